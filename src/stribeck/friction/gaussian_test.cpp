#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <stribeck/core/taylor.hpp>
#include <stribeck/friction/model.hpp>
#include <stribeck/friction/test_maps.hpp>

// Every member compiles for the other scalars: a forgotten select() would not.
template struct stribeck::friction::Gaussian<stribeck::Taylor<2>>;
template struct stribeck::friction::Gaussian<ceres::Jet<double, 11>>;

namespace stribeck::friction::gaussian_test {
namespace {

// Values from NumPy: e0 + e1*v + sum(a*exp(-((v-b)/c)**2)) with the digits of Table 2.3.
TEST(Gaussian, AgreesWithNumPyOnTable23) {
  const auto x = test::table_2_3_x();
  const auto y = test::table_2_3_y();
  for (const auto& [v, fx, fy] : {std::array{0.5, 1257.790440209842, 1073.8654290359718},
                                  {2.0, 1494.5057026286536, 1547.6564863993744},
                                  {5.8, 1968.631537815945, 2319.038084645958},
                                  {9.5, 3106.150330170575, 2996.9265295218706},
                                  {-0.5, -1040.4885444926083, -1003.5598197838258},
                                  {-2.0, -1353.840625881503, -1293.6182491124725},
                                  {-5.8, -1966.807946471989, -1765.9716131823639},
                                  {-9.5, -2742.855529472575, -2282.8299418447805}}) {
    EXPECT_NEAR(steady_force(x, v * 1e-3), fx, 1e-9) << "x at " << v << " mm/s";
    EXPECT_NEAR(steady_force(y, v * 1e-3), fy, 1e-9) << "y at " << v << " mm/s";
  }
}

TEST(Gaussian, ViscousFrictionIsThatOfTheSideWhateverTheSpeed) {
  auto map = test::table_2_3_x();
  map.negative.eta1 = 0.8 * map.positive.eta1;
  for (const double v : {1e-9, 0.5, 3.0}) {
    EXPECT_EQ(map.viscous_coefficient(v), map.positive.eta1);
    EXPECT_EQ(map.viscous_coefficient(-v), map.negative.eta1);
  }
}

TEST(Gaussian, HoldsTheSumOutsideItsRangeWhereTheFormulaWouldInventThousandsOfNewtons) {
  const auto map = test::table_2_3_x();
  const double border = steady_force(map, -9.5e-3);
  EXPECT_NEAR(steady_force(map, -14e-3), border - 102.48 * 4.5, 1e-9);
  // The bare formula at -14 mm/s gives -768.6 - 1434.7 - 4472 = -6675 N.
  EXPECT_GT(steady_force(map, -14e-3), -3300.0);
  const Model model{map, {}, {}};
  EXPECT_TRUE(model.covers(9.5e-3));
  EXPECT_FALSE(model.covers(-9.51e-3));
}

TEST(Gaussian, WithoutTermsIsCoulombAndViscous) {
  const Gaussian<double> map{
      test::branch(768.6, 102.48, {}), test::branch(-640.5, 140.91, {}), {-1e-2, 1e-2}};
  EXPECT_NEAR(steady_force(map, 3e-3), 768.6 + 3 * 102.48, 1e-10);
  EXPECT_NEAR(steady_force(map, -3e-3), -640.5 - 3 * 140.91, 1e-10);
}

TEST(Gaussian, BranchesWithDifferentNumbersOfTermsDoNotMix) {
  const Gaussian<double> map{
      test::branch(700, 100, {{100, 2, 1}}), test::branch(-700, 100, {}), {-1e-2, 1e-2}};
  EXPECT_NEAR(steady_force(map, 2e-3), 700 + 200 + 100, 1e-10);
  EXPECT_NEAR(steady_force(map, -2e-3), -900, 1e-10);
}

TEST(Gaussian, MirroredBranchesMirrorTheForce) {
  auto map = test::table_2_3_x();
  map.negative = test::branch(-768.6, 102.48,
                              {{-517.4, -1.763, 3.091}, {-509.3, -5.806, 1.825}, {-1995.9, -10.668, 1.876}});
  for (const double v : {1e-4, 2e-3, 9e-3, 2e-2}) EXPECT_EQ(steady_force(map, -v), -steady_force(map, v));
}

TEST(Gaussian, ScalesWithTheUnitOfForce) {
  auto map = test::table_2_3_x();
  auto twice = map;
  for (auto* b : {&twice.positive, &twice.negative}) {
    b->eta0 *= 2;
    b->eta1 *= 2;
    for (auto& g : b->gaussians) g.a *= 2;
  }
  for (const double v : {-7e-3, 4e-3}) EXPECT_DOUBLE_EQ(steady_force(twice, v), 2 * steady_force(map, v));
}

TEST(Gaussian, JetEqualsCentralDifference) {
  using J = ceres::Jet<double, 11>;
  auto map = test::table_2_3_x<J>();
  map.positive.gaussians[1].b.v[6] = 1.0;  // derivative by the second centre
  const double v = 5e-3;
  const double automatic = steady_force(map, J(v)).v[6];
  auto moved = test::table_2_3_x();
  const double h = 1e-7;
  moved.positive.gaussians[1].b += h;
  const double up = steady_force(moved, v);
  moved.positive.gaussians[1].b -= 2 * h;
  EXPECT_NEAR(automatic, (up - steady_force(moved, v)) / (2 * h), 1e-6 * std::abs(automatic));
}

TEST(Gaussian, ComplainsAboutALevelThatDoesNotOppose) {
  const Gaussian<double> map{test::branch(100, 1, {{-300, 5, 1}}), test::branch(-100, 1, {}), {-1e-2, 1e-2}};
  std::string said;
  map.validate([&](std::string_view key, std::string_view) { said += key; });
  EXPECT_EQ(said, "positive");
}

}  // namespace
}  // namespace stribeck::friction::gaussian_test
