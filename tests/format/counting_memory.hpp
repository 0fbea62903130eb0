// A memory resource that knows how much of it is in use.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory_resource>

namespace dfield::test {

class CountingMemory : public std::pmr::memory_resource {
  public:
    std::size_t live() const { return live_; }
    std::size_t peak() const { return peak_; }
    void reset_peak() { peak_ = live_; }

  private:
    void* do_allocate(std::size_t bytes, std::size_t alignment) override {
        void* block = std::pmr::new_delete_resource()->allocate(bytes, alignment);
        live_ += bytes;
        peak_ = std::max(peak_, live_);
        return block;
    }
    void do_deallocate(void* block, std::size_t bytes, std::size_t alignment) override {
        std::pmr::new_delete_resource()->deallocate(block, bytes, alignment);
        live_ -= bytes;
    }
    bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override {
        return this == &other;
    }

    std::size_t live_ = 0, peak_ = 0;
};

}  // namespace dfield::test
