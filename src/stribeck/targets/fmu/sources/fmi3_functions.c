/* The functions of FMI 3.0 for model exchange and co-simulation of the axes in axes.h.
 *
 * Value references: 0 time; then velocity, position and friction of every axis; the states, their rates, the event indicators, the
 * parameters. In co-simulation the inputs are held over a step, and the bristles are advanced exactly. Parameters are fixed once the
 * initialization mode has ended.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "axes.h"
#include "fmi3.h"

enum {
  FIRST_VELOCITY = 1,
  FIRST_POSITION = FIRST_VELOCITY + AXES,
  FIRST_FRICTION = FIRST_POSITION + AXES,
  FIRST_STATE = FIRST_FRICTION + AXES,
  FIRST_RATE = FIRST_STATE + STATES,
  FIRST_INDICATOR = FIRST_RATE + STATES,
  FIRST_PARAMETER = FIRST_INDICATOR + INDICATORS,
  END = FIRST_PARAMETER + PARAMETERS
};

/* All that a state of the FMU consists of. */
struct values {
  double time;
  double velocity[AXES];
  double position[AXES];
  double settled[AXES]; /* velocity at which stick and slip were last told apart */
  struct bristles bristles[AXES];
  double parameters[PARAMETERS];
  int initialized;
};

struct instance {
  struct values now;
  void* environment;
  log_message log;
};

static fmi3Status refused(const struct instance* i, const char* why) {
  if (i && i->log) i->log(i->environment, fmi3Error, "error", why);
  return fmi3Error;
}

static void start_values(struct values* now) {
  int i;
  memset(now, 0, sizeof *now);
  for (i = 0; i < PARAMETERS; ++i) now->parameters[i] = kParameters[i];
}

static struct instance* new_instance(fmi3String token, void* environment, log_message log) {
  struct instance* i = calloc(1, sizeof *i);
  if (!i) return NULL;
  i->environment = environment;
  i->log = log;
  start_values(&i->now);
  if (token && strcmp(token, TOKEN) == 0) return i;
  refused(i, "the instantiation token is not that of this model: modelDescription.xml and binary differ");
  free(i);
  return NULL;
}

/* The axis and the element of a state. */
static int axis_of_state(int state, int* element) {
  int a = 0;
  while (state >= kAxes[a].first_state + kAxes[a].states) ++a;
  *element = state - kAxes[a].first_state;
  return a;
}

static double rate_of(const struct values* now, int state) {
  double rates[MOST_ELEMENTS];
  int element;
  const int a = axis_of_state(state, &element);
  bristle_rates(&kAxes[a], now->parameters, &now->bristles[a], now->velocity[a], now->position[a], rates);
  return rates[element];
}

/* First the velocity of each axis, then the distance from slip of each element. */
static double indicator_of(const struct values* now, int indicator) {
  int a;
  if (indicator < AXES) return now->velocity[indicator];
  indicator -= AXES;
  for (a = 0; indicator >= kAxes[a].elements; ++a) indicator -= kAxes[a].elements;
  return distance_from_slip(&kAxes[a], now->parameters, &now->bristles[a], indicator, now->velocity[a],
                            now->position[a]);
}

static double value_of(const struct values* now, int r) {
  int element;
  int a;
  if (r == 0) return now->time;
  if (r < FIRST_POSITION) return now->velocity[r - FIRST_VELOCITY];
  if (r < FIRST_FRICTION) return now->position[r - FIRST_POSITION];
  if (r < FIRST_STATE) {
    a = r - FIRST_FRICTION;
    return friction_force(&kAxes[a], now->parameters, &now->bristles[a], now->velocity[a], now->position[a]);
  }
  if (r < FIRST_RATE) {
    a = axis_of_state(r - FIRST_STATE, &element);
    return now->bristles[a].value[element];
  }
  if (r < FIRST_INDICATOR) return rate_of(now, r - FIRST_RATE);
  if (r < FIRST_PARAMETER) return indicator_of(now, r - FIRST_INDICATOR);
  return now->parameters[r - FIRST_PARAMETER];
}

static void set_state(struct values* now, int state, double value) {
  int element;
  const int a = axis_of_state(state, &element);
  now->bristles[a].value[element] = value;
}

EXPORT const char* FMI(fmi3GetVersion)(void) { return "3.0"; }

EXPORT fmi3Status FMI(fmi3SetDebugLogging)(void* instance, bool on, size_t n, const fmi3String categories[]) {
  (void)instance, (void)on, (void)n, (void)categories;
  return fmi3OK;
}

EXPORT void* FMI(fmi3InstantiateModelExchange)(fmi3String name, fmi3String token, fmi3String resources,
                                               bool visible, bool logging, void* environment,
                                               log_message log) {
  (void)name, (void)resources, (void)visible, (void)logging;
  return new_instance(token, environment, log);
}

EXPORT void* FMI(fmi3InstantiateCoSimulation)(fmi3String name, fmi3String token, fmi3String resources,
                                              bool visible, bool logging, bool event_mode, bool early_return,
                                              const fmi3ValueReference intermediate[], size_t n,
                                              void* environment, log_message log, void (*update)(void)) {
  (void)name, (void)resources, (void)visible, (void)logging, (void)event_mode, (void)early_return;
  (void)intermediate, (void)n, (void)update;
  return new_instance(token, environment, log);
}

