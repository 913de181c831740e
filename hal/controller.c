/*
 * stribeck_axis and stribeck_contour: position controllers with friction compensation for the servo thread of LinuxCNC.
 *
 *   loadrt stribeck_axis names=ax.x,ax.y             one axis each: ax.x.pos-cmd, …, function ax.x
 *   loadrt stribeck_contour names=ct axes=3          one path:      ct.0.pos-cmd, …, function ct
 *
 * A drive that closes its own velocity or position loop (parameters drive-loop.*) gets `command`, in position units (per second), and
 * `offset`, a force beside it; `force-fb` takes the force that it reports. Otherwise it gets `force` or `voltage`. Without enable
 * `command` is no speed, or the encoder's position.
 *
 * Parameters are taken over when enable rises; `pending` tells that some wait. Faults: supervisor.h, and with supervision.checks = 2
 * those of the library, as 100 and their number (docs/guides/faults.md); these stop the axes by braking and hold the load until enable
 * falls. `brake` asks for the holding brakes. Of a contour controller every axis is enabled together, and a fault of one axis takes
 * all down. Law learning needs `phase`, the place in the lap; law
 * predictive sees the present point alone, and tells in `lag` by how much it is behind a command that asks for too much.
 */
#include "hal_parts.h"
#include "supervisor.h"

#include <stdlib.h>

#define LONGEST_RAMP 1.0  /* [s] */
#define LIBRARY_FAULT 100 /* on top of the library's own numbers */

#ifdef STRIBECK_CONTOUR
#define COMPONENT "stribeck_contour"
#define AXES 3
#define LEAST_AXES 2
MODULE_DESCRIPTION("contour controller with friction compensation, two or three axes");
static int axes = AXES;
RTAPI_MP_INT(axes, "axes of every path, 2 or 3");
#else
#define COMPONENT "stribeck_axis"
#define AXES 1
#define LEAST_AXES 1
MODULE_DESCRIPTION("position controller of one axis with friction compensation");
static const int axes = AXES;
#endif
MODULE_LICENSE("GPL"); /* of the module that is loaded: rtapi_app.h is GPL; the sources here are MIT */

static char* names[MAX_INSTANCES] = {0};
RTAPI_MP_ARRAY_STRING(names, MAX_INSTANCES, "names of the controllers");

struct axis {
  hal_float_t *pos_cmd, *vel_cmd, *acc_cmd, *pos_fb, *force_fb;
  hal_float_t *force, *voltage, *command, *offset, *friction_ff, *disturbance, *pos_error;
  hal_s32_t *fault, *bridged;
  hal_bit_t* saturated;
  hal_float_t ferror_limit, jump_limit, frozen_limit;
  hal_float_t force_per_volt;
};

/* What of an instance has to be in HAL memory: nothing is in it that can be elsewhere. */
struct shared {
  hal_bit_t *enable, *faulted, *pending, *brake;
  hal_float_t *phase, *lag;
  hal_float_t position_unit, force_unit, ramp_time;
  struct axis axis[AXES];
};

struct inner {
  struct supervisor watch;
  struct values values;
  double resting; /* position [m] that a drive which takes positions was last given; NaN: none */
};

struct instance {
  const char* name; /* in `names` */
  struct shared* hal;
  double position_used, force_used; /* units that are in use */
  double period;
  int was_enabled;
  int good;    /* the controller is configured */
  int stopped; /* fault of the library's supervision, and its axis */
  uint32_t stopped_axis;
  stribeck_controller* controller;
  size_t size;
  void* memory; /* of the controller, and what is in front of it for alignment */
  struct inner inner[AXES];
};

static int component = -1;
static struct parameters parameters;
static int drive_mode = -1; /* number of drive_loop.mode among them; below 0: there is none */
static struct instance* instances[MAX_INSTANCES];
static int count;

static void refused(const struct instance* s) {
  say_problem(COMPONENT, s->name, stribeck_controller_problem(s->controller));
}

