#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/replay/drift_band.hpp>
#include <stribeck/ident/replay/model_force.hpp>
#include <stribeck/ident/replay/replay.hpp>

namespace stribeck::ident::replay::model_force_test {
namespace {

constexpr double kT = 1e-3;

struct Truth {
  double mass = 100.0;
  double coulomb = 20.0;
  double viscous = 200.0;
  double load = 5.0;
  double ripple = 4.0;
  double period = 2.5e-3;
  double phase = 0.7;
};

/// x = 50 mm·(1 − cos 2t); the force that this motion needs, `late` seconds later in the log, with noise.
log::Record sine_log(const Truth& truth, double late, double noise, double homing = 0.0) {
  log::Record r;
  r.source = "sine";
  r.sample_time = kT;
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0.0, 1.0);
  constexpr double w = 2.0, A = 0.05;
  for (int k = 0; k < 16000; ++k) {
    const double t = kT * k, then = t - late;
    const double v = A * w * std::sin(w * then), x = A * (1.0 - std::cos(w * then));
    r.t.push_back(t);
    r.x.push_back(A * (1.0 - std::cos(w * t)) + homing);
    r.f.push_back(truth.mass * A * w * w * std::cos(w * then) + truth.load + truth.viscous * v +
                  (v > 0.0 ? truth.coulomb : -truth.coulomb) +
                  truth.ripple * std::sin(2.0 * kPi * x / truth.period - truth.phase) +
                  noise * normal(random));
  }
  return r;
}

friction::AxisModel model_of(const Truth& truth) {
  friction::AxisModel m;
  m.mass = truth.mass;
  m.load = truth.load;
  m.friction.steady = friction::Conventional<double>{truth.coulomb, truth.viscous, {}};
  m.friction.eccentric.push_back(
      {truth.ripple, truth.period, truth.phase, friction::EccentricForm::kAdditive});
  return m;
}

double rms(const std::vector<double>& y) {
  double sum = 0.0;
  for (const double s : y) sum += s * s;
  return std::sqrt(sum / static_cast<double>(y.size()));
}

// A mass of 10 kg too much errs by 10 kg · a: 10·0.2/√2 N RMS, whatever the friction.
TEST(ForceError, IsTheForceThatAModelMisses) {
  const Truth truth;
  const log::Record record = sine_log(truth, 0.0, 0.0);
  friction::AxisModel model = model_of(truth);
  // The filter of x moves each jump of 40 N at a reversal by a part of a row.
  const ForceError exact = force_error(model, record);
  EXPECT_LT(exact.relative, 0.012);
  model.mass += 10.0;
  const ForceError e = force_error(model, record);
  EXPECT_NEAR(e.rms, std::hypot(10.0 * 0.2 / std::sqrt(2.0), exact.rms), 0.03);
  EXPECT_NEAR(e.relative, e.rms / rms(record.f), 0.02 * e.relative);  // decimation takes 1 % of f away
  EXPECT_EQ(e.factor, 10u);
  EXPECT_DOUBLE_EQ(e.cut_off, 100.0);
  EXPECT_DOUBLE_EQ(e.band, 40.0);
}

// Under a weight of 2000 N, 10 N of friction too much are half a percent of the force, and no good model.
TEST(ForceError, AWeightDoesNotHideWhatAModelMisses) {
  Truth truth;
  truth.load = 2000.0;
  friction::AxisModel model = model_of(truth);
  std::get<friction::Conventional<double>>(model.friction.steady).alpha0 += 10.0;
  const ForceError heavy = force_error(model, sine_log(truth, 0.0, 0.0));
  truth.load = model.load = 0.0;
  const ForceError level = force_error(model, sine_log(truth, 0.0, 0.0));
  EXPECT_LT(heavy.relative, 0.006);  // the protocol counts the weight
  EXPECT_GT(level.filed_relative, 0.2);
  EXPECT_NEAR(heavy.filed_relative, level.filed_relative, 1e-3);
  EXPECT_NEAR(heavy.own_relative, level.own_relative, 1e-3);
  EXPECT_NEAR(heavy.moving_relative, level.moving_relative, 1e-3);
}

// Friction that is 40 % more makes a small part of the force of a heavy mass; a wrong mass, load or homing is no friction.
TEST(ForceError, FrictionCountsBesideAHeavyMass) {
  Truth truth;
  truth.mass = 1500.0;
  truth.ripple = 0.0;
  Truth sticky = truth;
  sticky.coulomb *= 1.4;
  sticky.viscous *= 1.4;
  friction::AxisModel model = model_of(truth);
  model.friction.eccentric.clear();
  const ForceError e = force_error(model, sine_log(sticky, -0.5e-3, 1.0));
  EXPECT_LT(e.own_relative, 0.1);
  for (const FrictionChange& change : {e.friction.slow, e.friction.fast}) {
    EXPECT_NEAR(change.share, 0.4, 0.02);
    EXPECT_LT(change.half_width, 0.03);
    EXPECT_NEAR(change.certain(), 0.4, 0.04);
  }
  sticky.viscous = truth.viscous;
  const FrictionChanges level = force_error(model, sine_log(sticky, -0.5e-3, 1.0)).friction;
  EXPECT_GT(level.slow.share, level.fast.share + 0.05);
  // 8 N of 20 N and what the viscous part is at this speed.
  for (const FrictionChange& change : {level.slow, level.fast})
    EXPECT_NEAR(change.share, 8.0 / (20.0 + 200.0 * change.speed), 0.02);
  model.mass *= 0.9;
  model.load += 30.0;
  const ForceError other = force_error(model, sine_log(truth, -0.5e-3, 1.0, 0.2));
  EXPECT_GT(other.own_relative, 0.08);
  for (const FrictionChange& change : {other.friction.slow, other.friction.fast}) {
    EXPECT_LT(std::abs(change.share), 0.03);
    EXPECT_LT(change.certain(), 0.01);
  }
}

// 35 % more forward and 35 % less backward is no change of friction that both directions share.
TEST(ForceError, ALoadCountsInEachDirection) {
  Truth truth;
  truth.mass = 1500.0;
  truth.ripple = 0.0;
  friction::AxisModel model = model_of(truth);
  model.friction.eccentric.clear();
  Truth pulled = truth;
  pulled.load += 9.0;
  const FrictionChanges changed = force_error(model, sine_log(pulled, -0.5e-3, 1.0)).friction;
  EXPECT_LT(changed.slow.certain(), 0.01);
  EXPECT_LT(changed.fast.certain(), 0.01);
  EXPECT_NEAR(changed.load, 9.0, 0.5);
  EXPECT_LT(changed.load_half_width, 0.5);
  // The mean speed of the sine is 64 mm/s: 12.7 N of viscous friction.
  EXPECT_NEAR(changed.forward.share, 9.0 / 32.7, 0.03);
  EXPECT_NEAR(changed.backward.share, -9.0 / 32.7, 0.03);
  EXPECT_GT(changed.forward.certain(), 0.2);
  // A counterbalance of 200 N varies by that.
  model.load += 200.0, pulled.load += 200.0;
  const FrictionChanges heavy = force_error(model, sine_log(pulled, -0.5e-3, 1.0)).friction;
  EXPECT_NEAR(heavy.forward.share, changed.forward.share, 1e-3);
  EXPECT_EQ(heavy.forward.certain(), 0.0);
  // Of one direction nothing is told.
  log::Record ahead = sine_log(pulled, -0.5e-3, 1.0);
  for (std::vector<double>* column : {&ahead.t, &ahead.x, &ahead.f}) column->resize(1500);
  EXPECT_TRUE(std::isnan(force_error(model, ahead).friction.load));
}

TEST(ForceError, FindsTheShiftOfTheRecord) {
  const Truth truth;
  for (const double late : {-0.5e-3, 0.0, 3.3e-3, 12e-3}) {
    const ForceError e = force_error(model_of(truth), sine_log(truth, late, 0.5));
    EXPECT_NEAR(e.shift, late, std::max(2.0 * e.shift_half, 2e-5)) << late;
    EXPECT_LT(e.shift_half, 2.5e-4);                  // a quarter of a row, which a shift must differ by
    EXPECT_EQ(e.shifted, late > 0.0 - 1e-9) << late;  // −½ row is a force under its hold
  }
}

// 20 um of pre-sliding that the model does not have were a force that is 8 to 15 ms late, without a word.
TEST(ForceError, SaysWhereAShiftMayBePreSliding) {
  const Truth truth;
  log::Record record = sine_log(truth, -0.5e-3, 0.5);
  double z = 0.0;
  for (std::size_t k = 1; k < record.x.size(); ++k) {
    const double moved = record.x[k] - record.x[k - 1];
    if (moved == 0.0) continue;
    const double sign = moved > 0.0 ? 1.0 : -1.0;
    z += (sign - z) * -std::expm1(-std::abs(moved) / 20e-6);
    record.f[k] += truth.coulomb * (z - sign);
  }
  const ForceError e = force_error(model_of(truth), record);
  EXPECT_TRUE(!e.shifted || e.or_pre_sliding) << e.shift;
  EXPECT_FALSE(force_error(model_of(truth), sine_log(truth, 3.3e-3, 0.5)).or_pre_sliding);
}

// A new homing position moves the phase by 2π·(its way)/period.
TEST(ForceError, FindsThePhaseOfTheRecord) {
  const Truth truth;
  const double homing = 0.3e-3;
  const log::Record record = sine_log(truth, -0.5e-3, 0.5, homing);
  const ForceError e = force_error(model_of(truth), record);
  ASSERT_EQ(e.phases.size(), 1u);
  EXPECT_TRUE(e.phases[0].determined);
  EXPECT_TRUE(e.phases[0].differs);
  EXPECT_NEAR(e.phases[0].found, truth.phase + 2.0 * kPi * homing / truth.period, 0.05);
  EXPECT_GT(e.filed_relative, 1.5 * e.own_relative);
  const ForceError same = force_error(model_of(truth), sine_log(truth, -0.5e-3, 0.5));
  EXPECT_FALSE(same.phases[0].differs);
  EXPECT_FALSE(same.shifted);
}

// Cogging of a linear motor that pushes at one end of the travel and pulls at the other: alone, a shift of 39 ms takes more of it out
// than it adds, and the error of the right model was 24 % with it.
TEST(ForceError, TakesNoSlowPeriodicTermForAShift) {
  for (const double phase : {-0.5 * kPi, 0.5 * kPi}) {
    for (const double ripple : {20.0, 60.0, 78.0}) {
      const Truth truth{30.0, 40.0, 80.0, 0.0, 60.0, 0.1 / 1.5, phase};
      Truth now = truth;
      now.ripple = ripple;
      const ForceError e = force_error(model_of(truth), sine_log(now, -0.5e-3, 0.5));
      EXPECT_FALSE(e.shifted) << phase << " " << ripple << ": " << e.shift;
      EXPECT_LT(e.own_relative, 1.02 * e.relative) << phase << " " << ripple;
    }
  }
}

/// A second of rest in front, as the filters leave it: not quite zero.
log::Record after_rest(const log::Record& moving, double force) {
  log::Record r = moving;
  constexpr int kRest = 3000;
  for (auto* column : {&r.t, &r.x, &r.f}) column->clear();
  for (int k = 0; k < kRest; ++k) {
    r.t.push_back(kT * k);
    r.x.push_back(0.0123);
    r.f.push_back(force);
  }
  for (std::size_t k = 0; k < moving.x.size(); ++k) {
    r.t.push_back(kT * static_cast<double>(kRest + static_cast<int>(k)));
    r.x.push_back(moving.x[k] + 0.0123);
    r.f.push_back(moving.f[k]);
  }
  return r;
}

// At rest the bristles carry the force of the record. Taken as sliding, they carry the whole friction, and nothing moves that off them:
// the right model missed 17 % on a log of pulses.
TEST(ForceError, BeginsAtRestWithTheForceOfTheRecord) {
  Truth truth;
  truth.ripple = 0.0;
  friction::AxisModel model = model_of(truth);
  model.friction.eccentric.clear();
  model.friction.dynamics = friction::LuGre<double>{1e8, 0.0, {}};
  const ForceError e = force_error(model, after_rest(sine_log(truth, -0.5e-3, 0.0), truth.load));
  EXPECT_LT(e.own_relative, 0.03);  // 0.5 with ±20 N over a fifth of the record
}

// A feed of a hundredth of the top speed and less, as production has for minutes, is a motion whose friction the model must know.
TEST(ForceError, ASlowFeedIsNoRest) {
  Truth truth;
  truth.ripple = 0.0;
  friction::AxisModel model = model_of(truth);
  model.friction.eccentric.clear();
  log::Record record = sine_log(truth, -0.5e-3, 0.0);
  const std::size_t fast = record.x.size();
  constexpr double kFeed = 0.3e-3;
  for (std::size_t k = 0; k < fast; ++k) {
    record.t.push_back(kT * static_cast<double>(record.t.size()));
    record.x.push_back(record.x[fast - 1] + kFeed * kT * static_cast<double>(k + 1));
    record.f.push_back(truth.load + truth.coulomb + truth.viscous * kFeed);
  }
  EXPECT_LT(force_error(model, record).at_rest, 0.02);
  std::get<friction::Conventional<double>>(model.friction.steady).alpha0 *= 2.0;
  EXPECT_GT(force_error(model, record).moving_relative, 0.3);
}

/// Every n-th row.
log::Record thinned(const log::Record& from, std::size_t n) {
  log::Record r = from;
  r.sample_time *= static_cast<double>(n);
  for (auto* column : {&r.t, &r.x, &r.f}) column->clear();
  for (std::size_t k = 0; k < from.x.size(); k += n) {
    r.t.push_back(from.t[k]);
    r.x.push_back(from.x[k]);
    r.f.push_back(from.f[k]);
  }
  return r;
}

// What the log makes a right model miss grows with the time between rows and with the noise of the position, and is never much less than
// what it does miss; a wrong model misses far more than that on a good log.
TEST(ForceError, TellsWhatTheLogMakesARightModelMiss) {
  const Truth truth;
  ForceOptions options;
  options.of_log = true;
  double before = 0.0;
  for (const std::size_t n : {1, 10, 30}) {
    const ForceError e = force_error(model_of(truth), thinned(sine_log(truth, -0.5e-3, 0.0), n), options);
    EXPECT_GT(e.of_log, before) << n;
    EXPECT_LT(e.own_relative, std::max(0.02, 2.0 * e.of_log)) << n;
    before = e.of_log;
  }
  log::Record noisy = sine_log(truth, -0.5e-3, 0.0);
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0.0, 20e-6);
  for (double& x : noisy.x) x += normal(random);
  const ForceError of_noise = force_error(model_of(truth), noisy, options);
  EXPECT_GT(of_noise.of_log, 0.5 * of_noise.own_relative);
  EXPECT_LT(of_noise.of_log, 1.5 * of_noise.own_relative);
  friction::AxisModel wrong = model_of(truth);
  wrong.friction.steady = friction::Conventional<double>{1.5 * truth.coulomb, truth.viscous, {}};
  const ForceError missed = force_error(wrong, sine_log(truth, -0.5e-3, 0.0), options);
  EXPECT_GT(missed.own_relative, 4.0 * missed.of_log);
  EXPECT_TRUE(std::isnan(force_error(wrong, noisy).of_log));  // not asked for
}

