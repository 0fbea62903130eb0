/* Volumes: distance fields and occlusion by sweeping (M. Singh, C. Yuksel, D. House: Fast Occlusion Sweeping,
   2009). Part of dfield.h.

   A volume is a grid of samples, x fastest; "inside" is where the value is >= the isovalue. Sample (x, y, z)
   lies at the point (x, y, z) * spacing, in world units throughout, whatever frame the caller's file has. All
   arrays are the caller's. These are calls for setting up: they allocate scratch memory through the context's
   hooks, split their work with its parallel_for, and give the same results at any number of threads. Any
   thread. */
#ifndef DFIELD_VOLUME_H
#define DFIELD_VOLUME_H

#include "dfield/context.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum dfield_sample_type {
    DFIELD_SAMPLE_U8 = 0,
    DFIELD_SAMPLE_I8 = 1,
    DFIELD_SAMPLE_U16 = 2,
    DFIELD_SAMPLE_I16 = 3,
    DFIELD_SAMPLE_F32 = 4 /* finite; other types are converted by the caller */
} dfield_sample_type;

#define DFIELD_MAX_VOLUME_DIM 65536u

typedef struct dfield_volume_grid {
    uint32_t dims[3]; /* 1..DFIELD_MAX_VOLUME_DIM each; no slice of 2^31 samples or more */
    float spacing[3]; /* > 0, world units; they may differ, by no more than 1000 times */
} dfield_volume_grid;

typedef struct dfield_volume_samples {
    size_t struct_size; /* sizeof(dfield_volume_samples) */
    dfield_volume_grid grid;
    uint32_t type;       /* dfield_sample_type */
    const void* data;    /* sample (0, 0, 0); rows along x are packed, values in the machine's byte order */
    size_t row_stride;   /* bytes from a row to the next in y; 0 = packed */
    size_t slice_stride; /* bytes from a slice to the next in z; 0 = packed */
} dfield_volume_samples;

/* How visibility is swept. */
typedef enum dfield_occlusion_form {
    /* Several ordinates an octant, a transmittance that does not darken flat walls, results near the surface
       taken a little off it. Runs after the distance sweeps. The default. */
    DFIELD_FORM_IMPROVED = 0,
    /* Equations 3 to 7 as published: weights 1/3, V = 1 outside the grid, embedded in the distance sweeps. */
    DFIELD_FORM_PAPER = 1,
    /* The paper's without the geometry term: visibility is the octants' mean. */
    DFIELD_FORM_COMBINED = 2
} dfield_occlusion_form;

/* Octants of the sky, by the sweep of the paper's Table 1 that their light comes with: octant i has the
   directions whose x is positive if bit 0 of i is set and negative otherwise, likewise y and bit 1, z and
   bit 2. */
#define DFIELD_OCTANT_COUNT 8
#define DFIELD_ALL_OCTANTS 255u

typedef struct dfield_sweep_desc {
    size_t struct_size; /* sizeof(dfield_sweep_desc) */
    float isovalue;
    uint32_t form;      /* dfield_occlusion_form */
    uint32_t ordinates; /* IMPROVED: 24 or 48, of the whole sky; more are slower and closer to the truth */
    uint32_t octants;   /* bit i: octant i shines. The cloudy day: the upper four */
    float intensities[DFIELD_OCTANT_COUNT]; /* >= 0, of the octants that shine */
    /* Unit length or not, towards a light: visibility then is the low-frequency shadow of this light alone,
       one octant of a grid turned to it, and octants and intensities are not used. 0,0,0: none. */
    float light[3];
    float gamma; /* > 0: visibility is raised to 1 / gamma. The paper's pictures have 2 */
    float alpha; /* 0..1, opacity of the matter (equation 8) */
    /* > 0, world units: distances farther than this are cut off at it; INFINITY: none are. */
    float band;
    uint32_t through; /* not 0: |N.w| for the geometry term, with an alpha < 1: light that shines through */
} dfield_sweep_desc;

