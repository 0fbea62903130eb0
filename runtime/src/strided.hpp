// Arrays as callers hand them over: a pointer and a stride in bytes, 0 for tightly packed.
#pragma once

#include <cmath>
#include <cstddef>
#include <glm/vec3.hpp>
#include <type_traits>

namespace dfield::runtime {

template<class Value>
class Strided {
    using Byte = std::conditional_t<std::is_const_v<Value>, const char, char>;

  public:
    Strided(Value* first, std::size_t stride, std::size_t values_an_element)
        : first_(reinterpret_cast<Byte*>(first)),
          stride_(stride ? stride : values_an_element * sizeof(Value)) {}

    explicit operator bool() const { return first_ != nullptr; }
    // The elements from `first` on.
    Strided from(std::size_t first) const { return {at(first), stride_, 0}; }
    Value* at(std::size_t i) const { return reinterpret_cast<Value*>(first_ + i * stride_); }
    glm::vec3 vec3(std::size_t i) const {
        Value* const v = at(i);
        return {v[0], v[1], v[2]};
    }

  private:
    Byte* first_;
    std::size_t stride_;
};

inline bool finite(const glm::vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace dfield::runtime
