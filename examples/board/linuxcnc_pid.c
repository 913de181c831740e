/*
 * A controller for `stribeck bench`: the law that the component `pid` of LinuxCNC documents (its manual page pid(9)), written anew.
 *
 *   out = bias + P·e + I·∫e dt + D·ė + FF1·ṙ + FF2·r̈        e = r − x less the dead band, out within ±maxoutput
 *
 * The integral stops while the output is limited. Gains: a triple pole at 30 rad/s with the mass of the model, FF1 the slope of the
 * friction curve between half and full speed, FF2 the mass, dead band one step of the encoder. The law knows no Coulomb friction.
 *
 *   cc -std=c11 -shared -fPIC -O2 -I capi/include -o linuxcnc-pid.so examples/board/linuxcnc_pid.c     (examples/board/build)
 */
#include <math.h>
#include <stdlib.h>
#include <stribeck/board.h>

enum { kMostAxes = 6 };

struct axis {
  double p, i, d, ff1, ff2, bias, deadband, maxoutput;
  double error, integral;
};

struct pid {
  uint32_t axes;
  double period;
  struct axis axis[kMostAxes];
};

uint32_t stribeck_board_abi(void) { return STRIBECK_BOARD_ABI; }

/* Slope of the friction curve over its upper half [N s/m]. */
static double viscous(const stribeck_board_axis* a) {
  const uint32_t last = a->points - 1;
  uint32_t half = last;
  while (half > 0 && a->speed[half] > 0.5 * a->speed[last]) half--;
  return (a->friction[last] - a->friction[half]) / (a->speed[last] - a->speed[half]);
}

void* stribeck_board_create(const stribeck_board_setup* setup) {
  const double omega = 30.0;
  struct pid* c = calloc(1, sizeof *c);
  if (c == NULL || setup->axes > kMostAxes) {
    free(c);
    return NULL;
  }
  c->axes = setup->axes;
  c->period = setup->period;
  for (uint32_t n = 0; n < setup->axes; n++) {
    const stribeck_board_axis* a = &setup->axis[n];
    struct axis* x = &c->axis[n];
    x->p = 3.0 * omega * omega * a->mass;
    x->i = omega * omega * omega * a->mass;
    x->d = 3.0 * omega * a->mass;
    x->ff1 = viscous(a);
    x->ff2 = a->mass;
    x->bias = a->load;
    x->deadband = a->resolution;
    x->maxoutput = a->force_limit;
  }
  return c;
}

static double with_deadband(double error, double deadband) {
  if (fabs(error) <= deadband) return 0.0;
  return error > 0.0 ? error - deadband : error + deadband;
}

void stribeck_board_step(void* controller, double time, const stribeck_board_input* in, double* force) {
  struct pid* c = controller;
  for (uint32_t n = 0; n < c->axes; n++) {
    struct axis* x = &c->axis[n];
    const double error = with_deadband(in[n].position - in[n].measured, x->deadband);
    const double rate = time > 0.0 ? (error - x->error) / c->period : 0.0;
    const double integral = x->integral + error * c->period;
    double out = x->bias + x->p * error + x->i * integral + x->d * rate + x->ff1 * in[n].velocity +
                 x->ff2 * in[n].acceleration;
    x->error = error;
    if (out > x->maxoutput) {
      out = x->maxoutput;
    } else if (out < -x->maxoutput) {
      out = -x->maxoutput;
    } else {
      x->integral = integral;
    }
    force[n] = out;
  }
}

void stribeck_board_destroy(void* controller) { free(controller); }
