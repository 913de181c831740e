/*
 * Stribeck for hosts in C: position controller of one to three axes, with all that the real-time tier knows of friction.
 *
 *   size_t n = stribeck_controller_size(1);                               or stribeck_controller_size_for(1, "predictive")
 *   stribeck_controller *c = stribeck_controller_init(memory, n, 1);      memory of yours, stribeck_alignment() aligned
 *   stribeck_controller_set(c, 0, "mass", 1000.0);                        SI; names: stribeck_controller_parameter()
 *   stribeck_controller_set(c, 0, "friction.conventional.alpha0", 20.0); level of friction
 *   stribeck_controller_configure(c, 1e-3);                               control period [s]; checks everything
 *   stribeck_controller_step(c, in, force);                               once per period
 *
 * Laws, parameter "law" of every axis: contouring control, which is PD for one axis; sliding-mode; predictive, which may be given
 * points ahead; learning, which must be given the phase (docs/theory). Force on the axis in N, positive in the positive
 * direction; friction positive for a positive velocity. The frame of two and three axes comes from the commanded motion.
 * Drives that close their velocity or position loop themselves: parameters drive_loop.*; the command of the coming period and the force
 * offset beside it are in the signals (command, offset). Give the force that such a drive reports with set_measured_force.
 * A number that is "left out" is NaN: set to it, what may be left out goes, and by the name of a number that may not the group that holds
 * it. Elements of lists are named by their index, from 0.
 *
 * Supervision: what is no number for longer than 10 ms, encoder or command, stops the axes: the step then answers STRIBECK_FAULT with
 * the forces of the stop, until reset. With supervision.checks = all and the limits of the axis, each sample and the motion are judged
 * as well, and single wild samples are bridged (docs/theory/supervision.md, docs/guides/faults.md).
 *
 * Real time: step, step_ahead, set_phase, set_elapsed, set_measured_force, reset, signals and supervision are safe: no allocation, exception, lock or input and output. They use
 * what is in the handle and nothing else, so that two handles may run in two threads. The rest is for configuring; configure needs
 * up to some hundred microseconds. A handle may be thrown away with its memory; there is nothing to release.
 * Errors: a result below zero, and then nothing has changed, but for STRIBECK_NOT_FINITE: a step that got such a number goes on with the
 * last force, or with what supervision put in its place; and for STRIBECK_FAULT. stribeck_controller_problem() says which parameter and why.
 */
