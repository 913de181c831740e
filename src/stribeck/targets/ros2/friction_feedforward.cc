// Friction feed-forward as a ros2_control controller (Jazzy): adds mass, friction and load of each joint to its effort command.
//
//   command = effort + mass * acceleration + friction(velocity, position) + load      of the commanded motion
//
// It is chainable. The controller before it writes its reference interfaces NAME/JOINT/effort, /velocity, /acceleration and /position,
// and claims no interface of the hardware; this controller writes JOINT/effort. A reference that nobody writes stays NaN: without velocity
// there is no friction, without acceleration no mass, without position no periodic term. Until the first effort nothing is commanded; where
// the effort ends, the load alone is. Deactivation commands 0: hold a joint that falls by a brake.
// Use the commanded velocity. The measured one changes its sign with the noise at rest, and the friction with it.
//
// The tables come from the YAML file that was written with this one. Friction jumps at a reversal: pre-sliding is not in it.
//
// In your package: add_library(friction_feedforward SHARED friction_feedforward.cpp), ament_target_dependencies(friction_feedforward
// controller_interface hardware_interface pluginlib rclcpp_lifecycle), pluginlib_export_plugin_description_file(controller_interface
// friction_feedforward.xml), and in that file
//
//   <library path="friction_feedforward">
//     <class name="stribeck_friction/FrictionFeedforward" type="stribeck_friction::FrictionFeedforward"
//            base_class_type="controller_interface::ChainableControllerInterface"/>
//   </library>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "controller_interface/chainable_controller_interface.hpp"
#include "hardware_interface/types/hardware_interface_type_values.hpp"
#include "pluginlib/class_list_macros.hpp"
#include "rclcpp/rclcpp.hpp"

namespace stribeck_friction {

// Speeds ascend; forces act against the motion.
struct Table {
  std::vector<double> speed;
  std::vector<double> force;

  bool valid() const {
    bool good = !speed.empty() && speed.size() == force.size();
    for (std::size_t i = 0; good && i < speed.size(); ++i)
      good = std::isfinite(speed[i]) && std::isfinite(force[i]) && (i == 0 || speed[i] > speed[i - 1]);
    return good;
  }

  // Straight lines between the points, the value of the end beyond them.
  double at(double s) const {
    if (s <= speed.front()) return force.front();
    if (s >= speed.back()) return force.back();
    std::size_t i = 1;
    while (s > speed[i]) ++i;
    return force[i - 1] + (force[i] - force[i - 1]) * (s - speed[i - 1]) / (speed[i] - speed[i - 1]);
  }
};

struct JointFriction {
  double mass = 0.0;
  double load = 0.0;
  Table positive;
  Table negative;
  std::vector<double> amplitude;   // of terms periodic in position
  std::vector<double> period;
  std::vector<double> phase;
  std::vector<bool> proportional;  // changes its sign with the velocity
  double spring_stiffness = 0.0;   // of a force that grows with the position
  std::vector<double> spring_positions;  // lowest, without force, highest; empty: no such force

  bool valid_spring() const {
    if (spring_positions.empty()) return spring_stiffness == 0.0;
    bool good = spring_positions.size() == 3 && std::isfinite(spring_stiffness);
    for (const double x : spring_positions) good = good && std::isfinite(x);
    return good && spring_positions[0] < spring_positions[2];
  }

  bool valid() const {
    const std::size_t terms = amplitude.size();
    bool good = std::isfinite(mass) && std::isfinite(load) && valid_spring() && positive.valid() && negative.valid() && period.size() == terms &&
      phase.size() == terms && proportional.size() == terms;
    for (std::size_t i = 0; good && i < terms; ++i)
      good = std::isfinite(amplitude[i]) && std::isfinite(phase[i]) && std::isfinite(period[i]) && period[i] > 0.0;
    return good;
  }

  double effort(double acceleration, double velocity, double position) const {
    const double two_pi = 6.283185307179586;
    double other = load + (std::isfinite(acceleration) ? mass * acceleration : 0.0);
    if (std::isfinite(position) && spring_positions.size() == 3)
      other += spring_stiffness * (std::min(std::max(position, spring_positions[0]), spring_positions[2]) - spring_positions[1]);
    double level = 0.0;
    if (std::isfinite(velocity) && velocity != 0.0) level = (velocity > 0.0 ? positive : negative).at(std::fabs(velocity));
    for (std::size_t i = 0; i < amplitude.size() && std::isfinite(position); ++i) {
      const double wave = amplitude[i] * std::sin(two_pi * position / period[i] - phase[i]);
      if (proportional[i]) {
        level += wave;
      } else {
        other += wave;
      }
    }
    return velocity > 0.0 ? other + level : velocity < 0.0 ? other - level : other;
  }
};

class FrictionFeedforward : public controller_interface::ChainableControllerInterface {
 public:
  controller_interface::CallbackReturn on_init() override { return controller_interface::CallbackReturn::SUCCESS; }

