#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <stribeck/friction/dynamics.hpp>
#include <stribeck/friction/gms.hpp>
#include <stribeck/friction/test_maps.hpp>

template struct stribeck::friction::Gms<ceres::Jet<double, 3>>;

namespace stribeck::friction::gms_test {
namespace {

Gms<double> four_elements(double damping = 0.0) {
  Gms<double> law;
  law.elements = {GmsElement<double>{1.6e8, 0.25}, GmsElement<double>{0.8e8, 0.25},
                  GmsElement<double>{0.4e8, 0.25}, GmsElement<double>{0.2e8, 0.25}};
  law.attraction = 1e5;
  law.damping_coefficient = damping;
  return law;
}

TEST(Gms, ExactHoldEqualsAFineReference) {
  // Reference: Euler with the switching rule checked at 400 000 steps.
  const auto law = four_elements();
  const auto map = test::table_2_3_x();
  for (const double v : {2e-4, 1e-3, -5e-3}) {
    Gms<double>::State exact;
    Gms<double>::State fine;
    const auto p = map.parts(v, 0.0);
    constexpr int kFine = 400000;
    for (int i = 0; i < kFine; ++i) {
      for (std::size_t k = 0; k < 4; ++k)
        fine.force[k] += 2e-2 / kFine * law.rate(k, fine.force[k], fine.slipping[k], v, p);
      law.settle(fine, v, v, p);
    }
    law.step(map, exact, v, 0.0, 2e-2);
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_NEAR(exact.force[k], fine.force[k], 1e-4 * std::abs(fine.force[k]) + 1e-3)
          << "element " << k << " at " << v;
      EXPECT_EQ(exact.slipping[k], fine.slipping[k]);
    }
  }
}

TEST(Gms, TheRatesOfAllElementsAreThoseOfEach) {
  // From the exact hold: what each force changes by in a short time, with elements that stick and that slip at different forces.
  const auto law = four_elements();
  const SteadyParts<double> p{400.0, 0.0, 0.0};
  Gms<double>::State s;
  s.force = {60.0, 90.0, 30.0, -20.0};
  s.slipping = {1.0, 1.0, 0.0, 0.0};
  const auto rates = law.rate(Gms<double>::Numbers(s.force), s, 1e-4, p);
  Gms<double>::State later = s;
  constexpr double kShort = 1e-9;
  law.advance(later, 1e-4, p.level, kShort);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_NEAR(rates[i], (later.force[i] - s.force[i]) / kShort, 1e-3 * std::abs(rates[i])) << i;
  EXPECT_NE(rates[0], rates[1]);
}

TEST(Gms, AnIntegratorBeginsWithTheForceOfEveryElement) {
  Gms<double>::State begun;
  begun.force = {60.0, 90.0, 30.0, -20.0};
  Integrated<Gms<double>> integrated(four_elements());
  std::array<double, Integrated<Gms<double>>::kCount> q{};
  integrated.place(begun, q.data());
  for (std::size_t i = 0; i < begun.force.size(); ++i) EXPECT_EQ(q[i], begun.force[i]) << i;
}

TEST(Gms, EveryElementSlipsTowardsItsOwnShare) {
  Gms<double> law;
  law.elements = {GmsElement<double>{1.6e8, 0.5}, GmsElement<double>{0.8e8, 0.3},
                  GmsElement<double>{0.4e8, 0.2}};
  law.attraction = 1e5;
  const SteadyParts<double> p{400.0, 0.0, 0.0};
  const std::array<double, 3> share{0.5, 0.3, 0.2};
  for (std::size_t i = 0; i < share.size(); ++i) {
    // At its share of the level it has nowhere to go, below it grows, above it falls.
    EXPECT_NEAR(law.rate(i, share[i] * 400.0, 1.0, 1e-3, p), 0.0, 1e-9) << i;
    EXPECT_GT(law.rate(i, share[i] * 400.0 - 1.0, 1.0, 1e-3, p), 0.0) << i;
    EXPECT_LT(law.rate(i, share[i] * 400.0 + 1.0, 1.0, 1e-3, p), 0.0) << i;
  }
}

TEST(Gms, OneStepEqualsManyWhateverTheirLength) {
  const auto law = four_elements();
  const test::Flat map{1000.0};
  Gms<double>::State one;
  Gms<double>::State many;
  const double f = law.step(map, one, 4e-4, 0.0, 1e-2);
  double g = 0.0;
  for (int i = 0; i < 1000; ++i) g = law.step(map, many, 4e-4, 0.0, 1e-5);
  EXPECT_NEAR(f, g, 1e-9 * f);
}

TEST(Gms, SteadySlidingTendsToTheCurve) {
  const auto map = test::table_2_3_y();
  const auto law = four_elements();
  for (const double v : {5e-4, 4e-3, -9.5e-3}) {
    Gms<double>::State s;
    double f = 0.0;
    for (int i = 0; i < 2000; ++i) f = law.step(map, s, v, 0.0, 1e-3);
    EXPECT_NEAR(f, steady_force(map, v), 1e-9 * std::abs(f)) << v;
  }
}

TEST(Gms, FirstPreSlidingHasTheSumOfTheStiffnesses) {
  const auto law = four_elements();
  EXPECT_DOUBLE_EQ(law.stiffness(), 3e8);
  Gms<double>::State s;
  EXPECT_NEAR(law.step(test::Flat{1000.0}, s, 1e-8, 0.0, 1e-2) / 1e-10, 3e8, 1.0);
}

TEST(Gms, PreSlidingLoopIsPiecewiseLinearByMasingsRule) {
  // First along the virgin curve to 2 um, then back by 2 um. The return branch has twice the breaks of the virgin curve (Masing),
  // so the force falls by twice the virgin force at half the distance.
  const auto law = four_elements();
  const test::Flat map{1000.0};
  const auto virgin = [&](double x) {
    double f = 0.0;
    for (const auto& e : law.elements) f += std::min(e.stiffness * x, e.share * 1000.0);
    return f;
  };
  Gms<double>::State s;
  double f = 0.0;
  for (int i = 0; i < 2000; ++i) f = law.step(map, s, 1e-6, 0.0, 1e-3);
  EXPECT_NEAR(f, virgin(2e-6), 1e-6);
  for (int i = 0; i < 2000; ++i) f = law.step(map, s, -1e-6, 0.0, 1e-3);
  EXPECT_NEAR(f, virgin(2e-6) - 2 * virgin(1e-6), 1e-6);
}

TEST(Gms, ClosedLoopsInPreSlidingReturnToWhereTheyBegan) {
  // Non-local memory: a small loop inside a large one leaves no trace.
  const auto law = four_elements();
  const test::Flat map{1000.0};
  Gms<double>::State s;
  for (int i = 0; i < 1500; ++i) law.step(map, s, 1e-6, 0.0, 1e-3);
  double before = 0.0;
  for (const double f : s.force) before += f;
  for (int i = 0; i < 300; ++i) law.step(map, s, -1e-6, 0.0, 1e-3);
  double after = 0.0;
  for (int i = 0; i < 300; ++i) after = law.step(map, s, 1e-6, 0.0, 1e-3);
  EXPECT_NEAR(after, before, 1e-6);
}

TEST(Gms, DissipatesOverAClosedCycle) {
  const auto map = test::table_2_3_x();
  const auto law = four_elements(600e3);
  Gms<double>::State s;
  double work = 0.0;
  double least = 0.0;
  for (int i = 0; i < 40000; ++i) {
    const double v = 2e-3 * std::sin(2 * kPi * i / 10000.0);
    work += law.step(map, s, v, 0.0, 1e-4) * v * 1e-4;
    if (i % 10000 == 9999) {
      EXPECT_GT(work, least);
      least = work;
    }
  }
}

TEST(Gms, MirrorsUnderSignOfVelocity) {
  const auto law = four_elements();
  const test::Flat map{800.0};
  Gms<double>::State plus;
  Gms<double>::State minus;
  for (const double v : {1e-5, 4e-3, -2e-4, 1e-3}) {
    EXPECT_EQ(law.step(map, plus, v, 0.0, 5e-3), -law.step(map, minus, -v, 0.0, 5e-3));
  }
}

TEST(Gms, ComplainsAboutSharesThatDoNotAddUp) {
  auto law = four_elements();
  law.elements[0].share = 0.3;
  std::string said;
  law.validate([&](std::string_view key, std::string_view) { said = key; });
  EXPECT_EQ(said, "elements");
}

TEST(Gms, AtRestNoElementMoves) {
  const auto law = four_elements();
  const SteadyParts<double> p{400.0, 0.0, 0.0};
  for (const double zero : {0.0, -0.0}) {
    Gms<double>::State s;
    s.force = {60.0, -90.0, 30.0, 0.0};
    s.slipping = {1.0, 1.0, 0.0, 0.0};
    const auto rates = law.rate(Gms<double>::Numbers(s.force), s, zero, p);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(rates[i], 0.0) << i;
    const auto before = s.force;
    law.advance(s, zero, p.level, 0.1);
    EXPECT_EQ(s.force, before);
    law.settle(s, 1e-3, zero, p);
    EXPECT_EQ(s.force, before);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(s.slipping[i], 0.0) << "a stop ends every slip";
  }
}

}  // namespace
}  // namespace stribeck::friction::gms_test