/* The component's own parameters, as far as they mean something; says which does not. Limits and ramp-time count at once. */
static int check_own(const struct instance* s) {
  const struct {
    const char* name;
    double value;
    int good;
  } whole[] = {
      {"position-unit", s->hal->position_unit, positive(s->hal->position_unit)},
      {"force-unit", s->hal->force_unit, positive(s->hal->force_unit)},
      {"ramp-time", s->hal->ramp_time, s->hal->ramp_time >= 0.0 && s->hal->ramp_time <= LONGEST_RAMP}};
  for (size_t i = 0; i < sizeof whole / sizeof whole[0]; ++i) {
    if (whole[i].good) continue;
    rtapi_print_msg(RTAPI_MSG_ERR, COMPONENT ": %s: %s: got %g, expected above 0 (a time: 0 to 1 s)\n",
                    s->name, whole[i].name, whole[i].value);
    return 0;
  }
  for (int a = 0; a < axes; ++a) {
    const struct axis* x = &s->hal->axis[a];
    const struct {
      const char* name;
      double value;
      int good;
    } own[] = {
        {"ferror-limit", x->ferror_limit, x->ferror_limit > 0.0},
        {"jump-limit", x->jump_limit, x->jump_limit > 0.0},
        {"frozen-limit", x->frozen_limit, x->frozen_limit > 0.0},
        {"force-per-volt", x->force_per_volt, x->force_per_volt >= 0.0 && isfinite(x->force_per_volt)}};
    for (size_t i = 0; i < sizeof own / sizeof own[0]; ++i) {
      if (own[i].good) continue;
      rtapi_print_msg(RTAPI_MSG_ERR, COMPONENT ": %s: axis %d: %s: got %g, expected a number above 0\n",
                      s->name, a, own[i].name, own[i].value);
      return 0;
    }
  }
  return 1;
}

/* Units that mean something are taken over; what the encoder said in other ones is forgotten. */
static void take_units(struct instance* s) {
  if (positive(s->hal->force_unit)) s->force_used = s->hal->force_unit;
  if (!positive(s->hal->position_unit) || same(s->hal->position_unit, s->position_used)) return;
  s->position_used = s->hal->position_unit;
  for (int a = 0; a < axes; ++a) s->inner[a].watch.seen = 0;
}

/* A controller from the HAL parameters; says what is wrong with them. */
static int configure(struct instance* s, double period) {
  s->period = period;
  s->controller = stribeck_controller_init(s->controller, s->size, (uint32_t)axes);
  for (int a = 0; a < axes; ++a) {
    struct values* v = &s->inner[a].values;
    values_taken(&parameters, v);
    for (uint32_t i = 0; i < parameters.count; ++i) {
      if (same(v->used[i], parameters.initial[i])) continue;
      if (stribeck_controller_set(s->controller, (uint32_t)a, parameters.name[i], v->used[i]) !=
          STRIBECK_OK) {
        refused(s);
        return 0;
      }
    }
  }
  if (stribeck_controller_configure(s->controller, period) == STRIBECK_OK) return 1;
  refused(s);
  return 0;
}

static int must_configure(const struct instance* s, double period) {
  if (!s->good || !same(period, s->period)) return 1;
  if (!same(s->hal->position_unit, s->position_used) || !same(s->hal->force_unit, s->force_used)) return 1;
  for (int a = 0; a < axes; ++a) {
    if (values_changed(&parameters, &s->inner[a].values)) return 1;
  }
  return 0;
}

/* What HAL says in one period, in SI. */
struct inputs {
  double period;
  double unit; /* position unit that is in use */
  double ramp_time;
  int enable;
  int finite; /* all of `axis` */
  stribeck_axis_input axis[AXES];
  double force[AXES]; /* that the drives report */
  struct limits limits[AXES];
};

