/*
 * A virtual drive for hosts in C: what stribeck simulate has, one axis, for trying a controller where there is no machine.
 *
 * Parameters by name in SI, as those of [axes.x.plant] in a machine file. Force or voltage goes in once per period, encoder and
 * true position come out.
 * Real time: step and get do not allocate; create, configure and start do. A library of its own (docs/decisions/0009-capi-plant.md).
 */
#ifndef STRIBECK_PLANT_H
#define STRIBECK_PLANT_H

#include <stribeck/stribeck.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct stribeck_plant stribeck_plant;

stribeck_result stribeck_plant_create(stribeck_plant**) STRIBECK_NOEXCEPT;
void stribeck_plant_destroy(stribeck_plant*) STRIBECK_NOEXCEPT; /* null is permitted */

stribeck_result stribeck_plant_parameter(uint32_t index, stribeck_parameter*) STRIBECK_NOEXCEPT;
const char* stribeck_plant_parameter_word(const char* name, uint32_t index) STRIBECK_NOEXCEPT;
stribeck_result stribeck_plant_set(stribeck_plant*, const char* name, double value) STRIBECK_NOEXCEPT;
stribeck_result stribeck_plant_choose(stribeck_plant*, const char* name, const char* word) STRIBECK_NOEXCEPT;
const char* stribeck_plant_problem(const stribeck_plant*) STRIBECK_NOEXCEPT;

/* Period [s], from 1 us to below 1 s, and highest speed [m/s]; then at rest at position 0. */
stribeck_result stribeck_plant_configure(stribeck_plant*, double period,
                                         double highest_speed) STRIBECK_NOEXCEPT;
/* At rest at a position [m]. The seed names the stream of the force noise; 1 to 1000 substeps of the integration in a period. */
stribeck_result stribeck_plant_start(stribeck_plant*, double position, uint64_t seed,
                                     int32_t substeps) STRIBECK_NOEXCEPT;

/* One period under a voltage [V], of a drive without drive_loop; what is not finite counts as 0 and is answered with STRIBECK_NOT_FINITE,
 * as is a motion that has overflowed (start again). `load` [N] acts on the
 * table against the positive direction. */
stribeck_result stribeck_plant_step(stribeck_plant*, double voltage, double load) STRIBECK_NOEXCEPT;

/* The same for a drive with drive_loop: under a velocity [m/s] or position [m], by drive_loop.mode, and a force offset [N]. */
stribeck_result stribeck_plant_step_command(stribeck_plant*, double command, double offset,
                                            double load) STRIBECK_NOEXCEPT;

typedef enum stribeck_plant_signal {
  STRIBECK_PLANT_ENCODER = 0,        /* [m] */
  STRIBECK_PLANT_POSITION = 1,       /* true, of the table [m] */
  STRIBECK_PLANT_VELOCITY = 2,       /* true, of the drive side [m/s] */
  STRIBECK_PLANT_FRICTION = 3,       /* true [N] */
  STRIBECK_PLANT_VOLTAGE = 4,        /* after the D/A converter [V] */
  STRIBECK_PLANT_FORCE_PER_VOLT = 5, /* at standstill [N/V] */
  STRIBECK_PLANT_FORCE_LIMIT = 6,    /* at the converter's range [N] */
  STRIBECK_PLANT_FORCE = 7           /* of the drive, mean over the last period [N] */
} stribeck_plant_signal;

/* NaN for a signal that there is not, or before configure. */
double stribeck_plant_get(const stribeck_plant*, stribeck_plant_signal) STRIBECK_NOEXCEPT;

#ifdef __cplusplus
}
#endif
#endif
