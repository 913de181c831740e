#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/circle/causes_parts.hpp>
#include <stribeck/ident/stats/uncertainty.hpp>

namespace stribeck::ident::circle {
namespace {

constexpr double kLeastEffect = 50e-9;
constexpr double kLeastShare = 0.01;  // of the largest effect
constexpr double kLeastOfSpike =
    0.05;  // of a spike: what a cyclic error beside it must have, as friction leaves ripples of some percent
constexpr double kBeyond = 1.5;  // half widths of the 95 % interval: three standard deviations

struct Fitted {
  std::vector<Offset> offsets;  ///< of each log, taken off its rows
  CauseRows rows;
  Design design;
  CauseFit fit;
};

/// Radial error of one cause over the circle, both directions, at the fastest feed.
struct Effect {
  double span = 0.0;
  double most = 0.0;  ///< largest size
};

Effect effect_of(const Fitted& f, const CauseColumns& cause) {
  double low = HUGE_VAL;
  double high = -HUGE_VAL;
  for (const double direction : {1.0, -1.0}) {
    if (direction < 0.0 && !f.rows.both_directions) continue;
    for (int degree = 0; degree < 360; ++degree) {
      CauseRow at;
      at.angle = (degree + 0.5) * kPi / 180.0;
      at.direction = f.rows.both_directions ? direction : f.rows.rows.front().direction;
      at.feed = f.rows.fastest;
      at.log = cause.log;
      const Eigen::VectorXd v = column_values(f.rows, f.design.columns, at);
      const double e =
          v.segment(cause.first, cause.count).dot(f.fit.coefficients.segment(cause.first, cause.count));
      low = std::min(low, e);
      high = std::max(high, e);
    }
  }
  return {high - low, std::max(std::abs(low), std::abs(high))};
}

double amplitude_width(const stats::Uncertainty& u, const CauseFit& fit, const CauseColumns& c) {
  Eigen::VectorXd g = Eigen::VectorXd::Zero(fit.coefficients.size());
  const double a = fit.coefficients(c.first);
  const double b = fit.coefficients(c.first + 1);
  const double amplitude = std::hypot(a, b);
  g(c.first) = amplitude > 0.0 ? a / amplitude : 1.0;
  g(c.first + 1) = amplitude > 0.0 ? b / amplitude : 0.0;
  return u.half_width(g);
}

double width_of_second(const stats::Uncertainty& u, const CauseFit& fit, const CauseColumns& c) {
  Eigen::VectorXd g = Eigen::VectorXd::Zero(fit.coefficients.size());
  g(c.first + 1) = 1.0;
  return u.half_width(g);
}

/// An offset or a drift of the centre, as a distance and its parts.
void tell_set_up(const Fitted& f, const stats::Uncertainty& u, const CauseColumns& c, Cause& out) {
  const bool drift = c.kind == CauseKind::kDrift;
  const Offset off = drift ? Offset{} : f.offsets[static_cast<std::size_t>(c.log)];
  const double x = off.x + f.fit.coefficients(c.first), y = off.y + f.fit.coefficients(c.first + 1);
  out.size = std::hypot(x, y);
  out.half_width = std::max(out.half_width, width_of_second(u, f.fit, c));
  out.effect = (drift ? 1.0 : 2.0) * out.size;
  out.figures.push_back({f.rows.axes[0], x * 1e6, std::nan(""), "um"});
  out.figures.push_back({f.rows.axes[1], y * 1e6, std::nan(""), "um"});
}

/// Size, interval and the numbers that the trade knows the cause by.
Cause cause_of(const Fitted& f, const stats::Uncertainty& u, const CauseColumns& c) {
  Cause out;
  out.kind = c.kind;
  out.axis = c.axis;
  const double first = f.fit.coefficients(c.first);
  const double second = c.count > 1 ? f.fit.coefficients(c.first + 1) : 0.0;
  Eigen::VectorXd g = Eigen::VectorXd::Zero(f.fit.coefficients.size());
  g(c.first) = 1.0;
  out.size = first;
  out.half_width = u.half_width(g);
  const Effect effect = effect_of(f, c);
  out.effect = effect.span;
  const double radius = f.rows.radius;
  const AxisNames& axes = f.rows.axes;
  const auto figure = [&](std::string name, double value, double half_width, std::string unit) {
    out.figures.push_back({std::move(name), value, half_width, std::move(unit)});
  };
  switch (c.kind) {
    case CauseKind::kBacklash: {
      if (c.count < 2) break;  // one end alone
      for (const double end : {1.0, -1.0}) {
        g(c.first + 1) = end;
        figure(end > 0.0 ? "at the positive end" : "at the negative end", (first + end * second) * 1e6,
               u.half_width(g) * 1e6, "um");
      }
      break;
    }
    case CauseKind::kCyclic:
      out.size = std::hypot(first, second);
      out.half_width = amplitude_width(u, f.fit, c);
      figure("pitch", c.pitch * 1e3, std::nan(""), "mm");
      // A·cos(2π·x/p − phase), x from the centre.
      figure("phase", std::atan2(second, first) * 180.0 / kPi, std::nan(""), "deg");
      break;
    case CauseKind::kServoMismatch:
      // d·V·(τx − τy)/2·sin 2θ
      if (f.rows.feeds_known)
        figure(fmt::format("{} later than {}", axes[0], axes[1]), 2e3 * first / f.rows.fastest,
               2e3 * out.half_width / f.rows.fastest, "ms");
      break;
    case CauseKind::kScaleMismatch:
      figure(fmt::format("{} longer than {}", axes[0], axes[1]), 2e6 * first / radius,
             2e6 * out.half_width / radius, "um/m");
      // The circle is as large in x as radius and mismatch together say, in y as their difference.
      for (const int axis : {0, 1}) {
        const int common = f.design.columns.causes.front().first;
        g(common) = axis == 0 ? 1.0 : -1.0;
        figure("scale error of " + axes[static_cast<std::size_t>(axis)],
               1e6 * (f.fit.coefficients(common) + (axis == 0 ? first : -first)) / radius,
               1e6 * u.half_width(g) / radius, "um/m");
      }
      break;
    case CauseKind::kSquareness:
      figure("angle short of 90 deg", 2e6 * first / radius, 2e6 * out.half_width / radius, "um/m");
      break;
    case CauseKind::kRadius:
      out.effect = std::abs(first);
      figure("both axes longer", 1e6 * first / radius, 1e6 * out.half_width / radius, "um/m");
      break;
    case CauseKind::kLag:
      out.effect = effect.most;
      // V²·T²/(2R) of two axes that follow with the lag T.
      figure("lag, if of second order", 1e3 * std::sqrt(std::max(0.0, 2.0 * first * radius)) / f.rows.fastest,
             std::nan(""), "ms");
      break;
    case CauseKind::kCentre:
    case CauseKind::kDrift:
      tell_set_up(f, u, c, out);
      break;
    default:
      break;
  }
  return out;
}

constexpr double kAlone = 5.0;     // half widths by which the peaks of one end stand out alone
constexpr double kBoth = 3.0;      // half widths beyond which both ends stand out
constexpr double kOtherEnd = 0.3;  // share of them that the other end has at most

/// The peaks of one end of an axis.
struct PeaksAtEnd {
  double sum = 0.0, noise = 0.0, width = 0.0, count = 0.0, angle = 0.0;
  double lowest = HUGE_VAL, highest = -HUGE_VAL;
  [[nodiscard]] double height() const { return count > 0.0 ? sum / count : 0.0; }
  /// Whether every peak stands out, and none is less than half of the mean.
  [[nodiscard]] bool alike() const {
    const double mean = height();
    const double least = mean > 0.0 ? lowest : -highest;
    return count > 0.0 && least > std::max(kBoth * noise, 0.5 * std::abs(mean));
  }
};

/// The positive end, then the negative one.
std::array<PeaksAtEnd, 2> peaks_at_ends(const std::vector<QuadrantPeak>& peaks, int axis) {
  std::array<PeaksAtEnd, 2> ends{};
  for (const QuadrantPeak& p : peaks) {
    if (p.axis != axis) continue;
    const double side = axis == 0 ? std::cos(p.angle) : std::sin(p.angle);
    PeaksAtEnd& end = ends[side > 0.0 ? 0 : 1];
    end.sum += p.height, end.width += p.width, end.count += 1.0;
    end.lowest = std::min(end.lowest, p.height), end.highest = std::max(end.highest, p.height);
    end.noise = std::max(end.noise, p.half_width_95);
    end.angle = p.angle;
  }
  return ends;
}

/// The peaks of one end of an axis, where the other end has none; not found: both have, or neither.
Cause spike_at_one_end(const std::array<PeaksAtEnd, 2>& ends, int axis) {
  const std::size_t larger = std::abs(ends[0].height()) >= std::abs(ends[1].height()) ? 0 : 1;
  const PeaksAtEnd &one = ends[larger], &other = ends[1 - larger];
  Cause out;
  if (other.count == 0.0 || !(std::abs(one.height()) > kAlone * one.noise) ||
      !(std::abs(other.height()) < kOtherEnd * std::abs(one.height())))
    return out;
  out.kind = CauseKind::kReversalSpike;
  out.axis = axis;
  out.found = true;
  out.size = one.height();
  out.half_width = one.noise / std::sqrt(one.count);
  out.effect = std::abs(out.size);
  out.figures.push_back({"width", one.width / one.count * 180.0 / kPi, std::nan(""), "deg"});
  out.figures.push_back({"only at", std::round(one.angle * 180.0 / kPi), std::nan(""), "deg"});
  return out;
}

/// Heights of the two ends of an axis where one bulges out and the other in. Their mean describes neither, so both are kept.
void tell_opposite_ends(const std::array<PeaksAtEnd, 2>& ends, Cause& out) {
  const PeaksAtEnd &a = ends[0], &b = ends[1];
  if (!a.alike() || !b.alike() || !(a.height() * b.height() < 0.0)) return;
  const PeaksAtEnd& larger = std::abs(a.height()) >= std::abs(b.height()) ? a : b;
  out.size = larger.height();
  out.half_width = larger.noise / std::sqrt(larger.count);
  out.effect = std::abs(a.height() - b.height());
  out.found = true;
  for (const PeaksAtEnd& end : ends)
    out.figures.push_back({fmt::format("at {:.0f} deg", std::round(end.angle * 180.0 / kPi)),
                           1e6 * end.height(), 1e6 * end.noise / std::sqrt(end.count), "um"});
}

/// What comes first at most of the reversals.
void tell_top_before(const std::vector<QuadrantPeak>& peaks, int axis, Cause& out) {
  double sum = 0.0;
  int all = 0, with = 0;
  for (const QuadrantPeak& p : peaks) {
    if (p.axis != axis) continue;
    ++all;
    if (p.before * out.size < 0.0) sum += p.before, ++with;
  }
  if (2 * with <= all) return;
  out.before = sum / with;
  out.figures.push_back({"before it", 1e6 * out.before, std::nan(""), "um"});
}

/// Mean height of an axis' peaks; found where the mean, or half of the peaks alone, stand out of the rest.
Cause spike_of(const std::vector<QuadrantPeak>& peaks, int axis) {
  Cause out;
  out.kind = CauseKind::kReversalSpike;
  out.axis = axis;
  double sum = 0.0;
  double squares = 0.0;
  double noise = 0.0;
  double width = 0.0;
  int count = 0;
  int clear = 0;
  const bool any_seen = std::any_of(peaks.begin(), peaks.end(), [&](const QuadrantPeak& p) {
    return p.axis == axis && !p.in_play && std::abs(p.height) > 2.0 * p.half_width_95;
  });
  for (const QuadrantPeak& p : peaks) {
    // A top that the play hides says less than one that is seen.
    if (p.axis != axis || (p.in_play && any_seen)) continue;
    sum += p.height;
    squares += p.height * p.height;
    noise = std::max(noise, p.half_width_95);
    width += p.width;
    ++count;
    // The largest of some ten independent steps of noise is beyond one half width: two are no chance.
    if (std::abs(p.height) > 2.0 * p.half_width_95) ++clear;
  }
  if (count == 0) return out;
  out.size = sum / count;
  const double spread = count > 1 ? std::max(0.0, squares - sum * sum / count) / (count - 1) : 0.0;
  const bool in_play = !any_seen && std::any_of(peaks.begin(), peaks.end(), [&](const QuadrantPeak& p) {
    return p.axis == axis && p.in_play;
  });
  // Tops that lie in the play, and what a top has between rows, are not chance: more reversals do not make them smaller.
  constexpr double kBetweenRows = 0.03;
  const double of_one = std::hypot(noise, 1.96 * std::sqrt(spread));
  const double of_mean = of_one / std::sqrt(static_cast<double>(count));
  out.half_width = std::hypot(in_play ? of_one : of_mean, kBetweenRows * out.size);
  out.effect = std::abs(out.size);
  out.found = 2 * clear > count && std::abs(out.size) > of_mean;
  // A spike that is there may be higher than the play shows, but is not none.
  constexpr double kThere = 0.9;
  if (in_play && out.found) out.half_width = std::min(out.half_width, kThere * std::abs(out.size));
  const std::array<PeaksAtEnd, 2> ends = peaks_at_ends(peaks, axis);
  if (const Cause alone = spike_at_one_end(ends, axis); alone.found) return alone;
  tell_opposite_ends(ends, out);
  tell_top_before(peaks, axis, out);
  out.figures.push_back({"width", width / count * 180.0 / kPi, std::nan(""), "deg"});
  return out;
}

/// Where the axes cross their play after a reversal, and stand still. A play that is compensated too much has another end: the
/// compensation moves the axis for a time that is not known, at most until the fit begins.
std::array<Crossing, 2> crossing_of_play(const std::vector<Cause>& causes, double radius,
                                         const Windows& windows) {
  std::array<Crossing, 2> out{};
  for (const Cause& c : causes) {
    if (c.kind != CauseKind::kBacklash || !(std::abs(c.size) > kBeyond * c.half_width) ||
        std::abs(c.size) < kLeastEffect)
      continue;
    const auto axis = static_cast<std::size_t>(*c.axis);
    double most = std::abs(c.size);
    for (const Cause::Figure& end : c.figures) most = std::max(most, 1e-6 * std::abs(end.value));
    const bool stands = c.size > 0.0;
    out[axis] = {stands ? std::acos(std::max(0.0, 1.0 - 1.2 * most / radius)) : windows[axis], most, stands};
    for (std::size_t end = 0; end < 2; ++end)
      out[axis].at_ends[end] = end < c.figures.size() ? 1e-6 * c.figures[end].value : c.size;
  }
  return out;
}

/// A peak is measured from the fit, which has its own interval where the peak is.
void add_width_of_fit(const Fitted& f, const stats::Uncertainty& u, QuadrantPeak& peak) {
  CauseRow at;
  at.direction = peak.counter_clockwise ? 1.0 : -1.0;
  at.angle = peak.angle + at.direction * peak.delay;
  at.feed = peak.feed;
  peak.half_width_95 =
      std::hypot(peak.half_width_95, u.half_width(column_values(f.rows, f.design.columns, at)));
}

/// The uncertainty of a fit of rows.
stats::Uncertainty uncertainty_of(const CauseRows& rows, const CauseFit& fit) {
  std::vector<int> record;
  std::vector<std::size_t> at;
  for (const std::size_t i : fit.used) {
    record.push_back(rows.rows[i].run);
    at.push_back(rows.rows[i].at);
  }
  return {fit.X, fit.rest, fit.inverse, record, at};
}

/// What friction leaves outside of the window has the form of other causes, small beside the spike and large beside noise: the tail of a
/// spike, and the error before a reversal, where friction rises as the axis slows down. Where more is left out, it is gone, and a cause of
/// its own stays: how far each size moves beyond its interval there, in the order of the columns.
std::vector<double> moved_by_window(const Fitted& f, const std::vector<Cause>& sizes) {
  constexpr double kDegree = kPi / 180.0;
  constexpr double kLongest = 45.0 * kDegree;
  struct Longer {
    double times, more, before;  // of the window, and before a reversal [rad]
  };
  constexpr std::array<Longer, 4> kLonger{{{1.6, 3.0 * kDegree, kDegree},
                                           {2.5, 6.0 * kDegree, kDegree},
                                           {1.0, 0.0, 12.0 * kDegree},
                                           {1.0, 0.0, 22.0 * kDegree}}};
  std::vector<double> moved(sizes.size(), 0.0);
  for (const auto& [times, more, before] : kLonger) {
    Windows windows = f.fit.windows;
    for (double& w : windows) w = std::max(w, std::min(times * w + more, kLongest));
    Fitted other = f;
    other.fit = fit_causes(f.rows, f.design, windows, before);
    if (other.fit.rest.size() == 0 || !other.fit.coefficients.allFinite()) continue;
    const stats::Uncertainty u = uncertainty_of(other.rows, other.fit);
    for (std::size_t k = 0; k < sizes.size(); ++k) {
      const Cause now = cause_of(other, u, f.design.columns.causes[k]);
      const double beyond = std::abs(now.size - sizes[k].size) - now.half_width;
      if (beyond > moved[k]) moved[k] = beyond;
    }
  }
  return moved;
}

/// The few fits show a part of how far a size may move: it counts twice.
void widen(Cause& cause, double moved) {
  if (!(moved > 0.0) || !(cause.half_width > 0.0)) return;
  const double ratio = 1.0 + 2.0 * moved / cause.half_width;
  cause.half_width *= ratio;
  for (Cause::Figure& f : cause.figures) f.half_width *= ratio;
}

void rank(std::vector<Cause>& causes) {
  double most = 0.0, spike = 0.0;
  for (const Cause& c : causes) {
    most = std::max(most, is_set_up(c.kind) ? 0.0 : c.effect);
    if (c.kind == CauseKind::kReversalSpike && c.found) spike = std::max(spike, c.effect);
  }
  double all = 0.0;
  for (Cause& c : causes) {
    const bool clear =
        c.kind == CauseKind::kReversalSpike ? c.found : std::abs(c.size) > kBeyond * c.half_width;
    const double least =
        std::max(kLeastShare * most, c.kind == CauseKind::kCyclic ? kLeastOfSpike * spike : 0.0);
    c.found = clear && c.effect > kLeastEffect && c.effect > least;
    if (c.found && !is_set_up(c.kind)) all += c.effect;
  }
  for (Cause& c : causes) c.share = c.found && !is_set_up(c.kind) ? c.effect / all : 0.0;
  std::stable_sort(causes.begin(), causes.end(), [](const Cause& a, const Cause& b) {
    if (a.found != b.found) return a.found;
    if (is_set_up(a.kind) != is_set_up(b.kind)) return is_set_up(b.kind);
    return a.effect > b.effect;
  });
}

}  // namespace

std::optional<Diagnosis> diagnose(const std::vector<CircleMotion>& given) {
  Fitted f;
  std::vector<CircleMotion> motions = given;
  for (CircleMotion& m : motions) f.offsets.push_back(m.commanded ? take_off_centre(m) : Offset{});
  f.rows = cause_rows(motions);
  if (f.rows.rows.size() < 144) return std::nullopt;  // a row for each 2.5 degrees
  f.rows.drifts = centre_drifts(f.rows);
  const std::vector<Pitch> pitches = find_pitches(f.rows);
  f.design = design_of(f.rows, pitches);
  f.fit = fit_with_window(f.rows, f.design);
  if (f.fit.rest.size() == 0 || !f.fit.coefficients.allFinite()) return std::nullopt;
  const stats::Uncertainty u = uncertainty_of(f.rows, f.fit);
  Diagnosis out;
  out.axes = f.rows.axes;
  const bool commanded =
      std::all_of(motions.begin(), motions.end(), [](const CircleMotion& m) { return m.commanded; });
  std::vector<Cause> sizes;
  for (const CauseColumns& c : f.design.columns.causes) sizes.push_back(cause_of(f, u, c));
  const std::vector<double> moved = moved_by_window(f, sizes);
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    const CauseColumns& c = f.design.columns.causes[k];
    if (c.kind == CauseKind::kCentre && !commanded) continue;
    Cause cause = std::move(sizes[k]);
    widen(cause, moved[k]);
    // Each log has its own set-up; the largest offset, and the largest drift, stand for all.
    if (is_set_up(c.kind) && c.log > 0) {
      if (cause.size > out.causes.back().size) out.causes.back() = std::move(cause);
      continue;
    }
    out.causes.push_back(std::move(cause));
  }
  const std::vector<double> rest = rest_of_rows(f.rows, f.design, f.fit);
  const Explained explained(f.rows, f.design, f.fit);
  out.peaks = quadrant_peaks(f.rows, rest, PassingSamples(motions, f.rows, explained), f.fit.windows,
                             crossing_of_play(out.causes, f.rows.radius, f.fit.windows));
  for (QuadrantPeak& p : out.peaks) add_width_of_fit(f, u, p);
  for (const int axis : {0, 1}) out.causes.push_back(spike_of(out.peaks, axis));
  const std::vector<Vibration> vibrations = find_vibrations(motions, f.rows, f.design, f.fit);
  for (const Vibration& vibration : vibrations) {
    // Where the axis reverses, a vibration stands at any of its phases.
    for (Cause& spike : out.causes)
      spike.found = spike.found &&
                    (spike.kind != CauseKind::kReversalSpike || std::abs(spike.size) > vibration.in_radius);
    Cause c;
    c.kind = CauseKind::kVibration;
    c.axis = vibration.axis;
    c.size = vibration.amplitude;
    c.half_width = vibration.half_width;
    c.effect = 2.0 * vibration.amplitude;
    c.figures.push_back({"frequency", vibration.frequency, vibration.frequency_half_width, "Hz"});
    out.causes.push_back(std::move(c));
  }
  rank(out.causes);
  for (Cause& c : out.causes) c.broad = c.kind == CauseKind::kReversalSpike && f.fit.window() > kBroad;
  out.remarks = remarks_on(f.rows, f.fit, out.causes, out.peaks, motions, commanded);
  out.rest_rms = std::sqrt(f.fit.rest.squaredNorm() / static_cast<double>(f.fit.rest.size()));
  out.window = f.fit.window();
  out.both_directions = f.rows.both_directions;
  out.own_encoder = f.rows.own_encoder;
  const auto [low, high] =
      std::minmax_element(f.rows.rows.begin(), f.rows.rows.end(),
                          [](const CauseRow& a, const CauseRow& b) { return a.error < b.error; });
  out.span = high->error - low->error;
  return out;
}

}  // namespace stribeck::ident::circle
