/* Scenes of instances, and their snapshots. Part of dfield.h. */
#ifndef DFIELD_SCENE_H
#define DFIELD_SCENE_H

#include "dfield/field.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Edited by one thread at a time. It may be queried from any number of threads while nobody edits it; to
   query while it is edited, query a snapshot. */
typedef struct dfield_scene dfield_scene;
typedef uint32_t dfield_instance; /* id, valid until removed; ids are used again */
#define DFIELD_NO_INSTANCE UINT32_MAX

DFIELD_API dfield_status dfield_scene_create(dfield_context* context, dfield_scene** scene);
DFIELD_API void dfield_scene_release(dfield_scene* scene); /* null is fine; snapshots live on */

/* Edits. A call that fails leaves the scene as it was.
   object_to_world: 16 floats, column-major, finite, last row 0 0 0 1, any invertible affine matrix
   (non-uniform and mirrored scale too). The scene keeps the field. */
DFIELD_API dfield_status dfield_scene_add_instance(dfield_scene* scene, dfield_field* field,
                                                   const float* object_to_world, dfield_instance* instance);
DFIELD_API dfield_status dfield_scene_remove_instance(dfield_scene* scene, dfield_instance instance);
DFIELD_API dfield_status dfield_scene_set_transform(dfield_scene* scene, dfield_instance instance,
                                                    const float* object_to_world);
/* Many at once: matrix i, `stride` bytes after the one before (0 = packed), goes to instances[i]. All or
 * none. */
DFIELD_API dfield_status dfield_scene_set_transforms(dfield_scene* scene, size_t count,
                                                     const dfield_instance* instances,
                                                     const float* object_to_world, size_t stride);
/* Another field in the same place, such as another level of detail. */
DFIELD_API dfield_status dfield_scene_set_field(dfield_scene* scene, dfield_instance instance,
                                                dfield_field* field);
/* A hidden instance occludes nothing and keeps its id; 0 shows it again. */
DFIELD_API dfield_status dfield_scene_set_hidden(dfield_scene* scene, dfield_instance instance, int hidden);
/* Solid ground below the plane n.p = d, with plane = {n.x, n.y, n.z, d} and n not zero: rays that go against
   n hit it, those that start below it at distance 0; rays that go along n never do, so that vertices which
   rounding put a little below the ground are not buried. Null turns it off (the default). */
DFIELD_API dfield_status dfield_scene_set_ground(dfield_scene* scene, const float* plane);

/* The scene as it is now, immutable and reference-counted, with a hierarchy over its instances: queries of
   many instances are faster on it than on the scene itself. Any number of threads may query it while the
   scene is edited. */
typedef struct dfield_snapshot dfield_snapshot;

/* An edit, as far as threads are concerned. Copies some 200 bytes an instance; the hierarchy is refitted, and
   built again only when instances came or went or have moved far. */
DFIELD_API dfield_status dfield_scene_commit(dfield_scene* scene, dfield_snapshot** snapshot);
DFIELD_API void dfield_snapshot_retain(dfield_snapshot* snapshot);  /* any thread */
DFIELD_API void dfield_snapshot_release(dfield_snapshot* snapshot); /* any thread; null is fine */

/* The snapshot for the query functions, which all take a const dfield_scene*; lives as long as the snapshot.
   Null for null. */
DFIELD_API const dfield_scene* dfield_snapshot_get_scene(const dfield_snapshot* snapshot);

#ifdef __cplusplus
}
#endif

#endif
