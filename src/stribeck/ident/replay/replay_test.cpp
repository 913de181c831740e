#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/replay/replay.hpp>
#include <stribeck/ident/test_drive.hpp>

namespace stribeck::ident::replay::replay_test {
namespace {

/// Coulomb and viscous friction with one force held for a sample, solved piece by piece:
/// v(t) = v∞ + (v0 − v∞)·exp(−t·α2/m). Own formula, own events.
struct ClosedForm {
  double mass = 100.0;
  double coulomb = 20.0;
  double viscous = 200.0;
  double load = -3.0;
  double x = 0.01;
  double v = 0.0;

  void hold(double force, double left) {
    while (left > 0.0) {
      const double push = force - load;
      if (v == 0.0 && std::abs(push) <= coulomb) return;
      const double s = v != 0.0 ? (v > 0.0 ? 1.0 : -1.0) : (push > 0.0 ? 1.0 : -1.0);
      const double rate = viscous / mass;
      const double end = (push - s * coulomb) / viscous;
      double t = left;
      bool stops = false;
      if (v != 0.0 && end * s < 0.0) {
        const double zero = std::log((v - end) / -end) / rate;
        stops = zero < left;
        t = std::min(t, zero);
      }
      const double fade = std::exp(-rate * t);
      x += end * t + (v - end) * (1.0 - fade) / rate;
      v = stops ? 0.0 : end + (v - end) * fade;
      left -= t;
    }
  }
};

friction::AxisModel coulomb_model() {
  friction::AxisModel m;
  m.mass = 100.0;
  m.load = -3.0;
  m.friction.steady = friction::Conventional<double>{20.0, 200.0, {}};
  return m;
}

/// Forwards, coasting into standstill, backwards at once through zero, standstill again.
log::Record closed_form_run(double period, std::size_t rows, std::vector<double>* speed = nullptr) {
  ClosedForm axis;
  log::Record r;
  r.source = "closed form";
  r.sample_time = period;
  for (std::size_t k = 0; k < rows; ++k) {
    const double t = period * static_cast<double>(k);
    const double phase = std::fmod(t, 0.8);
    const double force = phase < 0.2    ? 60.0
                         : phase < 0.45 ? 0.0
                         : phase < 0.6  ? -80.0
                         : phase < 0.7  ? 50.0
                                        : 5.0;
    r.t.push_back(t);
    r.x.push_back(axis.x);
    r.f.push_back(force);
    if (speed != nullptr) speed->push_back(axis.v);
    axis.hold(force, period);
  }
  return r;
}

// Kutta's third order errs by (h·α2/m)⁴/24 a sub-step of 0.25 ms: below 1e-14 of the speed.
TEST(Replay, SolvesCoulombFrictionAsTheClosedForm) {
  std::vector<double> speed;
  log::Record r = closed_form_run(0.001, 2000, &speed);
  const OpenLoop open = replay_open_loop(coulomb_model(), r);
  std::size_t stands = 0;
  for (std::size_t k = 0; k < r.x.size(); ++k) {
    ASSERT_NEAR(open.free.x[k], r.x[k], 1e-12) << k;
    ASSERT_NEAR(open.free.v[k], speed[k], 1e-11) << k;
    if (speed[k] == 0.0) {
      ++stands;
      ASSERT_EQ(open.free.v[k], 0.0) << k;  // stands, not creeps
    }
  }
  EXPECT_GT(stands, 100u);
  EXPECT_LT(open.free.position_most, 1e-12);
  EXPECT_EQ(open.free.outside, 0u);
  EXPECT_TRUE(std::isnan(open.free.force_relative));
}

TEST(Replay, AWrongModelIsFarOffAndStartingAnewKeepsItNear) {
  const log::Record r = closed_form_run(0.001, 4000);
  friction::AxisModel wrong = coulomb_model();
  wrong.friction.steady = friction::Conventional<double>{24.0, 200.0, {}};
  const OpenLoop open = replay_open_loop(wrong, r);
  EXPECT_GT(open.free.velocity_relative, 0.02);
  EXPECT_GT(open.starts.size(), 4u);
  EXPECT_LT(open.restarted.position_rms, 0.3 * open.free.position_rms);
  // At every start the measured position is taken.
  for (const std::size_t k : open.starts) EXPECT_EQ(open.restarted.x[k], r.x[k]);
}

// A drive that holds its place swings by some steps of the encoder: each was counted.
TEST(Replay, VibrationAtRestIsNoReversal) {
  log::Record r;
  r.sample_time = 1e-3;
  for (int k = 0; k < 8000; ++k) {
    const double t = 1e-3 * k;
    // Two strokes of 50 mm, between them a second of rest with a swing of 20 um.
    const double turn = std::fmod(t, 4.0);
    const double way = turn < 1.0 ? turn : turn < 2.0 ? 1.0 : turn < 3.0 ? 3.0 - turn : 0.0;
    const bool rests = turn - std::floor(turn) > 0.0 && (turn >= 3.0 || (turn >= 1.0 && turn < 2.0));
    r.x.push_back(50e-3 * way + (rests ? 20e-6 * std::sin(2.0 * kPi * 20.0 * t) : 0.0));
    r.f.push_back(0.0);
  }
  r.source = "swing";
  const OpenLoop open = not_replayed(r);
  EXPECT_GT(open.starts.size(), 20u);
  EXPECT_EQ(open.reversals.size(), 3u);
}

/// The same run and model seen from the other side.
log::Record mirrored(log::Record r) {
  for (auto* column : {&r.x, &r.r, &r.f, &r.v}) {
    for (double& value : *column) value = -value;
  }
  return r;
}

friction::AxisModel gaussian_model() {
  friction::AxisModel m;
  m.mass = 57.65e3;
  m.load = 40.0;
  m.friction.steady = test::table_2_3('x');
  m.friction.eccentric.push_back({30.0, 5e-3, 0.3, friction::EccentricForm::kAdditive});
  m.friction.eccentric.push_back({20.0, 2.5e-3, -1.0, friction::EccentricForm::kProportional});
  return m;
}

/// F'(v, x) = −F(−v, −x): additive sin(−p − η3) = −sin(p + η3), proportional −sin(p + η3)·sgn v.
friction::AxisModel mirrored(friction::AxisModel m) {
  m.load = -m.load;
  auto& map = std::get<friction::Gaussian<double>>(m.friction.steady);
  std::swap(map.positive, map.negative);
  for (auto* branch : {&map.positive, &map.negative}) {
    branch->eta0 = -branch->eta0;
    for (auto& g : branch->gaussians) {
      g.a = -g.a;
      g.b = -g.b;
    }
  }
  map.velocity_range = {-map.velocity_range[1], -map.velocity_range[0]};
  for (auto& term : m.friction.eccentric) {
    term.phase = term.form == friction::EccentricForm::kAdditive ? -term.phase : -term.phase + kPi;
  }
  return m;
}

const ReplayController kPd{PdLaw{57.65e3 * 1600, 57.65e3 * 80, 0.0, 57.65e3}, {}};

log::Record table_run(double noise = 0.0) {
  test::Drive drive;
  drive.friction = test::table_2_3('x');
  drive.noise_rms = noise;
  drive.encoder = 0.0;
  drive.bits = 0.0;
  return test::run_closed(drive, drive.mass, test::sine_reference(drive.sample_time, 0.01, 0.6, 1.2), 3);
}

TEST(Replay, MirrorsAndShiftsInTime) {
  const log::Record run = table_run();
  for (const bool dynamic : {false, true}) {
    friction::AxisModel model = gaussian_model();
    if (dynamic) model.friction.dynamics = friction::LuGre<double>{3e8, 6e5, 0.05e-3};
    log::Record late = run;
    for (double& t : late.t) t += 17.0;
    const OpenLoop open = replay_open_loop(model, run);
    const OpenLoop other = replay_open_loop(mirrored(model), mirrored(run));
    const Replay closed = replay_closed_loop(model, kPd, run);
    const Replay mirror = replay_closed_loop(mirrored(model), kPd, mirrored(run));
    EXPECT_EQ(replay_open_loop(model, late).free.x, open.free.x);
    for (std::size_t k = 0; k < run.x.size(); k += 7) {
      ASSERT_NEAR(open.free.x[k], -other.free.x[k], 1e-10) << k;
      ASSERT_NEAR(open.restarted.x[k], -other.restarted.x[k], 1e-10) << k;
      ASSERT_NEAR(closed.f[k], -mirror.f[k], 1e-5) << k;
    }
  }
}

// The virtual drive has its own equations and a classical Runge–Kutta of 16 steps.
TEST(Replay, FollowsAnotherProgramsBristles) {
  const log::Record run = table_run();
  friction::AxisModel model;
  model.mass = 57.65e3;
  model.friction.steady = test::table_2_3('x');
  model.friction.dynamics = friction::LuGre<double>{3e8, 6e5, 0.05e-3};
  const OpenLoop open = replay_open_loop(model, run);
  EXPECT_LT(open.free.velocity_relative, 1e-3);
  EXPECT_LT(open.free.position_most, 1e-6);
  model.friction.dynamics = friction::Static{};
  EXPECT_GT(replay_open_loop(model, run).free.position_most, 5e-6);
}

// Stiff bristles are no bristles: both laws tend to friction without dynamics, whose standstill is an event.
// What is left is the recoil at every stop, whose speed goes with 1/√(stiffness·m).
TEST(Replay, StiffBristlesTendToExactStandstill) {
  const log::Record r = closed_form_run(0.001, 1600);
  friction::AxisModel model = coulomb_model();
  for (const bool gms : {false, true}) {
    double before = 1.0;
    for (const double stiffness : {1e6, 1e8}) {
      if (gms) {
        friction::Gms<double> law;
        for (const double share : {0.1, 0.2, 0.3, 0.4}) law.elements.push_back({stiffness * share, share});
        law.attraction = 1e5;
        law.damping_coefficient = 0.2 * std::sqrt(stiffness * model.mass);
        law.damping_velocity = 1e-4;
        model.friction.dynamics = law;
      } else {
        model.friction.dynamics =
            friction::LuGre<double>{stiffness, 0.2 * std::sqrt(stiffness * model.mass), 1e-4};
      }
      const OpenLoop open = replay_open_loop(model, r);
      EXPECT_LT(open.free.position_most, 0.2 * before) << "gms " << gms << ", " << stiffness << " N/m";
      before = open.free.position_most;
    }
    EXPECT_LT(before, 1e-4);
  }
}

/// P-PI cascade with averaged velocity, written for the drive of the tests.
log::Record cascade_run(const CascadeLaw& c, double limit) {
  test::Drive drive;
  drive.mass = 100.0;
  drive.friction.velocity_range = {-0.2, 0.2};
  drive.friction.positive = {20.0, 200.0, {}};
  drive.friction.negative = {-22.0, 180.0, {}};
  drive.sigma0 = 1e6;
  drive.sigma1 = 3e3;
  drive.damping_velocity = 1e-3;
  drive.sample_time = 1e-3;
  drive.noise_rms = 0.0;
  drive.encoder = 0.0;
  drive.bits = 0.0;
  drive.force_per_volt = 1.0;
  drive.volts = limit;
  std::vector<double> r;  // at rest in the first and the last rows
  for (int k = 0; k < 2500; ++k)
    r.push_back(0.05 * (1.0 - std::cos(2.0 * kPi * 0.8 * std::clamp(k - 30, 0, 2460) * 1e-3)));
  std::vector<double> past(8, 0.0);
  double integral = 0.0;
  const auto at = [&](std::ptrdiff_t k) {
    return r[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, 2499))];
  };
  log::Record record = test::run(drive, 2.5, 1, [&](std::size_t row, double, double x) {
    const auto k = static_cast<std::ptrdiff_t>(row);
    past.insert(past.begin(), x);
    double mean_now = 0.0;
    double mean_before = 0.0;
    for (int i = 0; i < c.velocity_average; ++i) {
      mean_now += past[static_cast<std::size_t>(i)] / c.velocity_average;
      mean_before += past[static_cast<std::size_t>(i + 1)] / c.velocity_average;
    }
    const double w =
        c.position_gain * (at(k) - x) +
        c.velocity_feedforward * (k == 0 ? (at(1) - at(0)) / 1e-3 : (at(k + 1) - at(k - 1)) / 2e-3) -
        (mean_now - mean_before) / 1e-3;
    double out =
        c.velocity_gain * w + (k > 0 ? c.mass_feedforward * (at(k + 1) - 2 * at(k) + at(k - 1)) / 1e-6 : 0.0);
    if (c.integral_time) {
      const double more = k == 0 ? 0.0 : w * 1e-3;
      const double trial = out + c.velocity_gain / *c.integral_time * (integral + more);
      if (std::abs(trial) <= limit) integral += more;
      out = std::clamp(trial, -limit, limit);
    }
    return out;
  });
  record.r = r;
  return record;
}

