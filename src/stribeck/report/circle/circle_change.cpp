#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <stribeck/core/numbers.hpp>
#include <stribeck/ident/stats/quantiles.hpp>
#include <stribeck/io/json.hpp>
#include <stribeck/report/circle/circle_change.hpp>
#include <stribeck/report/circle/circle_parts.hpp>
#include <stribeck/report/columns.hpp>
#include <stribeck/report/factors.hpp>
#include <stribeck/report/text.hpp>

namespace stribeck::report {
namespace {

using ident::circle::LapTest;
using ident::circle::QuadrantPeak;

constexpr double kNotKnown = std::numeric_limits<double>::quiet_NaN();

struct LapMean {
  double mean = 0.0;
  double variance = kNotKnown;  ///< of the mean
  double freedom = 0.0;
};

LapMean mean_of(const std::vector<LapTest>& laps, double LapTest::*figure) {
  const auto n = static_cast<double>(laps.size());
  LapMean m;
  for (const LapTest& lap : laps) m.mean += lap.*figure / n;
  if (laps.size() < 2) return m;
  double squares = 0.0;
  for (const LapTest& lap : laps) squares += (lap.*figure - m.mean) * (lap.*figure - m.mean);
  m.freedom = n - 1.0;
  m.variance = squares / m.freedom / n;
  return m;
}

/// Half the 95 % interval of the difference of two means, after Welch.
double half_width_of(const LapMean& a, const LapMean& b) {
  const double variance = a.variance + b.variance;
  if (!(variance > 0.0)) return variance;  // NaN, or laps without any scatter
  const double freedom =
      variance * variance / (a.variance * a.variance / a.freedom + b.variance * b.variance / b.freedom);
  return ident::stats::student_factor(freedom) * std::sqrt(variance);
}

std::string short_direction(bool counter_clockwise) { return counter_clockwise ? "ccw" : "cw"; }

void add_lap_changes(std::vector<CircleChange>& out, const CircleLog& before, const CircleLog& after) {
  if (!before.test || !after.test) return;
  static constexpr std::array<std::pair<const char*, double LapTest::*>, 3> kFigures{
      {{"max", &LapTest::max_error}, {"RMS", &LapTest::rms}, {"G", &LapTest::circular_deviation}}};
  for (const auto& a : before.test->directions) {
    for (const auto& b : after.test->directions) {
      if (a.counter_clockwise != b.counter_clockwise || a.laps.empty() || b.laps.empty()) continue;
      for (const auto& [name, figure] : kFigures) {
        const LapMean x = mean_of(a.laps, figure);
        const LapMean y = mean_of(b.laps, figure);
        out.push_back({name, short_direction(a.counter_clockwise), x.mean, y.mean, half_width_of(x, y)});
      }
    }
  }
}

/// NaN as its variance: one lap.
LapMean lap_mean_of(const QuadrantPeak& p) {
  const double laps = p.laps;
  return {p.height, p.repeatability * p.repeatability / laps, laps - 1.0};
}

void add_peak_changes(std::vector<CircleChange>& out, const CircleLog& before, const CircleLog& after) {
  if (!before.diagnosis || !after.diagnosis) return;
  constexpr double kSamePlace = kPi / 8.0;
  constexpr double kClear = 2.0;  // half widths of a peak that is one
  for (const QuadrantPeak& a : before.diagnosis->peaks) {
    for (const QuadrantPeak& b : after.diagnosis->peaks) {
      if (a.axis != b.axis || a.counter_clockwise != b.counter_clockwise ||
          std::abs(std::remainder(a.angle - b.angle, 2.0 * kPi)) > kSamePlace)
        continue;
      const bool none =
          std::abs(a.height) < kClear * a.half_width_95 && std::abs(b.height) < kClear * b.half_width_95;
      if (none) continue;
      const double of_laps = half_width_of(lap_mean_of(a), lap_mean_of(b));
      out.push_back({"peak " + peak_name(*before.diagnosis, a), short_direction(a.counter_clockwise),
                     a.height, b.height, std::hypot(a.half_width_95, b.half_width_95, of_laps)});
    }
  }
}

std::string heading_of(const CircleLog& before, const CircleLog& after) {
  return fmt::format("Change from {} to {}", clean_text(before.label), clean_text(after.label));
}

std::string signed_micrometres(double metres) { return with_sign(metres * kMicro, 2); }

std::string spread_of(const CircleChange& c) {
  return std::isfinite(c.half_width) ? "± " + significant(c.half_width * kMicro, 2) : "";
}

constexpr const char* kRepeatability =
    "max, RMS and G are means over whole laps; a peak is that of the table of causes. ±: 95 % interval of the difference, from the scatter "
    "of the laps of both measurements. A change within it may be chance: record more laps. A machine warmed up or set up anew in between "
    "scatters more than its laps do.";

}  // namespace

std::string_view CircleChange::verdict() const {
  if (!std::isfinite(half_width)) return "not known: one lap";
  if (std::abs(difference()) <= half_width) return "within the repeatability";
  const bool turned = before * after < 0.0 && std::abs(after) > half_width;
  if (turned && std::abs(std::abs(after) - std::abs(before)) <= half_width)
    return after < 0.0 ? "turned round (overcompensated)" : "turned round";
  if (std::abs(after) < std::abs(before)) return turned ? "smaller, turned round" : "smaller";
  return turned ? "larger, turned round" : "larger";
}

std::vector<CircleChange> circle_changes(const CircleLog& before, const CircleLog& after) {
  std::vector<CircleChange> out;
  add_lap_changes(out, before, after);
  add_peak_changes(out, before, after);
  return out;
}

const std::vector<std::string>& limited_figures() {
  static const std::vector<std::string> kNames{"max", "RMS", "glitch", "G", "G(b)", "F", "D", "H"};
  return kNames;
}

double limited_figure(const CircleLog& log, std::string_view figure) {
  const auto largest_of = [&](double ident::circle::CircleTest::*member) {
    double most = kNotKnown;
    for (const auto& circle : log.circles) most = std::fmax(most, std::abs(circle.*member));
    return most;
  };
  if (figure == "max") return largest_of(&ident::circle::CircleTest::max_error);
  if (figure == "RMS") return largest_of(&ident::circle::CircleTest::rms);
  if (figure == "glitch") return largest_of(&ident::circle::CircleTest::quadrant_glitch);
  if (figure == "G") return largest_of(&ident::circle::CircleTest::circular_deviation);
  if (!log.test) return kNotKnown;
  if (figure == "G(b)") return log.test->bidirectional.value_or(kNotKnown);
  if (figure == "H") return log.test->hysteresis.value_or(kNotKnown);
  if (figure == "D") return std::abs(log.test->mean_radial_deviation);
  double most = kNotKnown;
  for (const auto& d : log.test->directions)
    most = std::fmax(most, std::fmax(std::abs(d.radial_max), std::abs(d.radial_min)));
  return most;
}

std::vector<CircleVerdict> circle_verdicts(const CircleReportInput& input) {
  std::vector<CircleVerdict> out;
  for (const CircleLog& log : input.logs) {
    const bool before = input.logs.size() > 1 && !input.together && &log == &input.logs.front();
    for (const CircleLimit& limit : input.limits)
      out.push_back({log.label, limit.figure, limited_figure(log, limit.figure), limit.most, before});
  }
  return out;
}

bool within_limits(const CircleReportInput& input) {
  const std::vector<CircleVerdict> all = circle_verdicts(input);
  return std::all_of(all.begin(), all.end(), [](const CircleVerdict& v) { return v.before || v.passed(); });
}

std::string changes_text(const CircleReportInput& input) {
  std::string out;
  if (input.together) return out;  // feeds of one machine are no before and after
  for (std::size_t i = 1; i < input.logs.size(); ++i) {
    const std::vector<CircleChange> all = circle_changes(input.logs.front(), input.logs[i]);
    if (all.empty()) continue;
    std::vector<TextColumn> columns{{"figure", "", {}, false}, {"", "", {}, false},  {"before", "µm", {}},
                                    {"after", "µm", {}},       {"change", "µm", {}}, {"±", "µm", {}},
                                    {"", "", {}, false}};
    for (const CircleChange& c : all) {
      std::size_t k = 0;
      for (const std::string& entry :
           {c.figure, c.direction, micrometres(c.before), micrometres(c.after),
            signed_micrometres(c.difference()),
            std::isfinite(c.half_width) ? significant(c.half_width * kMicro, 2) : "–",
            std::string(c.verdict())})
        columns[k++].entries.push_back(entry);
    }
    out += heading_of(input.logs.front(), input.logs[i]) + "\n" + lay_out(columns) + "\n";
  }
  return out;
}

void add_changes(Page& page, const CircleReportInput& input) {
  if (input.together) return;
  for (std::size_t i = 1; i < input.logs.size(); ++i) {
    const std::vector<CircleChange> all = circle_changes(input.logs.front(), input.logs[i]);
    if (all.empty()) continue;
    page.section(heading_of(input.logs.front(), input.logs[i]));
    Table table;
    table.columns = {{"figure", "", false}, {"direction", "", false},
                     {"before", "µm"},      {"after", "µm"},
                     {"change", "µm"},      {"beyond the repeatability?", "", false}};
    for (const CircleChange& c : all) {
      const bool certain = std::isfinite(c.half_width) && std::abs(c.difference()) > c.half_width;
      table.rows.push_back(
          {Cell{.text = c.figure}, Cell{.text = c.direction}, Cell{.text = micrometres(c.before)},
           Cell{.text = micrometres(c.after)},
           Cell{.text = signed_micrometres(c.difference()), .spread = spread_of(c), .best = certain},
           Cell{.text = certain ? "yes, " + std::string(c.verdict()) : std::string(c.verdict())}});
    }
    page.table(table);
    page.remark(kRepeatability);
  }
}

nlohmann::ordered_json changes_json(const CircleReportInput& input) {
  io::Json out = io::Json::array();
  if (input.together) return out;
  const auto um = [](double metres) { return io::number_or_null(metres * kMicro); };
  for (std::size_t i = 1; i < input.logs.size(); ++i) {
    io::Json one{
        {"from", input.logs.front().label}, {"to", input.logs[i].label}, {"figures", io::Json::array()}};
    for (const CircleChange& c : circle_changes(input.logs.front(), input.logs[i])) {
      one["figures"].push_back({{"figure", c.figure},
                                {"direction", c.direction},
                                {"before_um", um(c.before)},
                                {"after_um", um(c.after)},
                                {"difference_um", um(c.difference())},
                                {"half_width_95_um", um(c.half_width)},
                                {"verdict", c.verdict()}});
    }
    out.push_back(std::move(one));
  }
  return out;
}

std::string limits_text(const CircleReportInput& input) {
  std::string out;
  for (const CircleVerdict& v : circle_verdicts(input)) {
    out += fmt::format("{}: {} {} {}, limit {} µm{}\n",
                       v.passed() ? "passed"
                       : v.before ? "above"
                                  : "FAILED",
                       clean_text(v.label), v.figure,
                       std::isfinite(v.value) ? "of " + micrometres(v.value) + " µm" : "was not measured",
                       micrometres(v.most),
                       v.before ? " (the others are compared with it: it does not decide)" : "");
  }
  return out;
}

void add_limits(Page& page, const CircleReportInput& input) {
  const std::vector<CircleVerdict> all = circle_verdicts(input);
  if (all.empty()) return;
  page.section("Limits");
  Table table;
  table.columns = {
      {"control", "", false}, {"figure", "", false}, {"measured", "µm"}, {"limit", "µm"}, {"", "", false}};
  for (const CircleVerdict& v : all)
    table.rows.push_back({Cell{.text = v.label}, Cell{.text = v.figure}, Cell{.text = micrometres(v.value)},
                          Cell{.text = micrometres(v.most)},
                          Cell{.text = v.passed()                ? "passed"
                                       : !std::isfinite(v.value) ? "not measured"
                                       : v.before                ? "above, before"
                                                                 : "failed",
                               .best = !v.passed() && !v.before}});
  page.table(table);
  page.remark(
      "The larger one of both directions counts, without its sign. What was not measured has not passed. Of several logs the first is "
      "the one that the others are compared with: it does not decide.");
}

nlohmann::ordered_json limits_json(const CircleReportInput& input) {
  io::Json out = io::Json::array();
  for (const CircleVerdict& v : circle_verdicts(input))
    out.push_back({{"label", v.label},
                   {"figure", v.figure},
                   {"value_um", io::number_or_null(v.value * kMicro)},
                   {"limit_um", io::number_or_null(v.most * kMicro)},
                   {"passed", v.passed()},
                   {"decides", !v.before}});
  return out;
}

}  // namespace stribeck::report
