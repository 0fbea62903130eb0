/* Ambient occlusion of receivers. Part of dfield.h. */
#ifndef DFIELD_AMBIENT_H
#define DFIELD_AMBIENT_H

#include "dfield/scene.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct dfield_ao
    dfield_ao; /* settings with their tables; immutable: any number of threads may use it */

/* How occlusion falls with distance d of a hit: f(d / max_distance), 0 from max_distance on. The paper's
   empirical visibility V of a ray is 1 - f. */
typedef enum dfield_falloff {
    DFIELD_FALLOFF_NONE = 0,        /* 1 */
    DFIELD_FALLOFF_LINEAR = 1,      /* 1 - x */
    DFIELD_FALLOFF_SMOOTH = 2,      /* 1 - x*x*(3 - 2x) */
    DFIELD_FALLOFF_EXPONENTIAL = 3, /* (exp(-k x) - exp(-k)) / (1 - exp(-k)), k = falloff_rate */
    DFIELD_FALLOFF_TABLE = 4        /* 1 - table(x), linear between entries at x = i / (size - 1) */
} dfield_falloff;

/* Which directions a receiver with normal n looks into. */
typedef enum dfield_sampling {
    DFIELD_SAMPLING_HEMISPHERE = 0, /* ray_count directions around n, in the frame of n */
    DFIELD_SAMPLING_SHARED = 1 /* ray_count directions w over the whole sphere, in world space, the same for
                                  all receivers; weight max(0, n.w). The fast path for many receivers; fastest
                                       where neighbours in the arrays are neighbours in space, as a
                                       dfield_receiver_set puts them */
} dfield_sampling;

#define DFIELD_MAX_RAYS 65536u
#define DFIELD_MAX_SHARED_RAYS 4096u

typedef struct dfield_ao_desc {
    size_t struct_size; /* sizeof(dfield_ao_desc) */
    /* Hemisphere: 1..DFIELD_MAX_RAYS, a square gives the concentric map's grid. Shared:
       1..DFIELD_MAX_SHARED_RAYS, of which about half lie in a receiver's hemisphere. */
    uint32_t ray_count;
    uint32_t falloff;           /* dfield_falloff; all but NONE need a finite max_distance */
    float max_distance;         /* > 0; INFINITY = unbounded */
    float falloff_rate;         /* EXPONENTIAL: k > 0 */
    const float* falloff_table; /* TABLE: visibility V in [0,1] at even steps of distance, copied */
    size_t falloff_table_size;  /* 2..65536 */
    /* Null: cosine-weighted; shared: spherical Fibonacci points of the upper half and their opposites
       (opposite directions, here and in what is given, are looked up as one line: half the work). Otherwise 3
       * ray_count floats, unit, around +z (the normal, z >= 0); shared: anywhere. Copied. */
    const float* directions;
    /* Only with directions: ray_count floats >= 0 that sum to 1; null: even. Shared: any sum, they multiply
       max(0, n.w). Copied. */
    const float* weights;
    /* >= 0, world units: hits nearer than this do not count, unless the whole object lies in front of the
       receiver's tangent plane (then it is not the surface that the receiver lies on). */
    float bias;
    uint32_t sampling; /* dfield_sampling */
    uint32_t kind;     /* dfield_kind: forces queries to it, AUTO by default */
    /* 0..1. 0: the finest level of detail always. Otherwise a receiver at D bounding radii from an instance
       reads the coarsest level with p / (D * D) <= level_error, p being the share of the lines through the
       instance's sphere on which that level and the finest disagree: its visibility changes by no more, for
       each instance. */
    float level_error;
} dfield_ao_desc;

/* 256 rays, hemisphere sampling, unbounded, no falloff, bias 0, kind AUTO. */
DFIELD_API void dfield_ao_desc_init(dfield_ao_desc* desc);
/* Any thread. */
DFIELD_API dfield_status dfield_ao_create(dfield_context* context, const dfield_ao_desc* desc,
                                          dfield_ao** ao);
DFIELD_API void dfield_ao_release(dfield_ao* ao); /* null is fine; receiver sets keep theirs */

/* The directions that `ao` uses, 3 * ray_count floats that live as long as it: in the frame of the normal
   (z), which is dfield_frame of it; shared sampling: in world space. */
DFIELD_API const float* dfield_ao_get_directions(const dfield_ao* ao);

/* Which kind answers queries with these settings for instances of this field; the forced kind, or the best of
   those that the field has. DFIELD_INVALID_ARGUMENT where the field has none that can. Any thread. */
DFIELD_API dfield_status dfield_ao_get_kind(const dfield_ao* ao, const dfield_field* field,
                                            dfield_kind* kind);

/* Occlusion, in [0,1], that `ao` gives a hit at this distance: f(distance / max_distance), 1 - V of the
 * paper. */
DFIELD_API float dfield_ao_get_occlusion(const dfield_ao* ao, float distance);

/* Words of 32 rays that one receiver's mask takes: (ray_count + 31) / 32. */
DFIELD_API size_t dfield_ao_get_mask_words(const dfield_ao* ao);

