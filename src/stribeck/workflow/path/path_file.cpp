#include <fmt/format.h>

#include <algorithm>
#include <stribeck/io/units.hpp>
#include <stribeck/workflow/path/path_file.hpp>

namespace stribeck::workflow {
namespace {

constexpr std::size_t kMostPoints = 1000000;

std::string list_of(const std::vector<std::string>& names) {
  return fmt::format("{}", fmt::join(names, ", "));
}

std::vector<double> axis_in_si(const io::Log& table, const std::string& axis,
                               const std::vector<std::string>& axes) {
  const io::Column* found = table.find(axis);
  if (found == nullptr) {
    std::vector<std::string> there;
    for (const auto& c : table.columns) there.push_back(c.name);
    throw io::InputError({table.source, 0, axis,
                          fmt::format("no such column, found {} (a path has one column per axis: {})",
                                      list_of(there), list_of(axes))});
  }
  try {
    return io::in_si(*found, quantity("m", "mm"));
  } catch (const io::InputError& e) {
    io::Problem problem = e.problems().front();
    problem.file = table.source;
    throw io::InputError(problem);
  }
}

}  // namespace

PathColumns path_columns(const io::Log& table, const std::vector<std::string>& axes) {
  PathColumns path;
  path.source = table.source;
  path.notes = table.notes;
  if (table.rows > kMostPoints) {
    throw io::InputError(
        {table.source, 0, "",
         fmt::format("got {} points, expected at most {} (leave out points, or run it in parts)", table.rows,
                     kMostPoints)});
  }
  for (const auto& column : table.columns) {
    if (std::find(axes.begin(), axes.end(), column.name) == axes.end()) {
      throw io::InputError(
          {table.source, 0, column.header,
           fmt::format("is not an axis of the path, expected one column per axis: {} (remove it)",
                       list_of(axes))});
    }
  }
  for (const auto& axis : axes) path.axes.push_back(axis_in_si(table, axis, axes));

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
  return path;
}

void refuse_path(const PathColumns& columns, std::size_t index, std::string_view why) {
  const bool at_point = index < columns.rows.size();
  throw io::InputError({columns.source, 0,
                        at_point ? fmt::format("row {}", columns.rows[index]) : std::string(),
                        std::string(why)});
}

}  // namespace stribeck::workflow
