#pragma once
/// The excitation of an axis as a user asks for it: a method of ident/excitation within the limits of a machine.
/// Real time: no.
/// Errors: InputError naming the option.

#include <cstddef>
#include <optional>
#include <stribeck/ident/excitation/excitation.hpp>
#include <stribeck/sim/machine.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

/// Texts stand with their unit; empty: as the thesis does it, within the limits.
struct ExcitationOptions {
  std::string method;               ///< pulses, ramp, jog, sine, position-sine or constant-acceleration
  std::optional<int> periods;       ///< of sine, position-sine
  std::optional<int> repeats;       ///< of ramp, constant-acceleration
  std::vector<std::string> speeds;  ///< of jog
  std::string lead;                 ///< of the screw: jogs then move by whole turns
  std::string rise;                 ///< of ramp
  std::string known;                ///< axis file of an earlier identification, for pulses and ramp
};

/// Options of one method are refused with another, not ignored.
void check_excitation(const ExcitationOptions& options);

/// What the axis is to do.
ident::excitation::Excitation make_excitation(const ExcitationOptions& options, const sim::Machine& machine,
                                              std::size_t axis);

}  // namespace stribeck::workflow
