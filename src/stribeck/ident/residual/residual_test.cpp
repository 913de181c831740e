#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/residual/residual.hpp>

namespace stribeck::ident::residual::residual_test {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr double kT = 1e-3;
constexpr double kMass = 50.0, kCoulomb = 20.0, kViscous = 100.0;

struct Moment {
  double t = 0.0, x = 0.0, v = 0.0, a = 0.0;
};
using Motion = std::function<Moment(double)>;
using Extra = std::function<double(const Moment&)>;

Moment one_sine(double t) {
  constexpr double A = 0.05, w = 3.0;
  return {t, A * std::sin(w * t), A * w * std::cos(w * t), -A * w * w * std::sin(w * t)};
}
Moment two_sines(double t) {
  Moment m = one_sine(t);
  constexpr double A = 0.05, w = 1.1;
  m.x += A * std::sin(w * t), m.v += A * w * std::cos(w * t), m.a -= A * w * w * std::sin(w * t);
  return m;
}

/// Coulomb and viscous friction, and an extra force, under a hold: that of the middle of each row.
log::Record record_of(const Motion& motion, const Extra& extra, double noise = 0.3, double duration = 40.0,
                      double coulomb = kCoulomb) {
  log::Record r;
  r.source = "log.csv";
  r.sample_time = kT;
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0.0, 1.0);
  for (int k = 0; kT * k < duration; ++k) {
    const Moment now = motion(kT * k), mid = motion(kT * (k + 0.5));
    r.t.push_back(now.t);
    r.x.push_back(now.x);
    r.f.push_back(kMass * mid.a + kViscous * mid.v + (mid.v > 0.0 ? coulomb : -coulomb) + extra(mid) +
                  noise * normal(random));
  }
  return r;
}

Result truth() {
  Result r;
  r.mass = kMass;
  r.friction.steady = friction::Conventional<double>{kCoulomb, kViscous, {}};
  return r;
}

double none(const Moment&) { return 0.0; }
double sign(double v) { return v > 0.0 ? 1.0 : -1.0; }

TEST(Residual, GoodModelHasNothingToSay) {
  const Diagnosis d = diagnose({record_of(two_sines, none)}, truth());
  EXPECT_GT(d.quality.r_squared, 0.999);
  EXPECT_NEAR(d.quality.raw_rms, 0.3, 0.05);  // half a row beside its motion: m·da/dt·T/2 is 0.1 N
  EXPECT_FALSE(d.quality.strongest) << d.quality.strongest->frequency;
  EXPECT_THAT(d.warnings, IsEmpty());
  EXPECT_THAT(d.cannot_tell, IsEmpty());
  EXPECT_FALSE(d.spring);
  EXPECT_THAT(in_words(d.quality, "N"), AllOf(HasSubstr("(R² "), HasSubstr("% of friction")));
}

// The lines of a shaker on a feed axis: 0.45 on friction of 0.7, here scaled to newtons.
TEST(Residual, NamesTheStrongestLine) {
  const auto shaker = [](const Moment& m) { return 12.0 * std::sin(2.0 * kPi * 55.0 * m.t + 0.3); };
  const Diagnosis d = diagnose({record_of(two_sines, shaker)}, truth());
  ASSERT_TRUE(d.quality.strongest);
  EXPECT_NEAR(d.quality.strongest->frequency, 55.0, 0.1);
  EXPECT_NEAR(d.quality.strongest->amplitude, 12.0, 0.6);
  EXPECT_TRUE(d.quality.strongest->narrow);
  EXPECT_THAT(d.warnings, Contains(AllOf(HasSubstr("the force has a line of"), HasSubstr("vibration"))));
  EXPECT_GT(d.quality.raw_rms, 8.0);
}