static void read_inputs(const struct instance* s, int enable, double period, struct inputs* in) {
  in->period = period;
  in->unit = s->position_used;
  /* What is no time means at once: a force must not stay. */
  in->ramp_time = s->hal->ramp_time <= LONGEST_RAMP ? s->hal->ramp_time : 0.0;
  in->enable = enable;
  in->finite = 1;
  for (int a = 0; a < axes; ++a) {
    const struct axis* x = &s->hal->axis[a];
    stribeck_axis_input* i = &in->axis[a];
    i->position = *x->pos_cmd * in->unit;
    i->velocity = *x->vel_cmd * in->unit;
    i->acceleration = *x->acc_cmd * in->unit;
    i->measured = *x->pos_fb * in->unit;
    in->force[a] = *x->force_fb * s->force_used;
    struct limits* l = &in->limits[a];
    l->ferror = x->ferror_limit * in->unit;
    l->jump = x->jump_limit * in->unit;
    l->frozen = x->frozen_limit * in->unit;
    l->ramp_time = in->ramp_time;
    l->force = INFINITY;
    if (!isfinite(i->position + i->velocity + i->acceleration + i->measured)) in->finite = 0;
  }
}

static void fail_axis(struct instance* s, int a, enum fault f, const struct inputs* in) {
  supervisor_fail(&s->inner[a].watch, f, in->period, in->ramp_time);
}

static enum fault judge_axis(struct instance* s, int a, const struct inputs* in) {
  const stribeck_axis_input* i = &in->axis[a];
  return supervisor_judge(&s->inner[a].watch, &in->limits[a], i->position, i->velocity, i->acceleration,
                          i->measured, in->period);
}

/* Enable has risen: clears the faults, begins every axis where it is, and takes over parameters that have changed. */
static void begin(struct instance* s, const struct inputs* in) {
  s->stopped = 0;
  for (int a = 0; a < axes; ++a) {
    struct supervisor* w = &s->inner[a].watch;
    supervisor_clear(w);
    if (in->finite) {
      supervisor_begin(w, in->axis[a].position, in->axis[a].velocity, in->axis[a].measured);
    } else {
      fail_axis(s, a, judge_axis(s, a, in), in);
    }
  }
  if (!check_own(s)) {
    s->good = 0;
  } else if (must_configure(s, in->period)) {
    s->good = configure(s, in->period);
  } else {
    stribeck_controller_reset(s->controller);
  }
  if (!s->good) fail_axis(s, 0, FAULT_PARAMETERS, in);
}

/* Judges the inputs of axes that run; one fault, or enable that has fallen, takes every axis down. Answers whether the controller
 * runs in this period. */
static int supervise(struct instance* s, const struct inputs* in) {
  int failed = !in->enable;
  for (int a = 0; a < axes; ++a) {
    const struct supervisor* w = &s->inner[a].watch;
    /* Axes that the library brakes leave the command: their inputs are not judged. */
    if (w->mode == MODE_RUNNING && in->enable && s->stopped == 0) {
      const enum fault f = judge_axis(s, a, in);
      if (f != FAULT_NONE) fail_axis(s, a, f, in);
    }
    if (w->fault != FAULT_NONE) failed = 1;
  }
  int runs = 0;
  for (int a = 0; a < axes; ++a) {
    const struct supervisor* w = &s->inner[a].watch;
    if (failed && w->mode == MODE_RUNNING) fail_axis(s, a, FAULT_NONE, in);
    if (w->mode == MODE_RUNNING) runs = 1;
  }
  return runs;
}

/* Forces from the controller. The positions of `in` become those of its reference, which goes over to the command (supervisor.h). */
static void step_controller(struct instance* s, struct inputs* in, double* wanted) {
  for (int a = 0; a < axes; ++a) supervisor_lead(&s->inner[a].watch, &in->axis[a]);
  stribeck_controller_set_phase(s->controller, *s->hal->phase);
  stribeck_controller_set_measured_force(s->controller, in->force);
  if (stribeck_controller_step(s->controller, in->axis, wanted) != STRIBECK_FAULT) return;
  stribeck_supervision why = {0};
  stribeck_controller_supervision(s->controller, &why, sizeof why);
  s->stopped = why.fault;
  s->stopped_axis = why.axis;
}

