#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <stribeck/targets/steady/test_export.hpp>
#include <vector>

namespace stribeck::test::ros2_control_test {
namespace {

using ::testing::HasSubstr;

/// What the controller needs of ROS, for a test without ROS: the interfaces of ros2_control in Jazzy by name and signature, and
/// parameters from lines "NAME VALUES…".
constexpr const char* kStandIn = R"(#pragma once
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <type_traits>
#include <vector>
#define RCLCPP_ERROR(logger, ...) (static_cast<void>(logger), std::fprintf(stderr, __VA_ARGS__))
#define PLUGINLIB_EXPORT_CLASS(type, base) static_assert(std::is_base_of<base, type>::value, "base class");
namespace rclcpp {
struct Time {};
struct Duration {};
struct Logger {};
}
namespace rclcpp_lifecycle {
struct State {};
struct Node {
  std::map<std::string, std::string> parameters;
  const char* get_name() const { return "friction_feedforward"; }
  rclcpp::Logger get_logger() const { return {}; }
};
}
namespace hardware_interface {
constexpr char HW_IF_EFFORT[] = "effort", HW_IF_VELOCITY[] = "velocity", HW_IF_ACCELERATION[] = "acceleration", HW_IF_POSITION[] = "position";
struct CommandInterface {
  CommandInterface(const std::string& p, const std::string& n, double* v) : prefix(p), name(n), value(v) {}
  std::string prefix, name;
  double* value;
};
struct LoanedCommandInterface {
  [[nodiscard]] bool set_value(double v) { value = v; return true; }
  double value = 0.0;
};
}
namespace controller_interface {
enum class CallbackReturn { SUCCESS, FAILURE, ERROR };
enum class return_type { OK, ERROR };
enum class interface_configuration_type { ALL, INDIVIDUAL, NONE };
struct InterfaceConfiguration {
  interface_configuration_type type;
  std::vector<std::string> names;
};
class ChainableControllerInterface {
 public:
  virtual ~ChainableControllerInterface() = default;
  virtual CallbackReturn on_init() = 0;
  virtual CallbackReturn on_configure(const rclcpp_lifecycle::State&) = 0;
  virtual CallbackReturn on_activate(const rclcpp_lifecycle::State&) = 0;
  virtual CallbackReturn on_deactivate(const rclcpp_lifecycle::State&) = 0;
  virtual InterfaceConfiguration command_interface_configuration() const = 0;
  virtual InterfaceConfiguration state_interface_configuration() const = 0;
  rclcpp_lifecycle::Node* get_node() { return &node_; }
  rclcpp_lifecycle::Node node_;
  std::vector<hardware_interface::LoanedCommandInterface> command_interfaces_;
 protected:
  virtual std::vector<hardware_interface::CommandInterface> on_export_reference_interfaces() = 0;
  virtual return_type update_reference_from_subscribers(const rclcpp::Time&, const rclcpp::Duration&) = 0;
  virtual return_type update_and_write_commands(const rclcpp::Time&, const rclcpp::Duration&) = 0;
  template <class T>
  T auto_declare(const std::string& name, const T& or_else) {
    const auto found = node_.parameters.find(name);
    if (found == node_.parameters.end()) return or_else;
    std::istringstream in(found->second);
    in >> std::boolalpha;
    if constexpr (std::is_same_v<T, double>) {
      double x = 0.0;
      in >> x;
      return x;
    } else {
      T out;
      for (typename T::value_type x{}; in >> x;) out.push_back(x);
      return out;
    }
  }
  std::vector<double> reference_interfaces_;
};
}
)";

/// Reads the parameters, then commands from lines "effort velocity acceleration position", of the first joint.
constexpr const char* kMain = R"(
#include "friction_feedforward.cpp"
struct Run : stribeck_friction::FrictionFeedforward {
  using FrictionFeedforward::on_export_reference_interfaces;
  using FrictionFeedforward::update_and_write_commands;
};
int main(int, char** a) {
  Run c;
  std::ifstream file(a[1]);
  for (std::string line; std::getline(file, line);) {
    const auto at = line.find(' ');
    c.node_.parameters[line.substr(0, at)] = line.substr(at + 1);
  }
  using controller_interface::CallbackReturn;
  if (c.on_init() != CallbackReturn::SUCCESS || c.on_configure({}) != CallbackReturn::SUCCESS) return 3;
  auto references = c.on_export_reference_interfaces();
  c.command_interfaces_.resize(c.command_interface_configuration().names.size());
  if (c.on_activate({}) != CallbackReturn::SUCCESS) return 4;
  if (c.update_and_write_commands({}, {}) != controller_interface::return_type::OK) return 5;
  std::printf("%s %s %s %.15g\n", references[1].prefix.c_str(), references[1].name.c_str(),
              c.command_interface_configuration().names[0].c_str(), c.command_interfaces_[0].value);
  double r[4];
  while (std::scanf("%lf %lf %lf %lf", r, r + 1, r + 2, r + 3) == 4) {
    for (int i = 0; i < 4; ++i) *references[i].value = r[i];
    c.update_and_write_commands({}, {});
    std::printf("%.15g\n", c.command_interfaces_[0].value);
  }
  c.command_interfaces_[0].value = 12.0;
  if (c.on_deactivate({}) != CallbackReturn::SUCCESS || c.command_interfaces_[0].value != 0.0) return 7;
}
)";

