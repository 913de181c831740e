#include <fmt/format.h>

#include <stribeck/io/file.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/report/pages/tune_report.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <stribeck/workflow/option.hpp>
#include <stribeck/workflow/path/part_program.hpp>
#include <stribeck/workflow/run/tuning.hpp>

namespace stribeck::workflow {
namespace {

std::string file_of(const std::string& out, const std::string& id) {
  return is_controller_file(out) ? out : out + "/" + id + ".toml";
}

}  // namespace

std::vector<std::string> inputs_of(const TuneOptions& options, const ParameterOptions& origin,
                                   const std::string& machine_file) {
  std::vector<std::string> inputs = options.controllers;
  inputs.push_back(machine_file);
  if (is_controller_file(options.path.path)) inputs.push_back(options.path.path);
  for (const std::string& text : origin.axis_files) inputs.push_back(axis_and_file(text).second);
  return inputs;
}

Tuning plan_tuning(const TuneOptions& options, const ParameterOptions& origin,
                   const std::string& machine_file) {
  Tuning t;
  t.machine_file = machine_file;
  t.machine = read_virtual_machine(machine_file, origin.axis_files, AxisWithoutTruth::kLeftOut);
  t.origin = origin;
  t.spec = tune_spec(options, origin, t.machine, machine_file);
  t.wants_trade_off = options.trade_off;
  check_travel(t.machine, machine_file, t.spec.compare);
  return t;
}

void run_tuning(Tuning& t, const std::function<void(std::size_t, std::size_t)>& progress) {
  sim::CompareSpec needed = t.spec.compare;
  if (!t.spec.limits.input_variation) needed.controllers.push_back(*t.spec.reference);
  t.parameters = get_parameters(t.machine, t.machine_file, t.origin, needed);
  for (std::string& warning : unknown_delays(t.machine, t.spec.compare, t.parameters))
    t.parameters.assumed.push_back(std::move(warning));
  for (std::string& warning : uncounted_delays(t.machine, t.spec.compare))
    t.parameters.assumed.push_back(std::move(warning));
  for (std::string& warning : coverage_of(t.machine, t.spec.compare, t.parameters))
    t.parameters.assumed.push_back(std::move(warning));
  const std::vector<double> shares{0.5, 0.7, 1.0, 1.4, 2.0};
  const std::size_t searches = 1 + (t.wants_trade_off ? shares.size() : 0);
  t.result = sim::tune(t.machine, t.parameters.knowledge, t.spec, [&](std::size_t done, std::size_t all) {
    if (progress) progress(done, searches * all);
  });
  if (!t.wants_trade_off) return;
  t.trade_off = sim::trade_off(t.machine, t.parameters.knowledge, t.spec, shares,
                               [&](std::size_t done, std::size_t all) {
                                 const std::size_t one = all / shares.size();
                                 if (progress) progress(one + done, searches * one);
                               });
}

Comparison run_tuned_comparison(const ComparisonOptions& o,
                                const std::function<void(std::size_t, std::size_t)>& progress) {
  ComparisonPlan plan = plan_comparison(
      o, read_virtual_machine(o.machine, o.parameters.axis_files, AxisWithoutTruth::kLeftOut));
  TuneOptions options;
  options.experiment = plan.experiment;
  options.path = o.path;
  options.speeds = o.speeds;
  options.trials = o.trials;
  options.seed = o.seed;
  options.threads = o.threads;
  sim::TuneSpec search = tune_spec(options, o.parameters, plan.machine, o.machine);
  search.compare = plan.spec;
  sim::CompareSpec needed = plan.spec;
  needed.controllers.push_back(*search.reference);
  Parameters parameters = get_parameters(plan.machine, o.machine, o.parameters, needed);
  const sim::TuneResult tuned = sim::tune(plan.machine, parameters.knowledge, search, progress);
  std::vector<std::string> warnings;
  for (std::size_t i = 0; i < tuned.controllers.size(); ++i) {
    const sim::TunedController& c = tuned.controllers[i];
    if (c.found()) {
      plan.spec.controllers[i] = c.tuned;
      plan.spec.controllers[i].label = renamed(c.tuned).label;
    } else {
      warnings.push_back(
          fmt::format("({}) keeps its own gains: {}", c.start.id, report::why_none(c, search)));
    }
  }
  Comparison out = run_plan(std::move(plan), std::move(parameters), progress);
  out.warnings.insert(out.warnings.begin(), warnings.begin(), warnings.end());
  return out;
}

bool is_controller_file(const std::string& out) { return out.size() > 5 && out.ends_with(".toml"); }

std::vector<std::string> tuned_files(const Tuning& t, const std::string& out, const std::string& option) {
  if (out.empty()) return {};
  const auto& controllers = t.spec.compare.controllers;
  if (is_controller_file(out) && controllers.size() > 1) {
    refuse_option(option,
                  fmt::format("got a file for {} controllers, expected a folder (or a single --controller)",
                              controllers.size()));
  }
  std::vector<std::string> files;
  for (const sim::ControllerSpec& c : controllers) files.push_back(file_of(out, c.id));
  return files;
}

void write_tuned(const Tuning& t, const std::string& out, std::string_view version) {
  if (out.empty()) return;
  for (const sim::TunedController& c : t.result.controllers) {
    if (!c.found()) continue;
    io::write_atomically(
        file_of(out, c.start.id),
        io::write_toml(renamed(c.tuned),
                       fmt::format("Tuned by stribeck {} on the machine \"{}\": docs/theory/tuning.md.",
                                   version, t.machine.name)));
  }
}

std::string missed(const Tuning& t) {
  std::vector<std::string> all;
  for (const sim::TunedController& c : t.result.controllers) {
    if (!c.found())
      all.push_back(fmt::format("controller ({}): {}{}", c.start.id, report::why_none(c, t.spec),
                                way_out(c, t.spec.evaluations)));
  }
  return report::joined(all, "; ");
}

std::string text_of(const Tuning& t) {
  std::string text = part_words(t.spec.compare) + report::text_table(t.result, t.spec, t.trade_off);
  for (const std::string& warning : t.parameters.assumed) text += "Warning: " + warning + ".\n";
  return text + fmt::format("Compensators: {}.\n", t.parameters.words);
}

}  // namespace stribeck::workflow
