#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <stribeck/report/pages/verify_report.hpp>
#include <stribeck/report/shown_units.hpp>
#include <stribeck/report/test_result.hpp>

namespace stribeck::report::verify_report_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(ShownUnits, ReplaceForceAndPosition) {
  const ShownUnits plain;
  EXPECT_EQ(plain.named("N s2/mm"), "N s2/mm");
  EXPECT_TRUE(plain.physical());
  const ShownUnits ampere("A", "m");
  EXPECT_EQ(ampere.named("N s/mm"), "A s/mm");
  EXPECT_EQ(ampere.named("kg"), "A s2/m");
  EXPECT_EQ(ampere.named("mm/s"), "mm/s");
  EXPECT_EQ(ampere.mass, "A s2/mm");
  EXPECT_FALSE(ampere.physical());
  EXPECT_TRUE(ampere.linear());
  const ShownUnits torque("N m", "rad");
  EXPECT_EQ(torque.named("N m"), "N m");
  EXPECT_EQ(torque.named("N"), "N m");
  EXPECT_EQ(torque.named("N m s2/m"), "N m s2/rad");
  EXPECT_EQ(torque.named("N m s/m"), "N m s/rad");
  EXPECT_EQ(torque.named("N/m"), "N m/rad");
  const ShownUnits turning("%", "rad");
  EXPECT_EQ(turning.named("N s/m"), "% s/rad");
  EXPECT_EQ(turning.named("N/(m s)"), "%/(rad s)");
  EXPECT_EQ(turning.chosen("m/s", "mm/s"), "m/s");
  EXPECT_EQ(turning.velocity, "rad/s");
}

/// A record of a sine and two models that miss its velocity by 1 mm/s and by 2 mm/s.
VerifyReportInput two_models(bool closed) {
  VerifiedPart part;
  part.record.source = "log.csv";
  part.record.sample_time = 0.01;
  for (int k = 0; k < 400; ++k) {
    const double t = 0.01 * k;
    part.record.t.push_back(t);
    part.record.x.push_back(0.01 * std::sin(3.0 * t));
    part.record.f.push_back(100.0 * std::cos(3.0 * t));
  }
  for (int i = 1; i <= 2; ++i) {
    VerifiedModel m;
    m.name = i == 1 ? "a.toml" : "b.toml";
    ident::replay::Replay r;
    for (int k = 0; k < 400; ++k) {
      const double v = 0.03 * std::cos(0.03 * k);
      m.open.measured_velocity.push_back(k == 0 ? test::kNaN : v);
      r.v.push_back(v + 1e-3 * i);
      r.x.push_back(part.record.x[static_cast<std::size_t>(k)] + 1e-6 * i);
    }
    r.f = part.record.f;
    r.velocity_rms = 1e-3 * i;
    r.velocity_relative = 0.047 * i;
    r.position_rms = r.position_most = 1e-6 * i;
    r.outside = 3;
    m.open.free = m.open.restarted = r;
    m.force.relative = 0.022 * i;
    m.force.filed_relative = i == 1 ? 0.021 : 0.4;
    m.force.own_relative = i == 1 ? 0.02 : 0.4;
    m.force.own_rms = 1.0;
    m.force.row = {10, 20};
    m.drift.end = i == 1 ? 5e-5 : test::kNaN;
    m.open.starts = {0, 52, 157, 262, 366};
    m.open.reversals = {52, 157, 262, 366};
    if (closed) {
      r.force_rms = 2.5 * i;
      r.force_relative = 0.035 * i;
      m.closed = r;
    }
    part.models.push_back(m);
  }
  VerifyReportInput in;
  in.axis = "x";
  in.parts = {part};
  in.source = "log.csv";
  in.command = "stribeck verify a.toml b.toml log.csv";
  in.warnings = {"a warning"};
  return in;
}

