#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <stribeck/io/test_folder.hpp>
#include <string>
#include <tests/cli/command.hpp>
#include <vector>

namespace stribeck::test::excite_plan_test {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;

void expect_refused(const Said& said, const std::string& what) {
  EXPECT_EQ(said.code, 2);
  EXPECT_THAT(said.err, HasSubstr(what));
}

std::vector<std::string> excite(std::initializer_list<std::string> more, const std::string& output) {
  std::vector<std::string> words{"excite", kMachine, "--axis", "x", "-o", output};
  words.insert(words.end(), more);
  return words;
}

TEST(ExcitePlan, WritesTheLogsThatTellWhatIsWanted) {
  const Folder folder;
  // Half a minute leaves pulses and constant acceleration.
  const Said out = command(excite(
      {"--for", "mass,bristles", "--minutes", "0.5", "--json", folder / "plan.json"}, folder / "logs"));
  EXPECT_EQ(out.code, 0) << out.err;
  EXPECT_THAT(out.out, HasSubstr("What a log of axis x is expected to tell"));
  EXPECT_THAT(out.out, ContainsRegex("Not jog: [0-9]+ s of motion, more than there is time for"));
  EXPECT_THAT(text_of(folder / "plan.json"), HasSubstr("\"schema\": \"stribeck.plan/1\""));
  std::size_t files = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder / "logs")) {
    ++files;
    EXPECT_THAT(text_of(file.path().string()), HasSubstr("start"));
  }
  EXPECT_GE(files, 1u);
}

TEST(ExcitePlan, IsProposedForWhatALogLeavesOpen) {
  const Folder folder;
  // One period of a sine: its force of inertia is small, and a spring would look the same.
  ASSERT_EQ(command({"excite", kMachine, "--axis", "x", "--method", "sine", "--strokes", "0", "--periods",
                     "1", "-o", folder / "r.csv", "--quiet"})
                .code,
            0);
  ASSERT_EQ(command({"simulate", kMachine, "--axis", "x", "--reference", folder / "r.csv", "-o",
                     folder / "log.csv", "--quiet"})
                .code,
            0);
  const Said found = command({"identify", kMachine, folder / "log.csv", "--axis", "x", "-o", folder / "axes",
                              "--json", folder / "i.json"});
  ASSERT_EQ(found.code, 0) << found.err;
  EXPECT_THAT(found.out, HasSubstr("plan the next log:\n  stribeck excite " + kMachine + " --axis x --for "));
  EXPECT_THAT(found.out, HasSubstr(" --known " + folder / "axes/x.toml"));
  EXPECT_THAT(text_of(folder / "i.json"), HasSubstr("\"not_yet\": [\n"));
}

// Open-loop pulses were written for an axis that falls, because the file of another axis knew no load.
TEST(ExcitePlan, AnAxisFileThatContradictsTheMachineMovesNothing) {
  const Folder folder;
  const std::string model =
      "mass = \"57000 kg\"\nload = \"{} N\"\n[friction.steady]\nkind = \"conventional\"\nalpha0 = \"1000 N\"\nalpha2 = \"0 N s/m\"\n";
  const auto known = [&](const std::string& axis, const std::string& load) {
    std::string text = "axis = \"" + axis + "\"\n" + model;
    text.replace(text.find("{}"), 2, load);
    const std::string file = folder.write(axis + load + ".toml", text);
    return command(excite({"--method", "pulses", "--known", file}, folder / "r.csv"));
  };
  expect_refused(known("y", "0"), "says that it is of axis y, expected the axis file of x");
  const Said heavy = known("x", "4000");
  EXPECT_EQ(heavy.code, 1);
  EXPECT_THAT(heavy.err, HasSubstr("without force the axis may fall"));
  EXPECT_EQ(known("x", "100").code, 0);
}

TEST(ExcitePlan, RefusesWhatItCannotPlan) {
  const Folder folder;
  const std::string out = folder / "logs";
  expect_refused(command(excite({}, out)),
                 "--method: expected either --method, or --for with what is wanted");
  expect_refused(command(excite({"--for", "mass", "--method", "sine"}, out)),
                 "--method: expected either --method, or --for");
  expect_refused(command(excite({"--for", "weight"}, out)), "--for: got \"weight\"");
  expect_refused(command(excite({"--for", "mass", "--periods", "4"}, out)),
                 "--periods: does not go with --for");
  expect_refused(command(excite({"--for", "mass", "--minutes", "0"}, out)), "--minutes: got \"0\"");
  expect_refused(command(excite({"--method", "sine", "--minutes", "3"}, out)), "--minutes: goes with --for");
  expect_refused(command(excite({"--for", "mass", "--plots", folder / "figures"}, out)),
                 "--plots: does not go with --for");
  const Said none = command(excite({"--for", "mass", "--minutes", "0.1"}, out));
  EXPECT_NE(none.code, 0);
  EXPECT_THAT(none.err, HasSubstr("no excitation fits"));
  EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace
}  // namespace stribeck::test::excite_plan_test
