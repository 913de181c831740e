#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include <stribeck/ident/log/mixed_runs.hpp>
#include <stribeck/ident/log/test_runs.hpp>

namespace stribeck::ident::log::mixed_runs_test {
namespace {

using test::steady_runs;
using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(MixedRuns, TwoDaysAreSaid) {
  const auto law = [](double v) { return 10.0 + 40.0 * v; };
  const auto found =
      warn_of_mixed_runs(steady_runs([&](double v) { return law(v) + (v < 4.5e-3 ? 3.0 : 0.0); }, true));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].kind, "mixed-runs");
  EXPECT_THAT(found[0].text,
              AllOf(HasSubstr("different days"), HasSubstr("between 4 mm/s and 5 mm/s"), HasSubstr("v < 0")));
  EXPECT_NEAR(found[0].values.at(3), -3.0, 0.2);
}

TEST(MixedRuns, OneDayIsNot) {
  // Other lengths alone, or a steep low-speed part alone, are no second day.
  EXPECT_TRUE(warn_of_mixed_runs(steady_runs([](double v) { return 10.0 + 40.0 * v; }, true)).empty());
  EXPECT_TRUE(warn_of_mixed_runs(steady_runs([](double v) { return 10.0 + 5.0 * std::exp(-v / 4e-3); }, true))
                  .empty());
  EXPECT_TRUE(warn_of_mixed_runs(steady_runs([](double v) { return 10.0 + (v < 4.5e-3 ? 3.0 : 0.0); }, false))
                  .empty());
}

// Invariance: a machine that counts in the other direction has the same two days.
TEST(MixedRuns, MirroredRunsAreTheSameTwoDays) {
  auto runs = steady_runs([](double v) { return 10.0 + 40.0 * v + (v < 4.5e-3 ? 3.0 : 0.0); }, true);
  const auto before = warn_of_mixed_runs(runs);
  for (Record& r : runs) {
    for (auto* column : {&r.x, &r.f}) {
      for (double& value : *column) value = -value;
    }
  }
  const auto after = warn_of_mixed_runs(runs);
  ASSERT_EQ(before.size(), 1U);
  ASSERT_EQ(after.size(), 1U);
  EXPECT_NEAR(after[0].values.at(3), before[0].values.at(3), 0.2);
}

// The same jump between two sampling times: what differs is not the length of the runs alone.
TEST(MixedRuns, OtherSamplingIsAnotherDayToo) {
  auto runs = steady_runs([](double v) { return 10.0 + (v < 4.5e-3 ? 3.0 : 0.0); }, false);
  EXPECT_TRUE(warn_of_mixed_runs(runs).empty());
  for (Record& r : runs) {
    if (std::abs(r.x[1]) > 0.9 * 5e-3 * r.sample_time) continue;
    r.sample_time *= 1.5;
    for (double& t : r.t) t *= 1.5;
    for (double& x : r.x) x *= 1.5;
  }
  EXPECT_EQ(warn_of_mixed_runs(runs).size(), 1U);
}

}  // namespace
}  // namespace stribeck::ident::log::mixed_runs_test
