#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <stribeck/targets/pulse/fanuc.hpp>
#include <stribeck/targets/pulse/test_export.hpp>

namespace stribeck::test::fanuc_test {
namespace {

using ::testing::HasSubstr;

TEST(Fanuc, TheParametersAreReadBackToTheirRounding) {
  // 12.346 mm/min; a negative start ends at three times the distance.
  const std::string text = targets::servo_parameters({0.75, 12.346e-3 / 60.0, 20e-6, 3.0}, "X");
  EXPECT_EQ(text,
            "X stage 1 acceleration coefficient [%] = 75\nX stage 2 acceleration amount [mm/min] = 12.35\n"
            "X stage 2 start/end [detection unit of 1 um] = -20\n");
  const targets::TwoStages back = targets::read_servo_parameters(text, "X");
  EXPECT_DOUBLE_EQ(back.coefficient, 0.75);
  EXPECT_DOUBLE_EQ(back.amount, 12.35e-3 / 60.0);
  EXPECT_DOUBLE_EQ(back.start, 20e-6);
  EXPECT_EQ(back.end, 3.0);
  EXPECT_EQ(targets::servo_parameters(back, "X"), text);
  EXPECT_EQ(targets::read_servo_parameters(targets::servo_parameters({1.0, 0.0, 5e-6, 2.0}, "Y"), "Y").end,
            2.0);
  EXPECT_THROW(static_cast<void>(targets::read_servo_parameters(text, "Y")), io::InputError);
}

TEST(Fanuc, WritesWhatTakesMostOfTheQuadrantErrorAway) {
  PulseExport x("fanuc", kBristles);
  std::size_t calls = 0, last = 0, all = 0;
  x.request.progress = [&](std::string_view what, std::size_t done, std::size_t of) {
    EXPECT_EQ(what, "fanuc X: circles");
    EXPECT_EQ(done, last + 1);
    ++calls, last = done, all = of;
  };
  const targets::Exported written = x.write();
  EXPECT_GT(calls, 20U);
  EXPECT_EQ(last, all);
  const auto& circle = written.json["circle"];
  const double without = circle["without"]["quadrant_um"];
  EXPECT_GT(without, 3.0);
  EXPECT_LT(circle["pulse"]["quadrant_um"].get<double>(), 0.35 * without);
  const targets::TwoStages s = targets::read_servo_parameters(text_of(x.request.output), "X");
  EXPECT_NEAR(1e6 * s.start * s.end, written.json["axes"][0]["stage2_to_um"].get<double>(), 1e-9);
  EXPECT_THAT(written.text, HasSubstr("Check first the detection unit"));
}

TEST(PulseTargets, TellTheLoopInTheUnitsOfTheControl) {
  PulseExport x("tnc", kBristles);
  x.request.period = "1 ms";
  x.request.controller = x.folder.write(
      "loop.toml",
      "id = \"own\"\nlabel = \"own\"\n[law]\nkind = \"cascade\"\nposition_gain = [\"50 1/s\"]\nvelocity_gain = [\"200 1/s\"]\nintegral_time = [\"20 ms\"]\n");
  const targets::Exported written = x.write();
  // 50 mm/s per mm are 3 m/min per mm; 1000 kg · 200 1/s are 200 N s/mm.
  const std::string loop =
      "found for Kv 3.000 (m/min)/mm (MP1510 with velocity feed-forward, MP1810 without), Kp 200.0 N s/mm at the axis, Tn 20.00 ms";
  EXPECT_THAT(written.text, HasSubstr("; " + loop + ".\n"));
  EXPECT_THAT(text_of(x.request.output), HasSubstr(loop + "\nMP711.0 : "));
  const auto& axis = written.json["axes"][0];
  EXPECT_NEAR(axis["position_gain_per_s"], 50.0, 1e-9);
  EXPECT_NEAR(axis["velocity_gain_N_s_per_mm"], 200.0, 1e-9);
  EXPECT_NEAR(axis["integral_time_ms"], 20.0, 1e-9);
}

TEST(PulseTargets, AreAmongAllWhereTheLoopIsGiven) {
  PulseExport x("all", kBristles);
  x.request.output = x.folder / "all";
  x.request.names = {"x"};
  x.request.gain = "12 N/%";
  EXPECT_THAT(x.refusal(), HasSubstr("--period: applies only to --to sinumerik, tnc and fanuc"));
  x.request.controller = "cascade";
  const targets::Exported written = x.write();
  EXPECT_THAT(written.text, HasSubstr("what is written\ncsv  "));
  for (const char* name : {"sinumerik", "tnc", "fanuc", "cia402"})
    EXPECT_TRUE(std::filesystem::exists(x.folder / ("all/" + std::string(name) + ".txt"))) << name;
  EXPECT_EQ(written.json["targets"].back()["to"], "fanuc");
  EXPECT_LT(written.json["targets"].back()["circle"]["pulse"]["quadrant_um"],
            written.json["targets"].back()["circle"]["without"]["quadrant_um"]);
  EXPECT_THAT(written.text, HasSubstr("because an option is missing: ax8000 (--lead) and keba (--lead)."));
}

// Friction that builds up over half a millimetre: a table over the speed pushes before it is there.
TEST(PulseTargets, ATargetThatDoesHarmIsNamed) {
  std::string soft = kBristles;
  const std::size_t at = soft.find("sigma0 = \"");
  ASSERT_NE(at, std::string::npos);
  const std::size_t from = at + std::string("sigma0 = \"").size();
  soft.replace(from, soft.find('"', from) - from, "0.2 N/um");
  PulseExport x("all", soft.c_str());
  x.request.output = x.folder / "all";
  x.request.controller = "cascade";
  const targets::Exported written = x.write();
  const std::size_t warned = written.text.find("Warning: on this circle ");
  std::size_t harmful = 0;
  for (const auto& target : written.json["targets"]) {
    if (!target.contains("circle")) continue;
    const double without = target["circle"]["without"]["quadrant_um"],
                 with = target["circle"]["pulse"]["quadrant_um"];
    if (!(with > 1.02 * without)) continue;
    ++harmful;
    EXPECT_NE(written.text.find(target["to"].get<std::string>(), warned), std::string::npos) << target["to"];
  }
  EXPECT_GT(harmful, 0U);
  EXPECT_EQ(warned != std::string::npos, harmful > 0);
}

}  // namespace
}  // namespace stribeck::test::fanuc_test
