/// What verbs write beside their result: figures, tables, traces, and where a result comes from.

#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/sha256.hpp>
#include <tests/cli/command.hpp>

namespace stribeck::test::outputs_test {
namespace {

using ::testing::HasSubstr;

TEST(Outputs, TracesOfEveryTrialAreThoseOfSingleRuns) {
  const Folder folder;
  const Said said = command({"compare", kMachine, "--only", "e,f", "--trials", "2", "--speed", "9.5 mm/s",
                             "--parameters", "thesis", "--traces", folder / "traces", "--quiet"});
  ASSERT_EQ(said.code, 0) << said.err;
  std::size_t files = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder / "traces"))
    files += file.is_regular_file() ? 1 : 0;
  EXPECT_EQ(files, 4u);
  const auto rows = [](const std::string& path) {
    const std::string text = text_of(path);
    return text.substr(text.find("\nt [s]"));
  };
  const std::string single = folder / "one.csv";
  ASSERT_EQ(command({"simulate", kMachine, "--controller", "f", "--parameters", "thesis", "--trial", "1",
                     "-o", single, "--quiet"})
                .code,
            0);
  EXPECT_EQ(rows(folder / "traces/1-f-trial-001.csv"), rows(single));
  EXPECT_NE(rows(folder / "traces/1-f-trial-000.csv"), rows(single));
}

TEST(Outputs, AResultSaysWhatItWasMadeFrom) {
  const Folder folder;
  const std::string log = folder / "log.csv";
  ASSERT_EQ(
      command({"simulate", kMachine, "--controller", "f", "--parameters", "thesis", "-o", log, "--report",
               folder / "page", "--plots", folder / "plots", "--json", folder / "one.json", "--quiet"})
          .code,
      0);
  const auto made = nlohmann::json::parse(text_of(folder / "one.json"))["made"];
  EXPECT_THAT(made["command"].get<std::string>(), HasSubstr("simulate"));
  EXPECT_EQ(made["inputs"][0]["file"], kMachine);
  EXPECT_EQ(made["inputs"][0]["sha256"], io::sha256_of_file(kMachine));
  EXPECT_THAT(text_of(folder / "page/index.html"), HasSubstr(io::sha256_of_file(kMachine)));
  bool svg = false;
  for (const auto& file : std::filesystem::directory_iterator(folder / "plots"))
    svg = svg || file.path().extension() == ".svg";
  EXPECT_TRUE(svg);
}

TEST(Outputs, PlotsThatCannotBeWrittenAreRefusedBeforeTheWork) {
  const Folder folder;
  io::write_atomically(folder / "taken", "a file");
  const Said said = command({"simulate", kMachine, "-o", folder / "log.csv", "--plots", folder / "taken"});
  EXPECT_EQ(said.code, 2);
  EXPECT_THAT(said.err, HasSubstr("taken"));
  EXPECT_FALSE(std::filesystem::exists(folder / "log.csv"));
}

TEST(Outputs, LimitsOfACircleDecideTheExitCode) {
  const Folder folder;
  const std::string log = folder / "circle.csv";
  ASSERT_EQ(
      command({"simulate", kMachine, "--controller", "f", "--parameters", "thesis", "-o", log, "--quiet"})
          .code,
      0);
  EXPECT_EQ(command({"evaluate", log, "--limit", "G=1 mm", "--limit", "max=1 mm"}).code, 0);
  const Said failed = command({"evaluate", log, "--limit", "G=1nm", "--json", folder / "e.json"});
  EXPECT_EQ(failed.code, 1);
  EXPECT_THAT(failed.out, HasSubstr("FAILED: circle G of "));
  EXPECT_EQ(nlohmann::json::parse(text_of(folder / "e.json"))["limits"][0]["passed"], false);
  const Said unknown = command({"evaluate", log, "--limit", "Q=1um"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("got \"Q\", expected one of max, RMS, glitch, G, G(b), F, D and H"));
  EXPECT_THAT(command({"evaluate", log, "--limit", "G=5 N"}).err, HasSubstr("--limit"));
}

}  // namespace
}  // namespace stribeck::test::outputs_test
