#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/bristle/place_stiffness.hpp>

namespace stribeck::ident::bristle::place_stiffness_test {
namespace {

constexpr double kMass = 400.0, kLevel = 60.0, kSigma0 = 3e7, kPeriod = 1e-3;

double stiffness(double x) { return 1.0 + 10.0 * x; }  // 0.7 to 1.3 over ±30 mm

friction::AxisModel known() {
  friction::AxisModel model;
  model.mass = kMass;
  friction::Conventional<double> map;
  map.alpha0 = kLevel;
  model.friction.steady = map;
  friction::LuGre<double> law;
  law.sigma0 = kSigma0;
  model.friction.dynamics = law;
  for (const double x : {-0.03, -0.01, 0.01, 0.03}) model.friction.places.push_back({x, 1.0, 1.0});
  return model;
}

/// Position is given, the force follows: to and fro by 1 mm about places over ±30 mm. Own integration of the bristle, ten steps in a row.
log::Record record(const std::function<double(double)>& share, double noise) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal(0.0, noise);
  log::Record rec;
  rec.source = "formula";
  rec.sample_time = kPeriod;
  double z = 0.0, carried = 0.0;
  constexpr int kParts = 50;
  const auto position = [](double t) { return 0.03 * std::sin(0.05 * t) + 1e-3 * std::sin(4.0 * t); };
  const auto force = [&](double t) {
    double sum = 0.0;
    for (int i = 0; i < kParts; ++i) {
      const double h = kPeriod / kParts, at = t + (i + 0.5) * h;
      const double v = 0.03 * 0.05 * std::cos(0.05 * at) + 4e-3 * std::cos(4.0 * at);
      const double a = -0.03 * 0.0025 * std::sin(0.05 * at) - 16e-3 * std::sin(4.0 * at);
      const double s = kSigma0 * share(position(at));
      // The force of the bristle continues when its stiffness changes.
      z = carried / s;
      z += h * (v - s * std::abs(v) / kLevel * z);
      carried = s * z;
      sum += (kMass * a + carried) / kParts;
    }
    return sum;
  };
  for (int k = 0; k < 125'000; ++k) {
    const double t = k * kPeriod;
    rec.t.push_back(t);
    rec.x.push_back(position(t));
    rec.f.push_back(force(t) + normal(random));
  }
  return rec;
}

TEST(PlaceStiffness, IsFoundFromTheReversalsNearEachPlace) {
  const PlaceStiffness found = fit_place_stiffness({record(stiffness, 0.3)}, known(), kLevel / kSigma0, -0.5);
  ASSERT_EQ(found.share.size(), 4u);
  const double place[] = {-0.03, -0.01, 0.01, 0.03};
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(found.share[k], stiffness(place[k]), 0.04) << k;
}

TEST(PlaceStiffness, NothingIsSaidWhereItIsTheSameEverywhere) {
  const PlaceStiffness found =
      fit_place_stiffness({record([](double) { return 1.0; }, 0.3)}, known(), kLevel / kSigma0, -0.5);
  EXPECT_TRUE(found.share.empty());
}

}  // namespace
}  // namespace stribeck::ident::bristle::place_stiffness_test
