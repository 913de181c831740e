#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include <apps/cli/commands.hpp>
#include <apps/cli/expected.hpp>
#include <apps/cli/option_groups.hpp>
#include <apps/cli/shared.hpp>
#include <apps/cli/trace_page.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/report/json.hpp>
#include <stribeck/report/table.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/sim/experiments.hpp>
#include <stribeck/workflow/built_in.hpp>
#include <stribeck/workflow/option.hpp>
#include <stribeck/workflow/parameters.hpp>
#include <stribeck/workflow/part_program.hpp>
#include <stribeck/workflow/path_options.hpp>

namespace stribeck::cli {
namespace {

struct Options {
  Common common;
  std::string machine;
  std::string output;
  std::uint64_t seed = 1;
  // along a path
  std::string controller;  ///< empty: the product's default
  std::string experiment;
  PathOptions path;
  std::string speed;  ///< empty: 9.5 mm/s
  std::uint32_t trial = 0;
  ParameterOptions parameters;
  // one axis along a reference
  std::string reference;
  std::string axis;
};

/// Plays a file that excite wrote.
int play_reference(const Options& o, const sim::Machine& machine) {
  if (o.axis.empty()) refuse_option("--axis", "missing, expected the axis that --reference is for");
  const std::size_t axis = axis_index(machine, o.machine, o.axis);
  const io::Log table = io::read_csv(o.reference);
  const auto column = [&](std::string_view name, const Quantity& q) {
    const io::Column* c = table.find(name);
    return c == nullptr ? std::vector<double>{} : io::in_si(*c, q);
  };
  const std::vector<double> t = io::in_si(table.at("t"), quantity("s", "s"));
  const io::TimeCheck time = io::check_time(t, o.reference);
  const double period = machine.sample_time;
  if (!time.regular() || std::abs(time.sample_time - period) > 1e-6 * period) {
    throw io::InputError(
        {o.reference, 0, "t",
         fmt::format("steps of {:.6g} ms, expected the control period of the machine, {:.6g} ms, throughout",
                     time.sample_time * 1e3, period * 1e3)});
  }
  const std::vector<double> r = column("r", quantity("m", "mm"));
  std::vector<double> f = column("f", quantity("N", "N"));
  if (f.empty()) {
    f = column("u", quantity("V", "V"));
    for (double& v : f) v *= machine.axes[axis].second.plant.force_gain();
  }
  if (r.empty() && f.empty()) {
    throw io::InputError(
        {o.reference,
         0,
         {},
         "neither r (closed loop) nor f or u (open loop) among the columns (write one with excite)"});
  }
  const auto& limits = machine.axes[axis].second.limits;
  for (std::size_t k = 0; k < r.size(); ++k) {
    if (r[k] < limits.travel_min || r[k] > limits.travel_max) {
      throw io::InputError({o.reference, 0, "r",
                            fmt::format("row {}: {:.6g} mm is outside the travel, {:.6g} to {:.6g} mm", k + 1,
                                        r[k] * 1e3, limits.travel_min * 1e3, limits.travel_max * 1e3)});
    }
  }
  const sim::Recording recording = play(machine, axis, r, r.empty() ? f : std::vector<double>{}, o.seed);
  io::Log log = as_log(recording);
  log.metadata = {{"machine", machine.name}, {"axis", o.axis}, {"seed", std::to_string(o.seed)}};
  io::write_csv(o.output, log);
  report_log(o.common.report, log, fmt::format("Axis {} of {}", o.axis, machine.name),
             fmt::format("{:.6g} s, as a control would log it", recording.t.back()));
  write_json(o.common.json, {{"schema", "stribeck.simulate/1"},
                             {"machine", machine.name},
                             {"axis", o.axis},
                             {"seed", o.seed},
                             {"rows", log.rows},
                             {"duration_s", recording.t.back()}});
  say(o.common,
      fmt::format("{:.6g} s of axis {} in {} ({} rows).\n", recording.t.back(), o.axis, o.output, log.rows));
  return 0;
}

io::Log as_log(const std::vector<std::string>& axes, const std::vector<sim::ContourSample>& trace) {
  io::Log log;
  log.rows = trace.size();
  const auto add = [&](const std::string& name, const char* unit, double scale, auto&& get) {
    io::Column column{name, unit, {}};
    column.values.reserve(trace.size());
    for (const sim::ContourSample& s : trace) column.values.push_back(get(s) / scale);
    log.columns.push_back(std::move(column));
  };
  using S = sim::ContourSample;
  add("t", "s", 1.0, [](const S& s) { return s.time; });
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const std::string& axis = axes[i];
    add("r_" + axis, "mm", 1e-3, [i](const S& s) { return s.reference[i]; });
    add("x_" + axis, "mm", 1e-3, [i](const S& s) { return s.encoder[i]; });
    add("table_" + axis, "mm", 1e-3, [i](const S& s) { return s.position[i]; });
    add("u_" + axis, "V", 1.0, [i](const S& s) { return s.voltage[i]; });
    add("f_" + axis, "N", 1.0, [i](const S& s) { return s.force[i]; });
    add("friction_" + axis, "N", 1.0, [i](const S& s) { return s.friction[i]; });
  }
  add("contour_error", "um", 1e-6, [](const S& s) { return s.contour_error; });
  return log;
}

/// For the page, errors first: on a drawing of positions they cannot be seen.
io::Log errors_first(const io::Log& log, const std::vector<std::string>& axes) {
  io::Log shown = log;
  const io::Column contour = std::move(shown.columns.back());
  shown.columns.pop_back();
  std::vector<io::Column> errors{contour};
  for (const std::string& axis : axes) {
    io::Column e{"e_" + axis, "um", {}};
    const io::Column& r = log.at("r_" + axis);
    const io::Column& table = log.at("table_" + axis);
    for (std::size_t k = 0; k < log.rows; ++k) e.values.push_back(1e3 * (table.values[k] - r.values[k]));
    errors.push_back(std::move(e));
  }
  // The error of one axis is its tracking error.
  if (axes.size() == 1) errors.erase(errors.begin());
  shown.columns.insert(shown.columns.begin() + 1, errors.begin(), errors.end());
  return shown;
}

/// One controller of an experiment or of the biaxial table on one travel.
sim::CompareSpec spec_of(const Options& o, const sim::Machine& machine) {
  sim::CompareSpec spec;
  if (o.experiment.empty()) {
    if (source_of(o.path) == PathSource::kProgram && !o.speed.empty())
      refuse_option("--speed", "a part program has its own feed (leave it out)");
    use_path(
        spec, o.path,
        {option_si("--speed", o.speed.empty() ? "9.5 mm/s" : o.speed, quantity("m/s", "mm/s").positive())},
        machine, o.machine);
    spec.controllers = make_controllers(o.path);
    spec.accuracy = make_accuracy(o.path);
  } else {
    if (!(o.path == PathOptions{}) || !o.speed.empty()) {
      refuse_option("--experiment",
                    o.experiment + " has its own path, speed and gains: leave out the options of a path");
    }
    const auto all = sim::experiments();
    spec = sim::find_experiment(all, o.experiment)->settings.front().spec;
    spec.travels.resize(1);
  }
  const std::size_t printed = spec.controllers.size();
  add_beyond(spec.controllers, o.experiment, o.parameters);
  std::vector<std::string> ids;
  std::vector<sim::ControllerSpec> chosen;
  for (const sim::ControllerSpec& c : spec.controllers) {
    ids.push_back(c.id);
    if (c.id == o.controller) chosen = {c};
  }
  // The product's default, or the last of the thesis's controllers, which has the most.
  if (o.controller.empty()) chosen = {default_controller(spec.controllers, printed)};
  std::error_code ignored;
  if (chosen.empty() && std::filesystem::exists(o.controller, ignored))
    chosen = {read_controller(o.controller)};
  if (chosen.empty()) {
    refuse_option("--controller", fmt::format("got {}, expected a file or one of {}",
                                              io::in_quotes(o.controller), report::listed(ids)));
  }
  spec.controllers = chosen;
  spec.trials = o.trial + 1;
  spec.seed = o.seed;
  return spec;
}

int run_path(const Options& o, const sim::Machine& machine) {
  sim::CompareSpec spec = spec_of(o, machine);
  check_travel(machine, o.machine, spec);
  const sim::ControllerSpec& controller = spec.controllers.front();
  const sim::Travel& travel = spec.travels.front();
  const Parameters parameters = get_parameters(machine, o.machine, o.parameters, spec);
  sim::CompareResult one = sim::run_once(machine, parameters.knowledge, spec, o.trial);
  const sim::CompareRow& row = one.rows.front();
  const sim::Metrics& m = row.mean;
  io::Log log = as_log(one.axes, row.trace);
  const std::string pace = travel.pace_in_words();
  log.metadata = {{"machine", machine.name},
                  {"controller", controller.id + ", " + controller.label},
                  {"path", travel.name + ", " + pace},
                  {"seed", std::to_string(o.seed)}};
  io::write_csv(o.output, log);
  const std::string figures =
      fmt::format("{} error max {:.2f} µm, RMS {:.3f} µm", one.axes.size() == 1 ? "tracking" : "contour",
                  m.max_contour_error * 1e6, m.rms * 1e6);
  report_log(o.common.report, errors_first(log, one.axes),
             fmt::format("Controller ({}) on {}", controller.id, travel.name),
             fmt::format("{}, {}: {}", controller.label, pace, figures));
  auto json = report::to_json(one, o.experiment);
  json["schema"] = "stribeck.simulate/1";
  write_json(o.common.json, json);
  say(o.common, part_words(spec));
  say(o.common, fmt::format("Controller {} ({}) on {}, {}: {}. Trace in {} ({} rows).\n", controller.id,
                            controller.label, travel.name, pace, figures, o.output, log.rows));
  for (const std::string& warning : report::status_warnings(one))
    say(o.common, "Warning: " + warning + ".\n");
  for (const std::string& words : report::drift_words(one))
    say(o.common, "Change since identification: " + words + ".\n");
  return 0;
}

int simulate(const Options& o) {
  std::vector<std::string> inputs{o.machine, o.reference};
  if (o.reference.empty() && is_file(o.path)) inputs.push_back(o.path.path);
  for (const std::string& text : o.parameters.axis_files) inputs.push_back(axis_and_file(text).second);
  check_distinct(inputs, {o.output, page_of(o.common), o.common.json});
  if (!o.reference.empty() && !o.experiment.empty())
    refuse_option("--experiment", "does not go with --reference, which has its own motion (leave one out)");
  const OutputFolder page_folder = check_outputs(o.common);
  io::check_writable(o.output);
  const sim::Machine machine = load_machine(o.machine);
  return o.reference.empty() ? run_path(o, machine) : play_reference(o, machine);
}

}  // namespace

