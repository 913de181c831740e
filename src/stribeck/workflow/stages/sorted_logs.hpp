#pragma once
/// The logs in the folder of `commission --logs`, told apart by axis.
/// Real time: no.
/// Errors: InputError naming the folder.

#include <stribeck/workflow/log/logs_by_axis.hpp>
#include <stribeck/workflow/machine/description.hpp>
#include <stribeck/workflow/stages/stages.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

/// The logs of each axis, those without any too; what is no log, and what is a copy, is left out with the reason in `skipped`.
std::vector<LogsOfAxis> sorted_logs(const StageOptions& options, const MachineDescription& machine,
                                    std::vector<std::string>& skipped);

}  // namespace stribeck::workflow
