#include <gtest/gtest.h>

#include <cmath>

#include <stribeck/core/number_text.hpp>

namespace stribeck::number_text_test {
namespace {

TEST(NumberText, IsTheNumberWithWhichATextBegins) {
  EXPECT_EQ(number_in("2.5 mm"), 2.5);
  EXPECT_EQ(number_in(" \t+1e-3"), 1e-3);
  EXPECT_EQ(number_in("-7"), -7.0);
  EXPECT_EQ(number_in("2,5"), 2.0);
  EXPECT_TRUE(std::isinf(number_in("inf")));
}

TEST(NumberText, SaysHowMuchItRead) {
  EXPECT_EQ(number_at(" 12.5mm").length, 5U);
  EXPECT_EQ(number_at("mm").length, 0U);
}

TEST(NumberText, NoNumberIsNotANumber) {
  for (const char* text : {"", "  ", "mm", "+", "-", "1e999"})
    EXPECT_TRUE(std::isnan(number_in(text))) << text;
}

}  // namespace
}  // namespace stribeck::number_text_test