TEST(Residual, KnowsTheHumOfTheMains) {
  for (const double f : {50.0, 60.0}) {
    const auto hum = [f](const Moment& m) { return 10.0 * std::sin(2.0 * kPi * f * m.t); };
    const Diagnosis d = diagnose({record_of(two_sines, hum)}, truth());
    EXPECT_THAT(d.warnings, Contains(HasSubstr(f == 50.0 ? "hum of 50 Hz" : "hum of 60 Hz")));
  }
}

TEST(Residual, WarnsWhereTheModelExplainsLittle) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0.0, 1.0);
  double slow = 0.0;
  const auto wind = [&](const Moment&) { return slow = 0.999 * slow + 2.0 * normal(random); };
  const Diagnosis d = diagnose({record_of(two_sines, wind)}, truth());
  EXPECT_THAT(d.warnings, Contains(AllOf(HasSubstr("more than friction itself"))));
}

// 0.5 N/mm over 200 mm: −50 … 50 N beside 20 N of friction.
TEST(Residual, FindsASpringWhereTheMotionTellsItFromMass) {
  const auto spring = [](const Moment& m) { return 500.0 * m.x; };
  const Diagnosis d = diagnose({record_of(two_sines, spring)}, truth());
  ASSERT_TRUE(d.spring);
  EXPECT_NEAR(d.spring->stiffness, 500.0, std::max(2.0 * d.spring->half_width, 5.0));
  EXPECT_LT(d.spring->half_width, 50.0);
  // On one sine it is mass: x = −a/ω².
  const Diagnosis sine = diagnose({record_of(one_sine, none)}, truth());
  EXPECT_FALSE(sine.spring);
  EXPECT_THAT(sine.cannot_tell,
              Contains(AllOf(HasSubstr("spring, cable chain"), HasSubstr("-111 kg for each N/mm"))));
}

// Four hundredths of friction at the ends, and yet the mass would be off by more than its interval.
TEST(Residual, ASpringThatCountsForTheMassIsFoundBelowFriction) {
  const auto weak = [](const Moment& m) { return 8.0 * m.x; };
  const Diagnosis d = diagnose({record_of(two_sines, weak)}, truth());
  ASSERT_TRUE(d.spring);
  EXPECT_NEAR(d.spring->stiffness, 8.0, 1.0);
  EXPECT_LT(d.spring->half_width, 2.0);
  // One that neither friction nor mass feels is none.
  const auto none_to_speak_of = [](const Moment& m) { return 0.3 * m.x; };
  EXPECT_FALSE(diagnose({record_of(two_sines, none_to_speak_of)}, truth()).spring);
}

// Behind the low-pass of 200 Hz, which shows a fast ripple, steps of 20 um in the position are 3 m/s2 of noise beside 0.45 of motion: less
// mass explains them better, and a spring of -235 N/m then gives the motion back its force.
TEST(Residual, NoiseOfTheEncoderIsNoSpring) {
  log::Record r = record_of(two_sines, none);
  for (double& x : r.x) x = 20e-6 * std::round(x / 20e-6);
  Result result = truth();
  EXPECT_FALSE(diagnose({r}, result).spring);
  result.cut_off = 200.0;
  const Diagnosis d = diagnose({r}, result);
  EXPECT_NEAR(d.quality.cut_off, 200.0, 1e-9);
  EXPECT_FALSE(d.spring) << d.spring->stiffness;
}

// White noise of 30 N: less of it is behind 20 Hz than behind 100 Hz, and the model is the same.
TEST(Residual, TwoModelsAreComparedBehindOneLowPass) {
  const std::vector<log::Record> logs{record_of(two_sines, none, 30.0)};
  Result wide = truth(), narrow = truth();
  wide.cut_off = 100.0, narrow.cut_off = 20.0;
  EXPECT_GT(diagnose(logs, wide).quality.rms, 1.5 * diagnose(logs, narrow).quality.rms);
  const auto [of_wide, of_narrow] = both_leave({logs, wide}, {logs, narrow});
  EXPECT_DOUBLE_EQ(of_wide, of_narrow);
  EXPECT_DOUBLE_EQ(of_narrow, diagnose(logs, narrow).quality.rms);
  EXPECT_EQ(both_leave({logs, narrow}, {logs, wide}), both_leave({logs, wide}, {logs, narrow}));
}

