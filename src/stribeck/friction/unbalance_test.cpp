// A weight that turns with a rotary axis.
#include <gtest/gtest.h>

#include <stribeck/friction/unbalance.hpp>

namespace stribeck::friction::unbalance_test {
namespace {

TEST(Unbalance, PushesBackToWhereItHangsAndIsWorthItsWeightAtAQuarterTurn) {
  const Unbalance u{16.5, 0.4};
  EXPECT_EQ(u.at(0.4), 0.0);
  EXPECT_NEAR(u.at(0.4 + 0.5 * kPi), 16.5, 1e-12);
  EXPECT_GT(u.at(0.5), 0.0) << "a motor that holds it there pushes forward";
  EXPECT_LT(u.at(0.3), 0.0);
}

TEST(Unbalance, AsATermOfAnAxisFileIsTheSameForceAndIsKnownAsOne) {
  const Unbalance u{16.5, 0.4};
  Eccentric<double> term = u.term();
  EXPECT_TRUE(is_unbalance(term));
  for (const double x : {-2.0, 0.1, 1.7, 9.0}) {
    SteadyParts<double> p{};
    term.add_to(p, x);
    EXPECT_NEAR(p.additive, u.at(x), 1e-12) << x;
  }
  term.period = 3.0;  // a lead
  EXPECT_FALSE(is_unbalance(term));
  term = u.term();
  term.form = EccentricForm::kProportional;
  EXPECT_FALSE(is_unbalance(term));
}

}  // namespace
}  // namespace stribeck::friction::unbalance_test
