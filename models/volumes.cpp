#include "models/volumes.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <limits>

namespace dfield::models {
namespace {

constexpr double kCutOff = 4;  // voxels: what lies farther from a surface than this is flat

// Evaluates value(point) at every voxel.
template<class Value>
ScalarVolume sampled(Dims dims, Spacing spacing, const Value& value) {
    ScalarVolume volume{dims, spacing, {}};
    volume.values.reserve(std::size_t{dims[0]} * dims[1] * dims[2]);
    for (std::uint32_t z = 0; z < dims[2]; ++z)
        for (std::uint32_t y = 0; y < dims[1]; ++y)
            for (std::uint32_t x = 0; x < dims[0]; ++x)
                volume.values.push_back(
                    static_cast<float>(value(glm::dvec3(x * spacing[0], y * spacing[1], z * spacing[2]))));
    return volume;
}

glm::dvec3 extent_of(Dims dims) {
    return {dims[0] - 1.0, dims[1] - 1.0, dims[2] - 1.0};
}

// SplitMix64: the same numbers with every compiler and standard library.
class Sequence {
  public:
    explicit Sequence(std::uint64_t seed) : state_(seed) {}
    double uniform(double low, double high) {
        state_ += 0x9e3779b97f4a7c15u;
        std::uint64_t z = state_;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return low + (high - low) * static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
    }

  private:
    std::uint64_t state_;
};

double box_distance(const glm::dvec3& point, const glm::dvec3& half) {
    const glm::dvec3 q = glm::abs(point) - half;
    return glm::length(glm::max(q, glm::dvec3(0))) + std::min(std::max({q.x, q.y, q.z}), 0.0);
}

// A cone's frustum from a to b, its ends round.
struct Tube {
    glm::dvec3 a, b;
    double radius_a, radius_b;
};

double tube_distance(const Tube& tube, const glm::dvec3& point) {
    const glm::dvec3 axis = tube.b - tube.a;
    const double t = std::clamp(glm::dot(point - tube.a, axis) / glm::dot(axis, axis), 0.0, 1.0);
    return glm::length(point - tube.a - t * axis) - (tube.radius_a + t * (tube.radius_b - tube.radius_a));
}

// One vessel and, recursively, its two branches.
void grow(std::vector<Tube>& tubes, Sequence& random, const glm::dvec3& from, const glm::dvec3& direction,
          double radius, double length, int generation) {
    glm::dvec3 point = from, heading = direction;
    constexpr int kSegments = 4;
    for (int i = 0; i < kSegments; ++i) {
        heading = glm::normalize(
            heading + 0.35 * glm::dvec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)));
        const glm::dvec3 next = point + heading * (length / kSegments);
        tubes.push_back({point, next, radius * (1 - 0.05 * i), radius * (0.95 - 0.05 * i)});
        point = next;
    }
    if (generation == 0) return;
    for (int branch = 0; branch < 2; ++branch) {
        const glm::dvec3 turn(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
        grow(tubes, random, point, glm::normalize(heading + 0.9 * turn), radius * 0.75, length * 0.8,
             generation - 1);
    }
}

// The values of a lattice, smoothly blended: noise of one octave, in [-1, 1].
double lattice_noise(const glm::dvec3& point, std::uint64_t seed) {
    const glm::dvec3 cell = glm::floor(point), f = point - cell, s = f * f * (3.0 - 2.0 * f);
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::ivec3 at(corner & 1, corner >> 1 & 1, corner >> 2);
        const glm::dvec3 w = glm::mix(1.0 - s, s, glm::dvec3(at));
        const auto key = [&](int axis) {
            return static_cast<std::uint64_t>(static_cast<std::int64_t>(cell[axis]) + at[axis]);
        };
        Sequence hash(seed ^ key(0) * 0x8da6b343u ^ key(1) * 0xd8163841cb1ab1u ^ key(2) * 0xa2b5a4d1f7c3u);
        sum += w.x * w.y * w.z * hash.uniform(-1, 1);
    }
    return sum;
}

}  // namespace

ScalarVolume sphere_volume(Dims dims, const glm::dvec3& centre, double radius, Spacing spacing) {
    return sampled(dims, spacing, [&](const glm::dvec3& p) { return radius - glm::length(p - centre); });
}

ScalarVolume slab_volume(Dims dims, const glm::dvec3& centre, const glm::dvec3& normal, double thickness,
                         Spacing spacing) {
    return sampled(dims, spacing, [&](const glm::dvec3& p) {
        return thickness / 2 - std::abs(glm::dot(p - centre, normal));
    });
}

ScalarVolume plane_volume(Dims dims, const glm::dvec3& centre, const glm::dvec3& normal, Spacing spacing) {
    return sampled(dims, spacing, [&](const glm::dvec3& p) { return glm::dot(centre - p, normal); });
}

