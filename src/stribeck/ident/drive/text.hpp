#pragma once
/// Text with numbers, for the notes of a fit, in the format of printf. Inside ident only. Real time: no.

#include <fmt/printf.h>

#include <string>

namespace stribeck::ident::drive {

/// Not std::snprintf: it writes a decimal comma where the program has such a locale.
std::string text(const char* format, auto... values) { return fmt::sprintf(format, values...); }

}  // namespace stribeck::ident::drive
