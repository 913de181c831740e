#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <set>
#include <stribeck/report/plot/plot.hpp>
#include <stribeck/report/text.hpp>
#include <utility>

namespace stribeck::report {
namespace {

constexpr double kLeft = 66;  ///< margins [px]
constexpr double kRight = 20;
constexpr double kBottom = 48;
constexpr double kTop = 12;
constexpr double kLine = 21;  ///< height of a line of text
constexpr double kLegendLine = 18;
constexpr double kMarkerLine = 14;
constexpr std::size_t kLongestText = 200;
constexpr double kBandOpacity = 0.22;

/// A text that gnuplot takes literally: in single quotes only '' has a meaning.
std::string in_single_quotes(std::string_view text) {
  std::string out = "'";
  for (const char c : left_aligned(clean_text(text), std::min(kLongestText, text_width(text)))) {
    out += c;
    if (c == '\'') out += c;
  }
  return out + "'";
}

/// A label of a tic, written as a printf format.
std::string quoted_format(std::string_view text) {
  std::string out;
  for (const char c : in_single_quotes(text)) {
    out += c;
    if (c == '%') out += c;
  }
  return out;
}

bool is_color(std::string_view c) {
  return c.size() == 7 && c[0] == '#' &&
         c.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string_view::npos;
}

std::string color(std::string_view c) { return is_color(c) ? fmt::format("rgb '{}'", c) : "rgb '#444444'"; }

/// An axis label; the unit in its brackets is shown as printed.
std::string quoted_label(const std::string& label) {
  const std::size_t unit = std::min(label.rfind('['), label.size());
  return in_single_quotes(label.substr(0, unit) + printed_unit(std::string_view(label).substr(unit)));
}

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

struct Frame {
  Range x;
  Range y;
  double left, right, top, bottom;  ///< margins [px]

  [[nodiscard]] double width(const Plot& p) const { return std::max(1.0, p.width - left - right); }
  [[nodiscard]] double height(const Plot& p) const { return std::max(1.0, p.height - top - bottom); }
};

bool has_legend(const Plot& p) {
  return p.legend != Legend::kNone &&
         std::any_of(p.series.begin(), p.series.end(), [](const Series& s) { return !s.label.empty(); });
}

/// Place of an entry of the legend above a plot.
struct LegendEntry {
  const Series* series;
  double x;  ///< from the left border of the plot [px]
  int row;
};

/// gnuplot's own legend overestimates widths and then wraps into the plot; here the rows are computed in
/// advance.
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

/// Line of the label of each marker, 0 the lowest; −1 without a label. A label that would cover the one before it moves up by one
/// line. Uses the frame's x and its left and right margins.
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
  f.left = p.axes ? (p.y_label.empty() ? kLeft - kLine : kLeft) : 4;
  f.right = p.axes ? kRight : 4;
  f.bottom = p.axes ? (p.x_label.empty() ? kBottom - kLine : kBottom) : 4;
  f.top = p.axes ? kTop : 4;
  if (!p.title.empty()) f.top += kLine;
  const std::vector<LegendEntry> entries = legend_entries(p, f.width(p));
  if (!entries.empty()) f.top += kLegendLine * (entries.back().row + 1);
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

/// Merges points that fall on the same pixel; keeps their order.
void drop_covered(std::vector<double>& x, std::vector<double>& y, const Plot& p, const Frame& f) {
  std::set<std::pair<long, long>> taken;
  std::size_t n = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x[i]) || !std::isfinite(y[i])) continue;
    const auto at = [](double v, const Range& r, double px) {
      return std::lround(std::clamp((v - r.low) / (r.high - r.low) * px, -1e6, 1e6));
    };
    if (!p.log_x && !p.log_y && !taken.emplace(at(x[i], f.x, f.width(p)), at(y[i], f.y, f.height(p))).second)
      continue;
    x[n] = x[i];
    y[n] = y[i];
    ++n;
  }
  x.resize(n);
  y.resize(n);
}

class Script {
 public:
  std::string write(const std::vector<Plot>& plots) {
    line("set encoding utf8");
    for (const Plot& p : plots) add(p);
    return std::move(text_);
  }

