#pragma once
/// Text with numbers, for the notes of a fit. Inside ident only. Real time: no.

#include <cstdio>
#include <string>

namespace stribeck::ident::drive {

std::string text(const char* format, auto... values) {
  std::string out(static_cast<std::size_t>(std::snprintf(nullptr, 0, format, values...)), ' ');
  std::snprintf(out.data(), out.size() + 1, format, values...);
  return out;
}

}  // namespace stribeck::ident::drive
