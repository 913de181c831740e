#pragma once
/// A law, its compensation, its supervision and its drives on one motion of two axes, summed up in three numbers. Tests compare them with
/// numbers that were stored: any change of a force is seen, also one that no closed form tells.
///
/// For tests only.

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <limits>
#include <memory>
#include <stribeck/control/compensation/lost_motion_move.hpp>
#include <stribeck/control/drive_interface.hpp>
#include <stribeck/control/laws.hpp>
#include <stribeck/control/supervision/supervisor.hpp>
#include <stribeck/core/test_numbers.hpp>
#include <stribeck/path/motion_frame.hpp>
#include <string>
#include <tuple>
#include <variant>
#include <vector>

namespace stribeck::control::test_stored {

inline constexpr double kPeriod = 1e-3;
inline constexpr int kPeriods = 6000;
inline constexpr double kStep = 0.1e-6;  ///< of the encoders [m]
/// What rounds_as_stored() computes with the mathematical library of Debian 12 on a processor with fused multiply-add.
inline constexpr std::uint64_t kRounding = 8934578248929296875u;
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
using V = Vec<double, 2>;

/// Share of the full speed at time t [s] and its rate: run-in, a stop from 3.0 to 3.4 s, faster from then on.
struct Pace {
  double rate = 0.0;
  double change = 0.0;
};
inline Pace pace(double t) {
  const auto rise = [&](double from, double to, double height) {
    const double x = std::min(1.0, std::max(0.0, (t - from) / (to - from)));
    return Pace{height * x * x * (3.0 - 2.0 * x), height * 6.0 * x * (1.0 - x) / (to - from)};
  };
  Pace sum;
  for (const Pace& p : {rise(0.1, 0.6, 2.0), rise(2.6, 3.0, -2.0), rise(3.4, 3.8, 3.0)}) {
    sum.rate += p.rate;
    sum.change += p.change;
  }
  return sum;
}

/// An ellipse that leans, 10 mm by 4 mm.
class Motion {
 public:
  path::PathPoint<2> next() {
    path::PathPoint<2> r;
    const Pace p = pace(time_);
    const double c = std::cos(phi_);
    const double s = std::sin(phi_);
    r.phi = phi_;
    r.position = {{10e-3 * c, 4e-3 * s + 2e-3 * c}};
    const V first{{-10e-3 * s, 4e-3 * c - 2e-3 * s}};
    r.velocity = p.rate * first;
    r.acceleration = p.change * first - (p.rate * p.rate) * r.position;
    frame_.step(state_, r);
    phi_ += kPeriod / 6.0 * (p.rate + 4.0 * pace(time_ + 0.5 * kPeriod).rate + pace(time_ + kPeriod).rate);
    time_ += kPeriod;
    return r;
  }

 private:
  path::MotionFrame<2> frame_{kPeriod, 1e-4, 20.0};
  path::MotionFrame<2>::State state_;
  double phi_ = 0.0;
  double time_ = 0.0;
};

/// A mass with bristle friction that is not quite the model of the controllers.
class Axis {
 public:
  /// Starts at x, with an encoder of this step.
  Axis(double x, double step) : step_(step), x_(x) {}
  void move(double force, double load) {
    constexpr int kParts = 20;
    constexpr double kPart = kPeriod / kParts;
    for (int i = 0; i < kParts; ++i) {
      const double level = 34.0 + 8.0 * std::exp(-(v_ * v_) / 4e-6) + 2.0 * std::sin(x_ / 0.8e-3);
      z_ = (z_ + kPart * v_) / (1.0 + kPart * kStiffness * std::abs(v_) / level);
      const double friction = kStiffness * z_ + 300.0 * v_;
      v_ += kPart / kMass * (force - load - friction);
      x_ += kPart * v_;
    }
  }
  [[nodiscard]] double read(double noise) const {
    return step_ * std::round((x_ + 0.2 * step_ * noise) / step_);
  }

