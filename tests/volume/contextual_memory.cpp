// What a session holds, and what becomes of it when there is no more.
#include <catch2/catch.hpp>
#include <cstdlib>

#include "tests/volume/cut_volumes.hpp"

using namespace dfield;
using namespace dfield::test;

namespace {

// Hooks that know what is held, and fail when they are told to.
struct Memory {
    std::size_t held = 0;
    int left = -1;  // allocations until they fail; below 0: any number

    dfield_context_desc hooks() {
        dfield_context_desc desc = context_desc(DFIELD_SIMD_BEST);
        desc.user = this;
        desc.allocate = [](void* user, std::size_t size, std::size_t alignment) -> void* {
            Memory& memory = *static_cast<Memory*>(user);
            if (memory.left == 0) return nullptr;
            if (memory.left > 0) --memory.left;
            memory.held += size;
            return std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
        };
        desc.deallocate = [](void* user, void* memory, std::size_t size, std::size_t) {
            static_cast<Memory*>(user)->held -= size;
            std::free(memory);
        };
        return desc;
    }
};

}  // namespace

TEST_CASE("A session holds two and a half volumes and what clips have an effect on",
          "[volume][contextual][memory]") {
    Memory memory;
    const dfield_context_desc hooks = memory.hooks();
    const Context context(&hooks);
    Random random(6);
    const Meshes meshes(context);
    Cut scene;
    scene.volume = blobs({192, 160, 128}, 4);
    scene.local = local_desc(6, 4);
    const auto volumes = [&, before = memory.held] {
        return static_cast<double>(memory.held - before) /
               (sizeof(float) * static_cast<double>(scene.volume.values.size()));
    };
    Contextual session(context, scene.desc());
    session.update();
    const double unclipped = volumes();
    CHECK(unclipped < 2.7);
    const dfield_clip clip = placed(meshes.meshes[1], DFIELD_CLIP_SUBTRACT, random, {96, 80, 64}, 40);
    const std::uint32_t id = session.add(clip);
    session.update();
    CHECK(volumes() > unclipped);
    CHECK(volumes() < unclipped + 0.5);
    session.remove(id);
    session.update();
    CHECK(volumes() < unclipped + 0.01);
    // Nothing is left: all is affected.
    session.add(placed(meshes.meshes[1], DFIELD_CLIP_PROBE, random, {-900, 0, 0}, 4));
    session.update();
    CHECK(volumes() < 5);
}

TEST_CASE("An update without memory can be made again", "[volume][contextual][memory]") {
    Memory memory;
    const dfield_context_desc hooks = memory.hooks();
    const Context context(&hooks);
    const Meshes meshes(context);
    Random random(7);
    for (const dfield_update_mask mask : {DFIELD_UPDATE_CHANGED, DFIELD_UPDATE_DILATED}) {
        int failed = 0;
        for (int last = 0; last < 12; last += mask == DFIELD_UPDATE_DILATED ? 4 : 1) {
            Cut scene;
            scene.mask = mask;
            scene.volume = blobs({40, 26, 18}, random.below(100));
            scene.local = local_desc(14, 6);
            Contextual session(context, scene.desc());
            for (int frame = 0; frame < 4; ++frame) {
                random_change(random, meshes, scene, session);
                memory.left = last;
                dfield_update_result result{};
                const dfield_status status = dfield_contextual_update(session.get(), nullptr, &result);
                memory.left = -1;
                CHECK((status == DFIELD_OK || status == DFIELD_OUT_OF_MEMORY));
                failed += status == DFIELD_OUT_OF_MEMORY;
                if (frame % 2) CHECK(session.update().is_final == 1);
            }
            CHECK(scene.wrong(context, session.visibility()) == 0);
        }
        CHECK(failed > 2);
    }
}
