// What masks turn into: visibility, bytes, bent normals, harmonics; closed forms, and all levels of SIMD
// alike.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <limits>

#include "tests/runtime/baked_directions.hpp"
#include "tests/runtime/placements.hpp"
#include "tests/shapes.hpp"

using namespace dfield;
using namespace dfield::test;

namespace {

struct Answer {
    float visibility = -1, bent[3]{}, harmonics[DFIELD_SH_COUNT]{};
    std::uint8_t byte = 77;
    std::vector<std::uint32_t> mask;
};

dfield_receivers one(const glm::vec3& position, const glm::vec3& normal) {
    dfield_receivers receivers{};
    receivers.count = 1;
    receivers.positions = &position.x;
    receivers.normals = &normal.x;
    return receivers;
}

Answer ask(const Scene& scene, const Ao& ao, const glm::vec3& position, const glm::vec3& normal) {
    Answer answer;
    answer.mask.resize(ao.mask_words());
    dfield_outputs outputs = no_outputs();
    outputs.visibility = &answer.visibility;
    outputs.visibility8 = &answer.byte;
    outputs.bent_normals = answer.bent;
    outputs.masks = answer.mask.data();
    outputs.harmonics = answer.harmonics;
    scene.ambient(ao, one(position, normal), outputs);
    return answer;
}

dfield_ao_desc settings(std::uint32_t sampling, std::uint32_t rays) {
    dfield_ao_desc desc = Ao::defaults();
    desc.sampling = sampling;
    desc.ray_count = rays;
    return desc;
}

// The real harmonics as their definition has them.
std::array<double, 9> harmonics_of(const glm::dvec3& w) {
    const double pi = 3.14159265358979;
    const auto root = [&](double a) { return std::sqrt(a / pi); };
    return {0.5 * root(1),
            std::sqrt(3 / (4 * pi)) * w.y,
            std::sqrt(3 / (4 * pi)) * w.z,
            std::sqrt(3 / (4 * pi)) * w.x,
            0.5 * root(15) * w.x * w.y,
            0.5 * root(15) * w.y * w.z,
            0.25 * root(5) * (3 * w.z * w.z - 1),
            0.5 * root(15) * w.x * w.z,
            0.25 * root(15) * (w.x * w.x - w.y * w.y)};
}

}  // namespace

TEST_CASE("An open receiver sees along its normal, half a sky halfway") {
    const Context context;
    Scene scene(context);
    Random random(3);
    for (const std::uint32_t sampling : {DFIELD_SAMPLING_HEMISPHERE, DFIELD_SAMPLING_SHARED}) {
        const Ao ao(context, settings(sampling, 4096));
        for (int i = 0; i < 20; ++i) {
            scene.set_ground(nullptr);
            const glm::vec3 normal(random.direction());
            const Answer open = ask(scene, ao, {0, 0, 1}, normal * 3.0f);
            CHECK(open.visibility == 1);
            CHECK(open.byte == 255);
            CHECK(open.harmonics[0] == Approx(0.282095).margin(1e-5));
            // Lambert's lobe: 1, 2/3 and 1/4 of the bands.
            const auto at_normal = harmonics_of(glm::dvec3(normal));
            for (std::size_t k = 1; k < 9; ++k)
                CHECK(open.harmonics[k] == Approx(at_normal[k] * (k < 4 ? 2.0 / 3 : 0.25)).margin(2e-3));
            for (int axis = 0; axis < 3; ++axis) CHECK(open.bent[axis] == Approx(normal[axis]).margin(3e-3));

            // A wall behind which half of the hemisphere lies: seen at a right angle it hides half the light.
            glm::vec3 side(random.direction());
            side = glm::normalize(side - normal * glm::dot(side, normal));
            const float plane[4] = {side.x, side.y, side.z, -100};
            scene.set_ground(plane);
            const Answer half = ask(scene, ao, {0, 0, 0}, normal);
            CHECK(half.visibility == Approx(0.5).margin(0.02));
            CHECK(std::abs(half.byte - 127.5) < 6);
            const glm::vec3 bent = glm::normalize(normal * (2.0f / 3) + side * (8 / (3 * 3.14159265f) / 2));
            for (int axis = 0; axis < 3; ++axis) CHECK(half.bent[axis] == Approx(bent[axis]).margin(0.03));
        }
    }
}

