// Ten thousand random updates of one session, the identity checked at random frames. DFIELD_SOAK=N: N times
// as many.
#include <catch2/catch.hpp>
#include <cstdlib>

#include "tests/volume/cut_volumes.hpp"

using namespace dfield;
using namespace dfield::test;

TEST_CASE("Ten thousand updates leave what a computation from scratch finds", "[volume][contextual]") {
    const char* const more = std::getenv("DFIELD_SOAK");
    const int updates = 10000 * (more ? std::max(1, std::atoi(more)) : 1);
    Random random(11);
    const Context context;
    const Meshes meshes(context);
    Cut scene;
    scene.volume = blobs({40, 26, 18}, 3);
    scene.local = local_desc(14, 6);
    scene.clip_samples = 8;
    Contextual session(context, scene.desc());
    int calls = 0;
    dfield_update_desc cut_short = cancelled_after(calls);
    int checked = 0;
    for (int i = 0; i < updates; ++i) {
        random_change(random, meshes, scene, session);
        while (scene.clips.size() > 4) {
            session.remove(scene.clips.begin()->first);
            scene.clips.erase(scene.clips.begin());
        }
        // Now and then an update ends before it has finished; the next ones catch up.
        calls = static_cast<int>(random.below(8));
        const bool final = session.update(random.below(20) == 0 ? &cut_short : nullptr).is_final == 1;
        if (!final || random.below(150) != 0) continue;
        ++checked;
        INFO("update " << i);
        REQUIRE(scene.wrong(context, session.visibility()) == 0);
    }
    CHECK(checked > updates / 300);
}
