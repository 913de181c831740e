#pragma once
/// Logs that a model is to be verified on, although it was identified from them: a model always fits these.
/// Real time: no.

#include <string>
#include <vector>

namespace stribeck::workflow {

/// A note for each log whose name stands in the first line of the axis file, where identify writes them.
std::vector<std::string> notes_on_own_logs(const std::string& axis_file,
                                           const std::vector<std::string>& logs);

}  // namespace stribeck::workflow
