#pragma once
/// An axis with friction that follows a reference under a compensator, for the tests of this folder.

#include <algorithm>
#include <array>
#include <cmath>
#include <stribeck/control/laws/contouring.hpp>

namespace stribeck::control::test {

inline constexpr double kFollowPeriod = 5e-3;

/// A mass with LuGre friction under PD at rest or in motion, as exact as small steps make it.
class Axis {
 public:
  Axis(double level, double sigma0, double mass) : mass_(mass) {
    map_ = friction::Conventional<double>{level, 2e4, {}};
    law_ = friction::LuGre<double>{sigma0, std::sqrt(sigma0 * mass), 1e-4};
  }
  void move(double force) {
    constexpr int kParts = 50;
    const double dt = kFollowPeriod / kParts;
    for (int i = 0; i < kParts; ++i) {
      const double f = law_.step(map_, bristle_, v, x, dt);
      v += dt * (force - f) / mass_;
      x += dt * v;
    }
  }
  double x = 0.0;
  double v = 0.0;

 private:
  double mass_;
  friction::Conventional<double> map_;
  friction::LuGre<double> law_;
  friction::LuGre<double>::State bristle_;
};

inline CompensationParams whole(double level, double sigma0) {
  CompensationParams p;
  p.model.mass = 5e4;
  p.model.friction.steady = friction::Conventional<double>{level, 2e4, {}};
  p.model.friction.dynamics = friction::LuGre<double>{sigma0, std::sqrt(sigma0 * 5e4), 1e-4};
  p.feedforward = Feedforward::kDynamic;
  p.observer = Observer::kDisturbance;
  p.encoder_resolution = 1e-9;
  return p;
}

struct Followed {
  double worst = 0.0;  ///< tracking error of the last quarter [m]
  Compensation::State state;
};

/// 10 mm at 1 rad/s for so many seconds, PD at 40 rad/s. The mass, level and stiffness are the axis's; noise acts on it [N].
template <class Noise>
Followed follow(const CompensationParams& params, double level, double sigma0, double mass, int late,
                double seconds, Noise&& noise) {
  Setup<1> setup;
  setup.period = kFollowPeriod;
  setup.compensation[0] = params;
  const Contouring<1> law(ContouringParams::critical(40.0, 40.0), setup);
  Contouring<1>::State s;
  Axis axis(level, sigma0, mass);
  std::array<double, kMostDelay + 1> commanded{};  // newest first
  Followed result;
  const int steps = static_cast<int>(seconds / kFollowPeriod);
  for (int k = 0; k < steps; ++k) {
    // Starts at rest; the jump of the acceleration is negligible.
    const double t = k * kFollowPeriod;
    path::PathPoint<1> r;
    const double ramp = t < 1.0 ? 0.5 - 0.5 * std::cos(kPi * t) : 1.0;
    const double ramp1 = t < 1.0 ? 0.5 * kPi * std::sin(kPi * t) : 0.0;
    const double ramp2 = t < 1.0 ? 0.5 * kPi * kPi * std::cos(kPi * t) : 0.0;
    r.position = {{1e-2 * ramp * std::sin(t)}};
    r.velocity = {{1e-2 * (ramp1 * std::sin(t) + ramp * std::cos(t))}};
    r.acceleration = {{1e-2 * (ramp2 * std::sin(t) + 2.0 * ramp1 * std::cos(t) - ramp * std::sin(t))}};
    if (k > 3 * steps / 4) result.worst = std::max(result.worst, std::abs(axis.x - r.position[0]));
    std::rotate(commanded.begin(), commanded.end() - 1, commanded.end());
    commanded[0] = law.step(s, r, {{axis.x}})[0];
    axis.move(commanded[static_cast<std::size_t>(late)] + noise());
  }
  result.state = s.compensation[0];
  return result;
}

inline Followed follow(const CompensationParams& params, double level, double sigma0, double mass, int late,
                       double seconds) {
  return follow(params, level, sigma0, mass, late, seconds, [] { return 0.0; });
}

inline CompensationParams adapting(double level, double sigma0) {
  CompensationParams p = whole(level, sigma0);
  p.adaptation.enabled = true;
  p.guarded = true;
  return p;
}

}  // namespace stribeck::control::test