EXPORT void* FMI(fmi3InstantiateScheduledExecution)(fmi3String name, fmi3String token, fmi3String resources,
                                                    bool visible, bool logging, void* environment,
                                                    log_message log, void (*clock)(void), void (*lock)(void),
                                                    void (*unlock)(void)) {
  const struct instance asked = {.environment = environment, .log = log};
  (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)clock, (void)lock,
      (void)unlock;
  refused(&asked, "scheduled execution is not part of this model");
  return NULL;
}

EXPORT void FMI(fmi3FreeInstance)(void* instance) { free(instance); }

EXPORT fmi3Status FMI(fmi3EnterInitializationMode)(void* instance, bool tolerance_defined, double tolerance,
                                                   double start, bool stop_defined, double stop) {
  struct instance* i = instance;
  (void)tolerance_defined, (void)tolerance, (void)stop_defined, (void)stop;
  if (!isfinite(start)) return refused(i, "the start time is not a number");
  i->now.time = start;
  return fmi3OK;
}

EXPORT fmi3Status FMI(fmi3ExitInitializationMode)(void* instance) {
  struct instance* i = instance;
  int a;
  for (a = 0; a < AXES; ++a) {
    const char* fault = parameter_fault(&kAxes[a], i->now.parameters);
    if (fault) return refused(i, fault);
    i->now.settled[a] = i->now.velocity[a];
  }
  i->now.initialized = 1;
  return fmi3OK;
}

EXPORT fmi3Status FMI(fmi3Reset)(void* instance) {
  start_values(&((struct instance*)instance)->now);
  return fmi3OK;
}

EXPORT fmi3Status FMI(fmi3GetFloat64)(void* instance, const fmi3ValueReference references[], size_t n,
                                      double values[], size_t n_values) {
  struct instance* i = instance;
  size_t k;
  if (n != n_values) return refused(i, "fmi3GetFloat64: every variable has one value");
  for (k = 0; k < n; ++k) {
    if (references[k] >= END) return refused(i, "fmi3GetFloat64: no variable has this value reference");
    values[k] = value_of(&i->now, (int)references[k]);
  }
  return fmi3OK;
}

static fmi3Status set_value(struct instance* i, fmi3ValueReference r, double value) {
  if (!isfinite(value)) return refused(i, "fmi3SetFloat64: the value is not a number");
  if (r >= FIRST_VELOCITY && r < FIRST_POSITION) {
    i->now.velocity[r - FIRST_VELOCITY] = value;
  } else if (r >= FIRST_POSITION && r < FIRST_FRICTION) {
    i->now.position[r - FIRST_POSITION] = value;
  } else if (i->now.initialized) {
    return refused(i, "fmi3SetFloat64: after the initialization only velocity and position can be set");
  } else if (r >= FIRST_STATE && r < FIRST_RATE) {
    set_state(&i->now, (int)r - FIRST_STATE, value);
  } else if (r >= FIRST_PARAMETER && r < END) {
    i->now.parameters[r - FIRST_PARAMETER] = value;
  } else {
    return refused(i, "fmi3SetFloat64: this variable cannot be set");
  }
  return fmi3OK;
}

EXPORT fmi3Status FMI(fmi3SetFloat64)(void* instance, const fmi3ValueReference references[], size_t n,
                                      const double values[], size_t n_values) {
  struct instance* i = instance;
  size_t k;
  if (n != n_values) return refused(i, "fmi3SetFloat64: every variable has one value");
  for (k = 0; k < n; ++k) {
    const fmi3Status status = set_value(i, references[k], values[k]);
    if (status != fmi3OK) return status;
  }
  return fmi3OK;
}

/* Co-simulation */

EXPORT fmi3Status FMI(fmi3DoStep)(void* instance, double time, double step, bool no_set_state,
                                  bool* event_needed, bool* terminate, bool* early_return,
                                  double* last_time) {
  struct instance* i = instance;
  int a;
  (void)no_set_state;
  *event_needed = *terminate = *early_return = false;
  *last_time = i->now.time;
  if (!i->now.initialized) return refused(i, "fmi3DoStep: the initialization has not ended");
  if (!(isfinite(time) && isfinite(step) && step > 0.0))
    return refused(i, "fmi3DoStep: expected a step above zero");
  for (a = 0; a < AXES; ++a)
    advance_bristles(&kAxes[a], i->now.parameters, &i->now.bristles[a], i->now.velocity[a],
                     i->now.position[a], step);
  i->now.time = *last_time = time + step;
  return fmi3OK;
}

/* Model exchange */

