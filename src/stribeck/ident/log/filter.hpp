#pragma once
/// Digital filters of the published identification protocols, with the same treatment of the ends.
///
///   y[k] = (b0·x[k] + … + bn·x[k−n] − a1·y[k−1] − … − an·y[k−n]) / a0
///
/// Low-pass designs by the bilinear transformation with a prewarped edge; the edge is a share of the Nyquist
/// frequency, 0 < edge < 1. Forward-backward filtering has no phase and the squared gain. At the ends: odd
/// extension by 3·(number of coefficients − 1) samples, and initial states as after a constant input.
///
/// Source: Oppenheim, Schafer, Discrete-Time Signal Processing, chapter 7; ends: Gustafsson 1996,
/// doi:10.1109/78.492552.
/// Not modelled: second-order sections; above an order of about 10 the direct form loses digits.
/// Real time: no.
/// Errors: std::invalid_argument names the argument.

#include <cstddef>
#include <vector>

namespace stribeck::ident::log {

struct Filter {
  std::vector<double> b;  ///< numerator
  std::vector<double> a;  ///< denominator, a[0] = 1
};

/// Butterworth low-pass, −3 dB at the edge.
Filter butterworth(int order, double edge);

/// Chebyshev low-pass of the first kind, ripple in dB up to the edge.
Filter chebyshev_1(int order, double ripple_db, double edge);

/// Zero-phase filtering. The signal must be longer than the extension.
std::vector<double> forward_backward(const Filter& filter, const std::vector<double>& x);

/// The signal after forward_backward with a Chebyshev filter of order 8, 0.05 dB, 0.8/factor; every factor-th sample of it,
/// counted back from the end as MATLAB's `decimate` does. A factor above 13 is taken in steps of its divisors, as MATLAB's manual asks
/// for: so far below the rate the filter has no digits left. One with a prime above 13 in it is taken at once.
std::vector<double> decimate(const std::vector<double>& x, std::size_t factor);

/// The largest factor up to this one that can be taken in such steps.
std::size_t decimation_up_to(std::size_t most);

/// Weights of three boxes of 2j+1 samples, convolved; 6j+1 of them, with sum 1.
std::vector<double> box_weights(int j);

/// Variance of the second difference of white noise of variance 1 smoothed with these weights.
double second_difference_variance(const std::vector<double>& weights);

}  // namespace stribeck::ident::log
