/*
 * What watches over one axis in a servo thread: when it may begin, and when its inputs are not to be trusted any more.
 *
 *   off      force 0
 *   running  the controller's force; the reference begins where the axis is, with the speed it has, and goes over to the command
 *            within some tenths of a second, so that enabling is bumpless:
 *              reference = command + o,   τ²ö + 2τȯ + o = 0,   o, ȯ at first: encoder less command, and their speeds
 *   ramping  from the last force to the load in `ramp_time`, after a fault, or when enable falls; the load is held for as long as enable
 *            stays, and for `brake_time` more, until a brake has closed; then to 0 in `ramp_time`
 *
 * Where the library judges every sample itself (supervision.checks = 2), what is not finite is left to it: it bridges a single one.
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
  double brake_time;
  double hold;  /* force that holds the axis at rest, its load [N] */
  double force; /* no force beyond [N]; infinite: none */
  int bridges;  /* the library bridges samples and commands that are not finite */
};

struct supervisor {
  enum mode mode;
  enum fault fault;
  int was_enabled;
  int started;   /* it has run for a period */
  int seen;      /* `last` is valid */
  double last;   /* feedback of the last period */
  double speed;  /* of the encoder */
  double way;    /* of the command since the feedback last changed */
  double offset; /* o, of the reference from the command */
  double rate;   /* ȯ */
  double force;  /* last output [N] */
  double end;    /* force at which the ramp ends [N] */
  double ramp;   /* force by which a period takes it there [N] */
  double held;   /* time for which the end has been held without enable */
};

#define STRIBECK_BUMPLESS_TIME 0.05 /* τ */
#define STRIBECK_SPEED_TIME 0.004   /* low-pass of the speed, so that a step of the encoder is not one */

static inline void supervisor_ramp_to(struct supervisor* s, const struct limits* l, double end,
                                      double period) {
  const double change = fabs(s->force - end);
  s->end = end;
  s->ramp = l->ramp_time > period ? change * period / l->ramp_time : change;
}

static inline void supervisor_fail(struct supervisor* s, enum fault f, const struct limits* l,
                                   double period) {
  if (f != FAULT_NONE && s->fault == FAULT_NONE) s->fault = f;
  if (s->mode == MODE_RAMPING) return;
  /* An axis that was off stays off. A following error may come from a force with the wrong sign, which only the library's checks tell:
   * held, the load would drive the axis on. */
  const int sign_unknown = f == FAULT_FOLLOWING_ERROR && !l->bridges;
  supervisor_ramp_to(s, l, s->mode == MODE_RUNNING && !sign_unknown ? l->hold : 0.0, period);
  s->mode = MODE_RAMPING;
  s->held = 0.0;
}

/* What is wrong with the inputs of this period; `passed`: time since the last one. */
static inline enum fault supervisor_judge(struct supervisor* s, const struct limits* l, double command,
                                          double velocity, double acceleration, double feedback,
                                          double passed) {
  const int bridged = s->mode == MODE_RUNNING && l->bridges;
  if (!isfinite(feedback)) return bridged ? FAULT_NONE : FAULT_FEEDBACK_NOT_FINITE;
  if (!isfinite(command) || !isfinite(velocity) || !isfinite(acceleration))
    return bridged ? FAULT_NONE : FAULT_COMMAND_NOT_FINITE;
  if (s->started) {
    if (s->seen) { /* else the last sample was not finite */
      const double moved = feedback - s->last;
      /* A limit that is not a number is exceeded. */
      if (!(fabs(moved - velocity * passed) <= l->jump)) return FAULT_FEEDBACK_JUMPED;
      s->way = moved == 0.0 ? s->way + fabs(velocity) * passed : 0.0;
      if (!(s->way <= l->frozen)) return FAULT_FEEDBACK_FROZEN;
    }
    if (!(fabs(feedback - command - s->offset) <= l->ferror)) return FAULT_FOLLOWING_ERROR;
  }
  return FAULT_NONE;
}

/* Before a run: what the last one found and followed says nothing of it. */
static inline void supervisor_clear(struct supervisor* s) {
  s->fault = FAULT_NONE;
  s->started = 0;
}

/* The reference, from the command: with what is left between both since the axis was enabled. */
static inline void supervisor_lead(const struct supervisor* s, stribeck_axis_input* r) {
  r->position += s->offset;
  r->velocity += s->rate;
}

/* Enable has risen with inputs that are finite. */
static inline void supervisor_begin(struct supervisor* s, double command, double velocity, double feedback) {
  s->mode = MODE_RUNNING;
  s->fault = FAULT_NONE;
  s->started = 0;
  s->way = 0.0;
  s->offset = feedback - command;
  s->rate = s->seen ? s->speed - velocity : 0.0;
}

/* Once per period, in every mode: what the encoder says after the time `passed`; when running, the offset of the next period. */
static inline void supervisor_advance(struct supervisor* s, const struct limits* l, double feedback,
                                      double period, double passed) {
  const int finite = isfinite(feedback);
  const double moved = finite && s->seen ? feedback - s->last : 0.0;
  /* An encoder that jumps is at another place, and has not moved there. */
  if (fabs(moved - s->speed * passed) <= l->jump)
    s->speed += (moved / passed - s->speed) * passed / (passed + STRIBECK_SPEED_TIME);
  if (!finite) s->speed = 0.0;
  s->seen = finite;
  s->last = feedback;
  if (s->mode != MODE_RUNNING) return;
  s->started = 1;
  const double pull = (s->rate + s->offset / STRIBECK_BUMPLESS_TIME) * period;
  const double fade = exp(-period / STRIBECK_BUMPLESS_TIME);
  s->offset = (s->offset + pull) * fade;
  s->rate = (s->rate - pull / STRIBECK_BUMPLESS_TIME) * fade;
}

/* The force to put out, for what the controller wants [N]; call it in every mode. */
static inline double supervisor_force(struct supervisor* s, const struct limits* l, double wanted, int enable,
                                      double period) {
  double force = 0.0;
  if (s->mode == MODE_RUNNING) {
    force = isfinite(wanted) ? wanted : s->force;
  } else if (s->mode == MODE_RAMPING) {
    const double left = s->force - s->end;
    force = s->end + (left > s->ramp ? left - s->ramp : left < -s->ramp ? left + s->ramp : 0.0);
    if (force == 0.0 && s->end == 0.0) {
      s->mode = MODE_OFF;
    } else if (force == s->end && !enable) {
      s->held += period;
      /* A time that is not a number is over. */
      if (!(s->held < l->brake_time)) supervisor_ramp_to(s, l, 0.0, period);
    }
  }
  if (force > l->force) force = l->force;
  if (force < -l->force) force = -l->force;
  s->force = force;
  return force;
}

#endif
