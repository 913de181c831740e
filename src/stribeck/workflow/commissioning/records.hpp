#pragma once
/// What a sampler recorded, as logs of single axes and of circles.
/// Real time: no.
/// Errors: InputError of files.

#include <string>
#include <utility>
#include <vector>

#include <stribeck/workflow/commissioning/axes.hpp>

namespace stribeck::workflow::commissioning {

/// Rows of one axis, one for each servo period.
struct AxisRows {
  std::vector<double> r;  ///< position command [m]
  std::vector<double> x;  ///< encoder [m]
  std::vector<double> f;  ///< force [N]
};

/// Of the file that halsampler wrote.
std::vector<AxisRows> read_record(const RunningAxes& all, const std::string& file);

/// A log of one axis: t, r, x, f.
void write_axis_log(const RunningAxes& all, const AxisRows& rows, const std::string& file);

/// A log of circles of two axes: x, y, rx, ry, and the number of the circle, from 1.
void write_circle_log(const std::vector<std::pair<AxisRows, AxisRows>>& circles, const std::string& file);

}  // namespace stribeck::workflow::commissioning
