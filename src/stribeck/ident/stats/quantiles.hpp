#pragma once
/// Quantiles and tails of the distributions that intervals and tests need.
///
/// The only user of Boost.Math: its headers cost some ten seconds of compile time.
///
/// Real time: no.

namespace stribeck::ident::stats {

/// Student's t: half width of a two-sided 95 % interval in standard deviations, t_{0.975} with `freedom` degrees of freedom.
double student_factor(double freedom);

/// Chi-squared: probability that a sum of squares exceeds `sum`, with `freedom` degrees of freedom.
double chi_squared_above(double sum, double freedom);

/// Fisher's F: probability that a ratio of two mean squares exceeds `ratio`, with the degrees of freedom of the one above and below the line.
double fisher_above(double ratio, double freedom_above, double freedom_below);

}  // namespace stribeck::ident::stats
