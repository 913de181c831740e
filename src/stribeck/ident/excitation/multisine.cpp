// Many frequencies at once, on a stroke at constant speed.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/digits.hpp>
#include <stribeck/ident/excitation/excitation_parts.hpp>
#include <utility>

namespace stribeck::ident::excitation {
namespace {

constexpr double kOfHalfRate = 0.8;  ///< highest line, as a share of half the sampling frequency
constexpr double kHighest = 400.0;   ///< [Hz]
constexpr double kSpacing = 1.04;    ///< ratio of neighbouring lines, where the harmonics are close enough
constexpr double kOfSpeed = 0.4;     ///< speed of the stroke, as a share of the limit
constexpr double kOfStroke = 0.5;    ///< speed of the multisine, as a share of that of the stroke
constexpr double kOfAcceleration = 0.6;  ///< acceleration of the multisine, as a share of the limit
constexpr double kOfTravel = 0.9;
constexpr double kShortestFade = 0.5;  ///< [s]
constexpr double kCrest = 3.5;         ///< expected peak of a multisine over its RMS

double smooth(double s) { return s <= 0.0 ? 0.0 : s >= 1.0 ? 1.0 : s * s * (3.0 - 2.0 * s); }
/// Integral of smooth() from 0.
double smooth_integral(double s) { return s <= 0.0 ? 0.0 : s >= 1.0 ? s - 0.5 : s * s * s * (1.0 - 0.5 * s); }

/// Harmonics of the period in about equal ratios.
std::vector<int> harmonics(double lowest, double highest, double period) {
  std::vector<int> lines;
  const double last = highest * period;
  double next = std::max(1.0, lowest * period);
  while (std::round(next) <= last + 1e-9) {
    lines.push_back(static_cast<int>(std::round(next)));
    next = std::max(next * kSpacing, static_cast<double>(lines.back()) + 1.0);
  }
  return lines;
}

/// What the multisine may do, and how its lines share it.
struct Lines {
  std::vector<int> harmonic;
  std::vector<double> share;  ///< acceleration of each line, relative
  double base = 0.0;          ///< fundamental [rad/s]

  /// Expected peak of the m-th integral for shares of 1 m/s².
  [[nodiscard]] double peak(int integrals) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < harmonic.size(); ++i) {
      const double a = share[i] / std::pow(base * harmonic[i], integrals);
      sum += 0.5 * a * a;
    }
    return kCrest * std::sqrt(sum);
  }
  /// Equal accelerations above a corner, equal speeds below it.
  void shape(double corner) {
    share.clear();
    for (const int h : harmonic) share.push_back(1.0 / std::hypot(1.0, corner / (base * h)));
  }
};

/// One period of position for unit shares [m], its fastest speed and its largest acceleration.
struct Wave {
  std::vector<double> w;
  double speed = 0.0;
  double acceleration = 0.0;
};

Wave wave_of(const Lines& lines, std::size_t rows, double sample_time, std::mt19937_64& random) {
  Wave out;
  out.w.assign(rows, 0.0);
  const double step = 2.0 * kPi / static_cast<double>(rows);
  for (std::size_t i = 0; i < lines.harmonic.size(); ++i) {
    const double omega = lines.base * lines.harmonic[i];
    const double phase = 2.0 * kPi * std::ldexp(static_cast<double>(random() >> 11), -53);
    const double size = lines.share[i] / (omega * omega);
    const auto h = static_cast<std::size_t>(lines.harmonic[i]);
    for (std::size_t k = 0; k < rows; ++k)
      out.w[k] += size * std::cos(step * static_cast<double>(h * k % rows) + phase);
  }
  for (std::size_t k = 0; k < rows; ++k) {
    const double before = out.w[(k + rows - 1) % rows];
    const double after = out.w[(k + 1) % rows];
    out.speed = std::max(out.speed, std::abs(after - out.w[k]) / sample_time);
    out.acceleration =
        std::max(out.acceleration, std::abs(after - 2.0 * out.w[k] + before) / (sample_time * sample_time));
  }
  return out;
}

