/* Fields: one loaded .dfield. Part of dfield.h. */
#ifndef DFIELD_FIELD_H
#define DFIELD_FIELD_H

#include "dfield/context.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct dfield_field dfield_field; /* immutable: any number of threads may use it */

/* What a field can answer queries with; one file may hold several kinds. */
typedef enum dfield_kind {
    DFIELD_KIND_AUTO = 0,       /* whichever answers the query best */
    DFIELD_KIND_MAPS = 1,       /* displacement maps: any ray, distance of its first hit */
    DFIELD_KIND_LINES = 2,      /* a line table: visibility of any ray */
    DFIELD_KIND_DIRECTIONS = 3, /* direction maps: visibility of receivers that share their directions */
    DFIELD_KIND_VOLUME = 4 /* an occlusion volume: the whole cosine-weighted hemisphere at once, by octants;
                              neither rays nor distances, nor what follows from rays (masks, bent normals) */
} dfield_kind;

typedef enum dfield_positions { DFIELD_POSITIONS_SLATER = 0, DFIELD_POSITIONS_LATLONG = 1 } dfield_positions;
typedef enum dfield_mapping {
    DFIELD_MAPPING_CONCENTRIC = 0,
    DFIELD_MAPPING_POLAR = 1,
    DFIELD_MAPPING_REJECTION = 2
} dfield_mapping;

typedef struct dfield_field_info {
    /* Displacement maps; all 0 where the field has none. */
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
    uint32_t kinds;             /* bit 1 << dfield_kind for each kind that was loaded */
    /* Line table; all 0 where the field has none. */
    uint32_t line_lattice;    /* s: chords between s x s points of the sphere */
    uint32_t line_depth_bits; /* of the last hit on a chord; 0 = none */
    /* Direction maps, the finest level loaded; all 0 where the field has none. */
    uint32_t direction_levels;     /* levels of detail loaded */
    uint32_t direction_count;      /* directions over the sphere */
    uint32_t direction_map_size;   /* texels along a side */
    uint32_t direction_depth_size; /* texels along a side of the depth maps; 0 = none */
    /* Occlusion volume; all 0 where the field has none. */
    uint32_t volume_dims[3]; /* samples along each axis */
    float volume_spacing;    /* between them, object space */
} dfield_field_info;

/* What of a file is loaded: for engines that use one kind, or coarse levels of far objects. */
typedef struct dfield_load_desc {
    size_t struct_size;        /* sizeof(dfield_load_desc) */
    uint32_t kinds;            /* bit 1 << dfield_kind for each kind wanted; 0 = all. The others are neither
                                  decompressed nor checked */
    uint32_t direction_levels; /* at most so many levels of direction maps, coarse ones first; 0 = all */
} dfield_load_desc;

/* Decodes a .dfield; the bytes may be freed afterwards. Safe on any bytes. Any thread. */
DFIELD_API dfield_status dfield_field_load_memory(dfield_context* context, const void* bytes, size_t size,
                                                  dfield_field** field);
/* The same from a file; path is UTF-8 (on Windows too). */
DFIELD_API dfield_status dfield_field_load_file(dfield_context* context, const char* path,
                                                dfield_field** field);
/* The same of a part of the bytes of a file; DFIELD_INVALID_ARGUMENT when it holds none of the wanted kinds.
 */
DFIELD_API dfield_status dfield_field_load_part(dfield_context* context, const dfield_load_desc* desc,
                                                const void* bytes, size_t size, dfield_field** field);

/* Reference counting, any thread. Scenes and snapshots keep what they use. */
DFIELD_API void dfield_field_retain(dfield_field* field);
DFIELD_API void dfield_field_release(dfield_field* field); /* null is fine */

DFIELD_API dfield_status dfield_field_get_info(const dfield_field* field, dfield_field_info* info);

/* Visibility (1 = open) of the object's own vertices past the object itself, as baked by `dfield bake
   --self`, in the order of the vertices in the baked model: self_vertex_count floats that live as long as the
   field. Null when the field has none. */
DFIELD_API const float* dfield_field_get_self_visibility(const dfield_field* field);

#ifdef __cplusplus
}
#endif

#endif
