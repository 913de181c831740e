#pragma once
/// The frequency response of axes from their logs, and what it says of the loop: `stribeck frequency`.
/// Real time: no.
/// Errors: InputError for logs and options, ident::Refused where the logs do not hold the answer.

#include <optional>
#include <stribeck/report/frequency/frequency_report.hpp>
#include <stribeck/workflow/identify.hpp>
#include <stribeck/workflow/log/log_options.hpp>
#include <stribeck/workflow/machine/description.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

struct FrequencyOptions {
  std::string period{};        ///< of the excitation, with its unit; empty: found
  double phase_margin = 45.0;  ///< [deg]
  double gain_margin = 6.0;    ///< [dB]
};

/// Of one axis; `machine`: the file that describes it, null: none. Refuses a log that is slower than the control period and folds lines.
report::FrequencyAxis frequency_of(const AxisRecords& axis, const FrequencyOptions& options,
                                   const MachineDescription* machine);

/// Of one axis from `files`, or with a machine file first of each of its axes that the logs are of.
report::FrequencyReportInput frequency_of_logs(const std::vector<std::string>& files, const LogOptions& log,
                                               const FrequencyOptions& options);

}  // namespace stribeck::workflow
