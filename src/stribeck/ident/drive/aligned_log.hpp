#pragma once
/// The records of one axis as motions, with the force brought to the time of the motion that it belongs to.
///
/// The force through the window is kept beside the aligned one, so that another shift costs one pass over the
/// rows. The alignment is the only thing that a later step changes here: align() in rows.hpp.
///
/// Behind a position controller the reference alone explains a velocity, v̂ = Σ h_j·ṙ(k − l_j), with weights h by
/// least squares on the measured one. It is free of the noise, and close to the measured motion even behind a slow
/// position loop. Its acceleration is the instrument of the mass.
///
/// Inside ident only. Real time: no.
/// Errors: Refused when there is no record, a record has problems(), or records have different units.

#include <optional>
#include <span>
#include <stribeck/ident/log/motion.hpp>
#include <stribeck/ident/log/record.hpp>
#include <string>
#include <utility>
#include <vector>

namespace stribeck::ident::drive {

/// A programmed force under its hold belongs to the middle of its row.
inline constexpr double kHeldForce = -0.5;

/// What the steps have to say, in the order in which they ran.
struct Notes {
  std::vector<std::string> warnings;
  std::vector<std::string> cannot_tell;

  void warn(std::string words) { warnings.push_back(std::move(words)); }
};

struct AlignedLog {
  std::span<const log::Record> records;
  std::vector<log::Motion> motions;        ///< of each record
  std::vector<std::vector<double>> force;  ///< of each record, through the window, not aligned [N]
  std::vector<std::vector<double>>
      predicted;              ///< velocity that the reference explains [m/s]; empty: no reference
  double shift = kHeldForce;  ///< of the force, as in MotionOptions [rows]
};

AlignedLog reconstruct_all(std::span<const log::Record> records, double cut_off, std::optional<double> shift,
                           Notes& notes);

/// v̂ at every row of a record in closed loop; empty without a reference.
std::vector<double> predicted_velocity(const log::Record& record, const log::Motion& motion);

}  // namespace stribeck::ident::drive
