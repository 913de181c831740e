#pragma once
/// Controllers in words: every declared parameter that has an effect, with its value and unit. Made from fields(), so a new
/// parameter appears automatically.
/// Real time: no.

#include <stribeck/report/html.hpp>
#include <stribeck/sim/compare.hpp>
#include <string>
#include <utility>
#include <vector>

namespace stribeck::report {

/// "contouring control: kp 1600 1/s², kv 80 1/s". Absent parameters are left out.
std::string law_in_words(const control::LawParams& law);

/// Each law once, with the controllers that have it: "(a), (b)".
std::vector<std::pair<std::string, std::string>> laws_in_words(
    const std::vector<sim::ControllerSpec>& controllers);

/// One row for each controller, one column for each parameter outside the law that any of them uses.
Table controllers_in_words(const std::vector<sim::ControllerSpec>& controllers);

}  // namespace stribeck::report
