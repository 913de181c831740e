component moving_mass "A mass on a guide, moved by a force: a plant that knows nothing of Stribeck";

description """Coulomb friction that holds the mass until the force exceeds it, and viscous friction. What stands for the machine in
hal/own-plant, as any component could that takes a force and gives a position.""";

pin in float force "N";
pin out float position "mm, in steps of resolution";
param rw float mass = 50 "kg";
param rw float coulomb = 30 "N";
param rw float viscous = 200 "N s/m";
param rw float resolution = 0.0001 "mm";
variable double x;
variable double v;

function _ fp;
license "GPL";
;;
#include <rtapi_math.h>

enum { steps = 50 };

FUNCTION(_) {
  const double dt = fperiod / steps;
  for (int i = 0; i < steps; ++i) {
    const int side = v > 0 ? 1 : v < 0 ? -1 : force > coulomb ? 1 : force < -coulomb ? -1 : 0;
    if (side == 0) continue;
    const double next = v + dt * (force - side * coulomb - viscous * v) / mass;
    v = next * side < 0 ? 0 : next; /* friction stops it, and does not push it back */
    x += v * dt;
  }
  position = floor(1000 * x / resolution + 0.5) * resolution;
}
