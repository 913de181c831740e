#pragma once
/// HAL parameters that commissioning changes while it runs, and gives back: also after it was killed.
///
/// FILE is written before the first value is changed: name, value before, value now. give_back() sets those that still have the value
/// of now; LinuxCNC may have been started again meanwhile.
/// Real time: no.
/// Errors: MachineError, InputError of the file.

#include <string>
#include <utility>
#include <vector>

#include <stribeck/workflow/commissioning/running_machine.hpp>

namespace stribeck::workflow::commissioning {

class ChangedValues {
 public:
  ChangedValues(RunningMachine& machine, std::string file) : machine_(machine), file_(std::move(file)) {}

  /// Names and values. A second call keeps what was there before the first one.
  void set(const std::vector<std::pair<std::string, std::string>>& values);
  /// Does nothing where there is no file.
  void give_back();
  /// They stay as they are.
  void keep();

 private:
  RunningMachine& machine_;
  std::string file_;
};

/// After a failure: ends motion and record, and gives the values of FILE back to a machine that is off; what they protected from may not
/// have been proven. No step keeps the others from being tried, and none throws. Whether nothing of FILE is left; where something is, the
/// next command gives it back.
bool end_safely(RunningMachine& machine, const std::string& file);

/// "setp NAME VALUE" lines of a HAL file.
std::vector<std::pair<std::string, std::string>> setp_lines(const std::string& hal);

}  // namespace stribeck::workflow::commissioning