ScalarVolume gyroid_volume(Dims dims, double periods) {
    const std::uint32_t longest = std::max({dims[0], dims[1], dims[2]});
    const double scale = 2 * glm::pi<double>() * periods / longest;
    std::vector<double> sines, cosines;  // a hundred million voxels have but a few hundred coordinates
    for (std::uint32_t i = 0; i < longest; ++i) {
        sines.push_back(std::sin(i * scale));
        cosines.push_back(std::cos(i * scale));
    }
    return sampled(dims, kUnitSpacing, [&](const glm::dvec3& p) {
        const glm::uvec3 i(p);
        return sines[i.x] * cosines[i.y] + sines[i.y] * cosines[i.z] + sines[i.z] * cosines[i.x];
    });
}

ScalarVolume floor_volume(Dims dims) {
    struct Box {
        glm::dvec3 centre, half;  // of the extent
        double angle;             // around z
    };
    constexpr double kFloor = 0.2;
    const Box boxes[] = {{{0.25, 0.28, 0.32}, {0.10, 0.12, 0.125}, 0.0},
                         {{0.66, 0.26, 0.42}, {0.08, 0.08, 0.225}, 0.6},
                         {{0.35, 0.70, 0.27}, {0.16, 0.07, 0.075}, -0.35},
                         {{0.76, 0.72, 0.34}, {0.09, 0.14, 0.145}, 0.0},
                         {{0.52, 0.50, 0.24}, {0.05, 0.05, 0.045}, 0.9}};
    const glm::dvec3 extent = extent_of(dims);
    return sampled(dims, kUnitSpacing, [&](const glm::dvec3& p) {
        double distance = p.z - kFloor * extent.z;
        for (const Box& box : boxes) {
            const glm::dvec3 q = p - box.centre * extent;
            const double c = std::cos(box.angle), s = std::sin(box.angle);
            distance = std::min(distance,
                                box_distance({c * q.x + s * q.y, c * q.y - s * q.x, q.z}, box.half * extent));
        }
        return -std::clamp(distance, -kCutOff, kCutOff);
    });
}

ScalarVolume vessels_volume(Dims dims, std::uint64_t seed, int roots) {
    const glm::dvec3 extent = extent_of(dims);
    const double size = std::min({extent.x, extent.y, extent.z});
    Sequence random(seed);
    std::vector<Tube> tubes;
    constexpr int kGenerations = 6;
    for (int root = 0; root < roots; ++root)
        grow(tubes, random, {0, random.uniform(0.15, 0.85) * extent.y, random.uniform(0.15, 0.85) * extent.z},
             {1, 0, 0}, std::max(1.2, 0.02 * size), 0.28 * size, kGenerations);

    ScalarVolume volume{dims, kUnitSpacing, {}};
    volume.values.assign(std::size_t{dims[0]} * dims[1] * dims[2], static_cast<float>(-kCutOff));
    for (const Tube& tube : tubes) {
        const double reach = std::max(tube.radius_a, tube.radius_b) + kCutOff;
        const glm::dvec3 low = glm::max(glm::min(tube.a, tube.b) - reach, glm::dvec3(0));
        const glm::dvec3 high = glm::min(glm::max(tube.a, tube.b) + reach, extent);
        for (double z = std::ceil(low.z); z <= high.z; ++z)
            for (double y = std::ceil(low.y); y <= high.y; ++y)
                for (double x = std::ceil(low.x); x <= high.x; ++x) {
                    float& value =
                        volume.values[volume.index(static_cast<std::size_t>(x), static_cast<std::size_t>(y),
                                                   static_cast<std::size_t>(z))];
                    const double distance = std::max(tube_distance(tube, {x, y, z}), -kCutOff);
                    value = std::max(value, static_cast<float>(-distance));
                }
    }
    return volume;
}

ScalarVolume clouds_volume(Dims dims, std::uint64_t seed) {
    struct Puff {
        glm::dvec3 centre;
        double radius;
    };
    const glm::dvec3 extent = extent_of(dims);
    const double size = std::min({extent.x, extent.y, extent.z});
    Sequence random(seed);
    std::vector<Puff> puffs;
    constexpr int kPuffs = 24, kOctaves = 4;
    for (int i = 0; i < kPuffs; ++i) {
        const glm::dvec3 at(random.uniform(0.25, 0.75), random.uniform(0.25, 0.75),
                            random.uniform(0.25, 0.6));
        puffs.push_back({at * extent, random.uniform(0.06, 0.16) * size});
    }
    return sampled(dims, kUnitSpacing, [&](const glm::dvec3& p) {
        double distance = std::numeric_limits<double>::infinity();
        for (const Puff& puff : puffs)
            distance = std::min(distance, glm::length(p - puff.centre) - puff.radius);
        double rough = 0, amplitude = 0.06 * size, frequency = 10 / size;
        for (int octave = 0; octave < kOctaves; ++octave, amplitude /= 2, frequency *= 2)
            rough += amplitude * lattice_noise(p * frequency, seed + static_cast<std::uint64_t>(octave));
        return -std::max(distance + rough, 0.25 * extent.z - p.z);
    });
}

}  // namespace dfield::models
