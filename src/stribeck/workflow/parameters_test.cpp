#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stribeck/workflow/parameters.hpp>

namespace stribeck::workflow::parameters_test {
namespace {

TEST(Parameters, AnAxisWithoutItsKalmanObserverIsSaidOnce) {
  sim::CompareResult result;
  result.period = 4e-3;
  result.axes = {"y"};
  for (const std::size_t travel : {0, 1}) {
    sim::CompareRow row;
    row.controller.id = "h";
    row.controller.friction = sim::FrictionUse::kWhole;
    row.travel = travel;
    row.calmed = {0};
    result.rows.push_back(row);
  }
  Parameters parameters;
  parameters.knowledge.resize(1);
  parameters.knowledge[0].whole.emplace().delay = 8e-3;
  const auto said = check_coverage(result, {0}, parameters);
  ASSERT_THAT(said, testing::SizeIs(1));
  EXPECT_THAT(said[0], testing::HasSubstr("axis y: with a delay of 2 control periods"));
  EXPECT_THAT(said[0], testing::HasSubstr("so (h) has a disturbance observer there"));
  result.rows.clear();
  EXPECT_THAT(check_coverage(result, {0}, parameters), testing::IsEmpty());
}

}  // namespace
}  // namespace stribeck::workflow::parameters_test