TEST(Residual, FindsAnUnbalancedArm) {
  const auto turn = [](double t) {
    Moment m = two_sines(t);
    for (double* q : {&m.x, &m.v, &m.a}) *q *= 20.0;
    return m;
  };
  const auto weight = [](const Moment& m) { return 38.0 * std::sin(m.x - 0.4); };
  log::Record r = record_of(turn, weight);
  r.position_unit = "rad";
  r.force_unit = "N m";
  Result result = truth();
  result.position_unit = "rad";
  result.force_unit = "N m";
  const Diagnosis d = diagnose({r}, result);
  ASSERT_TRUE(d.unbalance);
  EXPECT_NEAR(std::hypot(d.unbalance->sine, d.unbalance->cosine), 38.0, 1.0);
  EXPECT_NEAR(std::atan2(-d.unbalance->cosine, d.unbalance->sine), 0.4, 0.05);
  EXPECT_FALSE(d.spring);
  // An axis that is carried at a radius of 1 m is told by its record.
  r.position_unit = "m";
  r.force_unit = "N";
  EXPECT_FALSE(diagnose({r}, truth()).unbalance);
  r.rotary = true;
  ASSERT_TRUE(diagnose({r}, truth()).unbalance);
  EXPECT_GT(diagnose({r}, truth()).unbalance->mass, 0.0);
}

// Over 2.8 rad a sine could take most of a straight line; a torsion spring is one nevertheless.
TEST(Residual, ATorsionSpringIsNoUnbalance) {
  const auto turn = [](double t) {
    Moment m{t, 0.0, 0.0, 0.0};
    for (const double w : {2.0, 0.7}) {
      m.x += 0.7 * std::sin(w * t), m.v += 0.7 * w * std::cos(w * t), m.a -= 0.7 * w * w * std::sin(w * t);
    }
    return m;
  };
  const auto spring = [](const Moment& m) { return 30.0 * (m.x - 0.1); };
  log::Record r = record_of(turn, spring);
  r.rotary = true;
  const Diagnosis d = diagnose({r}, truth());
  EXPECT_FALSE(d.unbalance);
  ASSERT_TRUE(d.spring);
  EXPECT_NEAR(d.spring->stiffness, 30.0, std::max(d.spring->half_width, 0.3));
}

// Strokes of constant acceleration over 1.2 rad, fast and slow ones in turn: sine and cosine of the angle are nearly friction and a
// straight line there, so that a weight is taken for a spring. The mass may then be another one, and that is said.
TEST(Residual, ASpringOfAnAxisThatTurnsMayBeAWeight) {
  const auto strokes = [](double t) {
    constexpr double kFast = 2.0, kSlow = 3.0, kStroke = 1.2;
    double at = std::fmod(t, 2.0 * (kFast + kSlow));
    double period = kFast;
    if (at >= 2.0 * kFast) at -= 2.0 * kFast, period = kSlow;
    const double way = at < period ? 1.0 : -1.0;
    at = std::fmod(at, period);
    const double a = 4.0 * kStroke / (period * period);
    const bool first = at < 0.5 * period;
    const double rest = period - at;
    const double moved = first ? 0.5 * a * at * at : kStroke - 0.5 * a * rest * rest;
    return Moment{t, 0.3 + (way > 0.0 ? moved : kStroke - moved), way * a * (first ? at : rest),
                  way * (first ? a : -a)};
  };
  const auto weight = [](const Moment& m) { return 60.0 * std::sin(m.x); };
  log::Record r = record_of(strokes, weight);
  const Diagnosis linear = diagnose({r}, truth());
  ASSERT_TRUE(linear.spring);
  EXPECT_FALSE(linear.spring->may_be_weight);
  r.rotary = true;
  const Diagnosis turning = diagnose({r}, truth());
  ASSERT_TRUE(turning.spring);
  // The mass of the fit with the spring, and that of the fit with the weight: the model here has the true one.
  EXPECT_TRUE(turning.spring->may_be_weight);
  EXPECT_GT(turning.spring->mass_half_width, 0.1);
  EXPECT_LT(turning.spring->mass_half_width, 0.1 * kMass);
  // Where the weight has bent the map, the whole force is fitted: its mass is no correction of the model's.
  Result bent = truth();
  bent.friction.steady = friction::Conventional<double>{
      kCoulomb, kViscous, friction::Stribeck<double>{2.0 * kCoulomb, 0.01, 2.0}};
  const Diagnosis whole = diagnose({r}, bent);
  ASSERT_TRUE(whole.spring);
  EXPECT_LT(whole.spring->mass_half_width, 0.2 * kMass);
}

