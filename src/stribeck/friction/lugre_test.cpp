#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <stribeck/core/taylor.hpp>
#include <stribeck/friction/lugre.hpp>
#include <stribeck/friction/test_maps.hpp>

template struct stribeck::friction::LuGre<ceres::Jet<double, 3>>;
template struct stribeck::friction::LuGre<stribeck::Taylor<2>>;

namespace stribeck::friction::lugre_test {
namespace {

// V2: 3e5 N/mm, 600 N s/mm fading at 0.05 mm/s.
const LuGre<double> kLaw{3e8, 600e3, 0.05e-3};

TEST(LuGre, ExactHoldEqualsFineEuler) {
  const auto map = test::table_2_3_x();
  for (const double v : {2e-6, 4e-5, 8e-4, -6e-3}) {
    LuGre<double>::State exact{1e-6};
    double z = 1e-6;
    constexpr int kFine = 400000;
    for (int i = 0; i < kFine; ++i) z += 5e-3 / kFine * kLaw.rate(z, v, map.parts(v, 0.0));
    kLaw.step(map, exact, v, 0.0, 5e-3);
    // Euler's own error with 400 000 steps is a relative 5e-6 of what changes.
    EXPECT_NEAR(exact.z, z, 1e-5 * std::abs(z - 1e-6) + 1e-14) << v;
  }
}

TEST(LuGre, OneStepEqualsManyWhateverTheirLength) {
  const auto map = test::table_2_3_x();
  LuGre<double>::State one{-2e-6};
  LuGre<double>::State many{-2e-6};
  const double f = kLaw.step(map, one, 3e-3, 0.0, 5e-3);
  double g = 0.0;
  for (int i = 0; i < 1000; ++i) g = kLaw.step(map, many, 3e-3, 0.0, 5e-6);
  EXPECT_NEAR(one.z, many.z, 1e-12 * std::abs(many.z));
  EXPECT_NEAR(f, g, 1e-9 * std::abs(g));
  // A step a thousand times longer than the bristle's memory lands on the curve.
  kLaw.step(map, one, 3e-3, 0.0, 10.0);
  EXPECT_NEAR(one.z, map.parts(3e-3, 0.0).level / kLaw.sigma0, 1e-18);
}

TEST(LuGre, SteadySlidingTendsToTheCurve) {
  const auto map = test::table_2_3_y();
  for (const double v : {5e-4, 4e-3, 9.5e-3, -5e-4, -9.5e-3}) {
    LuGre<double>::State s;
    double f = 0.0;
    for (int i = 0; i < 2000; ++i) f = kLaw.step(map, s, v, 0.0, 1e-3);
    EXPECT_NEAR(f, steady_force(map, v), 1e-9 * std::abs(f)) << v;
  }
}

TEST(LuGre, WithoutADampingTheFirstForceIsThatOfTheSpringAlone) {
  LuGre<double> law;
  law.sigma0 = 3e8;
  EXPECT_EQ(law.damping(1e-8), 0.0);
}

TEST(LuGre, FirstPreSlidingIsASpringOfStiffnessSigma0) {
  LuGre<double>::State s;
  const LuGre<double> undamped{3e8, 0.0, {}};
  const double f = undamped.step(test::Flat{1000.0}, s, 1e-8, 0.0, 1e-2);  // 0.1 nm
  EXPECT_NEAR(f / 1e-10, 3e8, 1e-4 * 3e8);
}

TEST(LuGre, PreSlidingHasHysteresis) {
  // Back and forth over 1 um, a third of g/sigma0: the force at the middle depends on the direction from which it is reached.
  const LuGre<double> law{3e8, 0.0, {}};
  const test::Flat map{1000.0};
  LuGre<double>::State s;
  double up = 0.0;
  double down = 0.0;
  for (int cycle = 0; cycle < 20; ++cycle) {
    for (int i = 0; i < 1000; ++i) {
      const double f = law.step(map, s, 1e-6, 0.0, 1e-3);
      if (i == 499) up = f;
    }
    for (int i = 0; i < 1000; ++i) {
      const double f = law.step(map, s, -1e-6, 0.0, 1e-3);
      if (i == 499) down = f;
    }
  }
  EXPECT_GT(up - down, 20.0);
  EXPECT_NEAR(up, -down, 0.5);  // a symmetric map: a symmetric loop
}

TEST(LuGre, DissipatesOverAClosedCycle) {
  const auto map = test::table_2_3_x();
  LuGre<double>::State s;
  double work = 0.0;
  double least = 0.0;
  for (int i = 0; i < 40000; ++i) {
    const double v = 2e-3 * std::sin(2 * kPi * i / 10000.0);
    const double f = kLaw.step(map, s, v, 0.0, 1e-4);
    work += f * v * 1e-4;
    if (i % 10000 == 9999) {
      EXPECT_GT(work, least) << "cycle " << i / 10000;
      least = work;
    }
  }
}

TEST(LuGre, MirrorsUnderSignOfVelocity) {
  const test::Flat map{800.0};
  LuGre<double>::State plus{1e-6};
  LuGre<double>::State minus{-1e-6};
  for (const double v : {1e-5, 4e-3, -2e-4}) {
    EXPECT_EQ(kLaw.step(map, plus, v, 0.0, 5e-3), -kLaw.step(map, minus, -v, 0.0, 5e-3));
  }
}

TEST(LuGre, JetGivesTheDerivativeByStiffness) {
  using J = ceres::Jet<double, 3>;
  const auto map = test::table_2_3_x<J>();
  LuGre<J> law{J(3e8, 0), J(0.0), {}};
  LuGre<J>::State s{J(1e-6)};
  const J f = law.step(map, s, J(2e-4), J(0.0), 5e-3);
  const auto force = [&](double sigma0) {
    LuGre<double>::State d{1e-6};
    return LuGre<double>{sigma0, 0.0, {}}.step(test::table_2_3_x(), d, 2e-4, 0.0, 5e-3);
  };
  EXPECT_NEAR(f.v[0], (force(3e8 + 100) - force(3e8 - 100)) / 200, 1e-6 * std::abs(f.v[0]));
}

TEST(LuGre, RateBoundIsTheRelaxationRateOfTheBristle) {
  // From the law itself: two states at the same speed approach each other by exp(-bound·t).
  const test::Flat flat{800.0};
  for (const double v : {2e-4, 3e-3}) {
    LuGre<double>::State a{0.0};
    LuGre<double>::State b{1e-6};
    const LuGre<double> law{3e8, 0.0, {}};
    const double dt = 1e-3;
    law.step(flat, a, v, 0.0, dt);
    law.step(flat, b, v, 0.0, dt);
    EXPECT_NEAR(law.rate_bound(v, 800.0), -std::log((b.z - a.z) / 1e-6) / dt, 1e-6 * law.rate_bound(v, 800.0))
        << v;
  }
}

TEST(LuGre, HoldGainIsSmoothAcrossItsSeries) {
  EXPECT_EQ(hold_gain(0.0), 1.0);
  EXPECT_NEAR(hold_gain(1e-3 * (1 - 1e-15)), hold_gain(1e-3 * (1 + 1e-15)), 1e-12);
  EXPECT_NEAR(hold_gain(2.0), (1 - std::exp(-2.0)) / 2.0, 1e-15);
}

}  // namespace
}  // namespace stribeck::friction::lugre_test