// The drive started the model anew 7 times, but the axis turned four times.
TEST(VerifyReport, VibrationAtRestIsNoReversal) {
  VerifyReportInput in = two_models(false);
  for (VerifiedModel& m : in.parts[0].models) m.open.starts = {0, 52, 157, 262, 300, 310, 320, 366};
  EXPECT_THAT(text_table(in), HasSubstr("400 rows, 4 reversals"));
  const std::string page = verify_report(in);
  EXPECT_THAT(page, HasSubstr("started anew 7 times, at 4 reversals and where it starts or rests,"));
  EXPECT_THAT(page, HasSubstr("Reversal at 0.52"));
  EXPECT_THAT(page, Not(HasSubstr("Reversal at 3.1")));
}

TEST(VerifyReport, TablesForATerminal) {
  EXPECT_EQ(
      text_table(two_models(false)),
      "axis x: 400 rows, 4 reversals\n"
      "           force     force    stroke    stroke  free run  free run\n"
      "model   protocol  as filed  velocity  position     drift    within\n"
      "               %         %         %        µm        mm      ± mm\n"
      "a.toml      2.20      2.10      4.70      1.00   0.00100    0.0500\n"
      "b.toml      4.40     40.00      9.40      2.00   0.00200         –\n"
      "Errors in % of the RMS of what was measured. force: under the measured motion; protocol: rows paired\n"
      "as the EMPS benchmark does; as filed: force aligned, in % of the force less the load; phases: of\n"
      "periodic terms, from the log. stroke: open loop, anew at each reversal. free run: largest drift, and\n"
      "what the error of the force explains (95 %). loop: closed loop.\n"
      "a.toml is good: error of the force 2.00 % (good up to 5 %, usable up to 15 %).\n"
      "b.toml is not usable: error of the force 40.00 % (good up to 5 %, usable up to 15 %).\n"
      "warning: a warning\n");
  EXPECT_THAT(text_table(two_models(true)), HasSubstr("   3.50      1.00\n"));
  // What tells two files apart survives a long path.
  VerifyReportInput deep = two_models(false);
  for (auto& m : deep.parts[0].models) m.name = "/a/very/long/way/" + m.name;
  EXPECT_EQ(text_table(deep), text_table(two_models(false)));
  deep.parts[0].models[1].name = "elsewhere/b.toml";
  EXPECT_THAT(text_table(deep), HasSubstr("/a/very/long/way/a.toml"));
}

// Where friction builds up behind reversals, which the model does not know, the rest may be right: usable, and no more.
TEST(VerifyReport, AModelWithoutPreSlidingIsAtMostUsable) {
  VerifyReportInput in = two_models(false);
  ident::replay::ForceError& e = in.parts[0].models[1].force;
  e.moving = 100;
  e.moving_relative = 0.03;
  e.moving_rms = 0.1;
  e.at_rest = 0.01;
  e.unsettled = 0.05;
  const Verdict v = verdicts(in)[1];
  EXPECT_TRUE(v.moving);
  EXPECT_TRUE(v.settled);
  EXPECT_EQ(v.grade, Grade::kUsable);
  EXPECT_THAT(text_table(in), HasSubstr("where friction has settled after a reversal"));
}

// Nobody knows the force of an axis that stands, so rests are not held against a model.
TEST(VerifyReport, JudgesWhereTheAxisMovesIfRestsMakeTheError) {
  VerifyReportInput in = two_models(false);
  ident::replay::ForceError& e = in.parts[0].models[1].force;
  e.moving = 100;
  e.moving_relative = 0.03;
  e.moving_rms = 0.1;
  e.at_rest = 0.05;
  EXPECT_FALSE(verdicts(in)[1].moving);
  e.at_rest = 0.25;
  Verdict v = verdicts(in)[1];
  EXPECT_TRUE(v.moving);
  EXPECT_NEAR(v.error, 0.03, 1e-12);
  EXPECT_EQ(v.grade, Grade::kGood);
  EXPECT_THAT(text_table(in),
              HasSubstr("b.toml is good: error of the force 3.00 % where the axis moves (good up to 5 %"));
  EXPECT_TRUE(to_json(in)["verdicts"][1]["where_it_moves"]);
  EXPECT_FALSE(to_json(in)["verdicts"][0]["where_it_moves"]);
  EXPECT_EQ(to_json(in)["parts"][0]["models"][1]["force"]["at_rest_percent"], 25.0);
  e.moving_relative = 0.39;  // the motion is no better
  EXPECT_FALSE(verdicts(in)[1].moving);
  e.moving_relative = 0.03;
  e.moving = 10;  // too little of it
  EXPECT_FALSE(verdicts(in)[1].moving);
}