/* The axis' own fault, else that of the library if it is in this axis. */
static int fault_of(const struct instance* s, int a) {
  const enum fault f = s->inner[a].watch.fault;
  if (f == FAULT_NONE && s->stopped != 0 && s->stopped_axis == (uint32_t)a) return LIBRARY_FAULT + s->stopped;
  return (int)f;
}

/* Whether a sample of the encoder may become the command of a drive that takes a position. While the drive is enabled, one of which a
 * fault says that it is wrong must not, nor one that is far from the last command: the drive would go there. */
static int may_follow(const struct inner* own, const struct inputs* in, int a) {
  const double measured = in->axis[a].measured, jump = in->limits[a].jump;
  const struct supervisor* w = &own->watch;
  if (!isfinite(measured)) return 0;
  if (!in->enable) return !w->seen || fabs(measured - w->last) <= jump;
  return w->fault != FAULT_FEEDBACK_NOT_FINITE && w->fault != FAULT_FEEDBACK_JUMPED &&
         w->fault != FAULT_FEEDBACK_FROZEN && !(fabs(measured - own->resting) > jump);
}

/* Whether the drive takes a position. While it is off what HAL says now counts: the controller may not have been configured yet. */
static int takes_position(const struct inner* own) {
  if (drive_mode < 0) return 0;
  const struct values* v = &own->values;
  return same(own->watch.mode == MODE_OFF ? v->value[drive_mode] : v->used[drive_mode], 1.0);
}

/* `now` is null when the controller does not run: a drive that takes a position is then told where the axis is, or is to be. */
static void write_command(struct instance* s, int a, const struct inputs* in,
                          const stribeck_axis_signals* now) {
  struct inner* own = &s->inner[a];
  double command = 0.0;
  if (now != NULL) {
    command = now->command;
    own->resting = command;
  } else if (takes_position(own)) {
    if (may_follow(own, in, a)) own->resting = in->axis[a].measured;
    const double wanted = isfinite(in->axis[a].position) ? in->axis[a].position : 0.0;
    command = isfinite(own->resting) ? own->resting : wanted;
  }
  const struct axis* x = &s->hal->axis[a];
  *x->command = command / in->unit;
  *x->offset = now != NULL ? now->offset : 0.0;
}

static void write_axis(const struct instance* s, int a, const struct inputs* in, double force,
                       const stribeck_axis_signals* now) {
  const struct axis* x = &s->hal->axis[a];
  *x->force = force / s->force_used;
  *x->voltage = positive(x->force_per_volt) ? force / x->force_per_volt : 0.0;
  *x->friction_ff = now->friction;
  *x->disturbance = now->disturbance;
  const double error = in->axis[a].measured - in->axis[a].position;
  *x->pos_error = isfinite(error) ? error / in->unit : 0.0;
  *x->fault = fault_of(s, a);
  *x->saturated = now->limited != 0;
}

/* Puts out the forces and what belongs to them, and advances every supervisor by one period. */
static void write_outputs(struct instance* s, const struct inputs* in, int runs, const double* wanted) {
  int faulted = s->stopped != 0;
  double lag = 0.0;
  for (int a = 0; a < axes; ++a) {
    struct supervisor* w = &s->inner[a].watch;
    stribeck_axis_signals now = {0};
    if (runs) stribeck_controller_signals(s->controller, (uint32_t)a, &now, sizeof now);
    write_command(s, a, in, runs && w->mode == MODE_RUNNING ? &now : NULL);
    const double force = supervisor_force(w, &in->limits[a], wanted[a]);
    supervisor_advance(w, &in->limits[a], in->axis[a].measured, in->period);
    write_axis(s, a, in, force, &now);
    /* Without the controller the last count stays. */
    if (runs) *s->hal->axis[a].bridged = (hal_s32_t)(now.bridged & 0x7fffffff);
    if (isfinite(now.lag)) lag = now.lag;
    if (w->fault != FAULT_NONE) faulted = 1;
  }
  *s->hal->lag = lag;
  *s->hal->faulted = faulted != 0;
  *s->hal->brake = faulted != 0;
  *s->hal->pending = runs && must_configure(s, in->period);
}

