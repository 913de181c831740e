#include <gtest/gtest.h>

#include <stribeck/workflow/commissioning/sign.hpp>

namespace stribeck::workflow::commissioning::sign_test {
namespace {

/// A command of 50 um after ten rows; the encoder follows by `share` of it, with one step of it up and down.
AxisRows rows_of(double share, double step = 0.0) {
  AxisRows rows;
  for (int k = 0; k < 60; ++k) {
    const double r = k < 10 ? 0.0 : std::min(50e-6, (k - 9) * 5e-6);
    rows.r.push_back(r);
    rows.x.push_back(share * r + (k % 2 == 0 ? step : 0.0));
    rows.f.push_back(100.0 * r / 50e-6);
  }
  return rows;
}

TEST(SignTest, IsThatOfTheMotion) {
  EXPECT_EQ(judge_sign(rows_of(1.0), 1e-7).sign, Sign::kRight);
  EXPECT_EQ(judge_sign(rows_of(-1.0), 1e-7).sign, Sign::kWrong);
  // In its bristles alone: 1 um of 50.
  EXPECT_EQ(judge_sign(rows_of(0.02), 1e-7).sign, Sign::kRight);
  EXPECT_EQ(judge_sign(rows_of(-0.02), 1e-7).sign, Sign::kWrong);
  EXPECT_NEAR(judge_sign(rows_of(0.02), 1e-7).moved, 1e-6, 1e-12);
  EXPECT_NEAR(judge_sign(rows_of(0.02), 1e-7).force, 100.0, 1e-9);
}

TEST(SignTest, IsNotSeenWithinFourStepsOrTheScatter) {
  EXPECT_EQ(judge_sign(rows_of(0.0), 1e-7).sign, Sign::kNotSeen);
  EXPECT_EQ(judge_sign(rows_of(0.02), 0.3e-6).sign, Sign::kNotSeen) << "1 um is less than four steps";
  EXPECT_EQ(judge_sign(rows_of(0.02), 0.0).sign, Sign::kRight) << "the step comes from the rows";
  // Standard deviation 0.53 um, of which five are more than the motion.
  EXPECT_EQ(judge_sign(rows_of(0.02, 1e-6), 1e-7).sign, Sign::kNotSeen);
  EXPECT_EQ(judge_sign({}, 1e-7).sign, Sign::kNotSeen);
}

TEST(SignTest, HoldsWhereTheMachineSwitchedOff) {
  AxisRows rows = rows_of(-0.5);
  // From then on the command is where the axis is.
  for (int k = 0; k < 200; ++k) {
    rows.r.push_back(-60e-6);
    rows.x.push_back(-60e-6);
    rows.f.push_back(0.0);
  }
  const SignTest test = judge_sign(rows, 1e-7);
  EXPECT_EQ(test.sign, Sign::kWrong);
  EXPECT_NEAR(test.moved, -25e-6, 1e-9);
  EXPECT_NEAR(test.farthest, 60e-6, 1e-9);
}

}  // namespace
}  // namespace stribeck::workflow::commissioning::sign_test
