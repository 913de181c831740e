#pragma once
/// Inside of verify_report.hpp: verify_verdict.cpp has the verdict and its sentence, verify_scores.cpp tables and JSON, verify_report.cpp
/// drawings and the page.
/// Inside report only. Real time: no.

#include <cstddef>
#include <stribeck/report/html.hpp>
#include <stribeck/report/pages/verify_report.hpp>
#include <stribeck/report/shown_units.hpp>
#include <string>

namespace stribeck::report {

ShownUnits units_of(const VerifiedPart& part);
bool has_closed(const VerifiedPart& part);
/// Names of the models without their common folder: they differ at the end.
VerifyReportInput with_short_names(VerifyReportInput input);
std::string part_name(const VerifyReportInput& input, std::size_t i);
std::string model_color(std::size_t i);
Table score_table(const VerifiedPart& part);
/// The best models of a part, in words.
std::string summary(const VerifiedPart& part);
/// The verdict in one line.
std::string sentence(const Verdict& verdict, const VerifyReportInput& input);

}  // namespace stribeck::report
