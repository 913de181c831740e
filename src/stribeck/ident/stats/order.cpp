#include <algorithm>
#include <cmath>
#include <stribeck/core/numbers.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <utility>

namespace stribeck::ident::stats {
namespace {

/// A list of more than twice as many elements is thinned to about this number.
constexpr std::size_t kThinned = 50000;

}  // namespace

double nth_smallest(std::vector<double> values, std::size_t k) {
  if (values.empty()) return kNaN;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(k);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

double median(std::vector<double> values) {
  const std::size_t middle = values.size() / 2;
  return nth_smallest(std::move(values), middle);
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return kNaN;
  const auto at = static_cast<std::size_t>(share * static_cast<double>(values.size() - 1));
  return nth_smallest(std::move(values), at);
}

double thinned_quantile(std::vector<double> values, double share) {
  if (values.size() > 2 * kThinned) {
    const std::size_t stride = values.size() / kThinned;
    std::size_t to = 0;
    for (std::size_t k = 0; k < values.size(); k += stride) values[to++] = values[k];
    values.resize(to);
  }
  return quantile(std::move(values), share);
}

std::vector<double> magnitudes(std::vector<double> values) {
  for (double& x : values) x = std::abs(x);
  return values;
}

}  // namespace stribeck::ident::stats