TEST(Replay, ClosedLoopFollowsTheCascade) {
  friction::AxisModel model;
  model.mass = 100.0;
  friction::Gaussian<double> map;
  map.velocity_range = {-0.2, 0.2};
  map.positive = {20.0, 200.0, {}};
  map.negative = {-22.0, 180.0, {}};
  model.friction.steady = map;
  model.friction.dynamics = friction::LuGre<double>{1e6, 3e3, 1e-3};
  CascadeLaw plain{160.0, 8500.0, {}, 0.0, 0.0, 2};
  CascadeLaw full{100.0, 6000.0, 0.05, 0.9, 80.0, 3};
  CascadeLaw one{100.0, 6000.0, 0.05, 0.9, 0.0, 1};
  for (const auto& [law, limit] : {std::pair{plain, 1000.0}, {full, 1000.0}, {one, 150.0}}) {
    const log::Record run = cascade_run(law, limit);
    const Replay closed = replay_closed_loop(model, {law, limit}, run);
    EXPECT_LT(closed.force_relative, 1e-4) << law.velocity_average;
    EXPECT_LT(closed.position_rms, 1e-8) << law.velocity_average;
    // The same with a wrong gain, so that the bound above says something.
    CascadeLaw other = law;
    other.velocity_gain *= 0.9;
    EXPECT_GT(replay_closed_loop(model, {other, limit}, run).position_rms, 1e-6);
  }
}

