#include "batch/field_levels.hpp"

#include <cmath>

#include "batch/direction_lookup.hpp"
#include "format/frame.hpp"
#include "format/hemisphere_map.hpp"

namespace dfield::runtime {

float level_disagreement(const DirectionMaps& level, const DirectionMaps& finest) {
    if (&level == &finest) return 0;
    constexpr std::uint32_t kDirections = 256, kLines = 32;  // lines a direction
    constexpr double kGolden = 2.39996322972865332;
    const Instance unit;  // the identity: world space is the sphere's own
    std::uint32_t differing = 0, turn = 0;
    for (const glm::vec3& w : fibonacci_sphere(kDirections)) {
        const DirectionLookup coarse(level, unit, w), fine(finest, unit, w);
        const Frame frame = frame_of_normal(w);
        // A sunflower over the disc across the direction, turned for each.
        for (std::uint32_t i = 0; i < kLines; ++i) {
            const double radius = std::sqrt((i + 0.5) / kLines), angle = kGolden * (i + 7.3 * turn);
            const glm::vec3 point = frame.to_world({radius * std::cos(angle), radius * std::sin(angle), 0});
            MapPlace place;
            differing += coarse.hits(point, place) != fine.hits(point, place);
        }
        ++turn;
    }
    return static_cast<float>(differing) / (kDirections * kLines);
}

}  // namespace dfield::runtime
