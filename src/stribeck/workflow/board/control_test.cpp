#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <stribeck/workflow/board/control.hpp>
#include <stribeck/workflow/board/machines.hpp>
#include <string>

namespace stribeck::workflow::control_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Notes of (h) on the first machine of seed 1, whose model tells a delay of its second axis of so many periods.
std::vector<std::string> notes_with_delay(double periods) {
  const BoardMachine board = board_machines(1, 1).front();
  std::vector<sim::AxisKnowledge> knowledge(2);
  for (std::size_t i = 0; i < 2; ++i) {
    const plant::AxisParams& truth = board.machine.axes[i].second.plant;
    knowledge[i].whole = friction::AxisModel{truth.mass, truth.load, truth.friction};
  }
  knowledge[1].whole->delay = periods * board.machine.sample_time;
  BoardControl control(board, knowledge, {"", ""}, 1, 0);
  const std::vector<BoardController> all = built_in_contestants();
  const auto h =
      std::find_if(all.begin(), all.end(), [](const BoardController& c) { return c.spec.id == "h"; });
  const BoardRun run = control.run(*h, 0);
  EXPECT_EQ(run.failure, "");
  return run.notes;
}

// (h) of the board had a Kalman observer where (h) of compare had none.
TEST(BoardControl, ALateAxisHasTheObserverThatCompareGivesIt) {
  EXPECT_THAT(
      notes_with_delay(2.0),
      ElementsAre(HasSubstr("axis y: with a delay of 2 control periods a loop with a Kalman observer")));
  EXPECT_THAT(notes_with_delay(0.0), IsEmpty());
}

}  // namespace
}  // namespace stribeck::workflow::control_test