TEST(ForceError, ShortRecordHasNone) {
  log::Record record = sine_log(Truth{}, 0.0, 0.0);
  for (auto* c : {&record.t, &record.x, &record.f}) c->resize(300);
  const ForceError e = force_error(model_of(Truth{}), record);
  EXPECT_TRUE(std::isnan(e.relative));
  EXPECT_TRUE(e.row.empty() || e.modelled.empty());
}

// The band is that of the error which drives the drift: a free replay stays in it, and it grows with the error.
TEST(DriftBand, HoldsTheFreeReplay) {
  const Truth truth;
  const log::Record record = sine_log(truth, -0.5e-3, 2.0);
  friction::AxisModel model = model_of(truth);
  double before = 0.0;
  for (const double off : {0.0, 1.0, 3.0}) {
    model.friction.steady = friction::Conventional<double>{truth.coulomb + off, truth.viscous, {}};
    const ForceError e = force_error(model, record);
    const OpenLoop open = replay_open_loop(model, record);
    const DriftBand band = drift_band(model, record, e, open);
    EXPECT_GT(band.end, before) << off;
    EXPECT_GT(band.inside, 0.85) << off;  // one path: its rows are not independent
    before = band.end;
  }
}

// Friction that falls with speed by 4 N per mm/s drives a deviation: 100 kg, 40 1/s. A second in it is e^40.
TEST(DriftBand, TellsHowMuchADeviationGrows) {
  Truth truth;
  truth.ripple = 0.0;
  const log::Record record = sine_log(truth, -0.5e-3, 0.0);
  friction::AxisModel model = model_of(truth);
  model.friction.eccentric.clear();
  const auto growth = [&] {
    const OpenLoop measured = not_replayed(record);
    return drift_band(model, record, force_error(model, record), measured).growth;
  };
  EXPECT_LT(growth(), 0.1);
  // 200 mm/s wide and at the middle of the speeds that the sine has.
  model.friction.steady =
      friction::Conventional<double>{20.0, 0.0, friction::Stribeck<double>{420.0, 0.1, 1.0}};
  EXPECT_GT(growth(), 8.0);
}

