#include <fmt/format.h>
#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>
#include <thread>

#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/json.hpp>
#include <stribeck/io/process/outside_program.hpp>
#include <stribeck/workflow/commissioning/running_linuxcnc.hpp>

namespace stribeck::workflow::commissioning {

extern const std::string_view kLinuxCncBridge;

namespace {

namespace fs = std::filesystem;
using io::Json;

/// LinuxCNC's module is that of Debian's own Python.
constexpr const char* kPython = "/usr/bin/python3";

class RunningLinuxCnc final : public RunningMachine {
 public:
  explicit RunningLinuxCnc(const std::string& ini) try
      : bridge_({kPython, "-c", std::string(kLinuxCncBridge), ini}, limits()) {
  } catch (const io::ProgramFailed& e) {
    throw MachineError(e.what());
  }
  RunningLinuxCnc(const RunningLinuxCnc&) = delete;
  RunningLinuxCnc& operator=(const RunningLinuxCnc&) = delete;
  /// The bridge is idle when it is ended: a halcmd that is killed may keep HAL locked.
  ~RunningLinuxCnc() override {
    try {
      ask({{"do", "finish"}});
    } catch (const MachineError&) {
      // It has ended already.
    }
  }

  MachineState state() override {
    const Json said = ask({{"do", "state"}});
    MachineState s;
    s.ini = said.at("ini");
    s.estop = said.at("estop");
    s.on = said.at("on");
    s.moving = said.at("moving");
    s.units_per_mm = said.at("linear_units");
    s.offsets = said.at("offsets");
    s.errors = said.at("errors");
    for (const Json& j : said.at("joints"))
      s.joints.push_back({j.at("position"), j.at("command"), j.at("following_error"), j.at("homed"),
                          j.at("fault"), j.at("at_limit")});
    return s;
  }
  std::vector<std::string> ini(const std::string& section, const std::string& key) override {
    return ask({{"do", "ini"}, {"section", section}, {"key", key}}).at("values");
  }
  void release_emergency_stop() override { ask({{"do", "release"}}); }
  void switch_on() override { ask({{"do", "on"}}); }
  void switch_off() override { ask({{"do", "off"}}); }
  void home() override { ask({{"do", "home"}}); }
  void jog(int joint, double speed, double distance) override {
    ask({{"do", "jog"}, {"joint", joint}, {"speed", speed}, {"distance", distance}});
  }
  void run(const std::string& program) override {
    ask({{"do", "run"}, {"program", fs::absolute(program).string()}});
  }
  void stop() override { ask({{"do", "stop"}}); }
  void sleep(double seconds) override { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }
  std::vector<HalItem> pins(const std::string& pattern) override { return items("pin", pattern); }
  std::vector<HalItem> parameters(const std::string& pattern) override { return items("param", pattern); }
  std::vector<std::string> functions() override { return ask({{"do", "functions"}}).at("functions"); }
  void hal(const std::vector<std::vector<std::string>>& commands) override {
    ask({{"do", "hal"}, {"commands", commands}});
  }
  void begin_record(int sampler, const std::string& file) override {
    ask({{"do", "begin_record"}, {"sampler", sampler}, {"file", fs::absolute(file).string()}});
  }
  void end_record() override { ask({{"do", "end_record"}}); }

 private:
  static io::ProgramLimits limits() {
    io::ProgramLimits l;
    l.first_answer = 30.0;
    l.answer = 120.0;
    l.processor_seconds = 36000.0;
    return l;
  }

  Json ask(const Json& wanted) {
    try {
      bridge_.say(wanted.dump() + '\n');
      Json said = Json::parse(bridge_.answer(), nullptr, false);
      if (!said.is_object()) throw MachineError("LinuxCNC's bridge answers with no JSON");
      if (const auto wrong = said.find("error"); wrong != said.end())
        throw MachineError(wrong->get<std::string>());
      return said;
    } catch (const io::ProgramFailed& e) {
      throw MachineError(fmt::format("LinuxCNC's bridge {}", e.what()));
    } catch (const nlohmann::json::exception& e) {
      throw MachineError(
          fmt::format("LinuxCNC's bridge answers with other JSON than expected: {}", e.what()));
    }
  }

  std::vector<HalItem> items(const char* kind, const std::string& pattern) {
    std::vector<HalItem> out;
    const Json said = ask({{"do", "items"}, {"kind", kind}, {"pattern", pattern}});
    for (const Json& one : said.at("items"))
      out.push_back({one.at("name"), one.at("value"), one.at("signal")});
    return out;
  }

  io::Conversation bridge_;
};

}  // namespace

std::unique_ptr<RunningMachine> running_linuxcnc(const std::string& ini) {
  static_cast<void>(io::read_text(ini));
  auto machine = std::make_unique<RunningLinuxCnc>(ini);
  const MachineState s = machine->state();
  std::error_code ignored;
  if (!s.ini.empty() && !fs::equivalent(s.ini, ini, ignored))
    throw io::InputError(
        {ini,
         0,
         {},
         fmt::format("is not that of the LinuxCNC that runs, which is {}", io::in_quotes(s.ini))});
  if (s.joints.empty()) throw MachineError("no LinuxCNC runs (start it with this INI file first)");
  return machine;
}

}  // namespace stribeck::workflow::commissioning
