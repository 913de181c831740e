#pragma once
/// What the units library udunits2 says of two unit texts. Internal to io. Threads: safe. Real time: no.

#include <stribeck/io/units.hpp>
#include <string_view>

namespace stribeck::io::detail {

enum class UnitVerdict { kGood, kUnknownUnit, kWrongDimension };

struct UnitAnswer {
  UnitVerdict verdict;
  Conversion conversion{};
};

/// The conversion from a unit as people write it to a unit of the program. Throws where the database of the library is missing.
UnitAnswer find_unit(std::string_view from, std::string_view to);

bool known_unit(std::string_view text);

/// A factor of conversion, taken for the power of ten that it is up to rounding.
Conversion conversion_by(double factor);

/// The text without blanks and ends of lines around it.
std::string_view without_blanks(std::string_view text);

}  // namespace stribeck::io::detail
