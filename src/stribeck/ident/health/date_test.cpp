#include <gtest/gtest.h>

#include <stribeck/ident/health/date.hpp>

namespace stribeck::ident::health::date_test {
namespace {

// date -d "2026-11-23 UTC" +%s divided by 86400.
TEST(HealthDate, CountsDays) {
  EXPECT_EQ(day_of("1970-01-01"), 0.0);
  EXPECT_EQ(day_of("2026-11-23"), 20780.0);
  EXPECT_EQ(*day_of("2024-03-01") - *day_of("2024-02-28"), 2.0) << "a leap year";
}

TEST(HealthDate, ComesBack) {
  for (const char* date : {"1999-12-31", "2024-02-29", "2026-11-23"})
    EXPECT_EQ(date_of(*day_of(date) + 0.5), date);
}

TEST(HealthDate, TakesNothingElse) {
  for (const char* text :
       {"", "2026-11-31", "2026-13-01", "26-11-23", "2026/11/23", "2026-11-2x", "-026-11-23", "2026-1-023"})
    EXPECT_FALSE(day_of(text)) << text;
}

}  // namespace
}  // namespace stribeck::ident::health::date_test
