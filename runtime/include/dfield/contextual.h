/* Contextual ambient occlusion: local ambient occlusion (local.h) of a volume while meshes cut it. Part of
   dfield.h.

   A clip mesh takes away the part of the volume inside it, or all that is outside. How much of a voxel is
   left is found by algorithm 2 of the paper, with 9 + N samples, and its opacity is multiplied by that. A
   voxel of which nothing is left is 1 unless one of its 26 neighbours is left in part, since trilinear
   reading meets both; all others have exactly, to the last bit, the ambient occlusion factor that
   dfield_volume_local_ao_clipped() computes for the clipped volume from scratch. */
#ifndef DFIELD_CONTEXTUAL_H
#define DFIELD_CONTEXTUAL_H

#include "dfield/local.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A closed mesh to clip with: immutable, shared by any sessions and threads. */
typedef struct dfield_clip_mesh dfield_clip_mesh;

typedef enum dfield_clip_method {
    DFIELD_CLIP_AUTO =
        0, /* depth maps along the first of z, x, y that shows two layers at most; otherwise EXACT */
    /* The paper's: between the first and the last layer that an orthographic camera along `axis` sees, a
       pixel of `resolution` at a time. Meshes with more than two layers are filled in between, as the paper
       says. */
    DFIELD_CLIP_DEPTH_MAPS = 1,
    DFIELD_CLIP_EXACT = 2 /* inside tests against the triangles: any closed mesh, no pixels */
} dfield_clip_method;

typedef struct dfield_clip_mesh_desc {
    size_t struct_size;      /* sizeof(dfield_clip_mesh_desc) */
    const float* positions;  /* 3 floats a vertex; vertices at one place are one */
    size_t position_stride;  /* bytes; 0: packed */
    size_t vertex_count;     /* below 2^32 */
    const uint32_t* indices; /* 3 a triangle, oriented alike or not */
    size_t triangle_count;
    uint32_t method;     /* dfield_clip_method */
    uint32_t axis;       /* DEPTH_MAPS: 0, 1, 2 */
    uint32_t resolution; /* depth maps: pixels along the longer side, 1..4096 */
} dfield_clip_mesh_desc;

/* AUTO, axis z, 512 pixels, no mesh. */
DFIELD_API void dfield_clip_mesh_desc_init(dfield_clip_mesh_desc* desc);
/* Copies what it needs. A mesh that is not closed is an INVALID_ARGUMENT. */
DFIELD_API dfield_status dfield_clip_mesh_create(dfield_context* context, const dfield_clip_mesh_desc* desc,
                                                 dfield_clip_mesh** mesh);
DFIELD_API void dfield_clip_mesh_release(dfield_clip_mesh* mesh); /* null is fine */
/* DEPTH_MAPS or EXACT: what AUTO chose. */
DFIELD_API dfield_clip_method dfield_clip_mesh_get_method(const dfield_clip_mesh* mesh);
/* The most crossings of a pixel's line with the mesh, two a layer pair; 0 with EXACT asked for. */
DFIELD_API uint32_t dfield_clip_mesh_get_layers(const dfield_clip_mesh* mesh);

typedef enum dfield_clip_mode {
    DFIELD_CLIP_SUBTRACT = 0, /* what is inside goes */
    DFIELD_CLIP_PROBE = 1     /* what is outside goes */
} dfield_clip_mode;

/* A mesh at its place. Several: what one of them takes away is gone (section 3.6). */
typedef struct dfield_clip {
    const dfield_clip_mesh* mesh;
    uint32_t mode;           /* dfield_clip_mode */
    float mesh_to_world[16]; /* column-major, affine and invertible; "world": the volume's frame, as in
                                volume.h */
} dfield_clip;

/* Anti-aliased clipping: samples within -1..1 voxels of a voxel that the boundary passes, after its centre
   and corners; the paper's N. 0: a voxel is there or not, by its centre. */
#define DFIELD_CLIP_SAMPLES 32u
#define DFIELD_MAX_CLIP_SAMPLES 240u

/* Local ambient occlusion of a clipped volume, all of it from scratch. */
DFIELD_API dfield_status dfield_volume_local_ao_clipped(dfield_context* context,
                                                        const dfield_volume_samples* samples,
                                                        const dfield_opacity_desc* opacity,
                                                        const dfield_local_desc* desc,
                                                        const dfield_clip* clips, size_t clip_count,
                                                        uint32_t clip_samples, float* visibility);

/* A session: a volume, a transfer function and clips that change from frame to frame. One thread at a time.
 */
typedef struct dfield_contextual dfield_contextual;

