#pragma once
/// Reads texts that a user gave for a setting, as an option of the command or an argument of a caller: with their unit,
/// or refused.
///
/// Real time: no.
/// Errors: InputError whose place is the name of the option ("--gain").

#include <cstddef>
#include <stribeck/core/fields.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/sim/machine.hpp>
#include <string>
#include <utility>

namespace stribeck::workflow {

/// Throws InputError for an option.
[[noreturn]] void refuse_option(const std::string& option, const std::string& message);

/// An option's value with its unit, in SI.
double option_si(const std::string& option, const std::string& text, const Quantity& quantity);

/// A length or speed along an axis; of a rotary axis it may be an angle, or the arc at a radius of 1 m.
double travel_si(const std::string& option, const std::string& text, const Quantity& quantity, bool rotary);

/// The travel of a turn without the words that say so: "5 mm/rev", "0.2 in / turn" and "10 mm/U" are 5 mm, 0.2 in and 10 mm.
std::string of_one_turn(std::string text);

/// The texts left and right of the first "=" of an option; both must be there; otherwise refused with what is `expected`.
std::pair<std::string, std::string> halves(const std::string& option, const std::string& text,
                                           const std::string& expected);
/// The same for --axis-file: axis and file.
std::pair<std::string, std::string> axis_and_file(const std::string& text);

/// What to say of an axis that cannot be simulated, because its file has neither its truth nor a model of it.
io::InputError no_truth(const std::string& file, const std::string& axis);

/// Index of the axis in the machine that was read from `file`; throws with the names that exist.
std::size_t axis_index(const sim::Machine& machine, const std::string& file, const std::string& axis);

}  // namespace stribeck::workflow
