#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <cmath>
#include <stribeck/core/numbers.hpp>
#include <stribeck/sim/uncertainty/spread.hpp>

namespace stribeck::sim {
namespace {

constexpr double kOutside = 0.025;  ///< probability on each side of an interval

const double kGamma = (1.0 + kSpreadError) / (1.0 - kSpreadError);
const double kLogGamma = std::log(kGamma);

/// Positive numbers have bins above this one, negative ones below its negative; 0 is zero.
constexpr int kMiddle = 2'000'000;

int bin_of(double x) {
  if (x == 0.0) return 0;
  const double size = std::clamp(std::abs(x), 1e-300, 1e300);
  const int i = static_cast<int>(std::ceil(std::log(size) / kLogGamma)) + kMiddle;
  return x > 0.0 ? i : -i;
}

double middle_of(int bin) {
  if (bin == 0) return 0.0;
  const double size = 2.0 * std::exp((std::abs(bin) - kMiddle) * kLogGamma) / (kGamma + 1.0);
  return bin > 0 ? size : -size;
}

/// P(B < k)
double below(std::uint64_t n, double p, std::uint64_t k) {
  if (k == 0) return 0.0;
  if (k > n) return 1.0;
  const boost::math::binomial_distribution<double> b(static_cast<double>(n), p);
  return boost::math::cdf(b, static_cast<double>(k - 1));
}

/// Largest l with P(B < l) ≤ 2.5 %; 0: none.
std::uint64_t lower_rank(std::uint64_t n, double p) {
  std::uint64_t from = 0;
  std::uint64_t to = n;
  while (from < to) {
    const std::uint64_t k = from + (to - from + 1) / 2;
    if (below(n, p, k) <= kOutside) {
      from = k;
    } else {
      to = k - 1;
    }
  }
  return from;
}

}  // namespace

void Spread::add(double x) {
  ++count_;
  smallest_ = count_ == 1 ? x : std::min(smallest_, x);
  largest_ = count_ == 1 ? x : std::max(largest_, x);
  if (std::isinf(x)) {
    ++infinite_;
    return;
  }
  ++bins_[bin_of(x)];
  const double n = static_cast<double>(count_ - infinite_);
  const double change = x - mean_;
  mean_ += change / n;
  square_ += change * (x - mean_);
}

double Spread::mean() const noexcept { return count_ == 0 || infinite_ > 0 ? kNaN : mean_; }
double Spread::deviation() const noexcept {
  return count_ < 2 || infinite_ > 0 ? kNaN : std::sqrt(square_ / static_cast<double>(count_ - 1));
}
double Spread::smallest() const noexcept { return count_ == 0 ? kNaN : smallest_; }
double Spread::largest() const noexcept { return count_ == 0 ? kNaN : largest_; }

double Spread::of_rank(std::uint64_t rank) const {
  // The exact value is known at both ends.
  if (rank <= 1) return smallest_;
  if (rank >= count_) return largest_;
  std::uint64_t seen = 0;
  for (const auto& [bin, number] : bins_) {
    seen += number;
    if (seen >= rank) return std::clamp(middle_of(bin), smallest_, largest_);
  }
  return kInfinity;
}

Confident Spread::quantile(double p) const {
  if (count_ == 0) return {kNaN, kNaN, kNaN};
  const auto n = static_cast<double>(count_);
  const auto rank = static_cast<std::uint64_t>(std::ceil(p * n));
  const std::uint64_t low = lower_rank(count_, p);
  // The same from above: rank n + 1 − l of the mirrored distribution.
  const std::uint64_t from_above = lower_rank(count_, 1.0 - p);
  return {of_rank(std::clamp<std::uint64_t>(rank, 1, count_)), low == 0 ? kNaN : of_rank(low),
          from_above == 0 ? kNaN : of_rank(count_ + 1 - from_above)};
}

std::vector<SharePoint> Spread::shares(std::size_t most) const {
  std::vector<SharePoint> points;
  std::uint64_t seen = 0;
  double next = 0.0;
  for (const auto& [bin, number] : bins_) {
    seen += number;
    const double share = static_cast<double>(seen) / static_cast<double>(count_);
    if (share < next && seen + infinite_ < count_) continue;
    points.push_back({std::clamp(middle_of(bin), smallest_, largest_), share});
    next = share + 1.0 / static_cast<double>(most);
  }
  return points;
}

}  // namespace stribeck::sim
