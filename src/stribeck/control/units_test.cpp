// What no control law may depend on: which axis of a machine an axis is, and the units of length, time and mass.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <stribeck/control/laws.hpp>
#include <utility>
#include <vector>

namespace stribeck::control::units_test {
namespace {

constexpr std::size_t kAxes = 3;
constexpr int kPeriods =
    2090;  // two laps; at their end learning decides for all axes together whether it goes on
constexpr double kLap = 2.0 * kPi;

/// So many of the unit are one metre, second, kilogram. Powers of four: every sum, product, quotient and root scales without
/// rounding.
struct Units {
  double m = 1.0;
  double s = 1.0;
  double kg = 1.0;
  [[nodiscard]] double newton() const { return kg * m / (s * s); }
};

/// Gains of axis i, in 1/s.
constexpr double omega(std::size_t i) {
  constexpr std::array<double, kAxes> kOmega{60.0, 75.0, 48.0};
  return kOmega[i];
}
template <class F>
PerAxis each(F f) {
  PerAxis list;
  for (std::size_t i = 0; i < kAxes; ++i) list.push_back(f(i));
  return list;
}
/// A gain in 1/s² and one in 1/s per axis.
PerAxis square(const Units& u) {
  return each([&](std::size_t i) { return omega(i) * omega(i) / (u.s * u.s); });
}
PerAxis twice(const Units& u) {
  return each([&](std::size_t i) { return 2.0 * omega(i) / u.s; });
}

/// How friction is compensated: on each axis by other means.
struct Means {
  std::array<Feedforward, kAxes> feedforward;
  std::array<Observer, kAxes> observer;
  std::array<bool, kAxes> adapts;
};
constexpr Means kOne{{Feedforward::kDynamic, Feedforward::kSteady, Feedforward::kReversal},
                     {Observer::kDisturbance, Observer::kKalman, Observer::kNone},
                     {true, false, false}};
constexpr Means kOther{{Feedforward::kNone, Feedforward::kDynamic, Feedforward::kDynamic},
                       {Observer::kAdaptive, Observer::kNone, Observer::kKalman},
                       {false, false, true}};

constexpr std::array<std::pair<Switching, SwitchingGain>, 3> kSliding{
    {{Switching::kBoundaryLayer, SwitchingGain::kPrinted},
     {Switching::kTanh, SwitchingGain::kSufficient},
     {Switching::kSuperTwisting, SwitchingGain::kAdaptive}}};

CompensationParams compensation(std::size_t i, const Means& means, const Units& u) {
  constexpr std::array<double, kAxes> kMass{30.0, 80.0, 20.0};
  constexpr std::array<double, kAxes> kLevel{6.0, 15.0, 4.0};
  const double n = u.newton();
  CompensationParams c;
  c.model.mass = kMass[i] * u.kg;
  c.model.load = (2.0 + static_cast<double>(i)) * n;
  c.model.friction.steady = friction::Conventional<double>{
      kLevel[i] * n, 40.0 * kLevel[i] * n * u.s / u.m,
      friction::Stribeck<double>{1.3 * kLevel[i] * n, (1.0 + static_cast<double>(i)) * 1e-3 * u.m / u.s,
                                 2.0}};
  c.model.friction.dynamics = friction::LuGre<double>{kLevel[i] * n / (5e-6 * u.m),
                                                      300.0 * kLevel[i] * n * u.s / u.m, 0.4e-3 * u.m / u.s};
  c.model.delay = 0.25e-3 * static_cast<double>(i) * u.s;
  c.feedforward = means.feedforward[i];
  c.observer = means.observer[i];
  c.observer_pole = (20.0 + 5.0 * static_cast<double>(i)) / u.s;
  if (c.observer == Observer::kKalman) c.disturbance_density = 2e3 * kMass[i] * n * n / u.s;
  c.adaptive_gain = 15.0 / u.s;
  c.adaptation.enabled = means.adapts[i];
  c.adaptation.memory = 8.0 * u.s;
  c.adaptation.correlation = 0.05 * u.s;
  c.reversal.distance = 6e-6 * u.m;
  c.reversal.lead = 0.5e-3 * u.s;
  c.reversal.rate_limit = 4000.0 * n / u.s;
  c.reversal.short_move = 50e-6 * u.m;
  c.encoder_resolution = 1e-7 * u.m;
  return c;
}

/// Small limits, so that forces are cut now and then.
double limit(std::size_t i, const Units& u) {
  constexpr std::array<double, kAxes> kLimit{22.0, 60.0, 17.0};
  return kLimit[i] * u.newton();
}

Setup<kAxes> setup(const Means& means, const Units& u = {}) {
  Setup<kAxes> s;
  s.period = 1e-3 * u.s;
  s.lap = kLap;
  for (std::size_t i = 0; i < kAxes; ++i) {
    s.compensation[i] = compensation(i, means, u);
    s.force_limit[i] = limit(i, u);
  }
  return s;
}
Setup<1> setup_of(const Setup<kAxes>& all, std::size_t i) {
  Setup<1> s;
  s.period = all.period;
  s.lap = all.lap;
  s.compensation[0] = all.compensation[i];
  s.force_limit[0] = all.force_limit[i];
  return s;
}

/// Axis i of a sine with reversals at other times on each axis, and what an encoder reads there: an error that changes, and one wild
/// jump that makes the force meet its limit.
struct Given {
  double position, velocity, acceleration, measured, phi;
};
Given given(std::size_t i, int k) {
  const double t = 1e-3 * k;
  const double w = 6.0;
  const double at = 1.3 * static_cast<double>(i);
  const double size = 4e-3 + 1e-3 * static_cast<double>(i);
  Given g{};
  g.phi = w * t;
  g.position = size * std::sin(g.phi + at);
  g.velocity = size * w * std::cos(g.phi + at);
  g.acceleration = -size * w * w * std::sin(g.phi + at);
  const double wild = k % 700 == 300 + 50 * static_cast<int>(i) ? 40e-6 : 0.0;
  g.measured = 1e-7 * std::nearbyint((g.position + 3e-6 * std::sin(9.0 * t + at) + wild) / 1e-7);
  return g;
}
template <std::size_t N>
void give(path::PathPoint<N>& r, Vec<double, N>& x, std::size_t to, std::size_t axis, int k,
          const Units& u = {}) {
  const Given g = given(axis, k);
  r.phi = g.phi;
  r.position[to] = g.position * u.m;
  r.velocity[to] = g.velocity * u.m / u.s;
  r.acceleration[to] = g.acceleration * u.m / (u.s * u.s);
  x[to] = g.measured * u.m;
}

/// Axis i of three gives the forces that it gives alone with its own settings, bit for bit. Not `cut`: no limit is met, because
/// then the law pauses learning on all axes.
template <class Params, class Alone>
void expect_independent(const Params& params, Alone alone_of, const Means& means, bool cut = true) {
  using All = typename Params::template Controller<kAxes>;
  using One = typename Params::template Controller<1>;
  Setup<kAxes> limited = setup(means);
  if (!cut) limited.force_limit = 1e6 * limited.force_limit;
  // Learning has one delay for all axes.
  for (CompensationParams& c : limited.compensation) c.model.delay = limited.compensation[1].model.delay;
  const auto all = std::make_unique<All>(params, limited);
  const auto state = std::make_unique<typename All::State>();
  std::vector<One> one;
  std::vector<typename One::State> alone(kAxes);
  for (std::size_t i = 0; i < kAxes; ++i) one.emplace_back(alone_of(i), setup_of(limited, i));
  int cuts = 0;
  for (int k = 0; k < kPeriods; ++k) {
    path::PathPoint<kAxes> r;
    Vec<double, kAxes> x;
    for (std::size_t i = 0; i < kAxes; ++i) give(r, x, i, i, k);
    const auto force = all->step(*state, r, x);
    for (std::size_t i = 0; i < kAxes; ++i) {
      path::PathPoint<1> r1;
      Vec<double, 1> x1;
      give(r1, x1, 0, i, k);
      ASSERT_EQ(force[i], one[i].step(alone[i], r1, x1)[0])
          << Params::kKind << " axis " << i << " period " << k;
      cuts += std::abs(force[i]) == limited.force_limit[i] ? 1 : 0;
    }
  }
  EXPECT_EQ(cuts > 0, cut) << Params::kKind;
}

PerAxis pick(const PerAxis& list, std::size_t i) { return PerAxis{list[i]}; }

/// A law with the gains kp and kv.
template <class Params>
void expect_independent_with_two(Params p, const Means& means, bool cut = true) {
  p.kp = square({});
  p.kv = twice({});
  expect_independent(
      p,
      [&](std::size_t i) {
        Params one = p;
        one.kp = pick(p.kp, i);
        one.kv = pick(p.kv, i);
        if constexpr (requires { p.ki; }) one.ki = pick(p.ki, i);
        return one;
      },
      means, cut);
}

TEST(Axes, EachOfThreeIsTheAxisAlone) {
  expect_independent_with_two(ContouringParams{}, kOne);
  expect_independent_with_two(ContouringParams{}, kOther);
  expect_independent_with_two(ZpetcParams{}, kOne);
  expect_independent_with_two(RepetitiveParams{}, kOne);
  expect_independent_with_two(LearningParams{}, kOne, false);
  PidParams pid;
  pid.ki = each([](std::size_t i) { return 4.0 * omega(i) * omega(i); });
  expect_independent_with_two(pid, kOther);
  CascadeParams cascade;
  cascade.position_gain = each([](std::size_t i) { return 0.5 * omega(i); });
  cascade.velocity_gain = twice({});
  cascade.integral_time = each([](std::size_t i) { return 0.1 + 0.02 * static_cast<double>(i); });
  expect_independent(
      cascade,
      [&](std::size_t i) {
        CascadeParams c = cascade;
        c.position_gain = pick(cascade.position_gain, i);
        c.velocity_gain = pick(cascade.velocity_gain, i);
        c.integral_time = pick(cascade.integral_time, i);
        return c;
      },
      kOne);
}

TEST(Axes, EachOfThreeIsTheAxisAloneInSlidingMode) {
  for (const auto& [switching, gain] : kSliding) {
    SlidingModeParams s;
    s.lambda = each([](std::size_t i) { return 0.5 * omega(i); });
    s.a = each([](std::size_t i) { return 10.0 + static_cast<double>(i); });
    s.gamma = each([](std::size_t i) { return 0.01 + 0.005 * static_cast<double>(i); });
    s.gamma_least = each([](std::size_t i) { return 0.002 + 0.001 * static_cast<double>(i); });
    s.gamma_most = each([](std::size_t i) { return 0.1 + 0.02 * static_cast<double>(i); });
    s.mass_bound = each([](std::size_t i) { return 1.0 + static_cast<double>(i); });
    s.force_bound = each([](std::size_t i) { return 0.5 + static_cast<double>(i); });
    s.switching = switching;
    s.gain = gain;
    expect_independent(
        s,
        [&s](std::size_t i) {
          SlidingModeParams one = s;
          for (const auto list :
               {&SlidingModeParams::lambda, &SlidingModeParams::a, &SlidingModeParams::gamma,
                &SlidingModeParams::gamma_least, &SlidingModeParams::gamma_most,
                &SlidingModeParams::mass_bound, &SlidingModeParams::force_bound})
            one.*list = pick(s.*list, i);
          return one;
        },
        kOne, false);
  }
}

/// The axes in another order: axis i of the other machine is axis kOrder[i] of this one.
constexpr std::array<std::size_t, kAxes> kOrder{2, 0, 1};
PerAxis reordered(const PerAxis& list) {
  PerAxis other;
  for (const std::size_t axis : kOrder) other.push_back(list[axis < list.size() ? axis : list.size() - 1]);
  return other;
}
/// One delay for all axes: the law that plans ahead and the one that learns know only one.
Setup<kAxes> in_order(const Means& means, bool other) {
  Setup<kAxes> all = setup(means);
  for (CompensationParams& c : all.compensation) c.model.delay = all.compensation[1].model.delay;
  // One axis has a drive with a loop of its own, whose velocity is not observed.
  all.compensation[0].model.drive_loop =
      friction::DriveLoop{friction::DriveMode::kVelocity, 2e4, 10e-3, {}, {}, false, true};
  Setup<kAxes> turned = all;
  for (std::size_t i = 0; i < kAxes; ++i) {
    turned.compensation[i] = all.compensation[kOrder[i]];
    turned.force_limit[i] = all.force_limit[kOrder[i]];
  }
  return other ? turned : all;
}
/// A frame that turns with φ about an axis that leans, as on a path in space.
void turn_frame(path::PathPoint<kAxes>& r) {
  constexpr double kRate = 6.0;
  const double lean = 0.4;
  const double c = std::cos(r.phi), s = std::sin(r.phi), up = std::cos(lean), down = std::sin(lean);
  r.frame = {{{{{c, s * up, s * down}}, {{-s, c * up, c * down}}, {{0.0, -down, up}}}}};
  r.frame_rate[0] = kRate * r.frame[1];
  r.frame_rate[1] = -kRate * r.frame[0];
  r.frame_acceleration[0] = -kRate * kRate * r.frame[0];
  r.frame_acceleration[1] = -kRate * kRate * r.frame[1];
}
path::PathPoint<kAxes> in_other_order(const path::PathPoint<kAxes>& r) {
  path::PathPoint<kAxes> other = r;
  for (std::size_t i = 0; i < kAxes; ++i) {
    for (const auto v : {&path::PathPoint<kAxes>::position, &path::PathPoint<kAxes>::velocity,
                         &path::PathPoint<kAxes>::acceleration})
      (other.*v)[i] = (r.*v)[kOrder[i]];
    for (const auto f : {&path::PathPoint<kAxes>::frame, &path::PathPoint<kAxes>::frame_rate,
                         &path::PathPoint<kAxes>::frame_acceleration}) {
      for (std::size_t row = 0; row < kAxes; ++row) (other.*f)[row][i] = (r.*f)[row][kOrder[i]];
    }
  }
  return other;
}

/// The forces of a machine whose axes are connected in another order are the same ones in that order. `other`: the same law, its
/// settings per axis in that order.
template <class Params>
void expect_any_order(const Params& params, const Params& other, const Means& means, int periods = 700) {
  using Law = typename Params::template Controller<kAxes>;
  const Setup<kAxes> here = in_order(means, false);
  const auto law = std::make_unique<Law>(params, here);
  const auto turned = std::make_unique<Law>(other, in_order(means, true));
  const auto state = std::make_unique<typename Law::State>();
  const auto state_turned = std::make_unique<typename Law::State>();
  for (int k = 0; k < periods; ++k) {
    path::PathPoint<kAxes> r;
    Vec<double, kAxes> x;
    for (std::size_t i = 0; i < kAxes; ++i) give(r, x, i, i, k);
    turn_frame(r);
    Vec<double, kAxes> measured;
    for (std::size_t i = 0; i < kAxes; ++i) measured[i] = x[kOrder[i]];
    const auto force = law->step(*state, r, x);
    const auto force_turned = turned->step(*state_turned, in_other_order(r), measured);
    for (std::size_t i = 0; i < kAxes; ++i)
      ASSERT_NEAR(force_turned[i], force[kOrder[i]], 1e-7 * here.force_limit[kOrder[i]])
          << Params::kKind << " axis " << i << " period " << k;
  }
  for (std::size_t i = 0; i < kAxes; ++i)
    EXPECT_NEAR(state_turned->change[i], state->change[kOrder[i]], 1e-9) << Params::kKind;
  if constexpr (requires { state->gain + state->update; }) {
    EXPECT_NEAR(state_turned->update, state->update, 1e-7 * state->update);
    EXPECT_NEAR(state_turned->error, state->error, 1e-7 * state->error);
    EXPECT_EQ(state_turned->passes, state->passes);
    EXPECT_GT(state->passes, 1u);
  }
}
template <class Params>
Params gains_reordered(Params p) {
  p.kp = reordered(p.kp);
  p.kv = reordered(p.kv);
  if constexpr (requires { p.ki; }) p.ki = reordered(p.ki);
  return p;
}
/// The means of friction of kOne, with a Kalman observer on each axis: its velocity is the one of an observed rate.
constexpr Means kObserved{{Feedforward::kDynamic, Feedforward::kSteady, Feedforward::kReversal},
                          {Observer::kKalman, Observer::kKalman, Observer::kKalman},
                          {false, true, false}};

TEST(AxesInAnyOrder, GiveTheirForcesInLawsWithGainsPerAxis) {
  for (const ErrorRate rate : {ErrorRate::kDifferenceOfError, ErrorRate::kLate, ErrorRate::kObserved}) {
    const Means& means = rate == ErrorRate::kObserved ? kObserved : kOther;
    PidParams pid;
    pid.kp = square({});
    pid.kv = twice({});
    pid.ki = each([](std::size_t i) { return 4.0 * omega(i) * omega(i); });
    pid.error_rate = rate;
    expect_any_order(pid, gains_reordered(pid), means);
    CascadeParams cascade;
    cascade.position_gain = each([](std::size_t i) { return 0.5 * omega(i); });
    cascade.velocity_gain = twice({});
    cascade.integral_time = each([](std::size_t i) { return 0.1 + 0.02 * static_cast<double>(i); });
    cascade.velocity_feedforward = 0.8;
    cascade.error_rate = rate;
    CascadeParams turned = cascade;
    turned.position_gain = reordered(cascade.position_gain);
    turned.velocity_gain = reordered(cascade.velocity_gain);
    turned.integral_time = reordered(cascade.integral_time);
    expect_any_order(cascade, turned, means);
  }
  for (const Preview preview : {Preview::kExtrapolated, Preview::kDelayed}) {
    ZpetcParams zpetc;
    zpetc.kp = square({});
    zpetc.kv = twice({});
    zpetc.preview = preview;
    expect_any_order(zpetc, gains_reordered(zpetc), kOne);
  }
  CrossCoupledParams coupled;
  coupled.kp = square({});
  coupled.kv = twice({});
  expect_any_order(coupled, gains_reordered(coupled), kOther);
}

TEST(AxesInAnyOrder, GiveTheirForcesInLawsOfTheFrame) {
  for (const ErrorRate rate : {ErrorRate::kDifferenceOfError, ErrorRate::kLate, ErrorRate::kObserved}) {
    ContouringParams p = ContouringParams::critical(60.0, 48.0);
    p.error_rate = rate;
    expect_any_order(p, p, rate == ErrorRate::kObserved ? kObserved : kOne);
  }
}

TEST(AxesInAnyOrder, GiveTheirForcesInSlidingMode) {
  for (const auto& [switching, gain] : kSliding) {
    SlidingModeParams s;
    s.mass_bound = each([](std::size_t i) { return 1.0 + static_cast<double>(i); });
    s.force_bound = each([](std::size_t i) { return 0.5 + static_cast<double>(i); });
    s.gamma = {8e-3, 15e-3};
    s.gamma_least = {0.5e-3, 2e-3};
    s.switching = switching;
    s.gain = gain;
    SlidingModeParams turned = s;
    turned.mass_bound = reordered(s.mass_bound);
    turned.force_bound = reordered(s.force_bound);
    expect_any_order(s, turned, kOne);
  }
}

TEST(AxesInAnyOrder, LearnTheSame) {
  RepetitiveParams repetitive;
  repetitive.kp = square({});
  repetitive.kv = twice({});
  expect_any_order(repetitive, gains_reordered(repetitive), kOne, 1500);
  LearningParams learning;
  learning.kv = {80.0, 60.0};
  expect_any_order(learning, learning, kOne, kPeriods);
}

TEST(AxesInAnyOrder, PlanTheSame) {
  for (const ErrorRate rate : {ErrorRate::kDifferenceOfError, ErrorRate::kObserved}) {
    for (const bool slows : {false, true}) {
      PredictiveParams p;
      p.speed_limit = {19e-3, 26e-3, 60e-3};  // the first two are faster than that
      p.slows = slows;
      p.horizon = 0.02;
      p.rate_at_sample = slows;
      p.error_rate = rate;
      PredictiveParams turned = p;
      turned.speed_limit = reordered(p.speed_limit);
      expect_any_order(p, turned, rate == ErrorRate::kObserved ? kObserved : kOther, 300);
    }
  }
}

/// In other units the forces are the same ones in those units.
template <class Make>
void expect_same_in_units(Make make, const Means& means, const std::vector<Units>& others) {
  using Params = decltype(make(Units{}));
  using Law = typename Params::template Controller<kAxes>;
  const auto si = std::make_unique<Law>(make(Units{}), setup(means));
  const auto state = std::make_unique<typename Law::State>();
  std::vector<Law> laws;
  std::vector<typename Law::State> states(others.size());
  for (const Units& u : others) laws.emplace_back(make(u), setup(means, u));
  for (int k = 0; k < kPeriods; ++k) {
    path::PathPoint<kAxes> r;
    Vec<double, kAxes> x;
    for (std::size_t i = 0; i < kAxes; ++i) give(r, x, i, i, k);
    const auto force = si->step(*state, r, x);
    for (std::size_t n = 0; n < others.size(); ++n) {
      for (std::size_t i = 0; i < kAxes; ++i) give(r, x, i, i, k, others[n]);
      const auto other = laws[n].step(states[n], r, x);
      for (std::size_t i = 0; i < kAxes; ++i)
        // The gains of the Kalman observer come from an iteration that ends at 1e-13 of them.
        ASSERT_NEAR(other[i], force[i] * others[n].newton(), 1e-9 * limit(i, others[n]))
            << Params::kKind << " axis " << i << " period " << k << " units " << n;
    }
  }
}

template <class Make>
void expect_same_in_other_units(Make make, const Means& means) {
  expect_same_in_units(make, means, {{4.0, 1.0, 1.0}, {1.0, 1.0, 4.0}});
  // Adaptation has time constants of its own.
  Means plain = means;
  plain.adapts = {};
  expect_same_in_units(make, plain, {{1.0, 4.0, 1.0}});
}

/// A law with the gains kp and kv.
template <class Params>
void expect_units_with_two(const Params& params, const Means& means) {
  expect_same_in_other_units(
      [&](const Units& u) {
        Params p = params;
        p.kp = square(u);
        p.kv = twice(u);
        if constexpr (requires { p.cutoff; }) p.cutoff = params.cutoff / u.s;
        if constexpr (requires { p.ki; }) p.ki = {2e5 / (u.s * u.s * u.s)};
        if constexpr (requires { p.contour_kp; }) {
          p.contour_kp /= u.s * u.s;
          p.contour_ki /= u.s * u.s * u.s;
          p.contour_kv /= u.s;
        }
        return p;
      },
      means);
}

TEST(Units, OfLengthTimeAndMassDoNotMatter) {
  expect_units_with_two(ContouringParams{}, kOne);
  expect_units_with_two(ContouringParams{}, kOther);
  expect_units_with_two(PidParams{}, kOther);
  expect_units_with_two(ZpetcParams{}, kOne);
  expect_units_with_two(RepetitiveParams{}, kOne);
  expect_units_with_two(LearningParams{}, kOne);
  expect_units_with_two(CrossCoupledParams{}, kOther);
  expect_same_in_other_units(
      [](const Units& u) {
        CascadeParams p;
        p.position_gain = each([&](std::size_t i) { return 0.5 * omega(i) / u.s; });
        p.velocity_gain = twice(u);
        p.integral_time = {0.1 * u.s};
        return p;
      },
      kOne);
}

TEST(Units, OfLengthTimeAndMassDoNotMatterInSlidingMode) {
  for (const auto& [switching, gain] : kSliding) {
    expect_same_in_other_units(
        [switching = switching, gain = gain](const Units& u) {
          const double a = u.m / (u.s * u.s);
          SlidingModeParams p;
          p.lambda = {20.0 / u.s, 40.0 / u.s};
          p.a = {10.0 / u.s, 20.0 / u.s};
          p.gamma = {10e-3 * a};
          p.gamma_least = {1e-3 * a};
          p.gamma_most = {100e-3 * a};
          p.mass_bound = {2.0 * u.kg};
          p.force_bound = {0.5 * u.newton()};
          p.boundary *= u.m / u.s;
          p.disturbance_rate /= u.s;
          p.growth /= u.s * u.s;
          p.switching = switching;
          p.gain = gain;
          return p;
        },
        kOne);
  }
}

}  // namespace
}  // namespace stribeck::control::units_test
