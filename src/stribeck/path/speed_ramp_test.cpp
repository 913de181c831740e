#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stribeck/path/speed_ramp.hpp>
#include <utility>

namespace stribeck::path::speed_ramp_test {
namespace {

constexpr double kRounding = 1e-12;
constexpr double kSearch = 1e-9;  ///< of bisections in 60 steps

/// What a phase has come to after so much time: constant jerk, integrated.
FeedPhase after(FeedPhase p, double t) {
  p.s += t * p.speed + t * t * p.acceleration / 2.0 + t * t * t * p.jerk / 6.0;
  p.speed += t * p.acceleration + t * t * p.jerk / 2.0;
  p.acceleration += t * p.jerk;
  p.time += t;
  return p;
}

TEST(SpeedRamp, HoldsTheAccelerationBetweenTwoJerks) {
  // 0.2 s of jerk come to 2 m/s² and 0.2 m/s, as at the end; 0.6 m/s are left for 2 m/s².
  const SpeedRamp up(0.0, 1.0, 2.0, 10.0);
  EXPECT_NEAR(up.jerk_time, 0.2, kRounding);
  EXPECT_NEAR(up.hold_time, 0.3, kRounding);
  EXPECT_NEAR(up.duration(), 0.7, kRounding);
  EXPECT_NEAR(up.distance(), 0.35, kRounding);  // at 0.5 m/s on average
  const auto p = up.phases(5.0, 3.0);
  EXPECT_EQ(p[0].time, 5.0);
  EXPECT_EQ(p[0].s, 3.0);
  EXPECT_NEAR(p[1].time, 5.2, kRounding);
  EXPECT_NEAR(p[1].speed, 0.2, kRounding);
  EXPECT_NEAR(p[1].acceleration, 2.0, kRounding);
  EXPECT_NEAR(p[2].time, 5.5, kRounding);
  EXPECT_NEAR(p[2].speed, 0.8, kRounding);
}

TEST(SpeedRamp, StaysBelowTheAccelerationWhereTheChangeIsSmall) {
  // 0.1 s of jerk come to half of the change, at 1 of 2 m/s².
  const SpeedRamp down(0.4, 0.3, 2.0, 10.0);
  EXPECT_NEAR(down.jerk_time, 0.1, kRounding);
  EXPECT_EQ(down.hold_time, 0.0);
  EXPECT_NEAR(down.distance(), 0.07, kRounding);
  EXPECT_NEAR(down.phases(0.0, 0.0)[1].acceleration, -1.0, kRounding);
  EXPECT_EQ(SpeedRamp(0.4, 0.4, 2.0, 10.0).duration(), 0.0);
}

TEST(SpeedRamp, PhasesFollowEachOtherAndEndAtTheSpeedAskedFor) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> speed(0.0, 2.0);
  std::uniform_real_distribution<double> most(0.5, 20.0);
  for (int n = 0; n < 200; ++n) {
    const double from = speed(random);
    const double to = speed(random);
    const double a = most(random);
    const double j = 5.0 * most(random);
    const SpeedRamp ramp(from, to, a, j);
    const auto p = ramp.phases(1.0, 2.0);
    EXPECT_EQ(p[0].speed, from);
    EXPECT_EQ(p[0].acceleration, 0.0);
    const double lengths[] = {ramp.jerk_time, ramp.hold_time, ramp.jerk_time};
    for (std::size_t i = 0; i < 3; ++i) {
      const FeedPhase end = after(p[i], lengths[i]);
      EXPECT_LE(std::abs(end.acceleration), a * (1.0 + kRounding)) << n;
      EXPECT_LE(std::abs(p[i].jerk), j) << n;
      const FeedPhase next =
          i < 2 ? p[i + 1] : FeedPhase{1.0 + ramp.duration(), 2.0 + ramp.distance(), to, 0.0, 0.0};
      EXPECT_NEAR(end.time, next.time, kRounding) << n;
      EXPECT_NEAR(end.s, next.s, kRounding) << n;
      EXPECT_NEAR(end.speed, next.speed, kRounding) << n;
      EXPECT_NEAR(end.acceleration, next.acceleration, 100.0 * kRounding) << n;
    }
  }
}

TEST(SpeedAfter, IsTheSpeedAtThatPlaceInEveryPhase) {
  for (const SpeedRamp& ramp :
       {SpeedRamp(0.1, 1.0, 2.0, 10.0), SpeedRamp(1.0, 0.3, 2.0, 10.0), SpeedRamp(0.2, 0.3, 2.0, 10.0)}) {
    const auto p = ramp.phases(0.0, 0.0);
    const double lengths[] = {ramp.jerk_time, ramp.hold_time, ramp.jerk_time};
    for (std::size_t i = 0; i < 3; ++i) {
      for (const double share : {0.1, 0.5, 0.9}) {
        const FeedPhase there = after(p[i], share * lengths[i]);
        EXPECT_NEAR(speed_after(ramp, there.s), there.speed, kSearch) << i << ' ' << share;
      }
    }
    EXPECT_NEAR(speed_after(ramp, 0.0), ramp.from, kSearch);
    EXPECT_NEAR(speed_after(ramp, ramp.distance()), ramp.to, kSearch);
  }
}

TEST(Reachable, IsTheSpeedWhoseRampFillsTheDistance) {
  const double distance = SpeedRamp(0.2, 1.0, 2.0, 10.0).distance();
  EXPECT_NEAR(reachable(0.2, distance, 3.0, 2.0, 10.0), 1.0, kSearch);
  EXPECT_EQ(reachable(0.2, distance, 0.7, 2.0, 10.0), 0.7);
  EXPECT_EQ(reachable(0.2, distance, 1.0, 2.0, 10.0), 1.0);
  // Where the distance is nothing, or the speed is too high already.
  EXPECT_NEAR(reachable(0.2, 0.0, 3.0, 2.0, 10.0), 0.2, kSearch);
  EXPECT_EQ(reachable(0.9, distance, 0.7, 2.0, 10.0), 0.9);
}

TEST(Reachable, BetweenTwoSpeedsIsTheOneWhoseRampsFillTheDistance) {
  const double distance =
      SpeedRamp(0.2, 1.0, 2.0, 10.0).distance() + SpeedRamp(1.0, 0.5, 2.0, 10.0).distance();
  EXPECT_NEAR(reachable_between(0.2, 0.5, distance, 3.0, 2.0, 10.0), 1.0, kSearch);
  EXPECT_NEAR(reachable_between(0.5, 0.2, distance, 3.0, 2.0, 10.0), 1.0, kSearch);
  EXPECT_EQ(reachable_between(0.2, 0.5, distance, 0.8, 2.0, 10.0), 0.8);
  EXPECT_EQ(reachable_between(0.2, 0.5, distance, 0.4, 2.0, 10.0), 0.5);
  EXPECT_EQ(reachable_between(0.6, 0.5, distance, 0.4, 2.0, 10.0), 0.6);
}

TEST(SpeedRamp, ARampThatIsNoneTakesNoTimeAndNoWay) {
  const SpeedRamp none;
  EXPECT_EQ(none.duration(), 0.0);
  EXPECT_EQ(none.distance(), 0.0);
  for (const FeedPhase& phase : none.phases(3.0, 0.2)) {
    EXPECT_EQ(phase.time, 3.0);
    EXPECT_EQ(phase.s, 0.2);
    EXPECT_EQ(phase.speed, 0.0);
    EXPECT_EQ(phase.acceleration, 0.0);
    EXPECT_EQ(phase.jerk, 0.0);
  }
}

TEST(SpeedRamp, ReachesExactlyWhatTheDistancePermits) {
  // From the answer back: the ramps up to the speed that is reachable take the whole distance.
  for (const double v : {0.0, 0.3}) {
    for (const double way : {0.05, 0.4}) {
      const double up = reachable(v, way, 5.0, 2.0, 10.0);
      EXPECT_NEAR(SpeedRamp(v, up, 2.0, 10.0).distance(), way, 1e-12);
      for (const double end : {0.0, 0.1}) {
        const double between = reachable_between(v, end, way, 5.0, 2.0, 10.0);
        if (between > std::max(v, end)) {
          EXPECT_NEAR(
              SpeedRamp(v, between, 2.0, 10.0).distance() + SpeedRamp(between, end, 2.0, 10.0).distance(),
              way, 1e-12);
        }
      }
    }
  }
  EXPECT_EQ(reachable(0.3, 10.0, 0.8, 2.0, 10.0), 0.8);
  EXPECT_EQ(reachable(0.3, 10.0, 0.2, 2.0, 10.0), 0.3) << "no slower than it is";
  EXPECT_EQ(reachable_between(0.3, 0.1, 10.0, 0.8, 2.0, 10.0), 0.8);
  EXPECT_EQ(reachable_between(0.3, 0.4, 10.0, 0.2, 2.0, 10.0), 0.4);
}

TEST(SpeedRamp, WhoIsFasterThanPermittedStaysAsFast) {
  // The ramp is for going faster: whatever the way, and however slow the end.
  for (const double way : {1e-6, 0.01, 10.0}) {
    EXPECT_EQ(reachable(0.3, way, 0.2, 2.0, 10.0), 0.3) << way;
    EXPECT_EQ(reachable_between(0.3, 0.1, way, 0.2, 2.0, 10.0), 0.3) << way;
    EXPECT_EQ(reachable_between(0.1, 0.3, way, 0.2, 2.0, 10.0), 0.3) << way;
  }
}

TEST(SpeedRamp, AfterAnyPartOfItsWayItHasTheSpeedOfThatPart) {
  // Against the phases, which say time, way and speed.
  for (const auto& [from, to] : {std::pair{0.0, 1.0}, std::pair{1.0, 0.2}, std::pair{0.4, 0.5}}) {
    const SpeedRamp ramp(from, to, 2.0, 10.0);
    for (const FeedPhase& phase : ramp.phases(0.0, 0.0)) {
      if (phase.s > 0.0) {
        EXPECT_NEAR(speed_after(ramp, phase.s), phase.speed, 1e-9);
      }
    }
    EXPECT_NEAR(speed_after(ramp, ramp.distance()), to, 1e-9);
    EXPECT_NEAR(speed_after(ramp, 0.0), from, 1e-9);
  }
}

}  // namespace
}  // namespace stribeck::path::speed_ramp_test
