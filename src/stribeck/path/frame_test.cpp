/// Tests of frame.hpp. Longer than 500 lines: three kinds of frame, each on plane, space and standstill.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <stribeck/path/contour_error.hpp>
#include <stribeck/path/fourier.hpp>
#include <stribeck/path/frame.hpp>
#include <stribeck/path/reference.hpp>
#include <vector>

namespace stribeck::path::frame_test {
namespace {

using V3 = Vec<double, 3>;

/// (4.25) of the thesis: plane (y = z), with inflections.
Fourier<3> printed_free_form() {
  Fourier<3> c;
  c.axis[0].terms = {Harmonic{10e-3, 3.0, 1.256 - 0.5 * kPi}};
  c.axis[1].terms = {Harmonic{15e-3, 1.0, -0.5 * kPi}};
  c.axis[2].terms = {Harmonic{15e-3, 1.0, -0.5 * kPi}};
  return c;
}

/// A path with torsion: 10 (cos, sin) and 3 sin 2φ, in mm.
Fourier<3> saddle() {
  Fourier<3> c;
  c.axis[0].terms = {Harmonic{10e-3, 1.0, 0.0}};
  c.axis[1].terms = {Harmonic{10e-3, 1.0, -0.5 * kPi}};
  c.axis[2].terms = {Harmonic{3e-3, 2.0, -0.5 * kPi}};
  return c;
}

Fourier<5> five_axes() {
  Fourier<5> c;
  for (std::size_t i = 0; i < 5; ++i)
    c.axis[i].terms = {Harmonic{10e-3, 1.0, 0.9 * static_cast<double>(i)},
                       Harmonic{2e-3, 2.0, static_cast<double>(i * i)}};
  return c;
}

struct Helix {
  static constexpr std::size_t kAxes = 3;
  double radius = 10e-3;
  double pitch = 8e-3;  ///< rise per radian

  [[nodiscard]] double period() const noexcept { return 4.0 * kPi; }
  [[nodiscard]] static constexpr bool closed() noexcept { return false; }
  template <Real T>
  [[nodiscard]] Vec<T, 3> point(const T& phi) const noexcept {
    return {{radius * cos(phi), radius * sin(phi), pitch * phi}};
  }
};

/// A straight line, then a bend (φ − 1)⁵ into a third direction: C⁴, curvature 0 up to φ = 1.
struct LineThenBend {
  static constexpr std::size_t kAxes = 3;
  [[nodiscard]] double period() const noexcept { return 2.0; }
  [[nodiscard]] static constexpr bool closed() noexcept { return false; }
  template <Real T>
  [[nodiscard]] Vec<T, 3> point(const T& phi) const noexcept {
    const T u = phi - T(1.0);
    const T bend = select(u > T(0.0), u * u * u * u * u, T(0.0));
    return {{10e-3 * phi, 4e-3 * phi + 20e-3 * bend, -20e-3 * bend}};
  }
};

template <PathCurve C>
Vec<double, C::kAxes> tangent(const C& curve, double phi) {
  const auto q = derivatives<1>(curve, phi);
  return (1.0 / norm(q[1])) * q[1];
}

template <std::size_t N>
double orthonormality(const Mat<double, N>& m) {
  double worst = 0.0;
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t k = 0; k < N; ++k)
      worst = std::max(worst, std::abs(dot(m[i], m[k]) - (i == k ? 1.0 : 0.0)));
  }
  return worst;
}

/// The transported frame at `to`, from the first one at `from` in `steps` steps.
template <PathCurve C>
Mat<double, C::kAxes> carried(const C& curve, double from, double to, int steps) {
  const auto q = derivatives<2>(curve, from);
  auto rt = first_frame(tangent(curve, from), q[2]);
  for (int k = 0; k < steps; ++k) {
    const double a = from + (to - from) * k / steps;
    const double b = from + (to - from) * (k + 1) / steps;
    rt = transport(rt, curve.point(a), curve.point(b), tangent(curve, b));
  }
  return rt;
}

