/* Screen-space volumetric ambient occlusion and indirect light, from a depth buffer alone (L. Szirmay-Kalos,
   B. Toth, T. Umenhoffer, M. Sbert: GPU-based Ambient Occlusion and Indirect Illumination; "the paper").
   Part of dfield.h.

   Camera space is right-handed: x right, y up, the camera looks along -z. Row 0 is the top of the picture,
   pixel (column, row) has its centre at + 0.5. Depth is the distance along -z, in world units.

   For a shaded point s with the unit normal N and the neighbourhood sphere of radius R around it

       O = 1/pi * integral over directions w of mu(D(w)) (N.w)+ dw         1 = open
         = 1/pi * integral over the sphere of mu'(r) / r^2 (N.w)+ v dV                     (equation 2)
       I = L~ (1 - O)
       L' = a (La O + I)

   with D the distance to the occluder, mu the fuzzy measure (mu(0) = 0, mu(R) = 1), v = 1 where a point of
   the sphere is seen by the camera, L~ the average radiance of the neighbourhood, a the albedo and La the
   ambient light. What is assumed of the neighbourhood:
   - One intersection (section 3.2): what the camera sees, s sees too. MARCH assumes less: it stops at the
     first point that is hidden.
   - Quasi-orthogonal (section 3.1): the rays of sight are parallel, so that a point of the sphere is looked
     up where the ray through it meets the plane of s across the camera's axis, and its depth is compared with
     that pixel's. See dfield_screen_sight for what they are parallel to.
   - The depth of a pixel holds for all of it.
   - Nothing hides what lies outside the picture: samples there are open. Render a margin if that shows.
   - A normal that looks away from the viewer is turned until it is perpendicular to the ray of sight.
   docs/screen.md has the derivations. */
#ifndef DFIELD_SCREEN_H
#define DFIELD_SCREEN_H

#include "dfield/context.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum dfield_projection {
    DFIELD_PROJECTION_PERSPECTIVE = 0,
    DFIELD_PROJECTION_ORTHOGRAPHIC = 1
} dfield_projection;

/* A pixel's u = 2 (column + 0.5) / width - 1 and v = 1 - 2 (row + 0.5) / height, both -1..1, are seen along
   x = offset_x + u half_width, y = offset_y + v half_height, which perspective multiplies by the depth. */
typedef struct dfield_screen_camera {
    uint32_t projection; /* dfield_projection */
    /* > 0. Perspective: tangents of half the field of view; orthographic: half extents in world units. */
    float half_width, half_height;
    float offset_x,
        offset_y; /* of the picture's middle, in the same units; 0 unless the frustum is lopsided */
    /* Of device depths 0..1, 0 at near_plane, 1 at far_plane: >= 0, not equal; near > far is reversed z; the
       farther one may be INFINITY with perspective. Perspective needs both > 0. Not used with
       DFIELD_DEPTH_DISTANCE. */
    float near_plane, far_plane;
} dfield_screen_camera;

typedef enum dfield_depth_encoding {
    /* World units along -z. Pixels of NaN, INFINITY or <= 0 are sky. */
    DFIELD_DEPTH_DISTANCE = 0,
    /* 0..1 of near_plane and far_plane: hyperbolic with perspective (1/depth is linear in it), linear with
       orthographic. Pixels at the farther plane or outside 0..1 are sky. */
    DFIELD_DEPTH_DEVICE = 1
} dfield_depth_encoding;

/* Floats of the caller's. Strides in bytes, multiples of 4, 0 = packed; rows may run upwards (negative). */
typedef struct dfield_screen_plane {
    const float* data; /* null: none */
    ptrdiff_t pixel_stride;
    ptrdiff_t row_stride;
} dfield_screen_plane;

typedef struct dfield_screen_target {
    float* data; /* null: not wanted */
    ptrdiff_t pixel_stride;
    ptrdiff_t row_stride;
} dfield_screen_target;

#define DFIELD_MAX_SCREEN_DIM 16384u

