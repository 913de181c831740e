#pragma once
/// A machine of one axis that a test plays: a table with friction and bristles under a loop, which writes records as halsampler does.
/// Real time: no.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include <stribeck/workflow/commissioning/running_machine.hpp>

namespace stribeck::workflow::commissioning {

class FakeMachine final : public RunningMachine {
 public:
  double sign = 1.0;               ///< −1: the encoder counts the other way
  double friction = 100.0;         ///< [N]
  double stiffness = 2e7;          ///< of the bristles [N/m]
  double mass = 100.0;             ///< [kg]
  double weight = 0.0;             ///< pulls the table to the negative side [N]
  double brake_time = 0.1;         ///< until the brake holds the table after the drive has no force [s]
  double blocked_at = 1e9;         ///< no farther than that to either side [m]
  double farthest = 0.0;           ///< of the table from where it began [m]
  std::string message_after = {};  ///< of LinuxCNC, at the next move
  std::string fault_value = "0";
  std::vector<std::string> log;  ///< what was asked
  std::map<std::string, std::vector<std::string>> keys{{"KINS KINEMATICS", {"trivkins coordinates=x"}},
                                                       {"EMCMOT SERVO_PERIOD", {"1000000"}},
                                                       {"JOINT_0 MIN_LIMIT", {"-50"}},
                                                       {"JOINT_0 MAX_LIMIT", {"50"}},
                                                       {"JOINT_0 MAX_VELOCITY", {"100"}},
                                                       {"JOINT_0 MAX_ACCELERATION", {"1000"}},
                                                       {"JOINT_0 FERROR", {"2"}}};
  std::map<std::string, std::string> values{{"ax.x.position-unit", "0.001"},
                                            {"ax.x.force-unit", "1"},
                                            {"ax.x.ferror-limit", "1"},
                                            {"ax.x.force-limit", "1000"},
                                            {"ax.x.feedforward", "2"},
                                            {"ax.x.observer", "1"},
                                            {"ax.x.adaptation.enabled", "0"},
                                            {"ax.x.drive-loop.mode", "nan"},
                                            {"ax.x.omega", "300"},
                                            {"ax.x.load", "0"}};
  bool on = false;
  bool estop = false;
  std::string offsets = {};        ///< of a program
  std::string pressed_after = {};  ///< "estop" or "off": somebody's hand, at the next move
  std::string fault_after = {};    ///< of the controller, with it
  bool is_homed = true;
  bool broken_record = false;  ///< rows of its records are no numbers

  MachineState state() override {
    MachineState s;
    s.estop = estop;
    s.on = on;
    s.offsets = offsets;
    s.joints = {{1e3 * sign * table_, 1e3 * command_, 0.0, is_homed, false, false}};
    s.errors = std::move(errors_);
    errors_.clear();
    return s;
  }
  std::vector<std::string> ini(const std::string& section, const std::string& key) override {
    const auto at = keys.find(section + ' ' + key);
    return at == keys.end() ? std::vector<std::string>() : at->second;
  }
  void release_emergency_stop() override {
    log.emplace_back("release");
    estop = false;
  }
  void switch_on() override {
    if (estop) throw MachineError("the emergency stop is active");
    log.emplace_back("on");
    on = true;
    fault_value = "0";
    command_ = sign * table_;
  }
  void switch_off() override {
    log.emplace_back("off");
    on = false;
  }
  void home() override {
    log.emplace_back("home");
    is_homed = true;
  }
  void jog(int /*joint*/, double speed, double distance) override {
    log.push_back("jog " + std::to_string(distance));
    if (!message_after.empty()) errors_.push_back(message_after);
    if (!pressed_after.empty()) {
      estop = pressed_after == "estop";
      on = false;
      if (!fault_after.empty()) fault_value = fault_after;
      pressed_after.clear();
    }
    const double from = command_;
    const double rows = std::abs(distance / speed) / kPeriod;
    for (double k = 1.0; k <= rows && on; k += 1.0) step(from + 1e-3 * distance * k / rows);
    if (on) step(from + 1e-3 * distance);
    sleep(0.02);
  }
  void run(const std::string& program) override { log.push_back("run " + program); }
  void stop() override { log.emplace_back("stop"); }
  void sleep(double seconds) override {
    for (double t = 0.0; t < seconds && t < 0.2; t += kPeriod) step(command_);
  }
  std::vector<HalItem> pins(const std::string& pattern) override {
    const std::vector<HalItem> all{
        {"joint.0.motor-pos-cmd", "0", "x-cmd"}, {"joint.0.motor-pos-fb", "0", "x-fb"},
        {"ax.x.pos-cmd", "0", "x-cmd"},          {"ax.x.pos-fb", "0", "x-fb"},
        {"ax.x.friction-ff", "0", ""},           {"ax.x.enable", "1", "x-enable"},
        {"ax.x.force", "0", "x-force"},          {"ax.x.faulted", "0", "x-faulted"},
        {"ax.x.fault", fault_value, ""},         {"sampler.0.pin.0", "0", "x-cmd"},
        {"sampler.0.pin.1", "0", "x-fb"},        {"sampler.0.pin.2", "0", "x-force"}};
    return matching(all, pattern);
  }
  std::vector<HalItem> parameters(const std::string& pattern) override {
    std::vector<HalItem> all;
    for (const auto& [name, value] : values) all.push_back({name, value, ""});
    return matching(all, pattern);
  }
  std::vector<std::string> functions() override { return {"motion-controller", "ax.x", "sampler.0"}; }
  void hal(const std::vector<std::vector<std::string>>& commands) override {
    for (const auto& c : commands) {
      if (c.front() == "setp") values[c.at(1)] = c.at(2);
    }
  }
  void begin_record(int /*sampler*/, const std::string& file) override {
    record_ = std::fopen(file.c_str(), "w");
  }
  void end_record() override {
    if (record_ != nullptr) std::fclose(record_);
    record_ = nullptr;
  }

