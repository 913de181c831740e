// A sine of position, from rest to rest.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/digits.hpp>
#include <stribeck/ident/excitation/excitation_parts.hpp>

namespace stribeck::ident::excitation {
namespace {

/// φ' rises as 3s² − 2s³ over `rise` seconds and then stays constant: position, speed and acceleration begin at rest. A cosine ends at
/// rest by itself; a sine, which passes its middle at full speed, slows down in the way it began.
struct Course {
  const SineDesign& design;
  double rise = 1.0;

  [[nodiscard]] double whole() const { return 2.0 * kPi * design.periods / design.frequency; }
  [[nodiscard]] double end() const {
    return design.from_middle ? std::max(whole() + rise, 2.0 * rise) : whole() + 0.5 * rise;
  }
  [[nodiscard]] double from_rest(double t) const {
    const double s = t / rise;
    return s < 1.0 ? rise * (s * s * s * (1.0 - 0.5 * s)) : t - 0.5 * rise;
  }
  [[nodiscard]] double at(double t) const {
    const bool slowing = design.from_middle && end() - t < rise;
    const double phase = design.frequency * (slowing ? whole() - from_rest(end() - t) : from_rest(t));
    return design.from_middle ? design.start + design.amplitude * std::sin(phase)
                              : design.start - design.amplitude + design.amplitude * std::cos(phase);
  }
  /// The acceleration of the first rows, until the sine has its speed.
  [[nodiscard]] double sharpest(double sample_time) const {
    double most = 0.0;
    for (double t = sample_time; t < rise; t += sample_time)
      most = std::max(most, std::abs(at(t + sample_time) - 2.0 * at(t) + at(t - sample_time)));
    return most / (sample_time * sample_time);
  }
};

/// Begins in one second, or as slowly as the acceleration permits: a sine from its middle has to reach its full speed at once.
Course course_of(const SineDesign& design, const Limits& limits, double sample_time) {
  constexpr double kLonger = 1.25;
  constexpr double kLongestRise = 20.0;  // [s]
  Course course{design};
  while (design.from_middle && limits.acceleration > 0.0 && course.rise < kLongestRise &&
         course.sharpest(sample_time) > limits.acceleration)
    course.rise *= kLonger;
  return course;
}

constexpr double kLongestStroke = 10.0;  // at constant speed [s]
constexpr double kFastestStroke = 0.5;   // share of the sine's top speed
constexpr double kNextStroke = 0.4;      // of the speed before

struct Appended {
  int strokes = 0;
  double way = 0.0;  ///< of the longest one [m]
};

/// From where the sine ends, towards its middle and as far as the limits and the number of rows allow: a fast control has short strokes, or
/// fewer.
Appended append_strokes(const SineDesign& design, const Limits& limits, Excitation& e) {
  Limits own = limits;
  // Without a limit the flanks are no sharper than the sine.
  if (!(own.acceleration > 0.0)) own.acceleration = design.amplitude * design.frequency * design.frequency;
  const double room = design.start - limits.travel_min;
  const double way = std::min(room, std::max(2.0 * design.amplitude, kSeveralTurns));
  double speed = kFastestStroke * std::min(design.amplitude * design.frequency, kReserve * limits.speed);
  Appended out;
  e.r.resize(e.r.size() + static_cast<std::size_t>(kRest / e.sample_time) + 1, design.start);
  for (int k = 0; k < design.strokes; ++k, speed *= kNextStroke) {
    Profile p = profile_of(own, e.sample_time, way, speed);
    // A way too short for half of the top speed: half of it for the flanks.
    while (p.longest < p.ramp) speed *= 0.9, p = profile_of(own, e.sample_time, way, speed);
    // Both ways, with the rests between them.
    constexpr double kInHand = 0.95;
    const double left = static_cast<double>(kMostRows) - static_cast<double>(e.r.size());
    const double room_in_time = kInHand * left * e.sample_time / (2.0 * (design.strokes - k));
    const double flat = std::min({p.longest, kLongestStroke, room_in_time - 2.0 * p.ramp});
    if (flat < p.ramp) break;
    append({design.start, -1.0, speed, p.ramp, flat}, e);
    ++out.strokes;
    out.way = std::max(out.way, speed * (flat + p.ramp));
  }
  return out;
}

}  // namespace

Excitation design_sine(const Limits& limits, double sample_time, const SineDesign& design) {
  check(limits, sample_time, design.start);
  if (!(design.amplitude > 0.0) || !(design.frequency > 0.0) || design.periods < 1) {
    throw Refused("sine: amplitude, frequency and number of periods must be positive");
  }
  Excitation e;
  e.method = design.from_middle ? ExcitationMethod::kPositionSine : ExcitationMethod::kSine;
  e.sample_time = sample_time;
  const Course course = course_of(design, limits, sample_time);
  const double end = course.end();
  check_rows("periods", end / sample_time, sample_time,
             fmt::format("{}: {} periods of {:.4g} s", enum_name(e.method), design.periods,
                         2.0 * kPi / design.frequency),
             "fewer periods, or a faster sine in the machine file");
  const auto rows = static_cast<std::size_t>(std::floor(end / sample_time)) + 1;
  for (std::size_t k = 0; k < rows; ++k) e.r.push_back(course.at(sample_time * static_cast<double>(k)));
  Appended strokes;
  if (design.strokes > 0 && !design.from_middle) strokes = append_strokes(design, limits, e);
  stamp(e, e.r.size());
  check_positions(e, limits);
  const Shown u = shown(limits);
  const double fastest = design.amplitude * design.frequency;
  if (design.from_middle) {
    e.says = fmt::format(
        "position sine: {:.1f} s, {} periods, up to {} {}/s over {} {}. Determines Coulomb "
        "and viscous friction and terms periodic in position (period, amplitude, phase of this "
        "homing) up to a third of the travel; determines the Stribeck part poorly, and the mass less "
        "well than pulses.",
        e.t.back(), design.periods, digits(fastest * u.per_metre), u.travel,
        digits(2.0 * u.per_metre * design.amplitude), u.travel);
    return e;
  }
  e.says = fmt::format(
      "sine: {:.1f} s, {} periods, up to {} {}/s and {} {}/s2. Determines friction at every speed up to there, "
      "and the mass as well as this acceleration shows it.",
      e.t.back(), design.periods, digits(fastest * u.per_metre), u.travel,
      digits(fastest * design.frequency * u.per_metre), u.travel);
  if (strokes.strokes > 0)
    e.says += fmt::format(
        " Then strokes at {} constant speed{}, up to {} {} long: they tell forces that belong to the place from friction over speed.",
        strokes.strokes, strokes.strokes == 1 ? "" : "s", digits(strokes.way * u.per_metre), u.travel);
  return e;
}

}  // namespace stribeck::ident::excitation
