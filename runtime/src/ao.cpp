#include "ao.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>

#include "desc.hpp"
#include "format/frame.hpp"
#include "format/hemisphere_map.hpp"
#include "status.hpp"

dfield_ao::dfield_ao(dfield_context* context, const dfield_ao_desc& desc)
    : Shared(context),
      ray_count(desc.ray_count),
      sampling(static_cast<dfield_sampling>(desc.sampling)),
      kind(static_cast<dfield_kind>(desc.kind)),
      falloff(static_cast<dfield_falloff>(desc.falloff)),
      max_distance(desc.max_distance),
      unbounded(desc.max_distance == std::numeric_limits<float>::infinity()),
      bias(desc.bias),
      level_error(desc.level_error),
      x(context),
      y(context),
      z(context),
      weights(context),
      gather_weights(context),
      directions(context),
      groups(context),
      shared(context),
      even_weight_(1 / static_cast<float>(desc.ray_count)),
      rate_(desc.falloff_rate),
      exponential_end_(std::exp(-desc.falloff_rate)),
      exponential_scale_(1 / (1 - exponential_end_)),
      table_(context) {
    if (desc.directions) {
        directions.assign(desc.directions, desc.directions + 3 * ray_count);
        if (desc.weights) weights.assign(desc.weights, desc.weights + ray_count);
    } else {
        for (const glm::vec3& w : sampling == DFIELD_SAMPLING_SHARED
                                      ? dfield::fibonacci_sphere(desc.ray_count)
                                      : dfield::cosine_directions(desc.ray_count))
            directions.insert(directions.end(), {w.x, w.y, w.z});
    }
    for (std::size_t r = 0; r < ray_count; ++r) {
        x.push_back(directions[3 * r]);
        y.push_back(directions[3 * r + 1]);
        z.push_back(directions[3 * r + 2]);
    }
    std::vector<glm::vec3> all;
    for (std::size_t r = 0; r < ray_count; ++r) all.emplace_back(x[r], y[r], z[r]);
    if (sampling == DFIELD_SAMPLING_SHARED) shared.build(all, weights);
    groups.build(all, weights, even_weight_);
    // Whole mask words, so that sums over a mask need no remainder.
    for (std::pmr::vector<float>* axis : {&x, &y, &z}) axis->resize(32 * mask_words(), 0);
    gather_weights.resize(32 * mask_words(), 0);
    for (std::size_t r = 0; r < ray_count; ++r)
        gather_weights[r] = sampling == DFIELD_SAMPLING_SHARED && weights.empty() ? 1 : weight(r);
    if (falloff == DFIELD_FALLOFF_TABLE)
        table_.assign(desc.falloff_table, desc.falloff_table + desc.falloff_table_size);
}

float dfield_ao::occlusion(float distance) const {
    if (!(distance < max_distance))
        return unbounded && distance < std::numeric_limits<float>::infinity() ? 1 : 0;
    const float u = std::max(distance, 0.0f) / max_distance;
    switch (falloff) {
        case DFIELD_FALLOFF_LINEAR:
            return 1 - u;
        case DFIELD_FALLOFF_SMOOTH:
            return 1 - u * u * (3 - 2 * u);
        case DFIELD_FALLOFF_EXPONENTIAL:
            return (std::exp(-rate_ * u) - exponential_end_) * exponential_scale_;
        case DFIELD_FALLOFF_TABLE: {
            const float position = u * static_cast<float>(table_.size() - 1);
            const std::size_t i = std::min(static_cast<std::size_t>(position), table_.size() - 2);
            const float rest = position - static_cast<float>(i);
            return 1 - (table_[i] + (table_[i + 1] - table_[i]) * rest);
        }
        default:
            return 1;
    }
}

namespace {

using dfield::runtime::require;

// Directions and weights as the header asks for, to the accuracy of floats.
void require_directions(const dfield_ao_desc& desc) {
    const bool shared = desc.sampling == DFIELD_SAMPLING_SHARED;
    double sum = 0;
    for (std::size_t r = 0; r < desc.ray_count; ++r) {
        const float* w = desc.directions + 3 * r;
        const float square = w[0] * w[0] + w[1] * w[1] + w[2] * w[2];
        require(std::fabs(square - 1) < 1e-3f && (shared || w[2] >= 0),
                "dfield_ao_create: a direction is not unit or lies below the horizon (z < 0)");
        if (!desc.weights) continue;
        require(desc.weights[r] >= 0 && (shared ? desc.weights[r] <= 1e6f : desc.weights[r] <= 1.001f),
                "dfield_ao_create: a weight is outside 0..1 (shared sampling: 0..1e6)");
        sum += desc.weights[r];
    }
    require(!desc.weights || shared || std::fabs(sum - 1) < 1e-3,
            "dfield_ao_create: the weights do not sum to 1");
}

}  // namespace

