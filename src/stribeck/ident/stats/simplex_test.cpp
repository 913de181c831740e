#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/stats/simplex.hpp>

namespace stribeck::ident::stats::simplex_test {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

double valley(const std::vector<double>& x) {
  return 100.0 * std::pow(x[1] - x[0] * x[0], 2.0) + std::pow(1.0 - x[0], 2.0);
}

// Closed form: Rosenbrock's valley has its minimum 0 at (1, 1).
TEST(Simplex, FindsTheEndOfRosenbrocksValley) {
  const SimplexResult r = minimise_simplex(valley, {-1.2, 1.0}, {0.1, 0.1});
  EXPECT_TRUE(r.converged);
  EXPECT_NEAR(r.x[0], 1.0, 1e-6);
  EXPECT_NEAR(r.x[1], 1.0, 1e-6);
}

TEST(Simplex, SaysWhenTheEvaluationsAreUsedUp) {
  const SimplexResult r = minimise_simplex(valley, {-1.2, 1.0}, {0.1, 0.1}, {1e-10, 20});
  EXPECT_FALSE(r.converged);
  EXPECT_LE(r.evaluations, 20);
}

// Where f is not a number the simplex turns back.
TEST(Simplex, KeepsAwayFromWhatIsNotANumber) {
  const SimplexResult r =
      minimise_simplex([](const std::vector<double>& x) { return x[0] - std::log(x[0]); }, {0.1}, {0.5});
  EXPECT_NEAR(r.x[0], 1.0, 1e-4);
}

TEST(Simplex, RefusesAStartThatIsNotFinite) {
  EXPECT_THAT(
      [&] { minimise_simplex([](const std::vector<double>&) { return std::nan(""); }, {1.0}, {1.0}); },
      ThrowsMessage<Refused>(HasSubstr("a start where the function is finite")));
}

}  // namespace
}  // namespace stribeck::ident::stats::simplex_test
