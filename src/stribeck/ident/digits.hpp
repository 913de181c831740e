#pragma once
/// Numbers in sentences.
///
/// Real time: no.

#include <fmt/core.h>

#include <cmath>
#include <string>

namespace stribeck::ident {

/// A finite number with `count` significant digits, without an exponent from 1e-5 to below 1e9; digits before the point are all
/// shown: 0.0123, 12.3, 12345. What is not finite is a dash.
inline std::string digits(double value, int count = 3) {
  if (!std::isfinite(value)) return "–";
  if (value == 0.0) return "0";
  const int exponent = static_cast<int>(std::floor(std::log10(std::abs(value))));
  if (exponent < -5 || exponent > 8) return fmt::format("{:.{}e}", value, count - 1);
  return fmt::format("{:.{}f}", value, exponent >= count ? 0 : count - 1 - exponent);
}

}  // namespace stribeck::ident
