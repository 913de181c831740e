#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <stribeck/ident/health/measured.hpp>

namespace stribeck::ident::health::measured_test {
namespace {

struct Truth {
  double mass = 500.0;
  double coulomb = 200.0, viscous = 4000.0, load = 30.0;  ///< [N], [N·s/m], [N]
  double bump = 0.0;                                      ///< more friction beyond 60 mm [N]
  double wave = 0.0;                                      ///< of 10 mm [N]
  double spring = 0.0;                                    ///< about 40 mm [N/m]
  double noise = 1.0;                                     ///< [N]
};

/// Jogs over 0 … 80 mm at four speeds, then a sine. The force of each row acts in its middle, as under a zero-order hold.
log::Record record_of(const Truth& truth, double top = 20e-3, std::uint32_t seed = 1) {
  constexpr double kPeriod = 2e-3;
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  log::Record r;
  r.source = "test.csv";
  r.sample_time = kPeriod;
  r.loop = log::Loop::kClosed;
  const auto add = [&](double x, double v, double a) {
    const double sign = v > 0.0 ? 1.0 : v < 0.0 ? -1.0 : 0.0;
    r.t.push_back(kPeriod * static_cast<double>(r.t.size()));
    r.x.push_back(x);
    r.r.push_back(x);
    const double middle = x + 0.5 * kPeriod * v;
    r.f.push_back(truth.mass * a + sign * (truth.coulomb + (middle > 0.06 ? truth.bump : 0.0)) +
                  truth.viscous * v + truth.load + truth.spring * (middle - 0.04) +
                  truth.wave * std::sin(2.0 * std::numbers::pi * middle / 0.01) +
                  truth.noise * normal(generator));
  };
  for (const double share : {0.1, 0.25, 0.5, 1.0}) {
    const double v = share * top, time = 0.08 / v;
    for (const double direction : {1.0, -1.0}) {
      for (double t = 0.0; t < time; t += kPeriod)
        add(direction > 0.0 ? v * t : 0.08 - v * t, direction * v, 0.0);
    }
  }
  const double omega = 2.0 * top / 0.08;
  for (double t = 0.0; t < 4.0 * std::numbers::pi / omega; t += kPeriod) {
    const double at = t + 0.5 * kPeriod;
    add(0.04 - 0.04 * std::cos(omega * t), 0.04 * omega * std::sin(omega * at),
        0.04 * omega * omega * std::cos(omega * at));
  }
  return r;
}

TEST(HealthMeasured, FindsWhatTheAxisHas) {
  const Truth truth;
  const std::vector<log::Record> logs{record_of(truth)};
  const Plan plan = plan_of(logs, 0.01);
  ASSERT_EQ(plan.speeds.size(), 4U);
  EXPECT_NEAR(plan.speeds[0], 2e-3, 2e-5);
  EXPECT_NEAR(plan.speeds[3], 20e-3, 2e-4);
  ASSERT_EQ(plan.borders.size(), 5U);
  EXPECT_EQ(plan.periods, (std::vector<double>{0.01, 0.005}));
  const Measured m = measure(logs, plan);
  for (const AtSpeed& s : m.friction) {
    const double friction = truth.coulomb + truth.viscous * s.speed;
    // The sine adds rows up to 5 % below the top speed, where viscous friction is 4 N less.
    EXPECT_NEAR(s.forward.value, friction + truth.load, 1.0) << s.speed;
    EXPECT_NEAR(s.backward.value, friction - truth.load, 1.0) << s.speed;
  }
  EXPECT_NEAR(m.offset.value, 30.0, 0.2);
  ASSERT_TRUE(m.coulomb && m.viscous && m.mass);
  EXPECT_NEAR(m.coulomb->value, 200.0, 0.5);
  EXPECT_NEAR(m.viscous->value, 4000.0, 40.0);
  EXPECT_NEAR(m.mass->value, 500.0, 3.0 * m.mass->half_width);
  EXPECT_LT(m.offset.half_width, 1.0);
  for (const AtPlace& p : m.places) EXPECT_NEAR(p.more.value, 0.0, 0.5);
  EXPECT_NEAR(m.periodic[0].amplitude.value, 0.0, 0.5);
}

TEST(HealthMeasured, FindsMoreFrictionAtAPlaceAndAWave) {
  Truth truth;
  truth.bump = 40.0;
  truth.wave = 15.0;
  const std::vector<log::Record> logs{record_of(truth)};
  const Measured m = measure(logs, plan_of(logs, 0.01));
  ASSERT_EQ(m.places.size(), 4U);
  // 40 N in one of four places: 30 N above the mean there, 10 N below it elsewhere.
  EXPECT_NEAR(m.places[3].more.value, 30.0, 1.0);
  EXPECT_NEAR(m.places[0].more.value, -10.0, 1.0);
  ASSERT_EQ(m.periodic.size(), 2U);
  EXPECT_NEAR(m.periodic[0].amplitude.value, 15.0, 0.5);
  EXPECT_NEAR(m.periodic[1].amplitude.value, 0.0, 0.5);
}

// A chain that pulls with up to a fifth of the friction: without its column it would be mass.
TEST(HealthMeasured, ASpringIsNoMass) {
  Truth truth;
  truth.spring = 1000.0;
  const std::vector<log::Record> logs{record_of(truth)};
  const Plan plan = plan_of(logs, 0.01);
  EXPECT_TRUE(plan.spring);
  const Measured m = measure(logs, plan);
  ASSERT_TRUE(m.spring && m.mass);
  EXPECT_NEAR(m.spring->value, 1000.0, 3.0 * m.spring->half_width);
  EXPECT_LT(m.spring->half_width, 50.0);
  EXPECT_NEAR(m.mass->value, 500.0, 3.0 * m.mass->half_width);
  EXPECT_NEAR(m.offset.value, 30.0, 0.5);
  // A test on another day is fitted in the same way, also where the chain is gone.
  const Measured later = measure({record_of({}, 20e-3, 2)}, plan_of(m));
  ASSERT_TRUE(later.spring);
  EXPECT_NEAR(later.spring->value, 0.0, 3.0 * later.spring->half_width);
  EXPECT_FALSE(plan_of({record_of({})}, 0.01).spring);
}

// Mirror: with x and f turned around, forward and backward change places and the offset its sign.
TEST(HealthMeasured, AMirroredAxisHasMirroredValues) {
  const std::vector<log::Record> logs{record_of({})};
  std::vector<log::Record> mirrored = logs;
  for (double& x : mirrored[0].x) x = -x;
  for (double& x : mirrored[0].r) x = -x;
  for (double& f : mirrored[0].f) f = -f;
  const Measured a = measure(logs, plan_of(logs, 0.0)), b = measure(mirrored, plan_of(mirrored, 0.0));
  EXPECT_NEAR(a.forward.value, b.backward.value, 1e-6);
  EXPECT_NEAR(a.offset.value, -b.offset.value, 1e-6);
  EXPECT_NEAR(a.mass->value, b.mass->value, 1e-6);
}

TEST(HealthMeasured, APlanComesBackFromAMeasurement) {
  const std::vector<log::Record> logs{record_of({})};
  const Plan plan = plan_of(logs, 0.01);
  const Plan again = plan_of(measure(logs, plan));
  EXPECT_EQ(again.speeds, plan.speeds);
  EXPECT_TRUE(again.dwells && plan.dwells);
  EXPECT_EQ(again.borders, plan.borders);
  EXPECT_EQ(again.periods, plan.periods);
}

std::string refusal(const std::function<void()>& what) {
  try {
    what();
  } catch (const Refused& e) {
    return e.what();
  }
  return "not refused";
}

TEST(HealthMeasured, RefusesAMotionWithoutASpeedOfThePlan) {
  const Plan plan = plan_of({record_of({})}, 0.0);
  EXPECT_EQ(
      refusal([&] { measure({record_of({}, 8e-3)}, plan); }),
      "test.csv: got 0 rows near 20 mm/s towards +x, expected 10 (repeat the motion of the first test)");
}

TEST(HealthMeasured, RefusesAForceWithoutNewtons) {
  std::vector<log::Record> logs{record_of({})};
  logs[0].force_unit = "A";
  EXPECT_EQ(refusal([&] { plan_of(logs, 0.0); }),
            "test.csv: got a force in A and a position in m, expected N and m (--gain, --lead)");
}

TEST(HealthMeasured, NamesWhatMakesAMotionAnotherOne) {
  const TestMotion reference{{0.0, 0.08}, 0.02, 0.1, 60.0};
  EXPECT_TRUE(motion_differs(reference, reference).empty());
  TestMotion other = reference;
  other.travel = {0.0, 0.05};
  EXPECT_EQ(motion_differs(other, reference),
            std::vector<std::string>{"got a travel from 0 to 50 mm, expected 0 to 80 mm"});
  other = reference;
  other.duration = 20.0;
  EXPECT_EQ(motion_differs(other, reference), std::vector<std::string>{"got 20 s of sliding, expected 60 s"});
}

}  // namespace
}  // namespace stribeck::ident::health::measured_test
