#pragma once
/// Distribution of many numbers in memory that does not grow with them: mean, standard deviation, extremes, quantiles with confidence.
///
///   bins        |x| in (γ^(i−1), γ^i], γ = (1 + α)/(1 − α); both signs, zero and infinity apart
///   quantile    Q(p): value of rank ⌈p·n⌉, the middle 2γ^i/(γ + 1) of its bin: within the share α of the exact order statistic
///   confidence  values of ranks l and u with P(B < l) ≤ 2.5 %, P(B ≥ u) ≤ 2.5 %, B ~ binomial(n, p): covers Q(p) in 95 % at least,
///               whatever the distribution. Too few values for a rank: no limit on that side (NaN)
///
/// Coverage holds for independent values. Those of a Latin hypercube and of a Sobol' sequence are spread more evenly, so that
/// the interval is wider than need be there. Infinite values have a rank, but no mean.
/// Source: Masson, Rim, Lee 2019, doi:10.14778/3352063.3352135 (bins); David, Nagaraja 2003, Order Statistics, 7.1 (confidence).
/// Real time: no.

#include <cstdint>
#include <map>
#include <vector>

namespace stribeck::sim {

/// Largest relative error of a quantile due to the width of its bin.
inline constexpr double kSpreadError = 5e-4;

/// NaN where there is no limit.
struct Confident {
  double value;
  double low;
  double high;
};

/// A point of the distribution function: share of the values that are at most x.
struct SharePoint {
  double x;
  double share;
};

class Spread {
 public:
  /// Not NaN.
  void add(double x);

  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  [[nodiscard]] std::uint64_t infinite() const noexcept { return infinite_; }
  /// NaN where a value is infinite or there is none.
  [[nodiscard]] double mean() const noexcept;
  /// NaN for fewer than two values.
  [[nodiscard]] double deviation() const noexcept;
  [[nodiscard]] double smallest() const noexcept;
  [[nodiscard]] double largest() const noexcept;

  /// p in (0, 1); NaN for no values.
  [[nodiscard]] Confident quantile(double p) const;
  /// At most this many points, with equal steps of the share; infinite values are left out.
  [[nodiscard]] std::vector<SharePoint> shares(std::size_t most) const;

 private:
  [[nodiscard]] double of_rank(std::uint64_t rank) const;

  std::map<int, std::uint64_t> bins_;  ///< in the order of the values
  std::uint64_t count_ = 0;
  std::uint64_t infinite_ = 0;
  double mean_ = 0.0;
  double square_ = 0.0;
  double smallest_ = 0.0;
  double largest_ = 0.0;
};

}  // namespace stribeck::sim