TEST(Residual, TellsALevelAlongTheTravelFromATightSpot) {
  const auto along = [](const Moment& m) { return sign(m.v) * kCoulomb * 0.4 * (m.x + 0.1) / 0.2; };
  const Diagnosis level = diagnose({record_of(two_sines, along)}, truth());
  EXPECT_THAT(level.warnings, Contains(HasSubstr("friction differs along the travel")));
  EXPECT_THAT(level.warnings, Not(Contains(HasSubstr("tight spot"))));
  const auto spot = [](const Moment& m) {
    return m.x > 0.03 && m.x < 0.035 ? sign(m.v) * 0.6 * kCoulomb : 0.0;
  };
  const Diagnosis tight = diagnose({record_of(two_sines, spot)}, truth());
  EXPECT_THAT(tight.warnings, Contains(AllOf(HasSubstr("a tight spot"), HasSubstr("higher between"))));
}

// Milling one way and back through the air. The map that is handed over is that of a fit which does not know the force.
TEST(Residual, FindsAForceInOneDirection) {
  const auto cut = [](double direction) {
    return [direction](const Moment& m) {
      return direction * m.v > 0.0 && direction * m.x > 0.02 ? direction * 15.0 : 0.0;
    };
  };
  for (const double direction : {1.0, -1.0}) {
    const Diagnosis d = diagnose({record_of(two_sines, cut(direction))}, truth());
    ASSERT_TRUE(d.one_sided) << direction;
    EXPECT_EQ(d.one_sided->direction, direction);
    EXPECT_NEAR(d.one_sided->force, 15.0, 1.5);
    EXPECT_NEAR(direction > 0.0 ? d.one_sided->from : -d.one_sided->to, 0.02, 0.005);
    EXPECT_EQ(d.one_sided->to_the_high_end, direction > 0.0);
    EXPECT_EQ(d.one_sided->from_the_low_end, direction < 0.0);
    EXPECT_TRUE(d.one_sided->enough_left);
    EXPECT_THAT(in_words(*d.one_sided, Shown()),
                AllOf(HasSubstr(direction > 0.0 ? "in positive direction" : "in negative direction"),
                      HasSubstr("a process force")));
  }
}

TEST(Residual, LeavesOutTheRowsOfAForceInOneDirection) {
  log::Record record = record_of(two_sines, none);
  leave_out({1.0, 15.0, 0.02, 0.05, false, false, true}, record);
  for (std::size_t k = 100; k + 100 < record.x.size(); ++k) {
    const double x = record.x[k], v = record.x[k + 1] - record.x[k - 1];
    if (std::abs(v) < 1e-6) continue;
    EXPECT_EQ(record.skip[k], v > 0.0 && x >= 0.02 && x <= 0.05 ? 1 : 0) << record.t[k];
  }
}

