#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stribeck/friction/unbalance.hpp>
#include <stribeck/sim/compare.hpp>
#include <stribeck/sim/cutting_estimate.hpp>
#include <stribeck/sim/parallel.hpp>
#include <stribeck/sim/study/loop_margins.hpp>
#include <stribeck/sim/trials_together.hpp>

namespace stribeck::sim {
namespace {

void summarise(const std::vector<Metrics>& trials, Metrics& mean, Metrics& spread) {
  const double n = static_cast<double>(trials.size());
  for_each_number([&](auto get) {
    double sum = 0.0;
    for (const Metrics& m : trials) sum += get(m);
    const double average = sum / n;
    double square = 0.0;
    for (const Metrics& m : trials) square += (get(m) - average) * (get(m) - average);
    get(mean) = average;
    get(spread) = trials.size() > 1 ? std::sqrt(square / (n - 1.0)) : Metrics::kUnknown;
  });
}

/// Whether the output of a law jumps with the sign of a measurement: two simulations of it never agree sample by sample.
bool switches(const control::LawParams& law) {
  const auto* sliding = std::get_if<control::SlidingModeParams>(&law);
  return sliding != nullptr && (sliding->switching == control::Switching::kSign ||
                                sliding->switching == control::Switching::kSuperTwisting);
}

std::string name_of(const ControllerSpec& c, double speed) {
  std::string text = "controller (" + c.id + ")";
  if (std::isfinite(speed)) text += fmt::format(" at {:.6g} mm/s", speed * 1e3);
  return text;
}

/// Refuses gains that cannot work before anything runs: unstable when sampled, or without the requested switching gain.
template <std::size_t N>
void check_law(const ControllerSpec& which, const control::Setup<N>& setup) {
  std::visit(
      [&](const auto& params) {
        if constexpr (requires { params.stable(setup.period); }) {
          if (!params.stable(setup.period)) {
            throw Refused(
                fmt::format("its gains are unstable at a control period of {:.4g} ms (choose lower ones)",
                            setup.period * 1e3));
          }
        }
      },
      which.law);
  const auto* sliding = std::get_if<control::SlidingModeParams>(&which.law);
  if (sliding != nullptr) {
    const auto bounds = control::spread<N>(sliding->mass_bound);
    for (std::size_t i = 0; i < N; ++i) {
      const double mass = setup.compensation[i].model.mass;
      if (!(bounds[i] < mass))
        throw Refused(fmt::format(
            "mass_bound is {:.6g} kg, expected less than the mass of an axis, {:.6g} kg (choose a smaller one)",
            bounds[i], mass));
    }
  }
  if (sliding != nullptr && sliding->gain == control::SwitchingGain::kSufficient &&
      !control::SlidingMode<N>(*sliding, setup).sufficient_gain_exists()) {
    throw Refused(
        "no sufficient switching gain exists: the sum of mass_bound/(mass - mass_bound) over the axes must be below 1 (choose smaller bounds, or gain = \"printed\")");
  }
}

/// Gains of the drive's own loops: those of the axis file, or else those of the machine.
void take_drive_loop(friction::AxisModel& model, const MachineAxis& machine, const std::string& axis) {
  const std::optional<plant::DriveLoop>& truth = machine.plant.drive_loop;
  if (!truth && machine.drive_loop)
    throw Refused("axis " + axis +
                  ": drive_loop is given, but the simulated drive has none (add plant.drive_loop)");
  if (!truth) {
    if (model.drive_loop)
      throw Refused(
          "axis " + axis +
          ": the axis file is for a drive with a loop of its own (drive_loop), the machine's takes a "
          "force (add plant.drive_loop to the machine, or take drive_loop out of the axis file)");
    return;
  }
  if (!model.drive_loop) model.drive_loop = machine.known_loop();
  if (model.drive_loop->mode != truth->loop.mode ||
      (model.drive_loop->force_offset && !truth->loop.force_offset))
    throw Refused("axis " + axis +
                  ": drive_loop of the axis file and of the machine have different commands");
}

template <std::size_t N>
struct Cell {
  std::shared_ptr<const Route<N>> route;
  control::Setup<N> setup;
  AnyController<N> controller;
  std::vector<StatusCounter> status;
};

/// Means and spreads of a row, or why it has none.
void conclude(CompareRow& row, const std::vector<StatusCounter>& status, double size) {
  for (const Metrics& m : row.trials) {
    if (row.refused.empty() && !(m.max_contour_error <= kLost * size)) {
      row.refused =
          std::isinf(m.max_contour_error)
              ? "the loop does not follow the path: an axis moves less than half as far as it should (friction holds it: gains too low, a wrong unit of a gain, or a drive without force)"
              : "with noise, encoder and D/A converter the loop does not follow the path (error above a tenth of its extent)";
    }
  }
  if (!row.refused.empty()) {
    row.mean = row.spread = Metrics::unknown();
    row.trials.clear();
    row.trace.clear();
    row.drift.clear();
    row.substeps = 0;
    return;
  }
  summarise(row.trials, row.mean, row.spread);
  for (const StatusCounter& s : status) {
    for (std::size_t k = 0; k < s.counts.size(); ++k) row.status.counts[k] += s.counts[k];
    if (row.status.first == Status::kOk) row.status.first = s.first;
  }
}

/// Trials that were not computed are as the first.
template <class T>
void repeat_trials(std::vector<T>& trials, std::uint32_t computed) {
  if (computed > 0) std::fill(trials.begin() + computed, trials.end(), trials.front());
}

/// A cell and a row for every travel and controller; a row that cannot run says why. Also sets the largest speed of the routes.
template <std::size_t N>
std::vector<Cell<N>> make_cells(const Machine& machine, const std::vector<AxisKnowledge>& knowledge,
                                const CompareSpec& spec, const std::vector<std::size_t>& axes,
                                std::vector<CompareRow>& rows, double& fastest) {
  std::vector<Cell<N>> cells;
  for (std::size_t t = 0; t < spec.travels.size(); ++t) {
    const Travel& travel = spec.travels[t];
    const auto route = std::make_shared<const Route<N>>(sample<N>(travel, machine.sample_time));
    for (const auto& p : route->points) fastest = std::max(fastest, norm(p.velocity));
    const double speed = travel.constant_speed();
    for (const ControllerSpec& c : spec.controllers) {
      CompareRow row;
      auto setup = make_setup<N>(machine, knowledge, axes, c);
      row.calmed = calm<N>(setup, c);
      setup.lap = route->lap;
      cells.push_back({route, setup, {}, std::vector<StatusCounter>(spec.trials)});
      row.controller = c;
      row.travel = t;
      row.speed = speed;
      row.trials.resize(spec.trials);
      try {
        cells.back().route = guide_motors<N>(route, machine, knowledge, axes, c, setup);
        cells.back().setup = setup;
        check_law<N>(c, setup);
        cells.back().controller = make_controller<N>(c.law, setup);
      } catch (const Refused& e) {
        row.refused = e.what();
      }
      rows.push_back(std::move(row));
    }
  }
  return cells;
}

template <std::size_t N>
void compare_axes(const Machine& machine, const std::vector<AxisKnowledge>& knowledge,
                  const CompareSpec& spec, const std::vector<std::size_t>& axes, CompareResult& result,
                  const std::function<void(std::size_t, std::size_t)>& progress) {
  double fastest = 0.0;
  std::vector<Cell<N>> cells = make_cells<N>(machine, knowledge, spec, axes, result.rows, fastest);
  const auto make_drives = [&] { return EqualDrives([&] { return Drives(machine, axes, 1.05 * fastest); }); };
  const std::uint32_t computed = trials_that_differ(machine, axes, spec.trials);
  const TrialShares shares(computed, cells.size(), spec.threads);
  const std::size_t total = cells.size() * (shares.count() + 1);
  std::size_t before = 0;
  const auto report = [&](std::size_t done, std::size_t) {
    if (progress) progress(before + done, total);
  };
  parallel_for(
      cells.size(), spec.threads, make_drives,
      [&](EqualDrives& drives, std::size_t i) {
        CompareRow& row = result.rows[i];
        if (!row.refused.empty()) return;
        try {
          row.substeps = substeps_for<N>(drives[0], cells[i].setup, row.controller, *cells[i].route,
                                         spec.accuracy, &row.repeatable);
        } catch (const Refused& e) {
          row.refused = e.what();
        }
      },
      report);
  before = cells.size();
  parallel_for(
      cells.size() * shares.count(), spec.threads, make_drives,
      [&](EqualDrives& drives, std::size_t job) {
        Cell<N>& cell = cells[job / shares.count()];
        CompareRow& row = result.rows[job / shares.count()];
        if (!row.refused.empty()) return;
        const auto [first, last] = shares[job % shares.count()];
        std::vector<RunTogether<N>> runs;
        for (std::uint32_t trial = first; trial < last; ++trial)
          runs.push_back({&drives[trial - first],
                          cell.controller,
                          {row.substeps, true, true},
                          trial,
                          trial == 0 ? &row.trace : nullptr,
                          trial == 0 ? &row.drift : nullptr});
        const std::vector<RunResult> results = Drives::run_together<N>(runs, *cell.route, spec.seed);
        for (std::uint32_t trial = first; trial < last; ++trial) {
          row.trials[trial] = results[trial - first].metrics;
          cell.status[trial] = results[trial - first].status;
        }
        if (const auto& cutting = spec.travels[row.travel].cutting; first == 0 && cutting)
          estimate_cutting<N>(row.trace, *cutting, cell.setup);
      },
      report);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    repeat_trials(result.rows[i].trials, computed);
    repeat_trials(cells[i].status, computed);
    conclude(result.rows[i], cells[i].status, cells[i].route->size);
  }
  const auto done = [](const CompareRow& row) { return row.refused.empty(); };
  if (std::none_of(result.rows.begin(), result.rows.end(), done)) {
    const CompareRow& first = result.rows.front();
    throw Refused(name_of(first.controller, first.speed) + ": " + first.refused);
  }
}

}  // namespace

