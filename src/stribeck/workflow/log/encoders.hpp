#pragma once
/// Both positions of an axis that has an encoder on the motor and a scale on the table, for lost motion.
///
/// The columns are "motor" and "scale", or what --map names so; where a log has one of them only, the position is the other.
/// Absent where a log has no second position, a part of the rows counts, or rows are not equally spaced.
///
/// Real time: no.
/// Errors: InputError naming file, column or option.

#include <optional>
#include <stribeck/ident/lost_motion/lost_motion.hpp>
#include <stribeck/io/log/log.hpp>
#include <stribeck/workflow/log/log_options.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

/// `notes` gets why a second position is not used.
std::optional<ident::lost_motion::Positions> both_encoders(const io::Log& log, const LogOptions& options,
                                                           std::vector<std::string>& notes);

}  // namespace stribeck::workflow
