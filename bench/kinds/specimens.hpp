// The sizes of each kind that are measured.
#pragma once

#include <string>
#include <vector>

#include "baker/plan.hpp"
#include "bench/paper/lab.hpp"

namespace dfield::kinds {

struct Specimen {
    std::string kind, size;
    FieldPlan plan;
    dfield_kind forced;
    bool headline;

    bool shared() const { return forced == DFIELD_KIND_DIRECTIONS; }
};

// Smaller ones where the lab is quick. `sweep`: also those that only plots show.
std::vector<Specimen> specimens(const paper::Lab& lab, bool sweep);

// Direction maps of (4 n^2 + 2) directions with m x m texels.
Specimen direction_specimen(const paper::Lab& lab, std::uint32_t n, std::uint32_t m);

// The bytes of a .dfield, baked on all cores.
std::vector<std::byte> baked_specimen(const TriangleMesh& mesh, const Specimen& specimen);

}  // namespace dfield::kinds