TEST(Replay, PdRejectsALoadByItsIntegral) {
  const log::Record run = table_run();
  friction::AxisModel model = gaussian_model();
  model.friction.eccentric = {};
  ReplayController pid = kPd;
  std::get<PdLaw>(pid.law).integral = 57.65e3 * 8000;
  const Replay without = replay_closed_loop(model, kPd, run);
  const Replay with = replay_closed_loop(model, pid, run);
  double mean_without = 0.0;
  double mean_with = 0.0;
  for (std::size_t k = 1000; k < run.x.size(); ++k) {
    mean_without += run.r[k] - without.x[k];
    mean_with += run.r[k] - with.x[k];
  }
  EXPECT_LT(std::abs(mean_with), 0.3 * std::abs(mean_without));
}

// Half a sample of delay is one sample of a log that is written twice as often.
TEST(Replay, DelayShiftsTheForce) {
  const log::Record fine = closed_form_run(0.001, 2000);
  for (const int late : {-3, 1, 2, 5}) {
    log::Record coarse;
    coarse.source = "coarse";
    coarse.sample_time = 0.002;
    ClosedForm axis;
    for (std::size_t k = 0; k < 1000; ++k) {
      const auto held = [&](int half) {
        const int i = static_cast<int>(2 * k) + half - late;
        return fine.f[static_cast<std::size_t>(std::clamp(i >= 0 ? i / 2 * 2 : 0, 0, 1998))];
      };
      coarse.t.push_back(0.002 * static_cast<double>(k));
      coarse.x.push_back(axis.x);
      coarse.f.push_back(fine.f[2 * k]);
      axis.hold(held(0), 0.001);
      axis.hold(held(1), 0.001);
    }
    const OpenLoop open = replay_open_loop(coulomb_model(), coarse, {0.001 * late});
    EXPECT_LT(open.free.position_most, 1e-9) << late;
    EXPECT_GT(replay_open_loop(coulomb_model(), coarse).free.position_most, 1e-5) << late;
  }
}

