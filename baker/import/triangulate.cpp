#include "baker/import/triangulate.hpp"

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

namespace dfield {
namespace {

// The polygon on its dominant plane, as a ring from which ears are cut.
class Ring {
  public:
    explicit Ring(std::span<const glm::vec3> corners)
        : points_(corners.size()), next_(corners.size()), previous_(corners.size()), size_(corners.size()) {
        // Newell's normal: the sum over all edges does not depend on any single corner being convex.
        const glm::dvec3 origin(corners[0]);
        glm::dvec3 normal(0);
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const glm::dvec3 a = glm::dvec3(corners[i]) - origin;
            const glm::dvec3 b = glm::dvec3(corners[(i + 1) % corners.size()]) - origin;
            normal += glm::cross(a, b);
        }
        const glm::dvec3 size = glm::abs(normal);
        const int drop = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
        const int u = (drop + 1) % 3, v = (drop + 2) % 3;
        const double flip = normal[drop] < 0 ? -1 : 1;  // so that the ring always runs counter-clockwise
        for (std::uint32_t i = 0; i < corners.size(); ++i) {
            const glm::dvec3 p = glm::dvec3(corners[i]) - origin;
            points_[i] = glm::dvec2(p[u] * flip, p[v]);
            next_[i] = i + 1 == corners.size() ? 0 : i + 1;
            previous_[next_[i]] = i;
        }
    }

    std::size_t size() const { return size_; }
    std::uint32_t next(std::uint32_t i) const { return next_[i]; }
    std::uint32_t previous(std::uint32_t i) const { return previous_[i]; }
    bool convex(std::uint32_t i) const { return turn(previous_[i], i, next_[i]) > 0; }

    bool is_ear(std::uint32_t i) const {
        const std::uint32_t a = previous_[i], b = i, c = next_[i];
        if (turn(a, b, c) <= 0) return false;
        for (std::uint32_t p = next_[c]; p != a; p = next_[p]) {
            // A seam visits its ends twice: the twin of a corner does not block that corner's ear.
            if (points_[p] == points_[a] || points_[p] == points_[b] || points_[p] == points_[c]) continue;
            if (turn(a, b, p) < 0 || turn(b, c, p) < 0 || turn(c, a, p) < 0) continue;
            if (!convex(p)) return false;  // the ring enters an ear only by a corner that is not convex
        }
        return true;
    }

    void cut(std::uint32_t i) {
        next_[previous_[i]] = next_[i];
        previous_[next_[i]] = previous_[i];
        --size_;
    }

  private:
    // Twice the signed area; positive where a, b, c turn left.
    double turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
        const glm::dvec2 ab = points_[b] - points_[a], ac = points_[c] - points_[a];
        return ab.x * ac.y - ab.y * ac.x;
    }

    std::vector<glm::dvec2> points_;
    std::vector<std::uint32_t> next_, previous_;
    std::size_t size_;
};

}  // namespace

void triangulate(std::span<const glm::vec3> corners, std::vector<std::array<std::uint32_t, 3>>& triangles) {
    if (corners.size() < 3) return;
    if (corners.size() == 3) {
        triangles.push_back({0, 1, 2});
        return;
    }
    Ring ring(corners);
    std::uint32_t tip = 1;  // a convex polygon becomes the fan around corner 0 that everybody expects
    while (ring.size() > 3) {
        std::size_t tried = 0;
        while (tried < ring.size() && !ring.is_ear(tip)) {
            tip = ring.next(tip);
            ++tried;
        }
        // No ear: the outline crosses itself or has collapsed to a line. Any convex corner keeps the rest
        // moving.
        for (std::size_t i = 0; tried == ring.size() && i < tried && !ring.convex(tip); ++i)
            tip = ring.next(tip);
        triangles.push_back({ring.previous(tip), tip, ring.next(tip)});
        const std::uint32_t following = ring.next(tip);
        ring.cut(tip);
        tip = following;
    }
    triangles.push_back({ring.previous(tip), tip, ring.next(tip)});
}

}  // namespace dfield
