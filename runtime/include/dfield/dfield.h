/* dfield: looks precomputed visibility up. C99, no dependencies.

   A *displacement field* (a .dfield file, baked offline) knows for every ray that meets an object's bounding
   sphere where it first hits the object. A *scene* places instances of fields by affine transforms and
   answers rays and ambient occlusion in constant time an instance, whatever the triangle count.

   Rules that hold for every function
   - Functions that can fail return a dfield_status; on failure dfield_error_message() says on this thread
   what was wrong, where, and what to do. Outputs are then untouched unless a function says otherwise. Nothing
   is thrown.
   - Lengths are in world units, matrices column-major (glTF, GLM, OpenGL), occlusion is 1 where nothing is
   seen of the sky, visibility is 1 where all of it is.
   - Strides are in bytes; 0 means tightly packed.
   - Loaded fields and ambient occlusion settings are immutable and may be used from any number of threads. A
   scene may be queried from any number of threads while none changes it.
   - Queries (dfield_scene_trace, _occluded, _visibility) allocate nothing, lock nothing and log nothing.
   Batches may be split anywhere: results do not depend on it. */
#ifndef DFIELD_DFIELD_H
#define DFIELD_DFIELD_H

#include <stddef.h>
#include <stdint.h>

#if defined(DFIELD_STATIC)
#define DFIELD_API
#elif defined(_WIN32)
#if defined(DFIELD_BUILDING)
#define DFIELD_API __declspec(dllexport)
#else
#define DFIELD_API __declspec(dllimport)
#endif
#else
#define DFIELD_API __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* clang-format off: comments are aligned by hand */

#define DFIELD_VERSION_MAJOR 0
#define DFIELD_VERSION_MINOR 1
#define DFIELD_VERSION_PATCH 0

/* Version of the library that runs, 10000 * major + 100 * minor + patch. */
DFIELD_API uint32_t dfield_version(void);

typedef enum dfield_status {
    DFIELD_OK = 0,
    DFIELD_INVALID_ARGUMENT =
        1, /* a null pointer, NaN, singular transform, unknown id: the message names it */
    DFIELD_OUT_OF_MEMORY = 2,
    DFIELD_FILE_ERROR = 3,    /* a file that cannot be opened or read */
    DFIELD_FORMAT_ERROR = 4,  /* bytes that are no valid .dfield */
    DFIELD_VERSION_ERROR = 5, /* a .dfield of a newer major version: bake again or update */
    DFIELD_INTERNAL_ERROR = 6 /* our bug */
} dfield_status;

/* Static text for a status, never null. */
DFIELD_API const char* dfield_status_name(dfield_status status);

/* What the last failing call on this thread said; valid until the next failing call on it. Never null. */
DFIELD_API const char* dfield_error_message(void);

/* ---- Context: hooks that everything made from it uses
 * ------------------------------------------------------------ */

typedef struct dfield_context dfield_context;

typedef struct dfield_context_desc {
    size_t struct_size; /* sizeof(dfield_context_desc) */
    void* user;         /* handed to every hook */
    /* Both or neither. Called at load and on changes of a scene, from the calling thread; never in queries.
       `allocate` returns null on failure. `alignment` is a power of two. */
    void* (*allocate)(void* user, size_t size, size_t alignment);
    void (*deallocate)(void* user, void* memory, size_t size, size_t alignment);
    /* Optional: runs body(data, begin, end) over disjoint ranges that cover [0, count), on any threads, and
       returns when all have ended. Queries hand their batches to it. Without it they run on the calling
       thread. */
    void (*parallel_for)(void* user, size_t count, void (*body)(void* data, size_t begin, size_t end),
                         void* data);
} dfield_context_desc;

/* desc may be null: malloc, no parallel_for. The context lives until it and everything made from it are
 * released. */
DFIELD_API dfield_status dfield_context_create(const dfield_context_desc* desc, dfield_context** context);
DFIELD_API void dfield_context_release(dfield_context* context); /* null is fine */

/* ---- Field: one loaded .dfield
 * ----------------------------------------------------------------------------------- */

typedef struct dfield_field dfield_field;

typedef enum dfield_positions { DFIELD_POSITIONS_SLATER = 0, DFIELD_POSITIONS_LATLONG = 1 } dfield_positions;
typedef enum dfield_mapping {
    DFIELD_MAPPING_CONCENTRIC = 0,
    DFIELD_MAPPING_POLAR = 1,
    DFIELD_MAPPING_REJECTION = 2
} dfield_mapping;

