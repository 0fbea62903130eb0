#include "kind.hpp"

#include <array>

#include "status.hpp"

namespace dfield::runtime {
namespace {

// Best first.
using Preference = std::array<dfield_kind, 4>;

Preference preference(const dfield_ao& ao) {
    constexpr dfield_kind kMaps = DFIELD_KIND_MAPS, kLines = DFIELD_KIND_LINES,
                          kShared = DFIELD_KIND_DIRECTIONS, kVolume = DFIELD_KIND_VOLUME;
    if (ao.sampling == DFIELD_SAMPLING_SHARED) return {kShared, kLines, kMaps, kVolume};
    // Direction maps know the directions that they were baked for: too few for one receiver's own rays.
    if (ao.any_hit()) return {kLines, kMaps, kVolume, kVolume};
    return {kMaps, kLines, kVolume, kVolume};
}

// Occlusion volumes know neither rays nor distances.
bool is_question_for(const dfield_ao& ao, dfield_kind kind) {
    return kind != DFIELD_KIND_VOLUME || (ao.any_hit() && ao.bias == 0);
}

bool has_distances(const dfield_field& field, dfield_kind kind) {
    switch (kind) {
        case DFIELD_KIND_LINES:
            return field.maps.lines->parameters.depth_bits != 0;
        case DFIELD_KIND_DIRECTIONS:
            return field.maps.directions.back().parameters.depth_size != 0;
        default:
            return true;
    }
}

}  // namespace

bool has_kind(const dfield_field& field, dfield_kind kind) {
    switch (kind) {
        case DFIELD_KIND_MAPS:
            return has_maps(field.maps.parameters);
        case DFIELD_KIND_LINES:
            return field.maps.lines.has_value();
        case DFIELD_KIND_DIRECTIONS:
            return !field.maps.directions.empty();
        case DFIELD_KIND_VOLUME:
            return field.maps.volume.has_value();
        default:
            return false;
    }
}

dfield_kind kind_for(const dfield_ao& ao, const dfield_field& field) {
    // First with distances where they count, then any.
    for (const bool distances : {true, false})
        for (const dfield_kind kind : preference(ao)) {
            if ((ao.kind != DFIELD_KIND_AUTO && kind != ao.kind) || !is_question_for(ao, kind)) continue;
            if (has_kind(field, kind) && (!distances || ao.any_hit() || has_distances(field, kind)))
                return kind;
        }
    return DFIELD_KIND_AUTO;
}

void require_kinds(const dfield_ao& ao, const SceneState& scene, bool rays) {
    const dfield_field* last = nullptr;
    bool directions = false, others = false;
    for (const dfield_instance id : scene.active) {
        const dfield_field* field = scene.instances[id].field;
        if (field == last) continue;
        last = field;
        const dfield_kind kind = kind_for(ao, *field);
        require(kind != DFIELD_KIND_AUTO,
                "an instance's field holds nothing that answers this query: bake it with the kind that is "
                "forced, use DFIELD_SAMPLING_SHARED for fields with direction maps alone, and no "
                "max_distance, falloff or bias for fields with an occlusion volume alone");
        require(
            kind != DFIELD_KIND_VOLUME || !rays,
            "an instance's field answers by its occlusion volume, which knows no single rays: masks, bent "
            "normals and harmonics want displacement maps, a line table or direction maps");
        if (kind != DFIELD_KIND_VOLUME) (kind == DFIELD_KIND_DIRECTIONS ? directions : others) = true;
    }
    require(ao.any_hit() || !directions || !others,
            "with a max_distance or falloff, shared sampling cannot mix fields with and without direction "
            "maps (of "
            "those with depths): force a kind that all fields of the scene have");
}

}  // namespace dfield::runtime

extern "C" dfield_status dfield_ao_get_kind(const dfield_ao* ao, const dfield_field* field,
                                            dfield_kind* kind) {
    using namespace dfield::runtime;
    return guarded([&] {
        require(ao && field && kind, "dfield_ao_get_kind: ao, field or kind is null");
        const dfield_kind found = kind_for(*ao, *field);
        require(found != DFIELD_KIND_AUTO, "dfield_ao_get_kind: the field has no kind that can answer");
        *kind = found;
    });
}