TEST_CASE("Outputs are the sums over the mask that the header states") {
    const Context context;
    const Field box = baked_directions(context, box_mesh({-1, -0.7f, -1}, {1, 0.7f, 1}), 8, 32);
    Scene scene(context);
    Random random(9);
    for (int i = 0; i < 6; ++i) {
        const glm::mat4 place = random_placement(random, {-2, -2, 0}, {2, 2, 2});
        scene.add(box, &place[0][0]);
    }
    for (const std::uint32_t sampling : {DFIELD_SAMPLING_HEMISPHERE, DFIELD_SAMPLING_SHARED})
        for (const std::uint32_t rays : {256u, 500u}) {
            const Ao ao(context, settings(sampling, rays));
            for (int i = 0; i < 20; ++i) {
                const glm::vec3 position(random.uniform(-2, 2), random.uniform(-2, 2), 0),
                    n(random.direction());
                const Answer answer = ask(scene, ao, position, n);
                float tangent[3], bitangent[3];
                dfield_frame(&n.x, tangent, bitangent);
                double all = 0, open = 0;
                glm::dvec3 bent(0);
                std::array<double, 9> sums{};
                for (std::uint32_t r = 0; r < rays; ++r) {
                    const float* d = ao.directions() + 3 * r;
                    glm::dvec3 w(d[0], d[1], d[2]);
                    double weight = 1;
                    if (sampling == DFIELD_SAMPLING_HEMISPHERE)
                        w = w.x * glm::dvec3(tangent[0], tangent[1], tangent[2]) +
                            w.y * glm::dvec3(bitangent[0], bitangent[1], bitangent[2]) + w.z * glm::dvec3(n);
                    else
                        weight = std::max(0.0, glm::dot(w, glm::dvec3(n)));
                    all += weight;
                    const bool blocked = answer.mask[r >> 5] >> (r & 31) & 1;
                    if (weight == 0) CHECK(!blocked);
                    if (blocked) continue;
                    open += weight;
                    bent += weight * w;
                    const auto y = harmonics_of(w);
                    for (std::size_t k = 0; k < 9; ++k) sums[k] += weight * y[k];
                }
                // Shared sampling takes the sum of weights from a table.
                CHECK(answer.visibility == Approx(open / all).margin(2e-3));
                CHECK(answer.byte == static_cast<int>(answer.visibility * 255 + 0.5f));
                bent = open > 0 ? glm::normalize(bent) : glm::dvec3(n);
                for (int axis = 0; axis < 3; ++axis)
                    CHECK(answer.bent[axis] == Approx(bent[axis]).margin(1e-4));
                for (std::size_t k = 0; k < 9; ++k)
                    CHECK(answer.harmonics[k] == Approx(sums[k] / all).margin(1e-5));
                // Bits beyond the last ray.
                if (rays % 32 != 0) CHECK(answer.mask.back() >> rays % 32 == 0);

                float alone = -1;
                scene.visibility(ao, one(position, n), &alone);
                CHECK(alone == Approx(answer.visibility).margin(2e-6));
            }
        }
}

TEST_CASE("A receiver that sees nothing, and one that has no normal") {
    const Context context;
    Scene scene(context);
    const float plane[4] = {0, 0, 1, 0};
    scene.set_ground(plane);
    for (const std::uint32_t sampling : {DFIELD_SAMPLING_HEMISPHERE, DFIELD_SAMPLING_SHARED}) {
        const Ao ao(context, settings(sampling, 256));
        const Answer closed = ask(scene, ao, {0, 0, 1}, {0, 0, -2});
        CHECK(closed.visibility == Approx(0).margin(2e-3));
        CHECK(closed.bent[2] == -1);
        for (const float coefficient : closed.harmonics) CHECK(coefficient == Approx(0).margin(1e-6));
        const Answer none = ask(scene, ao, {0, 0, 1}, {0, 0, 0});
        CHECK(none.visibility == 1);
        CHECK(none.bent[2] == Approx(1));
        CHECK(none.harmonics[0] == Approx(0.282095).margin(1e-5));
        for (const std::uint32_t word : none.mask) CHECK(word == 0);
    }
}

