#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>
#include <stribeck/io/error.hpp>
#include <stribeck/io/test_folder.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/workflow/identify.hpp>
#include <stribeck/workflow/identify_text.hpp>
#include <stribeck/workflow/judge/verify.hpp>
#include <string>

namespace stribeck::test::identify_test {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;
using workflow::IdentifyOptions;
using workflow::Method;
using workflow::ModelChoice;

constexpr double kMass = 50.0;     // [kg]
constexpr double kViscous = 30.0;  // [N s/m]
constexpr double kCoulomb = 10.0;  // [N]

/// Two sines of an axis with Coulomb and viscous friction, and a force noise of 0.3 N that repeats itself; `more` force in both
/// directions [N].
std::string sines(const std::string& header = "t [s],x [mm],f [N]", double more = 0.0) {
  std::string out = header + "\n";
  for (int k = 0; k < 6000; ++k) {
    const double t = 1e-3 * k;
    double x = 0.0, v = 0.0, a = 0.0;
    for (const double w : {2.0 * std::numbers::pi, 1.3 * std::numbers::pi}) {
      x += 0.03 * std::sin(w * t);
      v += 0.03 * w * std::cos(w * t);
      a -= 0.03 * w * w * std::sin(w * t);
    }
    const double f =
        kMass * a + kViscous * v + (v > 0.0 ? kCoulomb : -kCoulomb) + more + 0.3 * std::sin(997.0 * t * t);
    out += fmt::format("{:.3f},{:.6f},{:.5f}\n", t, 1e3 * x, f);
  }
  return out;
}

std::string refusal(const IdentifyOptions& options) {
  try {
    check_options(options);
  } catch (const io::InputError& e) {
    return e.problems().front().text();
  }
  return "accepted";
}

TEST(Identify, FindsMassAndFrictionOfALog) {
  const Folder folder;
  const std::string log = folder.write("log.csv", sines());
  const workflow::AxisRecords axis = workflow::read_axis({log}, {});
  ASSERT_EQ(axis.records.size(), 1U);
  EXPECT_EQ(axis.sources, log);
  EXPECT_FALSE(axis.one_direction);
  const workflow::Identification found = workflow::identify(axis, {});
  EXPECT_EQ(found.result.method, Method::kAuto);
  // 6000 rows with 0.3 N of noise tell a mass whose force has an amplitude of 60 N to a few parts in a thousand.
  EXPECT_NEAR(found.result.mass, kMass, 0.01 * kMass);
  EXPECT_LT(found.result.mass_interval.low, found.result.mass);
  EXPECT_GT(found.result.mass_interval.high, found.result.mass);
  const auto parts = axis_file_model(found, axis).friction.parts(0.1, 0.0);
  EXPECT_NEAR(parts.level + parts.viscous, kCoulomb + 0.1 * kViscous, 0.5);
  EXPECT_EQ(to_json(found, "x")["axis"], "x");
  EXPECT_THAT(text_of(found, "x"), HasSubstr("mass"));
}

TEST(Identify, SaysOnceWhatIsTrueOfSeveralLogs) {
  const Folder folder;
  const std::string first = folder.write("first.csv", sines("t [s],x [mm],i [A]"));
  const std::string second = folder.write("second.csv", sines("t [s],x [mm],i [A]", 1.0));
  const workflow::AxisRecords axis = workflow::read_axis({first, second}, {});
  std::vector<std::string> of_scale;
  std::copy_if(axis.notes.begin(), axis.notes.end(), std::back_inserter(of_scale),
               [](const auto& note) { return note.find("scale of the force") != std::string::npos; });
  ASSERT_EQ(of_scale.size(), 1U);
  EXPECT_THAT(of_scale.front(), ::testing::StartsWith(first + ", " + second + ": "));
}

// Motion alone cannot tell a load from friction that differs by direction; the machine file can.
TEST(Identify, ALoadOfZeroInTheMachineFileLeavesTheDifferenceToFriction) {
  const Folder folder;
  const std::string log = folder.write("log.csv", sines("t [s],x [mm],f [N]", 1.5));
  const auto with_load = workflow::identify(workflow::read_axis({log}, {}), {});
  EXPECT_NEAR(with_load.result.load, 1.5, 0.2);
  workflow::LogOptions options;
  options.drive.balanced = true;
  const auto balanced = workflow::identify(workflow::read_axis({log}, options), {});
  EXPECT_EQ(balanced.result.load, 0.0);
  EXPECT_EQ(balanced.result.find("load"), nullptr);
  const ident::Parameter* forward = balanced.result.find("coulomb_positive");
  const ident::Parameter* backward = balanced.result.find("coulomb_negative");
  ASSERT_NE(forward, nullptr);
  ASSERT_NE(backward, nullptr);
  EXPECT_NEAR(forward->value, kCoulomb + 1.5, 0.4);
  EXPECT_NEAR(backward->value, -(kCoulomb - 1.5), 0.4);
  EXPECT_THAT(balanced.result.warnings,
              ::testing::Contains(HasSubstr("as the machine file says a load of 0")));
}

/// Position, velocity and acceleration.
std::array<double, 3> motion_at(double t) {
  std::array<double, 3> out{};
  for (const double w : {2.0 * std::numbers::pi, 0.6 * std::numbers::pi}) {
    out[0] += 0.03 * std::sin(w * t);
    out[1] += 0.03 * w * std::cos(w * t);
    out[2] -= 0.03 * w * w * std::sin(w * t);
  }
  return out;
}

/// A spring of 0.4 N/mm about 10 mm, a fifth of the largest force of the motion; `noise` [N] gives the force of a row, which stands
/// `late` seconds behind its motion.
template <class Noise>
std::string spring_log(int rows, Noise noise, double late = 0.0) {
  std::string out = "t [s],x [mm],f [N]\n";
  for (int k = 0; k < rows; ++k) {
    const double t = 1e-3 * k;
    const auto [x, v, a] = motion_at(t - late);
    const double f =
        kMass * a + kViscous * v + (v > 0.0 ? kCoulomb : -kCoulomb) + 400.0 * (x - 0.01) + noise(t);
    out += fmt::format("{:.3f},{:.6f},{:.5f}\n", t, 1e3 * motion_at(t)[0], f);
  }
  return out;
}

// Out with a cut beyond 5 mm, back through the air, on the same friction: a fit of all rows has 80 N of friction and another mass.
TEST(Identify, LeavesAForceInOneDirectionOut) {
  std::string log = "t [s],x [mm],f [N]\n";
  for (int k = 0; k < 12000; ++k) {
    const double t = 1e-3 * k;
    const auto [x, v, a] = motion_at(t);
    const double cut = v > 0.0 && x > 0.005 ? 1.5 * kCoulomb : 0.0;
    const double f =
        kMass * a + kViscous * v + (v > 0.0 ? kCoulomb : -kCoulomb) + cut + 0.3 * std::sin(997.0 * t * t);
    log += fmt::format("{:.3f},{:.6f},{:.5f}\n", t, 1e3 * x, f);
  }
  const Folder folder;
  const workflow::Identification found =
      workflow::identify(workflow::read_axis({folder.write("log.csv", log)}, {}), {});
  EXPECT_NEAR(found.result.mass, kMass, 0.01 * kMass);
  for (const ident::CurvePoint& p : found.result.curve) {
    const double direction = p.velocity > 0.0 ? 1.0 : -1.0;
    EXPECT_NEAR(p.friction, kViscous * p.velocity + direction * kCoulomb, 0.05 * kCoulomb) << p.velocity;
  }
  EXPECT_THAT(text_of(found, ""),
              AllOf(HasSubstr("motion in positive direction needs "), HasSubstr("these rows are left out")));
}

/// The trend of a PLC: rows of 100 ms, each with the force at its end or with its mean since the row before.
std::string trend_log(bool means) {
  std::string out = "t [s],x [mm],f [N]\n";
  const auto force = [](double t) {
    constexpr double kSlower = 0.5;  // than motion_at
    const auto [x, v, a] = motion_at(kSlower * t);
    return kMass * kSlower * kSlower * a + kViscous * kSlower * v + (v > 0.0 ? kCoulomb : -kCoulomb);
  };
  for (int k = 0; k < 2400; ++k) {
    constexpr int kParts = 50;
    double f = 0.0;
    for (int i = 0; i < kParts; ++i) f += force(0.1 * k - 0.1 * (i + 0.5) / kParts) / kParts;
    out += fmt::format("{:.1f},{:.6f},{:.5f}\n", 0.1 * k, 1e3 * motion_at(0.05 * k)[0],
                       (means ? f : force(0.1 * k)) + 0.02 * std::sin(997.0 * k * k));
  }
  return out;
}

// Means of the force beside measured accelerations are smoothed more than these: the mass was 3 % too small.
TEST(Identify, KnowsAForceThatIsTheMeanOverARow) {
  const Folder folder;
  for (const bool means : {true, false}) {
    const workflow::Identification found =
        workflow::identify(workflow::read_axis({folder.write("log.csv", trend_log(means))}, {}), {});
    EXPECT_EQ(text_of(found, "").find("the mean over each row of 100 ms") != std::string::npos, means);
    EXPECT_NEAR(found.result.mass, kMass, (means ? 0.01 : 0.04) * kMass);
  }
}

TEST(Identify, TakesASpringOffTheLog) {
  const std::string out = spring_log(12000, [](double t) { return 0.3 * std::sin(997.0 * t * t); });
  const Folder folder;
  const std::string log = folder.write("log.csv", out);
  const workflow::Identification found = workflow::identify(workflow::read_axis({log}, {}), {});
  const ident::Parameter* spring = found.result.find("position_stiffness");
  ASSERT_NE(spring, nullptr);
  EXPECT_NEAR(spring->value, 400.0, 0.03 * 400.0);
  EXPECT_NEAR(found.result.mass, kMass, 0.02 * kMass);
  EXPECT_THAT(text_of(found, ""), HasSubstr("a force grows with position by 0.4"));
  // The axis file holds it over the travel of the log, and as far again on either side.
  const auto& filed = found.result.friction.spring;
  ASSERT_TRUE(filed);
  EXPECT_EQ(filed->stiffness, spring->value);
  EXPECT_NEAR(*filed->from, -3.0 * 0.0596, 0.0003);
  EXPECT_NEAR(*filed->to, 3.0 * 0.0596, 0.0003);
  // Load and spring together are the force of 400·(x − 10 mm).
  EXPECT_NEAR(found.result.load + filed->at(0.03), 400.0 * 0.02, 0.5);
  EXPECT_NEAR(found.result.load + filed->at(-0.03), 400.0 * -0.04, 0.5);
  ASSERT_TRUE(found.quality);
  EXPECT_GT(found.quality->r_squared, 0.99);
  EXPECT_TRUE(to_json(found, "x")["quality"]["r_squared"].is_number());
}

// Noise that is several times the spring hides it from the residual, not from the fit; without it the mass would be off by a tenth.
TEST(Identify, TakesASpringOffALogOfMuchNoise) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0.0, 150.0);
  const Folder folder;
  const std::string log = folder.write("log.csv", spring_log(60000, [&](double) { return noise(random); }));
  const workflow::Identification found = workflow::identify(workflow::read_axis({log}, {}), {});
  const ident::Parameter* spring = found.result.find("position_stiffness");
  ASSERT_NE(spring, nullptr);
  EXPECT_LT(spring->ci_low, 400.0);
  EXPECT_GT(spring->ci_high, 400.0);
  EXPECT_LT(found.result.mass_interval.low, kMass);
  EXPECT_GT(found.result.mass_interval.high, kMass);
}

