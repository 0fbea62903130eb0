#include "bench/paper/plain_lookup.hpp"

#include <cmath>
#include <optional>

#include "baker/parallel.hpp"
#include "format/frame.hpp"
#include "format/hemisphere_map.hpp"
#include "format/sphere_points.hpp"

namespace dfield::paper {
namespace {

// Everything in the space where the bounding sphere is the unit sphere.
struct Ray {
    glm::vec3 origin, direction;  // unit direction

    glm::vec3 at(float t) const { return origin + t * direction; }
};

class PlainField {
  public:
    PlainField(const DisplacementField& field, const LookupRules& rules)
        : field_(field),
          rules_(rules),
          points_(sphere_points(field.parameters.positions, field.parameters.subdivision)) {}

    bool blocks(const Ray& ray) const {
        const float b = glm::dot(ray.origin, ray.direction), c = glm::dot(ray.origin, ray.origin) - 1;
        const float square = b * b - c;
        if (!(square > 0)) return false;
        const float half = std::sqrt(square), t_in = -b - half, t_out = -b + half;
        if (t_out <= 0) return false;
        const auto first = hit(ray, t_in, -b, 1);
        if (t_in >= 0 || rules_.behind == Behind::kHit) return first.has_value();
        if (rules_.behind == Behind::kMiss) return first && *first > 0;
        const auto last = hit(ray, t_out, -b, -1);
        return last && *last > 0;
    }

  private:
    // Looks from the point at `t_end` along the ray (sense 1) or against it (-1).
    std::optional<float> hit(const Ray& ray, float t_end, float t_middle, float sense) const {
        const FieldParameters& parameters = field_.parameters;
        const std::uint32_t map =
            nearest_sphere_point(parameters.positions, parameters.subdivision, points_.data(), ray.at(t_end));
        const glm::vec3 p = points_[map];
        const glm::vec3 aim = rules_.pivot ? glm::normalize(ray.at(t_middle) - p) : sense * ray.direction;
        glm::vec3 local = frame_of_normal(-p).to_local(aim);
        local.z = std::max(local.z, 0.0f);  // a ray that grazes its point may leave the sample's hemisphere
        const std::uint32_t texel =
            direction_texel(parameters.mapping, parameters.map_size, glm::normalize(local));
        const std::uint8_t value = field_.texels[map * map_bytes(parameters) + texel];
        if (value == kMiss8) return std::nullopt;
        const float distance = static_cast<float>(value) * (2.0f / 254);
        // "Added to the intersection distance"; a hit of the pivot's line is projected onto the ray.
        return rules_.pivot ? glm::dot(p + distance * aim - ray.origin, ray.direction)
                            : t_end + sense * distance;
    }

    const DisplacementField& field_;
    const LookupRules& rules_;
    std::vector<glm::vec3> points_;
};

}  // namespace

std::vector<float> plain_visibility(const DisplacementField& field, const Receivers& receivers,
                                    const Directions& directions, const LookupRules& rules) {
    const PlainField plain(field, rules);
    const std::size_t count = directions.directions.size();
    std::vector<float> visibility(receivers.size());
    parallel_ranges(0, receivers.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Frame frame = frame_of_normal(receivers.normals[i]);
            const glm::vec3 origin = (receivers.positions[i] - field.centre) / field.radius;
            double occlusion = 0;
            for (std::size_t r = 0; r < count; ++r)
                if (plain.blocks({origin, frame.to_world(directions.directions[r])}))
                    occlusion +=
                        directions.weights.empty() ? 1.0 / static_cast<double>(count) : directions.weights[r];
            visibility[i] = static_cast<float>(1 - occlusion);
        }
    });
    return visibility;
}

}  // namespace dfield::paper
