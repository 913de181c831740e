/*
 * A controller for `stribeck bench`, as a shared object: define these four functions and compile with -shared -fPIC.
 *
 *   stribeck bench --controller ./mine.so
 *
 * The board starts the object in a process of its own for every run: it may keep static state, and a crash is a failed run.
 * SI units; force on the axis in N, positive in the positive direction; friction positive for a positive velocity. What points into the
 * setup is valid until destroy. Forces beyond the limit are cut and counted, NaN fails the run. Protocol: docs/board.md.
 * Real time: as its author makes it; the time of a step is reported and never judged.
 */
#ifndef STRIBECK_BOARD_H
#define STRIBECK_BOARD_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Grows with every change that breaks compiled controllers. */
#define STRIBECK_BOARD_ABI 1u

/* The identified model of an axis, and its name plates. */
typedef struct stribeck_board_axis {
  double mass;            /* [kg] */
  double load;            /* constant force against the positive direction [N] */
  double delay;           /* from the sample to the beginning of its hold [s] */
  double force_limit;     /* [N] */
  double resolution;      /* of the encoder [m] */
  double stiffness;       /* of pre-sliding [N/m]; 0: not known */
  double damping;         /* of pre-sliding [N s/m] */
  uint32_t points;        /* of the friction curve */
  const double* speed;    /* ascending, without 0 [m/s] */
  const double* friction; /* steady, without load [N] */
  const char* model_file; /* the whole model as an axis file */
} stribeck_board_axis;

typedef struct stribeck_board_setup {
  uint32_t abi; /* STRIBECK_BOARD_ABI of the board */
  uint32_t axes;
  double period; /* [s] */
  const stribeck_board_axis* axis;
} stribeck_board_setup;

typedef struct stribeck_board_input {
  double position;     /* reference at this sample [m] */
  double velocity;     /* [m/s] */
  double acceleration; /* [m/s2] */
  double measured;     /* encoder at this sample [m] */
} stribeck_board_input;

/* STRIBECK_BOARD_ABI as it was compiled. */
uint32_t stribeck_board_abi(void);
/* Null: it refuses this setup. */
void* stribeck_board_create(const stribeck_board_setup*);
/* Forces for the coming period [N], one for each axis; time from the start of the run [s]. */
void stribeck_board_step(void* controller, double time, const stribeck_board_input*, double* force);
void stribeck_board_destroy(void* controller);

#ifdef __cplusplus
}
#endif
#endif
