// Ambient occlusion settings with their tables. Immutable after creation.
#pragma once

#include <cmath>
#include <memory_resource>
#include <vector>

#include "batch/shared_directions.hpp"
#include "context.hpp"
#include "rays/ray_groups.hpp"

namespace dfield::runtime {

// Directions and weights of rays, 32 a mask word; rays that fill the last word have weight 0.
struct GatherRays {
    const float *x, *y, *z, *weight;
    std::size_t words;
    bool cosine;  // weights are to be multiplied by max(0, n.w)
};

}  // namespace dfield::runtime

struct dfield_ao final : dfield::runtime::Shared<dfield_ao> {
    dfield_ao(dfield_context* context, const dfield_ao_desc& desc);

    // Occlusion of a hit at this distance, in [0, 1]: 1 - V, V being the paper's empirical function of
    // distance.
    float occlusion(float distance) const;

    // Weight of ray r in the integral.
    float weight(std::size_t r) const { return weights.empty() ? even_weight_ : weights[r]; }

    // The weight of every ray is weight(0), whatever the receiver.
    bool even() const { return sampling == DFIELD_SAMPLING_HEMISPHERE && weights.empty(); }

    std::size_t mask_words() const { return (ray_count + 31) / 32; }

    // Only whether a ray hits matters, not where.
    bool any_hit() const { return unbounded && falloff == DFIELD_FALLOFF_NONE; }

    std::size_t ray_count;
    dfield_sampling sampling;
    dfield_kind kind;  // that queries are forced to, or DFIELD_KIND_AUTO
    dfield_falloff falloff;
    float max_distance;  // +infinity when unbounded
    bool unbounded;
    float bias;
    float level_error;
    dfield::runtime::GatherRays gather_rays() const {
        return {x.data(),     y.data(),
                z.data(),     gather_weights.data(),
                mask_words(), sampling == DFIELD_SAMPLING_SHARED};
    }
    std::pmr::vector<float> x, y, z;  // directions, one array an axis: around +z, or world
    std::pmr::vector<float> weights;  // empty: even
    std::pmr::vector<float>
        gather_weights;  // of all rays, 0 for those that fill the last mask word; x, y, z alike
    std::pmr::vector<float> directions;        // the same, interleaved, for the caller
    dfield::runtime::RayGroups groups;         // the same for lookups ray by ray
    dfield::runtime::SharedDirections shared;  // the same for batches; empty unless sampling is shared

  private:
    float even_weight_;
    float rate_, exponential_end_, exponential_scale_;
    std::pmr::vector<float> table_;
};
