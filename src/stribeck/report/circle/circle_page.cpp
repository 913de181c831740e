#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stribeck/core/numbers.hpp>
#include <stribeck/core/scalar.hpp>
#include <stribeck/report/circle/circle_change.hpp>
#include <stribeck/report/circle/circle_parts.hpp>
#include <stribeck/report/circle/circle_report.hpp>
#include <stribeck/report/factors.hpp>
#include <stribeck/report/html.hpp>
#include <stribeck/report/text.hpp>

namespace stribeck::report {
namespace {

/// A peak of this direction that stands out of its interval.
bool is_clear(const ident::circle::QuadrantPeak& p, bool counter_clockwise) {
  constexpr double kClear = 2.0;  // half widths
  return p.counter_clockwise == counter_clockwise && std::abs(p.height) >= kClear * p.half_width_95;
}

bool has_clear_peaks(const CircleLog& log, bool counter_clockwise) {
  return log.diagnosis && std::any_of(log.diagnosis->peaks.begin(), log.diagnosis->peaks.end(),
                                      [&](const auto& p) { return is_clear(p, counter_clockwise); });
}

/// Radius at which errors up to `most` are drawn magnified: the circle is the unit circle.
struct Magnifier {
  double per_metre = 0.0;
  double ring = 0.0;  ///< [m]

  explicit Magnifier(double most) {
    ring = std::pow(10.0, std::floor(std::log10(std::max(most, 1e-9))));
    for (const double digit : {5.0, 2.0}) {
      if (digit * ring <= most) {
        ring *= digit;
        break;
      }
    }
    per_metre = 0.5 / std::max(most, 1e-9);
  }

