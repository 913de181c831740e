// Canonical calls of LinuxCNC's interpreter, as it prints them (LinuxCNC 2.9), and written by hand.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <stribeck/io/error.hpp>
#include <stribeck/io/gcode/canonical.hpp>

namespace stribeck::io::canonical_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// Calls one a line, numbered as the interpreter does.
CanonicalReader reader_of(const std::string& calls) {
  CanonicalReader reader("part.ngc");
  std::istringstream in(calls);
  std::string call;
  for (int i = 1; std::getline(in, call); ++i) reader.line("    " + std::to_string(i) + " N..... " + call);
  return reader;
}
std::vector<CanonicalMove> moves_of(const std::string& calls) { return reader_of(calls).moves(); }

std::string refusal(const std::string& calls) {
  try {
    static_cast<void>(moves_of(calls));
  } catch (const InputError& e) {
    EXPECT_EQ(e.problems().size(), 1U);
    return e.problems().front().text();
  }
  ADD_FAILURE() << "accepted: " << calls;
  return {};
}

void expect_near(const std::array<double, 3>& got, const std::array<double, 3>& expected) {
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(got[i], expected[i], 1e-15) << "axis " << i;
}

TEST(Canonical, LinesRapidsAndFeeds) {
  const auto m = moves_of(
      "USE_LENGTH_UNITS(CANON_UNITS_MM)\n"
      "STRAIGHT_TRAVERSE(1.0000, -2.5000, 3.0000, 0.0000, 0.0000, 0.0000)\n"
      "SET_FEED_RATE(600.0000)\n"
      "STRAIGHT_FEED(0.0001, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n");
  ASSERT_EQ(m.size(), 2U);
  expect_near(m[0].to, {1e-3, -2.5e-3, 3e-3});
  EXPECT_TRUE(std::isinf(m[0].feed));
  expect_near(m[1].to, {1e-7, 0.0, 0.0});
  EXPECT_DOUBLE_EQ(m[1].feed, 10e-3);
  EXPECT_FALSE(m[1].arc);
}

TEST(Canonical, InchesAndBack) {
  const auto r = reader_of(
      "USE_LENGTH_UNITS(CANON_UNITS_INCHES)\n"
      "SET_FEED_RATE(10.0000)\n"
      "STRAIGHT_FEED(1.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n"
      "SET_MOTION_CONTROL_MODE(CANON_CONTINUOUS, 0.001000)\n"
      "USE_LENGTH_UNITS(CANON_UNITS_MM)\n"
      "STRAIGHT_FEED(1.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n");
  EXPECT_TRUE(r.inches());
  ASSERT_EQ(r.moves().size(), 2U);
  EXPECT_NEAR(r.moves()[0].to[0], 25.4e-3, 1e-15);
  EXPECT_NEAR(r.moves()[0].feed, 254e-3 / 60.0, 1e-15);
  EXPECT_NEAR(r.moves()[1].to[0], 1e-3, 1e-15);
  // Feed and tolerance were set in inches and stay what they were.
  EXPECT_NEAR(r.moves()[1].feed, 254e-3 / 60.0, 1e-15);
  EXPECT_NEAR(r.moves()[1].tolerance.value(), 25.4e-6, 1e-15);
}

