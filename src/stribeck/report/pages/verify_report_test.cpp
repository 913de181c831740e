#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <stribeck/report/pages/verify_report.hpp>
#include <stribeck/report/shown_units.hpp>
#include <stribeck/report/test_result.hpp>

namespace stribeck::report {
namespace {

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
      m.open.measured_velocity.push_back(k == 0 ? testing::kNaN : v);
      r.v.push_back(v + 1e-3 * i);
      r.x.push_back(part.record.x[static_cast<std::size_t>(k)] + 1e-6 * i);
    }
    r.f = part.record.f;
    r.velocity_rms = 1e-3 * i;
    r.velocity_relative = 0.047 * i;
    r.position_rms = r.position_most = 1e-6 * i;
    r.outside = 3;
    m.open.free = m.open.restarted = r;
    m.open.starts = {0, 52, 157, 262, 366};
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

TEST(VerifyReport, TablesForATerminal) {
  EXPECT_EQ(text_table(two_models(false)),
            "axis x: 400 rows, 4 reversals\n"
            "        open loop  anew at  reversals  from the  first row\n"
            "model    velocity    error   position  velocity      drift\n"
            "             mm/s        %         µm         %         mm\n"
            "a.toml       1.00     4.70       1.00      4.70    0.00100\n"
            "b.toml       2.00     9.40       2.00      9.40    0.00200\n"
            "RMS values; drift: largest value; error: share of the measured RMS.\n"
            "warning: a warning\n");
  EXPECT_THAT(text_table(two_models(true)), HasSubstr("2.50   3.50      1.00\n"));
  // What tells two files apart survives a long path.
  VerifyReportInput deep = two_models(false);
  for (auto& m : deep.parts[0].models) m.name = "/a/very/long/way/" + m.name;
  EXPECT_EQ(text_table(deep), text_table(two_models(false)));
  deep.parts[0].models[1].name = "elsewhere/b.toml";
  EXPECT_THAT(text_table(deep), HasSubstr("/a/very/long/way/a.toml"));
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

TEST(VerifyReport, StandsAloneWhateverItIsCalled) {
  VerifyReportInput in = two_models(true);
  in.axis = in.source = in.command = in.parts[0].models[0].name = in.warnings[0] = testing::kHostile;
  const std::string page = verify_report(in);
  for (const char* foreign : {"http:", "https:", "<script", "<link", " src=", "url("})
    EXPECT_THAT(page, Not(HasSubstr(foreign)));
}

}  // namespace
}  // namespace stribeck::report
