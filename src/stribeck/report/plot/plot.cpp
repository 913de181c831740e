#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <memory>
#include <set>
#include <stribeck/io/error.hpp>
#include <stribeck/report/html.hpp>
#include <stribeck/report/plot/plot.hpp>
#include <stribeck/report/text.hpp>
#include <system_error>
#include <utility>

extern char** environ;  // NOLINT: POSIX asks for this declaration

namespace stribeck::report {
namespace {

[[noreturn]] void fail(std::string message) {
  throw io::InputError(io::Problem{"", 0, "", std::move(message)});
}

// ---- script
// -------------------------------------------------------------------------------------------------------

constexpr double kLeft = 66;  ///< margins [px]
constexpr double kRight = 20;
constexpr double kBottom = 48;
constexpr double kTop = 12;
constexpr double kLine = 21;  ///< height of a line of text
constexpr double kLegendLine = 18;
constexpr double kMarkerLine = 14;
constexpr std::size_t kLongestText = 200;
constexpr double kBandOpacity = 0.22;

/// A text as gnuplot takes it literally: in single quotes nothing is replaced but '' itself.
std::string quoted(std::string_view text) {
  std::string out = "'";
  for (const char c : left_aligned(clean_text(text), std::min(kLongestText, text_width(text)))) {
    out += c;
    if (c == '\'') out += c;
  }
  return out + "'";
}

/// A label of a tic, which is a printf format.
std::string quoted_format(std::string_view text) {
  std::string out;
  for (const char c : quoted(text)) {
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

/// An axis label, the unit in its brackets as it is printed.
std::string quoted_label(const std::string& label) {
  const std::size_t unit = std::min(label.rfind('['), label.size());
  return quoted(label.substr(0, unit) + printed_unit(std::string_view(label).substr(unit)));
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
  /// With a share of room on both sides; never empty.
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

/// Where an entry of the legend above a plot stands.
struct LegendEntry {
  const Series* series;
  double x;  ///< from the left border of the plot [px]
  int row;
};

/// gnuplot's own legend guesses widths generously and then wraps into the plot; here the rows are known
/// beforehand.
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

/// The line that each marker's label stands on, 0 the lowest; −1 without a label. A label that would cover the one before it goes
/// one up. Knows the frame's x and its left and right margins.
std::vector<int> marker_rows(const Plot& p, const Frame& f) {
  constexpr double kLetter = 5.8;  // mean width of a letter of the 11 px sans-serif
  constexpr double kBetween = 6;
  std::vector<int> rows;
  std::vector<double> ends;  // of the last label on each line [px]
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

/// Points that fall on the same pixel are one; keeps their order.
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
           quoted(p.title), (p.axes ? f.left : 8.0) / p.width, 1.0 - (y + 8) / p.height);
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
           quoted(m.label), m.x, 1.0 - (f.top - 10.0 - kMarkerLine * rows[k]) / p.height);
    }
    for (const Note& n : p.notes) {
      if (!std::isfinite(n.x) || !std::isfinite(n.y)) continue;
      line("set label {} at first {:.9g}, first {:.9g} center front font ',11' textcolor {}", quoted(n.text),
           n.x, n.y, color(n.color));
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
    // Places of their own: those of gnuplot depend on the length of the numbers.
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
    line("set label {} at {} left front font ',12' textcolor rgb '#202124'", quoted(s.label), at(x + 30, y));
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

  /// A stem and two caps for each bar. gnuplot's own error bars punch a hole into the bar.
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
                                    : "title " + quoted(s.label);
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

// ---- process
// ------------------------------------------------------------------------------------------------------

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

/// A nameless file: nothing is left behind, whatever happens.
File nameless_file() {
  File file(std::tmpfile(), std::fclose);
  if (file == nullptr)
    fail("plots need room for a temporary file: " + std::generic_category().message(errno));
  ::fcntl(::fileno(file.get()), F_SETFD, FD_CLOEXEC);
  return file;
}

std::string last_line(std::FILE* file) {
  std::rewind(file);
  std::array<char, 4096> buffer{};
  std::string text;
  for (std::size_t n = 0; (n = std::fread(buffer.data(), 1, buffer.size(), file)) > 0;)
    text.append(buffer.data(), n);
  text.erase(text.find_last_not_of(" \t\r\n") + 1);
  return clean_text(text.substr(text.find_last_of('\n') + 1));
}

/// What gnuplot writes for a script.
std::string run_gnuplot(const std::string& script) {
  const File input = nameless_file();
  const File errors = nameless_file();
  if (std::fwrite(script.data(), 1, script.size(), input.get()) != script.size() ||
      std::fflush(input.get()) != 0) {
    fail("plots need room for a temporary file: " + std::generic_category().message(errno));
  }
  std::rewind(input.get());
  std::array<int, 2> pipe{};
  if (::pipe2(pipe.data(), O_CLOEXEC) != 0)
    fail("gnuplot cannot be started: " + std::generic_category().message(errno));

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ::fileno(input.get()), 0);
  posix_spawn_file_actions_adddup2(&actions, pipe[1], 1);
  posix_spawn_file_actions_adddup2(&actions, ::fileno(errors.get()), 2);
  // -d: no settings of the user. As a file the script is read in blocks; from the standard input byte by
  // byte.
  std::array<std::string, 3> words{"gnuplot", "-d", "/dev/stdin"};
  std::array<char*, 4> arguments{words[0].data(), words[1].data(), words[2].data(), nullptr};
  pid_t child = -1;
  const int error = ::posix_spawnp(&child, "gnuplot", &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  ::close(pipe[1]);
  if (error != 0) {
    ::close(pipe[0]);
    if (error == ENOENT || error == EACCES || error == ENOTDIR) {
      fail(
          "reports need the program gnuplot, which was not found (install it, on Debian: apt install "
          "gnuplot-nox)");
    }
    fail("gnuplot cannot be started: " + std::generic_category().message(error));
  }

  std::string output;
  std::array<char, 65536> buffer{};
  while (true) {
    const ssize_t n = ::read(pipe[0], buffer.data(), buffer.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    output.append(buffer.data(), static_cast<std::size_t>(n));
  }
  ::close(pipe[0]);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    const std::string said = last_line(errors.get());
    fail("gnuplot could not draw the report" + (said.empty() ? "" : ": " + said) +
         " (version 5.4 is known to work)");
  }
  return output;
}

// ---- SVG
// ----------------------------------------------------------------------------------------------------------

/// Absolute coordinates to a tenth of a pixel as relative ones, which are half as long: "M1.00,2.00
/// L3.00,2.50" becomes "M1 2l2 .5". What holds other commands than M, L and Z comes back as it is.
std::string compact_path(std::string_view d) {
  std::string out;
  std::array<long, 2> at{};
  char last = 0;
  const auto number = [&](long tenths, bool first) {
    if (tenths < 0) {
      out += '-';
    } else if (!first) {
      out += ' ';
    }
    const long size = std::abs(tenths);
    if (size >= 10 || size == 0) out += std::to_string(size / 10);
    if (size % 10 != 0) (out += '.') += static_cast<char>('0' + size % 10);
  };
  for (std::size_t i = 0; i < d.size();) {
    const char c = d[i];
    if (c == ' ' || c == '\n' || c == '\t' || c == '\r') {
      ++i;
    } else if (c == 'Z') {
      out += last = 'z';
      ++i;
    } else if (c == 'M' || c == 'L') {
      std::array<long, 2> next{};
      ++i;
      for (std::size_t k = 0; k < 2; ++k) {
        double value = 0.0;
        const auto [end, error] = std::from_chars(d.data() + i, d.data() + d.size(), value);
        if (error != std::errc()) return std::string(d);
        next[k] = std::lround(10.0 * value);
        i = static_cast<std::size_t>(end - d.data());
        if (k == 0 && (i >= d.size() || d[i++] != ',')) return std::string(d);
      }
      // After z the current point is the start of the stretch; every z of gnuplot is followed by M or
      // nothing.
      if (c == 'L' && last == 'z') return std::string(d);
      const bool move = c == 'M';
      if (move || last != 'l') out += move ? 'M' : 'l';
      number(move ? next[0] : next[0] - at[0], move || last != 'l');
      number(move ? next[1] : next[1] - at[1], false);
      last = move ? 'M' : 'l';
      at = next;
    } else {
      return std::string(d);
    }
  }
  return out;
}

/// Rewrites one drawing of gnuplot for a page: ids of its own, nothing that is empty or unused, no namespace
/// addresses.
class SvgCleaner {
 public:
  SvgCleaner(std::string_view raw, std::string prefix) : raw_(raw), prefix_(std::move(prefix)) {}

  std::string clean(const Plot& plot) {
    find_used();
    const std::string text =
        escape_html(clean_text(plot.description.empty() ? plot.title : plot.description));
    out_ = fmt::format(
        "<svg viewBox=\"0 0 {} {}\" width=\"{}\" role=\"img\" aria-label=\"{}\"><title>{}</title>",
        plot.width, plot.height, plot.width, text, text);
    std::size_t at = raw_.find("<svg");
    at = at == std::string_view::npos ? raw_.size() : raw_.find('>', at) + 1;
    while (at < raw_.size()) {
      if (raw_[at] != '<') {
        const std::size_t end = std::min(raw_.find('<', at), raw_.size());
        const std::string_view content = raw_.substr(at, end - at);
        if (content.find_first_not_of(" \t\r\n") != std::string_view::npos) emit(content);
        at = end;
        continue;
      }
      const std::size_t end = raw_.find('>', at) + 1;
      if (end == 0) break;
      at = tag(raw_.substr(at, end - at), end);
    }
    return std::move(out_);
  }

 private:
  static bool is_named(std::string_view tag, std::string_view name) {
    return tag.substr(1, name.size()) == name && tag.find_first_of(" />", 1) == name.size() + 1;
  }

  static std::string_view attribute(std::string_view tag, std::string_view name) {
    for (std::size_t at = tag.find(name); at != std::string_view::npos; at = tag.find(name, at + 1)) {
      const std::size_t value = at + name.size();
      if (!is_blank(tag[at - 1]) || value + 1 >= tag.size() || tag[value] != '=') continue;
      const std::size_t end = tag.find(tag[value + 1], value + 2);
      if (end != std::string_view::npos) return tag.substr(value + 2, end - value - 2);
    }
    return {};
  }

  /// Which symbols are drawn; one may be made of another that stands before it, so the list is read
  /// backwards.
  void find_used() {
    std::vector<std::string_view> tags;
    for (std::size_t at = raw_.find('<'); at != std::string_view::npos; at = raw_.find('<', at + 1)) {
      const std::size_t end = raw_.find('>', at);
      if (end == std::string_view::npos) break;
      tags.push_back(raw_.substr(at, end - at + 1));
    }
    for (auto tag = tags.rbegin(); tag != tags.rend(); ++tag) {
      const std::string_view href = attribute(*tag, "xlink:href");
      const std::string_view id = attribute(*tag, "id");
      if (is_named(*tag, "use") && id.empty() && href == "#gpPt6") continue;  // see add_dot
      if (!href.empty() && (id.empty() || used_.contains(id))) used_.insert(href.substr(1));
    }
  }

  /// Handles the tag that ends at `end`; returns where to go on.
  std::size_t tag(std::string_view t, std::size_t end) {
    const auto after = [&](std::string_view closing) {
      const std::size_t found = raw_.find(closing, end);
      return found == std::string_view::npos ? raw_.size() : found + closing.size();
    };
    if (is_named(t, "title")) return after("</title>");
    if (is_named(t, "desc")) return after("</desc>");
    if (is_named(t, "filter")) return after("</filter>");
    const bool symbol = attribute(t, "id").substr(0, 2) == "gp";
    if (symbol && !used_.contains(attribute(t, "id"))) return end;
    if (t.substr(0, 2) == "</") end_dots();
    if (t == "</g>" || t == "</defs>") {
      if (!open_.empty() && open_.back().at + open_.back().length == out_.size()) {
        out_.resize(open_.back().at);  // nothing came into it
        open_.pop_back();
        return end;
      }
      if (!open_.empty()) open_.pop_back();
      out_ += t;
      return end;
    }
    if (t.substr(0, 2) == "</") {
      out_ += t;
      return end;
    }
    const std::size_t start = out_.size();
    if (add_dot(t)) return end;
    end_dots();
    const std::string_view d = attribute(t, "d");
    if (is_named(t, "path") && !symbol && !d.empty()) {
      const auto at = static_cast<std::size_t>(d.data() - t.data());
      rewrite(std::string(t.substr(0, at)) + compact_path(d) + std::string(t.substr(at + d.size())));
    } else {
      rewrite(t);
    }
    if (is_named(t, "g") || is_named(t, "defs")) open_.push_back({start, out_.size() - start});
    return end;
  }

  void emit(std::string_view content) { out_ += content; }

  /// Filled circles of one colour and size become one path of round dots: a map has thousands of them.
  bool add_dot(std::string_view t) {
    constexpr std::string_view kTranslate = "translate(";
    constexpr std::string_view kScale = "scale(";
    if (!is_named(t, "use") || attribute(t, "xlink:href") != "#gpPt6") return false;
    const std::string_view transform = attribute(t, "transform");
    const std::size_t place = transform.find(kTranslate);
    const std::size_t size = transform.find(kScale);
    if (place != 0 || size == std::string_view::npos) return false;
    const std::string_view at = transform.substr(kTranslate.size(), transform.find(')') - kTranslate.size());
    const std::string_view scale =
        transform.substr(size + kScale.size(), transform.find(')', size) - size - kScale.size());
    std::string look(attribute(t, "color"));
    std::erase_if(look, is_blank);
    double radius = 0.0;
    std::from_chars(scale.data(), scale.data() + scale.size(), radius);
    look = fmt::format("stroke=\"{}\" stroke-width=\"{:.2f}\"", look, 2.0 * radius);
    if (look != dots_look_) end_dots();
    dots_look_ = look;
    dots_ += fmt::format("M{}h0", at);
    return true;
  }
  void end_dots() {
    if (!dots_.empty())
      out_ += fmt::format("<path {} stroke-linecap=\"round\" d=\"{}\"/>", dots_look_, dots_);
    dots_.clear();
  }

  /// A tag with the prefix before every id, and each run of white space made one blank.
  void rewrite(std::string_view t) {
    bool blank = false;
    char quote = 0;
    for (std::size_t i = 0; i < t.size(); ++i) {
      const char c = t[i];
      if (is_blank(c)) {
        blank = true;
        continue;
      }
      const bool useless = quote == 0 ? c == '>' || c == '/' || c == '=' : c == quote;
      if (blank && !useless) out_ += ' ';
      blank = false;
      if (quote != 0) {
        if (c == quote) quote = 0;
      } else if (c == '"' || c == '\'') {
        quote = c;
      } else if (t.substr(i, 11) == "xlink:href=") {
        out_ += "href=";
        i += 10;
        continue;
      }
      out_ += c;
      const std::string_view before(out_);
      if (before.ends_with(" id=\"") || before.ends_with(" id='") || before.ends_with("href='#") ||
          before.ends_with("href=\"#") || before.ends_with("url(#")) {
        out_ += prefix_;
      }
    }
  }

  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

  struct Open {
    std::size_t at;
    std::size_t length;
  };

  std::string_view raw_;
  std::string prefix_;
  std::string out_;
  std::string dots_;
  std::string dots_look_;
  std::vector<Open> open_;
  std::set<std::string_view> used_;
};

}  // namespace

std::string gnuplot_script(const std::vector<Plot>& plots) { return Script().write(plots); }

std::vector<std::string> render(const std::vector<Plot>& plots) {
  std::vector<std::string> drawings;
  if (plots.empty()) return drawings;
  const std::string output = run_gnuplot(gnuplot_script(plots));
  constexpr std::string_view kEnd = "</svg>";
  std::string_view rest = output;
  for (const Plot& plot : plots) {
    const std::size_t end = rest.find(kEnd);
    if (end == std::string_view::npos) {
      fail(fmt::format("gnuplot drew {} of {} plots (version 5.4 is known to work)", drawings.size(),
                       plots.size()));
    }
    drawings.push_back(
        SvgCleaner(rest.substr(0, end + kEnd.size()), fmt::format("plot-{}-", drawings.size() + 1))
            .clean(plot));
    rest.remove_prefix(end + kEnd.size());
  }
  return drawings;
}

void thin(std::vector<double>& x, std::vector<double>& y, int columns) {
  const std::size_t n = std::min(x.size(), y.size());
  x.resize(n);
  y.resize(n);
  if (columns < 1 || n <= 2 * static_cast<std::size_t>(columns)) return;
  Extent extent;
  double last = -std::numeric_limits<double>::infinity();
  for (const double v : x) {
    if (!std::isfinite(v)) continue;
    if (v < last) return;
    last = v;
    extent.add(v, false);
  }
  if (!(extent.high > extent.low)) return;
  const auto column = [&](double v) {
    return std::min(columns - 1, static_cast<int>((v - extent.low) / (extent.high - extent.low) * columns));
  };
  const auto finite = [&](std::size_t i) { return std::isfinite(x[i]) && std::isfinite(y[i]); };
  std::vector<double> kept_x;
  std::vector<double> kept_y;
  const auto keep = [&](std::size_t i) {
    kept_x.push_back(x[i]);
    kept_y.push_back(y[i]);
  };
  for (std::size_t i = 0; i < n;) {
    if (!finite(i)) {
      keep(i++);
      continue;
    }
    std::size_t end = i;
    std::size_t least = i;
    std::size_t greatest = i;
    for (; end < n && finite(end) && column(x[end]) == column(x[i]); ++end) {
      if (y[end] < y[least]) least = end;
      if (y[end] > y[greatest]) greatest = end;
    }
    std::array<std::size_t, 4> chosen{i, std::min(least, greatest), std::max(least, greatest), end - 1};
    // Within the picture two points of a column are enough; the first and the last of all carry the ends.
    const bool at_border = i == 0 || end == n || !finite(i - 1) || !finite(end);
    const auto from = at_border ? chosen.begin() : chosen.begin() + 1;
    const auto to = at_border ? chosen.end() : chosen.end() - 1;
    for (auto c = from; c != to; ++c) {
      if (c == from || *c != *(c - 1)) keep(*c);
    }
    i = end;
  }
  x = std::move(kept_x);
  y = std::move(kept_y);
}

std::string controller_color(std::string_view id, std::size_t position) {
  // Eight that everybody can tell apart, and as many others for controllers (i) and on.
  static constexpr std::array<std::string_view, 16> kPalette{
      "#7a7a7a", "#e69f00", "#009e73", "#56b4e9", "#d55e00", "#0072b2", "#cc79a7", "#000000",
      "#8c3fc9", "#8a6d00", "#004d38", "#a50f4f", "#7f2704", "#4a4a8a", "#e0669a", "#a6a600"};
  if (id.size() == 1 && id[0] >= 'a' && id[0] <= 'p')
    return std::string(kPalette[static_cast<std::size_t>(id[0] - 'a')]);
  return std::string(kPalette[position % kPalette.size()]);
}

}  // namespace stribeck::report
