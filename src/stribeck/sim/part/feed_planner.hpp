#pragma once
/// The feed along the segments of a part program: as fast as every segment permits, from rest to rest, with limited jerk.
///
/// Inside sim/part only; callers use plan_part() of part_path.hpp.
/// Real time: no.

#include <algorithm>
#include <cmath>
#include <limits>
#include <stribeck/sim/part/part_path.hpp>
#include <vector>

namespace stribeck::sim {

/// Smallest speed and limits over any range of segments: a tree of minima.
class Minima {
 public:
  explicit Minima(const std::vector<SegmentLimits>& of) : of_(of), size_(of.size()) {
    slowest_.resize(2 * size_);
    weakest_.resize(2 * size_);
    for (std::size_t i = 0; i < size_; ++i) {
      slowest_[size_ + i] = i;
      weakest_[size_ + i] = of[i];
    }
    for (std::size_t i = size_; i-- > 1;) {
      slowest_[i] = slower(slowest_[2 * i], slowest_[2 * i + 1]);
      weakest_[i] = weaker(weakest_[2 * i], weakest_[2 * i + 1]);
    }
  }
  [[nodiscard]] double speed(std::size_t i) const { return of_[i].speed; }
  /// The slowest segment of [first, last), the first one of equals.
  [[nodiscard]] std::size_t slowest(std::size_t first, std::size_t last) const {
    std::size_t best = first;
    each(first, last, [&](std::size_t node) { best = slower(best, slowest_[node]); });
    return best;
  }
  [[nodiscard]] SegmentLimits weakest(std::size_t first, std::size_t last) const {
    SegmentLimits all = of_[first];
    each(first, last, [&](std::size_t node) { all = weaker(all, weakest_[node]); });
    return all;
  }

 private:
  [[nodiscard]] std::size_t slower(std::size_t a, std::size_t b) const {
    const double va = of_[a].speed;
    const double vb = of_[b].speed;
    return vb < va || (vb == va && b < a) ? b : a;
  }
  static SegmentLimits weaker(const SegmentLimits& a, const SegmentLimits& b) {
    return {std::min(a.speed, b.speed), std::min(a.acceleration, b.acceleration), std::min(a.jerk, b.jerk)};
  }
  template <class F>
  void each(std::size_t first, std::size_t last, F&& f) const {
    for (first += size_, last += size_; first < last; first /= 2, last /= 2) {
      if (first % 2 == 1) f(first++);
      if (last % 2 == 1) f(--last);
    }
  }

  const std::vector<SegmentLimits>& of_;
  std::size_t size_;
  std::vector<std::size_t> slowest_;
  std::vector<SegmentLimits> weakest_;
};

/// Plans the feed over segments and writes it as phases.
class FeedPlanner {
 public:
  /// `stepwise`: a segment with much weaker limits than those beside it gets a ramp of its own, so that its limits do not slow
  /// the ramps of its neighbours. Narrow bends that are cut into pieces need this.
  FeedPlanner(const std::vector<SegmentLimits>& limits, const std::vector<double>& begin,
              std::vector<path::FeedPhase>& phases, bool stepwise = false)
      : minima_(limits), begin_(begin), phases_(phases), stepwise_(stepwise) {}

  /// From rest at the first of [first, last) to rest at the end of the last.
  void run(std::size_t first, std::size_t last) {
    todo_.push_back({first, last, 0.0, 0.0});
    while (!todo_.empty()) {
      const Stretch next = todo_.back();
      todo_.pop_back();
      plan(next);
    }
  }
  void dwell(double seconds, double s) {
    if (!(seconds > 0.0)) return;
    phases_.push_back({time_, s, 0.0, 0.0, 0.0});
    time_ += seconds;
  }
  [[nodiscard]] double time() const { return time_; }

 private:
  struct Stretch {
    std::size_t first;
    std::size_t last;
    double from;  ///< speed at its ends [m/s]
    double to;
    /// Limits for the ramps, where a ramp with these limits has been found to pass slower segments slowly enough.
    double acceleration = std::numeric_limits<double>::infinity();
    double jerk = std::numeric_limits<double>::infinity();
  };

