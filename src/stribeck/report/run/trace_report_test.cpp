#include <gtest/gtest.h>

#include <stribeck/report/run/trace_report.hpp>
#include <stribeck/report/test_result.hpp>

namespace stribeck::report::trace_report_test {
namespace {

TEST(TraceReport, DrawsColumnsOfOneUnitTogetherAndEscapesWhatItIsGiven) {
  TraceReportInput input;
  input.title = "sine <b>of</b> x";
  input.summary = "8 periods";
  input.version = "1.2.3";
  input.command = "stribeck excite 'a & b'";
  input.warnings = {"axis x ran into its end stop"};
  input.time = {0.0, 1.0, 2.0};
  input.columns = {{"r", "mm", {0, 1, 2}, "position"},
                   {"x", "mm", {0, 1, 3}, "position"},
                   {"f", "N", {5, 6, 7}},
                   {"c", "um", {1, 2, 3}, "contour error"},
                   {"e", "um", {1, 2, 3}, "tracking error"}};
  const std::string html = test::without_script(trace_report(input));
  EXPECT_EQ(html.find("<b>of</b>"), std::string::npos);
  EXPECT_NE(html.find("a &amp; b"), std::string::npos);
  EXPECT_LT(html.find("axis x ran into its end stop"), html.find("<svg"));
  std::size_t drawings = 0;
  for (auto at = html.find("<svg"); at != std::string::npos; at = html.find("<svg", at + 1)) ++drawings;
  EXPECT_EQ(drawings, 4U);
  for (const char* label : {"position [mm]", ">[N]", "contour error [µm]", "tracking error [µm]"})
    EXPECT_NE(html.find(label), std::string::npos) << label;
  EXPECT_EQ(html.find("<script"), std::string::npos);
}

}  // namespace
}  // namespace stribeck::report::trace_report_test
