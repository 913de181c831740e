#pragma once
/// Travel until the axis slides, where the data determine it. The length with which the friction of a fit settles may be known beside
/// it, although the log does not resolve pre-sliding.
/// Real time: no.

#include <algorithm>
#include <limits>
#include <stribeck/ident/bristle/bristle_fit.hpp>
#include <stribeck/ident/result.hpp>
#include <string>

namespace stribeck::ident {

/// [m]; NaN: not determined.
inline double told_break_away(const Result& r) {
  const auto refused = [](const std::string& words) { return words.starts_with(bristle::kNotDeterminable); };
  const Parameter* distance = r.find("break_away_distance");
  const bool told = distance != nullptr ? distance->identifiable
                                        : std::none_of(r.cannot_tell.begin(), r.cannot_tell.end(), refused);
  return told ? r.break_away_distance : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace stribeck::ident
