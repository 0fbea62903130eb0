#include "format/direction_maps.hpp"

#include <algorithm>
#include <cmath>

#include "format/frame.hpp"
#include "format/sphere_points.hpp"

namespace dfield {

std::uint32_t direction_subdivision(std::uint32_t count) {
    std::uint32_t n = 1;
    while (n < kMaxDirectionSubdivision && direction_count(n + 1) <= count) ++n;
    return n;
}

std::string direction_parameters_error(const DirectionParameters& p) {
    if (p.subdivision < 1 || p.subdivision > kMaxDirectionSubdivision)
        return "subdivision of directions " + std::to_string(p.subdivision) + " is outside 1.." +
               std::to_string(kMaxDirectionSubdivision);
    static_assert(kMaxDirectionMapSize == 128);
    if (p.map_size != 16 && p.map_size != 32 && p.map_size != 64 && p.map_size != 128)
        return "map size " + std::to_string(p.map_size) + " of direction maps is not 16, 32, 64 or 128";
    const bool power = p.depth_size != 0 && (p.depth_size & (p.depth_size - 1)) == 0;
    if (p.depth_size != 0 && (!power || p.depth_size < 8 || p.depth_size > p.map_size))
        return "depth size " + std::to_string(p.depth_size) +
               " of direction maps is not 0 or a power of two from 8 to the map size";
    return {};
}

DirectionFrame unpack_direction_frame(const PackedDirectionFrame& packed, const glm::vec3& direction) {
    const auto centred = [&](int i) { return static_cast<float>(packed[i]) - 128.0f; };
    const float t = static_cast<float>(packed[0]) * (1.0f / 256);
    const float scale = 1 / (1 + t * t), cosine = (1 - t * t) * scale, sine = 2 * t * scale;
    const Frame frame = frame_of_normal(direction);
    DirectionFrame result;
    result.axis_u = cosine * frame.tangent + sine * frame.bitangent;
    result.axis_v = cosine * frame.bitangent - sine * frame.tangent;
    result.direction = direction;
    result.centre_u = centred(1) * (1.0f / 128);
    result.centre_v = centred(2) * (1.0f / 128);
    result.half_u = (static_cast<float>(packed[3]) + 1) * (1.0f / 256);
    result.half_v = (static_cast<float>(packed[4]) + 1) * (1.0f / 256);
    result.depth = centred(5) * (1.0f / 128);
    result.slope_u = centred(6) * (1.0f / 64);
    result.slope_v = centred(7) * (1.0f / 64);
    return result;
}

glm::vec3 stored_direction(std::uint32_t subdivision, std::uint32_t index) {
    if (index == 0) return {0, 0, 1};
    auto ring = static_cast<std::uint32_t>((1 + std::sqrt(static_cast<double>(2 * index - 1))) / 2);
    while (SlaterRings::first(ring) > index) --ring;  // rounding of the root
    while (SlaterRings::first(ring + 1) <= index) ++ring;
    const double share = static_cast<double>(ring) / subdivision, height = 1 - share * share;
    const double angle = 1.5707963267948966 * (index - SlaterRings::first(ring)) / ring;
    const double radius = std::sqrt(1 - height * height);
    return {radius * std::cos(angle), radius * std::sin(angle), height};
}

float direction_reach(const DirectionMaps& maps) {
    const std::uint32_t m = maps.parameters.map_size, words = direction_map_words(m);
    float square = 0;
    for (std::uint32_t i = 0; i < maps.frames.size(); ++i) {
        const DirectionFrame f =
            unpack_direction_frame(maps.frames[i], stored_direction(maps.parameters.subdivision, i));
        const auto corner = [&](std::uint32_t s, std::uint32_t t) {
            const float u = (2 * static_cast<float>(s) / static_cast<float>(m) - 1) * f.half_u;
            const float v = (2 * static_cast<float>(t) / static_cast<float>(m) - 1) * f.half_v;
            const float depth = f.depth + f.slope_u * u + f.slope_v * v;
            square = std::max(square, (u + f.centre_u) * (u + f.centre_u) +
                                          (v + f.centre_v) * (v + f.centre_v) + depth * depth);
        };
        // The farthest corner of a row's texels is one of the first's or the last's.
        for (std::uint32_t t = 0; t < m; ++t) {
            std::uint32_t first = m, last = 0;
            for (std::uint32_t s = 0; s < m; ++s) {
                const std::uint32_t texel = t * m + s;
                if (!(maps.texels[i * words + texel / 32] >> texel % 32 & 1)) continue;
                first = std::min(first, s);
                last = s;
            }
            if (first == m) continue;
            for (const std::uint32_t row : {t, t + 1})
                for (const std::uint32_t column : {first, last + 1}) corner(column, row);
        }
    }
    return std::sqrt(square);
}

NearestDirection nearest_direction(std::uint32_t subdivision, const glm::vec3& k) {
    const SlaterRings rings{subdivision};
    const auto n = static_cast<float>(subdivision);
    bool flipped = k.z < 0;
    const glm::vec3 q = flipped ? -k : k;
    const float height = n * std::sqrt((q.x * q.x + q.y * q.y) / (1 + q.z));
    const auto ring = std::min(static_cast<std::uint32_t>(height + 0.5f), subdivision);
    std::uint32_t j = SlaterRings::nearest_on_ring(ring, quarter_turns(q.x, q.y));
    if (ring == subdivision && j >= 2 * ring) {
        j -= 2 * ring;
        flipped = !flipped;
    }
    return {rings.index(ring, j, false), flipped};
}

}  // namespace dfield