  /// Invariants: a ramp between both end speeds fits into the stretch. A profile that rises at once to the highest of both end speeds
  /// and the slowest segment's, and falls as late as possible, passes every segment at its speed or slower.
  void plan(const Stretch& r) {
    if (stepwise_ && (step(r, true) || step(r, false))) return;
    SegmentLimits w = minima_.weakest(r.first, r.last);
    w.acceleration = std::min(w.acceleration, r.acceleration);
    w.jerk = std::min(w.jerk, r.jerk);
    const double distance = begin_[r.last] - begin_[r.first];
    w.speed = std::max({w.speed, r.from, r.to});
    double top = path::reachable_between(r.from, r.to, distance, w.speed, w.acceleration, w.jerk);
    if (top < w.speed || r.last - r.first == 1) return emit(r, top, w);
    // Rises to the slowest segment outside the ramps; segments within the ramps may be slower.
    for (;;) {
      const double risen = begin_[r.first] + path::SpeedRamp(r.from, top, w.acceleration, w.jerk).distance();
      const double falls = begin_[r.last] - path::SpeedRamp(top, r.to, w.acceleration, w.jerk).distance();
      const std::size_t enters = segment_at(risen, r);
      const std::size_t k = minima_.slowest(enters, segment_at(falls, r) + 1);
      const double next = minima_.speed(k);
      if (next <= top) return cross(r, k, top, risen, falls, w);
      const double higher = path::reachable_between(r.from, r.to, distance, next, w.acceleration, w.jerk);
      const Slow slow = too_slow(r, higher, w);
      if (slow.segment != kNone) return split(r, slow, top, w);
      top = higher;
      if (higher < next) return emit(r, top, w);
    }
  }

  /// Plans the first or the last segment of a stretch on its own where its limits are much weaker than those of the rest; false:
  /// nothing done.
  bool step(const Stretch& r, bool at_begin) {
    constexpr double kWeak = 0.7;
    if (r.last - r.first < 2 || std::isfinite(r.acceleration)) return false;
    const std::size_t border = at_begin ? r.first + 1 : r.last - 1;
    const SegmentLimits one = at_begin ? minima_.weakest(r.first, border) : minima_.weakest(border, r.last);
    const SegmentLimits rest = at_begin ? minima_.weakest(border, r.last) : minima_.weakest(r.first, border);
    if (one.acceleration > kWeak * rest.acceleration && one.jerk > kWeak * rest.jerk) return false;
    const double end = at_begin ? r.from : r.to;
    const double far_end = at_begin ? r.to : r.from;
    const double most = std::min(one.speed, rest.speed);
    if (end > most || far_end > rest.speed) return false;
    const double length = at_begin ? begin_[border] - begin_[r.first] : begin_[r.last] - begin_[border];
    const double others = begin_[r.last] - begin_[r.first] - length;
    const double v = path::reachable(end, length, most, one.acceleration, one.jerk);
    if (path::SpeedRamp(v, far_end, rest.acceleration, rest.jerk).distance() > others) return false;
    todo_.push_back({border, r.last, v, r.to});
    todo_.push_back({r.first, border, r.from, v});
    return true;
  }

  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  /// The segment of a stretch at a distance.
  [[nodiscard]] std::size_t segment_at(double s, const Stretch& r) const {
    const auto first = begin_.begin() + static_cast<std::ptrdiff_t>(r.first);
    const auto last = begin_.begin() + static_cast<std::ptrdiff_t>(r.last);
    const auto it = std::upper_bound(first, last, s);
    return r.first + static_cast<std::size_t>(std::max<std::ptrdiff_t>(it - first, 1) - 1);
  }

  /// A segment that a ramp would pass too fast; kNone: there is none.
  struct Slow {
    std::size_t segment = kNone;
    bool rising = false;
  };

  /// For ramps up to a speed at the beginning of a stretch and down from it at the end: the too slow segment nearest to that end.
  [[nodiscard]] Slow too_slow(const Stretch& r, double top, const SegmentLimits& w) const {
    const path::SpeedRamp up(r.from, top, w.acceleration, w.jerk);
    const path::SpeedRamp down(r.to, top, w.acceleration, w.jerk);
    const double s0 = begin_[r.first];
    const double s1 = begin_[r.last];
    for (std::size_t i = r.first; i < r.last && begin_[i] < s0 + up.distance(); ++i) {
      const double there = std::min(begin_[i + 1] - s0, up.distance());
      if (minima_.speed(i) < top && path::speed_after(up, there) > minima_.speed(i)) return {i, true};
    }
    for (std::size_t i = r.last; i-- > r.first && begin_[i + 1] > s1 - down.distance();) {
      const double there = std::min(s1 - begin_[i], down.distance());
      if (minima_.speed(i) < top && path::speed_after(down, there) > minima_.speed(i)) return {i, false};
    }
    return {};
  }