// Taken off the row in which the force stands, a spring of 400 N/m would make 5 ms of its delay a damping of 2 N s/m.
TEST(Identify, TakesASpringOffAForceThatIsLate) {
  const Folder folder;
  const std::string log =
      folder.write("log.csv", spring_log(
                                  12000, [](double t) { return 0.1 * std::sin(997.0 * t * t); }, 5e-3));
  for (const char* given : {"", "5 ms"}) {
    workflow::IdentifyOptions options;
    options.force_shift = given;
    const workflow::Identification found = workflow::identify(workflow::read_axis({log}, {}), options);
    ASSERT_NE(found.result.find("position_stiffness"), nullptr) << given;
    EXPECT_NEAR(found.result.friction.parts(0.1, 0.0).viscous, 0.1 * kViscous, 0.02 * 0.1 * kViscous)
        << given;
    EXPECT_NEAR(found.result.mass, kMass, 0.02 * kMass) << given;
  }
}

constexpr double kMotor = 10.0, kLoad = 40.0;  // [kg]

/// 10 kg of motor and 40 kg behind a belt, whose anti-resonance is at 15 Hz: at 5 Hz the 40 kg feel like 45.
std::string belt_log(bool elastic) {
  constexpr double kAntiResonance = 2.0 * std::numbers::pi * 15.0;
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0.0, 0.3);
  std::string out = "t [s],x [mm],r [mm],f [N]\n";
  for (int k = 0; k < 20000; ++k) {
    const double t = 1e-3 * k;
    double x = 0.0, v = 0.0, inertia = 0.0;
    for (const auto& [hz, size] :
         {std::pair(0.4, 0.08), std::pair(2.3, 1e-3), std::pair(5.1, 3e-4), std::pair(6.7, 2e-4)}) {
      const double w = 2.0 * std::numbers::pi * hz;
      const double share = elastic ? std::pow(w / kAntiResonance, 2.0) : 0.0;
      x += size * std::sin(w * t + hz);
      v += size * w * std::cos(w * t + hz);
      inertia -= (kMotor + kLoad / (1.0 - share)) * size * w * w * std::sin(w * t + hz);
    }
    const double f = inertia + kViscous * v + (v > 0.0 ? kCoulomb : -kCoulomb) + noise(random);
    out += fmt::format("{:.3f},{:.6f},{:.6f},{:.5f}\n", t, 1e3 * x, 1e3 * x, f);
  }
  return out;
}

