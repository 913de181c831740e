#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/excitation.hpp>
#include <stribeck/ident/refused.hpp>

namespace stribeck::ident {
namespace {

constexpr double kReserve = 0.95;  // of the speed limit
constexpr double kDoubt = 0.85;    // speeds are predicted with this share of the friction: the idea is rough
constexpr double kBaseScale =
    4.0;  // the scale that just moves the axis (thesis: results are taken from K_u = 4)
constexpr double kJustMoves = 1.25;  // its height over the Coulomb force
constexpr double kRest = 0.15;       // between pulses, after the axis has stopped [s]
constexpr double kStep = 1e-3;       // of the prediction [s]

template <class... T>
std::string text(const char* format, T... values) {
  char buffer[400];
  std::snprintf(buffer, sizeof buffer, format, values...);
  return buffer;
}

void check(const Limits& l, double sample_time, double start) {
  if (!(sample_time > 0.0))
    throw Refused(text("excitation: sample time is %g s, expected a positive number", sample_time));
  if (!(l.speed > 0.0) || !(l.travel_max > l.travel_min)) {
    throw Refused("excitation: limits need a positive speed and a travel whose end is above its start");
  }
  if (start < l.travel_min || start > l.travel_max) {
    throw Refused(text("excitation: start at %g mm lies outside the travel of %g to %g mm", start * 1e3,
                       l.travel_min * 1e3, l.travel_max * 1e3));
  }
}

struct Outcome {
  double top = 0.0;   // [m/s]
  double way = 0.0;   // [m]
  double stop = 0.0;  // time until the axis rests [s]
};

double trapezoid(double t, double ramp, double hold) {
  if (t < ramp) return t / ramp;
  if (t < ramp + hold) return 1.0;
  return std::max(0.0, (2.0 * ramp + hold - t) / ramp);
}

/// One pulse on the rough drive.
Outcome predict(const RoughDrive& d, double height, double ramp, double hold) {
  Outcome o;
  double v = 0.0;
  for (double t = 0.0; t < 60.0; t += kStep) {
    const double f = height * trapezoid(t, ramp, hold);
    if (v <= 0.0 && f <= d.coulomb) {
      if (t >= ramp + hold) {
        o.stop = std::max(t, 2.0 * ramp + hold);
        return o;
      }
      continue;
    }
    v = std::max(0.0, v + kStep * (f - d.coulomb - d.viscous * v) / d.mass);
    o.way += kStep * v;
    o.top = std::max(o.top, v);
  }
  o.stop = 60.0;
  return o;
}

void stamp(Excitation& e, std::size_t rows) {
  for (std::size_t k = 0; k < rows; ++k) e.t.push_back(e.sample_time * static_cast<double>(k));
}

void check_positions(const Excitation& e, const Limits& l) {
  const double T = e.sample_time;
  for (std::size_t k = 0; k < e.r.size(); ++k) {
    if (e.r[k] < l.travel_min - 1e-9 || e.r[k] > l.travel_max + 1e-9) {
      throw Refused(
          text("%s: would go to %g mm at %.3f s, travel is %g to %g mm; move the start or shorten the motion",
               e.method.c_str(), e.r[k] * 1e3, e.t[k], l.travel_min * 1e3, l.travel_max * 1e3));
    }
    if (k + 1 < e.r.size() && std::abs(e.r[k + 1] - e.r[k]) / T > l.speed * (1.0 + 1e-6)) {
      throw Refused(text("%s: needs %.4g mm/s at %.3f s, the limit of speed is %g mm/s", e.method.c_str(),
                         std::abs(e.r[k + 1] - e.r[k]) / T * 1e3, e.t[k], l.speed * 1e3));
    }
    if (k > 0 && k + 1 < e.r.size() && l.acceleration > 0.0) {
      const double a = std::abs(e.r[k + 1] - 2.0 * e.r[k] + e.r[k - 1]) / (T * T);
      // Rounding of positions shows in a second difference.
      if (a > l.acceleration * 1.001 + 1e-14 / (T * T)) {
        throw Refused(text("%s: needs %.4g mm/s2 at %.3f s, the limit of acceleration is %g mm/s2",
                           e.method.c_str(), a * 1e3, e.t[k], l.acceleration * 1e3));
      }
    }
  }
}

}  // namespace

RoughDrive rough_drive(const Result& first) {
  double n = 0, sv = 0, sf = 0, svv = 0, svf = 0;
  double side[2] = {0.0, 0.0};
  double rows[2] = {0.0, 0.0};
  for (const CurvePoint& c : first.curve) {
    const double v = std::abs(c.velocity);
    const double f = c.velocity > 0.0 ? c.friction : -c.friction;
    n += 1, sv += v, sf += f, svv += v * v, svf += v * f;
    side[c.velocity > 0.0] += f;
    rows[c.velocity > 0.0] += 1.0;
  }
  const double det = n * svv - sv * sv;
  if (!(det > 0.0) || rows[0] == 0.0 || rows[1] == 0.0)
    throw Refused("rough drive: the first result has no curve");
  RoughDrive drive;
  drive.mass = first.mass;
  drive.viscous = std::max(0.0, (n * svf - sv * sf) / det);
  const double uneven = 0.5 * std::abs(side[0] / rows[0] - side[1] / rows[1]);
  drive.coulomb = (sf - drive.viscous * sv) / n + uneven;
  return drive;
}

Excitation design_pulses(const Limits& limits, const RoughDrive& drive, double sample_time,
                         const PulseDesign& design) {
  check(limits, sample_time, design.start);
  if (!(drive.mass > 0.0) || !(drive.coulomb > 0.0) || drive.viscous < 0.0) {
    throw Refused(
        "pulses: a rough mass and Coulomb force are needed, both positive; a slow jog gives the latter");
  }
  Excitation e;
  e.method = "pulses";
  e.sample_time = sample_time;
  const RoughDrive easy{drive.mass, kDoubt * drive.coulomb, kDoubt * drive.viscous};
  const double base = kJustMoves * drive.coulomb / kBaseScale;
  const double target = kReserve * limits.speed;
  double top = 0.0;
  double longest_way = 0.0;
  int moving = 0;
  for (const double scale : design.scales) {
    const double height = base * scale;
    if (limits.force > 0.0 && height > limits.force) {
      throw Refused(
          text("pulses: scale %g needs %.4g N, the limit of force is %.4g N; leave out scales above %.3g",
               scale, height, limits.force, limits.force / base));
    }
    // The longest flat top that keeps the speed; the flanks give way when they alone are too much.
    double ramp = design.ramp;
    while (ramp > 4.0 * sample_time && predict(easy, height, ramp, 0.0).top > target) ramp *= 0.8;
    double hold = design.longest;
    if (predict(easy, height, ramp, hold).top > target) {
      double low = 0.0;
      while (hold - low > kStep) {
        const double middle = 0.5 * (low + hold);
        (predict(easy, height, ramp, middle).top > target ? hold : low) = middle;
      }
      hold = low;
    } else if (height <= drive.coulomb) {
      hold = 0.3 * design.longest;
    }
    const Outcome o = predict(easy, height, ramp, hold);  // also the longest way and the latest stop
    const double a = (height - drive.coulomb) / drive.mass;
    if (limits.acceleration > 0.0 && a > limits.acceleration) {
      throw Refused(text("pulses: scale %g accelerates with %.4g mm/s2, the limit is %g mm/s2; leave it out",
                         scale, a * 1e3, limits.acceleration * 1e3));
    }
    if (design.start + 1.2 * o.way > limits.travel_max && design.start - 1.2 * o.way < limits.travel_min) {
      throw Refused(
          text("pulses: scale %g moves %.3g mm, there is no such way from %g mm to either end of the travel",
               scale, o.way * 1e3, design.start * 1e3));
    }
    top = std::max(top, o.top);
    longest_way = std::max(longest_way, o.way);
    moving += height > drive.coulomb;
    // Towards the side with more room, then back.
    const double first = limits.travel_max - design.start >= design.start - limits.travel_min ? 1.0 : -1.0;
    // A braking axis may need longer than predicted: half as much again.
    const double pause = 1.5 * (o.stop - 2.0 * ramp - hold) + kRest;
    for (const double way : {first, -first}) {
      const auto rows = static_cast<std::size_t>(std::ceil((2.0 * ramp + hold + pause) / sample_time));
      for (std::size_t k = 0; k < rows; ++k) {
        e.force.push_back(way * height * trapezoid(sample_time * static_cast<double>(k), ramp, hold));
      }
    }
  }
  if (moving == 0) throw Refused("pulses: no scale moves the axis; add scales above 4");
  stamp(e, e.force.size());
  e.says = text(
      "pulses: %.1f s, %zu pulses, %d pairs of them strong enough to move the axis, up to about %.3g mm/s "
      "and %.3g mm from "
      "the start. Determines the mass best of all methods, and friction up to the speed reached; below about "
      "0.5 mm/s the "
      "log shows the bristle more than the steady curve.",
      e.t.back(), 2 * design.scales.size(), moving, top * 1e3, longest_way * 1e3);
  return e;
}

Excitation design_jog(const Limits& limits, double sample_time, const JogDesign& design) {
  check(limits, sample_time, design.start);
  const double a = limits.acceleration > 0.0 ? 0.5 * limits.acceleration : 10.0 * limits.speed;
  const double room =
      design.direction > 0 ? limits.travel_max - design.start : design.start - limits.travel_min;
  Excitation e;
  e.method = "jog";
  e.sample_time = sample_time;
  double r = design.start;
  e.r.push_back(r);
  for (const double v : design.speeds) {
    if (!(v > 0.0) || v > limits.speed) {
      throw Refused(text("jog: speed of %g mm/s, expected above 0 and at most the limit of %g mm/s", v * 1e3,
                         limits.speed * 1e3));
    }
    // Long enough to leave the bristle behind (some tens of micrometres) and to average noise.
    const double ramp = std::max(4.0 * sample_time, v / a);
    const double flat = std::min(std::max(2.0, 0.2e-3 / v), (0.95 * room - v * ramp) / v);
    if (flat < 0.5) {
      throw Refused(text(
          "jog: %g mm/s has only %.3g s of constant speed in the travel; start elsewhere or leave it out",
          v * 1e3, flat));
    }
    for (const double way : {design.direction, -design.direction}) {
      const auto flank = static_cast<std::size_t>(std::ceil(ramp / sample_time));
      const auto rows = static_cast<std::size_t>(std::ceil(flat / sample_time));
      // Speed in the middle of each sample: the flanks sum up exactly and the way back ends at the start.
      for (std::size_t k = 0; k < rows + 2 * flank; ++k) {
        const double up = (static_cast<double>(k) + 0.5) / static_cast<double>(flank);
        const double down = (static_cast<double>(rows + 2 * flank - k) - 0.5) / static_cast<double>(flank);
        r += way * v * std::min({1.0, up, down}) * sample_time;
        e.r.push_back(r);
      }
      for (int k = 0; k < 20; ++k) e.r.push_back(r);
    }
    r = design.start;
  }
  stamp(e, e.r.size());
  check_positions(e, limits);
  e.says = text(
      "jog: %.1f s, %zu speeds in both directions. Determines friction at these speeds, the slowest "
      "included; says nothing "
      "about the mass.",
      e.t.back(), design.speeds.size());
  return e;
}

Excitation design_sine(const Limits& limits, double sample_time, const SineDesign& design) {
  check(limits, sample_time, design.start);
  if (!(design.amplitude > 0.0) || !(design.frequency > 0.0) || design.periods < 1) {
    throw Refused("sine: amplitude, frequency and number of periods must be positive");
  }
  Excitation e;
  e.method = "sine";
  e.sample_time = sample_time;
  // φ' rises as 3s² − 2s³ over the first second and stays: position, speed and acceleration begin at rest.
  const double end = 2.0 * kPi * design.periods / design.frequency + 0.5;
  const auto rows = static_cast<std::size_t>(std::floor(end / sample_time)) + 1;
  for (std::size_t k = 0; k < rows; ++k) {
    const double t = sample_time * static_cast<double>(k);
    const double s = t < 1.0 ? t * t * t * (1.0 - 0.5 * t) : t - 0.5;
    e.r.push_back(design.start - design.amplitude + design.amplitude * std::cos(design.frequency * s));
  }
  stamp(e, rows);
  check_positions(e, limits);
  e.says = text(
      "sine: %.1f s, %d periods, up to %.3g mm/s. Determines friction at every speed up to there; the mass "
      "less well than "
      "pulses, since the acceleration is small (%.3g mm/s2).",
      e.t.back(), design.periods, design.amplitude * design.frequency * 1e3,
      design.amplitude * design.frequency * design.frequency * 1e3);
  return e;
}

}  // namespace stribeck::ident
