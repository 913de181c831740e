#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include <stribeck/report/frequency/frequency_report.hpp>

namespace stribeck::report::frequency_report_test {
namespace {

/// One line, and a mass of 115 in the units of the log.
nlohmann::ordered_json json_with(const ShownUnits& units) {
  FrequencyReportInput input;
  FrequencyAxis& axis = input.axes.emplace_back();
  axis.units = units;
  axis.fit.mass.value = 115.0;
  axis.response.sample_time = 1e-3;
  axis.response.lines.push_back({.omega = 100.0, .plant = {2e-6, 0.0}, .half_width = 0.1});
  return to_json(input)["axes"][0];
}

TEST(FrequencyReport, AScaleThatIsNotKnownHasNoKilograms) {
  const auto known = json_with({});
  EXPECT_EQ(known["mass_kg"]["value"], 115.0);
  EXPECT_DOUBLE_EQ(known["lines"][0]["gain_um_per_N"], 2.0);
  EXPECT_FALSE(known.contains("mass"));
  const auto amperes = json_with(ShownUnits("A", "m"));
  EXPECT_TRUE(amperes["mass_kg"].is_null());
  EXPECT_EQ(amperes["mass"]["value"], 115.0);
  EXPECT_TRUE(amperes["lines"][0]["gain_um_per_N"].is_null());
  EXPECT_DOUBLE_EQ(amperes["lines"][0]["gain"], 2e-6);
}

}  // namespace
}  // namespace stribeck::report::frequency_report_test
