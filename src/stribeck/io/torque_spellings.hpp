#pragma once
/// Torques and inertias as data sheets and logs write them: together or with a hyphen. The library of units does not know them or takes them for a
/// mass at a distance ("in-lb" is no inch times a pound of mass). A new spelling is one line. Internal to io. Real time: no.

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace stribeck::io::detail {

inline constexpr std::array<std::pair<std::string_view, std::string_view>, 58> kTorques{{
    {"lb-in", "lbf in"},
    {"lb in", "lbf in"},
    {"lbf-in", "lbf in"},
    {"in-lb", "lbf in"},
    {"in lb", "lbf in"},
    {"in-lbf", "lbf in"},
    {"lb-ft", "lbf ft"},
    {"lb ft", "lbf ft"},
    {"lbf-ft", "lbf ft"},
    {"ft-lb", "lbf ft"},
    {"ft lb", "lbf ft"},
    {"ft-lbf", "lbf ft"},
    {"Ncm", "N cm"},
    {"N-cm", "N cm"},
    {"kgf-cm", "kgf cm"},
    {"kgf-m", "kgf m"},
    {"oz-in", "ozf in"},
    {"oz in", "ozf in"},
    {"ozf-in", "ozf in"},
    {"oz-in-s2", "ozf in s2"},
    {"oz-in-sec2", "ozf in s2"},
    {"in-lb-s2", "lbf in s2"},
    {"lb-in-s2", "lbf in s2"},
    {"lb-in-sec2", "lbf in s2"},
    {"kgm2", "kg m2"},
    {"kgm²", "kg m2"},
    {"kgm^2", "kg m2"},
    {"kg-m2", "kg m2"},
    {"kgcm2", "kg cm2"},
    {"kgcm²", "kg cm2"},
    {"kg-cm2", "kg cm2"},
    {"kgmm2", "kg mm2"},
    {"kgmm²", "kg mm2"},
    {"kgcm^2", "kg cm2"},
    {"kgmm^2", "kg mm2"},
    {"gcm^2", "g cm2"},
    {"oz-in^2", "avoirdupois_ounce in2"},
    {"oz-in²", "avoirdupois_ounce in2"},
    {"oz in^2", "avoirdupois_ounce in2"},
    {"oz-in2", "avoirdupois_ounce in2"},
    {"lb-in^2", "lb in2"},
    {"lb-in²", "lb in2"},
    {"lb-in2", "lb in2"},
    {"lb-ft2", "lb ft2"},
    {"lb-ft^2", "lb ft2"},
    {"oz-in-s^2", "ozf in s2"},
    {"oz-in-sec^2", "ozf in s2"},
    {"lb-in-s^2", "lbf in s2"},
    {"in-lb-s^2", "lbf in s2"},
    {"lb-in-sec^2", "lbf in s2"},
    {"kg·m²", "kg m2"},
    {"kg·cm²", "kg cm2"},
    {"Nmm", "N mm"},
    {"mNm", "mN m"},
    {"kgf·cm", "kgf cm"},
    {"gcm2", "g cm2"},
    {"gcm²", "g cm2"},
    {"g-cm2", "g cm2"},
}};

/// The torque or inertia that a spelling stands for; "" for others.
inline std::string_view torque_of(std::string_view unit) {
  const auto found =
      std::find_if(kTorques.begin(), kTorques.end(), [&](const auto& t) { return t.first == unit; });
  return found == kTorques.end() ? std::string_view() : found->second;
}

}  // namespace stribeck::io::detail
