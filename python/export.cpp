#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pybind11/pybind11.h>
#include <nlohmann/json.hpp>

#include <python/parts.hpp>
#include <stribeck/control/compensation/compensation_settings.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/targets/target.hpp>

namespace stribeck::python {
namespace {

Outcome export_files(const py::object& files, const std::string& to, const py::object& output,
                     const py::kwargs& given) {
  Keywords keywords("export", given);
  const targets::Target* target = targets::find_target(to);
  if (target == nullptr) {
    std::vector<std::string> names;
    for (const targets::Target& t : targets::all_targets()) names.emplace_back(t.name);
    Keywords::refuse_choice("to", to, names);
  }
  targets::ExportRequest o;
  o.files = paths_of(files, "files");
  if (o.files.empty()) refuse("files", "got none, expected axis files or one machine file");
  o.output = path_of(output, "output");
  o.names = keywords.texts("name");
  o.omega = keywords.quantity("omega", "rad/s");
  const std::vector<std::string> forms{kEnumWords<control::Feedforward>.begin(),
                                       kEnumWords<control::Feedforward>.end()};
  o.feedforward = keywords.word("feedforward", forms);
  o.lincurve = keywords.flag("lincurve", false);
  o.speed = keywords.quantity("speed", "m/s");
  o.parameters = keywords.word("parameters", {"identified", "commissioning"});
  o.axis_files = keywords.texts("axis_file");
  o.gain = keywords.text("gain");
  o.lead = keywords.quantity("lead", "m");
  o.resolution = keywords.quantity("resolution", "m");
  o.zero = keywords.quantity("zero", "m");
  o.controller = keywords.path("controller");
  o.machine = keywords.path("machine");
  o.period = keywords.quantity("period", "s");
  o.size = keywords.quantity("size", "m");
  o.command = fmt::format("stribeck.export() from {}, to {}", fmt::join(o.files, ", "), to);
  keywords.done();
  return unlocked([&] {
    io::check_distinct(targets::inputs_of(o), {o.output});
    const std::string notes = targets::axis_notes(o);
    targets::Exported written = target->write(o);
    return Outcome{std::move(written.json), written.text + notes, std::nullopt, true};
  });
}

}  // namespace

void add_export(py::module_& module) {
  module.def(
      "export", &export_files, py::arg("files"), py::arg("to"), py::arg("output"),
      "export(files, to, output, *, name=None, omega=None, feedforward=None, lincurve=False, speed=None, parameters=None, "
      "axis_file=None, gain=None, lead=None, resolution=None, zero=None, controller=None, machine=None, period=None, size=None)"
      "\n--\n\n"
      "Writes identified parameters in the format of another program.\n\n"
      "files: axis files of identify(), or one machine file for a LinuxCNC configuration. to: the program or control, e.g. "
      "\"sinumerik\", \"cia402\", \"csv\"; an unknown word lists all. output: file, or folder for \"all\". gain: force of one unit of the "
      "control, \"12.5 N/%\". lead, resolution, zero, size [m], speed [m/s], period [s], omega [rad/s]. The others as the options of "
      "`stribeck export` (docs/guides/export.md).\n"
      "Returns a Result with the error of the export.\n"
      "Raises InputError for files and arguments, and where the target cannot express the model.");
}

}  // namespace stribeck::python
