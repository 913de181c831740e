#pragma once
/// Finds stretches of constant speed in records, and the mean force of each.
///
///   F_i = mean of f over the stretch,   its standard error from the long-run variance (long_run.hpp)
///
/// The speed (of the reference where there is one, else measured) is cut into pieces of equal speed: neighbours that differ
/// least are joined, until those left differ by more than 4 % and by more than their noise. A piece counts when its speed neither
/// drifts nor bends. Its beginning is left out until the motion has settled and the axis has moved `exclude` beyond its last
/// reversal, because the bristle still follows there. Time and distance are found from the record; the distance is six relaxation
/// lengths of the force after reversals, where these can be seen.
///
/// A term periodic in position (the screw) biases the mean of a stretch whose length is no whole number of periods. It is
/// fitted over all stretches together with their means,
///
///   f = F_i + c·cos(2πx/p) + s·sin(2πx/p)        (times sgn v, where that fits better)
///
/// and subtracted when it explains a quarter of the residual of the means. p is searched unless it is given.
///
/// Source: thesis §2.3.3; periodic term: (2.36).
/// Not modelled: more than one period; a drift during a stretch.
/// Real time: no.
/// Errors: Refused, with the record.

#include <cstddef>
#include <limits>
#include <optional>
#include <stribeck/friction/eccentric.hpp>
#include <stribeck/ident/log/record.hpp>
#include <string>
#include <vector>

namespace stribeck::ident::map {

struct SteadyRun {
  std::size_t record = 0;
  std::size_t first = 0;  ///< row
  std::size_t last = 0;   ///< row, included
  double speed = 0.0;     ///< signed, measured [m/s]
  double way = 0.0;       ///< distance moved [m]
  double force = 0.0;     ///< mean, without the periodic term [N]
  double error = 0.0;     ///< standard error [N]
};

struct SteadyOptions {
  double shortest = 0.5;          ///< shortest stretch, without its left-out beginning [s]
  double settle = 0.5;            ///< left out after a change of speed [s], at most 30 % of the stretch
  std::optional<double> exclude;  ///< distance left out after a reversal [m]; absent: found from the force
  std::optional<double> period;   ///< of the term periodic in position [m]; 0: none; absent: searched
};

struct SteadyRuns {
  std::vector<SteadyRun> runs;  ///< in the order of records and rows
  double exclude = 0.0;         ///< [m]
  /// Relaxation length of the force after reversals, g/σ0 [m]; NaN: not seen.
  double relaxation = std::numeric_limits<double>::quiet_NaN();
  std::optional<friction::Eccentric<double>> periodic;
  double periodic_error = 0.0;     ///< standard error of its amplitude [N]
  std::vector<std::string> notes;  ///< what was left out, and why
};

SteadyRuns find_steady_runs(const std::vector<log::Record>& records, const SteadyOptions& options = {});

/// The record with positions; where only the velocity is logged, its integral. Refuses a record with problems().
log::Record with_positions(const log::Record& record);

}  // namespace stribeck::ident::map