TEST(Identify, ADriveThatGivesWayIsTakenOff) {
  const Folder folder;
  const auto found = [&](bool elastic) {
    return workflow::identify(workflow::read_axis({folder.write("log.csv", belt_log(elastic))}, {}), {});
  };
  const workflow::Identification belt = found(true);
  EXPECT_NEAR(belt.result.mass, kMotor + kLoad, 0.01 * (kMotor + kLoad));
  EXPECT_LT(belt.result.mass_interval.low, kMotor + kLoad);
  EXPECT_GT(belt.result.mass_interval.high, kMotor + kLoad);
  EXPECT_THAT(text_of(belt, ""), HasSubstr("the drive gives way between motor and table"));
  // No part of this motion is near the anti-resonance: 29 kg at 13 Hz give nearly the same force as 40 kg at 15 Hz.
  for (const auto& [name, value] : {std::pair("anti_resonance", 15.0), std::pair("table_mass", kLoad)}) {
    const ident::Parameter* p = belt.result.find(name);
    ASSERT_NE(p, nullptr) << name;
    EXPECT_LT(p->ci_low, value) << name;
    EXPECT_GT(p->ci_high, value) << name;
    EXPECT_FALSE(p->identifiable) << name;
  }
  const workflow::Identification screw = found(false);
  EXPECT_THAT(text_of(screw, ""), Not(AnyOf(HasSubstr("grows with its frequency"), HasSubstr("gives way"))));
  EXPECT_NEAR(screw.result.mass, kMotor + kLoad, 0.01 * (kMotor + kLoad));
}

