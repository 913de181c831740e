#pragma once
/// From a folder of logs to verified axis files, one stage after the other: what is there, what it determines, whether the model
/// holds on a log that was not fitted, and what to record next.
///
///   logs       every file of the folder that is a log, assigned to its axis (log/logs_by_axis.hpp)
///   identify   from all logs but one, which is held out: one with the word "verify" in its name, else the last for which the others
///              still determine the mass
///   verify     on the held-out log; a model that is not usable there is not promoted, and an earlier axis file stays as it was
///   promote    OUTPUT/AXIS.toml
///
/// OUTPUT/commission.json holds the result of every axis with the SHA-256 of its inputs (machine file, logs, options, version). An
/// axis whose inputs are the same is not computed again.
/// Real time: no.
/// Errors: InputError naming the file.

#include <stribeck/report/commission/commission_report.hpp>
#include <stribeck/report/pages/verify_report.hpp>
#include <stribeck/workflow/log/log_options.hpp>
#include <string>

namespace stribeck::workflow {

struct StageOptions {
  std::string machine;  ///< file
  std::string folder;   ///< of the logs
  std::string output;   ///< folder of the axis files and of the state
  LogOptions log;
  report::GradeLimits limits;
  std::string version;  ///< of the program, as an input
};

report::CommissionReportInput commission_from_logs(const StageOptions& options);

}  // namespace stribeck::workflow
