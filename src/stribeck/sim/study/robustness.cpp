#include <algorithm>
#include <cmath>
#include <limits>
#include <stribeck/sim/experiments.hpp>
#include <stribeck/sim/parallel.hpp>
#include <stribeck/sim/study/robustness.hpp>
#include <utility>

namespace stribeck::sim {
namespace {

/// A loop that is at the limit of its drives for more than this share of the ticks, and whose input varies by more than that share of
/// its range while it is scored, is held together by the limit. Stable loops of V2 vary by 1 % with the coarsest encoder.
constexpr double kMostLimited = 1e-3;
constexpr double kMostShaking = 0.02;

/// Sub-steps of order three at 0.8 of the fastest rate: twice as fine as stability needs, and no fewer than for nominal machines.
constexpr double kRatePerSubstep = 0.8;
constexpr int kFewestSubsteps = 6;

int substeps_of(const Drives& drives) {
  const double n = std::ceil(drives.rate_bound() * drives.period() / kRatePerSubstep);
  if (!(n <= kMostSubsteps))
    throw Refused("the machine needs more than 512 sub-steps per control period for its fastest rate");
  return std::max(kFewestSubsteps, static_cast<int>(n));
}

template <std::size_t N>
void run_machines(const Machine& nominal, const std::vector<AxisKnowledge>& knowledge,
                  const RobustnessSpec& spec, const std::vector<std::size_t>& axes, RobustnessResult& result,
                  const std::function<void(std::size_t, std::size_t)>& progress) {
  std::vector<Route<N>> routes;
  std::vector<AnyController<N>> controllers;
  double fastest = 0.0;
  for (const Travel& travel : spec.travels) {
    routes.push_back(sample<N>(travel, nominal.sample_time));
    for (const auto& p : routes.back().points) fastest = std::max(fastest, norm(p.velocity));
    for (const ControllerSpec& c : spec.controllers) {
      auto setup = make_setup<N>(nominal, knowledge, axes, c);
      setup.lap = routes.back().lap;
      controllers.push_back(make_controller<N>(c.law, setup));
      RobustRow row;
      row.controller = c;
      row.travel = routes.size() - 1;
      row.runs.resize(spec.machines);
      result.rows.push_back(std::move(row));
    }
  }
  const auto run = [&](const Machine& machine, std::uint32_t trial, const auto& place) {
    Drives drives(machine, axes, 1.05 * fastest);
    double range = std::numeric_limits<double>::infinity();
    for (const std::size_t i : axes) range = std::min(range, machine.axes[i].second.plant.converter.range);
    const plant::Fidelity fidelity{substeps_of(drives), true, true};
    for (std::size_t i = 0; i < controllers.size(); ++i) {
      const Route<N>& route = routes[i / spec.controllers.size()];
      StatusCounter status;
      RobustRun& r = place(result.rows[i]);
      r.metrics = drives.run<N>(controllers[i], route, fidelity, spec.seed, trial, nullptr, &status);
      r.limited = status.count(Status::kOutputLimited) / static_cast<double>(N * route.points.size());
      r.lost = !(r.metrics.max_contour_error <= kLost * route.size) ||
               (r.limited > kMostLimited && r.metrics.input_variation > kMostShaking * range);
    }
  };
  parallel_for(
      spec.machines + std::size_t{1}, spec.threads, [] { return 0; },
      [&](int&, std::size_t job) {
        if (job == 0) {
          run(nominal, 0, [](RobustRow& row) -> RobustRun& { return row.nominal; });
          return;
        }
        const auto i = static_cast<std::uint32_t>(job - 1);
        run(vary(nominal, spec.variation, spec.seed, i), i,
            [&](RobustRow& row) -> RobustRun& { return row.runs[i]; });
      },
      progress);
}

}  // namespace

RobustnessResult robustness(const Machine& nominal, const std::vector<AxisKnowledge>& knowledge,
                            const RobustnessSpec& spec,
                            const std::function<void(std::size_t, std::size_t)>& progress) {
  check(spec.variation);
  if (spec.travels.empty() || spec.controllers.empty() || spec.machines == 0)
    throw Refused("a robustness experiment needs a travel, a controller and a machine at least");
  CompareSpec chosen;
  chosen.travels = spec.travels;
  chosen.axes = spec.axes;
  RobustnessResult result{nominal.name, spec, {}, {}, {}};
  const std::vector<std::size_t> axes = chosen_axes(nominal, chosen);
  for (const std::size_t i : axes) result.axes.push_back(nominal.axes[i].first);
  for (std::uint32_t m = 0; m < spec.machines; ++m) {
    std::vector<Deviation>& of_machine = result.deviations.emplace_back();
    for (const std::size_t i : axes)
      of_machine.push_back(draw(spec.variation, spec.seed, m, static_cast<std::uint32_t>(i)));
  }
  const bool known = with_axes(
      axes.size(), [&](auto n) { run_machines<n>(nominal, knowledge, spec, axes, result, progress); });
  if (!known) throw Refused("paths have 1, 2, 3 or 5 axes");
  return result;
}

double quantile(std::vector<double> values, double p) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const double h = p * static_cast<double>(values.size() - 1);
  const auto k = static_cast<std::size_t>(h);
  const double share = h - static_cast<double>(k);
  if (share == 0.0) return values[k];
  // ∞ − ∞ would be NaN.
  return std::isinf(values[k + 1]) ? values[k + 1] : values[k] + share * (values[k + 1] - values[k]);
}

Quantiles quantiles(std::vector<double> values) {
  return {quantile(values, 0.5), quantile(values, 0.9), quantile(values, 0.99), quantile(values, 1.0)};
}

std::vector<double> figures(const RobustRow& row, double Metrics::*figure) {
  std::vector<double> all;
  for (const RobustRun& r : row.runs)
    all.push_back(r.lost ? std::numeric_limits<double>::infinity() : r.metrics.*figure);
  return all;
}

std::vector<double> ratios(const RobustRow& row, const RobustRow& reference, double Metrics::*figure) {
  std::vector<double> all = figures(row, figure);
  const std::vector<double> others = figures(reference, figure);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!row.runs[i].lost) all[i] /= others[i];
  }
  return all;
}

std::size_t lost(const RobustRow& row) {
  return static_cast<std::size_t>(
      std::count_if(row.runs.begin(), row.runs.end(), [](const RobustRun& r) { return r.lost; }));
}

RobustnessSpec robust_biaxial() {
  RobustnessSpec spec;
  for (const double speed : {3e-3, 9.5e-3}) {
    Travel t = along(path::Shape::kCircle, 10e-3, speed, 1.0);
    t.settle_laps = 2.0;
    spec.travels.push_back(std::move(t));
  }
  spec.controllers = robust_controllers();
  return spec;
}

std::vector<ControllerSpec> robust_controllers() {
  std::vector<ControllerSpec> all{biaxial_controllers().back()};
  for (ControllerSpec& c : beyond_controllers(all.front())) all.push_back(std::move(c));
  return all;
}

}  // namespace stribeck::sim
