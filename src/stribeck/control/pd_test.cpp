#include <gtest/gtest.h>

#include <cmath>
#include <stribeck/control/pd.hpp>
#include <stribeck/control/test_mass.hpp>
#include <string>

namespace stribeck::control::pd_test {
namespace {

using test::kMass;
using test::kPeriod;
using test::Mass;

Pd::Params pd(double omega) {
  Pd::Params p;
  p.gains = Gains::critical(omega);
  p.compensation.model.mass = kMass;
  return p;
}

// With a mass of -800 kg a loop pushed with 2 MN.
TEST(Pd, SaysWithWhichParametersNoLoopWorks) {
  const auto with = [](auto&& change, double period = kPeriod) {
    Pd::Params p = pd(20.0);
    p.compensation.model.friction.steady = friction::Conventional<double>{15.0, 3e3, {}};
    change(p);
    const char* wrong = Pd::problem(p, period);
    return std::string(wrong == nullptr ? "nothing" : wrong).substr(0, 8);
  };
  const auto nothing = [](Pd::Params&) {};
  EXPECT_EQ(with(nothing), "nothing");
  EXPECT_EQ(with(nothing, 0.0), "period: ");
  EXPECT_EQ(with([](Pd::Params& p) { p.compensation.model.mass = -800.0; }), "mass: ex");
  EXPECT_EQ(with([](Pd::Params& p) { p.compensation.model.mass = NAN; }), "mass: ex");
  EXPECT_EQ(with([](Pd::Params& p) { p.compensation.model.load = NAN; }), "load: ex");
  EXPECT_EQ(with([](Pd::Params& p) { p.force_limit = -250.0; }), "force_li");
  EXPECT_EQ(with([](Pd::Params& p) { p.gains = Gains::critical(6000.0); }), "gains: t");
  EXPECT_EQ(with([](Pd::Params& p) { p.gains.kv = 0.0; }), "gains: e");
  for (const friction::Conventional<double> wrong :
       {friction::Conventional<double>{-15.0, 0.0, {}}, friction::Conventional<double>{15.0, -3e3, {}},
        friction::Conventional<double>{NAN, 3e3, {}}})
    EXPECT_EQ(with([&](Pd::Params& p) { p.compensation.model.friction.steady = wrong; }), "friction");
}

TEST(Pd, ErrorDiesOutAsItsDoublePoleSays) {
  // Continuous law: e = e0 (1 + w t) exp(-w t). Sampled at w T = 0.02 with a difference of the error: within
  // 3 %.
  const Pd controller(pd(20.0), kPeriod);
  Pd::State state;
  Mass mass{1e-3, 0.0};
  for (int k = 0; k < 100; ++k) mass.move(controller.step(state, {0.0, 0.0, 0.0, mass.x}));
  EXPECT_NEAR(mass.x, 1e-3 * (1 + 2.0) * std::exp(-2.0), 0.03e-3);
}

TEST(Pd, FeedforwardAloneFollowsAKnownMassWithoutError) {
  const Pd controller(pd(20.0), kPeriod);
  Pd::State state;
  Mass mass;
  // r'' held over the period, so that mass and reference move alike.
  Mass reference;
  for (int k = 0; k < 500; ++k) {
    const double a = 0.1 * std::sin(0.05 * k);
    mass.move(controller.step(state, {reference.x, reference.v, a, mass.x}));
    reference.move(a * kMass);
  }
  EXPECT_NEAR(mass.x, reference.x, 1e-12);
}

TEST(Pd, FeedsFrictionForwardByTheReferenceNotTheMeasurement) {
  auto p = pd(20.0);
  p.compensation.feedforward = control::Feedforward::kSteady;
  p.compensation.model.friction.steady = friction::Conventional<double>{30.0, 100.0, {}};
  p.compensation.model.load = 7.0;
  const Pd controller(p, kPeriod);
  Pd::State state;
  EXPECT_NEAR(controller.step(state, {0.0, 2e-3, 0.0, 0.0}), 30.2 + 7.0, 1e-12);
  // At rest in reference: no Coulomb force, however the measurement trembles.
  Pd::State still;
  EXPECT_NEAR(controller.step(still, {0.0, 0.0, 0.0, 0.0}), 7.0, 1e-12);
  EXPECT_NEAR(controller.step(still, {0.0, 0.0, 0.0, 0.0}), 7.0, 1e-12);
}

TEST(Pd, LateErrorRateAddsTheRadiusErrorOfHalfASample) {
  // On a circle (here: its x axis) the late form lags by T/2 and adds a T/omega: 9.5 mm/s, R = 10 mm, T = 5
  // ms, omega = 40.
  const double period = 5e-3;
  const double rate = 0.95;
  double worst[2];
  for (const ErrorRate form : {ErrorRate::kDifferenceOfError, ErrorRate::kLate}) {
    auto p = pd(40.0);
    p.error_rate = form;
    const Pd controller(p, period);
    Pd::State state;
    Mass mass{10e-3, 0.0};
    double most = 0.0;
    for (int k = 0; k < 4000; ++k) {
      const double phase = rate * k * period;
      const double r = 10e-3 * std::cos(phase);
      mass.move(controller.step(state, {r, -rate * 10e-3 * std::sin(phase), -rate * rate * r, mass.x}),
                period);
      if (k > 2000) most = std::max(most, std::abs(mass.x - 10e-3 * std::cos(rate * (k + 1) * period)));
    }
    worst[form == ErrorRate::kLate] = most;
  }
  EXPECT_NEAR(worst[1] - worst[0], 9.025e-3 * period / 40.0, 0.1 * 1.13e-6);
}

TEST(Pd, LimitsItsForceAndSaysSo) {
  auto p = pd(20.0);
  p.force_limit = 5.0;
  const Pd controller(p, kPeriod);
  Pd::State state;
  EXPECT_EQ(controller.step(state, {1.0, 0.0, 0.0, 0.0}), 5.0);
  EXPECT_EQ(state.status.first, Status::kOutputLimited);
}

TEST(Pd, AnswersNaNWithItsLastForce) {
  const Pd controller(pd(20.0), kPeriod);
  Pd::State state;
  const double before = controller.step(state, {1e-3, 0.0, 0.0, 0.0});
  EXPECT_EQ(controller.step(state, {1e-3, 0.0, 0.0, std::nan("")}), before);
  EXPECT_EQ(state.status.count(Status::kNotFinite), 1U);
  EXPECT_NE(controller.step(state, {1e-3, 0.0, 0.0, 1e-4}), before);  // and goes on with the next good sample
}

TEST(Pd, CountsFrictionAskedOutsideItsRange) {
  auto p = pd(20.0);
  p.compensation.feedforward = control::Feedforward::kSteady;
  friction::Gaussian<double> g;
  g.positive.eta0 = 10.0;
  g.negative.eta0 = -10.0;
  g.velocity_range = {-1e-3, 1e-3};
  p.compensation.model.friction.steady = g;
  const Pd controller(p, kPeriod);
  Pd::State state;
  controller.step(state, {0.0, 0.9e-3, 0.0, 0.0});
  EXPECT_EQ(state.status.first, Status::kOk);
  controller.step(state, {0.0, 1.1e-3, 0.0, 0.0});
  EXPECT_EQ(state.status.first, Status::kOutsideVelocityRange);
}

TEST(Pd, AnInputThatSaysNothingAsksForNothing) {
  for (const ErrorRate rate : {ErrorRate::kDifferenceOfError, ErrorRate::kLate}) {
    Pd::Params p = pd(20.0);
    p.error_rate = rate;
    const Pd controller(p, kPeriod);
    Pd::State state;
    for (int k = 0; k < 3; ++k) EXPECT_EQ(controller.step(state, Pd::Input{}), 0.0);
  }
}

/// The axis of the tests with a force limit, where the greatest sound change of the differenced velocity in a period is known [m/s].
struct Shaken {
  Shaken() : law(limited(), kPeriod) {}
  static Pd::Params limited() {
    Pd::Params p = pd(20.0);
    p.force_limit = 100.0;
    p.compensation.encoder_resolution = 1e-7;
    return p;
  }
  static constexpr double kMost = 4.0 * (100.0 * kPeriod / kMass + 1e-7 / kPeriod);
  double step(double x) {
    law.step(state, {0.0, 0.0, 0.0, x});
    return state.change[0];
  }
  Pd law;
  Pd::State state;
};

TEST(Pd, TheUsualChangeOfTheVelocityIsLearnedFromManySamplesAndNotFromOne) {
  for (const double share : {0.2, 0.9}) {
    Shaken axis;
    // To and fro between two places, so that the velocity changes by as much in each period.
    const double way = 0.5 * share * Shaken::kMost * kPeriod;
    double change = 0.0;
    for (int k = 0; k < 600; ++k) change = axis.step(k % 2 == 0 ? 0.0 : way);
    EXPECT_NEAR(change, share * Shaken::kMost, 0.01 * change) << share;
    // A sample that is a thousand times as far away.
    const double after = axis.step(1e3 * way);
    EXPECT_GT(after, change);
    EXPECT_LE(after, change + 0.02 * (change + Shaken::kMost) * (1.0 + 1e-9));
  }
}

}  // namespace
}  // namespace stribeck::control::pd_test
