#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <stribeck/io/test_folder.hpp>
#include <stribeck/workflow/commissioning/stage_folder.hpp>

namespace stribeck::workflow::commissioning::stage_folder_test {
namespace {

const std::vector<std::string> kThree{"one", "two", "three"};

TEST(StageFolder, OnlyACompleteStageIsDone) {
  const test::Folder folder;
  StageFolder stages(folder / "out", kThree, "inputs");
  EXPECT_EQ(stages.missing_before("two"), "one");
  stages.begin("one");
  EXPECT_FALSE(stages.done("one"));
  stages.finish("one", {{"a", 1}});
  ASSERT_TRUE(stages.done("one"));
  EXPECT_EQ(stages.result("one")->at("a"), 1);
  EXPECT_EQ(stages.missing_before("two"), "");
  EXPECT_FALSE(std::filesystem::exists(folder / "out/.one"));
}

TEST(StageFolder, AStageThatIsRepeatedTakesThoseBehindItAlong) {
  const test::Folder folder;
  StageFolder stages(folder / "out", kThree, "inputs");
  for (const std::string& stage : kThree) {
    stages.begin(stage);
    stages.finish(stage, {{"run", 1}});
  }
  EXPECT_TRUE(stages.done("three"));
  stages.begin("two");
  stages.finish("two", {{"run", 2}});
  EXPECT_TRUE(stages.done("two"));
  EXPECT_FALSE(stages.done("three"));
}

TEST(StageFolder, OtherInputsBeginAgain) {
  const test::Folder folder;
  StageFolder stages(folder / "out", kThree, "inputs");
  stages.begin("one");
  stages.finish("one", {});
  EXPECT_TRUE(StageFolder(folder / "out", kThree, "inputs").done("one"));
  EXPECT_FALSE(StageFolder(folder / "out", kThree, "other inputs").done("one"));
}

}  // namespace
}  // namespace stribeck::workflow::commissioning::stage_folder_test
