#pragma once
/// Two measurements of one circle side by side, and a measurement against limits.
///
/// A change is beyond the repeatability where zero is outside its 95 % interval: of means over laps after Welch, of quadrant peaks from
/// the intervals of both. With one lap the repeatability is not known, and nothing is claimed.
///
/// Real time: no. Errors: none.

#include <nlohmann/json_fwd.hpp>
#include <stribeck/report/circle/circle_report.hpp>
#include <stribeck/report/html.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::report {

struct CircleChange {
  std::string figure;     ///< "G", "peak x 90°"
  std::string direction;  ///< "ccw" or "cw"
  double before = 0.0;    ///< [m]
  double after = 0.0;
  double half_width = 0.0;  ///< of the 95 % interval of the difference; NaN: the repeatability is not known

  [[nodiscard]] double difference() const { return after - before; }
  /// "smaller", "larger", "within the repeatability" or "not known: one lap". A peak is smaller where its height is nearer to zero. One that
  /// turned round by more than the half width is called so: "smaller, turned round", "larger, turned round", or where its size changed by
  /// no more than that "turned round (overcompensated)", towards the other side "turned round".
  [[nodiscard]] std::string_view verdict() const;
};

/// Of max, RMS and G as means over laps, and of the quadrant peaks that both logs have.
std::vector<CircleChange> circle_changes(const CircleLog& before, const CircleLog& after);

/// The figures that --limit knows.
const std::vector<std::string>& limited_figures();
/// Of one log: the largest of its directions, without sign; NaN: not measured.
double limited_figure(const CircleLog& log, std::string_view figure);

struct CircleVerdict {
  std::string label;
  std::string figure;
  double value = 0.0;  ///< NaN: not measured
  double most = 0.0;
  bool before =
      false;  ///< of the first of several logs, with which the others are compared: it does not decide

  [[nodiscard]] bool passed() const { return value <= most; }  // what was not measured has not passed
};
std::vector<CircleVerdict> circle_verdicts(const CircleReportInput& input);
/// Whether all figures that decide have passed.
bool within_limits(const CircleReportInput& input);

/// Parts of the text, the page and the JSON.
std::string changes_text(const CircleReportInput& input);
void add_changes(Page& page, const CircleReportInput& input);
nlohmann::ordered_json changes_json(const CircleReportInput& input);
std::string limits_text(const CircleReportInput& input);
void add_limits(Page& page, const CircleReportInput& input);
nlohmann::ordered_json limits_json(const CircleReportInput& input);

}  // namespace stribeck::report
