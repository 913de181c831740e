#pragma once
/// The option --gain of an export: the force of one unit of the control, and the unit in which its parameter counts.
///
/// Real time: no.
/// Errors: InputError naming the option.

#include <stribeck/targets/steady/steady_target.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stribeck::targets {

/// What an option says of an axis: "x=10 mm,y=5 mm" each its own, "10 mm" the same of all. Refuses one that leaves the axis out.
std::string text_of_axis(const char* option, const std::string& text, const std::string& axis);
/// A sentence where several axes were given the same gain or lead, which those of different drives are not; else nothing.
std::string word_of_common_gain(const ExportRequest& request);

/// "12.5 N/%" → 12.5 N and "%"; NaN and an empty unit where it was not given. The force of an axis that turns may be a torque; a torque
/// of the motor of another axis becomes a force by its `lead` [m], NaN: not given, which is refused.
std::pair<double, std::string> gain_of(const ExportRequest& request, const std::string& axis, bool rotary,
                                       double lead);
/// Whether --gain gives a torque, so that --lead has an effect.
bool gives_torque(const ExportRequest& request);

/// Fills gain and lead that the target needs and the command does not give from the drive in the axis file: per cent of the rated torque
/// where it is known, else amperes. Returns a sentence that says it; empty: nothing was taken.
std::string take_from_file(const SteadyTarget& target, Axis& axis);
/// The options that the target needs and neither the command nor every axis file gives, as words; empty: none.
std::string missing_options(const SteadyTarget& target, const ExportRequest& request);

/// Refuses an entry for an axis that is none of these.
void refuse_unknown_axes(const char* option, const std::string& text, const std::vector<std::string>& names);

/// Whether the target can count in the units of --gain, of all axes.
bool can_count(const SteadyTarget& target, const ExportRequest& request);
/// Whether a unit is a share of the rated torque: % or ‰.
bool is_share(std::string_view unit);

/// Whether the target can count in this unit of --gain.
bool can_count(const SteadyTarget& target, std::string_view unit);
/// Brings the gain of an axis to the unit in which the target counts; refuses a unit that cannot be.
void count_as(const SteadyTarget& target, Axis& axis);

/// A sentence where friction is above what the control can give, which tells that --gain is wrong; else nothing.
std::string word_of_gain(const SteadyTarget& target, const Axis& axis);

}  // namespace stribeck::targets
