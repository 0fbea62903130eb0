#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

#include "models/shapes.hpp"

namespace dfield::models {
namespace {

using glm::dvec3;

// SplitMix64 (Steele, Lea and Flood 2014): the same numbers everywhere, unlike the distributions of <random>.
class Random {
  public:
    explicit Random(std::uint64_t seed) : state_(seed) {}
    double between(double low, double high) {
        std::uint64_t z = state_ += 0x9e3779b97f4a7c15ull;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
        return low + (high - low) * (static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53);
    }
    dvec3 vector() { return {between(-1, 1), between(-1, 1), between(-1, 1)}; }

  private:
    std::uint64_t state_;
};

// How a bough of one level grows and what it bears.
struct Level {
    int segments, sides;
    double wander;                      // change of direction per segment
    double lift;                        // pull upwards per segment
    int children;                       // boughs of the next level, or leaves at the last
    double first_child;                 // fraction of the length that stays bare
    double spread;                      // angle between a child and its parent, radians
    double child_length, child_radius;  // relative to this bough's length and its radius at that place
};
constexpr Level kLevels[] = {
    {9, 9, 0.03, 0.04, 19, 0.32, 1.15, 0.50, 0.50},
    {5, 6, 0.12, 0.05, 5, 0.30, 0.80, 0.50, 0.55},
    {3, 4, 0.20, 0.04, 4, 0.20, 0.80, 0.62, 0.55},
    {2, 3, 0.25, -0.03, 14, 0.12, 1.00, 0.0, 0.0},
};
constexpr int kLastLevel = 3;
constexpr double kGoldenAngle = 2.399963229728653;

struct Frame {
    dvec3 u, v;
};

Frame frame_across(const dvec3& axis) {
    const dvec3 helper = std::abs(axis.y) < 0.9 ? dvec3(0, 1, 0) : dvec3(1, 0, 0);
    const dvec3 u = glm::normalize(glm::cross(helper, axis));
    return {u, glm::cross(axis, u)};
}

class TreeBuilder {
  public:
    Shape build() {
        grow(0, dvec3(0), dvec3(0, 1, 0), 2.9, 0.15);
        return std::move(shape_);
    }

  private:
    std::uint32_t add(const dvec3& point) {
        shape_.positions.push_back(quantized(point));
        return static_cast<std::uint32_t>(shape_.positions.size() - 1);
    }

    void grow(int level, dvec3 base, dvec3 direction, double length, double radius) {
        const Level& rule = kLevels[level];
        std::vector<dvec3> spine{base}, directions{direction};
        for (int i = 0; i < rule.segments; ++i) {
            const dvec3 turned = directions.back() + rule.wander * random_.vector() + dvec3(0, rule.lift, 0);
            directions.push_back(glm::normalize(turned));
            spine.push_back(spine.back() + directions.back() * (length / rule.segments));
        }
        add_tube(spine, directions, radius, rule.sides, level == 0);

        double azimuth = random_.between(0, glm::two_pi<double>());
        for (int i = 0; i < rule.children; ++i, azimuth += kGoldenAngle) {
            const double step = (i + random_.between(0.2, 0.8)) / rule.children;
            const double along = rule.first_child + (1 - rule.first_child) * step;
            const double at = std::min(along * rule.segments, rule.segments - 1e-9);
            const auto segment = static_cast<std::size_t>(at);
            const dvec3 place =
                glm::mix(spine[segment], spine[segment + 1], at - static_cast<double>(segment));
            const dvec3 axis = directions[segment + 1];
            const Frame frame = frame_across(axis);
            const dvec3 outwards = std::cos(azimuth) * frame.u + std::sin(azimuth) * frame.v;
            // The trunk's upper boughs stand steeper and are shorter, which rounds the crown.
            const double spread = rule.spread * (level == 0 ? 1.25 - 0.65 * step : random_.between(0.8, 1.2));
            const dvec3 towards = std::cos(spread) * axis + std::sin(spread) * outwards;
            if (level == kLastLevel) {
                add_leaf(place, towards);
                continue;
            }
            const double crown =
                level == 0 ? 0.72 + 0.62 * std::sin(glm::pi<double>() * (0.12 + 0.80 * step)) - 0.45 * step
                           : 1.15 - 0.45 * step;
            grow(level + 1, place, towards, length * rule.child_length * crown * random_.between(0.85, 1.15),
                 std::max(0.006, radius_at(radius, along) * rule.child_radius));
        }
    }

    static double radius_at(double radius, double along) { return radius * (1 - 0.8 * along); }

    // A tapering tube with a pointed end; its open base lies inside the parent or, for the trunk, in the
    // ground, where it flares.
    void add_tube(const std::vector<dvec3>& spine, const std::vector<dvec3>& directions, double radius,
                  int sides, bool flares) {
        std::vector<Face>& faces = shape_.parts[0].faces;
        const auto ring_size = static_cast<std::uint32_t>(sides);
        std::uint32_t previous = 0;
        for (std::size_t i = 0; i + 1 < spine.size(); ++i) {
            const Frame frame = frame_across(directions[i]);
            const double along = static_cast<double>(i) / static_cast<double>(spine.size() - 1);
            const double r = radius_at(radius, along) * (flares && i == 0 ? 1.5 : 1.0);
            const auto ring = static_cast<std::uint32_t>(shape_.positions.size());
            for (int s = 0; s < sides; ++s) {
                const double angle = glm::two_pi<double>() * s / sides;
                add(spine[i] + r * (std::cos(angle) * frame.u + std::sin(angle) * frame.v));
            }
            for (std::uint32_t s = 0; i > 0 && s < ring_size; ++s) {
                const std::uint32_t t = (s + 1) % ring_size;
                faces.push_back({previous + s, previous + t, ring + t, ring + s});
            }
            previous = ring;
        }
        const std::uint32_t tip = add(spine.back());
        for (std::uint32_t s = 0; s < ring_size; ++s)
            faces.push_back({previous + s, previous + (s + 1) % ring_size, tip});
    }

    // A rhombus whose front looks up, more or less.
    void add_leaf(const dvec3& stem, const dvec3& towards) {
        const dvec3 along = glm::normalize(towards + 0.5 * random_.vector() - dvec3(0, 0.25, 0));
        const dvec3 up = dvec3(0, 1, 0) + 0.7 * random_.vector();
        const dvec3 across = glm::normalize(glm::cross(along, up));
        const double length = random_.between(0.15, 0.23), half_width = 0.30 * length;
        const dvec3 middle = stem + 0.45 * length * along;
        const std::uint32_t a = add(stem), b = add(middle + half_width * across);
        const std::uint32_t c = add(stem + length * along), d = add(middle - half_width * across);
        shape_.parts[1].faces.push_back({a, b, c, d});
    }

    Random random_{2008};
    Shape shape_{{}, {{"wood", {}}, {"leaf", {}}}};
};

}  // namespace

Shape leafy_tree() {
    return TreeBuilder().build();
}

}  // namespace dfield::models
