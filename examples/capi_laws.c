/* The laws of the C interface on one axis that moves to and fro: which there are, how much memory each needs, and what it leaves. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <stribeck/stribeck.h>

/* Largest tracking error of the last lap of six [m], below 0 when the law is refused. */
static double run(const char* law) {
  const double period = 1e-3, lap = 3.0;
  const size_t size = stribeck_controller_size_for(1, law);
  void* memory = aligned_alloc(64, (size + 63) / 64 * 64);
  stribeck_controller* c = stribeck_controller_init(memory, size, 1);
  double x = 0.0, v = 0.0, most = -1.0;
  if (c != NULL) {
    stribeck_controller_choose(c, 0, "law", law);
    stribeck_controller_set(c, 0, "mass", 800.0);
    stribeck_controller_set(c, 0, "omega", 60.0);
    stribeck_controller_set(c, 0, "force_limit", 250.0);
    stribeck_controller_set(c, 0, "friction.conventional.alpha0", 10.0); /* it is 14 */
    stribeck_controller_choose(c, 0, "feedforward", "steady");
    stribeck_controller_set(c, 0, "learning.lap", lap);                /* refused under other laws */
    stribeck_controller_choose(c, 0, "sliding-mode.gain", "adaptive"); /* this too */
  }
  if (c == NULL || stribeck_controller_configure(c, period) != STRIBECK_OK) {
    fprintf(stderr, "%s: %s\n", law, stribeck_controller_problem(c));
    free(memory);
    return -1.0;
  }
  for (int k = 0; k < 18000; ++k) {
    const double w = 2.0 * 3.14159265358979 / lap, t = k * period;
    const stribeck_axis_input in = {10e-3 * sin(w * t), 10e-3 * w * cos(w * t), -10e-3 * w * w * sin(w * t),
                                    x};
    double force = 0.0;
    stribeck_controller_set_phase(c, t);
    if (stribeck_controller_step(c, &in, &force) != STRIBECK_OK) break;
    if (k > 15000) most = fmax(most, fabs(x - in.position));
    v += period * (force - 14.0 * tanh(v / 1e-4)) / 820.0;
    x += period * v;
  }
  free(memory);
  return most;
}

int main(void) {
  const char* law = NULL;
  for (uint32_t i = 0; (law = stribeck_controller_parameter_word("law", i)) != NULL; ++i) {
    const double most = run(law);
    if (most < 0.0) return 1;
    printf("%-13s %7zu bytes  %6.3f um\n", law, stribeck_controller_size_for(1, law), 1e6 * most);
  }
  return 0;
}
