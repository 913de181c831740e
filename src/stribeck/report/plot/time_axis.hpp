#pragma once
/// The horizontal axis of a drawing over the time of a log. Stamps of a clock (seconds since 1970) leave no room for readable numbers:
/// such a log is drawn over the time since its first row, and the label says so.
/// Real time: no.

#include <string>
#include <vector>

namespace stribeck::report {

struct TimeAxis {
  double origin = 0.0;  ///< to subtract from every time of the log [s]
  std::string label = "time [s]";
};

/// For the times of a record [s]; those that are not finite do not count.
TimeAxis time_axis(const std::vector<double>& t);

}  // namespace stribeck::report
