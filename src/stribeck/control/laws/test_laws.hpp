#pragma once
/// Tests that every control law must pass. Included by tests only.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stribeck/control/test_axes.hpp>

namespace stribeck::control::test {

/// A reference point that moves and turns, with every derivative different from zero.
inline path::PathPoint<2> turning_point() {
  path::PathPoint<2> r;
  r.position = {{1e-3, 2e-3}};
  r.velocity = {{3e-3, -4e-3}};
  r.acceleration = {{0.02, 0.05}};
  r.frame = {{{{{0.6, -0.8}}, {{0.8, 0.6}}}}};
  r.frame_rate = {{{{{0.72, 0.54}}, {{-0.54, 0.72}}}}};
  r.frame_acceleration = {{{{{-0.5, 0.6}}, {{-0.6, -0.5}}}}};
  r.phi = 0.3;
  return r;
}

/// Inputs that are not finite are answered with the last forces and leave no trace.
template <class Params>
void expect_nan_answered(const Params& params) {
  using Law = typename Params::template Controller<2>;
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  auto setup = masses<2>(1e-3);
  setup.lap = 2.0 * kPi;
  const Law law(params, setup);
  typename Law::State s;
  typename Law::State clean;
  const auto r = turning_point();
  const Vec2 x{{1.001e-3, 1.998e-3}};
  // Some periods first: time passes over the bad ones as well, so that what a law remembers of the reference must have come to rest.
  for (int k = 0; k < 4; ++k) EXPECT_EQ(law.step(s, r, x), law.step(clean, r, x));
  const Vec2 before = law.step(s, r, x);
  EXPECT_EQ(law.step(clean, r, x), before);
  EXPECT_EQ(law.step(s, r, Vec2{{1e-3, kNan}}), before);
  EXPECT_EQ(law.step(s, r, Vec2{{-std::numeric_limits<double>::infinity(), 2e-3}}), before);
  unsigned answered = 2;
  for (std::size_t i = 0; i < 2; ++i) {
    for (const auto member :
         {&path::PathPoint<2>::position, &path::PathPoint<2>::velocity, &path::PathPoint<2>::acceleration}) {
      auto broken = r;
      (broken.*member)[i] = kNan;
      EXPECT_EQ(law.step(s, broken, x), before) << i;
      ++answered;
    }
    for (const auto member : {&path::PathPoint<2>::frame, &path::PathPoint<2>::frame_rate,
                              &path::PathPoint<2>::frame_acceleration}) {
      auto broken = r;
      (broken.*member)[i][1 - i] = kNan;
      EXPECT_EQ(law.step(s, broken, x), before) << i;
      ++answered;
    }
  }
  EXPECT_EQ(s.status.count(Status::kNotFinite), answered);
  for (int k = 0; k < 5; ++k) EXPECT_EQ(law.step(s, r, x), law.step(clean, r, x));
}

/// Forces stay within their limits and the status says so; an axis without a limit is not touched.
template <class Params>
void expect_limits_kept(const Params& params) {
  using Law = typename Params::template Controller<2>;
  auto setup = masses<2>(1e-3);
  setup.force_limit = {{5.0, std::numeric_limits<double>::infinity()}};
  const Law law(params, setup);
  typename Law::State s;
  Vec2 f;
  for (int k = 0; k < 3; ++k) f = law.step(s, {}, Vec2{{-1.0, -1.0}});
  EXPECT_EQ(f[0], 5.0);
  EXPECT_GT(f[1], 5.0);
  EXPECT_EQ(s.status.first, Status::kOutputLimited);
}

/// With lists of gains that hold none there is no feedback: the force is that of the reference's acceleration, wherever the axis is.
template <class Params>
void expect_no_feedback(const Params& params) {
  using Law = typename Params::template Controller<2>;
  const Law law(params, masses<2>(1e-3));
  typename Law::State s;
  path::PathPoint<2> r;
  r.acceleration = {{0.02, 0.05}};
  for (int k = 0; k < 3; ++k) EXPECT_EQ(law.step(s, r, Vec2{{1e-3 * k, -2e-3 * k}}), kMass * r.acceleration);
}

/// The world mirrored through the origin: every force changes its sign, bit for bit.
template <class Params>
void expect_mirrored(const Params& params) {
  using Law = typename Params::template Controller<2>;
  auto setup = masses<2>(1e-3);
  setup.lap = 2.0 * kPi;
  setup.force_limit = {{60.0, 1e6}};  // the first is reached
  const Law law(params, setup);
  typename Law::State s;
  typename Law::State m;
  auto r = turning_point();
  bool limited = false;
  for (int k = 0; k < 50; ++k) {
    r.phi += 0.4;
    r.position = r.position + 1e-3 * r.velocity;
    auto q = r;
    for (auto* v : {&q.position, &q.velocity, &q.acceleration}) *v = -1.0 * *v;
    // Tangent and normal turn by half a turn as well.
    for (auto* f : {&q.frame, &q.frame_rate, &q.frame_acceleration}) {
      for (std::size_t i = 0; i < 2; ++i) (*f)[i] = -1.0 * (*f)[i];
    }
    const Vec2 x = r.position + Vec2{{20e-6 * (k % 7), -2e-6 * (k % 5)}};
    const Vec2 f = law.step(s, r, x);
    ASSERT_EQ(law.step(m, q, -1.0 * x), -1.0 * f) << "step " << k;
    limited = limited || std::abs(f[0]) == 60.0;
  }
  EXPECT_TRUE(limited);
}

/// Friction and load that the model knows leave no error on a stretch at constant speed: worst error over 0.5 s [m].
template <class Params>
double worst_error_under_known_friction(const Params& params, double period) {
  using Law = typename Params::template Controller<1>;
  constexpr double kSpeed = -4e-3;
  auto setup = masses<1>(period);
  auto& c = setup.compensation[0];
  c.model.friction.steady = friction::Conventional<double>{30.0, 2e3, {}};
  c.model.load = 7.0;
  c.feedforward = control::Feedforward::kSteady;
  const Law law(params, setup);
  typename Law::State s;
  Mass mass{0.0, kSpeed};
  double worst = 0.0;
  for (int k = 0; k < 0.5 / period; ++k) {
    path::PathPoint<1> r;
    r.position = {{kSpeed * period * k}};
    r.velocity = {{kSpeed}};
    worst = std::max(worst, std::abs(mass.x - r.position[0]));
    const double force = law.step(s, r, {{mass.x}})[0];
    mass.move(force + 30.0 - 2e3 * kSpeed - 7.0, period);
  }
  return worst;
}

/// A mass at rest under a law with a reference at rest; a constant disturbance [N] sets in at the first tick.
template <class Params>
class Disturbed {
 public:
  using Law = typename Params::template Controller<1>;

