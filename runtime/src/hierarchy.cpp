#include "hierarchy.hpp"

#include <algorithm>
#include <glm/common.hpp>

#include "scene.hpp"

namespace dfield::runtime {
namespace {

Box joined(const Box& a, const Box& b) {
    return {glm::min(a.low, b.low), glm::max(a.high, b.high)};
}

float surface(const Box& box) {
    const glm::vec3 size = box.high - box.low;
    return size.x * size.y + size.y * size.z + size.z * size.x;
}

}  // namespace

void InstanceHierarchy::build(std::span<const Instance> instances, std::span<const dfield_instance> ids) {
    nodes_.clear();
    order_.assign(ids.begin(), ids.end());
    if (ids.empty()) return;
    nodes_.reserve(ids.size());
    build_node(instances, 0, static_cast<std::uint32_t>(ids.size()));
    refit(instances);
    built_cost_ = cost_;
}

// Halves at the median along the longest side of the centres' box: balanced, so that a tree's depth is
// bounded.
void InstanceHierarchy::build_node(std::span<const Instance> instances, std::uint32_t first,
                                   std::uint32_t count) {
    const std::size_t at = nodes_.size();
    nodes_.push_back({{}, count <= kLeafSize ? count : 0, first});
    if (count <= kLeafSize) return;
    const auto centre = [&](dfield_instance id) {
        return instances[id].bounds.low * 0.5f + instances[id].bounds.high * 0.5f;
    };
    Box box{centre(order_[first]), centre(order_[first])};
    for (std::uint32_t i = first; i < first + count; ++i) {
        const glm::vec3 c = centre(order_[i]);
        box = joined(box, {c, c});
    }
    const glm::vec3 size = box.high - box.low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const auto begin = order_.begin() + first;
    const std::uint32_t half = count / 2;
    std::nth_element(begin, begin + half, begin + count, [&](dfield_instance a, dfield_instance b) {
        const float x = centre(a)[axis], y = centre(b)[axis];
        return x < y || (x == y && a < b);
    });
    build_node(instances, first, half);
    nodes_[at].next = static_cast<std::uint32_t>(nodes_.size());
    build_node(instances, first + half, count - half);
}

bool InstanceHierarchy::refit(std::span<const Instance> instances) {
    cost_ = 0;
    // Children lie behind their parent.
    for (std::size_t at = nodes_.size(); at-- > 0;) {
        Node& node = nodes_[at];
        if (node.count == 0) {
            node.box = joined(nodes_[at + 1].box, nodes_[node.next].box);
        } else {
            node.box = instances[order_[node.next]].bounds;
            for (std::uint32_t i = 1; i < node.count; ++i)
                node.box = joined(node.box, instances[order_[node.next + i]].bounds);
        }
        cost_ += surface(node.box);
    }
    return cost_ <= 1.5f * built_cost_;
}

}  // namespace dfield::runtime
