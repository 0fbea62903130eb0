// libFuzzer: edits, snapshots and receiver sets with any floats: NaN, infinities, zero scale, denormals. A
// transform is refused or usable; every query has a defined answer, the same from a snapshot, and an updated
// set has a new set's.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "dfield/dfield.hpp"
#include "tests/fuzz/input.hpp"

namespace {

using namespace dfield;

using fuzz::Input, fuzz::require;

struct Fields {
    Context context;
    std::vector<Field> fields;
    std::vector<Ao> settings;

    Fields() {
        for (const char* name : {"v1.1-all-kinds", "v1.0-8bit", "v1.0-1bit"})
            fields.push_back(Field::load(
                context, (std::string(DFIELD_SOURCE_DIR "/tests/golden/") + name + ".dfield").c_str()));
        for (const std::uint32_t sampling : {DFIELD_SAMPLING_HEMISPHERE, DFIELD_SAMPLING_SHARED})
            for (const bool falloff : {false, true}) {
                dfield_ao_desc desc = Ao::defaults();
                desc.sampling = sampling;
                desc.ray_count = 33;
                if (falloff) desc.falloff = DFIELD_FALLOFF_SMOOTH, desc.max_distance = 2;
                settings.emplace_back(context, desc);
            }
    }
};

constexpr std::size_t kReceivers = 4;

void edit(Input& input, Scene& scene, const Fields& shared, std::size_t field_count,
          std::vector<dfield_instance>& ids) {
    const Field& field = shared.fields[input.byte() % field_count];
    const std::uint8_t which = input.byte() % 8;
    dfield_instance id = ids.empty() ? 0 : ids[input.byte() % ids.size()];
    const std::array<float, 16> m = input.transform();
    if (which < 3 && ids.size() < 6) {
        if (dfield_scene_add_instance(scene.get(), field.get(), m.data(), &id) == DFIELD_OK)
            ids.push_back(id);
    } else if (which == 3) {
        if (dfield_scene_remove_instance(scene.get(), id) == DFIELD_OK) std::erase(ids, id);
    } else if (which == 4) {
        dfield_scene_set_hidden(scene.get(), id, input.byte() % 2);
    } else if (which == 5) {
        dfield_scene_set_field(scene.get(), id, field.get());
    } else if (which == 6) {
        const float plane[4] = {input.number(), input.number(), input.number(), input.number()};
        dfield_scene_set_ground(scene.get(), input.byte() % 4 == 0 ? nullptr : plane);
    } else {
        dfield_scene_set_transform(scene.get(), id, m.data());
    }
}

struct Answers {
    std::array<float, kReceivers> visibility, distances;
    std::array<float, 3 * kReceivers> bent;
    std::array<float, DFIELD_SH_COUNT * kReceivers> harmonics;
    std::array<std::uint32_t, 2 * kReceivers> masks;
    std::array<std::uint8_t, kReceivers> visibility8, occluded;

    dfield_outputs outputs() {
        dfield_outputs outputs = no_outputs();
        outputs.visibility = visibility.data();
        outputs.visibility8 = visibility8.data();
        outputs.bent_normals = bent.data();
        outputs.masks = masks.data();
        outputs.harmonics = harmonics.data();
        return outputs;
    }
    void check_values() const {
        for (const float v : visibility) require(v >= 0 && v <= 1);
        for (std::size_t i = 0; i < kReceivers; ++i)
            require(std::fabs(std::hypot(bent[3 * i], bent[3 * i + 1], bent[3 * i + 2]) - 1) < 1e-3f);
        for (const float coefficient : harmonics) require(std::fabs(coefficient) < 1.2f);
    }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const Fields shared;
    Input input(data, size);
    const std::size_t which = input.byte() % shared.settings.size();
    const Ao& ao = shared.settings[which];
    // Shared directions with a falloff do not mix fields of several kinds.
    const std::size_t field_count = which == 3 ? 1 : shared.fields.size();
    Scene scene(shared.context);
    std::vector<dfield_instance> ids;
    std::array<float, 3 * kReceivers> positions, normals;
    for (float& value : positions) value = input.number();
    for (float& value : normals) value = input.number();
    const std::array<dfield_instance, kReceivers> owners{DFIELD_NO_INSTANCE, 0, 1, DFIELD_NO_INSTANCE},
        attached{DFIELD_NO_INSTANCE, 0, DFIELD_NO_INSTANCE, 1};
    dfield_receivers receivers{};
    receivers.count = kReceivers;
    receivers.positions = positions.data();
    receivers.normals = normals.data();
    receivers.owners = owners.data();
    ReceiverSet set(shared.context, ao, receivers, attached.data());
    for (int round = 0; round < 3 && !input.empty(); ++round) {
        for (int k = 0; k < 3; ++k) edit(input, scene, shared, field_count, ids);
        const Snapshot snapshot = scene.commit();

        Answers answers, of_scene;
        snapshot.ambient(ao, receivers, answers.outputs());
        answers.check_values();
        scene.ambient(ao, receivers, of_scene.outputs());
        require(answers.masks == of_scene.masks);
        set.update(snapshot);
        set.outputs(answers.outputs());
        answers.check_values();
        ReceiverSet fresh(shared.context, ao, receivers, attached.data());
        fresh.update(snapshot);
        fresh.outputs(of_scene.outputs());
        require(std::memcmp(&answers.visibility, &of_scene.visibility, sizeof answers.visibility) == 0);
        require(answers.masks == of_scene.masks);

        const float limit = input.number();
        dfield_rays rays{};
        rays.count = kReceivers;
        rays.origins = positions.data();
        rays.directions = normals.data();
        std::array<float, kReceivers> limits;
        limits.fill(limit);
        rays.max_distances = limits.data();
        std::array<dfield_instance, kReceivers> hit;
        snapshot.trace(rays, {answers.distances.data(), 0, hit.data(), 0});
        snapshot.occluded(rays, answers.occluded.data());
        for (std::size_t i = 0; i < kReceivers; ++i) {
            require(answers.distances[i] >= 0);
            require(std::isinf(answers.distances[i]) || answers.distances[i] <= limit);
            require(hit[i] == DFIELD_NO_INSTANCE || std::find(ids.begin(), ids.end(), hit[i]) != ids.end());
            require(answers.occluded[i] <= 1);
        }
    }
    return 0;
}
