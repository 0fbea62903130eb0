// The C ABI's promises: statuses and messages, ownership, hooks, hostile numbers.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <thread>

#include "tests/runtime/baked.hpp"
#include "tests/shapes.hpp"

using namespace dfield;
using test::kIdentity;

namespace {

const float kNaN = std::numeric_limits<float>::quiet_NaN();
const float kInf = std::numeric_limits<float>::infinity();

struct Heap {
    std::map<void*, std::size_t> live;
    std::size_t allowed = SIZE_MAX, total = 0;

    dfield_context_desc hooks() {
        dfield_context_desc desc{};
        desc.struct_size = sizeof desc;
        desc.user = this;
        desc.allocate = [](void* user, std::size_t size, std::size_t alignment) -> void* {
            Heap& heap = *static_cast<Heap*>(user);
            if (heap.allowed == 0) return nullptr;
            --heap.allowed;
            ++heap.total;
            void* memory = ::operator new (size, std::align_val_t{alignment});
            heap.live[memory] = size;
            return memory;
        };
        desc.deallocate = [](void* user, void* memory, std::size_t size, std::size_t alignment) {
            Heap& heap = *static_cast<Heap*>(user);
            REQUIRE(heap.live.at(memory) == size);
            heap.live.erase(memory);
            ::operator delete (memory, std::align_val_t{alignment});
        };
        return desc;
    }
};

dfield_receivers one_receiver(const float* position, const float* normal) {
    dfield_receivers receivers{};
    receivers.count = 1;
    receivers.positions = position;
    receivers.normals = normal;
    return receivers;
}

}  // namespace

TEST_CASE("Null pointers and wrong arguments get a status and a message") {
    dfield_context* context = nullptr;
    CHECK(dfield_context_create(nullptr, nullptr) == DFIELD_INVALID_ARGUMENT);
    dfield_context_desc desc{};
    CHECK(dfield_context_create(&desc, &context) == DFIELD_INVALID_ARGUMENT);
    CHECK(std::strstr(dfield_error_message(), "struct_size"));
    REQUIRE(dfield_context_create(nullptr, &context) == DFIELD_OK);
    dfield_field* field = nullptr;
    dfield_scene* scene = nullptr;
    CHECK(dfield_field_load_memory(context, nullptr, 4, &field) == DFIELD_INVALID_ARGUMENT);
    CHECK(dfield_field_load_memory(context, "junk", 4, &field) == DFIELD_FORMAT_ERROR);
    CHECK(dfield_field_load_file(context, "/nowhere/x.dfield", &field) == DFIELD_FILE_ERROR);
    CHECK(std::strstr(dfield_error_message(), "/nowhere/x.dfield"));
    CHECK(field == nullptr);
    CHECK(dfield_scene_create(context, nullptr) == DFIELD_INVALID_ARGUMENT);
    REQUIRE(dfield_scene_create(context, &scene) == DFIELD_OK);
    dfield_instance id;
    CHECK(dfield_scene_add_instance(scene, nullptr, kIdentity, &id) == DFIELD_INVALID_ARGUMENT);
    CHECK(dfield_scene_set_transform(scene, 0, kIdentity) == DFIELD_INVALID_ARGUMENT);
    CHECK(dfield_scene_remove_instance(scene, 7) == DFIELD_INVALID_ARGUMENT);
    CHECK(dfield_scene_trace(scene, nullptr, nullptr) == DFIELD_INVALID_ARGUMENT);
    CHECK(dfield_scene_visibility(scene, nullptr, nullptr, nullptr, 0) == DFIELD_INVALID_ARGUMENT);
    CHECK(dfield_field_get_info(nullptr, nullptr) == DFIELD_INVALID_ARGUMENT);
    CHECK(dfield_field_get_self_visibility(nullptr) == nullptr);
    CHECK(dfield_ao_get_directions(nullptr) == nullptr);
    for (int status = 0; status < 7; ++status)
        CHECK(std::strlen(dfield_status_name(static_cast<dfield_status>(status))) > 0);
    dfield_scene_release(scene);
    dfield_context_release(context);
    dfield_context_release(nullptr);
    dfield_field_release(nullptr);
    dfield_scene_release(nullptr);
    dfield_ao_release(nullptr);
}

