/*
 * stribeck_plant: a virtual drive in the servo thread, in place of amplifier, motor, screw and encoder.
 *
 *   loadrt stribeck_plant names=pl.x,pl.y
 *
 * In: force [N] and voltage [V], which add up; of a drive with drive-loop.mode a command, in position units or those per second, and
 * offset [N], a force beside it; cutting [N], a force on the table against the positive direction. Out: pos, the
 * true position of the table; pos-fb, the encoder; vel, friction [N]; force-fb, the force of the drive [N]. Put its function at the end of the thread. Parameters are
 * taken over in the first period and whenever one of them changes; the drive then stands where it was, or at `start` when that has
 * changed. With parameters that are refused `ok` is off and no output changes any more; the log says which. Not for a thread with a
 * deadline while they change: it allocates.
 */
#include <stribeck/plant.h>

#include "hal_parts.h"

#include <stdlib.h>

#define COMPONENT "stribeck_plant"
MODULE_DESCRIPTION("virtual feed drive");
MODULE_LICENSE("GPL"); /* of the module that is loaded: rtapi_app.h is GPL; the sources here are MIT */

static char* names[MAX_INSTANCES] = {0};
RTAPI_MP_ARRAY_STRING(names, MAX_INSTANCES, "names of the drives");

/* Parameters that are the component's and not the drive's. */
struct own {
  hal_float_t position_unit, highest_speed, start;
  hal_s32_t substeps, seed;
};

/* What of an instance has to be in HAL memory. */
struct shared {
  hal_float_t *force, *voltage, *command, *offset, *cutting;
  hal_float_t *pos, *pos_fb, *vel, *friction, *force_fb;
  hal_bit_t* ok;
  struct own own;
};

struct instance {
  const char* name; /* in `names` */
  struct shared* hal;
  struct own used; /* as the last configuration took them over */
  double period;   /* of the last configuration; 0: there was none */
  double position; /* where the table was seen last [m] */
  int placed;      /* it has stood at its start */
  stribeck_plant* plant;
  struct values values;
};

static int component = -1;
static struct parameters parameters;
static struct instance* instances[MAX_INSTANCES];
static int count;

static int own_changed(const struct instance* s) {
  const struct own *now = &s->hal->own, *used = &s->used;
  return !same(now->position_unit, used->position_unit) || !same(now->highest_speed, used->highest_speed) ||
         !same(now->start, used->start) || now->substeps != used->substeps || now->seed != used->seed;
}

static void refused(const struct instance* s, const char* why) { say_problem(COMPONENT, s->name, why); }

/* A drive from the HAL parameters, at rest; says what is wrong with them. */
static int configure(struct instance* s, double period) {
  stribeck_plant_destroy(s->plant);
  s->plant = NULL;
  if (!same(s->hal->own.start, s->used.start)) s->placed = 0;
  s->period = period;
  s->used = s->hal->own;
  values_taken(&parameters, &s->values);
  const struct own* own = &s->used;
  if (!positive(own->position_unit)) return refused(s, "position-unit: expected a length above 0 [m]"), 0;
  if (!isfinite(own->start)) return refused(s, "start: expected a number"), 0;
  if (!s->placed) s->position = own->start * own->position_unit;
  if (stribeck_plant_create(&s->plant) != STRIBECK_OK)
    return refused(s, stribeck_describe(STRIBECK_NO_MEMORY)), 0;
  stribeck_result r = STRIBECK_OK;
  for (uint32_t i = 0; i < parameters.count && r == STRIBECK_OK; ++i) {
    const double v = s->values.used[i];
    if (!same(v, parameters.initial[i])) r = stribeck_plant_set(s->plant, parameters.name[i], v);
  }
  if (r == STRIBECK_OK)
    r = stribeck_plant_configure(s->plant, period, own->highest_speed * own->position_unit);
  if (r == STRIBECK_OK)
    r = stribeck_plant_start(s->plant, s->position, (uint64_t)(uint32_t)own->seed, own->substeps);
  if (r == STRIBECK_OK) return s->placed = 1;
  refused(s, stribeck_plant_problem(s->plant));
  stribeck_plant_destroy(s->plant);
  s->plant = NULL;
  return 0;
}