#ifndef STRIBECK_STRIBECK_H
#define STRIBECK_STRIBECK_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
#define STRIBECK_NOEXCEPT noexcept
extern "C" {
#else
#define STRIBECK_NOEXCEPT
#endif

/* Grows with every change that breaks compiled programs. Compare with stribeck_abi() after loading. */
#define STRIBECK_ABI 1u
#define STRIBECK_MAX_AXES 3u

typedef int32_t stribeck_result;
enum {
  STRIBECK_OK = 0,
  STRIBECK_BAD_HANDLE = -1,   /* null, or memory that init has not seen */
  STRIBECK_BAD_ARGUMENT = -2, /* an index too high, a null pointer, a period that is no time */
  STRIBECK_UNKNOWN_NAME = -3, /* no such parameter, or an element beyond the list's end */
  STRIBECK_OUT_OF_RANGE = -4, /* the parameter does not take this value */
  STRIBECK_NOT_SELECTED =
      -5,                /* belongs to a kind of model that is not chosen: set e.g. friction.steady first */
  STRIBECK_REFUSED = -6, /* the parameters together mean nothing; see problem() */
  STRIBECK_NOT_CONFIGURED = -7, /* step before configure */
  STRIBECK_NOT_FINITE =
      -8, /* an input was NaN or infinite, or numbers overflowed, and the law begins anew; the forces are the last ones */
  STRIBECK_NO_MEMORY = -9,
  STRIBECK_FAULT = -10 /* supervision has stopped the axes; the forces are those of the stop */
};

/* What this library can do; bits of stribeck_capabilities(). */
enum {
  STRIBECK_HAS_CONTOURING = 1u << 0,
  STRIBECK_HAS_DYNAMIC_FEEDFORWARD = 1u << 1,
  STRIBECK_HAS_REVERSAL_FEEDFORWARD = 1u << 2,
  STRIBECK_HAS_DISTURBANCE_OBSERVER = 1u << 3,
  STRIBECK_HAS_KALMAN_OBSERVER = 1u << 4,
  STRIBECK_HAS_ADAPTIVE_FRICTION = 1u << 5,
  STRIBECK_HAS_FRICTION_ADAPTATION = 1u << 6,
  STRIBECK_HAS_SLIDING_MODE = 1u << 7,
  STRIBECK_HAS_PREDICTIVE = 1u << 8,
  STRIBECK_HAS_LEARNING = 1u << 9,
  STRIBECK_HAS_SUPERVISION = 1u << 10,
  STRIBECK_HAS_DRIVE_LOOPS = 1u << 11
};

uint32_t stribeck_abi(void) STRIBECK_NOEXCEPT;
uint32_t stribeck_capabilities(void) STRIBECK_NOEXCEPT;
const char* stribeck_version(void) STRIBECK_NOEXCEPT;
const char* stribeck_describe(stribeck_result) STRIBECK_NOEXCEPT;
size_t stribeck_alignment(void) STRIBECK_NOEXCEPT;

/* One declared parameter. */
typedef enum stribeck_parameter_kind {
  STRIBECK_NUMBER = 0, /* with a unit */
  STRIBECK_INTEGER = 1,
  STRIBECK_SWITCH = 2, /* 0 or 1 */
  STRIBECK_CHOICE = 3  /* index of a word: stribeck_..._parameter_word() */
} stribeck_parameter_kind;

typedef struct stribeck_parameter {
  char name[64];
  const char* unit;  /* SI unit of the value; "" for a pure number */
  const char* about; /* one sentence */
  double value;      /* before it is set; NaN: left out */
  double min;
  double max;
  int32_t kind; /* stribeck_parameter_kind */
  uint32_t words;
} stribeck_parameter;

/* ---- controller ---- */

typedef struct stribeck_controller stribeck_controller;

/* Bytes for a controller of that many axes under contouring control; 0: there is none. */
size_t stribeck_controller_size(uint32_t axes) STRIBECK_NOEXCEPT;
/* The same for another law, by its word; 0: there is none. Memory for the largest of several laws will do for all of them. */
size_t stribeck_controller_size_for(uint32_t axes, const char* law) STRIBECK_NOEXCEPT;

/* A controller in memory of the caller, with the initial values of all parameters; null when the memory is too small for
 * contouring control or not aligned. The same memory may be initialised again. */
stribeck_controller* stribeck_controller_init(void* memory, size_t size, uint32_t axes) STRIBECK_NOEXCEPT;

/* The parameters of one axis, index 0 and up; STRIBECK_BAD_ARGUMENT after the last. omega, kp and kv are gains of the path's
 * directions: axis 0 means along the path, the others across it. */
stribeck_result stribeck_controller_parameter(uint32_t index, stribeck_parameter*) STRIBECK_NOEXCEPT;
/* Word of a choice; null after the last. */
const char* stribeck_controller_parameter_word(const char* name, uint32_t index) STRIBECK_NOEXCEPT;

/* Takes effect with the next configure. */
stribeck_result stribeck_controller_set(stribeck_controller*, uint32_t axis, const char* name,
                                        double value) STRIBECK_NOEXCEPT;
/* The same for a choice by its word. */
stribeck_result stribeck_controller_choose(stribeck_controller*, uint32_t axis, const char* name,
                                           const char* word) STRIBECK_NOEXCEPT;

/* Checks all parameters and builds the controller for a period from 1 us to below 1 s; it begins anew. When refused, it goes on as
 * it was. */
stribeck_result stribeck_controller_configure(stribeck_controller*, double period) STRIBECK_NOEXCEPT;
/* What the last call that failed was given and what it expected: "axis 1: mass: ...". Not of signals and supervision, which change
 * nothing in the handle; after STRIBECK_NOT_FINITE and STRIBECK_FAULT of a step, stribeck_controller_supervision() tells more. */
const char* stribeck_controller_problem(const stribeck_controller*) STRIBECK_NOEXCEPT;

typedef struct stribeck_axis_input {
  double position;     /* reference at this sample [m] */
  double velocity;     /* [m/s] */
  double acceleration; /* [m/s2] */
  double measured;     /* encoder at this sample [m] */
} stribeck_axis_input;

/* Forces for the coming period [N], one per axis, from one input per axis. */
stribeck_result stribeck_controller_step(stribeck_controller*, const stribeck_axis_input*,
                                         double* force) STRIBECK_NOEXCEPT;
/* The same with the reference of the coming periods as well: `points` rows of one input per axis, one row per period, the present
 * one first; `measured` counts in that one alone. Laws that do not look ahead take the first row. Of a row with a number that is not
 * finite on, the rows are left out, and the answer is STRIBECK_NOT_FINITE; the forces are new ones where the first row is good. */
stribeck_result stribeck_controller_step_ahead(stribeck_controller*, const stribeck_axis_input*,
                                               uint32_t points, double* force) STRIBECK_NOEXCEPT;
/* How many rows the law that is configured can make use of; 0 before. */
uint32_t stribeck_controller_points(const stribeck_controller*) STRIBECK_NOEXCEPT;
/* Learning: place in the lap for the steps to come, in the unit of learning.lap, counted on over the laps or begun anew in each.
 * NaN, and after reset: none, and nothing is learned or given; infinite counts as NaN and is answered with STRIBECK_NOT_FINITE. */
stribeck_result stribeck_controller_set_phase(stribeck_controller*, double phase) STRIBECK_NOEXCEPT;
/* For the next step: time since the one before, as the host measured it [s]; NaN: one period. A late step is counted, and what the encoder
 * has moved since is taken for the motion of that time. */
stribeck_result stribeck_controller_set_elapsed(stribeck_controller*, double elapsed) STRIBECK_NOEXCEPT;
/* For the next step: mean force of each axis over the past period, as drives with drive_loop.force_feedback report it [N]; NaN: none. */
stribeck_result stribeck_controller_set_measured_force(stribeck_controller*,
                                                       const double* force) STRIBECK_NOEXCEPT;
/* Forgets all motion: the next step is a first one. After a fault it goes on with what adaptation had learned before. */
stribeck_result stribeck_controller_reset(stribeck_controller*) STRIBECK_NOEXCEPT;

/* What the last step did on one axis. */
typedef struct stribeck_axis_signals {
  double force;       /* [N], after the limit */
  double friction;    /* feed-forward and load in it [N] */
  double disturbance; /* estimate of the observer in it [N] */
  double error;       /* encoder minus reference [m] */
  double error_rate;  /* [m/s] */
  double level;       /* by adaptation: change of the level of friction as a share; NaN without */
  int32_t limited;    /* the force was cut at the force limit */
  int32_t backed_off; /* the loop oscillated, and observer and adaptation were turned down */
  /* NaN under other laws. Sliding mode, of the direction with the axis's number: along the path, then across it. */
  double surface;        /* distance from it [m/s] */
  double switching_gain; /* [m/s2] */
  double lag;            /* predictive: time by which the reference is behind the one that was given [s] */
  double learned;        /* learning: force from earlier laps [N] */
  uint32_t bridged;      /* samples that were bridged since configure */
  double
      command; /* for the drive: velocity [m/s] or position [m] by drive_loop.mode; without drive_loop the force [N] */
  double offset; /* force beside it, with drive_loop.force_offset [N] */
} stribeck_axis_signals;

/* `size` is sizeof(stribeck_axis_signals), so that the struct may grow at its end. */
stribeck_result stribeck_controller_signals(const stribeck_controller*, uint32_t axis, stribeck_axis_signals*,
                                            size_t size) STRIBECK_NOEXCEPT;

/* Why supervision has stopped the axes. More may be added at the end. */
enum {
  STRIBECK_FAULT_NONE = 0,
  STRIBECK_FAULT_ENCODER_LOST = 1,
  STRIBECK_FAULT_ENCODER_IMPLAUSIBLE = 2,
  STRIBECK_FAULT_ENCODER_FROZEN = 3,
  STRIBECK_FAULT_ENCODER_UNRELIABLE = 4,
  STRIBECK_FAULT_WRONG_SIGN = 5,
  STRIBECK_FAULT_OVERSPEED = 6,
  STRIBECK_FAULT_FOLLOWING_ERROR = 7,
  STRIBECK_FAULT_SATURATED = 8,
  STRIBECK_FAULT_OSCILLATION = 9,
  STRIBECK_FAULT_LATE = 10,
  STRIBECK_FAULT_COMMAND_LOST = 11
};
#define STRIBECK_FAULTS 12

typedef struct stribeck_supervision {
  int32_t fault;                    /* the first one since reset */
  uint32_t axis;                    /* where */
  int32_t brake;                    /* holding brakes should close */
  int32_t safe;                     /* after a fault: forces are safe, set points of drives rest */
  uint32_t late;                    /* steps that were late, since configure */
  uint32_t commands_lost;           /* references that were no numbers, since configure */
  uint32_t counts[STRIBECK_FAULTS]; /* of each fault, since configure */
} stribeck_supervision;

/* `size` is sizeof(stribeck_supervision). */
stribeck_result stribeck_controller_supervision(const stribeck_controller*, stribeck_supervision*,
                                                size_t size) STRIBECK_NOEXCEPT;
/* "encoder-lost", and a sentence; null, and "unknown fault", for other numbers. */
const char* stribeck_fault_name(int32_t fault) STRIBECK_NOEXCEPT;
const char* stribeck_fault_describe(int32_t fault) STRIBECK_NOEXCEPT;

#ifdef __cplusplus
}
#endif
#endif