std::vector<ControllerSpec> biaxial_controllers(const control::LawParams& law, control::Observer observer,
                                                double observer_pole) {
  using enum FrictionUse;
  constexpr auto kWithout = control::Observer::kNone;
  std::vector<ControllerSpec> all{{"a", "no friction compensation", kNone, kWithout},
                                  {"b", "conventional friction model", kConventional, kWithout},
                                  {"c", "Gaussian friction model", kGaussian, kWithout},
                                  {"d", "disturbance observer only", kNone, observer},
                                  {"e", "observer + conventional model", kConventional, observer},
                                  {"f", "observer + Gaussian model", kGaussian, observer}};
  for (ControllerSpec& c : all) {
    c.law = law;
    c.observer_pole = observer_pole;
  }
  return all;
}

namespace {

/// Takes terms periodic in position out, less an unbalance: that is no friction.
void keep_unbalance(friction::Model& model) {
  friction::Model without = model;
  without.eccentric = {};
  for (const auto& term : model.eccentric)
    if (friction::is_unbalance(term)) without.eccentric.push_back(term);
  model = without;
}

}  // namespace

friction::AxisModel AxisKnowledge::model(FrictionUse use, const std::string& axis) const {
  const auto need = [&](const std::optional<friction::AxisModel>& m,
                        const char* kind) -> const friction::AxisModel& {
    if (!m)
      throw Refused("axis " + axis + ": no " + kind +
                    " friction model is available for it (identify one, or choose other controllers)");
    return *m;
  };
  switch (use) {
    case FrictionUse::kNone:
      break;
    case FrictionUse::kViscous: {
      friction::AxisModel m = need(conventional, "conventional");
      std::visit([](auto& map) { map = map.viscous_alone(); }, m.friction.steady);
      keep_unbalance(m.friction);
      return m;
    }
    case FrictionUse::kConventional:
      return need(conventional, "conventional");
    case FrictionUse::kGaussian:
      return need(gaussian, "Gaussian");
    case FrictionUse::kEccentric:
      return need(eccentric, "eccentric");
    case FrictionUse::kWhole:
      return need(whole, "whole");
    case FrictionUse::kNominal: {
      friction::AxisModel m = need(eccentric, "eccentric");
      keep_unbalance(m.friction);
      return m;
    }
  }
  for (const auto* m : {&eccentric, &conventional, &gaussian, &whole}) {
    if (*m) return **m;
  }
  return need(conventional, "conventional");
}

