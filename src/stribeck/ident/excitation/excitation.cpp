#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/excitation/excitation.hpp>
#include <stribeck/ident/refused.hpp>
#include <string_view>

namespace stribeck::ident::excitation {
namespace {

constexpr double kReserve = 0.95;  // of the speed limit
constexpr double kDoubt = 0.85;    // speeds are predicted with this share of the friction: the idea is rough
constexpr double kBaseScale =
    4.0;  // the scale that just moves the axis (thesis: results are taken from K_u = 4)
constexpr double kJustMoves = 1.25;        // its height over the Coulomb force
constexpr double kFineness = 0.1;          // of the friction: what is known roughly is not known better
constexpr double kSlower = 0.8;            // speeds that are tried where the travel is short
constexpr double kSlowest = 0.02;          // of the first of them
constexpr double kRest = 0.15;             // between pulses, after the axis has stopped [s]
constexpr double kStep = 1e-3;             // of the prediction [s]
constexpr double kShortestJog = 1.0;       // of constant speed: settling is left out [s]
constexpr double kLongestJog = 60.0;       // for the sake of whole periods [s]
constexpr double kSettle = 0.5;            // left out by the identification [s]
constexpr double kBeyond = 1.3;            // peak of a ramp over the rough Coulomb force
constexpr double kBack = 0.2;              // from there to zero [s]
constexpr double kGcodeStep = 0.02;        // [s]
constexpr double kFinest = 1e-7;           // shortest move of G-code [m]
constexpr double kHardlyMoves = 1e-3;      // of the speed limit
constexpr double kHardlySlips = 10e-6;     // some bristle lengths [m]
constexpr double kFewestRampRows = 100.0;  // of a rise; a quicker one is no ramp from rest

template <class... T>
std::string text(const char* format, T... values) {
  char buffer[500];
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

/// Before anything is filled; counts as numbers, since what is asked for may not fit an integer.
void check_rows(const char* parameter, double rows, double sample_time, const std::string& what,
                const std::string& way_out) {
  if (rows <= static_cast<double>(kMostRows)) return;
  throw BadDesign(parameter, what +
                                 text(" would take %.3g s and %.4g rows, expected at most %zu rows (",
                                      rows * sample_time, rows, kMostRows) +
                                 way_out + ")");
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
  // Forces beyond what drive and acceleration may have are brought down, those just above friction least.
  const double largest = base * *std::max_element(design.scales.begin(), design.scales.end());
  double cap = limits.force > 0.0 ? limits.force : largest;
  if (limits.acceleration > 0.0) cap = std::min(cap, drive.coulomb + drive.mass * limits.acceleration);
  const double spare = (cap - drive.coulomb) / drive.coulomb;
  if (largest > cap && spare < kFineness) {
    throw Refused(
        text("pulses: between rough friction (%.4g N) and the limits of force and acceleration (%.4g N) "
             "lie only %.2g %%: too little for a force in open loop; choose sine and constant-acceleration, "
             "or give --known after them",
             drive.coulomb, cap, 100.0 * spare));
  }
  const double squeeze = largest > cap ? (cap - drive.coulomb) / (largest - drive.coulomb) : 1.0;
  bool slower = false;
  std::size_t pairs = 0;
  for (const double scale : design.scales) {
    double height = base * scale;
    if (height > drive.coulomb) height = drive.coulomb + squeeze * (height - drive.coulomb);
    // The speed gives way where the travel is too short to come to rest.
    double ramp = design.ramp;
    double hold = design.longest;
    Outcome o;  // also the longest way and the latest stop
    double goal = target;
    const auto fits = [&] {
      return design.start + 1.2 * o.way <= limits.travel_max ||
             design.start - 1.2 * o.way >= limits.travel_min;
    };
    for (;; goal *= kSlower) {
      // The longest flat top that keeps the speed; the flanks give way when they alone are too much.
      ramp = design.ramp;
      while (ramp > 4.0 * sample_time && predict(easy, height, ramp, 0.0).top > goal) ramp *= 0.8;
      hold = design.longest;
      if (predict(easy, height, ramp, hold).top > goal) {
        double low = 0.0;
        while (hold - low > kStep) {
          const double middle = 0.5 * (low + hold);
          (predict(easy, height, ramp, middle).top > goal ? hold : low) = middle;
        }
        hold = low;
      } else if (height <= drive.coulomb) {
        hold = 0.3 * design.longest;
      }
      o = predict(easy, height, ramp, hold);
      if (fits() || goal < kSlowest * target) break;
    }
    slower |= goal < target;
    if (!fits() || o.top > limits.speed) continue;
    ++pairs;
    top = std::max(top, o.top);
    longest_way = std::max(longest_way, o.way);
    moving += height > drive.coulomb;
    // Towards the side with more room, then back.
    const double first = limits.travel_max - design.start >= design.start - limits.travel_min ? 1.0 : -1.0;
    // A braking axis may need longer than predicted: half as much again.
    const double pause = 1.5 * (o.stop - 2.0 * ramp - hold) + kRest;
    for (const double way : {first, -first}) {
      const double needed = std::ceil((2.0 * ramp + hold + pause) / sample_time);
      check_rows("sample_time", static_cast<double>(e.force.size()) + needed, sample_time, "pulses",
                 "a longer sample time");
      const auto rows = static_cast<std::size_t>(needed);
      for (std::size_t k = 0; k < rows; ++k) {
        e.force.push_back(way * height * trapezoid(sample_time * static_cast<double>(k), ramp, hold));
      }
    }
  }
  if (moving == 0) {
    throw Refused(text(
        "pulses: from %g mm no pulse that moves the axis keeps to the travel of %g to %g mm and to %g mm/s",
        design.start * 1e3, limits.travel_min * 1e3, limits.travel_max * 1e3, limits.speed * 1e3));
  }
  if (!slower && top < kHardlyMoves * limits.speed) {
    throw Refused(
        text("pulses: the axis would reach only %.3g of %g mm/s; the rough mass of %g kg "
             "or the friction is wrong",
             top * 1e3, limits.speed * 1e3, drive.mass));
  }
  stamp(e, e.force.size());
  e.says = text(
      "pulses: %.1f s, %zu pulses, %d pairs of them strong enough to move the axis, up to about %.3g mm/s "
      "and %.3g mm from the start. Determines the mass best of all methods, and friction up to the speed "
      "reached; below about 0.5 mm/s the log shows pre-sliding more than the steady friction.",
      e.t.back(), 2 * pairs, moving, top * 1e3, longest_way * 1e3);
  if (squeeze < 1.0)
    e.says += text(" Forces are brought down to %.4g N, the limits of force and acceleration.", cap);
  if (slower) e.says += " Speeds are lower than the limit: the travel is short.";
  return e;
}

std::vector<double> jog_speeds(double fastest) {
  std::vector<double> speeds;
  for (const double mm : {0.01, 0.04, 0.08, 0.15, 0.2, 0.4, 0.5, 1.0, 1.5,  2.5,  3.0,  3.5,  4.0,  4.5, 5.0,
                          5.5,  6.0,  6.5,  7.0,  7.5, 8.0, 8.5, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0}) {
    if (mm * 1e-3 <= fastest * (1.0 + 1e-9)) speeds.push_back(mm * 1e-3);
  }
  // Faster axes go on in equal shares.
  constexpr double kFaster = 1.25, kClose = 1.1;
  for (double v = 15e-3 * kFaster; std::isfinite(fastest) && v * kClose < fastest; v *= kFaster)
    speeds.push_back(v);
  // A curve is worth most where it ends: the last gap would leave it open there.
  constexpr double kGap = 1.02;
  if (!speeds.empty() && fastest > kGap * speeds.back() && std::isfinite(fastest)) speeds.push_back(fastest);
  return speeds;
}

namespace {

/// Flanks of a jog and the longest time of constant speed that the room allows.
struct JogWay {
  double ramp = 0.0;
  double longest = 0.0;
};

JogWay jog_way(const Limits& limits, double sample_time, double room, double v) {
  const double a = limits.acceleration > 0.0 ? 0.5 * limits.acceleration : 10.0 * limits.speed;
  const double ramp = std::max(4.0 * sample_time, v / a);
  return {ramp, (0.95 * room - v * ramp) / v};
}

double room_of(const Limits& limits, const JogDesign& design) {
  return design.direction > 0 ? limits.travel_max - design.start : design.start - limits.travel_min;
}

}  // namespace

double fastest_jog(const Limits& limits, double sample_time, const JogDesign& design) {
  const double room = room_of(limits, design);
  double low = 0.0;
  double high = kReserve * limits.speed;
  if (jog_way(limits, sample_time, room, high).longest >= kShortestJog) return high;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (jog_way(limits, sample_time, room, middle).longest >= kShortestJog ? low : high) = middle;
  }
  return low;
}

Excitation design_jog(const Limits& limits, double sample_time, const JogDesign& design) {
  check(limits, sample_time, design.start);
  if (design.speeds.empty()) throw Refused("jog: no speed is below the limit; give slower ones");
  const double room = room_of(limits, design);
  Excitation e;
  e.method = "jog";
  e.sample_time = sample_time;
  double r = design.start;
  e.r.push_back(r);
  if (design.period > 0.0) {
    const double fastest = *std::max_element(design.speeds.begin(), design.speeds.end());
    const double least = 2.0 * fastest * sample_time;
    if (design.period < least || design.period > room) {
      throw BadDesign(
          "period",
          text(
              "got %g mm, expected between %g mm (two rows at the fastest speed) and %g mm (the available travel)",
              design.period * 1e3, least * 1e3, room * 1e3));
    }
  }
  std::size_t whole_ways = 0;
  for (const double v : design.speeds) {
    if (!(v > 0.0) || v > limits.speed) {
      throw BadDesign(
          "speeds", text("jog: speed of %g mm/s, expected above 0 and at most the limit of %g mm/s", v * 1e3,
                         limits.speed * 1e3));
    }
    // Long enough to leave the bristle behind (some tens of micrometres) and to average noise.
    const auto [ramp, longest] = jog_way(limits, sample_time, room, v);
    double flat = std::min(std::max(2.0, 0.2e-3 / v), longest);
    if (design.period > 0.0) {
      // What is left out until the axis has settled comes on top of the whole periods.
      const double settled = flat - std::min(kSettle, 0.3 * flat);
      const double whole = std::ceil(v * settled / design.period - 1e-9) * design.period / v + kSettle;
      if (whole <= std::min(longest, kLongestJog)) {
        flat = whole;
        ++whole_ways;
      }
    }
    if (flat < kShortestJog) {
      throw Refused(text(
          "jog: %g mm/s has only %.3g s of constant speed in the travel; start elsewhere or leave it out",
          v * 1e3, flat));
    }
    check_rows(
        "speeds",
        static_cast<double>(e.r.size()) + 2.0 * (std::ceil(flat / sample_time) + 2.0 * ramp / sample_time),
        sample_time, text("jog: %g mm/s, with the speeds before it,", v * 1e3), "leave out the slowest");
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
      "jog: %.1f s, %zu speeds in both directions, up to %.3g mm/s. Determines friction at these speeds, "
      "the slowest included; says nothing about the mass.",
      e.t.back(), design.speeds.size(), 1e3 * *std::max_element(design.speeds.begin(), design.speeds.end()));
  if (design.period > 0.0) {
    e.says += text(" At %zu of them the travel is a whole number of turns of %g mm.", whole_ways,
                   design.period * 1e3);
  }
  return e;
}

Excitation design_sine(const Limits& limits, double sample_time, const SineDesign& design) {
  check(limits, sample_time, design.start);
  if (!(design.amplitude > 0.0) || !(design.frequency > 0.0) || design.periods < 1) {
    throw Refused("sine: amplitude, frequency and number of periods must be positive");
  }
  Excitation e;
  e.method = design.from_middle ? "position-sine" : "sine";
  e.sample_time = sample_time;
  // φ' rises as 3s² − 2s³ over the first second and stays: position, speed and acceleration begin at rest.
  // A cosine ends at rest by itself; a sine, which passes its middle at full speed, slows down as it began.
  const double whole = 2.0 * kPi * design.periods / design.frequency;
  const double end = design.from_middle ? std::max(whole + 1.0, 2.0) : whole + 0.5;
  check_rows("periods", end / sample_time, sample_time,
             text("%s: %d periods of %.4g s", e.method.c_str(), design.periods, 2.0 * kPi / design.frequency),
             "fewer periods, or a faster sine in the machine file");
  const auto rows = static_cast<std::size_t>(std::floor(end / sample_time)) + 1;
  const auto from_rest = [](double t) { return t < 1.0 ? t * t * t * (1.0 - 0.5 * t) : t - 0.5; };
  for (std::size_t k = 0; k < rows; ++k) {
    const double t = sample_time * static_cast<double>(k);
    const bool slowing = design.from_middle && end - t < 1.0;
    const double s = slowing ? whole - from_rest(end - t) : from_rest(t);
    const double phase = design.frequency * s;
    e.r.push_back(design.from_middle ? design.start + design.amplitude * std::sin(phase)
                                     : design.start - design.amplitude + design.amplitude * std::cos(phase));
  }
  stamp(e, rows);
  check_positions(e, limits);
  if (design.from_middle) {
    e.says = text(
        "position sine: %.1f s, %d periods, up to %.3g mm/s over %.3g mm. Determines Coulomb and viscous "
        "friction and terms periodic in position (period, amplitude, phase of this homing) up to a third of the travel; determines the Stribeck part poorly, and the mass less well than pulses.",
        e.t.back(), design.periods, design.amplitude * design.frequency * 1e3, 2e3 * design.amplitude);
    return e;
  }
  e.says = text(
      "sine: %.1f s, %d periods, up to %.3g mm/s. Determines friction at every speed up to there; the mass "
      "less well than pulses, since the acceleration is small (%.3g mm/s2).",
      e.t.back(), design.periods, design.amplitude * design.frequency * 1e3,
      design.amplitude * design.frequency * design.frequency * 1e3);
  return e;
}

namespace {

struct Slipped {
  double top = 0.0;  // [m/s]
  double way = 0.0;  // [m]
  double end = 0.0;  // time until the axis rests [s]
};

double ramp_force(double t, double up, double peak) {
  return t < up ? peak * t / up : std::max(0.0, peak * (1.0 - (t - up) / kBack));
}

/// What an axis with less friction than thought does once it slips.
Slipped predict_slip(const RoughDrive& easy, double up, double peak, double enough) {
  Slipped s;
  double v = 0.0, t = 0.0;
  while ((t < up + kBack || (v > 0.0 && t < 2.0 * up + 60.0)) && s.way < enough) {
    const double f = ramp_force(t, up, peak);
    if (v > 0.0 || f > easy.coulomb) {
      v = std::max(0.0, v + kStep * (f - easy.coulomb - easy.viscous * v) / easy.mass);
      s.way += kStep * v;
      s.top = std::max(s.top, v);
    }
    t += kStep;
  }
  s.end = t;
  return s;
}

}  // namespace

Excitation design_ramp(const Limits& limits, const RoughDrive& drive, double sample_time,
                       const RampDesign& design) {
  constexpr double kLongestRise = 15.0;  // [s]
  constexpr double kShortestRise = 1.0;  // [s]
  check(limits, sample_time, design.start);
  if (!(drive.mass > 0.0) || !(drive.coulomb > 0.0) || !(design.rise.value_or(1.0) > 0.0) ||
      design.repeats < 1) {
    throw Refused(
        "ramp: a rough mass and Coulomb force, a time of rise and a number of repeats are needed, all "
        "positive");
  }
  const double peak = kBeyond * drive.coulomb;
  if (limits.force > 0.0 && peak > limits.force) {
    throw Refused(text("ramp: needs %.4g N, the limit of force is %.4g N", peak, limits.force));
  }
  const RoughDrive easy{drive.mass, kDoubt * drive.coulomb, kDoubt * drive.viscous};
  const double room = std::min(limits.travel_max - design.start, design.start - limits.travel_min);
  double rise = design.rise.value_or(kLongestRise);
  if (design.rise && rise < kFewestRampRows * sample_time) {
    throw BadDesign("rise",
                    text("ramp: got %g s, expected at least %g s, %g rows (a faster rise is not a slow ramp)",
                         rise, kFewestRampRows * sample_time, kFewestRampRows));
  }
  check_rows(design.rise ? "rise" : "repeats",
             2.0 * design.repeats * (kBeyond * rise + kBack + 2.0 * kRest + 0.5) / sample_time, sample_time,
             text("ramp: %d ramps in each direction with a rise of %g s", design.repeats, rise),
             "a shorter rise or fewer repeats");
  Slipped slipped = predict_slip(easy, kBeyond * rise, peak, 2.0 * room);
  while (!design.rise && rise > kShortestRise && (slipped.top > limits.speed || 1.5 * slipped.way > room)) {
    rise *= 0.9;
    slipped = predict_slip(easy, kBeyond * rise, peak, 2.0 * room);
  }
  if (slipped.top > limits.speed) {
    throw Refused(
        text("ramp: the axis may reach %.3g mm/s after it slips, the limit of speed is %g mm/s; take a "
             "shorter rise, now %.3g s",
             slipped.top * 1e3, limits.speed * 1e3, rise));
  }
  if (1.5 * slipped.way > room) {
    throw Refused(
        text("ramp: the axis may move %.3g mm after it slips, the nearer end of the travel is %.3g mm "
             "away; take a shorter rise, now %.3g s",
             slipped.way * 1e3, room * 1e3, rise));
  }
  if (slipped.way < kHardlySlips) {
    throw Refused(
        text("ramp: the axis would slip by %.3g mm only; the rough mass of %g kg or the friction is wrong",
             slipped.way * 1e3, drive.mass));
  }
  const double up = kBeyond * rise;
  Excitation e;
  e.method = "ramp";
  e.sample_time = sample_time;
  const double whole = std::max(slipped.end, up + kBack) + 2.0 * kRest + 0.5;
  check_rows(design.rise ? "rise" : "repeats", 2.0 * design.repeats * whole / sample_time, sample_time,
             text("ramp: %d ramps in each direction with a rise of %g s", design.repeats, rise),
             "a shorter rise or fewer repeats");
  const auto rows = static_cast<std::size_t>(std::ceil(whole / sample_time));
  for (int i = 0; i < design.repeats; ++i) {
    for (const double direction : {1.0, -1.0}) {
      for (std::size_t k = 0; k < rows; ++k) {
        e.force.push_back(direction * ramp_force(sample_time * static_cast<double>(k), up, peak));
      }
    }
  }
  stamp(e, e.force.size());
  e.says = text(
      "ramp: %.1f s, %d ramps in each direction, up to %.4g N with %.3g N/s; after the slip the axis moves "
      "up to about %.2g mm. Determines the force and the distance of break-away; does not determine "
      "friction at speed or the mass.",
      e.t.back(), design.repeats, peak, peak / up, slipped.way * 1e3);
  return e;
}

Excitation design_constant_acceleration(const Limits& limits, double sample_time,
                                        const AccelerationDesign& design) {
  check(limits, sample_time, design.start);
  if (!(design.flank > 0.0) || design.repeats < 1) {
    throw Refused("constant acceleration: time of a flank and number of repeats must be positive");
  }
  const double room =
      design.direction > 0 ? limits.travel_max - design.start : design.start - limits.travel_min;
  double v = kReserve * limits.speed;
  double flank = design.flank;
  if (limits.acceleration > 0.0) flank = std::max(flank, v / (0.5 * limits.acceleration));
  v = std::min(v, 0.95 * room / flank);  // both flanks together go v·flank
  check_rows("repeats", 2.0 * design.repeats * (2.0 * flank + 0.2) / sample_time, sample_time,
             text("constant acceleration: %d triangles in each direction", design.repeats), "fewer repeats");
  const auto rows = static_cast<std::size_t>(std::ceil(flank / sample_time));
  if (rows < 20) {
    throw Refused(text("constant acceleration: a flank of %.3g s has only %zu samples, expected at least 20",
                       flank, rows));
  }
  Excitation e;
  e.method = "constant-acceleration";
  e.sample_time = sample_time;
  double r = design.start;
  e.r.push_back(r);
  for (int i = 0; i < design.repeats; ++i) {
    for (const double way : {design.direction, -design.direction}) {
      for (std::size_t k = 0; k < 2 * rows; ++k) {
        const double up = (static_cast<double>(k) + 0.5) / static_cast<double>(rows);
        r += way * v * std::min(up, 2.0 - up) * sample_time;
        e.r.push_back(r);
      }
      for (double t = 0.0; t < 0.2; t += sample_time) e.r.push_back(r);
    }
    r = design.start;
  }
  stamp(e, e.r.size());
  check_positions(e, limits);
  e.says = text(
      "constant acceleration: %.1f s, %d triangles of speed in each direction, %.3g mm/s2 up to %.3g mm/s. "
      "Determines the mass, from accelerating against braking at the same speed, whatever the friction; "
      "friction only roughly.",
      e.t.back(), design.repeats, v / flank * 1e3, v * 1e3);
  return e;
}

namespace {

/// Rounded as printed, without a sign before zero.
double millimetres(double metres) { return std::round(metres * 1e9) * 1e-6 + 0.0; }

}  // namespace

std::string as_gcode(const Excitation& e, const std::string& axis, const std::string& machine) {
  if (e.r.empty()) {
    throw Refused(e.method +
                  ": forces in open loop cannot be asked for by G-code, which moves positions only; give "
                  "the table to a control that takes forces, or choose jog, sine, position-sine or "
                  "constant-acceleration");
  }
  static constexpr std::string_view kLetters = "XYZABCUVW";
  const char letter =
      axis.size() == 1 ? static_cast<char>(std::toupper(static_cast<unsigned char>(axis[0]))) : '?';
  if (kLetters.find(letter) == std::string_view::npos) {
    throw Refused("G-code: axis " + axis + " has no letter of its own, expected one of X Y Z A B C U V W");
  }
  // Parentheses end a comment.
  std::string name = machine;
  std::erase_if(name, [](char c) { return c == '(' || c == ')' || c == '\n' || c < ' '; });
  std::string out =
      text("(%s of axis %c, %s)\n", e.method.c_str(), letter, name.c_str()) +
      text("(%.1f s; millimetres, millimetres per minute; record position and drive force meanwhile)\n",
           e.t.back()) +
      "(the control adds its own ramps: feed override 100 %, nothing else moving, no cutting)\n" +
      "G21 G90 G94 G64\n" + text("G0 %c%.6f\nG4 P1\n", letter, millimetres(e.r.front()));
  const double T = e.sample_time;
  const bool flats = e.method == "jog";
  const auto dense = static_cast<std::size_t>(std::max(1.0, std::round(kGcodeStep / T)));
  std::size_t k = 0;
  while (k + 1 < e.r.size()) {
    std::size_t last = k + 1;
    const double step = e.r[last] - e.r[k];
    if (step == 0.0) {
      while (last + 1 < e.r.size() && e.r[last + 1] == e.r[last]) ++last;
      out += text("G4 P%.3f\n", static_cast<double>(last - k) * T);
      k = last;
      continue;
    }
    double fastest = std::abs(step);
    if (flats) {
      // One way: the ramps are the control's, the feed is that of the flat part.
      while (last + 1 < e.r.size() && (e.r[last + 1] - e.r[last]) * step > 0.0) {
        ++last;
        fastest = std::max(fastest, std::abs(e.r[last] - e.r[last - 1]));
      }
    } else {
      while (last + 1 < e.r.size() && (e.r[last + 1] - e.r[last]) * step > 0.0 &&
             (last - k < dense || std::abs(e.r[last] - e.r[k]) < kFinest)) {
        ++last;
      }
      if (std::abs(e.r[last] - e.r[k]) < kFinest) {  // a feed of nearly zero is an error to the control
        out += text("G4 P%.3f\n", static_cast<double>(last - k) * T);
        k = last;
        continue;
      }
      fastest = std::abs(e.r[last] - e.r[k]) / static_cast<double>(last - k);
    }
    out += text("G1 %c%.6f F%.5f\n", letter, millimetres(e.r[last]), fastest / T * 60e3);
    k = last;
  }
  return out + "M2\n";
}

}  // namespace stribeck::ident::excitation