  [[nodiscard]] Series around(const std::vector<double>& angle, const std::vector<double>& error,
                              std::string label, std::string color, double width) const {
    Series s{.label = std::move(label), .color = std::move(color), .width = width};
    for (std::size_t i = 0; i < angle.size(); ++i) {
      const double r = 1.0 + per_metre * error[i];
      s.x.push_back(r * std::cos(angle[i]));
      s.y.push_back(r * std::sin(angle[i]));
    }
    return s;
  }
  void grid(Plot& plot, const ident::circle::AxisNames& axes) const {
    std::vector<double> angle;
    for (int i = 0; i <= 240; ++i) angle.push_back(2.0 * kPi * i / 240);
    for (const double e : {-ring, 0.0, ring}) {
      Series s = around(angle, std::vector<double>(angle.size(), e), "", e == 0.0 ? "#9aa0a6" : "#b6bbc0",
                        e == 0.0 ? 1.0 : 0.8);
      s.dashed = e != 0.0;
      s.scale = ScaleLine::kRing;
      plot.series.push_back(std::move(s));
    }
    plot.axes = false;
    plot.ring = Ring{0.0, 0.0, 1.0, kMicro / per_metre};
    plot.equal_aspect = true;
    plot.x_range = Range{-1.75, 1.75};
    plot.y_range = Range{-1.75, 1.75};
    axes_and_quadrants(plot, axes);
    scale_bar(plot);
  }
  /// Where the axes of the machine reverse, with the numbers of the quadrants between them.
  static void axes_and_quadrants(Plot& plot, const ident::circle::AxisNames& axes) {
    constexpr double kEnd = 1.55;
    plot.series.push_back(
        {.x = {-kEnd, kEnd}, .y = {0.0, 0.0}, .color = "#dadce0", .width = 0.8, .scale = ScaleLine::kFixed});
    plot.series.push_back(
        {.x = {0.0, 0.0}, .y = {-kEnd, kEnd}, .color = "#dadce0", .width = 0.8, .scale = ScaleLine::kFixed});
    plot.notes.push_back({kEnd + 0.1, 0.0, axes[0] + '+', "#5f6368"});
    plot.notes.push_back({0.0, kEnd + 0.1, axes[1] + '+', "#5f6368"});
    constexpr double kBetween = 0.42;
    plot.notes.push_back({kBetween, kBetween, "I", "#80868b"});
    plot.notes.push_back({-kBetween, kBetween, "II", "#80868b"});
    plot.notes.push_back({-kBetween, -kBetween, "III", "#80868b"});
    plot.notes.push_back({kBetween, -kBetween, "IV", "#80868b"});
  }
  /// A bar as long as the error of the ring, with its ends.
  void scale_bar(Plot& plot) const {
    const double length = per_metre * ring;
    constexpr double kX = -1.65;
    constexpr double kY = -1.62;
    constexpr double kTick = 0.04;
    plot.series.push_back({.x = {kX, kX, kX, kX + length, kX + length, kX + length},
                           .y = {kY - kTick, kY + kTick, kY, kY, kY + kTick, kY - kTick},
                           .color = "#3c4043",
                           .width = 1.4,
                           .scale = ScaleLine::kBar});
    plot.notes.push_back({kX + 0.5 * length, kY + 0.12, short_number(ring * kMicro) + " µm", "#3c4043"});
  }
  /// An arc inside the circle with an arrow head in the direction of travel.
  static void direction(Plot& plot, bool counter_clockwise) {
    constexpr double kRadius = 0.2;
    Series arc{.color = "#80868b", .width = 1.2, .scale = ScaleLine::kFixed};
    const double turn = counter_clockwise ? 1.0 : -1.0;
    for (int i = 0; i <= 40; ++i) {
      const double angle = turn * (0.25 * kPi + 1.5 * kPi * i / 40);
      arc.x.push_back(kRadius * std::cos(angle));
      arc.y.push_back(kRadius * std::sin(angle));
    }
    const double last = turn * 1.75 * kPi;
    const auto stroke = [&](double radius, double back) {
      arc.x.push_back(radius * std::cos(last - turn * back));
      arc.y.push_back(radius * std::sin(last - turn * back));
    };
    stroke(1.35 * kRadius, 0.45);
    stroke(kRadius, 0.0);
    stroke(0.65 * kRadius, 0.45);
    plot.series.push_back(std::move(arc));
  }
  /// The height of each quadrant peak at its place, outside the curve.
  void peaks(Plot& plot, const CircleLog& log, bool counter_clockwise, const std::string& color) const {
    if (!log.diagnosis) return;
    for (const ident::circle::QuadrantPeak& p : log.diagnosis->peaks) {
      if (!is_clear(p, counter_clockwise)) continue;
      const double turn = counter_clockwise ? 1.0 : -1.0;
      const double angle = p.angle + turn * (p.delay + 0.18);
      // The numbers are centred on their place: within the picture, and beside the names of the axes.
      constexpr double kFarthest = 1.5;
      const double r = 1.16 + per_metre * std::fmax(p.height, 0.0);
      plot.notes.push_back({std::clamp(r * std::cos(angle), -kFarthest, kFarthest),
                            std::clamp(r * std::sin(angle), -kFarthest, kFarthest),
                            with_sign(p.height * kMicro, 1) + " µm", color});
    }
  }
};

/// The samples in order of time, thinned for a drawing; the angle goes on from revolution to revolution [rad]. NaN: the part of the
/// circle that an arc leaves out.
struct Drawn {
  std::vector<double> angle;
  std::vector<double> error;
};

Drawn drawn(const ident::circle::CircleTest& t) {
  constexpr int kPerRevolution = 500;
  constexpr double kMissing = 30.0 * kPi / 180.0;
  const double way = t.counter_clockwise ? 1.0 : -1.0;
  Drawn d;
  double turned = 0.0;    // against the direction of travel it may step back by noise
  double farthest = 0.0;  // for a drawing it must not
  for (std::size_t i = 0; i < t.angle.size(); ++i) {
    double step = i == 0 ? way * t.angle[0] : way * std::remainder(t.angle[i] - t.angle[i - 1], 2.0 * kPi);
    if (i > 0 && std::abs(step) > kMissing) {
      if (step < 0.0) step += 2.0 * kPi;
      d.angle.push_back(std::numeric_limits<double>::quiet_NaN());
      d.error.push_back(std::numeric_limits<double>::quiet_NaN());
    }
    turned += step;
    farthest = i == 0 ? turned : std::fmax(farthest, turned);
    d.angle.push_back(farthest);
    d.error.push_back(t.error[i]);
  }
  thin(d.angle, d.error, static_cast<int>(kPerRevolution * std::fmax(std::ceil(t.revolutions), 1.0)));
  for (double& angle : d.angle) angle *= way;
  return d;
}

/// Over the angle from 0 to 360 degrees, with a gap where a revolution ends.
void fill_along(Series& s, const Drawn& d) {
  double before = 0.0;
  for (std::size_t k = 0; k < d.angle.size(); ++k) {
    const double degrees = d.angle[k] * 180.0 / kPi;
    const double within = degrees - 360.0 * std::floor(degrees / 360.0);
    if (k > 0 && std::abs(within - before) > 180.0) {
      s.x.push_back(std::numeric_limits<double>::quiet_NaN());
      s.y.push_back(std::numeric_limits<double>::quiet_NaN());
    }
    s.x.push_back(within);
    s.y.push_back(d.error[k] * kMicro);
    before = within;
  }
}

std::string picture_words(const CircleReportInput& input, std::size_t c) {
  double most = 0.0;
  for (const CircleLog& log : input.logs) most = std::max(most, log.circles[c].max_error);
  const CircleLog& first = input.logs.front();
  const bool numbers = input.logs.size() == 1 && has_clear_peaks(first, first.circles[c].counter_clockwise);
  return fmt::format(
      "Radial error magnified around the circle (thin line), all laps; outwards: radius too large. Dashed: {} µm to both sides. "
      "Good is a narrow ring without steps where an axis reverses (at {}+, {}+ and opposite); a step there is friction or play.{}",
      short_number(Magnifier(most).ring * kMicro), first.axes[0], first.axes[1],
      numbers ? " Numbers: heights of the quadrant peaks." : "");
}

/// All logs on one scale.
Plot overlaid(const CircleReportInput& input, std::size_t c) {
  double most = 0.0;
  for (const CircleLog& log : input.logs) most = std::max(most, log.circles[c].max_error);
  const Magnifier common(most);
  const bool counter_clockwise = input.logs.front().circles[c].counter_clockwise;
  Plot over{.title = fmt::format("Radial error, {}", circle_name(input, c)),
            .description = fmt::format("Radial error of {} logs around the circle, largest {} µm, {}",
                                       input.logs.size(), micrometres(most), circle_name(input, c)),
            .legend = Legend::kAbove,
            .width = 620,
            .height = 660};
  common.grid(over, input.logs.front().axes);
  Magnifier::direction(over, counter_clockwise);
  for (std::size_t i = 0; i < input.logs.size(); ++i) {
    const CircleLog& log = input.logs[i];
    const Drawn d = drawn(log.circles[c]);
    const std::string color = controller_color("", i);
    over.series.push_back(common.around(d.angle, d.error, log.label, color, 1.5));
    if (input.logs.size() == 1) common.peaks(over, log, counter_clockwise, "#202124");
  }
  return over;
}

void add_circle(Page& page, const CircleReportInput& input, std::size_t c) {
  page.section(circle_name(input, c));
  Plot along{
      .x_label = "angle [deg]", .y_label = "radial error [µm]", .x_range = Range{0.0, 360.0}, .x_step = 45.0};
  std::vector<Plot> own;
  for (std::size_t i = 0; i < input.logs.size(); ++i) {
    const CircleLog& log = input.logs[i];
    const ident::circle::CircleTest& t = log.circles[c];
    // The first log is the reference for the others, drawn in grey.
    const std::string color = controller_color("", i);
    const Drawn d = drawn(t);
    Series s{.label = log.label, .color = color, .width = 1.4};
    fill_along(s, d);
    along.series.push_back(std::move(s));
    const Magnifier magnifier(t.max_error);
    Plot p{.title = log.label, .legend = Legend::kNone, .width = 350, .height = 370};
    magnifier.grid(p, log.axes);
    Magnifier::direction(p, t.counter_clockwise);
    magnifier.peaks(p, log, t.counter_clockwise, "#202124");
    p.series.push_back(magnifier.around(d.angle, d.error, "", color, 1.4));
    own.push_back(std::move(p));
  }
  if (c > 0) page.figure(overlaid(input, c), picture_words(input, c));
  if (own.size() > 1)
    page.figures(own, own.size() > 4 ? 3 : 2,
                 input.together ? "Each on its own scale."
                                : "Each on its own scale, with the heights of its quadrant peaks in µm.");
  page.figure(along, "Radial error over the angle, all laps.");
}

/// The figures of every log, direction by direction.
Table figures_table(const CircleReportInput& input) {
  const std::vector<ident::circle::CircleTest>& circles = input.logs.front().circles;
  Table table;
  table.columns = {{"control", "", false}};
  for (std::size_t c = 0; c < circles.size(); ++c) {
    const std::string which = circles[c].counter_clockwise ? "ccw" : "cw";
    for (const char* head : {"max", "RMS", "glitch", "G"})
      table.columns.push_back({std::string(head), "µm, " + which, true});
  }
  for (const std::string& head : input.beside) table.columns.push_back(column_of(head));
  for (std::size_t i = 0; i < input.logs.size(); ++i) {
    const CircleLog& log = input.logs[i];
    std::vector<Cell> row{Cell{.text = log.label, .color = controller_color("", i)}};
    for (std::size_t c = 0; c < log.circles.size(); ++c) {
      const auto cell = [&](double ident::circle::CircleTest::*figure) {
        const double own = log.circles[c].*figure;
        bool least = input.logs.size() > 1;
        for (const CircleLog& other : input.logs) least = least && own <= other.circles[c].*figure;
        row.push_back(Cell{.text = micrometres(own), .best = least});
      };
      cell(&ident::circle::CircleTest::max_error);
      cell(&ident::circle::CircleTest::rms);
      cell(&ident::circle::CircleTest::quadrant_glitch);
      cell(&ident::circle::CircleTest::circular_deviation);
    }
    for (const std::string& text : log.beside) row.push_back(Cell{.text = text});
    table.rows.push_back(std::move(row));
  }
  return table;
}

/// Of which log the causes are that the lead names; an effect is that at the fastest feed.
std::string whose_causes(const CircleReportInput& input) {
  if (input.logs.size() == 1) return "";
  return " of " +
         (input.together ? std::string("all logs together, at the fastest feed") : input.logs.back().label);
}

/// That of all logs together, or of this one; null: there is none.
const ident::circle::Diagnosis* diagnosis_of(const CircleReportInput& input, const CircleLog& log) {
  return input.together ? &*input.together : log.diagnosis ? &*log.diagnosis : nullptr;
}

/// The largest cause that is no set-up, or null.
const ident::circle::Cause* main_cause(const CircleReportInput& input, const CircleLog& log) {
  const auto* diagnosis = diagnosis_of(input, log);
  if (diagnosis == nullptr) return nullptr;
  for (const ident::circle::Cause& cause : diagnosis->causes) {
    if (cause.found && !is_set_up(cause.kind)) return &cause;
  }
  return nullptr;
}

/// The result in two sentences: how round, and what to do.
std::string answer(const CircleReportInput& input) {
  const CircleLog& first = input.logs.front();
  const CircleLog& last = input.logs.back();
  std::string text;
  std::vector<CircleVerdict> verdicts = circle_verdicts(input);
  std::erase_if(verdicts, [](const CircleVerdict& v) { return v.before; });
  if (!verdicts.empty()) {
    const auto failed =
        std::count_if(verdicts.begin(), verdicts.end(), [](const auto& v) { return !v.passed(); });
    text += failed == 0 ? "Passed: every figure is within its limit. "
                        : fmt::format("Failed: {} of {} figures are beyond their limits or not measured. ",
                                      failed, verdicts.size());
  }
  const std::string radius = short_number(input.radius * 1e3);
  if (input.logs.size() == 1) {
    text += fmt::format(
        "The circle of {} mm{} deviates by G = {} µm from round; its largest radial error is {} µm.", radius,
        std::isfinite(last.feed) ? fmt::format(" at {} mm/min", significant(last.feed * 60e3, 4)) : "",
        micrometres(limited_figure(last, "G")), micrometres(limited_figure(last, "max")));
  } else if (input.logs.size() == 2 && !input.together) {
    text += fmt::format(
        "The largest radial error of the circle of {} mm changes from {} µm ({}) to {} µm ({}), its circular deviation G from {} to {} µm",
        radius, micrometres(limited_figure(first, "max")), first.label,
        micrometres(limited_figure(last, "max")), last.label, micrometres(limited_figure(first, "G")),
        micrometres(limited_figure(last, "G")));
    std::string verdict = "; whether G changes by more than the repeatability is not known";
    for (const CircleChange& c : circle_changes(first, last)) {
      if (c.figure != "G" || !std::isfinite(c.half_width)) continue;
      verdict = std::abs(c.difference()) > c.half_width ? "; G changes by more than the repeatability"
                                                        : "; the change of G is within the repeatability";
      break;
    }
    text += verdict + ".";
  } else {
    const auto rounder = [](const CircleLog& a, const CircleLog& b) {
      return limited_figure(a, "G") < limited_figure(b, "G");
    };
    const auto [best, worst] = std::minmax_element(input.logs.begin(), input.logs.end(), rounder);
    text += fmt::format("The circle of {} mm is roundest with {}: G = {} µm; it is worst with {}: {} µm.",
                        radius, best->label, micrometres(limited_figure(*best, "G")), worst->label,
                        micrometres(limited_figure(*worst, "G")));
  }
  if (const auto* cause = main_cause(input, last)) {
    text += fmt::format(" The largest cause{} is {} (effect {} µm): {}.", whose_causes(input),
                        cause_name(*diagnosis_of(input, last), *cause), micrometres(cause->effect),
                        next_step(*diagnosis_of(input, last), *cause));
  } else if (last.diagnosis || input.together) {
    text += " No cause stands out of the scatter: leave it as it is.";
  }
  return text;
}

std::vector<KeyNumber> key_numbers(const CircleReportInput& input) {
  const CircleLog& last = input.logs.back();
  const std::string of = input.logs.size() > 1 ? " of " + last.label : "";
  std::vector<KeyNumber> numbers{
      {"circular deviation G" + of, micrometres(limited_figure(last, "G")), "µm"},
      {"largest radial error" + of, micrometres(limited_figure(last, "max")), "µm"}};
  if (const auto* cause = main_cause(input, last))
    numbers.push_back(
        {"largest cause" + whose_causes(input) + ": " + cause_name(*diagnosis_of(input, last), *cause),
         micrometres(cause->effect), "µm"});
  return numbers;
}

Page circle_report_page(const CircleReportInput& input) {
  Page page(input.title, "stribeck " + input.version);
  page.lead(answer(input));
  page.numbers(key_numbers(input));
  page.figure(overlaid(input, 0), picture_words(input, 0));
  page.warnings(input.warnings);
  add_limits(page, input);
  add_changes(page, input);
  page.section("Figures");
  page.table(figures_table(input));
  page.remark(fmt::format(
      "ccw, cw: counter-clockwise, clockwise. max: largest |radial error|. glitch: the same within the "
      "first {:g} mm after an axis reversed. G: circular deviation, the width of the minimum zone, after "
      "ISO 230-4. Bold: the smallest.",
      1e3 * sim::kGlitchTravel));
  add_circular_test(page, input);
  if (input.together) add_causes(page, "all logs together", *input.together, input.radius);
  for (const CircleLog& log : input.logs) {
    if (log.diagnosis) add_causes(page, input.logs.size() > 1 ? log.label : "", *log.diagnosis, input.radius);
  }
  for (std::size_t c = 0; c < input.logs.front().circles.size(); ++c) add_circle(page, input, c);
  page.made({input.command, input.version, input.inputs});
  return page;
}

}  // namespace

std::string circle_report(const CircleReportInput& input) { return circle_report_page(input).html(); }

void write_circle_report(const PageFolders& folders, const CircleReportInput& input) {
  write_page(circle_report_page(input), folders);
}

}  // namespace stribeck::report
