#include <algorithm>
#include <cmath>
#include <limits>
#include <stribeck/path/corner.hpp>
#include <stribeck/path/frame.hpp>
#include <stribeck/sim/part/feed_planner.hpp>
#include <stribeck/sim/part/tame_pieces.hpp>

namespace stribeck::sim {
namespace {

using path::Segment;
using path::SegmentKind;

/// Shorter moves have no direction.
constexpr double kNoWay = 1e-10;

template <std::size_t N>
Vec<double, N> narrowed(const Vec<double, 3>& v) {
  Vec<double, N> r;
  for (std::size_t i = 0; i < N; ++i) r[i] = v[i];
  return r;
}

template <std::size_t N>
Segment<N> line(const Vec<double, 3>& from, const Vec<double, 3>& to) {
  const Vec<double, N> chord = narrowed<N>(to) - narrowed<N>(from);
  Segment<N> s;
  s.length = s.extent = norm(chord);
  s.c[0] = narrowed<N>(from);
  if (s.length > 0.0) s.c[1] = (1.0 / s.length) * chord;
  return s;
}

template <std::size_t N>
Segment<N> arc(const Vec<double, 3>& from, const PartMove& move) {
  // Ends where it began, but for rounding of the numbers themselves: once around.
  constexpr double kOnceAround = 1e-12;
  const Vec<double, 3>& n = move.normal;
  const auto in_plane = [&](const Vec<double, 3>& p) {
    const auto d = p - move.centre;
    return d - dot(d, n) * n;
  };
  const auto first = in_plane(from);
  const auto last = in_plane(move.to);
  const double r0 = norm(first);
  if (!(r0 > kNoWay)) return line<N>(from, move.to);
  const auto u = (1.0 / r0) * first;
  const auto v = path::cross(n, u);
  double angle = std::atan2(dot(last, v), dot(last, u));
  const double side = move.turns < 0 ? -1.0 : 1.0;
  angle *= side;
  if (angle < kOnceAround) angle += 2.0 * kPi;
  angle += 2.0 * kPi * (std::abs(move.turns) - 1);
  const double lift = dot(move.to - from, n);
  Segment<N> s;
  s.kind = SegmentKind::kArc;
  s.radius = r0;
  s.growth = norm(last) - r0;
  // Rounded ends: to rounding of the numbers themselves it is a circle.
  if (std::abs(s.growth) < 1e-14) s.growth = 0.0;
  s.angle = side * angle;
  s.length = std::hypot((r0 + 0.5 * s.growth) * angle, lift);
  // The place of the centre along the normal is that of the start.
  s.c[0] = narrowed<N>(from - first);
  s.c[1] = narrowed<N>(u);
  s.c[2] = narrowed<N>(v);
  s.c[3] = narrowed<N>(lift * n);
  s.extent = s.distance(s.length);
  return s;
}

template <std::size_t N>
struct Leg {
  Segment<N> segment;
  PartMove end;            ///< what happens at its end
  double cut_begin = 0.0;  ///< taken off by the corners
  double cut_end = 0.0;
  Segment<N> corner;   ///< at its end, if cut_end > 0
  bool stops = false;  ///< at its end
};

/// How far the corner is from the programmed path, and that from the corner.
template <std::size_t N>
double deviation_of(const Segment<N>& before, const Segment<N>& after, const Segment<N>& corner) {
  constexpr int kPoints = 12;
  const Vec<double, N> at = before.point(before.length);
  double worst = norm(at - corner.point(corner.nearest(at, 0.5 * corner.length)));
  for (int i = 1; i < kPoints; ++i) {
    const Vec<double, N> p = corner.point(corner.length * i / kPoints);
    const double to_before = norm(p - before.point(before.nearest(p, before.length)));
    const double to_after = norm(p - after.point(after.nearest(p, 0.0)));
    worst = std::max(worst, std::min(to_before, to_after));
  }
  return worst;
}

/// Whether two segments meet without a jump of direction or curvature, to rounding.
template <std::size_t N>
bool smooth(const Segment<N>& before, const Segment<N>& after) {
  const auto a = before.template derivatives<2>(before.length);
  const auto b = after.template derivatives<2>(0.0);
  return norm(a[1] - b[1]) < 1e-9 && norm(a[2] - b[2]) < 1e-9 * (norm(a[2]) + norm(b[2])) + 1e-12;
}

/// Rounds the end of a leg, or makes it a stop. Returns the deviation.
template <std::size_t N>
double join(Leg<N>& leg, Leg<N>& next) {
  constexpr double kSharpest = 0.25881904510252074;  // cos(150°/2)
  constexpr double kMostTurn = 0.5;                  // of an arc within a corner [rad]
  if (leg.end.junction == Junction::kStop) {
    leg.stops = true;
    return 0.0;
  }
  const Segment<N>& before = leg.segment;
  const Segment<N>& after = next.segment;
  if (smooth(before, after)) return 0.0;
  const Vec<double, N> t0 = before.template derivatives<1>(before.length)[1];
  const Vec<double, N> t1 = after.template derivatives<1>(0.0)[1];
  const path::HalfTurn turn = path::half_turn(t0, t1);
  double tolerance = leg.end.tolerance;
  bool stop = turn.cosine < kSharpest;
  if (leg.end.junction == Junction::kExact) {
    stop = stop || turn.sine > std::sin(0.5 * kPi / 180.0);
    tolerance = kExactTolerance;
  }
  if (stop || !(tolerance > 0.0)) {
    leg.stops = true;
    return 0.0;
  }
  double d = 0.5 * std::min(before.length, after.length);
  for (const Segment<N>* s : {&before, &after}) {
    if (s->kind == SegmentKind::kArc) d = std::min(d, kMostTurn * s->length / std::abs(s->angle));
  }
  double off = 0.0;
  const bool straight = before.kind == SegmentKind::kLine && after.kind == SegmentKind::kLine;
  if (straight) d = std::min(d, path::blend_length(tolerance, turn.sine));
  for (int i = 0; i < 40; ++i) {
    leg.corner = path::make_corner(before, before.length - d, after, d);
    off = straight ? path::blend_deviation(d, turn.sine) : deviation_of(before, after, leg.corner);
    if (off <= tolerance * (1.0 + 1e-9)) break;
    // The deviation grows with d, or with its square where only the curvature jumps.
    d *= std::clamp(0.98 * std::sqrt(tolerance / off), 0.1, 0.95);
  }
  if (off > tolerance * (1.0 + 1e-9)) {
    leg.stops = true;
    return 0.0;
  }
  leg.corner.extent = leg.corner.distance(leg.corner.length);
  leg.cut_end = d;
  next.cut_begin = d;
  return off;
}

/// The part of a segment from x0 to x1.
template <std::size_t N>
Segment<N> trimmed(const Segment<N>& s, double x0, double x1) {
  Segment<N> r = s;
  r.length = x1 - x0;
  if (s.kind == SegmentKind::kLine) {
    r.c[0] = s.point(x0);
    r.extent = r.length;
    return r;
  }
  const double share = r.length / s.length;
  const double turned = s.angle * x0 / s.length;
  r.angle = s.angle * share;
  r.growth = s.growth * share;
  r.radius = s.radius + s.growth * x0 / s.length;
  r.c[0] = s.c[0] + (x0 / s.length) * s.c[3];
  r.c[1] = std::cos(turned) * s.c[1] + std::sin(turned) * s.c[2];
  r.c[2] = std::cos(turned) * s.c[2] - std::sin(turned) * s.c[1];
  r.c[3] = share * s.c[3];
  r.extent = r.distance(r.length);
  return r;
}

/// Segments in a row become a part: each behind the last one, and the feed planned from stop to stop.
template <std::size_t N>
class Assembly {
 public:
  Assembly(Part<N>& part, const PartLimits<N>& limits, bool stepwise = false)
      : part_(part), limits_(limits), stepwise_(stepwise) {}

