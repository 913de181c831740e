#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>
#include <stribeck/report/plot/frame.hpp>
#include <stribeck/report/text.hpp>
#include <utility>

namespace stribeck::report {
namespace {

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

std::string color(std::string_view c) { return is_color(c) ? fmt::format("rgb '{}'", c) : "rgb '#444444'"; }

/// An axis label; the unit in its brackets is shown as printed.
std::string quoted_label(const std::string& label) {
  const std::size_t unit = std::min(label.rfind('['), label.size());
  return in_single_quotes(label.substr(0, unit) + printed_unit(std::string_view(label).substr(unit)));
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
  explicit Script(Format format) : format_(format) {}

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
    terminal(p);
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
    if (!p.title.empty()) {
      line("set label {} at screen {:.6f}, screen {:.6f} left font ',14' textcolor rgb '#202124'",
           in_single_quotes(p.title), (p.axes ? f.left : 8.0) / p.width,
           1.0 - ((p.axes ? 8 : 4) + 8.0) / p.height);
    }
    legend(p, f, legend_top(p));
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

  void terminal(const Plot& p) {
    constexpr double kPerInch = 96.0;  // pixels of an SVG
    constexpr int kFine = 2;           // pixels of a PNG for one of an SVG
    // Measured on what gnuplot 5.4 writes: with these a text and a line are as large, relative to the drawing, as in an SVG.
    constexpr double kPdfFont = 0.5625;
    constexpr double kPdfLine = 1.5;
    constexpr double kPngFont = 0.75 * kFine;
    switch (format_) {
      case Format::kSvg:
        line("set terminal svg size {},{} noenhanced rounded font 'sans-serif,13' background '#ffffff'",
             p.width, p.height);
        break;
      case Format::kPdf:
        line(
            "set terminal pdfcairo size {:.4f}in,{:.4f}in noenhanced rounded font 'sans-serif,13' fontscale {} "
            "linewidth {} background '#ffffff'",
            p.width / kPerInch, p.height / kPerInch, kPdfFont, kPdfLine);
        break;
      case Format::kPng:
        line(
            "set terminal pngcairo size {},{} noenhanced rounded font 'sans-serif,13' fontscale {} linewidth {} "
            "pointscale {} background '#ffffff'",
            kFine * p.width, kFine * p.height, kPngFont, kFine, kFine);
        break;
    }
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
        // gnuplot joins samples of one colour and width to one path, which then has the dashes of the first.
        line("set arrow from {} to {} nohead front lw {:.3g} dt {} lc {}", at(x, y), at(x + 24, y),
             std::max(s.width, 1.5) + (s.dashed ? 0.01 : 0.0), dash_of(p, s), color(s.color));
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

  /// Digits with which the values of a column stay apart as finely as the drawing needs: seven of their range, not of their distance
  /// from zero.
  static int digits_of(const std::vector<double>& column) {
    constexpr int kEnough = 7;
    constexpr int kAll = 17;
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (const double v : column) {
      if (!std::isfinite(v)) continue;
      low = std::min(low, v);
      high = std::max(high, v);
    }
    const double ratio = std::max(std::abs(low), std::abs(high)) / (high - low);
    if (!std::isfinite(ratio) || ratio <= 10.0) return kEnough;
    return std::min(kAll, kEnough + static_cast<int>(std::ceil(std::log10(ratio))));
  }

  /// Rows of columns; a row with a number that is not finite becomes one empty line.
  std::string data(const std::vector<const std::vector<double>*>& columns) {
    const std::string name = fmt::format("$data{}", blocks_++);
    line("{} << EOD", name);
    std::size_t rows = columns[0]->size();
    for (const auto* c : columns) rows = std::min(rows, c->size());
    std::vector<int> digits;
    for (const auto* c : columns) digits.push_back(digits_of(*c));
    bool gap = true;
    for (std::size_t i = 0; i < rows; ++i) {
      const bool finite =
          std::all_of(columns.begin(), columns.end(), [&](auto* c) { return std::isfinite((*c)[i]); });
      if (finite) {
        for (std::size_t k = 0; k < columns.size(); ++k)
          fmt::format_to(std::back_inserter(text_), "{:.{}g} ", (*columns[k])[i], digits[k]);
      }
      if (finite || !gap) text_ += '\n';
      gap = !finite;
    }
    line("EOD");
    return name;
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
                           s.style == Style::kSteps ? "steps" : "lines", s.width, dash_of(p, s), paint,
                           title));
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
          if (has_whiskers(s)) {
            draw(fmt::format("{} using 1:2:3:4 with vectors nohead lw 1.2 lc rgb '#202124' notitle",
                             whiskers(s, x)));
          }
          break;
        }
      }
    }
    line("plot {}", plot.empty() ? "NaN notitle" : plot);
  }

  Format format_;
  std::string text_;
  std::size_t blocks_ = 0;
};
}  // namespace

std::string gnuplot_script(const std::vector<Plot>& plots, Format format) {
  return Script(format).write(plots);
}

}  // namespace stribeck::report
