#include <algorithm>
#include <cmath>

#include <stribeck/sim/metrics.hpp>
#include <stribeck/workflow/live/contour_tracker.hpp>

namespace stribeck::workflow {

double ContourTracker::square_to(std::size_t i, const Point& p) const {
  const Point& a = points_[i];
  const Point& b = points_[i + 1];
  double length = 0.0;
  double along = 0.0;
  for (std::size_t k = 0; k < axes_; ++k) {
    length += (b[k] - a[k]) * (b[k] - a[k]);
    along += (p[k] - a[k]) * (b[k] - a[k]);
  }
  double share = along / length;
  if (i > 0) share = std::max(share, 0.0);
  if (i + 2 < points_.size()) share = std::min(share, 1.0);
  double square = 0.0;
  for (std::size_t k = 0; k < axes_; ++k) {
    const double d = p[k] - a[k] - share * (b[k] - a[k]);
    square += d * d;
  }
  return square;
}

double ContourTracker::signed_distance(std::size_t i, const Point& p, double square) const {
  const double distance = std::sqrt(square);
  if (axes_ != 2) return distance;
  const Point& a = points_[i];
  const Point& b = points_[i + 1];
  const double left = (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
  return left < 0.0 ? -distance : distance;
}

double ContourTracker::step(std::span<const double> commanded, std::span<const double> actual) {
  if (axes_ == 1) return actual[0] - commanded[0];
  Point r{};
  Point p{};
  std::copy_n(commanded.begin(), axes_, r.begin());
  std::copy_n(actual.begin(), axes_, p.begin());
  if (points_.empty() || points_.back() != r) points_.push_back(r);
  if (points_.size() >= 2 * kKept) {
    points_.erase(points_.begin(), points_.begin() + kKept);
    near_ -= std::min(near_, kKept);
  }
  if (points_.size() < 2) {
    double square = 0.0;
    for (std::size_t k = 0; k < axes_; ++k) square += (p[k] - r[k]) * (p[k] - r[k]);
    return std::sqrt(square);
  }
  double best = square_to(near_, p);
  // Forwards and backwards as long as it comes nearer; a few pieces farther, because noise makes small hills.
  constexpr std::size_t kOver = 8;
  const std::size_t from = near_;
  for (std::size_t i = from + 1, end = from + kOver; i + 1 < points_.size() && i <= end; ++i) {
    const double square = square_to(i, p);
    if (square <= best) {
      best = square;
      near_ = i;
      end = i + kOver;
    }
  }
  for (std::size_t i = from, end = from > kOver ? from - kOver : 0; i-- > end;) {
    const double square = square_to(i, p);
    if (square < best) {
      best = square;
      near_ = i;
      end = i > kOver ? i - kOver : 0;
    }
  }
  return signed_distance(near_, p, best);
}

void ContourTracker::restart() {
  points_.clear();
  near_ = 0;
}

void QuadrantGlitches::step(double t, std::span<const double> commanded_m, double error_um,
                            std::vector<QuadrantGlitch>& found) {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    Axis& a = axes_[i];
    const double r = commanded_m[i];
    if (a.known && r != a.last) {
      const int direction = r > a.last ? 1 : -1;
      if (a.direction != 0 && direction != a.direction) {
        if (a.open) found.push_back(a.glitch);  // turned again before its travel was complete
        a.open = true;
        a.from = r;
        a.glitch = {t, i, direction > 0, 0.0};
      }
      a.direction = direction;
    }
    a.known = true;
    a.last = r;
    if (!a.open) continue;
    if (std::abs(r - a.from) > sim::kGlitchTravel) {
      a.open = false;
      found.push_back(a.glitch);
    } else if (std::abs(error_um) > std::abs(a.glitch.error_um)) {
      a.glitch.error_um = error_um;
    }
  }
}

void QuadrantGlitches::restart() { axes_.assign(axes_.size(), {}); }

}  // namespace stribeck::workflow
