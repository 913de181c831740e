#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <cmath>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include <python/parts.hpp>
#include <stribeck/io/json.hpp>
#include <stribeck/report/table.hpp>
#include <stribeck/sim/metrics.hpp>
#include <stribeck/workflow/machine/drive_mode.hpp>
#include <stribeck/workflow/run/comparison.hpp>
#include <stribeck/workflow/traces.hpp>

namespace stribeck::python {
namespace {

using workflow::Comparison;

std::shared_ptr<Comparison> compare(const py::object& machine, const py::kwargs& given) {
  Keywords keywords("compare", given);
  workflow::ComparisonOptions o;
  o.machine = path_of(machine);
  o.experiment = keywords.word("experiment", workflow::experiment_ids());
  o.drive = keywords.word("drive", workflow::drive_modes());
  o.trials = trials_of(keywords, o.trials);
  o.seed = seed_of(keywords);
  o.threads = threads_of(keywords);
  o.speeds = keywords.quantities("speed", "m/s");
  o.controllers = keywords.paths("controller");
  o.only = keywords.texts("only");
  o.path = path_options(keywords);
  o.parameters = parameter_options(keywords);
  keywords.done();
  return unlocked([&] { return std::make_shared<Comparison>(workflow::run_comparison(o, interruptible())); });
}

/// The figure that JSON names so.
const sim::Figure& figure_of(const std::string& key) {
  std::vector<std::string> keys;
  for (const sim::Figure& f : sim::kFigures) {
    if (f.key == key) return f;
    keys.emplace_back(f.key);
  }
  Keywords::refuse_choice("figure", key, keys);
}

/// [speed, controller, trial], and [axis] where the figure has one value for each.
py::array_t<double> errors(const Comparison& c, const std::string& key) {
  const sim::Figure& figure = figure_of(key);
  const sim::CompareSpec& spec = c.result.spec;
  const bool of_axis = std::holds_alternative<sim::Figure::OfAxis>(figure.member);
  std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(spec.travels.size()),
                                 static_cast<py::ssize_t>(spec.controllers.size()),
                                 static_cast<py::ssize_t>(spec.trials)};
  const std::size_t each = of_axis ? c.result.axes.size() : 1;
  if (of_axis) shape.push_back(static_cast<py::ssize_t>(each));
  py::array_t<double> out(shape);
  double* at = out.mutable_data();
  for (const sim::CompareRow& row : c.result.rows) {
    for (std::size_t trial = 0; trial < spec.trials; ++trial) {
      for (std::size_t i = 0; i < each; ++i) {
        double value = std::numeric_limits<double>::quiet_NaN();
        if (trial < row.trials.size()) {
          const sim::Metrics& m = row.trials[trial];
          value = of_axis ? (m.*std::get<sim::Figure::OfAxis>(figure.member))[i]
                          : m.*std::get<sim::Figure::OfRun>(figure.member);
        }
        *at++ = value * figure.key_scale;
      }
    }
  }
  return out;
}

const sim::CompareRow& row_of(const Comparison& c, const std::string& controller, std::size_t speed) {
  const std::size_t speeds = c.result.spec.travels.size();
  if (speed >= speeds) refuse("motion", fmt::format("got {}, expected an index below {}", speed, speeds));
  std::vector<std::string> ids;
  for (const sim::CompareRow& row : c.result.rows) {
    if (row.travel != speed) continue;
    if (row.controller.id == controller) return row;
    ids.push_back(row.controller.id);
  }
  Keywords::refuse_choice("controller", controller, ids);
}

}  // namespace

void add_comparison(py::module_& module) {
  py::class_<Comparison, std::shared_ptr<Comparison>> c(
      module, "Comparison",
      "Errors of controllers on a virtual machine; str() gives the table of the command.");
  c.def_property_readonly(
      "controllers",
      [](const Comparison& self) {
        py::list out;
        for (const sim::ControllerSpec& one : self.result.spec.controllers) out.append(str_of(one.id));
        return out;
      },
      "list of str: ids of the controllers, in the order of errors().");
  c.def_property_readonly(
      "labels",
      [](const Comparison& self) {
        py::list out;
        for (const sim::ControllerSpec& one : self.result.spec.controllers) out.append(str_of(one.label));
        return out;
      },
      "list of str: what they are, in words.");
  c.def_property_readonly(
      "motions",
      [](const Comparison& self) {
        py::list out;
        for (const sim::Travel& one : self.result.spec.travels)
          out.append(str_of(one.name + ", " + one.pace_in_words()));
        return out;
      },
      "list of str: the motions (a path at a speed), in the order of errors().");
  c.def_property_readonly(
      "axes", [](const Comparison& self) { return list_of(self.result.axes); },
      "list of str: names of the axes.");
  c.def(
      "errors", &errors, py::arg("figure") = "max_contour_error_um",
      "errors($self, figure='max_contour_error_um')\n--\n\n"
      "A figure of merit of every run, in the unit of its name, as in the JSON (docs/reference/json.md).\n\n"
      "Returns an array [motion, controller, trial], with a fourth dimension [axis] for figures of axes; NaN where a controller could "
      "not be simulated. Raises InputError with all names for an unknown figure.");
  c.def(
      "trace",
      [](const Comparison& self, const std::string& controller, long long motion) {
        if (motion < 0)
          refuse("motion", fmt::format("got {}, expected the index of one of motions, from 0", motion));
        const sim::CompareRow& row = row_of(self, controller, static_cast<std::size_t>(motion));
        if (!row.refused.empty()) refuse("controller", controller + " was not simulated: " + row.refused);
        return workflow::as_log(self.result.axes, row.trace);
      },
      py::arg("controller"), py::arg("motion") = 0,
      "trace($self, controller, motion=0)\n--\n\nThe Log of the first trial: references, encoders, forces, contour error.");
  c.def(
      "to_dict", [](const Comparison& self) { return object_of(workflow::to_json(self)); },
      "to_dict($self)\n--\n\nThe same keys and numbers as `stribeck compare --json` writes, without \"made\".");
  c.def(
      "to_json", [](const Comparison& self) { return str_of(io::dump(workflow::to_json(self))); },
      "to_json($self)\n--\n\nto_dict() as text.");
  c.def("__str__", [](const Comparison& self) { return str_of(report::text_table(self.result)); });
  module.def(
      "compare", &compare, py::arg("machine"),
      "compare(machine, *, experiment=None, speed=None, trials=10, seed=1, threads=0, only=None, controller=None, drive=None, "
      "path=None, axes=None, size=None, laps=None, parameters='identified', axis_file=None, omega_t=None, omega_n=None, observer_pole=None, "
      "observer=None, error_rate=None, accuracy=None, acceleration=None, jerk=None, corner_tolerance=None, join=None)\n--\n\n"
      "Runs several controllers on a virtual machine.\n\n"
      "machine: machine file. speed [m/s] or text with a unit, one or a list. only: ids of controllers, [\"f\", \"h\"]. controller: "
      "further ones, built-in names or files. The others as the options of `stribeck compare`.\n"
      "Returns a Comparison. Ctrl-C ends it after the present run.\n"
      "Raises InputError for arguments and files, Refused where nothing can be simulated.");
}

}  // namespace stribeck::python
