#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stribeck/friction/model.hpp>
#include <stribeck/friction/spring.hpp>
#include <string>

namespace stribeck::friction::spring_test {
namespace {

TEST(Spring, PullsBackToWhereItsForceIsZeroAndStaysBeyondItsEnds) {
  const Spring s{2000.0, 0.1, 0.05, 0.3};
  EXPECT_DOUBLE_EQ(s.at(0.1), 0.0);
  EXPECT_DOUBLE_EQ(s.at(0.2), 200.0);
  EXPECT_DOUBLE_EQ(s.at(0.06), -80.0);
  EXPECT_DOUBLE_EQ(s.at(0.0), -100.0);
  EXPECT_DOUBLE_EQ(s.at(0.4), 400.0);
  const Spring endless{2000.0, 0.1};
  EXPECT_DOUBLE_EQ(endless.at(5.1), 10000.0);
  EXPECT_DOUBLE_EQ(endless.at(-4.9), -10000.0);
}

TEST(Spring, IsTheSameInEitherDirectionAndAtRest) {
  Model model;
  Conventional<double> map;
  map.alpha0 = 20.0;
  map.alpha2 = 300.0;
  model.steady = map;
  model.spring = Spring{1000.0, 0.02};
  for (const double v : {0.1, -0.1, 0.0}) {
    EXPECT_DOUBLE_EQ(model.parts(v, 0.05).additive, 30.0);
    EXPECT_DOUBLE_EQ(model.parts(v, 0.05).level, map.parts(v, 0.0).level);
    // What loops run on.
    const Composed<Conventional<double>> whole = composed(map, model);
    EXPECT_DOUBLE_EQ(whole.parts(v, 0.05).additive, 30.0);
    EXPECT_DOUBLE_EQ(whole.near(v).parts(v, 0.05).additive, 30.0);
  }
}

TEST(Spring, ItsEndsAscend) {
  std::string said;
  const auto report = [&](const char* key, const char* what) { said += std::string(key) + " " + what; };
  Spring{1.0, 0.0, 0.2, 0.3}.validate(report);
  Spring{1.0, 0.0, {}, 0.3}.validate(report);
  Spring{1.0, 0.0, 0.2, {}}.validate(report);
  EXPECT_EQ(said, "");
  Spring{1.0, 0.0, 0.3, 0.3}.validate(report);
  EXPECT_EQ(said, "to must be above from");
}

}  // namespace
}  // namespace stribeck::friction::spring_test