TEST_CASE("Messages belong to the thread that failed") {
    CHECK(dfield_context_create(nullptr, nullptr) == DFIELD_INVALID_ARGUMENT);
    const std::string here = dfield_error_message();
    std::thread([] {
        CHECK(std::string(dfield_error_message()) == "no error");
        CHECK(dfield_field_get_info(nullptr, nullptr) == DFIELD_INVALID_ARGUMENT);
    }).join();
    CHECK(dfield_error_message() == here);
}

TEST_CASE("All memory comes from the hooks, is given back with its size, and queries take none") {
    Heap heap;
    const auto bytes = test::baked_bytes(test::box_mesh({-1, -1, -1}, {1, 1, 1}), 4, 8);
    {
        const dfield_context_desc hooks = heap.hooks();
        const Context context(&hooks);
        Scene scene(context);
        {
            const Field field = Field::load(context, bytes.data(), bytes.size());
            scene.add(field, kIdentity);
            scene.remove(scene.add(field, kIdentity));
        }  // the scene keeps it
        const Ao ao(context);
        const std::size_t before = heap.total;
        const float position[3] = {0, 0, -2}, normal[3] = {0, 0, 1};
        float visibility = 2, distance = 0;
        scene.visibility(ao, one_receiver(position, normal), &visibility);
        CHECK(visibility < 0.8f);
        dfield_rays rays{};
        rays.count = 1;
        rays.origins = position;
        rays.directions = normal;
        scene.trace(rays, {&distance, 0, nullptr, 0});
        CHECK(distance == Approx(1).margin(0.1));
        CHECK(heap.total == before);
    }
    CHECK(heap.live.empty());
}

TEST_CASE("Running out of memory anywhere is a status and leaks nothing") {
    const auto bytes = test::baked_bytes(test::box_mesh({-1, -1, -1}, {1, 1, 1}), 2, 4);
    std::size_t allowed = 0;
    for (bool done = false; !done; ++allowed) {
        Heap heap;
        heap.allowed = allowed;
        const dfield_context_desc hooks = heap.hooks();
        dfield_context* context = nullptr;
        dfield_field* field = nullptr;
        dfield_scene* scene = nullptr;
        dfield_instance id;
        dfield_ao* ao = nullptr;
        dfield_ao_desc desc;
        dfield_ao_desc_init(&desc);
        dfield_status status = dfield_context_create(&hooks, &context);
        if (!status) status = dfield_field_load_memory(context, bytes.data(), bytes.size(), &field);
        if (!status) status = dfield_scene_create(context, &scene);
        if (!status) status = dfield_scene_add_instance(scene, field, kIdentity, &id);
        if (!status) status = dfield_ao_create(context, &desc, &ao);
        CHECK((status == DFIELD_OK || status == DFIELD_OUT_OF_MEMORY));
        done = status == DFIELD_OK;
        dfield_ao_release(ao);
        dfield_scene_release(scene);
        dfield_field_release(field);
        dfield_context_release(context);
        CHECK(heap.live.empty());
        REQUIRE(allowed < 200);
    }
    CHECK(allowed > 5);
}

TEST_CASE("Truncated, flipped and foreign bytes are refused through the ABI") {
    auto bytes = test::baked_bytes(test::box_mesh({-1, -1, -1}, {1, 1, 1}), 2, 4);
    const Context context;
    dfield_field* field = nullptr;
    for (std::size_t size = 0; size < bytes.size(); ++size) {
        const std::vector<std::byte> prefix(bytes.begin(), bytes.begin() + size);
        REQUIRE(dfield_field_load_memory(context.get(), prefix.data(), size, &field) != DFIELD_OK);
    }
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        auto flipped = bytes;
        flipped[i] ^= std::byte{0x10};
        REQUIRE(dfield_field_load_memory(context.get(), flipped.data(), flipped.size(), &field) != DFIELD_OK);
    }
    CHECK(field == nullptr);
}

TEST_CASE("Loading from a path is loading its bytes") {
    const auto bytes = test::baked_bytes(test::box_mesh({-1, -1, -1}, {1, 1, 1}), 4, 8);
    const auto path = std::filesystem::temp_directory_path() / "dfield-runtime-\xc3\xa9.dfield";
    std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const Context context;
    const Field field = Field::load(context, path.string().c_str());
    const dfield_field_info info = field.info();
    CHECK(info.position_count == 66);
    CHECK(info.map_size == 8);
    CHECK(info.bits == 8);
    CHECK(info.radius == Approx(std::sqrt(3.0)));
    CHECK(info.bounds_min[2] == -1);
    CHECK(info.memory_bytes > 66 * 64);
    CHECK(info.self_vertex_count == 0);
    CHECK(field.self_visibility() == nullptr);
    std::filesystem::remove(path);
}