void add_simulate(CLI::App& app, Action& action) {
  auto* verb = app.add_subcommand(
      "simulate", "Simulate one run of a virtual machine, along a path or with a reference of excite");
  auto o = std::make_shared<Options>();
  verb->add_option("machine", o->machine, "Machine file")->required()->type_name("MACHINE.toml");
  verb->add_option("-o,--output", o->output, "CSV of the run")->required()->type_name("TRACE.csv");
  add_seed(*verb, o->seed);
  verb->add_option(
      "--controller", o->controller,
      "A controller of the experiment, by its letter, or a controller file; left out: (h), or the last controller of the thesis where there is no (h)");
  std::vector<std::string> ids;
  for (const sim::Experiment& e : sim::experiments()) ids.push_back(e.id);
  verb->add_option("--experiment", o->experiment, "Path, gains and controllers of an experiment of compare")
      ->check(one_of(ids));
  verb->add_option("--speed", o->speed, "Speed along the path; left out: 9.5 mm/s")->type_name("SPEED");
  add_path_options(*verb, o->path);
  verb->add_option("--trial", o->trial, "Number of the trial; together with the seed it determines the noise")
      ->check(whole_from(0, std::numeric_limits<std::uint32_t>::max() - 1))
      ->capture_default_str();
  add_parameter_options(*verb, o->parameters);
  verb->add_option(
          "--reference", o->reference,
          "CSV written by excite, run on one axis in place of a path: column r in closed loop, u or f in open loop")
      ->type_name("REF.csv");
  verb->add_option("--axis", o->axis, "Axis on which the reference runs")->type_name("NAME");
  add_common(*verb, o->common);
  refuse_empty_options(*verb);
  verb->footer(
      "Examples:\n  stribeck simulate machines/biaxial-table.toml --reference x-sine.csv --axis x -o "
      "x-sine-log.csv\n"
      "  stribeck simulate machines/biaxial-table.toml --controller f --path eight --parameters thesis -o "
      "trace.csv\n"
      "  stribeck simulate machines/triaxial-tool.toml --path examples/part.ngc -o trace.csv");
  verb->callback([o, &action] { action = [o] { return simulate(*o); }; });
}

}  // namespace stribeck::cli
