#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <stribeck/io/sha256.hpp>
#include <stribeck/targets/steady/test_export.hpp>
#include <vector>

namespace stribeck::test::json_table_test {
namespace {

using ::testing::HasSubstr;

/// As the guide tells it: straight lines between the rows, end values beyond them [N]; velocity in m/s.
double looked_up(const nlohmann::json& axis, double v) {
  const auto x = axis["velocity_mm_per_s"].get<std::vector<double>>();
  const auto y = axis["friction_N"].get<std::vector<double>>();
  const double at = 1e3 * v;
  if (at <= x.front()) return y.front();
  if (at >= x.back()) return y.back();
  std::size_t i = 1;
  while (x[i] < at) ++i;
  return y[i - 1] + (y[i] - y[i - 1]) * (at - x[i - 1]) / (x[i] - x[i - 1]);
}

TEST(JsonTable, IsReadBackWithTheErrorThatIsPrinted) {
  SteadyExport x;
  const targets::Exported written = x.to("json");
  const auto file = nlohmann::json::parse(text_of(x.request.output));
  EXPECT_EQ(file["schema"], "stribeck.friction-table/1");
  EXPECT_EQ(file["made"]["command"], "test");
  EXPECT_EQ(file["made"]["inputs"][0]["sha256"], io::sha256_of_file(x.request.files[0]));
  const auto& axis = file["axes"][0];
  const double off = largest_off([&](double v) { return looked_up(axis, v); });
  EXPECT_LE(off, error_of(written) + 1e-9);
  EXPECT_GT(off, 0.9 * error_of(written));
  EXPECT_EQ(axis["max_error_N"], error_of(written));
  EXPECT_LT(off, 0.01);
  EXPECT_EQ(axis["mass_kg"], 800.0);
  EXPECT_EQ(axis["load_N"], 30.0);
  EXPECT_NEAR(axis["slowest_mm_per_s"], 0.1, 1e-12);
  EXPECT_NEAR(axis["fastest_mm_per_s"], 100.0, 1e-9);
  // Velocities ascend from one direction to the other.
  const auto v = axis["velocity_mm_per_s"].get<std::vector<double>>();
  EXPECT_EQ(v.size(), axis["friction_N"].size());
  EXPECT_TRUE(std::is_sorted(v.begin(), v.end()));
  EXPECT_NEAR(v.front(), -100.0, 1e-6);
  EXPECT_NEAR(v.back(), 100.0, 1e-6);
}

TEST(JsonTable, HoldsThePeriodicTermsAndSaysThatPlacesAreLeftOut) {
  SteadyExport x((std::string(kSteadyAxis) + "[[friction.places]]\nposition = \"0 mm\"\nlevel = 1\n"
                                             "[[friction.places]]\nposition = \"100 mm\"\nlevel = 1.25\n") +
                 kItsSpring);
  const auto file = nlohmann::json::parse(x.text("json"));
  const auto& axis = file["axes"][0];
  ASSERT_EQ(axis["periodic"].size(), 1U);
  EXPECT_EQ(axis["periodic"][0]["amplitude_N"], 7.0);
  EXPECT_NEAR(axis["periodic"][0]["period_mm"], 5.0, 1e-12);
  EXPECT_EQ(axis["periodic"][0]["phase_rad"], 0.4);
  EXPECT_EQ(axis["periodic"][0]["form"], "proportional");
  EXPECT_NEAR(axis["spring"]["stiffness_N_per_mm"], 1.5, 1e-12);
  EXPECT_NEAR(axis["spring"]["zero_at_mm"], 4.0, 1e-12);
  EXPECT_NEAR(axis["spring"]["from_mm"], -12.0, 1e-12);
  EXPECT_NEAR(axis["spring"]["to_mm"], 15.0, 1e-12);
  ASSERT_EQ(axis["left_out"].size(), 1U);
  EXPECT_THAT(axis["left_out"][0].get<std::string>(), HasSubstr("25 % of friction along the travel"));
}

}  // namespace
}  // namespace stribeck::test::json_table_test