TEST(Replay, StartIsTheSlopeUnlessItIsNoise) {
  log::Record r;
  r.sample_time = 0.002;
  const auto fill = [&](auto&& position) {
    r.x.clear();
    for (int k = 0; k < 100; ++k) r.x.push_back(position(k * 0.002));
  };
  fill([](double t) { return 0.1 + 0.03 * t + t * t; });
  EXPECT_NEAR(start_of(r, 0, 1e-12).v, 0.03, 1e-9);
  EXPECT_NEAR(start_of(r, 5, 1e-12).v, 0.05, 1e-9);
  EXPECT_EQ(start_of(r, 97, 1e-12).v, 0.0);  // too few rows are left
  fill([](double) { return 0.1; });
  EXPECT_EQ(start_of(r, 0, 0.0).v, 0.0);
  // Noise of 0.1 µm: rest is rest, and 60 rows tell 30 mm/s to better than 20 µm/s.
  std::mt19937_64 engine(1);
  std::normal_distribution<double> normal;
  fill([&](double) { return 0.1 + 1e-7 * normal(engine); });
  EXPECT_EQ(start_of(r, 0, 1e-7).v, 0.0) << "seed 1";
  fill([&](double t) { return 0.1 + 0.03 * t + t * t + 1e-7 * normal(engine); });
  EXPECT_NEAR(start_of(r, 0, 1e-7).v, 0.03, 2e-5) << "seed 1";
}

