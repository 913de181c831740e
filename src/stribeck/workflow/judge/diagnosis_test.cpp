#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stribeck/friction/unbalance.hpp>
#include <stribeck/ident/result.hpp>
#include <stribeck/io/test_folder.hpp>
#include <stribeck/workflow/identify.hpp>
#include <string>
#include <vector>

namespace stribeck::test::diagnosis_test {
namespace {

constexpr double kStep = 5e-3;      // [s]
constexpr double kMass = 41.0;      // [kg]
constexpr double kWeight = 105.0;   // [N]
constexpr double kSpring = 400.0;   // [N/m]
constexpr double kCoulomb = 48.0;   // [N]
constexpr double kViscous = 150.0;  // [N s/m]

/// Accelerations of strokes of 0.2 m to and fro at these speeds, with a rest after each.
std::vector<double> strokes(const std::vector<double>& speeds) {
  std::vector<double> a;
  for (const double speed : speeds) {
    const double length = speed >= 0.02 ? 0.2 : 4.0 * speed;
    const auto ramp = static_cast<std::size_t>(std::max(1.0, std::round(speed / kStep)));
    const double most = speed / (static_cast<double>(ramp) * kStep);
    for (const double d : {1.0, -1.0}) {
      a.insert(a.end(), ramp, d * most);
      a.insert(a.end(), static_cast<std::size_t>(length / speed / kStep), 0.0);
      a.insert(a.end(), ramp, -d * most);
      a.insert(a.end(), 20, 0.0);
    }
  }
  return a;
}

std::vector<double> sine() {
  std::vector<double> a;
  for (int k = 0; k < 3000; ++k) {
    const double w = std::numbers::pi, t = kStep * k;
    a.push_back(-0.05 * w * w * std::sin(w * t) - 0.004 * 16.0 * w * w * std::sin(4.0 * w * t));
  }
  return a;
}

/// A vertical screw with a gas spring: position rounded to 1 um, 1 N of noise, and a ripple of 4 N along the screw.
std::string log_of(const std::vector<double>& acceleration, double speed) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0.0, 1.0);
  constexpr double kStatic = 1.3 * kCoulomb, kSlow = 6e-3, kBristle = 4e6, kPitch = 0.01;
  std::string out = "t [s],x [mm],r [mm],f [N]\n";
  double x = 0.0, v = speed, bristle = 0.0;
  for (std::size_t k = 0; k < acceleration.size(); ++k) {
    const double level = kCoulomb + (kStatic - kCoulomb) / (1.0 + std::pow(std::abs(v) / kSlow, 1.5));
    const double f = kMass * acceleration[k] + kViscous * v + bristle + kWeight + kSpring * (x + 0.1) -
                     4.0 * std::sin(2.0 * std::numbers::pi * x / kPitch) + noise(random);
    out += fmt::format("{:.4f},{:.3f},{:.6f},{:.3f}\n", kStep * static_cast<double>(k), 1e3 * x, 1e3 * x, f);
    v += kStep * acceleration[k];
    bristle = std::clamp(bristle + kBristle * kStep * v, -level, level);
    x += kStep * v;
  }
  return out;
}

// A slow mode of a few parts of the mass follows the position as the spring does; it was found first, and hid the spring: coulomb
// friction of 74 and 46 N, a mass of 51 +- 24 kg.
TEST(Diagnosis, ASpringIsNoDriveThatGivesWay) {
  const Folder folder;
  const std::vector<std::string> logs{
      folder.write("jog.csv", log_of(strokes({0.005, 0.02, 0.06, 0.1}), 0.0)),
      folder.write("sine.csv", log_of(sine(), std::numbers::pi * (0.05 + 0.016))),
      folder.write("acc.csv", log_of(strokes(std::vector<double>(6, 0.1)), 0.0))};
  const workflow::Identification found = workflow::identify(workflow::read_axis(logs, {}), {});
  EXPECT_FALSE(found.elastic);
  const ident::Parameter* spring = found.result.find("position_stiffness");
  ASSERT_NE(spring, nullptr);
  EXPECT_NEAR(spring->value, kSpring, 0.02 * kSpring);
  EXPECT_NEAR(found.result.mass, kMass, 0.02 * kMass);
}

