/* Types of the interface FMI 3.0 (fmi-standard.org), as far as these sources need them. */
#ifndef STRIBECK_FMI3_H
#define STRIBECK_FMI3_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define EXPORT __attribute__((visibility("default")))
#else
#define EXPORT
#endif

/* Linked statically, each name begins with that of the model. */
#ifdef FMI3_FUNCTION_PREFIX
#define JOINED(a, b) a##b
#define PREFIXED(prefix, name) JOINED(prefix, name)
#define FMI(name) PREFIXED(FMI3_FUNCTION_PREFIX, name)
#else
#define FMI(name) name
#endif

typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef uint32_t fmi3ValueReference;
typedef const char* fmi3String;
typedef void (*log_message)(void* environment, fmi3Status status, fmi3String category, fmi3String message);

#endif
