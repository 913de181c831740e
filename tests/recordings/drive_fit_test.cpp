#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <stribeck/friction/axis_model.hpp>
#include <stribeck/friction/steady.hpp>
#include <stribeck/ident/drive/drive_fit.hpp>
#include <stribeck/ident/log/filter.hpp>
#include <stribeck/ident/log/motion.hpp>
#include <stribeck/ident/replay/replay.hpp>
#include <stribeck/io/log/log.hpp>
#include <stribeck/workflow/log/log_axis.hpp>
#include <string>
#include <tests/cli/command.hpp>
#include <tests/recordings/recording.hpp>
#include <tuple>
#include <variant>
#include <vector>

namespace stribeck::test::drive_fit_test {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

using Column = std::vector<double>;

constexpr double kGain = 35.15065188248547;  // [N/V], README of the recording
constexpr std::size_t kCycle = 6240;         // rows of 1 ms
constexpr double kHold = -0.5;               // rows: a commanded force under its zero-order hold
constexpr std::size_t kCycles = 4;           // the last one ends 0.12 s early

ident::log::Record emps(const std::string& log) {
  workflow::LogOptions options;
  options.gain = "35.15065188248547 N/V";
  return plain_record(io::read_csv(log), options);
}

ident::log::Record rows(const ident::log::Record& whole, std::size_t from, std::size_t to) {
  ident::log::Record part = whole;
  for (Column* c : {&part.t, &part.r, &part.x, &part.f, &part.v}) {
    if (c->empty()) continue;
    *c = Column(c->begin() + static_cast<std::ptrdiff_t>(from), c->begin() + static_cast<std::ptrdiff_t>(to));
  }
  return part;
}

/// The published filter and decimation with the force aligned, and a model scored on it.
class Protocol {
 public:
  Protocol(const ident::log::Record& record, double shift) : f_(ident::log::align_force(record.f, shift)) {
    const double T = record.sample_time;
    x_ = ident::log::forward_backward(ident::log::butterworth(4, 100.0 * 2.0 * T), record.x);
    v_ = central(x_, T);
    a_ = central(v_, T);
  }

  /// 100·‖e‖/‖f‖ over the decimated rows of a stretch.
  [[nodiscard]] double relative(const friction::AxisModel& model, std::size_t from, std::size_t to) const {
    Column e(f_.size());
    for (std::size_t k = 0; k < e.size(); ++k) {
      e[k] = f_[k] - model.mass * a_[k] - model.load - friction::steady_force(model.friction, v_[k], x_[k]);
    }
    return 100.0 * std::sqrt(square(e, from, to) / square(f_, from, to));
  }

 private:
  static constexpr std::size_t kDropped = 49;
  static constexpr std::size_t kDecimation = 10;

  static Column central(const Column& y, double T) {
    Column d(y.size());
    for (std::size_t k = 1; k + 1 < y.size(); ++k) d[k] = (y[k + 1] - y[k - 1]) / (2.0 * T);
    d.front() = (y[1] - y[0]) / T;
    d.back() = (y.back() - y[y.size() - 2]) / T;
    return d;
  }
  static double square(const Column& y, std::size_t from, std::size_t to) {
    const Column d = ident::log::decimate({y.begin() + kDropped, y.end()}, kDecimation);
    double sum = 0.0;
    for (std::size_t i = 0; i < d.size(); ++i) {
      const std::size_t row = y.size() - 1 - kDecimation * (d.size() - 1 - i);
      if (row >= from && row < to) sum += d[i] * d[i];
    }
    return sum;
  }

