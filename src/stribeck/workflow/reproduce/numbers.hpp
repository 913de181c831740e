#pragma once
/// Numbers of the thesis's tables, computed from results of identifications.
/// Real time: no.

#include <array>
#include <limits>
#include <stribeck/core/numbers.hpp>
#include <stribeck/friction/model.hpp>
#include <stribeck/ident/methods/jog/jog.hpp>
#include <stribeck/ident/result.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::workflow::reproduction {

inline constexpr double kMilli = 1e-3;  ///< mm, mm/s
inline constexpr double kKilo = 1e3;    ///< N s/mm, N s2/mm

/// Steady force of a map [N].
double force_of(const friction::SteadyVariant& map, double v);

/// f = α0±·sgn v + α2·v with one slope for both directions, the printed form of Tables 2.1 and 2.2.
/// Intervals are those of the scatter about it.
struct Line {
  std::array<double, 2> level{kNaN, kNaN};  ///< v > 0, v < 0, both positive [N]
  double slope = kNaN;                      ///< [N·s/m]
  std::array<double, 2> level_half{kNaN, kNaN};
  double slope_half = kNaN;
};

struct SpeedAndForce {
  double speed = 0.0;
  double force = 0.0;
};

Line line_through(const std::vector<SpeedAndForce>& points);
std::vector<SpeedAndForce> means_of(const ident::methods::Jog& jog);

/// The same line through Table 2.3 at the same speeds: the values that Tables 2.1 and 2.2 would have if they described the
/// same friction.
Line line_through_print(std::vector<SpeedAndForce> points, const std::string& axis);

struct Estimate {
  double value = kNaN;
  ident::Interval interval{};
};

/// A parameter of a result by its name; NaN where there is none.
Estimate estimate(const ident::Result& r, std::string_view name, double scale = 1.0);
Estimate plus_minus(double value, double half);

/// Conventional parameters of a jog fit: those of (2.9), or the means of both directions where it was fitted by direction.
struct Conventional {
  Estimate alpha0, alpha1, alpha2, v0;
};

Conventional conventional_of(const ident::Result& r);

/// The curve and its interval at a velocity, interpolated linearly between its points.
Estimate curve_at(const ident::Result& r, double v);

struct Deviation {
  double force = 0.0;    ///< [N]
  double percent = 0.0;  ///< of the printed curve
};

/// Largest difference from the printed curve over 0.5–9.5 mm/s of one direction.
Deviation deviation(const ident::Result& r, const std::string& axis, double direction);

}  // namespace stribeck::workflow::reproduction
