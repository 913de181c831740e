#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <stribeck/path/polyline.hpp>
#include <vector>

namespace stribeck::path {
namespace {

using Vec3 = Vec<double, 3>;
static_assert(PathCurve<BlendedPolyline<3>>);

constexpr double kTolerance = 20e-6;

template <std::size_t N>
struct Rounded {
  std::vector<typename BlendedPolyline<N>::Leg> legs;
  BlendedPolyline<N> path;
  PolylineResult result;
};

template <std::size_t N>
Rounded<N> rounded(const std::vector<Vec<double, N>>& points, double tolerance, bool closed = false) {
  Rounded<N> r;
  r.legs.resize(points.size());
  r.result = round_corners<N>(points, tolerance, closed, r.legs, r.path);
  return r;
}

std::vector<Vec3> plan() {
  return {{{0.0, 0.0, 0.0}},        {{30e-3, 0.0, 0.0}},    {{30e-3, 10e-3, 0.0}},  {{10e-3, 10e-3, 5e-3}},
          {{10e-3, 10.1e-3, 5e-3}}, {{20e-3, 20e-3, 5e-3}}, {{-20e-3, 21e-3, 0.0}}, {{-10e-3, -5e-3, 2e-3}}};
}

/// Distance from all of the polyline, leg by leg.
double distance_from(const std::vector<Vec3>& points, const Vec3& p, bool closed) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + (closed ? 0 : 1) < points.size(); ++i) {
    const Vec3 a = points[i];
    const Vec3 way = points[(i + 1) % points.size()] - a;
    const double share = std::clamp(dot(p - a, way) / dot(way, way), 0.0, 1.0);
    least = std::min(least, norm(p - a - share * way));
  }
  return least;
}

TEST(Polyline, StraightsAreExactAndCornersWithinTheTolerance) {
  for (const bool closed : {false, true}) {
    const auto points = plan();
    const auto r = rounded(points, kTolerance, closed);
    ASSERT_EQ(r.result.status, PolylineStatus::kOk);
    EXPECT_NEAR(r.result.deviation, kTolerance, 1e-18);
    double farthest = 0.0;
    std::vector<double> from_corner(points.size(), 1.0);
    for (int i = 0; i <= 200000; ++i) {
      const double phi = r.path.period() * i / 200000;
      const Vec3 q = r.path.point(phi);
      farthest = std::max(farthest, distance_from(points, q, closed));
      for (std::size_t k = 0; k < points.size(); ++k)
        from_corner[k] = std::min(from_corner[k], norm(q - points[k]));
    }
    EXPECT_LE(farthest, kTolerance);
    // The blends reach the tolerance, except between the short leg and its neighbours, which leave too little room.
    for (std::size_t k = closed ? 0 : 1; k + (closed ? 0 : 1) < points.size(); ++k) {
      const bool short_of_room = k == 3 || k == 4;
      EXPECT_LE(norm(r.path.point(r.path.legs()[k].begin) - points[k]), kTolerance * (1.0 + 1e-12)) << k;
      EXPECT_GE(from_corner[k], short_of_room ? 1e-7 : kTolerance * (1.0 - 1e-12)) << k;
    }
    // Between the blends: the plan itself.
    for (std::size_t k = 0; k < r.path.legs().size(); ++k) {
      const auto& leg = r.path.legs()[k];
      if (leg.length < 1e-3) continue;
      const auto q = derivatives<4>(r.path, leg.begin + 0.5 * leg.length);
      const Vec3 middle = 0.5 * (points[k] + points[(k + 1) % points.size()]);
      EXPECT_LT(norm(q[0] - middle), 1e-16);
      EXPECT_NEAR(norm(q[1]), 1.0, 1e-15);
      for (int order = 2; order <= 4; ++order) EXPECT_EQ(norm(q[order]), 0.0);
    }
  }
}

TEST(Polyline, BlendIsAsItsPaperSays) {
  // A corner of 120° turn in the plane.
  const double turn = 2.0 * kPi / 3.0;
  const std::vector<Vec2> points{{{-0.1, 0.0}}, {{0.0, 0.0}}, {{0.1 * std::cos(turn), 0.1 * std::sin(turn)}}};
  const auto r = rounded(points, 1e-3);
  const double d = 1e-3 / (35.0 / 128.0 * std::sin(0.5 * turn));
  EXPECT_NEAR(r.legs[1].blend, d, 1e-16);
  const auto q = derivatives<2>(r.path, 0.1);
  EXPECT_NEAR(norm(q[0]), 1e-3, 1e-17);
  EXPECT_NEAR(norm(q[1]), std::cos(0.5 * turn), 1e-14);
  const double curvature = std::abs(q[1][0] * q[2][1] - q[1][1] * q[2][0]) / std::pow(norm(q[1]), 3);
  EXPECT_NEAR(curvature, 35.0 / 16.0 * std::sin(0.5 * turn) / (d * std::pow(std::cos(0.5 * turn), 2)),
              1e-9 * curvature);
  // q' turns by the smooth step of order 3, S = w⁴·(35 − 84w + 70w² − 20w³).
  for (const double w : {0.1, 0.35, 0.5, 0.8}) {
    const auto at = derivatives<1>(r.path, 0.1 + d * (2.0 * w - 1.0));
    const double step = w * w * w * w * (35.0 - w * (84.0 - w * (70.0 - 20.0 * w)));
    EXPECT_NEAR(at[1][0], (1.0 - step) + step * std::cos(turn), 1e-13);
    EXPECT_NEAR(at[1][1], step * std::sin(turn), 1e-13);
  }
}

