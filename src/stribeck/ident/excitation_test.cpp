#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include <stribeck/ident/excitation.hpp>
#include <stribeck/ident/least_squares_a.hpp>
#include <stribeck/ident/test_drive.hpp>
#include <stribeck/ident/velocity_map.hpp>

namespace stribeck::ident {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr Limits kTable{-0.05, 0.05, 0.010, 0.2, 10480.0};
constexpr RoughDrive kRough{60e3, 1200.0, 110e3};
constexpr double kPeriod = 0.005;

TEST(Excitation, SineIsThePrintedOneFromRest) {
  const Excitation e = design_sine(kTable, kPeriod);
  EXPECT_EQ(e.r.front(), 0.0);
  EXPECT_NEAR(*std::min_element(e.r.begin(), e.r.end()), -0.04, 1e-8);
  // After the run-in: r = −20 + 20·cos(0.475·(t − 0.5)) mm.
  EXPECT_NEAR(e.r[2000], -0.02 + 0.02 * std::cos(0.475 * 9.5), 1e-12);
  EXPECT_NEAR((e.r[1] - e.r[0]) / kPeriod, 0.0, 1e-8);
  EXPECT_NEAR(e.t.back(), 4 * 2 * kPi / 0.475 + 0.5, kPeriod);
}

TEST(Excitation, JogEndsWhereItBeganAndReachesEverySpeed) {
  JogDesign design;
  design.speeds = {0.1e-3, 1e-3, 9e-3};
  const Excitation e = design_jog(kTable, kPeriod, design);
  EXPECT_NEAR(e.r.back(), 0.0, 1e-12);
  for (const double v : design.speeds) {
    for (const double way : {1.0, -1.0}) {
      int rows = 0;
      for (std::size_t k = 1; k < e.r.size(); ++k)
        rows += std::abs((e.r[k] - e.r[k - 1]) / kPeriod - way * v) < 1e-9;
      EXPECT_GE(rows * kPeriod, 0.5) << v;
    }
  }
}

// Independent reference: the pulses on the virtual drive, whose friction is not the rough one. A first run
// without any idea of viscous friction stays slow; the second, designed from the first one's log, uses the
// limit.
TEST(Excitation, PulsesMoveTheBiaxialTableWithinItsLimits) {
  for (const char axis : {'x', 'y'}) {
    testing::Drive drive;
    drive.friction = testing::table_2_3(axis);
    RoughDrive rough{60e3, 1.05 * drive.level(0.0, true), 0.0};
    for (const double expected : {4e-3, 7e-3}) {
      const Excitation e = design_pulses(kTable, rough, kPeriod);
      testing::Truth truth;
      const Record rec = testing::run(
          drive, e.t.back(), 1, [&](std::size_t k, double, double) { return e.force[k]; }, &truth);
      const auto [low, high] = std::minmax_element(truth.v.begin(), truth.v.end());
      EXPECT_GT(std::min(*high, -*low), expected) << axis;
      EXPECT_LT(std::max(*high, -*low), kTable.speed) << axis;
      for (const double x : rec.x) EXPECT_LT(std::abs(x), 0.05);
      EXPECT_NEAR(e.t.back(), 25.0, 10.0);
      rough = rough_drive(identify_least_squares_a({rec}).result);
    }
  }
}

TEST(Excitation, PulsesComeInPairsAndBeginAtRest) {
  const Excitation e = design_pulses(kTable, kRough, kPeriod);
  double sum = 0.0;
  for (const double f : e.force) sum += f;
  EXPECT_NEAR(sum, 0.0, 1e-6);
  EXPECT_EQ(e.force.front(), 0.0);
  EXPECT_NEAR(*std::max_element(e.force.begin(), e.force.end()), 9.0 * 1.25 * 1200.0 / 4.0, 1e-6);
}

TEST(Excitation, ScalesWithUnitsOfForce) {
  const Excitation a = design_pulses(kTable, kRough, kPeriod);
  Limits limits = kTable;
  limits.force *= 10.0;
  const Excitation b =
      design_pulses(limits, {10 * kRough.mass, 10 * kRough.coulomb, 10 * kRough.viscous}, kPeriod);
  ASSERT_EQ(a.force.size(), b.force.size());
  for (std::size_t k = 0; k < a.force.size(); ++k) EXPECT_NEAR(10.0 * a.force[k], b.force[k], 1e-6);
}

TEST(Excitation, NamesTheLimitThatWouldBreak) {
  Limits weak = kTable;
  weak.force = 2000.0;
  EXPECT_THAT([&] { design_pulses(weak, kRough, kPeriod); },
              ThrowsMessage<Refused>(HasSubstr("limit of force")));
  Limits slow = kTable;
  slow.speed = 0.005;
  EXPECT_THAT([&] { design_sine(slow, kPeriod); }, ThrowsMessage<Refused>(HasSubstr("limit of speed")));
  Limits narrow = kTable;
  narrow.travel_min = -0.03;
  EXPECT_THAT([&] { design_sine(narrow, kPeriod); }, ThrowsMessage<Refused>(HasSubstr("travel")));
  Limits gentle = kTable;
  gentle.acceleration = 0.001;
  EXPECT_THAT([&] { design_sine(gentle, kPeriod); }, ThrowsMessage<Refused>(HasSubstr("acceleration")));
}

}  // namespace
}  // namespace stribeck::ident
