/* Version, status codes and messages. Part of dfield.h. */
#ifndef DFIELD_BASE_H
#define DFIELD_BASE_H

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

#define DFIELD_VERSION_MAJOR 0
#define DFIELD_VERSION_MINOR 2
#define DFIELD_VERSION_PATCH 0

/* Version of the library that runs, 10000 * major + 100 * minor + patch. Any thread. */
DFIELD_API uint32_t dfield_version(void);

typedef enum dfield_status {
    DFIELD_OK = 0,
    DFIELD_INVALID_ARGUMENT = 1, /* null pointer, NaN, singular transform, unknown id: the message names it */
    DFIELD_OUT_OF_MEMORY = 2,
    DFIELD_FILE_ERROR = 3,    /* a file that cannot be opened or read */
    DFIELD_FORMAT_ERROR = 4,  /* bytes that are no valid .dfield */
    DFIELD_VERSION_ERROR = 5, /* a .dfield of a newer major version: bake again or update */
    DFIELD_INTERNAL_ERROR = 6 /* our bug */
} dfield_status;

/* Static text for a status, never null. Any thread. */
DFIELD_API const char* dfield_status_name(dfield_status status);

/* What the last failing call on this thread said; valid until the next failing call on it. Never null. */
DFIELD_API const char* dfield_error_message(void);

#ifdef __cplusplus
}
#endif

#endif