// ---- derivatives

/// Largest difference of R' and R'' from central differences of R, R' of neighbouring frames.
template <PathCurve C>
double derivative_error(const C& curve, double phi) {
  // With torsion, the neighbouring frames must be transported from this point.
  const double h = 1e-5;
  const auto here = carried(curve, 0.0, phi, 2000);
  const auto at = [&](double p) {
    auto rt = here;
    for (int k = 0; k < 10; ++k) {
      const double a = phi + (p - phi) * k / 10;
      const double b = phi + (p - phi) * (k + 1) / 10;
      rt = transport(rt, curve.point(a), curve.point(b), tangent(curve, b));
    }
    return transported_frame(series<3>(curve, p), rt);
  };
  const auto f = at(phi);
  const auto up = at(phi + h);
  const auto down = at(phi - h);
  double worst = orthonormality(f.rt);
  for (std::size_t i = 0; i < C::kAxes; ++i) {
    for (std::size_t k = 0; k < C::kAxes; ++k) {
      worst = std::max(worst, std::abs(f.first[i][k] - (up.rt[i][k] - down.rt[i][k]) / (2 * h)));
      worst = std::max(worst, std::abs(f.second[i][k] - (up.first[i][k] - down.first[i][k]) / (2 * h)));
    }
  }
  return worst;
}

TEST(TransportedFrame, DerivativesEqualCentralDifferences) {
  // Differences are off by h²/6 of the third derivative, 4e4 where the trifolium is sharp.
  for (const double phi : {0.3, 1.1, 2.9}) {
    EXPECT_LT(derivative_error(Curve{Shape::kTrifolium, 10e-3}, phi), 1e-6) << phi;
    EXPECT_LT(derivative_error(saddle(), phi), 1e-6) << phi;
    EXPECT_LT(derivative_error(five_axes(), phi), 1e-6) << phi;
    EXPECT_LT(derivative_error(Helix{}, phi), 1e-6) << phi;
  }
}

TEST(FrenetFrame, DerivativesEqualCentralDifferencesAsPrintedToo) {
  for (const bool as_printed : {false, true}) {
    for (const double phi : {0.4, 1.1, 2.8}) {
      const double h = 1e-4;
      const auto at = [&](double p) {
        return frenet_frame(series<4>(saddle(), p), as_printed, identity<3>());
      };
      const auto f = at(phi);
      const auto up = at(phi + h);
      const auto down = at(phi - h);
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
          EXPECT_NEAR(f.first[i][k], (up.rt[i][k] - down.rt[i][k]) / (2 * h), 1e-6);
          EXPECT_NEAR(f.second[i][k], (up.first[i][k] - down.first[i][k]) / (2 * h), 1e-6);
        }
      }
      EXPECT_TRUE(as_printed || orthonormality(f.rt) < 1e-15);
    }
  }
}

TEST(PrintedFrame, IsTheFormulaOfTheThesisAndNoRotation) {
  // (4.3) typed once more, with plain vectors: b = t × q̈/|q̈|, n = b × t.
  const auto curve = printed_free_form();
  for (const double phi : {0.2, 0.9, 2.0}) {
    const auto q = derivatives<2>(curve, phi);
    const auto f = frenet_frame(series<4>(curve, phi), true, identity<3>());
    const V3 t = (1.0 / norm(q[1])) * q[1];
    const V3 b = cross(t, (1.0 / norm(q[2])) * q[2]);
    const V3 n = cross(b, t);
    EXPECT_LT(norm(f.rt[0] - t) + norm(f.rt[1] - n) + norm(f.rt[2] - b), 1e-14);
    EXPECT_LT(norm(f.rt[2]), 0.999);  // shorter than 1: the gains across the path shrink by this
  }
}

