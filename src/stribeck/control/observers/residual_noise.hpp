#pragma once
/// Noise of a residual for a filter that assumes white noise: its variance times its correlation in samples, r [N²].
///
///   m_j = mean of e over block j of n samples      e = ε·√(r/(r + h))
///   r̂ ← r̂ + (n·(m_j − m_{j−1})²/2 − r̂)/N          r = max(r̂, least)
///
///   ε residual [N]; h = φᵀPφ, the part of its variance that comes from parameters not yet learned [N²]; N blocks: few at the
///   start, which stand for the assumed value, and at most as many as the memory holds.
///
/// Means over blocks longer than the correlation are independent, and n times their variance is the spectral density at low
/// frequency, which is the noise of an estimate over many blocks. Differences of neighbouring blocks are used, because a constant
/// residual is something to learn and not noise.
/// Source: differences: von Neumann 1941, doi:10.1214/aoms/1177731677; residual against the expectation of the filter: Mehra
/// 1972, doi:10.1109/TAC.1972.1100100.
/// Not modelled: correlation longer than a block.
/// Real time: safe.

#include <stribeck/core/scalar.hpp>

namespace stribeck::control {

class ResidualNoise {
 public:
  struct State {
    double sum = 0.0;       ///< of e in this block [N]
    int samples = 0;        ///< in this block
    double last = 0.0;      ///< mean of the block before [N]
    double blocks = 0.0;    ///< number seen, up to that of the memory [blocks]
    double estimate = 0.0;  ///< r̂ [N²]
  };

  ResidualNoise() = default;
  /// Memory [s] and period [s].
  ResidualNoise(double memory, double period) noexcept
      : samples_(max_of(1, static_cast<int>(min_of(kBlock / period, 1e6) + 0.5))),
        most_(max_of(memory / kBlock, kFew + 1.0)) {}

  /// One sample of ε [N] with h [N²]; `least` [N²] is the smallest noise. Returns r.
  double step(State& s, double residual, double predicted_variance, double least) const noexcept {
    const double r = max_of(s.estimate, least);
    s.sum += residual * sqrt(r / (r + predicted_variance));
    if (++s.samples < samples_) return r;
    const double mean = s.sum / samples_;
    const double change = mean - s.last;
    if (s.blocks > 0.0) {
      if (s.blocks == 1.0) s.estimate = least;
      s.estimate += (0.5 * samples_ * change * change - s.estimate) / min_of(kFew + s.blocks, most_);
    }
    s.blocks = min_of(s.blocks + 1.0, most_);
    s.last = mean;
    s.sum = 0.0;
    s.samples = 0;
    return max_of(s.estimate, least);
  }

 private:
  static constexpr double kBlock = 0.25;  ///< [s]
  static constexpr double kFew = 8.0;

  int samples_ = 1;
  double most_ = kFew;
};

}  // namespace stribeck::control
