#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <stribeck/report/plot/time_axis.hpp>

namespace stribeck::report {

TimeAxis time_axis(const std::vector<double>& t) {
  constexpr double kMostLengths = 1e3;  // from zero to the first row, in lengths of the record
  double first = std::numeric_limits<double>::quiet_NaN();
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const double at : t) {
    if (!std::isfinite(at)) continue;
    if (std::isnan(first)) first = at;
    low = std::fmin(low, at);
    high = std::fmax(high, at);
  }
  if (!(std::abs(first) > kMostLengths * (high - low))) return {};
  return {first, fmt::format("time since the first row, {:.10g} s [s]", first)};
}

}  // namespace stribeck::report