TEST(PrintedFrame, UsesTheAxesOfTheThesisOnAStraightLine) {
  struct Line {
    V3 way;
    [[nodiscard]] Vec<Taylor<4>, 3> point(const Taylor<4>& p) const noexcept {
      return {{way[0] * p, way[1] * p, way[2] * p}};
    }
  };
  const auto frame = [](const V3& way) {
    return frenet_frame(Line{way}.point(Taylor<4>::variable(0.3)), true, identity<3>()).rt;
  };
  EXPECT_LT(norm(frame({{0.6, 0.8, 0.0}})[2] - V3{{0.0, 0.0, -0.8}}), 1e-15);  // t × e_x, not normalised
  EXPECT_LT(norm(frame({{2.0, 0.0, 0.0}})[2] - V3{{0.0, 0.0, 1.0}}), 1e-15);   // e_x × e_y
}

TEST(FrenetFrame, HoldsWhatItIsGivenWhereThereIsNoNormal) {
  Mat<double, 3> held;
  held[1] = {{0.0, 0.0, 1.0}};
  held[2] = {{0.0, -1.0, 0.0}};
  const auto f = frenet_frame(series<4>(LineThenBend{}, 0.5), false, held);
  EXPECT_EQ(f.rt[1], held[1]);
  EXPECT_EQ(norm(f.first[1]) + norm(f.second[2]), 0.0);
}

// ---- transport

/// Frenet's frame on a helix turns about the tangent by torsion·arc, so that turning it back gives the transported one.
double helix_error(int steps) {
  const Helix helix;
  const double torsion_per_phi =
      helix.pitch / std::hypot(helix.radius, helix.pitch);  // τ·ds/dφ = p/(r² + p²)·√(r² + p²)
  const double end = 4.0 * kPi;
  const auto begin = frenet_frame(series<4>(helix, 0.0), false, identity<3>()).rt;
  const auto frenet = frenet_frame(series<4>(helix, end), false, identity<3>()).rt;
  const auto got = carried(helix, 0.0, end, steps);
  const double c = std::cos(torsion_per_phi * end);
  const double s = std::sin(torsion_per_phi * end);
  EXPECT_LT(norm(carried(helix, 0.0, 0.0, 1)[1] - begin[1]), 1e-14);
  return norm(got[1] - (c * frenet[1] - s * frenet[2])) + norm(got[2] - (s * frenet[1] + c * frenet[2]));
}

TEST(TransportedFrame, IsFrenetsTurnedBackByTheIntegralOfTorsion) { EXPECT_LT(helix_error(20000), 1e-11); }

TEST(TransportedFrame, DoubleReflectionIsOfFourthOrder) {
  const double order = std::log2(helix_error(100) / helix_error(200));
  RecordProperty("order", std::to_string(order));
  EXPECT_NEAR(order, 4.0, 0.1);
}

TEST(TransportedFrame, NormalsNeverTurnAboutTheTangent) {
  // What defines it: n_i'·n_k = 0, for any number of axes.
  const auto rt = carried(five_axes(), 0.0, 2.0, 500);
  const auto f = transported_frame(series<3>(five_axes(), 2.0), rt);
  for (std::size_t i = 1; i < 5; ++i) {
    for (std::size_t k = 1; k < 5; ++k) EXPECT_NEAR(dot(f.first[i], f.rt[k]), 0.0, 1e-12);
  }
}

TEST(TransportedFrame, StaysOrthonormalOverManySteps) {
  const auto curve = five_axes();
  auto rt = first_frame(tangent(curve, 0.0), derivatives<2>(curve, 0.0)[2]);
  for (int k = 0; k < 20000; ++k) {
    const double b = 1e-3 * (k + 1);
    rt = transport(rt, curve.point(b - 1e-3), curve.point(b), tangent(curve, b));
  }
  EXPECT_LT(orthonormality(rt), 1e-14);
}

