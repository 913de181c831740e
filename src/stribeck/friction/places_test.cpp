#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stribeck/friction/model.hpp>
#include <string>

namespace stribeck::friction::places_test {
namespace {

Places two() {
  Places p;
  p.push_back({-0.01, 0.8, 1.5});
  p.push_back({0.03, 1.2, 0.5});
  return p;
}

TEST(Places, AreJoinedByStraightLinesAndHoldBeyondTheEnds) {
  const Places p = two();
  EXPECT_DOUBLE_EQ(shares_at(p, 0.01).level, 1.0);
  EXPECT_DOUBLE_EQ(shares_at(p, 0.01).stiffness, 1.0);
  EXPECT_DOUBLE_EQ(shares_at(p, 0.0).level, 0.9);
  EXPECT_DOUBLE_EQ(shares_at(p, -1.0).level, 0.8);
  EXPECT_DOUBLE_EQ(shares_at(p, 1.0).stiffness, 0.5);
}

TEST(Places, NoneOrOneIsTheSameEverywhere) {
  EXPECT_EQ(shares_at({}, 0.3).level, 1.0);
  Places one;
  one.push_back({0.1, 0.7, 1.3});
  for (const double x : {-1.0, 0.1, 1.0}) EXPECT_EQ(shares_at(one, x).level, 0.7) << x;
}

TEST(Places, ScaleTheLevelAndLeaveTheRest) {
  Model model;
  Conventional<double> map;
  map.alpha0 = 20.0;
  map.alpha2 = 300.0;
  model.steady = map;
  model.eccentric.push_back({2.0, 5e-3, 0.4, EccentricForm::kAdditive});
  const SteadyParts<double> plain = model.parts(0.02, -1.0);
  model.places = two();
  const SteadyParts<double> placed = model.parts(0.02, -1.0);
  EXPECT_DOUBLE_EQ(placed.level, 0.8 * plain.level);
  EXPECT_EQ(placed.viscous, plain.viscous);
  EXPECT_EQ(placed.additive, plain.additive);
  // What loops run on says the same as what files hold.
  const Composed<Conventional<double>> whole = composed(map, model);
  EXPECT_EQ(whole.parts(0.02, 0.013).level, model.parts(0.02, 0.013).level);
  EXPECT_EQ(whole.near(0.02).parts(0.02, 0.013).level, model.parts(0.02, 0.013).level);
}

TEST(Places, MustAscend) {
  Model model;
  model.places.push_back({0.1, 1.0, 1.0});
  model.places.push_back({0.1, 1.1, 1.0});
  std::string said;
  model.validate([&](const char* key, const char* what) { said += std::string(key) + ": " + what; });
  EXPECT_EQ(said, "places: positions must ascend");
}

TEST(Places, MustAscendAllTheWay) {
  const auto complaints = [](const std::vector<double>& positions) {
    Model m;
    for (const double x : positions) m.places.push_back({x, 1.0, 1.0});
    int count = 0;
    m.validate([&](std::string_view key, std::string_view) { count += key == "places" ? 1 : 0; });
    return count;
  };
  EXPECT_EQ(complaints({0.0, 5e-3, 9e-3}), 0);
  EXPECT_EQ(complaints({-9e-3, 5e-3, 3e-3}), 1);
  EXPECT_EQ(complaints({5e-3, 0.0, 9e-3}), 1);
}

}  // namespace
}  // namespace stribeck::friction::places_test
