#pragma once
/// Nelder–Mead's simplex, as the papers of this field use it (fminsearch), by NLopt.
///
/// It needs no derivatives, is slow, and stops at the nearest local minimum. The fits of this folder use derivatives
/// and many starts; the simplex is there for comparison with printed results.
///
/// Source: Nelder, Mead 1965, doi:10.1093/comjnl/7.4.308; NLopt (LN_NELDERMEAD).
/// Real time: no.
/// Errors: Refused when the function is not finite at the start.

#include <functional>
#include <vector>

namespace stribeck::ident::stats {

struct SimplexOptions {
  double tolerance = 1e-10;  ///< relative, of the value and of every coordinate
  int evaluations = 8000;
};

struct SimplexResult {
  std::vector<double> x;
  double value = 0.0;
  int evaluations = 0;
  bool converged = false;  ///< false: the limit of evaluations was reached
};

/// Minimum of f near `start`; `step` is the size of the first simplex in each coordinate. Values that are not
/// finite count as very large.
SimplexResult minimise_simplex(const std::function<double(const std::vector<double>&)>& f,
                               std::vector<double> start, std::vector<double> step,
                               const SimplexOptions& options = {});

}  // namespace stribeck::ident::stats