 private:
  static constexpr double kPeriod = 1e-3;  // [s]

  static std::vector<HalItem> matching(const std::vector<HalItem>& all, const std::string& pattern) {
    std::vector<HalItem> out;
    const std::size_t star = pattern.find('*');
    for (const HalItem& p : all) {
      const bool same = star == std::string::npos ? p.name == pattern
                                                  : p.name.starts_with(pattern.substr(0, star)) &&
                                                        p.name.ends_with(pattern.substr(star + 1));
      if (same) out.push_back(p);
    }
    return out;
  }

  /// One period, in steps of the table that are short beside its bristles.
  void step(double command) {
    const double from = command_;
    const double w = std::stod(values["ax.x.omega"]);
    const double limit = std::stod(values["ax.x.force-limit"]);
    const double load = std::stod(values["ax.x.load"]);
    for (int k = 0; k < 20; ++k) {
      const double dt = kPeriod / 20;
      command_ = from + (command - from) * (k + 1) / 20;
      off_for_ = on ? 0.0 : off_for_ + dt;
      // After it was switched off, the controller holds its load until the brake has closed.
      const double rest = off_for_ > brake_time ? 0.0 : load;
      force_ = on ? std::clamp(mass * (w * w * (command_ - sign * table_) - 2.0 * w * sign * speed_) + load,
                               -limit, limit)
                  : rest;
      if (weight != 0.0 && off_for_ > brake_time) speed_ = 0.0;
      bristle_ = std::clamp(bristle_ + speed_ * dt, -friction / stiffness, friction / stiffness);
      if (weight == 0.0 || off_for_ <= brake_time)
        speed_ += dt * (force_ - weight - stiffness * bristle_ - 1e3 * speed_) / mass;
      table_ += dt * speed_;
      if (std::abs(table_) > blocked_at) {
        table_ = std::copysign(blocked_at, table_);
        speed_ = table_ > 0.0 ? std::min(speed_, 0.0) : std::max(speed_, 0.0);
      }
    }
    farthest = std::max(farthest, std::abs(table_));
    if (on && std::abs(command_ - sign * table_) > 1e-3 * std::stod(values["ax.x.ferror-limit"])) {
      on = false;
      fault_value = "5";
    }
    if (record_ != nullptr && broken_record) std::fputs("1 2 wild\n", record_);
    if (record_ != nullptr) std::fprintf(record_, "%f %f %f\n", 1e3 * command_, 1e3 * sign * table_, force_);
  }

  std::vector<std::string> errors_;
  std::FILE* record_ = nullptr;
  double command_ = 0.0;  ///< [m]
  double table_ = 0.0;    ///< [m]
  double speed_ = 0.0;
  double bristle_ = 0.0;
  double force_ = 0.0;
  double off_for_ = 1e3;  ///< the brake holds at first [s]
};

}  // namespace stribeck::workflow::commissioning
