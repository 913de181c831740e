#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "command.hpp"

namespace stribeck::test::reproduce_robustness_test {
namespace {

TEST(ReproduceRobustness, ComparesControllerFilesWithTheReference) {
  const Folder f;
  const std::string file = f.write("slow.toml",
                                   "id = \"slow\"\nlabel = \"half the speed\"\nobserver = \"disturbance\"\n"
                                   "friction = \"gaussian\"\n[law]\nkind = \"contouring\"\n"
                                   "kp = [\"400 1/s2\"]\nkv = [\"40 1/s\"]\n");
  const Said said = command({"reproduce", "robustness", "--machines", "2", "--vary", "mass", "--controller",
                             file, "--json", f / "r.json", "--markdown", f / "r.md", "--quiet"});
  ASSERT_EQ(said.code, 0) << said.err;
  const std::string table = text_of(f / "r.md");
  EXPECT_NE(table.find("(f) observer + Gaussian model"), std::string::npos);
  EXPECT_NE(table.find("(slow) half the speed"), std::string::npos);
  EXPECT_EQ(table.find("(g)"), std::string::npos);
  EXPECT_NE(table.find("--controller " + file), std::string::npos);
}

TEST(ReproduceRobustness, RefusesInOneLine) {
  const auto refused = [](std::vector<std::string> words, const char* part) {
    words.insert(words.begin(), "reproduce");
    const Said said = command(words);
    EXPECT_EQ(said.code, 2) << part;
    EXPECT_NE(said.err.find(part), std::string::npos) << said.err;
    EXPECT_EQ(std::count(said.err.begin(), said.err.end(), '\n'), 1) << said.err;
  };
  refused({"robustness", "--machines", "0"},
          "--machines: got \"0\", expected a whole number from 1 to 100000");
  refused({"robustness", "--vary", "-1"}, "--vary: got \"-1\", expected one of all, friction");
  refused({"robustness", "--vary", "masses"}, "did you mean mass");
  refused({"robustness", "--controller", "nobody"}, "nobody");
  refused({"bi-circle", "--controller", "pid"}, "--controller: can be used with robustness only");
}

}  // namespace
}  // namespace stribeck::test::reproduce_robustness_test