 private:
  static constexpr double kMass = 105.0;       ///< [kg]
  static constexpr double kStiffness = 4.0e6;  ///< [N/m]
  double step_ = kStep;
  double x_ = 0.0;
  double v_ = 0.0;
  double z_ = 0.0;
};

/// First axis: differs by direction, with places, ripple and LuGre. Second: Stribeck and GMS, with a load.
inline Setup<2> setup() {
  Setup<2> s;
  s.period = kPeriod;
  s.lap = 2.0 * kPi;
  s.force_limit = {{260.0, 300.0}};
  for (CompensationParams& c : s.compensation) {
    c.model.mass = 100.0;
    c.encoder_resolution = kStep;
    c.observer_pole = 60.0;
    c.adaptive_gain = 30.0;
    c.guarded = true;
  }
  friction::AxisModel& x = s.compensation[0].model;
  friction::Gaussian<double> map;
  map.positive.eta0 = 33.0;
  map.positive.eta1 = 310.0;
  map.positive.gaussians = {friction::GaussianTerm<double>{7.0, 0.0, 2e-3}};
  map.negative.eta0 = -36.0;
  map.negative.eta1 = 290.0;
  map.negative.gaussians = {friction::GaussianTerm<double>{-6.0, 0.0, 3e-3}};
  map.velocity_range = {{-18e-3, 18e-3}};
  x.friction.steady = map;
  x.friction.dynamics = friction::LuGre<double>{4.5e6, 9e3, 0.3e-3};
  x.friction.eccentric = {
      friction::Eccentric<double>{1.5, 5e-3, 0.4},
      friction::Eccentric<double>{1.0, 2e-3, -0.2, friction::EccentricForm::kProportional}};
  x.friction.places = {friction::Place{-8e-3, 1.1, 0.9}, friction::Place{6e-3, 0.95, 1.2}};
  friction::AxisModel& y = s.compensation[1].model;
  y.load = 21.0;
  y.friction.steady = friction::Conventional<double>{33.0, 280.0, {}};
  friction::Gms<double> elements;
  elements.elements = {friction::GmsElement<double>{2e6, 0.4}, friction::GmsElement<double>{1.5e6, 0.35},
                       friction::GmsElement<double>{0.5e6, 0.25}};
  elements.attraction = 300.0;
  elements.damping_coefficient = 6e3;
  elements.damping_velocity = 0.4e-3;
  y.friction.dynamics = elements;
  return s;
}

inline Supervision<2> limits() {
  Supervision<2> all;
  for (SupervisionParams& p : all) {
    p.speed_limit = 50e-3;
    p.acceleration_limit = 0.4;
    p.omega = 40.0;
  }
  return all;
}

inline LostMotionParams play() {
  LostMotionParams p;
  p.backlash = 6e-6;
  p.backlash_slope = 1e-4;
  p.stiffness = 20e6;
  p.table_friction = 20.0;
  p.table_mass = 40.0;
  return p;
}

/// What a run is given in one of its periods.
struct Given {
  path::PathPoint<2>& r;
  V& measured;
  double& elapsed;
  bool& reset;
};
using Trouble = std::function<void(int period, Given)>;

struct Case {
  std::string name;
  LawParams law;
  std::function<void(Setup<2>&)> change;
  Trouble trouble;  ///< with it the law is supervised
  std::function<void(Supervision<2>&)> limit = {};
  std::function<void(LostMotionParams&)> lose = {};
  int periods = kPeriods;
  bool second = false;  ///< what adaptation, lost motion and stops of the second axis tell is summed up too
};

inline void everywhere(Setup<2>& s, Feedforward f, Observer o, bool adapts = false) {
  for (CompensationParams& c : s.compensation) {
    c.feedforward = f;
    c.observer = o;
    c.adaptation.enabled = adapts;
  }
}
inline void late(Setup<2>& s, double periods) {
  for (CompensationParams& c : s.compensation) c.model.delay = periods * kPeriod;
}
inline void loops(Setup<2>& s, friction::DriveMode mode, bool offset) {
  for (CompensationParams& c : s.compensation) {
    friction::DriveLoop d;
    d.mode = mode;
    d.gain = 9e3;
    d.integral_time = 20e-3;
    d.position_gain = 50.0;
    d.velocity_feedforward = 0.8;
    d.force_offset = offset;
    d.force_feedback = true;
    c.model.drive_loop = d;
  }
}

/// Sums of the forces of each axis, and of everything else that a run tells, with weights that differ from period to period.
struct Sums {
  double first = 0.0;
  double second = 0.0;
  double other = 0.0;
};

inline void add_drift(const Drift& d, stribeck::test::Numbers& weights, Sums& sums) {
  for (const double value :
       {d.level, d.level_deviation, d.positive, d.negative, d.viscous, d.break_away, d.mass, 1e3 * d.delay,
        d.viscous_deviation, d.mass_deviation, d.break_away_deviation, 1e3 * d.delay_deviation,
        std::isnan(d.trend) ? 0.0 : d.trend, static_cast<double>(d.verdict)})
    sums.other += weights.next() * value;
}

template <class State>
void add_counts(const State& state, stribeck::test::Numbers& weights, Sums& sums) {
  for (int i = 0; i < static_cast<int>(Status::kCount); ++i)
    sums.other += weights.next() * 1e-3 * state.law.status.count(static_cast<Status>(i));
  for (const std::uint32_t n : state.watch.counts) sums.other += weights.next() * n;
  sums.other += weights.next() * state.watch.late + weights.next() * state.watch.commands_lost;
  for (const auto& a : state.watch.axes) sums.other += weights.next() * a.encoder.bridged;
}

template <class Params>
Sums run(const Params& params, const Case& which) {
  using Law = typename Params::template Controller<2>;
  Setup<2> s = setup();
  if (which.change) which.change(s);
  Supervision<2> supervision = limits();
  if (which.limit) which.limit(supervision);
  LostMotionParams motion_lost = play();
  if (which.lose) which.lose(motion_lost);
  const Supervised<Law, 2> watched(params, s, supervision);
  const Law law(params, s);
  const DriveInterface<2> drives(s);
  const Compensation observed(with_known_force(s.compensation[0]), kPeriod);
  const auto state = std::make_unique<typename Supervised<Law, 2>::State>();
  typename DriveInterface<2>::State commands;
  const LostMotionMove lost_motion(motion_lost, s.compensation[0], {20e-3, 0.5, 50.0, -20e-3, 20e-3},
                                   kPeriod);
  const auto lost = std::make_unique<LostMotionMove::State>();
  const Compensation observed_y(with_known_force(s.compensation[1]), kPeriod);
  const LostMotionMove lost_motion_y(motion_lost, s.compensation[1], {15e-3, 0.3, 20.0, -10e-3, 12e-3},
                                     kPeriod);
  const auto lost_y = std::make_unique<LostMotionMove::State>();
  Motion motion;
  Axis x(10e-3, s.compensation[0].encoder_resolution);
  Axis y(2e-3, s.compensation[1].encoder_resolution);
  stribeck::test::Numbers noise{2026};
  stribeck::test::Numbers weights{2026};
  Sums sums;
  V force;
  for (int k = 0; k < which.periods; ++k) {
    path::PathPoint<2> r = motion.next();
    V measured{{x.read(noise.next()), y.read(noise.next())}};
    drives.admit(commands, state->law, force);
    double elapsed = kNan;
    if (which.trouble) {
      bool reset = false;
      which.trouble(k, {r, measured, elapsed, reset});
      if (reset) watched.reset(*state);
      force = watched.step(*state, r, measured, elapsed);
    } else {
      force = law.step(state->law, r, measured);
    }
    if (state->watch.fault == Fault::kNone) {
      drives.command(commands, state->law, r, measured, force);
    } else {
      drives.stop(commands, r, measured, force, {50, 50}, false);
    }
    x.move(force[0], 0.0);
    y.move(force[1], 20.0);
    sums.first += weights.next() * force[0];
    sums.second += weights.next() * force[1];
    for (std::size_t i = 0; i < 2; ++i) {
      if (drives.present(i))
        sums.other += weights.next() * 1e4 * commands[i].command + weights.next() * commands[i].offset;
    }
    const LostMotionMove::Output& moved =
        lost_motion.step(*lost, r.position[0], r.velocity[0], r.acceleration[0]);
    sums.other +=
        weights.next() * (1e6 * moved.position + moved.force) + weights.next() * 1e3 * moved.velocity;
    sums.other += weights.next() * static_cast<double>(state->watch.fault) +
                  weights.next() * (state->law.bridged[0] || state->law.doubtful[0] ? 1.0 : 0.0) +
                  weights.next() * state->law.compensation[0].guard.trust;
    if (which.second) {
      const LostMotionMove::Output& other =
          lost_motion_y.step(*lost_y, r.position[1], r.velocity[1], r.acceleration[1]);
      sums.other += weights.next() * (1e6 * other.position + other.force) +
                    weights.next() * 1e3 * other.velocity +
                    weights.next() * state->law.compensation[1].guard.trust;
      for (const auto& a : state->watch.axes) sums.other += weights.next() * a.stop.force;
    }
    for (const std::size_t axis : {std::size_t{0}, std::size_t{1}}) {
      const Compensation& told = axis == 0 ? observed : observed_y;
      if (k % 100 != 99 || !told.adapts() || (axis == 1 && !which.second)) continue;
      const Drift d = told.drift(state->law.compensation[axis]);
      add_drift(d, weights, sums);
    }
  }
  add_counts(*state, weights, sums);
  return sums;
}

struct Stored {
  const char* name;
  Sums sums;
};
/// Whether exp, sin and cos round as where the numbers were stored. Closed loops with rounded encoders multiply a difference of one bit.
inline bool rounds_as_stored() {
  std::uint64_t hash = 1469598103934665603u;
  for (int k = 1; k < 2000; ++k) {
    for (const double value : {std::exp(-0.0173 * k), std::sin(0.37 * k), std::cos(1.1e-3 * k)})
      hash = (hash ^ std::bit_cast<std::uint64_t>(value)) * 1099511628211u;
  }
  return hash == kRounding;
}

inline bool printing() { return std::getenv("STRIBECK_PRINT_FORCES") != nullptr; }

/// Prints the lines of the table, where a change is meant.
inline void print(const std::vector<Case>& cases) {
  for (const Case& one : cases) {
    const Sums now = std::visit([&](const auto& params) { return run(params, one); }, one.law);
    std::printf("    {\"%s\", {%.9g, %.9g, %.9g}},\n", one.name.c_str(), now.first, now.second, now.other);
  }
}

/// Runs a case and compares.
inline void expect_stored(const Case& one, const Stored& before) {
  if (printing()) return;
  if (!rounds_as_stored())
    GTEST_SKIP() << "another mathematical library: exp, sin or cos round otherwise here";
  ASSERT_EQ(one.name, before.name);
  const Sums now = std::visit([&](const auto& params) { return run(params, one); }, one.law);
  EXPECT_NEAR(now.first, before.sums.first, 1e-3);
  EXPECT_NEAR(now.second, before.sums.second, 1e-3);
  EXPECT_NEAR(now.other, before.sums.other, 1e-3);
}

/// Names of tests have no hyphens.
inline std::string name_of(const Stored& s) {
  std::string name = s.name;
  for (char& c : name) c = c == '-' ? '_' : c;
  return name;
}

}  // namespace stribeck::control::test_stored
