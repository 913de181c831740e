/*
 * stribeck_axis and stribeck_contour: position controllers with friction compensation for the servo thread of LinuxCNC.
 *
 *   loadrt stribeck_axis names=ax.x,ax.y             one axis each: ax.x.pos-cmd, …, function ax.x
 *   loadrt stribeck_contour names=ct axes=3          one path:      ct.0.pos-cmd, …, function ct
 *
 * A drive that closes its own velocity or position loop (parameters drive-loop.*) gets `command`, in position units (per second), and
 * `offset`, a force beside it; `force-fb` takes the force that it reports. Otherwise it gets `force` or `voltage`, and `command` is 0.
 * Without enable `command` is no speed, or the encoder's position. `force`, `offset` and `force-fb` are in force-unit, `friction-ff` and
 * `disturbance` in N.
 *
 * Parameters are taken over when enable rises; `pending` tells that some wait. Faults: supervisor.h, and with supervision.checks = 2
 * those of the library, as 100 and their number (docs/guides/faults.md); these stop the axes by braking. After any fault the load is held
 * until enable falls, and then for brake-time more. `brake` asks for the holding brakes whenever the axes are not controlled. With
 * watch-lateness the library is told how long after the last one a cycle comes.
 *
 * Of a contour controller every axis is enabled together, and a fault of one axis takes all down. Law learning needs `phase`, the place in
 * the lap; law predictive sees the present point alone, and tells in `lag` by how much it is behind a command that asks for too much.
 */
#include "hal_parts.h"
#include "supervisor.h"

#include <stdlib.h>

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

#include "instance.h"

/* What HAL says in one period, in SI. */
struct inputs {
  double period;
  double passed; /* since the last cycle, in whole periods unless it came late [s] */
  double unit;   /* position unit that is in use */
  int enable;
  int finite; /* all of `axis` */
  stribeck_axis_input axis[AXES];
  double force[AXES]; /* that the drives report */
  struct limits limits[AXES];
};

/* Value of a parameter of axis a that is in use. */
static double used(const struct instance* s, int a, int number) {
  return number < 0 ? NAN : s->inner[a].values.used[number];
}

/* The force at which an axis ends that is not controlled any more: its load, within the limit. A force whose sign may be wrong holds
 * nothing. */
static double holding(const struct instance* s, int a) {
  const double load = used(s, a, load_at), limit = fabs(used(s, a, limit_at));
  if (!s->good || s->stopped == STRIBECK_FAULT_WRONG_SIGN || !isfinite(load)) return 0.0;
  return load > limit ? limit : load < -limit ? -limit : load;
}

static void read_inputs(const struct instance* s, int enable, double period, struct inputs* in) {
  in->period = period;
  in->unit = s->position_used;
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
    /* What is no time means at once: a force must not stay. */
    l->ramp_time = s->hal->ramp_time <= LONGEST_TIME ? s->hal->ramp_time : 0.0;
    l->brake_time = s->hal->brake_time <= LONGEST_TIME ? s->hal->brake_time : 0.0;
    l->hold = holding(s, a);
    l->force = INFINITY;
    l->bridges = same(used(s, a, checks_at), 2.0);
    if (!isfinite(i->position + i->velocity + i->acceleration + i->measured)) in->finite = 0;
  }
}

static void fail_axis(struct instance* s, int a, enum fault f, const struct inputs* in) {
  supervisor_fail(&s->inner[a].watch, f, &in->limits[a], in->period);
}

static enum fault judge_axis(struct instance* s, int a, const struct inputs* in) {
  const stribeck_axis_input* i = &in->axis[a];
  return supervisor_judge(&s->inner[a].watch, &in->limits[a], i->position, i->velocity, i->acceleration,
                          i->measured, in->passed);
}

