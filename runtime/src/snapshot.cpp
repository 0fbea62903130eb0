// Snapshots: a copy of the scene's state, with a hierarchy that the scene keeps from commit to commit.
#include "scene.hpp"
#include "status.hpp"

extern "C" {

dfield_status dfield_scene_commit(dfield_scene* scene, dfield_snapshot** snapshot) {
    using namespace dfield::runtime;
    return guarded([&] {
        require(scene && snapshot, "dfield_scene_commit: scene or snapshot is null");
        const SceneState& state = scene->state;
        if (scene->tree_stale || !scene->committed.refit(state.instances)) {
            scene->tree_stale = true;  // also where building runs out of memory
            scene->committed.build(state.instances, state.active);
            scene->tree_stale = false;
        }
        dfield_snapshot* made = dfield_snapshot::make(state.context(), state);
        try {
            made->scene.state.hierarchy.emplace(scene->committed, state.context());
        } catch (...) {
            made->release();
            throw;
        }
        *snapshot = made;
    });
}

void dfield_snapshot_retain(dfield_snapshot* snapshot) {
    if (snapshot) snapshot->retain();
}

void dfield_snapshot_release(dfield_snapshot* snapshot) {
    if (snapshot) snapshot->release();
}

const dfield_scene* dfield_snapshot_get_scene(const dfield_snapshot* snapshot) {
    return snapshot ? &snapshot->scene : nullptr;
}
}
