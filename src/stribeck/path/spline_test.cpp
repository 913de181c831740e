/// Tests of spline.hpp and spline_fit.hpp. Longer than 500 lines: both are judged on the same curves.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <stribeck/path/spline_fit.hpp>
#include <vector>

namespace stribeck::path::spline_test {
namespace {

using Vec3 = Vec<double, 3>;
static_assert(PathCurve<QuinticSpline<3>>);
static_assert(PathCurve<QuinticSpline<2>>);

template <std::size_t N>
struct Fitted {
  std::vector<typename QuinticSpline<N>::Segment> segments;
  QuinticSpline<N> path;
  SplineFit fit;
};

template <std::size_t N>
Fitted<N> fitted(const std::vector<Vec<double, N>>& points, const SplineOptions<N>& options = {}) {
  Fitted<N> f;
  f.segments.resize(points.size());
  std::vector<SplineRow<N>> rows(spline_rows(points.size()));
  f.fit = fit_spline<N>(points, options, f.segments, rows, f.path);
  return f;
}

/// A helix of 10 mm radius with torsion, parametrised by its arc length s.
struct Helix {
  static constexpr std::size_t kAxes = 3;
  double radius = 10e-3;
  double pitch = 3e-3;  ///< rise per radian

  template <Real T>
  [[nodiscard]] Vec<T, 3> point(const T& s) const noexcept {
    const T a = s / T(std::hypot(radius, pitch));
    return {{T(radius) * cos(a), T(radius) * sin(a), T(pitch) * a}};
  }
  [[nodiscard]] static double period() noexcept { return 60e-3; }
  [[nodiscard]] static bool closed() noexcept { return false; }

