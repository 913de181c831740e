#pragma once
/// Units without the units library, for where that library is not to be had (the page that computes in a browser). Same answers as
/// units_library.hpp for the units of machines and logs: SI with prefixes, min, h, deg, rev, %, ‰, inch, foot, pound, ounce, kgf, bar,
/// and their products, quotients and powers; others are unknown. A test compares both.
/// Internal to io. Threads: safe. Real time: no.

#include <stribeck/io/units/units_library.hpp>
#include <string_view>

namespace stribeck::io::detail {

UnitAnswer find_unit_in_table(std::string_view from, std::string_view to);

bool known_in_table(std::string_view text);

}  // namespace stribeck::io::detail
