#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <stribeck/report/table.hpp>
#include <stribeck/report/test_result.hpp>
#include <stribeck/report/text.hpp>

namespace stribeck::report::table_test {
namespace {

std::vector<std::string> lines(const std::string& text) {
  std::vector<std::string> all;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) all.push_back(line);
  return all;
}

std::size_t widest(const std::string& text) {
  std::size_t w = 0;
  for (const std::string& line : lines(text)) w = std::max(w, text_width(line));
  return w;
}

TEST(TextTable, ShowsTheThesisValuesBesideTheResult) {
  EXPECT_EQ(
      text_table(test::two_controllers(), kBiaxialTables),
      "9.5 mm/s, contour error, mean of 4 trials ± standard deviation between them; printed: thesis, Table "
      "3.2\n"
      "                                                                          thesis  thesis  thesis\n"
      "   controller                          max  glitch         RMS  mean |ε|     max  glitch     RMS\n"
      "                                        µm      µm          µm        µm      µm      µm      µm\n"
      "a  no friction compensation     8.00 ±0.25    4.00  4.00 ±0.12      2.00   12.74   12.74    6.88\n"
      "b  conventional friction model  2.00 ±0.25    1.00  1.00 ±0.12      0.50    5.38    4.98    2.23\n");
}

TEST(TextTable, WithoutPrintShowsMoreOfTheResult) {
  sim::CompareResult result = test::two_controllers();
  result.spec.trials = 1;
  for (auto& row : result.rows) row.spread = test::nothing();
  result.rows[1].mean.quadrant_glitch = test::kNaN;
  EXPECT_EQ(text_table(result),
            "9.5 mm/s, contour error, mean of 1 trial\n"
            "   controller                    max  glitch   RMS  mean |ε|    SD  mean |Δu|\n"
            "                                  µm      µm    µm        µm    µm         mV\n"
            "a  no friction compensation     8.00    4.00  4.00      2.00  4.00        125\n"
            "b  conventional friction model  2.00       –  1.00      0.50  1.00        125\n");
}

TEST(TextTable, SaysWhatCouldNotBeSimulated) {
  sim::CompareResult result = test::two_controllers();
  result.rows[1].mean = result.rows[1].spread = test::nothing();
  result.rows[1].refused = "too stiff";
  EXPECT_NE(text_table(result).find("b  conventional friction model           –"), std::string::npos)
      << text_table(result);
  EXPECT_EQ(status_warnings(result), std::vector<std::string>{"(b) at 9.5 mm/s: not simulated: too stiff"});
  result.rows[0].repeatable = false;
  EXPECT_THAT(status_warnings(result).front(), ::testing::StartsWith("(a) at 9.5 mm/s: stick-slip"));
}

TEST(TextTable, FitsTheTerminal) {
  sim::CompareResult result = test::two_controllers();
  result.rows[0].controller.label = test::kHostile + test::kHostile;
  result.rows[1].mean.max_contour_error = 123456.789e-6;
  const std::string text = text_table(result, kBiaxialTables);
  const auto all = lines(text);
  for (std::size_t i = 1; i < all.size(); ++i) EXPECT_LE(text_width(all[i]), kTableWidth) << all[i];
  EXPECT_EQ(text.find('\x01'), std::string::npos);
  EXPECT_EQ(all.size(), 6u);
  // Columns of numbers end at the same place in every row.
  for (std::size_t i = 2; i < all.size(); ++i) EXPECT_EQ(text_width(all[i]), text_width(all[1]));
  EXPECT_LE(widest(text_table(test::fit(), "x")), kTableWidth);
  // The longest id there may be is not cut, a label is.
  result.rows[1].controller.id = "abcdefghijklmnop";
  const std::string full = text_table(result, kBiaxialTables);
  EXPECT_NE(full.find("\nabcdefghijklmnop  conv"), std::string::npos) << full;
  EXPECT_LE(widest(full.substr(full.find('\n'))), kTableWidth);
  result.rows[1].controller.id = std::string(200, 'x');
  EXPECT_LE(widest(text_table(result, kBiaxialTables).substr(text.find('\n'))), kTableWidth);
}

TEST(TextTable, ShowsAFit) {
  EXPECT_EQ(text_table(test::fit(), "x"),
            "axis x: gaussian model by velocity-map, 1234 rows, 20.5 N RMS on held-out motion\n"
            "parameter               value  95 % from      to  unit\n"
            "mass                   57.650     57.600  57.700  N s2/mm\n"
            "eta1_positive           102.5      101.0   104.0  N s/mm\n"
            "gaussian_1_a_positive   12.50          –       –  N        not determined by the data\n"
            "\n"
            "model                     held-out RMS  ± from best\n"
            "                                     N            N\n"
            "Gaussian, 1 term, v > 0          20.50         0.00  chosen\n"
            "Gaussian, 0 terms, v > 0        250.00        12.00\n"
            "warning: speeds above 9 mm/s were seen once\n");
}

TEST(TextTable, SaysWhatTheLogCannotTellInItsUnits) {
  ident::Result r = test::own_units(false);
  r.models = {{"a", 0, 2, 0.0412, 0.0003, true}};
  const std::string text = text_table(r, "x");
  EXPECT_THAT(text, ::testing::HasSubstr("57.650     57.600  57.700  A s2/mm\n"));
  EXPECT_THAT(text, ::testing::HasSubstr("force_shift"));
  EXPECT_THAT(text, ::testing::HasSubstr("20.5 A RMS on held-out motion"));
  EXPECT_THAT(text, ::testing::HasSubstr("0.04120      0.00030  chosen"));
  EXPECT_THAT(text, ::testing::HasSubstr("Forces are in A, positions in mm: the log gives no scale."));
  EXPECT_THAT(text, ::testing::HasSubstr(
                        "This log does not determine:\n  - the stiffness of pre-sliding: the encoder "
                        "is too coarse\n"));
  EXPECT_THAT(text, ::testing::Not(::testing::ContainsRegex("[0-9] +N( |\n)")));
}

}  // namespace
}  // namespace stribeck::report::table_test
