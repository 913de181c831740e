#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stribeck/io/error.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <stribeck/workflow/path/path_options.hpp>
#include <stribeck/workflow/path/single_run.hpp>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace stribeck::workflow::path_options_test {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

sim::Machine mill() {
  return read_virtual_machine(std::string(STRIBECK_SOURCE_DIR) + "/machines/five-axis-mill.toml");
}

double reference_radius(const sim::CompareSpec& spec) {
  return std::get<path::ConeFrustum>(spec.travels.front().path).table.radius;
}

// A rotary axis has a radius of 1 m; if the file does not say that it is rotary, the radius of the experiment is used.
TEST(PathOptions, TheTableTurnsAtTheRadiusOfItsAxes) {
  sim::Machine machine = mill();
  EXPECT_DOUBLE_EQ(reference_radius(printed_spec("five-axis", machine, "m.toml")), 0.1);
  machine.axes[3].second.rotary = true;
  EXPECT_THAT([&] { printed_spec("five-axis", machine, "m.toml"); },
              ThrowsMessage<io::InputError>(HasSubstr("write rotary = true")));
  machine.axes[4].second.rotary = true;
  EXPECT_DOUBLE_EQ(reference_radius(printed_spec("five-axis", machine, "m.toml")), 1.0);
  SingleRunOptions one;
  one.experiment = "five-axis";
  EXPECT_DOUBLE_EQ(reference_radius(single_run(one, {}, machine, "m.toml")), 1.0);
}

// The accuracy is one of the simulation; the options of a path are another matter.
TEST(PathOptions, APrintedExperimentTakesAnAccuracyAndNoPath) {
  const sim::Machine machine = mill();
  PathOptions path;
  path.accuracy = "20 nm";
  EXPECT_DOUBLE_EQ(experiment_spec("five-axis", path, {}, machine, "m.toml").accuracy, 20e-9);
  EXPECT_EQ(experiment_spec("five-axis", {}, {}, machine, "m.toml").accuracy,
            printed_spec("five-axis", machine, "m.toml").accuracy);
  path.size = "20 mm";
  EXPECT_THAT([&] { experiment_spec("five-axis", path, {}, machine, "m.toml"); },
              ThrowsMessage<io::InputError>(HasSubstr("--path, --size and the other options of a path")));
}

TEST(PathOptions, FiveAxesOfOnesOwnTakeSpeeds) {
  sim::Machine machine = mill();
  for (auto& [name, axis] : machine.axes) axis.published = {};
  EXPECT_EQ(default_experiment(machine, {}), "five-axis");
  EXPECT_EQ(default_experiment(machine, {}, {"40 mm/s"}), kOwn);
  PathOptions path;
  path.size = "5 mm";
  EXPECT_EQ(default_experiment(machine, path), kOwn);
  path = {};
  path.axes = {"x", "y"};
  EXPECT_EQ(default_experiment(machine, path), kOwn);
}

// Five axes whose identified models stand for the truth: nobody says that two of them carry the table of the five-axis mill.
TEST(PathOptions, AMachineThatExistsIsNoFiveAxisMill) {
  sim::Machine machine = mill();
  for (auto& [name, axis] : machine.axes) axis.published = {};
  machine.axes[0].second.truth_from = "x.toml";
  EXPECT_EQ(default_experiment(machine, {}), kOwn);
}

// Below position 0 as a vertical axis goes: no size of a circle about 0 would do.
TEST(PathOptions, ACircleIsLaidIntoTheTravel) {
  sim::Machine machine =
      read_virtual_machine(std::string(STRIBECK_SOURCE_DIR) + "/machines/biaxial-table.toml");
  PathOptions path;
  sim::CompareSpec spec;
  use_path(spec, path, {5e-3}, machine, "m.toml");
  EXPECT_TRUE(std::holds_alternative<path::Curve>(spec.travels.front().path));
  machine.axes[1].second.limits.travel_min = -0.42;
  machine.axes[1].second.limits.travel_max = 0.0;
  use_path(spec, path, {5e-3}, machine, "m.toml");
  const auto& moved = std::get<path::Fourier<2>>(spec.travels.front().path);
  EXPECT_DOUBLE_EQ(moved.point(0.25 * moved.period())[1], -0.21 + 10e-3);
  EXPECT_NO_THROW(check_travel(machine, "m.toml", spec));
  // Other shapes lie about 0, and say so.
  path.path = "eight";
  use_path(spec, path, {5e-3}, machine, "m.toml");
  EXPECT_THAT([&] { check_travel(machine, "m.toml", spec); },
              ThrowsMessage<io::InputError>(HasSubstr("this shape is centred at position 0")));
  // On a travel that begins at 0 and holds the centre, the size is the cause.
  machine.axes[1].second.limits.travel_min = -1e-3;
  machine.axes[1].second.limits.travel_max = 0.42;
  EXPECT_THAT([&] { check_travel(machine, "m.toml", spec); },
              ThrowsMessage<io::InputError>(HasSubstr("(choose a smaller size)")));
}

