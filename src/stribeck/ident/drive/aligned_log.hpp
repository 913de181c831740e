#pragma once
/// The records of one axis as motions, each with its force shifted in time to the motion that it belongs to.
///
/// The windowed force is kept beside the aligned one, so that another shift costs one pass over the rows. Later steps change
/// nothing here but the alignment: align() in rows.hpp.
///
/// In closed loop the reference alone predicts a velocity, v̂ = Σ h_j·ṙ(k − l_j), with weights h by least squares on the
/// measured one. v̂ is free of measurement noise, and close to the measured motion even behind a slow position loop. Its
/// acceleration is the instrument of the mass. Where no reference was logged, or one that does not ask for most of the acceleration (pulses
/// of force were added to a slow motion), v̂ is the measured motion through a longer window: the force of a loop that works on the noise of
/// its encoder agrees with the noise of the motion itself.
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

/// A programmed force is held for one row: its mean belongs to the middle of its row.
inline constexpr double kHeldForce = -0.5;

/// Notes of the steps, in the order in which the steps ran.
struct Notes {
  std::vector<std::string> warnings;
  std::vector<std::string> cannot_tell;

  void warn(std::string words) { warnings.push_back(std::move(words)); }
};

struct AlignedLog {
  std::span<const log::Record> records;
  std::vector<log::Motion> motions;        ///< of each record
  std::vector<std::vector<double>> force;  ///< of each record, through the window, before alignment [N]
  std::vector<std::vector<double>>
      predicted;  ///< velocity with little noise [m/s]: by the reference, else the motion behind a longer window; empty: open loop, or closed loop without a reference
  double shift = kHeldForce;  ///< of the force, as in MotionOptions [rows]
  double held =
      kHeldForce;  ///< the shift while none is fitted: of a held force, or what the reversals tell [rows]
};

/// `mass_is_given`: nothing is said of how well the motion tells it.
AlignedLog reconstruct_all(std::span<const log::Record> records, double cut_off, std::optional<double> shift,
                           Notes& notes, bool mass_is_given = false);

/// v̂ at every row of a record in closed loop; empty without a reference.
std::vector<double> predicted_velocity(const log::Record& record, const log::Motion& motion);

}  // namespace stribeck::ident::drive