TEST(TransportedFrame, ComesBackOnTheSameWay) {
  // Invariance in time: forth and back over the same points is no turn at all.
  const auto curve = saddle();
  const auto begin = carried(curve, 0.0, 0.0, 1);
  auto rt = begin;
  const auto go = [&](double a, double b) {
    rt = transport(rt, curve.point(a), curve.point(b), tangent(curve, b));
  };
  for (int k = 0; k < 300; ++k) go(0.01 * k, 0.01 * (k + 1));
  EXPECT_GT(norm(rt[1] - begin[1]), 0.1);
  for (int k = 300; k > 0; --k) go(0.01 * k, 0.01 * (k - 1));
  EXPECT_LT(norm(rt[1] - begin[1]) + norm(rt[2] - begin[2]), 1e-12);
}

TEST(TransportedFrame, TurnsWithTheWorld) {
  const double c = std::cos(0.7);
  const double s = std::sin(0.7);
  const auto turn = [&](const V3& v) { return V3{{v[0], c * v[1] - s * v[2], s * v[1] + c * v[2]}}; };
  const auto curve = saddle();
  auto rt = carried(curve, 0.0, 0.0, 1);
  auto turned = rt;
  for (auto& row : turned.row) row = turn(row);
  for (int k = 0; k < 100; ++k) {
    const V3 from = curve.point(0.02 * k);
    const V3 to = curve.point(0.02 * (k + 1));
    const V3 t = tangent(curve, 0.02 * (k + 1));
    rt = transport(rt, from, to, t);
    turned = transport(turned, turn(from), turn(to), turn(t));
  }
  for (std::size_t i = 0; i < 3; ++i) EXPECT_LT(norm(turn(rt[i]) - turned[i]), 1e-13);
}

TEST(TransportedFrame, AChordOfRoundingErrorsDoesNotTurnIt) {
  // Creeping at the first ticks of a run-in: the points differ by their last digit, in a direction of its own.
  const V3 t{{std::sqrt(0.5), std::sqrt(0.5), 0.0}};
  Mat<double, 3> rt;
  rt[0] = t;
  rt[1] = {{-std::sqrt(0.5), std::sqrt(0.5), 0.0}};
  rt[2] = {{0.0, 0.0, 1.0}};
  const V3 next{{t[0] + 1e-16, t[1], 1e-16}};
  for (const V3& chord :
       {V3{{1e-18, -1e-18, 0.0}}, V3{{0.0, 0.0, 1e-18}}, V3{{1e-18, -1e-18, 3e-19}}, V3{}}) {
    const auto m = transport(rt, V3{}, chord, next);
    EXPECT_LT(norm(m[1] - rt[1]) + norm(m[2] - rt[2]), 1e-14);
  }
}

// ---- inflections, straight stretches, standstill

TEST(Frames, OnThePrintedFreeFormFrenetFlipsAndTransportedDoesNot) {
  const auto curve = printed_free_form();
  constexpr int kSteps = 20000;
  auto rt = carried(curve, 0.0, 0.0, 1);
  auto frenet = frenet_frame(series<4>(curve, 0.0), false, rt);
  int flips = 0;
  double largest_step = 0.0;
  double from_plane = 0.0;
  for (int k = 0; k < kSteps; ++k) {
    const double b = 2.0 * kPi * (k + 1) / kSteps;
    const auto next = transport(rt, curve.point(2.0 * kPi * k / kSteps), curve.point(b), tangent(curve, b));
    largest_step = std::max(largest_step, norm(next[1] - rt[1]) + norm(next[2] - rt[2]));
    rt = next;
    const auto f = frenet_frame(series<4>(curve, b), false, frenet.rt);
    flips += dot(f.rt[2], frenet.rt[2]) < 0.0 ? 1 : 0;
    frenet = f;
    // On a plane path both are the same but for one sign.
    const double sign = dot(f.rt[2], rt[2]) > 0.0 ? 1.0 : -1.0;
    from_plane = std::max(from_plane, norm(rt[1] - sign * f.rt[1]) + norm(rt[2] - sign * f.rt[2]));
  }
  EXPECT_EQ(flips, 4);            // each side of x = 10 sin(3φ + 1.256) has two inflections against y
  EXPECT_LT(largest_step, 1e-2);  // 3e-4 rad per step times the sharpest curvature
  EXPECT_LT(from_plane, 1e-7);    // Frenet's own rounding next to an inflection
}

