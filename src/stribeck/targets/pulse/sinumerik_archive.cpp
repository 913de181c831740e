#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <stribeck/targets/pulse/sinumerik.hpp>

namespace stribeck::targets {

namespace {

/// One machine datum with a number: where it is kept, its unit in SI, and the decimals that are written.
struct Datum {
  int number;
  const char* name;
  double Qec::*member;
  double unit;
  int decimals;
};
constexpr std::array kData{Datum{32520, "FRICT_COMP_CONST_MAX", &Qec::largest, kMmPerMinute, 3},
                           Datum{32530, "FRICT_COMP_CONST_MIN", &Qec::smallest, kMmPerMinute, 3},
                           Datum{32540, "FRICT_COMP_TIME", &Qec::time_constant, 1.0, 4},
                           Datum{32550, "FRICT_COMP_ACCEL1", &Qec::a1, 1.0, 6},
                           Datum{32560, "FRICT_COMP_ACCEL2", &Qec::a2, 1.0, 6},
                           Datum{32570, "FRICT_COMP_ACCEL3", &Qec::a3, 1.0, 6}};

std::string left_of(const Datum& d, const std::string& axis) {
  return fmt::format("N{} $MA_{}[{}]=", d.number, d.name, axis);
}

/// Shares of the two amplitudes in Δn(a).
std::array<double, 2> shares(const Qec& breaks, double a) {
  if (a < breaks.a1) return {a / breaks.a1, 0.0};
  if (a <= breaks.a2) return {1.0, 0.0};
  if (a >= breaks.a3) return {0.0, 1.0};
  const double part = (a - breaks.a2) / (breaks.a3 - breaks.a2);
  return {1.0 - part, part};
}

/// Sets both amplitudes by least squares for the given breaks; returns the sum of the squares.
double fit_amplitudes(Qec& qec, const std::vector<PulsePoint>& points) {
  double s11 = 0.0;
  double s12 = 0.0;
  double s22 = 0.0;
  double t1 = 0.0;
  double t2 = 0.0;
  for (const PulsePoint& p : points) {
    const auto [one, two] = shares(qec, p.acceleration);
    const double w = p.weight * p.weight;
    s11 += w * one * one;
    s12 += w * one * two;
    s22 += w * two * two;
    t1 += w * one * p.amplitude;
    t2 += w * two * p.amplitude;
  }
  const double determinant = s11 * s22 - s12 * s12;
  if (determinant > 1e-9 * s11 * s22) {
    qec.largest = (s22 * t1 - s12 * t2) / determinant;
    qec.smallest = (s11 * t2 - s12 * t1) / determinant;
  } else {
    // All points in the level part, or all in the last one: it stays level.
    qec.largest = s11 > 0.0 ? t1 / s11 : s22 > 0.0 ? t2 / s22 : 0.0;
    qec.smallest = qec.largest;
  }
  if (!(qec.largest >= 0.0 && qec.smallest >= 0.0)) return std::numeric_limits<double>::infinity();
  double sum = 0.0;
  for (const PulsePoint& p : points) {
    const double off = p.weight * (qec.amplitude(p.acceleration) - p.amplitude);
    sum += off * off;
  }
  return sum;
}

}  // namespace

double Qec::amplitude(double acceleration) const noexcept {
  const auto [one, two] = shares(*this, acceleration);
  return one * largest + two * smallest;
}

Qec nearest_qec(const std::vector<PulsePoint>& points, double time_constant) {
  const auto by_acceleration = [](const PulsePoint& a, const PulsePoint& b) {
    return a.acceleration < b.acceleration;
  };
  const auto [low, high] = std::minmax_element(points.begin(), points.end(), by_acceleration);
  // Breaks in steps of a ratio, from half the smallest acceleration to the largest: beyond what was tried it stays level.
  constexpr int kSteps = 24;
  const double first = 0.5 * low->acceleration;
  const double ratio = std::pow(2.0 * high->acceleration / low->acceleration, 1.0 / kSteps);
  const auto at = [&](int i) { return first * std::pow(ratio, i); };
  Qec best;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kSteps - 2; ++i) {
    for (int j = i + 1; j <= kSteps - 1; ++j) {
      for (int k = j + 1; k <= kSteps; ++k) {
        Qec q{0.0, 0.0, time_constant, at(i), at(j), at(k)};
        const double sum = fit_amplitudes(q, points);
        if (sum < least) {
          least = sum;
          best = q;
        }
      }
    }
  }
  return best;
}

std::string archive_text(const Qec& qec, const std::string& axis) {
  std::string out = fmt::format(
      "N32490 $MA_FRICT_COMP_MODE[{0}]=1\nN32500 $MA_FRICT_COMP_ENABLE[{0}]=1\nN32510 $MA_FRICT_COMP_ADAPT_ENABLE[{0}]=1\n",
      axis);
  for (const Datum& d : kData)
    out += fmt::format("{}{:.{}f}\n", left_of(d, axis), qec.*d.member / d.unit, d.decimals);
  return out;
}

Qec read_archive(const std::string& text, const std::string& axis) {
  Qec qec;
  for (const Datum& d : kData) qec.*d.member = number_after(left_of(d, axis), text, "archive") * d.unit;
  return qec;
}

}  // namespace stribeck::targets
