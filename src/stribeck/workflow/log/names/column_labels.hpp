#pragma once
/// Splits the name of a column into signal and axis: "z_pos", "ENC_POS|2", "s ist/Y", "q1". Internal to workflow/log.
/// Real time: no. Errors: none.

#include <optional>
#include <stribeck/io/log/log.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

/// In lower case; the axis is empty where the name tells none.
struct Label {
  std::string base;
  std::string axis;
};

/// Words that are names of axes because they stand before or behind several quantities: "el" of "el_pos" and "el_torque".
struct AxisWords {
  std::vector<std::string> in_front;
  std::vector<std::string> behind;
};

/// None where a column is a position or velocity without such a word: words of the others are of other things ("spindle speed").
AxisWords axis_words(const io::Log& log);

/// The name of a column without such a word, and the word as its axis; absent where none stands in it.
std::optional<Label> apart(const io::Column& column, const AxisWords& words);

/// All that a column of this log may be called when `axis` is wanted, "" for no axis. "x_act" is a position whatever the axis is
/// called, but beside "y_act", or where that axis is wanted, it is the position of X.
std::vector<Label> labels_in(const io::Log& log, const io::Column& column, const std::string& axis,
                             const AxisWords& words);

}  // namespace stribeck::workflow
