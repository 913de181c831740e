// Paths of part programs under limits of every axis. The limits are checked on positions alone: an n-th divided difference is a
// mean of the n-th derivative, whatever the program thinks that one is.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stribeck/sim/part/part_path.hpp>

namespace stribeck::sim::part_path_test {
namespace {

using Vec3 = Vec<double, 3>;
constexpr double kRapid = std::numeric_limits<double>::infinity();

PartMove to(Vec3 p, double feed = 0.05, double tolerance = 1e-5) {
  PartMove m;
  m.to = p;
  m.feed = feed;
  m.tolerance = tolerance;
  return m;
}
PartMove stop(Vec3 p, double feed = 0.05, double dwell = 0.0) {
  PartMove m = to(p, feed);
  m.junction = Junction::kStop;
  m.dwell = dwell;
  return m;
}
PartMove around(Vec3 p, Vec3 centre, int turns, Vec3 normal = {{0.0, 0.0, 1.0}}, double feed = 0.05) {
  PartMove m = to(p, feed);
  m.arc = true;
  m.centre = centre;
  m.normal = normal;
  m.turns = turns;
  return m;
}

template <std::size_t N>
PartLimits<N> limits(double v = 0.1, double a = 0.5, double j = 5.0) {
  PartLimits<N> l;
  for (std::size_t i = 0; i < N; ++i) {
    // Of each axis its own.
    const double share = 1.0 + 0.3 * static_cast<double>(i);
    l.speed[i] = v * share;
    l.acceleration[i] = a * share;
    l.jerk[i] = j * share;
  }
  return l;
}

template <std::size_t N>
std::shared_ptr<const Part<N>> planned(const std::vector<PartMove>& moves, const PartLimits<N>& l) {
  auto part = plan_part<N>({}, moves, l);
  EXPECT_NE(part, nullptr);
  return part;
}

template <std::size_t N>
std::vector<Vec<double, N>> positions(const Part<N>& part, double dt) {
  PartMotion<N> motion(part);
  std::vector<Vec<double, N>> p;
  for (double t = 0.0; t < part.summary.duration + 4.0 * dt; t = dt * static_cast<double>(p.size()))
    p.push_back(motion.at(t).position);
  return p;
}

/// Speed, acceleration and jerk of each axis from positions, against the limits.
template <std::size_t N>
void expect_within(const Part<N>& part, const PartLimits<N>& l, double dt = 1e-3) {
  const auto p = positions(part, dt);
  for (std::size_t i = 0; i < N; ++i) {
    // 1e-9 of the limit, and what rounding of place and time makes of differences.
    double farthest = 0.0;
    for (const auto& q : p) farthest = std::max(farthest, std::abs(q[i]));
    const double rounding = 2e-16 * (farthest + l.speed[i] * part.summary.duration);
    const double most_v = l.speed[i] * (1.0 + 1e-9) + 2.0 * rounding / dt;
    const double most_a = l.acceleration[i] * (1.0 + 1e-9) + 4.0 * rounding / (dt * dt);
    const double most_j = l.jerk[i] * (1.0 + 1e-9) + 8.0 * rounding / (dt * dt * dt);
    for (std::size_t k = 3; k < p.size(); ++k) {
      const double v = (p[k][i] - p[k - 1][i]) / dt;
      const double a = (p[k][i] - 2.0 * p[k - 1][i] + p[k - 2][i]) / (dt * dt);
      const double j = (p[k][i] - 3.0 * p[k - 1][i] + 3.0 * p[k - 2][i] - p[k - 3][i]) / (dt * dt * dt);
      ASSERT_LE(std::abs(v), most_v) << "speed of axis " << i << " at " << dt * static_cast<double>(k);
      ASSERT_LE(std::abs(a), most_a) << "acceleration of axis " << i << " at " << dt * static_cast<double>(k);
      ASSERT_LE(std::abs(j), most_j) << "jerk of axis " << i << " at " << dt * static_cast<double>(k);
    }
  }
}

double from_line(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 d = b - a;
  const double share = clamp_to(dot(p - a, d) / dot(d, d), 0.0, 1.0);
  return norm(p - a - share * d);
}

// Closed forms.

TEST(PartPath, OneMoveTakesTheKnownTime) {
  const auto time = [](double way, double v, double a, double j) {
    PartLimits<3> l = limits<3>();
    l.speed[0] = v;
    l.acceleration[0] = a;
    l.jerk[0] = j;
    const auto part = planned<3>({stop({{way, 0.0, 0.0}}, kRapid)}, l);
    expect_within(*part, l);
    return part->summary.duration;
  };
  // All seven segments: T = s/v + v/a + a/j.
  EXPECT_NEAR(time(0.1, 0.05, 0.5, 5.0), 2.0 + 0.1 + 0.1, 1e-12);
  // Without constant speed: v(v/a + a/j) = s.
  const double v = 0.5 * (-0.05 + std::sqrt(0.05 * 0.05 + 4.0 * 0.5 * 0.02));
  EXPECT_NEAR(time(0.02, 10.0, 0.5, 5.0), 2.0 * (v / 0.5 + 0.1), 1e-9);
  // Jerk alone: s = 2·j·t³ in four parts of t.
  EXPECT_NEAR(time(1e-4, 10.0, 0.5, 5.0), 4.0 * std::cbrt(1e-4 / 10.0), 1e-9);
  // Constant speed, but jerk too low for the acceleration: T = s/v + 2·√(v/j).
  EXPECT_NEAR(time(0.1, 0.02, 0.5, 5.0), 5.0 + 2.0 * std::sqrt(0.02 / 5.0), 1e-12);
}

TEST(PartPath, AlongADiagonalTheAxesShareTheFeed) {
  PartLimits<2> l;
  l.speed = {{1.0, 1.0}};
  l.acceleration = {{0.3, 1.0}};
  l.jerk = {{6.0, 6.0}};
  // 3:4: x has 0.6 of the distance; its acceleration permits 0.5 along the path, y's jerk 6/0.8.
  const auto part = planned<2>({stop({{0.06, 0.08, 0.0}}, 0.05)}, l);
  EXPECT_NEAR(part->summary.duration, 2.0 + 0.05 / 0.5 + 0.5 / 7.5, 1e-12);
  expect_within(*part, l);
}

TEST(PartPath, CircleGoesAsFastAsItsCurvatureAllows) {
  const double r = 0.02;
  PartLimits<2> l;
  l.speed = {{1.0, 1.0}};
  l.acceleration = {{0.5, 0.5}};
  l.jerk = {{100.0, 100.0}};
  const auto part = planned<2>({around({}, {{-r, 0.0, 0.0}}, 5, {{0.0, 0.0, 1.0}}, kRapid)}, l);
  expect_within(*part, l);
  EXPECT_NEAR(part->summary.length, 10.0 * kPi * r, 1e-12);
  PartMotion<2> motion(*part);
  double fastest = 0.0;
  for (double t = 0.0; t < part->summary.duration; t += 1e-3) {
    const auto p = motion.at(t);
    EXPECT_NEAR(norm(p.position - Vec2{{-r, 0.0}}), r, 1e-15);
    fastest = std::max(fastest, norm(p.velocity));
  }
  // v²/r = 0.8 a, less the margin of the sampled curvature.
  EXPECT_LE(fastest, std::sqrt(0.8 * 0.5 * r));
  EXPECT_GT(fastest, 0.99 * std::sqrt(0.8 * 0.5 * r));
}

TEST(PartPath, HelixRisesEvenly) {
  const auto l = limits<3>();
  // Three turns clockwise seen from +y, about an axis along y.
  const auto part = planned<3>({around({{0.0, 6e-3, 0.0}}, {{0.01, 0.0, 0.0}}, -3, {{0.0, 1.0, 0.0}})}, l);
  expect_within(*part, l);
  EXPECT_NEAR(part->summary.length, std::hypot(6.0 * kPi * 0.01, 6e-3), 1e-14);
  // A quarter of a turn on: about +y clockwise from −x is towards +z … by the right hand −x goes to +z counter-clockwise.
  const Vec3 quarter = part->path.point(part->path.period() / 12.0);
  EXPECT_NEAR(quarter[0], 0.01, 1e-15);
  EXPECT_NEAR(quarter[1], 0.5e-3, 1e-15);
  EXPECT_NEAR(quarter[2], -0.01, 1e-15);
}

TEST(PartPath, ArcWithRoundedEndsPassesThroughBoth) {
  // Coordinates of four decimals: the radii at both ends differ by 0.1 µm.
  const auto l = limits<2>();
  const Vec3 end{{0.0100001, 0.01, 0.0}};
  const auto part = planned<2>({around(end, {{0.0, 0.01, 0.0}}, 1), stop({{0.01, 0.03, 0.0}})}, l);
  expect_within(*part, l);
  double nearest = 1.0;
  for (const auto& p : positions(*part, 1e-3)) nearest = std::min(nearest, std::abs(p[1] - 0.01));
  EXPECT_LT(part->summary.deviation, 1.0001e-5);
}

// Corners.

std::vector<PartMove> zigzag(double tolerance, double feed = 0.05) {
  return {to({{0.02, 0.0, 0.0}}, feed, tolerance), to({{0.02, 0.02, 0.0}}, feed, tolerance),
          to({{0.03, 0.02, 0.004}}, kRapid, tolerance), to({{0.02, 0.02, 0.001}}, feed, tolerance)};
}

TEST(PartPath, CornersAreRoundedWithinTheTolerance) {
  const auto l = limits<3>();
  for (const double tolerance : {1e-6, 1e-5, 1e-4, 1e-2}) {
    const auto part = planned<3>(zigzag(tolerance), l);
    EXPECT_EQ(part->summary.corners, 2U);
    EXPECT_EQ(part->summary.stops, 1U);  // the last corner turns by more than 150°
    expect_within(*part, l);
    const auto moves = zigzag(tolerance);
    double worst = 0.0;
    for (const auto& p : positions(*part, 1e-3)) {
      double off = 1.0;
      Vec3 from{};
      for (const auto& m : moves) {
        off = std::min(off, from_line(p, from, m.to));
        from = m.to;
      }
      worst = std::max(worst, off);
    }
    EXPECT_LE(worst, part->summary.deviation * (1.0 + 1e-9));
    EXPECT_LE(part->summary.deviation, tolerance * (1.0 + 1e-9));
    if (tolerance < 1e-3) {
      EXPECT_GT(part->summary.deviation, 0.99 * tolerance);
    }
    if (tolerance < 1e-5) continue;
    // The distance to the sharper corner: the rounded path is nearest to it in its middle.
    double to_corner = 1.0;
    for (const auto& p : positions(*part, 1e-4))
      to_corner = std::min(to_corner, norm(p - Vec3{{0.02, 0.0, 0.0}}));
    EXPECT_LE(to_corner, tolerance * 1.001);
  }
}

TEST(PartPath, LineRunsIntoArcWithoutAJumpOfAcceleration) {
  const auto l = limits<2>();
  // A slot: two lines, two half circles, all tangent.
  const double r = 5e-3;
  const auto part = planned<2>(
      {to({{0.03, 0.0, 0.0}}, kRapid),
       around({{0.03, 2.0 * r, 0.0}}, {{0.03, r, 0.0}}, 1, {{0.0, 0.0, 1.0}}, kRapid),
       to({{0.0, 2.0 * r, 0.0}}, kRapid), around({}, {{0.0, r, 0.0}}, 1, {{0.0, 0.0, 1.0}}, kRapid)},
      l);
  EXPECT_EQ(part->summary.stops, 0U);
  EXPECT_EQ(part->summary.corners, 3U);
  EXPECT_LE(part->summary.deviation, 1.0001e-5);
  expect_within(*part, l);
  double slowest = 1.0;
  PartMotion<2> motion(*part);
  for (double t = 0.3; t < part->summary.duration - 0.3; t += 1e-3)
    slowest = std::min(slowest, norm(motion.at(t).velocity));
  // What limits is the jerk where the curvature of 200/m begins: c³·κ'.
  EXPECT_GT(slowest, 0.01);
}

TEST(PartPath, CornersAreFourTimesDifferentiable) {
  const auto l = limits<3>();
  const auto part = planned<3>(
      {to({{0.02, 0.0, 0.0}}), around({{0.03, 0.01, 3e-3}}, {{0.02, 0.01, 0.0}}, 1), to({{0.03, 0.03, 0.0}})},
      l);
  ASSERT_EQ(part->summary.corners, 2U);
  for (std::size_t i = 0; i + 1 < part->segments.size(); ++i) {
    const auto& a = part->segments[i];
    const auto& b = part->segments[i + 1];
    const auto before = a.derivatives<4>(a.length);
    const auto after = b.derivatives<4>(0.0);
    double scale = 1.0;
    for (std::size_t k = 0; k <= 4; ++k) {
      // In units of the shorter of both: rounding of 1e-16 of 0.03 m, times 9·8·7·6 in the fourth derivative.
      EXPECT_LT(scale * norm(before[k] - after[k]), 1e-12) << "derivative " << k << " after segment " << i;
      scale *= std::min(a.length, b.length);
    }
  }
}

TEST(PartPath, StopsWhereItIsAsked) {
  const auto l = limits<3>();
  auto moves = zigzag(1e-5);
  moves[0] = stop(moves[0].to, 0.05, 0.25);
  moves[1].junction = Junction::kExact;
  const auto part = planned<3>(moves, l);
  EXPECT_EQ(part->summary.stops, 3U);
  EXPECT_EQ(part->summary.deviation, 0.0);
  expect_within(*part, l);
  // Each line on its own, the first with its dwell.
  double sum = 0.0;
  Vec3 from{};
  for (const PartMove& m : moves) {
    sum += plan_part<3>(from, {m}, l)->summary.duration;
    from = m.to;
  }
  EXPECT_NEAR(part->summary.duration, sum, 1e-12);
  std::size_t at_rest = 0;
  PartMotion<3> motion(*part);
  for (double t = 0.0; t < part->summary.duration; t += 1e-3) {
    const auto p = motion.at(t);
    if (norm(p.velocity) == 0.0 && norm(p.position - moves[0].to) < 1e-15) ++at_rest;
    for (std::size_t i = 0; i < 3; ++i) ASSERT_NEAR(norm(p.frame[i]), 1.0, 1e-12);
  }
  EXPECT_NEAR(static_cast<double>(at_rest), 250.0, 2.0);
}

TEST(PartPath, FramesStayOrthonormalThroughStops) {
  const auto part = planned<2>(
      {stop({{0.01, 0.0, 0.0}}), stop({{0.01, 0.01, 0.0}}), stop({{0.01, 0.0, 0.0}})}, limits<2>());
  PartMotion<2> motion(*part);
  for (double t = 0.0; t < part->summary.duration; t += 1e-3) {
    const auto p = motion.at(t);
    ASSERT_NEAR(p.frame[0][0] * p.frame[1][1] - p.frame[0][1] * p.frame[1][0], 1.0, 1e-12) << t;
    ASSERT_GE(dot(p.frame[0], p.velocity), 0.999 * norm(p.velocity)) << t;
  }
}

// Look-ahead.

TEST(PartPath, ManyShortMovesGoAsOneLongOne) {
  const auto l = limits<2>();
  std::vector<PartMove> moves;
  for (int i = 1; i <= 2000; ++i) moves.push_back(to({{1e-4 * i, 0.0, 0.0}}, kRapid));
  const auto part = planned<2>(moves, l);
  EXPECT_EQ(part->summary.corners, 0U);
  EXPECT_EQ(part->summary.moves, 2000U);
  const auto whole = planned<2>({to({{0.2, 0.0, 0.0}}, kRapid)}, l);
  EXPECT_NEAR(part->summary.duration, whole->summary.duration, 1e-9);
}

TEST(PartPath, ChordsOfACircleKeepUpItsSpeed) {
  // Between two chords the direction turns within 0.1 mm, 3 ms: what speed they allow is a matter of jerk.
  const auto l = limits<2>(0.1, 0.5, 300.0);
  const double r = 0.02;
  const double feed = 0.03;
  std::vector<PartMove> moves;
  constexpr int kChords = 1256;  // 0.1 mm each
  for (int i = 1; i <= kChords; ++i) {
    const double a = 2.0 * kPi * i / kChords;
    // As printed by the interpreter: four decimals of a millimetre.
    const auto printed = [](double x) { return 1e-7 * std::round(1e7 * x); };
    moves.push_back(to({{printed(r * std::sin(a)), printed(r * (1.0 - std::cos(a))), 0.0}}, feed));
  }
  const auto part = planned<2>(moves, l);
  EXPECT_EQ(part->summary.stops, 0U);
  expect_within(*part, l);
  const double shortest = part->summary.length / feed;
  EXPECT_GE(part->summary.duration, shortest);
  EXPECT_LT(part->summary.duration, 1.2 * shortest);
}

TEST(PartPath, NoMoveIsFasterThanItsFeed) {
  // Along one line, so that nothing else limits: slow moves within ramps, at their ends, one after the other.
  const auto l = limits<2>(0.2, 0.5, 5.0);
  for (const unsigned seed : {1U, 2U, 3U, 4U}) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> u(0.0, 1.0);
    std::vector<PartMove> moves;
    double x = 0.0;
    for (int i = 0; i < 300; ++i) {
      x += std::pow(10.0, -4.0 + 2.5 * u(random));
      moves.push_back(to({{x, 0.0, 0.0}}, 0.005 + 0.2 * std::pow(u(random), 3.0)));
    }
    const auto part = planned<2>(moves, l);
    EXPECT_EQ(part->summary.stops, 0U);
    PartMotion<2> motion(*part);
    double least = 0.0;
    std::size_t k = 0;
    double fast = 0.0;
    double total = 0.0;
    for (double t = 0.0; t < part->summary.duration; t += 5e-4) {
      const auto p = motion.at(t);
      while (k + 1 < moves.size() && p.position[0] > moves[k].to[0] + 1e-12) ++k;
      const double feed = p.position[0] < moves[k].to[0] - 1e-12
                              ? moves[k].feed
                              : std::max(moves[k].feed, moves[std::min(k + 1, moves.size() - 1)].feed);
      ASSERT_LE(p.velocity[0], feed * (1.0 + 1e-9)) << "move " << k << " at " << p.position[0];
      fast += p.velocity[0] > 0.99 * feed ? 1.0 : 0.0;
      total += 1.0;
    }
    x = 0.0;
    for (const PartMove& m : moves) {
      least += (m.to[0] - x) / m.feed;
      x = m.to[0];
    }
    EXPECT_GT(part->summary.duration, least);
    // Not the least time, but most of it at the feed.
    EXPECT_LT(part->summary.duration, 1.5 * least);
    EXPECT_GT(fast, 0.5 * total);
    expect_within(*part, l);
  }
}

TEST(PartPath, FollowsAFeedThatRisesSlowly) {
  // 10 µm each, at a feed that asks for 0.02 m/s² of 0.5: every border between two moves lies in a ramp.
  const auto l = limits<2>(0.3, 0.5, 20.0);
  std::vector<PartMove> moves;
  double least = 0.0;
  constexpr int kMoves = 5000;
  for (int i = 1; i <= 2 * kMoves; ++i) {
    const double share = i <= kMoves ? i : 2 * kMoves + 1 - i;
    moves.push_back(to({{1e-5 * i, 0.0, 0.0}}, 1e-3 + std::sqrt(0.04 * 1e-5 * share)));
    least += 1e-5 / moves.back().feed;
  }
  const auto part = planned<2>(moves, l);
  expect_within(*part, l);
  EXPECT_GT(part->summary.duration, least);
  EXPECT_LT(part->summary.duration, 1.1 * least);
}

TEST(PartPath, RandomProgramsKeepTheirLimits) {
  for (const unsigned seed : {1U, 2U, 3U, 4U, 5U, 6U}) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> u(0.0, 1.0);
    std::vector<PartMove> moves;
    Vec3 here{};
    const auto l = limits<3>();
    for (int i = 0; i < 60; ++i) {
      const double size = std::pow(10.0, -4.0 + 2.5 * u(random));
      const Vec3 way{{size * (u(random) - 0.5), size * (u(random) - 0.5), 0.2 * size * (u(random) - 0.5)}};
      PartMove m = to(here + way, u(random) < 0.1 ? kRapid : 0.001 + 0.05 * u(random), 1e-5);
      if (u(random) < 0.3) {
        // Around a point that is as far from both ends.
        const Vec3 across{{-way[1], way[0], 0.0}};
        m = around(here + way, here + 0.5 * Vec3{{way[0], way[1], 0.0}} + (u(random) - 0.5) * across,
                   u(random) < 0.5 ? 1 : -1, {{0.0, 0.0, 1.0}}, m.feed);
      }
      const double what = u(random);
      m.junction = what < 0.1 ? Junction::kStop : what < 0.2 ? Junction::kExact : Junction::kRound;
      here = here + way;
      moves.push_back(m);
    }
    const auto part = planned<3>(moves, l);
    expect_within(*part, l);
    for (const auto& s : part->segments) {
      EXPECT_NEAR(s.distance(s.length), s.extent, 1e-15);
    }
    EXPECT_LE(part->summary.deviation, 1.0001e-5);
    EXPECT_NEAR(norm(positions(*part, 1e-2).back() - here), 0.0, 1e-12);
  }
}