/// 3 kg of motor and 12 kg behind a belt, whose anti-resonance is at 13.8 Hz and swings for long; speed goes up and down with one
/// acceleration, as constant-acceleration of `excite` asks for. Positions have steps of 15 um, the force has 1 N of noise.
std::string ringing_belt_log(double acceleration, double top) {
  constexpr double kFine = 1e-4, kOmega = 2.0 * std::numbers::pi * 13.8, kDamping = 0.029, kCount = 15e-6;
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::string out = "t [s],r [mm],x [mm],f [N]\n";
  const auto ramp = static_cast<int>(std::round(top / acceleration / kFine));
  double x = 0.0, v = 0.0, stretch = 0.0, rate = 0.0;
  for (int k = -2000; k < 12 * ramp + 2000; ++k) {
    const int quarter = k < 0 || k >= 12 * ramp ? -1 : k / ramp % 4;
    const double a = quarter < 0 ? 0.0 : quarter == 0 || quarter == 3 ? acceleration : -acceleration;
    v += a * kFine;
    x += v * kFine;
    rate += (a - kOmega * kOmega * stretch - 2.0 * kDamping * kOmega * rate) * kFine;
    stretch += rate * kFine;
    if (k % 10 != 0) continue;
    const double side = std::abs(v) < 1e-9 ? 0.0 : v > 0.0 ? 1.0 : -1.0;
    const double f = 3.0 * a + 12.0 * (kOmega * kOmega * stretch + 2.0 * kDamping * kOmega * rate) +
                     side * (28.0 + 30.0 * std::abs(v)) + noise(random);
    out += fmt::format("{:.4f},{:.6f},{:.6f},{:.4f}\n", kFine * (k + 2000), 1e3 * x,
                       1e3 * kCount * std::round(x / kCount), f);
  }
  return out;
}

// A shift of 18 ms took up half of the swing: 15.5 (15.0 to 15.9) kg.
TEST(Diagnosis, ASwingThatLastsIsNoShiftOfManyRows) {
  const test::Folder folder;
  const auto found =
      workflow::identify(workflow::read_axis({folder.write("log.csv", ringing_belt_log(0.5, 0.2))}, {}), {});
  EXPECT_EQ(found.result.find("force_shift"), nullptr);
  ASSERT_TRUE(found.elastic);
  EXPECT_NEAR(found.elastic->frequency, 13.8, 0.3);
  EXPECT_NEAR(found.result.mass, 15.0, 0.15);
  EXPECT_LT(found.result.mass_interval.low, 15.0);
  EXPECT_GT(found.result.mass_interval.high, 15.0);
}

/// A rotary table whose axis lies, with a weight of 38 N m that hangs down at 40 deg: a swing to and fro over seven turns, friction that
/// falls by a tenth while it warms up, and teeth of 15 deg. The position has steps of 0.001 deg.
std::string unbalanced_table_log() {
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0.0, 0.5);
  constexpr double kDegree = std::numbers::pi / 180.0, kTurn = 2.0 * std::numbers::pi, kPeriod = 45.0;
  std::string out = "t [s],x [deg],r [deg],f [N m]\n";
  for (int k = 0; k < 45'000; ++k) {
    const double t = kStep * k, w = kTurn / kPeriod;
    const double x = 3.5 * kTurn * std::sin(w * t), v = 3.5 * kTurn * w * std::cos(w * t), a = -w * w * x;
    const double friction = (40.0 * std::tanh(v / 1e-3) + 9.0 * v) * (1.0 - 0.1 * t / 225.0);
    const double f = 14.0 * a + friction + 38.0 * std::sin(x - 40.0 * kDegree) +
                     2.5 * std::sin(24.0 * x - 0.3) + noise(random);
    out += fmt::format("{:.4f},{:.3f},{:.5f},{:.3f}\n", t, x / kDegree, x / kDegree, f);
  }
  return out;
}

// Among the periodic terms the weight had a period of 359.6 deg, and was out of phase fifty turns away.
TEST(Diagnosis, AWeightOverManyTurnsRepeatsEveryTurn) {
  const test::Folder folder;
  workflow::LogOptions options;
  options.drive.rotary = true;
  const auto found =
      workflow::identify(workflow::read_axis({folder.write("log.csv", unbalanced_table_log())}, options), {});
  const ident::Parameter* weight = found.result.find("unbalance");
  const ident::Parameter* angle = found.result.find("unbalance_hangs_at");
  ASSERT_NE(weight, nullptr);
  ASSERT_NE(angle, nullptr);
  EXPECT_NEAR(weight->value, 38.0, 0.2);
  EXPECT_NEAR(angle->value, 40.0 * std::numbers::pi / 180.0, 0.01);
  const auto& terms = found.result.friction.eccentric;
  ASSERT_EQ(terms.size(), 2u);
  EXPECT_NEAR(terms[0].period, std::numbers::pi / 12.0, 1e-4);
  EXPECT_TRUE(friction::is_unbalance(terms[1]));
}

}  // namespace
}  // namespace stribeck::test::diagnosis_test
