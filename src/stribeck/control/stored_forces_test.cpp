// The forces of every law, observer, feed-forward and supervision on one motion, against forces that were stored: any change of a
// force is seen here, also one that no closed form tells. Where a change is meant, STRIBECK_PRINT_FORCES=1 prints the new table.
#include <gtest/gtest.h>

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
#include <stribeck/path/motion_frame.hpp>
#include <string>
#include <vector>

namespace stribeck::control::stored_forces_test {
namespace {

constexpr double kPeriod = 1e-3;
constexpr int kPeriods = 6000;
constexpr double kStep = 0.1e-6;  ///< of the encoders [m]
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
using V = Vec<double, 2>;

/// Numbers between -1 and 1, the same everywhere.
class Numbers {
 public:
  double next() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state_ >> 40) * 0x1p-23 - 1.0;
  }

 private:
  std::uint64_t state_ = 2026;
};

/// Share of the full speed at time t [s] and its rate: run-in, a stop from 3.0 to 3.4 s, faster from then on.
struct Pace {
  double rate = 0.0;
  double change = 0.0;
};
Pace pace(double t) {
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
  explicit Axis(double x) : x_(x) {}
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
    return kStep * std::round((x_ + 0.2 * kStep * noise) / kStep);
  }

 private:
  static constexpr double kMass = 105.0;       ///< [kg]
  static constexpr double kStiffness = 4.0e6;  ///< [N/m]
  double x_ = 0.0;
  double v_ = 0.0;
  double z_ = 0.0;
};