/* Enable has risen: clears the faults, begins every axis where it is, and takes over parameters that have changed. */
static void begin(struct instance* s, struct inputs* in) {
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
  if (s->good) return;
  /* Nothing has been controlled: no force begins now. */
  for (int a = 0; a < axes; ++a) in->limits[a].hold = 0.0;
  fail_axis(s, 0, FAULT_PARAMETERS, in);
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
  stribeck_controller_set_elapsed(s->controller, in->passed);
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

/* What the drive takes: 0 a velocity, 1 a position, NaN a force. While it is off what HAL says now counts: the controller may not have
 * been configured yet. */
static double mode_of(const struct inner* own) {
  if (drive_mode < 0) return NAN;
  const struct values* v = &own->values;
  return own->watch.mode == MODE_OFF ? v->value[drive_mode] : v->used[drive_mode];
}

/* Whether nothing but the offset carries the load: the drive takes one, and has no integral that would. */
static int carries_by_offset(const struct instance* s, int a) {
  return same(used(s, a, force_offset), 1.0) && !isfinite(used(s, a, integral_time));
}

/* `now` is null when the controller does not run: a drive that takes a position is then told where the axis is, or is to be. */
static void write_command(struct instance* s, int a, const struct inputs* in,
                          const stribeck_axis_signals* now) {
  struct inner* own = &s->inner[a];
  const double mode = mode_of(own);
  double command = 0.0;
  if (now != NULL) {
    command = isfinite(mode) ? now->command : 0.0;
    own->resting = command;
  } else if (same(mode, 1.0)) {
    if (may_follow(own, in, a)) own->resting = in->axis[a].measured;
    const double wanted = isfinite(in->axis[a].position) ? in->axis[a].position : 0.0;
    command = isfinite(own->resting) ? own->resting : wanted;
  }
  *s->hal->axis[a].command = command / in->unit;
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
    const int controlled = runs && w->mode == MODE_RUNNING;
    write_command(s, a, in, controlled ? &now : NULL);
    const double force = supervisor_force(w, &in->limits[a], wanted[a], in->enable, in->period);
    const double offset = controlled ? now.offset : carries_by_offset(s, a) ? force : 0.0;
    *s->hal->axis[a].offset = offset / s->force_used;
    supervisor_advance(w, &in->limits[a], in->axis[a].measured, in->period, in->passed);
    write_axis(s, a, in, force, &now);
    /* Without the controller the last count stays. */
    if (runs) *s->hal->axis[a].bridged = (hal_s32_t)(now.bridged & 0x7fffffff);
    if (isfinite(now.lag)) lag = now.lag;
    if (w->fault != FAULT_NONE) faulted = 1;
  }
  *s->hal->lag = lag;
  *s->hal->faulted = faulted != 0;
  *s->hal->brake = faulted != 0 || !runs;
  *s->hal->pending = runs && must_configure(s, in->period);
}

/* Time since the last cycle as the clock says; what is less than half a period late is one period. Without watch-lateness it is one
 * period: virtual time passes in periods. */
static double time_passed(struct instance* s, double period) {
  const long long now = rtapi_get_time();
  const double passed = 1e-9 * (double)(now - s->last_call);
  const int known = s->last_call != 0 && s->hal->watch_lateness;
  s->last_call = now;
  return known && passed > 1.5 * period ? passed : period;
}

static void update(void* arg, long period_ns) {
  struct instance* s = arg;
  const int enable = *s->hal->enable != 0;
  const int rises = enable && !s->was_enabled;
  s->was_enabled = enable;
  if (rises) take_units(s);
  struct inputs in;
  read_inputs(s, enable, 1e-9 * (double)period_ns, &in);
  in.passed = time_passed(s, in.period);
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
  s->hal->brake_time = 0.2;
  if ((r = hal_param_float_newf(HAL_RW, &s->hal->position_unit, component, "%s.position-unit", name)) < 0)
    return r;
  if ((r = hal_param_float_newf(HAL_RW, &s->hal->force_unit, component, "%s.force-unit", name)) < 0) return r;
  if ((r = hal_param_float_newf(HAL_RW, &s->hal->ramp_time, component, "%s.ramp-time", name)) < 0) return r;
  if ((r = hal_param_float_newf(HAL_RW, &s->hal->brake_time, component, "%s.brake-time", name)) < 0) return r;
  if ((r = hal_param_bit_newf(HAL_RW, &s->hal->watch_lateness, component, "%s.watch-lateness", name)) < 0)
    return r;
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
    const struct {
      const char* name;
      int* number;
    } needed[] = {{"drive_loop.mode", &drive_mode},
                  {"drive_loop.force_offset", &force_offset},
                  {"drive_loop.integral_time", &integral_time},
                  {"load", &load_at},
                  {"force_limit", &limit_at},
                  {"supervision.checks", &checks_at}};
    for (size_t k = 0; k < sizeof needed / sizeof needed[0]; ++k) {
      if (strcmp(parameters.name[i], needed[k].name) == 0) *needed[k].number = (int)i;
    }
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
