#pragma once
/// Limits of a record that can be identified. problems() of a record names what breaks them, and the cleaning of a log keeps to them.
/// Real time: safe.

#include <cstddef>

namespace stribeck::ident::log {

/// Smallest number of rows for a second difference, a smoothing window and one stretch of sliding; also of a piece of a log.
inline constexpr std::size_t kFewestRows = 100;
/// Largest difference of a time step from the sample time, as a share of it.
inline constexpr double kJitter = 0.01;
/// No magnitude of a machine: squares of smaller ones, and their sums, do not overflow.
inline constexpr double kAbsurd = 1e30;

}  // namespace stribeck::ident::log
