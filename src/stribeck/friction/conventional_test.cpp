#include <gtest/gtest.h>

#include <stribeck/friction/conventional.hpp>
#include <stribeck/friction/static.hpp>

namespace stribeck::friction::conventional_test {
namespace {

Conventional<double> table_4_2_x(double delta) {
  return {20.0, 5.0e3, Stribeck<double>{35.0, 0.6e-3, delta}};
}

// Values from NumPy, the formula typed there in N and mm/s: (20 + 15 exp(-(v/0.6)**d)) + 5 v.
TEST(Conventional, AgreesWithNumPyOnTable42) {
  for (const auto& [v, squared, linear] : {std::array{0.1, 35.08906715674523, 33.19722587335921},
                                           {0.6, 28.518191617571635, 28.518191617571635},
                                           {3.0, 35.00000000020832, 35.10106920498628}}) {
    EXPECT_NEAR(steady_force(table_4_2_x(2.0), v * 1e-3), squared, 1e-11);
    EXPECT_NEAR(steady_force(table_4_2_x(1.0), v * 1e-3), linear, 1e-11);
  }
}

TEST(Conventional, TendsToStaticAndCoulombFriction) {
  const auto map = table_4_2_x(2.0);
  EXPECT_NEAR(steady_force(map, 1e-12), 35.0, 1e-6);
  EXPECT_NEAR(map.parts(1.0, 0.0).level, 20.0, 1e-12);
  EXPECT_EQ(steady_force(map, 0.0), 0.0);
}

TEST(Conventional, WithoutStribeckPartTheLevelIsCoulombAtEveryVelocity) {
  // Table 2.1 prints zeros for v0 and delta; taken as numbers they would leave a factor exp(-1).
  const Conventional<double> map{1255.38, 105.54e3, {}};
  EXPECT_EQ(map.parts(0.0, 0.0).level, 1255.38);
  EXPECT_NEAR(steady_force(map, -4e-3), -1255.38 - 105.54 * 4.0, 1e-9);
}

TEST(Conventional, ScaledByAFactorEveryForceIs) {
  // As a machine that is warm has it: Coulomb, static and viscous friction all together.
  const auto map = table_4_2_x(1.0);
  const auto warm = map.scaled(0.4);
  for (const double v : {1e-6, 3e-4, 2e-3, 0.5})
    EXPECT_NEAR(steady_force(warm, v), 0.4 * steady_force(map, v), 1e-9);
  EXPECT_EQ(Conventional<double>({10.0, 0.0, {}}).scaled(3.0).parts(1.0, 0.0).level, 30.0);
}

TEST(Conventional, MirrorsUnderSignOfVelocityForOddShape) {
  const auto map = table_4_2_x(1.0);
  for (const double v : {1e-5, 3e-4, 2e-3}) EXPECT_EQ(steady_force(map, -v), -steady_force(map, v));
}

TEST(Conventional, AStribeckPartThatIsNotGivenHasNoStaticFriction) {
  EXPECT_EQ(Stribeck<double>{}.alpha1, 0.0);
}

TEST(Conventional, WithoutPreSlidingThereIsNoFrictionAtRest) {
  const Static law;
  Static::State s;
  EXPECT_EQ(law.bristle(s, 0.0, 30.0, 1.0), 0.0);
  EXPECT_EQ(law.bristle(s, 1e-9, 30.0, 1.0), 30.0);
  EXPECT_EQ(law.bristle(s, -1e-9, 30.0, 1.0), -30.0);
  EXPECT_EQ(law.shift(s, 10.0, 30.0), 0.0) << "nothing is deflected";
  const SteadyParts<double> none;
  EXPECT_EQ(none.level, 0.0);
  EXPECT_EQ(none.viscous, 0.0);
  EXPECT_EQ(none.additive, 0.0);
}

}  // namespace
}  // namespace stribeck::friction::conventional_test
