#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/residual/residual.hpp>

namespace stribeck::ident::residual::elastic_test {
namespace {

constexpr double kT = 1e-3, kMotor = 6.0, kViscous = 80.0;

/// What the drive is made of; friction is that of Coulomb on either side [N].
struct Drive {
  double table = 20.0;      ///< [kg]
  double frequency = 15.0;  ///< anti-resonance [Hz]
  double damping = 0.02;
  double on_motor = 30.0;
  double on_table = 0.0;
};

/// The motor moves as given; the table follows on its spring, in steps of 10 us. `lag`: time of a filter of the force [s].
log::Record record_of(const Drive& d, double noise = 0.2, double lag = 0.0) {
  log::Record r;
  r.source = "log.csv";
  r.sample_time = kT;
  std::mt19937 random(7);
  std::normal_distribution<double> normal(0.0, 1.0);
  constexpr int kSteps = 100;
  constexpr double kStep = kT / kSteps;
  const double k = d.table * std::pow(2.0 * kPi * d.frequency, 2.0);
  const double c = 2.0 * d.damping * 2.0 * kPi * d.frequency * d.table;
  double x2 = 0.0, v2 = 0.0, force = 0.0;
  for (int i = 0; i < 20'000; ++i) {
    double mean = 0.0;
    for (int j = 0; j < kSteps; ++j) {
      const double t = kT * i + kStep * j;
      const double soft = std::min(1.0, t);  // begins at rest
      double x = 0.0, v = 0.0, a = 0.0;
      for (const auto& [hz, size] :
           {std::pair(0.3, 0.08), std::pair(1.7, 4e-3), std::pair(4.3, 1e-3), std::pair(7.9, 3e-4)}) {
        const double w = 2.0 * kPi * hz;
        x += soft * size * std::sin(w * t), v += soft * size * w * std::cos(w * t);
        a -= soft * size * w * w * std::sin(w * t);
      }
      if (j == 0) {
        if (i == 0) x2 = x, v2 = v;
        r.t.push_back(t);
        r.x.push_back(x);
      }
      const double spring = k * (x - x2) + c * (v - v2);
      const double free = v2 + spring / d.table * kStep;
      const double brake = d.on_table / d.table * kStep;
      v2 = std::abs(free) <= brake ? 0.0 : free - (free > 0.0 ? brake : -brake);
      x2 += v2 * kStep;
      const double rigid = kMotor * a + kViscous * v + (v > 0.0 ? d.on_motor : -d.on_motor);
      force += lag > 0.0 ? (rigid + spring - force) * kStep / lag : rigid + spring - force;
      mean += force / kSteps;
    }
    r.f.push_back(mean + noise * normal(random));
  }
  return r;
}

/// A rigid model that was fitted to the log of an elastic drive has some mass and friction.
Result rigid_model(const Drive& d, double more_mass = 3.0) {
  Result r;
  r.mass = kMotor + d.table + more_mass;
  r.friction.steady = friction::Conventional<double>{d.on_motor + d.on_table, kViscous, {}};
  return r;
}

TEST(Elastic, FindsTheTableOnItsSpring) {
  const Drive drive;
  const Diagnosis d = diagnose({record_of(drive)}, rigid_model(drive));
  ASSERT_TRUE(d.elastic);
  EXPECT_NEAR(d.elastic->frequency, drive.frequency, 0.02 * drive.frequency);
  EXPECT_NEAR(d.elastic->table_mass, drive.table, 0.05 * drive.table);
  EXPECT_NEAR(d.elastic->mass, kMotor + drive.table, 0.01 * (kMotor + drive.table));
  EXPECT_NEAR(d.elastic->damping, drive.damping, 0.02);
}

// Friction of the guide acts behind the spring: the table sticks while the motor turns back.
TEST(Elastic, TellsFrictionBehindTheSpring) {
  const Drive drive{20.0, 15.0, 0.02, 5.0, 25.0};
  const Diagnosis d = diagnose({record_of(drive)}, rigid_model(drive));
  ASSERT_TRUE(d.elastic);
  EXPECT_NEAR(d.elastic->frequency, drive.frequency, 0.05 * drive.frequency);
  EXPECT_NEAR(d.elastic->mass, kMotor + drive.table, 0.03 * (kMotor + drive.table));
  EXPECT_NEAR(d.elastic->friction, drive.on_table, 0.3 * drive.on_table);
}

TEST(Elastic, TheForceOfTheSpringIsWhatARigidDriveLeaves) {
  const Drive drive;
  const log::Record elastic = record_of(drive, 0.0);
  const Diagnosis d = diagnose({elastic}, rigid_model(drive));
  ASSERT_TRUE(d.elastic);
  const std::vector<double> more = force_of(*d.elastic, log::reconstruct(elastic));
  // 500 Hz: as good as rigid.
  const log::Record rigid = record_of({drive.table, 500.0, 0.02, drive.on_motor, 0.0}, 0.0);
  double left = 0.0, all = 0.0;
  for (std::size_t k = 2000; k + 100 < more.size(); ++k) {
    const double difference = elastic.f[k] - rigid.f[k];
    left += std::pow(difference - 0.5 * (more[k] + more[k + 1]), 2.0), all += difference * difference;
  }
  EXPECT_LT(left, 0.03 * all);
}

TEST(Elastic, ARigidDriveIsNotElastic) {
  for (const double more_mass : {0.0, 3.0}) {
    const Drive drive{20.0, 500.0, 0.02, 30.0, 0.0};
    EXPECT_FALSE(diagnose({record_of(drive)}, rigid_model(drive, more_mass)).elastic) << more_mass;
  }
}

// A filter of the force turns its phase, too.
TEST(Elastic, AFilteredForceIsNotElastic) {
  const Drive drive{20.0, 500.0, 0.02, 30.0, 0.0};
  for (const double lag : {2e-3, 8e-3})
    EXPECT_FALSE(diagnose({record_of(drive, 0.2, lag)}, rigid_model(drive, 0.0)).elastic) << lag;
}

}  // namespace
}  // namespace stribeck::ident::residual::elastic_test
