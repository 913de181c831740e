#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stribeck/io/error.hpp>
#include <stribeck/io/test_folder.hpp>
#include <stribeck/workflow/built_in.hpp>
#include <stribeck/workflow/path/point_path.hpp>
#include <string>

namespace stribeck::test::point_path_test {
namespace {

using ::testing::HasSubstr;
using workflow::PathOptions;
using workflow::PointJoin;

constexpr double kSpeed = 2e-3;  // [m/s]

sim::CompareSpec planned(const PathOptions& options) {
  sim::CompareSpec spec;
  workflow::use_points(spec, options, {kSpeed}, workflow::built_in_machine("biaxial-table"));
  return spec;
}

std::string refusal(const PathOptions& options) {
  try {
    static_cast<void>(planned(options));
  } catch (const io::InputError& e) {
    return e.problems().front().text();
  }
  return "accepted";
}

/// A copy, which outlives the experiment.
sim::Part<2> part_of(const sim::CompareSpec& spec) {
  return *std::get<sim::PartPath<2>>(spec.travels.at(0).path).part;
}

TEST(PointPath, CornersAreRoundedWithinTheTolerance) {
  const Folder folder;
  PathOptions o;
  o.path = folder.write("square.csv", "x [mm],y [mm]\n0,0\n10,0\n10,10\n0,10\n0,0\n");
  o.corner_tolerance = "20 um";
  const sim::CompareSpec spec = planned(o);
  const sim::PartSummary& s = part_of(spec).summary;
  EXPECT_EQ(s.corners, 3U);
  EXPECT_EQ(s.stops, 0U);
  EXPECT_LE(s.deviation, 20e-6 * (1.0 + 1e-9));
  EXPECT_GT(s.deviation, 19e-6);
  // Corners cut a little off the 40 mm.
  EXPECT_LT(s.length, 40e-3);
  EXPECT_GT(s.length, 39.5e-3);
  EXPECT_EQ(spec.travels.front().name, "square.csv at 2 mm/s");
  EXPECT_THAT(spec.travels.front().note, HasSubstr("closed"));
}

TEST(PointPath, SplineThroughACircleIsTheCircle) {
  const Folder folder;
  std::string points = "x [mm],y [mm]\n";
  constexpr int kPoints = 72;
  for (int k = 0; k <= kPoints; ++k) {
    const double phi = 2.0 * std::numbers::pi * (k % kPoints) / kPoints;
    points += std::to_string(10.0 * std::cos(phi)) + "," + std::to_string(10.0 * std::sin(phi)) + "\n";
  }
  PathOptions o;
  o.path = folder.write("circle.csv", points);
  o.join = PointJoin::kSpline;
  o.corner_tolerance = "10 nm";
  const sim::CompareSpec spec = planned(o);
  const sim::Part<2>& part = part_of(spec);
  EXPECT_EQ(part.summary.corners, 0U);
  EXPECT_NEAR(part.summary.length, 20e-3 * std::numbers::pi, 1e-7);
  // Between the points a quintic spline of 5 degrees is off the circle by less than the tolerance as well.
  double farthest = 0.0;
  for (int k = 0; k <= 1000; ++k) {
    const Vec<double, 2> q = part.path.point(part.path.period() * k / 1000.0);
    farthest = std::max(farthest, std::abs(norm(q) - 10e-3));
  }
  EXPECT_LT(farthest, 20e-9);
  // At 2 mm/s nothing limits it: the time is that of the length and one ramp at either end.
  EXPECT_GT(part.summary.duration, part.summary.length / kSpeed);
  EXPECT_LT(part.summary.duration, part.summary.length / kSpeed + 1.0);
}

TEST(PointPath, HeadersMayHaveCapitalsAndAUnitAfterABlank) {
  const Folder folder;
  PathOptions o;
  for (const char* header : {"x mm,y mm", "X [mm],Y [mm]", "X mm,y_mm"}) {
    o.path = folder.write("line.csv", std::string(header) + "\n0,0\n10,0\n");
    EXPECT_NEAR(part_of(planned(o)).summary.length, 10e-3, 1e-12) << header;
  }
  o.path = folder.write("twice.csv", "x [mm],y [mm],X [um]\n0,0,0\n10,0,0\n");
  EXPECT_THAT(refusal(o), HasSubstr("axis x has a second column"));
}

// A short last segment bends the spline narrowly; only that place is passed slowly.
TEST(PointPath, AShortLastSegmentCostsLittleTime) {
  const Folder folder;
  PathOptions o;
  o.path = folder.write("end.csv", "x [mm],y [mm]\n0,0\n1,0\n2,0\n3,0\n4,0\n5,0\n5,0.1\n");
  o.join = PointJoin::kSpline;
  const sim::PartSummary& s = part_of(planned(o)).summary;
  EXPECT_LT(s.duration, 3.0 * s.length / kSpeed);
}

TEST(PointPath, SpeedsAreToldApart) {
  const Folder folder;
  PathOptions o;
  o.path = folder.write("line.csv", "x [mm],y [mm]\n0,0\n10,0\n");
  sim::CompareSpec spec;
  workflow::use_points(spec, o, {1e-3, 2e-3}, workflow::built_in_machine("biaxial-table"));
  ASSERT_EQ(spec.travels.size(), 2U);
  EXPECT_EQ(spec.travels[0].pace_in_words(), "up to 1 mm/s");
  EXPECT_EQ(spec.travels[1].pace_in_words(), "up to 2 mm/s");
}

TEST(PointPath, RefusesPointsThatMeanNothing) {
  const Folder folder;
  PathOptions o;
  o.path = folder.write("huge.csv", "x [mm],y [mm]\n0,0\n1e300,0\n");
  EXPECT_THAT(refusal(o), HasSubstr("row 2, x: got 1e+297 m, expected at most 1000 km from zero"));
  o.path = folder.write("tiny.csv", "x [mm],y [mm]\n0,0\n1e-9,0\n");
  EXPECT_THAT(refusal(o), HasSubstr("the path is 1e-06 um long, expected at least 1 um"));
  // No side file is read, so none is suggested.
  o.path = folder.write("bare.csv", "0,0\n10,0\n");
  EXPECT_THAT(refusal(o), ::testing::AllOf(HasSubstr("has no header"), ::testing::Not(HasSubstr(".toml"))));
}

TEST(PointPath, SaysWhatIsWrong) {
  const Folder folder;
  PathOptions o;
  o.path = folder.write("far.csv", "x [mm],y [mm]\n0,0\n100000,0\n");
  EXPECT_THAT(refusal(o), HasSubstr("leaves the travel of axis x"));
  EXPECT_THAT(refusal(o), HasSubstr("scale them down"));
  o.path = folder.write("one.csv", "x [mm],b [mm]\n0,0\n1,0\n");
  EXPECT_THAT(refusal(o), HasSubstr("got 1 of the axes of the machine"));
  o.path = folder.write("still.csv", "x [mm],y [mm]\n1,1\n1,1\n");
  EXPECT_THAT(refusal(o), HasSubstr("has no motion"));
  o.laps = 3.0;
  EXPECT_THAT(refusal(o), HasSubstr("leave out --size and --laps"));
}

}  // namespace
}  // namespace stribeck::test::point_path_test
