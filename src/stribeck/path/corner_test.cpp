#include <gtest/gtest.h>

#include <cmath>
#include <stribeck/path/corner.hpp>

namespace stribeck::path::corner_test {
namespace {

using Two = Vec<double, 2>;

TEST(Corner, HalfItsAngleComesFromTheDirectionsOnEitherSide) {
  const Two along{{1.0, 0.0}};
  for (const double degrees : {0.0, 20.0, 90.0, 150.0, 180.0}) {
    const double turn = degrees * kPi / 180.0;
    const HalfTurn half = half_turn(along, Two{{std::cos(turn), std::sin(turn)}});
    EXPECT_NEAR(half.sine, std::sin(0.5 * turn), 1e-15) << degrees;
    EXPECT_NEAR(half.cosine, std::cos(0.5 * turn), 1e-15) << degrees;
  }
}

TEST(Corner, ABlendOfTheLengthForADeviationHasIt) {
  for (const double sine : {0.1, 0.7, 1.0})
    EXPECT_NEAR(blend_deviation(blend_length(5e-6, sine), sine), 5e-6, 1e-18);
}

TEST(Corner, TwiceTheBlendIsTwiceAsFarFromTheCorner) {
  for (const double sine : {0.1, 0.7, 1.0}) {
    EXPECT_DOUBLE_EQ(blend_deviation(4e-3, sine), 2.0 * blend_deviation(2e-3, sine));
    EXPECT_DOUBLE_EQ(blend_length(4e-6, sine), 2.0 * blend_length(2e-6, sine));
    EXPECT_DOUBLE_EQ(blend_length(2e-6, 0.5 * sine), 2.0 * blend_length(2e-6, sine));
  }
}

}  // namespace
}  // namespace stribeck::path::corner_test