extern "C" {

void dfield_ao_desc_init(dfield_ao_desc* desc) {
    if (!desc) return;
    *desc = {};
    desc->struct_size = sizeof(dfield_ao_desc);
    desc->ray_count = 256;
    desc->falloff = DFIELD_FALLOFF_NONE;
    desc->max_distance = std::numeric_limits<float>::infinity();
    desc->falloff_rate = 3;
}

dfield_status dfield_ao_create(dfield_context* context, const dfield_ao_desc* given, dfield_ao** ao) {
    return dfield::runtime::guarded([&] {
        require(context && given && ao, "dfield_ao_create: context, desc or ao is null");
        // Version 0.1 ended before `sampling`, where 64-bit machines had four bytes of padding.
        constexpr std::size_t kUsed01 = offsetof(dfield_ao_desc, sampling), kAlign = alignof(dfield_ao_desc);
        const dfield_ao_desc copy = dfield::runtime::read_desc(
            given, {{(kUsed01 + kAlign - 1) / kAlign * kAlign, kUsed01}},
            "dfield_ao_create: desc->struct_size is of no known version; call dfield_ao_desc_init first");
        const dfield_ao_desc* const desc = &copy;
        require(desc->sampling <= DFIELD_SAMPLING_SHARED, "dfield_ao_create: unknown sampling");
        require(desc->kind <= DFIELD_KIND_VOLUME, "dfield_ao_create: unknown kind");
        require(desc->sampling == DFIELD_SAMPLING_HEMISPHERE || desc->ray_count <= DFIELD_MAX_SHARED_RAYS,
                "dfield_ao_create: shared sampling takes at most DFIELD_MAX_SHARED_RAYS rays");
        require(desc->ray_count >= 1 && desc->ray_count <= 65536,
                "dfield_ao_create: ray_count is outside 1..65536");
        require(desc->falloff <= DFIELD_FALLOFF_TABLE, "dfield_ao_create: unknown falloff");
        require(desc->max_distance > 0,
                "dfield_ao_create: max_distance must be above 0 (INFINITY for unbounded)");
        require(desc->falloff == DFIELD_FALLOFF_NONE || std::isfinite(desc->max_distance),
                "dfield_ao_create: a falloff needs a finite max_distance");
        require(desc->level_error >= 0 && desc->level_error <= 1,
                "dfield_ao_create: level_error is outside 0..1");
        require(desc->bias >= 0 && std::isfinite(desc->bias), "dfield_ao_create: bias must be 0 or above");
        if (desc->falloff == DFIELD_FALLOFF_EXPONENTIAL)
            require(desc->falloff_rate >= 1e-3f && desc->falloff_rate <= 80,
                    "dfield_ao_create: falloff_rate is outside 0.001..80");
        if (desc->falloff == DFIELD_FALLOFF_TABLE) {
            require(desc->falloff_table && desc->falloff_table_size >= 2 && desc->falloff_table_size <= 65536,
                    "dfield_ao_create: the falloff table needs 2..65536 entries");
            require(std::all_of(desc->falloff_table, desc->falloff_table + desc->falloff_table_size,
                                [](float v) { return v >= 0 && v <= 1; }),
                    "dfield_ao_create: the falloff table holds a value outside 0..1");
        }
        if (desc->directions) require_directions(*desc);
        require(desc->directions || !desc->weights, "dfield_ao_create: weights need directions");
        *ao = dfield_ao::make(context, *desc);
    });
}

void dfield_ao_release(dfield_ao* ao) {
    if (ao) ao->release();
}

const float* dfield_ao_get_directions(const dfield_ao* ao) {
    return ao ? ao->directions.data() : nullptr;
}

size_t dfield_ao_get_mask_words(const dfield_ao* ao) {
    return ao ? ao->mask_words() : 0;
}

float dfield_ao_get_occlusion(const dfield_ao* ao, float distance) {
    return ao ? ao->occlusion(distance) : 0;
}

void dfield_frame(const float normal[3], float tangent[3], float bitangent[3]) {
    const dfield::Frame frame = dfield::frame_of_normal({normal[0], normal[1], normal[2]});
    for (int axis = 0; axis < 3; ++axis) {
        tangent[axis] = frame.tangent[axis];
        bitangent[axis] = frame.bitangent[axis];
    }
}
}
