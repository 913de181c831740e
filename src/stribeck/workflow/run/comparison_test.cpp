#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stribeck/io/error.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <stribeck/workflow/run/comparison.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow::comparison_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

std::vector<std::string> ids_of(const ComparisonOptions& options) {
  std::vector<std::string> ids;
  for (const sim::ControllerSpec& c :
       plan_comparison(options, read_virtual_machine(options.machine)).spec.controllers)
    ids.push_back(c.id);
  return ids;
}

// A controller that was added is wanted.
TEST(Comparison, OnlyChoosesAmongTheControllersOfTheExperiment) {
  ComparisonOptions o;
  o.machine = std::string(STRIBECK_SOURCE_DIR) + "/machines/biaxial-table.toml";
  o.only = {"f", "a"};
  EXPECT_THAT(ids_of(o), ElementsAre("a", "f"));
  o.controllers = {"cascade", "pid"};
  EXPECT_THAT(ids_of(o), ElementsAre("a", "f", "cascade", "pid"));
  o.only = {"pid"};
  EXPECT_THAT(ids_of(o), ElementsAre("cascade", "pid"));
  o.only = {"q"};
  EXPECT_THAT([&] { ids_of(o); },
              ThrowsMessage<io::InputError>(HasSubstr("got \"q\", expected one of a, b")));
}

}  // namespace
}  // namespace stribeck::workflow::comparison_test
