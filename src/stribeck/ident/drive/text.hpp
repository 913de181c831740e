#pragma once
/// Text with numbers, for the notes of a fit. Inside ident only. Real time: no.

#include <cstdio>
#include <string>

namespace stribeck::ident::drive {

std::string text(const char* format, auto... values) {
  char buffer[320];
  std::snprintf(buffer, sizeof buffer, format, values...);
  return buffer;
}

}  // namespace stribeck::ident::drive