static void update(void* arg, long period_ns) {
  struct instance* s = arg;
  const double period = 1e-9 * (double)period_ns;
  if (!same(period, s->period) || own_changed(s) || values_changed(&parameters, &s->values))
    *s->hal->ok = configure(s, period) != 0;
  if (s->plant == NULL) return;
  const double unit = s->used.position_unit;
  if (stribeck_plant_step_command(s->plant, *s->hal->command * unit, *s->hal->offset, *s->hal->cutting) ==
      STRIBECK_REFUSED) {
    const double voltage =
        *s->hal->voltage + *s->hal->force / stribeck_plant_get(s->plant, STRIBECK_PLANT_FORCE_PER_VOLT);
    stribeck_plant_step(s->plant, voltage, *s->hal->cutting);
  }
  s->position = stribeck_plant_get(s->plant, STRIBECK_PLANT_POSITION);
  if (!isfinite(s->position)) {
    refused(s, "the drive left all bounds; change a parameter to put it back to its start");
    stribeck_plant_destroy(s->plant);
    s->plant = NULL;
    s->placed = 0;
    *s->hal->ok = 0;
    return;
  }
  *s->hal->pos = s->position / unit;
  *s->hal->pos_fb = stribeck_plant_get(s->plant, STRIBECK_PLANT_ENCODER) / unit;
  *s->hal->vel = stribeck_plant_get(s->plant, STRIBECK_PLANT_VELOCITY) / unit;
  *s->hal->friction = stribeck_plant_get(s->plant, STRIBECK_PLANT_FRICTION);
  *s->hal->force_fb = stribeck_plant_get(s->plant, STRIBECK_PLANT_FORCE);
}

static int make(const char* name) {
  struct instance* s = calloc(1, sizeof *s);
  if (s == NULL) return -ENOMEM;
  instances[count++] = s;
  s->name = name;
  s->hal = take_hal_memory(sizeof *s->hal);
  if (s->hal == NULL) return -ENOMEM;
  int r = 0;
  const struct {
    const char* name;
    hal_float_t** pin;
    hal_pin_dir_t direction;
  } pins[] = {{"force", &s->hal->force, HAL_IN},        {"voltage", &s->hal->voltage, HAL_IN},
              {"command", &s->hal->command, HAL_IN},    {"offset", &s->hal->offset, HAL_IN},
              {"cutting", &s->hal->cutting, HAL_IN},    {"pos", &s->hal->pos, HAL_OUT},
              {"pos-fb", &s->hal->pos_fb, HAL_OUT},     {"vel", &s->hal->vel, HAL_OUT},
              {"friction", &s->hal->friction, HAL_OUT}, {"force-fb", &s->hal->force_fb, HAL_OUT}};
  for (size_t i = 0; i < sizeof pins / sizeof pins[0]; ++i) {
    if ((r = hal_pin_float_newf(pins[i].direction, pins[i].pin, component, "%s.%s", name, pins[i].name)) < 0)
      return r;
  }
  if ((r = hal_pin_bit_newf(HAL_OUT, &s->hal->ok, component, "%s.ok", name)) < 0) return r;
  const struct {
    const char* name;
    hal_float_t* value;
    double initial;
  } own[] = {{"position-unit", &s->hal->own.position_unit, 1e-3},
             {"highest-speed", &s->hal->own.highest_speed, 250.0},
             {"start", &s->hal->own.start, 0.0}};
  for (size_t i = 0; i < sizeof own / sizeof own[0]; ++i) {
    *own[i].value = own[i].initial;
    if ((r = hal_param_float_newf(HAL_RW, own[i].value, component, "%s.%s", name, own[i].name)) < 0) return r;
  }
  s->hal->own.substeps = 8;
  s->hal->own.seed = 1;
  if ((r = hal_param_s32_newf(HAL_RW, &s->hal->own.substeps, component, "%s.substeps", name)) < 0) return r;
  if ((r = hal_param_s32_newf(HAL_RW, &s->hal->own.seed, component, "%s.seed", name)) < 0) return r;
  if ((r = export_parameters(&parameters, &s->values, component, name)) < 0) return r;
  return hal_export_funct(name, update, s, 1, 0, component);
}

static void release(void) {
  if (component >= 0) hal_exit(component);
  component = -1;
  while (count > 0) {
    --count;
    stribeck_plant_destroy(instances[count]->plant);
    free(instances[count]);
  }
  end_of_component(names);
}

static int load(void) {
  if (!abi_good(COMPONENT)) return -EINVAL;
  find_parameters(&parameters, stribeck_plant_parameter);
  const int n = count_names(COMPONENT, names, &parameters, 0);
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
