// Instances of fields move over a ground, frame by frame. Every frame: new transforms, a snapshot, and an
// update of the ground's receivers, which computes again only what the movers can affect. The same masks
// light the ground twice, by the sky (ambient occlusion) and by an area light (its soft shadow). Writes a
// sequence of pictures.
//
//     dfield bake models/cube_with_hole.obj -o cube.dfield
//     moving_instances out/frame- 24 cube.dfield [more.dfield ...]
#include <chrono>
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

constexpr int kPixels = 160;    // receivers along a side of the ground, and pixels of a picture
constexpr float kHalfSize = 6;  // of the ground
constexpr int kInstances = 24;
constexpr std::uint32_t kRays = 512;

struct Vector {
    float x, y, z;
};

float dot(const Vector& a, const Vector& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

// Every second instance circles over the ground, the others stay; all stand on it.
void place(int i, float time, const dfield_field_info& info, float* m) {
    const float ring = 1.2f + 4.2f * static_cast<float>(i) / kInstances;
    const float turn = 2.4f * static_cast<float>(i) + (i % 2 == 0 ? 0.8f * time / ring : 0.0f);
    const float scale = (i % 3 == 0 ? 0.8f : 0.45f) / info.radius, c = std::cos(turn) * scale,
                s = std::sin(turn) * scale;
    const float matrix[16] = {c, 0, -s, 0, 0, scale, 0, 0, s, 0, c, 0, 0, 0, 0, 1};
    for (int k = 0; k < 16; ++k) m[k] = matrix[k];
    m[12] = ring * std::cos(turn) - (c * info.centre[0] + s * info.centre[2]);
    m[13] = -scale * info.bounds_min[1];
    m[14] = ring * std::sin(turn) - (c * info.centre[2] - s * info.centre[0]);
}

void run(const std::string& prefix, int frames, const std::vector<std::string>& files) {
    dfield::Threads threads;
    dfield_context_desc hooks{};
    hooks.struct_size = sizeof hooks;
    threads.install(hooks);
    const dfield::Context context(&hooks);

    std::vector<dfield::Field> fields;
    std::vector<dfield_field_info> infos;
    for (const std::string& file : files) {
        fields.push_back(dfield::Field::load(context, file.c_str()));
        infos.push_back(fields.back().info());
    }
    dfield::Scene scene(context);
    std::vector<dfield_instance> instances;
    std::vector<float> transforms(16 * kInstances);
    for (int i = 0; i < kInstances; ++i) {
        const std::size_t which = i % fields.size();
        place(i, 0, infos[which], &transforms[16 * i]);
        instances.push_back(scene.add(fields[which], &transforms[16 * i]));
    }

    // The ground's receivers, a pixel each.
    std::vector<Vector> positions, normals;
    for (int y = 0; y < kPixels; ++y)
        for (int x = 0; x < kPixels; ++x) {
            const auto along = [](int pixel) { return kHalfSize * (2 * (pixel + 0.5f) / kPixels - 1); };
            positions.push_back({along(x), 0, along(y)});
            normals.push_back({0, 1, 0});
        }
    dfield_receivers receivers{};
    receivers.count = positions.size();
    receivers.positions = &positions[0].x;
    receivers.normals = &normals[0].x;

    dfield_ao_desc settings = dfield::Ao::defaults();
    settings.sampling = DFIELD_SAMPLING_SHARED;
    settings.ray_count = kRays;
    const dfield::Ao ao(context, settings);
    dfield::ReceiverSet ground(context, ao, receivers);

    // A round light of 12 degrees around a direction: the rays that lead to it.
    const Vector to_light{0.48f, 0.6f, 0.64f};
    std::vector<float> light(kRays);
    for (std::uint32_t r = 0; r < kRays; ++r) {
        const float* d = ao.directions() + 3 * r;
        light[r] = dot({d[0], d[1], d[2]}, to_light) > std::cos(12 * 3.14159265f / 180) ? 1.0f : 0.0f;
    }

    std::vector<std::uint32_t> masks(ao.mask_words() * positions.size());
    dfield_outputs outputs = dfield::no_outputs();
    outputs.masks = masks.data();
    std::vector<float> lit(positions.size());
    for (int frame = 0; frame < frames; ++frame) {
        for (int i = 0; i < kInstances; ++i)
            place(i, static_cast<float>(frame) / 12, infos[i % fields.size()], &transforms[16 * i]);
        const auto start = std::chrono::steady_clock::now();
        // Only those that move: what is set is taken for changed.
        for (int i = 0; i < kInstances; i += 2) scene.set_transform(instances[i], &transforms[16 * i]);
        const dfield_update_stats stats = ground.update(scene.commit());
        ground.outputs(outputs, frame > 0);
        ao.gather(receivers, masks.data(), light.data(), lit.data());
        const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start;

        example::Picture picture(kPixels, kPixels);
        for (int y = 0; y < kPixels; ++y)
            for (int x = 0; x < kPixels; ++x) {
                const std::size_t i = static_cast<std::size_t>(y) * kPixels + x;
                const float sky = 0.35f * ground.visibility()[i], sun = 0.45f * lit[i];
                picture.set(x, y, {0.9f * sky + sun, 0.95f * sky + 0.93f * sun, 1.1f * sky + 0.8f * sun});
            }
        char number[16];
        std::snprintf(number, sizeof number, "%03d.ppm", frame);
        picture.write(prefix + number);
        std::printf("frame %d: %.2f ms, %zu instances moved, %zu of %zu receivers changed\n", frame,
                    elapsed.count(), stats.instances, stats.changed, positions.size());
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 4 || std::atoi(argv[2]) < 1) {
        std::fprintf(stderr, "usage: moving_instances PICTURE-PREFIX FRAMES FILE.dfield ...\n");
        return 2;
    }
    try {
        run(argv[1], std::atoi(argv[2]), {argv + 3, argv + argc});
    } catch (const std::exception& error) {
        std::fprintf(stderr, "moving_instances: %s\n", error.what());
        return 1;
    }
    return 0;
}