TEST(Frames, ADerivativeDifferencedAcrossTheFlipSpikesAndTheExactOneDoesNot) {
  const auto curve = printed_free_form();
  Reference<Fourier<3>> frenet(curve, {9.5e-3, 1.0, 60e-3}, Pace::kSpeed, FrameKind::kFrenet);
  Reference<Fourier<3>> transported(curve, {9.5e-3, 1.0, 60e-3});
  const double dt = 5e-3;
  auto last = frenet.point();
  double differenced = 0.0;
  double exact = 0.0;
  double unlike = 0.0;
  while (!frenet.finished()) {
    frenet.advance(dt);
    transported.advance(dt);
    const auto f = frenet.point();
    const auto t = transported.point();
    differenced = std::max(differenced, norm((1.0 / dt) * (f.frame[1] - last.frame[1])));
    exact = std::max(exact, norm(f.frame_rate[1]));
    unlike = std::max(unlike, std::abs(norm(f.frame_rate[1]) - norm(t.frame_rate[1])));
    last = f;
  }
  EXPECT_NEAR(differenced, 2.0 / dt, 0.1 / dt);  // n turned over within one tick
  EXPECT_LT(exact, 20.0);
  EXPECT_LT(unlike, 1e-6);
}

TEST(Frames, AreDefinedAndSteadyThroughAStraightStretch) {
  const LineThenBend path;
  auto rt = carried(path, 0.0, 0.0, 1);
  EXPECT_LT(orthonormality(rt), 1e-15);
  const auto begin = rt;
  for (int k = 0; k < 1000; ++k) {
    const double a = 2.0 * k / 1000;
    const double b = 2.0 * (k + 1) / 1000;
    const auto next = transport(rt, path.point(a), path.point(b), tangent(path, b));
    EXPECT_LT(norm(next[1] - rt[1]) + norm(next[2] - rt[2]), 0.02) << b;
    rt = next;
    const auto f = transported_frame(series<3>(path, b), rt);
    if (b <= 1.0) {
      EXPECT_LT(norm(rt[1] - begin[1]), 1e-14);
      EXPECT_EQ(norm(f.first[1]) + norm(f.second[2]), 0.0);
    }
    for (const FrameKind kind : {FrameKind::kFrenet, FrameKind::kPrinted}) {
      const auto g = frenet_frame(series<4>(path, b), kind == FrameKind::kPrinted, rt);
      for (std::size_t i = 0; i < 3; ++i) EXPECT_TRUE(std::isfinite(norm(g.rt[i]) + norm(g.second[i])));
    }
  }
  EXPECT_LT(orthonormality(rt), 1e-14);
}

TEST(Frames, AreDefinedAtStandstill) {
  for (const FrameKind kind : {FrameKind::kTransported, FrameKind::kFrenet, FrameKind::kPrinted}) {
    Reference<Fourier<3>> r(saddle(), {9.5e-3, 1.0, 5e-3}, Pace::kSpeed, kind);
    const auto begin = r.point();
    EXPECT_EQ(norm(begin.velocity), 0.0);
    EXPECT_NEAR(norm(begin.frame[0]), 1.0, 1e-15);
    EXPECT_EQ(norm(begin.frame_rate[1]), 0.0);
    while (!r.finished()) r.advance(1e-3);
    for (int k = 0; k < 100; ++k) r.advance(1e-3);
    const auto end = r.point();
    EXPECT_EQ(norm(end.velocity), 0.0);
    EXPECT_TRUE(kind == FrameKind::kPrinted || orthonormality(end.frame) < 1e-14);
  }
}

