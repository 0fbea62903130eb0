/* dfield: looks precomputed visibility up. C99, no dependencies. This header is all that is needed; it
   includes
   - base.h: version, status codes, messages
   - context.h: hooks for memory, threads, log; instruction set
   - field.h: loaded .dfield files
   - scene.h: instances of fields, and snapshots of them
   - rays.h: nearest hits, occlusion
   - ambient.h: ambient occlusion of receivers, bent normals, harmonics, masks
   - receiver_set.h: receivers that stay from frame to frame, updated where something changed
   - volume.h: volumes: distance fields and occlusion by sweeping
   - local.h: local ambient occlusion of volumes
   - contextual.h: the same while meshes cut them
   - screen.h: ambient occlusion and indirect light of depth buffers

   A *field* (a .dfield file, baked offline) knows of one rigid object what it hides, for every line that
   meets its bounding sphere. A *scene* places instances of fields by affine transforms and answers rays and
   ambient occlusion in constant time an instance, whatever the triangle count.

   Rules that hold for every function
   - Functions that can fail return a dfield_status; on failure dfield_error_message() says on this thread
   what was wrong, where, and what to do. Outputs are then untouched unless a function says otherwise. Nothing
   is thrown.
   - Lengths are in world units, matrices column-major (glTF, GLM, OpenGL), occlusion is 1 where nothing is
   seen of the sky, visibility is 1 where all of it is.
   - Strides are in bytes; 0 means tightly packed.
   - Structs that begin with struct_size may grow in later versions; set it to their sizeof and the rest to
   zero.
   - Fields, ambient occlusion settings and snapshots are immutable and may be used from any number of
   threads. Scenes and receiver sets are used by one thread at a time, but a scene may be queried from any
   number of threads while nobody edits it.
   - Queries are the functions that take a const dfield_scene*, which may be dfield_snapshot_get_scene of a
   snapshot. They allocate nothing, lock nothing and log nothing, and take at most 512 KiB of each thread's
   stack. Batches may be split anywhere: results do not depend on it. */
#ifndef DFIELD_DFIELD_H
#define DFIELD_DFIELD_H

#include "dfield/ambient.h"
#include "dfield/base.h"
#include "dfield/context.h"
#include "dfield/contextual.h"
#include "dfield/field.h"
#include "dfield/local.h"
#include "dfield/rays.h"
#include "dfield/receiver_set.h"
#include "dfield/scene.h"
#include "dfield/screen.h"
#include "dfield/volume.h"

#endif
