/* The context: hooks that everything made from it uses. Part of dfield.h. */
#ifndef DFIELD_CONTEXT_H
#define DFIELD_CONTEXT_H

#include "dfield/base.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct dfield_context dfield_context;

/* Instruction sets of the queries, as a cap: the best one up to it that the machine has. Results differ
   between levels in the last bits only; SCALAR is plain C++. */
typedef enum dfield_simd {
    DFIELD_SIMD_BEST = 0, /* no cap */
    DFIELD_SIMD_SCALAR = 1,
    DFIELD_SIMD_SSE4 = 2,
    DFIELD_SIMD_AVX2 = 3,
    DFIELD_SIMD_AVX512 = 4,
    DFIELD_SIMD_NEON = 5
} dfield_simd;

typedef enum dfield_log_level {
    DFIELD_LOG_INFO = 0,
    DFIELD_LOG_WARNING = 1 /* works, but not as well as it could: the message says what to do */
} dfield_log_level;

typedef struct dfield_context_desc {
    size_t struct_size; /* sizeof(dfield_context_desc) */
    void* user;         /* handed to every hook */
    /* Both or neither. Called by what creates, loads, edits, commits, updates and releases, from the calling
       thread (updates: also from the threads of parallel_for); never in queries. `allocate` returns null on
       failure. `alignment` is a power of two. */
    void* (*allocate)(void* user, size_t size, size_t alignment);
    void (*deallocate)(void* user, void* memory, size_t size, size_t alignment);
    /* Optional: runs body(data, begin, end) over disjoint ranges that cover [0, count), on any threads, and
       returns when all have ended. Queries and updates hand their batches to it. Without it they run on the
       calling thread. dfield/threads.hpp has one on std::thread. */
    void (*parallel_for)(void* user, size_t count, void (*body)(void* data, size_t begin, size_t end),
                         void* data);
    /* Optional: one line of text without line end; level is a dfield_log_level. Called when a context is made
       and when a field is loaded, from the calling thread; never in queries. */
    void (*log)(void* user, int level, const char* message);
    uint32_t simd; /* dfield_simd: cap on the instruction set */
} dfield_context_desc;

/* desc may be null: malloc, no parallel_for, no log, best instruction set. Hooks must be callable from every
   thread that uses what the context made. The context lives until it and everything made from it are
   released. Any thread. */
DFIELD_API dfield_status dfield_context_create(const dfield_context_desc* desc, dfield_context** context);
DFIELD_API void dfield_context_release(dfield_context* context); /* null is fine */

/* The level that queries of this context run at: the best one of this machine up to the cap. Any thread. */
DFIELD_API dfield_simd dfield_context_get_simd(const dfield_context* context);

#ifdef __cplusplus
}
#endif

#endif
