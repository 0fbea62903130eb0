// The ray kernels of every instruction set against the plain code: the same rays blocked, at the same
// distances, but for those that rounding puts into another texel.
#include <array>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <limits>

#include "baker/bake_lines.hpp"
#include "baker/scene.hpp"
#include "tests/random.hpp"
#include "tests/runtime/baked.hpp"
#include "tests/shapes.hpp"
#include "tests/test_data.hpp"

using namespace dfield;
using test::Random;

namespace {

constexpr std::array kLevels{DFIELD_SIMD_SSE4, DFIELD_SIMD_AVX2, DFIELD_SIMD_AVX512, DFIELD_SIMD_NEON};

// Rays that may end in another texel than the plain code's. Measured: 2e-5 .. 2e-4 of all rays that meet the
// sphere.
constexpr double kOtherTexel = 5e-4;

Context context_at(dfield_simd simd) {
    dfield_context_desc desc{};
    desc.struct_size = sizeof desc;
    desc.simd = simd;
    return Context(&desc);
}

TriangleMesh clutter() {
    TriangleMesh mesh = test::sphere_mesh({-0.6f, 0, 0.1f}, 0.5f, 20);
    test::append(mesh, test::box_mesh({0, -0.3f, -0.6f}, {1, 0.5f, 0.4f}));
    return mesh;
}

std::vector<std::byte> line_bytes(const TriangleMesh& mesh, bool pivot, std::uint32_t depth_bits) {
    BakeOptions options;
    options.parameters = kNoMaps;
    DisplacementField field = bake_field(mesh, options);
    LineParameters parameters;
    parameters.lattice = 24;
    parameters.pivot = pivot;
    parameters.depth_bits = depth_bits;
    parameters.depth_lattice = depth_bits ? 16 : 0;
    field.lines = bake_lines(mesh, {field.centre, field.radius}, {parameters});
    return write_field(field, {.zstd_level = 1});
}

// What one level says of receivers and rays around a few placements of an object. 300 rays: two blocks, the
// second with a tail.
struct Answers {
    std::vector<std::uint32_t> masks;
    std::vector<float> falloff;
    std::vector<std::uint8_t> occluded, occluded_near;
    std::vector<float> distances;
    std::vector<dfield_instance> instances;
    dfield_simd level;
};

Answers ask(dfield_simd simd, const std::vector<std::byte>& bytes) {
    const Context context = context_at(simd);
    const Field field = Field::load(context, bytes.data(), bytes.size());
    const dfield_field_info info = field.info();
    const float size = 1 / info.radius;
    Scene scene(context);
    const glm::mat4 unit = glm::translate(glm::scale(glm::mat4(1), glm::vec3(size)),
                                          -glm::vec3(info.centre[0], info.centre[1], info.centre[2]));
    Random random(7);
    for (const glm::vec3 scale : {glm::vec3(1), glm::vec3(0.7f, 1.2f, 0.9f), glm::vec3(-1, 1, 1)}) {
        const glm::mat4 turned(glm::mat3(random.rotation()));
        const glm::vec3 place(random.direction() * 1.4);
        scene.add(field, glm::value_ptr(glm::translate(glm::mat4(1), place) * turned *
                                        glm::scale(glm::mat4(1), scale) * unit));
    }
    std::vector<glm::vec3> positions, normals, directions;
    std::vector<float> limits;
    for (int i = 0; i < 400; ++i) {
        positions.emplace_back(random.direction() * random.uniform(0.1, 4));
        normals.emplace_back(random.direction());
    }
    dfield_receivers receivers{};
    receivers.count = positions.size();
    receivers.positions = &positions.front().x;
    receivers.normals = &normals.front().x;
    dfield_ao_desc desc = Ao::defaults();
    desc.ray_count = 300;
    desc.bias = 0.01f;

    Answers answers;
    answers.level = context.simd();
    const Ao ao(context, desc);
    answers.masks.resize(receivers.count * ao.mask_words());
    scene.visibility_mask(ao, receivers, answers.masks.data());
    desc.max_distance = 1.5f;
    desc.falloff = DFIELD_FALLOFF_LINEAR;
    answers.falloff.resize(receivers.count);
    scene.visibility(Ao(context, desc), receivers, answers.falloff.data());

    positions.clear();
    for (int i = 0; i < 20011; ++i) {
        positions.emplace_back(random.direction() * random.uniform(0.1, 4));
        directions.emplace_back(random.direction() * random.uniform(0.5, 2));
        limits.push_back(static_cast<float>(random.uniform(0, 3)));
    }
    dfield_rays rays{};
    rays.count = positions.size();
    rays.origins = &positions.front().x;
    rays.directions = &directions.front().x;
    answers.occluded.resize(rays.count);
    scene.occluded(rays, answers.occluded.data());
    answers.distances.resize(rays.count);
    answers.instances.resize(rays.count);
    scene.trace(rays, {answers.distances.data(), 0, answers.instances.data(), 0});
    rays.max_distances = limits.data();
    answers.occluded_near.resize(rays.count);
    scene.occluded(rays, answers.occluded_near.data());
    return answers;
}

double different(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) count += a[i] != b[i];
    return static_cast<double>(count) / static_cast<double>(a.size());
}