TEST(NotReplayed, HasTheMeasuredCourseAndNoPrediction) {
  const log::Record record = sine_log(Truth{}, -0.5e-3, 0.0);
  const OpenLoop measured = not_replayed(record);
  EXPECT_GT(measured.starts.size(), 5u);
  EXPECT_EQ(measured.measured_velocity.size(), record.x.size());
  EXPECT_EQ(measured.free.x.size(), record.x.size());
  EXPECT_TRUE(std::isnan(measured.free.x[100]));
  EXPECT_TRUE(std::isnan(measured.restarted.velocity_relative));
}

const ReplayController kPd{PdLaw{4e5, 12e3, 0.0, 0.0}, {}};

TEST(ControllerCheck, ReproducesTheCommandOrSaysByHowMuchNot) {
  log::Record record = sine_log(Truth{}, -0.5e-3, 0.0);
  record.r = record.x;
  for (std::size_t k = 0; k < record.r.size(); ++k)
    record.r[k] += 1e-6 * std::sin(0.01 * static_cast<double>(k));
  for (std::size_t k = 0; k < record.f.size(); ++k) {
    const double e = record.r[k] - record.x[k];
    const double b = k > 0 ? record.r[k - 1] - record.x[k - 1] : e;
    record.f[k] = 4e5 * e + 12e3 * (e - b) / kT;
  }
  const ControllerCheck right = check_controller(kPd, record);
  EXPECT_LT(right.relative, 0.01);  // the row before the first one is not known
  EXPECT_TRUE(right.added.empty());
  ReplayController wrong = kPd;
  std::get<PdLaw>(wrong.law).stiffness = 8e5;
  EXPECT_GT(check_controller(wrong, record).relative, 0.3);
  EXPECT_TRUE(check_controller(wrong, record).added.empty());
  // Pulses of 30 N in a tenth of the rows.
  for (std::size_t k = 0; k < record.f.size(); ++k)
    record.f[k] += k % 1000 >= 500 && k % 1000 < 600 ? 30.0 : 0.0;
  const ControllerCheck pulses = check_controller(kPd, record);
  ASSERT_EQ(pulses.added.size(), record.f.size());
  EXPECT_NEAR(pulses.added_share, 0.1, 0.001);
  EXPECT_NEAR(pulses.added_rms, 30.0, 0.1);
  EXPECT_NEAR(pulses.added[550], 30.0, 0.1);
  EXPECT_EQ(pulses.added[700], 0.0);
}

}  // namespace
}  // namespace stribeck::ident::replay::model_force_test
