#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include <stribeck/ident/shown.hpp>
#include <stribeck/targets/steady/table_source.hpp>

namespace stribeck::targets {

namespace {

std::vector<Corner> rounded(std::vector<Corner> points) {
  for (Corner& c : points) {
    c.x = with_digits(c.x, 10);
    c.y = with_digits(c.y, 10);
  }
  return points;
}

std::string numbers(const std::vector<Corner>& points, double Corner::*which) {
  std::string out;
  for (const Corner& c : points) out += fmt::format("{}{:.9e}", out.empty() ? "" : ", ", c.*which);
  return out;
}

}  // namespace

SourceTables::SourceTables(const Axis& axis)
    : positive(rounded(nearest_points(axis, kSourcePoints, 1.0))),
      negative(rounded(nearest_points(axis, kSourcePoints, -1.0))) {}

double SourceTables::at(double v) const noexcept {
  return signed_force(interpolated(v < 0.0 ? negative : positive, std::abs(v)), v);
}

std::string words_of_end(const Axis& axis, const SourceTables& tables) {
  return fmt::format(" Its tables of axis {} end at {}; beyond, the friction stays as it is there.",
                     axis.name,
                     ident::Shown("m", "N", axis.rotary)
                         .speed(std::max(tables.positive.back().x, tables.negative.back().x)));
}

std::string speeds_of(const std::vector<Corner>& points) { return numbers(points, &Corner::x); }
std::string forces_of(const std::vector<Corner>& points) { return numbers(points, &Corner::y); }

StopLists lists_of(const friction::BuildUp& bristles) {
  std::vector<Corner> stops;
  for (const friction::Stop& stop : bristles.stops)
    stops.push_back({stop.weight, 2.0 * stop.weight / stop.reach});
  return {numbers(stops, &Corner::x), numbers(stops, &Corner::y)};
}

}  // namespace stribeck::targets
