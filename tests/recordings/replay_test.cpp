#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/replay/model_force.hpp>
#include <stribeck/ident/replay/replay.hpp>
#include <stribeck/io/log/log.hpp>
#include <stribeck/workflow/log/log_axis.hpp>
#include <string>
#include <tests/cli/command.hpp>
#include <tests/recordings/recording.hpp>

namespace stribeck::test::replay_test {
namespace {

// Controller of the recording: kp 160.18 1/s, kv 243.45 V·s/m at 35.15065188248547 N/V, ±10 V.
constexpr double kGain = 35.15065188248547;
const ident::replay::ReplayController kEmps{
    ident::replay::CascadeLaw{160.18, 243.45 * kGain, {}, 0.0, 0.0, 2}, 10.0 * kGain};

ident::log::Record emps(const std::string& log) {
  workflow::LogOptions options;
  options.gain = "35.15065188248547 N/V";
  return plain_record(io::read_csv(log), options);
}

friction::AxisModel published() {
  return {95.1089, -3.1648, {friction::Conventional<double>{20.3935, 203.5034, {}}, {}, {}}};
}

/// Least squares on the recording with the force aligned: friction by direction, fading at low speed, and the
/// ripple of the screw. It has seen the record; what is tested is the replay.
friction::AxisModel richer() {
  friction::AxisModel m;
  m.mass = 94.891;
  m.load = -0.1845;
  friction::Gaussian<double> map;
  map.velocity_range = {-0.13, 0.13};
  map.positive = {21.2175, 158.915, {}};
  map.negative = {-21.2175, 233.956, {}};
  map.positive.gaussians.push_back({-6.608, 0.0, 0.016});
  map.negative.gaussians.push_back({7.634, 0.0, 0.016});
  m.friction.steady = map;
  m.friction.eccentric.push_back({0.9768, 2.5e-3, 0.3577, friction::EccentricForm::kAdditive});
  return m;
}

TEST(Replay, ReproducesEmpsInItsClosedLoop) {
  STRIBECK_RECORDING(log, "emps/emps.csv");
  const ident::log::Record record = emps(log);
  const ident::replay::Replay plain = ident::replay::replay_closed_loop(published(), kEmps, record);
  // An independent program with closed-form pieces between events: 4.562 % and 1.616 µm.
  EXPECT_NEAR(100.0 * plain.force_relative, 4.562, 0.02);
  EXPECT_NEAR(1e6 * plain.position_rms, 1.616, 0.01);
  const ident::replay::Replay rich = ident::replay::replay_closed_loop(richer(), kEmps, record);
  EXPECT_NEAR(100.0 * rich.force_relative, 2.506, 0.05);
  EXPECT_NEAR(1e6 * rich.position_rms, 0.842, 0.02);
  // Half a sample of wrong alignment costs 0.2 %, though the loop makes up for most of it.
  const ident::replay::Replay late = ident::replay::replay_closed_loop(richer(), kEmps, record, {0.5e-3});
  EXPECT_GT(late.force_relative, 1.05 * rich.force_relative);
}

TEST(Replay, PredictsTheVelocityOfEmpsInOpenLoop) {
  STRIBECK_RECORDING(log, "emps/emps.csv");
  const ident::log::Record record = emps(log);
  const ident::replay::OpenLoop plain = ident::replay::replay_open_loop(published(), record);
  const ident::replay::OpenLoop rich = ident::replay::replay_open_loop(richer(), record);
  EXPECT_NEAR(100.0 * plain.restarted.velocity_relative, 4.82, 0.1);
  EXPECT_NEAR(100.0 * rich.restarted.velocity_relative, 1.74, 0.1);
  EXPECT_EQ(plain.starts.size(), 8u);  // four cycles
}

// The published protocol prints 4.0834 % for these parameters.
TEST(ForceError, IsThatOfTheEmpsBenchmarkToTheDigit) {
  STRIBECK_RECORDING(log, "emps/emps.csv");
  const ident::log::Record record = emps(log);
  const ident::replay::ForceError plain = ident::replay::force_error(published(), record);
  EXPECT_NEAR(100.0 * plain.relative, 4.0834, 0.0001);
  EXPECT_FALSE(plain.shifted);
  const ident::replay::ForceError rich = ident::replay::force_error(richer(), record);
  EXPECT_LT(100.0 * rich.own_relative, 2.2);
  EXPECT_GT(100.0 * rich.own_relative, 1.5);
  ASSERT_EQ(rich.phases.size(), 1u);
  EXPECT_TRUE(rich.phases[0].determined);
  EXPECT_FALSE(rich.phases[0].differs);
  const ident::replay::ControllerCheck check = ident::replay::check_controller(kEmps, record);
  EXPECT_NEAR(100.0 * check.relative, 0.25, 0.02);  // 0.0037 V, says the archive
}

// The same record after another homing: positions 0.7 mm further on.
TEST(ForceError, FindsTheNewPhaseOfEmps) {
  STRIBECK_RECORDING(log, "emps/emps.csv");
  ident::log::Record record = emps(log);
  for (auto* column : {&record.x, &record.r}) {
    for (double& x : *column) x += 0.7e-3;
  }
  const ident::replay::ForceError e = ident::replay::force_error(richer(), record);
  EXPECT_TRUE(e.phases[0].differs);
  EXPECT_NEAR(e.phases[0].found - e.phases[0].stored, 2.0 * kPi * 0.7 / 2.5, 0.2);
  EXPECT_GT(e.filed_relative, 1.2 * e.own_relative);
}

TEST(Replay, VerbSaysTheSame) {
  STRIBECK_RECORDING(log, "emps/emps.csv");
  const Folder folder;
  const std::string axis =
      folder.write("published.toml",
                   "mass = \"95.1089 kg\"\nload = \"-3.1648 N\"\n[friction.steady]\n"
                   "kind = \"conventional\"\nalpha0 = \"20.3935 N\"\nalpha2 = \"203.5034 N s/m\"\n");
  const std::string controller = folder.write(
      "controller.toml",
      "limit = \"351.5065188248547 N\"\n[controller]\nkind = \"cascade\"\nposition_gain = \"160.18 1/s\"\n"
      "velocity_gain = \"8557.426200791081 N s/m\"\nvelocity_average = 2\n");
  const Said said = command({"verify", axis, log, "--gain", "35.15065188248547 N/V", "--controller",
                             controller, "--json", folder / "v.json", "--report", folder / "report"});
  ASSERT_EQ(said.code, 0) << said.err;
  const auto json = nlohmann::json::parse(text_of(folder / "v.json"));
  const auto& closed = json["parts"][0]["models"][0]["closed_loop"];
  EXPECT_NEAR(closed["force_relative_percent"].get<double>(), 4.562, 0.02);
  EXPECT_NEAR(closed["position_rms_um"].get<double>(), 1.616, 0.01);
  EXPECT_NE(said.out.find("4.56"), std::string::npos) << said.out;
}

}  // namespace
}  // namespace stribeck::test::replay_test