TEST(Canonical, FeedUsedUnderAnotherUnitThanItWasSetIn) {
  const std::string move = "STRAIGHT_FEED(1.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n";
  const std::string inches = "USE_LENGTH_UNITS(CANON_UNITS_INCHES)\n";
  // G20 F10 in one line, as rs274 prints it; the first one counts.
  const auto r = reader_of("SET_FEED_RATE(10.0000)\n" + inches + move + "SET_FEED_RATE(20.0000)\n" +
                           "USE_LENGTH_UNITS(CANON_UNITS_MM)\n" + move);
  ASSERT_TRUE(r.foreign_feed());
  EXPECT_DOUBLE_EQ(r.foreign_feed()->feed, 10e-3 / 60.0);
  EXPECT_FALSE(r.foreign_feed()->in_inches);
  const auto back = reader_of(inches + "SET_FEED_RATE(20.0000)\nUSE_LENGTH_UNITS(CANON_UNITS_MM)\n" + move);
  ASSERT_TRUE(back.foreign_feed());
  EXPECT_DOUBLE_EQ(back.foreign_feed()->feed, 20 * 25.4e-3 / 60.0);
  EXPECT_TRUE(back.foreign_feed()->in_inches);
  // Rapids have no feed; one that is given again is in the unit in force.
  const std::string rapid = "STRAIGHT_TRAVERSE(1.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n";
  EXPECT_FALSE(reader_of("SET_FEED_RATE(10.0000)\n" + inches + rapid + "SET_FEED_RATE(1.0000)\n" + move)
                   .foreign_feed());
}

TEST(Canonical, ArcsInThreePlanes) {
  // Each from (8, 25, 10) about a centre 5 mm along the first axis of the plane: half a turn.
  const std::string start =
      "SET_FEED_RATE(60.0000)\nSTRAIGHT_FEED(8.0000, 25.0000, 10.0000, 0.0000, 0.0000, 0.0000)\n";
  const auto xy = moves_of(
      start +
      "SELECT_PLANE(CANON_PLANE_XY)\nARC_FEED(18.0000, 25.0000, 13.0000, 25.0000, 1, 12.0000, 0.0000, "
      "0.0000, 0.0000)\n")[1];
  expect_near(xy.to, {18e-3, 25e-3, 12e-3});
  EXPECT_NEAR(xy.centre[0], 13e-3, 1e-15);
  EXPECT_NEAR(xy.centre[1], 25e-3, 1e-15);
  expect_near(xy.normal, {0.0, 0.0, 1.0});
  EXPECT_EQ(xy.turns, 1);
  // As rs274 prints G18 G2 X25 Z8 I5 K0: z before x.
  const auto xz = moves_of(
      start +
      "SELECT_PLANE(CANON_PLANE_XZ)\nARC_FEED(20.0000, 8.0000, 15.0000, 8.0000, -3, 26.0000, 0.0000, "
      "0.0000, 0.0000)\n")[1];
  expect_near(xz.to, {8e-3, 26e-3, 20e-3});
  EXPECT_NEAR(xz.centre[0], 8e-3, 1e-15);
  EXPECT_NEAR(xz.centre[2], 15e-3, 1e-15);
  expect_near(xz.normal, {0.0, 1.0, 0.0});
  EXPECT_EQ(xz.turns, -3);
  const auto yz = moves_of(
      start +
      "SELECT_PLANE(CANON_PLANE_YZ)\nARC_FEED(35.0000, 10.0000, 30.0000, 10.0000, 1, 8.0000, 0.0000, "
      "0.0000, 0.0000)\n")[1];
  expect_near(yz.to, {8e-3, 35e-3, 10e-3});
  expect_near(yz.normal, {1.0, 0.0, 0.0});
}