// A motion of much acceleration hides wrong friction from the error of the force.
TEST(VerifyReport, FrictionThatIsOffLowersTheVerdict) {
  VerifyReportInput in = two_models(false);
  ident::replay::FrictionChange& friction = in.parts[0].models[0].force.friction.slow;
  friction = {0.12, 0.05, 0.01};
  EXPECT_EQ(verdicts(in)[0].grade, Grade::kGood);
  friction = {-0.12, 0.005, 0.01};
  EXPECT_EQ(verdicts(in)[0].grade, Grade::kUsable);
  EXPECT_THAT(text_table(in),
              HasSubstr("a.toml is usable: error of the force 2.00 % (good up to 5 %, usable up to "
                        "15 %), but friction at 10 mm/s is 12 ± 0.5 % less than that of the file (good up "
                        "to 10 %, usable up to 30 %).\n"));
  EXPECT_EQ(to_json(in)["verdicts"][0]["friction_more_percent"], -12.0);
  friction = {0.4, 0.005, 0.01};
  EXPECT_EQ(verdicts(in)[0].grade, Grade::kNotUsable);
  EXPECT_FALSE(usable(in));
  in.limits.usable = 25.0;
  EXPECT_TRUE(usable(in));
}

// 35 % more in one direction and 35 % less in the other were "good": both together are right.
TEST(VerifyReport, ALoadThatIsOffLowersTheVerdict) {
  VerifyReportInput in = two_models(false);
  ident::replay::FrictionChanges& friction = in.parts[0].models[0].force.friction;
  friction.slow = {0.01, 0.01, 0.01};
  friction.forward = {0.35, 0.01, 0.05}, friction.backward = {-0.34, 0.01, 0.05};
  friction.load = 7.0, friction.load_half_width = 0.2;
  Verdict v = verdicts(in)[0];
  EXPECT_EQ(v.grade, Grade::kNotUsable);
  EXPECT_THAT(
      text_table(in),
      HasSubstr(
          "but friction is 35 ± 1 % more forward and 34 ± 1 % less backward than that of the file: "
          "the constant force, a load or an offset, is 7 N ± 0.2 N more than in the file (good up to 10 %"));
  const auto json = to_json(in)["verdicts"][0];
  EXPECT_EQ(json["forward_friction_more_percent"], 35.0);
  EXPECT_EQ(json["backward_friction_more_percent"], -34.0);
  EXPECT_EQ(json["load_more_N"], 7.0);
  // A load of which a twentieth is a third of friction: a counterbalance varies by that, however many parts show it.
  friction.forward.varies = friction.backward.varies = 0.33;
  in.parts.insert(in.parts.end(), 9, in.parts[0]);
  EXPECT_EQ(verdicts(in)[0].grade, Grade::kGood);
  // One direction alone is friction that changed.
  for (VerifiedPart& part : in.parts) {
    part.models[0].force.friction.forward = {0.2, 0.01, 0.05};
    part.models[0].force.friction.backward = {0.02, 0.01, 0.05};
  }
  EXPECT_EQ(verdicts(in)[0].grade, Grade::kUsable);
  EXPECT_THAT(text_table(in), AllOf(HasSubstr("20 ± 0.32 % more forward and 2 ± 0.32 % more backward"),
                                    testing::Not(HasSubstr("offset"))));
}

