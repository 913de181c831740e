// Lines, arcs, helices, spirals and rounded corners: places, distances and contour errors that geometry gives.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <stribeck/path/corner.hpp>
#include <stribeck/path/feed_profile.hpp>
#include <stribeck/path/segment_path.hpp>

namespace stribeck::path::segment_path_test {
namespace {

constexpr double kRounding = 1e-15;  ///< of coordinates below 1 m [m]
constexpr double kSearch = 1e-12;    ///< of Newton's iterations [m]

using Point = Vec<double, 2>;

Segment<2> line(Point from, Point to) {
  Segment<2> s;
  s.length = s.extent = norm(to - from);
  s.c[0] = from;
  s.c[1] = (1.0 / s.length) * (to - from);
  return s;
}
/// About a centre, from an angle on; positive: to the left.
Segment<2> arc(Point centre, double radius, double from, double angle) {
  Segment<2> s;
  s.kind = SegmentKind::kArc;
  s.radius = radius;
  s.angle = angle;
  s.length = s.extent = radius * std::abs(angle);
  s.c[0] = centre;
  s.c[1] = {{std::cos(from), std::sin(from)}};
  s.c[2] = {{-std::sin(from), std::cos(from)}};
  return s;
}
template <std::size_t M>
std::array<Segment<2>, M> in_a_row(std::array<Segment<2>, M> all) {
  double at = 0.0;
  for (Segment<2>& s : all) {
    s.begin = s.travelled = at;
    at += s.length;
  }
  return all;
}
void expect_at(const Point& p, double x, double y, double tolerance = kRounding) {
  EXPECT_NEAR(p[0], x, tolerance);
  EXPECT_NEAR(p[1], y, tolerance);
}

/// 30 mm to the right, a quarter of a circle of 10 mm to the left, 20 mm upwards.
const auto kHook =
    in_a_row(std::array{line({{0.0, 0.0}}, {{0.03, 0.0}}), arc({{0.03, 0.01}}, 0.01, -0.5 * kPi, 0.5 * kPi),
                        line({{0.04, 0.01}}, {{0.04, 0.03}})});
constexpr double kQuarter = 0.01 * 0.5 * kPi;

TEST(SegmentPath, GoesAlongItsSegments) {
  const SegmentPath<2> path{kHook};
  EXPECT_NEAR(path.period(), 0.05 + kQuarter, kRounding);
  expect_at(path.point(0.012), 0.012, 0.0);
  expect_at(path.point(0.03 + kQuarter / 2), 0.03 + 0.01 * std::sqrt(0.5), 0.01 - 0.01 * std::sqrt(0.5));
  expect_at(path.point(0.03 + kQuarter + 0.005), 0.04, 0.015);
  expect_at(path.point(path.period()), 0.04, 0.03);
}

TEST(SegmentPath, ContourErrorIsTheDistanceAndPositiveToTheLeft) {
  const SegmentPath<2> path{kHook};
  const double middle = 0.03 + kQuarter / 2;
  EXPECT_NEAR(path.contour_error({{0.012, 2e-4}}, 0.0121), 2e-4, kSearch);
  EXPECT_NEAR(path.contour_error({{0.012, -2e-4}}, 0.0121), -2e-4, kSearch);
  const auto at_radius = [](double r) {
    return Point{{0.03 + r * std::sqrt(0.5), 0.01 - r * std::sqrt(0.5)}};
  };
  EXPECT_NEAR(path.contour_error(at_radius(0.0097), middle + 1e-3), 3e-4, kSearch);
  EXPECT_NEAR(path.contour_error(at_radius(0.0103), middle - 1e-3), -3e-4, kSearch);
  // Beside the centre of the arc the quarter's nearest point is still on the side of the position.
  const PathPlace far = path.nearest(at_radius(0.004), middle);
  EXPECT_NEAR(far.distance, 0.006, kSearch);
  EXPECT_NEAR(far.phi, middle, 1e-9);
}

TEST(SegmentPath, LeftIsLeftInEveryDirectionOfTravel) {
  for (int k = 0; k < 16; ++k) {
    const double angle = 2.0 * kPi * (k + 0.3) / 16.0;
    const Point along{{std::cos(angle), std::sin(angle)}};
    const Point left{{-along[1], along[0]}};
    const Point begin{{0.2, -0.1}};
    const std::array<Segment<2>, 1> one{line(begin, begin + 0.03 * along)};
    const SegmentPath<2> path{one};
    for (const double off : {2e-4, -2e-4})
      EXPECT_NEAR(path.contour_error(begin + 0.012 * along + off * left, 0.0121), off, kSearch) << k;
  }
}

TEST(SegmentPath, FindsTheNearestPlaceOnTheNeighboursToBothSides) {
  const SegmentPath<2> path{kHook};
  // The reference is 3 mm ahead on the arc, the axes are still beside the first line; and the other way round.
  const PathPlace behind = path.nearest({{0.028, 1e-4}}, 0.031);
  EXPECT_NEAR(behind.phi, 0.028, kSearch);
  EXPECT_NEAR(behind.distance, 1e-4, kSearch);
  const PathPlace ahead = path.nearest({{0.0401, 0.012}}, 0.03 + kQuarter - 1e-3);
  EXPECT_NEAR(ahead.phi, 0.03 + kQuarter + 0.002, kSearch);
  EXPECT_NEAR(ahead.distance, 1e-4, kSearch);
  // Past both ends it is the end.
  EXPECT_EQ(path.nearest({{-1e-3, 0.0}}, 0.0).phi, 0.0);
  EXPECT_NEAR(path.nearest({{0.04, 0.031}}, path.period()).phi, path.period(), kRounding);
}

TEST(SegmentPath, StaysOnTheBranchThatIsBeingTravelled) {
  // There, 100 mm along, and back 1 mm beside it: the way back is nearer, but far away along the path.
  const auto hairpin =
      in_a_row(std::array{line({{0.0, 0.0}}, {{0.1, 0.0}}), line({{0.1, 0.0}}, {{0.1, 0.001}}),
                          line({{0.1, 0.001}}, {{0.0, 0.001}})});
  const SegmentPath<2> path{hairpin};
  EXPECT_NEAR(path.contour_error({{0.02, 6e-4}}, 0.02), 6e-4, kSearch);
  EXPECT_NEAR(path.nearest({{0.02, 6e-4}}, 0.181).phi, 0.181, kSearch);
}

TEST(SegmentPath, LooksAtTheNearestTwoHundredAndFiftySixSegments) {
  // 800 segments of 0.1 mm along x. A position far from the reference is looked for so far, and no farther, to both sides.
  std::array<Segment<2>, 800> many;
  for (std::size_t i = 0; i < many.size(); ++i) {
    const double x = 1e-4 * static_cast<double>(i);
    many[i] = line({{x, 0.0}}, {{x + 1e-4, 0.0}});
  }
  many = in_a_row(many);
  const SegmentPath<2> path{many};
  constexpr double kReach = 256 * 1e-4;
  for (const double from : {0.04005, 0.03505}) {
    EXPECT_NEAR(path.nearest({{from + 0.02, 0.0}}, from).phi, from + 0.02, kSearch);
    EXPECT_NEAR(path.nearest({{from - 0.02, 0.0}}, from).phi, from - 0.02, kSearch);
    EXPECT_NEAR(path.nearest({{from + 0.033, 0.0}}, from).phi, from + kReach, 1e-4);
    EXPECT_NEAR(path.nearest({{from - 0.033, 0.0}}, from).phi, from - kReach, 1e-4);
  }
  // At the ends there are none beyond.
  EXPECT_NEAR(path.nearest({{2e-3, 1e-3}}, 5e-5).phi, 2e-3, kSearch);
  EXPECT_NEAR(path.nearest({{0.078, 1e-3}}, 0.07995).phi, 0.078, kSearch);
}

TEST(Segment, TheNearestPlaceIsFoundDeepInsideAnArc) {
  // 40 % of the radius inside and outside, from the ends of a quarter.
  const Segment<2> quarter = arc({{0.0, 0.0}}, 0.01, 0.0, 0.5 * kPi);
  for (const double radius : {0.006, 0.014}) {
    for (const double degrees : {10.0, 45.0, 80.0}) {
      const double angle = degrees * kPi / 180.0;
      const Point p{{radius * std::cos(angle), radius * std::sin(angle)}};
      for (const double start : {0.0, 0.5 * quarter.length, quarter.length})
        EXPECT_NEAR(quarter.nearest(p, start), 0.01 * angle, 1e-9) << radius << ' ' << degrees;
    }
  }
}

// A corner that turns back by 146 degrees: its two legs run side by side. The least of 2000 places along it is the nearest.
TEST(Segment, TheNearestPlaceOfASharpCornerIsOnEitherLeg) {
  const double turn = 146.0 * kPi / 180.0;
  const Segment<2> in = line({{0.0, 0.0}}, {{0.01, 0.0}});
  const Segment<2> out = line({{0.01, 0.0}}, {{0.01 + 0.01 * std::cos(turn), 0.01 * std::sin(turn)}});
  const Segment<2> corner = make_corner(in, in.length - 2e-3, out, 2e-3);
  for (const double along : {0.05, 0.2, 0.4, 0.6, 0.8, 0.95}) {
    for (const double off : {-2e-5, 2e-5}) {
      const auto q = corner.derivatives<1>(along * corner.length);
      const Point p{{q[0][0] - off * q[1][1], q[0][1] + off * q[1][0]}};
      double least = 1.0;
      for (int k = 0; k <= 2000; ++k)
        least = std::min(least, norm(p - corner.point(corner.length * k / 2000.0)));
      for (const double start : {0.0, 0.3, 0.5, 0.7, 1.0}) {
        const double found = corner.nearest(p, start * corner.length);
        EXPECT_LE(norm(p - corner.point(found)), least + 1e-9) << along << ' ' << start;
      }
    }
  }
}

TEST(Segment, ASpiralIsAsLongAsCalculusSays) {
  // r = a(1 + Θ·ψ/2π) over one turn, with a = 10 mm and Θ = 1: arc length of an Archimedean spiral in closed form.
  Segment<2> s = arc({{0.0, 0.0}}, 0.01, 0.0, 2.0 * kPi);
  s.growth = 0.01;
  const double b = 0.01 / (2.0 * kPi);
  const auto length = [&](double r) {
    return (r * std::sqrt(r * r + b * b) + b * b * std::asinh(r / b)) / (2.0 * b);
  };
  s.extent = length(0.02) - length(0.01);
  EXPECT_FALSE(s.by_distance());
  EXPECT_NEAR(s.distance(s.length), s.extent, 1e-9);  // 20 points of Gauss and Legendre
  EXPECT_NEAR(s.distance(0.5 * s.length), length(0.015) - length(0.01), 1e-9);
  EXPECT_NEAR(s.place(length(0.015) - length(0.01)), 0.5 * s.length, 1e-9);
  EXPECT_NEAR(s.place(s.extent), s.length, 1e-9);
  EXPECT_EQ(s.place(-1.0), 0.0);
  expect_at(s.point(0.5 * s.length), -0.015, 0.0);
  expect_at(s.point(s.length), 0.02, 0.0);
}

TEST(Segment, AHelixTravelsAlongItsAxis) {
  Segment<3> s;
  s.kind = SegmentKind::kArc;
  s.radius = 3e-3;
  s.angle = -2.0 * kPi;
  s.c = {Vec<double, 3>{{0.1, 0.2, 0.3}}, {{1.0, 0.0, 0.0}}, {{0.0, 1.0, 0.0}}, {{0.0, 0.0, 0.01}}};
  s.length = s.extent = std::hypot(2.0 * kPi * 3e-3, 0.01);
  const auto q = s.derivatives<2>(0.25 * s.length);
  EXPECT_NEAR(q[0][0], 0.1, kRounding);
  EXPECT_NEAR(q[0][1], 0.2 - 3e-3, kRounding);  // to the right, a quarter
  EXPECT_NEAR(q[0][2], 0.3 + 0.0025, kRounding);
  EXPECT_NEAR(norm(q[1]), 1.0, 1e-12);
  // Curvature r/(r² + (h/2π)²)
  EXPECT_NEAR(norm(q[2]), 3e-3 / (9e-6 + std::pow(0.01 / (2.0 * kPi), 2)), 1e-9);
  EXPECT_TRUE(s.by_distance());
  EXPECT_EQ(s.place(2.0 * s.length), s.length);
  EXPECT_NEAR(s.nearest(q[0], 0.3 * s.length), 0.25 * s.length, 1e-9);
}

TEST(Corner, JoinsBothSegmentsWithFourDerivatives) {
  const Segment<2> before = kHook[0];
  const Segment<2> after = arc({{0.03, 0.02}}, 0.02, -0.5 * kPi + 0.3, 1.0);  // in another direction
  for (const Segment<2>& next : {kHook[2], after}) {
    const double x0 = before.length - 2e-3;
    const double x1 = 2e-3;
    const Segment<2> corner = make_corner(before, x0, next, x1);
    EXPECT_EQ(corner.kind, SegmentKind::kCorner);
    EXPECT_NEAR(corner.length, 4e-3, kRounding);
    const auto begin = corner.derivatives<4>(0.0);
    const auto end = corner.derivatives<4>(corner.length);
    const auto first = before.derivatives<4>(x0);
    const auto last = next.derivatives<4>(x1);
    double size = 0.02;
    for (std::size_t k = 0; k <= 4; ++k) {
      for (std::size_t i = 0; i < 2; ++i) {
        // Sums of ten terms, each k-th derivative as large as 1/l^k.
        EXPECT_NEAR(begin[k][i], first[k][i], 1e-11 * size) << k;
        EXPECT_NEAR(end[k][i], last[k][i], 1e-11 * size) << k;
      }
      size *= 10.0 / corner.length;
    }
  }
}

TEST(Corner, IsNotPlacedYet) {
  // Its place on the path and its length are for the caller, who knows what comes before it.
  const Segment<2> corner = make_corner(kHook[0], 0.028, kHook[2], 2e-3);
  EXPECT_EQ(corner.begin, 0.0);
  EXPECT_EQ(corner.travelled, 0.0);
  EXPECT_EQ(corner.extent, 0.0);
  EXPECT_FALSE(corner.by_distance());
}

TEST(Corner, KeepsTheDistanceFromTheCornerThatItsLengthGives) {
  // A right angle, blended over 2 mm to both sides.
  const Segment<2> before = line({{0.0, 0.0}}, {{0.03, 0.0}});
  const Segment<2> after = line({{0.03, 0.0}}, {{0.03, 0.03}});
  Segment<2> corner = make_corner(before, 0.028, after, 2e-3);
  const HalfTurn half = half_turn(before.c[1], after.c[1]);
  EXPECT_NEAR(half.sine, std::sqrt(0.5), kRounding);
  EXPECT_NEAR(half.cosine, std::sqrt(0.5), kRounding);
  const Point middle = corner.point(0.5 * corner.length);
  const double off = norm(Point{{0.03, 0.0}} - middle);
  EXPECT_NEAR(off, blend_deviation(2e-3, half.sine), 1e-12);
  EXPECT_NEAR(blend_length(off, half.sine), 2e-3, 1e-12);
  // Inside the corner, which turns to the left; slower in φ by cos(θ/2) in its middle.
  EXPECT_LT(middle[0], 0.03);
  EXPECT_GT(middle[1], 0.0);
  EXPECT_NEAR(norm(corner.derivatives<1>(0.5 * corner.length)[1]), std::sqrt(0.5), 0.08);
  // Two halves that mirror each other, and shorter than around the corner.
  corner.extent = corner.distance(corner.length);
  EXPECT_NEAR(corner.distance(0.5 * corner.length), 0.5 * corner.extent, 1e-9);
  EXPECT_LT(corner.extent, 4e-3);
  EXPECT_GT(corner.extent, std::hypot(2e-3, 2e-3));
  EXPECT_NEAR(corner.place(0.5 * corner.extent), 0.5 * corner.length, 1e-9);
  EXPECT_NEAR(corner.nearest(middle, 0.2 * corner.length), 0.5 * corner.length, 1e-9);
}

TEST(FeedProfile, WithoutPhasesItTakesNoTimeAndNoWay) {
  EXPECT_EQ(FeedProfile{}.duration(), 0.0);
  EXPECT_EQ(FeedProfile{}.length(), 0.0);
  EXPECT_TRUE(FeedProfile{}.phases().empty());
}

TEST(FeedProfile, IsWhereConstantJerkTakesIt) {
  // From rest to 1 m/s within 2 m/s² and 10 m/s³, and back: 0.7 s and 0.35 m each (speed_ramp_test.cpp).
  const auto up = SpeedRamp(0.0, 1.0, 2.0, 10.0).phases(0.0, 0.1);
  const auto down = SpeedRamp(1.0, 0.0, 2.0, 10.0).phases(0.7, 0.45);
  const std::array<FeedPhase, 6> phases{up[0], up[1], up[2], down[0], down[1], down[2]};
  const FeedProfile profile(phases, 1.4, 0.8);
  EXPECT_EQ(profile.at(-1.0).s, 0.1);
  EXPECT_EQ(profile.at(0.0).speed, 0.0);
  EXPECT_EQ(profile.at(2.0).s, 0.8);
  EXPECT_EQ(profile.at(2.0).speed, 0.0);
  EXPECT_NEAR(profile.at(0.1).s, 0.1 + 10.0 * 1e-3 / 6.0, 1e-12);
  EXPECT_NEAR(profile.at(0.1).speed, 0.05, 1e-12);
  EXPECT_NEAR(profile.at(0.1).acceleration, 1.0, 1e-12);
  EXPECT_NEAR(profile.at(0.35).speed, 0.5, 1e-12);
  EXPECT_NEAR(profile.at(0.35).acceleration, 2.0, 1e-12);
  EXPECT_NEAR(profile.at(0.6).speed, 0.95, 1e-12);
  EXPECT_NEAR(profile.at(0.7).speed, 1.0, 1e-12);
  for (const double t : {0.05, 0.3, 0.55, 0.69}) {
    const SpeedLaw::Point there = profile.at(t);
    const SpeedLaw::Point back = profile.at(1.4 - t);
    EXPECT_NEAR(there.s - 0.1, 0.8 - back.s, 1e-12) << t;
    EXPECT_NEAR(there.speed, back.speed, 1e-12) << t;
    EXPECT_NEAR(there.acceleration, -back.acceleration, 1e-12) << t;
    EXPECT_GT(there.s, 0.1) << t;
  }
}

}  // namespace
}  // namespace stribeck::path::segment_path_test