TEST(Frames, StandStillWhenTheReferenceCreeps) {
  // Ticks of 1 µs: the first thousands move by less than a digit of the position.
  Reference<Fourier<3>> r(saddle(), {9.5e-3, 1.0, 5e-3});
  const auto begin = r.point();
  for (int k = 0; k < 5000; ++k) {
    r.advance(1e-6);
    ASSERT_LT(norm(r.point().frame[1] - begin.frame[1]), 1e-8) << k;  // 1.5e-9 rad of path
  }
}

TEST(FirstFrame, NormalPointsToTheInsideAndTheFrameIsRightHanded) {
  const auto m = first_frame<3>({{0.0, 1.0, 0.0}}, {{-2.0, 0.5, 0.0}});
  EXPECT_LT(norm(m[1] - V3{{-1.0, 0.0, 0.0}}), 1e-15);
  EXPECT_LT(norm(m[2] - V3{{0.0, 0.0, 1.0}}), 1e-15);
  for (const V3& t : {V3{{1.0, 0.0, 0.0}}, V3{{0.0, 0.0, 1.0}}, V3{{0.6, 0.0, 0.8}}}) {
    const auto straight = first_frame<3>(t, V3{});
    EXPECT_LT(orthonormality(straight), 1e-15);
    EXPECT_LT(norm(cross(straight[0], straight[1]) - straight[2]), 1e-15);
  }
  const auto left = first_frame<2>({{0.6, 0.8}}, {{1.0, 0.0}});
  EXPECT_LT(norm(left[1] - Vec2{{-0.8, 0.6}}), 1e-15);
  EXPECT_LT(orthonormality(first_frame<5>({{0.0, 0.0, 1.0, 0.0, 0.0}}, {})), 1e-15);
}

// ---- references in space

template <std::size_t N>
void expect_rates_are_derivatives(const Fourier<N>& curve, Pace pace, FrameKind kind, double begin) {
  constexpr double kFine = 1e-4;
  const SpeedLaw law = pace == Pace::kSpeed ? SpeedLaw{9.5e-3, 1.0, 1.0} : SpeedLaw{0.85, 1.0, 10.0};
  Reference<Fourier<N>> reference(curve, law, pace, kind);
  while (reference.time() < begin) reference.advance(kFine);
  const auto before = reference.point();
  reference.advance(kFine);
  const auto now = reference.point();
  reference.advance(kFine);
  const auto after = reference.point();
  for (std::size_t i = 0; i < N; ++i) {
    EXPECT_NEAR(now.velocity[i], (after.position[i] - before.position[i]) / (2 * kFine), 1e-9);
    EXPECT_NEAR(now.acceleration[i], (after.velocity[i] - before.velocity[i]) / (2 * kFine), 1e-7);
    for (std::size_t k = 0; k < N; ++k) {
      EXPECT_NEAR(now.frame_rate[i][k], (after.frame[i][k] - before.frame[i][k]) / (2 * kFine), 1e-6);
      EXPECT_NEAR(now.frame_acceleration[i][k],
                  (after.frame_rate[i][k] - before.frame_rate[i][k]) / (2 * kFine), 2e-5);
    }
  }
}

TEST(Reference, RatesInSpaceAreDerivativesOfTheirMotion) {
  for (const double begin : {0.6, 1.7}) {
    for (const Pace pace : {Pace::kSpeed, Pace::kRate}) {
      for (const FrameKind kind : {FrameKind::kTransported, FrameKind::kFrenet, FrameKind::kPrinted})
        expect_rates_are_derivatives(saddle(), pace, kind, begin);
      expect_rates_are_derivatives(five_axes(), pace, FrameKind::kTransported, begin);
    }
  }
}

