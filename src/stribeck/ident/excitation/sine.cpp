// A sine of position, from rest to rest.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/digits.hpp>
#include <stribeck/ident/excitation/excitation_parts.hpp>

namespace stribeck::ident::excitation {

Excitation design_sine(const Limits& limits, double sample_time, const SineDesign& design) {
  check(limits, sample_time, design.start);
  if (!(design.amplitude > 0.0) || !(design.frequency > 0.0) || design.periods < 1) {
    throw Refused("sine: amplitude, frequency and number of periods must be positive");
  }
  Excitation e;
  e.method = design.from_middle ? ExcitationMethod::kPositionSine : ExcitationMethod::kSine;
  e.sample_time = sample_time;
  // φ' rises as 3s² − 2s³ over the first second and then stays constant: position, speed and acceleration begin at rest. A cosine
  // ends at rest by itself; a sine, which passes its middle at full speed, slows down in the way it began.
  const double whole = 2.0 * kPi * design.periods / design.frequency;
  const double end = design.from_middle ? std::max(whole + 1.0, 2.0) : whole + 0.5;
  check_rows("periods", end / sample_time, sample_time,
             fmt::format("{}: {} periods of {:.4g} s", enum_name(e.method), design.periods,
                         2.0 * kPi / design.frequency),
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
    e.says = fmt::format(
        "position sine: {:.1f} s, {} periods, up to {} mm/s over {} mm. Determines Coulomb "
        "and viscous friction and terms periodic in position (period, amplitude, phase of this "
        "homing) up to a third of the travel; determines the Stribeck part poorly, and the mass less "
        "well than pulses.",
        e.t.back(), design.periods, digits(design.amplitude * design.frequency * 1e3),
        digits(2e3 * design.amplitude));
    return e;
  }
  e.says = fmt::format(
      "sine: {:.1f} s, {} periods, up to {} mm/s and {} mm/s2. Determines friction at every speed up to there, "
      "and the mass as well as this acceleration shows it.",
      e.t.back(), design.periods, digits(design.amplitude * design.frequency * 1e3),
      digits(design.amplitude * design.frequency * design.frequency * 1e3));
  return e;
}

}  // namespace stribeck::ident::excitation
