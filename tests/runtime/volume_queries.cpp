// Occlusion volumes through the C ABI: how they combine, what they refuse, what queries promise.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>

#include "dfield/threads.hpp"
#include "format/file.hpp"
#include "tests/runtime/baked.hpp"
#include "tests/runtime/baked_volume.hpp"
#include "tests/runtime/counted.hpp"
#include "tests/shapes.hpp"

using namespace dfield;
using namespace dfield::test;

namespace {

TriangleMesh two_boxes() {
    TriangleMesh mesh = box_mesh({-1, -1, -1}, {-0.2f, 1, 0});
    append(mesh, box_mesh({0.3f, -0.5f, -0.2f}, {1, 0.4f, 1}));
    return mesh;
}

ReceiverList receivers(std::size_t count, std::uint64_t seed) {
    ReceiverList list;
    Random random(seed);
    for (std::size_t i = 0; i < count; ++i) {
        list.positions.emplace_back(random.uniform(-6, 6), random.uniform(-6, 6), random.uniform(-1, 4));
        list.normals.emplace_back(random.direction() * random.uniform(0.5, 2));
    }
    return list;
}

Context context_at(dfield_simd simd) {
    dfield_context_desc desc{};
    desc.struct_size = sizeof desc;
    desc.simd = simd;
    return Context(&desc);
}

std::vector<float> visibility_in(const Scene& scene, const Ao& ao, const ReceiverList& list) {
    std::vector<float> visibility(list.size(), -1);
    scene.visibility(ao, list.view(), visibility.data());
    return visibility;
}

// Some instances of any transforms.
void add_crowd(Scene& scene, const Field& field, int count, std::uint64_t seed) {
    Random random(seed);
    for (int i = 0; i < count; ++i) {
        glm::mat4 place = random_placement(random, {-5, -5, 0}, {5, 5, 3});
        if (i % 3 == 0) place = place * glm::mat4(1, 0, 0, 0, 0.4f, 1, 0, 0, 0, -0.3f, 1, 0, 0, 0, 0, 1);
        scene.add(field, &place[0][0]);
    }
}

}  // namespace

TEST_CASE("Kernels of every instruction set agree with the scalar reference") {
    const auto bytes = baked_volume_bytes(two_boxes(), 24);
    const ReceiverList list = receivers(3001, 3);
    const auto at = [&](dfield_simd level, dfield_simd& ran) {
        const Context context = context_at(level);
        ran = context.simd();
        const Field field = Field::load(context, bytes.data(), bytes.size());
        std::vector<std::vector<float>> results;
        for (std::uint64_t seed = 0; seed < 12; ++seed) {
            Scene scene(context);
            add_crowd(scene, field, seed < 10 ? 1 : 7, seed);
            results.push_back(visibility_in(scene, Ao(context), list));
        }
        return results;
    };
    dfield_simd ran = DFIELD_SIMD_BEST;
    const auto reference = at(DFIELD_SIMD_SCALAR, ran);
    REQUIRE(ran == DFIELD_SIMD_SCALAR);
    int levels = 0;
    for (const dfield_simd level :
         {DFIELD_SIMD_SSE4, DFIELD_SIMD_AVX2, DFIELD_SIMD_AVX512, DFIELD_SIMD_NEON}) {
        const auto results = at(level, ran);
        if (ran != level) continue;
        ++levels;
        double largest = 0;
        for (std::size_t s = 0; s < results.size(); ++s)
            for (std::size_t i = 0; i < list.size(); ++i)
                largest = std::max(largest, std::fabs(static_cast<double>(results[s][i]) - reference[s][i]));
        INFO("level " << level);
        CHECK(largest < 1e-4);
    }
    CHECK(levels > 0);
}

TEST_CASE("The visibility past several instances is the product, of other kinds and the ground too") {
    const Context context;
    const TriangleMesh mesh = two_boxes();
    const Field volume = baked_volume(context, mesh, 24), maps = baked(context, mesh);
    const ReceiverList list = receivers(500, 5);
    const Ao ao(context);
    Random random(6);
    const glm::mat4 first = random_placement(random, {-3, -3, 0}, {0, 0, 2}),
                    second = random_placement(random, {0, 0, 0}, {3, 3, 2});
    const float ground[4] = {0, 0, 1, -1.5f};
    const auto alone = [&](const Field* field, const glm::mat4& place, bool with_ground) {
        Scene scene(context);
        if (field) scene.add(*field, &place[0][0]);
        if (with_ground) scene.set_ground(ground);
        return visibility_in(scene, ao, list);
    };
    const auto a = alone(&volume, first, false), b = alone(&volume, second, false),
               rays = alone(&maps, second, true);
    Scene both(context), mixed(context);
    both.add(volume, &first[0][0]);
    both.add(volume, &second[0][0]);
    mixed.add(volume, &first[0][0]);
    mixed.add(maps, &second[0][0]);
    mixed.set_ground(ground);
    const auto together = visibility_in(both, ao, list), with_others = visibility_in(mixed, ao, list);
    double darkest = 1;
    for (std::size_t i = 0; i < list.size(); ++i) {
        CHECK(together[i] == Approx(a[i] * b[i]).margin(1e-6));
        CHECK(with_others[i] == Approx(a[i] * rays[i]).margin(1e-6));
        darkest = std::min(darkest, static_cast<double>(together[i]));
    }
    CHECK(darkest < 0.7);

    // Shared directions, with direction maps beside or none.
    dfield_ao_desc desc = Ao::defaults();
    desc.sampling = DFIELD_SAMPLING_SHARED;
    const auto shared = visibility_in(both, Ao(context, desc), list);
    CHECK(std::memcmp(shared.data(), together.data(), list.size() * sizeof(float)) == 0);
}

