#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stribeck/control/laws/contouring.hpp>
#include <stribeck/control/laws/cross_coupled.hpp>
#include <stribeck/control/laws/pid.hpp>
#include <stribeck/control/laws/test_laws.hpp>
#include <stribeck/core/test_fields.hpp>
#include <stribeck/path/curve.hpp>

namespace stribeck::control::cross_coupled_test {
namespace {

path::PathPoint<2> along(double angle) {
  path::PathPoint<2> r;
  r.frame = {{{{{std::cos(angle), std::sin(angle)}}, {{-std::sin(angle), std::cos(angle)}}}}};
  return r;
}

TEST(CrossCoupled, OnAStraightStretchItIsPdAlongAndPidAcross) {
  const auto r = along(0.7);
  const auto setup = test::masses<2>(1e-3);
  const CrossCoupled<2> law({}, setup);
  PidParams p;
  p.kp = {1600.0, 3600.0};
  p.ki = {0.0, 20000.0};
  p.kv = {80.0, 120.0};
  const Pid<2> pid(p, setup);
  CrossCoupled<2>::State s;
  Pid<2>::State q;
  std::array<test::Mass, 2> mass;
  for (int k = 0; k < 300; ++k) {
    const Vec2 x{{mass[0].x, mass[1].x}};
    const Vec2 f = law.step(s, r, x);
    // The same axes seen along and across the path.
    const Vec2 local = pid.step(q, {}, r.frame * x);
    const Vec2 g = to_machine(r.frame, local);
    ASSERT_NEAR(f[0], g[0], 1e-10) << k;
    ASSERT_NEAR(f[1], g[1], 1e-10) << k;
    mass[0].move(f[0] - 30.0, 1e-3);
    mass[1].move(f[1] + 50.0, 1e-3);
  }
}

TEST(CrossCoupled, LeavesNoContourErrorUnderAConstantDisturbanceAndPdAlong) {
  // On a diagonal: only k_p acts against the force along the path; the integral acts against the force across it.
  const auto r = along(kPi / 4);
  const CrossCoupled<2> law({}, test::masses<2>(1e-3));
  CrossCoupled<2>::State s;
  std::array<test::Mass, 2> mass;
  for (int k = 0; k < 5000; ++k) {
    const Vec2 f = law.step(s, r, Vec2{{mass[0].x, mass[1].x}});
    mass[0].move(f[0] - 100.0, 1e-3);
    mass[1].move(f[1], 1e-3);
  }
  const Vec2 local = r.frame * Vec2{{mass[0].x, mass[1].x}};
  EXPECT_NEAR(local[0], -100.0 * std::sqrt(0.5) / test::kMass / 1600.0, 1e-12);
  EXPECT_NEAR(local[1], 0.0, 1e-12);
}

TEST(CrossCoupled, WithoutItsCouplingItIsPdOnEachAxis) {
  CrossCoupledParams p;
  p.contour_kp = p.contour_ki = p.contour_kv = 0.0;
  auto r = test::turning_point();
  const CrossCoupled<2> law(p, test::masses<2>(1e-3));
  CrossCoupled<2>::State s;
  r.frame_rate = {};  // contouring control with equal gains and no turn is PD
  r.frame_acceleration = {};
  const Contouring<2> pd(ContouringParams::critical(40.0, 40.0), test::masses<2>(1e-3));
  Contouring<2>::State t;
  for (int k = 0; k < 5; ++k) {
    const Vec2 x = r.position + Vec2{{1e-6 * k, -3e-6 * k}};
    const Vec2 f = law.step(s, r, x);
    const Vec2 g = pd.step(t, r, x);
    EXPECT_NEAR(f[0], g[0], 1e-9);
    EXPECT_NEAR(f[1], g[1], 1e-9);
  }
}

TEST(CrossCoupled, TheRateOfTheContourErrorHasTheTurnOfTheFrame) {
  // On a circle travelled at 4 rad/s the derivative of n·e is n'·e + n·e': against the difference of n·e itself.
  path::Reference<path::Curve> reference({path::Shape::kCircle, 10e-3}, {40e-3, 0.5, 1.0});
  while (reference.time() < 1.0) reference.advance(1e-4);
  const auto a = reference.point();
  reference.advance(1e-4);
  const auto b = reference.point();
  const Vec2 e0{{3e-6, -2e-6}};
  const Vec2 e1{{3.1e-6, -1.8e-6}};
  CrossCoupledParams p;
  p.contour_kp = p.contour_ki = 0.0;
  p.contour_kv = 1.0;
  CrossCoupledParams without = p;
  without.contour_kv = 0.0;
  const auto force = [&](const CrossCoupledParams& which) {
    const CrossCoupled<2> law(which, test::masses<2>(1e-4));
    CrossCoupled<2>::State s;
    law.step(s, a, a.position + e0);
    return law.step(s, b, b.position + e1);
  };
  const Vec2 pull = (-1.0 / test::kMass) * (force(p) - force(without));
  const double rate = (dot(b.frame[1], e1) - dot(a.frame[1], e0)) / 1e-4;
  // The turn is worth 4 rad/s · 3.6 um = 14 um/s of 2 mm/s; the difference lags by half a period.
  EXPECT_NEAR(dot(pull, b.frame[1]), rate, 1e-6);
  EXPECT_NEAR(dot(pull, b.frame[0]), 0.0, 1e-9);
}

TEST(CrossCoupled, HalvesTheContourErrorOfAxesThatDoNotMatch) {
  // A circle with one axis 20 % heavier than it is known to be: PD alone makes an oval.
  const auto worst = [](const auto& params) {
    using Law = typename std::decay_t<decltype(params)>::template Controller<2>;
    const Law law(params, test::masses<2>(1e-3));
    const path::Curve circle{path::Shape::kCircle, 10e-3};
    path::Reference<path::Curve> reference(circle, {20e-3, 0.5, 2.0 * path::lap_length(circle)});
    typename Law::State s;
    std::array<test::Mass, 2> mass;
    for (std::size_t i = 0; i < 2; ++i) mass[i].x = reference.point().position[i];
    double most = 0.0;
    while (!reference.finished()) {
      const Vec2 x{{mass[0].x, mass[1].x}};
      if (reference.time() > 1.0) most = std::max(most, std::abs(norm(x) - 10e-3));
      const Vec2 f = law.step(s, reference.point(), x);
      mass[0].move(f[0], 1e-3, 1.2 * test::kMass);
      mass[1].move(f[1], 1e-3);
      reference.advance(1e-3);
    }
    return most;
  };
  const double pd = worst(ContouringParams::critical(40.0, 40.0));
  EXPECT_GT(pd, 3e-6);
  EXPECT_LT(worst(CrossCoupledParams{}), 0.5 * pd);
}

/// Whether masses with unequal axes come to rest beside a straight stretch, in nearly continuous time.
bool comes_to_rest(const CrossCoupledParams& p, double angle) {
  const CrossCoupled<2> law(p, test::masses<2>(1e-4));
  const auto r = along(angle);
  CrossCoupled<2>::State s;
  std::array<test::Mass, 2> mass{test::Mass{1e-6, 0.0}, test::Mass{-2e-6, 0.0}};
  double late = 0.0;
  for (int k = 0; k < 40000; ++k) {
    const Vec2 f = law.step(s, r, Vec2{{mass[0].x, mass[1].x}});
    for (std::size_t i = 0; i < 2; ++i) mass[i].move(f[i], 1e-4);
    const double e = std::abs(mass[0].x) + std::abs(mass[1].x);
    if (!(e < 1.0)) return false;
    if (k > 36000) late = std::max(late, e);
  }
  return late < 3e-6;
}

TEST(CrossCoupled, WhatTheConditionPromisesHoldsInEveryDirectionWithUnequalAxes) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  int checked = 0;
  for (int n = 0; n < 12; ++n) {
    CrossCoupledParams p;
    p.kp = {400.0 + 3000.0 * share(random), 400.0 + 3000.0 * share(random)};
    p.kv = {30.0 + 90.0 * share(random), 30.0 + 90.0 * share(random)};
    p.contour_kp = 4000.0 * share(random);
    p.contour_kv = 100.0 * share(random);
    double below = 0.0;
    double above = 1e7;
    for (int k = 0; k < 40; ++k) {
      p.contour_ki = 0.5 * (below + above);
      (p.stable() ? below : above) = p.contour_ki;
    }
    p.contour_ki = 0.95 * below;  // sampled at 0.1 ms
    EXPECT_TRUE(comes_to_rest(p, kPi * share(random))) << "seed 7, case " << n;
    ++checked;
  }
  EXPECT_EQ(checked, 12);
  // With equal axes it is the border itself.
  CrossCoupledParams p;
  p.contour_ki = 1.02 * (1600.0 + 2000.0) * (80.0 + 40.0);
  EXPECT_FALSE(p.stable());
  EXPECT_FALSE(comes_to_rest(p, 0.4));
  p.contour_ki *= 0.96;
  EXPECT_TRUE(p.stable());
  EXPECT_TRUE(comes_to_rest(p, 0.4));
}

TEST(CrossCoupled, DefaultsAreStableOnTheVirtualMachines) {
  EXPECT_TRUE(CrossCoupledParams{}.stable());
  for (const double period : {1e-3, 5e-3}) EXPECT_TRUE(CrossCoupledParams{}.stable(period));
}

TEST(CrossCoupled, SaysWhichGainMakesItUnstable) {
  using Keys = std::set<std::string>;
  EXPECT_EQ(stribeck::test::complaints(CrossCoupledParams{}), Keys{});
  CrossCoupledParams p;
  p.contour_ki = 1e9;
  EXPECT_EQ(stribeck::test::complaints(p), Keys{"contour_ki"});
}

TEST(CrossCoupled, WhetherItIsStableDoesNotDependOnTheUnitOfTime) {
  // The same loop in seconds, in milliseconds and in hours; k_i just inside and just outside of the border of equal axes.
  for (const double second : {1.0, 1e3, 1.0 / 3600.0}) {
    for (const double share : {0.0, 0.99, 1.01}) {
      CrossCoupledParams p;
      p.kp = {900.0 / (second * second)};
      p.kv = {60.0 / second};
      p.contour_kp = 300.0 / (second * second);
      p.contour_kv = 20.0 / second;
      p.contour_ki = share * 1200.0 * 80.0 / (second * second * second);
      EXPECT_EQ(p.stable(), share < 1.0) << second << ", " << share;
      EXPECT_EQ(p.stable(1e-4 * second), share < 1.0) << second << ", " << share;
    }
  }
}

TEST(CrossCoupled, ItsBorderOfStabilityDoesNotDependOnTheUnitOfTime) {
  // With a strong coupling, where the worst direction is between the axes.
  const auto border = [](double second) {
    CrossCoupledParams p;
    p.kp = {900.0 / (second * second), 400.0 / (second * second)};
    p.kv = {60.0 / second, 40.0 / second};
    p.contour_kp = 3000.0 / (second * second);
    p.contour_kv = 100.0 / second;
    double below = 0.0;
    double above = 1e7 / (second * second * second);
    for (int k = 0; k < 60; ++k) {
      p.contour_ki = 0.5 * (below + above);
      (p.stable() ? below : above) = p.contour_ki;
    }
    return below * second * second * second;
  };
  const double si = border(1.0);
  EXPECT_GT(si, 900.0 * 60.0);
  for (const double second : {1e3, 1.0 / 3600.0}) EXPECT_NEAR(border(second), si, 1e-9 * si);
}

TEST(CrossCoupled, EachGainOfEachAxisCanMakeItUnstable) {
  for (const double wrong : {0.0, -1e-3, -1e3}) {
    for (const auto gain : {&CrossCoupledParams::kp, &CrossCoupledParams::kv}) {
      for (const std::size_t axis : {0, 2}) {
        CrossCoupledParams p;
        const double good = (p.*gain)[0];
        p.*gain = {good, good, good};
        ASSERT_TRUE(p.stable() && p.stable(1e-3));
        (p.*gain)[axis] = wrong;
        EXPECT_FALSE(p.stable()) << wrong << " on axis " << axis;
        EXPECT_FALSE(p.stable(1e-3)) << wrong << " on axis " << axis;
      }
    }
  }
  // And those of the coupling: the sum with the gain of the axes decides.
  CrossCoupledParams p;
  p.contour_kp = -p.kp[0] - 1.0;
  EXPECT_FALSE(p.stable(1e-3));
  p = {};
  p.contour_kv = -p.kv[0] - 1.0;
  EXPECT_FALSE(p.stable(1e-3));
}

TEST(CrossCoupled, WithoutGainsOfTheAxesItIsNotStable) {
  CrossCoupledParams p;
  p.kp = {};
  EXPECT_FALSE(p.stable());
  p = {};
  p.kv = {};
  EXPECT_FALSE(p.stable());
}

TEST(CrossCoupled, ItsIntegralsStandStillWhileAnAxisIsLimited) {
  auto setup = test::masses<2>(1e-3);
  setup.force_limit = {{100.0, 1e9}};
  const CrossCoupled<2> law({}, setup);
  CrossCoupled<2>::State s;
  auto r = along(0.4);
  law.step(s, r, Vec2{{1e-6, 2e-6}});
  const double before = s.integral[1];
  EXPECT_NEAR(before, 1e-3 * dot(r.frame[1], Vec2{{1e-6, 2e-6}}), 1e-20);
  r.acceleration = {{1000.0, 0.0}};
  law.step(s, r, Vec2{{1e-6, 2e-6}});
  EXPECT_EQ(s.integral[1], before);
}

TEST(CrossCoupled, KeepsWhatEveryLawKeeps) {
  test::expect_nan_answered(CrossCoupledParams{});
  test::expect_limits_kept(CrossCoupledParams{});
  test::expect_mirrored(CrossCoupledParams{});
  for (const double period : {1e-3, 5e-3})
    EXPECT_LT(test::worst_error_under_known_friction(CrossCoupledParams{}, period), 1e-12);
}

}  // namespace
}  // namespace stribeck::control::cross_coupled_test
