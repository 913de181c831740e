#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stribeck/core/scalar.hpp>
#include <stribeck/targets/pulse/test_export.hpp>
#include <stribeck/targets/pulse/tnc.hpp>

namespace stribeck::test::tnc_test {
namespace {

using ::testing::HasSubstr;

TEST(Tnc, TheFormulaIsThatOfTheManual) {
  // 10° on 100 mm at 1000 mm/min last 10·2π·100·60/(360·1000) = 1.0472 s; 5 µm in half of it, in cycles of 3 ms.
  const targets::SpikeCompensation c =
      targets::spike_compensation(5e-6, 10.0 * kPi / 180.0, 0.1, 1.0 / 60.0, 3e-3);
  EXPECT_DOUBLE_EQ(c.height, 5e-6);
  EXPECT_NEAR(c.increment, 5e-6 * 3e-3 / (0.5 * 1.0471975512), 1e-18);
  EXPECT_NEAR(c.time(3e-3), 0.5235987756, 1e-9);
  EXPECT_NEAR(c.speed(3e-3) * c.time(3e-3), 5e-6, 1e-18);
  EXPECT_NEAR(targets::spike_width(c, 0.1, 1.0 / 60.0, 3e-3), 10.0 * kPi / 180.0, 1e-12);
}

TEST(Tnc, TheParametersAreReadBackToTheirRounding) {
  const std::string text = targets::machine_parameters({45.64e-6, 1.5223e-6}, "0");
  EXPECT_EQ(text, "MP711.0 : 0.0456\nMP712.0 : 0.001522\n");
  const targets::SpikeCompensation back = targets::read_machine_parameters(text, "0");
  EXPECT_DOUBLE_EQ(back.height, 45.6e-6);
  EXPECT_DOUBLE_EQ(back.increment, 1.522e-6);
  EXPECT_EQ(targets::machine_parameters(back, "0"), text);
  EXPECT_THROW(static_cast<void>(targets::read_machine_parameters(text, "1")), io::InputError);
}

TEST(Tnc, WritesWhatTakesMostOfTheQuadrantErrorAway) {
  PulseExport x("tnc", kBristles);
  const targets::Exported written = x.write();
  const auto& circle = written.json["circle"];
  const double without = circle["without"]["quadrant_um"];
  EXPECT_GT(without, 3.0);
  EXPECT_LT(circle["pulse"]["quadrant_um"].get<double>(), 0.35 * without);
  EXPECT_LT(circle["pulse"]["circular_deviation_um"].get<double>(),
            0.7 * circle["without"]["circular_deviation_um"].get<double>());
  // The prediction is that of the numbers in the file.
  const targets::SpikeCompensation c = targets::read_machine_parameters(text_of(x.request.output), "0");
  EXPECT_NEAR(1e3 * c.increment, written.json["axes"][0]["mp712_mm"].get<double>(), 1e-12);
  EXPECT_NEAR(c.time(5e-3), written.json["axes"][0]["time_s"].get<double>(), 1e-12);
  EXPECT_THAT(written.text, HasSubstr("Check first that --period is the control loop cycle time"));
  // The same bytes again.
  const std::string first = text_of(x.request.output);
  static_cast<void>(x.write());
  EXPECT_EQ(text_of(x.request.output), first);
}

// One value of a gain holds for all axes; of several each axis has its own.
TEST(Tnc, EveryAxisHasItsGains) {
  PulseExport x("tnc", kBristles);
  x.request.files.push_back(x.request.files.front());
  const auto one = x.write().json["axes"];
  EXPECT_EQ(one[0]["position_gain_per_s"], 20.0);
  EXPECT_EQ(one[1]["position_gain_per_s"], 20.0);
  EXPECT_EQ(one[1]["integral_time_ms"], 100.0);
  EXPECT_EQ(one[0]["mp711_mm"], one[1]["mp711_mm"]);
  x.request.controller = x.folder.write(
      "two.toml",
      "id = \"two\"\nlabel = \"gains by axis\"\nfriction = \"conventional\"\n[law]\nkind = \"cascade\"\nposition_gain = [\"20 1/s\", \"10 1/s\"]\n"
      "velocity_gain = [\"80 1/s\", \"40 1/s\"]\n");
  const auto two = x.write().json["axes"];
  EXPECT_EQ(two[0]["mp711_mm"], one[0]["mp711_mm"]);
  EXPECT_EQ(two[1]["position_gain_per_s"], 10.0);
  EXPECT_NE(two[1]["mp711_mm"], one[1]["mp711_mm"]);
}

}  // namespace
}  // namespace stribeck::test::tnc_test
