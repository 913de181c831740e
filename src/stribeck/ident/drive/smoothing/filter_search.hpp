#pragma once
/// Whether the drive passed the force through a filter of first order before it was logged, and the time of that filter.
///
/// The mean delay τ of such a filter looks like a shift, which the fit finds and removes. What is left, κ·f̈ with
/// κ = τ²/2 and more, is in no column of the fit. At the ends of a stroke it runs against the acceleration, and the mass
/// comes out too small: 0.6 % with τ = 5 ms and 50 ms from rest to full acceleration, 15 % with τ = 3 ms and pulses of
/// 15 ms.
///
/// So where the force of a log is late by more than three quarters of a row, τ is searched up to three times that delay.
/// For each τ the filter is taken off the force (before_filter.hpp), shift and linear terms are fitted anew, and what
/// remains must not agree with
///
///   c = d/dt G_τ[f̂]        G_τ: the filter; f̂: force that the predicted motion asks for (aligned_log.hpp), free of measurement noise
///
/// beside the instruments of the other columns; all of it within strokes where this has a narrower interval, because friction that drifts
/// is most of a residual and nothing of it within a stroke. The reference of a soft loop asks for a force that jumps at other rows than
/// that of the axis: where it does not tell τ, the motion behind a longer window takes its place.
///
/// A pure delay leads to τ near zero. τ is believed when its interval is narrow and when the residual over pieces of 5 τ, where the noise
/// of ḟ has no part, is smaller than without a filter, beyond chance. An elastic drive has a delay and no filter: there it is not smaller.
///
/// The rows and the lag of friction at reversals were found on the smoothed force, which pulls τ down by up to 15 %. So the caller takes
/// the filter off, fits everything anew and searches again beside that, until τ stays.
///
/// A force that was programmed was not measured and has no filter: logs with such a record are left as they are. So is a filter whose delay
/// is beyond the search for a shift (30 ms or 40 rows, shift.hpp).
///
/// Source: expansion of the impulse response by its moments (Papoulis, The Fourier Integral, 1962, ch. 8); instruments as in
/// linear_fit.hpp. Not modelled: filters of higher order. Inside ident only. Real time: no.

#include <optional>
#include <stribeck/ident/drive/linear_fit.hpp>
#include <stribeck/ident/log/record.hpp>

namespace stribeck::ident::drive {

/// `log`: with the force that was logged. `rows`, `terms` and `fit`: as they were found on it, or on the force before a
/// filter that is nearly the right one. `shift`: of the logged force, its filter included [rows]; `given`: without its
/// filter, which is not fitted then. Empty: none shows.
std::optional<ForceFilter> find_filter(const AlignedLog& log, const Rows& rows, const Terms& terms,
                                       const LinearFit& fit, double shift,
                                       const std::optional<double>& given = {});

/// What an error of one row of `time` [rows] adds to each linear term, after the filter was taken off; zero where the rows do not tell.
VectorXd moved_by_filter(const AlignedLog& log, const Rows& rows, const Terms& terms, const LinearFit& fit,
                         double time);

}  // namespace stribeck::ident::drive