TEST(Polyline, FourDerivativesAreContinuous) {
  const auto r = rounded(plan(), kTolerance, true);
  for (std::size_t k = 0; k < r.path.legs().size(); ++k) {
    const auto& leg = r.path.legs()[k];
    for (const double edge : {leg.begin - leg.blend, leg.begin, leg.begin + leg.blend}) {
      const double h = 1e-6 * leg.blend;
      const auto before = derivatives<4>(r.path, edge - h);
      const auto after = derivatives<4>(r.path, edge + h);
      for (std::size_t order = 0; order <= 4; ++order) {
        // Over 2h each derivative may change by the next one, at most 500/d^(n − 1); rounding grows with the place, 0.2 m.
        const double scale = 500.0 * std::pow(leg.blend, -static_cast<double>(order));
        EXPECT_LT(norm(after[order] - before[order]), scale * (2.0 * h + 2e-14 * leg.blend) + 2e-16)
            << "corner " << k << ", derivative " << order;
      }
    }
  }
}

TEST(Polyline, CornersOfTheSmallestTurnTakeTheRoomTheyHave) {
  // A fine polyline on a circle of 10 mm: all is blend, no corner is left, and the path is within the tolerance.
  std::vector<Vec2> points;
  for (int i = 0; i < 400; ++i) {
    points.push_back({{10e-3 * std::cos(2.0 * kPi * i / 400), 10e-3 * std::sin(2.0 * kPi * i / 400)}});
  }
  const auto r = rounded(points, kTolerance, true);
  ASSERT_EQ(r.result.status, PolylineStatus::kOk);
  for (const auto& leg : r.path.legs()) EXPECT_NEAR(leg.blend, 0.5 * leg.length, 1e-12);
  // 35/128·d·sin(θ/2) with d half of 2R·sin(θ/2), θ = 2π/400.
  const double sine = std::sin(kPi / 400.0);
  EXPECT_NEAR(r.result.deviation, 35.0 / 128.0 * 10e-3 * sine * sine, 1e-15);
  // Points on one line have no corner at all.
  const auto line = rounded<2>({{{0.0, 0.0}}, {{1.0, 0.0}}, {{3.0, 0.0}}}, kTolerance);
  EXPECT_EQ(line.result.deviation, 0.0);
  EXPECT_EQ(derivatives<4>(line.path, 1.0)[1][0], 1.0);
}

TEST(Polyline, MovesWithItsPoints) {
  const auto points = plan();
  const auto turned = [](const Vec3& p) {
    return Vec3{{0.6 * p[0] - 0.8 * p[1], p[2], 0.8 * p[0] + 0.6 * p[1]}};
  };
  std::vector<Vec3> moved;
  for (const auto& p : points) moved.push_back(turned(p) + Vec3{{0.1, 0.2, -0.3}});
  auto reversed = points;
  std::reverse(reversed.begin(), reversed.end());
  auto shifted = points;
  std::rotate(shifted.begin(), shifted.begin() + 3, shifted.end());
  const auto r = rounded(points, kTolerance);
  const auto m = rounded(moved, kTolerance);
  const auto b = rounded(reversed, kTolerance);
  const auto c = rounded(points, kTolerance, true);
  const auto s = rounded(shifted, kTolerance, true);
  for (int i = 0; i <= 5000; ++i) {
    const double phi = r.path.period() * i / 5000;
    const Vec3 q = r.path.point(phi);
    EXPECT_LT(norm(m.path.point(phi) - turned(q) - Vec3{{0.1, 0.2, -0.3}}), 1e-15);
    EXPECT_LT(norm(b.path.point(r.path.period() - phi) - q), 1e-15);
    EXPECT_LT(norm(s.path.point(phi) - c.path.point(phi + c.path.legs()[3].begin)), 1e-15);
  }
}

