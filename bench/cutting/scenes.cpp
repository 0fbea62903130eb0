#include "bench/cutting/scenes.hpp"

#include <algorithm>
#include <cmath>

#include "bench/cutting/shapes.hpp"
#include "bench/cutting/stage.hpp"

namespace dfield::cutting {
namespace {

using Size = std::array<std::size_t, 3>;

struct Recipe {
    const char *name, *scan, *transfer, *made_of, *cutter_name;
    Size low, crop, size;
    std::uint32_t samples;
    double dilated;
    glm::dvec3 first, second;  // where the cutters are, as shares of the volume
    double degrees;
    glm::vec3 to_eye;
};

const std::array kRecipes{
    Recipe{.name = "engine",
           .scan = "engine",
           .transfer = "engine",
           .made_of = "the engine's first 110 slices of 128, as scanned",
           .cutter_name = "sphere",
           .low = {0, 0, 0},
           .crop = {256, 256, 110},
           .size = {256, 256, 110},
           .samples = 20,
           .dilated = 14.94,
           .first = {0.55, 0.28, 0.6},
           .second = {0.75, 0.5, 0.75},
           .degrees = 0,
           .to_eye = {0.35f, -1, 0.75f}},
    Recipe{.name = "beetle",
           .scan = "bonsai",
           .transfer = "bonsai",
           .made_of = "256 x 256 x 152 voxels of the bonsai, resampled",
           .cutter_name = "cube",
           .low = {0, 0, 60},
           .crop = {256, 256, 152},
           .size = {416, 416, 247},
           .samples = 40,
           .dilated = 20.24,
           .first = {0.5, 0.3, 0.6},
           .second = {0.68, 0.45, 0.8},
           .degrees = 25,
           .to_eye = {0.3f, -1, 0.4f}},
    Recipe{.name = "skeleton",
           .scan = "bonsai",
           .transfer = "bonsai",
           .made_of = "the bonsai of 256 x 256 x 256 voxels, resampled",
           .cutter_name = "prism",
           .low = {0, 0, 0},
           .crop = {256, 256, 256},
           .size = {512, 512, 512},
           .samples = 50,
           .dilated = 16.13,
           .first = {0.5, 0.35, 0.55},
           .second = {0.65, 0.45, 0.7},
           .degrees = 15,
           .to_eye = {0.3f, -1, 0.35f}},
};

TriangleMesh cutter_mesh(const std::string& name) {
    if (name == "sphere") return unit_sphere();
    if (name == "cube") return prism(1, 1);
    return prism(0.6, 0.8);
}

Volume cloud(const Size& size) {
    const models::Dims dims{static_cast<std::uint32_t>(size[0]), static_cast<std::uint32_t>(size[1]),
                            static_cast<std::uint32_t>(size[2])};
    return volumes::as_bytes("cloud", models::clouds_volume(dims, 1), 12).volume;
}

}  // namespace

Volume resampled(const Volume& from, const Size& low, const Size& size, const Size& to) {
    const std::vector<float> values = float_values(from);
    struct Place {
        std::size_t at, next;
        float fraction;
    };
    std::array<std::vector<Place>, 3> places;
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (std::size_t i = 0; i < to[axis]; ++i) {
            const double at = static_cast<double>(i) * static_cast<double>(size[axis] - 1) /
                              static_cast<double>(to[axis] - 1);
            const auto whole = std::min(static_cast<std::size_t>(at), size[axis] - 1);
            places[axis].push_back({low[axis] + whole, low[axis] + std::min(whole + 1, size[axis] - 1),
                                    static_cast<float>(at - std::floor(at))});
        }
    VolumeGrid grid;
    grid.size = to;
    Volume result{grid, from.type == VoxelType::kU8 ? VoxelType::kU8 : VoxelType::kF32, {}};
    result.data.resize(result.grid.voxels() * size_of(result.type));
    const auto fill = [&](auto* out, float rounding) {
        const auto row = [&](std::size_t y, std::size_t z) {
            return values.data() + from.grid.size[0] * (y + from.grid.size[1] * z);
        };
        for (const Place& z : places[2])
            for (const Place& y : places[1]) {
                const float* const rows[] = {row(y.at, z.at), row(y.next, z.at), row(y.at, z.next),
                                             row(y.next, z.next)};
                for (const Place& x : places[0]) {
                    float along[4];
                    for (int r = 0; r < 4; ++r)
                        along[r] = std::lerp(rows[r][x.at], rows[r][x.next], x.fraction);
                    const float value = std::lerp(std::lerp(along[0], along[1], y.fraction),
                                                  std::lerp(along[2], along[3], y.fraction), z.fraction);
                    *out++ = static_cast<std::remove_pointer_t<decltype(out)>>(value + rounding);
                }
            }
    };
    if (result.type == VoxelType::kU8)
        fill(result.voxels<std::uint8_t>().data(), 0.5f);
    else
        fill(result.voxels<float>().data(), 0.0f);
    return result;
}

int rounds_of(const Lab& lab, const Scene& scene) {
    constexpr double kVoxels = 4e7;
    return lab.stock.rounds(3 + static_cast<int>(kVoxels / static_cast<double>(scene.volume.grid.voxels())));
}

TransferFunction transfer_function(const Lab& lab, const std::string& name) {
    return read_transfer_function(lab.models / "transfer_functions" / (name + ".json"));
}

Scene plain_scene(const Lab& lab, const std::string& name, const std::string& transfer, const Volume& volume,
                  std::uint32_t samples) {
    Scene scene{.name = name,
                .transfer_file = transfer + ".json",
                .volume = volume,
                .transfer = transfer_function(lab, transfer),
                .samples = samples};
    scene.volume.grid = VolumeGrid();
    scene.volume.grid.size = volume.grid.size;
    return scene;
}

std::optional<Scene> make_scene(Lab& lab, const std::string& name) {
    const Recipe& recipe = *std::ranges::find_if(kRecipes, [&](const Recipe& r) { return name == r.name; });
    const volumes::Subject* scan = lab.stock.shared(recipe.scan);
    if (!scan && !lab.stock.quick()) return std::nullopt;
    Size size = recipe.size;
    for (std::size_t& n : size) n = lab.stock.size(static_cast<std::uint32_t>(n));
    Scene scene{.name = name,
                .made_of = scan ? recipe.made_of : "a small cloud",
                .transfer_file = std::string(recipe.transfer) + ".json",
                .cutter_name = recipe.cutter_name,
                .volume = scan ? resampled(scan->volume, recipe.low, recipe.crop, size) : cloud(size),
                .transfer = transfer_function(lab, recipe.transfer),
                .samples = lab.stock.quick() ? recipe.samples / 8 + 1 : recipe.samples,
                .first = {.mesh = cutter_mesh(recipe.cutter_name), .degrees = recipe.degrees},
                .second = {.mesh = unit_sphere()},
                .asked_dilated = recipe.dilated,
                .to_eye = recipe.to_eye};
    const glm::dvec3 extent(static_cast<double>(size[0]), static_cast<double>(size[1]),
                            static_cast<double>(size[2]));
    scene.first.centre = recipe.first * extent;
    scene.second.centre = recipe.second * extent;
    fit_cutter(scene);
    scene.second.scale = 0.5 * scene.first.scale;
    return scene;
}

}  // namespace dfield::cutting
