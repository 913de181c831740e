/*
 * One controller of controller.c: what it keeps, in HAL memory and beside it, and how it takes its parameters over when enable rises.
 * controller.c includes this once, after `COMPONENT`, `AXES` and `axes`.
 */
#ifndef STRIBECK_HAL_INSTANCE_H
#define STRIBECK_HAL_INSTANCE_H

#define LONGEST_TIME 1.0 /* of ramp-time and brake-time [s] */

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
  hal_float_t position_unit, force_unit, ramp_time, brake_time;
  hal_bit_t watch_lateness;
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
  long long last_call; /* time of the last cycle [ns]; 0: there was none */
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
/* Numbers of some parameters among them; below 0: there is none. */
static int drive_mode = -1, force_offset = -1, integral_time = -1, load_at = -1, limit_at = -1,
           checks_at = -1;
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
      {"ramp-time", s->hal->ramp_time, s->hal->ramp_time >= 0.0 && s->hal->ramp_time <= LONGEST_TIME},
      {"brake-time", s->hal->brake_time, s->hal->brake_time >= 0.0 && s->hal->brake_time <= LONGEST_TIME}};
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

#endif