  controller_interface::CallbackReturn on_configure(const rclcpp_lifecycle::State &) override {
    joints_ = auto_declare<std::vector<std::string>>("joints", {});
    friction_.clear();
    for (const std::string & joint : joints_) {
      JointFriction f;
      f.mass = auto_declare<double>(joint + ".mass", 0.0);
      f.load = auto_declare<double>(joint + ".load", 0.0);
      f.positive.speed = auto_declare<std::vector<double>>(joint + ".speed_positive", {});
      f.positive.force = auto_declare<std::vector<double>>(joint + ".force_positive", {});
      f.negative.speed = auto_declare<std::vector<double>>(joint + ".speed_negative", {});
      f.negative.force = auto_declare<std::vector<double>>(joint + ".force_negative", {});
      f.amplitude = auto_declare<std::vector<double>>(joint + ".amplitude", {});
      f.period = auto_declare<std::vector<double>>(joint + ".period", {});
      f.phase = auto_declare<std::vector<double>>(joint + ".phase", {});
      f.proportional = auto_declare<std::vector<bool>>(joint + ".proportional", {});
      f.spring_stiffness = auto_declare<double>(joint + ".spring_stiffness", 0.0);
      f.spring_positions = auto_declare<std::vector<double>>(joint + ".spring_positions", {});
      if (!f.valid()) {
        RCLCPP_ERROR(
          get_node()->get_logger(),
          "%s: expected finite numbers, tables of equal length with ascending speeds, periodic terms with periods above 0, and a spring with three positions", joint.c_str());
        return controller_interface::CallbackReturn::ERROR;
      }
      friction_.push_back(f);
    }
    if (joints_.empty()) RCLCPP_ERROR(get_node()->get_logger(), "joints: is empty, expected the joints of the YAML file");
    return joints_.empty() ? controller_interface::CallbackReturn::ERROR : controller_interface::CallbackReturn::SUCCESS;
  }

  controller_interface::CallbackReturn on_activate(const rclcpp_lifecycle::State &) override {
    for (double & reference : reference_interfaces_) reference = kNone;
    commanded_.assign(friction_.size(), false);
    return controller_interface::CallbackReturn::SUCCESS;
  }

  // The hardware keeps the last command: without this it would be the mass and friction of the last period.
  controller_interface::CallbackReturn on_deactivate(const rclcpp_lifecycle::State &) override {
    for (auto & command : command_interfaces_) static_cast<void>(command.set_value(0.0));
    return controller_interface::CallbackReturn::SUCCESS;
  }

  controller_interface::InterfaceConfiguration command_interface_configuration() const override {
    std::vector<std::string> names;
    for (const std::string & joint : joints_) names.push_back(joint + "/" + hardware_interface::HW_IF_EFFORT);
    return {controller_interface::interface_configuration_type::INDIVIDUAL, names};
  }

  controller_interface::InterfaceConfiguration state_interface_configuration() const override {
    return {controller_interface::interface_configuration_type::NONE, {}};
  }

 protected:
  std::vector<hardware_interface::CommandInterface> on_export_reference_interfaces() override {
    const char * const quantities[kQuantities] = {
      hardware_interface::HW_IF_EFFORT, hardware_interface::HW_IF_VELOCITY, hardware_interface::HW_IF_ACCELERATION,
      hardware_interface::HW_IF_POSITION};
    reference_interfaces_.assign(kQuantities * joints_.size(), std::numeric_limits<double>::quiet_NaN());
    std::vector<hardware_interface::CommandInterface> out;
    out.reserve(reference_interfaces_.size());
    for (std::size_t i = 0; i < reference_interfaces_.size(); ++i) {
      out.emplace_back(
        get_node()->get_name(), joints_[i / kQuantities] + "/" + quantities[i % kQuantities], &reference_interfaces_[i]);
    }
    return out;
  }

  // Without a controller before it there is no command.
  controller_interface::return_type update_reference_from_subscribers(const rclcpp::Time &, const rclcpp::Duration &) override {
    return controller_interface::return_type::OK;
  }

  controller_interface::return_type update_and_write_commands(const rclcpp::Time &, const rclcpp::Duration &) override {
    for (std::size_t i = 0; i < friction_.size(); ++i) {
      const double * const reference = &reference_interfaces_[kQuantities * i];
      if (!std::isfinite(reference[0])) {
        // The command of the last period holds mass and friction of a motion that has ended: the load alone stays.
        if (commanded_[i]) static_cast<void>(command_interfaces_[i].set_value(friction_[i].effort(kNone, kNone, kNone)));
        continue;
      }
      commanded_[i] = true;
      static_cast<void>(
        command_interfaces_[i].set_value(reference[0] + friction_[i].effort(reference[2], reference[1], reference[3])));
    }
    return controller_interface::return_type::OK;
  }

 private:
  static constexpr std::size_t kQuantities = 4;  // effort, velocity, acceleration, position

  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  std::vector<std::string> joints_;
  std::vector<JointFriction> friction_;
  std::vector<bool> commanded_;  // an effort has come since activation
};

}  // namespace stribeck_friction

PLUGINLIB_EXPORT_CLASS(stribeck_friction::FrictionFeedforward, controller_interface::ChainableControllerInterface)
