#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stribeck/control/sampled_loop.hpp>
#include <stribeck/control/test_axes.hpp>
#include <stribeck/sim/contour_run.hpp>
#include <stribeck/sim/study/loop_margins.hpp>

namespace stribeck::sim::loop_margins_test {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

using control::ContouringParams;
using control::Observer;

constexpr double kPeriod = 5e-3;
constexpr double kDegrees = 180.0 / kPi;

/// The axes of V2; `delay` in periods.
control::Setup<2> table(Observer observer = Observer::kNone, double delay = 0.0) {
  control::Setup<2> s;
  s.period = kPeriod;
  s.compensation[0].model.mass = 57650.0;
  s.compensation[1].model.mass = 58930.0;
  for (auto& c : s.compensation) {
    c.observer = observer;
    c.encoder_resolution = 25e-9;
    c.model.delay = delay * kPeriod;
  }
  return s;
}

TEST(LoopMargins, GainOfPdIsTheClosedForm) {
  // Factor g on both gains to the border g·k_p T (2 + g·k_v T) = 2 g·k_v (2 − g·k_v T) of sampled_loop.hpp.
  for (const auto& [kp, kv] : {std::pair{1600.0, 80.0}, {900.0, 90.0}, {400.0, 40.0}}) {
    ContouringParams p;
    p.kp = {kp};
    p.kv = {kv};
    const LoopMargins m = loop_margins<2>(p, table());
    const double border = (4.0 * kv - 2.0 * kp * kPeriod) / (kv * kPeriod * (kp * kPeriod + 2.0 * kv));
    EXPECT_TRUE(m.stable);
    EXPECT_NEAR(m.gain_up, border, 1e-6 * border);
    EXPECT_TRUE(std::isinf(m.gain_down));
    EXPECT_EQ(m.gain, m.gain_up);
  }
}

TEST(LoopMargins, AgreeWithOtherHands) {
  // NumPy: transfer functions written out (exact hold, delay inside a period, observer by its matrix exponential), crossings by
  // Brent's method on 40000 frequencies. Its moduli are off by what lies between two of them, ours too: 1e-4.
  const auto law = ContouringParams::critical(40.0, 40.0);
  const LoopMargins pd = loop_margins<2>(law, table());
  EXPECT_NEAR(pd.phase * kDegrees, 53.23921113, 1e-5);
  EXPECT_NEAR(pd.delay / kPeriod, 2.19298195, 1e-6);
  EXPECT_NEAR(pd.modulus, 0.675145, 1e-4);
  const LoopMargins late = loop_margins<2>(law, table(Observer::kNone, 0.4));
  EXPECT_NEAR(late.phase * kDegrees, 43.50568106, 1e-5);
  EXPECT_NEAR(late.gain_up, 2.75315423, 1e-6);
  EXPECT_NEAR(late.delay / kPeriod, 1.79165541, 1e-6);
  const LoopMargins observed = loop_margins<2>(law, table(Observer::kDisturbance));
  EXPECT_NEAR(observed.phase * kDegrees, 50.77943079, 1e-5);
  EXPECT_NEAR(observed.gain_up, 4.43817649, 1e-5);
  EXPECT_NEAR(observed.gain_down, 1.0 / 0.1082815937, 1e-4);
  EXPECT_NEAR(observed.delay / kPeriod, 2.11044925, 1e-6);
  // A mode at 30 Hz, which this loop excites: unstable, and by how much.
  const plant::AxialMode mode{30.0, 0.05, 0.4};
  const LoopMargins soft = loop_margins<2>(law, table(Observer::kNone, 0.4), {mode, mode});
  EXPECT_FALSE(soft.stable);
  EXPECT_NEAR(soft.phase * kDegrees, -0.75520503, 1e-4);
  EXPECT_NEAR(soft.gain, 0.98735463, 1e-6);
  EXPECT_EQ(soft.delay, 0.0);
}

// The margins above, from another program, found again in the curve.
TEST(LoopMargins, TheResponseHasThem) {
  const auto law = ContouringParams::critical(40.0, 40.0);
  const LoopResponse r = loop_responses<2>(law, table())[0];
  ASSERT_EQ(r.omega.size(), r.loop.size());
  EXPECT_NEAR(r.omega.back(), kPi / kPeriod, 1e-9);
  EXPECT_LT(r.omega.front(), 1e-3 * r.omega.back());
  double nearest = 1e300;
  for (std::size_t k = 1; k < r.loop.size(); ++k) {
    nearest = std::min(nearest, std::abs(1.0 + r.loop[k]));
    const double before = std::log(std::abs(r.loop[k - 1])), now = std::log(std::abs(r.loop[k]));
    if (before < 0.0 || now >= 0.0) continue;
    const double share = before / (before - now);
    const double phase = std::arg(-r.loop[k - 1]) + share * (std::arg(-r.loop[k]) - std::arg(-r.loop[k - 1]));
    EXPECT_NEAR(phase * kDegrees, 53.23921113, 0.05);
  }
  EXPECT_NEAR(nearest, 0.675145, 1e-3);
  EXPECT_NEAR(r.nearest, nearest, 1e-12);
  // The loop with a mode is the one nearer to instability.
  const plant::AxialMode mode{60.0, 0.05, 0.4};
  const auto second = loop_responses<2>(law, table(), {std::nullopt, mode});
  EXPECT_EQ(second[1].axis, 1u);
  EXPECT_LT(second[1].nearest, 0.9 * second[0].nearest);
}

TEST(LoopMargins, KnowThatSixtyAndSeventyAreUnstableWithOneMorePeriod) {
  // Largest root of z²(z−1)² + …: 1.034 at 70 rad/s and 0.973 at 60 rad/s with one period of delay, 0.813 without (NumPy).
  EXPECT_TRUE(loop_margins<2>(ContouringParams::critical(60.0, 70.0), table()).stable);
  EXPECT_TRUE(loop_margins<2>(ContouringParams::critical(60.0, 60.0), table(Observer::kNone, 1.0)).stable);
  const LoopMargins m = loop_margins<2>(ContouringParams::critical(60.0, 70.0), table(Observer::kNone, 1.0));
  EXPECT_FALSE(m.stable);
  EXPECT_LT(m.phase, 0.0);
  EXPECT_LT(m.gain, 1.0);
  // The delay margin says so beforehand.
  EXPECT_LT(loop_margins<2>(ContouringParams::critical(60.0, 70.0), table()).delay, kPeriod);
}

TEST(LoopMargins, StabilityIsThatOfTheSampledLoop) {
  for (const double omega : {40.0, 90.0, 130.0, 139.0, 142.0, 200.0}) {  // border of a double pole: ωT = 0.70
    const auto p = ContouringParams::critical(omega, omega);
    EXPECT_EQ(loop_margins<2>(p, table()).stable,
              control::sampled_loop_stable(omega * omega, 2.0 * omega, 0.0, kPeriod))
        << omega;
  }
  for (const double ki : {1e3, 27e3, 2e5}) {
    control::PidParams p;
    p.ki = {ki};
    EXPECT_EQ(loop_margins<2>(p, table()).stable, p.stable(kPeriod)) << ki;
  }
}

TEST(LoopMargins, DoNotDependOnMassAndScaleWithTime) {
  auto light = table(Observer::kDisturbance);
  for (auto& c : light.compensation) c.model.mass = 1.0;
  const auto law = ContouringParams::critical(40.0, 40.0);
  const LoopMargins a = loop_margins<2>(law, table(Observer::kDisturbance));
  const LoopMargins b = loop_margins<2>(law, light);
  EXPECT_NEAR(a.phase, b.phase, 1e-6);
  EXPECT_NEAR(a.gain, b.gain, 1e-6 * a.gain);
  // All rates five times higher at a fifth of the period.
  auto fast = table(Observer::kDisturbance);
  fast.period = 1e-3;
  for (auto& c : fast.compensation) c.observer_pole = 100.0;
  const LoopMargins c = loop_margins<2>(ContouringParams::critical(200.0, 200.0), fast);
  EXPECT_NEAR(c.phase, a.phase, 1e-6);
  EXPECT_NEAR(c.delay / fast.period, a.delay / kPeriod, 1e-6);
}

TEST(LoopMargins, SeeTheGainsAcrossThePathOnEveryAxis) {
  // Only y is late; the faster gains across the path meet it where the tangent lies along x.
  auto s = table();
  s.compensation[1].model.delay = kPeriod;
  EXPECT_FALSE(loop_margins<2>(ContouringParams::critical(60.0, 70.0), s).stable);
  EXPECT_FALSE(loop_margins<2>(ContouringParams::critical(70.0, 60.0), s).stable);
  EXPECT_EQ(loop_margins<2>(ContouringParams::critical(40.0, 70.0), s).axis, 1U);
}

TEST(LoopMargins, SwitchingCountsWithItsDescribingFunction) {
  // A + 4γ/(πa) at a = 0.1 mm/s in place of A, as a boundary layer of that slope.
  control::SlidingModeParams sign;
  sign.gamma = {2e-3, 4e-3};
  auto layer = sign;
  layer.switching = control::Switching::kBoundaryLayer;
  layer.boundary = kPi / 4.0 * 0.1e-3;
  const LoopMargins a = loop_margins<2>(sign, table());
  EXPECT_EQ(a.phase, loop_margins<2>(layer, table()).phase);
  // And as plain contouring control: k_v = λ + A + γ/Φ, k_p = λ(A + γ/Φ).
  ContouringParams linear;
  const auto pull = [&](std::size_t i) { return sign.a[i] + sign.gamma[i] / layer.boundary; };
  linear.kv = {sign.lambda[0] + pull(0), sign.lambda[1] + pull(1)};
  linear.kp = {sign.lambda[0] * pull(0), sign.lambda[1] * pull(1)};
  EXPECT_NEAR(a.phase, loop_margins<2>(linear, table()).phase, 1e-4);
  sign.switching = control::Switching::kSuperTwisting;
  EXPECT_THAT([&] { loop_margins<2>(sign, table()); },
              ThrowsMessage<Refused>(HasSubstr("super-twisting has no linear part")));
}

TEST(LoopMargins, EveryLawHasThem) {
  const auto s = table();
  const auto each = [&]<class... P>(std::variant<P...>*) {
    const auto one = [&]<class Params>(const Params& params) {
      const LoopMargins m = loop_margins<2>(params, s);
      EXPECT_TRUE(m.stable) << Params::kKind;
      EXPECT_GT(m.phase, 0.0) << Params::kKind;
      EXPECT_GT(m.gain, 1.0) << Params::kKind;
    };
    (
        [&] {
          if constexpr (!std::is_same_v<P, control::SlidingModeParams>) one(P{});
        }(),
        ...);
  };
  each(static_cast<control::LawParams*>(nullptr));
}

}  // namespace
}  // namespace stribeck::sim::loop_margins_test
