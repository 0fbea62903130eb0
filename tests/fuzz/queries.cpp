// libFuzzer: transforms, rays and receivers of any bits (NaN, infinities, zero scale, denormals) through the
// C ABI. Each call answers a status, and queries that succeed give numbers within their ranges.
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "dfield/dfield.hpp"
#include "format/writer.hpp"
#include "tests/format/kinds.hpp"
#include "tests/fuzz/input.hpp"

namespace {

using namespace dfield;

using fuzz::Input, fuzz::require;

struct World {
    Context context;
    std::vector<Field> fields;
    std::vector<std::pair<dfield_kind, Ao>> settings;

    World() {
        for (const std::uint32_t bits : {1u, 8u}) {
            const auto bytes = write_field(test::make_all_kinds_and_volume(bits), {.zstd_level = 1});
            fields.push_back(Field::load(context, bytes.data(), bytes.size()));
        }
        for (const dfield_kind kind : {DFIELD_KIND_AUTO, DFIELD_KIND_MAPS, DFIELD_KIND_LINES,
                                       DFIELD_KIND_DIRECTIONS, DFIELD_KIND_VOLUME}) {
            dfield_ao_desc desc = Ao::defaults();
            desc.ray_count = 9;
            desc.kind = kind;
            if (kind == DFIELD_KIND_DIRECTIONS) {
                desc.sampling = DFIELD_SAMPLING_SHARED;
                desc.ray_count = 40;
            } else if (kind != DFIELD_KIND_VOLUME) {
                desc.max_distance = 2;
                desc.falloff = DFIELD_FALLOFF_LINEAR;
            }
            settings.emplace_back(kind, Ao(context, desc));
        }
    }
};

void query_rays(const dfield_scene* scene, Input& input) {
    std::vector<float> floats(7 * 5);
    for (float& value : floats) value = input.number();
    const std::size_t stride = 7 * sizeof(float), count = 5;
    const dfield_rays rays{count, &floats[0], stride, &floats[3], stride, &floats[6], stride};
    std::array<float, count> distances;
    std::array<dfield_instance, count> instances;
    if (dfield_hits hits{distances.data(), 0, instances.data(), 0};
        dfield_scene_trace(scene, &rays, &hits) == DFIELD_OK)
        for (std::size_t i = 0; i < count; ++i) require(distances[i] >= 0);
    std::array<std::uint8_t, count> occluded;
    if (dfield_scene_occluded(scene, &rays, occluded.data()) == DFIELD_OK)
        for (const std::uint8_t value : occluded) require(value <= 1);
}

void query_receivers(const dfield_scene* scene, dfield_kind kind, const Ao& ao, Input& input) {
    constexpr std::size_t kCount = 4;
    std::vector<float> floats(6 * kCount);
    for (float& value : floats) value = input.number();
    dfield_receivers receivers{};
    receivers.count = kCount;
    receivers.positions = &floats[0];
    receivers.normals = &floats[3];
    receivers.position_stride = receivers.normal_stride = 6 * sizeof(float);
    std::array<float, kCount> visibility;
    std::array<float, 3 * kCount> bent;
    std::array<float, DFIELD_SH_COUNT * kCount> harmonics;
    dfield_outputs outputs = no_outputs();
    outputs.visibility = visibility.data();
    const bool rays = kind != DFIELD_KIND_VOLUME;  // which that kind does not know
    if (rays) outputs.bent_normals = bent.data();
    if (rays) outputs.harmonics = harmonics.data();
    if (dfield_scene_ambient(scene, ao.get(), &receivers, &outputs) != DFIELD_OK) return;
    for (const float value : visibility) require(value >= 0 && value <= 1);
    if (!rays) return;
    for (const float value : harmonics) require(std::isfinite(value));
    for (std::size_t i = 0; i < kCount; ++i)
        for (std::size_t axis = 0; axis < 3; ++axis) {
            // Of a receiver that is none the bent normal is whatever its normal was.
            bool usable = false;
            for (std::size_t k = 3; k < 6; ++k) usable = usable || floats[6 * i + k] != 0;
            for (std::size_t k = 0; k < 6; ++k) usable = usable && std::isfinite(floats[6 * i + k]);
            require(!usable || std::fabs(bent[3 * i + axis]) <= 1.001f);
        }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static World world;
    Input input(data, size);
    Scene scene(world.context);
    std::vector<dfield_instance> instances;
    for (std::size_t i = 0; i < 3; ++i) {
        std::array<float, 16> matrix{};
        for (std::size_t k = 0; k < 16; ++k)
            matrix[k] = k % 4 == 3 ? (k == 15 ? 1.0f : 0.0f) : input.number();
        dfield_instance id = DFIELD_NO_INSTANCE;
        if (instances.size() == 2) {
            dfield_scene_set_transform(scene.get(), instances.front(), matrix.data());
        } else if (dfield_scene_add_instance(scene.get(), world.fields[i % 2].get(), matrix.data(), &id) ==
                   DFIELD_OK) {
            require(id != DFIELD_NO_INSTANCE);
            instances.push_back(id);
        }
    }
    std::array<float, 4> ground;
    for (float& value : ground) value = input.number();
    dfield_scene_set_ground(scene.get(), ground.data());
    const Snapshot snapshot = scene.commit();
    for (int round = 0; round < 4 && input.left() > 0; ++round)
        for (const dfield_scene* target : {scene.scene_handle(), snapshot.scene_handle()}) {
            query_rays(target, input);
            for (const auto& [kind, ao] : world.settings) query_receivers(target, kind, ao, input);
        }
    return 0;
}
