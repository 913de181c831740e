#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <stribeck/core/scalar.hpp>
#include <stribeck/targets/pulse/pulse_target.hpp>
#include <stribeck/targets/pulse/test_export.hpp>

namespace stribeck::test::circle_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// A circle of two axes with 20 N of friction, as the command takes it.
targets::PulseTask task_of(const PulseExport& x) {
  return targets::pulse_task(
      "tnc", [](std::size_t axis) { return std::string(1, "xy"[axis]); }, x.request);
}

/// Forces of this level by direction.
std::array<targets::TableForce, 2> level(double newtons) {
  const auto force = [newtons](double v) { return newtons * sign(v); };
  return {targets::TableForce{force}, targets::TableForce{force}};
}

TEST(Circle, APeakThatIsTurnedRoundIsInTheDeviationWithBothSides) {
  const PulseExport x("tnc", kBristles);
  targets::UserCircle c = targets::user_circle(task_of(x));
  // Without compensation, all peaks are on one side of a circle that is round between them.
  EXPECT_NEAR(c.without.deviation, c.without.largest, 0.3 * c.without.largest);
  const targets::CircleError strong = c.circle.with(level(40.0));
  EXPECT_GT(strong.deviation, 1.2 * strong.largest);
  EXPECT_LT(c.model.deviation, 0.1 * c.without.deviation);
}

TEST(Circle, WordsWarnOfALessRoundCircle) {
  const PulseExport x("tnc", kBristles);
  const targets::PulseTask task = task_of(x);
  const targets::UserCircle c = targets::user_circle(task);
  const auto words = [&](double quadrant, double deviation) {
    return targets::circle_words(
        task, c, "this pulse",
        {quadrant * c.without.quadrant, c.without.largest, deviation * c.without.deviation});
  };
  EXPECT_THAT(words(0.5, 0.9), Not(HasSubstr("Warning")));
  EXPECT_THAT(words(0.5, 1.1),
              HasSubstr("Warning: the circular deviation is no smaller with it than without"));
  EXPECT_THAT(words(1.1, 1.1), HasSubstr("Warning: with it the peaks are larger than without"));
}

}  // namespace
}  // namespace stribeck::test::circle_test
