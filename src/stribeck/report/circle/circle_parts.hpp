#pragma once
/// Parts of the page, text and JSON of `evaluate`: the circular test after ISO 230-4.
///
/// Inside report only. Real time: no. Errors: none.

#include <nlohmann/json_fwd.hpp>
#include <stribeck/report/circle/circle_report.hpp>
#include <stribeck/report/html.hpp>
#include <string>

namespace stribeck::report {

/// A table with one row for each log that has a test; "" where none has.
std::string circular_test_text(const CircleReportInput& input);
void add_circular_test(Page& page, const CircleReportInput& input);
nlohmann::ordered_json circular_test_json(const ident::circle::CircularTest& test);

}  // namespace stribeck::report
