#pragma once
/// Which axis of a machine each of many logs belongs to.
///
///   1. what the log says itself: `# axis: x`
///   2. columns that carry the name of an axis (x_y, ENC_POS|2): such a log belongs to each axis in it that moves
///   3. the name of the file: a word in it that is an axis (x-sine-log.csv)
///   4. a machine of one axis has no other
///   5. --axis
///
/// A log that none of these assigns is refused: it is not guessed. One that says an axis that the machine does not have is refused without --axis. Each axis comes with what the machine file says of its drive, for
/// logs in volts, amperes, percent of the rated torque or turns of the motor (DriveScale).
///
/// Real time: no.
/// Errors: InputError naming the log.

#include <stribeck/workflow/log/log_options.hpp>
#include <stribeck/workflow/machine/description.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

struct LogsOfAxis {
  std::string axis;
  LogOptions options;                ///< with the axis and its drive
  std::vector<std::string> logs;     ///< in the order given
  std::vector<std::string> notes{};  ///< logs that name another axis themselves
};

/// In the order of the machine's axes, those with logs only; --axis leaves one.
std::vector<LogsOfAxis> logs_by_axis(const MachineDescription& machine, const std::vector<std::string>& logs,
                                     const LogOptions& options);

}  // namespace stribeck::workflow
