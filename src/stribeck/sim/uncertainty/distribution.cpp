#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <limits>
#include <stribeck/sim/uncertainty/distribution.hpp>

namespace stribeck::sim {
namespace {

/// Where a normal distribution ends that has no end of its own [standard deviations].
constexpr double kEnd = 5.0;

double probability_below(double z) { return boost::math::cdf(boost::math::normal_distribution<double>(), z); }

/// Quantile of a standard normal distribution that ends at z[0] and z[1].
double between(const std::array<double, 2>& z, double u) {
  // In the lower half, where probabilities keep their digits; the upper half is its mirror.
  if (z[0] + z[1] > 0.0) return -between({-z[1], -z[0]}, 1.0 - u);
  const double a = probability_below(z[0]);
  const double b = probability_below(z[1]);
  const double p = std::clamp(a + u * (b - a), std::numeric_limits<double>::min(), 1.0 - 1e-16);
  return std::clamp(boost::math::quantile(boost::math::normal_distribution<double>(), p), z[0], z[1]);
}

/// Ends of a normal distribution in standard deviations.
std::array<double, 2> ends(const Normal<double>& d) {
  return {d.low ? (*d.low - d.mean) / d.sd : -kEnd, d.high ? (*d.high - d.mean) / d.sd : kEnd};
}
std::array<double, 2> ends(const LogNormal<double>& d) {
  return {d.low ? std::log(*d.low / d.median) / d.sigma : -kEnd,
          d.high ? std::log(*d.high / d.median) / d.sigma : kEnd};
}

std::string instead_of(std::string_view key, double value, std::string_view what) {
  return fmt::format("{}: got {:.6g}, expected {}", key, value, what);
}

constexpr auto kLowFirst = "high: expected a value above low, or nothing varies";

/// Ends beyond what a double can tell from the tail hold no probability.
std::string of_ends(const std::array<double, 2>& z) {
  if (!(z[0] < z[1])) return kLowFirst;
  if (z[0] > 30.0 || z[1] < -30.0)
    return "low: expected a range that the distribution reaches, within 30 standard deviations";
  return {};
}

std::string wrong(const Uniform<double>& d) { return d.low < d.high ? std::string() : kLowFirst; }
std::string wrong(const LogUniform<double>& d) {
  if (!(d.low > 0.0)) return instead_of("low", d.low, "a value above 0, whose logarithm exists");
  return d.low < d.high ? std::string() : kLowFirst;
}
std::string wrong(const Normal<double>& d) {
  if (!(d.sd > 0.0)) return instead_of("sd", d.sd, "a standard deviation above 0");
  return of_ends(ends(d));
}
std::string wrong(const LogNormal<double>& d) {
  if (!(d.median > 0.0)) return instead_of("median", d.median, "a median above 0, whose logarithm exists");
  if (!(d.sigma > 0.0)) return instead_of("sigma", d.sigma, "a standard deviation above 0");
  if (d.sigma > 10.0) return instead_of("sigma", d.sigma, "at most 10: a factor of 22000 for each sigma");
  if (d.low && !(*d.low > 0.0)) return instead_of("low", *d.low, "a value above 0");
  if (d.high && !(*d.high > 0.0)) return instead_of("high", *d.high, "a value above 0");
  return of_ends(ends(d));
}
std::string wrong(const ListOf<double>& d) {
  return d.values.empty() ? "values: got an empty list, expected one value or more" : std::string();
}
std::string wrong(const Steps<double>& d) {
  if (d.points < 2) return instead_of("points", static_cast<double>(d.points), "2 or more");
  return d.low < d.high ? std::string() : kLowFirst;
}

double at(const Uniform<double>& d, double u) { return d.low + u * (d.high - d.low); }
double at(const LogUniform<double>& d, double u) {
  return std::clamp(d.low * std::pow(d.high / d.low, u), d.low, d.high);
}
double at(const Normal<double>& d, double u) {
  const double x = d.mean + d.sd * between(ends(d), u);
  return std::clamp(x, d.low.value_or(x), d.high.value_or(x));
}
double at(const LogNormal<double>& d, double u) {
  const double x = d.median * std::exp(d.sigma * between(ends(d), u));
  return std::clamp(x, d.low.value_or(x), d.high.value_or(x));
}
double number(const ListOf<double>& d, std::uint64_t i) { return d.values[i]; }
double number(const Steps<double>& d, std::uint64_t i) {
  const double share = static_cast<double>(i) / static_cast<double>(d.points - 1);
  return i + 1 == static_cast<std::uint64_t>(d.points) ? d.high : d.low + share * (d.high - d.low);
}

template <class D>
concept Discrete = requires(const D& d) {
  number(d, 0);
};

}  // namespace

std::string problem(const Distribution& d) {
  return std::visit([](const auto& one) { return wrong(one); }, d);
}

double value_at(const Distribution& d, double u) {
  return std::visit(
      [&](const auto& one) {
        if constexpr (Discrete<decltype(one)>) {
          const std::uint64_t n = number_of_values(d);
          const auto i = static_cast<std::uint64_t>(u * static_cast<double>(n));
          return number(one, std::min(i, n - 1));
        } else {
          return at(one, u);
        }
      },
      d);
}

std::array<double, 2> support(const Distribution& d) {
  struct Ends {
    std::array<double, 2> operator()(const Uniform<double>& o) const { return {o.low, o.high}; }
    std::array<double, 2> operator()(const LogUniform<double>& o) const { return {o.low, o.high}; }
    std::array<double, 2> operator()(const Normal<double>& o) const {
      return {o.low.value_or(o.mean - kEnd * o.sd), o.high.value_or(o.mean + kEnd * o.sd)};
    }
    std::array<double, 2> operator()(const LogNormal<double>& o) const {
      const double factor = std::exp(kEnd * o.sigma);
      return {o.low.value_or(o.median / factor), o.high.value_or(o.median * factor)};
    }
    std::array<double, 2> operator()(const ListOf<double>& o) const {
      const auto [low, high] = std::minmax_element(o.values.begin(), o.values.end());
      return {*low, *high};
    }
    std::array<double, 2> operator()(const Steps<double>& o) const { return {o.low, o.high}; }
  };
  return std::visit(Ends(), d);
}

std::uint64_t number_of_values(const Distribution& d) {
  if (const auto* list = std::get_if<ListOf<double>>(&d)) return list->values.size();
  if (const auto* steps = std::get_if<Steps<double>>(&d)) return static_cast<std::uint64_t>(steps->points);
  return 0;
}

double value_number(const Distribution& d, std::uint64_t i) {
  if (const auto* list = std::get_if<ListOf<double>>(&d)) return list->values[i];
  return number(std::get<Steps<double>>(d), i);
}

}  // namespace stribeck::sim
