#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include <stribeck/ident/drive/aligned_log.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/test_drive.hpp>

namespace stribeck::ident::drive::aligned_log_test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

log::Record moved() {
  ident::test::Drive drive;
  drive.friction = ident::test::table_2_3('x');
  return ident::test::run_closed(drive, drive.mass, ident::test::sine_reference(0.005, 0.02, 0.475, 2.0), 3);
}

// A position that follows its reference by half a second: the delays carry it all the same.
TEST(AlignedLog, TheReferenceExplainsTheVelocityBehindASlowLoop) {
  log::Record rec;
  rec.sample_time = 0.002;
  log::Motion m;
  m.sample_time = rec.sample_time;
  m.loop = log::Loop::kClosed;
  constexpr double kLate = 0.4;
  for (int k = 0; k < 10000; ++k) {
    const double t = rec.sample_time * k;
    rec.r.push_back(0.1 * std::sin(1.3 * t) + 0.02 * std::sin(3.1 * t));
    m.v.push_back(0.13 * std::cos(1.3 * (t - kLate)) + 0.062 * std::cos(3.1 * (t - kLate)));
  }
  const std::vector<double> v = predicted_velocity(rec, m);
  ASSERT_EQ(v.size(), m.v.size());
  double error = 0.0, without = 0.0, all = 0.0;
  for (std::size_t k = 500; k + 500 < v.size(); ++k) {
    error += std::pow(v[k] - m.v[k], 2.0);
    without += std::pow((rec.r[k + 1] - rec.r[k - 1]) / (2.0 * rec.sample_time) - m.v[k], 2.0);
    all += m.v[k] * m.v[k];
  }
  EXPECT_LT(std::sqrt(error / all), 0.1);  // delays lie a third apart
  EXPECT_GT(std::sqrt(without / all), 0.5);
}

TEST(AlignedLog, WithoutAReferenceACalmerMotionTakesItsPlace) {
  log::Record rec = moved();
  Notes notes;
  const AlignedLog with = reconstruct_all({&rec, 1}, 0.0, std::nullopt, notes);
  EXPECT_FALSE(with.predicted[0].empty());
  EXPECT_THAT(notes.warnings, IsEmpty());
  rec.r.clear();
  const std::vector<log::Record> pieces{rec, rec};
  const AlignedLog without = reconstruct_all(pieces, 0.0, std::nullopt, notes);
  ASSERT_EQ(without.predicted[0].size(), rec.x.size());
  EXPECT_EQ(without.predicted[0], log::calm_velocity(without.motions[0]));
  EXPECT_NE(with.predicted[0], log::calm_velocity(with.motions[0]));
  EXPECT_EQ(without.shift, kHeldForce);
  EXPECT_THAT(notes.warnings, ::testing::ElementsAre(HasSubstr("no reference and no programmed force")));
  Notes given;
  static_cast<void>(reconstruct_all(pieces, 0.0, std::nullopt, given, true));
  EXPECT_THAT(given.warnings, IsEmpty());
}

/// A slow sine, and on it a fast one that makes four fifths of the acceleration.
log::Record two_sines() {
  log::Record rec;
  rec.source = "two sines";
  rec.sample_time = 1e-3;
  for (int k = 0; k < 8000; ++k) {
    const double t = rec.sample_time * k;
    rec.t.push_back(t);
    rec.r.push_back(0.02 * std::sin(3.0 * t));
    rec.x.push_back(rec.r.back() + 2e-4 * std::sin(60.0 * t));
    rec.f.push_back(10.0 * std::cos(3.0 * t) - 7.0 * std::sin(60.0 * t));
  }
  return rec;
}

// Pulses of force on a slow motion are in no reference.
TEST(AlignedLog, AReferenceThatAsksForLittleOfTheAccelerationIsNotUsed) {
  log::Record rec = two_sines();
  Notes notes;
  const AlignedLog little = reconstruct_all({&rec, 1}, 0.0, std::nullopt, notes);
  EXPECT_EQ(little.predicted[0], log::calm_velocity(little.motions[0]));
  EXPECT_NEAR(little.motions[0].instrument[4000], little.motions[0].a[4000], 0.05);
  EXPECT_THAT(notes.warnings, IsEmpty());
  // Noise that hides the fast sine: the reference is all there is.
  std::mt19937_64 engine(7);
  std::normal_distribution<double> noise(0.0, 5e-3);
  for (double& x : rec.x) x += noise(engine);
  const AlignedLog noisy = reconstruct_all({&rec, 1}, 0.0, std::nullopt, notes);
  EXPECT_NE(noisy.predicted[0], log::calm_velocity(noisy.motions[0]));
  rec = two_sines();
  rec.r = rec.x;
  const AlignedLog whole = reconstruct_all({&rec, 1}, 0.0, std::nullopt, notes);
  EXPECT_NE(whole.predicted[0], log::calm_velocity(whole.motions[0]));
}

TEST(AlignedLog, AKnownShiftIsTaken) {
  const log::Record rec = moved();
  Notes notes;
  const AlignedLog log = reconstruct_all({&rec, 1}, 0.0, 2.0, notes);
  EXPECT_EQ(log.shift, 2.0);
  for (std::size_t k = 500; k < 600; ++k) ASSERT_NEAR(log.motions[0].f[k], log.force[0][k + 2], 60.0) << k;
}

TEST(AlignedLog, RefusesNoRecordAndTwoUnits) {
  Notes notes;
  EXPECT_THAT([&] { reconstruct_all({}, 0.0, std::nullopt, notes); },
              ThrowsMessage<Refused>(HasSubstr("no record given")));
  std::vector<log::Record> two{moved(), moved()};
  two[1].position_unit = "rad";
  EXPECT_THAT([&] { reconstruct_all(two, 0.0, std::nullopt, notes); },
              ThrowsMessage<Refused>(HasSubstr("its position in rad, expected N and m as in virtual drive")));
}

}  // namespace
}  // namespace stribeck::ident::drive::aligned_log_test
