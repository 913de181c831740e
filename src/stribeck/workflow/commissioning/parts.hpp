#pragma once
/// What the stages of commissioning share. For the sources of this folder.
/// Real time: no. Errors: Stopped.

#include <string>
#include <utility>
#include <vector>

#include <stribeck/io/json.hpp>
#include <stribeck/workflow/commissioning/changed_values.hpp>
#include <stribeck/workflow/commissioning/circles.hpp>
#include <stribeck/workflow/commissioning/commissioning.hpp>
#include <stribeck/workflow/commissioning/stage_folder.hpp>

namespace stribeck::workflow::commissioning {

/// File of ChangedValues for the time of a stage, and for the model that the controllers have got.
inline constexpr const char* kForAWhile = "changed-for-a-while.json";
inline constexpr const char* kModelValues = "changed-model.json";

/// A stage while it runs.
struct Work {
  RunningMachine& machine;
  const Options& options;
  const Dialogue& dialogue;
  const MachineDescription& description;
  const RunningAxes& axes;
  const StageFolder& folders;
  std::string folder;             ///< of this stage, to write to
  std::vector<std::string> says;  ///< what it found

  void found(const std::string& text);
  /// Announces a motion and asks; Stopped where the answer is no.
  void ask(const std::string& motion) const;
  /// Files of an earlier stage.
  [[nodiscard]] std::string of(const std::string& stage, const std::string& file) const {
    return folders.path(stage) + '/' + file;
  }
};

/// Why the machine has to stop; an empty `why`: there is no reason. Being switched off is a reason.
struct Trouble {
  std::string why = {};
  bool by_hand = false;  ///< the emergency stop is active, or somebody switched the machine off

  [[nodiscard]] bool any() const noexcept { return !why.empty(); }
};
Trouble trouble(Work& work, const MachineState& state);
/// Ends the stage for this reason.
[[noreturn]] void stop_for(const Trouble& trouble);
/// Programs are in machine coordinates: Stopped where offsets are active.
void refuse_offsets(Work& work);
/// Waits until a motion has ended; stops the machine and throws where there is a reason.
void wait_for_motion(Work& work, double seconds);
/// A jog in the machine file's metres, and its end.
void jog(Work& work, const RunningAxis& axis, double speed, double distance);
/// Runs a program to its end; with a file, recorded to it.
void run_program(Work& work, const std::string& name, const std::string& gcode, double seconds,
                 const std::string& record = {});
/// Homed, or Stopped; switched on, after a question where it is off.
void require_ready(Work& work);
/// A parameter of HAL; NaN: there is none.
double value_in_hal(RunningMachine& machine, const std::string& name);
/// Sets the ferror-limit of a controller for a while, unless it is lower already [m]. Gives the limit that holds.
double tighten(Work& work, ChangedValues& changed, const RunningAxis& axis, double ferror);

// The stages; each gives what its result.json holds.
io::Json check(Work& work);
io::Json moves(Work& work);
io::Json record(Work& work);
io::Json identify_axes(Work& work);
io::Json circle_before(Work& work);
io::Json circle_after(Work& work);
io::Json write_configuration(Work& work);

}  // namespace stribeck::workflow::commissioning
