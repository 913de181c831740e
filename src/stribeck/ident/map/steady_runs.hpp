#pragma once
/// Stretches of constant speed in records, found by themselves, and the mean force of each.
///
///   F_i = mean of f over the stretch,   its standard error from the long-run variance (long_run.hpp)
///
/// The speed (of the reference where there is one, else measured) is cut into pieces of equal speed by joining
/// the neighbours that differ least, until those left differ by more than 4 % and by more than their noise. A
/// piece counts when the speed neither drifts nor bends in it. Its beginning is left out until the motion has
/// settled and the axis has gone `exclude` beyond its last reversal: there the bristle still follows. Both are
/// as found, in time and in way; six relaxation lengths of the force after reversals where these are seen.
///
/// A term periodic in position (the screw) biases the mean of a stretch that is no whole number of periods
/// long. It is fitted over all stretches together with their means,
///
///   f = F_i + c·cos(2πx/p) + s·sin(2πx/p)        (times sgn v, where that fits better)
///
/// and taken off, when it explains a quarter of what the means leave. p is searched unless it is given.
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
  double way = 0.0;       ///< [m]
  double force = 0.0;     ///< mean, without the periodic term [N]
  double error = 0.0;     ///< standard error [N]
};

struct SteadyOptions {
  double shortest = 0.5;          ///< of a stretch, what is left out not counted [s]
  double settle = 0.5;            ///< left out after a change of speed [s], at most 30 % of the stretch
  std::optional<double> exclude;  ///< left out after a reversal [m]; absent: from the force
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

/// The record with positions: where only the velocity is logged, its integral. Refused when it is no good.
log::Record with_positions(const log::Record& record);

}  // namespace stribeck::ident::map
