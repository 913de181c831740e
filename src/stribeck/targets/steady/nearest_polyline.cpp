#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include <stribeck/core/number_text.hpp>
#include <stribeck/targets/steady/nearest_polyline.hpp>

namespace stribeck::targets {
namespace {

/// y = slope·x + height
struct Piece {
  double slope = 0.0;
  double height = 0.0;

  [[nodiscard]] double at(double x) const noexcept { return slope * x + height; }
};

/// Convex set of lines, given by its vertices in the plane of slope and height.
using Lines = std::vector<Piece>;

/// Keeps the lines on one side of the point (x, y): below it for side = 1, above it for −1.
Lines clipped(const Lines& lines, double x, double y, double side) {
  Lines left;
  left.reserve(lines.size() + 2);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Piece& a = lines[i];
    const Piece& b = lines[(i + 1) % lines.size()];
    const double da = side * (a.at(x) - y);
    const double db = side * (b.at(x) - y);
    if (da <= 0.0) left.push_back(a);
    if ((da < 0.0 && db > 0.0) || (da > 0.0 && db < 0.0)) {
      const double t = da / (da - db);
      left.push_back({a.slope + t * (b.slope - a.slope), a.height + t * (b.height - a.height)});
    }
  }
  return left;
}

/// Vertex with the largest (side = 1) or smallest value at x.
Piece extreme(const Lines& lines, double x, double side) {
  return *std::max_element(lines.begin(), lines.end(),
                           [&](const Piece& a, const Piece& b) { return side * a.at(x) < side * b.at(x); });
}

Piece middle_of(const Lines& lines) {
  Piece m;
  for (const Piece& l : lines) {
    m.slope += l.slope / static_cast<double>(lines.size());
    m.height += l.height / static_cast<double>(lines.size());
  }
  return m;
}

/// The curve, scaled to a square of side one to keep rounding small.
struct Scaled {
  std::vector<double> x;
  std::vector<double> y;
  double x0 = 0.0;
  double y0 = 0.0;
  double width = 1.0;
  double height = 1.0;
  double steepest = 1.0;
};

Scaled scaled(std::span<const double> x, std::span<const double> y) {
  if (x.size() != y.size() || x.size() < 2) throw std::invalid_argument("a curve needs two samples or more");
  Scaled s;
  s.x0 = x.front();
  s.width = x.back() - x.front();
  const auto [low, high] = std::minmax_element(y.begin(), y.end());
  s.y0 = *low;
  s.height = *high > *low ? *high - *low : 1.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (i > 0 && !(x[i] > x[i - 1])) throw std::invalid_argument("the samples of a curve must ascend");
    s.x.push_back((x[i] - s.x0) / s.width);
    s.y.push_back((y[i] - s.y0) / s.height);
    if (i > 0) s.steepest = std::max(s.steepest, std::abs(s.y[i] - s.y[i - 1]) / (s.x[i] - s.x[i - 1]));
  }
  return s;
}

std::optional<std::vector<Piece>> lines_within(const Scaled& s, double tolerance, std::size_t pieces) {
  const std::size_t n = s.x.size();
  // No line through the band from one sample to the next is steeper than this.
  double closest = 1.0;
  for (std::size_t i = 1; i < n; ++i) closest = std::min(closest, s.x[i] - s.x[i - 1]);
  const double most = s.steepest + 2.0 * tolerance / closest + 1.0;
  const Lines all{{-most, -2.0 - most}, {most, -2.0 - most}, {most, 2.0 + most}, {-most, 2.0 + most}};

  std::vector<Piece> taken;
  Lines lines = all;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < n; ++i) {
    Lines next = clipped(clipped(lines, s.x[i], s.y[i] + tolerance, 1.0), s.x[i], s.y[i] - tolerance, -1.0);
    if (!next.empty()) {
      lines = std::move(next);
      continue;
    }
    // No line reaches this sample: the tunnel turns up (side 1) or down (−1).
    const double side = extreme(lines, s.x[i], 1.0).at(s.x[i]) < s.y[i] - tolerance ? 1.0 : -1.0;
    const Piece furthest = extreme(lines, s.x[i], side);
    if (taken.size() + 1 == pieces) return std::nullopt;
    taken.push_back(furthest);
    std::size_t last = begin;
    double gap = std::numeric_limits<double>::infinity();
    for (std::size_t k = begin; k < i; ++k) {
      const double here = tolerance - side * (furthest.at(s.x[k]) - s.y[k]);
      if (here <= gap + 1e-12) {
        gap = std::min(gap, here);
        last = k;
      }
    }
    // Only the wall on that side limits: before the corner the last piece is in the tunnel, behind it the new one starts.
    lines = all;
    for (std::size_t k = last; k < i; ++k) lines = clipped(lines, s.x[k], s.y[k] + side * tolerance, side);
    lines = clipped(clipped(lines, s.x[i], s.y[i] + tolerance, 1.0), s.x[i], s.y[i] - tolerance, -1.0);
    if (lines.empty()) return std::nullopt;
    begin = last;
  }
  taken.push_back(middle_of(lines));
  return taken;
}

Polyline joined(const std::vector<Piece>& lines, const Scaled& s, std::span<const double> x,
                std::span<const double> y) {
  Polyline p;
  const auto add = [&](double at, double value) {
    p.corners.push_back({s.x0 + s.width * at, s.y0 + s.height * value});
  };
  add(0.0, lines.front().at(0.0));
  double before = 0.0;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const Piece& a = lines[i - 1];
    const Piece& b = lines[i];
    before = std::clamp((b.height - a.height) / (a.slope - b.slope), before, 1.0);
    add(before, b.at(before));
  }
  add(1.0, lines.back().at(1.0));
  p.corners.back().x = x.back();
  for (std::size_t i = 0; i < x.size(); ++i)
    p.largest_error = std::max(p.largest_error, std::abs(p.at(x[i]) - y[i]));
  return p;
}

}  // namespace

double Polyline::at(double x) const noexcept {
  if (x <= corners.front().x) return corners.front().y;
  for (std::size_t i = 1; i < corners.size(); ++i) {
    const Corner& a = corners[i - 1];
    const Corner& b = corners[i];
    if (x <= b.x) return b.x > a.x ? a.y + (b.y - a.y) * (x - a.x) / (b.x - a.x) : b.y;
  }
  return corners.back().y;
}

std::optional<Polyline> polyline_within(std::span<const double> x, std::span<const double> y,
                                        double tolerance, std::size_t pieces) {
  const Scaled s = scaled(x, y);
  const auto lines = lines_within(s, tolerance / s.height, pieces);
  if (!lines) return std::nullopt;
  return joined(*lines, s, x, y);
}

Polyline nearest_polyline(std::span<const double> x, std::span<const double> y, std::size_t pieces) {
  if (pieces == 0) throw std::invalid_argument("a polyline has at least one piece");
  const Scaled s = scaled(x, y);
  // For a single piece half the height is enough.
  double high = 0.5 + 1e-9;
  double low = 0.0;
  std::vector<Piece> best = lines_within(s, high, pieces).value();
  constexpr double kNear = 1e-6;  // share of the height
  while (high - low > kNear) {
    const double tolerance = 0.5 * (low + high);
    if (auto lines = lines_within(s, tolerance, pieces)) {
      best = std::move(*lines);
      high = tolerance;
    } else {
      low = tolerance;
    }
  }
  return joined(best, s, x, y);
}

double with_digits(double value, int digits) { return number_in(fmt::format("{:.{}g}", value, digits)); }

}  // namespace stribeck::targets
