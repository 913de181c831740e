/*
 * What the components share: names of parameters from the C interface, and their values in HAL.
 *
 * A parameter of the C interface becomes a HAL parameter of the same name with "-" for "_", in SI; a choice is the index of its
 * word. docs/guides/linuxcnc.md lists them.
 */
#ifndef STRIBECK_HAL_PARTS_H
#define STRIBECK_HAL_PARTS_H

#include <stribeck/stribeck.h>

#include "rtapi.h"
/* rtapi.h before these */
#include "hal.h"
#include "rtapi_app.h"
#include "rtapi_string.h"

#define MAX_PARAMETERS 256
#define MAX_INSTANCES 8

typedef stribeck_result (*parameter_list)(uint32_t, stribeck_parameter*);

/* Values in HAL memory, and those the last configuration was made from. HAL has 1 MiB for everything and takes nothing back when a
 * component goes, so that only what must be there is. */
struct values {
  hal_float_t* value;
  double used[MAX_PARAMETERS];
};

/* Names and initial values, the same for all instances. */
struct parameters {
  uint32_t count;
  char name[MAX_PARAMETERS][48]; /* of the C interface */
  double initial[MAX_PARAMETERS];
};

static inline int same(double a, double b) { return a == b || (a != a && b != b); }

static inline void find_parameters(struct parameters* all, parameter_list list) {
  stribeck_parameter p;
  all->count = 0;
  while (all->count < MAX_PARAMETERS && list(all->count, &p) == STRIBECK_OK) {
    rtapi_snprintf(all->name[all->count], sizeof all->name[0], "%s", p.name);
    all->initial[all->count++] = p.value;
  }
}

/* One HAL parameter for each, called PREFIX.NAME. */
static inline int export_parameters(const struct parameters* all, struct values* v, int component,
                                    const char* prefix) {
  v->value = hal_malloc((long)(all->count * sizeof *v->value));
  if (v->value == NULL) return -ENOMEM;
  for (uint32_t i = 0; i < all->count; ++i) {
    char name[64];
    rtapi_snprintf(name, sizeof name, "%s", all->name[i]);
    for (char* c = name; *c != '\0'; ++c) {
      if (*c == '_') *c = '-';
    }
    v->value[i] = all->initial[i];
    v->used[i] = all->initial[i];
    const int r = hal_param_float_newf(HAL_RW, &v->value[i], component, "%s.%s", prefix, name);
    if (r < 0) return r;
  }
  return 0;
}

static inline int values_changed(const struct parameters* all, const struct values* v) {
  for (uint32_t i = 0; i < all->count; ++i) {
    if (!same(v->value[i], v->used[i])) return 1;
  }
  return 0;
}

static inline void values_taken(const struct parameters* all, struct values* v) {
  for (uint32_t i = 0; i < all->count; ++i) v->used[i] = v->value[i];
}

#endif
