#pragma once
/// The excitation of an axis from the options of a user: a method of ident/excitation within the limits of a machine.
/// Real time: no.
/// Errors: InputError naming the option.

#include <cstddef>
#include <optional>
#include <stribeck/ident/excitation/worst_case.hpp>
#include <stribeck/workflow/machine/description.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

inline constexpr int kStrokeSpeeds = 2;  ///< of the strokes after a sine

/// Texts contain their unit; empty: as in the thesis, within the limits.
struct ExcitationOptions {
  ident::excitation::ExcitationMethod method = ident::excitation::ExcitationMethod::kJog;
  std::optional<int> periods;       ///< of sine, position-sine, multisine
  std::optional<int> strokes;       ///< of sine; 0: none
  std::optional<int> repeats;       ///< of ramp, constant-acceleration, multisine
  std::vector<std::string> speeds;  ///< of jog; of multisine one
  std::string lead;                 ///< of the screw: jogs then move by whole turns
  std::string rise;                 ///< of ramp
  std::string period;               ///< of multisine
  std::string highest;              ///< frequency of multisine
  std::string known;                ///< axis file of an earlier identification, for pulses and ramp
};

/// Refuses options of another method.
void check_excitation(const ExcitationOptions& options);

/// The options in use that shape the motion of some methods only, e.g. "--strokes".
std::vector<std::string> given_method_options(const ExcitationOptions& options);

/// Designs the excitation, safe for every axis that the machine file allows.
ident::excitation::SafeExcitation make_excitation(const ExcitationOptions& options,
                                                  const MachineDescription& machine, std::size_t axis);

/// Where it begins, which way it moves, the room that it needs, what must abort it: for the heads of files.
std::vector<std::string> safety_notes(const ident::excitation::SafeExcitation& excitation,
                                      const MachineDescription& machine, std::size_t axis);

/// " --gcode STEM.ngc" for a command of excite, with .mpf for an axis that only SINUMERIK has; empty where G-code has no such axis.
std::string gcode_option(const std::string& axis, const std::string& stem);

/// The same as comments in the head of a program that as_gcode() made.
std::string with_notes(std::string gcode, const std::vector<std::string>& notes);

}  // namespace stribeck::workflow
