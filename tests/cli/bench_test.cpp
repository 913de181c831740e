#include <gmock/gmock.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "command.hpp"

namespace stribeck::test::bench_test {
namespace {

using ::testing::HasSubstr;

const std::string kEntry = std::string(STRIBECK_SOURCE_DIR) + "/examples/board/coulomb-viscous.toml";

TEST(Bench, PrintsATableAndWritesJsonAndPage) {
  const Folder f;
  const Said said = command({"bench", kEntry, "--machines", "1", "--only", "least-squares,a,coulomb-viscous",
                             "--json", f / "b.json", "--report", f / "page", "-o", f / "kept"});
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out, HasSubstr("1 machine of two axes, drawn with seed 1."));
  EXPECT_THAT(said.out, HasSubstr("coulomb-viscous *"));
  EXPECT_THAT(said.out, HasSubstr("Control, circle of 10 mm at 9.5 mm/s"));
  const auto json = nlohmann::json::parse(text_of(f / "b.json"));
  EXPECT_EQ(json["schema"], "stribeck.bench/1");
  EXPECT_EQ(json["identification"].size(), 2U);
  EXPECT_EQ(json["identification"][0]["curve_error_percent"]["values"].size(), 2U);
  EXPECT_EQ(json["control"].size(), 2U);
  // What a reader of a submission asks: which command, which entry.
  EXPECT_THAT(json["made"]["command"].get<std::string>(), HasSubstr("bench"));
  EXPECT_EQ(json["made"]["inputs"].size(), 1U);
  EXPECT_THAT(text_of(f / "page/index.html"), HasSubstr("Identification"));
  EXPECT_TRUE(std::filesystem::exists(f / "kept/biaxial-table-1-x-pulses.csv"));
}

TEST(Bench, WritesLogsAndRunsNothing) {
  const Folder f;
  const Said said = command({"bench", "--write-logs", f / "logs", "--machines", "1"});
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out, HasSubstr("4 logs in "));
  EXPECT_THAT(text_of(f / "logs/biaxial-table-1-y-sine.csv"), HasSubstr("x [mm]"));
}

TEST(Bench, AnEntryWithoutAnyResultIsNoSuccess) {
  const Said said = command({"bench", "--machines", "1", "--no-built-in", "--identifier", "/bin/false"});
  EXPECT_EQ(said.code, 1) << said.err;
  EXPECT_THAT(said.out, HasSubstr("failed"));
}

TEST(Bench, RefusesInOneLine) {
  const Folder f;
  const auto refused = [](std::vector<std::string> words, const char* part) {
    words.insert(words.begin(), "bench");
    const Said said = command(words);
    EXPECT_EQ(said.code, 2) << said.out;
    EXPECT_EQ(std::count(said.err.begin(), said.err.end(), '\n'), 1) << said.err;
    EXPECT_THAT(said.err, testing::StartsWith("stribeck: "));
    EXPECT_THAT(said.err, HasSubstr(part));
  };
  refused({"none.toml"}, "none.toml");
  refused({"--only", "hh"}, "expected the name of an entry");
  refused({"--no-built-in"}, "no entry is left");
  refused({"--answers", f / "none"}, "there is no folder");
  refused({"--machines", "0"}, "--machines");
  refused({"--identifier", "fit 'a"}, "a quote is not closed");
}

}  // namespace
}  // namespace stribeck::test::bench_test