  /// Arc length of the point nearest to p, from a guess.
  [[nodiscard]] double nearest(const Vec3& p, double s) const {
    for (int i = 0; i < 20; ++i) {
      const auto q = derivatives<2>(*this, s);
      const Vec3 d = p - q[0];
      s += dot(d, q[1]) / (dot(q[1], q[1]) - dot(d, q[2]));
    }
    return s;
  }
};

/// n points over the range of the curve; uneven: steps differ up to seven-fold without order.
std::vector<double> places(double range, std::size_t n, bool uneven) {
  std::vector<double> s{0.0};
  for (std::size_t i = 1; i < n; ++i) {
    const double k = static_cast<double>(i);
    s.push_back(s.back() + (uneven ? 1.0 + 0.6 * std::sin(7.0 * k) + 0.2 * std::fmod(7.0 * k, 3.0) : 1.0));
  }
  for (double& x : s) x *= range / s[n - 1];
  return s;
}

std::vector<Vec3> points_of(const Helix& helix, const std::vector<double>& places) {
  std::vector<Vec3> p;
  for (const double s : places) p.push_back(helix.point(s));
  return p;
}

/// Largest error of the k-th derivative against the helix at the nearest point, for k = 0 … 4.
std::array<double, 5> errors(const QuinticSpline<3>& path, const Helix& helix, double margin = 0.0) {
  std::array<double, 5> worst{};
  constexpr int kSamples = 1000;
  for (int i = 0; i <= kSamples; ++i) {
    const double phi = path.period() * (margin + (1.0 - 2.0 * margin) * i / kSamples);
    const auto q = derivatives<4>(path, phi);
    const auto truth = derivatives<4>(helix, helix.nearest(q[0], phi));
    for (std::size_t k = 0; k < 5; ++k) worst[k] = std::max(worst[k], norm(q[k] - truth[k]));
  }
  return worst;
}

// Closed form.

TEST(Spline, IsExactOnQuinticPolynomials) {
  const auto truth = [](auto t) {
    using T = decltype(t);
    return Vec<T, 2>{{T(1.0) + t * (T(-2.0) + t * (T(0.5) + t * (T(3.0) + t * (T(-1.0) + t * T(0.3))))),
                      t * t * (T(2.0) + t * t * t * T(-0.2))}};
  };
  const std::vector<double> knots{0.0, 0.3, 0.4, 0.9, 1.3, 1.4, 2.0, 2.2, 3.0};
  std::vector<Vec2> points;
  for (const double t : knots) points.push_back(truth(t));
  const auto at_end = [&](double t) {
    const auto q = truth(Taylor<2>::variable(t));
    return std::array<Vec2, 2>{
        {{{q[0].derivative(1), q[1].derivative(1)}}, {{q[0].derivative(2), q[1].derivative(2)}}}};
  };
  SplineOptions<2> options;
  options.knots = knots;
  options.given = {at_end(0.0), at_end(3.0)};
  for (const SplineEnds ends : {SplineEnds::kFromPoints, SplineEnds::kGiven}) {
    options.ends = ends;
    const auto f = fitted(points, options);
    ASSERT_EQ(f.fit.status, SplineStatus::kOk);
    for (double t = 0.0; t <= 3.0; t += 0.05) {
      const auto q = derivatives<5>(f.path, t);
      const auto expected = truth(Taylor<5>::variable(t));
      // Points of size 70 are rounded to 1e-14; differences over the least step of 0.1 enlarge that tenfold and more
      // with every derivative.
      for (int k = 0; k <= 5; ++k) {
        for (std::size_t i = 0; i < 2; ++i) {
          EXPECT_NEAR(q[k][i], expected[i].derivative(k), 1e-13 * std::pow(20.0, k)) << k << " at " << t;
        }
      }
    }
  }
}

TEST(Spline, FewPointsGiveThePolynomialThroughThem) {
  const auto line = fitted<2>({{{1.0, 2.0}}, {{4.0, 6.0}}});
  EXPECT_DOUBLE_EQ(line.path.period(), 5.0);
  EXPECT_NEAR(line.path.point(2.5)[0], 2.5, 1e-15);
  EXPECT_NEAR(norm(derivatives<2>(line.path, 1.0)[2]), 0.0, 1e-15);

  const std::vector<double> knots{0.0, 1.0, 3.0};
  const auto parabola = fitted<2>({{{0.0, 0.0}}, {{1.0, 1.0}}, {{3.0, 9.0}}}, {.knots = knots});
  EXPECT_NEAR(parabola.path.point(2.0)[1], 4.0, 1e-14);
  EXPECT_NEAR(derivatives<2>(parabola.path, 2.0)[2][1], 2.0, 1e-14);
}

TEST(Spline, SeriesOfThePathIsThatOfItsPolynomial) {
  const auto f = fitted(points_of({}, places(60e-3, 20, true)));
  Taylor<6> phi = Taylor<6>::variable(0.0243);
  phi.c = {0.0243, 0.7, -0.3, 0.05, 2.0, -1.0, 0.4};
  const auto q = f.path.point(phi);
  const auto& segments = f.path.segments();
  const auto& s = segments[detail::item_at(segments, 0.0243, f.path.period())];
  for (std::size_t i = 0; i < 3; ++i) {
    Taylor<6> expected(0.0);  // by products of series
    for (std::size_t k = 6; k-- > 0;) expected = expected * (phi - s.begin) + Taylor<6>(s.c[k][i]);
    for (std::size_t k = 0; k <= 6; ++k)
      EXPECT_NEAR(q[i].c[k], expected.c[k], 1e-12 * std::abs(expected.c[k]) + 1e-18);
  }
  EXPECT_NEAR(f.path.point(0.0243)[0], q[0].c[0], 1e-17);
}

// Limit.

TEST(Spline, ConvergesWithTheSixthOrderAlsoOnUnevenPoints) {
  for (const bool uneven : {false, true}) {
    const Helix helix;
    const auto coarse = errors(fitted(points_of(helix, places(60e-3, 48, uneven))).path, helix);
    const auto fine = errors(fitted(points_of(helix, places(60e-3, 192, uneven))).path, helix);
    for (std::size_t k = 0; k < 5; ++k) {
      const double order = std::log(coarse[k] / fine[k]) / std::log(191.0 / 47.0);
      EXPECT_GE(order, 6.0 - static_cast<double>(k) - 0.3)
          << "derivative " << k << (uneven ? ", uneven" : "");
    }
  }
}

TEST(Spline, ClosedCircleConvergesWithTheSixthOrder) {
  const auto worst = [](int n) {
    std::vector<Vec2> p;
    for (int i = 0; i < n; ++i) {
      const double a = 2.0 * kPi * (i + 0.3 * std::sin(2.0 * kPi * i / n)) / n;
      p.push_back({{std::cos(a), std::sin(a)}});
    }
    const auto f = fitted<2>(p, {.closed = true});
    EXPECT_NEAR(f.path.period(), 2.0 * kPi, 1e-5);
    std::array<double, 5> e{};
    for (int i = 0; i <= 2000; ++i) {
      const auto q = derivatives<4>(f.path, f.path.period() * i / 2000);
      for (std::size_t k = 0; k < 5; ++k) e[k] = std::max(e[k], std::abs(norm(q[k]) - 1.0));
    }
    return e;
  };
  const auto coarse = worst(24);
  const auto fine = worst(48);
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_GE(std::log2(coarse[k] / fine[k]), 6.0 - static_cast<double>(k) - 0.3) << "derivative " << k;
  }
}

TEST(Spline, ChordLengthsAloneSpoilTheThirdDerivative) {
  // Why the fit goes on to arc length: with chords as knots q''' does not converge where the spacing changes.
  const Helix helix;
  const auto points = points_of(helix, places(60e-3, 192, true));
  std::vector<double> chords{0.0};
  for (std::size_t i = 1; i < points.size(); ++i)
    chords.push_back(chords.back() + norm(points[i] - points[i - 1]));
  const auto by_chords = errors(fitted(points, {.knots = chords}).path, helix);
  const auto by_arcs = errors(fitted(points).path, helix);
  EXPECT_GT(by_chords[3], 1000.0 * by_arcs[3]);
}

TEST(Spline, ParameterIsTheArcLength) {
  const Helix helix;
  const auto f = fitted(points_of(helix, places(60e-3, 192, true)));
  EXPECT_NEAR(f.path.period(), 60e-3, 1e-12);
  for (int i = 0; i <= 1000; ++i) {
    EXPECT_NEAR(norm(derivatives<1>(f.path, f.path.period() * i / 1000)[1]), 1.0, 1e-7);
  }
}

TEST(Spline, FourDerivativesAreContinuousAtTheKnots) {
  for (const bool closed : {false, true}) {
    std::vector<Vec3> points = points_of({}, places(60e-3, 40, true));
    const auto f = fitted(points, {.closed = closed});
    const auto& s = f.path.segments();
    for (std::size_t i = closed ? 0 : 1; i < s.size(); ++i) {
      const auto& before = s[i > 0 ? i - 1 : s.size() - 1];
      const double end = i > 0 ? s[i].begin : f.path.period();
      const auto left = detail::polynomial(before.c, Taylor<5>::variable(end - before.begin));
      for (std::size_t a = 0; a < 3; ++a) {
        for (std::size_t k = 0; k <= 4; ++k) {
          // Rounding of points of 10 mm over steps of 0.4 mm and more: 2e-18/h^k, times what the system adds.
          EXPECT_NEAR(left[a].c[k], s[i].c[k][a], 1e-16 * std::pow(0.4e-3, -static_cast<double>(k)))
              << i << ", " << k;
        }
      }
      double jump = 0.0;
      for (std::size_t a = 0; a < 3; ++a) jump = std::max(jump, std::abs(left[a].c[5] - s[i].c[5][a]));
      EXPECT_GT(jump, 1e-3);  // the fifth is not: it is no single polynomial
    }
  }
}

TEST(Spline, UnequalSpacingIsHarmlessOrRefused) {
  const auto worst = [](double least, SplineStatus expected) {
    std::vector<Vec2> p;
    double x = 0.0;
    for (int i = 0; i < 40; ++i) {
      x += i % 3 == 0 ? least : 0.3;
      p.push_back({{x, std::sin(x)}});
    }
    const auto f = fitted(p);
    EXPECT_EQ(f.fit.status, expected);
    double off = 0.0;
    for (int i = 0; i <= 1000 && f.fit.status == SplineStatus::kOk; ++i) {
      const Vec2 q = f.path.point(f.path.period() * i / 1000);
      off = std::max(off, std::abs(q[1] - std::sin(q[0])));
    }
    return off;
  };
  const double even = worst(0.3, SplineStatus::kOk);
  for (const double least : {1e-2, 1e-4, 1e-6})
    EXPECT_LT(worst(least, SplineStatus::kOk), 2.0 * even) << least;
  worst(1e-8, SplineStatus::kTooUneven);
}

// Smoothing.

std::vector<Vec3> noisy(const Helix& helix, std::size_t n, double deviation) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0.0, deviation);
  auto p = points_of(helix, places(60e-3, n, false));
  for (auto& q : p) {
    for (std::size_t i = 0; i < 3; ++i) q[i] += noise(random);
  }
  return p;
}

