#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stribeck/core/numbers.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/log/log.hpp>
#include <stribeck/workflow/circle_logs.hpp>
#include <stribeck/workflow/judge/circle_track.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow::circle_track_test {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

/// Two laps of 20 mm in the plane of the columns of `circle`; the third axis stands, but for its noise.
io::Log log_of(const std::string& circle, const std::string& header = "t [s],x [mm],y [mm],z [mm]") {
  std::string text = header + "\n";
  for (int k = 0; k <= 720; ++k) {
    const double angle = 2.0 * kPi * k / 360.0;
    const double still = 35.0 + 0.001 * (k % 2);
    const auto place = [&](char axis) {
      return axis == circle[0]   ? 20.0 * std::cos(angle)
             : axis == circle[1] ? -80.0 + 20.0 * std::sin(angle)
                                 : still;
    };
    text += fmt::format("{},{},{},{}\n", 0.01 * k, place('x'), place('y'), place('z'));
  }
  return io::parse_log(text, "circle.csv");
}

TEST(CircleTrack, IsThatOfTheTwoAxesThatMove) {
  const CircleTrack xy = circle_track(log_of("xy"), {}, 20e-3);
  EXPECT_EQ(xy.axes, (ident::circle::AxisNames{"x", "y"}));
  EXPECT_THAT(xy.notes, IsEmpty());
  const CircleTrack xz = circle_track(log_of("xz"), {}, 20e-3);
  EXPECT_EQ(xz.axes, (ident::circle::AxisNames{"x", "z"}));
  EXPECT_NEAR(xz.y[90], -60e-3, 1e-12);
  EXPECT_THAT(xz.notes, Contains(AllOf(HasSubstr("counter-clockwise goes from x+ to z+"),
                                       HasSubstr("G2 in the plane G18"))));
  const CircleTrack yz = circle_track(log_of("yz"), {}, 20e-3);
  EXPECT_EQ(yz.axes, (ident::circle::AxisNames{"y", "z"}));
  EXPECT_NEAR(yz.x[0], 20e-3, 1e-12);
  EXPECT_EQ(yz.empty_copy().axes, yz.axes);
}

// The plane was that of all rows, in which all three axes move.
TEST(CircleTrack, ThePlaneIsThatOfTheChosenRows) {
  std::string text = "t [s],plane,x [mm],y [mm],z [mm]\n";
  for (const int plane : {17, 18}) {
    for (int k = 0; k <= 720; ++k) {
      const double angle = 2.0 * kPi * k / 360.0;
      const double across = 20.0 * std::sin(angle);
      const double t = 0.01 * (k + (plane == 18 ? 1000 : 0));
      text += fmt::format("{},{},{},{},{}\n", t, plane, 20.0 * std::cos(angle), plane == 17 ? across : 0.0,
                          plane == 18 ? across : 0.0);
    }
  }
  const io::Log log = io::parse_log(text, "planes.csv");
  EXPECT_EQ(circle_track(log, {}, 20e-3, "plane=17").axes, (ident::circle::AxisNames{"x", "y"}));
  EXPECT_EQ(circle_track(log, {}, 20e-3, "plane=18").axes, (ident::circle::AxisNames{"x", "z"}));
  EXPECT_THAT(circle_track(log, {}, 20e-3).notes, Contains(HasSubstr("z travels 40 mm in this log")));
}

/// What judge_circles() refuses of one log; empty: nothing.
std::string refusal_of(const io::Log& log, const std::vector<std::string>& maps = {}) {
  CircleOptions options;
  options.logs = {log.source};
  options.maps = maps;
  try {
    judge_circles(options, {log});
    return {};
  } catch (const io::InputError& e) {
    return e.what();
  }
}