TEST_CASE("Owners are not occluded, self-visibility is multiplied, and what is no receiver is open") {
    const Context context;
    const Field field = baked_volume(context, two_boxes(), 24);
    Scene scene(context);
    const glm::mat4 place(1);
    const dfield_instance id = scene.add(field, &place[0][0]);
    const Ao ao(context);
    ReceiverList list = receivers(200, 7);
    const auto plain = visibility_in(scene, ao, list);
    list.self.assign(list.size(), 0.5f);
    list.owners.assign(list.size(), DFIELD_NO_INSTANCE);
    for (std::size_t i = 0; i < list.size(); i += 2) list.owners[i] = id;
    const auto owned = visibility_in(scene, ao, list);
    for (std::size_t i = 0; i < list.size(); ++i) CHECK(owned[i] == 0.5f * (i % 2 == 0 ? 1 : plain[i]));
    list.self.clear();
    list.owners.clear();
    list.positions[3].x = NAN;
    list.normals[4] = glm::vec3(0);
    list.normals[5].y = INFINITY;
    list.positions[6] = glm::vec3(3e38f, -3e38f, 3e38f);
    const auto broken = visibility_in(scene, ao, list);
    for (const std::size_t i : {3, 4, 5}) CHECK(broken[i] == 1);
    CHECK(broken[6] >= 0);
    CHECK(broken[6] <= 1);
    CHECK(broken[7] == plain[7]);
    scene.set_hidden(id, true);
    for (const float open : visibility_in(scene, ao, receivers(50, 8))) CHECK(open == 1);
}

TEST_CASE("Volumes say what they cannot answer") {
    const Context context;
    const Field field = baked_volume(context, two_boxes(), 16);
    const dfield_field_info info = field.info();
    CHECK(info.kinds == 1u << DFIELD_KIND_VOLUME);
    CHECK(info.bits == 0);
    CHECK(*std::max_element(info.volume_dims, info.volume_dims + 3) == 16);
    CHECK(info.volume_spacing > 0);
    CHECK(info.memory_bytes > 8 * info.volume_dims[0] * info.volume_dims[1] * info.volume_dims[2]);
    CHECK(Ao(context).kind(field) == DFIELD_KIND_VOLUME);

    Scene scene(context);
    const glm::mat4 place(1);
    scene.add(field, &place[0][0]);
    const ReceiverList list = receivers(10, 1);
    const dfield_receivers view = list.view();
    std::vector<float> floats(100);
    const auto refused = [&](const dfield_ao_desc& desc, const dfield_outputs& outputs, const char* why) {
        const Ao ao(context, desc);
        CHECK(dfield_scene_ambient(scene.scene_handle(), ao.get(), &view, &outputs) ==
              DFIELD_INVALID_ARGUMENT);
        CHECK(std::string(dfield_error_message()).find(why) != std::string::npos);
    };
    dfield_outputs outputs = no_outputs();
    outputs.visibility = floats.data();
    dfield_ao_desc desc = Ao::defaults();
    desc.max_distance = 3;
    refused(desc, outputs, "max_distance");
    desc.falloff = DFIELD_FALLOFF_LINEAR;
    refused(desc, outputs, "falloff");
    desc = Ao::defaults();
    desc.bias = 0.1f;
    refused(desc, outputs, "bias");
    desc = Ao::defaults();
    desc.kind = DFIELD_KIND_MAPS;
    refused(desc, outputs, "bake it with the kind");
    desc = Ao::defaults();
    outputs.bent_normals = floats.data();
    refused(desc, outputs, "no single rays");
    outputs = no_outputs();
    outputs.harmonics = floats.data();
    refused(desc, outputs, "no single rays");
    std::vector<std::uint32_t> masks(10 * 8);
    outputs = no_outputs();
    outputs.masks = masks.data();
    refused(desc, outputs, "no single rays");

    CHECK(dfield_scene_visibility_reference(scene.scene_handle(), Ao(context).get(), &view, floats.data(),
                                            0) == DFIELD_INVALID_ARGUMENT);

    const glm::vec3 origin(3), direction(-1);
    dfield_rays rays{};
    rays.count = 1;
    rays.origins = &origin.x;
    rays.directions = &direction.x;
    std::uint8_t occluded = 0;
    const dfield_hits hits{floats.data(), 0, nullptr, 0};
    CHECK(dfield_scene_occluded(scene.scene_handle(), &rays, &occluded) == DFIELD_INVALID_ARGUMENT);
    CHECK(dfield_scene_trace(scene.scene_handle(), &rays, &hits) == DFIELD_INVALID_ARGUMENT);
    CHECK(std::string(dfield_error_message()).find("line table") != std::string::npos);
}

