#include <gtest/gtest.h>

#include <stribeck/control/contouring.hpp>

namespace stribeck::control {
namespace {

constexpr double kPeriod = 1e-3;
constexpr double kMass = 50.0;

/// A mass moved exactly by a held force.
struct Mass {
  double x = 0.0;
  double v = 0.0;
  void move(double force, double dt = kPeriod, double mass = kMass) {
    const double a = force / mass;
    x += dt * v + 0.5 * dt * dt * a;
    v += dt * a;
  }
};

Pd::Params pd(double omega) {
  Pd::Params p;
  p.gains = Gains::critical(omega);
  p.compensation.model.mass = kMass;
  return p;
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
  p.compensation.friction_feedforward = true;
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
  p.compensation.friction_feedforward = true;
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

TEST(DisturbanceObserver, FindsAConstantForce) {
  const DisturbanceObserver observer(20.0, kMass, kPeriod);
  DisturbanceObserver::State s;
  Mass mass;
  double estimate = 0.0;
  for (int k = 0; k < 1500; ++k) {
    estimate = observer.step(s, 3.0, mass.v);  // 3 N asked, 3 - 8 N arrive
    mass.move(3.0 - 8.0);
  }
  EXPECT_NEAR(estimate, 8.0, 0.05);
}

TEST(DisturbanceObserver, StepResponseIsThatOfItsDoublePole) {
  // Velocity known and zero, force f held by nothing: d'' + 2p d' + p^2 d = p^2 f, so d = f (1 - (1 + p t)
  // e^(-p t)), exactly, at every sample.
  for (const double period : {1e-3, 0.04}) {
    const DisturbanceObserver observer(20.0, kMass, period);
    DisturbanceObserver::State s;
    for (int k = 1; k <= 10; ++k) {
      const double t = k * period;
      EXPECT_NEAR(observer.step(s, 5.0, 0.0), 5.0 * (1 - (1 + 20 * t) * std::exp(-20 * t)), 1e-12) << t;
    }
  }
}

TEST(DisturbanceObserver, MirrorsUnderSign) {
  const DisturbanceObserver observer(20.0, kMass, kPeriod);
  DisturbanceObserver::State plus;
  DisturbanceObserver::State minus;
  for (int k = 0; k < 50; ++k) {
    EXPECT_EQ(observer.step(plus, 2.0 + k, 1e-3 * k), -observer.step(minus, -2.0 - k, -1e-3 * k));
  }
}

TEST(KalmanObserver, FindsAConstantForceFromPositionsAlone) {
  const KalmanObserver observer(1e4, 1e-16, kMass, kPeriod);
  KalmanObserver::State s;
  Mass mass;
  double estimate = 0.0;
  for (int k = 0; k < 2000; ++k) {
    estimate = observer.step(s, 3.0, mass.x);
    mass.move(3.0 - 8.0);
  }
  EXPECT_NEAR(estimate, 8.0, 1e-6);
  EXPECT_NEAR(s.estimate[1], mass.v, 1e-4);
}

TEST(KalmanObserver, GainIsThatOfScipysRiccatiSolver) {
  // scipy.linalg.solve_discrete_are for T = 5 ms, m = 57650 kg, q_d = 4e6 N^2/s, r = (25 nm)^2/12:
  // K = P H'/(H P H' + r) with d = -m times its third element. Seen through one innovation of 1 m from rest.
  const KalmanObserver observer(4e6, 25e-9 * 25e-9 / 12, 57650.0, 5e-3);
  KalmanObserver::State s;
  observer.step(s, 0.0, 0.0);
  observer.step(s, 0.0, 1.0);
  EXPECT_NEAR(s.estimate[0], 0.9830365089899638, 1e-9);
  EXPECT_NEAR(s.estimate[1], 295.02701148126175, 1e-6);
  EXPECT_NEAR(s.estimate[2], -2552250095.08357, 30.0);
}

// ---- contouring

struct PlaneMass {
  Mass axis[2];
};

Contouring::Params contouring(double omega_t, double omega_n) {
  Contouring::Params p;
  p.tangential = Gains::critical(omega_t);
  p.normal = Gains::critical(omega_n);
  for (auto& c : p.compensation) c.model.mass = kMass;
  return p;
}

/// Error along (0) and across (1) the path after `time`, beginning with the given one, on a circle at
/// constant speed.
Vec2 error_after(const Contouring::Params& params, double time, const Vec2& initial, double period) {
  const path::Curve circle{path::Shape::kCircle, 10e-3};
  path::Reference reference(circle, {20e-3, 1.0, 1.0});
  while (reference.time() < 1.0) reference.advance(period);
  const Contouring controller(params, period);
  Contouring::State state;
  path::PathPoint r = reference.point();
  Mass m[2];
  const auto frame = [](const path::PathPoint& p, const Vec2& e) {
    return Vec2{{p.tangent[0] * e[0] - p.tangent[1] * e[1], p.tangent[1] * e[0] + p.tangent[0] * e[1]}};
  };
  // e_l at rest in the moving frame: e' = theta' J e.
  const Vec2 e = frame(r, initial);
  for (int i = 0; i < 2; ++i) {
    m[i].x = r.position[i] + e[i];
    m[i].v = r.velocity[i] + r.theta_rate * (i == 0 ? -e[1] : e[0]);
  }
  // Prime the difference of the error with the sample before.
  for (int i = 0; i < 2; ++i) {
    state.error[i].update(m[i].x - period * m[i].v, r.position[i] - period * r.velocity[i], 0.0, period,
                          ErrorRate::kDifferenceOfError);
  }
  for (double t = 0.0; t < time - 0.5 * period; t += period) {
    const Vec2 force = controller.step(state, reference.point(), Vec2{{m[0].x, m[1].x}});
    for (int i = 0; i < 2; ++i) m[i].move(force[i], period);
    reference.advance(period);
  }
  r = reference.point();
  const Vec2 d{{m[0].x - r.position[0], m[1].x - r.position[1]}};
  return {{r.tangent[0] * d[0] + r.tangent[1] * d[1], r.tangent[0] * d[1] - r.tangent[1] * d[0]}};
}

TEST(Contouring, ErrorsAlongAndAcrossDecayEachWithItsOwnPole) {
  // e_l'' + K_v e_l' + K_p e_l = 0 in the moving frame: each part (1 + w t) exp(-w t) of its start, no
  // mixing. The circle turns by 0.2 rad meanwhile; with the printed I at theta'^2 the parts would mix by
  // 1e-2.
  const Vec2 start{{50e-6, -30e-6}};
  const Vec2 e = error_after(contouring(40.0, 60.0), 0.1, start, 1e-5);
  EXPECT_NEAR(e[0], 50e-6 * (1 + 4.0) * std::exp(-4.0), 2e-3 * 50e-6);
  EXPECT_NEAR(e[1], -30e-6 * (1 + 6.0) * std::exp(-6.0), 2e-3 * 50e-6);
}

TEST(Contouring, WithEqualGainsAndNoTurnItIsPdOnEachAxis) {
  // A straight stretch: theta' = 0, so the frame must not matter.
  path::PathPoint r;
  r.tangent = {{0.6, 0.8}};
  r.velocity = {{3e-3, 4e-3}};
  const Contouring two(contouring(40.0, 40.0), kPeriod);
  const Pd one(pd(40.0), kPeriod);
  Contouring::State s;
  Pd::State a;
  Pd::State b;
  for (const double x : {1e-6, 3e-6, -2e-6}) {
    const Vec2 f = two.step(s, r, Vec2{{x, -2 * x}});
    EXPECT_NEAR(f[0], one.step(a, {0.0, 3e-3, 0.0, x}), 1e-12);
    EXPECT_NEAR(f[1], one.step(b, {0.0, 4e-3, 0.0, -2 * x}), 1e-12);
  }
}

TEST(Contouring, IsTheSameLawWhenTheWorldIsTurned) {
  // Everything rotated by 30 degrees: the force must rotate with it.
  const double c = std::cos(0.5);
  const double n = std::sin(0.5);
  const auto turn = [&](const Vec2& v) { return Vec2{{c * v[0] - n * v[1], n * v[0] + c * v[1]}}; };
  path::PathPoint r;
  r.position = {{1e-3, 2e-3}};
  r.velocity = {{9e-3, 0.0}};
  r.acceleration = {{1e-3, 8e-3}};
  r.theta_rate = 0.9;
  r.theta_acceleration = 0.2;
  path::PathPoint q = r;
  q.position = turn(r.position);
  q.velocity = turn(r.velocity);
  q.acceleration = turn(r.acceleration);
  q.tangent = turn(r.tangent);
  const Contouring law(contouring(40.0, 60.0), kPeriod);
  Contouring::State s;
  Contouring::State t;
  for (const Vec2 e : {Vec2{{1e-6, -4e-6}}, Vec2{{2e-6, -3e-6}}}) {
    const Vec2 f = turn(law.step(s, r, r.position + e));
    const Vec2 g = law.step(t, q, q.position + turn(e));
    EXPECT_NEAR(f[0], g[0], 1e-9);
    EXPECT_NEAR(f[1], g[1], 1e-9);
  }
}

TEST(Contouring, AnswersNaNWithItsLastForces) {
  const Contouring law(contouring(40.0, 60.0), kPeriod);
  Contouring::State s;
  const Vec2 before = law.step(s, {}, Vec2{{1e-6, 2e-6}});
  EXPECT_EQ(law.step(s, {}, Vec2{{1e-6, std::nan("")}}), before);
  EXPECT_EQ(s.status.first, Status::kNotFinite);
}

}  // namespace
}  // namespace stribeck::control