// A lathe counts X in diameter, and its circle is an ellipse twice as wide as high: it was one of which the "longest arc" is missing.
TEST(CircleTrack, NamesAnAxisThatIsInDiameter) {
  std::string text = "t [s],x_cmd [mm],x_act [mm],z_cmd [mm],z_act [mm]\n";
  std::string flat = "t [s],x [mm],y [mm]\n";
  for (int k = -50; k <= 720; ++k) {
    const double angle = 2.0 * kPi * std::max(k, 0) / 360.0;
    const double in = k < 0 ? 0.1 * k : 0.0;  // leads in
    const double x = 270.0 + 60.0 * std::cos(angle) + in, z = 300.0 + 30.0 * std::sin(angle);
    text += fmt::format("{},{},{},{},{}\n", 0.01 * k, x, x + 0.002, z, z - 0.001);
    // A rectangle of two to one.
    flat += fmt::format("{},{},{}\n", 0.01 * k, 60.0 * std::clamp(1.6 * std::cos(angle), -1.0, 1.0),
                        30.0 * std::clamp(1.6 * std::sin(angle), -1.0, 1.0));
  }
  const io::Log log = io::parse_log(text, "lathe.csv");
  EXPECT_THAT(refusal_of(log), AllOf(HasSubstr("x is in diameter, as a lathe may count it"),
                                     HasSubstr("a circle with a radius of 30 mm"),
                                     HasSubstr("--map x=\"x_act 0.5 mm\" --map rx=\"x_cmd 0.5 mm\" --map "
                                               "y=\"z_act mm\" --map ry=\"z_cmd mm\"")));
  EXPECT_EQ(refusal_of(log, {"x=x_act 0.5 mm", "rx=x_cmd 0.5 mm", "y=z_act mm", "ry=z_cmd mm"}), "");
  EXPECT_EQ(refusal_of(io::parse_log(flat, "flat.csv")).find("diameter"), std::string::npos);
}

TEST(CircleTrack, HasTheNamesOfTheColumnsThatAreMapped) {
  const io::Log log = log_of("xz", "t [s],x [mm],q [mm],Z position [mm]");
  const CircleTrack mapped = circle_track(log, {{"y", "Z position mm"}}, 20e-3);
  EXPECT_EQ(mapped.axes, (ident::circle::AxisNames{"x", "z"}));
  // A name that says nothing stands for what it is mapped to.
  EXPECT_EQ(circle_track(log, {{"y", "q mm"}}, 20e-3).axes, (ident::circle::AxisNames{"x", "y"}));
  // Without --map the position of z is found by its name too.
  EXPECT_EQ(circle_track(log, {}, 20e-3).axes, (ident::circle::AxisNames{"x", "z"}));
}

// A controller may move the motor ahead of the table on purpose: the table is what is judged.
TEST(CircleTrack, ScalesGoBeforeMotors) {
  std::string text = "t [s],x_x [mm],x_y [mm],scale_x [mm],scale_y [mm]\n";
  for (int k = 0; k <= 360; ++k) {
    const double angle = 2.0 * kPi * k / 360.0;
    text += fmt::format("{},{},{},{},{}\n", 0.01 * k, 20.01 * std::cos(angle), 20.01 * std::sin(angle),
                        20.0 * std::cos(angle), 20.0 * std::sin(angle));
  }
  const io::Log log = io::parse_log(text, "circle.csv");
  const CircleTrack table = circle_track(log, {}, 20e-3);
  EXPECT_TRUE(table.scale);
  EXPECT_NEAR(table.x[0], 20e-3, 1e-12);
  EXPECT_THAT(table.notes, Contains(HasSubstr("those of the scales, \"scale_x [mm]\" and \"scale_y [mm]\"")));
  const CircleTrack motor = circle_track(log, {{"x", "x_x mm"}, {"y", "x_y mm"}}, 20e-3);
  EXPECT_FALSE(motor.scale);
  EXPECT_NEAR(motor.x[0], 20.01e-3, 1e-12);
}

}  // namespace
}  // namespace stribeck::workflow::circle_track_test