TEST_CASE("All levels of SIMD give the same outputs") {
    const auto bytes = baked_directions_bytes(box_mesh({-1, -0.7f, -1}, {1, 0.7f, 1}), 8, 32);
    std::vector<float> expected;
    std::vector<std::uint32_t> expected_masks;
    for (const std::uint32_t simd : {DFIELD_SIMD_SCALAR, DFIELD_SIMD_SSE4, DFIELD_SIMD_AVX2,
                                     DFIELD_SIMD_AVX512, DFIELD_SIMD_NEON, DFIELD_SIMD_BEST}) {
        dfield_context_desc hooks{};
        hooks.struct_size = sizeof hooks;
        hooks.simd = simd;
        const Context context(&hooks);
        if (simd != DFIELD_SIMD_BEST) CHECK((context.simd() == simd || context.simd() < simd));
        const Field box = Field::load(context, bytes.data(), bytes.size());
        Scene scene(context);
        Random random(21);
        for (int i = 0; i < 5; ++i) {
            const glm::mat4 place = random_placement(random, {-2, -2, 0}, {2, 2, 2});
            scene.add(box, &place[0][0]);
        }
        std::vector<float> found;
        std::vector<std::uint32_t> masks;
        for (const std::uint32_t sampling : {DFIELD_SAMPLING_HEMISPHERE, DFIELD_SAMPLING_SHARED}) {
            const Ao ao(context, settings(sampling, 144));
            for (int i = 0; i < 40; ++i) {
                const glm::vec3 position(random.uniform(-2, 2), random.uniform(-2, 2), 0),
                    n(random.direction());
                const Answer answer = ask(scene, ao, position, n);
                found.push_back(answer.visibility);
                found.insert(found.end(), answer.bent, answer.bent + 3);
                found.insert(found.end(), answer.harmonics, answer.harmonics + 9);
                masks.insert(masks.end(), answer.mask.begin(), answer.mask.end());
            }
        }
        if (expected.empty()) expected = found, expected_masks = masks;
        // Rounding may put a line into the next texel.
        std::size_t flips = 0;
        for (std::size_t i = 0; i < masks.size(); ++i)
            flips += static_cast<std::size_t>(__builtin_popcount(masks[i] ^ expected_masks[i]));
        CHECK(flips <= 6);
        std::size_t off = 0;
        for (std::size_t i = 0; i < found.size(); ++i) off += std::fabs(found[i] - expected[i]) > 1e-5f;
        CHECK(off <= 13 * flips);
    }
}

TEST_CASE("A light's share falls out of a mask") {
    const Context context;
    const Field box = baked_directions(context, box_mesh({-1, -1, -1}, {1, 1, 1}));
    Scene scene(context);
    const glm::mat4 above = [] {
        glm::mat4 m(0.5f);
        m[3] = glm::vec4(0, 0, 2, 1);
        return m;
    }();
    scene.add(box, &above[0][0]);
    for (const std::uint32_t sampling : {DFIELD_SAMPLING_HEMISPHERE, DFIELD_SAMPLING_SHARED}) {
        const Ao ao(context, settings(sampling, 1024));
        // A light overhead of some 15 degrees; the box hides it from the middle, not from afar.
        std::vector<float> weights(1024);
        for (std::size_t r = 0; r < weights.size(); ++r)
            weights[r] = ao.directions()[3 * r + 2] > 0.96f ? 1 : 0;
        const glm::vec3 positions[2] = {{0, 0, 0}, {5, 0, 0}}, normals[2] = {{0, 0, 1}, {0, 0, 2}};
        dfield_receivers receivers{};
        receivers.count = 2;
        receivers.positions = &positions[0].x;
        receivers.normals = &normals[0].x;
        std::vector<std::uint32_t> masks(2 * ao.mask_words());
        scene.visibility_mask(ao, receivers, masks.data());
        float light[2], sky[2], expected[2];
        ao.gather(receivers, masks.data(), weights.data(), light);
        CHECK(light[0] < 0.05f);
        CHECK(light[1] == 1);
        ao.gather(receivers, masks.data(), nullptr, sky);
        scene.visibility(ao, receivers, expected);
        for (int i = 0; i < 2; ++i) CHECK(sky[i] == Approx(expected[i]).margin(1e-3));
        std::fill(weights.begin(), weights.end(), 0.0f);
        ao.gather(receivers, masks.data(), weights.data(), light);
        CHECK(light[0] == 1);
    }
}

