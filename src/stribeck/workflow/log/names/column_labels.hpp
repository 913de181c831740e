#pragma once
/// Splits the name of a column into signal and axis: "z_pos", "ENC_POS|2", "s ist/Y", "q1". Internal to workflow/log.
/// Real time: no. Errors: none.

#include <stribeck/io/log/log.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

/// In lower case; the axis is empty where the name tells none.
struct Label {
  std::string base;
  std::string axis;
};

/// All that a column of this log may be called when `axis` is wanted, "" for no axis. "x_act" is a position whatever the axis is
/// called, but beside "y_act", or where that axis is wanted, it is the position of X.
std::vector<Label> labels_in(const io::Log& log, const io::Column& column, const std::string& axis);

}  // namespace stribeck::workflow
