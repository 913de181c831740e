#include <algorithm>
#include <cmath>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/circle/causes_parts.hpp>

namespace stribeck::ident::circle {
namespace {

constexpr double kRightAngle = 0.5 * kPi;

/// A quarter of a degree, on large circles half a millimetre, so that the pitch of a screw has ten steps; more where the samples are
/// farther apart or the rows would be too many for the fit.
double step_of(const std::vector<CircleMotion>& motions) {
  constexpr double kMostRows = 40000.0;
  constexpr double kLongest = 0.5e-3;  // [m]
  double step = std::min(0.25 * kPi / 180.0, kLongest / motions.front().radius);
  double turned = 0.0;
  for (const CircleMotion& m : motions) {
    for (const CircleRun& run : m.runs) {
      const double angle = run.revolutions * 2.0 * kPi;
      turned += angle;
      step = std::max(step, 1.001 * angle / static_cast<double>(run.angle.size() - 1));
    }
  }
  return std::max(step, turned / kMostRows);
}

void add_run(CauseRows& out, const CircleRun& run, int log, int number) {
  const double direction = run.counter_clockwise ? 1.0 : -1.0;
  CauseRow row;
  double angle = 0.0;
  double error = 0.0;
  double time = 0.0;
  const auto close = [&] {
    if (row.samples == 0) return;
    row.angle = angle / row.samples;
    row.error = error / row.samples;
    row.progress = time / row.samples;
    out.rows.push_back(row);
  };
  for (std::size_t i = 0; i < run.angle.size(); ++i) {
    const double turned = std::max(0.0, direction * (run.angle[i] - run.angle.front()));
    const auto at = static_cast<std::size_t>(turned / out.step);
    if (row.samples > 0 && at > row.at) {
      close();
      row.samples = 0;
    }
    if (row.samples == 0) {
      row = {number, log, static_cast<int>(turned / (2.0 * kPi)), at, 0.0, 0.0, direction, run.feed, 0, 0.0};
      angle = error = time = 0.0;
    }
    angle += run.angle[i];
    error += run.error[i];
    time += run.time.empty() ? static_cast<double>(run.first + i) : run.time[i];
    ++row.samples;
  }
  close();
}

/// Times, or numbers of rows, of each log become −½ to ½.
void make_progress(std::vector<CauseRow>& rows) {
  for (auto first = rows.begin(); first != rows.end();) {
    const auto last = std::find_if(first, rows.end(), [&](const CauseRow& r) { return r.log != first->log; });
    const auto [low, high] = std::minmax_element(
        first, last, [](const CauseRow& a, const CauseRow& b) { return a.progress < b.progress; });
    const double begin = low->progress, length = high->progress - begin;
    for (auto r = first; r != last; ++r)
      r->progress = length > 0.0 ? (r->progress - begin) / length - 0.5 : 0.0;
    first = last;
  }
}

}  // namespace

CauseRows cause_rows(const std::vector<CircleMotion>& motions) {
  CauseRows out;
  if (motions.empty()) return out;
  out.axes = motions.front().axes;
  out.radius = motions.front().radius;
  out.step = step_of(motions);
  out.feeds_known = true;
  bool forward = false;
  bool back = false;
  double slowest = HUGE_VAL;
  int number = 0;
  for (const CircleMotion& m : motions) {
    out.arcs = out.arcs || m.arcs;
    for (const CircleRun& run : m.runs) {
      add_run(out, run, out.logs, number++);
      (run.counter_clockwise ? forward : back) = true;
      out.feeds_known = out.feeds_known && std::isfinite(run.feed);
      out.fastest = std::max(out.fastest, std::isfinite(run.feed) ? run.feed : 0.0);
      slowest = std::min(slowest, std::isfinite(run.feed) ? run.feed : HUGE_VAL);
    }
    ++out.logs;
  }
  make_progress(out.rows);
  out.both_directions = forward && back;
  out.own_encoder = std::all_of(motions.begin(), motions.end(),
                                [](const CircleMotion& m) { return m.commanded && !m.ball_bar && !m.scale; });
  out.feeds_known = out.feeds_known && !out.rows.empty();
  out.feeds_differ = out.feeds_known && out.fastest > 1.2 * slowest;
  return out;
}

double after_reversal(const CauseRow& row) {
  const double turned = row.direction * row.angle;
  return turned - kRightAngle * std::floor(turned / kRightAngle);
}

int last_border(const CauseRow& row) {
  const double quarters = std::floor(row.direction * row.angle / kRightAngle);
  const int passed = static_cast<int>(quarters - 4.0 * std::floor(quarters / 4.0));
  return row.direction > 0.0 ? passed : (4 - passed) % 4;
}

}  // namespace stribeck::ident::circle
