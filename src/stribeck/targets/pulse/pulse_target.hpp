#pragma once
/// Targets that hold a pulse at the reversal: what all of them share.
///
/// Such a target is one source file with a function that finds its numbers for one axis, writes them and reads them back. Options,
/// axis files, loop, the prediction on the user's circle and the report stand here.
///
/// Real time: no.
/// Errors: InputError naming the option or the file.

#include <optional>
#include <stribeck/targets/pulse/search.hpp>
#include <stribeck/targets/target.hpp>

namespace stribeck::targets {

inline constexpr double kMmPerMinute = 1e-3 / 60.0;  ///< [m/s]

/// What the command was asked for, in SI.
struct PulseTask {
  std::vector<std::string> names;  ///< of the axes in the control
  std::vector<friction::AxisModel> axes;
  std::vector<std::size_t> numbers;  ///< of the axes, by their names in the files: axis_numbers()
  sim::ControllerSpec loop;
  double period = 0.0;
  double radius = 0.0;
  double feed = 0.0;
  std::optional<sim::Machine> machine;
  ExportProgress progress;  ///< may be empty

  [[nodiscard]] double integral_time() const;  ///< of the velocity loop [s]
  /// That of the search for one axis of a target.
  [[nodiscard]] SearchProgress search_progress(std::string_view target, std::size_t axis) const;
};

using AxisNamer = std::string (*)(std::size_t axis);

/// From the options of an export; the namer is asked unless the user gives names.
PulseTask pulse_task(std::string_view target, AxisNamer axis_name, const ExportRequest& request);
/// The task with the gains of one axis for all: its pulse is sought on a circle of two such axes. A controller file lists gains by the
/// axes of the machine: as many as there are axis files are taken in the order of the axes, more of them by the number of the axis.
PulseTask with_gains_of(PulseTask task, std::size_t axis);

/// The user's circle, its errors without compensation and with the whole model, and where it is driven.
struct UserCircle {
  Circle circle;
  CircleError without;
  CircleError model;
  std::string where;
  std::array<std::size_t, 2> axes;  ///< of the task
};
UserCircle user_circle(const PulseTask& task);
/// The prediction in words and as JSON; `what` is compared with none and the whole model.
std::string circle_words(const PulseTask& task, const UserCircle& c, const char* what,
                         const CircleError& with);
nlohmann::ordered_json circle_json(const PulseTask& task, const UserCircle& c, const CircleError& with);

/// One axis: found on the grid, written, and read back.
struct WrittenPulse {
  Pulse pulse;  ///< as the text has it
  std::string text;
  std::string words;
  nlohmann::ordered_json json;
};

struct PulseTarget {
  std::string_view name;
  std::string_view what;     ///< what is written, in a few words
  std::string_view comment;  ///< begins a comment line
  std::string_view end;      ///< last lines of the file
  std::string_view to_do;    ///< where it is typed, and what to check first
  std::string_view kv;       ///< the control's name for the Kv factor, in (m/min)/mm; empty: none is known
  AxisNamer axis_name;
  WrittenPulse (*write)(const PulseTask& task, std::size_t axis);
};

/// All of them, in the order of help.
std::span<const PulseTarget* const> pulse_targets();

Exported write_pulse(const PulseTarget& target, const ExportRequest& request);

/// The number behind `left` in the text of a target. Throws InputError, naming `what`, for a line that is missing.
double number_after(const std::string& left, const std::string& text, const char* what);

/// An amplitude that was found at an acceleration; errors of it count with the weight.
struct PulsePoint {
  double acceleration = 0.0;  ///< [m/s²]
  double amplitude = 0.0;     ///< [m/s]
  double weight = 1.0;
};
/// The best amplitudes of a grid; the weight is what a wrong one costs at the quadrant.
std::vector<PulsePoint> points_of(const PulseSearch& found);
/// The one amplitude that is nearest to all of them.
double constant_amplitude(const std::vector<PulsePoint>& points);

/// Tries the pulse of `out` on the grid. Completes words ("…; from the best amplitudes …") and JSON; its amplitude at an acceleration
/// is for the residual.
void judge_on_grid(const PulseTask& task, std::size_t axis, const PulseSearch& found,
                   const std::function<double(double)>& amplitude, WrittenPulse& out);

}  // namespace stribeck::targets
