#include "gather.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "format/frame.hpp"
#include "receivers.hpp"
#include "status.hpp"

namespace dfield::runtime {
namespace {

// A receiver without a normal sees everything; for the outputs that need one it looks up.
glm::vec3 usable_normal(const glm::vec3& normal) {
    return normal == glm::vec3(0) ? glm::vec3(0, 0, 1) : normal;
}

// Moments of directions in a frame, as moments of the same directions in the world: the first ones are a
// vector, the second ones a symmetric tensor.
GatherMoments to_world(const GatherMoments& local, const Frame& frame) {
    const glm::mat3 axes(frame.tangent, frame.bitangent, frame.normal);
    const float xx = 0.5f * (local.one - local.zz + local.xx_yy),
                yy = 0.5f * (local.one - local.zz - local.xx_yy);
    const glm::mat3 second(xx, local.xy, local.xz, local.xy, yy, local.yz, local.xz, local.yz, local.zz);
    const glm::vec3 first = axes * glm::vec3(local.x, local.y, local.z);
    const glm::mat3 world = axes * second * glm::transpose(axes);
    return {local.one,   first.x,     first.y,
            first.z,     world[0][1], world[1][2],
            world[2][2], world[0][2], world[0][0] - world[1][1]};
}

std::array<float, DFIELD_SH_COUNT> harmonics_of(const GatherMoments& m) {
    return {0.28209479f * m.one,
            0.48860251f * m.y,
            0.48860251f * m.z,
            0.48860251f * m.x,
            1.09254843f * m.xy,
            1.09254843f * m.yz,
            0.31539157f * (3 * m.zz - m.one),
            1.09254843f * m.xz,
            0.54627422f * m.xx_yy};
}

const dfield_outputs& checked(const dfield_outputs& outputs) {
    require(outputs.struct_size == sizeof(dfield_outputs),
            "outputs->struct_size is not sizeof(dfield_outputs)");
    return outputs;
}

}  // namespace

float mask_visibility(const GatherKernels& kernels, const dfield_ao& ao, const glm::vec3& normal,
                      const std::uint32_t* mask) {
    if (ao.even()) {
        int blocked = 0;
        for (std::size_t word = 0; word < ao.mask_words(); ++word) blocked += std::popcount(mask[word]);
        return std::max(1 - static_cast<float>(blocked) * ao.weight(0), 0.0f);
    }
    GatherWeights sums;
    kernels.weigh(ao.gather_rays(), usable_normal(normal), mask, sums);
    const float blocked = sums.all - sums.open;
    if (!(blocked > 0)) return 1;
    // As batch_visibility does.
    const float whole = ao.shared.empty() ? sums.all : ao.shared.total(usable_normal(normal));
    return std::clamp(1 - blocked / whole, 0.0f, 1.0f);
}

void gather_visibility(const dfield_ao& ao, const dfield_receivers& receivers,
                       const Strided<const std::uint32_t>& masks, const float* weights,
                       const Strided<float>& visibility) {
    constexpr std::size_t kReceivers = 256, kWords = 32;  // at a time
    const GatherKernels kernels = gather_kernels(ao.context()->simd_targets);
    const Strided<const float> normals(receivers.normals, receivers.normal_stride, 3);
    const GatherRays rays = ao.gather_rays();
    std::array<GatherWeights, kReceivers> totals;
    std::array<float, 32 * kWords> products;
    for (std::size_t first = 0; first < receivers.count; first += kReceivers) {
        const std::size_t count = std::min(kReceivers, receivers.count - first);
        totals.fill({0, 0});
        for (std::size_t word = 0; word < rays.words; word += kWords) {
            GatherRays part{rays.x + 32 * word,
                            rays.y + 32 * word,
                            rays.z + 32 * word,
                            rays.weight + 32 * word,
                            std::min(kWords, rays.words - word),
                            rays.cosine};
            if (weights) {
                for (std::size_t k = 0; k < 32 * part.words; ++k) {
                    const std::size_t r = 32 * word + k;
                    products[k] = r < ao.ray_count ? rays.weight[r] * weights[r] : 0;
                }
                part.weight = products.data();
            }
            for (std::size_t k = 0; k < count; ++k) {
                const glm::vec3 normal = unit_receiver({}, normals.vec3(first + k), 0).normal;
                GatherWeights sums;
                kernels.weigh(part, usable_normal(normal), masks.at(first + k) + word, sums);
                totals[k].open += sums.open;
                totals[k].all += sums.all;
            }
        }
        for (std::size_t k = 0; k < count; ++k)
            *visibility.at(first + k) = totals[k].all > 0 ? totals[k].open / totals[k].all : 1;
    }
}

OutputWriter::OutputWriter(const dfield_ao& ao, const dfield_outputs& outputs)
    : ao_(ao),
      kernels_(gather_kernels(ao.context()->simd_targets)),
      visibility_(checked(outputs).visibility, outputs.visibility_stride, 1),
      visibility8_(outputs.visibility8, outputs.visibility8_stride, 1),
      bent_normals_(outputs.bent_normals, outputs.bent_normal_stride, 3),
      masks_(outputs.masks, outputs.mask_stride, ao.mask_words()),
      harmonics_(outputs.harmonics, outputs.harmonics_stride, DFIELD_SH_COUNT) {}

void OutputWriter::write_visibility(std::size_t i, float visibility) const {
    if (visibility_) *visibility_.at(i) = visibility;
    if (visibility8_)
        *visibility8_.at(i) = static_cast<std::uint8_t>(std::clamp(visibility, 0.0f, 1.0f) * 255 + 0.5f);
}

void OutputWriter::write(std::size_t i, const glm::vec3& given_normal, const std::uint32_t* mask,
                         float visibility) const {
    write_visibility(i, visibility);
    if (masks_ && masks_.at(i) != mask) std::copy_n(mask, ao_.mask_words(), masks_.at(i));
    if (!wants_moments()) return;
    const glm::vec3 normal = usable_normal(given_normal);
    const GatherRays rays = ao_.gather_rays();
    GatherMoments moments;
    kernels_.moments(rays, normal, mask, moments);
    float all = 1;  // weights around the normal sum to 1
    if (rays.cosine) {
        GatherWeights sums;
        kernels_.weigh(rays, normal, mask, sums);
        all = sums.all;
    } else {
        moments = to_world(moments, frame_of_normal(normal));
    }
    if (bent_normals_) {
        const glm::vec3 bent(moments.x, moments.y, moments.z);
        const float length = glm::length(bent);
        const glm::vec3 unit = length > 1e-6f * all ? bent / length : normal;
        std::copy_n(&unit.x, 3, bent_normals_.at(i));
    }
    if (harmonics_) {
        const std::array<float, DFIELD_SH_COUNT> coefficients = harmonics_of(moments);
        const float scale = all > 0 ? 1 / all : 0;
        std::transform(coefficients.begin(), coefficients.end(), harmonics_.at(i),
                       [&](float value) { return value * scale; });
    }
}

}  // namespace dfield::runtime
