// Batches over direction maps: every level of SIMD against the reference, independence of how receivers are
// grouped, closed forms, distances.
#include <algorithm>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>

#include "baker/bake_directions.hpp"
#include "baker/embree_scene.hpp"
#include "format/hemisphere_map.hpp"
#include "tests/runtime/baked_directions.hpp"
#include "tests/runtime/placements.hpp"
#include "tests/shapes.hpp"

using namespace dfield;
using namespace dfield::test;

namespace {

Context context_at(dfield_simd simd) {
    dfield_context_desc desc{};
    desc.struct_size = sizeof desc;
    desc.simd = simd;
    return Context(&desc);
}

dfield_ao_desc shared(std::uint32_t rays = 512) {
    dfield_ao_desc desc = Ao::defaults();
    desc.sampling = DFIELD_SAMPLING_SHARED;
    desc.ray_count = rays;
    return desc;
}

// Receivers in a box around several placed objects, some of them owned.
struct Case {
    std::vector<glm::mat4> places;
    ReceiverList receivers;
};

Case random_case(std::uint64_t seed, std::size_t instances, std::size_t receivers) {
    Random random(seed);
    Case result;
    const glm::dvec3 low(-4), high(4);
    for (std::size_t i = 0; i < instances; ++i) result.places.push_back(random_placement(random, low, high));
    for (std::size_t i = 0; i < receivers; ++i) {
        result.receivers.positions.emplace_back(random.uniform(-5, 5), random.uniform(-5, 5),
                                                random.uniform(-5, 5));
        result.receivers.normals.emplace_back(random.direction() * random.uniform(0.1, 3));
        result.receivers.owners.push_back(
            random.below(5) == 0 ? random.below(static_cast<std::uint32_t>(instances)) : DFIELD_NO_INSTANCE);
    }
    return result;
}

// Grids on a few planes among the objects, and a bent one: blocks that are small, face alike, and lie before
// or behind whole objects.
Case wall_case(std::uint64_t seed, std::size_t instances) {
    Random random(seed);
    Case result = random_case(seed, instances, 0);
    constexpr int kSide = 26;
    for (int wall = 0; wall < 5; ++wall) {
        const glm::dmat3 turn = wall < 3 ? glm::dmat3(1) : random.rotation();
        const glm::dvec3 middle(random.uniform(-3, 3), random.uniform(-3, 3),
                                wall == 0 ? -5.0 : random.uniform(-5, 5));
        for (int i = 0; i < kSide * kSide; ++i) {
            const double u = 8.0 * (i % kSide) / kSide - 4, v = 8.0 * (i / kSide) / kSide - 4;
            const double bend = wall == 4 ? 0.1 : 0;
            result.receivers.positions.emplace_back(middle + turn * glm::dvec3(u, v, bend * u * u));
            result.receivers.normals.emplace_back(turn * glm::normalize(glm::dvec3(-2 * bend * u, 0, 1)));
        }
    }
    return result;
}

void place(Scene& scene, const Field& field, const Case& setting) {
    for (const glm::mat4& place : setting.places) scene.add(field, &place[0][0]);
}

std::vector<std::uint32_t> masks_of(dfield_simd simd, const std::vector<std::byte>& bytes,
                                    const Case& setting, const dfield_ao_desc& desc) {
    const Context context = context_at(simd);
    const Field field = Field::load(context, bytes.data(), bytes.size());
    Scene scene(context);
    place(scene, field, setting);
    const Ao ao(context, desc);
    std::vector<std::uint32_t> masks(setting.receivers.size() * dfield_ao_get_mask_words(ao.get()));
    scene.visibility_mask(ao, setting.receivers.view(), masks.data());
    return masks;
}

TriangleMesh table() {
    TriangleMesh mesh = box_mesh({-1, -0.6f, 0.5f}, {1, 0.6f, 0.7f});
    append(mesh, box_mesh({-0.9f, -0.5f, -0.7f}, {-0.8f, -0.4f, 0.5f}));
    append(mesh, box_mesh({0.8f, 0.4f, -0.7f}, {0.9f, 0.5f, 0.5f}));
    return mesh;
}

}  // namespace