TEST_CASE("Lookups of volumes allocate nothing and do not depend on splits or threads") {
    std::size_t allocations = 0;
    const auto bytes = baked_volume_bytes(two_boxes(), 24);
    const ReceiverList list = receivers(4001, 9);
    const dfield_context_desc hooks = counting_hooks(allocations);
    const Context context(&hooks);
    const Field field = Field::load(context, bytes.data(), bytes.size());
    const Ao ao(context);
    Scene scene(context);
    add_crowd(scene, field, 9, 4);
    const Snapshot snapshot = scene.commit();
    std::vector<float> whole(list.size()), parts(list.size()), committed(list.size());
    const std::size_t before = allocations;
    REQUIRE(before > 0);
    scene.visibility(ao, list.view(), whole.data());
    dfield_receivers view = list.view();
    check(dfield_scene_visibility(snapshot.scene_handle(), ao.get(), &view, committed.data(), 0));
    for (std::size_t begin = 0, step = 1; begin < list.size(); begin += step, step = step % 97 + 1) {
        dfield_receivers part = list.view();
        part.positions += 3 * begin;
        part.normals += 3 * begin;
        part.count = std::min(step, list.size() - begin);
        scene.visibility(ao, part, parts.data() + begin);
    }
    CHECK(allocations == before);
    CHECK(std::memcmp(whole.data(), parts.data(), whole.size() * sizeof(float)) == 0);
    CHECK(std::memcmp(whole.data(), committed.data(), whole.size() * sizeof(float)) == 0);

    Threads pool(3);
    dfield_context_desc threaded{};
    threaded.struct_size = sizeof threaded;
    pool.install(threaded);
    const Context several(&threaded);
    const Field again = Field::load(several, bytes.data(), bytes.size());
    Scene same(several);
    add_crowd(same, again, 9, 4);
    const auto by_threads = visibility_in(same, Ao(several), list);
    CHECK(std::memcmp(whole.data(), by_threads.data(), whole.size() * sizeof(float)) == 0);
}

TEST_CASE("Receiver sets follow volumes that move, bit for bit") {
    const Context context;
    const Field volume = baked_volume(context, two_boxes(), 16), maps = baked(context, two_boxes(), 6, 8);
    const ReceiverList list = receivers(700, 11);
    const Ao ao(context);
    Scene scene(context);
    add_crowd(scene, volume, 10, 2);
    Random random(12);
    const glm::mat4 other = random_placement(random, {-3, -3, 0}, {3, 3, 2});
    const dfield_instance moving = scene.add(volume, &other[0][0]);
    scene.add(maps, &other[0][0]);
    ReceiverSet set(context, ao, list.view());
    for (int frame = 0; frame < 4; ++frame) {
        const glm::mat4 place = random_placement(random, {-4, -4, 0}, {4, 4, 2});
        scene.set_transform(moving, &place[0][0]);
        const Snapshot snapshot = scene.commit();
        set.update(snapshot);
        ReceiverSet fresh(context, ao, list.view());
        fresh.update(snapshot);
        CHECK(std::memcmp(set.visibility(), fresh.visibility(), list.size() * sizeof(float)) == 0);
        const auto queried = visibility_in(scene, ao, list);
        for (std::size_t i = 0; i < list.size(); ++i)
            REQUIRE(set.visibility()[i] == Approx(queried[i]).margin(1e-5));
        std::vector<float> bent(3 * list.size());
        dfield_outputs outputs = no_outputs();
        outputs.bent_normals = bent.data();
        CHECK_THROWS(set.outputs(outputs));
    }
}

TEST_CASE("Bakes of volumes do not depend on the threads") {
    FieldPlan plan;
    plan.volume = VolumeParameters{20};
    const TriangleMesh mesh = two_boxes();
    BakeOptions options;
    options.threads = 1;
    const DisplacementField one = bake_plan(mesh, plan, options);
    options.threads = 3;
    CHECK(payload_hash(one) == payload_hash(bake_plan(mesh, plan, options)));
    CHECK(plan_of(one) == plan);
    CHECK(read_field(write_field(one)).volume->memory_bytes() <= plan_bytes(plan));
}
