#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <stribeck/core/scalar.hpp>
#include <stribeck/targets/pulse/pulse_target.hpp>
#include <stribeck/targets/pulse/test_export.hpp>
#include <utility>
#include <variant>
#include <vector>

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

// A list of gains is in the order of the axes x, y, z: the files may be given in another one.
TEST(Circle, EachAxisHasItsOwnGains) {
  const PulseExport x("tnc", kBristles);
  targets::PulseTask task = task_of(x);
  friction::AxisModel heavy = task.axes[0];
  heavy.mass *= 4.0;
  const friction::AxisModel light = task.axes[0];
  auto& law = std::get<control::CascadeParams>(task.loop.law);
  const auto peak = [&](std::vector<std::size_t> numbers, const control::PerAxis& position_gain) {
    task.axes = {heavy, light};
    task.numbers = std::move(numbers);
    law.position_gain = position_gain;
    return targets::user_circle(task).without.quadrant;
  };
  const double in_order = peak({0, 1}, {20.0, 40.0});
  EXPECT_NEAR(peak({1, 0}, {40.0, 20.0}), in_order, 1e-12);
  // More gains than files: y and z have the second and the third.
  EXPECT_NEAR(peak({1, 2}, {80.0, 20.0, 40.0}), in_order, 1e-12);
  EXPECT_GT(std::abs(peak({0, 1}, {40.0, 20.0}) - in_order), 1e-6);
}

}  // namespace
}  // namespace stribeck::test::circle_test