TEST(Polyline, DistanceFromThePlanIsExact) {
  for (const bool closed : {false, true}) {
    const auto points = plan();
    const auto r = rounded(points, kTolerance, closed);
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> off(-10e-6, 10e-6);
    for (int i = 0; i <= 20000; ++i) {
      const double phi = r.path.period() * i / 20000;
      const Vec3 p = r.path.point(phi) + Vec3{{off(random), off(random), off(random)}};
      const PlanPoint near = nearest_on_plan(r.path, p, phi);
      ASSERT_NEAR(near.distance, distance_from(points, p, closed), 1e-17) << "seed 3, " << i;
      const double gap = std::abs(near.phi - phi);
      EXPECT_LT(std::min(gap, closed ? r.path.period() - gap : gap), 5e-4);
    }
  }
}

TEST(Polyline, DistanceIsJudgedOnTheBranchTravelled) {
  // Out and back 1 mm apart: 0.6 mm off the way out is nearer to the way back.
  const std::vector<Vec2> points{{{0.0, 0.0}}, {{0.1, 0.0}}, {{0.1, 1e-3}}, {{0.0, 1e-3}}};
  const auto r = rounded(points, kTolerance);
  const Vec2 p{{0.05, 0.6e-3}};
  EXPECT_NEAR(nearest_on_plan(r.path, p, 0.0501).distance, 0.6e-3, 1e-17);
  EXPECT_NEAR(nearest_on_plan(r.path, p, 0.1501).distance, 0.4e-3, 1e-17);
  EXPECT_NEAR(nearest_on_plan(r.path, p, 0.1501).phi, 0.151, 1e-15);
  // In a corner both legs count, however sharp it is: at half its blend, on the other leg.
  const double c = std::cos(kPi / 9.0);
  const auto sharp =
      rounded<2>({{{0.1, 0.0}}, {{0.0, 0.0}}, {{0.1 * c, 0.1 * std::sqrt(1.0 - c * c)}}}, 1e-3);
  const double half = 0.5 * sharp.legs[1].blend;
  EXPECT_NEAR(nearest_on_plan<2>(sharp.path, {{half, 0.0}}, 0.1 + half).distance, 0.0, 1e-17);
  // Before the beginning and behind the end the ends are nearest.
  EXPECT_NEAR(nearest_on_plan<2>(r.path, {{-3e-3, 4e-3}}, 0.0).distance, 5e-3, 1e-17);
  EXPECT_EQ(nearest_on_plan<2>(r.path, {{-3e-3, 0.0}}, -1.0).phi, 0.0);
}

TEST(Polyline, SaysWhatIsWrongAndWhere) {
  const std::vector<Vec2> good{{{0.0, 0.0}}, {{1.0, 0.0}}, {{1.0, 1.0}}, {{0.0, 1.0}}};
  const auto status = [](const std::vector<Vec2>& p, double tolerance, bool closed, std::size_t index) {
    const auto r = rounded(p, tolerance, closed);
    EXPECT_EQ(r.result.index, index) << describe(r.result.status);
    return r.result.status;
  };
  const auto with = [&](std::size_t i, Vec2 p) {
    auto bad = good;
    bad[i] = p;
    return bad;
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(status(good, kTolerance, true, 0), PolylineStatus::kOk);
  EXPECT_EQ(status({good[0]}, kTolerance, false, 1), PolylineStatus::kTooFewPoints);
  EXPECT_EQ(status({good[0], good[1]}, kTolerance, true, 2), PolylineStatus::kTooFewPoints);
  EXPECT_EQ(status(with(0, {{kNan, 0.0}}), kTolerance, false, 0), PolylineStatus::kNotFinite);
  EXPECT_EQ(status(with(2, {{kNan, 0.0}}), kTolerance, false, 2), PolylineStatus::kNotFinite);
  EXPECT_EQ(status(with(2, good[1]), kTolerance, false, 2), PolylineStatus::kEqualNeighbours);
  EXPECT_EQ(status(with(3, good[0]), kTolerance, true, 0), PolylineStatus::kEqualNeighbours);
  EXPECT_EQ(status(with(2, {{0.5, 1e-4}}), kTolerance, false, 1), PolylineStatus::kTurnsBack);
  EXPECT_EQ(status(good, 0.0, false, 0), PolylineStatus::kToleranceNotPositive);
  EXPECT_EQ(status(good, kNan, false, 0), PolylineStatus::kToleranceNotPositive);
  std::vector<BlendedPolyline<2>::Leg> legs(2);
  BlendedPolyline<2> path;
  EXPECT_EQ(round_corners<2>(good, kTolerance, false, legs, path).status, PolylineStatus::kMemoryTooSmall);
  for (int i = 0; i <= static_cast<int>(PolylineStatus::kMemoryTooSmall); ++i) {
    EXPECT_NE(describe(static_cast<PolylineStatus>(i)), "unknown status");
  }
}

}  // namespace
}  // namespace stribeck::path