TEST_CASE("every level of SIMD agrees with the reference", "[batch]") {
    for (const std::uint32_t map_size : {16u, 32u, 64u, 128u}) {
        CAPTURE(map_size);
        const auto bytes = baked_directions_bytes(table(), 7, map_size, 8);
        const Case setting = random_case(11 + map_size, 7, 700);
        const std::vector<std::uint32_t> reference =
            masks_of(DFIELD_SIMD_SCALAR, bytes, setting, shared(300));
        std::size_t blocked = 0;
        for (const std::uint32_t word : reference) blocked += std::popcount(word);
        REQUIRE(blocked > 3000);
        for (const dfield_simd simd :
             {DFIELD_SIMD_SSE4, DFIELD_SIMD_AVX2, DFIELD_SIMD_AVX512, DFIELD_SIMD_NEON}) {
            CAPTURE(simd);
            const std::vector<std::uint32_t> masks = masks_of(simd, bytes, setting, shared(300));
            std::size_t differing = 0;
            for (std::size_t i = 0; i < masks.size(); ++i)
                differing += std::popcount(masks[i] ^ reference[i]);
            // Rounding puts a line into another texel, or a direction to another stored one.
            CHECK(differing <= 700 * 300 / 5000);
        }
    }
}

TEST_CASE("blocks that are small and face alike agree with the reference, too", "[batch]") {
    const auto bytes = baked_directions_bytes(table(), 7, 32, 8);
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
        const Case setting = wall_case(seed, 9);
        const std::size_t pairs = setting.receivers.size() * 300;
        const std::vector<std::uint32_t> reference =
            masks_of(DFIELD_SIMD_SCALAR, bytes, setting, shared(300));
        std::size_t blocked = 0;
        for (const std::uint32_t word : reference) blocked += std::popcount(word);
        REQUIRE(blocked > pairs / 100);
        for (const dfield_simd simd : {DFIELD_SIMD_SSE4, DFIELD_SIMD_AVX2, DFIELD_SIMD_AVX512}) {
            CAPTURE(seed, simd);
            const std::vector<std::uint32_t> masks = masks_of(simd, bytes, setting, shared(300));
            std::size_t differing = 0;
            for (std::size_t i = 0; i < masks.size(); ++i)
                differing += std::popcount(masks[i] ^ reference[i]);
            CHECK(differing <= pairs / 5000);
            const Context context = context_at(simd);
            const Field field = Field::load(context, bytes.data(), bytes.size());
            Scene scene(context);
            place(scene, field, setting);
            const Ao ao(context, shared(300));
            std::vector<float> visibility(setting.receivers.size());
            scene.visibility(ao, setting.receivers.view(), visibility.data());
            std::vector<float> gathered(visibility.size());
            ao.gather(setting.receivers.view(), masks.data(), nullptr, gathered.data());
            for (std::size_t i = 0; i < visibility.size(); ++i)
                REQUIRE(visibility[i] == Approx(gathered[i]).margin(2e-3));
        }
    }
}

