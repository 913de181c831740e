#pragma once
/// Unit texts as people type them, made into those that a units library reads. Internal to io. Real time: no.

#include <algorithm>
#include <stribeck/io/units/torque_spellings.hpp>
#include <stribeck/io/units/units_library.hpp>
#include <string>
#include <string_view>

namespace stribeck::io::detail {

/// The text to read; "" where it is no proportional unit: a date, an offset or a logarithm.
inline std::string readable_unit(std::string_view text) {
  std::string unit(without_blanks(text));
  const auto replace_all = [&](std::string_view what, std::string_view by) {
    for (auto at = unit.find(what); at != std::string::npos; at = unit.find(what, at + by.size()))
      unit.replace(at, what.size(), by);
  };
  replace_all("\u22C5", "\u00B7");  // dot operator, as typed on some keyboards
  for (const char* written : {"\u2030", "per mille"}) replace_all(written, "permille");
  // "8 in-lb", and of a torque constant "3 oz-in/A".
  const auto divided = std::min(unit.find('/'), unit.size());
  if (const auto torque = torque_of(without_blanks(std::string_view(unit).substr(0, divided)));
      !torque.empty())
    unit.replace(0, divided, torque);
  return unit.find_first_of("@:;,\"'") == std::string::npos ? unit : std::string();
}

}  // namespace stribeck::io::detail