TEST(Canonical, OnceAroundUnderAnotherFrameOrUnitEndsWhereItBegan) {
  // (10, 0) is called (8.6603, -5) once the coordinates are turned by 30 degrees: rounded, 0.04 um beside it.
  const auto turned = moves_of(
      "USE_LENGTH_UNITS(CANON_UNITS_MM)\nSET_FEED_RATE(300.0000)\n"
      "STRAIGHT_FEED(10.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n"
      "SET_XY_ROTATION(30.0000)\n"
      "ARC_FEED(8.6603, -5.0000, 0.0000, 0.0000, 1, 2.0000, 0.0000, 0.0000, 0.0000)\n");
  ASSERT_EQ(turned.size(), 2U);
  EXPECT_EQ(turned[1].to[0], turned[0].to[0]);
  EXPECT_EQ(turned[1].to[1], turned[0].to[1]);
  EXPECT_NEAR(turned[1].to[2], 2e-3, 1e-15);
  const auto inches = moves_of(
      "USE_LENGTH_UNITS(CANON_UNITS_MM)\nSET_FEED_RATE(300.0000)\n"
      "STRAIGHT_FEED(10.0000, 3.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n"
      "USE_LENGTH_UNITS(CANON_UNITS_INCHES)\n"
      "ARC_FEED(0.3937, 0.1181, 0.0000, 0.1181, -1, 0.0000, 0.0000, 0.0000, 0.0000)\n");
  EXPECT_EQ(inches[1].to, inches[0].to);
  // In the frame of its start, an end one digit further on is an arc of that length.
  const auto tiny = moves_of(
      "USE_LENGTH_UNITS(CANON_UNITS_MM)\nSET_FEED_RATE(300.0000)\n"
      "STRAIGHT_FEED(10.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n"
      "ARC_FEED(10.0000, 0.0001, 0.0000, 0.0000, 1, 0.0000, 0.0000, 0.0000, 0.0000)\n");
  EXPECT_NEAR(tiny[1].to[1], 1e-7, 1e-18);
}

TEST(Canonical, OffsetsAndRotationInTheirOrder) {
  // G92 first, then the rotation about z, then G54 and the tool.
  const auto m = moves_of(
      "SET_G92_OFFSET(-4.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n"
      "SET_G5X_OFFSET(1, 3.0000, 1.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n"
      "SET_XY_ROTATION(90.0000)\n"
      "USE_TOOL_LENGTH_OFFSET(0.0000 0.0000 2.0000, 0.0000 0.0000 0.0000, 0.0000 0.0000 0.0000)\n"
      "SET_FEED_RATE(60.0000)\n"
      "STRAIGHT_FEED(5.0000, 2.0000, -2.0000, 0.0000, 0.0000, 0.0000)\n"
      "ARC_FEED(5.0000, 4.0000, 5.0000, 3.0000, 1, -2.0000, 0.0000, 0.0000, 0.0000)\n");
  expect_near(m[0].to, {(3.0 - 2.0) * 1e-3, (1.0 + 1.0) * 1e-3, 0.0});
  expect_near(m[1].to, {(3.0 - 4.0) * 1e-3, 2e-3, 0.0});
  expect_near(m[1].centre, {0.0, 2e-3, 0.0});
  expect_near(m[1].normal, {0.0, 0.0, 1.0});
}

TEST(Canonical, StopsDwellsAndTolerances) {
  const std::string move = "STRAIGHT_FEED(1.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n";
  const auto m = moves_of(
      "SET_FEED_RATE(60.0000)\n" + move + "SET_MOTION_CONTROL_MODE(CANON_CONTINUOUS, 0.020000)\n" + move +
      "DWELL(0.5000)\nDWELL(0.2500)\nSET_MOTION_CONTROL_MODE(CANON_EXACT_PATH)\n" + move +
      "SET_MOTION_CONTROL_MODE(CANON_EXACT_STOP)\n" + move +
      "SET_MOTION_CONTROL_MODE(CANON_CONTINUOUS, 0.000000)\n" + move + "START_SPINDLE_CLOCKWISE(0)\n" + move +
      "SPINDLE.0.WAIT_ORIENT_COMPLETE(1.0000)\n" + move + "COMMENT(\"DWELL(9)\")\n");
  ASSERT_EQ(m.size(), 7U);
  EXPECT_FALSE(m[0].tolerance);
  EXPECT_EQ(m[0].control, PathControl::kContinuous);
  EXPECT_NEAR(m[1].tolerance.value(), 20e-6, 1e-18);
  EXPECT_TRUE(m[1].waits);
  EXPECT_DOUBLE_EQ(m[1].dwell, 0.75);
  EXPECT_EQ(m[2].control, PathControl::kExactPath);
  EXPECT_EQ(m[3].control, PathControl::kExactStop);
  EXPECT_EQ(m[4].control, PathControl::kContinuous);
  EXPECT_FALSE(m[4].tolerance);
  EXPECT_TRUE(m[4].waits);
  EXPECT_EQ(m[4].dwell, 0.0);
  EXPECT_TRUE(m[5].waits);
  EXPECT_FALSE(m[6].waits);
}

