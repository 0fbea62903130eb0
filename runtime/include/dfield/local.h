/* Local ambient occlusion of volumes, and contextual ambient occlusion: the same while the volume is being
   cut (A. Titov, M. Kersten-Oertel, S. Drouin: Contextual Ambient Occlusion, Computers & Graphics 2024). Part
   of dfield.h.

   A voxel's ambient occlusion factor A, 1 = open, is the mean over K rays of

       A_k = 1/M sum_{m=1..M} prod_{i=1..m-1} (1 - a_i)                                 (equations 2 and 3)

   where a_i is the opacity, trilinear between the voxels and 0 outside the grid, at the ray's i-th sample. A
   ray's last sample is therefore never read. Samples are left out where all is empty, which changes nothing,
   and where less than 1e-5 of the light is left, which changes A by less than that; with up to 256 rays what
   each of them loses is rounded to 2^-24, or so much of the weights' mean. Grids and samples are those of
   volume.h: arrays are the caller's, points are in world units. Results do not depend on the number of
   threads, on which voxels are computed together, nor on the level of SIMD where it multiplies and adds in
   one (AVX2, AVX-512, NEON); SSE4 and SCALAR are within 2e-5 of these. */
#ifndef DFIELD_LOCAL_H
#define DFIELD_LOCAL_H

#include "dfield/volume.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct dfield_opacity_point {
    float value;   /* of a sample */
    float opacity; /* 0..1 */
} dfield_opacity_point;

/* The transfer function of opacity: piecewise linear, constant beyond its ends; of two points at one value
   the second holds from there on. */
typedef struct dfield_opacity_desc {
    size_t struct_size;                 /* sizeof(dfield_opacity_desc) */
    const dfield_opacity_point* points; /* values ascend */
    size_t point_count;                 /* 1 or more */
    /* 0: opacities are those of a ray's samples, however far apart, as in the paper. > 0, world units: those
       of matter so thick, so that a sample's is 1 - (1 - a)^(step / unit_length). */
    float unit_length;
} dfield_opacity_desc;

typedef enum dfield_ray_set {
    DFIELD_RAYS_NEIGHBOURS =
        0,                    /* the paper's 6, 14 or 26 directions of neighbours, or 54 of a Rubik's cube */
    DFIELD_RAYS_FIBONACCI = 1 /* any number, spherical Fibonacci */
} dfield_ray_set;

typedef enum dfield_step_unit {
    DFIELD_STEP_VOXELS = 0, /* directions and steps are those of the grid, as if spacings were equal */
    DFIELD_STEP_WORLD = 1
} dfield_step_unit;

#define DFIELD_MAX_LOCAL_RAYS 4096u
#define DFIELD_MAX_LOCAL_SAMPLES 1024u

typedef struct dfield_local_desc {
    size_t struct_size; /* sizeof(dfield_local_desc) */
    uint32_t ray_set;   /* dfield_ray_set */
    uint32_t ray_count; /* K, 1..DFIELD_MAX_LOCAL_RAYS; 6, 14, 26 or 54 with NEIGHBOURS */
    uint32_t samples;   /* M, 1..DFIELD_MAX_LOCAL_SAMPLES */
    uint32_t step_unit; /* dfield_step_unit */
    float step;         /* > 0, from a sample to the next; a ray reaches no farther than 1024 voxels */
    const float*
        weights; /* w_k, ray_count of them, >= 0, finite; null: all 1. A is within 0..1 if their mean is 1 */
    /* 0..1: turns every ray of every voxel at random, by up to this share of half the angle between
       neighbouring rays. 0, the default, is many times as fast. */
    float jitter;
    uint64_t seed; /* of the jitter: the turns depend on it, on the voxel's index and on the ray alone */
    /* 1: long rays are approximate. The first samples (3, or 150 / M where that is more) are taken singly,
       five or six pairs and then fours as if all of a group had the opacity in its middle; and where the
       first samples meet nothing rays are walked for every second row and slice alone, between which A is
       interpolated. No group is longer than four voxels: steps longer than one have pairs alone, and rays
       whose steps are longer than two are exact. With 40 or 50 samples a voxel apart A differs by 4e-4 to
       1.3e-3 (RMS), the less the smoother the volume is, and by 0.05 at single voxels; a third more with
       steps of two voxels. What it gains grows with M and with the share of air. Not with jitter, not in
       sessions (contextual.h). 0, the default: exact. */
    uint32_t approximate;
} dfield_local_desc;

/* NEIGHBOURS, 54 rays, 20 samples a voxel apart, no weights, no jitter, exact. */
DFIELD_API void dfield_local_desc_init(dfield_local_desc* desc);

/* The rays' directions, 3 floats each, unit vectors along the grid's axes: what weights are given for. Any
 * thread. */
DFIELD_API dfield_status dfield_local_get_directions(const dfield_local_desc* desc, float* directions);

/* Local ambient occlusion of a whole volume: a float a voxel, packed, into `visibility`. Allocates the
   opacities, about 1.1 floats a voxel, through the context's hooks. Any thread.
 */
DFIELD_API dfield_status dfield_volume_local_ao(dfield_context* context, const dfield_volume_samples* samples,
                                                const dfield_opacity_desc* opacity,
                                                const dfield_local_desc* desc, float* visibility);

#ifdef __cplusplus
}
#endif

#endif
