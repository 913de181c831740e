#pragma once
/// The excitation of an axis as a table and as JSON: `stribeck excite`.
/// Real time: no.
/// Errors: InputError naming the option or the machine file.

#include <nlohmann/json_fwd.hpp>
#include <stribeck/io/log/log.hpp>
#include <stribeck/workflow/excitation.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

struct AxisExcitation {
  std::string machine;  ///< its name
  std::string axis;
  ident::excitation::ExcitationMethod method = ident::excitation::ExcitationMethod::kJog;
  ident::excitation::Excitation excitation;
  std::vector<std::string> notes;  ///< safety_notes()
  io::Log log;                     ///< t and r, or t, f and what the drive takes; the notes in its head
  bool rotary = false;             ///< the log is in deg and N m
  bool of_lathe = false;  ///< X of a machine with X and Z and without Y: its control may count diameters
};

/// Designs it for an axis of a machine file.
AxisExcitation excite_axis(const ExcitationOptions& options, const std::string& machine_file,
                           const std::string& axis);

nlohmann::ordered_json to_json(const AxisExcitation& excitation);

}  // namespace stribeck::workflow
