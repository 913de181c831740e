#pragma once
/// The output of an identification: JSON for programs, tables for people.
/// Real time: no.

#include <nlohmann/json_fwd.hpp>
#include <stribeck/report/pages/identify_report.hpp>
#include <stribeck/workflow/identify.hpp>
#include <string>

namespace stribeck::workflow {

/// The result (report/json.hpp), with the figures of single methods: "published", "peaks", "beside", …
nlohmann::ordered_json to_json(const Identification& found, const std::string& axis);

/// Tables of the result and of those beside it, then the figures of single methods.
std::string text_of(const Identification& found, const std::string& axis);

/// The page of the result; the caller adds command, version and inputs.
report::IdentifyReportInput page_of(const Identification& found, const AxisRecords& axis);

}  // namespace stribeck::workflow
