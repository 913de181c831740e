#pragma once
/// Tables of the thesis as printed, in its units (N, mm, rad). They are only shown beside results and never used as an input of an
/// identification.
/// Real time: no.

#include <cstddef>
#include <stribeck/friction/gaussian.hpp>
#include <string>
#include <string_view>

namespace stribeck::workflow::reproduction {

/// Gaussians of each direction in Table 2.3.
inline constexpr int kPrintedGaussians = 3;

/// A value of a table ("2.3") in the row of an axis, with + or − for one direction ("x+"); columns as in printed_tables.cpp. NaN
/// where nothing is printed.
double printed(std::string_view table, std::string_view of, std::size_t column);

/// Table 2.3 of an axis as a map, SI.
friction::Gaussian<double> printed_map(const std::string& axis);

}  // namespace stribeck::workflow::reproduction
