// Fields with direction maps, baked for a test.
#pragma once

#include "baker/bake_directions.hpp"
#include "tests/runtime/baked.hpp"

namespace dfield::test {

// Displacement maps as baked_bytes makes them, and one level of direction maps, or two.
inline std::vector<std::byte> baked_directions_bytes(const TriangleMesh& mesh, std::uint32_t subdivision = 6,
                                                     std::uint32_t map_size = 16,
                                                     std::uint32_t depth_size = 8,
                                                     bool coarse_level = false) {
    BakeOptions options;
    options.parameters = {Positions::kSlater, 6, Mapping::kConcentric, 8, 8};
    DisplacementField field = bake_field(mesh, options);
    DirectionBakeOptions directions;
    if (coarse_level) {
        directions.parameters = {subdivision / 2, 16, depth_size};
        field.directions.push_back(bake_directions(mesh, {field.centre, field.radius}, directions));
    }
    directions.parameters = {subdivision, map_size, depth_size};
    field.directions.push_back(bake_directions(mesh, {field.centre, field.radius}, directions));
    return write_field(field, {.zstd_level = 1});
}

inline Field baked_directions(const Context& context, const TriangleMesh& mesh, std::uint32_t subdivision = 6,
                              std::uint32_t map_size = 16, std::uint32_t depth_size = 8) {
    const auto bytes = baked_directions_bytes(mesh, subdivision, map_size, depth_size);
    return Field::load(context, bytes.data(), bytes.size());
}

}  // namespace dfield::test