TEST_CASE("custom directions, opposite, alone or twice, keep their order and their weights", "[batch]") {
    Random random(17);
    constexpr std::size_t kRays = 200;
    std::vector<glm::vec3> directions;
    while (directions.size() < kRays) {
        const glm::vec3 w(random.direction());
        directions.push_back(w);
        if (random.below(3) == 0) directions.push_back(-w);
        if (random.below(10) == 0) directions.push_back(random.below(2) ? w : -w);
    }
    directions.resize(kRays);
    std::vector<float> weights;
    for (std::size_t r = 0; r < kRays; ++r) weights.push_back(static_cast<float>(random.uniform(0, 2)));
    std::vector<std::uint32_t> order(kRays);
    std::iota(order.begin(), order.end(), 0u);
    for (std::size_t i = kRays; i > 1; --i)
        std::swap(order[i - 1], order[random.below(static_cast<std::uint32_t>(i))]);
    std::vector<glm::vec3> shuffled;
    for (const std::uint32_t r : order) shuffled.push_back(directions[r]);

    const auto bytes = baked_directions_bytes(table(), 7, 32, 8);
    for (const Case& setting : {random_case(23, 6, 400), wall_case(4, 6)}) {
        dfield_ao_desc desc = shared(kRays);
        desc.directions = &directions.front().x;
        desc.weights = weights.data();
        const std::vector<std::uint32_t> masks = masks_of(DFIELD_SIMD_BEST, bytes, setting, desc);
        dfield_ao_desc other = shared(kRays);
        other.directions = &shuffled.front().x;
        const std::vector<std::uint32_t> moved = masks_of(DFIELD_SIMD_BEST, bytes, setting, other);
        const std::vector<std::uint32_t> reference = masks_of(DFIELD_SIMD_SCALAR, bytes, setting, desc);

        const Context context;
        const Field field = Field::load(context, bytes.data(), bytes.size());
        Scene scene(context);
        place(scene, field, setting);
        std::vector<float> visibility(setting.receivers.size());
        scene.visibility(Ao(context, desc), setting.receivers.view(), visibility.data());

        constexpr std::size_t kWords = (kRays + 31) / 32;
        std::size_t differing = 0, misplaced = 0, hidden = 0;
        for (std::size_t i = 0; i < setting.receivers.size(); ++i) {
            const glm::vec3 normal = glm::normalize(setting.receivers.normals[i]);
            const auto bit = [&](const std::vector<std::uint32_t>& of, std::size_t r) {
                return of[i * kWords + r / 32] >> r % 32 & 1;
            };
            double open = 0, whole = 0;
            for (std::size_t k = 0; k < kRays; ++k) {
                const std::size_t r = order[k];
                const double cosine = glm::dot(normal, directions[r]);
                differing += bit(masks, r) != bit(reference, r);
                misplaced += bit(masks, r) != bit(moved, k);
                if (cosine < -1e-6) hidden += bit(masks, r);
                if (cosine <= 0) continue;
                whole += weights[r] * cosine;
                if (!bit(masks, r)) open += weights[r] * cosine;
            }
            REQUIRE(visibility[i] ==
                    Approx(open / whole).margin(6e-3));  // few and uneven rays: a rough table
        }
        CHECK(differing <= setting.receivers.size() * kRays / 5000);
        CHECK(misplaced <= setting.receivers.size() * kRays / 5000);  // clusters differ, and so do roundings
        CHECK(hidden == 0);
    }
}

TEST_CASE("the ground hides what leads below it", "[batch]") {
    const Case setting = wall_case(8, 0);
    const float plane[4] = {0.1f, -0.2f, 1, -6};
    for (const dfield_simd simd :
         {DFIELD_SIMD_SCALAR, DFIELD_SIMD_SSE4, DFIELD_SIMD_AVX2, DFIELD_SIMD_BEST}) {
        const Context context = context_at(simd);
        Scene scene(context);
        scene.set_ground(plane);
        const Ao ao(context, shared(256));
        std::vector<std::uint32_t> masks(setting.receivers.size() * 8);
        scene.visibility_mask(ao, setting.receivers.view(), masks.data());
        for (std::size_t i = 0; i < setting.receivers.size(); ++i)
            for (std::size_t r = 0; r < 256; ++r) {
                const float* w = ao.directions() + 3 * r;
                const glm::vec3 ray(w[0], w[1], w[2]);
                const float cosine = glm::dot(setting.receivers.normals[i], ray);
                const float climb = glm::dot(glm::vec3(plane[0], plane[1], plane[2]), ray);
                if (std::fabs(cosine) < 1e-6f || std::fabs(climb) < 1e-6f) continue;
                REQUIRE((masks[i * 8 + r / 32] >> r % 32 & 1) == (cosine > 0 && climb < 0));
            }
    }
}

TEST_CASE("results do not depend on how receivers are grouped", "[batch]") {
    const Context context;
    const Field field = baked_directions(context, table(), 8, 32, 8);
    const Case setting = random_case(5, 9, 3000);
    Scene scene(context);
    place(scene, field, setting);
    for (const bool bounded : {false, true}) {
        CAPTURE(bounded);
        dfield_ao_desc desc = shared(1000);  // two slabs of directions
        if (bounded) {
            desc.max_distance = 2;
            desc.falloff = DFIELD_FALLOFF_LINEAR;
        }
        const Ao ao(context, desc);
        std::vector<float> whole(setting.receivers.size());
        scene.visibility(ao, setting.receivers.view(), whole.data());
        std::vector<std::uint32_t> order(whole.size());
        std::iota(order.begin(), order.end(), 0u);
        Random random(3);
        for (std::size_t i = order.size(); i > 1; --i)
            std::swap(order[i - 1], order[random.below(static_cast<std::uint32_t>(i))]);
        for (const std::size_t size : {1u, 17u, 500u}) {
            ReceiverList part;
            const std::size_t first = random.below(2000);
            for (std::size_t i = first; i < first + size; ++i) {
                part.positions.push_back(setting.receivers.positions[order[i]]);
                part.normals.push_back(setting.receivers.normals[order[i]]);
                part.owners.push_back(setting.receivers.owners[order[i]]);
            }
            std::vector<float> values(size);
            scene.visibility(ao, part.view(), values.data());
            for (std::size_t i = 0; i < size; ++i) REQUIRE(values[i] == whole[order[first + i]]);
        }
        CHECK(*std::min_element(whole.begin(), whole.end()) < 0.9f);
    }
}