TEST_CASE("Shared directions: anywhere, of any weight") {
    const Context context;
    Scene scene(context);
    const float plane[4] = {0, 0, 1, 0};
    scene.set_ground(plane);
    const float directions[9] = {0, 0, 1, 0, 0.6f, -0.8f, 1, 0, 0}, weights[3] = {2, 4, 0};
    dfield_ao_desc desc = settings(DFIELD_SAMPLING_SHARED, 3);
    desc.directions = directions;
    desc.weights = weights;
    const Ao ao(context, desc);
    const glm::vec3 n = glm::normalize(glm::vec3(0, 0.6f, 0.2f));
    const double up = 2 * n.z, down = 4 * (0.6 * n.y - 0.8 * n.z);
    const Answer answer = ask(scene, ao, {0, 0, 1}, n);
    CHECK(answer.mask[0] == 2);
    CHECK(answer.visibility == Approx(up / (up + down)).margin(0.02));
    const auto refused = [&](auto&& change) {
        dfield_ao_desc bad = desc;
        change(bad);
        dfield_ao* handle = nullptr;
        CHECK(dfield_ao_create(context.get(), &bad, &handle) == DFIELD_INVALID_ARGUMENT);
    };
    const float negative[3] = {1, -1, 1}, infinite[3] = {1, std::numeric_limits<float>::infinity(), 1},
                lengthy[9]{2};
    refused([&](auto& bad) { bad.weights = negative; });
    refused([&](auto& bad) { bad.weights = infinite; });
    refused([&](auto& bad) { bad.directions = lengthy; });
    refused([&](auto& bad) { bad.sampling = 2; });
    refused([&](auto& bad) { bad.kind = DFIELD_KIND_VOLUME + 1; });
    refused([&](auto& bad) {
        bad.ray_count = DFIELD_MAX_SHARED_RAYS + 1, bad.directions = nullptr, bad.weights = nullptr;
    });
    refused([&](auto& bad) { bad.struct_size -= 1; });
}

TEST_CASE("Structs of version 0.1 are understood") {
    struct Old {
        std::size_t struct_size;
        std::uint32_t ray_count, falloff;
        float max_distance, falloff_rate;
        const float* falloff_table;
        std::size_t falloff_table_size;
        const float *directions, *weights;
        float bias;
    } old{sizeof(Old), 64, 0, std::numeric_limits<float>::infinity(), 0, nullptr, 0, nullptr, nullptr, 0};
    // What lies behind it, and its padding, mean nothing.
    alignas(dfield_ao_desc) unsigned char memory[2 * sizeof(dfield_ao_desc)];
    std::memset(memory, 0xee, sizeof memory);
    std::memcpy(memory, &old, offsetof(Old, bias) + sizeof(float));
    const Context context;
    dfield_ao* ao = nullptr;
    REQUIRE(dfield_ao_create(context.get(), reinterpret_cast<dfield_ao_desc*>(memory), &ao) == DFIELD_OK);
    CHECK(dfield_ao_get_mask_words(ao) == 2);
    dfield_ao_release(ao);

    dfield_context_desc hooks{};
    hooks.struct_size = offsetof(dfield_context_desc, log);
    std::memset(reinterpret_cast<unsigned char*>(&hooks) + hooks.struct_size, 0xee,
                sizeof hooks - hooks.struct_size);
    dfield_context* handle = nullptr;
    REQUIRE(dfield_context_create(&hooks, &handle) == DFIELD_OK);
    dfield_context_release(handle);
}
