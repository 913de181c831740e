/*
 * What watches over one axis in a servo thread: when it may begin, and when its inputs are not to be trusted any more.
 *
 *   off      force 0
 *   running  the controller's force; the reference begins where the axis stands and goes over to the command within some tens of
 *            milliseconds, so that enabling is bumpless
 *   ramping  from the last force to 0 in `ramp_time`, after a fault, or when enable falls
 *
 * Faults stay (latched) until enable rises again. Lengths in m, times in s.
 * Real time: safe.
 */
#ifndef STRIBECK_HAL_SUPERVISOR_H
#define STRIBECK_HAL_SUPERVISOR_H

#include <math.h>

enum fault {
  FAULT_NONE = 0,
  FAULT_FEEDBACK_NOT_FINITE = 1, /* pos-fb is NaN or infinite */
  FAULT_COMMAND_NOT_FINITE = 2,  /* pos-cmd, vel-cmd or acc-cmd is */
  FAULT_FEEDBACK_JUMPED = 3,     /* pos-fb moved by more than jump-limit beyond the command in one period */
  FAULT_FEEDBACK_FROZEN = 4,     /* pos-fb stood while the command went on by more than frozen-limit */
  FAULT_FOLLOWING_ERROR = 5,     /* pos-fb is further than ferror-limit from pos-cmd */
  FAULT_PARAMETERS = 6           /* a parameter was refused; the log says which */
};

enum mode { MODE_OFF, MODE_RUNNING, MODE_RAMPING };

struct limits {
  double ferror;
  double jump;
  double frozen;
  double ramp_time;
  double force; /* no force beyond [N]; infinite: none */
};

struct supervisor {
  enum mode mode;
  enum fault fault;
  int was_enabled;
  int started;   /* `last` is valid */
  double last;   /* feedback of the last period */
  double way;    /* of the command since the feedback last changed */
  double offset; /* of the reference from the command */
  double force;  /* last output [N] */
  double ramp;   /* force by which a period takes it down [N] */
};

#define STRIBECK_BUMPLESS_TIME 0.05

static inline void supervisor_fail(struct supervisor* s, enum fault f, double period, double ramp_time) {
  if (f != FAULT_NONE && s->fault == FAULT_NONE) s->fault = f;
  if (s->mode == MODE_RAMPING) return;
  s->mode = MODE_RAMPING;
  s->ramp = ramp_time > period ? fabs(s->force) * period / ramp_time : fabs(s->force);
}

/* What is wrong with the inputs of this period. */
static inline enum fault supervisor_judge(struct supervisor* s, const struct limits* l, double command,
                                          double velocity, double acceleration, double feedback,
                                          double period) {
  if (!isfinite(feedback)) return FAULT_FEEDBACK_NOT_FINITE;
  if (!isfinite(command) || !isfinite(velocity) || !isfinite(acceleration)) return FAULT_COMMAND_NOT_FINITE;
  if (s->started) {
    const double moved = feedback - s->last;
    if (fabs(moved - velocity * period) > l->jump) return FAULT_FEEDBACK_JUMPED;
    s->way = moved == 0.0 ? s->way + fabs(velocity) * period : 0.0;
    if (s->way > l->frozen) return FAULT_FEEDBACK_FROZEN;
    if (fabs(feedback - command - s->offset) > l->ferror) return FAULT_FOLLOWING_ERROR;
  }
  return FAULT_NONE;
}

/* Enable has risen with inputs that are finite. */
static inline void supervisor_begin(struct supervisor* s, double command, double feedback) {
  s->mode = MODE_RUNNING;
  s->fault = FAULT_NONE;
  s->started = 0;
  s->way = 0.0;
  s->offset = feedback - command;
}

/* The force to put out, for what the controller wants [N]; call it in every mode. */
static inline double supervisor_force(struct supervisor* s, const struct limits* l, double wanted) {
  double force = 0.0;
  if (s->mode == MODE_RUNNING) {
    force = isfinite(wanted) ? wanted : s->force;
  } else if (s->mode == MODE_RAMPING) {
    force = s->force > s->ramp ? s->force - s->ramp : s->force < -s->ramp ? s->force + s->ramp : 0.0;
    if (force == 0.0) s->mode = MODE_OFF;
  }
  if (force > l->force) force = l->force;
  if (force < -l->force) force = -l->force;
  s->force = force;
  return force;
}

#endif
