#include <algorithm>
#include <array>
#include <cmath>
#include <stribeck/core/numbers.hpp>
#include <stribeck/sim/uncertainty/design.hpp>
#include <stribeck/sim/uncertainty/sensitivity.hpp>

namespace stribeck::sim {
namespace {

constexpr std::uint64_t kBootstrap = 0x626f6f74;
constexpr std::size_t kCommon = 3;
constexpr std::size_t kOfFactor = 3;

/// Poisson distribution with mean 1.
unsigned char poisson(double u) {
  double p = std::exp(-1.0);
  double sum = p;
  unsigned char k = 0;
  while (u > sum && k < 20) {
    ++k;
    p /= k;
    sum += p;
  }
  return k;
}

/// Limits of the middle 95 %; sorts.
std::array<double, 2> middle(std::vector<double>& values) {
  std::sort(values.begin(), values.end());
  const auto at = [&](double p) {
    const double h = p * static_cast<double>(values.size() - 1);
    const auto k = static_cast<std::size_t>(h);
    const double share = h - static_cast<double>(k);
    return share == 0.0 ? values[k] : values[k] + share * (values[k + 1] - values[k]);
  };
  return {at(0.025), at(0.975)};
}

}  // namespace

std::vector<unsigned char> bootstrap_counts(std::uint64_t seed, std::uint64_t sample) {
  std::vector<unsigned char> counts(kBootstraps);
  for (std::size_t r = 0; r < kBootstraps; ++r)
    counts[r] = poisson(random_share(seed ^ kBootstrap, sample, r));
  return counts;
}

SobolIndices::SobolIndices(std::size_t factors)
    : factors_(factors), sums_((kBootstraps + 1) * (kCommon + kOfFactor * factors)) {}

void SobolIndices::add(double a, double b, std::span<const double> ab,
                       std::span<const unsigned char> counts) {
  if (samples_ == 0) shift_ = a;
  ++samples_;
  a -= shift_;
  b -= shift_;
  std::vector<double> one(kCommon + kOfFactor * factors_);
  one[0] = 1.0;
  one[1] = a + b;
  one[2] = a * a + b * b;
  for (std::size_t i = 0; i < factors_; ++i) {
    const double d = ab[i] - shift_ - a;
    double* const of_factor = &one[kCommon + kOfFactor * i];
    of_factor[0] = b * d;
    of_factor[1] = d;
    of_factor[2] = d * d;
  }
  for (std::size_t r = 0; r <= kBootstraps; ++r) {
    const double weight = r == kBootstraps ? 1.0 : counts[r];
    if (weight == 0.0) continue;
    double* const sums = &sums_[r * one.size()];
    for (std::size_t k = 0; k < one.size(); ++k) sums[k] += weight * one[k];
  }
}

double SobolIndices::variance(std::size_t bootstrap) const {
  const double* const s = &sums_[bootstrap * (kCommon + kOfFactor * factors_)];
  const double n = 2.0 * s[0];
  const double mean = s[1] / n;
  return std::max(0.0, s[2] / n - mean * mean);
}

SobolIndices::Estimate SobolIndices::estimate(std::size_t bootstrap, std::size_t factor) const {
  const double* const s = &sums_[bootstrap * (kCommon + kOfFactor * factors_)];
  const double* const of_factor = s + kCommon + kOfFactor * factor;
  const double v = variance(bootstrap);
  // Rounding alone is no variance.
  if (!(v > 1e-14 * (s[2] / (2.0 * s[0]) + shift_ * shift_))) return {kNaN, kNaN};
  const double c = s[1] / (2.0 * s[0]);
  return {(of_factor[0] - c * of_factor[1]) / s[0] / v, 0.5 * of_factor[2] / s[0] / v};
}

double SobolIndices::deviation() const { return samples_ < 2 ? kNaN : std::sqrt(variance(kBootstraps)); }

SobolIndex SobolIndices::index(std::size_t factor) const {
  constexpr Confident kUnknown{kNaN, kNaN, kNaN};
  if (samples_ < 2) return {kUnknown, kUnknown};
  const Estimate all = estimate(kBootstraps, factor);
  if (std::isnan(all.first)) return {kUnknown, kUnknown};
  std::vector<double> first;
  std::vector<double> total;
  for (std::size_t r = 0; r < kBootstraps; ++r) {
    const Estimate one = estimate(r, factor);
    if (std::isnan(one.first)) continue;
    first.push_back(one.first);
    total.push_back(one.total);
  }
  // Of a few samples, most bootstraps hold the same one alone.
  if (first.size() < kBootstraps / 2) return {{all.first, kNaN, kNaN}, {all.total, kNaN, kNaN}};
  const auto [first_low, first_high] = middle(first);
  const auto [total_low, total_high] = middle(total);
  return {{all.first, first_low, first_high}, {all.total, total_low, total_high}};
}

}  // namespace stribeck::sim