/// A stroke from rest to rest at constant speed between two flanks of `flank` seconds.
struct SteadyStroke {
  double speed = 0.0;
  double flank = 0.0;
  double cruise = 0.0;  ///< at constant speed [s]

  [[nodiscard]] double duration() const { return 2.0 * flank + cruise; }
  [[nodiscard]] double distance() const { return speed * (flank + cruise); }
  [[nodiscard]] double at(double t) const {
    const double up = flank * smooth_integral(std::min(t, flank + cruise) / flank);
    const double down = t - flank - cruise;
    return speed * (down <= 0.0 ? up : up + down - flank * smooth_integral(down / flank));
  }
};

double flank_for(double speed, const Limits& limits) {
  return std::max(0.2, limits.acceleration > 0.0 ? 3.0 * speed / limits.acceleration : 0.0);
}

/// Appends a stroke from the last position; `wave` may be empty.
void append(Excitation& e, const SteadyStroke& stroke, double direction, const std::vector<double>& wave,
            double scale, double fade) {
  const double begin = e.r.back();
  const auto rows = static_cast<std::size_t>(std::ceil(stroke.duration() / e.sample_time));
  const double end = stroke.duration() - stroke.flank;
  for (std::size_t k = 1; k <= rows; ++k) {
    const double t = e.sample_time * static_cast<double>(k);
    double r = begin + direction * stroke.at(std::min(t, stroke.duration()));
    if (!wave.empty())
      r += scale * smooth(std::min(t - stroke.flank, end - t) / fade) * wave[k % wave.size()];
    e.r.push_back(r);
  }
  for (double t = 0.0; t < kRest; t += e.sample_time) e.r.push_back(e.r.back());
}

/// Speed of the stroke that was asked for, or the one that limits and travel allow.
double stroke_speed(const Limits& limits, const MultisineDesign& design, double cruise) {
  const Shown u = shown(limits);
  const double room =
      kOfTravel * 2.0 * std::min(limits.travel_max - design.start, design.start - limits.travel_min);
  double speed = design.speed.value_or(kOfSpeed * limits.speed);
  if (design.speed && (*design.speed <= 0.0 || *design.speed > 0.6 * limits.speed)) {
    throw BadDesign(
        "speed", fmt::format("multisine: got {} {}/s, expected at most {} {}/s, six tenths of the limit: the "
                             "excitation comes on top of it",
                             digits(*design.speed * u.per_metre), u.travel,
                             digits(0.6 * u.per_metre * limits.speed), u.travel));
  }
  const double most = room / (cruise + flank_for(speed, limits));
  if (design.speed && speed > most) {
    throw BadDesign(
        "speed",
        fmt::format("multisine: {} {}/s for {:.1f} s needs more than the travel; expected at most {} "
                    "{}/s, or fewer periods",
                    digits(speed * u.per_metre), u.travel, cruise, digits(most * u.per_metre), u.travel));
  }
  return std::min(speed, most);
}

Lines lines_of(const Limits& limits, const MultisineDesign& design, double sample_time, std::size_t rows,
               double speed, double acceleration) {
  Lines lines;
  const double period = sample_time * static_cast<double>(rows);
  lines.base = 2.0 * kPi / period;
  const double top = design.highest.value_or(std::min(kHighest, kOfHalfRate * 0.5 / sample_time));
  if (top > 0.95 * 0.5 / sample_time || top < 4.0 * design.lowest) {
    throw BadDesign(
        "highest",
        fmt::format("multisine: got {} Hz, expected {} to {} Hz: below half the sampling frequency, and "
                    "four times the lowest line",
                    digits(top), digits(4.0 * design.lowest), digits(0.475 / sample_time)));
  }
  lines.harmonic = harmonics(design.lowest, top, period);
  const double most = std::min(kOfStroke * speed, kReserve * limits.speed - speed);
  // The smallest corner with which the acceleration is the limit, not the speed.
  for (double corner = lines.base; corner < 2.0 * kPi * top; corner *= 1.2) {
    lines.shape(corner);
    if (most / lines.peak(1) >= acceleration / lines.peak(0)) break;
  }
  return lines;
}

