#pragma once
/// Factors from SI to the units that people see.
/// Real time: safe.

namespace stribeck::report {

inline constexpr double kMilli = 1e3;  ///< m to mm
inline constexpr double kMicro = 1e6;  ///< m to µm

}  // namespace stribeck::report
