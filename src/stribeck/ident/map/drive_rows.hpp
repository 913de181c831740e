#pragma once
/// Rows of sliding motion, sorted into bins of speed for each direction, and the mean friction of each bin, without a model.
/// Inside ident only.
/// Real time: no.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stribeck/ident/log/motion.hpp>
#include <vector>

namespace stribeck::ident::map {

inline constexpr int kSides = 2;  ///< 0: v > 0, 1: v < 0
inline constexpr std::array<double, kSides> kDirection{1.0, -1.0};
inline constexpr std::array<const char*, kSides> kSideName{"positive", "negative"};

inline int side_of(double v) { return v > 0.0 ? 0 : 1; }

/// Bins of speed of one direction: of equal width from `knee` to `high`; below, where slow steady motion was recorded too, of equal
/// ratio from `low` to `knee`.
struct Grid {
  double low = 0.0;   ///< [m/s]
  double high = 0.0;  ///< [m/s]
  int bins = 1;       ///< of both kinds
  double knee = 0.0;  ///< [m/s]; without slow bins it is not used
  int slow_bins = 0;

  [[nodiscard]] int bin(double speed) const noexcept;
  /// Slowest speed of a bin [m/s].
  [[nodiscard]] double left(int bin) const noexcept;
  /// Width of the bin with this speed [m/s].
  [[nodiscard]] double width(double speed) const noexcept;

 private:
  [[nodiscard]] double equal_from() const noexcept { return slow_bins > 0 ? knee : low; }
};

inline int Grid::bin(double speed) const noexcept {
  if (slow_bins > 0 && speed < knee) {
    const double place = std::log(std::max(speed, low) / low) / std::log(knee / low) * slow_bins;
    return std::clamp(static_cast<int>(place), 0, slow_bins - 1);
  }
  const int equal = bins - slow_bins;
  const double place = (speed - equal_from()) / (high - equal_from()) * equal;
  return slow_bins + std::clamp(static_cast<int>(place), 0, equal - 1);
}

inline double Grid::left(int bin) const noexcept {
  if (bin < slow_bins) return low * std::pow(knee / low, static_cast<double>(bin) / slow_bins);
  return equal_from() + (high - equal_from()) * (bin - slow_bins) / (bins - slow_bins);
}

inline double Grid::width(double speed) const noexcept {
  if (slow_bins > 0 && speed < knee) return left(bin(speed) + 1) - left(bin(speed));
  return (high - equal_from()) / (bins - slow_bins);
}

/// Mean over each bin, joined by straight lines.
struct BinCurve {
  Grid grid;
  std::vector<double> speed, force, weight;  ///< occupied bins; force against the motion
  std::vector<int> next;  ///< first occupied bin whose mean speed is above the left edge of the bin

  void build(const Grid& g, const std::vector<double>& n, const std::vector<double>& sum_v,
             const std::vector<double>& sum_f);
  [[nodiscard]] double operator()(double s) const noexcept;
  /// Straight line through the bins.
  struct Line {
    double level = 0.0;  ///< [N]
    double slope = 0.0;  ///< [N·s/m]
  };
  [[nodiscard]] Line line() const;
};

inline double BinCurve::operator()(double s) const noexcept {
  if (s <= speed.front()) return force.front();
  if (s >= speed.back()) return force.back();
  auto i = static_cast<std::size_t>(next[static_cast<std::size_t>(grid.bin(s))]);
  while (speed[i] < s) ++i;
  if (i == 0) return force.front();
  const double share = (s - speed[i - 1]) / (speed[i] - speed[i - 1]);
  return force[i - 1] + share * (force[i] - force[i - 1]);
}

/// Rows that are used, of all records in a row.
struct Rows {
  std::vector<int> record;
  std::vector<std::size_t> at;  ///< row of the record
  std::vector<int> stretch;     ///< counted over all records
  std::vector<std::uint8_t> side;
  std::vector<int> bin;
  std::vector<double> lag;  ///< by how much friction lags behind its steady state, signed [N]

  [[nodiscard]] std::size_t size() const noexcept { return at.size(); }
  void reserve(std::size_t rows);
  void clear();  ///< keeps the memory allocated
};

/// Number of peaks of the smoothed map less its straight line; the border at the highest speed counts as a peak if the map rises
/// to it (thesis §2.4.3).
int peaks_of(const BinCurve& map);

}  // namespace stribeck::ident::map