void compare(const Answers& plain, const Answers& fast) {
    INFO("level " << fast.level);
    std::size_t hits = 0, other = 0;
    for (std::size_t i = 0; i < plain.masks.size(); ++i) {
        hits += std::popcount(plain.masks[i]);
        other += std::popcount(plain.masks[i] ^ fast.masks[i]);
    }
    const double rays = 400.0 * 300;
    CHECK(static_cast<double>(hits) > 0.1 * rays);
    CHECK(static_cast<double>(other) <= kOtherTexel * rays);

    // Even a receiver whose rays change texel changes little.
    double worst = 0, sum = 0;
    for (std::size_t i = 0; i < plain.falloff.size(); ++i) {
        const double error = std::fabs(plain.falloff[i] - fast.falloff[i]);
        worst = std::max(worst, error);
        sum += error;
    }
    CHECK(worst <= 0.02);
    CHECK(sum <= 2 * kOtherTexel * 400);

    CHECK(different(plain.occluded, fast.occluded) <= kOtherTexel);
    CHECK(different(plain.occluded_near, fast.occluded_near) <= 2 * kOtherTexel);
    std::size_t elsewhere = 0;
    for (std::size_t i = 0; i < plain.distances.size(); ++i) {
        const float a = plain.distances[i], b = fast.distances[i];
        elsewhere += !(a == b || std::fabs(a - b) < 1e-4f) || plain.instances[i] != fast.instances[i];
    }
    CHECK(static_cast<double>(elsewhere) <= 3 * kOtherTexel * static_cast<double>(plain.distances.size()));
}

void compare_levels(const std::vector<std::byte>& bytes) {
    const Answers plain = ask(DFIELD_SIMD_SCALAR, bytes);
    REQUIRE(plain.level == DFIELD_SIMD_SCALAR);
    for (const dfield_simd level : kLevels) compare(plain, ask(level, bytes));
}

// Masks of receivers around three placements, one of them skewed, for rays in directions of the caller's.
std::vector<std::uint32_t> masks_of(dfield_simd simd, const std::vector<std::byte>& bytes,
                                    dfield_ao_desc desc) {
    const Context context = context_at(simd);
    const Field field = Field::load(context, bytes.data(), bytes.size());
    const dfield_field_info info = field.info();
    Scene scene(context);
    Random random(11);
    for (const glm::vec3 scale : {glm::vec3(1), glm::vec3(0.5f, 1.3f, 0.9f), glm::vec3(2)})
        scene.add(field, glm::value_ptr(glm::translate(glm::mat4(1), glm::vec3(random.direction() * 2.0)) *
                                        glm::mat4(glm::mat3(random.rotation())) *
                                        glm::scale(glm::mat4(1), scale / info.radius)));
    std::vector<glm::vec3> positions, normals;
    for (int i = 0; i < 600; ++i) {
        positions.emplace_back(random.direction() * random.uniform(0.1, 8));
        normals.emplace_back(random.direction());
    }
    dfield_receivers receivers{};
    receivers.count = positions.size();
    receivers.positions = &positions.front().x;
    receivers.normals = &normals.front().x;
    const Ao ao(context, desc);
    std::vector<std::uint32_t> masks(receivers.count * ao.mask_words());
    scene.visibility_mask(ao, receivers, masks.data());
    return masks;
}