// The model is that of a rigid drive: what the belt adds is no error of its friction.
TEST(Verify, ADriveThatGivesWayIsTakenOffTheLog) {
  const Folder folder;
  sim::AxisFile file;
  file.model.mass = kMotor + kLoad;
  file.model.friction.steady = friction::Conventional<double>{kCoulomb, kViscous, {}};
  for (const bool elastic : {true, false}) {
    workflow::VerifyOptions options;
    options.models = {{"x.toml", file}};
    options.logs = {folder.write("log.csv", belt_log(elastic))};
    const report::VerifyReportInput found = workflow::verify(options);
    EXPECT_LT(found.parts.front().models.front().force.moving_relative, 0.08) << elastic;
    const auto named = ::testing::Contains(HasSubstr("gives way between motor and table"));
    if (elastic) {
      EXPECT_THAT(found.warnings, named);
    } else {
      EXPECT_THAT(found.warnings, Not(named));
    }
  }
}

/// 50 kg that move as above, more sharply, and a drive that logs the force behind a filter of 8 ms.
std::string smoothed_log() {
  constexpr double kFilter = 8e-3, kStep = 1e-4;
  std::mt19937_64 random(6);
  std::normal_distribution<double> noise(0.0, 0.3);
  std::string out = "t [s],x [mm],r [mm],f [N]\n";
  double logged = 0.0;
  for (int k = 0; k < 200'000; ++k) {
    const double t = kStep * k;
    double x = 0.0, v = 0.0, a = 0.0;
    for (const auto& [hz, size] : {std::pair(0.4, 0.08), std::pair(3.1, 4e-3), std::pair(7.3, 1e-3)}) {
      const double w = 2.0 * std::numbers::pi * hz;
      x += size * std::sin(w * t + hz);
      v += size * w * std::cos(w * t + hz);
      a -= size * w * w * std::sin(w * t + hz);
    }
    const double f = (kMotor + kLoad) * a + kViscous * v + (v > 0.0 ? kCoulomb : -kCoulomb);
    logged = k == 0 ? f : logged + kStep / kFilter * (f - logged);
    if (k % 10 == 0)
      out += fmt::format("{:.3f},{:.6f},{:.6f},{:.5f}\n", t, 1e3 * x, 1e3 * x, logged + noise(random));
  }
  return out;
}

