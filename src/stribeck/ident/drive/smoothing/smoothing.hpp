#pragma once
/// A force that the drive smoothed before it was logged: by a filter of first order, or as the mean of some samples.
///
///   f_logged(t + d) = f(t) + κ·f̈(t) + …        κ = σ²/2
///
///   d   mean delay of the filter: found and taken out as a shift [rows]
///   σ   deviation of the times over which it spreads a force [rows]: τ of a filter of first order, W/√12 of a mean over W
///
/// κ·f̈ is in no column of the fit. At the ends of a stroke f̈ runs against the acceleration, so that the mass comes out too small: 0.6 %
/// with τ = 5 ms and 50 ms from rest to full acceleration. f̈ is that of the force which the reference asks for, free of noise; without a
/// reference nothing is found. No filter spreads a force much longer than it delays it, which bounds κ.
///
/// Source: expansion of the impulse response by its moments (Papoulis, The Fourier Integral, 1962, ch. 8).
/// Not modelled: higher moments. Inside ident only. Real time: no.

#include <optional>
#include <stribeck/ident/drive/linear_fit.hpp>
#include <vector>

namespace stribeck::ident::drive {

struct Smoothing {
  double kappa = 0.0;  ///< κ [rows²]
  double error = 0.0;  ///< its standard error [rows²]
  VectorXd moved;      ///< what it has added to each linear term

  [[nodiscard]] double spread() const;  ///< σ [rows]
};

/// `residual` of every row [N], `memory` its integrated correlation [rows]. Empty: no smoothing shows.
std::optional<Smoothing> find_smoothing(const AlignedLog& log, const Rows& rows, const Terms& terms,
                                        const LinearFit& fit, const std::vector<double>& residual,
                                        double memory);

}  // namespace stribeck::ident::drive
