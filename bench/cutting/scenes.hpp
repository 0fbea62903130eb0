// The paper's three scenes in kind: volumes of its sizes, transfer functions of one colour, meshes that clip.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "baker/mesh.hpp"
#include "baker/volume/transfer_function.hpp"
#include "bench/volume/chapter.hpp"

namespace dfield::cutting {

using cli::Json;
using cli::text;
using volumes::Lab;

// A mesh around its origin, and where in the volume it is.
struct Cutter {
    TriangleMesh mesh{};
    glm::dvec3 centre{0};  // voxels
    double scale = 1;      // voxels
    double degrees = 0;    // turned around (1, 1, 1)
};

struct Scene {
    std::string name, made_of{}, transfer_file{}, cutter_name{};
    Volume volume;  // spacing 1
    TransferFunction transfer;
    std::uint32_t samples = 20;  // M
    Cutter first{}, second{};    // the second one overlaps the first
    // Voxels that the paper's mask has computed anew, per cent: the paper's share, and the scene's own.
    double asked_dilated = 0, dilated = 0;
    glm::vec3 to_eye{0.6f, -1, 0.45f};
};

inline constexpr std::array kSceneNames{"engine", "beetle", "skeleton"};
// Nothing where its scan is missing; with --quick a small cloud of our own. The first cutter is as large as
// dilates the paper's share.
std::optional<Scene> make_scene(Lab& lab, const std::string& name);
// A volume as it is, at spacing 1, without cutters.
Scene plain_scene(const Lab& lab, const std::string& name, const std::string& transfer, const Volume& volume,
                  std::uint32_t samples);
// How often a scene's calls are timed: the less they take, the more often.
int rounds_of(const Lab& lab, const Scene& scene);
// A box of a volume, trilinear, at another size: bytes of bytes, floats of all other types.
Volume resampled(const Volume& from, const std::array<std::size_t, 3>& low,
                 const std::array<std::size_t, 3>& size, const std::array<std::size_t, 3>& to);
TransferFunction transfer_function(const Lab& lab, const std::string& name);

}  // namespace dfield::cutting
