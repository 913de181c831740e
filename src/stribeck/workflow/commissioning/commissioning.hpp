#pragma once
/// Commissions a machine under a running LinuxCNC, stage after stage.
///
///   check     axes, limits, units and signals; then the sign of every axis from a move of 0.05 mm under a small force; homes
///   moves     jogs from 0.05 mm on, each three times as long as the one before
///   record    the motions of excite as G-code, recorded by halsampler; one of them is held out
///   identify  mass and friction, and the verdict on the held-out motion (stages/stages.hpp)
///   before    the circle with the controller as it is
///   after     the circle with the model; refused where it is not better
///   write     HAL file and INI file; the originals are kept (originals.hpp)
///
/// Every stage is complete or not there (stage_folder.hpp). Values of HAL that a stage changes for a time are given back
/// (changed_values.hpp). Before a stage moves anything it says what, and asks.
///
/// The machine stops, and commissioning ends with the reason, at any message of LinuxCNC, fault of a controller, limit of a joint, and
/// where the machine is switched off.
/// Real time: no.
/// Errors: Stopped (the answer is no), MachineError, InputError, ident::Refused.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <stribeck/report/circle/circle_report.hpp>
#include <stribeck/report/commission/commission_report.hpp>
#include <stribeck/report/pages/verify_report.hpp>
#include <stribeck/workflow/commissioning/axes.hpp>
#include <stribeck/workflow/commissioning/running_machine.hpp>

namespace stribeck::workflow::commissioning {

/// In their order.
const std::vector<std::string>& stage_names();

struct Options {
  std::string machine;  ///< file
  std::string ini;      ///< file with which LinuxCNC was started
  std::string output;   ///< folder of all results
  std::string axis;     ///< one axis; empty: all
  std::string stage;    ///< this one alone, also when it is done; empty: all that are not done
  report::GradeLimits limits;
  std::string version;  ///< of the program
};

/// How commissioning talks to the person at the machine.
struct Dialogue {
  std::function<void(const std::string&)> say;
  /// Whether the motion that was announced may begin.
  std::function<bool(const std::string&)> agree;
  /// setp lines of a controller: axis file, prefix of its parameters, double pole of its loop [rad/s].
  std::function<std::string(const std::string&, const std::string&, double)> controller_lines;
  /// What a parameter of a controller is before it is set: "friction.conventional.alpha0".
  std::function<double(const std::string&)> initial_value;
};

struct StageDone {
  std::string stage;
  bool earlier = false;           ///< done by an earlier command
  std::vector<std::string> says;  ///< what was found
};

struct Outcome {
  std::vector<StageDone> stages;
  std::optional<double> before;  ///< largest radial error of the circle [m]; absent: no circle
  std::optional<double> after;
  std::vector<std::string> files;  ///< that were written to the configuration
  std::string page;                ///< both circles; empty: none
};

Outcome run(RunningMachine& machine, const Options& options, const Dialogue& dialogue);

/// Gives back the files of the configuration, and, where LinuxCNC runs, the values of HAL; null: it does not run.
std::vector<std::string> undo(RunningMachine* machine, const std::string& output);

}  // namespace stribeck::workflow::commissioning
