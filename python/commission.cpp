#include <fmt/format.h>
#include <pybind11/pybind11.h>
#include <filesystem>
#include <nlohmann/json.hpp>

#include <python/parts.hpp>
#include <stribeck/io/output_folder.hpp>
#include <stribeck/report/commission/commission_report.hpp>
#include <stribeck/report/health/health_report.hpp>
#include <stribeck/workflow/health/health.hpp>
#include <stribeck/workflow/stages/stages.hpp>

namespace stribeck::python {
namespace {

constexpr double kMostPercent = 1000.0;

Outcome commission(const py::object& machine, const py::object& logs, const py::object& output,
                   const py::kwargs& given) {
  Keywords keywords("commission", given);
  workflow::StageOptions o;
  o.machine = path_of(machine, "machine");
  o.folder = path_of(logs, "logs");
  o.output = path_of(output, "output");
  o.log = log_options(keywords);
  o.limits.good = keywords.number("good", 0.0, kMostPercent).value_or(o.limits.good);
  o.limits.usable = keywords.number("usable", 0.0, kMostPercent).value_or(o.limits.usable);
  o.version = STRIBECK_VERSION;
  keywords.done();
  return unlocked([&] {
    const io::OutputFolder folder(o.output);
    const report::CommissionReportInput found = workflow::commission_from_logs(o);
    return Outcome{report::to_json(found), report::text_table(found), std::nullopt, found.ready()};
  });
}

Outcome health(const py::object& machine, const py::args& logs, const py::kwargs& given) {
  Keywords keywords("health", given);
  workflow::HealthOptions o;
  o.machine = path_of(machine, "machine");
  for (const py::handle& log : logs) {
    for (std::string& path : paths_of(log, "logs")) o.logs.push_back(std::move(path));
  }
  const std::string archive = keywords.path("archive");
  if (archive.empty()) refuse("archive", "missing, expected the folder of the tests");
  o.log = log_options(keywords);
  o.date = keywords.text("date");
  o.temperature = keywords.number("temperature", -50.0, 150.0);
  o.circles = keywords.paths("circle");
  o.size = keywords.quantity("size", "m");
  o.turn = keywords.quantity("turn", "m");
  o.since = keywords.text("since");
  o.limits = {0.01 * keywords.number("limit", 1.0, kMostPercent).value_or(10.0),
              0.01 * keywords.number("drift_limit", 1.0, kMostPercent).value_or(25.0)};
  keywords.done();
  workflow::check_health_options(o);
  workflow::check_archive(o, archive);
  return unlocked([&] {
    const io::OutputFolder folder(archive);
    const workflow::ArchiveFolder tests(archive);
    report::HealthReportInput page = workflow::check_health(o, tests);
    page.command = "stribeck.health()";
    page.version = STRIBECK_VERSION;
    return Outcome{report::to_json(page), report::text_table(page), std::nullopt, !page.changed()};
  });
}

}  // namespace

void add_commission(py::module_& module) {
  module.def(
      "commission", &commission, py::arg("machine"), py::arg("logs"), py::arg("output"),
      "commission(machine, logs, output, *, good=None, usable=None, axis=None, map=None, gain=None, lead=None, where=None, "
      "runs=None, sample_time=None, keep=None, map_file=None)\n--\n\n"
      "From a folder of logs to verified axis files: what they determine, what to record next.\n\n"
      "machine: machine file. logs: folder of the logs, of any axes. output: folder for AXIS.toml of each verified axis, and for the "
      "state of this call. good, usable: largest error of the force [%]. The others as of identify().\n"
      "Returns a Result; ok is False where an axis is not ready.\n"
      "Raises InputError for files and arguments.");
  module.def(
      "health", &health, py::arg("machine"),
      "health(machine, *logs, archive, date=None, temperature=None, circle=None, size=None, turn=None, since=None, limit=10, "
      "drift_limit=25, axis=None, map=None, gain=None, lead=None, where=None, runs=None, sample_time=None, keep=None, map_file=None)"
      "\n--\n\n"
      "Adds the logs of a repeated motion to an archive, and tells changes from scatter and seasons.\n\n"
      "logs: files of today's test, of any axes; none: the trend of the archive alone. archive: folder of the tests. date: "
      "\"2026-11-23\". temperature [°C]. circle: logs of a circle, with size [m]. turn [m]: of the screw. since: first day that counts. "
      "limit, drift_limit: smallest step and slow change that matter [%]. The others as of identify().\n"
      "Returns a Result; ok is False where something changed.\n"
      "Raises InputError for files and arguments.");
}

}  // namespace stribeck::python