TEST(Spline, ToleranceTakesNoiseOutOfTheDerivatives) {
  const Helix helix;
  const auto points = noisy(helix, 601, 1e-6);
  const auto exact = fitted(points);
  const auto smoothed = fitted(points, {.tolerance = 5e-6});
  EXPECT_EQ(exact.fit.deviation, 0.0);
  EXPECT_LE(smoothed.fit.deviation, 5e-6);
  EXPECT_GT(smoothed.fit.deviation, 4.9e-6);
  // The ends, where points stand on one side only, are several times worse than the rest.
  const auto noise = errors(exact.path, helix, 0.1);
  const auto rest = errors(smoothed.path, helix, 0.1);
  const auto whole = errors(smoothed.path, helix);
  const auto truth = derivatives<4>(helix, 0.03);
  EXPECT_GT(noise[3], 100.0 * norm(truth[3]));
  EXPECT_LT(rest[0], 1.2e-6);
  EXPECT_LT(rest[2], 0.02 * norm(truth[2]));
  EXPECT_LT(rest[3], 0.15 * norm(truth[3]));
  EXPECT_LT(whole[0], 3e-6);
  EXPECT_LT(whole[3], norm(truth[3]));
}

TEST(Spline, ToleranceBoundsTheDistanceToThePoints) {
  const auto points = noisy({}, 300, 1e-6);
  for (const double tolerance : {1e-12, 0.5e-6, 3e-6, 1e-3}) {
    for (const bool closed : {false, true}) {
      const auto f = fitted(points, {.closed = closed, .tolerance = tolerance});
      ASSERT_EQ(f.fit.status, SplineStatus::kOk);
      double farthest = 0.0;
      for (std::size_t i = 0; i < f.path.segments().size(); ++i) {
        farthest = std::max(farthest, norm(f.path.point(f.path.segments()[i].begin) - points[i]));
      }
      EXPECT_LE(farthest, tolerance * (1.0 + 1e-9));
      EXPECT_LE(f.fit.deviation, tolerance);
    }
  }
}

