// What queries promise: no allocation, a bounded stack, the same answers however a batch is split.
#include <catch2/catch.hpp>
#include <cstring>

#include "tests/runtime/baked_directions.hpp"
#include "tests/runtime/counted.hpp"
#include "tests/runtime/placements.hpp"
#include "tests/shapes.hpp"

#if defined(__linux__)
#include <pthread.h>
#endif

using namespace dfield;
using namespace dfield::test;

namespace {

struct World {
    Context context;
    Field box;
    Scene scene;
    ReceiverList list;
    std::vector<float> floats, visibility, distances;
    std::vector<std::uint32_t> masks;
    std::vector<std::uint8_t> bytes;

    explicit World(const dfield_context_desc& hooks)
        : context(&hooks),
          box(baked_directions(context, box_mesh({-1, -0.7f, -1}, {1, 0.7f, 1}), 8, 32, 16)),
          scene(context) {
        Random random(8);
        for (int i = 0; i < 20; ++i) {
            const glm::mat4 place = random_placement(random, {-4, -4, 0}, {4, 4, 2});
            scene.add(box, &place[0][0]);
        }
        const float plane[4] = {0, 0, 1, -0.5f};
        scene.set_ground(plane);
        for (int i = 0; i < 3000; ++i) {
            list.positions.emplace_back(random.uniform(-4, 4), random.uniform(-4, 4), random.uniform(0, 1));
            list.normals.emplace_back(random.direction());
        }
        floats.resize(9 * list.size());
        visibility.resize(list.size());
        distances.resize(list.size());
        masks.resize(32 * list.size());
        bytes.resize(list.size());
    }

    // Every query, of receivers [begin, end) and of rays from them.
    void ask(const dfield_scene* asked, const Ao& ao, std::size_t begin, std::size_t end) {
        dfield_receivers receivers = list.view();
        receivers.positions += 3 * begin;
        receivers.normals += 3 * begin;
        receivers.count = end - begin;
        dfield_outputs outputs = no_outputs();
        outputs.masks = masks.data() + begin * ao.mask_words();
        outputs.visibility8 = bytes.data();
        outputs.bent_normals = floats.data();
        check(dfield_scene_ambient(asked, ao.get(), &receivers, &outputs));
        outputs = no_outputs();
        outputs.harmonics = floats.data();
        check(dfield_scene_ambient(asked, ao.get(), &receivers, &outputs));
        ao.gather(receivers, masks.data(), nullptr, floats.data());
        check(dfield_scene_visibility(asked, ao.get(), &receivers, visibility.data() + begin, 0));
        dfield_rays rays{};
        rays.count = receivers.count;
        rays.origins = receivers.positions;
        rays.directions = receivers.normals;
        check(dfield_scene_occluded(asked, &rays, bytes.data()));
        const dfield_hits hits{distances.data() + begin, 0, nullptr, 0};
        check(dfield_scene_trace(asked, &rays, &hits));
    }
};

std::vector<dfield_ao_desc> all_settings() {
    std::vector<dfield_ao_desc> settings;
    for (const std::uint32_t sampling : {DFIELD_SAMPLING_HEMISPHERE, DFIELD_SAMPLING_SHARED})
        for (const std::uint32_t rays : {64u, 1000u})
            for (const bool falloff : {false, true}) {
                if (falloff && rays == 1000) continue;
                dfield_ao_desc desc = Ao::defaults();
                desc.sampling = sampling;
                desc.ray_count = rays;
                if (falloff) desc.falloff = DFIELD_FALLOFF_LINEAR, desc.max_distance = 2;
                settings.push_back(desc);
            }
    return settings;
}

}  // namespace

TEST_CASE("Queries allocate nothing") {
    std::size_t allocations = 0;
    World world(counting_hooks(allocations));
    for (const dfield_ao_desc& desc : all_settings()) {
        const Ao ao(world.context, desc);
        const Snapshot snapshot = world.scene.commit();
        const std::size_t before = allocations;
        world.ask(world.scene.scene_handle(), ao, 0, 200);
        world.ask(snapshot.scene_handle(), ao, 0, 200);
        CHECK(allocations == before);
    }
    CHECK(allocations > 10);
}

