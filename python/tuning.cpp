#include <pybind11/pybind11.h>
#include <nlohmann/json.hpp>

#include <python/parts.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/output_folder.hpp>
#include <stribeck/report/pages/tune_report.hpp>
#include <stribeck/sim/experiments.hpp>
#include <stribeck/workflow/run/comparison.hpp>
#include <stribeck/workflow/run/tuning.hpp>

namespace stribeck::python {
namespace {

Outcome tune(const py::object& machine, const py::kwargs& given) {
  Keywords keywords("tune", given);
  workflow::TuneOptions o;
  o.experiment = keywords.word("experiment", workflow::experiment_ids());
  o.controllers = keywords.paths("controller");
  o.speeds = keywords.quantities("speed", "m/s");
  o.trials = trials_of(keywords, o.trials);
  o.seed = seed_of(keywords);
  o.threads = threads_of(keywords);
  o.phase_margin = keywords.number("phase_margin", 1.0, 90.0).value_or(o.phase_margin);
  o.gain_margin = keywords.number("gain_margin", 0.1, 40.0).value_or(o.gain_margin);
  o.delay_margin = keywords.number("delay_margin", 0.0, 100.0).value_or(o.delay_margin);
  o.input_variation = keywords.quantity("input_variation", "V");
  o.axial_mode = keywords.quantity("axial_mode", "Hz");
  o.evaluations = static_cast<int>(keywords.whole("evaluations", 10, 100000).value_or(o.evaluations));
  o.path = path_options(keywords);
  const workflow::ParameterOptions origin = parameter_options(keywords);
  const std::string out = keywords.path("output");
  keywords.done();
  const std::string file = path_of(machine, "machine");
  return unlocked([&] {
    workflow::Tuning t = workflow::plan_tuning(o, origin, file);
    io::check_distinct(workflow::inputs_of(o, origin, file), workflow::tuned_files(t, out, "output"));
    const bool folder = !out.empty() && !workflow::is_controller_file(out);
    const io::OutputFolder made = folder ? io::OutputFolder(out) : io::OutputFolder();
    if (!folder) io::check_writable(out);
    workflow::run_tuning(t, interruptible());
    workflow::write_tuned(t, out, STRIBECK_VERSION);
    const std::string none = workflow::missed(t);
    std::string text = workflow::text_of(t);
    if (!none.empty()) text += none + '\n';
    return Outcome{report::to_json(t.result, t.spec), std::move(text), std::nullopt, none.empty()};
  });
}

}  // namespace

void add_tuning(py::module_& module) {
  module.def(
      "tune", &tune, py::arg("machine"),
      "tune(machine, *, controller=None, experiment=None, speed=None, output=None, trials=10, seed=1, threads=0, "
      "phase_margin=45, gain_margin=6, delay_margin=1, input_variation=None, axial_mode=None, evaluations=300, path=None, axes=None, size=None, "
      "laps=None, parameters='identified', axis_file=None, omega_t=None, omega_n=None, observer_pole=None, observer=None, "
      "error_rate=None, accuracy=None, acceleration=None, jerk=None, corner_tolerance=None, join=None)\n--\n\n"
      "Finds the best gains of each controller within limits of stability margin and input variation.\n\n"
      "machine: file of a virtual machine. controller: ids, built-in names or files, one or a list. output: folder for one ID.toml "
      "each, or FILE.toml for a single controller. phase_margin [deg], gain_margin [dB], delay_margin [control periods], "
      "input_variation [V], axial_mode [Hz], speed [m/s]. The others as the options of `stribeck tune`.\n"
      "Returns a Result; ok is False where a controller has no gains within the limits. Ctrl-C ends it after the present run.\n"
      "Raises InputError for arguments and files, Refused where nothing can be simulated.");
}

}  // namespace stribeck::python
