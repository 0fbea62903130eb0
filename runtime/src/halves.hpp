// Neighbours together: points in space halved again and again.
#pragma once

#include <algorithm>
#include <cstddef>
#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <span>

namespace dfield::runtime {

// Splits items across the longest side of their box, at a multiple of `unit` near the middle, until at most
// `unit` are left: as many boxes of `unit` items as can be, each as small as can be. point(item): where it
// is; id(item): decides among equals, so that the order depends on nothing else.
template<class Item, class Point, class Id>
void halve(std::span<Item> items, std::size_t unit, const Point& point, const Id& id) {
    if (items.size() <= unit) return;
    glm::vec3 low(std::numeric_limits<float>::infinity()), high(-low);
    for (const Item& item : items) {
        low = glm::min(low, point(item));
        high = glm::max(high, point(item));
    }
    const glm::vec3 size = high - low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::size_t middle = (items.size() + unit - 1) / unit / 2 * unit;
    std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(middle), items.end(),
                     [&](const Item& a, const Item& b) {
                         const float left = point(a)[axis], right = point(b)[axis];
                         return left != right ? left < right : id(a) < id(b);
                     });
    halve(items.first(middle), unit, point, id);
    halve(items.subspan(middle), unit, point, id);
}

}  // namespace dfield::runtime