/* Isovalue 0, IMPROVED, 24 ordinates, all octants of intensity 1, no light, gamma 1, alpha 1, no band. */
DFIELD_API void dfield_sweep_desc_init(dfield_sweep_desc* desc);

/* What a sweep leaves, packed, x fastest; null for what is not wanted. */
typedef struct dfield_sweep_outputs {
    size_t struct_size; /* sizeof(dfield_sweep_outputs) */
    /* A float a voxel: the distance to the isosurface, world units, < 0 inside. It is initialised at every
       grid edge that crosses the isovalue, by linear interpolation; a value equal to the isovalue is inside,
       its crossing lies at the vertex, and its distance is -0: the sign bit says inside or outside
       everywhere. +-INFINITY where there is no surface. */
    float* distance;
    /* A float a voxel, 1 = open: the sum of intensity V G(N) over the octants, divided by that of G(N) over
       all eight, G being equation 5's integral of max(0, N.w) and N the gradient of the distance. COMBINED:
       the mean of intensity V over the octants that shine. An intensity above 1 may lead above 1. */
    float* visibility;
    /* Two bytes volumes of four channels, as the paper's two RGBA textures: byte 4 * (voxel + (i / 4) *
       voxels) + i % 4 is octant i's V times 255, rounded. Whatever shines. Not with COMBINED or a light. */
    uint8_t* octants;
} dfield_sweep_outputs;

typedef struct dfield_sweep_times {
    double sweeps;     /* seconds: the distance field and what PAPER and COMBINED embed in it */
    double occlusion;  /* IMPROVED and lights: occlusion after the distance field */
    double evaluation; /* PAPER: octants to visibility; gamma */
} dfield_sweep_times;

/* On failure outputs may have been written to. times may be null. */
DFIELD_API dfield_status dfield_volume_sweep(dfield_context* context, const dfield_volume_samples* samples,
                                             const dfield_sweep_desc* desc,
                                             const dfield_sweep_outputs* outputs, dfield_sweep_times* times);

/* Points in a volume's frame. */
typedef struct dfield_volume_points {
    size_t count;
    const float* positions; /* 3 floats each; those outside the grid are moved to its border */
    size_t position_stride;
    const float* normals; /* 3 floats each, any length; null, or a zero: the field's gradient */
    size_t normal_stride;
} dfield_volume_points;

/* Monte Carlo: the share of `rays` (1..65536) cosine-weighted rays around each point's normal that leave the
   grid without meeting the isosurface, sphere-traced in the distance field. The rays of point i depend on
   seed + i alone. Points of no normal at all: 1. */
DFIELD_API dfield_status dfield_volume_visibility_by_rays(dfield_context* context,
                                                          const dfield_volume_grid* grid,
                                                          const float* distance,
                                                          const dfield_volume_points* points, uint32_t rays,
                                                          uint64_t seed, float* visibility);

/* PAPER's visibility at points, octants of intensity 1 read between the voxels. Without normals `distance` is
 * needed. */
DFIELD_API dfield_status dfield_volume_gather_octants(dfield_context* context, const dfield_volume_grid* grid,
                                                      const float* distance, const uint8_t* octants,
                                                      const dfield_volume_points* points, float* visibility);

/* A field, such as distance or visibility, between the voxels: its trilinear values, and its gradients
   normalised (3 floats each, 0 where there is none). Either output may be null. */
DFIELD_API dfield_status dfield_volume_interpolate(dfield_context* context, const dfield_volume_grid* grid,
                                                   const float* field, const dfield_volume_points* points,
                                                   float* values, float* gradients);

/* Equation 5's G of the eight octants for a unit normal, in closed form; through: with |N.w|. They sum to pi,
 * or 2 pi. */
DFIELD_API void dfield_octant_geometry(const float normal[3], int through, float terms[DFIELD_OCTANT_COUNT]);

#ifdef __cplusplus
}
#endif

#endif
