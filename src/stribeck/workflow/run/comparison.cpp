#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include <stribeck/io/error.hpp>
#include <stribeck/report/json.hpp>
#include <stribeck/report/table.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/workflow/built_in.hpp>
#include <stribeck/workflow/machine/drive_mode.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <stribeck/workflow/option.hpp>
#include <stribeck/workflow/run/comparison.hpp>

namespace stribeck::workflow {
namespace {

/// Of the first `of_experiment` leaves only those with these ids; controllers that the user added stay.
void keep_only(std::vector<sim::ControllerSpec>& controllers, std::size_t of_experiment,
               const std::vector<std::string>& only) {
  if (only.empty()) return;
  std::vector<std::string> ids;
  for (const sim::ControllerSpec& c : controllers) ids.push_back(c.id);
  for (const std::string& id : only) {
    if (std::find(ids.begin(), ids.end(), id) == ids.end()) {
      refuse_option("--only",
                    fmt::format("got {}, expected one of {}", io::in_quotes(id), report::listed(ids)));
    }
  }
  const auto added = controllers.begin() + static_cast<std::ptrdiff_t>(of_experiment);
  const auto left = std::remove_if(controllers.begin(), added, [&](const sim::ControllerSpec& c) {
    return std::find(only.begin(), only.end(), c.id) == only.end();
  });
  controllers.erase(left, added);
}

sim::CompareSpec spec_of(const ComparisonOptions& o, const std::string& experiment,
                         const sim::Machine& machine) {
  sim::CompareSpec s = experiment_spec(experiment, o.path, o.speeds, machine, o.machine);
  add_beyond(s.controllers, experiment, o.parameters);
  const std::size_t of_experiment = s.controllers.size();
  for (const std::string& name : o.controllers) add_controller(s.controllers, read_controller(name), name);
  keep_only(s.controllers, of_experiment, o.only);
  s.trials = o.trials;
  s.seed = o.seed;
  s.threads = o.threads;
  return s;
}

}  // namespace

std::string whose_loop(const ComparisonPlan& plan, const ComparisonOptions& o) {
  const auto& all = plan.spec.controllers;
  const bool without =
      std::any_of(all.begin(), all.end(), [](const sim::ControllerSpec& c) { return c.id == "a"; });
  if (plan.experiment != kOwn || !o.controllers.empty() || !without) return {};
  double omega = INFINITY;
  for (const std::size_t i : plan.spec.axes)
    omega = std::fmin(omega, plan.machine.axes[i].second.commissioning.omega);
  const bool hangs = std::any_of(plan.spec.axes.begin(), plan.spec.axes.end(), [&](std::size_t i) {
    const sim::MachineAxis& axis = plan.machine.axes[i].second;
    const auto& terms = axis.plant.friction.eccentric;
    return axis.rotary && std::any_of(terms.begin(), terms.end(), [](const auto& t) {
             return t.form == friction::EccentricForm::kAdditive && std::abs(t.period - 2.0 * kPi) < 1e-3;
           });
  });
  std::string words = fmt::format(
      "(a) is the law of the other controllers without compensation, {}; it is not the loop that your control has: to see what that one leaves, "
      "copy controllers/cascade.toml (P control of position around PI control of velocity), enter its gains, and give it as --controller",
      o.path.omega_n.empty() ? fmt::format("with poles of {:.3g} rad/s, a rule for recording", omega)
                             : "with your poles");
  if (hangs)
    words +=
        "; without a friction model (a) and (d) know nothing of the unbalance either, and the error of (a) is in part the sag under it, which an "
        "integral part would take away";
  return words;
}

namespace {

bool compensates(const sim::ControllerSpec& c) {
  return c.friction != sim::FrictionUse::kNone || c.observer != control::Observer::kNone;
}

/// The rows of a travel that were simulated: without compensation, and those with compensation under the same law.
struct RowsOfTravel {
  const sim::CompareRow* plain = nullptr;
  std::vector<const sim::CompareRow*> others;
};

RowsOfTravel rows_of(const sim::CompareResult& result, std::size_t travel) {
  RowsOfTravel rows;
  for (const sim::CompareRow& r : result.rows) {
    if (r.travel != travel || !r.refused.empty() || !std::isfinite(r.mean.max_contour_error)) continue;
    if (compensates(r.controller))
      rows.others.push_back(&r);
    else if (rows.plain == nullptr)
      rows.plain = &r;
  }
  if (rows.plain != nullptr) {
    const std::size_t law = rows.plain->controller.law.index();
    std::erase_if(rows.others, [law](const sim::CompareRow* r) { return r->controller.law.index() != law; });
  }
  return rows;
}

}  // namespace

std::vector<std::string> harmful_speeds(const sim::CompareResult& result) {
  std::vector<std::string> all;
  constexpr double kMore = 1.05;  // less is chance
  for (std::size_t travel = 0; travel < result.spec.travels.size(); ++travel) {
    const RowsOfTravel rows = rows_of(result, travel);
    if (rows.plain == nullptr || rows.others.empty()) continue;
    const double without = rows.plain->mean.max_contour_error;
    const std::string pace = result.spec.travels[travel].pace_in_words();
    const auto largest = [](const sim::CompareRow* r) { return r->mean.max_contour_error; };
    const sim::CompareRow* best = *std::min_element(
        rows.others.begin(), rows.others.end(),
        [&](const sim::CompareRow* x, const sim::CompareRow* y) { return largest(x) < largest(y); });
    if (largest(best) > kMore * without) {
      all.push_back(fmt::format(
          "at {} every compensation does harm: ({}) leaves {:.3g} um without any, ({}), the best of the others, {:.3g} um (leave it off for "
          "such motion, or compare with a finer encoder, a shorter control period or another interface of the drives, --drive)",
          pace, rows.plain->controller.id, 1e6 * without, best->controller.id, 1e6 * largest(best)));
      continue;
    }
    std::string worse;
    for (const sim::CompareRow* r : rows.others) {
      if (largest(r) > kMore * without)
        worse +=
            fmt::format("{}({}) {:.3g} um", worse.empty() ? "" : ", ", r->controller.id, 1e6 * largest(r));
    }
    if (!worse.empty())
      all.push_back(
          fmt::format("at {} some compensation does harm: {}, where ({}) leaves {:.3g} um without any", pace,
                      worse, rows.plain->controller.id, 1e6 * without));
  }
  return all;
}

std::vector<std::string> inputs_of(const ComparisonOptions& o) {
  std::vector<std::string> inputs = o.controllers;
  inputs.push_back(o.machine);
  if (is_file(o.path)) inputs.push_back(o.path.path);
  for (const std::string& text : o.parameters.axis_files) inputs.push_back(axis_and_file(text).second);
  return inputs;
}

ComparisonPlan plan_comparison(const ComparisonOptions& o, sim::Machine machine) {
  ComparisonPlan plan{o.experiment, std::move(machine), {}};
  if (!o.drive.empty()) set_drive_mode(plan.machine, o.drive);
  if (plan.experiment.empty()) plan.experiment = default_experiment(plan.machine, o.path, o.speeds);
  plan.spec = spec_of(o, plan.experiment, plan.machine);
  check_travel(plan.machine, o.machine, plan.spec);
  return plan;
}

Comparison run_plan(ComparisonPlan plan, Parameters parameters,
                    const std::function<void(std::size_t, std::size_t)>& progress) {
  Comparison out{std::move(plan.experiment), std::move(plan.machine), std::move(parameters), {}, {}};
  out.result = sim::compare(out.machine, out.parameters.knowledge, plan.spec, progress);
  out.warnings = harmful_speeds(out.result);
  for (std::string& warning :
       check_coverage(out.result, sim::chosen_axes(out.machine, plan.spec), out.parameters))
    out.warnings.push_back(std::move(warning));
  std::vector<report::ModelOfAxis> models;
  for (const std::size_t i : sim::chosen_axes(out.machine, plan.spec)) {
    if (out.parameters.axes.empty()) break;
    for (const CommissionedModel& m : out.parameters.axes[i].models)
      models.push_back({out.machine.axes[i].first, &m.result});
  }
  for (std::string& warning : report::identification_warnings(models))
    out.warnings.push_back(std::move(warning));
  return out;
}

namespace {

/// With --drive the machine has other drives than those whose loops the axis files tell.
void leave_out_loops(Parameters& parameters) {
  for (sim::AxisKnowledge& axis : parameters.knowledge) {
    for (auto* model : {&axis.conventional, &axis.gaussian, &axis.eccentric, &axis.whole})
      if (*model) (*model)->drive_loop.reset();
  }
}

}  // namespace

Comparison run_comparison(const ComparisonOptions& o,
                          const std::function<void(std::size_t, std::size_t)>& progress) {
  ComparisonPlan plan = plan_comparison(
      o, read_virtual_machine(o.machine, o.parameters.axis_files, AxisWithoutTruth::kLeftOut));
  Parameters parameters = get_parameters(plan.machine, o.machine, o.parameters, plan.spec);
  if (!o.drive.empty()) leave_out_loops(parameters);
  const std::string note = whose_loop(plan, o);
  Comparison out = run_plan(std::move(plan), std::move(parameters), progress);
  if (!note.empty()) out.warnings.push_back(note);
  return out;
}

nlohmann::ordered_json to_json(const Comparison& comparison) {
  nlohmann::ordered_json json = report::to_json(comparison.result, comparison.experiment);
  json["path"] = comparison.result.spec.travels.front().name;
  for (const std::string& warning : comparison.warnings) json["warnings"].push_back(warning);
  return json;
}

}  // namespace stribeck::workflow
