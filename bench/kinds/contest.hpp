// Contestants of the measurements: a field's instances through the C ABI, and Embree. They take turns, and
// the fastest turn of each counts.
#pragma once

#include <cstddef>
#include <glm/mat4x4.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "baker/cli/embree_peer.hpp"
#include "baker/embree_scene.hpp"
#include "bench/paper/lab.hpp"

namespace dfield::kinds {

inline constexpr std::uint32_t kSharedDirections = 512;
inline constexpr std::size_t kReceiversAPart = 128;

// Pairs of a receiver and a direction that both sides answer: 256 cosine-weighted directions around each
// normal, or the shared directions above the receiver's plane.
struct Pairs {
    dfield_sampling sampling = DFIELD_SAMPLING_HEMISPHERE;
    std::vector<glm::vec3> directions;

    // Rays of receivers [begin, end) in their order.
    std::vector<cli::PeerRay> rays(const paper::Receivers& receivers, std::size_t begin,
                                   std::size_t end) const;
    // Settings of the lookup. `kind` as in dfield_ao_desc.
    dfield_ao_desc desc(dfield_kind kind) const;
    // Visibility from what rays() of these receivers hit.
    void gather(const paper::Receivers& receivers, std::size_t begin, std::size_t end,
                std::span<const std::uint8_t> occluded, std::vector<float>& visibility) const;
};
Pairs hemisphere_pairs(const paper::Lab& lab);
Pairs shared_pairs(const paper::Lab& lab);

// Embree on all pairs of receivers and a scene: any-hit queries over packets prepared beforehand. Receivers
// come in parts of about a millisecond, and the fastest turn of each part counts: what takes long must not
// lose to what is short because other programs run in between.
class EmbreeContest {
  public:
    // All kept by the caller. `instanced` as in cli::embree_modes.
    EmbreeContest(const EmbreeScene& scene, const paper::Receivers& receivers, const Pairs& pairs,
                  bool instanced);

    // One turn of every mode that is still in the running: those far behind after the first do not come back.
    // With many receivers the mode is settled on some of them beforehand.
    void turn();

    double seconds() const { return seconds_; }
    const std::string& mode() const { return mode_; }
    std::size_t rays() const { return rays_; }
    // By incoherent packets of sixteen, whichever mode was fastest: along edges modes differ in a few rays.
    const std::vector<float>& visibility() const { return visibility_; }

  private:
    struct Mode {
        cli::EmbreeMode mode;
        std::vector<double> parts;  // the fastest seconds of each
        double seconds() const;
    };
    // One turn of every `step`-th part.
    void time_parts(Mode& mode, std::size_t step, std::vector<float>* visibility = nullptr);

    const EmbreeScene& scene_;
    const paper::Receivers& receivers_;
    const Pairs& pairs_;
    std::vector<Mode> modes_;
    double seconds_;
    std::string mode_;
    std::size_t rays_ = 0;
    std::vector<float> visibility_;
};

// A context of one thread with the instruction set capped.
Context capped_context(dfield_simd cap);
const char* simd_name(dfield_simd simd);

}  // namespace dfield::kinds
