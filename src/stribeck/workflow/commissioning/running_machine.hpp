#pragma once
/// A machine under a running LinuxCNC, as commissioning sees it: the only way to anything outside this program.
///
///   RunningLinuxCnc      the real one (running_linuxcnc.hpp)
///   a test               a fake that answers as it likes
///
/// Lengths are in machine units (mm or inch, as [TRAJ]LINEAR_UNITS says), times in s. Joints count from 0.
/// Real time: no.
/// Errors: MachineError where LinuxCNC does not answer or refuses a command.

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace stribeck::workflow::commissioning {

struct MachineError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct JointState {
  double position = 0.0;         ///< of the encoder
  double command = 0.0;          ///< position command
  double following_error = 0.0;  ///< as LinuxCNC counts it
  bool homed = false;
  bool fault = false;
  bool at_limit = false;  ///< a hard or soft limit is active
};

struct MachineState {
  std::string ini;  ///< file with which LinuxCNC was started
  bool estop = true;
  bool on = false;
  bool moving = false;        ///< a program runs, or a joint is on its way
  double units_per_mm = 1.0;  ///< [TRAJ]LINEAR_UNITS
  /// Offsets between a program and the machine (G54 to G59.3, G92, tool length, rotation), in words; empty: there are none.
  std::string offsets = {};
  std::vector<JointState> joints;
  std::vector<std::string> errors;  ///< messages of LinuxCNC since the last call

  [[nodiscard]] bool homed() const noexcept {
    for (const JointState& j : joints) {
      if (!j.homed) return false;
    }
    return !joints.empty();
  }
};

/// A pin or a parameter of HAL.
struct HalItem {
  std::string name;
  std::string value;
  std::string signal;  ///< that the pin is connected to; empty: none
};

class RunningMachine {
 public:
  RunningMachine() = default;
  virtual ~RunningMachine() = default;
  RunningMachine(const RunningMachine&) = delete;
  RunningMachine& operator=(const RunningMachine&) = delete;

  virtual MachineState state() = 0;
  /// All values of a key of the INI file, as LinuxCNC reads it.
  virtual std::vector<std::string> ini(const std::string& section, const std::string& key) = 0;

  /// After a person has agreed to it; refused where a button is still pressed.
  virtual void release_emergency_stop() = 0;
  virtual void switch_on() = 0;  ///< refused while the emergency stop is active
  virtual void switch_off() = 0;
  virtual void home() = 0;  ///< begins to home all joints
  /// Begins a move of one joint by a distance.
  virtual void jog(int joint, double speed, double distance) = 0;
  /// Begins a program of G-code.
  virtual void run(const std::string& program) = 0;
  virtual void stop() = 0;
  virtual void sleep(double seconds) = 0;

  /// Those whose names match a pattern with "*".
  virtual std::vector<HalItem> pins(const std::string& pattern) = 0;
  virtual std::vector<HalItem> parameters(const std::string& pattern) = 0;
  /// Names of the functions of the servo thread, in their order.
  virtual std::vector<std::string> functions() = 0;
  /// Other commands of halcmd, in this order; all words of one command in one list.
  virtual void hal(const std::vector<std::vector<std::string>>& commands) = 0;

  /// Begins to write the rows of a sampler to a file; the row is complete when end_record() returns.
  virtual void begin_record(int sampler, const std::string& file) = 0;
  virtual void end_record() = 0;
};

}  // namespace stribeck::workflow::commissioning
