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

#include <math.h>
#include <string.h>

#define MAX_PARAMETERS 256
#define MAX_INSTANCES 8

typedef stribeck_result (*parameter_list)(uint32_t, stribeck_parameter*);

/* Values in HAL memory, and those the last configuration was made from. HAL has 1 MiB for everything, so that only what must be there
 * is. */
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

/* HAL takes no memory back when a component goes. The loader keeps these modules (-z nodelete), and with them this list: a component
 * that is loaded again uses the blocks it had before. */
#define MAX_BLOCKS 64
static struct {
  void* at;
  size_t size;
  int in_use;
} hal_blocks[MAX_BLOCKS];

/* HAL memory of zeros; NULL: there is none left. */
static inline void* take_hal_memory(size_t size) {
  for (int i = 0; i < MAX_BLOCKS; ++i) {
    const int mine = hal_blocks[i].at != NULL;
    if (mine && (hal_blocks[i].in_use || hal_blocks[i].size != size)) continue;
    if (!mine) hal_blocks[i].at = hal_malloc((long)size);
    if (hal_blocks[i].at == NULL) return NULL;
    hal_blocks[i].size = size;
    hal_blocks[i].in_use = 1;
    return memset(hal_blocks[i].at, 0, size);
  }
  void* more = hal_malloc((long)size);
  return more == NULL ? NULL : memset(more, 0, size);
}

/* After hal_exit: what was taken may be used again, and the next load begins with no names. */
static inline void end_of_component(char** names) {
  for (int i = 0; i < MAX_BLOCKS; ++i) hal_blocks[i].in_use = 0;
  for (int i = 0; i < MAX_INSTANCES; ++i) names[i] = NULL;
}

static inline int same(double a, double b) { return a == b || (a != a && b != b); }

/* Friction that differs along the travel is left out: a list of thirteen places would take more of HAL's memory than all the rest. */
static inline void find_parameters(struct parameters* all, parameter_list list) {
  stribeck_parameter p;
  all->count = 0;
  for (uint32_t i = 0; all->count < MAX_PARAMETERS && list(i, &p) == STRIBECK_OK; ++i) {
    if (strncmp(p.name, "friction.places.", 16) == 0) continue;
    rtapi_snprintf(all->name[all->count], sizeof all->name[0], "%s", p.name);
    all->initial[all->count++] = p.value;
  }
}

/* How many names there are, all of which can be loaded: none empty, none twice, none so long that with `suffix` letters and the
 * longest parameter it does not go into a HAL name. Else it says which and answers -1. */
static inline int count_names(const char* module, char* const* names, const struct parameters* all,
                              int suffix) {
  size_t longest = 0;
  for (uint32_t i = 0; i < all->count; ++i) {
    if (strlen(all->name[i]) > longest) longest = strlen(all->name[i]);
  }
  const size_t room = HAL_NAME_LEN - 1 - longest - (size_t)suffix;
  int n = 0;
  for (; n < MAX_INSTANCES && names[n] != NULL; ++n) {
    const char* wrong = names[n][0] == '\0' ? "is empty" : NULL;
    for (int k = 0; k < n; ++k) {
      if (strcmp(names[k], names[n]) == 0) wrong = "is there twice";
    }
    if (wrong != NULL) {
      rtapi_print_msg(RTAPI_MSG_ERR, "%s: names: \"%s\" %s\n", module, names[n], wrong);
      return -1;
    }
    if (strlen(names[n]) > room) {
      rtapi_print_msg(RTAPI_MSG_ERR, "%s: names: \"%s\" is too long, expected at most %d letters\n", module,
                      names[n], (int)room);
      return -1;
    }
  }
  if (n == 0) {
    rtapi_print_msg(RTAPI_MSG_ERR, "%s: no names, expected e.g. loadrt %s names=a,b\n", module, module);
    return -1;
  }
  return n;
}

/* Whether this component was made for the library that it found. */
static inline int abi_good(const char* module) {
  if (stribeck_abi() == STRIBECK_ABI) return 1;
  rtapi_print_msg(RTAPI_MSG_ERR, "%s: made for version %u of the C interface, the library has %u\n", module,
                  STRIBECK_ABI, stribeck_abi());
  return 0;
}

/* A problem of the C interface in HAL's spelling. */
static inline void say_problem(const char* module, const char* who, const char* problem) {
  char text[256];
  rtapi_snprintf(text, sizeof text, "%s", problem);
  for (char* c = text; *c != '\0'; ++c) {
    if (*c == '_') *c = '-';
  }
  rtapi_print_msg(RTAPI_MSG_ERR, "%s: %s: %s\n", module, who, text);
}

static inline int positive(double x) { return isfinite(x) && x > 0.0; }

/* One HAL parameter for each, called PREFIX.NAME. */
static inline int export_parameters(const struct parameters* all, struct values* v, int component,
                                    const char* prefix) {
  v->value = take_hal_memory(all->count * sizeof *v->value);
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
