#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <stribeck/core/number_text.hpp>
#include <stribeck/report/plot/frame.hpp>
#include <stribeck/report/text.hpp>

namespace stribeck::report {
namespace {

constexpr double kLeft = 66;  ///< margins [px]
constexpr double kRight = 20;
constexpr double kBottom = 48;
constexpr double kTop = 12;

struct Extent {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void add(double v, bool logarithmic) {
    if (!std::isfinite(v) || (logarithmic && v <= 0.0)) return;
    low = std::min(low, v);
    high = std::max(high, v);
  }
  void add(const std::vector<double>& all, bool logarithmic) {
    for (const double v : all) add(v, logarithmic);
  }
  /// The range with a margin on both sides; never empty.
  [[nodiscard]] Range range(double room, bool logarithmic) const {
    if (!(low <= high)) return logarithmic ? Range{1.0, 10.0} : Range{0.0, 1.0};
    if (logarithmic) {
      const double factor = std::max(1.05, std::pow(high / low, room));
      return {low / factor, high * factor};
    }
    if (!(high > low))
      return {low - 0.5 * std::max(std::abs(low), 1.0), low + 0.5 * std::max(std::abs(low), 1.0)};
    return {low - room * (high - low), high + room * (high - low)};
  }
};

/// What long numbers at the vertical axis need beyond the usual margin, so that its title is not written over them [px].
double room_for_numbers(const Range& r) {
  constexpr double kDigit = 7.3;  // width of a digit of the 12 px sans-serif
  constexpr double kUsual = 3.0;  // letters: "0.5", "−20"
  const double step = std::pow(10.0, std::floor(std::log10((r.high - r.low) / 5.0)));
  if (!(step > 0.0) || !std::isfinite(step)) return 0.0;
  double longest = 0.0;
  for (const double end : {r.low, r.high}) {
    const double number = std::trunc(end / step) * step;
    longest = std::max(longest, static_cast<double>(fmt::format("{:.6g}", number).size()));
  }
  return kDigit * std::max(0.0, longest - kUsual);
}

using Json = nlohmann::ordered_json;

double rounded(double px) { return std::round(10.0 * px) / 10.0; }

/// With the digits that a drawing can show.
double shown(double v) { return v == 0.0 || !std::isfinite(v) ? 0.0 : number_in(fmt::format("{:.7g}", v)); }

/// Low, high, and 1 for a logarithmic axis.
Json axis_facts(const Range& r, bool logarithmic) {
  return {shown(r.low), shown(r.high), logarithmic ? 1 : 0};
}

/// The unit in the brackets of a label as it is printed.
std::string printed_label(const std::string& label) {
  const std::size_t unit = std::min(label.rfind('['), label.size());
  return clean_text(label.substr(0, unit) + printed_unit(std::string_view(label).substr(unit)));
}

}  // namespace

bool has_legend(const Plot& p) {
  return p.legend != Legend::kNone &&
         std::any_of(p.series.begin(), p.series.end(), [](const Series& s) { return !s.label.empty(); });
}

std::vector<LegendEntry> legend_entries(const Plot& p, double width) {
  constexpr double kLetter = 6.3;  // mean width of a letter of the 12 px sans-serif
  constexpr double kSample = 30;
  constexpr double kBetween = 16;
  std::vector<LegendEntry> entries;
  if (p.legend != Legend::kAbove) return entries;
  double x = 0;
  int row = 0;
  for (const Series& s : p.series) {
    if (s.label.empty()) continue;
    const double w = kSample + kLetter * static_cast<double>(text_width(s.label));
    if (x > 0 && x + w > width) {
      x = 0;
      ++row;
    }
    entries.push_back({&s, x, row});
    x += w + kBetween;
  }
  return entries;
}

std::vector<int> marker_rows(const Plot& p, const Frame& f) {
  constexpr double kLetter = 5.8;  // mean width of a letter of the 11 px sans-serif
  constexpr double kBetween = 6;
  std::vector<int> rows;
  std::vector<double> ends;  // end of the last label on each line [px]
  for (const Marker& m : p.markers) {
    if (m.label.empty() || !std::isfinite(m.x)) {
      rows.push_back(-1);
      continue;
    }
    const double at = (m.x - f.x.low) / (f.x.high - f.x.low) * f.width(p);
    const double half = 0.5 * kLetter * static_cast<double>(text_width(m.label));
    std::size_t row = 0;
    while (row < ends.size() && at - half < ends[row] + kBetween) ++row;
    if (row == ends.size()) ends.push_back(0.0);
    ends[row] = at + half;
    rows.push_back(static_cast<int>(row));
  }
  return rows;
}

Frame frame_of(const Plot& p) {
  Frame f{};
  f.left = p.axes ? (p.y_label.empty() ? kLeft - kTitleLine : kLeft) : 4;
  f.right = p.axes ? kRight : 4;
  f.bottom = p.axes ? (p.x_label.empty() ? kBottom - kTitleLine : kBottom) : 4;
  f.top = p.axes ? kTop : 4;
  if (!p.title.empty()) f.top += kTitleLine;
  Extent x;
  Extent y;
  bool bars = false;
  for (const Series& s : p.series) {
    x.add(s.x, p.log_x);
    if (s.style != Style::kBand) y.add(s.y, p.log_y);
    y.add(s.y_low, p.log_y);
    y.add(s.y_high, p.log_y);
    if (s.style == Style::kBars) {
      bars = true;
      for (const double v : s.x) {
        x.add(v - 0.5 * s.width, false);
        x.add(v + 0.5 * s.width, false);
      }
      y.add(0.0, p.log_y);
    }
  }
  for (const Note& n : p.notes) y.add(n.y, p.log_y);
  const auto good = [](const std::optional<Range>& r, bool logarithmic) {
    return r && std::isfinite(r->low) && std::isfinite(r->high) && r->high > r->low &&
           (!logarithmic || r->low > 0.0);
  };
  f.x = good(p.x_range, p.log_x) ? *p.x_range : x.range(bars ? 0.04 : 0.0, p.log_x);
  f.y = good(p.y_range, p.log_y) ? *p.y_range : y.range(0.06, p.log_y);
  if (bars && !p.y_range && y.low >= 0.0) f.y.low = 0.0;
  if (p.axes && !p.y_label.empty() && !p.log_y) f.left += room_for_numbers(f.y);
  const std::vector<LegendEntry> entries = legend_entries(p, f.width(p));
  if (!entries.empty()) f.top += kLegendLine * (entries.back().row + 1);
  const std::vector<int> rows = marker_rows(p, f);
  if (!rows.empty()) f.top += kMarkerLine * (*std::max_element(rows.begin(), rows.end()) + 1);
  if (p.equal_aspect) {
    const double per_px = std::max((f.x.high - f.x.low) / f.width(p), (f.y.high - f.y.low) / f.height(p));
    const auto widen = [](Range& r, double span) {
      const double middle = 0.5 * (r.low + r.high);
      r = {middle - 0.5 * span, middle + 0.5 * span};
    };
    widen(f.x, per_px * f.width(p));
    widen(f.y, per_px * f.height(p));
  }
  return f;
}

bool drawable(const Series& s) {
  const std::vector<double>& y = s.style == Style::kBand ? s.y_low : s.y;
  const std::size_t n = std::min(s.x.size(), y.size());
  for (std::size_t i = 0; i < n; ++i) {
    if (std::isfinite(s.x[i]) && std::isfinite(y[i]) &&
        (s.style != Style::kBand || (i < s.y_high.size() && std::isfinite(s.y_high[i])))) {
      return true;
    }
  }
  return false;
}

bool has_whiskers(const Series& s) {
  const std::size_t n = std::min(s.x.size(), s.y.size());
  return s.style == Style::kBars && s.y_low.size() >= n && s.y_high.size() >= n;
}

bool is_color(std::string_view c) {
  return c.size() == 7 && c[0] == '#' &&
         c.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string_view::npos;
}

double legend_top(const Plot& p) { return (p.axes ? 8.0 : 4.0) + (p.title.empty() ? 0.0 : kTitleLine); }

std::string_view dash_of(const Plot& p, const Series& s) {
  // The first curve of a plot is solid; the others differ in their dashes as well as in their colours.
  static constexpr std::array<std::string_view, 4> kDashes{"1", "(14,3)", "(9,3,2,3)", "(3,2)"};
  if (s.dashed) return "(7,4)";
  const auto is_curve = [](const Series& c) {
    return !c.label.empty() && !c.dashed && (c.style == Style::kLines || c.style == Style::kSteps);
  };
  if (!is_curve(s)) return kDashes[0];
  std::size_t before = 0;
  for (const Series& c : p.series) {
    if (&c == &s) break;
    if (is_curve(c)) ++before;
  }
  return kDashes[before % kDashes.size()];
}

std::string plot_facts(const Plot& p) {
  const Frame f = frame_of(p);
  Json out;
  out["f"] = {rounded(f.left), rounded(f.top), rounded(p.width - f.right), rounded(p.height - f.bottom)};
  out["x"] = axis_facts(f.x, p.log_x);
  out["y"] = axis_facts(f.y, p.log_y);
  out["t"] = clean_text(p.title);
  out["xl"] = printed_label(p.x_label);
  out["yl"] = printed_label(p.y_label);
  if (p.equal_aspect) out["eq"] = 1;
  if (!p.axes) out["bare"] = 1;
  if (!p.x_tics.empty()) out["named"] = 1;
  if (p.ring) {
    const double per_px = (f.x.high - f.x.low) / f.width(p);
    out["ring"] = {rounded(f.left + (p.ring->x - f.x.low) / per_px),
                   rounded(f.top + (f.y.high - p.ring->y) / per_px), rounded(p.ring->radius / per_px),
                   shown(p.ring->error_per_unit * per_px)};
  }
  for (const Marker& m : p.markers) {
    if (std::isfinite(m.x)) out["m"].push_back({shown(m.x), clean_text(m.label)});
  }
  for (const Note& n : p.notes) {
    if (std::isfinite(n.x) && std::isfinite(n.y))
      out["n"].push_back(
          {shown(n.x), shown(n.y), clean_text(n.text), is_color(n.color) ? n.color : "#444444"});
  }
  const std::vector<LegendEntry> legend = legend_entries(p, f.width(p));
  int group = 0;
  out["s"] = Json::array();
  for (const Series& s : p.series) {
    if (!drawable(s)) continue;
    Json one{{"n", clean_text(s.label)}, {"c", is_color(s.color) ? s.color : "#444444"}};
    one["g"] = {++group};
    if (has_whiskers(s)) one["g"].push_back(++group);
    if (s.style == Style::kBand || s.style == Style::kBars) one["fill"] = 1;
    if (s.scale != ScaleLine::kNone) one["scale"] = static_cast<int>(s.scale);
    for (const LegendEntry& e : legend) {
      if (e.series != &s) continue;
      const double letters = 6.3 * static_cast<double>(text_width(s.label));
      one["b"] = {rounded(f.left + e.x), rounded(legend_top(p) + kLegendLine * e.row),
                  rounded(30.0 + letters)};
    }
    out["s"].push_back(std::move(one));
  }
  return out.dump();
}

}  // namespace stribeck::report
