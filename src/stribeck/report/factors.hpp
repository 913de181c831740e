#pragma once
/// Factors from SI to the units that people see.
/// Real time: safe.

#include <stribeck/core/scalar.hpp>

namespace stribeck::report {

inline constexpr double kMilli = 1e3;            ///< m to mm
inline constexpr double kMicro = 1e6;            ///< m to µm
inline constexpr double kDegrees = 180.0 / kPi;  ///< rad to degrees

}  // namespace stribeck::report