std::vector<std::size_t> chosen_axes(const Machine& machine, const CompareSpec& spec) {
  std::vector<std::size_t> axes = spec.axes;
  if (axes.empty()) {
    for (std::size_t i = 0; i < spec.travels.front().axes(); ++i) axes.push_back(i);
  }
  for (const std::size_t i : axes) {
    if (i >= machine.axes.size()) {
      throw Refused("the path has " + std::to_string(axes.size()) + " axes, the machine \"" + machine.name +
                    "\" has " + std::to_string(machine.axes.size()));
    }
  }
  return axes;
}

friction::Model straightened(const friction::Model& model, double fastest) {
  constexpr int kPoints = 400;
  friction::Gaussian<double> line;
  line.velocity_range = {-fastest, fastest};
  for (const double side : {1.0, -1.0}) {
    double v1 = 0.0;
    double v2 = 0.0;
    double f1 = 0.0;
    double vf = 0.0;
    for (int i = 1; i <= kPoints; ++i) {
      const double v = side * fastest * (i - 0.5) / kPoints;
      const auto p = model.parts(v, 0.0);
      const double f = p.level * side + p.viscous;
      v1 += v;
      v2 += v * v;
      f1 += f;
      vf += v * f;
    }
    auto& branch = side > 0.0 ? line.positive : line.negative;
    branch.eta1 = (kPoints * vf - v1 * f1) / (kPoints * v2 - v1 * v1);
    branch.eta0 = (f1 - branch.eta1 * v1) / kPoints;
  }
  friction::Model straight;
  straight.steady = line;
  straight.spring = model.spring;
  straight.eccentric = model.eccentric;
  keep_unbalance(straight);
  return straight;
}

