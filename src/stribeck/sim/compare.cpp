#include <algorithm>
#include <cstdio>
#include <stribeck/sim/compare.hpp>
#include <stribeck/sim/parallel.hpp>

namespace stribeck::sim {
namespace {

/// Applies f(double& into, member of each) to every figure, so that mean and spread name no figure twice.
template <class F>
void for_each_figure(F&& f) {
  f([](auto& m) -> auto& { return m.max_contour_error; });
  f([](auto& m) -> auto& { return m.quadrant_glitch; });
  f([](auto& m) -> auto& { return m.rms; });
  f([](auto& m) -> auto& { return m.sd; });
  f([](auto& m) -> auto& { return m.mean_abs; });
  f([](auto& m) -> auto& { return m.mean_abs_tracking[0]; });
  f([](auto& m) -> auto& { return m.mean_abs_tracking[1]; });
  f([](auto& m) -> auto& { return m.power; });
  f([](auto& m) -> auto& { return m.mean_abs_ui; });
  f([](auto& m) -> auto& { return m.input_variation; });
}

void summarise(const std::vector<Metrics>& trials, Metrics& mean, Metrics& spread) {
  const double n = static_cast<double>(trials.size());
  for_each_figure([&](auto get) {
    double sum = 0.0;
    for (const Metrics& m : trials) sum += get(m);
    const double average = sum / n;
    double square = 0.0;
    for (const Metrics& m : trials) square += (get(m) - average) * (get(m) - average);
    get(mean) = average;
    get(spread) =
        trials.size() > 1 ? std::sqrt(square / (n - 1.0)) : std::numeric_limits<double>::quiet_NaN();
  });
}

}  // namespace

std::vector<ControllerSpec> biaxial_controllers() {
  using enum FrictionUse;
  using control::Observer;
  return {{"a", "no friction compensation", kNone, Observer::kNone},
          {"b", "conventional friction model", kConventional, Observer::kNone},
          {"c", "Gaussian friction model", kGaussian, Observer::kNone},
          {"d", "disturbance observer only", kNone, Observer::kDisturbance},
          {"e", "observer + conventional model", kConventional, Observer::kDisturbance},
          {"f", "observer + Gaussian model", kGaussian, Observer::kDisturbance}};
}

control::Contouring make_controller(const Machine& machine, const std::vector<AxisKnowledge>& knowledge,
                                    const CompareSpec& spec, const ControllerSpec& which) {
  control::Contouring::Params p;
  p.tangential = control::Gains::critical(spec.omega_t);
  p.normal = control::Gains::critical(spec.omega_n);
  p.error_rate = spec.error_rate;
  for (std::size_t i = 0; i < 2; ++i) {
    const AxisKnowledge& k = knowledge[i];
    control::CompensationParams& c = p.compensation[i];
    c.model = which.friction == FrictionUse::kGaussian ? k.gaussian : k.conventional;
    c.friction_feedforward = which.friction != FrictionUse::kNone;
    c.observer = which.observer == control::Observer::kNone ? control::Observer::kNone : spec.observer;
    c.observer_pole = spec.observer_pole;
    c.encoder_resolution = machine.axes[i].second.plant.encoder.resolution;
    p.force_limit[i] = machine.axes[i].second.force_limit();
  }
  return {p, machine.sample_time};
}

CompareResult compare(const Machine& machine, const std::vector<AxisKnowledge>& knowledge,
                      const CompareSpec& spec,
                      const std::function<void(std::size_t, std::size_t)>& progress) {
  CompareResult result{machine.name, spec, machine.sample_time, {}, {}};
  for (const auto& [name, axis] : machine.axes) result.axes.push_back(name);
  const double v_max = 1.05 * *std::max_element(spec.speeds.begin(), spec.speeds.end());

  struct Cell {
    Travel travel;
    const std::vector<path::PathPoint>* reference;
    control::Contouring controller;
    std::vector<Metrics> trials;
    std::vector<StatusCounter> status;
  };
  std::vector<std::vector<path::PathPoint>> references;
  references.reserve(spec.speeds.size());
  std::vector<Cell> cells;
  for (const double speed : spec.speeds) {
    const Travel travel{spec.curve, speed, spec.laps, spec.run_in};
    references.push_back(sample_reference(travel, machine.sample_time));
    for (const ControllerSpec& c : spec.controllers) {
      cells.push_back({travel, &references.back(), make_controller(machine, knowledge, spec, c),
                       std::vector<Metrics>(spec.trials), std::vector<StatusCounter>(spec.trials)});
      result.rows.push_back({c, speed, {}, {}, {}, {}, 0});
    }
  }

  const auto make_table = [&] { return Table2(machine, v_max); };
  const std::size_t total = cells.size() * (spec.trials + 1);
  std::size_t before = 0;
  const auto report = [&](std::size_t done, std::size_t) {
    if (progress) progress(before + done, total);
  };
  parallel_for(
      cells.size(), spec.threads, make_table,
      [&](Table2& table, std::size_t i) {
        const CompareRow& row = result.rows[i];
        try {
          result.rows[i].substeps = choose_substeps(table, cells[i].controller, cells[i].travel,
                                                    *cells[i].reference, machine.sample_time, spec.accuracy);
        } catch (const Refused& e) {
          char where[64];
          std::snprintf(where, sizeof where, "%.6g mm/s", row.speed * 1e3);
          throw Refused("controller (" + row.controller.id + ") at " + where + ": " + e.what());
        }
      },
      report);
  before = cells.size();
  parallel_for(
      cells.size() * spec.trials, spec.threads, make_table,
      [&](Table2& table, std::size_t job) {
        Cell& cell = cells[job / spec.trials];
        CompareRow& row = result.rows[job / spec.trials];
        const auto trial = static_cast<std::uint32_t>(job % spec.trials);
        cell.trials[trial] =
            table.run(cell.controller, cell.travel, *cell.reference, {row.substeps, true, true}, spec.seed,
                      trial, trial == 0 ? &row.trace : nullptr, &cell.status[trial]);
      },
      report);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    summarise(cells[i].trials, result.rows[i].mean, result.rows[i].spread);
    for (const StatusCounter& s : cells[i].status) {
      for (std::size_t k = 0; k < s.counts.size(); ++k) result.rows[i].status.counts[k] += s.counts[k];
      if (result.rows[i].status.first == Status::kOk) result.rows[i].status.first = s.first;
    }
  }
  return result;
}

}  // namespace stribeck::sim
