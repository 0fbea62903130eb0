// A box moves through a volume and cuts it, frame by frame, as in a viewer: every frame has some milliseconds
// for ambient occlusion, is refined until it is final, and takes over the changed box of voxels alone. Writes
// a sequence of pictures.
//
//     cut_volume out/frame- 24
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <dfield/dfield.hpp>
#include <dfield/threads.hpp>
#include <exception>
#include <string>
#include <vector>

#include "picture.hpp"

namespace {

constexpr std::uint32_t kSize = 128;  // voxels along a side
constexpr double kSecondsPerUpdate = 0.02;
constexpr float kAir = 100, kMatter = 150, kOpacity = 0.6f;  // opacity rises from kAir to kMatter

std::size_t voxel(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return (std::size_t{z} * kSize + y) * kSize + x;
}

float opacity(std::uint8_t value) {
    return kOpacity * std::clamp((static_cast<float>(value) - kAir) / (kMatter - kAir), 0.0f, 1.0f);
}

// A ball with a gyroid's tunnels.
std::vector<std::uint8_t> sponge() {
    std::vector<std::uint8_t> values(std::size_t{kSize} * kSize * kSize);
    for (std::uint32_t z = 0; z < kSize; ++z)
        for (std::uint32_t y = 0; y < kSize; ++y)
            for (std::uint32_t x = 0; x < kSize; ++x) {
                const auto centred = [](std::uint32_t i) {
                    return static_cast<float>(i) - 0.5f * (kSize - 1);
                };
                const float px = centred(x), py = centred(y), pz = centred(z), k = 0.14f;
                const float gyroid = std::sin(k * px) * std::cos(k * py) +
                                     std::sin(k * py) * std::cos(k * pz) +
                                     std::sin(k * pz) * std::cos(k * px);
                const float wall = 2 * (0.5f + gyroid),
                            ball = 0.3f * (0.46f * kSize - std::sqrt(px * px + py * py + pz * pz));
                values[voxel(x, y, z)] =
                    static_cast<std::uint8_t>(128 + 127 * std::clamp(std::min(wall, ball), -1.0f, 1.0f));
            }
    return values;
}

// A cube around the origin, half a side of 1.
dfield::ClipMesh cube(const dfield::Context& context) {
    std::vector<float> positions;
    for (int corner = 0; corner < 8; ++corner)
        for (int axis = 0; axis < 3; ++axis) positions.push_back(corner >> axis & 1 ? 1.0f : -1.0f);
    const std::vector<std::uint32_t> indices{0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                             2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    dfield_clip_mesh_desc desc = dfield::clip_mesh_defaults();
    desc.positions = positions.data();
    desc.vertex_count = positions.size() / 3;
    desc.indices = indices.data();
    desc.triangle_count = indices.size() / 3;
    return dfield::ClipMesh(context, desc);
}

// Turned around z, and coming in from the front.
std::array<float, 16> pose(float time) {
    const float half = 0.28f * kSize, c = half * std::cos(0.5f + 0.4f * time),
                s = half * std::sin(0.5f + 0.4f * time), middle = 0.5f * kSize;
    return {c, s, 0, 0, -s, c, 0, 0, 0, 0, half, 0, middle, kSize * (0.5f * time - 0.25f), 1.25f * middle, 1};
}

// What a viewer holds on its graphics card: factors and what is left of each voxel, 1 = all.
struct Textures {
    std::vector<float> visibility, left;

    // The rows of the box that an update names; how many voxels that were.
    std::size_t upload(const dfield::Contextual& session, const dfield_update_result& result) {
        constexpr float kWhole = 9 + DFIELD_CLIP_SAMPLES;
        std::size_t count = 0;
        for (std::uint32_t z = result.low[2]; z < result.high[2]; ++z)
            for (std::uint32_t y = result.low[1]; y < result.high[1]; ++y)
                for (std::uint32_t x = result.low[0]; x < result.high[0]; ++x, ++count) {
                    const std::size_t i = voxel(x, y, z);
                    visibility[i] = session.visibility()[i];
                    left[i] = static_cast<float>(session.coverage()[i]) / kWhole;
                }
        return count;
    }
};

// Seen from the front, along y, over white.
example::Picture picture_of(const std::vector<std::uint8_t>& values, const Textures& textures) {
    example::Picture picture(kSize, kSize);
    for (std::uint32_t z = 0; z < kSize; ++z)
        for (std::uint32_t x = 0; x < kSize; ++x) {
            float seen = 0, open = 1;  // light that arrives, and how much of what is behind still does
            for (std::uint32_t y = 0; y < kSize && open > 0.001f; ++y) {
                const std::size_t i = voxel(x, y, z);
                const float a = opacity(values[i]) * textures.left[i];
                // Half of the rays of a plane go into it: twice its factor is white.
                seen += open * a * std::min(1.0f, 2 * textures.visibility[i]);
                open *= 1 - a;
            }
            picture.set(static_cast<int>(x), static_cast<int>(kSize - 1 - z),
                        {0.9f * seen + open, 0.8f * seen + open, 0.65f * seen + open});
        }
    return picture;
}

void run(const std::string& prefix, int frames) {
    dfield::Threads threads;
    dfield_context_desc hooks{};
    hooks.struct_size = sizeof hooks;
    threads.install(hooks);
    const dfield::Context context(&hooks);

    const std::vector<std::uint8_t> values = sponge();
    const dfield_opacity_point points[] = {{kAir, 0}, {kMatter, kOpacity}};
    dfield_contextual_desc desc = dfield::contextual_defaults();
    desc.samples.struct_size = sizeof desc.samples;
    desc.samples.grid = {{kSize, kSize, kSize}, {1, 1, 1}};
    desc.samples.type = DFIELD_SAMPLE_U8;
    desc.samples.data = values.data();
    desc.opacity.struct_size = sizeof desc.opacity;
    desc.opacity.points = points;
    desc.opacity.point_count = 2;
    dfield::Contextual session(context, desc);
    Textures textures{std::vector<float>(values.size()), std::vector<float>(values.size())};
    textures.upload(session, session.update());  // the whole volume

    dfield_clip clip{};
    const dfield::ClipMesh mesh = cube(context);
    clip.mesh = mesh.get();
    clip.mode = DFIELD_CLIP_SUBTRACT;
    const std::array<float, 16> first = pose(0);
    std::copy(first.begin(), first.end(), clip.mesh_to_world);
    const std::uint32_t id = session.add(clip);

    dfield_update_desc budget{};
    budget.struct_size = sizeof budget;
    budget.seconds = kSecondsPerUpdate;
    for (int frame = 0; frame < frames; ++frame) {
        session.move(id, pose(static_cast<float>(frame) / static_cast<float>(frames)).data());
        // A viewer would show each of these; here they are refined before the picture is taken.
        int updates = 0;
        double seconds = 0;
        std::size_t computed = 0, uploaded = 0;
        for (bool is_final = false; !is_final; ++updates) {
            const dfield_update_result result = session.update(&budget);
            seconds += result.seconds;
            computed += result.recomputed;
            uploaded += textures.upload(session, result);
            is_final = result.is_final;
        }
        char number[16];
        std::snprintf(number, sizeof number, "%03d.ppm", frame);
        picture_of(values, textures).write(prefix + number);
        const auto percent = [&](std::size_t voxels) {
            return 100 * static_cast<double>(voxels) / static_cast<double>(values.size());
        };
        std::printf("frame %d: %.1f ms in %d updates, %.1f %% of the voxels computed, %.1f %% uploaded\n",
                    frame, 1000 * seconds, updates, percent(computed), percent(uploaded));
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3 || std::atoi(argv[2]) < 1) {
        std::fprintf(stderr, "usage: cut_volume PICTURE-PREFIX FRAMES\n");
        return 2;
    }
    try {
        run(argv[1], std::atoi(argv[2]));
    } catch (const std::exception& error) {
        std::fprintf(stderr, "cut_volume: %s\n", error.what());
        return 1;
    }
    return 0;
}
