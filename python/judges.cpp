#include <fmt/format.h>
#include <pybind11/pybind11.h>
#include <algorithm>
#include <nlohmann/json.hpp>

#include <python/parts.hpp>
#include <stribeck/report/circle/circle_change.hpp>
#include <stribeck/report/circle/circle_report.hpp>
#include <stribeck/report/pages/verify_report.hpp>
#include <stribeck/workflow/circle_logs.hpp>
#include <stribeck/workflow/judge/verify.hpp>

namespace stribeck::python {
namespace {

constexpr double kMostPercent = 1000.0;

/// Axis files and models, one or a list.
void add_given_models(const py::handle& models, workflow::VerifyOptions& out) {
  if (!py::isinstance<py::list>(models) && !py::isinstance<py::tuple>(models)) {
    if (py::isinstance<sim::AxisFile>(models)) {
      out.models.emplace_back(fmt::format("model {}", out.models.size() + 1),
                              py::cast<const sim::AxisFile&>(models));
    } else {
      out.axis_files.push_back(path_of(models));
    }
    return;
  }
  for (const py::handle& one : models) add_given_models(one, out);
}

Outcome verify(const py::object& models, const py::object& logs, const py::kwargs& given) {
  Keywords keywords("verify", given);
  workflow::VerifyOptions o;
  o.log = log_options(keywords);
  o.controller = keywords.path("controller");
  o.force_shift = keywords.quantity("force_shift", "s");
  o.limits.good = keywords.number("good", 0.0, kMostPercent).value_or(o.limits.good);
  o.limits.usable = keywords.number("usable", 0.0, kMostPercent).value_or(o.limits.usable);
  keywords.done();
  if (!(o.limits.good <= o.limits.usable))
    refuse("good",
           fmt::format("got {:g} %, expected at most usable, {:g} %", o.limits.good, o.limits.usable));
  add_given_models(models, o);
  if (o.axis_files.empty() && o.models.empty())
    refuse("models", "got none, expected axis files or models of identify");
  o.read = logs_of(logs, reading_with(o.log));
  o.logs = names_of(o.read);
  return unlocked([&] {
    const report::VerifyReportInput page = workflow::verify(o);
    return Outcome{report::to_json(page), report::text_table(page), std::nullopt, report::usable(page)};
  });
}

Outcome evaluate(const py::args& logs, const py::kwargs& given) {
  Keywords keywords("evaluate", given);
  workflow::CircleOptions o;
  if (const std::string size = keywords.quantity("size", "m"); !size.empty()) o.size = size;
  if (const std::string feed = keywords.quantity("feed", "m/s"); !feed.empty()) o.feeds = {feed};
  o.maps = keywords.texts("map");
  o.where = keywords.texts("where");
  o.labels = keywords.texts("label");
  o.limits = keywords.texts("limit", "m");
  o.together = keywords.flag("together", false);
  keywords.done();
  const std::vector<io::Log> read = logs_of(logs, workflow::read_circle_log);
  o.logs = names_of(read);
  return unlocked([&] {
    const report::CircleReportInput input = workflow::judge_circles(o, read);
    return Outcome{report::to_json(input), report::text_table(input), std::nullopt,
                   report::within_limits(input)};
  });
}

}  // namespace

void add_judges(py::module_& module) {
  module.def(
      "verify", &verify, py::arg("models"), py::arg("logs"),
      "verify(models, logs, *, axis=None, map=None, gain=None, lead=None, where=None, runs=None, sample_time=None, keep=None, "
      "map_file=None, controller=None, force_shift=None, good=None, usable=None)\n--\n\n"
      "Tests models on logs that were not used to identify them.\n\n"
      "models: axis files or AxisModel objects, one or a list. logs: files, Log objects or dicts of arrays, one or a list.\n"
      "controller: TOML file of the position controller of the log. force_shift [s]. good, usable: largest error of the force "
      "[%]. The others as of identify().\n"
      "Returns a Result; ok is False where no model is usable.\n"
      "Raises InputError for files and arguments, Refused where no part of the log can be replayed.");
  module.def(
      "evaluate", &evaluate,
      "evaluate(*logs, size=None, feed=None, map=None, where=None, label=None, limit=None, together=False)\n--\n\n"
      "Circular test of measured circles after ISO 230-4, and the causes of their deviation.\n\n"
      "logs: files, Log objects or dicts of arrays {\"t\": t, \"x\": x, \"y\": y} in SI, with rx, ry (commanded) where known, or "
      "angle [rad] and radius [m] (or deviation [m]) of a ball-bar; t may be left out.\n"
      "size: commanded radius, \"50 mm\" or in m; left out: what the file of a ball-bar states, else that of the commanded or measured circle. feed: of logs without "
      "times, \"1000 mm/min\" or in m/s. map: {\"x\": \"COLUMN mm\"}. where: rows of one circle, {\"line\": 7}. "
      "limit: {\"G\": \"10 um\"}, or in m. together: the logs are of one machine.\n"
      "Returns a Result: result[\"logs\"][0][\"circular_test\"] has G, G(b), F, D and H; ok is False where a limit is broken.\n"
      "Raises InputError for logs without a circle of this size.");
}

}  // namespace stribeck::python