// Invariance.

TEST(PartPath, MirroredProgramTakesAsLong) {
  auto l = limits<3>();
  const auto forth = planned<3>(zigzag(1e-5), l);
  auto mirrored = zigzag(1e-5);
  for (auto& m : mirrored) m.to[0] = -m.to[0];
  const auto back = planned<3>(mirrored, l);
  EXPECT_NEAR(forth->summary.duration, back->summary.duration, 1e-12);
  // Twice the size at twice the limits takes as long.
  auto doubled = zigzag(2e-5, 0.1);
  for (auto& m : doubled) m.to = 2.0 * m.to;
  for (auto* v : {&l.speed, &l.acceleration, &l.jerk}) *v = 2.0 * *v;
  EXPECT_NEAR(planned<3>(doubled, l)->summary.duration, forth->summary.duration, 1e-9);
}

TEST(PartPath, ContourErrorIsTakenFromTheBranchTravelled) {
  const auto part = planned<2>(
      {to({{0.02, 0.0, 0.0}}), to({{0.02, 0.02, 0.0}}), stop({{0.0, 0.02, 0.0}}), stop({{0.0, -0.01, 0.0}})},
      limits<2>());
  const auto& path = part->path;
  // Left of the path is positive; behind and ahead does not count.
  EXPECT_NEAR(path.contour_error({{0.0102, 3e-6}}, 0.01), 3e-6, 1e-15);
  EXPECT_NEAR(path.contour_error({{0.0098, -3e-6}}, 0.01), -3e-6, 1e-15);
  // Where it crosses its beginning: on the last leg x counts, on the first y.
  const double crossing = path.period() - 0.01;
  EXPECT_NEAR(path.contour_error({{2e-6, 5e-6}}, crossing), 2e-6, 1e-15);
  EXPECT_NEAR(path.contour_error({{2e-6, 5e-6}}, 0.0), 5e-6, 1e-15);
  // At the stop in the corner: from whichever leg is nearer.
  const double corner = path.period() - 0.03;
  EXPECT_NEAR(std::abs(path.contour_error({{4e-6, 0.02 + 1e-6}}, corner)), 1e-6, 1e-15);
  EXPECT_NEAR(std::abs(path.contour_error({{1e-6, 0.02 - 4e-6}}, corner + 1e-6)), 1e-6, 1e-15);
}

