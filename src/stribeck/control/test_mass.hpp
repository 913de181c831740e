#pragma once
/// A mass for tests of observers and of PD: moved exactly by a force that is held over a period.

namespace stribeck::control::test {

inline constexpr double kPeriod = 1e-3;  ///< [s]
inline constexpr double kMass = 50.0;    ///< [kg]

struct Mass {
  double x = 0.0;  ///< [m]
  double v = 0.0;  ///< [m/s]
  void move(double force, double dt = kPeriod, double mass = kMass) {
    const double a = force / mass;
    x += dt * v + 0.5 * dt * dt * a;
    v += dt * a;
  }
};

}  // namespace stribeck::control::test