typedef struct dfield_field_info {
    uint32_t positions;      /* dfield_positions */
    uint32_t subdivision;    /* n */
    uint32_t position_count; /* stored positional samples */
    uint32_t mapping;        /* dfield_mapping */
    uint32_t map_size;       /* m, a map has m x m texels */
    uint32_t bits;           /* a texel */
    float centre[3];         /* bounding sphere, object space */
    float radius;
    float bounds_min[3]; /* box of the object, object space */
    float bounds_max[3];
    uint64_t memory_bytes;      /* all that the loaded field occupies */
    uint64_t self_vertex_count; /* vertices with baked self-occlusion, 0 = none */
} dfield_field_info;

/* Decodes a whole .dfield; the bytes may be freed afterwards. Safe on any bytes. */
DFIELD_API dfield_status dfield_field_load_memory(dfield_context* context, const void* bytes, size_t size,
                                                  dfield_field** field);
/* Same from a file; path is UTF-8 (on Windows too). */
DFIELD_API dfield_status dfield_field_load_file(dfield_context* context, const char* path,
                                                dfield_field** field);
DFIELD_API void dfield_field_retain(dfield_field* field);
DFIELD_API void dfield_field_release(dfield_field* field); /* null is fine; scenes keep what they use */
DFIELD_API dfield_status dfield_field_get_info(const dfield_field* field, dfield_field_info* info);
/* Visibility (1 = open) of the object's own vertices past the object itself, as baked by `dfield bake
   --self`, in the order of the vertices in the baked model: self_vertex_count floats. Null when the field has
   none. */
DFIELD_API const float* dfield_field_get_self_visibility(const dfield_field* field);

/* ---- Scene: instances of fields
 * ---------------------------------------------------------------------------------- */

typedef struct dfield_scene dfield_scene;
typedef uint32_t dfield_instance; /* id, valid until removed; ids are used again */
#define DFIELD_NO_INSTANCE UINT32_MAX

DFIELD_API dfield_status dfield_scene_create(dfield_context* context, dfield_scene** scene);
DFIELD_API void dfield_scene_release(dfield_scene* scene); /* null is fine */

/* object_to_world: 16 floats, column-major, finite, last row 0 0 0 1, any invertible affine matrix
   (non-uniform and mirrored scale too). The scene keeps the field. */
DFIELD_API dfield_status dfield_scene_add_instance(dfield_scene* scene, dfield_field* field,
                                                   const float* object_to_world, dfield_instance* instance);
DFIELD_API dfield_status dfield_scene_set_transform(dfield_scene* scene, dfield_instance instance,
                                                    const float* object_to_world);
DFIELD_API dfield_status dfield_scene_remove_instance(dfield_scene* scene, dfield_instance instance);

/* Solid ground below the plane n.p = d, with plane = {n.x, n.y, n.z, d} and n not zero: rays that go against
   n hit it, those that start below it at distance 0; rays that go along n never do, so that vertices which
   rounding put a little below the ground are not buried. Null turns it off (the default). */
DFIELD_API dfield_status dfield_scene_set_ground(dfield_scene* scene, const float* plane);

/* ---- Rays
 * -------------------------------------------------------------------------------------------------------- */

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
    dfield_instance*
        instances; /* may be null: whom the ray hit; DFIELD_NO_INSTANCE for a miss and for the ground */
    size_t instance_stride;
} dfield_hits;

/* Nearest hit of each ray, to the accuracy of the maps. Where an origin lies inside an instance's bounding
   sphere the ray is extended backwards to its entry point; if the object's first hit on that line lies behind
   the origin, the line is looked up from its other end, which gives the last hit: exact for whether there is
   a hit ahead, an upper bound for its distance. 1-bit fields answer distances from a mean depth only. A ray
   with a NaN, an infinity or a zero direction misses. */
DFIELD_API dfield_status dfield_scene_trace(const dfield_scene* scene, const dfield_rays* rays,
                                            const dfield_hits* hits);

/* occluded[i] = 1 when ray i hits anything within its max distance, else 0. Cheaper than dfield_scene_trace.
 */
DFIELD_API dfield_status dfield_scene_occluded(const dfield_scene* scene, const dfield_rays* rays,
                                               uint8_t* occluded);

/* ---- Ambient occlusion
 * ------------------------------------------------------------------------------------------- */

typedef struct dfield_ao dfield_ao; /* settings with their tables, immutable */

/* How occlusion falls with distance d of a hit: f(d / max_distance), 0 from max_distance on. The paper's
   empirical visibility V of a ray is 1 - f. */