typedef struct dfield_screen_buffers {
    size_t struct_size;     /* sizeof(dfield_screen_buffers) */
    uint32_t width, height; /* 1..DFIELD_MAX_SCREEN_DIM */
    dfield_screen_camera camera;
    uint32_t depth_encoding;   /* dfield_depth_encoding */
    dfield_screen_plane depth; /* 1 float a pixel */
    /* 3 floats, camera space, any length, towards the viewer. None, and pixels of NaN or zero: derived from
       depth, from the nearer of the neighbours left and right, above and below. */
    dfield_screen_plane normals;
    dfield_screen_plane
        radiance; /* 3 floats, >= 0: light that leaves the surface; for indirect light. NaN: 0 */
    dfield_screen_plane albedo; /* 3 floats, a; none: 1 */
} dfield_screen_buffers;

/* What samples are placed on, by the paper's sections. n is their number a pixel. */
typedef enum dfield_screen_estimator {
    /* 4.1 and 4.2: uniform in the sphere, or the half in front of the tangent plane. Where mu starts linearly
       (LINEAR, EXPONENTIAL) their terms grow as 1/r^2 and their variance is infinite; for QUADRATIC it is
       finite. */
    DFIELD_ESTIMATOR_SPHERE = 0,
    DFIELD_ESTIMATOR_HEMISPHERE = 1,
    DFIELD_ESTIMATOR_IMPORTANCE = 2, /* 4.3: directions by the cosine, distances by mu' */
    DFIELD_ESTIMATOR_TANGENT = 3,    /* 4.4: uniform in the tangent sphere: another integral, close to O */
    DFIELD_ESTIMATOR_DISK = 4,       /* 4.5: on the base disk, analytic along the ray of sight. The default */
    DFIELD_ESTIMATOR_MARCH = 5       /* 3.2: n rays of march_steps points each */
} dfield_screen_estimator;

typedef enum dfield_fuzzy_measure {
    DFIELD_MEASURE_QUARTIC = 0,    /* (r/R)^4, the paper's and the default */
    DFIELD_MEASURE_QUADRATIC = 1,  /* (r/R)^2 */
    DFIELD_MEASURE_LINEAR = 2,     /* r/R */
    DFIELD_MEASURE_EXPONENTIAL = 3 /* (1 - exp(-sigma r)) / (1 - exp(-sigma R)), cut off at R */
} dfield_fuzzy_measure;

/* What the rays of sight around s are taken to be parallel to, with perspective. */
typedef enum dfield_screen_sight {
    DFIELD_SIGHT_VIEW = 0, /* the ray through s: planes stay planes up to R / depth. The default */
    DFIELD_SIGHT_AXIS = 1  /* z, as the paper has it: slanted planes away from the middle hide themselves */
} dfield_screen_sight;

/* How the terms of SPHERE, HEMISPHERE, TANGENT and DISK are made a value. */
typedef enum dfield_screen_weights {
    /* Divided by the sum of the same samples' terms where all is open: 1 on an open plane, 0 where nothing is
       open, less noise between; consistent. DISK's samples are denser in its middle, where the pipes are
       longer. Also what normalises TANGENT. The default. */
    DFIELD_WEIGHTS_RATIO = 0,
    /* The paper's unbiased sums of uniform samples. TANGENT is divided by what the integral gives where all
       is open (QUARTIC: 0.4) unless tangent_as_printed. */
    DFIELD_WEIGHTS_PLAIN = 1
} dfield_screen_weights;

#define DFIELD_MAX_SCREEN_SAMPLES 4096u

typedef struct dfield_screen_desc {
    size_t struct_size;   /* sizeof(dfield_screen_desc) */
    uint32_t estimator;   /* dfield_screen_estimator */
    uint32_t measure;     /* dfield_fuzzy_measure */
    float radius;         /* R, world units: 0 (all is open) or 1e-18..1e18 */
    float sigma;          /* EXPONENTIAL: > 0, extinction a world unit */
    uint32_t samples;     /* n, 1..DFIELD_MAX_SCREEN_SAMPLES; MARCH: rays */
    uint32_t march_steps; /* MARCH: points a ray, 1..DFIELD_MAX_SCREEN_SAMPLES */
    /* 1..8: pixels use one of interleave^2 sets of samples, by their place in squares of so many (section 5).
       1: the same set everywhere. */
    uint32_t interleave;
    /* Not 0: the mean over the interleave^2 sets around a pixel (of even sides, the outermost rows and
       columns on both sides by half), leaving out sky and pixels whose depth is farther than filter_limit * R
       from the tangent plane's there. */
    uint32_t filter;
    float filter_limit;          /* > 0, shares of R */
    uint32_t sight;              /* dfield_screen_sight */
    uint32_t weights;            /* dfield_screen_weights */
    uint32_t tangent_as_printed; /* not 0: TANGENT with PLAIN as in 4.4, 0.4 on an open plane with QUARTIC */
    float ambient[3];            /* La, >= 0, for reflected radiance */
    uint64_t seed;               /* another choice of sample sets of the same quality */
} dfield_screen_desc;

