#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

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
  EXPECT_FALSE(without.by_reference(0));
  EXPECT_TRUE(with.by_reference(0));
  EXPECT_EQ(without.shift, kHeldForce);
  EXPECT_THAT(notes.warnings, ::testing::ElementsAre(HasSubstr("no reference and no programmed force")));
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
