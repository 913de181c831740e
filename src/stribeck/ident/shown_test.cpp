#include <gtest/gtest.h>

#include <stribeck/ident/shown.hpp>

namespace stribeck::ident::shown_test {
namespace {

TEST(Shown, MillimetresAndSmallLengths) {
  const Shown s("m", "N", false);
  EXPECT_EQ(s.length(0.0), "0 mm");
  EXPECT_EQ(s.length(0.0123), "12.3 mm");
  EXPECT_EQ(s.length(0.3456), "345.6 mm");
  EXPECT_EQ(s.length(1.2345), "1234 mm");
  EXPECT_EQ(s.velocity(-0.0), "+0 mm/s");
  EXPECT_EQ(s.length(-4.56e-6), "-4.56 um");
  EXPECT_EQ(s.speed(0.1234), "123 mm/s");
  EXPECT_EQ(s.velocity(0.01), "+10 mm/s");
  EXPECT_EQ(s.force(12.34), "12.3 N");
  EXPECT_EQ(s.force_per_length(5e3), "5 N/mm");
  EXPECT_EQ(s.force(12345.6), "12346 N");
  EXPECT_EQ(s.force(-999.7), "-1000 N");
  EXPECT_EQ(s.velocity(1.5), "+1500 mm/s");
  EXPECT_EQ(s.force_per_length(50e6), "50000 N/mm");
}

TEST(Shown, DegreesOfARotaryAxis) {
  const Shown s("m", "N", true);
  EXPECT_EQ(s.length(0.5), "28.6 deg");
  EXPECT_EQ(s.length(1e-6), "5.73e-05 deg");
  EXPECT_EQ(s.velocity(-0.5), "-28.6 deg/s");
  EXPECT_EQ(s.force(3.0), "3 N m");
  EXPECT_EQ(s.force_per_length(100.0), "1.75 N m/deg");
}

TEST(Shown, OtherUnitsStay) {
  const Shown s("rad", "V", false);
  EXPECT_EQ(s.length(1e-6), "1e-06 rad");
  EXPECT_EQ(s.speed(2.0), "2 rad/s");
  EXPECT_EQ(s.force(2.0), "2 V");
  EXPECT_EQ(Shown("m", "V", true).force(2.0), "2 V");
}

}  // namespace
}  // namespace stribeck::ident::shown_test
