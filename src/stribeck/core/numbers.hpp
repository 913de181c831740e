#pragma once
/// Numbers that many files need by name.
/// Real time: safe.

#include <limits>

namespace stribeck {

/// Not a number: a value that is absent or not known, where the declaration says so.
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace stribeck
