#pragma once
/// The times of a log's columns, which may have been sampled at different rates.
///
/// Real time: no.
/// Errors: InputError naming the file.

#include <map>
#include <stribeck/workflow/log/columns.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

class LogTimes {
 public:
  explicit LogTimes(const AxisColumns& columns);

  /// Index of the time column of another column; −1: there is none.
  [[nodiscard]] int index_of(const io::Column& column) const;
  /// Values of that time column [s], converted once.
  const std::vector<double>& seconds(int index);

 private:
  const io::Log& log_;
  std::string axis_;
  int mapped_ = -1;
  std::string unit_;  ///< from --map; empty: the file's own
  std::map<int, std::vector<double>> converted_;
};

}  // namespace stribeck::workflow
