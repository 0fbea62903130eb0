#include "format/field.hpp"

namespace dfield {

std::uint64_t position_count(const FieldParameters& parameters) {
    if (!has_maps(parameters)) return 0;
    const std::uint64_t n = parameters.subdivision;
    return parameters.positions == Positions::kSlater ? 4 * n * n + 2 : (2 * n + 1) * (2 * n + 2);
}

std::uint64_t paper_position_count(const FieldParameters& parameters) {
    if (!has_maps(parameters)) return 0;
    const std::uint64_t n = parameters.subdivision;
    return parameters.positions == Positions::kSlater ? 2 * (2 * n * n + 2 * n + 1)
                                                      : position_count(parameters);
}

std::uint64_t map_bytes(const FieldParameters& parameters) {
    const std::uint64_t m = parameters.map_size;
    return (m * m * parameters.bits + 7) / 8;
}

std::uint64_t texel_bytes(const FieldParameters& parameters) {
    return position_count(parameters) * map_bytes(parameters);
}

std::string parameters_error(const FieldParameters& parameters) {
    const auto& [positions, subdivision, mapping, map_size, bits] = parameters;
    if (!has_maps(parameters))
        return parameters == kNoMaps
                   ? std::string()
                   : "a field without displacement maps (0 bits a texel) has other parameters";
    if (positions != Positions::kSlater && positions != Positions::kLatlong)
        return "unknown layout of positional samples " + std::to_string(static_cast<int>(positions)) +
               " (known: 0 slater, 1 latlong)";
    if (mapping != Mapping::kConcentric && mapping != Mapping::kPolar && mapping != Mapping::kRejection)
        return "unknown mapping " + std::to_string(static_cast<int>(mapping)) +
               " (known: 0 concentric, 1 polar, 2 rejection)";
    if (subdivision < 1 || subdivision > kMaxSubdivision)
        return "subdivision " + std::to_string(subdivision) + " is outside 1.." +
               std::to_string(kMaxSubdivision);
    if (map_size < 1 || map_size > kMaxMapSize)
        return "map size " + std::to_string(map_size) + " is outside 1.." + std::to_string(kMaxMapSize);
    if (bits != 1 && bits != 8 && bits != 16 && bits != 32)
        return std::to_string(bits) + " bits a texel are not supported (1, 8, 16 or 32)";
    if (texel_bytes(parameters) > kMaxTexelBytes)
        return "the maps would take " + std::to_string(texel_bytes(parameters)) +
               " bytes, more than the format's " + std::to_string(kMaxTexelBytes) +
               "; lower the subdivision or the map size";
    return {};
}

}  // namespace dfield
