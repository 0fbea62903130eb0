/* Receivers that stay from frame to frame: updates compute again only what changed. Part of dfield.h. */
#ifndef DFIELD_RECEIVER_SET_H
#define DFIELD_RECEIVER_SET_H

#include "dfield/ambient.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Used by one thread at a time. */
typedef struct dfield_receiver_set dfield_receiver_set;

typedef struct dfield_receiver_set_desc {
    size_t struct_size;         /* sizeof(dfield_receiver_set_desc) */
    dfield_ao* ao;              /* kept */
    dfield_receivers receivers; /* copied */
    /* May be null. The instance that a receiver is attached to, DFIELD_NO_INSTANCE for none: position and
       normal are then in that instance's object space and move with it. Without the instance in the scene it
       is open. */
    const dfield_instance* attached;
    size_t attached_stride;
} dfield_receiver_set_desc;

/* All are open until the first update. */
DFIELD_API dfield_status dfield_receiver_set_create(dfield_context* context,
                                                    const dfield_receiver_set_desc* desc,
                                                    dfield_receiver_set** set);
DFIELD_API void dfield_receiver_set_release(dfield_receiver_set* set); /* null is fine */

typedef struct dfield_update_stats {
    size_t instances; /* that came, went, moved, hid, showed or got another field since the last update */
    size_t computed;  /* receivers that were looked at again */
    size_t changed;   /* receivers whose result is another one now */
} dfield_update_stats;

/* Brings all results to the state of `snapshot`, which may be of any scene of the set's context; the set
   keeps it until the next update. Looks again only at what the old and the new places of changed instances
   can affect, and ends with what a new set would compute, bit for bit. The ground's change computes all
   again. `stats` may be null. Allocates through the hooks. On failure the set is as before, or all is
   computed again by the next update. */
DFIELD_API dfield_status dfield_receiver_set_update(dfield_receiver_set* set, dfield_snapshot* snapshot,
                                                    dfield_update_stats* stats);

/* One float a receiver in the order that they were given in, as dfield_outputs.visibility. The pointer stays,
   the values change with updates. */
DFIELD_API const float* dfield_receiver_set_get_visibility(const dfield_receiver_set* set);

/* Indices of the receivers that the last update changed, in no certain order; valid until the next update. */
DFIELD_API const uint32_t* dfield_receiver_set_get_changed(const dfield_receiver_set* set, size_t* count);

/* Writes what `outputs` asks for, of all receivers or only of those that the last update changed. */
DFIELD_API dfield_status dfield_receiver_set_get_outputs(const dfield_receiver_set* set,
                                                         const dfield_outputs* outputs, int only_changed);

#ifdef __cplusplus
}
#endif

#endif