  Column f_, x_, v_, a_;
};

friction::AxisModel axis(const ident::Result& result) { return {result.mass, result.load, result.friction}; }

/// Of the force, in rows of 1 ms; under its hold where none was found.
double shift_of(const ident::Result& result) {
  const ident::Parameter* shift = result.find("force_shift");
  return shift == nullptr ? kHold : shift->value / 1e-3;
}

TEST(DriveFit, PredictsTheCycleOfEmpsThatItHasNotSeen) {
  STRIBECK_RECORDING(log, "emps/emps.csv");
  const ident::log::Record whole = emps(log);
  const Protocol held(whole, kHold);
  const std::size_t n = whole.x.size();
  const friction::AxisModel published{
      95.1089, -3.1648, {friction::Conventional<double>{20.3935, 203.5034, {}}, {}, {}}};
  // 4.0834 % with the force half a row late; alignment alone gains 0.1 %.
  EXPECT_NEAR(held.relative(published, 0, n), 4.0, 0.1);
  ident::drive::DriveFitOptions options;
  options.dynamics = false;  // the score takes the steady map alone
  // Measured: 1.981, 1.895, 1.896, 2.161 %. In sample, all four cycles: 1.938 %.
  for (std::size_t cycle = 0; cycle < kCycles; ++cycle) {
    const std::size_t from = cycle * kCycle;
    const std::size_t to = std::min(n, from + kCycle);
    std::vector<ident::log::Record> others;
    if (from > 0) others.push_back(rows(whole, 0, from));
    if (to < n) others.push_back(rows(whole, to, n));
    const ident::Result result = ident::drive::identify_drive(others, options);
    const double error = Protocol(whole, shift_of(result)).relative(axis(result), from, to);
    EXPECT_LE(error, 2.4) << "cycle " << cycle;
    EXPECT_GE(error, 1.7) << "cycle " << cycle;  // less than what its own rows leave: a leak
    EXPECT_NEAR(result.mass, 95.05, 0.2) << "cycle " << cycle;
    EXPECT_GE(held.relative(published, from, to), 3.5) << "cycle " << cycle;
  }
}

// A drive or a field bus may hold the force back by many rows; beside the fit of a force on time the shift was not found again.
TEST(DriveFit, EmpsWithALateForceIsTheSameAxis) {
  STRIBECK_RECORDING(log, "emps/emps.csv");
  const ident::log::Record whole = emps(log);
  for (const std::size_t late : {14U, 20U}) {
    ident::log::Record record = rows(whole, late, whole.x.size());
    record.f = Column(whole.f.begin(), whole.f.end() - static_cast<std::ptrdiff_t>(late));
    const ident::Result result = ident::drive::identify_drive({record});
    EXPECT_NEAR(result.find("mass")->value, 95.05, 0.3) << late;
    EXPECT_NEAR(shift_of(result), static_cast<double>(late) + kHold, 0.6) << late;
  }
}

TEST(DriveFit, FindsInEmpsWhatTheDataHold) {
  STRIBECK_RECORDING(log, "emps/emps.csv");
  const ident::Result result = ident::drive::identify_drive({emps(log)});
  // A commanded force; with a drive behind it that is late by a third of a row at most.
  EXPECT_LE(shift_of(result), kHold);
  EXPECT_GE(shift_of(result), kHold - 0.4);
  const ident::Parameter* period = result.find("periodic_period_1");
  const ident::Parameter* amplitude = result.find("periodic_amplitude_1");
  ASSERT_NE(period, nullptr);
  ASSERT_NE(amplitude, nullptr);
  EXPECT_NEAR(period->value, 2.5e-3, 0.02e-3);
  EXPECT_LT(period->ci_high - period->ci_low, 0.02e-3);
  EXPECT_NEAR(amplitude->value, 1.0, 0.15);
  EXPECT_TRUE(amplitude->identifiable);
  // It keeps its sign when the direction turns.
  EXPECT_EQ(result.friction.eccentric[0].form, friction::EccentricForm::kAdditive);

  // Friction falls towards standstill, in both directions: below the straight line through higher speeds.
  for (const double d : {1.0, -1.0}) {
    const auto friction = [&](double speed) {
      const auto p = result.friction.parts(d * speed, 0.0);
      return p.level + d * p.viscous;
    };
    const double slope = (friction(0.080) - friction(0.042)) / 0.038;
    const double drop = friction(0.042) - slope * 0.037 - friction(0.005);
    EXPECT_GE(drop, 2.0) << d;  // measured 3.3 and 4.7 N
    EXPECT_LE(drop, 7.0) << d;
    EXPECT_LT(friction(0.002), friction(0.005)) << d;
    EXPECT_LT(friction(0.005), friction(0.020)) << d;
  }

  // Controller of the README.
  const ident::replay::ReplayController controller{
      ident::replay::CascadeLaw{160.18, 243.45 * kGain, {}, 0.0, 0.0, 2}, 10.0 * kGain};
  friction::AxisModel model = axis(result);
  EXPECT_FALSE(std::holds_alternative<friction::Static>(model.friction.dynamics));
  const auto expect_replay = [&](double force_percent, double position_um) {
    const ident::replay::Replay replay =
        ident::replay::replay_closed_loop(model, controller, emps(log), {(kHold - shift_of(result)) * 1e-3});
    EXPECT_LE(100.0 * replay.force_relative, 2.8);
    EXPECT_LE(1e6 * replay.position_rms, 1.0);
    EXPECT_NEAR(100.0 * replay.force_relative, force_percent, 0.15);
    EXPECT_NEAR(1e6 * replay.position_rms, position_um, 0.06);
  };
  expect_replay(2.121, 0.696);
  model.friction.dynamics = friction::Static{};
  expect_replay(2.234, 0.736);
}

/// What the verb writes for programs.
nlohmann::json identified(std::vector<std::string> words) {
  const Folder folder;
  words.insert(words.begin(), "identify");
  words.insert(words.end(), {"--json", folder / "result.json"});
  const Said said = command(words);
  EXPECT_EQ(said.code, 0) << said.err;
  return said.code == 0 ? nlohmann::json::parse(text_of(folder / "result.json")) : nlohmann::json::object();
}

std::vector<std::string> words_of(const nlohmann::json& result, const char* key) {
  return result.at(key).get<std::vector<std::string>>();
}

/// NaN where there is no such parameter.
double parameter(const nlohmann::json& result, const std::string& name) {
  for (const auto& p : result.at("parameters")) {
    if (p.at("name") == name) return p.at("value").get<double>();
  }
  return std::nan("");
}

// README: I = 2.63 a + 4.93 v + 0.646 sgn v + 3.23, rms 0.168 A with the magnitude as logged; 5 to 6 ms late.
TEST(DriveFit, TumIsAMagnitudeAndLate) {
  STRIBECK_RECORDING(log, "tum_feed_axis/FeedStep150_N0_H55.sco");
  const nlohmann::json result = identified({log});
  EXPECT_EQ(result.at("force_unit"), "A");
  EXPECT_THAT(words_of(result, "warnings"),
              AllOf(Contains(AllOf(HasSubstr("magnitude"), HasSubstr("Sign recovered"))),
                    Contains(HasSubstr("the drive is off"))));
  EXPECT_LE(result.at("held_out_rms").get<double>(), 0.17);
  EXPECT_NEAR(result.at("held_out_rms").get<double>(), 0.035, 0.005);
  EXPECT_NEAR(result.at("mass").get<double>(), 2.7, 0.1);
  EXPECT_NEAR(result.at("load").get<double>(), 3.2, 0.15);
  EXPECT_NEAR(parameter(result, "force_shift"), 6.25, 1.25);  // ms
}

// README: frozen from 4.6976 to 4.7936 s; 1.2 samples of 3 ms late against the velocity, which is the mean over the
// slot before and so half a row earlier than the position; 3.97 a; rms 0.0344 to 0.0437 A; 3.00 and 1.50 mm.
TEST(DriveFit, UbcIsFrozenAndLate) {
  STRIBECK_RECORDING(log, "ubc_feed_axis/ubc_trial3_x.csv");
  const nlohmann::json result = identified({log});
  EXPECT_THAT(words_of(result, "warnings"), Contains(HasSubstr("4.6976 to 4.7936 s")));
  const double rms = result.at("held_out_rms").get<double>();
  EXPECT_LE(rms, 0.040);
  // Below the README's by the drift of the level, which is taken out; a fit of the noise itself would be far below.
  EXPECT_GE(rms, 0.020);
  EXPECT_NEAR(result.at("mass").get<double>(), 4.0, 0.1);
  const double late = parameter(result, "force_shift") / 3.0 - 0.5;
  EXPECT_GE(late, 1.0);
  EXPECT_LE(late, 1.4);
  // Its ripple of 0.008 A is at the edge of what this residual shows: periodic_test.cpp finds it on the plateaus.
}

// README: X 8.26 a, R2 0.999; Y 8.89 a, 15.07 A of weight, R2 0.996; the sign is inverted.
TEST(DriveFit, SiemensIsInvertedAndCut) {
  STRIBECK_RECORDING(log, "siemens_edge_capture/capture_840Dsl.json");
  for (const auto& [name, mass, load] : {std::tuple{"X1", 8.26, 0.2}, std::tuple{"Y1", 8.89, 15.07}}) {
    SCOPED_TRACE(name);
    const nlohmann::json result = identified({log, "--axis", name});
    EXPECT_THAT(words_of(result, "warnings"),
                AllOf(Contains(AllOf(HasSubstr("positive towards smaller positions"),
                                     HasSubstr("sign of the force reversed"))),
                      Contains(HasSubstr("gap of 7.72 s"))));
    EXPECT_GE(result.at("r_squared").get<double>(), 0.995);
    EXPECT_LT(result.at("r_squared").get<double>(), 0.99999);
    EXPECT_NEAR(result.at("mass").get<double>(), mass, 0.04 * mass);
    EXPECT_NEAR(result.at("load").get<double>(), load, 0.5);
  }
}

// Residuals on run means: jog_test.cpp. Here: the verb takes these runs for constant speeds, and drive 2 gets nothing
// that it does not need.
TEST(DriveFit, VerbTakesTheScrewDrivesForJogs) {
  STRIBECK_RECORDING(log, "screw_drives/screw_drives.csv");
  const auto drive = [&](const char* number) {
    return identified(
        {log, "--where", std::string("drive=") + number, "--where", "test=steady", "--runs", "set_rpm"});
  };
  const nlohmann::json one = drive("1"), two = drive("2"), three = drive("3");
  for (const nlohmann::json& result : {one, two, three}) {
    EXPECT_EQ(result.at("method"), "jog");
    EXPECT_EQ(result.at("force_unit"), "%");
    EXPECT_THAT(words_of(result, "cannot_tell"), Contains(HasSubstr("mass")));
  }
  EXPECT_NEAR(one.at("held_out_rms").get<double>(), 0.40, 0.05);
  EXPECT_NEAR(three.at("held_out_rms").get<double>(), 0.35, 0.05);
  EXPECT_EQ(one.at("model"), "gaussian");
  EXPECT_EQ(three.at("model"), "gaussian");
  EXPECT_EQ(two.at("model"), "conventional");
  EXPECT_TRUE(two.at("friction").at("steady").at("stribeck").is_null());
  EXPECT_TRUE(std::isnan(parameter(two, "alpha1")));
}

TEST(DriveFit, VerbSaysThatUmichIsTooCoarseForPreSliding) {
  STRIBECK_RECORDING(log, "umich_cnc_mill/experiment_01.csv");
  for (const std::string name : {"X1", "Y1"}) {
    const Said said =
        command({"identify", log, "--inspect", "--axis", name, "--sample-time", "100 ms", "--map",
                 "x=" + name + "_ActualPosition mm", "--map", "v=" + name + "_ActualVelocity mm/s", "--map",
                 "current=" + name + "_CurrentFeedback A"});
    EXPECT_EQ(said.code, 0) << said.err;
    EXPECT_THAT(said.out, AllOf(HasSubstr("pre-sliding"), HasSubstr("too coarse"), HasSubstr("1 mm")));
  }
}

}  // namespace
}  // namespace stribeck::test::drive_fit_test
