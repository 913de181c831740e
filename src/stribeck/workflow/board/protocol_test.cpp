#include <gtest/gtest.h>

#include <array>
#include <sstream>
#include <stdexcept>
#include <stribeck/workflow/board/protocol.hpp>

namespace stribeck::workflow::protocol_test {
namespace {

BoardSetup sample() {
  BoardSetup setup{0.005, {}};
  BoardAxis a{57.65e3, -1.0 / 3.0, 1e-3, 10480.0, 2.5e-8, 3e8, 6e5};
  a.speed = {-0.01, 0.1 + 0.2};
  a.friction = {-1234.5, 1.0 / 7.0};
  a.model_file = "/a folder/x.toml";
  setup.axes = {a, BoardAxis{}};
  return setup;
}

TEST(BoardProtocol, SetupReadsBackBitForBit) {
  const BoardSetup sent = sample();
  BoardSetup got;
  std::istringstream lines(setup_lines(sent));
  std::string line;
  while (std::getline(lines, line) && read_setup_line(line, got)) {
  }
  EXPECT_EQ(line, "start");
  EXPECT_EQ(got.period, sent.period);
  ASSERT_EQ(got.axes.size(), 2U);
  const BoardAxis& a = got.axes[0];
  const BoardAxis& b = sent.axes[0];
  EXPECT_EQ(a.mass, b.mass);
  EXPECT_EQ(a.load, b.load);
  EXPECT_EQ(a.delay, b.delay);
  EXPECT_EQ(a.force_limit, b.force_limit);
  EXPECT_EQ(a.resolution, b.resolution);
  EXPECT_EQ(a.stiffness, b.stiffness);
  EXPECT_EQ(a.damping, b.damping);
  EXPECT_EQ(a.speed, b.speed);
  EXPECT_EQ(a.friction, b.friction);
  EXPECT_EQ(a.model_file, b.model_file);
  EXPECT_TRUE(got.axes[1].speed.empty());
}

TEST(BoardProtocol, RefusesLinesOfAnotherKind) {
  for (const char* line : {"hello", "stribeck-board 2", "axes 7", "axes x", "axis 5 mass 1",
                           "axis 0 weight 1", "friction 0 2 1.0", "period nan"}) {
    BoardSetup setup;
    EXPECT_THROW(static_cast<void>(read_setup_line(line, setup)), std::runtime_error) << line;
  }
}

TEST(BoardProtocol, TakesAsManyFiniteNumbersAsAreWantedAndNothingElse) {
  std::array<double, 2> x{};
  EXPECT_TRUE(read_numbers(" +1.5e3\t-2 \r", x.data(), 2));
  EXPECT_EQ(x[0], 1500.0);
  EXPECT_EQ(x[1], -2.0);
  for (const char* line : {"", "1", "1 2 3", "1 nan", "inf 1", "1,5 2", "1 2x", "1 0x10", "1 1e999"})
    EXPECT_FALSE(read_numbers(line, x.data(), 2)) << line;
}

}  // namespace
}  // namespace stribeck::workflow::protocol_test