TEST_CASE("Running out of memory in commits and updates is a status, leaks nothing, and is made up for") {
    struct Heap {
        std::size_t allowed = SIZE_MAX, live = 0;
    } heap;
    dfield_context_desc hooks{};
    hooks.struct_size = sizeof hooks;
    hooks.user = &heap;
    hooks.allocate = [](void* user, std::size_t size, std::size_t alignment) -> void* {
        Heap& counted = *static_cast<Heap*>(user);
        if (counted.allowed == 0) return nullptr;
        --counted.allowed;
        ++counted.live;
        return ::operator new (size, std::align_val_t{alignment});
    };
    hooks.deallocate = [](void* user, void* memory, std::size_t, std::size_t alignment) {
        --static_cast<Heap*>(user)->live;
        ::operator delete (memory, std::align_val_t{alignment});
    };
    {
        World world(hooks);
        dfield_ao_desc desc = Ao::defaults();
        desc.sampling = DFIELD_SAMPLING_SHARED;
        desc.ray_count = 64;
        const Ao ao(world.context, desc);
        dfield_receivers receivers = world.list.view();
        receivers.count = 100;
        const glm::mat4 moved(1.0f);
        std::size_t refused = 0;
        for (std::size_t allowed = 0;; ++allowed) {
            const std::size_t before = heap.live;
            dfield_receiver_set* created = nullptr;
            dfield_snapshot* snapshot = nullptr;
            dfield_receiver_set_desc set_desc{};
            set_desc.struct_size = sizeof set_desc;
            set_desc.ao = ao.get();
            set_desc.receivers = receivers;
            world.scene.set_transform(0, &moved[0][0]);
            heap.allowed = allowed;
            dfield_status status = dfield_receiver_set_create(world.context.get(), &set_desc, &created);
            if (!status) status = dfield_scene_commit(world.scene.get(), &snapshot);
            if (!status) status = dfield_receiver_set_update(created, snapshot, nullptr);
            heap.allowed = SIZE_MAX;
            const bool done = status == DFIELD_OK;
            refused += status == DFIELD_OUT_OF_MEMORY;
            CHECK((done || status == DFIELD_OUT_OF_MEMORY));
            // What failed works when there is memory.
            if (created) {
                const Snapshot later = world.scene.commit();
                ReceiverSet fresh(world.context, ao, receivers);
                fresh.update(later);
                REQUIRE(dfield_receiver_set_update(created, later.get(), nullptr) == DFIELD_OK);
                CHECK(std::memcmp(dfield_receiver_set_get_visibility(created), fresh.visibility(),
                                  receivers.count * sizeof(float)) == 0);
            }
            dfield_receiver_set_release(created);
            dfield_snapshot_release(snapshot);
            // The scene may have grown the hierarchy that it keeps.
            CHECK(heap.live <= before + 4);
            if (done) break;
            REQUIRE(allowed < 300);
        }
        CHECK(refused > 8);
    }
    CHECK(heap.live == 0);
}

TEST_CASE("Batches may be split anywhere") {
    dfield_context_desc hooks{};
    hooks.struct_size = sizeof hooks;
    World world(hooks);
    for (const dfield_ao_desc& desc : all_settings()) {
        const std::size_t count = desc.sampling == DFIELD_SAMPLING_SHARED && desc.falloff == 0 ? 3000 : 300;
        const Ao ao(world.context, desc);
        world.ask(world.scene.scene_handle(), ao, 0, count);
        const std::vector<float> visibility = world.visibility, distances = world.distances;
        const std::vector<std::uint32_t> masks = world.masks;
        for (std::size_t begin = 0; begin < count;) {
            const std::size_t end = std::min(count, begin + 1 + begin / 2);
            world.ask(world.scene.scene_handle(), ao, begin, end);
            begin = end;
        }
        CHECK(visibility == world.visibility);
        CHECK(distances == world.distances);
        CHECK(masks == world.masks);
    }
}

#if defined(__linux__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST_CASE("Queries keep to the stack that the header states") {
    struct Job {
        World* world;
        const Ao* ao;
    };
    constexpr std::size_t kStated = 512 << 10, kFrames = 16 << 10, kStack = 2 << 20;
    dfield_context_desc hooks{};
    hooks.struct_size = sizeof hooks;
    World world(hooks);
    for (const dfield_ao_desc& desc : all_settings()) {
        const Ao ao(world.context, desc);
        Job job{&world, &ao};
        // A thread on a painted stack: what is no longer painted was used.
        constexpr unsigned char kPaint = 0xa5;
        auto* const stack = static_cast<unsigned char*>(::operator new (kStack, std::align_val_t{4096}));
        std::memset(stack, kPaint, kStack);
        pthread_attr_t attributes;
        REQUIRE(pthread_attr_init(&attributes) == 0);
        REQUIRE(pthread_attr_setstack(&attributes, stack, kStack) == 0);
        pthread_t thread;
        REQUIRE(pthread_create(
                    &thread, &attributes,
                    [](void* data) -> void* {
                        const Job& asked = *static_cast<Job*>(data);
                        asked.world->ask(asked.world->scene.scene_handle(), *asked.ao, 0, 2500);
                        return nullptr;
                    },
                    &job) == 0);
        pthread_join(thread, nullptr);
        pthread_attr_destroy(&attributes);
        std::size_t unused = 0;
        while (unused < kStack && stack[unused] == kPaint) ++unused;
        ::operator delete (stack, std::align_val_t{4096});
        INFO("sampling " << desc.sampling << " rays " << desc.ray_count << " falloff " << desc.falloff);
        CHECK(kStack - unused < kStated + kFrames);  // the thread's own frames, and the test's
    }
}
#endif
