#include <gtest/gtest.h>

#include <stribeck/core/scalar.hpp>
#include <stribeck/friction/eccentric.hpp>
#include <stribeck/friction/test_maps.hpp>

namespace stribeck::friction::eccentric_test {
namespace {

TEST(Eccentric, PrintedFormKeepsItsSignWithDirectionAndTheOtherFollowsIt) {
  // Table 2.4, y axis: 11.2 N, 2 mm, -0.27 rad; peak where 2 pi x / 2 mm + 0.27 = pi / 2.
  const double peak = 2e-3 * (kPi / 2 - 0.27) / (2 * kPi);
  SteadyParts<double> p{15.0, 0.0, 0.0};
  Eccentric<double> term{11.2, 2e-3, -0.27, EccentricForm::kAdditive};
  term.add_to(p, peak);
  EXPECT_NEAR(p.additive, 11.2, 1e-12);
  EXPECT_EQ(p.level, 15.0);
  term.form = EccentricForm::kProportional;
  p = {15.0, 0.0, 0.0};
  term.add_to(p, peak + 1e-3);  // half a turn on
  EXPECT_NEAR(p.level, 15.0 - 11.2, 1e-12);
  EXPECT_EQ(p.additive, 0.0);
}

TEST(Eccentric, RepeatsWithItsPeriodAndVanishesWithItsAmplitude) {
  const Eccentric<double> term{4.2, 2e-3, 0.28, EccentricForm::kAdditive};
  SteadyParts<double> here;
  SteadyParts<double> there;
  term.add_to(here, 0.3e-3);
  term.add_to(there, 0.3e-3 + 7 * 2e-3);
  EXPECT_NEAR(here.additive, there.additive, 1e-12);
  SteadyParts<double> none;
  Eccentric<double>{0.0, 2e-3, 0.28, EccentricForm::kAdditive}.add_to(none, 1e-3);
  EXPECT_EQ(none.additive, 0.0);
}

}  // namespace
}  // namespace stribeck::friction::eccentric_test
