#include <gtest/gtest.h>

#include <cmath>
#include <stribeck/control/laws/contouring.hpp>
#include <stribeck/control/pd.hpp>
#include <stribeck/control/test_axes.hpp>

namespace stribeck::control::contouring_test {
namespace {

constexpr double kPeriod = 1e-3;

/// What is left after 0.1 s of an error of (50, -30, 20) um with poles at 40 along and 60 rad/s across the path.
template <class C>
auto error_after(const C& curve, path::FrameKind frame = path::FrameKind::kTransported) {
  constexpr double kFine = 1e-5;
  Vec<double, C::kAxes> start;
  for (std::size_t i = 0; i < C::kAxes; ++i) start[i] = std::array{50e-6, -30e-6, 20e-6}[i];
  using Law = Contouring<C::kAxes>;
  const Law law(ContouringParams::critical(40.0, 60.0), test::masses<C::kAxes>(kFine));
  test::Followers<C, Law> run(curve, {20e-3, 1.0, 1.0}, 1.0, start, kFine, frame);
  for (int k = 0; k < 10000; ++k) run.step(law);
  return run.local();
}

TEST(Contouring, ErrorsAlongAndAcrossDecayEachWithItsOwnPole) {
  // e_l'' + K_v e_l' + K_p e_l = 0 in the moving frame: each part (1 + w t) exp(-w t) of its start, no mixing. The circle turns
  // by 0.2 rad meanwhile; with the printed I at theta'^2 the parts would mix by 1e-2.
  const Vec2 e = error_after(path::Curve{path::Shape::kCircle, 10e-3});
  EXPECT_NEAR(e[0], 50e-6 * (1 + 4.0) * std::exp(-4.0), 2e-3 * 50e-6);
  EXPECT_NEAR(e[1], -30e-6 * (1 + 6.0) * std::exp(-6.0), 2e-3 * 50e-6);
}

TEST(Contouring, DecaysTheSameWayOnAPathWithTorsion) {
  for (const auto frame : {path::FrameKind::kTransported, path::FrameKind::kFrenet}) {
    const auto e = error_after(test::saddle(), frame);
    EXPECT_NEAR(e[0], 50e-6 * (1 + 4.0) * std::exp(-4.0), 2e-3 * 50e-6);
    EXPECT_NEAR(e[1], -30e-6 * (1 + 6.0) * std::exp(-6.0), 2e-3 * 50e-6);
    EXPECT_NEAR(e[2], 20e-6 * (1 + 6.0) * std::exp(-6.0), 2e-3 * 50e-6);
  }
}

TEST(Contouring, WithEqualGainsAndNoTurnItIsPdOnEachAxis) {
  // A straight stretch: R' = 0, so the frame must not matter.
  path::PathPoint<2> r;
  r.frame = {{{{{0.6, 0.8}}, {{-0.8, 0.6}}}}};
  r.velocity = {{3e-3, 4e-3}};
  const Contouring<2> two(ContouringParams::critical(40.0, 40.0), test::masses<2>(kPeriod));
  Pd::Params params;
  params.gains = Gains::critical(40.0);
  params.compensation.model.mass = test::kMass;
  const Pd one(params, kPeriod);
  Contouring<2>::State s;
  Pd::State a;
  Pd::State b;
  for (const double x : {1e-6, 3e-6, -2e-6}) {
    const Vec2 f = two.step(s, r, Vec2{{x, -2 * x}});
    EXPECT_NEAR(f[0], one.step(a, {0.0, 3e-3, 0.0, x}), 1e-12);
    EXPECT_NEAR(f[1], one.step(b, {0.0, 4e-3, 0.0, -2 * x}), 1e-12);
  }
}

TEST(Contouring, WithOneAxisItIsPd) {
  path::PathPoint<1> r;
  r.velocity = {{3e-3}};
  r.acceleration = {{0.1}};
  const Contouring<1> law(ContouringParams::critical(40.0, 1.0), test::masses<1>(kPeriod));
  Pd::Params params;
  params.gains = Gains::critical(40.0);
  params.compensation.model.mass = test::kMass;
  const Pd pd(params, kPeriod);
  Contouring<1>::State s;
  Pd::State a;
  for (const double x : {1e-6, 3e-6, -2e-6})
    EXPECT_NEAR(law.step(s, r, {{x}})[0], pd.step(a, {0.0, 3e-3, 0.1, x}), 1e-12);
}

TEST(Contouring, IsTheSameLawWhenTheWorldIsTurned) {
  // Everything rotated by 0.5 rad: the force must rotate with it.
  const double c = std::cos(0.5);
  const double n = std::sin(0.5);
  const auto turn = [&](const Vec2& v) { return Vec2{{c * v[0] - n * v[1], n * v[0] + c * v[1]}}; };
  path::PathPoint<2> r;
  r.position = {{1e-3, 2e-3}};
  r.velocity = {{9e-3, 0.0}};
  r.acceleration = {{1e-3, 8e-3}};
  r.frame_rate = {{{{{0.0, 0.9}}, {{-0.9, 0.0}}}}};
  r.frame_acceleration = {{{{{-0.81, 0.2}}, {{-0.2, -0.81}}}}};
  path::PathPoint<2> q = r;
  q.position = turn(r.position);
  q.velocity = turn(r.velocity);
  q.acceleration = turn(r.acceleration);
  for (int i = 0; i < 2; ++i) {
    q.frame[i] = turn(r.frame[i]);
    q.frame_rate[i] = turn(r.frame_rate[i]);
    q.frame_acceleration[i] = turn(r.frame_acceleration[i]);
  }
  const Contouring<2> law(ContouringParams::critical(40.0, 60.0), test::masses<2>(kPeriod));
  Contouring<2>::State s;
  Contouring<2>::State t;
  for (const Vec2 e : {Vec2{{1e-6, -4e-6}}, Vec2{{2e-6, -3e-6}}}) {
    const Vec2 f = turn(law.step(s, r, r.position + e));
    const Vec2 g = law.step(t, q, q.position + turn(e));
    EXPECT_NEAR(f[0], g[0], 1e-9);
    EXPECT_NEAR(f[1], g[1], 1e-9);
  }
}

TEST(Contouring, AnswersNaNWithItsLastForces) {
  const Contouring<2> law(ContouringParams::critical(40.0, 60.0), test::masses<2>(kPeriod));
  Contouring<2>::State s;
  const Vec2 before = law.step(s, {}, Vec2{{1e-6, 2e-6}});
  EXPECT_EQ(law.step(s, {}, Vec2{{1e-6, std::nan("")}}), before);
  path::PathPoint<2> broken;
  broken.frame_rate[1][0] = std::nan("");
  EXPECT_EQ(law.step(s, broken, Vec2{{1e-6, 2e-6}}), before);
  EXPECT_EQ(s.status.count(Status::kNotFinite), 2U);
}

TEST(Contouring, LimitsItsForcesAndSaysSo) {
  auto setup = test::masses<2>(kPeriod);
  setup.force_limit = {{5.0, 1e9}};
  const Contouring<2> law(ContouringParams::critical(40.0, 60.0), setup);
  Contouring<2>::State s;
  const Vec2 f = law.step(s, {}, Vec2{{-1.0, -1.0}});
  EXPECT_EQ(f[0], 5.0);
  EXPECT_GT(f[1], 5.0);
  EXPECT_EQ(s.status.first, Status::kOutputLimited);
}

TEST(Gains, AListStandsForTheRestWithItsLastValue) {
  EXPECT_EQ((spread<3>({20.0, 40.0})), (Vec<double, 3>{{20.0, 40.0, 40.0}}));
  EXPECT_EQ((spread<2>({20.0, 40.0, 60.0})), (Vec<double, 2>{{20.0, 40.0}}));
  EXPECT_EQ((spread<2>({}, 7.0)), (Vec<double, 2>{{7.0, 7.0}}));
  EXPECT_EQ((spread<2>({})), (Vec<double, 2>{{0.0, 0.0}}));
}

}  // namespace
}  // namespace stribeck::control::contouring_test