/// The parameters of the controller as lines "NAME VALUES…", read from the YAML text.
std::string parameters_in(const std::string& yaml) {
  std::string out;
  std::string joint;
  std::istringstream lines(yaml.substr(yaml.find("\nfriction_feedforward:\n")));
  for (std::string line; std::getline(lines, line);) {
    line = line.substr(0, line.find('#'));
    const std::size_t indent = line.find_first_not_of(' ');
    const std::size_t colon = line.find(':');
    if (indent == std::string::npos || colon == std::string::npos || indent < 4) continue;
    std::string key = line.substr(indent, colon - indent);
    std::string value = line.substr(colon + 1);
    for (const char c : {'[', ']', ',', '"'}) std::replace(value.begin(), value.end(), c, ' ');
    if (key.front() == '"') {
      joint = key.substr(1, key.size() - 2) + ".";
    } else {
      out += (indent == 4 ? "" : joint) + key + value + "\n";
    }
  }
  return out;
}

/// The controller that was written, compiled against the stand-in and run with the parameters that were written; what it says.
struct Controller {
  SteadyExport x{std::string(kSteadyAxis) + kItsSpring};
  targets::Exported written;
  std::string program;

  explicit Controller(const char* lead = "") {
    x.request.output = x.folder / "friction.yaml";
    x.request.lead = lead;
    written = x.to("ros2_control");
    for (const char* header : {"controller_interface/chainable_controller_interface.hpp",
                               "hardware_interface/types/hardware_interface_type_values.hpp",
                               "pluginlib/class_list_macros.hpp", "rclcpp/rclcpp.hpp"}) {
      std::filesystem::create_directories(std::filesystem::path(x.folder / header).parent_path());
      x.folder.write(header, "#include \"stand_in.hpp\"\n");
    }
    x.folder.write("stand_in.hpp", kStandIn);
    const std::string main = x.folder.write("main.cpp", kMain);
    program = x.folder / "program";
    const std::string folder = x.folder / "";
    const std::string compile =
        "c++ -std=c++17 -Wall -Wextra -Werror -I'" + folder + "' -o '" + program + "' '" + main + "'";
    EXPECT_EQ(std::system(compile.c_str()), 0);
  }
  std::string run(const std::string& parameters, const std::string& commands) {
    const std::string in = x.folder.write("commands.txt", commands);
    const std::string out = x.folder / "out.txt";
    const std::string with = x.folder.write("parameters.txt", parameters);
    code = std::system(("'" + program + "' '" + with + "' < '" + in + "' > '" + out + "' 2> '" +
                        (x.folder / "said.txt") + "'")
                           .c_str());
    return text_of(out);
  }
  std::string yaml() { return text_of(x.request.output); }
  int code = 0;
};