TEST(Spline, ParabolaIsSmoothedWithoutChange) {
  // ∫|q'''|² is 0 on it: any tolerance leaves it where it is. Knots are given, for along its arc it is none.
  for (const std::size_t n : {50U, 4000U}) {
    const std::vector<double> knots = places(3.0, n, true);
    std::vector<Vec2> points;
    for (const double t : knots) points.push_back({{t, t * t - t}});
    const auto f = fitted(points, {.tolerance = 0.1, .knots = knots});
    EXPECT_LT(f.fit.deviation, 1e-6) << n;  // λ of 1e12 costs ten of sixteen digits at most
  }
}

TEST(Spline, MostSmoothingIsNotRounding) {
  // Points a micrometre apart with noise of one, steps of all sizes therefore, and a tolerance that asks for all smoothing
  // there is: what is taken off is noise, which along a parameter of noisy chords reaches 10.3 µm, not the error of the
  // solution (with λ up to 1e15 13 µm, on other points 119 µm).
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0.0, 1e-6);
  std::vector<Vec3> points;
  for (int i = 0; i < 4000; ++i) {
    const double a = 1e-5 * i;
    points.push_back({{0.1 * std::cos(a) + noise(random), 0.1 * std::sin(a) + noise(random), noise(random)}});
  }
  const auto f = fitted(points, {.tolerance = 1e-3});
  EXPECT_GT(f.fit.deviation, 4e-6);
  EXPECT_LT(f.fit.deviation, 12e-6);
}

// Invariance.

Vec3 turned(const Vec3& p) {
  const double c = std::cos(0.7);
  const double s = std::sin(0.7);
  const Vec3 q{{c * p[0] - s * p[1], s * p[0] + c * p[1], p[2]}};
  return {{q[0], c * q[1] - s * q[2], s * q[1] + c * q[2]}};
}

