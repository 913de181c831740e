#pragma once
/// Distributions of a factor of a study, as its file writes them and as the study draws from them.
///
///   uniform      low … high                     log-uniform   the same in the logarithm
///   normal       mean, sd                       log-normal    median, sigma: standard deviation of the natural logarithm
///   list         values, equally likely         steps         `points` values from low to high, equally likely
///
/// AnyDistribution<std::string> is what a file holds: texts with units. Distribution has the numbers in SI. A value is drawn by the
/// inverse of the distribution function at a share u in (0, 1), so that any design of shares (design.hpp) can be used.
/// A normal and a log-normal end at `low` and `high`, or where these are left out 5 standard deviations from the middle
/// (6e-7 of the draws lie beyond). A distribution therefore has a smallest and a largest value, which are checked before the first run.
/// Real time: no.

#include <array>
#include <cstdint>
#include <optional>
#include <stribeck/core/fields.hpp>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace stribeck::sim {

template <class T>
struct Uniform {
  static constexpr std::string_view kKind = "uniform";
  T low{};
  T high{};

  static constexpr auto fields() {
    return std::tuple{field("low", &Uniform::low, "smallest value"),
                      field("high", &Uniform::high, "largest value")};
  }
};

template <class T>
struct LogUniform {
  static constexpr std::string_view kKind = "log-uniform";
  T low{};
  T high{};

  static constexpr auto fields() {
    return std::tuple{field("low", &LogUniform::low, "smallest value, above 0"),
                      field("high", &LogUniform::high, "largest value")};
  }
};

template <class T>
struct Normal {
  static constexpr std::string_view kKind = "normal";
  T mean{};
  T sd{};
  std::optional<T> low;
  std::optional<T> high;

  static constexpr auto fields() {
    return std::tuple{
        field("mean", &Normal::mean, "mean"), field("sd", &Normal::sd, "standard deviation"),
        field("low", &Normal::low, "smallest value; left out: 5 sd below the mean").or_default(),
        field("high", &Normal::high, "largest value; left out: 5 sd above the mean").or_default()};
  }
};

template <class T>
struct LogNormal {
  static constexpr std::string_view kKind = "log-normal";
  T median{};
  double sigma = 0.0;
  std::optional<T> low;
  std::optional<T> high;

  static constexpr auto fields() {
    return std::tuple{
        field("median", &LogNormal::median, "median, above 0"),
        field("sigma", &LogNormal::sigma, pure_number(), "standard deviation of the natural logarithm"),
        field("low", &LogNormal::low, "smallest value; left out: 5 sigma below the median").or_default(),
        field("high", &LogNormal::high, "largest value; left out: 5 sigma above the median").or_default()};
  }
};

template <class T>
struct ListOf {
  static constexpr std::string_view kKind = "list";
  std::vector<T> values;

  static constexpr auto fields() {
    return std::tuple{field("values", &ListOf::values, "the values, equally likely")};
  }
};

template <class T>
struct Steps {
  static constexpr std::string_view kKind = "steps";
  T low{};
  T high{};
  std::int64_t points = 0;

  static constexpr auto fields() {
    return std::tuple{field("low", &Steps::low, "first value"), field("high", &Steps::high, "last value"),
                      field("points", &Steps::points, pure_number().at_least(2.0).at_most(1e9),
                            "number of values, at even distance and equally likely")};
  }
};

template <class T>
using AnyDistribution = std::variant<Uniform<T>, LogUniform<T>, Normal<T>, LogNormal<T>, ListOf<T>, Steps<T>>;
using Distribution = AnyDistribution<double>;

/// What is wrong with it, as "key: what"; empty: nothing.
std::string problem(const Distribution& d);

/// The value below which a share u in (0, 1) of the draws lies. The distribution must be without a problem.
double value_at(const Distribution& d, double u);

/// Smallest and largest value.
std::array<double, 2> support(const Distribution& d);

/// Number of values; 0 for a continuous distribution.
std::uint64_t number_of_values(const Distribution& d);
/// Value number i of a distribution that has that many.
double value_number(const Distribution& d, std::uint64_t i);

}  // namespace stribeck::sim