// Over this motion the filter hides a tenth of the mass, and makes a right model miss more than a tenth of the force.
TEST(Identify, AFilterOfTheDriveIsTakenOff) {
  const Folder folder;
  const std::string log = folder.write("log.csv", smoothed_log());
  const workflow::Identification found = workflow::identify(workflow::read_axis({log}, {}), {});
  ASSERT_TRUE(found.result.filter);
  EXPECT_NEAR(found.result.filter->time, 8e-3, 0.4e-3);
  EXPECT_NEAR(found.result.mass, kMotor + kLoad, 0.01 * (kMotor + kLoad));
  EXPECT_THAT(text_of(found, ""), AllOf(HasSubstr("force_filter"),
                                        HasSubstr("the drive smoothed the force before it was logged")));
  ASSERT_TRUE(found.quality);
  EXPECT_GT(found.quality->r_squared, 0.999);  // of the force before the filter
}

TEST(Verify, AFilterOfTheDriveIsTakenOffTheLog) {
  const Folder folder;
  sim::AxisFile right, light;
  right.model.mass = kMotor + kLoad;
  right.model.friction.steady = friction::Conventional<double>{kCoulomb, kViscous, {}};
  light = right;
  light.model.mass *= 0.7;
  workflow::VerifyOptions options;
  options.models = {{"right.toml", right}, {"light.toml", light}};
  options.logs = {folder.write("log.csv", smoothed_log())};
  const report::VerifyReportInput found = workflow::verify(options);
  EXPECT_THAT(found.warnings,
              ::testing::Contains(HasSubstr("smoothed the force of this log by a filter of")));
  const std::vector<report::Verdict> all = report::verdicts(found);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].grade, report::Grade::kGood) << all[0].error;
  EXPECT_EQ(all[1].grade, report::Grade::kNotUsable) << all[1].error;
}