TEST(Ros2Control, TheControllerAddsTheFrictionOfTheYamlToTheEffort) {
  for (const double radius : {0.0, 0.01 / (2.0 * 3.14159265358979)}) {
    // Of the joint: the axis itself, or its motor with 10 mm per turn.
    Controller c(radius > 0.0 ? "10 mm" : "");
    const double r = radius > 0.0 ? radius : 1.0;
    std::string commands;
    std::vector<std::array<double, 2>> motions;
    for (int i = -19; i <= 19; ++i) {
      motions.push_back({5e-3 * i + (i == 0 ? 0.0 : 1e-4), 1e-3 * i});
      std::ostringstream line;
      line.precision(17);
      line << 11.0 << ' ' << motions.back()[0] / r << ' ' << 2.0 / r << ' ' << motions.back()[1] / r << '\n';
      commands += line.str();
    }
    std::istringstream said(c.run(parameters_in(c.yaml()), commands + "11 nan nan nan\nnan 1 1 1\n"));
    ASSERT_EQ(c.code, 0);
    std::string prefix, reference, command;
    double value = 1.0;
    said >> prefix >> reference >> command >> value;
    EXPECT_EQ(prefix, "friction_feedforward");
    EXPECT_EQ(reference, "x/velocity");
    EXPECT_EQ(command, "x/effort");
    EXPECT_EQ(value, 0.0);  // nobody has commanded anything
    for (const auto& [v, p] : motions) {
      ASSERT_TRUE(said >> value);
      const double ripple = 7.0 * std::sin(2.0 * 3.14159265358979 * p / 5e-3 - 0.4);
      const double friction = v == 0.0 ? 0.0 : friction_of(v) + (v < 0.0 ? -ripple : ripple);
      EXPECT_NEAR(value, 11.0 + r * (1600.0 + 30.0 + friction + spring_of(p)),
                  r * (error_of(c.written) + 1e-5))
          << v;
    }
    // Without a velocity there is no friction: the load alone. Without an effort neither: what was commanded for a motion must not stay.
    ASSERT_TRUE(said >> value);
    EXPECT_NEAR(value, 11.0 + r * 30.0, 1e-9);
    double last = 0.0;
    ASSERT_TRUE(said >> last);
    EXPECT_NEAR(last, r * 30.0, 1e-9);
  }
}

TEST(Ros2Control, RefusesParametersThatAreNoTable) {
  Controller c;
  const std::string good = parameters_in(c.yaml());
  std::string bad = good;
  bad.replace(bad.find("x.speed_positive "), 17, "x.speed_positive 0.2 ");
  static_cast<void>(c.run(bad, ""));
  EXPECT_NE(c.code, 0);
  EXPECT_THAT(text_of(c.x.folder / "said.txt"),
              HasSubstr("x: expected finite numbers, tables of equal length"));
  std::string not_finite = good;
  not_finite.replace(not_finite.find("x.force_positive ") + 17, 0, "nan ");
  not_finite.replace(not_finite.find("x.speed_positive ") + 17, 0, "-1 ");
  static_cast<void>(c.run(not_finite, ""));
  EXPECT_NE(c.code, 0);
  static_cast<void>(c.run("joints \n", ""));
  EXPECT_NE(c.code, 0);
  EXPECT_THAT(text_of(c.x.folder / "said.txt"), HasSubstr("joints: is empty"));
}

TEST(Ros2Control, TheYamlMayNotHaveTheNameOfTheSource) {
  SteadyExport x;
  x.request.output = x.folder / "friction_feedforward.cpp";
  EXPECT_THAT(x.refusal("ros2_control"),
              HasSubstr("--output: friction_feedforward.cpp is the name of the source"));
  EXPECT_FALSE(std::filesystem::exists(x.folder / "friction_feedforward.cpp"));
}

TEST(Ros2Control, AControllerOfYoursIsKept) {
  SteadyExport x;
  const std::string file = x.folder.write("friction_feedforward.cpp", "// mine\n");
  const targets::Exported written = x.to("ros2_control");
  EXPECT_EQ(text_of(file), "// mine\n");
  EXPECT_THAT(written.text, HasSubstr("Kept, because it is another one"));
  EXPECT_EQ(written.json["beside"], file);
}

// y is a boolean in YAML 1.1.
TEST(Ros2Control, NamesAreTexts) {
  SteadyExport x;
  x.request.names = {"y"};
  const std::string yaml = x.text("ros2_control");
  EXPECT_THAT(yaml, HasSubstr("joints: [\"y\"]\n"));
  EXPECT_THAT(yaml, HasSubstr("    \"y\":\n"));
}

}  // namespace
}  // namespace stribeck::test::ros2_control_test
