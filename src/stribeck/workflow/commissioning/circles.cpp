#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <vector>

#include <stribeck/core/scalar.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/workflow/commissioning/circles.hpp>

namespace stribeck::workflow::commissioning {
namespace {

constexpr int kLaps = 3;
constexpr double kMostRadius = 10e-3;  // [m]
constexpr double kMostSpeed = 10e-3;   // [m/s]
constexpr double kRoomShare = 0.3;

/// Down to tenths of a millimetre.
double tenths(double metres) { return std::floor(1e4 * metres + 1e-9) * 1e-4; }

/// The middle of the circle: zero where the travel has room on both sides of it.
double middle_of_travel(const sim::AxisLimits& l) {
  const double travel = l.travel_max - l.travel_min;
  if (l.travel_min < 0.0 && l.travel_max > 0.0 && std::min(-l.travel_min, l.travel_max) > 0.2 * travel)
    return 0.0;
  return tenths(0.5 * (l.travel_min + l.travel_max));
}

double room_about(const sim::AxisLimits& l, double middle) {
  return std::min(middle - l.travel_min, l.travel_max - middle);
}

const RunningAxis* axis_with(const RunningAxes& all, char letter) {
  for (const RunningAxis& a : all.axes) {
    if (a.letter == letter) return &a;
  }
  return nullptr;
}

std::string mm(double metres) { return fmt::format("{:.4f}", 1e3 * metres + 0.0); }

}  // namespace

CirclePlan plan_circle(const RunningAxes& all) {
  struct Plane {
    char u, v;
    const char* code;
    char i, j;
  };
  CirclePlan p;
  for (const Plane& plane : {Plane{'X', 'Y', "G17", 'I', 'J'}, Plane{'X', 'Z', "G18", 'I', 'K'},
                             Plane{'Y', 'Z', "G19", 'J', 'K'}}) {
    const RunningAxis* u = axis_with(all, plane.u);
    const RunningAxis* v = axis_with(all, plane.v);
    if (u == nullptr || v == nullptr) continue;
    p.u = u;
    p.v = v;
    p.plane = plane.code;
    p.i = plane.i;
    p.j = plane.j;
    break;
  }
  if (p.u == nullptr) return p;
  p.middle_u = middle_of_travel(p.u->limits);
  p.middle_v = middle_of_travel(p.v->limits);
  const double room = std::min(room_about(p.u->limits, p.middle_u), room_about(p.v->limits, p.middle_v));
  p.radius = tenths(std::min(kMostRadius, kRoomShare * room));
  if (!(p.radius > 0.0)) throw Stopped("the travel has no room for a circle");
  const double acceleration = std::min(p.u->limits.acceleration, p.v->limits.acceleration);
  p.speed = std::min({kMostSpeed, 0.8 * std::min(p.u->limits.speed, p.v->limits.speed),
                      std::sqrt(0.5 * acceleration * p.radius)});
  return p;
}

std::string CirclePlan::approach() const {
  return fmt::format(
      "(to the start of the circle)\nG21 {} G90 G91.1 G94 G40 G64 P0.001\nG1 {}{} {}{} F{:.3f}\nG4 P0.5\nM2\n",
      plane, u->letter, mm(middle_u + radius), v->letter, mm(middle_v), 60e3 * speed);
}

std::string CirclePlan::laps(bool counter_clockwise) const {
  std::string out = fmt::format("(circle of {} mm)\nG21 {} G90 G91.1 G94 G40 G64 P0.001\nF{:.3f}\n",
                                mm(radius), plane, 60e3 * speed);
  // In G18 the first axis of the circle is Z, so that its directions are the other way round.
  const bool g3 = counter_clockwise != (plane == "G18");
  for (int k = 0; k < kLaps; ++k)
    out += fmt::format("G{} {}{} {}{} {}{} {}0\n", g3 ? 3 : 2, u->letter, mm(middle_u + radius), v->letter,
                       mm(middle_v), i, mm(-radius), j);
  return out + "G4 P0.3\nM2\n";
}

double CirclePlan::lap_time() const { return 2.0 * kPi * radius / speed; }

std::string CirclePlan::words() const {
  return fmt::format("{}{} on a circle of {} mm about {}{} {}{} at {} mm/min, {} laps in each direction",
                     u->letter, v->letter, report::significant(1e3 * radius, 4), u->letter,
                     report::significant(1e3 * middle_u, 6), v->letter,
                     report::significant(1e3 * middle_v, 6), report::significant(60e3 * speed, 4), kLaps);
}

std::pair<AxisRows, AxisRows> counted_laps(const CirclePlan& plan, const AxisRows& u, const AxisRows& v) {
  std::pair<AxisRows, AxisRows> out;
  double turned = 0.0;
  double angle = 0.0;
  // The end of the last lap is left out, where the program brakes (0.2 rad).
  const double first = 2.0 * kPi;
  const double last = 2.0 * kPi * kLaps - 0.2;
  for (std::size_t k = 0; k < u.r.size(); ++k) {
    const double now = std::atan2(v.r[k] - plan.middle_v, u.r[k] - plan.middle_u);
    if (k > 0) turned += std::remainder(now - angle, 2.0 * kPi);
    angle = now;
    if (std::abs(turned) < first || std::abs(turned) > last) continue;
    const auto take = [k](AxisRows& to, const AxisRows& from) {
      to.r.push_back(from.r[k]);
      to.x.push_back(from.x[k]);
      to.f.push_back(from.f[k]);
    };
    take(out.first, u);
    take(out.second, v);
  }
  return out;
}

}  // namespace stribeck::workflow::commissioning