TEST(Spline, MovesWithItsPoints) {
  const auto points = noisy({}, 100, 20e-6);
  auto moved = points;
  for (auto& p : moved) p = turned(p) + Vec3{{0.02, -0.05, 0.01}};
  auto reversed = points;
  std::reverse(reversed.begin(), reversed.end());
  auto larger = points;
  for (auto& p : larger) p = 1000.0 * p;
  for (const double tolerance : {0.0, 50e-6}) {
    const auto f = fitted(points, {.tolerance = tolerance});
    const auto g = fitted(moved, {.tolerance = tolerance});
    const auto r = fitted(reversed, {.tolerance = tolerance});
    const auto l = fitted(larger, {.tolerance = 1000.0 * tolerance});
    for (int i = 0; i <= 200; ++i) {
      const double phi = f.path.period() * i / 200;
      const auto q = derivatives<3>(f.path, phi);
      const auto m = derivatives<3>(g.path, phi * g.path.period() / f.path.period());
      const auto back = derivatives<3>(r.path, (f.path.period() - phi) * r.path.period() / f.path.period());
      const auto big = derivatives<3>(l.path, phi * l.path.period() / f.path.period());
      // The search for λ may take the last of its steps differently: one part in 1400 of λ.
      const double close = tolerance > 0.0 ? 1e-3 * tolerance : 1e-15;
      EXPECT_LT(norm(m[0] - turned(q[0]) - Vec3{{0.02, -0.05, 0.01}}), close);
      EXPECT_LT(norm(back[0] - q[0]), close);
      EXPECT_LT(norm(1e-3 * big[0] - q[0]), close);
      EXPECT_LT(norm(m[3] - turned(q[3])), 1e-3 * norm(q[3]) + 10.0);
      EXPECT_LT(norm(back[3] + q[3]), 1e-3 * norm(q[3]) + 10.0);
    }
  }
}

TEST(Spline, ClosedPathHasNoSpecialPoint) {
  std::vector<Vec3> points;
  for (int i = 0; i < 50; ++i) {
    const double a = 2.0 * kPi * i / 50;
    points.push_back({{std::cos(a), 0.7 * std::sin(a) + 0.02 * std::cos(31.0 * i), 0.3 * std::sin(2.0 * a)}});
  }
  auto shifted = points;
  std::rotate(shifted.begin(), shifted.begin() + 17, shifted.end());
  for (const double tolerance : {0.0, 0.02}) {
    const auto f = fitted(points, {.closed = true, .tolerance = tolerance});
    const auto g = fitted(shifted, {.closed = true, .tolerance = tolerance});
    EXPECT_NEAR(f.path.period(), g.path.period(), 1e-3 * tolerance + 1e-13);
    const double start = f.path.segments()[17].begin;
    for (int i = 0; i <= 200; ++i) {
      const double phi = f.path.period() * i / 200;
      EXPECT_LT(norm(g.path.point(phi) - f.path.point(phi + start)), 1e-3 * tolerance + 1e-12);
    }
    EXPECT_LT(norm(f.path.point(0.3) - f.path.point(0.3 - f.path.period())), 1e-14);
    EXPECT_LT(norm(f.path.point(0.3) - f.path.point(0.3 + 2.0 * f.path.period())), 1e-14);
  }
}

TEST(Spline, SegmentIsFoundFromAnywhere) {
  std::vector<QuinticSpline<1>::Segment> items(1000);
  double begin = 0.0;
  for (std::size_t i = 0; i < items.size(); ++i) {
    items[i].begin = begin;
    begin += i < 900 ? 1e-3 : 5.0;
  }
  const std::span<const QuinticSpline<1>::Segment> all(items);
  for (std::size_t i = 0; i < items.size(); ++i) {
    EXPECT_EQ(detail::item_at(all, items[i].begin, begin), i);
    const std::size_t before = i > 0 ? i - 1 : 0;
    EXPECT_EQ(detail::item_at(all, std::nextafter(items[i].begin, -1.0), begin), before);
  }
  EXPECT_EQ(detail::item_at(all, -1.0, begin), 0U);
  EXPECT_EQ(detail::item_at(all, 2.0 * begin, begin), items.size() - 1);
}

