// From a receiver's mask of blocked rays to what callers want: visibility, bent normal, harmonics.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>

#include "ao.hpp"
#include "strided.hpp"

namespace dfield::runtime {

// Sums of weights, for c = weight or weight * max(0, n.w).
struct GatherWeights {
    float open, all;  // over the rays whose bit is 0, over all
};

// Sums over the rays whose bit is 0 of c times what the name says of w = (x, y, z).
struct GatherMoments {
    float one, x, y, z, xy, yz, zz, xz, xx_yy;
};

struct GatherKernels {
    void (*weigh)(const GatherRays& rays, const glm::vec3& normal, const std::uint32_t* mask,
                  GatherWeights& sums);
    void (*moments)(const GatherRays& rays, const glm::vec3& normal, const std::uint32_t* mask,
                    GatherMoments& sums);
};
GatherKernels gather_kernels(std::int64_t targets);  // dfield_context::simd_targets
extern const GatherKernels kGatherReference;

// Writes the outputs of receivers, one at a time.
class OutputWriter {
  public:
    // Throws where the struct is of no known size.
    OutputWriter(const dfield_ao& ao, const dfield_outputs& outputs);

    bool wants_visibility() const { return visibility_ || visibility8_; }
    bool wants_moments() const { return bent_normals_ || harmonics_; }
    const Strided<std::uint32_t>& masks() const { return masks_; }
    // Where visibility goes as floats and nothing else is wanted; otherwise null.
    Strided<float> visibility_alone() const {
        return visibility8_ || masks_ || wants_moments() ? Strided<float>(nullptr, 0, 1) : visibility_;
    }

    // Output i of a receiver. normal: unit, or zero for a receiver without a usable one. visibility: of the
    // receiver with its self-visibility. The mask goes to masks() only where it is not there already.
    void write(std::size_t i, const glm::vec3& normal, const std::uint32_t* mask, float visibility) const;

    // The same without mask, where only the visibility is wanted.
    void write_visibility(std::size_t i, float visibility) const;

  private:
    const dfield_ao& ao_;
    GatherKernels kernels_;
    Strided<float> visibility_;
    Strided<std::uint8_t> visibility8_;
    Strided<float> bent_normals_;
    Strided<std::uint32_t> masks_;
    Strided<float> harmonics_;
};

// Visibility from a mask, self-visibility apart. normal as above.
float mask_visibility(const GatherKernels& kernels, const dfield_ao& ao, const glm::vec3& normal,
                      const std::uint32_t* mask);

// dfield_ao_gather; its weights may be null.
void gather_visibility(const dfield_ao& ao, const dfield_receivers& receivers,
                       const Strided<const std::uint32_t>& masks, const float* weights,
                       const Strided<float>& visibility);

}  // namespace dfield::runtime