// A file that tells friction from 40 mm/s on is not refused by a log that creeps.
TEST(VerifyReport, ALogSlowerThanTheFileTellsDecidesNothing) {
  VerifyReportInput in = two_models(false);
  VerifiedModel& m = in.parts[0].models[1];
  m.told_from = 0.04;
  m.force.moving = 100;
  m.force.untold = 0.4;
  EXPECT_EQ(verdicts(in)[1].grade, Grade::kNotUsable);
  m.force.untold = 0.9;
  EXPECT_EQ(verdicts(in)[1].grade, Grade::kUndecided);
  EXPECT_THAT(text_table(in),
              HasSubstr("in 90 % of the motion the axis is slower than 40 mm/s, from which on the file "
                        "tells friction: verify with a faster motion"));
  EXPECT_EQ(to_json(in)["verdicts"][1]["untold_percent"], 90.0);
  EXPECT_EQ(to_json(in)["verdicts"][1]["told_from_mm_per_s"], 40.0);
  EXPECT_EQ(to_json(in)["parts"][0]["models"][1]["force"]["untold_percent"], 90.0);
  m.force.friction.fast = {0.5, 0.01, 0.1};  // at speeds that the file tells
  EXPECT_EQ(verdicts(in)[1].grade, Grade::kNotUsable);
}

// Two parts: the one that tells friction better counts more.
TEST(VerifyReport, FrictionOfAllPartsIsWeighedByWhatTheyTell) {
  VerifyReportInput in = two_models(false);
  in.parts.push_back(in.parts[0]);
  in.parts[0].models[0].force.friction.fast = {0.3, 0.1, 0.1};
  in.parts[1].models[0].force.friction.fast = {0.0, 0.01, 0.1};
  const Verdict v = verdicts(in)[0];
  EXPECT_NEAR(v.friction.share, 0.003, 2e-4);
  EXPECT_LT(v.friction.half_width, 0.01);
  EXPECT_EQ(v.grade, Grade::kGood);
}

// One log with 40 % more and one with 40 % less are no good model.
TEST(VerifyReport, FrictionOfPartsThatDisagreeDoesNotCancel) {
  VerifyReportInput in = two_models(false);
  in.parts.push_back(in.parts[0]);
  in.parts[0].models[0].force.friction.slow = {0.4, 0.04, 0.01};
  in.parts[1].models[0].force.friction.slow = {-0.42, 0.04, 0.01};
  const Verdict v = verdicts(in)[0];
  EXPECT_EQ(v.grade, Grade::kNotUsable);
  EXPECT_DOUBLE_EQ(v.friction.share, -0.42);
}

// An error that the log explains is no verdict on the model.
TEST(VerifyReport, LeavesUndecidedWhatTheLogCannotTell) {
  VerifyReportInput in = two_models(false);
  for (VerifiedModel& m : in.parts[0].models) m.force.of_log = 0.3;
  std::vector<Verdict> all = verdicts(in);
  EXPECT_EQ(all[0].grade, Grade::kGood);
  EXPECT_EQ(all[1].grade, Grade::kNotUsable);  // √(40² − 30²) = 26 %
  in.parts[0].models[1].force.of_log = 0.39;
  all = verdicts(in);
  EXPECT_EQ(all[1].grade, Grade::kUndecided);
  EXPECT_NEAR(all[1].of_log, 0.39, 1e-12);
  EXPECT_THAT(text_table(in), AllOf(HasSubstr("b.toml is undecided: error of the force 40.00 %"),
                                    HasSubstr("make a right model miss up to 39.00 %")));
  EXPECT_TRUE(usable(in));
  in.parts[0].models.erase(in.parts[0].models.begin());
  EXPECT_FALSE(usable(in));
  EXPECT_EQ(to_json(in)["verdicts"][0]["verdict"], "undecided");
  EXPECT_NEAR(to_json(in)["verdicts"][0]["of_log_percent"].get<double>(), 39.0, 1e-9);
}

TEST(VerifyReport, SaysInWordsWhatIsBeyondTheTravel) {
  VerifyReportInput in = two_models(false);
  VerifiedModel& m = in.parts[0].models[0];
  m.travel = 0.02;
  m.drift.end = 4e32;
  const std::string text = text_table(in);
  EXPECT_THAT(text, AllOf(HasSubstr("0.00100  > travel"), Not(HasSubstr("e+"))));
  const auto drift = to_json(in)["parts"][0]["models"][0]["drift"];
  EXPECT_TRUE(drift["expected_mm"].is_null());
  EXPECT_TRUE(drift["beyond_travel"].get<bool>());
  // Where no run is left, the force decides alone.
  m.open.restarted.velocity_relative = test::kNaN;
  EXPECT_THAT(verify_report(in), HasSubstr("b.toml predicts the velocity"));
}

