#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <span>
#include <stribeck/core/walk_fields.hpp>
#include <stribeck/sim/parallel.hpp>
#include <stribeck/sim/study/tuning_search.hpp>

namespace stribeck::sim {
namespace {

using namespace tuning;

// ---- gains

/// Powers of time in the units of gains. The poles of a Kalman observer change with the sixth root of its density.
std::optional<int> power_of_time(std::string_view unit) {
  constexpr std::array kUnits{
      std::pair{std::string_view{"1/s"}, -1},  std::pair{std::string_view{"rad/s"}, -1},
      std::pair{std::string_view{"1/s2"}, -2}, std::pair{std::string_view{"1/s3"}, -3},
      std::pair{std::string_view{"s"}, 1},     std::pair{std::string_view{"m/s"}, -1},
      std::pair{std::string_view{"m/s2"}, -2}, std::pair{std::string_view{"N2/s"}, -6}};
  for (const auto& [name, power] : kUnits) {
    if (name == unit) return power;
  }
  return {};
}

/// Collects numbers and lists of numbers of a controller and its law; no optional ones, and none of its tables.
void collect(const Target& owner, const std::string& place, std::size_t axes, std::vector<Gain>& gains) {
  for_each_member(owner, [&](const TargetMember& m) {
    const std::string name = place + std::string(m.info.name);
    const auto power = power_of_time(m.info.quantity.unit);
    const auto add = [&](const std::string& full, const Target& number) {
      auto* value = static_cast<double*>(number.object());
      if (power && *value > 0.0 && std::isfinite(*value))
        gains.push_back({full, m.info.quantity, *power, value});
    };
    if (m.value.kind() == Kind::kNumber) {
      add(name, m.value);
    } else if (m.value.kind() == Kind::kList && m.value.type().inner->kind == Kind::kNumber) {
      const std::size_t n = m.value.size();
      for (std::size_t i = 0; i < std::min(n, axes); ++i)
        add(n > 1 ? name + "[" + std::to_string(i) + "]" : name, m.value[i]);
    } else if (m.value.kind() == Kind::kVariant) {
      collect(m.value.chosen(), name + ".", axes, gains);
    }
  });
}

/// The variation that the reference has on each travel, under the noise of these trials.
template <std::size_t N>
void limit_by(const ControllerSpec& reference, Task<N>& task, std::span<Trials* const> all) {
  task.choose_substeps(reference);
  for (Trials* trials : all) {
    Point p;
    task.run(reference, *trials, p);
    if (!std::isfinite(p.objective)) {
      throw Refused("controller (" + reference.id +
                    "), whose input variation is the limit, does not follow the path (choose another "
                    "reference, or give the limit)");
    }
    trials->variation_limit = p.variation;
  }
}

template <std::size_t N>
void tune_axes(const Machine& machine, const std::vector<AxisKnowledge>& knowledge, const TuneSpec& spec,
               const std::vector<std::size_t>& axes, TuneResult& result,
               const std::function<void(std::size_t, std::size_t)>& progress) {
  std::vector<std::shared_ptr<const Route<N>>> routes;
  double fastest = 0.0;
  for (const Travel& travel : spec.compare.travels) {
    routes.push_back(std::make_shared<const Route<N>>(sample<N>(travel, machine.sample_time)));
    for (const auto& p : routes.back()->points) fastest = std::max(fastest, norm(p.velocity));
  }
  std::vector<NearbyMachine> machines{{"nominal", machine}};
  if (spec.nearby) machines = nearby_machines(machine);
  const auto make_fleet = [&] {
    Fleet fleet;
    for (const NearbyMachine& m : machines)
      fleet.push_back(EqualDrives([&m, &axes, fastest] { return Drives(m.machine, axes, 1.05 * fastest); }));
    return fleet;
  };
  const auto& controllers = spec.compare.controllers;
  Trials search{kSearchTrial, trials_that_differ(machine, axes, spec.search_trials), 1, {}};
  Trials check{kCheckTrial,
               trials_that_differ(machine, axes, kCheckTrials),
               trials_that_differ(machine, axes, spec.search_trials),
               {}};
  if (spec.limits.input_variation) {
    search.variation_limit.assign(routes.size(), *spec.limits.input_variation);
    check.variation_limit = search.variation_limit;
  } else {
    const ControllerSpec& reference = spec.reference ? *spec.reference : controllers.back();
    result.reference = reference.id;
    // The limit is that of the given machine: the reference need not suit the others.
    Fleet fleet;
    fleet.push_back(std::move(make_fleet().front()));
    Task<N> task(machine, knowledge, spec, axes, routes, fleet);
    limit_by<N>(reference, task, std::array{&search, &check});
  }
  for (Trials* trials : {&search, &check}) {
    for (double& limit : trials->variation_limit) limit *= spec.limits.variation_share;
  }
  result.variation_limit = check.variation_limit;
  std::mutex mutex;
  std::size_t done = 0;
  const std::size_t all = controllers.size() * static_cast<std::size_t>(spec.evaluations);
  result.controllers.resize(controllers.size());
  parallel_for(controllers.size(), spec.compare.threads, make_fleet, [&](Fleet& fleet, std::size_t i) {
    TunedController& out = result.controllers[i];
    out.start = out.tuned = controllers[i];
    std::size_t mine = 0;
    const std::function<void()> counted = [&] {
      const std::lock_guard lock(mutex);
      ++mine;
      ++done;
      if (progress) progress(done, all);
    };
    Task<N> task(machine, knowledge, spec, axes, routes, fleet);
    try {
      out.start_margins = task.margins(controllers[i]);
      out.start_loop = task.response(controllers[i]);
      Search<N>(task, controllers[i], search, check, spec.evaluations, counted).run(out);
      if (out.found()) out.tuned_loop = task.response(out.tuned);
      if (spec.stick_slip) {
        out.start_smooth = task.smooth_speeds(out.start);
        if (out.found()) out.tuned_smooth = task.smooth_speeds(out.tuned);
      }
    } catch (const Refused& e) {
      out.refused = e.what();
      out.tuned = controllers[i];
      out.gains.clear();
    }
    const std::lock_guard lock(mutex);
    done += static_cast<std::size_t>(spec.evaluations) - mine;
    if (progress) progress(done, all);
  });
}

std::vector<TravelScore> scores(const CompareResult& run, std::size_t which, std::size_t controllers) {
  std::vector<TravelScore> s;
  for (std::size_t r = which; r < run.rows.size(); r += controllers) {
    if (!run.rows[r].refused.empty()) throw Refused(run.rows[r].refused);
    s.push_back({run.rows[r].mean, run.rows[r].spread});
  }
  return s;
}

/// Mean of the largest errors over the travels; NaN: refused.
double largest_error(const Machine& machine, const std::vector<AxisKnowledge>& knowledge, CompareSpec one,
                     const ControllerSpec& controller) {
  one.controllers = {controller};
  try {
    double sum = 0.0;
    for (const TravelScore& s : scores(compare(machine, knowledge, one), 0, 1))
      sum += s.mean.max_contour_error;
    return sum / static_cast<double>(one.travels.size());
  } catch (const Refused&) {
    return std::numeric_limits<double>::quiet_NaN();
  }
}

void score_nearby(const Machine& machine, const std::vector<AxisKnowledge>& knowledge, const TuneSpec& spec,
                  TunedController& c) {
  CompareSpec one = spec.compare;
  one.trials = std::min(one.trials, spec.search_trials);
  for (const NearbyMachine& m : nearby_machines(machine))
    c.machines.push_back({m.name, largest_error(m.machine, knowledge, one, c.start),
                          largest_error(m.machine, knowledge, one, c.tuned)});
}

}  // namespace

std::vector<Gain> gains_of(ControllerSpec& controller, std::size_t axes) {
  std::vector<Gain> gains;
  collect(target_of(controller), "", axes, gains);
  return gains;
}

ControllerSpec slowed(const ControllerSpec& controller, std::size_t axes, double share) {
  ControllerSpec c = controller;
  for (const Gain& g : gains_of(c, axes))
    *g.value = permitted(g.quantity, *g.value * std::pow(share, -g.time));
  return c;
}

TuneResult tune(const Machine& machine, const std::vector<AxisKnowledge>& knowledge, const TuneSpec& spec,
                const std::function<void(std::size_t, std::size_t)>& progress) {
  if (spec.compare.controllers.empty() || spec.compare.travels.empty())
    throw Refused("nothing to tune: expected at least one controller and one travel");
  TuneResult result;
  result.machine = machine.name;
  result.period = machine.sample_time;
  const std::vector<std::size_t> axes = chosen_axes(machine, spec.compare);
  for (const std::size_t i : axes) result.axes.push_back(machine.axes[i].first);
  const bool known =
      with_axes(axes.size(), [&](auto n) { tune_axes<n>(machine, knowledge, spec, axes, result, progress); });
  if (!known) throw Refused("paths have 1, 2, 3 or 5 axes");
  // The report: results of compare() for both, under equal conditions.
  for (TunedController& c : result.controllers) {
    CompareSpec one = spec.compare;
    one.controllers = {c.start};
    try {
      c.before = scores(compare(machine, knowledge, one), 0, 1);
    } catch (const Refused& e) {
      c.before_refused = e.what();
    }
    if (!c.found()) continue;
    one.controllers = {c.tuned};
    try {
      c.after = scores(compare(machine, knowledge, one), 0, 1);
    } catch (const Refused& e) {
      c.refused = e.what();
    }
    if (spec.nearby && c.found()) score_nearby(machine, knowledge, spec, c);
  }
  return result;
}

TradeOff trade_off(const Machine& machine, const std::vector<AxisKnowledge>& knowledge, const TuneSpec& spec,
                   const std::vector<double>& shares,
                   const std::function<void(std::size_t, std::size_t)>& progress) {
  TradeOff all{shares, {}};
  for (std::size_t i = 0; i < shares.size(); ++i) {
    TuneSpec one = spec;
    one.limits.variation_share = shares[i];
    one.stick_slip = false;
    all.results.push_back(tune(machine, knowledge, one, [&](std::size_t done, std::size_t of) {
      if (progress) progress(i * of + done, shares.size() * of);
    }));
  }
  return all;
}

}  // namespace stribeck::sim