TEST_CASE("Baked self-visibility comes back") {
    const TriangleMesh mesh = test::sphere_mesh({0, 0, 0}, 1, 8);
    BakeOptions options;
    options.parameters.subdivision = 4;
    options.parameters.map_size = 8;
    options.self_visibility = true;
    const DisplacementField baked = bake_field(mesh, options);
    const auto bytes = write_field(baked);
    const Context context;
    const Field field = Field::load(context, bytes.data(), bytes.size());
    REQUIRE(field.info().self_vertex_count == mesh.positions.size());
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
        CHECK(field.self_visibility()[i] == Approx(baked.self_visibility[i] / 65535.0));
}

TEST_CASE("Transforms that cannot be inverted are refused and leave the scene as it was") {
    const Context context;
    const Field field = test::baked(context, test::box_mesh({-1, -1, -1}, {1, 1, 1}), 4, 8);
    Scene scene(context);
    const dfield_instance id = scene.add(field, kIdentity);
    const auto refused = [&](auto&& change) {
        float m[16];
        std::memcpy(m, kIdentity, sizeof m);
        change(m);
        CHECK(dfield_scene_set_transform(scene.get(), id, m) == DFIELD_INVALID_ARGUMENT);
        dfield_instance other = 77;
        CHECK(dfield_scene_add_instance(scene.get(), field.get(), m, &other) == DFIELD_INVALID_ARGUMENT);
        CHECK(other == 77);
    };
    refused([](float* m) { m[0] = 0; });
    refused([](float* m) { m[5] = kNaN; });
    refused([](float* m) { m[12] = kInf; });
    refused([](float* m) { m[3] = 0.5f; });
    refused([](float* m) { m[15] = 0; });
    refused([](float* m) { m[0] = m[5] = m[10] = 1e-38f; });
    refused([](float* m) { m[0] = m[5] = m[10] = 3e38f; });
    refused([](float* m) { std::memcpy(m + 4, m, 12); });
    CHECK(dfield_scene_set_transform(scene.get(), id, nullptr) == DFIELD_INVALID_ARGUMENT);
    const float o[3] = {0, 0, -5}, d[3] = {0, 0, 1};
    float t = 0;
    dfield_rays rays{};
    rays.count = 1, rays.origins = o, rays.directions = d;
    scene.trace(rays, {&t, 0, nullptr, 0});
    CHECK(t == Approx(4).margin(0.1));
}

TEST_CASE("Ids: used again after removal, refused when unknown") {
    const Context context;
    const Field field = test::baked(context, test::box_mesh({-1, -1, -1}, {1, 1, 1}), 4, 8);
    Scene scene(context);
    const auto a = scene.add(field, kIdentity), b = scene.add(field, kIdentity),
               c = scene.add(field, kIdentity);
    scene.remove(b);
    CHECK(dfield_scene_remove_instance(scene.get(), b) == DFIELD_INVALID_ARGUMENT);
    CHECK(scene.add(field, kIdentity) == b);
    scene.remove(a);
    scene.remove(b);
    scene.remove(c);
    const float o[3] = {0, 0, -5}, d[3] = {0, 0, 1};
    float t = 0;
    dfield_rays rays{};
    rays.count = 1, rays.origins = o, rays.directions = d;
    scene.trace(rays, {&t, 0, nullptr, 0});
    CHECK(t == kInf);
}

