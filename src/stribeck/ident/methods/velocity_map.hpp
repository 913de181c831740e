#pragma once
/// Model C of the thesis: mass and velocity–friction map of an axis from runs through all speeds (sine, pulses).
///
///   f = m·a + F(v) + noise          F: Gaussian-augmented map, one branch for each direction
///
/// The general identification (drive_fit.hpp), restricted to this model: a commanded force under its zero-order hold, nothing
/// periodic, friction by direction. The thesis takes the number of terms from the peaks of the smoothed map (the border counts);
/// that number is reported beside the one that held-out motion gives.
///
/// Source: thesis §2.4.3.
/// Not modelled: friction that depends on position, temperature or load.
/// Real time: no.
/// Errors: Refused, with the reason.

#include <optional>
#include <stribeck/ident/log/record.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/result.hpp>
#include <vector>

namespace stribeck::ident::methods {

struct VelocityMapOptions {
  std::optional<double> mass;  ///< known mass [kg]; absent: estimated
  std::optional<int> terms;    ///< Gaussians of each branch; absent: chosen from the data
  int most_terms = 6;          ///< largest number that is tried
  int bins = 160;              ///< of velocity, each direction
  int curve_points = 24;       ///< each direction
  int map_points = 600;        ///< for plots, each direction
};

Result identify_velocity_map(const std::vector<log::Record>& records, const VelocityMapOptions& options = {});

}  // namespace stribeck::ident::methods
