#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pybind11/pybind11.h>
#include <limits>
#include <nlohmann/json.hpp>

#include <python/parts.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/report/table.hpp>
#include <stribeck/sim/experiments.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <stribeck/workflow/option.hpp>
#include <stribeck/workflow/run/axis_excitation.hpp>
#include <stribeck/workflow/run/axis_run.hpp>
#include <stribeck/workflow/run/path_run.hpp>

namespace stribeck::python {
namespace {

constexpr std::int64_t kMostRepeats = 1000;

std::optional<int> count(Keywords& keywords, const char* name) {
  const auto given = keywords.whole(name, 1, kMostRepeats);
  return given ? std::optional<int>(static_cast<int>(*given)) : std::nullopt;
}

Outcome excite(const py::object& machine, const std::string& method, const std::string& axis,
               const py::kwargs& given) {
  using Method = ident::excitation::ExcitationMethod;
  Keywords keywords("excite", given);
  workflow::ExcitationOptions o;
  const auto known = enum_value<Method>(method);
  if (!known)
    Keywords::refuse_choice("method", method, {kEnumWords<Method>.begin(), kEnumWords<Method>.end()});
  o.method = *known;
  o.periods = count(keywords, "periods");
  o.repeats = count(keywords, "repeats");
  o.speeds = keywords.quantities("speeds", "m/s");
  o.lead = keywords.quantity("lead", "m");
  o.rise = keywords.quantity("rise", "s");
  o.known = keywords.path("known");
  keywords.done();
  const std::string file = path_of(machine);
  return unlocked([&] {
    workflow::check_excitation(o);
    workflow::AxisExcitation e = workflow::excite_axis(o, file, axis);
    e.log.source = "excitation of axis " + axis;
    std::string text = fmt::format("{}\nSafety: it {}.\n", e.excitation.says, fmt::join(e.notes, "; "));
    return Outcome{workflow::to_json(e), std::move(text), std::move(e.log), true};
  });
}

/// One axis along a reference.
Outcome along_reference(const std::string& machine, const std::string& axis, const py::object& reference,
                        std::uint64_t seed) {
  if (axis.empty()) refuse("axis", "missing, expected the axis that the reference is for");
  const std::vector<io::Log> tables =
      logs_of(reference, [](const std::string& path) { return io::read_csv(path); });
  if (tables.size() != 1) refuse("reference", fmt::format("got {}, expected one", tables.size()));
  return unlocked([&] {
    workflow::AxisRun run =
        workflow::run_axis(workflow::read_virtual_machine(machine, {}, workflow::AxisWithoutTruth::kLeftOut),
                           machine, axis, tables.front(), seed);
    run.log.source = "simulation of axis " + axis;
    return Outcome{
        workflow::to_json(run),
        fmt::format("{:.6g} s of axis {} ({} rows).\n", run.recording.t.back(), axis, run.log.rows),
        std::move(run.log), !run.end_stop};
  });
}

Outcome simulate(const py::object& machine, const py::object& reference, const py::kwargs& given) {
  Keywords keywords("simulate", given);
  const std::string file = path_of(machine);
  const std::uint64_t seed = seed_of(keywords);
  if (!reference.is_none()) {
    const std::string axis = keywords.text("axis");
    keywords.done();
    return along_reference(file, axis, reference, seed);
  }
  workflow::PathRunOptions o;
  o.seed = seed;
  o.trial = static_cast<std::uint32_t>(
      keywords.whole("trial", 0, std::numeric_limits<std::uint32_t>::max() - 1).value_or(0));
  std::vector<std::string> ids;
  for (const sim::Experiment& e : sim::experiments()) ids.push_back(e.id);
  o.run.experiment = keywords.word("experiment", ids);
  o.run.speed = keywords.quantity("speed", "m/s");
  o.run.controller = keywords.path("controller");
  o.run.path = path_options(keywords);
  o.parameters = parameter_options(keywords);
  keywords.done();
  return unlocked([&] {
    workflow::PathRun run = workflow::run_path(
        o,
        workflow::read_virtual_machine(file, o.parameters.axis_files, workflow::AxisWithoutTruth::kLeftOut),
        file);
    run.log.source = "simulation";
    return Outcome{workflow::to_json(run), report::text_table(run.result), std::move(run.log), true};
  });
}

}  // namespace

void add_runs(py::module_& module) {
  module.def(
      "excite", &excite, py::arg("machine"), py::arg("method"), py::arg("axis"),
      "excite(machine, method, axis, *, periods=None, repeats=None, speeds=None, lead=None, rise=None, known=None)\n--\n\n"
      "Designs a motion or force whose log determines friction and mass of an axis.\n\n"
      "machine: machine file. method: pulses, ramp (forces), jog, sine, position-sine, constant-acceleration, multisine (positions).\n"
      "periods, repeats: int. speeds [m/s], lead [m], rise [s]: numbers, or text with a unit. known: axis file.\n"
      "Returns a Result; its log has t [s] and r [m], or f [N] and what the drive takes; log.save() writes it for simulate.\n"
      "Raises InputError for arguments and machine file, Refused where no excitation is safe.");
  module.def(
      "simulate", &simulate, py::arg("machine"), py::arg("reference") = py::none(),
      "simulate(machine, reference=None, *, axis=None, controller=None, experiment=None, speed=None, path=None, axes=None, size=None, "
      "laps=None, parameters='identified', axis_file=None, seed=1, trial=0, omega_t=None, omega_n=None, observer_pole=None, "
      "observer=None, error_rate=None, accuracy=None, acceleration=None, jerk=None, corner_tolerance=None, join=None)\n--\n\n"
      "One run of a virtual machine.\n\n"
      "reference: what excite gave (Log, dict of arrays, file) for the axis `axis`; left out: along a path.\n"
      "controller: id, built-in name or file. path: circle, eight, trifolium, a G-code file or a CSV of points. speed [m/s], "
      "size [m]. axis_file: {\"x\": \"x.toml\"} in place of an identification. The others as the options of `stribeck simulate`.\n"
      "Returns a Result; its log has the samples in SI: of an axis t, r, x, u, f as a control would log them, of a path "
      "references, encoders, forces of all axes and the contour error; ok is False where the axis ran into an end stop.\n"
      "Raises InputError for arguments and files, Refused where the run would mean nothing.");
}

}  // namespace stribeck::python