  /// Crosses segment k at constant speed, as far as the ramps permit, and plans the parts before and behind it separately.
  void cross(const Stretch& r, std::size_t k, double c, double risen, double falls, const SegmentLimits& w) {
    const bool before = k > r.first && risen <= begin_[k];
    const bool behind = k + 1 < r.last && falls >= begin_[k + 1];
    if (!before && !behind) return emit(r, c, w);
    if (behind) push(k + 1, r.last, c, r.to, w);
    push(before ? k : r.first, behind ? k + 1 : r.last, before ? c : r.from, behind ? c : r.to, w);
    if (before) push(r.first, k, r.from, c, w);
  }

  /// A segment limits a ramp to more than `top`: the ramp is interrupted at the far end of that segment, as seen from the end of the
  /// stretch where the ramp begins. Where that does not fit, the stretch is planned as a whole, up to `top`.
  void split(const Stretch& r, const Slow& slow, double top, SegmentLimits w) {
    const double s0 = begin_[r.first];
    const double s1 = begin_[r.last];
    const std::size_t border = slow.rising ? slow.segment + 1 : slow.segment;
    w.speed = top;
    if (border == r.first || border == r.last) return emit(r, top, w);
    const double most = minima_.speed(slow.segment);
    const double near_way = slow.rising ? begin_[border] - s0 : s1 - begin_[border];
    double v = path::reachable(slow.rising ? r.from : r.to, near_way, most, w.acceleration, w.jerk);
    const auto rest = [&](double speed) {
      return slow.rising ? Stretch{border, r.last, speed, r.to} : Stretch{r.first, border, r.from, speed};
    };
    // Above `top` the other side has not been checked yet.
    if (v > top && too_slow(rest(v), v, w).segment != kNone) v = top;
    if (v > most || v < (slow.rising ? r.from : r.to)) return emit(r, top, w);
    const auto fits = [&](const Stretch& part) {
      return path::SpeedRamp(part.from, part.to, w.acceleration, w.jerk).distance() <=
             begin_[part.last] - begin_[part.first];
    };
    if (!fits(rest(v))) return emit(r, top, w);
    push(border, r.last, v, r.to, w);
    push(r.first, border, r.from, v, w);
  }

  /// Adds a stretch to be planned next. It keeps the limits of the ramps found so far where these pass slower segments.
  void push(std::size_t first, std::size_t last, double from, double to, const SegmentLimits& w) {
    Stretch part{first, last, from, to};
    if (minima_.weakest(first, last).speed < std::max(from, to)) {
      part.acceleration = w.acceleration;
      part.jerk = w.jerk;
    }
    todo_.push_back(part);
  }

  void emit(const Stretch& r, double top, const SegmentLimits& w) {
    const double s0 = begin_[r.first];
    const double s1 = begin_[r.last];
    const path::SpeedRamp up(r.from, top, w.acceleration, w.jerk);
    const path::SpeedRamp down(top, r.to, w.acceleration, w.jerk);
    const double cruise = std::max(s1 - s0 - up.distance() - down.distance(), 0.0);
    const auto add = [&](const path::SpeedRamp& ramp, double s) {
      const auto p = ramp.phases(time_, s);
      if (ramp.jerk_time > 0.0) phases_.push_back(p[0]);
      if (ramp.hold_time > 0.0) phases_.push_back(p[1]);
      if (ramp.jerk_time > 0.0) phases_.push_back(p[2]);
      time_ += ramp.duration();
    };
    add(up, s0);
    if (cruise > 0.0) {
      phases_.push_back({time_, s0 + up.distance(), top, 0.0, 0.0});
      time_ += cruise / top;
    }
    add(down, s1 - down.distance());
  }

  Minima minima_;
  const std::vector<double>&
      begin_;  ///< distance at the beginning of every segment, and at the end of the last
  std::vector<path::FeedPhase>& phases_;
  bool stepwise_;
  std::vector<Stretch> todo_;
  double time_ = 0.0;
};

}  // namespace stribeck::sim
