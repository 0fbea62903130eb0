/* Batches of rays. Part of dfield.h. */
#ifndef DFIELD_RAYS_H
#define DFIELD_RAYS_H

#include "dfield/scene.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct dfield_rays {
    size_t count;
    const float* origins; /* 3 floats each */
    size_t origin_stride;
    const float* directions; /* 3 floats each, any length but zero: distances are in units of this length */
    size_t direction_stride;
    const float* max_distances; /* 1 float each, or null: unbounded */
    size_t max_distance_stride;
} dfield_rays;

typedef struct dfield_hits {
    float* distances; /* 1 float each: t of the hit, INFINITY for a miss */
    size_t distance_stride;
    dfield_instance* instances; /* may be null: whom the ray hit; NO_INSTANCE for a miss and for the ground */
    size_t instance_stride;
} dfield_hits;

/* Nearest hit of each ray, to the accuracy of the maps. Where an origin lies inside an instance's bounding
   sphere the ray is extended backwards to its entry point; if the object's first hit on that line lies behind
   the origin, the line is looked up from its other end, which gives the last hit: exact for whether there is
   a hit ahead, an upper bound for its distance. 1-bit fields answer distances from a mean depth only. A ray
   with a NaN, an infinity or a zero direction misses. DFIELD_INVALID_ARGUMENT where an instance's field has
   neither displacement maps nor a line table. A query: any thread. */
DFIELD_API dfield_status dfield_scene_trace(const dfield_scene* scene, const dfield_rays* rays,
                                            const dfield_hits* hits);

/* occluded[i] = 1 when ray i hits anything within its max distance, else 0. Cheaper than dfield_scene_trace.
   A query: any thread. */
DFIELD_API dfield_status dfield_scene_occluded(const dfield_scene* scene, const dfield_rays* rays,
                                               uint8_t* occluded);

#ifdef __cplusplus
}
#endif

#endif