/* Which voxels are computed anew. The results are the same. */
typedef enum dfield_update_mask {
    /* Those whose rays meet a voxel that changed, as far as any that is clipped now; the default. */
    DFIELD_UPDATE_CHANGED = 0,
    /* The paper's: those within the clips' dilation maps (algorithm 1), in every update. */
    DFIELD_UPDATE_DILATED = 1
} dfield_update_mask;

typedef struct dfield_contextual_desc {
    size_t struct_size;            /* sizeof(dfield_contextual_desc) */
    dfield_volume_samples samples; /* the caller's, unchanged while the session lives */
    dfield_opacity_desc opacity;   /* copied */
    dfield_local_desc local;       /* copied */
    uint32_t clip_samples;         /* 0..DFIELD_MAX_CLIP_SAMPLES */
    uint32_t mask;                 /* dfield_update_mask */
} dfield_contextual_desc;

/* local_defaults, DFIELD_CLIP_SAMPLES, CHANGED; no volume, no transfer function. */
DFIELD_API void dfield_contextual_desc_init(dfield_contextual_desc* desc);
/* Allocates 2.3 to 2.5 floats a voxel, a mesh's tables apart (some megabytes); computes nothing yet. Updates
   take a float more for each voxel that clips have an effect on, and one for each in the box around what is
   clipped: 0.2 to 0.5 a voxel where 5 to 17% are affected, 2.2 at most. */
DFIELD_API dfield_status dfield_contextual_create(dfield_context* context, const dfield_contextual_desc* desc,
                                                  dfield_contextual** session);
DFIELD_API void dfield_contextual_release(dfield_contextual* session); /* null is fine */

/* Changes, seen by the next update. Ids are never used twice. A mesh is kept alive by the session. */
DFIELD_API dfield_status dfield_contextual_add_clip(dfield_contextual* session, const dfield_clip* clip,
                                                    uint32_t* id);
DFIELD_API dfield_status dfield_contextual_move_clip(dfield_contextual* session, uint32_t id,
                                                     const float mesh_to_world[16]);
DFIELD_API dfield_status dfield_contextual_remove_clip(dfield_contextual* session, uint32_t id);
/* Another transfer function. Voxels are computed anew whose rays meet one whose opacity it changes. */
DFIELD_API dfield_status dfield_contextual_set_opacity(dfield_contextual* session,
                                                       const dfield_opacity_desc* opacity);

typedef struct dfield_update_desc {
    size_t struct_size; /* sizeof(dfield_update_desc) */
    /* > 0: an update ends about so many seconds after it began, finished or not; 0: when it is finished. What
       there was no time for has a rough estimate by six rays if there was time for that, its unclipped
       factor, or its former value. */
    double seconds;
    int (*cancelled)(void* user); /* optional: asked between tiles, from the calling thread; not 0: end now */
    void* user;
} dfield_update_desc;

typedef struct dfield_update_result {
    uint32_t low[3], high[3]; /* the box of voxels [low, high) whose factors this update may have changed */
    int is_final;             /* 1: every voxel is exact; 0: update again, with or without further changes */
    uint64_t changed;         /* voxels whose opacity or state of being clipped changed */
    uint64_t recomputed; /* voxels computed along all rays, first or unclipped computations not counted */
    uint64_t masked;     /* DILATED: voxels of the mask's category b */
    double seconds;      /* all of it */
    double clip_seconds; /* of these, finding what is clipped and which voxels are affected */
} dfield_update_result;

/* Brings the factors up to date. desc and result may be null. Without memory, or with a sample that is not
   finite, nothing is final and the next update begins again. */
DFIELD_API dfield_status dfield_contextual_update(dfield_contextual* session, const dfield_update_desc* desc,
                                                  dfield_update_result* result);

/* A float a voxel, packed; and of how many of a voxel's 9 + clip_samples samples something is left, as a
   byte; without clip_samples 0 or 1. The session's memory: valid until its release, changed by updates alone.
 */
DFIELD_API const float* dfield_contextual_get_visibility(const dfield_contextual* session);
DFIELD_API const uint8_t* dfield_contextual_get_coverage(const dfield_contextual* session);

/* For renderers: 1 for each point (3 floats, world units) that the session's clips, as of the last update,
   take away, by their inside tests alone; 0 for the others. Any number of threads while nobody changes the
   session. */
DFIELD_API dfield_status dfield_contextual_test_points(const dfield_contextual* session, size_t count,
                                                       const float* positions, size_t position_stride,
                                                       uint8_t* clipped);

#ifdef __cplusplus
}
#endif

#endif
