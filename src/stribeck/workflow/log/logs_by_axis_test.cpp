#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stribeck/io/error.hpp>
#include <stribeck/io/test_folder.hpp>
#include <stribeck/workflow/log/logs_by_axis.hpp>
#include <string>
#include <vector>

namespace stribeck::test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

sim::Machine two_axes() {
  sim::Machine m;
  m.name = "table";
  m.axes.resize(2);
  m.axes[0].first = "x";
  m.axes[1].first = "y";
  return m;
}

std::string rows(const std::string& header, int columns) {
  std::string text = header + "\n";
  for (int k = 0; k < 20; ++k) {
    text += std::to_string(0.001 * k);
    for (int c = 1; c < columns; ++c) text += "," + std::to_string(0.1 * k * c);
    text += "\n";
  }
  return text;
}
const std::string kPlain = rows("t [s],x [mm],f [N]", 3);

TEST(LogsByAxis, FindsTheAxisByWhatALogSaysItsColumnsOrItsName) {
  const Folder folder;
  const std::string said = folder.write("a.csv", "# axis: y\n" + kPlain);
  const std::string both = folder.write("b.csv", rows("t [s],x_x [mm],f_x [N],x_y [mm],f_y [N]", 5));
  const std::string one = folder.write("c.csv", rows("t [s],x_y [mm],f_y [N]", 3));
  const std::string named = folder.write("sine-X-log.csv", kPlain);
  const auto all = workflow::logs_by_axis(two_axes(), {said, both, one, named}, {});
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].axis, "x");
  EXPECT_EQ(all[0].options.axis, "x");
  EXPECT_THAT(all[1].logs, ElementsAre(said, both, one));
  EXPECT_THAT(all[0].logs, ElementsAre(both, named));
  workflow::LogOptions only_y;
  only_y.axis = "y";
  EXPECT_EQ(workflow::logs_by_axis(two_axes(), {said, named}, only_y).size(), 1u);
}

TEST(LogsByAxis, RefusesALogThatCouldBeOfAnyAxis) {
  const Folder folder;
  const std::string log = folder.write("log.csv", kPlain);
  try {
    workflow::logs_by_axis(two_axes(), {log}, {});
    FAIL() << "accepted";
  } catch (const io::InputError& e) {
    EXPECT_THAT(e.problems().front().text(),
                AllOf(HasSubstr("log.csv"), HasSubstr("# axis: x"), HasSubstr("--axis")));
  }
  // A machine of one axis has no other.
  sim::Machine single = two_axes();
  single.axes.resize(1);
  EXPECT_THAT(workflow::logs_by_axis(single, {log}, {}).front().logs, ElementsAre(log));
}

}  // namespace
}  // namespace stribeck::test
