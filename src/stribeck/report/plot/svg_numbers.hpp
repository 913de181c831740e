#pragma once
/// Numbers of drawings, in tenths of a pixel.
/// Real time: no. Errors: none.

#include <cstdlib>
#include <string>

namespace stribeck::report {

/// "12.5" of 125, ".3" of 3, "-7" of −70.
inline std::string of_tenths(long tenths) {
  std::string out = tenths < 0 ? "-" : "";
  const long size = std::abs(tenths);
  if (size >= 10 || size == 0) out += std::to_string(size / 10);
  if (size % 10 != 0) (out += '.') += static_cast<char>('0' + size % 10);
  return out;
}

/// A number of a path behind another one: a minus separates them as well as a blank.
inline void append_tenths(std::string& out, long tenths) {
  if (tenths >= 0) out += ' ';
  out += of_tenths(tenths);
}

}  // namespace stribeck::report