/// A log without its reference, of an encoder of 5 um. The loop works on the error of the counts, and most on its change.
std::string log_of_counts() {
  constexpr double kT = 1e-3, kCount = 5e-6, kPosition = 1e5, kVelocity = 1e4;
  std::mt19937_64 random(11);
  std::normal_distribution<double> noise(0.0, 1e-6);
  std::string out = "t [s],x [mm],f [N]\n";
  double before = 0.0;
  for (int k = 0; k < 20000; ++k) {
    const double t = kT * k, held = t + 0.5 * kT;
    double x = 0.0, v = 0.0, a = 0.0;
    for (const auto& [hz, size] : {std::pair(0.45, 0.04), std::pair(1.1, 0.012), std::pair(2.3, 0.004)}) {
      const double w = 2.0 * std::numbers::pi * hz;
      x += size * std::sin(w * t);
      v += size * w * std::cos(w * held);
      a -= size * w * w * std::sin(w * held);
    }
    const double counted = kCount * std::round((x + noise(random)) / kCount);
    const double error = counted - x;
    const double f = kMass * a + 10.0 * kViscous * v + (v > 0.0 ? 100.0 : -100.0) - kPosition * error -
                     kVelocity * (error - before) / kT;
    before = error;
    out += fmt::format("{:.3f},{:.6f},{:.5f}\n", t, 1e3 * counted, f);
  }
  return out;
}

// The force agrees with the noise of the encoder, and so does the acceleration: that is no shift of the force.
TEST(Identify, WithoutAReferenceTheNoiseOfTheEncoderIsNoShift) {
  const Folder folder;
  const workflow::Identification found =
      workflow::identify(workflow::read_axis({folder.write("log.csv", log_of_counts())}, {}), {});
  EXPECT_EQ(found.result.find("force_shift"), nullptr);
  EXPECT_LT(found.result.mass_interval.low, kMass);
  EXPECT_GT(found.result.mass_interval.high, kMass);
}

TEST(Identify, AMassThatFewMachinesHaveIsNamed) {
  const Folder folder;
  workflow::LogOptions options;
  options.gain = "1 N/mA";
  const std::string log = folder.write("log.csv", sines("t [s],x [mm],i [A]"));
  const workflow::AxisRecords axis = workflow::read_axis({log}, options);
  EXPECT_THAT(text_of(workflow::identify(axis, {}), ""), Not(HasSubstr("few machines")));  // 50 t
  options.gain = "10 N/mA";
  EXPECT_THAT(text_of(workflow::identify(workflow::read_axis({log}, options), {}), ""),
              HasSubstr("kg is one that few machines have: check --gain"));
}

// A light arm at constant speeds, which it reaches between two rows: the friction is that of a jog, and there is no mass.
TEST(Identify, ConstantSpeedsWithoutAccelerationGiveTheFriction) {
  std::string rows = "t [s],x [mm],f [N]\n";
  double x = 0.0;
  int k = 0;
  for (const double speed : {5.0, 10.0, 20.0, 40.0, 80.0}) {
    for (const double v : {speed, -speed}) {
      for (int i = 0; i < 1500; ++i, ++k) {
        x += 1e-3 * v;
        const double friction = kCoulomb + kViscous * 1e-3 * speed;
        const double f = (v > 0.0 ? friction : -friction) + 0.5 * std::sin(997.0 * k * 1e-3 * k * 1e-3);
        rows += fmt::format("{:.3f},{:.6f},{:.5f}\n", 1e-3 * k, x, f);
      }
    }
  }
  const Folder folder;
  const std::string log = folder.write("log.csv", rows);
  const workflow::Identification found = workflow::identify(workflow::read_axis({log}, {}), {});
  EXPECT_EQ(found.result.method, Method::kJog);
  EXPECT_FALSE(std::isfinite(found.result.mass));
  ASSERT_NE(found.result.find("alpha0"), nullptr);
  EXPECT_NEAR(found.result.find("alpha0")->value, kCoulomb, 0.2);
  EXPECT_THAT(found.result.warnings, ::testing::Contains(HasSubstr("too little acceleration for the mass")));
}

