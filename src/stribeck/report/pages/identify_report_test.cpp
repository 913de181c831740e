#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <stribeck/ident/bristle/bristle_fit.hpp>
#include <stribeck/report/json.hpp>
#include <stribeck/report/pages/identify_report.hpp>
#include <stribeck/report/table.hpp>
#include <stribeck/report/test_result.hpp>

namespace stribeck::report::identify_report_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

/// What break-away hands back: no model, no mass.
ident::Result slips() {
  ident::Result r;
  r.method = ident::Method::kBreakAway;
  r.set_steady(ident::SteadyModel::kNone);
  r.mass = std::numeric_limits<double>::quiet_NaN();
  r.rows = 8;
  r.parameters.push_back({"break_away_positive", 1200.0, "N", "N", 1150.0, 1250.0, true});
  return r;
}

TEST(IdentifyReport, SaysInPlainWordsWhatWasDetermined) {
  ident::Result r = slips();
  EXPECT_THAT(text_table(r, "x"),
              StartsWith("axis x: force and distance of break-away, from slow ramps, 8 slips\n"));
  const std::string page = identify_report({"x", {r}, "log.csv", "", ""});
  EXPECT_THAT(page, HasSubstr("Axis x: force and distance of break-away, from slow ramps, from 8 slips."));
  EXPECT_THAT(page, Not(HasSubstr("Mass")));  // it is not known
  r.rows = 1;
  EXPECT_EQ(counted(r), "1 slip");
  r.method = ident::Method::kGravity;
  EXPECT_EQ(headline(r), "load and friction, from equal speeds both ways");
  EXPECT_EQ(counted(r), "1 row");
  r.method = ident::Method::kConstantAcceleration;
  EXPECT_THAT(headline(r), StartsWith("mass, "));
  r.method = ident::Method::kPositionMap;
  r.set_steady(ident::SteadyModel::kCogging);
  EXPECT_THAT(headline(r), HasSubstr("cogging"));
  r.set_steady(ident::SteadyModel::kConventional);
  EXPECT_EQ(headline(r), "conventional model by position-map");
}

TEST(IdentifyReport, StatesNoBreakAwayDistanceThatTheLogDoesNotTell) {
  ident::Result r = test::whole_fit();
  EXPECT_THAT(identify_report({"x", {r}, "log.csv", "", ""}), HasSubstr("breaks away after about 12 µm"));
  EXPECT_EQ(to_json(r, "x")["break_away_um"], 12.0);
  r.cannot_tell = {ident::bristle::kNotDeterminable + std::string("sample faster")};
  EXPECT_THAT(identify_report({"x", {r}, "log.csv", "", ""}), Not(HasSubstr("breaks away")));
  EXPECT_TRUE(to_json(r, "x")["break_away_um"].is_null());
}

TEST(IdentifyReport, FirstScreenHasNumbersAndPointsOfTheCurveAreFolded) {
  IdentifyReportInput in{"x", {test::fit()}, "log.csv", "", ""};
  for (int k = 0; k < 6; ++k) {
    in.results[0].parameters.push_back(in.results[0].parameters.front());
    in.results[0].parameters.back().name = "friction_at_" + std::to_string(k);
  }
  const std::string page = identify_report(in);
  EXPECT_LT(page.find("<dl class=\"numbers\">"), page.find("<h2"));
  const auto folded = page.find(" points and parameters of the curve</summary>");
  ASSERT_NE(folded, std::string::npos);
  EXPECT_GT(page.find("friction_at_0"), folded);
}

}  // namespace
}  // namespace stribeck::report::identify_report_test
