#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <tests/cli/command.hpp>

namespace stribeck::test::tune_test {
namespace {

using ::testing::HasSubstr;

std::vector<std::string> quick(std::vector<std::string> more) {
  std::vector<std::string> words{
      "tune",     kMachine, "--parameters", "thesis", "--speed",       "9.5 mm/s", "--laps", "1",
      "--trials", "1",      "--controller", "f",      "--evaluations", "12"};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

TEST(Tune, WritesControllersThatCompareReads) {
  const Folder f;
  const Said said = command(quick({"-o", f / "tuned.toml", "--json", f / "t.json", "--report", f / "page"}));
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out, HasSubstr("Limits: phase margin 45 deg, gain margin 6 dB"));
  EXPECT_THAT(said.out, HasSubstr("as of (f) at its own gains"));
  const auto json = nlohmann::json::parse(text_of(f / "t.json"));
  EXPECT_EQ(json["schema"], "stribeck.tune/1");
  const auto& c = json["controllers"][0];
  EXPECT_TRUE(c["missed"].is_null());
  EXPECT_NEAR(c["margins"]["start"]["phase_deg"].get<double>(), 50.8, 0.1);
  EXPECT_GE(c["margins"]["tuned"]["phase_deg"].get<double>(), 45.0);
  EXPECT_LE(c["rows"][0]["tuned"]["max_contour_error_um"].get<double>(),
            c["rows"][0]["start"]["max_contour_error_um"].get<double>());
  EXPECT_THAT(text_of(f / "page/index.html"), HasSubstr("Tuned controllers: biaxial table"));
  // Nothing is retyped.
  const Said compare =
      command({"compare", kMachine, "--parameters", "thesis", "--speed", "9.5 mm/s", "--laps", "1",
               "--trials", "1", "--controller", f / "tuned.toml", "--json", f / "c.json", "--quiet"});
  ASSERT_EQ(compare.code, 0) << compare.err;
  const auto rows = nlohmann::json::parse(text_of(f / "c.json"))["rows"];
  EXPECT_EQ(rows.back()["controller"], "f-tuned");
  EXPECT_EQ(rows.back()["max_contour_error_um"], c["rows"][0]["tuned"]["max_contour_error_um"]);
}

TEST(Tune, SaysNoWhenNoGainsMeetTheLimits) {
  const Folder f;
  const Said said = command(quick({"--input-variation", "1 uV", "-o", f / "tuned", "--json", f / "t.json"}));
  EXPECT_EQ(said.code, 1);
  EXPECT_THAT(said.err, HasSubstr("stribeck: controller (f): none found in "));
  EXPECT_THAT(said.err, HasSubstr("a mean |Δu| of "));
  EXPECT_THAT(said.err, HasSubstr(" mV at 9.5 mm/s, where at most"));
  EXPECT_THAT(
      said.err,
      HasSubstr(
          "where at most 0.001000 mV less 0.5 % for other noise are allowed (raise --input-variation)"));
  EXPECT_THAT(
      said.err,
      HasSubstr("the search stopped at its limit of 12 evaluations: first try a larger --evaluations"));
  EXPECT_THAT(said.out, HasSubstr("50.8 → –"));
  EXPECT_FALSE(nlohmann::json::parse(text_of(f / "t.json"))["controllers"][0]["missed"].is_null());
  EXPECT_FALSE(std::filesystem::exists(f / "tuned/f.toml"));
}

TEST(Tune, IdsStandInFull) {
  const Folder f;
  std::string text = text_of(std::string(STRIBECK_SOURCE_DIR) + "/controllers/contouring.toml");
  const auto at = text.find("id = ");
  ASSERT_NE(at, std::string::npos);
  text.replace(at, text.find('\n', at) - at, "id = \"abcdefghijklmnop\"");
  const auto label = text.find("label = ");
  text.replace(label, text.find('\n', label) - label, "label = \"" + std::string(60, 'x') + "\"");
  const Said said =
      command({"tune", kMachine, "--parameters", "thesis", "--speed", "9.5 mm/s", "--laps", "1", "--trials",
               "1", "--evaluations", "10", "--controller", f.write("long.toml", text)});
  EXPECT_THAT(said.out, HasSubstr("\nabcdefghijklmnop  xxxxxxx"));
  EXPECT_THAT(said.out, HasSubstr("x…"));
}

TEST(Tune, RefusesBadOptionsInOneLine) {
  const Folder f;
  const auto refused = [&](std::vector<std::string> more, const char* part) {
    const Said said = command(quick(std::move(more)));
    EXPECT_EQ(said.code, 2) << part;
    EXPECT_THAT(said.err, HasSubstr(part));
  };
  refused({"--input-variation", "3 mm"}, "--input-variation");
  refused({"--phase-margin", "120"}, "--phase-margin: got \"120\", expected a number from 1 to 90");
  refused({"--gain-margin", "nan"}, "--gain-margin: got \"nan\", expected a number from 0.1 to 40");
  refused({"--delay-margin"}, "--delay-margin: got nothing, expected a value (stribeck tune --help");
  refused({"--laps", "0.1"}, "--laps");
  refused({"--controller", "nobody"},
          "got \"nobody\", expected a file, one of the experiment's a, b, c, d, e and f, or");
  refused({"--controller", "f"}, "there is a controller with the id");
  refused({"--controller", "e", "-o", f / "one.toml"}, "expected a folder");
  refused({"--experiment", "bi-circle"}, "--experiment");
}

}  // namespace
}  // namespace stribeck::test::tune_test
