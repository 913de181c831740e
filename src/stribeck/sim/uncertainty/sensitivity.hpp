#pragma once
/// Sobol' indices: which share of the variance of a result comes from which factor.
///
///   A, B   two independent matrices of N samples     AB_i   A with factor i from B
///   S_i  = mean[(f(B) − c)·(f(AB_i) − f(A))] / V     the share of factor i alone (first order)
///   ST_i = mean[(f(A) − f(AB_i))²] / 2V              the share of i with everything it acts together with (total)
///   V    = variance of f over A and B                c    mean of f over A and B
///
/// Each sample costs 2 + (number of factors) runs. Confidence: 2.5 % and 97.5 % quantiles over 400 Poisson bootstraps: in each, a sample
/// counts k times, k Poisson with mean 1, drawn from (seed, sample, bootstrap). Sums alone are kept, so that memory does not grow.
/// An index is a share of a variance; an estimate may lie below 0 or above 1 by its error.
/// Source: Saltelli et al. 2010, doi:10.1016/j.cpc.2009.09.018, Table 2 (b), (f) (Jansen 1999); Hanley, MacGibbon 2006,
/// doi:10.1016/j.cmpb.2006.04.006 (bootstrap).
/// Not modelled: dependent factors.
/// Real time: no.

#include <cstdint>
#include <span>
#include <stribeck/sim/uncertainty/spread.hpp>
#include <vector>

namespace stribeck::sim {

inline constexpr std::size_t kBootstraps = 400;

struct SobolIndex {
  Confident first;
  Confident total;
};

/// How often a sample counts in each bootstrap; the same for every result of that sample.
std::vector<unsigned char> bootstrap_counts(std::uint64_t seed, std::uint64_t sample);

/// Of one result.
class SobolIndices {
 public:
  explicit SobolIndices(std::size_t factors);

  /// f on a sample of A, on that of B, and on the AB_i; finite.
  void add(double a, double b, std::span<const double> ab, std::span<const unsigned char> counts);

  [[nodiscard]] std::uint64_t samples() const noexcept { return samples_; }
  /// Standard deviation of f over A and B.
  [[nodiscard]] double deviation() const;
  /// NaN where f does not vary, or with fewer than two samples.
  [[nodiscard]] SobolIndex index(std::size_t factor) const;

 private:
  struct Estimate {
    double first;
    double total;
  };
  [[nodiscard]] Estimate estimate(std::size_t bootstrap, std::size_t factor) const;
  [[nodiscard]] double variance(std::size_t bootstrap) const;

  std::size_t factors_;
  std::uint64_t samples_ = 0;
  double shift_ = 0.0;        ///< the first result, taken off all of them for the digits of the sums
  std::vector<double> sums_;  ///< for each bootstrap (the last one is all samples once): weight, Σf, Σf²,
                              ///< then for each factor Σ f(B)·d, Σ d, Σ d²
};

}  // namespace stribeck::sim