/* Tangent and bitangent that belong to a unit normal (FORMAT.md, "Frame rule"). */
DFIELD_API void dfield_frame(const float normal[3], float tangent[3], float bitangent[3]);

/* Points with normals. One with a NaN, an infinity or a zero normal is open: nothing occludes it. */
typedef struct dfield_receivers {
    size_t count;
    const float* positions; /* 3 floats each, world */
    size_t position_stride;
    const float* normals; /* 3 floats each, world, any length but zero */
    size_t normal_stride;
    const dfield_instance*
        owners; /* may be null: the instance that a receiver belongs to does not occlude it */
    size_t owner_stride;
    const float*
        self_visibility; /* may be null: multiplied into the visibility (occlusion by its own object) */
    size_t self_visibility_stride;
} dfield_receivers;

/* Spherical harmonics of the cosine-weighted visibility V(w) max(0, n.w) / pi, its real coefficients up to
   the second band: Y0,0 Y1,-1 Y1,0 Y1,1 Y2,-2 Y2,-1 Y2,0 Y2,1 Y2,2, orthonormal on the sphere, without the
   Condon-Shortley phase: with w = (x, y, z) in world space
       0.282095,  0.488603 y,  0.488603 z,  0.488603 x,
       1.092548 xy,  1.092548 yz,  0.315392 (3zz - 1),  1.092548 xz,  0.546274 (xx - yy).
   Their dot product with the coefficients of the environment's radiance is the radiance that a white diffuse
   receiver reflects. An open receiver's first one is 0.282095. */
#define DFIELD_SH_COUNT 9

/* Where a query puts its results, in the caller's memory; null for what is not wanted. With V_r = 0 for rays
   that are blocked, 1 for the others, and W_r for the rays' weights, shared sampling's max(0, n.w) included,
   divided by their sum, these are the visibility sum(W_r V_r), the bent normal sum(W_r V_r w_r) and the
   harmonics sum(W_r V_r Y(w_r)). Falloff enters the visibility alone: it takes V_r = 1 - f there. */
typedef struct dfield_outputs {
    size_t struct_size; /* sizeof(dfield_outputs) */
    float* visibility;  /* 1 float, in [0,1]: the cosine-weighted share of the hemisphere that the receiver
                           sees  past all instances and the ground; 1 = open */
    size_t visibility_stride;
    uint8_t* visibility8; /* 1 byte: the same times 255, rounded */
    size_t visibility8_stride;
    float* bent_normals; /* 3 floats, unit, world: the mean direction that the receiver sees; its normal where
                            it sees nothing */
    size_t bent_normal_stride;
    uint32_t* masks; /* dfield_ao_get_mask_words words: bit r & 31 of word r >> 5 is 1 when ray r hits
                        anything within max_distance. Shared sampling: 0 where n.w <= 0. Masks of several
                        queries combine by OR */
    size_t mask_stride;
    float* harmonics; /* DFIELD_SH_COUNT floats */
    size_t harmonics_stride;
} dfield_outputs;

/* All that `outputs` asks for, of all receivers. Occlusion volumes multiply what the others leave visible.
   A query: any thread; DFIELD_INVALID_ARGUMENT where an instance's field has no kind that can answer. */
DFIELD_API dfield_status dfield_scene_ambient(const dfield_scene* scene, const dfield_ao* ao,
                                              const dfield_receivers* receivers,
                                              const dfield_outputs* outputs);

/* dfield_scene_ambient of one output. visibility_stride in bytes, 0 = packed. A query: any thread. */
DFIELD_API dfield_status dfield_scene_visibility(const dfield_scene* scene, const dfield_ao* ao,
                                                 const dfield_receivers* receivers, float* visibility,
                                                 size_t visibility_stride);
DFIELD_API dfield_status dfield_scene_visibility_mask(const dfield_scene* scene, const dfield_ao* ao,
                                                      const dfield_receivers* receivers, uint32_t* masks,
                                                      size_t mask_stride);

/* The visibility from masks that a query wrote, all of them or rays of the caller's choice: for what falls
   out of one mask, such as the soft shadow of an area light, `weights` being 1 for the rays that lead to the
   light. Each result is sum(W_r weights[r] V_r) / sum(W_r weights[r]), 1 where no weight is left. `weights`:
   ray_count floats
   >= 0, or null: all 1. Reads normals and count of `receivers` alone. A query: any thread. */
DFIELD_API dfield_status dfield_ao_gather(const dfield_ao* ao, const dfield_receivers* receivers,
                                          const uint32_t* masks, size_t mask_stride, const float* weights,
                                          float* visibility, size_t visibility_stride);

/* The same by the paper's Algorithm 2, ray by ray in double precision on the calling thread, from
   displacement maps. Slow; for checking. Agrees with dfield_scene_visibility on displacement maps but for
   rays that rounding puts into another texel. A query: any thread. */
DFIELD_API dfield_status dfield_scene_visibility_reference(const dfield_scene* scene, const dfield_ao* ao,
                                                           const dfield_receivers* receivers,
                                                           float* visibility, size_t visibility_stride);

#ifdef __cplusplus
}
#endif

#endif