/// x = (w − w0)²·A, y = (w − w0)³·B + (w − w0)·C over w = 0 … 1: a cusp at w0 where C is 0, nearly one where it is small.
path::Segment<2> cusp_at(double w0, double side) {
  constexpr double kA = 0.04;
  constexpr double kB = 0.02;
  path::Segment<2> s;
  s.kind = path::SegmentKind::kCorner;
  s.length = 0.02;
  s.c[0] = {{kA * w0 * w0, -kB * w0 * w0 * w0 - side * w0}};
  s.c[1] = {{-2.0 * kA * w0, 3.0 * kB * w0 * w0 + side}};
  s.c[2] = {{kA, -3.0 * kB * w0}};
  s.c[3] = {{0.0, kB}};
  return s;
}

// The narrowest place lies between those at which the curvature is looked at (40 in a row).
TEST(PartPath, ANarrowBendIsPassedWithinTheLimits) {
  const auto l = limits<2>();
  for (const double side : {1e-3, 1e-4, 1e-5, 1e-6, 1e-8}) {
    SCOPED_TRACE(side);
    const auto part = plan_smooth<2>({cusp_at(0.5123, side)}, 0.05, l);
    ASSERT_NE(part, nullptr);
    // The radius of the bend is side²/0.08 m: below a nanometre it is a cusp.
    EXPECT_EQ(part->summary.stops, side * side / 0.08 < 1e-9 ? 1U : 0U);
    expect_within(*part, l);
    // Only the narrow place is passed slowly: the whole takes hardly longer, however narrow it is.
    EXPECT_LT(part->summary.duration, 2.0);
  }
}

