#include "format/contents.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/matrix.hpp>

#include "format/codec_neighbours.hpp"

namespace dfield {
namespace {

using Code = FormatErrorCode;

// How far the box may stick out of the sphere's box: a share of the radius, and rounding where the centre is
// far from the origin.
constexpr double kBoundsTolerance = 1e-3, kRoundingTolerance = 1e-6;

// Length of the UTF-8 sequence at the front of `text` (RFC 3629: no overlong forms, no surrogates), 0 if
// none.
std::size_t utf8_length(std::string_view text) {
    const auto byte = [&](std::size_t i) {
        return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u;
    };
    const auto follows = [&](std::size_t i) { return (byte(i) & 0xc0) == 0x80; };
    const unsigned first = byte(0), second = byte(1);
    if (first < 0x80) return 1;
    if (first >= 0xc2 && first <= 0xdf) return follows(1) ? 2 : 0;
    if (first >= 0xe0 && first <= 0xef) {
        const bool canonical = (first != 0xe0 || second >= 0xa0) && (first != 0xed || second < 0xa0);
        return canonical && follows(1) && follows(2) ? 3 : 0;
    }
    if (first >= 0xf0 && first <= 0xf4) {
        const bool canonical = (first != 0xf0 || second >= 0x90) && (first != 0xf4 || second < 0x90);
        return canonical && follows(1) && follows(2) && follows(3) ? 4 : 0;
    }
    return 0;
}

}  // namespace

std::vector<ContentError> sphere_errors(const DisplacementField& field) {
    std::vector<ContentError> errors;
    const auto check_finite = [&](float value, std::size_t offset, const char* name) {
        if (!std::isfinite(value))
            errors.push_back({Code::kNotFinite, offset, std::string(name) + " is not finite"});
    };
    check_finite(field.radius, layout::kRadiusAt, "the radius");
    for (int axis = 0; axis < 3; ++axis) {
        check_finite(field.centre[axis], layout::kCentreAt + 4 * axis, "the centre");
        check_finite(field.bounds_min[axis], layout::kBoundsMinAt + 4 * axis, "the box");
        check_finite(field.bounds_max[axis], layout::kBoundsMaxAt + 4 * axis, "the box");
    }
    if (!errors.empty()) return errors;
    if (!(field.radius > 0) || !std::isnormal(field.radius) || !std::isfinite(2 * field.radius))
        return {{Code::kRadius, layout::kRadiusAt,
                 "the radius is " + std::to_string(field.radius) +
                     ", not a positive normal number with a finite double"}};
    for (int axis = 0; axis < 3; ++axis) {
        const double low = field.bounds_min[axis], high = field.bounds_max[axis], centre = field.centre[axis],
                     radius = field.radius;
        const double reach = radius * (1 + kBoundsTolerance) + std::fabs(centre) * kRoundingTolerance;
        if (low > high)
            errors.push_back(
                {Code::kBounds, layout::kBoundsMinAt + 4 * axis, "the box's minimum is above its maximum"});
        else if (low < centre - reach || high > centre + reach)
            errors.push_back(
                {Code::kBounds, layout::kBoundsMinAt + 4 * axis, "the box is not within the sphere's"});
    }
    return errors;
}

std::optional<ContentError> unused_texel_error(const FieldParameters& parameters,
                                               std::span<const std::uint8_t> plane) {
    if (parameters.mapping != Mapping::kRejection) return std::nullopt;
    const codec::MaskLayout mask(parameters);
    const auto m = static_cast<std::int64_t>(parameters.map_size);
    const std::size_t maps = position_count(parameters);
    for (std::int64_t t = 0; t < m; ++t) {
        std::array<std::uint8_t, kMaxMapSize / 8> unused{};  // of row t of every map
        for (std::int64_t s = 0; s < m; ++s) {
            const std::int64_t a = 2 * s + 1 - m, b = 2 * t + 1 - m;  // centre of the texel, disk of radius m
            if (a * a + b * b > m * m) unused[s / 8] |= static_cast<std::uint8_t>(1 << s % 8);
        }
        for (std::size_t map = 0; map < maps; ++map)
            for (std::size_t i = 0; i < mask.row_bytes; ++i)
                if ((plane[mask.row_at(map, t) + i] & unused[i]) != 0)
                    return ContentError{
                        Code::kUnusedTexel, 0,
                        "map " + std::to_string(map) + " has a hit in a texel without a direction"};
    }
    return std::nullopt;
}

std::optional<ContentError> mean_depth_error(const FieldParameters& parameters,
                                             std::span<const std::uint8_t> plane,
                                             std::span<const std::uint16_t> mean_depth) {
    const std::size_t bytes = plane.size() / position_count(parameters);
    for (std::size_t map = 0; map < mean_depth.size(); ++map) {
        const auto maps = plane.subspan(map * bytes, bytes);
        if (mean_depth[map] != 0 &&
            std::all_of(maps.begin(), maps.end(), [](std::uint8_t byte) { return byte == 0; }))
            return ContentError{Code::kMeanDepth, map,
                                "map " + std::to_string(map) + " has no hit, but its mean depth is not 0"};
    }
    return std::nullopt;
}

std::optional<ContentError> line_table_error(const LineTable& table) {
    const LineParameters& p = table.parameters;
    const auto error = [](Code code, std::size_t at, const std::string& what) {
        return ContentError{code, at, what};
    };
    if (const std::string wrong = line_parameters_error(p); !wrong.empty())
        return error(Code::kParameters, layout::kLineLatticeAt, wrong);
    for (int i = 0; i < 9; ++i)
        if (!std::isfinite(table.to_unit[i / 3][i % 3]))
            return error(Code::kNotFinite, layout::kLineToUnitAt + 4 * i,
                         "the map to the unit sphere is not finite");
    for (int i = 0; i < 3; ++i)
        if (!std::isfinite(table.centre[i]))
            return error(Code::kNotFinite, layout::kLineCentreAt + 4 * i,
                         "the line table's centre is not finite");
    if (!std::isnormal(glm::determinant(glm::dmat3(table.to_unit))))
        return error(Code::kLineTransform, layout::kLineToUnitAt,
                     "the map to the unit sphere is not invertible");
    const auto padded = [&](std::span<const std::uint32_t> words, std::uint64_t bits) {
        return words.size() == (bits + 31) / 32 && (bits % 32 == 0 || words.back() >> bits % 32 == 0);
    };
    if (!padded(table.hits, line_hit_count(p)))
        return error(Code::kLineTable, layout::kLineHeaderBytes,
                     "the line table's hits have other bits than its pairs of points");
    if (!padded(table.depths, line_depth_count(p) * p.depth_bits))
        return error(Code::kLineTable, layout::kLineHeaderBytes,
                     "the line table's depths have other bits than its pairs of points");
    return std::nullopt;
}

std::optional<ContentError> direction_maps_error(const DirectionMaps& maps) {
    const DirectionParameters& p = maps.parameters;
    if (const std::string wrong = direction_parameters_error(p); !wrong.empty())
        return ContentError{Code::kParameters, layout::kDirectionSubdivisionAt, wrong};
    const auto error = [](const std::string& what) {
        return ContentError{Code::kDirectionMaps, layout::kDirectionHeaderBytes, what};
    };
    const std::uint64_t directions = stored_direction_count(p.subdivision),
                        depths = directions * p.depth_size * p.depth_size;
    if (maps.frames.size() != directions ||
        maps.texels.size() != directions * direction_map_words(p.map_size) || maps.depths.size() != depths)
        return error("the direction maps have other sizes than their parameters say");
    for (const DirectionDepth& depth : maps.depths)
        if (depth.nearest > depth.farthest && (depth.nearest != 255 || depth.farthest != 0))
            return error("a depth of a direction map has its nearest hit behind its farthest");
    return std::nullopt;
}

bool finer_level(const DirectionParameters& coarse, const DirectionParameters& fine) {
    return fine.subdivision >= coarse.subdivision && fine.map_size >= coarse.map_size &&
           (fine.subdivision > coarse.subdivision || fine.map_size > coarse.map_size ||
            fine.depth_size > coarse.depth_size);
}

std::optional<ContentError> volume_error(const OcclusionVolume& volume) {
    if (const std::string wrong = volume_dims_error(volume.dims, volume.far_size); !wrong.empty())
        return ContentError{Code::kParameters, layout::kVolumeDimsAt, wrong};
    const auto grid_error = [](Code code, std::size_t at, const char* what) {
        return ContentError{code, at, what};
    };
    if (!std::isfinite(volume.spacing) || !std::isfinite(volume.blend))
        return grid_error(Code::kNotFinite, layout::kVolumeSpacingAt,
                          "the occlusion volume's spacing or blend is not finite");
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const float low = volume.origin[static_cast<int>(axis)];
        if (!std::isfinite(low) ||
            !std::isfinite(low + volume.spacing * static_cast<float>(volume.dims[axis])))
            return grid_error(Code::kNotFinite, layout::kVolumeOriginAt + 4 * axis,
                              "the occlusion volume's box is not finite");
    }
    if (!(volume.spacing > 0) || !std::isnormal(volume.spacing) || !std::isnormal(1 / volume.spacing))
        return grid_error(
            Code::kVolumeGrid, layout::kVolumeSpacingAt,
            "the occlusion volume's spacing is not a positive normal number with a normal inverse");
    if (!(volume.blend >= volume.spacing))
        return grid_error(Code::kVolumeGrid, layout::kVolumeBlendAt,
                          "the occlusion volume's blend is less than its spacing");
    if (volume.octants.size() != 2 * volume.samples() ||
        volume.far.size() != std::size_t{volume.far_size} * volume.far_size)
        return grid_error(Code::kVolume, layout::kVolumeHeaderBytes,
                          "the occlusion volume has other sizes than its dimensions say");
    return std::nullopt;
}

std::optional<ContentError> provenance_error(std::string_view text) {
    const auto error = [](std::size_t at, const std::string& what) {
        return ContentError{Code::kProvenance, at, "the provenance " + what};
    };
    if (text.size() > kMaxProvenanceBytes)
        return error(0, "has more than " + std::to_string(kMaxProvenanceBytes) + " bytes");
    if (text.size() < 2 || text.front() != '{' || text.back() != '}') return error(0, "is no JSON object");
    for (std::size_t i = 0; i < text.size();) {
        const char c = text[i];
        const bool control = static_cast<unsigned char>(c) < 0x20 && c != '\t' && c != '\n' && c != '\r';
        const std::size_t length = utf8_length(text.substr(i));
        if (control || c == 0x7f || length == 0) return error(i, "is not UTF-8 text");
        i += length;
    }
    return std::nullopt;
}

}  // namespace dfield
