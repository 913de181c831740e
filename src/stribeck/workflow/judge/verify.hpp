#pragma once
/// Identified models on logs that were not used to identify them: what `stribeck verify` shows.
///
///   workflow::VerifyOptions o;
///   o.axis_files = {"x.toml"}, o.logs = {"unseen.csv"};
///   const report::VerifyReportInput found = workflow::verify(o);
///
/// Each log is read and cleaned as for an identification. On each of its parts every model is scored by the error of
/// its force (ident/replay/model_force.hpp) and replayed in open loop and, with a controller, in closed loop. A shift
/// of the force that the log shows is taken out before; so are rows in which something was added to the command. With a
/// machine file, logs in volts, amperes, percent or turns are scaled with the drive of their axis.
///
/// Real time: no.
/// Errors: InputError for files and options, ident::Refused where no part can be replayed.

#include <stribeck/report/pages/verify_report.hpp>
#include <stribeck/sim/axis_file.hpp>
#include <stribeck/workflow/log/log_options.hpp>
#include <string>
#include <utility>
#include <vector>

namespace stribeck::workflow {

struct VerifyOptions {
  std::string machine{};  ///< file; empty: none
  std::vector<std::string> axis_files{};
  std::vector<std::string> logs{};
  LogOptions log{};
  std::string controller{};   ///< file; empty: no closed loop
  std::string force_shift{};  ///< known one, "3.5 ms"; empty: found in the log
  report::GradeLimits limits{};
  /// Axis files that are not written yet, by the name that they will have.
  std::vector<std::pair<std::string, sim::AxisFile>> models{};
  std::vector<io::Log> read{};  ///< the logs, where they are read already; `logs` has their names
};

report::VerifyReportInput verify(const VerifyOptions& options);

}  // namespace stribeck::workflow
