/* The C interface seen by a C compiler: sizes that compiled hosts rely on, and a controller in memory of the caller. */
#include <stdalign.h>
#include <stddef.h>
#include <stribeck/plant.h>
#include <stribeck/stribeck.h>

_Static_assert(STRIBECK_ABI == 1, "a change below is a change of STRIBECK_ABI");
_Static_assert(sizeof(stribeck_axis_input) == 32, "four numbers");
_Static_assert(sizeof(stribeck_axis_signals) == 112,
               "six numbers, two switches; since then four numbers and a counter, two numbers: it may grow");
_Static_assert(offsetof(stribeck_axis_signals, limited) == 48, "");
_Static_assert(offsetof(stribeck_axis_signals, surface) == 56, "");
_Static_assert(offsetof(stribeck_axis_signals, command) == 96, "");
_Static_assert(sizeof(stribeck_parameter) == 112, "");
_Static_assert(offsetof(stribeck_parameter, value) == 80, "");
_Static_assert(STRIBECK_NO_MEMORY == -9 && STRIBECK_CHOICE == 3 && STRIBECK_PLANT_FORCE_LIMIT == 6, "");

/* Force of a PD controller for one step, or 1e9. */
double stribeck_test_force_from_c(double position, double measured) {
  static alignas(64) unsigned char memory[64 * 1024];
  const stribeck_axis_input in = {position, 0.0, 0.0, measured};
  double force = 1e9;
  stribeck_controller* c = stribeck_controller_init(memory, sizeof memory, 1);
  if (stribeck_abi() != STRIBECK_ABI || c == NULL) return 1e9;
  stribeck_controller_set(c, 0, "mass", 2.0);
  stribeck_controller_set(c, 0, "omega", 10.0);
  stribeck_controller_set(c, 0, "friction.conventional.alpha0", 5.0);
  stribeck_controller_configure(c, 1e-3);
  stribeck_controller_step(c, &in, &force);
  return force;
}
