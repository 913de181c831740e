#include <gtest/gtest.h>

#include <cmath>
#include <stribeck/control/observers/disturbance_observer.hpp>
#include <stribeck/control/test_mass.hpp>

namespace stribeck::control::disturbance_observer_test {
namespace {

using test::kMass;
using test::kPeriod;
using test::Mass;

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

}  // namespace
}  // namespace stribeck::control::disturbance_observer_test
