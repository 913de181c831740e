// The choice among candidates that were judged on held-out blocks: pick() of static_fit.hpp.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <stribeck/ident/map/static_fit.hpp>

namespace stribeck::ident::map {
namespace {

constexpr double kOfError = 0.01;     // less of the error does not count
constexpr double kOfFriction = 0.01;  // a force of this size does
constexpr double kSure = 3.0;         // standard errors

}  // namespace

Picked pick(const std::vector<std::vector<double>>& loss, const std::vector<std::size_t>& complexity,
            const std::vector<std::size_t>& parameters, double rows, double friction) {
  const auto m = static_cast<double>(loss.front().size());
  std::vector<double> mean;
  for (const auto& l : loss) mean.push_back(std::accumulate(l.begin(), l.end(), 0.0) / rows);
  const auto best = static_cast<std::size_t>(std::min_element(mean.begin(), mean.end()) - mean.begin());
  // Standard error of the difference of two means, from the differences of the blocks.
  const auto error_between = [&](std::size_t a, std::size_t b) {
    const double fold_mean = (mean[a] - mean[b]) * rows / m;
    double square = 0.0;
    for (std::size_t k = 0; k < loss[a].size(); ++k)
      square += std::pow(loss[a][k] - loss[b][k] - fold_mean, 2.0);
    return std::sqrt(square * m / (m - 1.0)) / rows;
  };
  Picked p;
  p.chosen = best;
  for (std::size_t n = 0; n < loss.size(); ++n) {
    const double error = error_between(n, best);
    p.rms.push_back(std::sqrt(std::max(0.0, mean[n])));
    p.error.push_back(p.rms.back() > 0.0 ? error / (2.0 * p.rms.back()) : 0.0);
    const double little = std::min(2.0 * kOfError * mean[best], std::pow(kOfFriction * friction, 2.0));
    p.equal.push_back(mean[n] - mean[best] <= std::max(error, little));
    if (p.equal.back() && complexity[n] < complexity[p.chosen]) p.chosen = n;
  }
  // A law of another exponent is no richer: a difference that is sure counts, however small it is.
  for (std::size_t n = 0; n < loss.size(); ++n) {
    if (n == p.chosen || parameters[n] != parameters[p.chosen] || !(mean[n] < mean[p.chosen])) continue;
    if (mean[p.chosen] - mean[n] > kSure * error_between(n, p.chosen)) p.chosen = n;
  }
  return p;
}

}  // namespace stribeck::ident::map
