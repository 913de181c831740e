#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include <stribeck/sim/parallel.hpp>
#include <stribeck/workflow/built_in.hpp>
#include <stribeck/workflow/commission.hpp>
#include <stribeck/workflow/option.hpp>
#include <stribeck/workflow/path/path_options.hpp>
#include <stribeck/workflow/reproduce/identification.hpp>
#include <stribeck/workflow/reproduce/reproduction.hpp>

namespace stribeck::workflow {
namespace {

constexpr std::array<std::string_view, 5> kIdentification{"ident-A", "ident-B", "ident-C", "ident-D",
                                                          "verify"};

bool contains(const std::vector<std::string>& ids, std::string_view id) {
  return std::find(ids.begin(), ids.end(), id) != ids.end();
}

/// Identified models of the axes of one machine, shared by all experiments on it.
struct Known {
  sim::Machine machine;
  Needs needs;
  std::vector<bool> used;
  std::vector<sim::AxisKnowledge> identified;
};

std::vector<sim::AxisKnowledge> printed_knowledge(const sim::Machine& machine) {
  std::vector<sim::AxisKnowledge> all;
  for (const auto& [name, axis] : machine.axes)
    all.push_back({axis.published.conventional, axis.published.gaussian, axis.published.eccentric, {}});
  return all;
}

/// Every machine of the settings, with its axes identified for all of them together.
std::map<std::string, Known> commission_machines(const std::vector<sim::Experiment>& chosen,
                                                 const ReproduceOptions& o, const StageProgress& progress) {
  std::map<std::string, Known> all;
  for (const sim::Experiment& e : chosen) {
    for (const sim::Setting& s : e.settings) {
      Known& k = all[s.machine];
      if (k.machine.axes.empty()) k.machine = built_in_machine(s.machine);
      k.used.resize(k.machine.axes.size());
      k.identified.resize(k.machine.axes.size());
      if (s.parameters != sim::ParameterSource::kIdentified) continue;
      const Needs n = Needs::of(s.spec.controllers);
      k.needs = k.needs | n;
      for (const std::size_t i : sim::chosen_axes(k.machine, s.spec)) k.used[i] = true;
    }
  }
  struct Job {
    Known* known;
    std::size_t axis;
  };
  std::vector<Job> jobs;
  for (auto& [name, k] : all) {
    for (std::size_t i = 0; i < k.used.size(); ++i) {
      if (k.used[i]) jobs.push_back({&k, i});
    }
  }
  sim::parallel_for(
      jobs.size(), o.threads, [] { return 0; },
      [&](int&, std::size_t i) {
        Known& k = *jobs[i].known;
        k.identified[jobs[i].axis] = commission_axis(k.machine, jobs[i].axis, k.needs, o.seed).knowledge;
      },
      [&](std::size_t done, std::size_t count) { progress("identify", done, count); });
  return all;
}

report::ReproducedSection run_setting(const sim::Experiment& e, const sim::Setting& s, const Known& known,
                                      const ReproduceOptions& o) {
  const bool printed = s.parameters == sim::ParameterSource::kPrinted;
  sim::CompareSpec spec = s.spec;
  spec.trials = o.trials;
  spec.seed = o.seed;
  spec.threads = o.threads;
  const sim::CompareResult result =
      sim::compare(known.machine, printed ? printed_knowledge(known.machine) : known.identified, spec);
  for (const sim::CompareRow& row : result.rows) {
    if (!row.refused.empty())
      throw sim::Refused(fmt::format("{}, controller ({}): {}", e.id, row.controller.id, row.refused));
  }
  return report::reproduced(
      e, s, result, printed ? "printed parameters of the thesis" : "identified from logs of this machine");
}

}  // namespace

std::vector<std::string> reproducible_ids() {
  std::vector<std::string> ids{"all"};
  ids.insert(ids.end(), kIdentification.begin(), kIdentification.end());
  for (const sim::Experiment& e : sim::experiments()) ids.push_back(e.id);
  ids.emplace_back(kRobustness);
  return ids;
}

ReproductionPlan plan_reproduction(const ReproduceOptions& o) {
  ReproductionPlan plan;
  plan.options = o;
  // The thesis contains none of it, so "all" does not include it.
  plan.robust = contains(o.ids, kRobustness);
  if (!plan.robust && !o.controllers.empty())
    refuse_option("--controller", "can be used with robustness only (add robustness to the experiments)");
  plan.robustness = sim::robust_biaxial();
  plan.robustness.machines = o.machines;
  if (o.vary != "all") plan.robustness.variation = sim::vary_only(o.vary);
  plan.robustness.seed = o.seed;
  plan.robustness.threads = o.threads;
  if (!o.controllers.empty()) plan.robustness.controllers.resize(1);  // the reference for the others
  for (const std::string& name : o.controllers)
    add_controller(plan.robustness.controllers, read_controller(name), name);
  const bool everything = contains(o.ids, "all");
  for (const std::string_view id : kIdentification) {
    if (everything || contains(o.ids, id)) plan.identification.emplace_back(id);
  }
  for (sim::Experiment& e : sim::experiments()) {
    if (everything || contains(o.ids, e.id)) plan.experiments.push_back(std::move(e));
  }
  return plan;
}

report::ReproductionInput reproduce(const ReproductionPlan& plan, const StageProgress& told) {
  const StageProgress progress = [&](const char* stage, std::size_t done, std::size_t all) {
    if (told) told(stage, done, all);
  };
  const ReproduceOptions& o = plan.options;
  report::ReproductionInput page;
  page.seed = o.seed;
  page.trials = plan.experiments.empty() && plan.identification.empty() ? 0 : o.trials;
  if (!plan.identification.empty()) {
    page.sections = reproduce_identification(plan.identification, built_in_machine("biaxial-table"),
                                             built_in_machine("triaxial-tool"), o.seed, o.threads);
  }
  const sim::Experiment robustness = robustness_experiment(plan.robustness);
  std::vector<sim::Experiment> identified = plan.experiments;
  if (plan.robust) identified.push_back(robustness);
  const auto known = commission_machines(identified, o, progress);
  std::size_t settings = 0;
  for (const sim::Experiment& e : plan.experiments) settings += e.settings.size();
  std::size_t done = 0;
  for (const sim::Experiment& e : plan.experiments) {
    for (const sim::Setting& s : e.settings) {
      page.sections.push_back(run_setting(e, s, known.at(s.machine), o));
      progress("reproduce", ++done, settings);
    }
  }
  if (plan.robust) {
    const Known& k = known.at(robustness.settings.front().machine);
    page.sections.push_back(robustness_section(sim::robustness(
        k.machine, k.identified, plan.robustness,
        [&](std::size_t ready, std::size_t count) { progress("robustness", ready, count); })));
  }
  return page;
}

}  // namespace stribeck::workflow
