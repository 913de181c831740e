#pragma once
/// The health of a machine: table, JSON, page.
///
///   json   {"schema": "stribeck.health/1", "machine", "archive", "changed", "added": [file], "limits": {"step_percent",
///           "drift_percent"}, "axes": [{"axis", "tests", "first", "last", "changed", "numbers": [{"number", "from_mm", "to_mm",
///           "unit", "reference", "now", "change_percent", "change_half_width_percent", "scatter_percent", "per_degree_percent",
///           "status"}], "changes": [{"kind", "date", "earliest", "latest", "probability", "beyond_limit", "undone", "restores", "restores_part", "effects":
///           [{"number", "from_mm", "to_mm", "percent", "half_width_percent", "counts"}], "causes": [{"what", "why", "next"}]}],
///           "motion": [command]}], "remarks"}
///
/// Real time: no. Errors: io::InputError of files and of gnuplot.

#include <nlohmann/json_fwd.hpp>
#include <stribeck/ident/health/findings.hpp>
#include <stribeck/report/page/output.hpp>
#include <string>
#include <vector>

namespace stribeck::report {

struct HealthAxis {
  std::string name;  ///< of the axis, or "circle"
  ident::health::Health health;
  std::vector<ident::health::HealthTest> tests;  ///< those that count, ascending in time
  std::vector<std::string> motion;               ///< commands that design it; none for a circle
};

struct HealthReportInput {
  std::string machine;
  std::string archive;
  std::vector<std::string> added;  ///< files of the archive that this command wrote
  ident::health::Limits limits;
  std::vector<HealthAxis> axes;
  std::vector<std::string> remarks;
  std::string command;
  std::string version;
  std::vector<InputFile> inputs = {};  ///< machine file and logs of today

  [[nodiscard]] bool changed() const noexcept {
    for (const HealthAxis& a : axes) {
      if (a.health.changed()) return true;
    }
    return false;
  }
};

std::string text_table(const HealthReportInput& input);
nlohmann::ordered_json to_json(const HealthReportInput& input);
std::string health_report(const HealthReportInput& input);
/// Writes index.html, and the parts of the page where a folder for them is given.
void write_health_report(const PageFolders& folders, const HealthReportInput& input);

/// Name of a number for people: "friction, 40 to 60 mm".
std::string name_of(const ident::health::Channel& channel);
/// Unit in which it is shown, and that unit per SI.
struct HealthUnit {
  std::string name;
  double per_si = 1.0;
};
HealthUnit unit_of(const ident::health::Channel& channel);

}  // namespace stribeck::report
