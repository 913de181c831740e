#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <string>
#include <vector>

#include <stribeck/ident/excitation/excitation.hpp>
#include <stribeck/ident/methods/least_squares_a.hpp>
#include <stribeck/ident/methods/velocity_map.hpp>
#include <stribeck/ident/test_drive.hpp>

namespace stribeck::ident::excitation::excitation_test {
namespace {

using ::testing::AllOf;
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

// The sine stays what it is; then each of the two speeds is held, out and back, over several turns of a screw.
TEST(Excitation, StrokesAfterASineHoldTheirSpeedWhereTheSineChangesIt) {
  const Limits axis{-0.4, 0.4, 0.05, 0.5, 0.0};
  SineDesign design{0.004, 0.002, 10.0, 4};
  const Excitation alone = design_sine(axis, kPeriod, design);
  design.strokes = 2;
  const Excitation e = design_sine(axis, kPeriod, design);
  ASSERT_GT(e.r.size(), alone.r.size());
  EXPECT_TRUE(std::equal(alone.r.begin(), alone.r.end(), e.r.begin()));
  EXPECT_NEAR(e.r.back(), design.start, 1e-12);
  EXPECT_NEAR(*std::min_element(e.r.begin(), e.r.end()), design.start - 0.095, 1e-3);  // 95 % of 100 mm
  for (const double v : {0.010, 0.004}) {  // half of the 20 mm/s of the sine, and 0.4 of that
    for (const double way : {1.0, -1.0}) {
      double held = 0.0;
      for (std::size_t k = alone.r.size(); k < e.r.size(); ++k) {
        const double step = e.r[k] - e.r[k - 1];
        if (std::abs(step / kPeriod - way * v) < 1e-9) held += std::abs(step);
      }
      EXPECT_GT(held, 0.039) << way * v;  // ten seconds of the slower one
    }
  }
  // A travel that is hardly longer than the sine, and no room below it for a stroke at that speed.
  const Limits narrow{-0.0005, 0.0041, 0.05, 0.5, 0.0};
  EXPECT_NO_THROW(design_sine(narrow, kPeriod, design));
  design.strokes = 1;
  design.amplitude = 1e-5;
  EXPECT_NO_THROW(design_sine({0.0039, 0.0041, 0.05, 0.5, 0.0}, kPeriod, design));
}

// Ten seconds of each stroke are two million rows of a fast control, which nobody asked for.
TEST(Excitation, StrokesOfAFastControlAreShorter) {
  const Limits axis{-0.4, 0.4, 0.05, 0.5, 0.0};
  SineDesign design{0.004, 0.002, 10.0, 4};
  design.strokes = 2;
  const Excitation slow = design_sine(axis, 1e-3, design);
  const Excitation fast = design_sine(axis, 12.5e-6, design);
  EXPECT_LE(fast.r.size(), kMostRows);
  EXPECT_GT(fast.r.size(), kMostRows / 2);
  EXPECT_LT(fast.t.back(), 0.8 * slow.t.back());
  EXPECT_NEAR(fast.r.back(), design.start, 1e-9);
  EXPECT_NE(fast.says.find("2 constant speeds"), std::string::npos) << fast.says;
}

// Friction that changes in time must not look like friction over speed.
TEST(Excitation, MixedOrderHasNoTrend) {
  const std::vector<double> sorted = jog_speeds(0.3);
  const std::vector<double> mixed = in_mixed_order(sorted);
  std::vector<double> again = mixed;
  std::sort(again.begin(), again.end());
  EXPECT_TRUE(std::includes(again.begin(), again.end(), sorted.begin(), sorted.end()));
  EXPECT_EQ(mixed.size(), sorted.size() + 3);
  // Rank correlation with the place in the order; 0.9 and more is what a log is warned of.
  double xy = 0.0, xx = 0.0;
  const double middle = 0.5 * (static_cast<double>(sorted.size()) - 1.0);
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const auto rank =
        static_cast<double>(std::lower_bound(sorted.begin(), sorted.end(), mixed[i]) - sorted.begin());
    const double x = static_cast<double>(i) - middle;
    xy += x * (rank - middle), xx += x * x;
  }
  EXPECT_LT(std::abs(xy / xx), 0.3);
  EXPECT_EQ(in_mixed_order({0.003, 0.001, 0.002}), (std::vector<double>{0.001, 0.002, 0.003}));
}

TEST(Excitation, FastestJogGoesSeveralTurns) {
  JogDesign design;
  design.speeds = {1e-3, 9e-3};
  design.way = 0.04;
  const Excitation e = design_jog(kTable, kPeriod, design);
  EXPECT_NEAR(*std::max_element(e.r.begin(), e.r.end()), 0.04, 1e-3);
  design.way = kSeveralTurns;  // more than the travel of 50 mm to that side
  const Excitation far = design_jog(kTable, kPeriod, design);
  EXPECT_NEAR(*std::max_element(far.r.begin(), far.r.end()), 0.0475, 1e-3);
}

TEST(Excitation, JogsOnBothSidesStayInTheSmallerRoom) {
  JogDesign design;
  design.speeds = {9e-3, 8e-3, 1e-3};
  design.way = kSeveralTurns;
  design.both_sides = true;
  design.start = 0.01;  // 40 mm above, 60 mm below
  const Excitation e = design_jog(kTable, kPeriod, design);
  const auto [low, high] = std::minmax_element(e.r.begin(), e.r.end());
  EXPECT_NEAR(*high - 0.01, 0.038, 1e-3);
  EXPECT_LT(*low, 0.01 - 0.015);  // two seconds of the second speed
  EXPECT_GT(*low, 0.01 - 0.04);
  EXPECT_NEAR(e.r.back(), 0.01, 1e-9);
}

// What is asked for is counted before it is filled.
TEST(Excitation, RefusesWhatWouldTakeForEver) {
  const auto parameter_of = [](auto&& design) -> std::string {
    try {
      design();
    } catch (const BadDesign& bad) {
      return bad.parameter;
    }
    return "accepted";
  };
  for (const double rise : {1e-9, 1e5, 1e300}) {
    RampDesign design;
    design.rise = rise;
    EXPECT_EQ(parameter_of([&] { design_ramp(kTable, kRough, kPeriod, design); }), "rise") << rise;
  }
  RampDesign ramps;
  ramps.repeats = 100000;
  EXPECT_EQ(parameter_of([&] { design_ramp(kTable, kRough, kPeriod, ramps); }), "repeats");
  for (const double v : {1e-15, 1e-9, -1.0, 0.0, 1.0}) {
    JogDesign design;
    design.speeds = {1e-3, v};
    EXPECT_EQ(parameter_of([&] { design_jog(kTable, kPeriod, design); }), "speeds") << v;
  }
  for (const double lead : {1e-15, 1e9}) {
    JogDesign design;
    design.period = lead;
    EXPECT_EQ(parameter_of([&] { design_jog(kTable, kPeriod, design); }), "period") << lead;
  }
  SineDesign sine;
  sine.periods = 1000000;
  EXPECT_EQ(parameter_of([&] { design_sine(kTable, kPeriod, sine); }), "periods");
  sine = {};
  sine.frequency = 1e-300;
  EXPECT_EQ(parameter_of([&] { design_sine(kTable, kPeriod, sine); }), "periods");
  AccelerationDesign triangles;
  triangles.repeats = 1000000;
  EXPECT_EQ(parameter_of([&] { design_constant_acceleration(kTable, kPeriod, triangles); }), "repeats");
  // A mass that nothing moves.
  EXPECT_THAT(
      [] {
        design_ramp(kTable, RoughDrive{1e300, 1200.0, 0.0}, kPeriod);
      },
      ThrowsMessage<Refused>(HasSubstr("rough mass of 1e+300 kg")));
  EXPECT_THAT(
      [] {
        design_pulses(kTable, RoughDrive{1e300, 1200.0, 0.0}, kPeriod);
      },
      ThrowsMessage<Refused>(HasSubstr("rough mass of 1e+300 kg")));
  // As many rows as there may be are designed.
  ramps = {};
  ramps.rise = 900.0;
  EXPECT_LE(design_ramp(kTable, RoughDrive{60e3, 1200.0, 1e9}, kPeriod, ramps).t.size(), kMostRows);
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
    test::Drive drive;
    drive.friction = test::table_2_3(axis);
    RoughDrive rough{60e3, 1.05 * drive.level(0.0, true), 0.0};
    for (const double expected : {4e-3, 7e-3}) {
      const Excitation e = design_pulses(kTable, rough, kPeriod);
      test::Truth truth;
      const log::Record rec = test::run(
          drive, e.t.back(), 1, [&](std::size_t k, double, double) { return e.force[k]; }, &truth);
      const auto [low, high] = std::minmax_element(truth.v.begin(), truth.v.end());
      EXPECT_GT(std::min(*high, -*low), expected) << axis;
      EXPECT_LT(std::max(*high, -*low), kTable.speed) << axis;
      for (const double x : rec.x) EXPECT_LT(std::abs(x), 0.05);
      EXPECT_NEAR(e.t.back(), 25.0, 10.0);
      rough = rough_drive(methods::identify_least_squares_a({rec}).result);
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

TEST(Excitation, PulsesKeepToWhatTheMachineMay) {
  Limits weak = kTable;
  weak.force = 2000.0;
  weak.acceleration = 0.0;
  const Excitation down = design_pulses(weak, kRough, kPeriod);
  EXPECT_NEAR(*std::max_element(down.force.begin(), down.force.end()), 2000.0, 1e-9);
  EXPECT_THAT(down.says, HasSubstr("reduced to 2000 N"));
  Limits gentle = kTable;
  gentle.acceleration = 600.0 / kRough.mass;
  const Excitation soft = design_pulses(gentle, kRough, kPeriod);
  EXPECT_NEAR(*std::max_element(soft.force.begin(), soft.force.end()), kRough.coulomb + 600.0, 1e-9);
  // A heavy axis that hardly brakes by itself: 2 t, 21 N, ±20 mm. What it really does with the friction that it is thought to have.
  const Limits wide{-0.02, 0.02, 0.15, 0.3, 2000.0};
  const RoughDrive heavy{2000.0, 21.0, 200.0};
  const Excitation short_way = design_pulses(wide, heavy, kPeriod);
  EXPECT_THAT(short_way.says, HasSubstr("the travel is short"));
  double x = 0.0, v = 0.0, most = 0.0, fastest = 0.0;
  for (const double f : short_way.force) {
    const double free = v + kPeriod * (f - heavy.viscous * v) / heavy.mass;
    const double brake = kPeriod * heavy.coulomb / heavy.mass;
    v = free > brake ? free - brake : free < -brake ? free + brake : 0.0;
    x += kPeriod * v;
    most = std::max(most, std::abs(x));
    fastest = std::max(fastest, std::abs(v));
  }
  EXPECT_LT(most, 0.02);
  EXPECT_GT(fastest, 0.01);
  // A light one with much friction.
  EXPECT_THAT(
      [] {
        design_pulses({-0.2, 0.2, 0.1, 1.0, 500.0}, {12.0, 150.0, 0.0}, kPeriod);
      },
      ThrowsMessage<Refused>(
          HasSubstr("are only 8.0 % above it: too little for a force in open loop; choose sine")));
  Limits creeping = kTable;
  creeping.speed = 1e-7;
  EXPECT_THAT([&] { design_pulses(creeping, kRough, kPeriod); },
              ThrowsMessage<Refused>(HasSubstr("stays within the travel of")));
  Limits stuck = kTable;
  stuck.force = 1000.0;
  EXPECT_THAT([&] { design_pulses(stuck, kRough, kPeriod); },
              ThrowsMessage<Refused>(HasSubstr("limits of force")));
}

TEST(Excitation, JogsGoAsFastAsTheTravelLets) {
  const Limits fast{-0.07, 0.07, 0.3, 1.0, 0.0};
  const double fastest = fastest_jog(fast, kPeriod);
  EXPECT_GT(fastest, 0.04);
  EXPECT_LT(fastest, 0.07);
  const std::vector<double> speeds = jog_speeds(fastest);
  EXPECT_EQ(speeds.back(), fastest);
  for (std::size_t k = 12; k < speeds.size(); ++k) EXPECT_LT(speeds[k], 1.5 * speeds[k - 1]);
  JogDesign design;
  design.speeds = speeds;
  EXPECT_NO_THROW(design_jog(fast, kPeriod, design));
  design.speeds = {1.05 * fastest};
  EXPECT_THAT([&] { design_jog(fast, kPeriod, design); },
              ThrowsMessage<Refused>(HasSubstr("of constant speed")));
  EXPECT_DOUBLE_EQ(fastest_jog({-1.0, 1.0, 0.1, 1.0, 0.0}, kPeriod), 0.095);
}

TEST(Excitation, NamesTheLimitThatWouldBreak) {
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

// A linear motor with a period of 62.5 us: all speeds of an axis of 1.5 m/s would take more than two million rows.
TEST(Excitation, JogsOfAShortPeriodLeaveTheSlowestOut) {
  const Limits limits{0.0, 1.0, 1.5, 15.0, 900.0};
  constexpr double kShortest = 62.5e-6;
  JogDesign jog;
  jog.start = 0.5;
  jog.speeds = in_mixed_order(jog_speeds(fastest_jog(limits, kShortest, jog)));
  const std::size_t all = jog.speeds.size();
  EXPECT_THROW(design_jog(limits, kShortest, jog), Refused);
  EXPECT_TRUE(leave_out_slowest(limits, kShortest, jog));
  EXPECT_LT(jog.speeds.size(), all);
  EXPECT_GT(*std::min_element(jog.speeds.begin(), jog.speeds.end()), 1e-5);
  const Excitation e = design_jog(limits, kShortest, jog);
  EXPECT_LE(e.r.size(), kMostRows);
  EXPECT_GT(e.r.size(), kMostRows / 2);
  // A usual period has room for all.
  EXPECT_FALSE(leave_out_slowest(limits, 1e-3, jog));
}

TEST(Excitation, JogOfAScrewGoesWholeTurns) {
  JogDesign design;
  design.speeds = {0.1e-3, 1e-3, 9e-3};
  design.period = 2e-3;
  const Excitation e = design_jog(kTable, kPeriod, design);
  for (const double v : design.speeds) {
    double way = 0.0;
    for (std::size_t k = 1; k < e.r.size(); ++k) {
      const double step = e.r[k] - e.r[k - 1];
      if (std::abs(step / kPeriod - v) < 1e-9) way += step;
    }
    const double turns = (way - 0.5 * v) / design.period;  // half a second is left out by the identification
    EXPECT_NEAR(turns, std::round(turns), 0.03) << v;
    EXPECT_GE(turns, 0.97) << v;
  }
}

TEST(Excitation, PositionSineIsThePrintedOneFromRest) {
  SineDesign design{0.0, 0.010, 0.9, 4, true};
  const Excitation e = design_sine(kTable, kPeriod, design);
  EXPECT_NEAR(e.r[2000], 0.010 * std::sin(0.9 * 9.5), 1e-12);
  EXPECT_EQ(e.r.front(), 0.0);
  EXPECT_NEAR((e.r[1] - e.r[0]) / kPeriod, 0.0, 1e-6);
}

// The inertia of a light axis with much friction is hardly seen at the usual acceleration.
TEST(Excitation, TrianglesOfALightAxisAccelerateMore) {
  const double inertia = 9.5e-3;  // of 1 kg, 9.5 mm/s in one second [N]
  const AccelerationDesign usual = acceleration_design(kTable, 0.0, 1.0, 2.0 * inertia);
  const AccelerationDesign light = acceleration_design(kTable, 0.0, 1.0, 10.0 * inertia);
  EXPECT_EQ(usual.flank, 1.0);
  EXPECT_EQ(light.flank, 0.25);
  EXPECT_EQ(light.repeats, 4 * usual.repeats) << "a log of the same length";
}

// A limit of speed that the travel does not let the axis reach changes nothing.
TEST(Excitation, AHigherLimitOfSpeedMakesNoWeakerTriangles) {
  Limits limits{-0.02, 0.02, 0.25, 20.0, 100.0, false};
  const Excitation slow = design_constant_acceleration(limits, kPeriod, {});
  limits.speed = 15.0;
  const Excitation fast = design_constant_acceleration(limits, kPeriod, {});
  const auto largest = [](const Excitation& e) {
    double a = 0.0;
    for (std::size_t k = 1; k + 1 < e.r.size(); ++k)
      a = std::max(a, std::abs(e.r[k + 1] - 2.0 * e.r[k] + e.r[k - 1]));
    return a;
  };
  EXPECT_GE(largest(fast), 0.99 * largest(slow));
}

TEST(Excitation, TrianglesOfSpeedReturnAndAccelerateEvenly) {
  const Excitation e = design_constant_acceleration(kTable, kPeriod);
  EXPECT_NEAR(e.r.back(), 0.0, 1e-12);
  double largest = 0.0;
  int even = 0;
  for (std::size_t k = 1; k + 1 < e.r.size(); ++k) {
    const double a = (e.r[k + 1] - 2.0 * e.r[k] + e.r[k - 1]) / (kPeriod * kPeriod);
    largest = std::max(largest, std::abs(a));
    even += std::abs(std::abs(a) - 9.5e-3) < 1e-5;
  }
  EXPECT_LE(largest, 9.6e-3);  // 9.5 mm/s in one second
  EXPECT_GT(even, 0.85 * static_cast<double>(e.r.size()));
}

// 38 mm/s in the first second would be 50.1 mm/s², just above the limit.
TEST(Excitation, PositionSineBeginsAsSlowlyAsTheAccelerationPermits) {
  const Limits lazy{-0.3048, 0.3048, 0.0423, 0.05, 21645.0};
  const SineDesign design{0.0, 0.2032, 0.1875, 4, true};
  const Excitation e = design_sine(lazy, kPeriod, design);
  double largest = 0.0;
  for (std::size_t k = 1; k + 1 < e.r.size(); ++k)
    largest = std::max(largest, std::abs(e.r[k + 1] - 2.0 * e.r[k] + e.r[k - 1]) / (kPeriod * kPeriod));
  EXPECT_LE(largest, 0.05);
  EXPECT_GT(largest, 0.03);
  EXPECT_NEAR(*std::max_element(e.r.begin(), e.r.end()), 0.2032, 1e-5);
  EXPECT_NEAR(e.r.back(), 0.0, 1e-5);
}

// A linear motor with 150 mm to either side: one second to 143 mm/s would be 0.14 m/s², far below friction.
TEST(Excitation, TrianglesOfSpeedAreStrongInAShortTravelToo) {
  const Excitation e = design_constant_acceleration({-0.15, 0.15, 1.0, 15.0, 150.0}, kPeriod);
  double largest = 0.0;
  double fastest = 0.0;
  for (std::size_t k = 1; k + 1 < e.r.size(); ++k) {
    largest = std::max(largest, std::abs(e.r[k + 1] - 2.0 * e.r[k] + e.r[k - 1]) / (kPeriod * kPeriod));
    fastest = std::max(fastest, std::abs(e.r[k + 1] - e.r[k]) / kPeriod);
  }
  EXPECT_GT(largest, 2.0);
  EXPECT_LT(largest, 7.6);
  EXPECT_GT(fastest, 0.5);
  EXPECT_LT(*std::max_element(e.r.begin(), e.r.end()), 0.15);
  EXPECT_NEAR(e.r.back(), 0.0, 1e-12);
}

TEST(Excitation, RampKeepsToTheLimitsOfAnAxisThatSlips) {
  const Excitation e = design_ramp(kTable, kRough, kPeriod);
  EXPECT_NEAR(*std::max_element(e.force.begin(), e.force.end()), 1.3 * 1200.0, 1.0);
  EXPECT_NEAR(*std::min_element(e.force.begin(), e.force.end()), -1.3 * 1200.0, 1.0);
  RampDesign slow;
  slow.rise = 500.0;
  EXPECT_THAT(
      [&] {
        design_ramp(kTable, {60e3, 1200.0, 0.0}, kPeriod, slow);
      },
      ThrowsMessage<Refused>(HasSubstr("shorter rise")));
}

// The moves of the program add up to the table: ends of the ways and the time at the feeds.
TEST(Excitation, GcodeRepeatsTheTable) {
  const Excitation e = design_sine(kTable, kPeriod, {0.0, 0.010, 0.9, 1});
  const std::string code = as_gcode(e, "x", "table (test)");
  EXPECT_EQ(code.find("(test)"), std::string::npos);
  EXPECT_NE(code.find("G21 G90 G94 G64"), std::string::npos);
  std::istringstream in(code);
  double x = 0.0, time = 0.0, lowest = 0.0;
  for (std::string line; std::getline(in, line);) {
    double to = 0.0, feed = 0.0;
    if (std::sscanf(line.c_str(), "G1 X%lf F%lf", &to, &feed) == 2) {
      time += std::abs(to - x) / feed * 60.0;
      x = to;
      lowest = std::min(lowest, x);
    }
  }
  EXPECT_NEAR(x, e.r.back() * 1e3, 1e-6);
  EXPECT_NEAR(lowest, -20.0, 1e-3);
  EXPECT_NEAR(time, e.t.back(), 0.02 * e.t.back());
  EXPECT_THAT([&] { as_gcode(e, "spindle", "table"); },
              ThrowsMessage<Refused>(AllOf(HasSubstr("axis spindle has no letter of its own"),
                                           HasSubstr("rename the axis in the machine file"))));
  // The same arc at a radius of 1 m: 20 mm are 20 mrad.
  const std::string turned = as_gcode(e, "c", "table", GcodeUnit::kDegree);
  EXPECT_NE(turned.find("degrees per minute"), std::string::npos);
  double first = 1.0, last = 0.0, feed = 0.0;
  ASSERT_EQ(std::sscanf(turned.substr(turned.find("G0 C")).c_str(), "G0 C%lf", &first), 1);
  ASSERT_EQ(std::sscanf(turned.substr(turned.rfind("G1 C")).c_str(), "G1 C%lf F%lf", &last, &feed), 2);
  EXPECT_NEAR(first, e.r.front() * 57.29577951308232, 1e-6);
  EXPECT_NEAR(last, e.r.back() * 57.29577951308232, 1e-6);
  const Excitation pulses = design_pulses(kTable, kRough, kPeriod);
  EXPECT_THAT([&] { as_gcode(pulses, "x", "table"); }, ThrowsMessage<Refused>(HasSubstr("open loop")));
}

// X1=12.5 is a word of SINUMERIK, which has comments, units and dwells of its own besides.
TEST(Excitation, GcodeOfAnAxisWithANumberIsThatOfSinumerik) {
  const Excitation e = design_sine(kTable, kPeriod, {0.0, 0.010, 0.9, 1});
  const std::string plain = as_gcode(e, "x", "table");
  const std::string code = as_gcode(e, "X1", "table");
  std::istringstream a(plain), b(code);
  std::vector<std::string> moves, wanted;
  for (std::string line; std::getline(a, line);) {
    if (line.starts_with("G4 P")) line[3] = 'F';
    if (line.starts_with("G0 X") || line.starts_with("G1 X")) line.insert(4, "1=");
    if (!line.starts_with("(")) wanted.push_back(line);
  }
  for (std::string line; std::getline(b, line);)
    if (!line.starts_with("; ")) moves.push_back(line);
  std::replace(wanted.begin(), wanted.end(), std::string("G21 G90 G94 G64"), std::string("G710 G90 G94 G64"));
  std::replace(wanted.begin(), wanted.end(), std::string("G49"), std::string("G500 D0"));
  EXPECT_EQ(moves, wanted);
  EXPECT_EQ(code.find("; sine of axis X1, table\n"), 0u);
  EXPECT_NE(code.find("; for SINUMERIK; other controls, as LinuxCNC, know no axis X1\n"), std::string::npos);
  EXPECT_EQ(code.find_first_of("()"), std::string::npos);
  for (const char* none : {"1x", "x-1", "xx", "q1", "", "X1a"}) EXPECT_EQ(gcode_word(none), "") << none;
}

// Travel and free room are those of the machine: a work offset or a tool length of the last part would move all of it.
TEST(Excitation, GcodeIsInTheCoordinatesOfTheMachine) {
  const Excitation e = design_sine(kTable, kPeriod, {0.0, 0.010, 0.9, 1});
  const std::string plain = as_gcode(e, "z", "t"), sinumerik = as_gcode(e, "z1", "t");
  EXPECT_NE(plain.find("\nG49\nG21 "), std::string::npos);
  EXPECT_NE(plain.find("(positions are those of the machine: no work offset, G52, G92 or rotation may act"),
            std::string::npos);
  EXPECT_NE(sinumerik.find("\nG500 D0\nG710 "), std::string::npos);
  EXPECT_NE(sinumerik.find("; positions are those of the machine: G500 D0 switches"), std::string::npos);
  EXPECT_EQ(plain.find("G53"), std::string::npos) << "a rapid move in the dialects of Fanuc";
}

// A lathe that counts X in diameter would move half as far.
TEST(Excitation, GcodeOfXSaysThatItIsNoDiameter) {
  const Excitation e = design_sine(kTable, kPeriod, {0.0, 0.010, 0.9, 1});
  EXPECT_NE(as_gcode(e, "x", "t").find("diameter programming off before, LinuxCNC G8, SINUMERIK DIAMOF)\n"),
            std::string::npos);
  EXPECT_NE(as_gcode(e, "x2", "t").find("diameter programming off before, DIAMOF\n"), std::string::npos);
  EXPECT_EQ(as_gcode(e, "z", "t").find("DIAMOF"), std::string::npos);
  EXPECT_EQ(as_gcode(e, "x", "t", GcodeUnit::kDegree).find("DIAMOF"), std::string::npos);
}

TEST(Multisine, RepeatsWithItsPeriodAndNeverReversesWhileItIsMeasured) {
  MultisineDesign design;
  design.repeats = 2;
  const Limits limits{-0.075, 0.075, 10e-3, 0.2, 10480.0};
  const double T = 5e-3;
  const Excitation e = design_multisine(limits, {57650.0, 1000.0, 0.0}, T, design);
  const std::size_t period = 400;  // 2 s
  // In the middle of every stroke the increments repeat, and they have one sign.
  std::size_t measured = 0;
  for (std::size_t k = 1; k + period + 1 < e.r.size(); ++k) {
    const double now = e.r[k + 1] - e.r[k];
    const double later = e.r[k + period + 1] - e.r[k + period];
    if (now == 0.0 || std::abs(now - later) > 1e-12) continue;
    EXPECT_GE(std::abs(now) / T, 1.9e-3);  // half the ride of 4 mm/s, less a rounding of the line's speed
    EXPECT_LE(std::abs(now) / T, limits.speed);
    ++measured;
  }
  EXPECT_GE(measured, 4 * 3 * period);  // three of four periods of each stroke have a next one
  for (std::size_t k = 1; k + 1 < e.r.size(); ++k)
    ASSERT_LE(std::abs(e.r[k + 1] - 2.0 * e.r[k] + e.r[k - 1]) / (T * T), limits.acceleration);
  // The strokes lie about the middle of the travel.
  const auto [low, high] = std::minmax_element(e.r.begin(), e.r.end());
  EXPECT_NEAR(*low, -*high, 1e-3);
  EXPECT_NE(e.says.find("4 strokes at 4.00 mm/s"), std::string::npos) << e.says;
}

TEST(Multisine, RefusesADriveThatFrictionUsesUp) {
  EXPECT_THAT(
      [&] {
        design_multisine({-0.1, 0.1, 0.01, 0.2, 900.0}, {100.0, 1000.0, 0.0}, 1e-3);
      },
      ThrowsMessage<Refused>(HasSubstr("no force is left")));
}

}  // namespace
}  // namespace stribeck::ident::excitation::excitation_test
