#pragma once
/// Inside of frequency_report.hpp: numbers that text and page share.
/// Real time: no.

#include <stribeck/report/frequency/frequency_report.hpp>
#include <stribeck/report/html.hpp>
#include <string>

namespace stribeck::report {

/// "82.3 ± 0.4".
std::string with_half_width(double value, double half_width);

/// Mass, friction, delay, resonance with intervals.
Table plant_table(const FrequencyAxis& axis);
/// Present and proposed loops with their margins.
Table loop_table(const FrequencyAxis& axis);

inline constexpr double kPerTurn = 6.283185307179586;

}  // namespace stribeck::report