EXPORT fmi3Status FMI(fmi3UpdateDiscreteStates)(void* instance, bool* need_update, bool* terminate,
                                                bool* nominals_changed, bool* values_changed,
                                                bool* next_event_defined, double* next_event) {
  struct instance* i = instance;
  int a;
  *need_update = *terminate = *nominals_changed = *values_changed = *next_event_defined = false;
  *next_event = 0.0;
  for (a = 0; a < AXES; ++a) {
    if (settle_bristles(&kAxes[a], i->now.parameters, &i->now.bristles[a], i->now.settled[a],
                        i->now.velocity[a], i->now.position[a]))
      *values_changed = true;
    i->now.settled[a] = i->now.velocity[a];
  }
  return fmi3OK;
}

EXPORT fmi3Status FMI(fmi3CompletedIntegratorStep)(void* instance, bool no_set_state, bool* enter_event_mode,
                                                   bool* terminate) {
  (void)instance, (void)no_set_state;
  *enter_event_mode = *terminate = false;
  return fmi3OK;
}

EXPORT fmi3Status FMI(fmi3SetTime)(void* instance, double time) {
  if (!isfinite(time)) return refused(instance, "fmi3SetTime: the time is not a number");
  ((struct instance*)instance)->now.time = time;
  return fmi3OK;
}

EXPORT fmi3Status FMI(fmi3SetContinuousStates)(void* instance, const double states[], size_t n) {
  struct instance* i = instance;
  int k;
  if (n != STATES) return refused(i, "fmi3SetContinuousStates: wrong number of states");
  for (k = 0; k < STATES; ++k) {
    if (!isfinite(states[k])) return refused(i, "fmi3SetContinuousStates: a state is not a number");
    set_state(&i->now, k, states[k]);
  }
  return fmi3OK;
}

/* `n` values from a value reference on. */
static fmi3Status several(struct instance* i, int first, int count, double values[], size_t n) {
  int k;
  if (n != (size_t)count) return refused(i, "wrong number of states or event indicators");
  for (k = 0; k < count; ++k) values[k] = value_of(&i->now, first + k);
  return fmi3OK;
}

EXPORT fmi3Status FMI(fmi3GetContinuousStates)(void* instance, double states[], size_t n) {
  return several(instance, FIRST_STATE, STATES, states, n);
}

EXPORT fmi3Status FMI(fmi3GetContinuousStateDerivatives)(void* instance, double rates[], size_t n) {
  return several(instance, FIRST_RATE, STATES, rates, n);
}

EXPORT fmi3Status FMI(fmi3GetEventIndicators)(void* instance, double indicators[], size_t n) {
  return several(instance, FIRST_INDICATOR, INDICATORS, indicators, n);
}

EXPORT fmi3Status FMI(fmi3GetNominalsOfContinuousStates)(void* instance, double nominals[], size_t n) {
  int element;
  int k;
  if (n != STATES) return refused(instance, "wrong number of states");
  for (k = 0; k < STATES; ++k)
    nominals[k] = kAxes[axis_of_state(k, &element)].dynamics == LUGRE ? LUGRE_NOMINAL : GMS_NOMINAL;
  return fmi3OK;
}

EXPORT fmi3Status FMI(fmi3GetNumberOfEventIndicators)(void* instance, size_t* n) {
  (void)instance;
  *n = INDICATORS;
  return fmi3OK;
}

EXPORT fmi3Status FMI(fmi3GetNumberOfContinuousStates)(void* instance, size_t* n) {
  (void)instance;
  *n = STATES;
  return fmi3OK;
}

/* The state of the FMU */

EXPORT fmi3Status FMI(fmi3GetFMUState)(void* instance, void** state) {
  const struct instance* i = instance;
  if (!*state) *state = malloc(sizeof i->now);
  if (!*state) return refused(i, "fmi3GetFMUState: no memory");
  memcpy(*state, &i->now, sizeof i->now);
  return fmi3OK;
}

EXPORT fmi3Status FMI(fmi3SetFMUState)(void* instance, void* state) {
  struct instance* i = instance;
  if (!state) return refused(i, "fmi3SetFMUState: there is no state");
  memcpy(&i->now, state, sizeof i->now);
  return fmi3OK;
}

EXPORT fmi3Status FMI(fmi3FreeFMUState)(void* instance, void** state) {
  (void)instance;
  free(*state);
  *state = NULL;
  return fmi3OK;
}

EXPORT fmi3Status FMI(fmi3SerializedFMUStateSize)(void* instance, void* state, size_t* size) {
  (void)instance, (void)state;
  *size = sizeof(struct values);
  return fmi3OK;
}

EXPORT fmi3Status FMI(fmi3SerializeFMUState)(void* instance, void* state, uint8_t bytes[], size_t size) {
  if (!state || size < sizeof(struct values)) return refused(instance, "fmi3SerializeFMUState: no room");
  memcpy(bytes, state, sizeof(struct values));
  return fmi3OK;
}

EXPORT fmi3Status FMI(fmi3DeserializeFMUState)(void* instance, const uint8_t bytes[], size_t size,
                                               void** state) {
  if (size < sizeof(struct values)) return refused(instance, "fmi3DeserializeFMUState: too few bytes");
  if (!*state) *state = malloc(sizeof(struct values));
  if (!*state) return refused(instance, "fmi3DeserializeFMUState: no memory");
  memcpy(*state, bytes, sizeof(struct values));
  return fmi3OK;
}
