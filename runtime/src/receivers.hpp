// Receivers as callers hand them over, checked and with unit normals.
#pragma once

#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "dfield/ambient.h"
#include "strided.hpp"

namespace dfield::runtime {

struct UnitReceiver {
    glm::vec3 position;
    glm::vec3 normal;  // unit; zero where position or normal are unusable: nothing occludes such a receiver
    dfield_instance owner;

    bool usable() const { return normal != glm::vec3(0); }
};

inline UnitReceiver unit_receiver(const glm::vec3& position, const glm::vec3& normal, dfield_instance owner) {
    const float length = std::sqrt(glm::dot(normal, normal));
    const bool usable = finite(position) && std::isfinite(length) && length > 0;
    return {position, usable ? normal * (1 / length) : glm::vec3(0), owner};
}

class ReceiverReader {
  public:
    explicit ReceiverReader(const dfield_receivers& receivers)
        : positions_(receivers.positions, receivers.position_stride, 3),
          normals_(receivers.normals, receivers.normal_stride, 3),
          owners_(receivers.owners, receivers.owner_stride, 1) {}

    UnitReceiver operator[](std::size_t i) const {
        return unit_receiver(positions_.vec3(i), normals_.vec3(i),
                             owners_ ? *owners_.at(i) : DFIELD_NO_INSTANCE);
    }

  private:
    Strided<const float> positions_, normals_;
    Strided<const dfield_instance> owners_;
};

// Receivers [first, first + count) by themselves.
inline dfield_receivers receivers_from(dfield_receivers receivers, std::size_t first, std::size_t count) {
    const auto skip = [first](auto*& pointer, std::size_t& stride, std::size_t values) {
        using Value = std::remove_reference_t<decltype(*pointer)>;
        const Strided<Value> whole(pointer, stride, values);
        if (whole) pointer = whole.at(first);
    };
    receivers.count = count;
    skip(receivers.positions, receivers.position_stride, 3);
    skip(receivers.normals, receivers.normal_stride, 3);
    skip(receivers.owners, receivers.owner_stride, 1);
    skip(receivers.self_visibility, receivers.self_visibility_stride, 1);
    return receivers;
}

}  // namespace dfield::runtime