 private:
  template <class... A>
  void line(fmt::format_string<A...> format, A&&... arguments) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<A>(arguments)...);
    text_ += '\n';
  }

  void add(const Plot& p) {
    const Frame f = frame_of(p);
    line("reset");
    line("set terminal svg size {},{} noenhanced rounded font 'sans-serif,13' background '#ffffff'", p.width,
         p.height);
    line("set output");  // ends the drawing before this one
    line("set minussign");
    line("set lmargin at screen {:.6f}", f.left / p.width);
    line("set rmargin at screen {:.6f}", 1.0 - f.right / p.width);
    line("set tmargin at screen {:.6f}", 1.0 - f.top / p.height);
    line("set bmargin at screen {:.6f}", f.bottom / p.height);
    line("set xrange [{:.9g}:{:.9g}]", f.x.low, f.x.high);
    line("set yrange [{:.9g}:{:.9g}]", f.y.low, f.y.high);
    if (p.log_x) line("set logscale x");
    if (p.log_y) line("set logscale y");
    axes(p, f);
    double y = p.axes ? 8 : 4;
    if (!p.title.empty()) {
      line("set label {} at screen {:.6f}, screen {:.6f} left font ',14' textcolor rgb '#202124'",
           in_single_quotes(p.title), (p.axes ? f.left : 8.0) / p.width, 1.0 - (y + 8) / p.height);
      y += kLine;
    }
    legend(p, f, y);
    const std::vector<int> rows = marker_rows(p, f);
    for (std::size_t k = 0; k < p.markers.size(); ++k) {
      const Marker& m = p.markers[k];
      if (!std::isfinite(m.x)) continue;
      line(
          "set arrow from first {0:.9g}, graph 0 to first {0:.9g}, graph 1 nohead back lw 1 dt (4,3) lc "
          "rgb '#80868b'",
          m.x);
      if (m.label.empty()) continue;
      line("set label {} at first {:.9g}, screen {:.6f} center font ',11' textcolor rgb '#5f6368'",
           in_single_quotes(m.label), m.x, 1.0 - (f.top - 10.0 - kMarkerLine * rows[k]) / p.height);
    }
    for (const Note& n : p.notes) {
      if (!std::isfinite(n.x) || !std::isfinite(n.y)) continue;
      line("set label {} at first {:.9g}, first {:.9g} center front font ',11' textcolor {}",
           in_single_quotes(n.text), n.x, n.y, color(n.color));
    }
    series(p, f);
  }

  void axes(const Plot& p, const Frame& f) {
    if (!p.axes) {
      line("unset border");
      line("unset tics");
      return;
    }
    line("set border 3 lw 1 lc rgb '#9aa0a6'");
    line("set xtics offset 0, 0.35");
    line("set tics nomirror out scale 0.5 font ',12' textcolor rgb '#3c4043'");
    line("set format '%h'");
    line("set grid xtics ytics back lt 1 lw 0.7 dt 1 lc rgb '#e8eaed'");
    if (!p.log_y && f.y.low < 0.0 && f.y.high > 0.0) line("set xzeroaxis lt 1 lw 1 dt 1 lc rgb '#bdc1c6'");
    if (!p.x_tics.empty()) {
      std::string list;
      for (const Tic& t : p.x_tics) {
        if (!std::isfinite(t.at)) continue;
        list += fmt::format("{}{} {:.9g}", list.empty() ? "" : ", ", quoted_format(t.label), t.at);
      }
      line("set xtics ({})", list);
      line("set grid noxtics");
    } else if (std::isfinite(p.x_step) && p.x_step > 0.0) {
      line("set xtics {:.9g}", p.x_step);
    }
    // Places set here, because those of gnuplot depend on the length of the numbers.
    if (!p.x_label.empty()) {
      line("set label {} at graph 0.5, screen {:.6f} center font ',12' textcolor rgb '#3c4043'",
           quoted_label(p.x_label), 11.0 / p.height);
    }
    if (!p.y_label.empty()) {
      line("set label {} at screen {:.6f}, graph 0.5 center rotate by 90 font ',12' textcolor rgb '#3c4043'",
           quoted_label(p.y_label), 13.0 / p.width);
    }
  }

  void legend(const Plot& p, const Frame& f, double y) {
    line("unset key");
    if (!has_legend(p)) return;
    constexpr std::string_view kLook =
        "Left reverse samplen 1.8 spacing 1.15 font ',12' textcolor rgb '#202124'";
    switch (p.legend) {
      case Legend::kAbove:
        for (const LegendEntry& e : legend_entries(p, f.width(p))) {
          legend_entry(p, *e.series, f.left + e.x, y + kLegendLine * (e.row + 0.5));
        }
        break;
      case Legend::kTopLeft:
        line("set key inside top left {}", kLook);
        break;
      case Legend::kTopRight:
        line("set key inside top right {}", kLook);
        break;
      case Legend::kBottomLeft:
        line("set key inside bottom left {}", kLook);
        break;
      case Legend::kBottomRight:
        line("set key inside bottom right {}", kLook);
        break;
      case Legend::kNone:
        break;
    }
  }

  /// A sample and its text; x, y in pixels from the left and the top.
  void legend_entry(const Plot& p, const Series& s, double x, double y) {
    const auto at = [&](double px, double py) {
      return fmt::format("screen {:.6f}, screen {:.6f}", px / p.width, 1.0 - py / p.height);
    };
    switch (s.style) {
      case Style::kLines:
      case Style::kSteps:
        line("set arrow from {} to {} nohead front lw {:.3g} dt {} lc {}", at(x, y), at(x + 24, y),
             std::max(s.width, 1.5), s.dashed ? "(7,4)" : "1", color(s.color));
        break;
      case Style::kBand:
      case Style::kBars:
        line("set object rectangle from {} to {} front fs transparent solid {} noborder fc {}", at(x, y - 5),
             at(x + 24, y + 5), s.style == Style::kBand ? kBandOpacity : 0.9, color(s.color));
        break;
      case Style::kPoints:
        line("set label '' at {} front point pt 7 ps {:.3g} lc {}", at(x + 12, y),
             std::max(0.2 * s.width, 0.4), color(s.color));
        break;
    }
    line("set label {} at {} left front font ',12' textcolor rgb '#202124'", in_single_quotes(s.label),
         at(x + 30, y));
  }

  /// Rows of columns; a row with a number that is not finite becomes one empty line.
  std::string data(const std::vector<const std::vector<double>*>& columns) {
    const std::string name = fmt::format("$data{}", blocks_++);
    line("{} << EOD", name);
    std::size_t rows = columns[0]->size();
    for (const auto* c : columns) rows = std::min(rows, c->size());
    bool gap = true;
    for (std::size_t i = 0; i < rows; ++i) {
      const bool finite =
          std::all_of(columns.begin(), columns.end(), [&](auto* c) { return std::isfinite((*c)[i]); });
      if (finite) {
        for (const auto* c : columns) fmt::format_to(std::back_inserter(text_), "{:.7g} ", (*c)[i]);
      }
      if (finite || !gap) text_ += '\n';
      gap = !finite;
    }
    line("EOD");
    return name;
  }

  static bool drawable(const Series& s) {
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

  /// A stem and two caps for each bar. gnuplot's own error bars cut a hole into the bar.
  std::string whiskers(const Series& s, const std::vector<double>& x) {
    const double cap = 0.12 * s.width;
    std::array<std::vector<double>, 4> v;
    const auto stroke = [&](double at, double y, double dx, double dy) {
      const std::array<double, 4> row{at, y, dx, dy};
      for (std::size_t k = 0; k < row.size(); ++k) v[k].push_back(row[k]);
    };
    for (std::size_t i = 0; i < x.size(); ++i) {
      stroke(x[i], s.y_low[i], 0.0, s.y_high[i] - s.y_low[i]);
      stroke(x[i] - cap, s.y_low[i], 2.0 * cap, 0.0);
      stroke(x[i] - cap, s.y_high[i], 2.0 * cap, 0.0);
    }
    return data({&v[0], &v[1], &v[2], &v[3]});
  }

  void series(const Plot& p, const Frame& f) {
    std::string plot;
    const auto draw = [&](const std::string& what) { plot += (plot.empty() ? "" : ", ") + what; };
    for (const Series& s : p.series) {
      if (!drawable(s)) continue;
      const std::string title = s.label.empty() || p.legend == Legend::kNone || p.legend == Legend::kAbove
                                    ? "notitle"
                                    : "title " + in_single_quotes(s.label);
      const std::string paint = "lc " + color(s.color);
      std::vector<double> x = s.x;
      std::vector<double> y = s.y;
      x.resize(std::min(x.size(), s.style == Style::kBand ? s.y_low.size() : y.size()));
      if (s.style != Style::kBand) y.resize(x.size());
      switch (s.style) {
        case Style::kLines:
        case Style::kSteps: {
          thin(x, y, static_cast<int>(p.detail * f.width(p)));
          const std::string name = data({&x, &y});
          draw(fmt::format("{} using 1:2 with {} lw {:.3g} dt {} {} {}", name,
                           s.style == Style::kSteps ? "steps" : "lines", s.width, s.dashed ? "(7,4)" : "1",
                           paint, title));
          break;
        }
        case Style::kPoints: {
          drop_covered(x, y, p, f);
          draw(fmt::format("{} using 1:2 with points pt 7 ps {:.3g} {} {}", data({&x, &y}), 0.2 * s.width,
                           paint, title));
          break;
        }
        case Style::kBand:
          draw(fmt::format("{} using 1:2:3 with filledcurves fs transparent solid {} noborder {} {}",
                           data({&x, &s.y_low, &s.y_high}), kBandOpacity, paint, title));
          break;
        case Style::kBars: {
          const std::vector<double> wide(x.size(), s.width);
          draw(fmt::format("{} using 1:2:3 with boxes fs solid 0.9 noborder {} {}", data({&x, &y, &wide}),
                           paint, title));
          if (s.y_low.size() >= x.size() && s.y_high.size() >= x.size()) {
            draw(fmt::format("{} using 1:2:3:4 with vectors nohead lw 1.2 lc rgb '#202124' notitle",
                             whiskers(s, x)));
          }
          break;
        }
      }
    }
    line("plot {}", plot.empty() ? "NaN notitle" : plot);
  }

  std::string text_;
  std::size_t blocks_ = 0;
};
}  // namespace

std::string gnuplot_script(const std::vector<Plot>& plots) { return Script().write(plots); }

}  // namespace stribeck::report
