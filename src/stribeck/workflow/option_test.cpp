#include <gtest/gtest.h>

#include <stribeck/workflow/option.hpp>

namespace stribeck::workflow::option_test {
namespace {

// Data sheets of screws say so; it was "another kind of quantity".
TEST(Option, TheTravelOfATurnMaySayThatItIs) {
  EXPECT_EQ(of_one_turn("5 mm/rev"), "5 mm");
  EXPECT_EQ(of_one_turn("0.2 in / turn"), "0.2 in");
  EXPECT_EQ(of_one_turn("10 mm/U"), "10 mm");
  EXPECT_EQ(of_one_turn("5 mm"), "5 mm");
  EXPECT_EQ(of_one_turn("5 mm/s"), "5 mm/s");
}

}  // namespace
}  // namespace stribeck::workflow::option_test
