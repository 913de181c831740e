// Supervision through the C interface, on a plant that shares no code with Stribeck's (other_machine.hpp).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "other_machine.hpp"

namespace stribeck::test::other_plant_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kWhen = 2.0;

class Machine : public testing::TestWithParam<const char*>, protected OtherMachine {
 protected:
  Machine() : OtherMachine(GetParam()) {}
  void TearDown() override { EXPECT_TRUE(good) << "a force that is no number or above the limit"; }
};

TEST_P(Machine, SoundItIsNeverStoppedAndNothingIsBridged) {
  run_to(15.0);
  EXPECT_EQ(why().fault, STRIBECK_FAULT_NONE) << stribeck_fault_describe(why().fault);
  EXPECT_EQ(signals(0).bridged, 0u);
}

TEST_P(Machine, WildSamplesOfAnySizeMoveNothing) {
  run_to(kWhen);
  const double before = worst_to(4.0);
  limited = false;
  double when = 4.0;
  for (const double size : {3e-6, 1e-3, 1.0, 1e15, 1e300, kNan}) {
    encoder = [=](double t, std::size_t i, double x) {
      return i == 0 && std::abs(t - when) < 0.5 * kPeriod ? x + size : x;
    };
    EXPECT_LT(worst_to(when + 0.2), before + 20e-6) << size;
    EXPECT_LT(worst_to(when + 0.5), 1.2 * before) << size;
    when += 0.5;
  }
  EXPECT_FALSE(limited);
  EXPECT_EQ(why().fault, STRIBECK_FAULT_NONE);
}

TEST_P(Machine, ALostEncoderStopsWithinAMillimetre) {
  run_to(kWhen);
  encoder = [](double, std::size_t, double) { return kNan; };
  EXPECT_LT(moved_to(kWhen + 1.0), 1e-3);
  EXPECT_EQ(why().fault, STRIBECK_FAULT_ENCODER_LOST);
  EXPECT_EQ(force[0], 0.0);
  EXPECT_EQ(force[1], 0.0);
}

TEST_P(Machine, AFrozenEncoderStopsWithinTwoMillimetres) {
  run_to(kWhen);
  const double held[2] = {axis[0].encoder(), axis[1].encoder()};
  encoder = [=](double, std::size_t i, double) { return held[i]; };
  EXPECT_LT(moved_to(kWhen + 1.0), 2e-3);
  EXPECT_EQ(result, STRIBECK_FAULT);
}

TEST_P(Machine, AWrongSignIsSeenWithinHalfAMillimetre) {
  // The second axis moves first: the circle begins at the end of the first one.
  acts = [](double, std::size_t i, double f) { return i == 1 ? -f : f; };
  run_to(0.001);
  const double from = axis[1].x;
  run_to(2.0);
  EXPECT_LT(std::abs(axis[1].x - from), 0.5e-3);
  EXPECT_EQ(why().fault, STRIBECK_FAULT_WRONG_SIGN) << stribeck_fault_describe(why().fault);
  EXPECT_FALSE(limited);
}

INSTANTIATE_TEST_SUITE_P(Laws, Machine,
                         testing::Values("contouring", "sliding-mode", "predictive", "learning"),
                         [](const auto& law) {
                           std::string name = law.param;
                           std::erase(name, '-');
                           return name;
                         });

}  // namespace
}  // namespace stribeck::test::other_plant_test
