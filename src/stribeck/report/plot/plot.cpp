#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stribeck/io/error.hpp>
#include <stribeck/report/plot/gnuplot.hpp>
#include <stribeck/report/plot/plot.hpp>
#include <stribeck/report/plot/svg_cleaner.hpp>
#include <stribeck/report/plot/svg_squeeze.hpp>
#include <utility>

namespace stribeck::report {

namespace {

/// The last bytes of a drawing.
std::string_view end_of(Format format) {
  switch (format) {
    case Format::kPdf:
      return "%%EOF\n";
    case Format::kPng:
      return std::string_view("IEND\xae\x42\x60\x82", 8);
    case Format::kSvg:
      break;
  }
  return "</svg>";
}

/// Without the time at which it was drawn: the same plot gives the same bytes.
std::string timeless(std::string pdf) {
  constexpr std::string_view kKey = "/CreationDate (D:";
  if (const std::size_t key = pdf.find(kKey); key != std::string::npos) {
    for (std::size_t at = key + kKey.size(); at < pdf.size() && pdf[at] != ')'; ++at) {
      if (pdf[at] >= '0' && pdf[at] <= '9') pdf[at] = '0';
    }
  }
  return pdf;
}

}  // namespace

std::string described(const Plot& plot) {
  if (!plot.description.empty()) return plot.description;
  if (!plot.title.empty()) return plot.title;
  std::string out = plot.y_label.empty() ? "Drawing" : plot.y_label;
  if (!plot.x_label.empty()) out += " over " + plot.x_label;
  const char* before = ": ";
  for (const Series& s : plot.series) {
    if (s.label.empty()) continue;
    out += before + s.label;
    before = ", ";
  }
  return out;
}

std::vector<std::string> render(const std::vector<Plot>& plots, Format format) {
  std::vector<std::string> drawings;
  if (plots.empty()) return drawings;
  const std::string output = run_gnuplot(gnuplot_script(plots, format));
  const std::string_view last_bytes = end_of(format);
  std::string_view rest = output;
  for (const Plot& plot : plots) {
    const std::size_t end = rest.find(last_bytes);
    if (end == std::string_view::npos) {
      throw io::InputError(
          io::Problem{"", 0, "",
                      fmt::format("gnuplot drew {} of {} plots (version 5.4 is known to work)",
                                  drawings.size(), plots.size())});
    }
    const std::string_view drawing = rest.substr(0, end + last_bytes.size());
    if (format == Format::kSvg) {
      drawings.push_back(
          squeezed_svg(cleaned_svg(drawing, plot, fmt::format("plot-{}-", drawings.size() + 1))));
    } else {
      drawings.push_back(timeless(std::string(drawing)));
    }
    rest.remove_prefix(end + last_bytes.size());
  }
  return drawings;
}
void thin(std::vector<double>& x, std::vector<double>& y, int columns) {
  const std::size_t n = std::min(x.size(), y.size());
  x.resize(n);
  y.resize(n);
  if (columns < 1 || n <= 2 * static_cast<std::size_t>(columns)) return;
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  double last = -std::numeric_limits<double>::infinity();
  for (const double v : x) {
    if (!std::isfinite(v)) continue;
    if (v < last) return;
    last = v;
    low = std::min(low, v);
    high = v;
  }
  if (!(high > low)) return;
  const auto column = [&](double v) {
    return std::min(columns - 1, static_cast<int>((v - low) / (high - low) * columns));
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
    // Inside the picture two points of a column are enough; the first and the last of all are the ends of the line.
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
  // Eight colours that can be distinguished with colour blindness, and as many others for controllers (i) and following.
  static constexpr std::array<std::string_view, 16> kPalette{
      "#7a7a7a", "#e69f00", "#009e73", "#56b4e9", "#d55e00", "#0072b2", "#cc79a7", "#000000",
      "#8c3fc9", "#8a6d00", "#004d38", "#a50f4f", "#7f2704", "#4a4a8a", "#e0669a", "#a6a600"};
  if (id.size() == 1 && id[0] >= 'a' && id[0] <= 'p')
    return std::string(kPalette[static_cast<std::size_t>(id[0] - 'a')]);
  return std::string(kPalette[position % kPalette.size()]);
}

}  // namespace stribeck::report