static void update(void* arg, long period_ns) {
  struct instance* s = arg;
  const int enable = *s->hal->enable != 0;
  const int rises = enable && !s->was_enabled;
  s->was_enabled = enable;
  if (rises) take_units(s);
  struct inputs in;
  read_inputs(s, enable, 1e-9 * (double)period_ns, &in);
  if (rises) begin(s, &in);
  const int runs = supervise(s, &in);
  double wanted[AXES] = {0};
  if (runs) step_controller(s, &in, wanted);
  write_outputs(s, &in, runs, wanted);
}

static int make_axis(struct axis* x, struct inner* inner, const char* prefix) {
  int r = 0;
  const struct {
    const char* name;
    hal_float_t** pin;
    hal_pin_dir_t direction;
  } pins[] = {{"pos-cmd", &x->pos_cmd, HAL_IN},          {"vel-cmd", &x->vel_cmd, HAL_IN},
              {"acc-cmd", &x->acc_cmd, HAL_IN},          {"pos-fb", &x->pos_fb, HAL_IN},
              {"force-fb", &x->force_fb, HAL_IN},        {"force", &x->force, HAL_OUT},
              {"voltage", &x->voltage, HAL_OUT},         {"command", &x->command, HAL_OUT},
              {"offset", &x->offset, HAL_OUT},           {"friction-ff", &x->friction_ff, HAL_OUT},
              {"disturbance", &x->disturbance, HAL_OUT}, {"pos-error", &x->pos_error, HAL_OUT}};
  for (size_t i = 0; i < sizeof pins / sizeof pins[0]; ++i) {
    if ((r = hal_pin_float_newf(pins[i].direction, pins[i].pin, component, "%s.%s", prefix, pins[i].name)) <
        0)
      return r;
  }
  if ((r = hal_pin_s32_newf(HAL_OUT, &x->fault, component, "%s.fault", prefix)) < 0) return r;
  if ((r = hal_pin_s32_newf(HAL_OUT, &x->bridged, component, "%s.bridged", prefix)) < 0) return r;
  if ((r = hal_pin_bit_newf(HAL_OUT, &x->saturated, component, "%s.saturated", prefix)) < 0) return r;
  const struct {
    const char* name;
    hal_float_t* value;
    double initial;
  } own[] = {{"ferror-limit", &x->ferror_limit, 1.0},
             {"jump-limit", &x->jump_limit, 0.5},
             {"frozen-limit", &x->frozen_limit, 0.2},
             {"force-per-volt", &x->force_per_volt, 0.0}};
  for (size_t i = 0; i < sizeof own / sizeof own[0]; ++i) {
    *own[i].value = own[i].initial;
    if ((r = hal_param_float_newf(HAL_RW, own[i].value, component, "%s.%s", prefix, own[i].name)) < 0)
      return r;
  }
  return export_parameters(&parameters, &inner->values, component, prefix);
}

/* Room for any law. */
static size_t largest_size(void) {
  size_t largest = 0;
  const char* law = NULL;
  for (uint32_t i = 0; (law = stribeck_controller_parameter_word("law", i)) != NULL; ++i) {
    const size_t size = stribeck_controller_size_for((uint32_t)axes, law);
    if (size > largest) largest = size;
  }
  return largest;
}