TEST_CASE("a sphere hides what its solid angle says", "[batch]") {
    const Context context;
    const Field field = baked_directions(context, sphere_mesh({0, 0, 0}, 1), 16, 64, 0);
    Scene scene(context);
    scene.add(field, kIdentity);
    const Ao ao(context, shared(4096));
    Random random(7);
    for (int i = 0; i < 40; ++i) {
        const double distance = random.uniform(1.3, 6);
        const glm::dvec3 away = random.direction();
        ReceiverList receiver;
        receiver.positions.emplace_back(distance * away);
        receiver.normals.emplace_back(-away);
        float visibility = 0;
        scene.visibility(ao, receiver.view(), &visibility);
        // Cosine-weighted share of a cap around the normal: the square of its sine.
        CHECK(visibility == Approx(1 - 1 / (distance * distance)).margin(0.006));
    }
}

TEST_CASE("masks and visibility of a batch belong together", "[batch]") {
    const Context context;
    const Field field = baked_directions(context, table(), 8, 32, 8);
    const Case setting = random_case(9, 4, 500);
    Scene scene(context);
    place(scene, field, setting);
    const float ground[4] = {0, 0, 1, -4.5f};
    scene.set_ground(ground);
    const Ao ao(context, shared(512));
    const std::size_t words = dfield_ao_get_mask_words(ao.get());
    std::vector<std::uint32_t> masks(setting.receivers.size() * words);
    std::vector<float> visibility(setting.receivers.size());
    scene.visibility_mask(ao, setting.receivers.view(), masks.data());
    scene.visibility(ao, setting.receivers.view(), visibility.data());
    for (std::size_t i = 0; i < visibility.size(); ++i) {
        const glm::vec3 normal = glm::normalize(setting.receivers.normals[i]);
        double open = 0, whole = 0;
        for (std::size_t r = 0; r < 512; ++r) {
            const float* w = ao.directions() + 3 * r;
            const double cosine = glm::dot(normal, glm::vec3(w[0], w[1], w[2]));
            const bool blocked = masks[i * words + r / 32] >> r % 32 & 1;
            if (cosine <= 0) {
                if (cosine < -1e-6) CHECK_FALSE(blocked);
                continue;
            }
            whole += cosine;
            if (!blocked) open += cosine;
        }
        CHECK(visibility[i] == Approx(open / whole).margin(1e-3));  // the table of whole sums is interpolated
    }
}

TEST_CASE("bounded distances and falloff come from the depth maps", "[batch]") {
    const Context context;
    const TriangleMesh mesh = sphere_mesh({0, 0, 0}, 1);
    const Field field = baked_directions(context, mesh, 16, 64, 64);
    Scene scene(context);
    scene.add(field, kIdentity);
    EmbreeScene embree(EmbreeUse::kFast);
    embree.add_mesh(mesh);
    embree.commit();
    dfield_ao_desc desc = shared(512);
    desc.max_distance = 2;
    for (const dfield_falloff falloff : {DFIELD_FALLOFF_NONE, DFIELD_FALLOFF_LINEAR, DFIELD_FALLOFF_SMOOTH}) {
        CAPTURE(falloff);
        desc.falloff = falloff;
        const Ao ao(context, desc);
        Random random(13);
        double squares = 0;
        constexpr int kReceivers = 200;
        for (int i = 0; i < kReceivers; ++i) {
            ReceiverList receiver;
            receiver.positions.emplace_back(random.uniform(1.05, 3) * random.direction());
            receiver.normals.emplace_back(random.direction());
            float visibility = 0;
            scene.visibility(ao, receiver.view(), &visibility);
            double occluded = 0, whole = 0;
            for (std::size_t r = 0; r < 512; ++r) {
                const glm::vec3 w(ao.directions()[3 * r], ao.directions()[3 * r + 1],
                                  ao.directions()[3 * r + 2]);
                const double cosine = glm::dot(receiver.normals[0], w);
                if (cosine <= 0) continue;
                whole += cosine;
                RTCIntersectContext rays;
                rtcInitIntersectContext(&rays);
                RTCRayHit hit{};
                hit.ray = {receiver.positions[0].x,
                           receiver.positions[0].y,
                           receiver.positions[0].z,
                           0,
                           w.x,
                           w.y,
                           w.z,
                           0,
                           1e30f,
                           ~0u,
                           0,
                           0};
                hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
                rtcIntersect1(embree.get(), &rays, &hit);
                if (hit.hit.geomID != RTC_INVALID_GEOMETRY_ID)
                    occluded += cosine * dfield_ao_get_occlusion(ao.get(), hit.ray.tfar);
            }
            squares += std::pow(255 * (visibility - (1 - occluded / whole)), 2);
        }
        CHECK(std::sqrt(squares / kReceivers) < 3);  // grey levels
    }
}

