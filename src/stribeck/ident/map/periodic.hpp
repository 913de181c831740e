#pragma once
/// Finds terms periodic in position in the residual of a friction model. The periods are not known before.
///
///   e = Σ_j η_j·sin(2π·x/λ_j − φ_j)·(1 or sgn v) + smooth + noise
///
///   e residual [N], x [m], η amplitude [N], λ period [m], φ phase [rad] at the homing position of the log
///
/// 1. Neighbouring rows are averaged. From each pass (a stretch of one direction) a polynomial in x, at most cubic, is
///    removed; its ends, where reversals still act, get a lower weight.
/// 2. The least-squares spectrum is computed for both forms: the same sign in both directions (additive), or a sign that
///    changes with the direction (proportional).
/// 3. The strongest line is tried as a term. It counts when it stands out of the background at neighbouring periods
///    (chance below 1e-3 over all lines), also after it has been taken out, and holds in passes that it was not fitted to. All terms are then refined together by
///    Gauss–Newton, far below the resolution λ²/stroke. The search ends when no line stands out.
/// 4. Where a line that does not count is stronger than all that do, rows too fast for the low-pass of the log may have spoken against
///    it: the search is repeated with rows that count for a period as far as the low-pass leaves it at their speed.
///
/// Intervals and significance come from the residual spectrum beside the term itself, so that they hold under noise
/// that is correlated in time or repeats at each pass.
///
/// Source: Lomb 1976, doi:10.1007/BF00648343; Scargle 1982, doi:10.1086/160554.
/// Not modelled: amplitudes that grow with load or speed; periods longer than a third of the travel.
/// Real time: no.
/// Errors: Refused for columns of unequal length and for numbers that are not finite, with the row.

#include <cstddef>
#include <stribeck/friction/eccentric.hpp>
#include <stribeck/ident/log/motion.hpp>
#include <stribeck/ident/result.hpp>
#include <stribeck/ident/shown.hpp>
#include <string>
#include <vector>

namespace stribeck::ident::map {

/// Rows of one or more records, each record ascending in `at`.
struct PeriodicRows {
  std::vector<double> x;        ///< [m]
  std::vector<double> e;        ///< [N]
  std::vector<int> direction;   ///< +1, −1; 0 everywhere: held at standstill
  std::vector<int> record;      ///< number of the record
  std::vector<std::size_t> at;  ///< row in the record
  /// Travel in one period of the cut-off of the log's low-pass, |v|/f_c [m]; empty: no low-pass.
  std::vector<double> blur = {};
  log::Passed passed = nullptr;  ///< what that low-pass leaves of an amplitude
  Shown shown = {};              ///< units for sentences
};

struct PeriodicTerm {
  friction::Eccentric<double> term;
  Interval amplitude;                 ///< [N]
  Interval period;                    ///< [m]
  Interval phase;                     ///< around term.phase, not wrapped [rad]
  double share = 0.0;                 ///< of the variance of the residual
  double signal_to_background = 0.0;  ///< amplitude divided by that of a line of the background
  bool form_told = false;             ///< the data distinguish additive from proportional
  int harmonic = 1;                   ///< number n if the period is 1/n of the longest period found; else 1
};

struct PeriodicOptions {
  double shortest = 0.0;  ///< [m]; 0: four rows, a 2000th of the travel, or what keeps the search fast
  double longest = 0.0;   ///< [m]; 0: a third of the travel
  double turn = 0.0;  ///< period of one turn [m]; then only 1/n of it is searched, and kept exact; 0: unknown
  double known = 0.0;  ///< a period [m] that a line beside it has exactly: one turn of a rotary axis; 0: none
  int most = 4;        ///< largest number of terms
  bool guess =
      false;  ///< where no term counts, the strongest line is returned: a start for a better residual
};

struct PeriodicResult {
  std::vector<PeriodicTerm> terms;     ///< largest amplitude first
  std::vector<SpectrumLine> spectrum;  ///< of e, the larger of both forms, ascending period
  std::vector<std::string> notes;
  std::vector<std::string> cannot_tell;  ///< what these rows do not determine
};

PeriodicResult find_periodic(const PeriodicRows& rows, const PeriodicOptions& options = {});

}  // namespace stribeck::ident::map
