#include <fmt/format.h>
#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

#include <apps/web/curves.hpp>
#include <apps/web/what_if.hpp>
#include <stribeck/core/walk_fields.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/path/curve.hpp>
#include <stribeck/report/shell_words.hpp>
#include <stribeck/workflow/built_in.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <stribeck/workflow/option.hpp>
#include <stribeck/workflow/study/factors.hpp>

namespace stribeck::web {
namespace {

constexpr std::size_t kMostKnown = 8;
constexpr double kMostTicks = 60e3;  // of one controller: seconds of computing for the slowest law
constexpr std::string_view kExperiment = "experiment";
constexpr std::string_view kFiveAxis = "five-axis";  // no motion of the thesis

[[noreturn]] void refuse(const std::string& key, const std::string& what) {
  throw io::InputError({"request", 0, key, what});
}

bool is_shape(const std::string& motion) { return enum_value<path::Shape>(motion).has_value(); }

std::string default_motion(const sim::Machine& machine) {
  const std::string experiment = workflow::default_experiment(machine, {});
  if (experiment == workflow::kVaried) return "circle";
  return experiment == workflow::kOwn ? experiment : std::string(kExperiment);
}

bool is_built_in(const std::string& controller) {
  const auto names = workflow::built_in_controllers();
  return std::find(names.begin(), names.end(), controller) != names.end();
}

/// The options of `compare` that the request stands for; no text of it names a file.
workflow::ComparisonOptions options_of(const WhatIfRequest& r, const sim::Machine& machine,
                                       const std::string& file) {
  workflow::ComparisonOptions o;
  o.machine = file;
  o.parameters.source = r.parameters;
  o.trials = 1;
  o.seed = r.seed;
  const std::string motion = r.motion.empty() ? default_motion(machine) : r.motion;
  const bool own = motion == workflow::kOwn;
  if (is_shape(motion) || own) {
    o.experiment = own ? workflow::kOwn : workflow::kVaried;
    if (!own) o.path.path = motion;
    o.path.size = r.size;
    o.path.laps = 1.0;
    if (!r.omega_t.empty()) o.path.omega_t = r.omega_t;
    if (!r.omega_n.empty()) o.path.omega_n = r.omega_n;
    if (!r.observer_pole.empty()) o.path.observer_pole = r.observer_pole;
    if (!r.speed.empty()) o.speeds = {r.speed};
    if (r.speed.empty() && !own) o.speeds = {"9.5 mm/s"};
  } else if (motion == kExperiment) {
    o.experiment = workflow::default_experiment(machine, {});
    if (o.experiment == workflow::kVaried || o.experiment == workflow::kOwn)
      refuse("motion",
             "this machine has no motion of its own in the thesis, expected circle, eight, trifolium or own");
    if (!(r.size + r.speed + r.omega_t + r.omega_n + r.observer_pole).empty())
      refuse("motion",
             "experiment has its own size, speed and gains (leave them out, or choose another motion)");
  } else {
    refuse("motion",
           "got " + io::in_quotes(motion) + ", expected circle, eight, trifolium, own or experiment");
  }
  for (const std::string& c : r.controllers) {
    if (is_built_in(c)) {
      o.controllers.push_back(c);
      o.only.push_back(workflow::read_controller(c).id);
    } else {
      o.only.push_back(c);
    }
  }
  return o;
}

/// One motion, short enough for a knob.
void shorten(workflow::ComparisonPlan& plan) {
  const bool own = plan.experiment == workflow::kOwn;  // slow, then fast
  plan.spec.travels = {own ? plan.spec.travels.back() : plan.spec.travels.front()};
  const sim::Travel& travel = plan.spec.travels.front();
  const double ticks = travel.duration() / plan.machine.sample_time;
  if (ticks <= kMostTicks) return;
  refuse(
      "speed",
      fmt::format("the lap takes {:.3g} control periods, at most {:.3g} are computed here (choose a higher "
                  "speed or a smaller size; stribeck compare has no such limit)",
                  ticks, kMostTicks));
}

sim::Machine changed(const sim::Machine& nominal, const WhatIfRequest& r) {
  sim::Machine machine = nominal;
  std::vector<std::size_t> axes;
  for (std::size_t i = 0; i < nominal.axes.size(); ++i) axes.push_back(i);
  if (!r.changes.empty()) {
    workflow::StudyFile study;
    for (const Change& c : r.changes) {
      workflow::StudyFactor factor;
      factor.key = c.key;
      if (c.scale) factor.scale = sim::ListOf<double>{{*c.scale}};
      if (c.value) factor.value = sim::ListOf<std::string>{{*c.value}};
      study.factors.push_back(std::move(factor));
    }
    const auto factors = workflow::bind_factors(study, io::Node{}, "request", nominal, axes);
    std::vector<double> values;
    for (const workflow::BoundFactor& f : factors) values.push_back(sim::value_number(f.distribution, 0));
    machine = workflow::with_values(nominal, factors, values);
  }
  if (!r.sample_time.empty())
    machine.sample_time =
        workflow::option_si("sample_time", r.sample_time, quantity("s", "ms").at_least(50e-6).at_most(0.05));
  if (const std::string wrong = workflow::why_impossible(machine, axes); !wrong.empty())
    refuse("changes", wrong);
  return machine;
}

/// The command that repeats it; empty where the machine is not one that a file has.
std::string command_of(const WhatIfRequest& r, const workflow::ComparisonOptions& o,
                       const std::string& travel_speed) {
  if (!r.changes.empty() || !r.sample_time.empty()) return {};
  std::string words =
      "stribeck compare " + report::shell_quoted(o.machine) + " --trials 1 --experiment " + o.experiment;
  const auto add = [&](const char* option, const std::string& value) {
    if (!value.empty()) words += fmt::format(" {} {}", option, report::shell_quoted(value));
  };
  if (o.experiment == workflow::kVaried || o.experiment == workflow::kOwn) {
    words += " --laps 1";
    if (o.path.path != workflow::PathOptions{}.path) words += " --path " + o.path.path;
    add("--size", o.path.size);
    add("--speed", travel_speed);
    add("--omega-t", o.path.omega_t);
    add("--omega-n", o.path.omega_n);
    add("--observer-pole", r.observer_pole);
  }
  for (const std::string& c : o.controllers) words += " --controller " + report::shell_quoted(c);
  words += " --only ";
  for (std::size_t i = 0; i < o.only.size(); ++i) words += (i > 0 ? "," : "") + o.only[i];
  if (o.parameters.source != "identified") words += " --parameters " + o.parameters.source;
  if (o.seed != 1) words += fmt::format(" --seed {}", o.seed);
  return words;
}

}  // namespace

const workflow::Parameters& WhatIf::parameters_for(const workflow::ComparisonPlan& plan,
                                                   const std::string& file, const std::string& source) {
  const workflow::Needs needs = workflow::Needs::of(plan.spec.controllers);
  const auto is_it = [&](const Known& k) {
    const auto all = [](const workflow::Needs& n) {
      return std::array{n.conventional, n.gaussian, n.eccentric, n.whole};
    };
    // An experiment on fewer axes identifies fewer.
    return all(k.needs) == all(needs) && k.source == source && k.seed == plan.spec.seed &&
           same(value_of(k.machine), value_of(plan.machine)) &&
           k.axes == sim::chosen_axes(plan.machine, plan.spec);
  };
  const auto found = std::find_if(known_.begin(), known_.end(), is_it);
  if (found != known_.end()) {
    known_.splice(known_.begin(), known_, found);
  } else {
    workflow::ParameterOptions options;
    options.source = source;
    known_.push_front({plan.machine, needs, source, plan.spec.seed, sim::chosen_axes(plan.machine, plan.spec),
                       workflow::get_parameters(plan.machine, file, options, plan.spec)});
    // Recordings are the larger part, and nothing asks for them any more.
    for (workflow::CommissionedAxis& axis : known_.front().parameters.axes) axis.logs = {};
    if (known_.size() > kMostKnown) known_.pop_back();
  }
  return known_.front().parameters;
}

nlohmann::ordered_json WhatIf::run(const WhatIfRequest& r, const IsOld& is_old) {
  const auto begin = std::chrono::steady_clock::now();
  const auto check = [&] {
    if (is_old()) throw Outdated{};
  };
  check();
  const auto [nominal, name] = machines_.read(r.machine);
  const workflow::ComparisonOptions options = options_of(r, nominal, name.file);
  const sim::Machine machine = changed(nominal, r);
  workflow::ComparisonPlan plan = workflow::plan_comparison(options, machine);
  shorten(plan);
  workflow::ComparisonPlan identified = plan;
  if (!r.identify_changed) identified.machine = nominal;
  check();
  const workflow::Parameters parameters = parameters_for(identified, name.file, r.parameters);
  check();
  const auto simulating = std::chrono::steady_clock::now();
  const workflow::Comparison done =
      workflow::run_plan(std::move(plan), parameters, [&](std::size_t, std::size_t) { check(); });
  const auto end = std::chrono::steady_clock::now();
  const auto ms = [](auto from, auto to) {
    return std::chrono::duration<double, std::milli>(to - from).count();
  };

  nlohmann::ordered_json json;
  json["schema"] = "stribeck.what-if/1";
  json["result"] = workflow::to_json(done);
  const sim::Travel& travel = done.result.spec.travels.front();
  json["motion"] = travel.name + ", " + travel.pace_in_words();
  json["parameters"] = parameters.words;
  const double speed = travel.constant_speed();
  const bool rate = travel.pace == path::Pace::kRate;
  const std::string command =
      command_of(r, options, rate ? r.speed : fmt::format("{:.6g} mm/s", speed * 1e3));
  json["command"] = command.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(command);
  json["simulated_in_ms"] = ms(simulating, end);
  json["identified_in_ms"] = ms(begin, simulating);
  add_curves(json, done);
  return json;
}

std::pair<std::unique_ptr<sim::EndlessRun>, std::string> WhatIf::endless(const WhatIfRequest& r,
                                                                         const IsOld& is_old) {
  const auto check = [&] {
    if (is_old()) throw Outdated{};
  };
  check();
  const auto [nominal, name] = machines_.read(r.machine);
  const workflow::ComparisonOptions options = options_of(r, nominal, name.file);
  workflow::ComparisonPlan plan = workflow::plan_comparison(options, changed(nominal, r));
  shorten(plan);
  workflow::ComparisonPlan identified = plan;
  if (!r.identify_changed) identified.machine = nominal;
  check();
  const workflow::Parameters parameters = parameters_for(identified, name.file, r.parameters);
  check();
  const sim::Travel& travel = plan.spec.travels.front();
  const sim::ControllerSpec& controller = plan.spec.controllers.front();
  std::string words = fmt::format("{}, {}, {}, ({}) {}", plan.machine.name, travel.name,
                                  travel.pace_in_words(), controller.id, controller.label);
  return {sim::EndlessRun::make(plan.machine, parameters.knowledge, plan.spec), std::move(words)};
}

std::string WhatIf::machine_file(const WhatIfRequest& r) const {
  const auto [nominal, name] = machines_.read(r.machine);
  return workflow::machine_text(
      changed(nominal, r), "Made by stribeck serve from " + name.file + ", with values changed by hand.");
}

nlohmann::ordered_json WhatIf::form(const std::string& id) const {
  const auto read = machines_.read(id);  // no structured binding: clang 14 captures none
  const sim::Machine& machine = read.first;
  const std::string& file = read.second.file;
  nlohmann::ordered_json json = machine_form(machine);
  json["id"] = id;
  json["file"] = file;
  const std::string motion = default_motion(machine);
  json["motion"] = motion;
  nlohmann::ordered_json motions = nlohmann::ordered_json::object();
  WhatIfRequest r;
  const auto controllers = [&](const std::string& which) {
    r.motion = which;
    workflow::ComparisonOptions all = options_of(r, machine, file);
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    workflow::ComparisonPlan plan = workflow::plan_comparison(all, machine);
    for (const sim::ControllerSpec& c : plan.spec.controllers)
      list.push_back({{"id", c.id}, {"choice", c.id}, {"label", c.label}});
    for (const std::string& c : workflow::built_in_controllers()) {
      const sim::ControllerSpec spec = workflow::read_controller(c);
      const bool taken = std::any_of(plan.spec.controllers.begin(), plan.spec.controllers.end(),
                                     [&](const sim::ControllerSpec& other) { return other.id == spec.id; });
      if (!taken) list.push_back({{"id", spec.id}, {"choice", c}, {"label", spec.label}});
    }
    const sim::Travel& travel = plan.spec.travels.back();
    const auto* law = std::get_if<control::ContouringParams>(&plan.spec.controllers.front().law);
    const bool free = which != kExperiment;
    motions[which] = {
        {"label", travel.name},
        {"thesis", which == kExperiment && plan.experiment != kFiveAxis},
        {"free", free},
        {"size_mm", is_shape(which) ? nlohmann::ordered_json(10.0) : nlohmann::ordered_json(nullptr)},
        {"speed_mm_per_s", free && travel.pace != path::Pace::kRate
                               ? nlohmann::ordered_json(travel.speed * 1e3)
                               : nlohmann::ordered_json(nullptr)},
        {"omega_rad_per_s",
         free && law != nullptr ? nlohmann::ordered_json(0.5 * law->kv[0]) : nlohmann::ordered_json(nullptr)},
        {"controllers", std::move(list)}};
  };
  std::vector<std::string> possible;
  if (machine.axes.size() >= 2) possible = {"circle", "eight", "trifolium"};
  if (machine.axes.size() <= 3) possible.emplace_back(workflow::kOwn);
  if (motion == kExperiment) possible.insert(possible.begin(), std::string(kExperiment));
  for (const std::string& one : possible) {
    try {
      controllers(one);
    } catch (const io::InputError&) {
      // Not within the limits of this machine.
    }
  }
  if (motions.empty()) refuse("machine", "no motion of the dashboard is within the limits of this machine");
  if (!motions.contains(motion)) json["motion"] = motions.begin().key();
  json["motions"] = std::move(motions);
  return json;
}

}  // namespace stribeck::web