TEST_CASE("fields with and without direction maps share a scene", "[batch]") {
    const Context context;
    const Field with = baked_directions(context, table(), 12, 64, 8),
                without = baked(context, table(), 16, 32, 8);
    const Case setting = random_case(21, 6, 400);
    const Ao ao(context, shared(512));
    Scene all(context), mixed(context);
    for (std::size_t i = 0; i < setting.places.size(); ++i) {
        all.add(with, &setting.places[i][0][0]);
        mixed.add(i % 2 ? with : without, &setting.places[i][0][0]);
    }
    std::vector<float> expected(setting.receivers.size()), visibility(expected.size());
    all.visibility(ao, setting.receivers.view(), expected.data());
    mixed.visibility(ao, setting.receivers.view(), visibility.data());
    double squares = 0, changes = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        squares += std::pow(255 * (visibility[i] - expected[i]), 2);
        changes += visibility[i] < 1;
    }
    CHECK(std::sqrt(squares / static_cast<double>(expected.size())) < 6);
    CHECK(changes > 200);

    dfield_ao_desc bounded = shared(512);
    bounded.max_distance = 3;
    const Ao by_distance(context, bounded);
    CHECK_THROWS_WITH(mixed.visibility(by_distance, setting.receivers.view(), visibility.data()),
                      Catch::Contains("cannot mix fields"));
    bounded.kind = DFIELD_KIND_MAPS;
    mixed.visibility(Ao(context, bounded), setting.receivers.view(), visibility.data());
}

TEST_CASE("far instances are read from coarser levels within the stated error", "[batch]") {
    const TriangleMesh mesh = table();
    BakeOptions options;
    options.parameters = kNoMaps;
    DisplacementField baked = bake_field(mesh, options);
    for (const DirectionParameters& level :
         {DirectionParameters{4, 16, 0}, DirectionParameters{8, 32, 0}, DirectionParameters{16, 64, 0}}) {
        DirectionBakeOptions of_level;
        of_level.parameters = level;
        baked.directions.push_back(bake_directions(mesh, {baked.centre, baked.radius}, of_level));
    }
    const auto bytes = write_field(baked, {.zstd_level = 1});
    const Context context;
    const Field field = Field::load(context, bytes.data(), bytes.size());
    Scene scene(context);
    scene.add(field, kIdentity);
    Random random(17);
    ReceiverList receivers;
    for (int i = 0; i < 2000; ++i) {
        const glm::dvec3 away = random.direction();
        receivers.positions.emplace_back(away * std::pow(2, random.uniform(0.5, 4)));
        receivers.normals.emplace_back(-away + 0.7 * random.direction());
    }
    const auto visibility = [&](float level_error) {
        dfield_ao_desc desc = shared(2048);
        desc.level_error = level_error;
        std::vector<float> values(receivers.size());
        scene.visibility(Ao(context, desc), receivers.view(), values.data());
        return values;
    };
    const std::vector<float> finest = visibility(0);
    std::size_t unequal_before = 0;
    for (const float level_error : {0.001f, 0.01f, 0.05f}) {
        const std::vector<float> values = visibility(level_error);
        std::size_t unequal = 0;
        float largest = 0;
        for (std::size_t i = 0; i < values.size(); ++i) {
            unequal += values[i] != finest[i];
            largest = std::max(largest, std::fabs(values[i] - finest[i]));
        }
        // 2048 directions are a sample of the lines that the bound speaks of: 3 of them more may differ.
        CHECK(largest <= level_error + 3 * 4 / 2048.0f);
        CHECK(unequal > unequal_before);  // coarser levels are read at all, and by more receivers
        unequal_before = unequal;
    }
}
