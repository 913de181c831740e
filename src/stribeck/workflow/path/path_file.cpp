#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <stribeck/io/units.hpp>
#include <stribeck/workflow/path/path_file.hpp>

namespace stribeck::workflow {
namespace {

constexpr std::size_t kMostPoints = 1000000;
/// Beyond this [m] the digits of a double no longer resolve what a machine does.
constexpr double kFarthest = 1e6;
/// No axis follows a shorter path [m].
constexpr double kShortest = 1e-6;

std::string list_of(const std::vector<std::string>& names) {
  return fmt::format("{}", fmt::join(names, ", "));
}

/// [m]; of an axis that turns [rad], which is the arc at a radius of 1 m.
std::vector<double> axis_in_si(const io::Log& table, const std::string& axis,
                               const std::vector<std::string>& axes, bool turns) {
  const io::Column* found = find_axis(table, axis);
  if (found == nullptr) {
    std::vector<std::string> there;
    for (const auto& c : table.columns) there.push_back(c.name);
    throw io::InputError({table.source, 0, axis,
                          fmt::format("no such column, found {} (a path has one column per axis: {})",
                                      list_of(there), list_of(axes))});
  }
  const Quantity angle = quantity("rad", "deg");
  const bool in_angle = turns && io::is_convertible("1 " + found->unit_text, angle);
  try {
    return io::in_si(*found, in_angle ? angle : quantity("m", "mm"));
  } catch (const io::InputError& e) {
    io::Problem problem = e.problems().front();
    problem.file = table.source;
    throw io::InputError(problem);
  }
}

bool same_letters(std::string_view a, std::string_view b) {
  const auto small = [](unsigned char c) { return std::tolower(c); };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](char x, char y) {
    return small(static_cast<unsigned char>(x)) == small(static_cast<unsigned char>(y));
  });
}

void refuse_far_points(const io::Log& table, const PathColumns& path, const std::vector<std::string>& axes) {
  for (std::size_t i = 0; i < axes.size(); ++i) {
    for (std::size_t k = 0; k < table.rows; ++k) {
      const double x = path.axes[i][k];
      if (std::abs(x) <= kFarthest) continue;
      throw io::InputError({table.source, 0, fmt::format("row {}, {}", k + 1, axes[i]),
                            fmt::format("got {:.6g} m, expected at most {:.0f} km from zero (correct the "
                                        "number or the unit of the column)",
                                        x, kFarthest / 1e3)});
    }
  }
}

/// Straight from point to point [m].
double length_of(const PathColumns& path) {
  double length = 0.0;
  for (std::size_t k = 1; k < path.rows.size(); ++k) {
    double square = 0.0;
    for (const auto& x : path.axes) square += (x[k] - x[k - 1]) * (x[k] - x[k - 1]);
    length += std::sqrt(square);
  }
  return length;
}

}  // namespace

io::Log read_path_table(const std::string& file) { return io::read_csv(file, {.unit_after_blank = true}); }

const io::Column* find_axis(const io::Log& table, std::string_view axis) {
  const io::Column* found = nullptr;
  for (const io::Column& column : table.columns) {
    if (!same_letters(column.name, axis)) continue;
    if (found != nullptr) {
      throw io::InputError(
          {table.source, 0, column.header,
           fmt::format("axis {} has a second column, the first is {} (remove one)", axis, found->header)});
    }
    found = &column;
  }
  return found;
}

PathColumns path_columns(const io::Log& table, const std::vector<std::string>& axes,
                         const std::vector<bool>& turns) {
  PathColumns path;
  path.source = table.source;
  path.notes.assign(table.notes.begin(), table.notes.end());
  if (table.rows > kMostPoints) {
    throw io::InputError(
        {table.source, 0, "",
         fmt::format("got {} points, expected at most {} (leave out points, or run it in parts)", table.rows,
                     kMostPoints)});
  }
  for (const auto& column : table.columns) {
    if (std::none_of(axes.begin(), axes.end(),
                     [&](const std::string& axis) { return same_letters(axis, column.name); })) {
      throw io::InputError(
          {table.source, 0, column.header,
           fmt::format("is not an axis of the path, expected one column per axis: {} (remove it)",
                       list_of(axes))});
    }
  }
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const bool rotary = i < turns.size() && turns[i];
    path.axes.push_back(axis_in_si(table, axes[i], axes, rotary));
    if (rotary)
      path.notes.push_back(fmt::format(
          "axis {} turns: it is carried as an arc at a radius of 1 m, 1 deg is 17.45 mm", axes[i]));
  }
  refuse_far_points(table, path, axes);

  const auto same = [&](std::size_t a, std::size_t b) {
    return std::all_of(path.axes.begin(), path.axes.end(), [&](const auto& x) { return x[a] == x[b]; });
  };
  std::size_t merged = 0;
  std::size_t first_merged = 0;
  for (std::size_t k = 0; k < table.rows; ++k) {
    if (!path.rows.empty() && same(path.rows.size() - 1, k)) {
      first_merged = merged++ == 0 ? k + 1 : first_merged;
      continue;
    }
    // Never behind k: points still to be read are not overwritten.
    for (auto& x : path.axes) x[path.rows.size()] = x[k];
    path.rows.push_back(k + 1);
  }
  if (merged > 0) {
    path.notes.push_back(fmt::format(
        "points equal to the one before them were merged: {}, the first in row {}", merged, first_merged));
  }
  if (path.rows.size() > 3 && same(path.rows.size() - 1, 0)) {
    path.closed = true;
    path.rows.pop_back();
    path.notes.emplace_back("the last point is the first: the path is closed");
  }
  for (auto& x : path.axes) x.resize(path.rows.size());
  if (const double length = length_of(path); path.rows.size() > 1 && length < kShortest) {
    throw io::InputError(
        {table.source,
         0,
         {},
         fmt::format("the path is {:.3g} um long, expected at least {:.0f} um (correct the numbers or the "
                     "units of the columns)",
                     length * 1e6, kShortest * 1e6)});
  }
  return path;
}

void refuse_path(const PathColumns& columns, std::size_t index, std::string_view why) {
  const bool at_point = index < columns.rows.size();
  throw io::InputError({columns.source, 0,
                        at_point ? fmt::format("row {}", columns.rows[index]) : std::string(),
                        std::string(why)});
}

}  // namespace stribeck::workflow