  void add(Segment<N> s, double feed) {
    s.begin = phi_;
    s.travelled = begin_.back();
    phi_ += s.length;
    begin_.push_back(s.travelled + s.extent);
    segment_limits_.push_back(limits_on<N>(s, feed, limits_));
    part_.segments.push_back(std::move(s));
  }
  /// Behind the segments so far.
  void stop(double dwell) {
    const std::size_t last = stops_.empty() ? 0 : stops_.back().first;
    if (part_.segments.size() > last || dwell > 0.0) stops_.emplace_back(part_.segments.size(), dwell);
  }
  void finish() {
    FeedPlanner planner(segment_limits_, begin_, part_.phases, stepwise_);
    std::size_t first = 0;
    for (const auto& [last, dwell] : stops_) {
      planner.run(first, last);
      planner.dwell(dwell, begin_[last]);
      first = last;
    }
    part_.path = path::SegmentPath<N>(part_.segments);
    part_.feed = path::FeedProfile(part_.phases, planner.time(), begin_.back());
    part_.summary.length = begin_.back();
    part_.summary.duration = planner.time();
  }

 private:
  Part<N>& part_;
  const PartLimits<N>& limits_;
  bool stepwise_;
  double phi_ = 0.0;
  std::vector<double> begin_{0.0};
  std::vector<SegmentLimits> segment_limits_;
  std::vector<std::pair<std::size_t, double>> stops_;  // after how many segments, for how long
};

}  // namespace

template <std::size_t N>
path::PathPoint<N> PartMotion<N>::at(double time) noexcept {
  constexpr double kCorner = 0.5;  // cosine; as in motion_frame.hpp
  const path::SpeedLaw::Point law = part_.feed.at(time);
  const auto& segments = part_.segments;
  while (segment_ + 1 < segments.size() && law.s >= segments[segment_ + 1].travelled) ++segment_;
  const Segment<N>& s = segments[segment_];
  const double x = s.place(law.s - s.travelled);
  const auto q = s.point(Taylor<4>::variable(x));
  const Taylor<3> stretch = norm(path::differentiated<3, 1>(q));
  const Taylor<2> inverse = Taylor<2>(1.0) / path::shortened<2>(stretch);
  const double rate = law.speed * inverse.c[0];
  const double rate2 = (law.acceleration - rate * rate * stretch.c[1]) * inverse.c[0];
  const Vec<double, N> q1 = path::detail::derivative_of<1>(q);
  const Vec<double, N> q2 = path::detail::derivative_of<2>(q);
  path::PathPoint<N> r;
  r.phi = s.begin + x;
  r.position = path::detail::derivative_of<0>(q);
  r.velocity = rate * q1;
  r.acceleration = rate * rate * q2 + rate2 * q1;
  const Vec<double, N> t = inverse.c[0] * q1;
  rt_ = started_ && dot(t, rt_[0]) > kCorner ? path::transport(rt_, position_, r.position, t)
                                             : path::first_frame(t, q2);
  started_ = true;
  position_ = r.position;
  const path::Frame<N> f = path::transported_frame(q, inverse, rt_);
  r.frame = f.rt;
  for (std::size_t i = 0; i < N; ++i) {
    r.frame_rate[i] = rate * f.first[i];
    r.frame_acceleration[i] = rate * rate * f.second[i] + rate2 * f.first[i];
  }
  return r;
}

template <std::size_t N>
SegmentLimits limits_on(const Segment<N>& segment, double feed, const PartLimits<N>& limits) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  // Shares of acceleration and jerk that the curve alone may take at the highest speed; along a circle 0.8 across leaves
  // 0.6 along the path.
  constexpr double kAcross = 0.8;
  constexpr double kCurveJerk = 0.6;
  constexpr double kMixedJerk = 0.25;
  if (segment.kind == SegmentKind::kLine) {
    SegmentLimits r{feed, kNone, kNone};
    for (std::size_t i = 0; i < N; ++i) {
      const double t = std::abs(segment.c[1][i]);
      r.speed = std::min(r.speed, limits.speed[i] / t);
      r.acceleration = std::min(r.acceleration, limits.acceleration[i] / t);
      r.jerk = std::min(r.jerk, limits.jerk[i] / t);
    }
    return r;
  }
  // Between two places the derivatives are larger by less than this.
  const bool is_arc = segment.kind == SegmentKind::kArc;
  const int places = is_arc ? 64 : 40;
  const double margin = is_arc ? 1.005 : 1.03;
  const double range = is_arc && std::abs(segment.angle) > 2.0 * kPi
                           ? segment.length * 2.0 * kPi / std::abs(segment.angle)
                           : segment.length;
  std::vector<std::array<Vec<double, N>, 3>> d;
  d.reserve(static_cast<std::size_t>(places) + 1);
  for (int k = 0; k <= places; ++k) {
    const auto q = segment.point(Taylor<3>::variable(range * k / places));
    const auto first = path::differentiated<2, 1>(q);
    const Taylor<2> inverse = Taylor<2>(1.0) / norm(first);
    const auto t = inverse * first;
    const auto bend = path::shortened<1>(inverse) * path::differentiated<1, 1>(t);
    const Vec<double, N> third = inverse.c[0] * path::detail::derivative_of<1>(bend);
    d.push_back({path::detail::derivative_of<0>(t), path::detail::derivative_of<0>(bend), third});
    for (Vec<double, N>& v : d.back()) {
      for (std::size_t i = 0; i < N; ++i) v[i] = margin * std::abs(v[i]);
    }
  }
  SegmentLimits r{feed, kNone, kNone};
  for (const auto& p : d) {
    for (std::size_t i = 0; i < N; ++i) {
      r.speed =
          std::min({r.speed, limits.speed[i] / p[0][i], std::sqrt(kAcross * limits.acceleration[i] / p[1][i]),
                    std::cbrt(kCurveJerk * limits.jerk[i] / p[2][i])});
    }
  }
  const double c = r.speed;
  for (const auto& p : d) {
    for (std::size_t i = 0; i < N; ++i) {
      r.acceleration = std::min({r.acceleration, (limits.acceleration[i] - p[1][i] * c * c) / p[0][i],
                                 kMixedJerk * limits.jerk[i] / (3.0 * p[1][i] * c)});
    }
  }
  for (const auto& p : d) {
    for (std::size_t i = 0; i < N; ++i) {
      const double left = limits.jerk[i] - p[2][i] * c * c * c - 3.0 * p[1][i] * c * r.acceleration;
      r.jerk = std::min(r.jerk, left / p[0][i]);
    }
  }
  return r;
}