  Disturbed(const Params& params, double period, double disturbance,
            double limit = std::numeric_limits<double>::infinity())
      : law_(params, setup(period, limit)), period_(period), disturbance_(disturbance) {
    law_.step(state, {}, {{0.0}});
  }
  /// Tracking error after so many periods [m].
  double error_after(int steps) {
    for (int k = 0; k < steps; ++k) {
      const double force = law_.step(state, {}, {{mass.x}})[0];
      mass.move(force - disturbance_, period_);
    }
    return mass.x;
  }
  Mass mass;
  typename Law::State state;

 private:
  static Setup<1> setup(double period, double limit) {
    auto s = masses<1>(period);
    s.force_limit = {{limit}};
    return s;
  }
  Law law_;
  double period_;
  double disturbance_;
};

/// Whether a small error on masses becomes smaller in the long run: what stable() is compared with.
template <class Params>
bool dies_out(const Params& params, double period) {
  Disturbed<Params> loop(params, period, 0.0);
  loop.mass.x = 1e-6;
  const int steps = static_cast<int>(4.0 / period);
  double middle = 0.0;
  double end = 0.0;
  for (int k = 0; k < steps; ++k) {
    const double e = std::abs(loop.error_after(1));
    if (!(e < 1.0)) return false;
    if (k >= 4 * steps / 10 && k < 5 * steps / 10) middle = std::max(middle, e);
    if (k >= 9 * steps / 10) end = std::max(end, e);
  }
  return end < middle || end < 1e-15;
}

}  // namespace stribeck::control::test
