#include "bench/kinds/specimens.hpp"

#include <algorithm>
#include <array>

#include "bench/common/page.hpp"
#include "format/writer.hpp"

namespace dfield::kinds {
namespace {

constexpr std::uint32_t kQuickDivisor = 4;

Specimen maps(const paper::Lab& lab, std::uint32_t subdivision, std::uint32_t map_size, std::uint32_t bits,
              bool headline) {
    const FieldParameters parameters = lab.parameters(subdivision, map_size, bits);
    FieldPlan plan;
    plan.maps = parameters;
    return {
        "displacement maps, " + std::to_string(bits) + " bit",
        bench::grouped(paper_position_count(parameters)) + " × " + std::to_string(parameters.map_size) + "²",
        plan, DFIELD_KIND_MAPS, headline};
}

enum class LineSpace { kSphere, kEllipsoid, kEllipsoidPivot };

Specimen lines(const paper::Lab& lab, std::uint32_t lattice, LineSpace space, bool headline) {
    constexpr std::array kNames{"line table", "line table, ellipsoid", "line table, pivot, ellipsoid"};
    LineParameters parameters;
    parameters.lattice = lab.quick() ? lattice / kQuickDivisor : lattice;
    parameters.ellipsoid = space != LineSpace::kSphere;
    parameters.pivot = space == LineSpace::kEllipsoidPivot;
    FieldPlan plan;
    plan.lines = parameters;
    return {kNames[static_cast<std::size_t>(space)],
            bench::grouped(lattice_point_count(parameters.lattice)) + "²", plan, DFIELD_KIND_LINES, headline};
}

Specimen directions(const paper::Lab& lab, std::uint32_t subdivision, std::uint32_t map_size, bool headline) {
    DirectionParameters parameters;
    parameters.subdivision = lab.quick() ? subdivision / kQuickDivisor : subdivision;
    parameters.map_size = map_size;
    FieldPlan plan;
    plan.directions = {parameters};
    return {"direction maps",
            bench::grouped(direction_count(parameters.subdivision)) + " × " + std::to_string(map_size) + "²",
            plan, DFIELD_KIND_DIRECTIONS, headline};
}

Specimen volume(const paper::Lab& lab, std::uint32_t full, bool headline) {
    const std::uint32_t size = lab.quick() ? full / 2 : full;
    FieldPlan plan;
    plan.volume = VolumeParameters{size};
    return {"occlusion volume", std::to_string(size) + "³", plan, DFIELD_KIND_VOLUME, headline};
}

}  // namespace

Specimen direction_specimen(const paper::Lab& lab, std::uint32_t n, std::uint32_t m) {
    return directions(lab, n, m, false);
}

std::vector<Specimen> specimens(const paper::Lab& lab, bool sweep) {
    std::vector<Specimen> result{maps(lab, 32, 32, 8, true),
                                 maps(lab, 32, 32, 1, true),
                                 lines(lab, 33, LineSpace::kSphere, true),
                                 lines(lab, 24, LineSpace::kEllipsoid, true),
                                 lines(lab, 33, LineSpace::kEllipsoidPivot, true),
                                 directions(lab, 16, 32, true),
                                 directions(lab, 16, 64, true),
                                 volume(lab, 32, true),
                                 volume(lab, 48, true)};
    if (!sweep) return result;
    for (const auto& [n, m] : {std::pair{8u, 16u}, {16u, 16u}, {16u, 32u}, {32u, 64u}})
        for (const std::uint32_t bits : {8u, 1u})
            if (bits == 1 || m < 64) result.push_back(maps(lab, n, m, bits, false));
    for (const LineSpace space : {LineSpace::kSphere, LineSpace::kEllipsoidPivot})
        for (const std::uint32_t lattice : {16u, 24u, 45u})
            result.push_back(lines(lab, lattice, space, false));
    for (const auto& [n, m] : {std::pair{8u, 32u}, {24u, 32u}, {32u, 32u}, {8u, 64u}, {24u, 64u}, {32u, 64u}})
        result.push_back(directions(lab, n, m, false));
    for (const std::uint32_t size : {24u, 64u}) result.push_back(volume(lab, size, false));
    return result;
}

std::vector<std::byte> baked_specimen(const TriangleMesh& mesh, const Specimen& specimen) {
    return write_field(bake_plan(mesh, specimen.plan, {}));
}

}  // namespace dfield::kinds
