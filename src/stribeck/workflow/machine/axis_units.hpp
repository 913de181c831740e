#pragma once
/// Units in which people read an axis: mm, N and kg, or of a rotary axis, which is carried as a linear one at a radius of 1 m, deg,
/// N m and kg m2.
/// Real time: no.

#include <stribeck/core/scalar.hpp>
#include <stribeck/report/factors.hpp>
#include <string_view>

namespace stribeck::workflow {

struct AxisUnits {
  double per_metre = 1e3;  ///< units of travel in 1 m
  std::string_view travel = "mm";
  double per_metre_fine = 1e6;
  std::string_view fine = "µm";
  double per_metre_per_second = 60.0;
  std::string_view fast = "m/min";
  std::string_view force = "N";
  std::string_view mass = "kg";
};

inline constexpr AxisUnits kLinearUnits{};
inline constexpr AxisUnits kRotaryUnits{
    report::kDegrees, "deg", 3600.0 * report::kDegrees, "arc seconds", 30.0 / kPi, "rpm", "N m", "kg m2"};

constexpr const AxisUnits& units_of(bool rotary) noexcept { return rotary ? kRotaryUnits : kLinearUnits; }

/// Said wherever results of a rotary axis are shown in the units of a linear one.
inline constexpr std::string_view kRotaryAsLinear =
    "a rotary axis: angles are taken as arcs at a radius of 1 m, so that N stands for N m, kg for kg m2 and mm for mrad";
/// Key of a log whose positions are such arcs.
inline constexpr const char* kRotaryKey = "rotary";
/// The same beside a value.
inline constexpr std::string_view kRotaryInResults =
    "axis files, JSON and simulated logs take angles as arcs at a radius of 1 m: N stands for N m, kg for kg m2 and mm for mrad";
/// The same beside a result, whose table is in degrees.
inline constexpr std::string_view kRotaryNote =
    "a rotary axis: its table is in deg, N m and kg m2; axis file and JSON take angles as arcs at a radius of 1 m, so that N "
    "stands for N m, kg for kg m2 and mm for mrad";

}  // namespace stribeck::workflow
