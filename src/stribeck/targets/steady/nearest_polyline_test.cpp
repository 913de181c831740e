#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <stribeck/targets/steady/nearest_polyline.hpp>

namespace stribeck::targets::nearest_polyline_test {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

struct Samples {
  std::vector<double> x;
  std::vector<double> y;
};

template <class F>
Samples sampled(double from, double to, F&& f, int n = 2000) {
  Samples s;
  for (int i = 0; i <= n; ++i) {
    s.x.push_back(from + (to - from) * i / n);
    s.y.push_back(f(s.x.back()));
  }
  return s;
}

double slope_of_friction(double v) { return 20.0 + 15.0 * std::exp(-v * v / 0.36) + 4.5 * v; }

// Closed form: of a parabola y = x² every piece of width h is h²/8 too low in the middle, half of that to both sides; pieces of
// one width are best.
TEST(NearestPolyline, ParabolaInClosedForm) {
  const Samples s = sampled(
      0.0, 3.0, [](double x) { return x * x; }, 600);
  for (const std::size_t pieces : {1u, 2u, 5u}) {
    const Polyline p = nearest_polyline(s.x, s.y, pieces);
    const double h = 3.0 / static_cast<double>(pieces);
    // Between samples the error is not seen: it differs by at most a step's square.
    EXPECT_NEAR(p.largest_error, h * h / 8.0, 2e-3 * h * h) << pieces;
    ASSERT_EQ(p.corners.size(), pieces + 1);
    for (std::size_t i = 0; i <= pieces; ++i) {
      // An error of a thousandth moves a corner by some hundredths, because the error grows with the square of the distance.
      EXPECT_NEAR(p.corners[i].x, h * static_cast<double>(i), 0.1 * h) << pieces << " " << i;
    }
  }
}

// Limit: a polyline is found again, and one piece less is not enough.
TEST(NearestPolyline, FindsAPolylineAgain) {
  const std::vector<Corner> corners{{0.0, 1.0}, {0.5, -2.0}, {1.25, 3.0}, {2.0, 3.5}, {4.0, 0.0}};
  const Polyline truth{corners, 0.0};
  const Samples s = sampled(
      0.0, 4.0, [&](double x) { return truth.at(x); }, 1600);
  const Polyline p = nearest_polyline(s.x, s.y, 4);
  // The bisection ends at a millionth of the height, 5.5.
  EXPECT_LT(p.largest_error, 1e-5);
  ASSERT_EQ(p.corners.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(p.corners[i].x, corners[i].x, 1e-4);
  EXPECT_GT(nearest_polyline(s.x, s.y, 3).largest_error, 0.1);
}

// Invariance: mirrored in x and in y, scaled and moved.
TEST(NearestPolyline, DoesNotDependOnUnitsAndSigns) {
  const Samples s = sampled(0.0, 16.0, slope_of_friction, 500);
  const double error = nearest_polyline(s.x, s.y, 5).largest_error;
  EXPECT_GT(error, 0.1);
  Samples mirrored;
  for (std::size_t i = s.x.size(); i-- > 0;) {
    mirrored.x.push_back(7.0 - 1e-3 * s.x[i]);
    mirrored.y.push_back(-1e3 * s.y[i] + 4.0);
  }
  EXPECT_NEAR(nearest_polyline(mirrored.x, mirrored.y, 5).largest_error, 1e3 * error, 1e-2 * error * 1e3);
}

// Independent: no table that chance makes of the best is nearer, and the best reaches its error in one more place than it has
// corners to give (Chebyshev).
TEST(NearestPolyline, NothingNearbyIsNearer) {
  const Samples s = sampled(0.0, 4.0, slope_of_friction, 800);
  const Polyline best = nearest_polyline(s.x, s.y, 6);
  constexpr unsigned kSeed = 7;
  std::mt19937 random(kSeed);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 5000; ++k) {
    Polyline other = best;
    const double size = std::pow(10.0, -3.0 * (k % 3) - 1.0);
    for (std::size_t i = 0; i < other.corners.size(); ++i) {
      if (i > 0 && i + 1 < other.corners.size()) other.corners[i].x += size * normal(random);
      other.corners[i].y += size * normal(random);
    }
    double worst = 0.0;
    for (std::size_t i = 0; i < s.x.size(); ++i) worst = std::max(worst, std::abs(other.at(s.x[i]) - s.y[i]));
    ASSERT_GE(worst, best.largest_error - 2e-4) << "seed " << kSeed << ", case " << k;
  }
}

TEST(NearestPolyline, FewestPiecesWithin) {
  const Samples s = sampled(0.0, 3.0, [](double x) { return x * x; });
  // h²/8 = 0.05 for h = 0.632: 4.74 pieces.
  EXPECT_FALSE(polyline_within(s.x, s.y, 0.05, 4));
  const auto p = polyline_within(s.x, s.y, 0.05, 16);
  ASSERT_TRUE(p);
  EXPECT_EQ(p->corners.size(), 6u);
  EXPECT_LE(p->largest_error, 0.05 * (1.0 + 1e-9));
}

TEST(NearestPolyline, RefusesWhatIsNoCurve) {
  const std::vector<double> one{1.0};
  const std::vector<double> same{1.0, 1.0};
  EXPECT_THAT([&] { nearest_polyline(one, one, 3); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("needs two samples or more")));
  EXPECT_THAT([&] { nearest_polyline(same, same, 3); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("must ascend")));
  EXPECT_THAT([&] { nearest_polyline(same, one, 3); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("needs two samples or more")));
  const std::vector<double> up{1.0, 2.0, 3.0};
  EXPECT_THAT([&] { nearest_polyline(up, up, 0); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("at least one piece")));
  const std::vector<double> flat{5.0, 5.0, 5.0};
  EXPECT_LT(nearest_polyline(up, flat, 1).largest_error, 1e-5);
}

}  // namespace
}  // namespace stribeck::targets::nearest_polyline_test
