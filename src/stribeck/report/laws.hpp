#pragma once
/// Control laws in words: every declared parameter with its value and unit.
/// Real time: no.

#include <stribeck/sim/compare.hpp>
#include <string>

namespace stribeck::report {

/// "contouring control: kp 1600 1/s2, kv 80 1/s".
std::string law_in_words(const control::LawParams& law);

}  // namespace stribeck::report