// A machine of one's own had its circle alone; --experiment bi-table, with the gains of another machine, was the way to other shapes.
TEST(PathOptions, AMachineOfOnesOwnTakesEveryShape) {
  const std::string file = std::string(STRIBECK_SOURCE_DIR) + "/examples/own-machine/gantry-virtual.toml";
  const sim::Machine machine = read_virtual_machine(file);
  PathOptions path;
  for (const auto shape : {path::Shape::kEight, path::Shape::kTrifolium}) {
    path.path = enum_name(shape);
    ASSERT_EQ(default_experiment(machine, path), kOwn);
    const sim::CompareSpec spec = experiment_spec(kOwn, path, {}, machine, file);
    ASSERT_EQ(spec.axes, (std::vector<std::size_t>{0, 1}));
    const auto& moved = std::get<path::Fourier<2>>(spec.travels.back().path);
    const path::Curve curve{shape, 20e-3};
    const auto middle = [&](std::size_t i) {
      const sim::AxisLimits& l = machine.axes[i].second.limits;
      return 0.5 * (l.travel_min + l.travel_max);
    };
    const double shift = shape == path::Shape::kTrifolium ? curve.size : 0.0;  // it begins at x = 0 there
    double radius = 1.0;
    for (int k = 0; k < 100; ++k) {
      const double share = 0.01 * k;
      const auto is = moved.point(share * moved.period());
      const auto told = curve.point(share * curve.period());
      EXPECT_NEAR(is[0], told[0] - shift + middle(0), 1e-15) << share;
      EXPECT_NEAR(is[1], told[1] + middle(1), 1e-15) << share;
      const auto d = path::derivatives<2>(curve, share * curve.period());
      const double length = norm(d[1]);
      radius = std::min(radius, length * length * length / std::abs(d[1][0] * d[2][1] - d[1][1] * d[2][0]));
    }
    const auto acceleration = [&](std::size_t i) { return machine.axes[i].second.limits.acceleration; };
    const double speed = spec.travels.back().speed;
    EXPECT_LE(speed * speed / radius, 0.3 * std::min(acceleration(0), acceleration(1))) << path.path;
  }
  path.path = "part.ngc";
  EXPECT_THAT([&] { experiment_spec(kOwn, path, {}, machine, file); },
              ThrowsMessage<io::InputError>(HasSubstr("own takes circle, eight or trifolium")));
  path.path = "eight";
  path.axes = {"x"};
  EXPECT_THAT([&] { experiment_spec(kOwn, path, {}, machine, file); },
              ThrowsMessage<io::InputError>(HasSubstr("got 1 axes, expected 2 for this shape")));
}

// The circle needs two axes; compare takes a sine.
TEST(PathOptions, ARunOnOneAxisIsThatOfCompare) {
  const sim::Machine machine = read_virtual_machine(std::string(STRIBECK_SOURCE_DIR) +
                                                    "/examples/own-machine/rotary-table-virtual.toml");
  ASSERT_EQ(machine.axes.size(), 1U);
  const sim::CompareSpec compared =
      experiment_spec(default_experiment(machine, {}), {}, {}, machine, "m.toml");
  const sim::CompareSpec run = single_run({}, {}, machine, "m.toml");
  ASSERT_EQ(run.travels.size(), 1U);
  EXPECT_EQ(run.travels.front().name, compared.travels.front().name);
  EXPECT_EQ(run.travels.front().axes(), 1U);
  ASSERT_EQ(run.controllers.size(), 1U);
}

// With the radius, the speeds and the gains of compare: it had those of the biaxial table.
TEST(PathOptions, ARunOfAMachineOfOnesOwnIsThatOfCompare) {
  const std::string file = std::string(STRIBECK_SOURCE_DIR) + "/examples/own-machine/gantry-virtual.toml";
  const sim::Machine machine = read_virtual_machine(file);
  const sim::CompareSpec compared = experiment_spec(kOwn, {}, {"20 mm/s"}, machine, file);
  SingleRunOptions one;
  one.speed = "20 mm/s";
  one.controller = "a";
  const sim::CompareSpec run = single_run(one, {}, machine, file);
  EXPECT_EQ(run.travels.front().name, compared.travels.front().name);
  EXPECT_EQ(run.travels.front().speed, 20e-3);
  EXPECT_EQ(run.axes, compared.axes);
  const auto pole = [](const sim::ControllerSpec& c) {
    return std::get<control::ContouringParams>(c.law).kp[0];
  };
  EXPECT_EQ(pole(run.controllers.front()), pole(compared.controllers.front()));
}

// Millimetres and milliradians make no circle.
TEST(PathOptions, TheAxesOfAMotionAreChosen) {
  sim::Machine machine = mill();
  for (auto& [name, axis] : machine.axes) axis.published = {};
  machine.axes[0].second.rotary = true;
  PathOptions path;
  EXPECT_THAT(experiment_spec(kOwn, path, {}, machine, "m.toml").axes, testing::ElementsAre(1, 2, 3));
  for (auto& [name, axis] : machine.axes) axis.rotary = name != "z";
  EXPECT_THAT(experiment_spec(kOwn, path, {}, machine, "m.toml").axes, testing::ElementsAre(2));
  path.axes = {"z", "x"};
  const sim::CompareSpec own = experiment_spec(kOwn, path, {}, machine, "m.toml");
  EXPECT_THAT(own.axes, testing::ElementsAre(2, 0));
  EXPECT_EQ(own.travels.front().axes(), 2U);
  sim::CompareSpec circle;
  use_path(circle, path, {5e-3}, machine, "m.toml");
  EXPECT_THAT(circle.axes, testing::ElementsAre(2, 0));
  const auto refusal = [&](std::vector<std::string> axes) {
    path.axes = std::move(axes);
    try {
      use_path(circle, path, {5e-3}, machine, "m.toml");
    } catch (const io::InputError& e) {
      return std::string(e.what());
    }
    return std::string("accepted");
  };
  EXPECT_THAT(refusal({"x"}), HasSubstr("got 1 axes, expected 2 for this path"));
  EXPECT_THAT(refusal({"x", "x"}), HasSubstr("axis \"x\" stands there twice"));
  EXPECT_THAT(refusal({"x", "q"}), HasSubstr("no axis \"q\""));
}

}  // namespace
}  // namespace stribeck::workflow::path_options_test