/// First axis: differs by direction, with places, ripple and LuGre. Second: Stribeck and GMS, with a load.
Setup<2> setup() {
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

Supervision<2> limits() {
  Supervision<2> all;
  for (SupervisionParams& p : all) {
    p.speed_limit = 50e-3;
    p.acceleration_limit = 0.4;
    p.omega = 40.0;
  }
  return all;
}

LostMotionParams play() {
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
};

void everywhere(Setup<2>& s, Feedforward f, Observer o, bool adapts = false) {
  for (CompensationParams& c : s.compensation) {
    c.feedforward = f;
    c.observer = o;
    c.adaptation.enabled = adapts;
  }
}
void late(Setup<2>& s, double periods) {
  for (CompensationParams& c : s.compensation) c.delay = c.model.delay = periods * kPeriod;
}
void loops(Setup<2>& s, friction::DriveMode mode, bool offset) {
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

template <class Params>
Sums run(const Params& params, const Case& which) {
  using Law = typename Params::template Controller<2>;
  Setup<2> s = setup();
  if (which.change) which.change(s);
  const Supervised<Law, 2> watched(params, s, limits());
  const Law law(params, s);
  const DriveInterface<2> drives(s);
  const Compensation observed(with_known_force(s.compensation[0]), kPeriod);
  const auto state = std::make_unique<typename Supervised<Law, 2>::State>();
  typename DriveInterface<2>::State commands;
  const LostMotionMove lost_motion(play(), s.compensation[0], {20e-3, 0.5, 50.0, -20e-3, 20e-3}, kPeriod);
  const auto lost = std::make_unique<LostMotionMove::State>();
  Motion motion;
  Axis x(10e-3);
  Axis y(2e-3);
  Numbers noise;
  Numbers weights;
  Sums sums;
  V force;
  for (int k = 0; k < kPeriods; ++k) {
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
      drives.stop(commands, r, measured, force, 50, false);
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
    if (k % 100 == 99 && observed.adapts()) {
      const Drift d = observed.drift(state->law.compensation[0]);
      for (const double value :
           {d.level, d.level_deviation, d.positive, d.negative, d.viscous, d.break_away, d.mass,
            1e3 * d.delay, d.viscous_deviation, d.mass_deviation, d.break_away_deviation,
            1e3 * d.delay_deviation, std::isnan(d.trend) ? 0.0 : d.trend, static_cast<double>(d.verdict)})
        sums.other += weights.next() * value;
    }
  }
  for (int i = 0; i < static_cast<int>(Status::kCount); ++i)
    sums.other += weights.next() * 1e-3 * state->law.status.count(static_cast<Status>(i));
  for (const std::uint32_t n : state->watch.counts) sums.other += weights.next() * n;
  sums.other += weights.next() * state->watch.late + weights.next() * state->watch.commands_lost;
  for (const auto& a : state->watch.axes) sums.other += weights.next() * a.encoder.bridged;
  return sums;
}

ContouringParams critical() { return ContouringParams::critical(40.0, 60.0); }

std::function<void(Setup<2>&)> with(Feedforward f, Observer o, bool adapts = false) {
  return [=](Setup<2>& s) { everywhere(s, f, o, adapts); };
}

/// Each law alone.
void add_laws(std::vector<Case>& all) {
  const auto add = [&](std::string name, LawParams law) {
    all.push_back({std::move(name), std::move(law), {}, {}});
  };
  add("contouring", critical());
  add("pid", PidParams{});
  add("cascade", CascadeParams{});
  add("zpetc", ZpetcParams{});
  ZpetcParams delayed;
  delayed.preview = Preview::kDelayed;
  add("zpetc-delayed", delayed);
  add("cross-coupled", CrossCoupledParams{});
  add("repetitive", RepetitiveParams{});
  add("learning", LearningParams{});
  add("predictive", PredictiveParams{});
  for (const auto& [name, switching, gain] :
       {std::tuple{"sliding-sign", Switching::kSign, SwitchingGain::kPrinted},
        std::tuple{"sliding-layer", Switching::kBoundaryLayer, SwitchingGain::kSufficient},
        std::tuple{"sliding-tanh", Switching::kTanh, SwitchingGain::kAdaptive},
        std::tuple{"sliding-twisting", Switching::kSuperTwisting, SwitchingGain::kPrinted}}) {
    SlidingModeParams p;
    p.switching = switching;
    p.gain = gain;
    p.mass_bound = {10.0};
    p.force_bound = {20.0};
    add(name, p);
  }
  ContouringParams late_rate = critical();
  late_rate.error_rate = ErrorRate::kLate;
  add("late-rate", late_rate);
}

void add_compensations(std::vector<Case>& all) {
  const auto add = [&](std::string name, LawParams law, std::function<void(Setup<2>&)> change) {
    all.push_back({std::move(name), std::move(law), std::move(change), {}});
  };
  add("steady", critical(), with(Feedforward::kSteady, Observer::kNone));
  add("disturbance", critical(), with(Feedforward::kSteady, Observer::kDisturbance));
  add("kalman", critical(), with(Feedforward::kDynamic, Observer::kKalman));
  add("adaptive", critical(), with(Feedforward::kReversal, Observer::kAdaptive));
  add("adaptation", critical(), with(Feedforward::kDynamic, Observer::kKalman, true));
  add("reversal-adapts", critical(), with(Feedforward::kReversal, Observer::kDisturbance, true));
  ContouringParams observed = critical();
  observed.error_rate = ErrorRate::kObserved;
  add("observed-rate", observed, [](Setup<2>& s) {
    everywhere(s, Feedforward::kDynamic, Observer::kKalman, true);
    for (CompensationParams& c : s.compensation) c.disturbance_density = 4e4;
  });
  for (const double periods : {0.4, 1.0, 2.3}) {
    add("delay-" + std::to_string(static_cast<int>(10.0 * periods)), critical(), [=](Setup<2>& s) {
      everywhere(s, Feedforward::kDynamic, Observer::kKalman, true);
      late(s, periods);
    });
  }
  add("build-up", critical(), [](Setup<2>& s) {
    everywhere(s, Feedforward::kReversal, Observer::kDisturbance, true);
    s.compensation[0].reversal.build_up = {BuildUpPoint{0.0, 0.1}, BuildUpPoint{2e-6, 0.6},
                                           BuildUpPoint{9e-6, 1.1}, BuildUpPoint{30e-6, 1.0}};
    s.compensation[0].reversal.lead = 1.5e-3;
    s.compensation[1].reversal.distance = 6e-6;
    s.compensation[1].reversal.rate_limit = 2e3;
    s.compensation[1].reversal.short_move = 8e-3;
  });
  add("no-bristles", critical(), [](Setup<2>& s) {
    everywhere(s, Feedforward::kReversal, Observer::kKalman, true);
    for (CompensationParams& c : s.compensation) c.model.friction.dynamics = friction::Static{};
  });
  for (const auto mode : {friction::DriveMode::kVelocity, friction::DriveMode::kPosition}) {
    for (const bool offset : {false, true}) {
      add(std::string(mode == friction::DriveMode::kVelocity ? "velocity" : "position") +
              (offset ? "-offset" : "-loop"),
          critical(), [=](Setup<2>& s) {
            everywhere(s, Feedforward::kDynamic, Observer::kDisturbance, true);
            loops(s, mode, offset);
          });
    }
  }
  add("oscillation", ContouringParams::critical(250.0, 250.0), [](Setup<2>& s) {
    everywhere(s, Feedforward::kDynamic, Observer::kKalman, true);
    for (CompensationParams& c : s.compensation) c.observer_pole = 400.0;
  });
}

void add_supervised(std::vector<Case>& all) {
  const auto add = [&](std::string name, Trouble trouble) {
    all.push_back({std::move(name), critical(), with(Feedforward::kDynamic, Observer::kKalman, true),
                   std::move(trouble)});
  };
  add("sound", [](int, Given) {});
  add("wild-samples", [](int k, Given g) {
    if (k % 701 == 700) g.measured[0] += 3e-3;
    if (k % 503 == 502) g.measured[1] = kNan;
    if (k % 311 == 310) g.measured[0] += 1e-6;
    if (k > 4000 && k < 4006) g.measured[0] = -1.0;
    if (k % 907 == 906) g.r.acceleration[1] = kNan;
    if (k == 2200 || k == 2201) g.r.position[0] = kNan;
    if (k % 401 == 400) g.elapsed = 2.2 * kPeriod;
  });
  add("lost-and-reset", [](int k, Given g) {
    if (k >= 1800 && k < 2000) g.measured[1] = kNan;
    if (k >= 5200 && k < 5300) g.measured[0] = kNan;
    g.reset = k == 2400 || k == 5500;
  });
  add("frozen", [frozen = 0.0](int k, Given g) mutable {
    if (k == 1500) frozen = g.measured[0];
    if (k >= 1500) g.measured[0] = frozen;
  });
  add("wrong-sign", [](int, Given g) { g.measured[1] = 4e-3 - g.measured[1]; });
  add("command-lost", [](int k, Given g) {
    if (k > 3900) g.r.velocity[1] = kNan;
  });
  add("too-late", [](int k, Given g) {
    if (k > 4200) g.elapsed = 1.7 * kPeriod;
  });
  add("command-jumps", [](int k, Given g) {
    if (k > 2000) g.r.position[0] += 3e-3;
  });
}

struct Stored {
  const char* name;
  Sums sums;
};
const Stored kStored[] = {
    {"contouring", {2295.0926, -2581.90564, -132.90439}},
    {"pid", {2369.35172, -2582.04932, -132.90439}},
    {"cascade", {2390.22211, -2490.84157, -132.90439}},
    {"zpetc", {2402.445, -2063.43752, -132.90439}},
    {"zpetc-delayed", {2434.20648, -2035.06236, -132.90439}},
    {"cross-coupled", {2295.76949, -2570.95797, -132.90439}},
    {"repetitive", {2374.76939, -2258.28353, -132.90439}},
    {"learning", {2365.16694, -2043.39773, -132.90439}},
    {"predictive", {2427.36015, -2055.25564, -132.90439}},
    {"sliding-sign", {1694.42868, -1620.58179, -132.90439}},
    {"sliding-layer", {2039.10691, -2731.74663, -132.90439}},
    {"sliding-tanh", {1933.45863, -1537.85885, -132.90439}},
    {"sliding-twisting", {2465.18698, -2865.89018, -132.90439}},
    {"late-rate", {2331.71773, -2573.61299, -132.90439}},
    {"steady", {2660.3467, -2540.16883, 671.570037}},
    {"disturbance", {2572.2399, -2495.86671, 671.570037}},
    {"kalman", {2842.02817, -2404.72216, -332.965226}},
    {"adaptive", {2843.38711, -2432.07395, -290.335042}},
    {"adaptation", {2581.07881, -1962.16473, -81.2456336}},
    {"reversal-adapts", {2594.7707, -1969.44553, -73.3967426}},
    {"observed-rate", {2530.97041, -1207.40913, -81.0172807}},
    {"delay-4", {2606.32698, -1940.71716, -82.4358496}},
    {"delay-10", {2568.75945, -1941.31179, -81.6674003}},
    {"delay-23", {2616.46047, -1970.59068, -72.6288981}},
    {"build-up", {2744.10631, -1813.75044, -293.787624}},
    {"no-bristles", {2682.95761, -1949.73967, -258.92778}},
    {"velocity-loop", {-718.780701, -2778.62321, 8098.24898}},
    {"velocity-offset", {-718.780701, -2778.62321, 7364.661}},
    {"position-loop", {-718.780701, -2778.62321, 1250.85307}},
    {"position-offset", {-718.780701, -2778.62321, 1228.96616}},
    {"oscillation", {2235.23399, -1938.74672, -80.9232816}},
    {"sound", {2581.07881, -1962.16473, -81.2456336}},
    {"wild-samples", {2597.48725, -1962.8737, -67.9102692}},
    {"lost-and-reset", {248.242852, -534.429933, 203.824703}},
    {"frozen", {630.289456, 196.559805, 8.59445197}},
    {"wrong-sign", {2.77996765, -157.743616, -56.4255923}},
    {"command-lost", {1210.9168, -2057.2328, 96.7221435}},
    {"too-late", {978.443364, -1999.07604, 91.0233809}},
    {"command-jumps", {181.671233, -616.884923, 178.122088}},
};

bool printing() { return std::getenv("STRIBECK_PRINT_FORCES") != nullptr; }

TEST(StoredForces, AreThoseOfEveryRun) {
  std::vector<Case> cases;
  add_laws(cases);
  add_compensations(cases);
  add_supervised(cases);
  std::size_t at = 0;
  for (const Case& one : cases) {
    const Sums now = std::visit([&](const auto& params) { return run(params, one); }, one.law);
    if (printing()) {
      std::printf("    {\"%s\", {%.9g, %.9g, %.9g}},\n", one.name.c_str(), now.first, now.second, now.other);
      continue;
    }
    ASSERT_LT(at, std::size(kStored));
    const Stored& before = kStored[at++];
    ASSERT_EQ(one.name, before.name);
    // Another mathematical library may round differently.
    EXPECT_NEAR(now.first, before.sums.first, 1e-3) << one.name;
    EXPECT_NEAR(now.second, before.sums.second, 1e-3) << one.name;
    EXPECT_NEAR(now.other, before.sums.other, 1e-3) << one.name;
  }
  if (!printing()) {
    EXPECT_EQ(at, std::size(kStored));
  }
}

}  // namespace
}  // namespace stribeck::control::stored_forces_test
