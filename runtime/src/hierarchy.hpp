// A hierarchy of boxes over the instances of a snapshot.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory_resource>
#include <span>
#include <vector>

#include "dfield/scene.h"

namespace dfield::runtime {

struct Instance;

struct Box {
    glm::vec3 low, high;
};

class InstanceHierarchy {
  public:
    // Nodes in depth-first order: an inner node's first child follows it. Bounds are Instance::bounds.
    struct Node {
        Box box;
        std::uint32_t count;  // of instances, from order()[next] on; 0: an inner node
        std::uint32_t next;   // an inner node's second child
    };

    explicit InstanceHierarchy(std::pmr::memory_resource* memory) : nodes_(memory), order_(memory) {}
    InstanceHierarchy(const InstanceHierarchy& other, std::pmr::memory_resource* memory)
        : nodes_(other.nodes_, memory),
          order_(other.order_, memory),
          built_cost_(other.built_cost_),
          cost_(other.cost_) {}

    // Over these instances, from nothing.
    void build(std::span<const Instance> instances, std::span<const dfield_instance> ids);
    // Over the same ids in new places: the tree stays, its boxes change. False where that has made it so
    // loose that building it again pays.
    bool refit(std::span<const Instance> instances);

    // Empty without instances; nodes()[0] is the root.
    std::span<const Node> nodes() const { return nodes_; }
    std::span<const dfield_instance> order() const { return order_; }

    // Calls visit(id) for the instances of every leaf that all of whose ancestors, and itself, enter(box)
    // lets in. An instance's own box is not asked.
    template<class Enter, class Visit>
    void traverse(const Enter& enter, const Visit& visit) const {
        std::uint32_t stack[kMaxDepth];
        std::size_t depth = 0;
        std::uint32_t at = 0;
        if (nodes_.empty()) return;
        for (;;) {
            const Node& node = nodes_[at];
            if (enter(node.box)) {
                if (node.count == 0) {
                    stack[depth++] = node.next;
                    ++at;
                    continue;
                }
                for (std::uint32_t i = 0; i < node.count; ++i) visit(order_[node.next + i]);
            }
            if (depth == 0) return;
            at = stack[--depth];
        }
    }

  private:
    static constexpr std::size_t kLeafSize = 4;
    static constexpr std::size_t kMaxDepth = 40;  // leaves are halves of halves of at most 2^32 ids

    void build_node(std::span<const Instance> instances, std::uint32_t first, std::uint32_t count);

    std::pmr::vector<Node> nodes_;
    std::pmr::vector<dfield_instance> order_;
    float built_cost_ = 0, cost_ = 0;  // sums of the nodes' surfaces, as built and now
};

}  // namespace dfield::runtime
