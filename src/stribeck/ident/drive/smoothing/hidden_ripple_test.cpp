#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/drive/drive_fit.hpp>
#include <stribeck/ident/drive/smoothing/hidden_ripple.hpp>
#include <stribeck/ident/residual/residual.hpp>
#include <vector>

namespace stribeck::ident::drive::hidden_ripple_test {
namespace {

constexpr double kPeriod = 0.8e-3;  // [m], a full step of a stepper motor

/// A printer: strokes of 40 mm at 20, 40 and 60 mm/s, positions in steps of 12.5 um, 1.8 kg, 5 N of friction, 0.1 N of noise.
std::vector<log::Record> printer(double ripple) {
  constexpr double kT = 1e-3, kCount = 12.5e-6, kMass = 1.8;
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0.0, 0.1);
  log::Record r;
  r.source = "printer.csv";
  r.sample_time = kT;
  double x = 0.0, v = 0.0;
  // The force of a row is held until the next one, and is what the middle between them needs.
  const auto row = [&](double a) {
    const double middle = x + 0.5 * kT * v + 0.125 * kT * kT * a, speed = v + 0.5 * kT * a;
    const double side = speed > 1e-9 ? 1.0 : speed < -1e-9 ? -1.0 : 0.0;
    r.t.push_back(kT * static_cast<double>(r.t.size()));
    r.r.push_back(x);
    r.x.push_back(kCount * std::round(x / kCount));
    r.f.push_back(kMass * a + 5.0 * side + 8.0 * speed + ripple * std::sin(2.0 * kPi * middle / kPeriod) +
                  noise(random));
    x += kT * v + 0.5 * kT * kT * a;
    v += kT * a;
  };
  for (int pass = 0; pass < 2; ++pass) {
    for (const double speed : {0.02, 0.04, 0.06}) {
      for (const double d : {1.0, -1.0}) {
        for (int k = 0; k < 40; ++k) row(d * speed / 40e-3);
        for (int k = 0; k < static_cast<int>(40.0 / speed); ++k) row(0.0);
        for (int k = 0; k < 40; ++k) row(-d * speed / 40e-3);
        for (int k = 0; k < 50; ++k) row(0.0);
      }
    }
  }
  return {r};
}

TEST(HiddenRipple, IsFoundInWhatTheWindowTakesOff) {
  Notes notes;
  const std::vector<log::Record> records = printer(0.6);
  const auto found = find_hidden_ripple(reconstruct_all(records, 0.0, {}, notes), 0.01);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->period, kPeriod, 0.005 * kPeriod);
  EXPECT_GT(found->amplitude, 0.1);
  EXPECT_LT(found->amplitude, 0.65);
  EXPECT_GT(found->cut_off, 0.06 / kPeriod);  // the frequency at the top speed
  EXPECT_LT(found->cut_off, 400.0);
}

TEST(HiddenRipple, NoiseAndSmallRipplesAreNone) {
  Notes notes;
  const std::vector<log::Record> smooth = printer(0.0), rippled = printer(0.6);
  EXPECT_FALSE(find_hidden_ripple(reconstruct_all(smooth, 0.0, {}, notes), 0.0));
  EXPECT_FALSE(find_hidden_ripple(reconstruct_all(rippled, 0.0, {}, notes), 1.0));
}

// Behind the window of this encoder nothing was found, and Gaussians took its place in the map.
TEST(HiddenRipple, TheDriveFitHasIt) {
  const Result found = identify_drive(printer(0.6), {});
  ASSERT_FALSE(found.friction.eccentric.empty());
  EXPECT_NEAR(found.friction.eccentric[0].period, kPeriod, 1e-3 * kPeriod);
  EXPECT_NEAR(found.friction.eccentric[0].amplitude, 0.6, 0.06);
  EXPECT_LT(found.mass_interval.low, 1.8);
  EXPECT_GT(found.mass_interval.high, 1.8);
  EXPECT_NEAR(found.mass, 1.8, 0.05) << found.mass_interval.low << " " << found.mass_interval.high;
  const Result smooth = identify_drive(printer(0.0), {});
  EXPECT_TRUE(smooth.friction.eccentric.empty());
  EXPECT_EQ(smooth.cut_off, 0.0);
}

// The sentence on the quality was that of the window which hid the ripple, and no word said that another low-pass was used.
TEST(HiddenRipple, TheLowPassThatShowsItIsSaid) {
  const std::vector<log::Record> records = printer(0.6);
  const Result found = identify_drive(records, {});
  EXPECT_GT(found.cut_off, 75.0);  // the frequency of the ripple at the top speed
  EXPECT_THAT(found.warnings, ::testing::Contains(::testing::AllOf(
                                  ::testing::HasSubstr("hides a force that repeats every 799 um"),
                                  ::testing::HasSubstr("Hz, which shows it"))));
  EXPECT_EQ(residual::diagnose(records, found).quality.cut_off, found.cut_off);
}

}  // namespace
}  // namespace stribeck::ident::drive::hidden_ripple_test