/// Acceleration that limits and drive allow [m/s²].
double allowed(const Limits& limits, const RoughDrive& drive) {
  double most = limits.acceleration > 0.0 ? kOfAcceleration * limits.acceleration : 1e9;
  if (limits.force > 0.0 && drive.mass > 0.0) {
    const double left = limits.force - drive.coulomb;
    if (left <= 0.0) {
      throw Refused(
          fmt::format("multisine: the rough friction is {} {}, the largest force of the drive is {} {}: no "
                      "force is left to shake the axis (check commissioning.friction and limits.force)",
                      digits(drive.coulomb), shown(limits).force, digits(limits.force), shown(limits).force));
    }
    most = std::min(most, kOfAcceleration * left / drive.mass);
  }
  return most;
}

}  // namespace

Excitation design_multisine(const Limits& limits, const RoughDrive& drive, double sample_time,
                            const MultisineDesign& design) {
  check(limits, sample_time, design.start);
  const auto rows = static_cast<std::size_t>(std::lround(design.period / sample_time));
  if (design.period <= 0.0 || rows < 40) {
    throw BadDesign("period", fmt::format("multisine: a period of {} s has {} rows, expected at least 40",
                                          digits(design.period), rows));
  }
  if (design.periods < 3 || design.repeats < 1) {
    throw BadDesign(
        design.periods < 3 ? "periods" : "repeats",
        fmt::format(
            "multisine: got {} periods and {} repeats, expected at least 3 and 1: the first period of each stroke is "
            "for settling",
            design.periods, design.repeats));
  }
  const double period = sample_time * static_cast<double>(rows);
  check_rows("repeats", 2.0 * design.repeats * (design.periods * period + 3.0) / sample_time, sample_time,
             fmt::format("multisine: {} strokes in each direction", design.repeats),
             "fewer repeats, fewer periods or a shorter period");
  const double acceleration = allowed(limits, drive);
  double fade = kShortestFade;
  const double cruise = design.periods * period;
  SteadyStroke stroke;
  stroke.speed = stroke_speed(limits, design, cruise + 2.0 * fade);
  const Lines lines = lines_of(limits, design, sample_time, rows, stroke.speed, acceleration);

  std::mt19937_64 random(design.seed);
  std::vector<Wave> waves;
  double scale = 1e300;
  const double most = std::min(kOfStroke * stroke.speed, kReserve * limits.speed - stroke.speed);
  for (int i = 0; i < 2 * design.repeats; ++i) {
    waves.push_back(wave_of(lines, rows, sample_time, random));
    scale = std::min({scale, acceleration / waves.back().acceleration, most / waves.back().speed});
  }
  stroke.flank = flank_for(stroke.speed, limits);
  stroke.cruise = cruise + 2.0 * fade;

  Excitation e;
  e.method = ExcitationMethod::kMultisine;
  e.sample_time = sample_time;
  e.r.push_back(design.start);
  SteadyStroke first = stroke;
  first.cruise = 0.5 * stroke.distance() / stroke.speed - stroke.flank;
  if (first.cruise < 0.0) first = {0.5 * stroke.distance() / stroke.flank, stroke.flank, 0.0};
  append(e, first, -design.direction, {}, 0.0, fade);
  double direction = design.direction;
  for (const Wave& wave : waves) {
    append(e, stroke, direction, wave.w, scale, fade);
    direction = -direction;
  }
  stamp(e, e.r.size());
  check_positions(e, limits);
  const Shown u = shown(limits);
  e.says = fmt::format(
      "multisine: {:.1f} s, {} lines from {} to {} Hz with a period of {} s, on {} strokes at {} {}/s over {} {}; speed never "
      "below {} {}/s while it is measured. Determines the frequency response from force to position (stribeck frequency), with it "
      "mass, delay and resonances; of friction only the slope at this speed.",
      e.t.back(), lines.harmonic.size(), digits(lines.harmonic.front() / period),
      digits(lines.harmonic.back() / period), digits(period), waves.size(),
      digits(stroke.speed * u.per_metre), u.travel, digits(stroke.distance() * u.per_metre), u.travel,
      digits((stroke.speed - most) * u.per_metre), u.travel);
  return e;
}

}  // namespace stribeck::ident::excitation
