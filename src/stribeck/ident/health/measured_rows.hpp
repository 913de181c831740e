#pragma once
/// The rows of the logs of a test, their speeds and places. Inside ident only. Real time: no. Errors: as measured.hpp.

#include <array>
#include <cstddef>
#include <stribeck/core/numbers.hpp>
#include <stribeck/ident/log/record.hpp>
#include <utility>
#include <vector>

namespace stribeck::ident::health {

inline constexpr std::size_t kFewRows = 20;  // of one speed and direction
inline constexpr double kOutside = 1.1;      // speeds beyond the plan by more than this factor are left out

/// The rows of all logs that a test uses.
struct Rows {
  std::vector<double> x, v, a, f;
  std::vector<int> record;
  std::vector<std::size_t> at;  ///< number among the rows that are used
  double duration = 0.0;        ///< [s]

  [[nodiscard]] std::size_t size() const { return x.size(); }
};

/// Sliding rows with the force `shift` rows later than its motion (log::MotionOptions).
Rows rows_of(const std::vector<log::Record>& records, double shift);

/// Speeds at which a jog dwells, ascending; empty: the speed changes all the time.
std::vector<double> constant_speeds(const std::vector<double>& speed);

/// A length or speed with the digits that matter to a reader of the file.
double rounded(double value, double per_unit);

/// Index of the speed below, and the share of the one above.
std::pair<std::size_t, double> between(const std::vector<double>& speeds, double v);

/// Whether the speed is within the plan, or little outside.
bool within(const std::vector<double>& speeds, double v);

/// Number of rows nearest to each speed, towards −x and +x.
std::vector<std::array<std::size_t, 2>> counts_of(const Rows& rows, const std::vector<double>& speeds,
                                                  double from = -kInfinity, double to = kInfinity);

/// Quarters of the travel, where each quarter has rows in both directions at half of the speeds, at least at two.
std::vector<double> borders_of(const Rows& rows, const std::vector<double>& speeds);

}  // namespace stribeck::ident::health