/* DISK, QUARTIC, radius 1, sigma 1, 16 samples, 16 steps, interleave 4, filtered, limit 0.25, VIEW, RATIO,
   ambient 1, seed 0. */
DFIELD_API void dfield_screen_desc_init(dfield_screen_desc* desc);

/* mu at a distance >= 0 by the desc's measure, radius and sigma; 1 from R on. NaN for a desc that makes no
 * sense. */
DFIELD_API float dfield_screen_measure(const dfield_screen_desc* desc, float distance);

/* Sample sets, and memory for frames of the sizes it has seen. One thread at a time; the context's
   parallel_for splits its work, and results are the same at any number of threads. Levels of SIMD agree
   within 1e-4 in visibility, of the value itself where PLAIN is above 1, and 1e-3 of the brightest radiance
   around in indirect light. Every estimator is vectorised with every measure; DFIELD_SIMD_SCALAR runs the
   reference. */
typedef struct dfield_screen dfield_screen;

DFIELD_API dfield_status dfield_screen_create(dfield_context* context, const dfield_screen_desc* desc,
                                              dfield_screen** screen);
DFIELD_API void dfield_screen_release(dfield_screen* screen); /* null is fine */

/* All null: nothing is wanted, nothing done. */
typedef struct dfield_screen_outputs {
    size_t struct_size;              /* sizeof(dfield_screen_outputs) */
    dfield_screen_target visibility; /* O, 1 float: 0..1 but for PLAIN; sky: 1 */
    /* I, 3 floats; sky: 0. L~ is the mean over the samples, each with the radiance of the pixel it is looked
       up in and the weight 1 - (r/R)^4, r the distance of that pixel's surface from s: none from R on.
       Surfaces that are turned away from s (the test of section 3.1) or behind its tangent plane have none
       either. The two tests fade in over R/16, and every sample has 1e-4 of darkness: nothing else would be
       stable on a plane. The filter averages the sums of radiance and of weights, and O, before I is made of
       them. Needs radiance. */
    dfield_screen_target indirect;
    dfield_screen_target reflected; /* a (La O + I), 3 floats; I = 0 without radiance; sky: 0 */
} dfield_screen_outputs;

/* A frame. Outputs may not overlap buffers. On failure outputs may have been written to. Allocates when a
   frame is larger, or asks for more, than any before it. */
DFIELD_API dfield_status dfield_screen_shade(dfield_screen* screen, const dfield_screen_buffers* buffers,
                                             const dfield_screen_outputs* outputs);

/* By brute force, what the screen's estimator converges to at some pixels: thousands of lookups each, every
   pixel of the disk for DISK (of disks more than 512 pixels across, about 512 x 512 of them), 65,536 points
   for the others (MARCH: 4,096 rays of its march_steps), none of its samples; no interleaving, no filter.
   `pixels`: `count` indices column + width * row, null for all of the picture in order (count is not read).
   visibility: count floats, packed. indirect: 3 count floats or null. */
DFIELD_API dfield_status dfield_screen_integral(dfield_screen* screen, const dfield_screen_buffers* buffers,
                                                const uint32_t* pixels, size_t count, float* visibility,
                                                float* indirect);

/* The unit normals that are used, 3 floats: the buffers' own or those derived from depth; sky: 0. */
DFIELD_API dfield_status dfield_screen_normals(dfield_context* context, const dfield_screen_buffers* buffers,
                                               const dfield_screen_target* normals);

#ifdef __cplusplus
}
#endif

#endif