typedef enum dfield_falloff {
    DFIELD_FALLOFF_NONE = 0,        /* 1 */
    DFIELD_FALLOFF_LINEAR = 1,      /* 1 - x */
    DFIELD_FALLOFF_SMOOTH = 2,      /* 1 - x*x*(3 - 2x) */
    DFIELD_FALLOFF_EXPONENTIAL = 3, /* (exp(-k x) - exp(-k)) / (1 - exp(-k)), k = falloff_rate */
    DFIELD_FALLOFF_TABLE = 4        /* 1 - table(x), linear between entries at x = i / (size - 1) */
} dfield_falloff;

typedef struct dfield_ao_desc {
    size_t struct_size;         /* sizeof(dfield_ao_desc) */
    uint32_t ray_count;         /* rays a receiver, 1..65536; a square gives the concentric map's grid */
    uint32_t falloff;           /* dfield_falloff; all but NONE need a finite max_distance */
    float max_distance;         /* > 0; INFINITY = unbounded */
    float falloff_rate;         /* EXPONENTIAL: k > 0 */
    const float* falloff_table; /* TABLE: visibility V in [0,1] at even steps of distance, copied */
    size_t falloff_table_size;  /* 2..65536 */
    const float* directions;    /* null: cosine-weighted. Otherwise 3 * ray_count floats, unit, around +z (the
                                   normal, z >= 0);    copied */
    const float* weights; /* only with directions: ray_count floats >= 0 that sum to 1; null: even. Copied */
    float
        bias; /* >= 0, world units: hits nearer than this do not count, unless the whole object lies in front
                 of the receiver's tangent plane (then it is not the surface that the receiver lies on) */
} dfield_ao_desc;

/* 256 rays, unbounded, no falloff, bias 0. */
DFIELD_API void dfield_ao_desc_init(dfield_ao_desc* desc);
DFIELD_API dfield_status dfield_ao_create(dfield_context* context, const dfield_ao_desc* desc,
                                          dfield_ao** ao);
DFIELD_API void dfield_ao_release(dfield_ao* ao); /* null is fine */

/* The directions that `ao` uses, in the frame of the normal (z): 3 * ray_count floats. A receiver's
   frame is dfield_frame of its normal. */
DFIELD_API const float* dfield_ao_get_directions(const dfield_ao* ao);

/* Occlusion, in [0,1], that `ao` gives a hit at this distance: f(distance / max_distance), 1 - V of the
 * paper. */
DFIELD_API float dfield_ao_get_occlusion(const dfield_ao* ao, float distance);

/* Tangent and bitangent that belong to a unit normal (FORMAT.md, "Frame rule"). */
DFIELD_API void dfield_frame(const float normal[3], float tangent[3], float bitangent[3]);

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
        self_visibility; /* may be null: multiplied into the result (its occlusion by its own object) */
    size_t self_visibility_stride;
} dfield_receivers;

/* visibility[i], in [0,1]: the cosine-weighted share of the hemisphere that receiver i sees past all
   instances and the ground; 1 = open. A receiver with a NaN, an infinity or a zero normal gets 1.
   visibility_stride in bytes, 0 = packed. */
DFIELD_API dfield_status dfield_scene_visibility(const dfield_scene* scene, const dfield_ao* ao,
                                                 const dfield_receivers* receivers, float* visibility,
                                                 size_t visibility_stride);

/* The same by the paper's Algorithm 2, ray by ray in double precision on the calling thread. Slow; for
   checking. Agrees with dfield_scene_visibility but for rays that rounding puts into another texel. */
DFIELD_API dfield_status dfield_scene_visibility_reference(const dfield_scene* scene, const dfield_ao* ao,
                                                           const dfield_receivers* receivers,
                                                           float* visibility, size_t visibility_stride);

/* Words of 32 rays that one receiver's mask takes: (ray_count + 31) / 32. */
DFIELD_API size_t dfield_ao_get_mask_words(const dfield_ao* ao);

/* Which rays are blocked: bit r & 31 of word r >> 5 of receiver i's mask is 1 when ray r of `ao` hits
   anything within max_distance. Falloff and self_visibility do not enter. Masks of several calls combine by
   OR. Receivers with a NaN, an infinity or a zero normal get zeros. mask_stride in bytes, 0 = packed. */
DFIELD_API dfield_status dfield_scene_visibility_mask(const dfield_scene* scene, const dfield_ao* ao,
                                                      const dfield_receivers* receivers, uint32_t* masks,
                                                      size_t mask_stride);

/* clang-format on */

#ifdef __cplusplus
}
#endif

#endif