// A conventional map has no range of its own: the file says the velocities beside it, and nothing where one is in the map.
TEST(Identify, TheAxisFileSaysTheVelocitiesOfAnyModel) {
  const Folder folder;
  const workflow::AxisRecords axis = workflow::read_axis({folder.write("log.csv", sines())}, {});
  workflow::IdentifyOptions how;
  how.model = workflow::ModelChoice::kConventional;
  const workflow::Identification found = workflow::identify(axis, how);
  const auto file = io::read_toml<sim::AxisFile>(folder.write("x.toml", axis_file_text(found, axis, "1")));
  ASSERT_FALSE(file.model.friction.identified_range());
  ASSERT_TRUE(file.velocity_range);
  const std::array<double, 2>& range = found.result.velocity_range;
  EXPECT_EQ(*file.velocity_range, range);
  ASSERT_TRUE(file.identified_speed());
  EXPECT_EQ(*file.identified_speed(), std::min(-range[0], range[1]));
  how.model = workflow::ModelChoice::kGaussian;
  const sim::AxisFile by_direction = axis_file(workflow::identify(axis, how), axis);
  EXPECT_TRUE(by_direction.model.friction.identified_range());
  EXPECT_FALSE(by_direction.velocity_range);
  EXPECT_TRUE(by_direction.identified_speed());
}

TEST(Identify, NotesNameTheirLog) {
  const Folder folder;
  std::string text = sines();
  text.erase(text.find("\n1.000,") + 1, text.find("\n1.400,") - text.find("\n1.000,"));  // 0.4 s are missing
  const std::string log = folder.write("gap.csv", text);
  const workflow::AxisRecords axis = workflow::read_axis({log}, {});
  ASSERT_EQ(axis.notes.size(), 1U);
  EXPECT_THAT(axis.notes.front(), ::testing::StartsWith(log + ": "));
}

TEST(Identify, OwnUnitIsNoAxisFile) {
  const Folder folder;
  const std::string log = folder.write("v.csv", sines("t [s],x [mm],u [V]"));
  const workflow::AxisRecords axis = workflow::read_axis({log}, {});
  const workflow::Identification found = workflow::identify(axis, {});
  workflow::IdentifyOptions for_file;
  for_file.for_axis_file = true;
  for (const bool before : {false, true}) {
    try {
      if (before) static_cast<void>(workflow::identify_logs(std::vector{log}, {}, for_file));
      if (!before) static_cast<void>(axis_file_model(found, axis));
      ADD_FAILURE() << "accepted";
    } catch (const io::InputError& e) {
      EXPECT_THAT(e.problems().front().text(), HasSubstr("--output: an axis file holds newtons and metres"));
      EXPECT_THAT(e.problems().front().text(), HasSubstr("give --gain"));
    }
  }
}

TEST(Identify, OptionsThatAMethodIgnoresAreRefused) {
  EXPECT_EQ(refusal({}), "accepted");
  EXPECT_EQ(refusal({.method = Method::kGravity, .terms = 2}), "--terms: --method gravity does not take it");
  EXPECT_EQ(refusal({.method = Method::kLeastSquaresA, .mass = "5 kg"}),
            "--mass: --method least-squares does not take it");
  EXPECT_EQ(refusal({.method = Method::kJog, .turn = "5 mm"}), "--turn: --method jog does not take it");
  EXPECT_EQ(
      refusal({.method = Method::kIdimLs, .model = ModelChoice::kGaussian}),
      "--model: got gaussian, which --method idim-ls cannot give (expected auto, conventional, asymmetric)");
  EXPECT_EQ(refusal({.model = ModelChoice::kConventional, .terms = 2}),
            "--terms: got 2, but --model conventional has no Gaussians");
}

}  // namespace
}  // namespace stribeck::test::identify_test
