#pragma once
/// Parts of the page, text and JSON of `evaluate`: the circular test after ISO 230-4, the causes.
///
/// Inside report only. Real time: no. Errors: none.

#include <nlohmann/json_fwd.hpp>
#include <stribeck/report/circle/circle_report.hpp>
#include <stribeck/report/html.hpp>
#include <string>

namespace stribeck::report {

std::string direction(const ident::circle::CircleTest& test);
/// "clockwise, rows line=9"; parts that do not distinguish circles are left out.
std::string circle_name(const CircleReportInput& input, std::size_t circle);
/// Head and unit of "servo time [clocks]".
Column column_of(const std::string& head);

/// A table with one row for each log that has a test; "" where none has.
std::string circular_test_text(const CircleReportInput& input);
void add_circular_test(Page& page, const CircleReportInput& input);
nlohmann::ordered_json circular_test_json(const ident::circle::CircularTest& test);

/// "backlash x"
std::string cause_name(const ident::circle::Diagnosis& diagnosis, const ident::circle::Cause& cause);
/// "x 90°"
std::string peak_name(const ident::circle::Diagnosis& diagnosis, const ident::circle::QuadrantPeak& peak);

/// The next step for a cause. What one direction alone does not tell for sure is not to be set right by it.
std::string next_step(const ident::circle::Diagnosis& diagnosis, const ident::circle::Cause& cause);

/// Table, next steps and remarks.
std::string causes_text(const std::string& label, const ident::circle::Diagnosis& diagnosis);
/// The largest causes in one line, for one log of several.
std::string causes_line(const std::string& label, const ident::circle::Diagnosis& diagnosis);
void add_causes(Page& page, const std::string& label, const ident::circle::Diagnosis& diagnosis,
                double radius);
nlohmann::ordered_json causes_json(const ident::circle::Diagnosis& diagnosis, double radius);

}  // namespace stribeck::report
