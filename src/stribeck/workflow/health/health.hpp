#pragma once
/// The health of a machine: measures the logs of a repeated motion, adds them to the archive, and judges the trend.
///
/// The first test of an axis decides its speeds, places and periods; a later log with another motion is refused, because its
/// numbers could not be compared. Nothing is added unless every log of the command could be measured.
/// Real time: no.
/// Errors: InputError naming the log, also where its motion does not determine the numbers.

#include <stribeck/report/health/health_report.hpp>
#include <stribeck/workflow/health/archive.hpp>
#include <stribeck/workflow/log/log_options.hpp>
#include <stribeck/workflow/machine/description.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

/// Texts contain their unit; empty: not given.
struct HealthOptions {
  std::string machine;            ///< file
  std::vector<std::string> logs;  ///< of any axes; none: only the trend of the archive
  LogOptions log;
  std::string date;  ///< 2026-11-23; empty: what the log says
  std::optional<double> temperature;
  std::vector<std::string> circles;  ///< logs of a circle
  std::string size;                  ///< radius of the circle
  std::string turn;                  ///< travel of one turn of the screw; empty: lead of the machine file
  std::string since;                 ///< first day that counts
  ident::health::Limits limits;
};

/// Refuses options that do not go together.
void check_health_options(const HealthOptions& options);

/// Refuses an archive that is not there, without logs to begin one.
void check_archive(const HealthOptions& options, const std::string& archive);

/// What to record for the first test, with the commands that design it, where no archive is there and no log begins one; else empty.
std::string before_first_test(const HealthOptions& options, const std::string& archive);

/// The input of the page; the caller adds command and version.
report::HealthReportInput check_health(const HealthOptions& options, const ArchiveFolder& archive);

/// The commands that design the motion to repeat: jogs at four speeds over whole turns, then triangles of speed for the mass.
std::vector<std::string> motion_commands(const std::string& file, const MachineDescription& machine,
                                         std::size_t axis, double turn);

}  // namespace stribeck::workflow
