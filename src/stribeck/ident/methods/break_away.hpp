#pragma once
/// Break-away force and distance from slow ramps of the force, which begin at rest and end at the first slip.
///
///   slip      first row k whose deflection is twice that of the row where the force was 5 % smaller
///   force     F_k − m·a_k (where the mass is given: an axis that begins to slip accelerates and lags behind the ramp)
///   distance  δ of F = F_s·(1 − exp(−y/δ)), least squares up to 85 % of the force: g/σ0 of LuGre
///
/// Sliding begins where the deflection grows without bound at a nearly constant force. The rule needs no threshold of speed
/// or position: for F = F_s·(1 − exp(−y/δ)) it is met at 0.997 F_s. Stick and slip that follow while the force rises are not
/// evaluated.
///
/// A record may hold several ramps, of both directions. Each ends at its first slip; quick changes of force between ramps
/// (return to the start) are no ramps. A ramp begins at rest with a force near zero, and rises along a straight line. There is no
/// ramp where a reference moves, because the force then follows the motion. There is no break-away point where the axis creeps
/// far before it slips. Intervals are Student's over the repeats.
///
/// Source: thesis §2.1; Armstrong-Hélouvry, Dupont, Canudas de Wit 1994, doi:10.1016/0005-1098(94)90209-7.
/// Not modelled: growth of the static friction with the time at rest; creep under a force with ripple, which makes
/// the distance too large; a load, which both directions contain.
/// Real time: no.
/// Errors: Refused, with the reason.

#include <array>
#include <optional>
#include <stribeck/ident/log/record.hpp>
#include <stribeck/ident/result.hpp>
#include <vector>

namespace stribeck::ident::methods {

struct BreakAwayOptions {
  std::optional<double> mass;  ///< [kg]
};

/// One ramp.
struct Slip {
  std::size_t record = 0;
  std::size_t row = 0;      ///< of the slip
  int direction = 1;        ///< +1, −1
  double force = 0.0;       ///< signed [N]
  double deflection = 0.0;  ///< up to the slip [m]
  double distance = 0.0;    ///< δ [m]
};

struct BreakAway {
  std::vector<Slip> slips;
  std::array<double, 2> force{};     ///< forward, backward (signed) [N]; NaN: no such ramp
  std::array<Interval, 2> interval;  ///< 95 %
  double distance = 0.0;             ///< δ, mean [m]
  Interval distance_interval;        ///< 95 %
  Result result;
};

BreakAway identify_break_away(const std::vector<log::Record>& records, const BreakAwayOptions& options = {});

}  // namespace stribeck::ident::methods