TEST(Residual, AForceInBothDirectionsIsNotInOne) {
  const auto spring = [](const Moment& m) { return 500.0 * m.x; };
  const auto rough = [](const Moment& m) { return m.x > 0.02 ? 15.0 * sign(m.v) : 0.0; };
  const auto uneven = [](const Moment& m) { return m.v > 0.0 ? 15.0 : 0.0; };
  const auto spring_and_rough = [](const Moment& m) { return 100.0 * m.x + 100.0 * (m.x + 0.1) * sign(m.v); };
  const auto warming = [](const Moment& m) { return -10.0 * (1.0 - std::exp(-m.t / 15.0)) * sign(m.v); };
  for (const Extra& extra :
       {Extra(none), Extra(spring), Extra(rough), Extra(uneven), Extra(spring_and_rough), Extra(warming)})
    EXPECT_FALSE(diagnose({record_of(two_sines, extra)}, truth()).one_sided);
}

TEST(Residual, TellsASuddenChangeFromADrift) {
  const auto step = [](const Moment& m) { return m.t > 20.0 ? sign(m.v) * 0.25 * kCoulomb : 0.0; };
  EXPECT_THAT(diagnose({record_of(two_sines, step)}, truth()).warnings,
              Contains(AllOf(HasSubstr("friction rose suddenly"), HasSubstr("s of log.csv"))));
  const auto drift = [](const Moment& m) { return sign(m.v) * 0.25 * kCoulomb * m.t / 40.0; };
  EXPECT_THAT(diagnose({record_of(two_sines, drift)}, truth()).warnings,
              Not(Contains(HasSubstr("suddenly"))));
  // What warms up quickly at first is nearer to a step than to a line.
  const auto warming = [](const Moment& m) { return sign(m.v) * 0.3 * kCoulomb * std::exp(-m.t / 5.0); };
  EXPECT_THAT(diagnose({record_of(two_sines, warming)}, truth()).warnings,
              Not(Contains(HasSubstr("suddenly"))));
}

/// Strokes back and forth of constant speed, each speed once.
Moment ordered_jogs(double t) {
  constexpr double kStroke = 4.0;
  const int n = static_cast<int>(t / kStroke);
  const double speed = 0.005 * (1 + n / 2), tau = t - kStroke * n;
  const double s = n % 2 == 0 ? 1.0 : -1.0;
  return {t, s > 0.0 ? speed * tau : speed * (kStroke - tau), s * speed, 0.0};
}

TEST(Residual, SaysThatOrderedSpeedsHideAChange) {
  const Diagnosis d = diagnose({record_of(ordered_jogs, none, 0.3, 80.0)}, truth());
  EXPECT_THAT(d.cannot_tell,
              Contains(AllOf(HasSubstr("in order, from slow to fast"), HasSubstr("at the end"))));
  EXPECT_THAT(diagnose({record_of(two_sines, none)}, truth()).cannot_tell,
              Not(Contains(HasSubstr("in order"))));
}

TEST(Residual, SaysHowLogsDiffer) {
  log::Record monday = record_of(two_sines, none, 0.3, 40.0, 18.0);
  log::Record friday = record_of(two_sines, none, 0.3, 40.0, 22.0);
  monday.source = "monday.csv";
  friday.source = "friday.csv";
  const Diagnosis d = diagnose({monday, friday}, truth());
  EXPECT_THAT(d.warnings, Contains(AllOf(HasSubstr("the logs differ in friction by"),
                                         HasSubstr("monday.csv -"), HasSubstr("friday.csv +"))));
  friday = monday;
  friday.source = "friday.csv";
  EXPECT_THAT(diagnose({monday, friday}, truth()).warnings, Not(Contains(HasSubstr("the logs differ"))));
}

TEST(Residual, ShortRecordsAreLeftAlone) {
  const Diagnosis d = diagnose({record_of(two_sines, none, 0.3, 0.12)}, truth());
  EXPECT_THAT(d.warnings, IsEmpty());
  EXPECT_EQ(in_words(d.quality, "N").empty(), d.quality.rows == 0);
}

}  // namespace
}  // namespace stribeck::ident::residual::residual_test