// Independent reference: SciPy 1.10. p(t) as below; natural: make_interp_spline(t, p, k=5, bc_type=([(3, 0), (4, 0)],)*2);
// periodic: bc_type='periodic', the first point again at 13.5; smoothed: quintic B-splines on these knots, Gauss-Legendre of
// |q'''|² in five points, dense normal equations, λ = 0.0511953749 by brentq so that the largest distance is 0.05.
struct Reference {
  double at;
  Vec3 value;
  Vec3 third;
};

void expect_references(const SplineOptions<3>& with, const std::vector<Reference>& references,
                       double tolerance) {
  std::vector<double> knots{0.0, 1.0, 2.5, 3.0, 4.2, 5.5, 6.0, 7.5, 9.0, 9.6, 11.0, 12.0};
  std::vector<Vec3> points;
  for (std::size_t k = 0; k < knots.size(); ++k) {
    const double i = static_cast<double>(k);
    const double t = knots[k];
    points.push_back(
        {{std::cos(0.5 * t) + 0.05 * std::sin(40.0 * i), std::sin(0.4 * t) + 0.05 * std::cos(77.0 * i),
          0.1 * t + 0.05 * std::sin(5.0 * i * i)}});
  }
  if (with.closed) knots.push_back(13.5);
  SplineOptions<3> options = with;
  options.knots = knots;
  options.ends = SplineEnds::kNatural;
  const auto f = fitted(points, options);
  ASSERT_EQ(f.fit.status, SplineStatus::kOk);
  for (const auto& r : references) {
    const auto q = derivatives<3>(f.path, r.at);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(q[0][i], r.value[i], tolerance) << r.at;
      EXPECT_NEAR(q[3][i], r.third[i], 10.0 * tolerance) << r.at;
    }
  }
}

TEST(Spline, NaturalEndsAsSciPy) {
  expect_references({},
                    {{0.3,
                      {{1.032747456593084, 0.1671234558326643, -0.0006971218363307798}},
                      {{0.042992785383818954, 0.015774551144872424, -0.009178057342090457}}},
                     {2.7,
                      {{0.19900751943008027, 0.8528003327072884, 0.31917938364731396}},
                      {{-0.7815367509717576, -0.5274986826367452, -0.10000034423375281}}},
                     {6.6,
                      {{-0.8954123359260039, 0.41876963189013616, 0.6278706338705051}},
                      {{0.227332277951631, -0.023594462780838328, -0.209531052402899}}},
                     {11.9,
                      {{0.9347692816959049, -0.9900541376149004, 1.2218025093273008}},
                      {{0.002809571190809379, -0.0006431282866827814, 0.002397194080330678}}}},
                    1e-12);
}

TEST(Spline, PeriodicAsSciPy) {
  expect_references({.closed = true},
                    {{0.3,
                      {{0.9966011218796191, 0.199341899042143, -0.08377336189186499}},
                      {{-0.7075064054535735, 0.48850662853093857, -1.3712895790667223}}},
                     {6.6,
                      {{-0.8946724363250279, 0.4173420412770077, 0.6313151339154586}},
                      {{0.2084885157417544, 0.006584122197319679, -0.283019449528045}}},
                     {13.2,
                      {{1.0063779747934205, -0.15184358580707238, 0.20465493128083492}},
                      {{0.20177233063020683, -1.0134005422940469, 1.9979347587286695}}}},
                    1e-12);
}

TEST(Spline, SmoothedAsByDenseNormalEquations) {
  // λ is found to one part in 1400, which moves points by that part of 0.05 or less.
  expect_references({.tolerance = 0.05},
                    {{0.3,
                      {{1.0035062440745481, 0.15351803273802636, 0.006087968900762746}},
                      {{0.008342618559503384, 0.00018079450068712172, -0.006779859333002163}}},
                     {2.7,
                      {{0.21259750908732125, 0.8624290643014028, 0.3030606962972997}},
                      {{0.06045575548564459, -0.12278332151233401, 0.0010657795472181313}}},
                     {6.6,
                      {{-0.9855167427032652, 0.45391266119716367, 0.6382202844989394}},
                      {{0.013880123604637633, 0.005996690817379802, -0.02235564390560526}}},
                     {11.9,
                      {{0.9426349465406453, -0.9960323515890545, 1.2255133030497145}},
                      {{0.00020444375367389966, 0.0004476252932050784, 0.0004009265281794683}}}},
                    2e-5);
}

