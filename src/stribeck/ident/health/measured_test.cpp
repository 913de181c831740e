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

/// An arm on a lying axis, from -110 to 110 deg at four speeds, then a sine: 92 N m while it is level, friction of 30 N m and 6 N m s/rad.
std::vector<log::Record> arm_logs(double weight, double hangs_at, std::uint32_t seed) {
  constexpr double kPeriod = 2e-3, kEnd = 1.92, kMass = 6.1;
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  log::Record r;
  r.source = "arm.csv";
  r.sample_time = kPeriod;
  r.loop = log::Loop::kClosed;
  r.rotary = true;
  const auto add = [&](double x, double v, double a) {
    r.t.push_back(kPeriod * static_cast<double>(r.t.size()));
    r.x.push_back(x);
    r.r.push_back(x);
    const double sign = v > 0.0 ? 1.0 : v < 0.0 ? -1.0 : 0.0;
    r.f.push_back(kMass * a + 30.0 * sign + 6.0 * v + weight * std::sin(x + 0.5 * kPeriod * v - hangs_at) +
                  normal(generator));
  };
  for (const double v : {0.2, 0.5, 1.0, 2.0}) {
    for (const double direction : {1.0, -1.0}) {
      for (double t = 0.0; t < 2.0 * kEnd / v; t += kPeriod)
        add(direction * (v * t - kEnd), direction * v, 0.0);
    }
  }
  const double omega = 2.0 / kEnd;
  for (double t = 0.0; t < 4.0 * std::numbers::pi / omega; t += kPeriod) {
    const double at = t + 0.5 * kPeriod;
    add(-kEnd * std::cos(omega * t), kEnd * omega * std::sin(omega * at),
        kEnd * omega * omega * std::cos(omega * at));
  }
  return {r};
}

TEST(HealthMeasured, AnArmHasAnUnbalanceAndNoSpring) {
  const auto logs = arm_logs(92.0, 0.07, 1);
  const Plan plan = plan_of(logs, 0.0);
  EXPECT_TRUE(plan.unbalance);
  EXPECT_FALSE(plan.spring);
  const Measured m = measure(logs, plan);
  ASSERT_TRUE(m.unbalance);
  EXPECT_NEAR(m.unbalance->value, 92.0, 0.5);
  EXPECT_NEAR(m.offset.value, 0.0, 0.5);
  ASSERT_TRUE(m.coulomb);
  EXPECT_NEAR(m.coulomb->value, 30.0, 0.5);
  EXPECT_NEAR(m.viscous->value, 6.0, 0.3);
  EXPECT_NEAR(m.mass->value, 6.1, 0.1);
  // A later test looks for the same, and sees that the arm carries more.
  const Measured later = measure(arm_logs(110.0, 0.07, 2), plan_of(m));
  ASSERT_TRUE(later.unbalance);
  EXPECT_NEAR(later.unbalance->value, 110.0, 0.5);
  EXPECT_NEAR(later.coulomb->value, 30.0, 0.5);
}

TEST(HealthMeasured, ABalancedTableHasNoUnbalance) {
  const Plan plan = plan_of(arm_logs(0.0, 0.0, 3), 0.0);
  EXPECT_FALSE(plan.unbalance);
  EXPECT_FALSE(plan.spring);
}

/// Correlated noise over so many seconds; the friction's interval.
double half_width_of(double seconds, unsigned seed) {
  constexpr double kPeriod = 1e-3, kRho = 0.98;
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  log::Record r;
  r.source = "test.csv";
  r.sample_time = kPeriod;
  r.loop = log::Loop::kClosed;
  double noise = 0.0;
  for (double t = 0.0; t < seconds; t += kPeriod) {
    const double at = t + 0.5 * kPeriod, v = 0.1 * std::cos(2.0 * at) + 0.102 * std::cos(5.1 * at);
    const double a = -0.2 * std::sin(2.0 * at) - 0.5202 * std::sin(5.1 * at);
    noise = kRho * noise + std::sqrt(1.0 - kRho * kRho) * normal(generator);
    r.t.push_back(t);
    r.x.push_back(0.05 * std::sin(2.0 * t) + 0.02 * std::sin(5.1 * t));
    r.r.push_back(r.x.back());
    r.f.push_back(50.0 * a + (v > 0.0 ? 30.0 : -30.0) + 100.0 * v + noise);
  }
  return measure({r}, plan_of({r}, 0.0)).forward.half_width;
}

// More than 30 000 rows are thinned: neighbours are then two rows apart, and still correlated.
TEST(HealthMeasured, ThinnedRowsKeepTheirCorrelation) {
  double ratio = 0.0;
  constexpr unsigned kSeeds = 10;
  for (unsigned seed = 1; seed <= kSeeds; ++seed)
    ratio += half_width_of(32.0, seed) / half_width_of(29.0, seed) / kSeeds;
  EXPECT_NEAR(ratio, 1.0, 0.15);
}

}  // namespace
}  // namespace stribeck::ident::health::measured_test
