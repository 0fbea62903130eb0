// Scratch memory of a call, from the context's hooks.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>

#include "context.hpp"

namespace dfield::runtime::volume {

// `count` values on a cache line's border, uninitialised.
template<class Value>
class Buffer {
  public:
    Buffer() = default;
    Buffer(dfield_context* context, std::size_t count) : context_(context), count_(count) {
        if (count > 0) data_ = static_cast<Value*>(context->allocate(count * sizeof(Value), kAlignment));
    }
    Buffer(dfield_context* context, std::size_t count, Value value) : Buffer(context, count) {
        std::fill_n(data_, count, value);
    }
    Buffer(Buffer&& other) noexcept
        : context_(other.context_), data_(std::exchange(other.data_, nullptr)), count_(other.count_) {}
    Buffer& operator=(Buffer&& other) noexcept {
        std::swap(context_, other.context_);
        std::swap(data_, other.data_);
        std::swap(count_, other.count_);
        return *this;
    }
    ~Buffer() {
        if (data_) context_->deallocate(data_, count_ * sizeof(Value), kAlignment);
    }

    explicit operator bool() const { return data_ != nullptr; }
    Value* get() const { return data_; }
    Value* operator+(std::ptrdiff_t offset) const { return data_ + offset; }

  private:
    static constexpr std::size_t kAlignment = 64;
    dfield_context* context_ = nullptr;
    Value* data_ = nullptr;
    std::size_t count_ = 0;
};

}  // namespace dfield::runtime::volume