// Errors.

TEST(Spline, EveryNumberIsLookedAt) {
  const std::vector<Vec2> good{{{0.0, 0.0}}, {{1.0, 0.0}}, {{1.0, 1.0}}, {{0.0, 1.0}}};
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < good.size(); ++i) {
    auto bad = good;
    bad[i][i % 2] = kNan;
    const SplineFit fit = fitted(bad, SplineOptions<2>{}).fit;
    EXPECT_EQ(fit.status, SplineStatus::kNotFinite) << i;
    EXPECT_EQ(fit.index, i);
    std::vector<double> knots{0.0, 1.0, 2.0, 3.0};
    knots[i] = i == 3 ? std::numeric_limits<double>::infinity() : kNan;
    SplineOptions<2> o;
    o.knots = knots;
    const SplineFit with_knots = fitted(good, o).fit;
    EXPECT_EQ(with_knots.status, SplineStatus::kNotFinite) << i;
    EXPECT_EQ(with_knots.index, i);
  }
  // A number of the ends counts where the ends are given, and only there.
  for (std::size_t end = 0; end < 2; ++end) {
    for (std::size_t order = 0; order < 2; ++order) {
      SplineOptions<2> o;
      o.given[end][order] = {{0.0, kNan}};
      for (const SplineEnds ends : {SplineEnds::kFromPoints, SplineEnds::kNatural}) {
        o.ends = ends;
        EXPECT_EQ(fitted(good, o).fit.status, SplineStatus::kOk);
      }
      o.ends = SplineEnds::kGiven;
      EXPECT_EQ(fitted(good, o).fit.status, SplineStatus::kNotFinite);
      EXPECT_EQ(fitted(good, o).fit.index, end == 0 ? 0U : 3U);
      o.closed = true;
      EXPECT_EQ(fitted(good, o).fit.status, SplineStatus::kOk);
    }
  }
}

TEST(Spline, HasTheEndsThatAreGiven) {
  const std::vector<Vec2> points{{{0.0, 0.0}}, {{1.0, 0.2}}, {{1.7, 1.0}}, {{1.2, 2.0}}, {{0.0, 2.5}}};
  const std::vector<double> knots{0.0, 1.0, 2.1, 3.2, 4.5};
  SplineOptions<2> o;
  o.ends = SplineEnds::kGiven;
  o.knots = knots;
  o.given = {{{Vec2{{0.7, -0.4}}, Vec2{{0.3, 0.9}}}, {Vec2{{-0.8, 0.5}}, Vec2{{-0.2, 0.6}}}}};
  const auto f = fitted(points, o);
  ASSERT_EQ(f.fit.status, SplineStatus::kOk);
  for (std::size_t end = 0; end < 2; ++end) {
    const auto d = derivatives<2>(f.path, end == 0 ? 0.0 : knots.back());
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_NEAR(d[1][i], o.given[end][0][i], 1e-12);
      EXPECT_NEAR(d[2][i], o.given[end][1][i], 1e-12);
    }
  }
}