control::Feedforward feedforward_with(const ControllerSpec& which, const friction::AxisModel& model) {
  using enum control::Feedforward;
  if (which.friction == FrictionUse::kNone) return kNone;
  const bool step =
      which.feedforward == kDynamic && std::holds_alternative<friction::Static>(model.friction.dynamics);
  return step && which.adaptation.enabled ? kReversal : which.feedforward;
}

template <std::size_t N>
control::Setup<N> make_setup(const Machine& machine, const std::vector<AxisKnowledge>& knowledge,
                             const std::vector<std::size_t>& axes, const ControllerSpec& which) {
  control::Setup<N> setup;
  setup.period = machine.sample_time;
  const Vec<double, N> adaptive = control::spread<N>(which.adaptive_gain, 20.0);
  for (std::size_t i = 0; i < N; ++i) {
    const auto& [name, axis] = machine.axes[axes[i]];
    control::CompensationParams& c = setup.compensation[i];
    c.model = knowledge[axes[i]].model(which.friction, name);
    if (which.friction == FrictionUse::kNominal)
      c.model.friction = straightened(c.model.friction, axis.limits.speed);
    take_drive_loop(c.model, axis, name);
    c.feedforward = feedforward_with(which, c.model);
    c.observer = which.observer;
    c.observer_pole = which.observer_pole;
    c.adaptive_gain = adaptive[i];
    c.disturbance_density = which.disturbance_density;
    c.guarded = which.feedforward != control::Feedforward::kSteady || which.adaptation.enabled;
    c.adaptation = which.adaptation;
    c.reversal = which.reversal;
    if (!control::delay_fits(c.model.delay_or_none(), machine.sample_time)) {
      throw Refused(
          fmt::format("axis {}: a delay of {:.4g} ms, expected at most {} control periods ({:.4g} ms)", name,
                      c.model.delay_or_none() * 1e3, control::kMostDelay,
                      static_cast<double>(control::kMostDelay) * machine.sample_time * 1e3));
    }
    const NamePlate plate = axis.name_plate();
    c.encoder_resolution = plate.encoder_resolution;
    setup.force_limit[i] = plate.force;
  }
  return setup;
}

template <std::size_t N>
std::vector<std::size_t> calm(control::Setup<N>& setup, const ControllerSpec& which) {
  constexpr double kNoDelay = 0.1;  // periods: less than what the logs tell of it
  // 2.5 dB. With 1.35 (biaxial table, one period late) the Kalman observer leaves 0.29 um where the other one leaves 0.46; with 1.30 and
  // 1.13 (random machines) the loop oscillates.
  constexpr double kLeastGain = 4.0 / 3.0;
  std::vector<std::size_t> late;
  if (!which.adaptation.enabled || which.observer != control::Observer::kKalman) return late;
  for (std::size_t i = 0; i < N; ++i) {
    const control::CompensationParams& c = setup.compensation[i];
    if (c.delay() > kNoDelay * setup.period && !c.model.drive_loop) late.push_back(i);
  }
  if (late.empty()) return late;
  try {
    const LoopMargins margins = loop_margins<N>(which.law, setup);
    if (margins.stable && margins.gain >= kLeastGain) return {};
  } catch (const Refused&) {
    return {};  // a law without margins: the guard of the compensation remains
  }
  for (const std::size_t i : late)
    setup.compensation[i] = control::Compensation::calmed(setup.compensation[i]);
  return late;
}