template <std::size_t N>
std::shared_ptr<const Part<N>> plan_part(const Vec<double, 3>& start, const std::vector<PartMove>& moves,
                                         const PartLimits<N>& limits) {
  auto part = std::make_shared<Part<N>>();
  std::vector<Leg<N>> legs;
  Vec<double, 3> here = start;
  for (const PartMove& m : moves) {
    Leg<N> leg;
    leg.segment = m.arc ? arc<N>(here, m) : line<N>(here, m.to);
    leg.end = m;
    here = m.to;
    if (leg.segment.length > kNoWay) {
      legs.push_back(std::move(leg));
    } else if (!legs.empty() && m.junction == Junction::kStop) {
      // A move without travel acts at the end of the last one.
      legs.back().end.junction = Junction::kStop;
      legs.back().end.dwell += m.dwell;
    }
  }
  if (legs.empty()) return nullptr;
  for (std::size_t i = 0; i + 1 < legs.size(); ++i) {
    const double off = join<N>(legs[i], legs[i + 1]);
    part->summary.deviation = std::max(part->summary.deviation, off);
    part->summary.corners += legs[i].cut_end > 0.0 ? 1 : 0;
    part->summary.stops += legs[i].stops ? 1 : 0;
  }
  legs.back().stops = true;
  part->summary.moves = legs.size();
  for (const Leg<N>& leg : legs) {
    const bool slower = limits_on<N>(leg.segment, leg.end.feed, limits).speed < leg.end.feed * (1.0 - 1e-9);
    if (slower && std::isfinite(leg.end.feed)) ++part->summary.limited;
  }

  Assembly<N> assembly(*part, limits);
  for (std::size_t i = 0; i < legs.size(); ++i) {
    const Leg<N>& leg = legs[i];
    const double end = leg.segment.length - leg.cut_end;
    if (end - leg.cut_begin > 1e-12) assembly.add(trimmed(leg.segment, leg.cut_begin, end), leg.end.feed);
    if (leg.cut_end > 0.0) assembly.add(leg.corner, std::min(leg.end.feed, legs[i + 1].end.feed));
    if (leg.stops) assembly.stop(leg.end.dwell);
  }
  assembly.finish();
  return part;
}

