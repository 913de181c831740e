#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stribeck/workflow/path/path_file.hpp>
#include <string>
#include <utility>
#include <vector>

namespace stribeck::test::path_file_test {
namespace {

using ::testing::ThrowsMessage;

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::vector<std::string> kPlane{"x", "y"};
const std::vector<std::string> kSpace{"x", "y", "z"};

io::Log table(const std::string& text) { return io::parse_csv(text, "part.csv"); }

template <std::size_t N = 2>
std::string refusal(const std::string& text, const std::vector<std::string>& axes = kPlane,
                    double tolerance = 1e-5) {
  try {
    const auto points = workflow::path_points<N>(table(text), axes);
    static_cast<void>(workflow::make_spline(points, tolerance));
  } catch (const io::InputError& e) {
    return e.problems().front().text();
  }
  ADD_FAILURE() << "accepted";
  return {};
}

TEST(PathFile, ColumnsAreFoundByAxisAndUnit) {
  const auto p = workflow::path_points<3>(
      table("z_um,x [mm],y (m)\n1000,1,0.002\n2000,3,0.004\n-500,5,0.006\n"), kSpace);
  ASSERT_EQ(p.points.size(), 3U);
  EXPECT_EQ(p.points[0], (Vec<double, 3>{{1e-3, 2e-3, 1e-3}}));
  EXPECT_EQ(p.points[2], (Vec<double, 3>{{5e-3, 6e-3, -0.5e-3}}));
  EXPECT_FALSE(p.columns.closed);
  EXPECT_TRUE(p.columns.notes.empty());
}

TEST(PathFile, EqualNeighboursAreMergedAndTheLapIsClosed) {
  const auto p = workflow::path_points<2>(
      table("x [mm],y [mm]\n0,0\n0,0\n10,0\n10,10\n10,10\n10,10\n0,10\n0,0\n"), kPlane);
  EXPECT_TRUE(p.columns.closed);
  EXPECT_THAT(p.columns.rows, ElementsAre(1, 3, 4, 7));
  ASSERT_EQ(p.points.size(), 4U);
  EXPECT_EQ(p.points[3], (Vec2{{0.0, 10e-3}}));
  EXPECT_THAT(p.columns.notes, Contains(AllOf(HasSubstr("merged: 3"), HasSubstr("row 2"))));
  EXPECT_THAT(p.columns.notes, Contains(HasSubstr("closed")));
}

TEST(PathFile, OutAndBackIsNotClosed) {
  // Three points of which the last is the first: no lap, but a path that turns back.
  const auto p = workflow::path_points<2>(table("x [mm],y [mm]\n0,0\n1,1\n0,0\n"), kPlane);
  EXPECT_FALSE(p.columns.closed);
  EXPECT_EQ(p.points.size(), 3U);
}

// The table of a rotary axis is in degrees, which the path carries as arcs at a radius of 1 m.
TEST(PathFile, PointsOfAnAxisThatTurnsAreInDegrees) {
  const std::string text = "x [mm],c [deg]\n0,0\n20,30\n40,-90\n";
  const auto p = workflow::path_points<2>(table(text), {"x", "c"}, {false, true});
  EXPECT_NEAR(p.points[1][0], 20e-3, 1e-15);
  EXPECT_NEAR(p.points[1][1], std::numbers::pi / 6.0, 1e-15);
  EXPECT_NEAR(p.points[2][1], -std::numbers::pi / 2.0, 1e-15);
  EXPECT_THAT(p.columns.notes, Contains(HasSubstr("axis c turns")));
  // Arcs in millimetres stay what they are; a linear axis has no degrees.
  const std::string arcs = "x [mm],c [mm]\n0,0\n20,500\n";
  EXPECT_NEAR(workflow::path_points<2>(table(arcs), {"x", "c"}, {false, true}).points[1][1], 0.5, 1e-15);
  EXPECT_THAT(refusal(text, {"x", "c"}), HasSubstr("got \"deg\", expected a unit like m"));
}

TEST(PathFile, CurveKeepsItsMemoryWhenMoved) {
  std::string text = "x [mm],y [mm]\n";
  for (int i = 0; i < 60; ++i) {
    text += std::to_string(10.0 * std::cos(0.1 * i)) + "," + std::to_string(10.0 * std::sin(0.1 * i)) + "\n";
  }
  auto made = workflow::make_spline(workflow::path_points<2>(table(text), kPlane), 2e-9);
  const Vec2 before = made.curve.point(0.02);
  auto moved = std::move(made);
  EXPECT_EQ(moved.curve.point(0.02), before);
  // Numbers of six decimals are rounded to 0.5 nm in each axis.
  EXPECT_NEAR(norm(before), 10e-3, 3e-9);
  EXPECT_LE(moved.deviation, 2e-9);
}

TEST(PathFile, SaysWhatIsWrongAndWhere) {
  const std::string good = "x [mm],y [mm]\n0,0\n1,0\n1,1\n";
  EXPECT_THAT(refusal("x,y\n0,0\n1,0\n"),
              AllOf(HasSubstr("part.csv"), HasSubstr("\"x\""), HasSubstr("no unit")));
  EXPECT_THAT(refusal("x [N],y [mm]\n0,0\n1,0\n"), AllOf(HasSubstr("part.csv"), HasSubstr("N")));
  EXPECT_THAT(refusal<3>(good, kSpace), AllOf(HasSubstr("part.csv: z"), HasSubstr("found x, y")));
  EXPECT_THAT(refusal("x [mm],y [mm],a [deg]\n0,0,1\n1,0,2\n"),
              AllOf(HasSubstr("a [deg]"), HasSubstr("x, y")));
  EXPECT_THAT(refusal("x [mm],y [mm]\n0,0\n1,nan\n"), HasSubstr("row 2"));
  EXPECT_THAT(refusal("x [mm],y [mm]\n0,0\n1,one\n"), HasSubstr("row 2"));
  EXPECT_THAT(refusal("x [mm],y [mm]\n0,0\n"), HasSubstr("at least two"));
  EXPECT_THAT(refusal("x [mm],y [mm]\n1,2\n1,2\n1,2\n"), HasSubstr("too few points"));
  EXPECT_THAT(refusal("x [mm],y [mm]\n0,0\n1,0\n1,0.000000001\n1,1\n"),
              AllOf(HasSubstr("row 2"), HasSubstr("million")));
  EXPECT_THAT(refusal(good, kPlane, -1.0), HasSubstr("tolerance"));
}

TEST(PathFile, TooManyPointsAreRefused) {
  io::Log log;
  log.source = "part.csv";
  log.rows = 1000001;
  log.columns = {{"x", "mm", std::vector<double>(log.rows, 0.0)},
                 {"y", "mm", std::vector<double>(log.rows, 0.0)}};
  EXPECT_THAT([&] { static_cast<void>(workflow::path_points<2>(log, kPlane)); },
              ThrowsMessage<io::InputError>(HasSubstr("expected at most 1000000")));
}

}  // namespace
}  // namespace stribeck::test::path_file_test