TEST(Canonical, OtherLinesAreWhatTheProgramPrints) {
  CanonicalReader r("part.ngc");
  for (const char* line : {"hello", "", "STRAIGHT_FEED(1, 2, 3, 0, 0, 0)", "   12 ", "12 N..... no call",
                           "3 N..... ()", "x 0.5 (mm)"})
    r.line(line);
  EXPECT_TRUE(r.moves().empty());
  r.line("123456 N20 MESSAGE(\"a (b) \"c\")");
  r.line("   44 N100 PROGRAM_END()");
  EXPECT_TRUE(r.moves().empty());
}

TEST(Canonical, SaysWhatIsWrongAndWhere) {
  const std::string feed = "SET_FEED_RATE(60.0000)\n";
  EXPECT_THAT(refusal(feed + "STRAIGHT_FEED(1.0000, 0.0000, 0.0000, 3.0000, 0.0000, 0.0000)\n"),
              AllOf(HasSubstr("part.ngc: move 1 (STRAIGHT_FEED)"), HasSubstr("rotary")));
  EXPECT_THAT(refusal("STRAIGHT_FEED(1.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n"), HasSubstr("feed"));
  EXPECT_THAT(refusal("STRAIGHT_TRAVERSE(1.0000, 0.0000)\n"), HasSubstr("6 numbers"));
  EXPECT_THAT(refusal("STRAIGHT_TRAVERSE(1.0000, nan, 0.0000, 0.0000, 0.0000, 0.0000)\n"),
              HasSubstr("finite"));
  EXPECT_THAT(refusal("STRAIGHT_TRAVERSE(1.0000, x, 0.0000, 0.0000, 0.0000, 0.0000)\n"), HasSubstr("finite"));
  EXPECT_THAT(refusal("STRAIGHT_TRAVERSE(1e999, 0, 0.0000, 0.0000, 0.0000, 0.0000)\n"), HasSubstr("finite"));
  // Finite, but what is computed from it would not be.
  EXPECT_THAT(refusal("SET_XY_ROTATION(-1e308)\n"), HasSubstr("up to 1e9"));
  EXPECT_THAT(refusal("STRAIGHT_TRAVERSE(1.1e9, 0, 0.0000, 0.0000, 0.0000, 0.0000)\n"),
              HasSubstr("up to 1e9"));
  EXPECT_THAT(refusal(feed + "ARC_FEED(1.0000, 0.0000, 0.0000, 0.0000, 0, 0.0000, 0.0000, 0.0000, 0.0000)\n"),
              HasSubstr("turns"));
  EXPECT_THAT(refusal("NURBS_FEED(4, ...)\n"), AllOf(HasSubstr("NURBS_FEED"), HasSubstr("not supported")));
  EXPECT_THAT(refusal("START_SPEED_FEED_SYNC(1.000000,0)\n"), HasSubstr("not supported"));
  EXPECT_THAT(refusal("STRAIGHT_PROBE(1.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n"),
              HasSubstr("not supported"));
  EXPECT_THAT(refusal("SELECT_PLANE(CANON_PLANE_UV)\n"), HasSubstr("XY"));
  EXPECT_THAT(refusal("USE_LENGTH_UNITS(UNKNOWN)\n"), HasSubstr("inches"));
  EXPECT_THAT(refusal("DWELL(-1.0000)\n"), HasSubstr("negative"));
  EXPECT_THAT(refusal("SET_FEED_MODE(0, 1)\n" + feed +
                      "STRAIGHT_FEED(1.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n"),
              HasSubstr("G95"));
  EXPECT_THAT(refusal("SET_G5X_OFFSET(1, 0.0000, 0.0000, 0.0000, 4.0000, 0.0000, 0.0000)\n"),
              HasSubstr("rotary"));
}

}  // namespace
}  // namespace stribeck::io::canonical_test
