#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <stribeck/report/board/board_parts.hpp>
#include <stribeck/report/text.hpp>
#include <utility>

namespace stribeck::report {
namespace {

constexpr std::string_view kLostWord = "lost";
constexpr std::size_t kName = 17;
constexpr std::size_t kNumber = 9;
constexpr std::size_t kInterval = 15;

std::string line_of(const std::vector<std::pair<std::string, std::size_t>>& cells) {
  std::string line;
  for (std::size_t i = 0; i < cells.size(); ++i)
    line += i == 0 ? left_aligned(cells[i].first, cells[i].second)
                   : right_aligned(cells[i].first, cells[i].second);
  return line + "\n";
}

std::string entrant_of(const BoardEntrant& e) { return e.id + (e.outside ? " *" : ""); }

std::size_t count_of(const std::vector<std::string>& failures) {
  return static_cast<std::size_t>(
      std::count_if(failures.begin(), failures.end(), [](const std::string& f) { return !f.empty(); }));
}

/// Reasons with their numbers, in the order in which they came first.
void add_reasons(const BoardEntrant& who, const std::string& where, const std::vector<std::string>& failures,
                 const std::vector<std::string>& cases, std::vector<std::string>& out) {
  std::vector<std::pair<std::string, std::vector<std::size_t>>> reasons;
  for (std::size_t i = 0; i < failures.size(); ++i) {
    if (failures[i].empty()) continue;
    auto found =
        std::find_if(reasons.begin(), reasons.end(), [&](const auto& r) { return r.first == failures[i]; });
    if (found == reasons.end()) found = reasons.insert(reasons.end(), {failures[i], {}});
    found->second.push_back(i);
  }
  constexpr std::size_t kMost = 3;
  for (std::size_t r = 0; r < reasons.size(); ++r) {
    if (r == kMost) {
      out.push_back(
          fmt::format("{}{}: {} further reasons (--json lists all)", who.id, where, reasons.size() - kMost));
      break;
    }
    const auto& [why, which] = reasons[r];
    out.push_back(fmt::format(
        "{}{} failed on {}{}: {}", who.id, where, cases[which.front()],
        which.size() > 1 ? fmt::format(" and {} more", which.size() - 1) : std::string(), clean_text(why)));
  }
}

}  // namespace

std::size_t IdentificationRow::failed() const { return count_of(failures); }
std::size_t ControlRow::failed() const { return count_of(failures); }

std::string board_in_words(const BoardResult& r) {
  return fmt::format("{} machine{} of two axes, drawn with seed {}", r.machines.size(),
                     r.machines.size() == 1 ? "" : "s", r.seed);
}

std::vector<std::string> board_motions(const BoardResult& r) {
  std::vector<std::string> all;
  for (const ControlRow& row : r.control) {
    if (std::find(all.begin(), all.end(), row.motion) == all.end()) all.push_back(row.motion);
  }
  return all;
}

std::string board_number(double value, std::string_view infinite) {
  if (std::isinf(value)) return std::string(infinite);
  if (!std::isfinite(value)) return "–";
  return significant(value, 3);
}

std::string board_interval(const sim::Confident& c, std::string_view infinite) {
  if (std::isnan(c.low) && std::isnan(c.high)) return {};
  return fmt::format("{}–{}", board_number(c.low, infinite),
                     std::isnan(c.high) ? "?" : board_number(c.high, infinite));
}

std::string covered_in_words(const IdentificationRow& row) {
  return std::isnan(row.covered.value) ? "none" : decimals(row.covered.value, 0) + " %";
}

std::vector<std::string> failures_in_words(const BoardResult& r) {
  std::vector<std::string> all;
  for (const IdentificationRow& row : r.identification)
    add_reasons(row.entrant, "", row.failures, r.axes, all);
  for (const ControlRow& row : r.control)
    add_reasons(row.entrant, " on the " + row.motion, row.failures, r.machines, all);
  for (const ControlRow& row : r.control) {
    if (row.lost > 0)
      all.push_back(fmt::format("{} on the {} lost the path on {} of {} machines", row.entrant.id, row.motion,
                                row.lost, r.machines.size()));
  }
  return all;
}

std::string cost_in_words(const BoardCost& cost) {
  if (std::isnan(cost.seconds)) return "–";
  const std::string time = cost.seconds < 1e-6 ? significant(1e9 * cost.seconds, 2) + " ns"
                                               : significant(1e6 * cost.seconds, 2) + " µs";
  return cost.over_a_pipe ? time + " over the pipe" : time;
}

std::string text_table(const BoardResult& r) {
  std::string text = board_in_words(r) + ".\n";
  if (!r.identification.empty()) {
    text += "\nIdentification: errors in %, median and 99 % over the axes\n\n";
    text += line_of({{"entry", kName},
                     {"curve", kNumber},
                     {"95 %", kInterval},
                     {"99 %", kNumber},
                     {"mass", kNumber},
                     {"unseen", kNumber},
                     {"covered", kNumber},
                     {"± %", kNumber},
                     {"failed", kNumber}});
    for (const IdentificationRow& row : r.identification) {
      text += line_of({{entrant_of(row.entrant), kName},
                       {board_number(row.curve_error.median.value), kNumber},
                       {board_interval(row.curve_error.median), kInterval},
                       {board_number(row.curve_error.p99.value), kNumber},
                       {board_number(row.mass_error.median.value), kNumber},
                       {board_number(row.held_out_error.median.value), kNumber},
                       {covered_in_words(row), kNumber},
                       {board_number(row.half_width), kNumber},
                       {std::to_string(row.failed()), kNumber}});
    }
  }
  for (const std::string& motion : board_motions(r)) {
    text += fmt::format("\nControl, {}: contour error in µm, median and 99 % over the machines\n\n", motion);
    text += line_of({{"entry", kName},
                     {"max", kNumber},
                     {"95 %", kInterval},
                     {"99 %", kNumber},
                     {"RMS", kNumber},
                     {"99 %", kNumber},
                     {"|Δu| mV", kNumber},
                     {"lost", kNumber},
                     {"failed", kNumber}});
    for (const ControlRow& row : r.control) {
      if (row.motion != motion) continue;
      text += line_of({{entrant_of(row.entrant), kName},
                       {board_number(row.max_error.median.value, kLostWord), kNumber},
                       {board_interval(row.max_error.median, kLostWord), kInterval},
                       {board_number(row.max_error.p99.value, kLostWord), kNumber},
                       {board_number(row.rms.median.value, kLostWord), kNumber},
                       {board_number(row.rms.p99.value, kLostWord), kNumber},
                       {board_number(row.input_variation.median.value, kLostWord), kNumber},
                       {std::to_string(row.lost), kNumber},
                       {std::to_string(row.failed()), kNumber}});
    }
  }
  if (!r.costs.empty()) {
    text += "\nTime of a step of two axes, which differs from run to run\n\n";
    for (const BoardCost& cost : r.costs)
      text += "  " + left_aligned(cost.id, kName) + cost_in_words(cost) + "\n";
  }
  const auto has_outside = [](const auto& rows) {
    return std::any_of(rows.begin(), rows.end(), [](const auto& row) { return row.entrant.outside; });
  };
  if (has_outside(r.identification) || has_outside(r.control)) text += "\n* given by the user\n";
  return text;
}

}  // namespace stribeck::report
