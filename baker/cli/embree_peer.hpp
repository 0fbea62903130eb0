// Embree at its best for the rays of a comparison: any-hit queries over packets prepared beforehand, in every
// mode that might be fastest.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <vector>

#include "baker/embree_scene.hpp"

namespace dfield::cli {

struct PeerRay {
    glm::vec3 origin, direction;
};

struct EmbreeMode {
    int width;  // rays a packet: 1, 4, 8, 16
    bool coherent;
    std::string name() const;
};

// The modes that are measured. Coherent packets never return from some scenes of instances in Embree 3.13,
// and are slower wherever they do: they are left out there.
std::span<const EmbreeMode> embree_modes(bool instanced);

// Traces the rays `repetitions` times and returns the seconds of the fastest; preparing packets is not
// counted. occluded[i] = 1 where ray i hits anything.
double time_occluded(const EmbreeScene& scene, std::span<const PeerRay> rays, const EmbreeMode& mode,
                     int threads, int repetitions, std::vector<std::uint8_t>& occluded);

}  // namespace dfield::cli
