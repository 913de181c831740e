#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stribeck/ident/drive/smoothing/before_filter.hpp>
#include <utility>

namespace stribeck::ident::drive {
namespace {

/// Rows of the line to either side.
std::ptrdiff_t reach_of(double time) {
  constexpr double kLine = 0.2;  // of the time
  return std::max<std::ptrdiff_t>(1, std::lround(kLine * time));
}

}  // namespace

std::vector<double> before_filter(std::span<const double> logged, double time) {
  const auto n = static_cast<std::ptrdiff_t>(logged.size());
  const std::ptrdiff_t h = reach_of(time);
  double squares = 0.0;
  for (std::ptrdiff_t j = 1; j <= h; ++j) squares += 2.0 * static_cast<double>(j * j);
  std::vector<double> out(logged.begin(), logged.end());
  for (std::ptrdiff_t k = 0; k < n; ++k) {
    double slope = 0.0;
    for (std::ptrdiff_t j = 1; j <= h; ++j) {
      const auto after = static_cast<std::size_t>(std::min(k + j, n - 1));
      const auto before = static_cast<std::size_t>(std::max<std::ptrdiff_t>(k - j, 0));
      slope += static_cast<double>(j) * (logged[after] - logged[before]) / squares;
    }
    out[static_cast<std::size_t>(k)] += time * slope;
  }
  return out;
}

void take_off(const ForceFilter& filter, log::Record& record) {
  const double time = filter.time / record.sample_time;
  record.f = before_filter(record.f, time);
  record.filter = filter;
  const auto h = static_cast<std::size_t>(reach_of(time)), n = record.f.size();
  std::vector<std::uint8_t> skip(n, 0);
  for (std::size_t k = 0; k < n; ++k) {
    if (k < h || k + h >= n) skip[k] = 1;
    if (record.skip.empty() || record.skip[k] == 0) continue;
    for (std::size_t j = k > h ? k - h : 0; j < std::min(n, k + h + 1); ++j) skip[j] = 1;
  }
  record.skip = std::move(skip);
}

}  // namespace stribeck::ident::drive