static int make(const char* name) {
  const size_t alignment = stribeck_alignment();
  const size_t size = largest_size();
  if (size == 0) return -ENOMEM;
  struct instance* s = calloc(1, sizeof *s);
  if (s == NULL) return -ENOMEM;
  instances[count++] = s;
  s->name = name;
  s->hal = take_hal_memory(sizeof *s->hal);
  s->memory = calloc(1, size + alignment);
  if (s->hal == NULL || s->memory == NULL) return -ENOMEM;
  s->size = size;
  char* memory = s->memory;
  memory += (alignment - (uintptr_t)memory % alignment) % alignment;
  s->controller = stribeck_controller_init(memory, size, (uint32_t)axes);
  if (s->controller == NULL) return -EINVAL;
  int r = 0;
  if ((r = hal_pin_bit_newf(HAL_IN, &s->hal->enable, component, "%s.enable", name)) < 0) return r;
  if ((r = hal_pin_bit_newf(HAL_OUT, &s->hal->faulted, component, "%s.faulted", name)) < 0) return r;
  if ((r = hal_pin_bit_newf(HAL_OUT, &s->hal->pending, component, "%s.pending", name)) < 0) return r;
  if ((r = hal_pin_bit_newf(HAL_OUT, &s->hal->brake, component, "%s.brake", name)) < 0) return r;
  if ((r = hal_pin_float_newf(HAL_IN, &s->hal->phase, component, "%s.phase", name)) < 0) return r;
  if ((r = hal_pin_float_newf(HAL_OUT, &s->hal->lag, component, "%s.lag", name)) < 0) return r;
  for (int a = 0; a < axes; ++a) s->inner[a].resting = NAN;
  s->hal->position_unit = s->position_used = 1e-3;
  s->hal->force_unit = s->force_used = 1.0;
  s->hal->ramp_time = 0.02;
  if ((r = hal_param_float_newf(HAL_RW, &s->hal->position_unit, component, "%s.position-unit", name)) < 0)
    return r;
  if ((r = hal_param_float_newf(HAL_RW, &s->hal->force_unit, component, "%s.force-unit", name)) < 0) return r;
  if ((r = hal_param_float_newf(HAL_RW, &s->hal->ramp_time, component, "%s.ramp-time", name)) < 0) return r;
  for (int a = 0; a < axes; ++a) {
    char prefix[HAL_NAME_LEN + 1];
#ifdef STRIBECK_CONTOUR
    rtapi_snprintf(prefix, sizeof prefix, "%s.%d", name, a);
#else
    rtapi_snprintf(prefix, sizeof prefix, "%s", name);
#endif
    if ((r = make_axis(&s->hal->axis[a], &s->inner[a], prefix)) < 0) return r;
  }
  return hal_export_funct(name, update, s, 1, 0, component);
}

static void release(void) {
  if (component >= 0) hal_exit(component);
  component = -1;
  while (count > 0) {
    --count;
    free(instances[count]->memory);
    free(instances[count]);
  }
  end_of_component(names);
#ifdef STRIBECK_CONTOUR
  axes = AXES;
#endif
}

static int load(void) {
  if (!abi_good(COMPONENT)) return -EINVAL;
  if (axes < LEAST_AXES || axes > AXES) {
    rtapi_print_msg(RTAPI_MSG_ERR, COMPONENT ": axes: got %d, expected 2 or 3 (one axis: stribeck_axis)\n",
                    axes);
    return -EINVAL;
  }
  find_parameters(&parameters, stribeck_controller_parameter);
  for (uint32_t i = 0; i < parameters.count; ++i) {
    if (strcmp(parameters.name[i], "drive_loop.mode") == 0) drive_mode = (int)i;
  }
  const int n = count_names(COMPONENT, names, &parameters, LEAST_AXES > 1 ? 2 : 0); /* ct.0 */
  if (n < 0) return -EINVAL;
  component = hal_init(COMPONENT);
  if (component < 0) return component;
  for (int i = 0; i < n; ++i) {
    const int r = make(names[i]);
    if (r < 0) {
      rtapi_print_msg(RTAPI_MSG_ERR, COMPONENT ": \"%s\" could not be made (%d)\n", names[i], r);
      return r;
    }
  }
  hal_ready(component);
  return 0;
}

int rtapi_app_main(void) {
  const int r = load();
  if (r < 0) release();
  return r;
}

void rtapi_app_exit(void) { release(); }
