#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <stribeck/ident/drive/drive_fit.hpp>
#include <stribeck/ident/excitation/excitation.hpp>
#include <stribeck/ident/test_drive.hpp>

namespace stribeck::ident::drive::drive_fit_test {
namespace {

using ::testing::HasSubstr;

/// Coulomb, viscous and Stribeck friction on a light axis, as on the triaxial machine.
test::Drive light() {
  test::Drive drive;
  drive.mass = 1000.0;
  drive.sample_time = 0.002;
  drive.encoder = 1e-7;
  drive.friction.velocity_range = {-1.0, 1.0};
  drive.friction.positive = {18.0, 4500.0, {}};
  drive.friction.positive.gaussians.push_back({15.0, 0.0, 0.6e-3});
  drive.friction.negative = {-18.0, 4500.0, {}};
  drive.friction.negative.gaussians.push_back({-15.0, 0.0, 0.6e-3});
  drive.sigma0 = 7.2e6;
  drive.sigma1 = 8.5e4;
  drive.noise_rms = 0.5;
  drive.noise_time = 0.0095;
  drive.force_per_volt = 25.0;
  return drive;
}

log::Record sine(const test::Drive& drive, std::uint64_t seed, double periods) {
  return test::run_closed(drive, drive.mass, test::sine_reference(drive.sample_time, 0.01, 1.0, periods),
                          seed);
}

DriveFitOptions quick() {
  DriveFitOptions options;
  options.dynamics = false;
  return options;
}

// The simplest model that explains the log is the one that made it: symmetric, with a Stribeck part, no load.
TEST(DriveFit, FindsTheModelThatMadeTheLog) {
  const test::Drive drive = light();
  const Result r = identify_drive({sine(drive, 3, 4.0)}, quick());
  EXPECT_EQ(r.model, "conventional");
  EXPECT_NEAR(r.mass, drive.mass, 0.01 * drive.mass);
  ASSERT_NE(r.find("v0"), nullptr);
  EXPECT_NEAR(r.find("alpha0")->value, 18.0, 0.4);
  EXPECT_NEAR(r.find("alpha2")->value, 4500.0, 90.0);
  EXPECT_NEAR(r.load, 0.0, 0.2);
  EXPECT_EQ(r.find("force_shift"), nullptr);
  EXPECT_TRUE(r.friction.eccentric.empty());
}

/// Strokes of 12 mm/s and 100 mm/s² that reach their acceleration in 30 ms.
log::Record strokes(const test::Drive& drive, std::uint64_t seed) {
  const double T = drive.sample_time;
  constexpr double kAcceleration = 0.1, kSpeed = 0.012, kStroke = 0.5, kRise = 0.03;
  std::vector<double> v;
  for (int k = 0; k < static_cast<int>(40.0 / T); ++k) {
    const double t = std::fmod(T * k, 2.0 * kStroke);
    const double up = std::min(t, kStroke - t), down = std::min(t - kStroke, 2.0 * kStroke - t);
    v.push_back(t < kStroke ? std::min(kSpeed, kAcceleration * up) : -std::min(kSpeed, kAcceleration * down));
  }
  const auto rise = static_cast<std::size_t>(kRise / T);
  std::vector<double> r(v.size(), 0.0);
  for (std::size_t k = 1; k < v.size(); ++k) {
    double mean = 0.0;
    for (std::size_t j = 0; j < rise; ++j) mean += v[k > j ? k - j : 0] / static_cast<double>(rise);
    r[k] = r[k - 1] + T * mean;
  }
  return test::run_closed(drive, drive.mass, r, seed);
}

/// A filter of first order on a column; `time` in rows.
void smooth(std::vector<double>& column, double time) {
  double y = column.front();
  for (double& value : column) {
    y += (1.0 - std::exp(-1.0 / time)) * (value - y);
    value = y;
  }
}

// The drive smooths its torque before it is logged. The delay of that would be taken out as a shift, and the mass would come out 0.6 % too
// small.
TEST(DriveFit, TakesAFilterOfTheDriveOffTheForce) {
  const test::Drive drive = light();
  log::Record record = strokes(drive, 3);
  const double period = record.sample_time;
  const Result plain = identify_drive({record}, quick());
  EXPECT_FALSE(plain.filter);
  EXPECT_EQ(plain.find("force_filter"), nullptr);
  EXPECT_NEAR(plain.mass, drive.mass, 0.006 * drive.mass);
  smooth(record.f, 5.0);
  const Result smoothed = identify_drive({record}, quick());
  ASSERT_TRUE(smoothed.filter);
  EXPECT_NEAR(smoothed.filter->time, 5.0 * period, smoothed.filter->half_width);
  EXPECT_LT(smoothed.filter->half_width, 0.5 * period);
  EXPECT_LT(smoothed.mass_interval.low, drive.mass);
  EXPECT_GT(smoothed.mass_interval.high, drive.mass);
  EXPECT_NEAR(smoothed.mass, drive.mass, 0.003 * drive.mass);
  const Parameter* shift = smoothed.find("force_shift");  // what is left of it is no delay
  if (shift != nullptr) {
    EXPECT_LT(std::abs(shift->value), period);
  }
}

// The shift of the force before the filter is what is printed, so that is what a given one means; and a wrong one makes no filter.
TEST(DriveFit, AGivenShiftIsThatOfTheForceBeforeItsFilter) {
  const test::Drive drive = light();
  log::Record record = strokes(drive, 5);
  DriveFitOptions options = quick();
  options.shift = 0.0;
  EXPECT_FALSE(identify_drive({record}, options).filter);
  smooth(record.f, 5.0);
  options.shift = -1.0;  // of the recursion, whose newest row counts at once
  const Result given = identify_drive({record}, options);
  ASSERT_TRUE(given.filter);
  EXPECT_NEAR(given.filter->time, 5.0 * record.sample_time, given.filter->half_width);
  EXPECT_NEAR(given.mass, drive.mass, 0.003 * drive.mass);
  options.mass = drive.mass;  // nothing but the filter is left to find
  const Result both = identify_drive({record}, options);
  ASSERT_TRUE(both.filter);
  EXPECT_NEAR(both.filter->time, 5.0 * record.sample_time, both.filter->half_width);
  options.mass.reset();
  options.shift = 4.0;  // its delay counted twice
  const Result late = identify_drive({record}, options);
  EXPECT_FALSE(late.filter);
  EXPECT_THAT(late.warnings, ::testing::Contains(HasSubstr("which the given shift of 8 ms does not allow")));
  options = quick();
  options.filter = false;
  EXPECT_FALSE(identify_drive({record}, options).filter);
}

// A programmed force was not measured: nothing is taken off it, nor off what was logged beside it.
TEST(DriveFit, TakesNoFilterOffAProgrammedForce) {
  const test::Drive drive = light();
  log::Record smoothed = strokes(drive, 6);
  smooth(smoothed.f, 5.0);
  const excitation::Limits limits{-0.03, 0.03, 0.012, 0.1, 150.0};
  const excitation::Excitation pulses =
      excitation::design_pulses(limits, {drive.mass, 18.0, 4500.0}, drive.sample_time);
  const log::Record pushed =
      test::run(drive, pulses.t.back(), 5, [&](std::size_t k, double, double) { return pulses.force[k]; });
  EXPECT_FALSE(identify_drive({smoothed, pushed}, quick()).filter);
}

// A force that is only late has no filter.
TEST(DriveFit, DoesNotTakeADelayForAFilter) {
  const test::Drive drive = light();
  log::Record record = strokes(drive, 4);
  for (std::size_t k = record.f.size() - 1; k >= 4; --k) record.f[k] = record.f[k - 4];
  const Result late = identify_drive({record}, quick());
  EXPECT_FALSE(late.filter);
  ASSERT_NE(late.find("force_shift"), nullptr);
  EXPECT_NEAR(late.find("force_shift")->value, 3.5 * record.sample_time, 0.2 * record.sample_time);
}

// A weight adds to the force in both directions alike; nothing else may move.
TEST(DriveFit, TellsALoadFromFriction) {
  const test::Drive drive = light();
  const log::Record level = sine(drive, 3, 4.0);
  log::Record heavy = level;
  for (double& f : heavy.f) f += 60.0;
  const Result a = identify_drive({level}, quick());
  const Result b = identify_drive({heavy}, quick());
  EXPECT_NEAR(b.load - a.load, 60.0, 1e-3);
  EXPECT_NEAR(b.mass, a.mass, 1e-3 * a.mass);
  EXPECT_NEAR(b.find("alpha0")->value, a.find("alpha0")->value, 0.01);
}

// Mass and friction of a fit that does not know the screw take a part of it; the period is searched again without that.
TEST(DriveFit, TheScrewIsFoundBesideMassAndFriction) {
  test::Drive drive = light();
  drive.mass = 1100.0;
  drive.sample_time = 0.001;
  drive.wave = 5.0;
  drive.wave_length = 5e-3;
  const excitation::Limits limits{-0.06, 0.06, 0.03, 0.2, 250.0};
  const excitation::Excitation pulses =
      excitation::design_pulses(limits, {1100.0, 22.0, 4500.0}, drive.sample_time);
  const log::Record pushed =
      test::run(drive, pulses.t.back(), 5, [&](std::size_t k, double, double) { return pulses.force[k]; });
  const log::Record swung =
      test::run_closed(drive, drive.mass, test::sine_reference(drive.sample_time, 0.03, 0.8, 3.0), 6);
  const Result r = identify_drive({pushed, swung}, quick());
  ASSERT_EQ(r.friction.eccentric.size(), 1u);
  EXPECT_NEAR(r.friction.eccentric.begin()->period, 5e-3, 5e-6);
  EXPECT_NEAR(r.friction.eccentric.begin()->amplitude, 5.0, 0.1);
  EXPECT_EQ(r.model, "conventional + periodic");
}

// On a slow sine the acceleration hardly tells a delay, the screw does; together with a term that reverses it must not be
// taken for one that is not there.
TEST(DriveFit, TheScrewTellsTheShift) {
  test::Drive drive = light();
  drive.wave = 4.0;
  drive.wave_length = 2e-3;
  log::Record log = sine(drive, 7, 6.0);
  constexpr std::size_t kLate = 3;
  log.f.erase(log.f.begin(), log.f.begin() + kLate);
  log.f.insert(log.f.end(), kLate, log.f.back());
  const Result r = identify_drive({log}, quick());
  ASSERT_NE(r.find("force_shift"), nullptr);
  EXPECT_NEAR(r.find("force_shift")->value / drive.sample_time, -3.5, 0.1);
  ASSERT_EQ(r.friction.eccentric.size(), 1u);
  EXPECT_NEAR(r.friction.eccentric.begin()->amplitude, 4.0, 0.1);
}

// A loop that works against the screw, seen every 4 ms, looks like a force that comes 20 ms too early.
TEST(DriveFit, DoesNotTakeTheScrewForAShift) {
  test::Drive drive = light();
  drive.mass = 202.0;
  drive.sample_time = 0.004;
  for (auto* branch : {&drive.friction.positive, &drive.friction.negative}) {
    const double sign = branch == &drive.friction.positive ? 1.0 : -1.0;
    branch->eta0 = sign * 59.0;
    branch->eta1 = 671.0;
    branch->gaussians[0] = {sign * 28.0, 0.0, 1.6e-3};
  }
  drive.wave = 14.8;
  drive.wave_length = 3.4135e-3;
  drive.sigma1 = 2.8e4;
  drive.noise_rms = 0.96;
  drive.force_per_volt = 87.0;
  const log::Record log =
      test::run_closed(drive, drive.mass, test::sine_reference(drive.sample_time, 0.1416, 0.3375, 3.0), 3);
  const Result r = identify_drive({log}, quick());
  EXPECT_NEAR(r.mass, drive.mass, 0.02 * drive.mass);
  EXPECT_NEAR(r.find("alpha0")->value, 59.0, 0.6);
  ASSERT_FALSE(r.friction.eccentric.empty());
  EXPECT_NEAR(r.friction.eccentric.begin()->amplitude, 14.8, 0.3);
  EXPECT_EQ(r.find("force_shift"), nullptr);
  EXPECT_THAT(r.warnings, ::testing::Contains(HasSubstr("the shift removed is 0 ms")));
}

// The term is laid over the force at the true position: amplitude, period and phase come back, unprompted.
TEST(DriveFit, FindsATermPeriodicInPosition) {
  const test::Drive drive = light();
  log::Record rec = sine(drive, 5, 4.0);
  for (std::size_t k = 0; k < rec.f.size(); ++k) {
    rec.f[k] +=
        4.2 * std::sin(2.0 * kPi * 0.5 * (rec.x[k] + rec.x[std::min(k + 1, rec.x.size() - 1)]) / 2e-3 - 0.28);
  }
  const Result r = identify_drive({rec}, quick());
  ASSERT_EQ(r.friction.eccentric.size(), 1u);
  EXPECT_NEAR(r.friction.eccentric[0].amplitude, 4.2, 0.03 * 4.2);
  EXPECT_NEAR(r.friction.eccentric[0].period, 2e-3, 5e-6);
  EXPECT_NEAR(r.friction.eccentric[0].phase, 0.28, 0.03);
  EXPECT_EQ(r.friction.eccentric[0].form, friction::EccentricForm::kAdditive);
  EXPECT_FALSE(r.spectrum.empty());
}

// A log that stores the force three rows late is put right, and the rest comes out as before.
TEST(DriveFit, FindsTheShiftBetweenForceAndMotion) {
  test::Drive drive = light();
  drive.noise_rms = 0.1;
  std::vector<double> r;
  for (double t = 0.0; t < 20.0; t += drive.sample_time) {
    const double ramp = std::min(1.0, t);
    r.push_back(ramp * (0.008 * std::sin(t) + 0.0004 * std::sin(9.0 * t)));
  }
  log::Record rec = test::run_closed(drive, drive.mass, r, 9);
  const Result right = identify_drive({rec}, quick());
  std::vector<double> late(rec.f);
  for (std::size_t k = 3; k < late.size(); ++k) late[k] = rec.f[k - 3];
  rec.f = late;
  const Result shifted = identify_drive({rec}, quick());
  ASSERT_NE(shifted.find("force_shift"), nullptr);
  EXPECT_NEAR(shifted.find("force_shift")->value, 2.5 * drive.sample_time, 0.5 * drive.sample_time);
  EXPECT_NEAR(shifted.mass, right.mass, 0.02 * right.mass);
}

// A sine has one speed at each place: a force of the place, a tenth of friction here, goes into the map. Strokes tell it.
TEST(DriveFit, StrokesAfterASineTellAForceOfThePlaceFromFriction) {
  test::Drive drive = light();
  drive.wave = 3.0;
  drive.wave_length = 6e-3;
  excitation::SineDesign design{0.0, 0.003, 3.0, 8};
  const auto worst = [&](int strokes) {
    design.strokes = strokes;
    const excitation::Excitation e =
        excitation::design_sine({-0.1, 0.1, 0.02, 0.5, 0.0}, drive.sample_time, design);
    const Result r = identify_drive({test::run_closed(drive, drive.mass, e.r, 4)}, quick());
    double most = 0.0;
    for (const CurvePoint& p : r.curve) {
      if (std::abs(p.velocity) < 2e-3 || std::abs(p.velocity) > 8e-3) continue;
      const double truth = drive.steady(p.velocity);
      most = std::max(most, std::abs((p.friction + r.load) / truth - 1.0));
    }
    return most;
  };
  EXPECT_GT(worst(0), 0.03);
  EXPECT_LT(worst(2), 0.01);
}

// Speeds in order while friction falls: what the repeated speeds tell of the drift is taken out of all of them.
TEST(DriveFit, TakesTheDriftOutOfTheCurve) {
  const test::Drive drive = light();
  excitation::JogDesign jog;
  jog.speeds = excitation::in_mixed_order({1e-3, 2e-3, 3e-3, 4e-3, 5e-3, 6e-3, 7e-3, 8e-3});
  const excitation::Excitation e =
      excitation::design_jog({-0.1, 0.1, 0.02, 0.5, 0.0}, drive.sample_time, jog);
  log::Record rec = test::run_closed(drive, drive.mass, e.r, 8);
  const auto n = static_cast<double>(rec.f.size());
  // The measured friction falls by 15 % over the log: nearly all of the force of a jog is friction.
  for (std::size_t k = 0; k < rec.f.size(); ++k) rec.f[k] *= 1.075 - 0.15 * static_cast<double>(k) / n;
  DriveFitOptions options = quick();
  options.mass = drive.mass;
  const Result r = identify_drive({rec}, options);
  EXPECT_THAT(r.warnings, ::testing::Contains(HasSubstr("friction fell by")));
  for (const CurvePoint& p : r.curve) {
    // Between the slowest three jogs the map has the Stribeck part to guess, drift or not.
    if (std::abs(p.velocity) < 3.5e-3) continue;
    const double truth = drive.steady(p.velocity);
    // Left in, the drift is up to 7.5 % of each jog. A third of it may stay: three speeds that come again tell it.
    EXPECT_NEAR((p.friction + r.load) / truth, 1.0, 0.025) << p.velocity;
  }
}

// Jogs with stops on an encoder whose window reaches into them: rows before a stop had a mean of friction and of what the force is at rest,
// and the map fell by 6 % between the speeds of the jogs here, by 64 % under a loop with integral action.
TEST(DriveFit, StopsAreNoFrictionBetweenTheSpeedsOfJogs) {
  test::Drive drive = light();
  drive.mass = 300.0;
  drive.encoder = 10e-6;
  drive.friction.positive = {100.0, 500.0, {}};
  drive.friction.positive.gaussians.push_back({30.0, 0.0, 2e-3});
  drive.friction.negative = {-100.0, 500.0, {}};
  drive.friction.negative.gaussians.push_back({-30.0, 0.0, 2e-3});
  drive.sigma0 = 8e6;
  drive.sigma1 = 1e4;
  drive.noise_rms = 1.0;
  drive.force_per_volt = 100.0;
  excitation::JogDesign jog;
  jog.speeds = excitation::in_mixed_order({0.5e-3, 20e-3, 60e-3, 120e-3});
  const excitation::Excitation e =
      excitation::design_jog({-0.3, 0.3, 0.15, 1.0, 0.0}, drive.sample_time, jog);
  DriveFitOptions options;
  options.periodic = options.dynamics = false;
  const Result r = identify_drive({test::run_closed(drive, drive.mass, e.r, 8)}, options);
  EXPECT_NEAR(r.mass, 300.0, 3.0);
  for (const CurvePoint& p : r.curve) {
    if (std::abs(p.velocity) < 4e-3) continue;
    EXPECT_NEAR((p.friction + r.load) / drive.steady(p.velocity), 1.0, 0.01) << p.velocity;
  }
}

TEST(DriveFit, KeepsTheUnitOfTheLog) {
  log::Record rec = sine(light(), 3, 2.0);
  const Result newton = identify_drive({rec}, quick());
  for (double& f : rec.f) f /= 25.0;
  rec.force_unit = "V";
  const Result volt = identify_drive({rec}, quick());
  EXPECT_EQ(volt.force_unit, "V");
  EXPECT_EQ(volt.find("mass")->unit, "V s2/m");
  EXPECT_NEAR(25.0 * volt.mass, newton.mass, 1e-6 * newton.mass);
  log::Record other = rec;
  other.force_unit = "N";
  EXPECT_THAT(
      [&] {
        identify_drive({rec, other});
      },
      ::testing::ThrowsMessage<Refused>(HasSubstr("expected V and m")));
}

// A belt axis whose jogs go from slow to fast: each speed has its own time, and what the bristle does at the slow ones looked like a level of
// friction that rises by a quarter over the log.
TEST(DriveFit, AnErrorOfTheCurveIsNoDrift) {
  test::Drive drive = light();
  drive.mass = 0.8;
  drive.sample_time = 1e-3;
  drive.encoder = 5e-6;
  drive.friction.positive = {2.2, 4.0, {}};
  drive.friction.positive.gaussians.push_back({0.8, 0.0, 15e-3});
  drive.friction.negative = {-2.2, 4.0, {}};
  drive.friction.negative.gaussians.push_back({-0.8, 0.0, 15e-3});
  drive.sigma0 = 5e4;
  drive.sigma1 = 20.0;
  drive.damping_velocity = 0.1e-3;
  drive.noise_rms = 0.044;
  drive.noise_time = 5e-3;
  drive.force_per_volt = 6.0;
  const excitation::Limits limits{-0.25, 0.25, 0.5, 4.0, 0.0};
  excitation::JogDesign jog;
  jog.speeds = excitation::jog_speeds(excitation::fastest_jog(limits, drive.sample_time, jog));
  const auto jogs = excitation::design_jog(limits, drive.sample_time, jog);
  const log::Record slow = test::run_closed(drive, drive.mass, jogs.r, 8);
  const log::Record fast =
      test::run_closed(drive, drive.mass, test::sine_reference(drive.sample_time, 0.1, 4.0, 6.0), 9);
  const Result r = identify_drive({slow, fast}, quick());
  for (const std::string& w : r.warnings) {
    EXPECT_EQ(w.find("friction rose"), std::string::npos) << w;
    EXPECT_EQ(w.find("friction fell"), std::string::npos) << w;
  }
  for (const CurvePoint& p : r.curve) {
    if (std::abs(p.velocity) < 20e-3) continue;
    EXPECT_NEAR((p.friction + r.load) / drive.steady(p.velocity), 1.0, 0.02) << p.velocity;
  }
}

TEST(DriveFit, SaysWhatWarmingUpDoes) {
  const test::Drive drive = light();
  log::Record rec = sine(drive, 3, 6.0);
  for (std::size_t k = 0; k < rec.f.size(); ++k) {
    const double share = static_cast<double>(k) / static_cast<double>(rec.f.size());
    rec.f[k] -= (k > 0 && rec.x[k] > rec.x[k - 1] ? 1.0 : -1.0) * 4.0 * share;
  }
  const Result r = identify_drive({rec}, quick());
  EXPECT_THAT(r.warnings, ::testing::Contains(HasSubstr("friction fell by")));
  // The same where the log was cut at a gap.
  log::Record first = rec, second = rec;
  const auto half = static_cast<std::ptrdiff_t>(rec.t.size() / 2);
  for (auto column : {&log::Record::t, &log::Record::r, &log::Record::x, &log::Record::f}) {
    if ((rec.*column).empty()) continue;
    (first.*column).resize(static_cast<std::size_t>(half) - 20);
    (second.*column).erase((second.*column).begin(), (second.*column).begin() + half);
  }
  const Result cut = identify_drive({first, second}, quick());
  EXPECT_THAT(cut.warnings, ::testing::Contains(HasSubstr("friction fell by")));
  const Result steady = identify_drive({sine(drive, 3, 6.0)}, quick());
  EXPECT_THAT(steady.warnings, ::testing::Not(::testing::Contains(HasSubstr("warming up"))));
}

// The fast log passes the break-away distance within a few rows, and has most of the reversals.
TEST(DriveFit, PreSlidingIsThatOfTheLogThatTellsIt) {
  test::Drive drive = light();
  drive.force_per_volt = 250.0;
  log::Record slow = sine(drive, 3, 4.0);
  slow.source = "slow.csv";
  log::Record fast =
      test::run_closed(drive, drive.mass, test::sine_reference(drive.sample_time, 0.0006, 60.0, 100.0), 4);
  fast.source = "fast.csv";
  ASSERT_EQ(identify_drive({fast}, {}).find("sigma0"), nullptr);
  const Result r = identify_drive({slow, fast}, {});
  const Parameter* sigma0 = r.find("sigma0");
  ASSERT_NE(sigma0, nullptr);
  EXPECT_NEAR(sigma0->value, drive.sigma0, 0.1 * drive.sigma0);
  EXPECT_THAT(
      r.warnings,
      ::testing::Contains(HasSubstr(
          "pre-sliding is that of slow.csv, fitted alone; all logs together did not tell it: the axis passes the break-away distance")));
}

/// Strokes out and back, each half of constant acceleration a, with a rest between them.
std::vector<double> parabolas(double T, double stroke, const std::vector<double>& accelerations) {
  std::vector<double> r;
  for (const double a : accelerations) {
    const double half = std::sqrt(stroke / a);
    for (const double way : {1.0, -1.0}) {
      for (double t = 0.0; t < 2.0 * half + 0.3; t += T) {
        const double rest = std::max(0.0, 2.0 * half - t);
        const double moved = t < half ? 0.5 * a * t * t : stroke - 0.5 * a * rest * rest;
        r.push_back(way > 0.0 ? moved : stroke - moved);
      }
    }
  }
  return r;
}

// Each place has its own speed in every stroke of one acceleration, and the directions differ.
TEST(DriveFit, FindsARippleOnStrokesOfConstantAcceleration) {
  test::Drive drive = light();
  drive.sigma0 = 3e6;
  drive.wave = 6.0;
  drive.wave_length = 0.03;
  drive.friction.negative.eta0 = -14.0;
  drive.friction.negative.eta1 = 3500.0;
  for (const std::vector<double>& accelerations : {std::vector{0.04, 0.04, 0.03, 0.03}, std::vector{0.04}}) {
    const std::vector<double> reference = parabolas(drive.sample_time, 0.1, accelerations);
    const Result r = identify_drive({test::run_closed(drive, drive.mass, reference, 3)}, quick());
    ASSERT_FALSE(r.friction.eccentric.empty());
    EXPECT_NEAR(r.friction.eccentric[0].amplitude, 6.0, 0.15);
    EXPECT_NEAR(r.friction.eccentric[0].period, 0.03, 3e-4);
    EXPECT_NEAR(r.mass, drive.mass, 0.01 * drive.mass);
  }
}

}  // namespace
}  // namespace stribeck::ident::drive::drive_fit_test