TEST(PartPath, AtACuspTheMotionStops) {
  const auto l = limits<2>();
  for (const double w0 : {0.5, 0.5123, 1.0 / 3.0}) {
    SCOPED_TRACE(w0);
    const auto part = plan_smooth<2>({cusp_at(w0, 0.0)}, 0.05, l);
    ASSERT_NE(part, nullptr);
    EXPECT_EQ(part->summary.stops, 1U);
    expect_within(*part, l);
    const auto p = positions(*part, 1e-3);
    double nearest = 1.0;
    for (const auto& q : p) nearest = std::min(nearest, norm(q));
    EXPECT_LT(nearest, 1e-9);
  }
}

// There and back along a straight line: the pieces are those of the line, and the turn has no length.
TEST(PartPath, ATurnOnTheSpotIsAStop) {
  path::Segment<2> s;
  s.kind = path::SegmentKind::kCorner;
  s.length = 0.02;
  s.c[1] = {{0.04, 0.02}};
  s.c[2] = {{-0.04, -0.02}};
  const auto l = limits<2>();
  const auto part = plan_smooth<2>({s}, 0.05, l);
  ASSERT_NE(part, nullptr);
  EXPECT_EQ(part->summary.stops, 1U);
  EXPECT_NEAR(part->summary.length, 2.0 * std::hypot(0.01, 0.005), 1e-9);
  expect_within(*part, l);
}

// Pieces of a smooth curve are the curve.
TEST(PartPath, AGentlePolynomialIsNotCut) {
  path::Segment<2> s = cusp_at(-3.0, 0.0);
  const auto part = plan_smooth<2>({s}, 0.05, limits<2>());
  ASSERT_NE(part, nullptr);
  EXPECT_EQ(part->segments.size(), 1U);
}

TEST(PartPath, WithoutAWayThereIsNothingToPlan) {
  EXPECT_EQ(plan_part<3>({}, {}, limits<3>()), nullptr);
  EXPECT_EQ(plan_part<3>({}, {stop({})}, limits<3>()), nullptr);
}

}  // namespace
}  // namespace stribeck::sim::part_path_test
