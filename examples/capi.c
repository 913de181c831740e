/* A servo loop in C: one axis with friction compensation, in memory of this program. The "machine" is a mass with Coulomb
 * friction in five lines. */
#include <math.h>
#include <stdalign.h>
#include <stdio.h>
#include <stribeck/stribeck.h>

static alignas(64) unsigned char memory[32 * 1024];

int main(void) {
  const double period = 1e-3;
  stribeck_controller* c = stribeck_controller_init(memory, sizeof memory, 1);
  if (stribeck_abi() != STRIBECK_ABI || c == NULL) return 2;

  /* SI; the names are those of stribeck_controller_parameter(), and of axis files. */
  stribeck_controller_set(c, 0, "mass", 800.0);
  stribeck_controller_set(c, 0, "omega", 60.0);
  stribeck_controller_set(c, 0, "force_limit", 250.0);
  stribeck_controller_choose(c, 0, "friction.steady", "conventional");
  stribeck_controller_set(c, 0, "friction.conventional.alpha0", 15.0);
  stribeck_controller_set(c, 0, "friction.conventional.alpha2", 3e3);
  stribeck_controller_choose(c, 0, "feedforward", "steady");
  stribeck_controller_choose(c, 0, "observer", "disturbance");
  if (stribeck_controller_configure(c, period) != STRIBECK_OK) {
    fprintf(stderr, "%s\n", stribeck_controller_problem(c));
    return 2;
  }

  double x = 0.0, v = 0.0;
  stribeck_axis_signals now = {0};
  for (int k = 0; k < 2000; ++k) {
    const double w = 2.0, t = k * period;
    const stribeck_axis_input in = {10e-3 * sin(w * t), 10e-3 * w * cos(w * t), -10e-3 * w * w * sin(w * t),
                                    x};
    double force = 0.0;
    if (stribeck_controller_step(c, &in, &force) != STRIBECK_OK) return 1;
    stribeck_controller_signals(c, 0, &now, sizeof now);
    v += period * (force - 14.0 * tanh(v / 1e-4) - 3.2e3 * v) / 820.0;
    x += period * v;
  }
  printf("tracking error after 2 s: %.4f um, friction %.1f N, disturbance %.2f N\n", fabs(now.error) * 1e6,
         now.friction, now.disturbance);
  return 0;
}