template <std::size_t N>
std::shared_ptr<const Part<N>> plan_smooth(std::vector<path::Segment<N>> segments, double feed,
                                           const PartLimits<N>& limits) {
  if (segments.empty()) return nullptr;
  auto part = std::make_shared<Part<N>>();
  part->summary.moves = segments.size();
  constexpr bool kStepwise = true;
  Assembly<N> assembly(*part, limits, kStepwise);
  bool after_cusp = false;
  for (Segment<N>& s : segments) {
    s.extent = s.distance(s.length);
    bool slower = false;
    for (const TamePiece<N>& piece : tame_pieces(s)) {
      if (piece.cusp) assembly.stop(0.0);
      if (piece.segment.extent > 0.0) {
        slower = slower || limits_on<N>(piece.segment, feed, limits).speed < feed * (1.0 - 1e-9);
        assembly.add(piece.segment, feed);
      }
      if (piece.cusp) assembly.stop(0.0);
      part->summary.stops += piece.cusp && !after_cusp ? 1 : 0;
      after_cusp = piece.cusp;
    }
    if (slower) ++part->summary.limited;
  }
  if (part->segments.empty()) return nullptr;
  assembly.stop(0.0);
  assembly.finish();
  return part;
}

#define STRIBECK_INSTANTIATE(N)                                                                             \
  template class PartMotion<N>;                                                                             \
  template SegmentLimits limits_on<N>(const path::Segment<N>&, double, const PartLimits<N>&);               \
  template std::shared_ptr<const Part<N>> plan_part<N>(const Vec<double, 3>&, const std::vector<PartMove>&, \
                                                       const PartLimits<N>&);                               \
  template std::shared_ptr<const Part<N>> plan_smooth<N>(std::vector<path::Segment<N>>, double,             \
                                                         const PartLimits<N>&);
STRIBECK_INSTANTIATE(2)
STRIBECK_INSTANTIATE(3)
#undef STRIBECK_INSTANTIATE

}  // namespace stribeck::sim
