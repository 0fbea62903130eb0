// Ambient occlusion settings with their tables. Immutable after creation.
#pragma once

#include <cmath>
#include <memory_resource>
#include <vector>

#include "context.hpp"

struct dfield_ao final : dfield::runtime::Shared<dfield_ao> {
    dfield_ao(dfield_context* context, const dfield_ao_desc& desc);

    // Occlusion of a hit at this distance, in [0, 1]: 1 - V, V being the paper's empirical function of
    // distance.
    float occlusion(float distance) const;

    // Weight of ray r in the integral.
    float weight(std::size_t r) const { return weights.empty() ? even_weight_ : weights[r]; }

    // Only whether a ray hits matters, not where.
    bool any_hit() const { return unbounded && falloff == DFIELD_FALLOFF_NONE; }

    std::size_t ray_count;
    dfield_falloff falloff;
    float max_distance;  // +infinity when unbounded
    bool unbounded;
    float bias;
    std::pmr::vector<float> x, y, z;     // directions around +z, one array an axis
    std::pmr::vector<float> weights;     // empty: even
    std::pmr::vector<float> directions;  // the same, interleaved, for the caller

  private:
    float even_weight_;
    float rate_, exponential_end_, exponential_scale_;
    std::pmr::vector<float> table_;
};