TEST(VerifyReport, ComparesTheModels) {
  const std::string page = verify_report(two_models(true));
  EXPECT_THAT(page,
              HasSubstr("a.toml predicts the velocity to 4.70 % (1.00 mm/s RMS), the best of 2 models"));
  EXPECT_THAT(page, HasSubstr("In its closed loop a.toml predicts the force to 3.50 %"));
  EXPECT_THAT(page, HasSubstr("<b>4.70</b>"));
  EXPECT_THAT(page, HasSubstr("a warning"));
  std::size_t drawings = 0;
  for (auto at = page.find("<svg "); at != std::string::npos; at = page.find("<svg ", at + 1)) ++drawings;
  EXPECT_EQ(drawings, 2u + 2u + 4u + 2u + 4u);
  EXPECT_THAT(verify_report(two_models(false)), Not(HasSubstr("Closed loop")));
  EXPECT_THAT(verify_report({}), HasSubstr("</html>"));
}

TEST(VerifyReport, JsonHoldsTheNumbers) {
  auto json = to_json(two_models(true));
  EXPECT_EQ(json["schema"], "stribeck.verify/1");
  const auto& part = json["parts"][0];
  EXPECT_EQ(part["restarts"], 4);
  EXPECT_DOUBLE_EQ(part["models"][1]["open_loop"]["velocity_rms_mm_per_s"], 2.0);
  EXPECT_DOUBLE_EQ(part["models"][1]["closed_loop"]["force_relative_percent"], 7.0);
  EXPECT_EQ(part["models"][0]["open_loop"]["rows_outside_range"], 3);
  VerifyReportInput own = two_models(false);
  own.parts[0].record.force_unit = "A";
  own.parts[0].record.position_unit = "rad";
  json = to_json(own);
  EXPECT_TRUE(json["parts"][0]["models"][0]["closed_loop"].is_null());
  EXPECT_TRUE(json["parts"][0]["models"][0]["open_loop"]["velocity_rms_mm_per_s"].is_null());
  EXPECT_EQ(json["parts"][0]["models"][0]["open_loop"]["velocity_rms"], 1e-3);
  EXPECT_THAT(verify_report(own), Not(HasSubstr("mm/s")));
}

TEST(VerifyReport, JudgesEveryModelOnAllParts) {
  VerifyReportInput in = two_models(false);
  EXPECT_TRUE(usable(in));
  in.limits = {1.0, 1.5};
  EXPECT_FALSE(usable(in));
  // Two parts of equal length: errors of 2 % and 6 % of one force are 4.47 % together.
  in = two_models(false);
  in.parts.push_back(in.parts.front());
  in.parts[1].models[0].force.own_relative = 0.06;
  in.parts[1].models[0].force.own_rms = 3.0;
  const auto all = verdicts(in);
  EXPECT_NEAR(all[0].error, std::sqrt(0.5 * (0.02 * 0.02 + 0.06 * 0.06)), 1e-12);
  EXPECT_EQ(all[0].grade, Grade::kGood);
  EXPECT_EQ(all[1].grade, Grade::kNotUsable);
  // A log too short for the force is judged by the velocity.
  for (auto& part : in.parts) part.models[0].force = {};
  EXPECT_FALSE(verdicts(in)[0].of_force);
  EXPECT_NEAR(verdicts(in)[0].error, 0.047, 1e-12);
  const auto json = to_json(two_models(true));
  EXPECT_EQ(json["verdicts"][1]["verdict"], "not usable");
  EXPECT_DOUBLE_EQ(json["parts"][0]["models"][0]["force"]["error_percent"], 2.2);
}

TEST(VerifyReport, StandsAloneWhateverItIsCalled) {
  VerifyReportInput in = two_models(true);
  in.axis = in.source = in.command = in.parts[0].models[0].name = in.warnings[0] = test::kHostile;
  const std::string page = test::without_script(verify_report(in));
  for (const char* foreign : {"http:", "https:", "<script", "<link", " src=", "url("})
    EXPECT_THAT(page, Not(HasSubstr(foreign)));
}

}  // namespace
}  // namespace stribeck::report::verify_report_test