/// Largest |φ − φ(s)| on the way, φ(s) by a run with a tenth of the tick; and at the end of a run of one lap in all.
template <PathCurve C>
std::array<double, 2> parameter_error(const C& curve, double speed, double dt) {
  const SpeedLaw law{speed, 0.5, lap_length(curve) - 0.5 * speed};
  Reference<C> coarse(curve, law);
  Reference<C> fine(curve, law);
  double worst = 0.0;
  while (!coarse.finished()) {
    coarse.advance(dt);
    for (int i = 0; i < 10; ++i) fine.advance(dt / 10);
    worst = std::max(worst, std::abs(coarse.point().phi - fine.point().phi));
  }
  return {worst, std::abs(coarse.point().phi - curve.period())};
}

TEST(Reference, ParameterFollowsTheArcLengthInSpaceToo) {
  for (const double dt : {1e-3, 5e-3}) {
    const auto free_form = parameter_error(printed_free_form(), 9.5e-3, dt);
    const auto twisted = parameter_error(saddle(), 9.5e-3, dt);
    EXPECT_LT(free_form[0], 2e-8);  // in its sharp turns at 5 ms: 0.1 nm
    EXPECT_LT(free_form[1], 2e-10);
    EXPECT_LT(twisted[0], 1e-9);
    EXPECT_LT(twisted[1], 1e-10);
  }
}

TEST(Reference, WhereTheSeriesDoesNotReachItStepsOtherwise) {
  // 100 mm/s at 50 ms: half a radian per tick. Nothing exact then, but on the path and never astray.
  const auto e = parameter_error(printed_free_form(), 0.1, 50e-3);
  EXPECT_LT(e[0], 1e-2);
  EXPECT_LT(e[1], 1e-2);
}

// ---- contour error in space

/// Exact less linearised contour error for a tracking error (along, n, b) of `size`, at φ.
template <PathCurve C>
double linearisation_error(const C& curve, double phi, double size) {
  const auto rt = first_frame(tangent(curve, phi), derivatives<2>(curve, phi)[2]);
  V3 e;
  const V3 local = size * V3{{0.6, 0.5, 0.62}};
  for (std::size_t i = 0; i < 3; ++i) e = e + local[i] * rt[i];
  return std::abs(contour_error(curve, curve.point(phi) + e, phi) - linearised_contour_error(rt * e));
}

Fourier<3> tilted_circle() {
  Fourier<3> c;
  c.axis[0].terms = {Harmonic{10e-3, 1.0, 0.0}};
  c.axis[1].terms = {Harmonic{10e-3 * std::cos(0.5), 1.0, -0.5 * kPi}};
  c.axis[2].terms = {Harmonic{10e-3 * std::sin(0.5), 1.0, -0.5 * kPi}};
  return c;
}

/// (4.7): cos²φ(4 sin²φ − 1) = −(cos 2φ + cos 4φ)/2, cos φ sin φ(4 sin²φ − 1) = (sin 2φ − sin 4φ)/2.
Fourier<3> tri_free() {
  Fourier<3> p;
  p.lap = kPi;
  p.axis[0].offset = 10e-3;
  p.axis[0].terms = {Harmonic{-5e-3, 2.0, 0.0}, Harmonic{-5e-3, 4.0, 0.0}};
  p.axis[1].terms = {Harmonic{5e-3, 2.0, -0.5 * kPi}, Harmonic{-5e-3, 4.0, -0.5 * kPi}};
  p.axis[2] = p.axis[0];
  return p;
}

TEST(ContourError, ExactAndLinearisedAgreeToSecondOrderInSpace) {
  for (const double phi : {0.4, 1.3, 2.6}) {
    for (const double size : {100e-6, 25e-6}) {
      EXPECT_NEAR(std::log2(linearisation_error(tilted_circle(), phi, size) /
                            linearisation_error(tilted_circle(), phi, 0.5 * size)),
                  2.0, 0.02);
      EXPECT_NEAR(std::log2(linearisation_error(tri_free(), phi, size) /
                            linearisation_error(tri_free(), phi, 0.5 * size)),
                  2.0, 0.1);
    }
  }
}

