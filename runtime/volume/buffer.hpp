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

// As much for each of several workers. Memory of those that never come is never touched.
template<class Value>
class WorkerBuffer {
  public:
    WorkerBuffer() = default;
    WorkerBuffer(dfield_context* context, std::size_t workers, std::size_t count, Value initial = {})
        : count_((count * sizeof(Value) + 63) / 64 * 64 / sizeof(Value)),  // cache lines of their own
          all_(context, workers * count_),
          initial_(initial) {}
    explicit operator bool() const { return static_cast<bool>(all_); }
    Value* of(std::size_t worker) const { return all_.get() + worker * count_; }
    // Sets a worker's to the initial value.
    void prepare(std::size_t worker) const {
        if (all_) std::fill_n(of(worker), count_, initial_);
    }

  private:
    std::size_t count_ = 0;
    Buffer<Value> all_;
    Value initial_{};
};

}  // namespace dfield::runtime::volume