// Groups of neighbouring rays are culled by the cones around them; the plain code knows none.
void compare_groups(const std::vector<std::byte>& bytes, dfield_kind kind) {
    for (const dfield_sampling sampling : {DFIELD_SAMPLING_HEMISPHERE, DFIELD_SAMPLING_SHARED})
        for (const std::uint32_t count : {1u, 5u, 17u, 100u, 700u}) {
            INFO("sampling " << sampling << ", " << count << " rays");
            Random random(count);
            std::vector<glm::vec3> directions;
            for (std::uint32_t i = 0; i < count; ++i) {
                glm::vec3 w(random.direction());
                if (sampling == DFIELD_SAMPLING_HEMISPHERE) w.z = std::fabs(w.z);
                directions.push_back(w);
            }
            dfield_ao_desc desc = Ao::defaults();
            desc.kind = kind;
            desc.sampling = sampling;
            desc.ray_count = count;
            desc.directions = &directions.front().x;
            const std::vector<std::uint32_t> plain = masks_of(DFIELD_SIMD_SCALAR, bytes, desc);
            std::size_t hits = 0;
            for (const std::uint32_t word : plain) hits += std::popcount(word);
            CHECK(hits > 10 * count);
            for (const dfield_simd level : kLevels) {
                INFO("level " << level);
                const std::vector<std::uint32_t> fast = masks_of(level, bytes, desc);
                std::size_t other = 0;
                for (std::size_t i = 0; i < plain.size(); ++i) other += std::popcount(plain[i] ^ fast[i]);
                CHECK(static_cast<double>(other) <= 1 + 0.1 * kOtherTexel * 600 * count);
            }
        }
}

}  // namespace

TEST_CASE("Culling groups of rays loses none") {
    // Fills its bounding sphere, so that rays along the rim count.
    const TriangleMesh mesh = test::sphere_mesh(glm::vec3(0), 1, 40);
    compare_groups(test::baked_bytes(mesh, 13, 16, 8), DFIELD_KIND_MAPS);
    compare_groups(line_bytes(mesh, false, 8), DFIELD_KIND_LINES);
}

TEST_CASE("Displacement maps: every level finds what the plain code finds") {
    const TriangleMesh mesh = clutter();
    for (const std::uint32_t bits : {1u, 8u})
        for (const std::uint32_t n : {1u, 2u, 13u, 32u}) {
            INFO(bits << " bits, n = " << n);
            compare_levels(test::baked_bytes(mesh, n, n == 13 ? 17 : 16, bits));
        }
}

TEST_CASE("Line tables: every level finds what the plain code finds") {
    const TriangleMesh mesh = clutter();
    for (const bool pivot : {false, true})
        for (const std::uint32_t depth_bits : {0u, 4u, 8u}) {
            INFO("pivot " << pivot << ", depth bits " << depth_bits);
            compare_levels(line_bytes(mesh, pivot, depth_bits));
        }
}

TEST_CASE("Fields without kernels answer the same bits at every level") {
    const TriangleMesh mesh = clutter();
    for (const auto& bytes :
         {test::baked_bytes(mesh, 8, 16, 8, Mapping::kPolar), test::baked_bytes(mesh, 8, 16, 16),
          test::baked_bytes(mesh, 8, 16, 8, Mapping::kConcentric, Positions::kLatlong)}) {
        const Answers plain = ask(DFIELD_SIMD_SCALAR, bytes), fast = ask(DFIELD_SIMD_BEST, bytes);
        CHECK(plain.masks == fast.masks);
        CHECK(plain.falloff == fast.falloff);
        CHECK(plain.distances == fast.distances);
    }
}

TEST_CASE("A real model: every level finds what the plain code finds") {
    const auto path = test::shared_file("models/stanford-bunny.obj");
    if (!path) return;
    const TriangleMesh mesh = flatten_scene(import_scene(*path));
    compare_levels(test::baked_bytes(mesh, 32, 32, 8));
    compare_levels(line_bytes(mesh, false, 8));
}
