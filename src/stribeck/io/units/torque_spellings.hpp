#pragma once
/// Torques and inertias as data sheets and logs write them: together, with a hyphen, a dot or a blank. The library of units does not know them or takes them for a
/// mass at a distance ("in-lb" is no inch times a pound of mass). A new spelling is one line. Internal to io. Real time: no.

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>

namespace stribeck::io::detail {

/// Written with hyphens between the units, or together, and powers as plain digits; "lbs" stands as "lb".
inline constexpr std::array<std::pair<std::string_view, std::string_view>, 41> kTorques{{
    {"lb-in", "lbf in"},
    {"lbf-in", "lbf in"},
    {"in-lb", "lbf in"},
    {"in-lbf", "lbf in"},
    {"lb-ft", "lbf ft"},
    {"lbf-ft", "lbf ft"},
    {"ft-lb", "lbf ft"},
    {"ft-lbf", "lbf ft"},
    {"oz-in", "ozf in"},
    {"ozf-in", "ozf in"},
    {"in-oz", "ozf in"},
    {"in-ozf", "ozf in"},
    {"Ncm", "N cm"},
    {"N-cm", "N cm"},
    {"Nmm", "N mm"},
    {"mNm", "mN m"},
    {"kgf-cm", "kgf cm"},
    {"kgf-m", "kgf m"},
    {"oz-in-s2", "ozf in s2"},
    {"ozf-in-s2", "ozf in s2"},
    {"in-oz-s2", "ozf in s2"},
    {"in-lb-s2", "lbf in s2"},
    {"in-lbf-s2", "lbf in s2"},
    {"lb-in-s2", "lbf in s2"},
    {"lbf-in-s2", "lbf in s2"},
    {"lb-ft-s2", "lbf ft s2"},
    {"ft-lb-s2", "lbf ft s2"},
    {"oz-in2", "avoirdupois_ounce in2"},
    {"in2-oz", "avoirdupois_ounce in2"},
    {"lb-in2", "lb in2"},
    {"in2-lb", "lb in2"},
    {"lb-ft2", "lb ft2"},
    {"ft2-lb", "lb ft2"},
    {"kgm2", "kg m2"},
    {"kg-m2", "kg m2"},
    {"kgcm2", "kg cm2"},
    {"kg-cm2", "kg cm2"},
    {"kgmm2", "kg mm2"},
    {"kg-mm2", "kg mm2"},
    {"gcm2", "g cm2"},
    {"g-cm2", "g cm2"},
}};

/// "in·lbs" and "oz in s²" as the table has them.
inline std::string as_in_table(std::string_view unit) {
  std::string text(unit);
  constexpr std::array<std::pair<std::string_view, std::string_view>, 8> kWritten{{
      {"\u00B2", "2"},
      {"^2", "2"},
      {"\u00B7", "-"},
      {"*", "-"},
      {".", "-"},
      {" ", "-"},
      {"lbs", "lb"},
      {"sec", "s"},
  }};
  for (const auto& [written, plain] : kWritten) {
    for (auto at = text.find(written); at != std::string::npos; at = text.find(written, at + plain.size()))
      text.replace(at, written.size(), plain);
  }
  return text;
}

/// The torque or inertia that a spelling stands for; "" for others.
inline std::string_view torque_of(std::string_view unit) {
  const std::string text = as_in_table(unit);
  const auto found =
      std::find_if(kTorques.begin(), kTorques.end(), [&](const auto& t) { return t.first == text; });
  return found == kTorques.end() ? std::string_view() : found->second;
}

}  // namespace stribeck::io::detail