template <std::size_t N>
int substeps_for(Drives& drives, const control::Setup<N>& setup, const ControllerSpec& which,
                 const Route<N>& route, double accuracy, bool* repeatable) {
  const control::LawParams law =
      switches(which.law) ? control::LawParams(control::ContouringParams::critical(40.0, 40.0)) : which.law;
  return choose_substeps<N>(drives, make_controller<N>(law, setup), route, accuracy, repeatable);
}

#define STRIBECK_INSTANTIATE(N)                                                                           \
  template control::Setup<N> make_setup<N>(const Machine&, const std::vector<AxisKnowledge>&,             \
                                           const std::vector<std::size_t>&, const ControllerSpec&);       \
  template std::vector<std::size_t> calm<N>(control::Setup<N>&, const ControllerSpec&);                   \
  template int substeps_for<N>(Drives&, const control::Setup<N>&, const ControllerSpec&, const Route<N>&, \
                               double, bool*);
STRIBECK_INSTANTIATE(1)
STRIBECK_INSTANTIATE(2)
STRIBECK_INSTANTIATE(3)
STRIBECK_INSTANTIATE(5)
#undef STRIBECK_INSTANTIATE

CompareResult run_once(const Machine& machine, const std::vector<AxisKnowledge>& knowledge,
                       const CompareSpec& spec, std::uint32_t trial) {
  CompareResult result{machine.name, spec, machine.sample_time, {}, {}};
  result.spec.travels.resize(1);
  result.spec.controllers.resize(1);
  result.spec.trials = 1;
  const std::vector<std::size_t> axes = chosen_axes(machine, spec);
  for (const std::size_t i : axes) result.axes.push_back(machine.axes[i].first);
  with_axes(axes.size(), [&](auto n) {
    constexpr std::size_t kAxes = n;
    const Travel& travel = spec.travels.front();
    auto route = std::make_shared<const Route<kAxes>>(sample<kAxes>(travel, machine.sample_time));
    double fastest = 0.0;
    for (const Travel& one : spec.travels) {
      const Route<kAxes> sampled = sample<kAxes>(one, machine.sample_time);
      for (const auto& p : sampled.points) fastest = std::max(fastest, norm(p.velocity));
    }
    Drives drives(machine, axes, 1.05 * fastest);
    CompareRow row;
    row.controller = spec.controllers.front();
    row.speed = travel.constant_speed();
    auto setup = make_setup<kAxes>(machine, knowledge, axes, row.controller);
    row.calmed = calm<kAxes>(setup, row.controller);
    setup.lap = route->lap;
    check_law<kAxes>(row.controller, setup);
    route = guide_motors<kAxes>(route, machine, knowledge, axes, row.controller, setup);
    row.substeps = substeps_for<kAxes>(drives, setup, row.controller, *route, spec.accuracy, &row.repeatable);
    row.mean =
        drives.run<kAxes>(make_controller<kAxes>(row.controller.law, setup), *route,
                          {row.substeps, true, true}, spec.seed, trial, &row.trace, &row.status, &row.drift);
    row.spread = Metrics::unknown();
    result.rows.push_back(std::move(row));
  });
  return result;
}

CompareResult compare(const Machine& machine, const std::vector<AxisKnowledge>& knowledge,
                      const CompareSpec& spec,
                      const std::function<void(std::size_t, std::size_t)>& progress) {
  CompareResult result{machine.name, spec, machine.sample_time, {}, {}};
  const std::vector<std::size_t> axes = chosen_axes(machine, spec);
  for (const std::size_t i : axes) result.axes.push_back(machine.axes[i].first);
  const bool known = with_axes(
      axes.size(), [&](auto n) { compare_axes<n>(machine, knowledge, spec, axes, result, progress); });
  if (!known) throw Refused("paths have 1, 2, 3 or 5 axes");
  return result;
}

}  // namespace stribeck::sim
