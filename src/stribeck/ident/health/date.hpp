#pragma once
/// Dates of tests: the text 2026-11-23 and the number of days since 1970-01-01.
/// Real time: no.

#include <optional>
#include <string>
#include <string_view>

namespace stribeck::ident::health {

/// Absent: not a date of the calendar in this form.
std::optional<double> day_of(std::string_view date);
/// The date of the day that contains this time.
std::string date_of(double day);

}  // namespace stribeck::ident::health
