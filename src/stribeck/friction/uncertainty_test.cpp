#include <gtest/gtest.h>

#include <cmath>
#include <stribeck/friction/uncertainty.hpp>

namespace stribeck::friction::uncertainty_test {
namespace {

double force(const AxisModel& m, double v) { return steady_force(m.friction, v) + m.load; }

AxisModel conventional() {
  AxisModel m;
  m.mass = 50.0;
  m.load = 7.0;
  m.friction.steady = Conventional<double>{30.0, 200.0, Stribeck<double>{38.0, 4e-3, 1.0}};
  m.friction.dynamics = LuGre<double>{5e6, 1e3, 0.0};
  return m;
}

AxisModel gaussian() {
  AxisModel m;
  m.mass = 50.0;
  Gaussian<double> map;
  map.velocity_range = {-0.2, 0.3};
  map.positive = {30.0, 200.0, {GaussianTerm<double>{8.0, 0.01, 0.02}}};
  map.negative = {-25.0, 150.0, {}};
  m.friction.steady = map;
  return m;
}

TEST(ModelUncertainty, ALevelMovesEachDirectionByItself) {
  ModelDeviation d;
  d.level = {3.0, -2.0};  // forward more friction, backward less
  for (const AxisModel& m : {conventional(), gaussian()}) {
    const AxisModel moved = deviated(m, d, 4e-3);
    EXPECT_NEAR(force(moved, 0.1) - force(m, 0.1), 3.0, 1e-12);
    EXPECT_NEAR(force(moved, -0.1) - force(m, -0.1), 2.0, 1e-12);
  }
}

TEST(ModelUncertainty, ViscousPartAndRise) {
  ModelDeviation d;
  d.viscous = {20.0, 20.0};
  d.rise = {4.0, 4.0};
  for (const AxisModel& m : {conventional(), gaussian()}) {
    const AxisModel moved = deviated(m, d, 4e-3);
    EXPECT_NEAR(force(moved, 0.1) - force(m, 0.1), 2.0, 1e-6);
    EXPECT_NEAR(force(moved, -0.1) - force(m, -0.1), -2.0, 1e-6);
    EXPECT_NEAR(force(moved, 1e-9) - force(m, 1e-9), 4.0, 1e-5);
    EXPECT_NEAR(force(moved, -1e-9) - force(m, -1e-9), -4.0, 1e-5);
  }
}

TEST(ModelUncertainty, MassAndStiffness) {
  ModelDeviation d;
  d.mass = -5.0;
  d.stiffness = std::log(2.0);
  const AxisModel moved = deviated(conventional(), d, 4e-3);
  EXPECT_DOUBLE_EQ(moved.mass, 45.0);
  EXPECT_NEAR(std::get<LuGre<double>>(moved.friction.dynamics).sigma0, 1e7, 1.0);
}

TEST(ModelUncertainty, WhatWouldLeaveNoMassOrFrictionIsHalved) {
  ModelDeviation d;
  d.mass = -120.0;
  EXPECT_DOUBLE_EQ(deviated(conventional(), d, 4e-3).mass, 20.0);
  d = {};
  d.level = {-50.0, 0.0};
  const AxisModel moved = deviated(gaussian(), d, 4e-3);
  EXPECT_NEAR(force(moved, 0.3) - force(gaussian(), 0.3), -25.0, 1e-12);
  EXPECT_TRUE(is_possible(moved));
}

TEST(ModelUncertainty, AModelIsPossibleWithAnyMassAndFrictionAboveZero) {
  AxisModel m = conventional();
  m.mass = 1e-3;  // a stage of a gram
  EXPECT_TRUE(is_possible(m));
  for (const double none : {0.0, -1.0, std::nan("")}) {
    m.mass = none;
    EXPECT_FALSE(is_possible(m)) << none;
  }
  m = conventional();
  std::get<Conventional<double>>(m.friction.steady).alpha0 =
      -1.0;  // below the rise at standstill nothing brakes
  EXPECT_FALSE(is_possible(m));
  // A branch of a map that is wrong at the end of its range.
  for (const bool positive : {false, true}) {
    AxisModel g = gaussian();
    auto& map = std::get<Gaussian<double>>(g.friction.steady);
    EXPECT_TRUE(is_possible(g));
    (positive ? map.positive : map.negative)
        .gaussians.push_back({positive ? -40.0 : 40.0, positive ? 0.3 : -0.2, 0.01});
    EXPECT_FALSE(is_possible(g)) << positive;
  }
}

TEST(ModelUncertainty, ViscousFrictionFallsToNothingAndNotBelow) {
  AxisModel m = conventional();
  auto& map = std::get<Conventional<double>>(m.friction.steady);
  map.alpha2 = 0.4;  // of a small axis
  ModelDeviation d;
  d.viscous = {-0.1, -0.1};
  const auto viscous = [&] {
    return std::get<Conventional<double>>(deviated(m, d, 4e-3).friction.steady).alpha2;
  };
  EXPECT_DOUBLE_EQ(viscous(), 0.3);
  d.viscous = {-0.9, -0.9};
  EXPECT_EQ(viscous(), 0.0);
}

TEST(ModelUncertainty, NoDeviationIsNoChange) {
  for (const AxisModel& m : {conventional(), gaussian()}) {
    const AxisModel same = deviated(m, {}, 4e-3);
    EXPECT_EQ(same.mass, m.mass);
    EXPECT_EQ(same.load, m.load);
    for (const double v : {-0.15, -1e-3, 1e-3, 0.2}) EXPECT_EQ(force(same, v), force(m, v)) << v;
  }
}

}  // namespace
}  // namespace stribeck::friction::uncertainty_test