TEST(Spline, SaysWhatIsWrongAndWhere) {
  const std::vector<Vec2> good{{{0.0, 0.0}}, {{1.0, 0.0}}, {{1.0, 1.0}}, {{0.0, 1.0}}};
  const auto status = [](std::vector<Vec2> p, const SplineOptions<2>& o, std::size_t index) {
    const auto f = fitted(p, o);
    EXPECT_EQ(f.fit.index, index) << describe(f.fit.status);
    EXPECT_EQ(f.fit.deviation, 0.0) << describe(f.fit.status);
    EXPECT_TRUE(f.path.segments().empty() || f.fit.status == SplineStatus::kOk);
    return f.fit.status;
  };
  const auto with = [&](std::size_t i, Vec2 p) {
    auto bad = good;
    bad[i] = p;
    return bad;
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(status(good, {}, 0), SplineStatus::kOk);
  EXPECT_EQ(status({}, {}, 0), SplineStatus::kTooFewPoints);
  EXPECT_EQ(status({good[0]}, {}, 1), SplineStatus::kTooFewPoints);
  EXPECT_EQ(status({good[0], good[1]}, {.closed = true}, 2), SplineStatus::kTooFewPoints);
  EXPECT_EQ(status(with(2, {{1.0, kNan}}), {}, 2), SplineStatus::kNotFinite);
  EXPECT_EQ(status(with(2, {{1e200, 1.0}}), {}, 2), SplineStatus::kNotFinite);
  EXPECT_EQ(status(with(2, good[1]), {}, 2), SplineStatus::kEqualNeighbours);
  EXPECT_EQ(status(with(3, good[0]), {.closed = true}, 0), SplineStatus::kEqualNeighbours);
  EXPECT_EQ(status(with(2, {{1.0, 1e-90}}), {}, 1), SplineStatus::kTooUneven);
  EXPECT_EQ(status(with(2, {{1.0, 1e-9}}), {}, 1), SplineStatus::kTooUneven);
  EXPECT_EQ(status(good, {.tolerance = -1.0}, 0), SplineStatus::kToleranceNegative);
  EXPECT_EQ(status(good, {.tolerance = kNan}, 0), SplineStatus::kToleranceNegative);
  const std::vector<double> equal{0.0, 1.0, 1.0, 2.0};
  EXPECT_EQ(status(good, {.knots = equal}, 2), SplineStatus::kKnotsDoNotAscend);
  const std::vector<double> few{0.0, 1.0, 2.0};
  EXPECT_EQ(status(good, {.knots = few}, 0), SplineStatus::kKnotsDoNotAscend);
  SplineOptions<2> given;
  given.ends = SplineEnds::kGiven;
  given.given[1][0] = {{kNan, 0.0}};
  EXPECT_EQ(status(good, given, 3), SplineStatus::kNotFinite);

  std::vector<QuinticSpline<2>::Segment> segments(2);
  std::vector<SplineRow<2>> rows(5);
  QuinticSpline<2> path;
  const SplineFit small = fit_spline<2>(good, {}, segments, rows, path);
  EXPECT_EQ(small.status, SplineStatus::kMemoryTooSmall);
  EXPECT_EQ(small.deviation, 0.0);
  for (int i = 0; i <= static_cast<int>(SplineStatus::kMemoryTooSmall); ++i) {
    EXPECT_NE(describe(static_cast<SplineStatus>(i)), "unknown status");
  }
}

/// A line, a quarter of a circle of 10 mm in twenty steps, and a line: what CAM writes. `line`: length of both lines in one step.
std::vector<Vec2> line_arc_line(double line) {
  std::vector<Vec2> points{{{0.1 - line, 0.0}}, {{0.1, 0.0}}};
  for (int i = 1; i <= 20; ++i) {
    const double a = i * 3.14159265358979 / 40.0;
    points.push_back({{0.1 + 0.01 * std::sin(a), 0.01 - 0.01 * std::cos(a)}});
  }
  points.push_back({{0.11, 0.01 + line}});
  return points;
}

// The ends of a polynomial through six uneven points left the line of 20 mm by 24 mm, and one of 100 mm by more than the universe is wide.
TEST(SplineFit, LongStepsBesideShortOnesAreKeptOrRefused) {
  for (const double length : {1e-3, 3e-3, 8e-3, 20e-3, 0.1}) {
    const Fitted<2> f = fitted<2>(line_arc_line(length));
    if (f.fit.status == SplineStatus::kLeavesPoints) {
      EXPECT_GT(length, 10e-3) << length;
      EXPECT_LT(f.fit.index, 23U);
      continue;
    }
    ASSERT_EQ(f.fit.status, SplineStatus::kOk) << length;
    double farthest = 0.0;
    for (int k = 0; k <= 1000; ++k) {
      const Vec2 q = f.path.point(f.path.period() * k / 1000.0);
      // From the line along x, the quarter of the circle and the line along y.
      const double x = q[0] - 0.1, y = q[1] - 0.01;
      const double from_line =
          std::min({std::hypot(std::max(0.0, x), q[1]), std::hypot(x - 0.01, std::min(0.0, y)),
                    x > 0.0 && y < 0.0 ? std::abs(std::hypot(x, y) - 0.01) : 1.0});
      farthest = std::max(farthest, from_line);
    }
    EXPECT_LT(farthest, 0.03 * length) << length;
  }
}

}  // namespace
}  // namespace stribeck::path::spline_test
