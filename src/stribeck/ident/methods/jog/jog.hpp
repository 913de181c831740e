#pragma once
/// Model B: friction from constant speeds (jogs): mean force at each speed, then a nonlinear fit of (2.9).
///
///   symmetric       f = load + [α0 + (α1 − α0)·exp(−|v/v0|^δ)]·sgn v + α2·v     δ = 2 or free; or without exponential
///   by direction    f = η0± + η1±·v + a±·exp(−(v/c±)²)                          c common or separate; or without the last term
///   Gaussians       f = η0± + η1±·v + Σ a_i·exp(−((v − b_i)/c_i)²)              as many as the speeds determine
///
/// Stretches of constant speed are found in the records (steady_runs.hpp). Every candidate is fitted with each speed but the
/// fastest (both directions) left out in turn, and judged on it. Of those within one standard error of the best, the one with the
/// fewest parameters is taken. v0 and c lie between the slowest speed and a third of the fastest. Beside a Stribeck part, α2 and η1
/// are not negative: a wide one with a falling slope is a parabola, not friction.
///
/// Linear parameters are eliminated; the others are found by Levenberg–Marquardt from many starts (the simplex of the papers can
/// be selected). Intervals use the larger of two errors: that of the means under correlated noise, and the residual of the curve.
/// By direction, a load cannot be distinguished from friction; half the sum of both directions is taken for the load when it is the same
/// at all speeds, or too large for friction.
///
/// The mass comes from records without constant speeds, e.g. a sine (equal_speed.hpp).
///
/// Source: thesis §2.3.3, §4.4.1, (2.9); one standard error: Breiman et al. 1984.
/// Not modelled: pre-sliding; drift between the runs (a jump between groups of speeds is found and reported).
/// Real time: no.
/// Errors: Refused, with the reason.

#include <optional>
#include <stribeck/ident/log/record.hpp>
#include <stribeck/ident/map/steady_runs.hpp>
#include <stribeck/ident/result.hpp>
#include <vector>

namespace stribeck::ident::methods {

enum class Solver { kDerivatives, kSimplex };

struct JogOptions {
  map::SteadyOptions steady;
  Solver solver = Solver::kDerivatives;
  std::optional<int> terms;    ///< Gaussians of each direction; absent: chosen among all candidates
  bool gaussians = true;       ///< false: conventional candidates only, as printed
  std::optional<double> mass;  ///< known [kg]
  int curve_points = 24;       ///< each direction
};

struct Jog {
  Result result;                     ///< of the group with the most speeds
  std::vector<map::SteadyRun> runs;  ///< all of them
  double residual_rms = 0.0;         ///< of the means that were fitted [N]
  std::vector<Result> groups;  ///< the other groups, where friction jumps between two days; usually empty
};

Jog identify_jog(const std::vector<log::Record>& records, const JogOptions& options = {});

}  // namespace stribeck::ident::methods
