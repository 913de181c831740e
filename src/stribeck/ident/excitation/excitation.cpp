// Common parts of all designs: checks against the limits, the rough drive.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stribeck/ident/excitation/excitation_parts.hpp>

namespace stribeck::ident::excitation {

void check(const Limits& l, double sample_time, double start) {
  if (!(sample_time > 0.0))
    throw Refused(fmt::format("excitation: sample time is {:g} s, expected a positive number", sample_time));
  if (!(l.speed > 0.0) || !(l.travel_max > l.travel_min)) {
    throw Refused("excitation: limits need a positive speed and a travel whose end is above its start");
  }
  if (start < l.travel_min || start > l.travel_max) {
    const Shown u = shown(l);
    throw Refused(fmt::format("excitation: start at {:g} {} lies outside the travel of {:g} to {:g} {}",
                              start * u.per_metre, u.travel, l.travel_min * u.per_metre,
                              l.travel_max * u.per_metre, u.travel));
  }
}

void check_rows(const char* parameter, double rows, double sample_time, const std::string& what,
                const std::string& way_out) {
  if (rows <= static_cast<double>(kMostRows)) return;
  throw BadDesign(parameter,
                  what +
                      fmt::format(" would take {:.3g} s and {:.4g} rows, expected at most {} rows (",
                                  rows * sample_time, rows, kMostRows) +
                      way_out + ")");
}

void stamp(Excitation& e, std::size_t rows) {
  for (std::size_t k = 0; k < rows; ++k) e.t.push_back(e.sample_time * static_cast<double>(k));
}

void check_positions(const Excitation& e, const Limits& l) {
  const double T = e.sample_time;
  const Shown u = shown(l);
  for (std::size_t k = 0; k < e.r.size(); ++k) {
    if (e.r[k] < l.travel_min - 1e-9 || e.r[k] > l.travel_max + 1e-9) {
      throw Refused(fmt::format(
          "{}: would go to {:g} {} at {:.3f} s, travel is {:g} to {:g} {}; move the start or shorten the motion",
          enum_name(e.method), e.r[k] * u.per_metre, u.travel, e.t[k], l.travel_min * u.per_metre,
          l.travel_max * u.per_metre, u.travel));
    }
    if (k + 1 < e.r.size() && std::abs(e.r[k + 1] - e.r[k]) / T > l.speed * (1.0 + 1e-6)) {
      throw Refused(fmt::format("{}: needs {:.4g} {}/s at {:.3f} s, the limit of speed is {:g} {}/s",
                                enum_name(e.method), std::abs(e.r[k + 1] - e.r[k]) / T * u.per_metre,
                                u.travel, e.t[k], l.speed * u.per_metre, u.travel));
    }
    if (k > 0 && k + 1 < e.r.size() && l.acceleration > 0.0) {
      const double a = std::abs(e.r[k + 1] - 2.0 * e.r[k] + e.r[k - 1]) / (T * T);
      // Rounding of positions affects their second difference.
      if (a > l.acceleration * 1.001 + 1e-14 / (T * T)) {
        throw Refused(fmt::format(
            "{}: needs {:.4g} {}/s2 at {:.3f} s, the limit of acceleration is {:g} {}/s2",
            enum_name(e.method), a * u.per_metre, u.travel, e.t[k], l.acceleration * u.per_metre, u.travel));
      }
    }
  }
}

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

}  // namespace stribeck::ident::excitation