TEST(Replay, RefusesWhatItCannotAnswer) {
  const log::Record r = closed_form_run(0.001, 1600);
  const auto why = [](auto&& call) {
    try {
      call();
    } catch (const Refused& e) {
      return std::string(e.what());
    }
    return std::string("nothing");
  };
  friction::AxisModel model = coulomb_model();
  EXPECT_NE(why([&] { replay_closed_loop(model, kPd, r); }).find("no reference"), std::string::npos);
  log::Record with = r;
  with.r = r.x;
  EXPECT_NE(
      why([&] { replay_closed_loop(model, kPd, with, {-0.001}); }).find("a force acts after it is commanded"),
      std::string::npos);
  EXPECT_NE(why([&] { replay_open_loop(model, r, {1.0}); }).find("at most 100 samples"), std::string::npos);
  model.friction.dynamics = friction::LuGre<double>{1e15, 0.0, {}};
  EXPECT_NE(why([&] { replay_open_loop(model, r); }).find("sub-steps"), std::string::npos);
  model = coulomb_model();
  model.mass = 1e-9;
  EXPECT_NE(why([&] { replay_open_loop(model, r); }).find("so small a mass"), std::string::npos);
  model.mass = 0.0;
  EXPECT_NE(why([&] { replay_open_loop(model, r); }).find("positive mass"), std::string::npos);
  friction::Gaussian<double> pushes;
  pushes.velocity_range = {-0.1, 0.1};
  pushes.positive = {20.0, -5000.0, {}};
  pushes.negative = {-20.0, -5000.0, {}};
  model = coulomb_model();
  model.friction.steady = pushes;
  EXPECT_NE(why([&] { replay_open_loop(model, r); }).find("diverges from row"), std::string::npos);
  pushes.positive.eta0 = -1.0;
  model.friction.steady = pushes;
  EXPECT_NE(why([&] { replay_open_loop(model, r); }).find("expected above 0"), std::string::npos);
  log::Record still = r;
  for (double& x : still.x) x = 0.0;
  EXPECT_NE(why([&] { replay_open_loop(coulomb_model(), still); }).find("does not move"), std::string::npos);
  still.x.pop_back();
  EXPECT_NE(why([&] { replay_open_loop(coulomb_model(), still); }).find("rows"), std::string::npos);
}

}  // namespace
}  // namespace stribeck::ident::replay::replay_test
