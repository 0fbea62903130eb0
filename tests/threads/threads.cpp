// Several threads at once: what ThreadSanitizer looks at (tests/package/thread_sanitizer.cmake).
#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <mutex>
#include <optional>
#include <thread>

#include "dfield/threads.hpp"
#include "tests/runtime/placements.hpp"
#include "tests/test_data.hpp"

using namespace dfield;
using namespace dfield::test;

TEST_CASE("Snapshots are queried while the scene is edited and committed") {
    Threads threads(2);
    dfield_context_desc hooks{};
    hooks.struct_size = sizeof hooks;
    threads.install(hooks);
    const Context context(&hooks);
    const Field field =
        Field::load(context, source_file("tests/golden/v1.1-all-kinds.dfield").string().c_str());
    Scene scene(context);
    Random random(4);
    std::vector<dfield_instance> ids;
    for (int i = 0; i < 10; ++i) {
        const glm::mat4 place = random_placement(random, {-4, -4, 0}, {4, 4, 2});
        ids.push_back(scene.add(field, &place[0][0]));
    }
    dfield_ao_desc desc = Ao::defaults();
    desc.ray_count = 64;
    desc.sampling = DFIELD_SAMPLING_SHARED;
    const Ao ao(context, desc);
    ReceiverList list;
    for (int i = 0; i < 100; ++i) {
        list.positions.emplace_back(random.uniform(-4, 4), random.uniform(-4, 4), 0);
        list.normals.emplace_back(0, 0, 1);
    }
    std::mutex latest_mutex;
    std::optional<Snapshot> latest(scene.commit());
    const auto read_latest = [&] {
        const std::lock_guard lock(latest_mutex);
        return Snapshot(*latest);
    };
    std::atomic<bool> stop{false};
    std::atomic<int> answers{0}, wrong{0};
    const auto reader = [&](bool with_set) {
        ReceiverSet set(context, ao, list.view());
        std::vector<float> values(list.size()), again(list.size());
        while (!stop) {
            const Snapshot snapshot = read_latest();
            snapshot.visibility(ao, list.view(), values.data());
            snapshot.visibility(ao, list.view(), again.data());
            if (values != again) ++wrong;
            if (with_set) set.update(snapshot);
            ++answers;
        }
    };
    std::thread first(reader, true), second(reader, false);
    for (int edit = 0; edit < 60 || answers < 20; ++edit) {
        const glm::mat4 place = random_placement(random, {-4, -4, 0}, {4, 4, 2});
        const dfield_instance id = ids[random.below(10)];
        scene.set_transform(id, &place[0][0]);
        if (edit % 5 == 0) scene.set_hidden(id, edit % 10 == 0);
        if (edit % 7 == 0) {
            scene.remove(ids[3]);
            ids[3] = scene.add(field, &place[0][0]);
        }
        Snapshot snapshot = scene.commit();
        const std::lock_guard lock(latest_mutex);
        latest = std::move(snapshot);
    }
    stop = true;
    first.join();
    second.join();
    CHECK(wrong == 0);
}

TEST_CASE("The thread adapter covers every index once, also from within itself and from several threads") {
    Threads threads(4);
    CHECK(threads.size() == 4);
    const auto run = [&](std::size_t count) {
        std::vector<std::atomic<int>> seen(count);
        threads.parallel_for(
            count,
            [](void* data, std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i)
                    ++(*static_cast<std::vector<std::atomic<int>>*>(data))[i];
            },
            &seen);
        return std::all_of(seen.begin(), seen.end(), [](const auto& times) { return times == 1; });
    };
    for (const std::size_t count : {0u, 1u, 2u, 3u, 100u, 100000u}) CHECK(run(count));
    std::atomic<int> good{0};
    std::thread others[3];
    for (std::thread& other : others)
        other = std::thread([&] {
            for (int i = 0; i < 50; ++i) good += run(1000);
        });
    for (std::thread& other : others) other.join();
    CHECK(good == 150);
    struct Nested {
        Threads& threads;
        std::atomic<std::size_t> sum{0};
    } nested{threads};
    threads.parallel_for(
        8,
        [](void* data, std::size_t begin, std::size_t end) {
            Nested& outer = *static_cast<Nested*>(data);
            for (std::size_t i = begin; i < end; ++i)
                outer.threads.parallel_for(
                    10,
                    [](void* inner, std::size_t b, std::size_t e) {
                        static_cast<Nested*>(inner)->sum += e - b;
                    },
                    data);
        },
        &nested);
    CHECK(nested.sum == 80);
}