TEST(ContourError, OnACircleInSpaceTheSecondOrderIsTheCurvaturesShare) {
  // ε = |(e_n − κe_t²/2, e_b)|, so exact − linearised = −κ·e_t²·e_n/(2|ε|) to second order.
  const double size = 20e-6;
  const double expected = 0.36 * 0.5 / (2.0 * std::hypot(0.5, 0.62)) * size * size / 10e-3;
  EXPECT_NEAR(linearisation_error(tilted_circle(), 0.4, size), expected, 0.01 * expected);
}

TEST(ContourError, InSpaceIsTheDistanceAndHasNoSign) {
  const auto curve = saddle();
  for (const double phi : {0.2, 1.9, 4.0}) {
    const auto rt = first_frame(tangent(curve, phi), derivatives<2>(curve, phi)[2]);
    for (const double offset : {30e-6, -30e-6}) {
      const V3 p = curve.point(phi) + offset * (0.6 * rt[1] + 0.8 * rt[2]);
      EXPECT_NEAR(contour_error(curve, p, phi + 1e-3), 30e-6, 1e-15);
    }
  }
}

TEST(FirstFrame, PointsToTheInsideHoweverGentleTheBend) {
  // Also where the curvature is not quite across the path.
  for (const double bend : {1e-5, 1.0, 1e5}) {
    for (const double along : {0.0, 0.3}) {
      const auto m = first_frame(V3{{1.0, 0.0, 0.0}}, bend * V3{{along, 0.6, -0.8}});
      EXPECT_NEAR(norm(m[1] - V3{{0.0, 0.6, -0.8}}), 0.0, 1e-15) << bend;
      EXPECT_NEAR(norm(m[2] - V3{{0.0, 0.8, 0.6}}), 0.0, 1e-15) << bend;
    }
  }
}

TEST(FirstFrame, OnAStraightPathTheFirstAxisThatIsFreeIsTheNormal) {
  EXPECT_EQ(first_frame(V3{{0.0, 0.0, 1.0}}, V3{})[1], (V3{{1.0, 0.0, 0.0}}));
  EXPECT_EQ(first_frame(V3{{1.0, 0.0, 0.0}}, V3{})[1], (V3{{0.0, 1.0, 0.0}}));
  EXPECT_EQ(first_frame(V3{{0.0, 1.0, 0.0}}, V3{})[1], (V3{{1.0, 0.0, 0.0}}));
  // A curvature along the path says nothing.
  EXPECT_EQ(first_frame(V3{{0.0, 0.0, 1.0}}, V3{{0.0, 0.0, 5.0}})[1], (V3{{1.0, 0.0, 0.0}}));
}

TEST(Transport, AChordOfRoundingErrorsTurnsNoNormal) {
  const V3 t{{1.0, 0.0, 0.0}};
  const auto rt = first_frame(t, V3{{0.0, 0.6, 0.8}});
  for (const V3& chord : {V3{}, V3{{1e-17, 1e-16, 0.0}}, V3{{-1e-17, 3e-17, 1e-16}}}) {
    const auto m = transport(rt, V3{}, chord, t);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(norm(m[i] - rt[i]), 0.0, 1e-15) << i;
  }
}

TEST(Transport, NormalsThatAreOffBecomeOrthonormal) {
  // By far more than reflections leave: twice as long, and leaning.
  const V3 t{{1.0, 0.0, 0.0}};
  auto rt = first_frame(t, V3{{0.0, 1.0, 0.0}});
  rt[1] = V3{{0.1, 2.0, 0.3}};
  rt[2] = V3{{0.0, 0.2, 0.5}};
  const auto m = transport(rt, V3{}, V3{}, t);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(dot(m[i], m[k]), i == k ? 1.0 : 0.0, 1e-15);
  }
}

}  // namespace
}  // namespace stribeck::path::frame_test
