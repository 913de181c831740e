#include <gtest/gtest.h>

#include <cmath>
#include <stribeck/control/observers/kalman_observer.hpp>
#include <stribeck/control/test_mass.hpp>

namespace stribeck::control::kalman_observer_test {
namespace {

using test::kMass;
using test::kPeriod;
using test::Mass;

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

TEST(KalmanObserver, AnswerIsItsOwnLag) {
  const double mass = 50.0;
  const KalmanObserver o(KalmanObserver::density(60.0, 1e-7, mass), 1e-14 / 12.0, mass, 1e-3);
  KalmanObserver::State s;
  Mass axis;
  Vec<double, 3> error{};
  o.step(s, 0.0, 0.0);
  for (int k = 0; k < 300; ++k) {
    const double d = 10.0 * std::sin(0.03 * k);
    axis.move(-d, 1e-3, mass);
    EXPECT_NEAR(o.step(s, 0.0, axis.x), o.answer(error, d), 1e-9);
  }
  // Two thirds of a step are reached within half to three times 1/ω.
  error = {};
  int k = 0;
  while (o.answer(error, 1.0) < 0.63) ++k;
  EXPECT_GT(k, 1000 * 0.5 / 60.0);
  EXPECT_LT(k, 1000 * 3.0 / 60.0);
}

TEST(KalmanObserver, TheBandwidthOfADensityIsTheOneItWasMadeFor) {
  for (const double bandwidth : {30.0, 200.0}) {
    const double q = KalmanObserver::density(bandwidth, 1e-7, 800.0);
    EXPECT_NEAR(KalmanObserver::bandwidth(q, 1e-7, 800.0), bandwidth, 1e-9 * bandwidth);
  }
}

}  // namespace
}  // namespace stribeck::control::kalman_observer_test