TEST_CASE("Rays and receivers of NaN, infinity, zero and denormals have their defined answers") {
    const Context context;
    const Field field = test::baked(context, test::box_mesh({-1, -1, -1}, {1, 1, 1}), 4, 8);
    Scene scene(context);
    scene.add(field, kIdentity);
    const float hostile[] = {kNaN, kInf, -kInf, 0.0f, 1e-40f, 3e38f, -3e38f};
    const Ao ao(context);
    for (const float a : hostile)
        for (const float b : hostile) {
            const float o[3] = {a, 0, b}, d[3] = {b, a, 0};
            float t = -1, visibility = -1;
            std::uint8_t occluded = 9;
            dfield_rays rays{};
            rays.count = 1, rays.origins = o, rays.directions = d;
            scene.trace(rays, {&t, 0, nullptr, 0});
            CHECK((t >= 0 && !std::isnan(t)));
            scene.occluded(rays, &occluded);
            CHECK(occluded <= 1);
            scene.visibility(ao, one_receiver(o, d), &visibility);
            CHECK((visibility >= 0 && visibility <= 1));
            std::uint32_t mask[8];
            scene.visibility_mask(ao, one_receiver(o, d), mask);
            if (!(std::isfinite(a) && std::isfinite(b)) || (a == 0 && b == 0)) {
                CHECK(t == kInf);
                CHECK(visibility == 1);
                CHECK(mask[0] == 0);
            }
        }
}

TEST_CASE("Ambient occlusion settings are checked") {
    const Context context;
    const auto refused = [&](auto&& change) {
        dfield_ao_desc desc = Ao::defaults();
        change(desc);
        dfield_ao* ao = nullptr;
        CHECK(dfield_ao_create(context.get(), &desc, &ao) == DFIELD_INVALID_ARGUMENT);
        CHECK(ao == nullptr);
    };
    refused([](auto& desc) { desc.struct_size = 0; });
    refused([](auto& desc) { desc.ray_count = 0; });
    refused([](auto& desc) { desc.ray_count = 65537; });
    refused([](auto& desc) { desc.falloff = 9; });
    refused([](auto& desc) { desc.max_distance = 0; });
    refused([](auto& desc) { desc.max_distance = kNaN; });
    refused([](auto& desc) { desc.falloff = DFIELD_FALLOFF_LINEAR; });
    refused([](auto& desc) { desc.bias = -1; });
    refused([](auto& desc) {
        desc.falloff = DFIELD_FALLOFF_EXPONENTIAL, desc.max_distance = 1, desc.falloff_rate = 0;
    });
    refused([](auto& desc) { desc.falloff = DFIELD_FALLOFF_TABLE, desc.max_distance = 1; });
    const float table[2] = {0, 1.5f};
    refused([&](auto& desc) {
        desc.falloff = DFIELD_FALLOFF_TABLE, desc.max_distance = 1;
        desc.falloff_table = table, desc.falloff_table_size = 2;
    });
    const float below[3] = {0, 0, -1}, up[3] = {0, 0, 1}, half = 0.5f;
    refused([&](auto& desc) { desc.ray_count = 1, desc.directions = below; });
    refused([&](auto& desc) { desc.ray_count = 1, desc.directions = up, desc.weights = &half; });
    refused([&](auto& desc) { desc.ray_count = 1, desc.weights = &half; });
}

TEST_CASE("Occlusion by distance: every falloff's closed form") {
    const Context context;
    const auto occlusion = [&](std::uint32_t falloff, float distance) {
        const float table[3] = {0.2f, 0.6f, 1.0f};
        dfield_ao_desc desc = Ao::defaults();
        desc.falloff = falloff;
        desc.max_distance = 4;
        desc.falloff_rate = 2;
        if (falloff == DFIELD_FALLOFF_TABLE) desc.falloff_table = table, desc.falloff_table_size = 3;
        const Ao ao(context, desc);
        return dfield_ao_get_occlusion(ao.get(), distance);
    };
    for (const float d : {0.0f, 1.0f, 2.0f, 3.5f}) {
        const float x = d / 4;
        CHECK(occlusion(DFIELD_FALLOFF_NONE, d) == 1);
        CHECK(occlusion(DFIELD_FALLOFF_LINEAR, d) == Approx(1 - x));
        CHECK(occlusion(DFIELD_FALLOFF_SMOOTH, d) == Approx(1 - x * x * (3 - 2 * x)));
        CHECK(occlusion(DFIELD_FALLOFF_EXPONENTIAL, d) ==
              Approx((std::exp(-2 * x) - std::exp(-2.0)) / (1 - std::exp(-2.0))));
        CHECK(occlusion(DFIELD_FALLOFF_TABLE, d) == Approx(0.8 - 0.8 * x));
    }
    for (std::uint32_t falloff = 0; falloff <= DFIELD_FALLOFF_TABLE; ++falloff) {
        CHECK(occlusion(falloff, 4) == 0);
        CHECK(occlusion(falloff, 100) == 0);
        CHECK(occlusion(falloff, kInf) == 0);
    }
}
