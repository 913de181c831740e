#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <stribeck/sim/experiments.hpp>
#include <stribeck/sim/parallel.hpp>
#include <stribeck/sim/study/robustness.hpp>
#include <thread>
#include <utility>

namespace stribeck::sim {
namespace {

void run_machines(const Machine& nominal, const std::vector<AxisKnowledge>& knowledge,
                  const RobustnessSpec& spec, const std::vector<std::size_t>& axes, RobustnessResult& result,
                  const std::function<void(std::size_t, std::size_t)>& progress) {
  const MachineRuns runs(nominal, knowledge, spec.travels, axes, spec.controllers, spec.seed);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    RobustRow row;
    row.controller = spec.controllers[i % spec.controllers.size()];
    row.travel = i / spec.controllers.size();
    row.runs.resize(spec.machines);
    result.rows.push_back(std::move(row));
  }
  const auto keep = [&](RunsOfMachine&& of, auto&& place) {
    if (of.refused) std::rethrow_exception(of.refused);
    for (std::size_t i = 0; i < of.runs.size(); ++i) place(result.rows[i]) = of.runs[i];
  };
  // The nominal machine is a job of its own; of the others as many together as fill the packs, where all threads have enough of them.
  const std::size_t threads =
      spec.threads > 0 ? spec.threads : std::max(1U, std::thread::hardware_concurrency());
  const std::size_t together =
      std::clamp<std::size_t>(spec.machines / (2 * threads), 1, MachineRuns::kTogether);
  const std::size_t blocks = (spec.machines + together - 1) / together;
  const auto machines_before = [&](std::size_t block) {
    return std::min<std::size_t>(block * together, spec.machines);
  };
  std::atomic<std::size_t> finished{0};
  parallel_for(
      blocks + 1, spec.threads, [] { return 0; },
      [&](int&, std::size_t job) {
        if (job == 0) {
          keep({runs.run(nominal, 0), {}}, [](RobustRow& row) -> RobustRun& { return row.nominal; });
          return;
        }
        std::vector<MachineTrial> some;
        for (std::size_t m = machines_before(job - 1); m < machines_before(job); ++m) {
          const auto trial = static_cast<std::uint32_t>(m);
          some.push_back({vary(nominal, spec.variation, spec.seed, trial), trial});
        }
        std::vector<RunsOfMachine> of_all = runs.run_together(some);
        for (std::size_t k = 0; k < some.size(); ++k)
          keep(std::move(of_all[k]), [&](RobustRow& row) -> RobustRun& { return row.runs[some[k].trial]; });
        finished += some.size();
      },
      [&](std::size_t, std::size_t) {
        if (progress) progress(finished, spec.machines);
      });
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
  run_machines(nominal, knowledge, spec, axes, result, progress);
  return result;
}

double interpolated_quantile(std::vector<double> values, double p) {
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
  return {interpolated_quantile(values, 0.5), interpolated_quantile(values, 0.9),
          interpolated_quantile(values, 0.99), interpolated_quantile(values, 1.0)};
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
