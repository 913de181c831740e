#pragma once
/// The loop of drill.hpp for a number of axes; each is instantiated in a file of its own, because it holds every law.

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <stribeck/plant/axis.hpp>
#include <stribeck/sim/contour_run.hpp>

#include "drill.hpp"

namespace stribeck::test {

template <std::size_t N>
Drilled run_axes(const Drill& d);

namespace detail {

/// The drives as they are, which is not always as the controllers know them.
inline std::vector<plant::Axis> drives_of(const Drill& d, const sim::Machine& machine,
                                          const std::vector<std::size_t>& axes, double v_max) {
  std::vector<plant::Axis> drives;
  for (const std::size_t i : axes) {
    plant::AxisParams p = machine.axes[i].second.plant;
    p.mass *= d.mass;
    if (d.mode) p.axial_mode = d.mode;
    std::visit(
        [&](auto& map) {
          if constexpr (requires { map.alpha0; }) {
            map.alpha0 *= d.friction;
            map.alpha2 *= d.friction;
            if (map.stribeck) map.stribeck->alpha1 *= d.friction;
          } else if constexpr (requires { map.positive.eta0; }) {
            for (auto* b : {&map.positive, &map.negative}) {
              b->eta0 *= d.friction;
              b->eta1 *= d.friction;
              for (auto& g : b->gaussians) g.a *= d.friction;
            }
          }
        },
        p.friction.steady);
    drives.emplace_back(p, machine.sample_time, v_max);
  }
  return drives;
}

inline std::vector<sim::AxisKnowledge> knowledge_of(const sim::Machine& machine) {
  std::vector<sim::AxisKnowledge> all;
  for (const auto& [name, axis] : machine.axes) {
    sim::AxisKnowledge k;
    k.whole = friction::AxisModel{axis.plant.mass, axis.plant.load, axis.plant.friction};
    k.eccentric = k.whole;
    k.eccentric->friction.dynamics = friction::Static{};
    k.conventional = k.gaussian = k.eccentric;
    all.push_back(k);
  }
  return all;
}

template <std::size_t N>
control::Setup<N> setup_of(const Drill& d, const sim::Machine& machine,
                           const std::vector<std::size_t>& axes) {
  auto setup = sim::make_setup<N>(machine, knowledge_of(machine), axes, d.controller);
  if (d.force_limit) {
    for (std::size_t i = 0; i < N; ++i) setup.force_limit[i] = (*d.force_limit)[i];
  }
  return setup;
}

template <std::size_t N, class Law>
Vec<double, N> step_of(const Law& law, typename Law::State& s, const std::vector<path::PathPoint<N>>& points,
                       std::size_t k, const path::PathPoint<N>& r, const Vec<double, N>& measured) {
  if constexpr (requires { Law::kPreview; }) {
    std::vector<path::PathPoint<N>> ahead(
        points.begin() + static_cast<std::ptrdiff_t>(k),
        points.begin() + static_cast<std::ptrdiff_t>(std::min(k + Law::kPreview + 1, points.size())));
    ahead[0] = r;
    return law.step(s, std::span<const path::PathPoint<N>>(ahead), measured);
  } else {
    return law.step(s, r, measured);
  }
}

}  // namespace detail

template <std::size_t N>
Drilled run_axes(const Drill& d) {
  const sim::Machine machine = d.drawn ? *d.drawn : machine_of(d.machine);
  sim::CompareSpec spec;
  spec.travels = {d.travel};
  spec.axes = d.axes;
  const auto axes = sim::chosen_axes(machine, spec);
  const sim::Route<N> route = sim::sample<N>(d.travel, machine.sample_time);
  auto setup = detail::setup_of<N>(d, machine, axes);
  setup.lap = route.lap;
  control::Supervision<N> limits;
  double v_max = 0.0;
  for (std::size_t i = 0; i < N; ++i) {
    const sim::AxisLimits& l = machine.axes[axes[i]].second.limits;
    limits[i].checks = d.supervised ? control::Checks::kAll : control::Checks::kNone;
    limits[i].speed_limit = l.speed;
    limits[i].acceleration_limit = l.acceleration;
    if (d.omega > 0.0) limits[i].omega = d.omega;
    v_max = std::max(v_max, l.speed);
  }
  const control::Supervisor<N> supervisor(limits, setup);
  auto drives = detail::drives_of(d, machine, axes, 1.05 * v_max);
  double rate = 0.0;
  for (const auto& a : drives) rate = std::max(rate, a.rate_bound());
  const int substeps = std::max(4, static_cast<int>(std::ceil(rate * machine.sample_time)));
  for (std::uint32_t i = 0; i < N; ++i)
    drives[i].start(route.points[0].position[i], {substeps, true, true}, {d.seed, 0, i});

  Drilled result;
  result.period = machine.sample_time;
  result.limit = sim::widened(setup.force_limit);
  const auto loop = [&](const auto& law) {
    using Law = std::decay_t<decltype(law)>;
    auto state = std::make_unique<typename Law::State>();
    typename control::Supervisor<N>::State watch;
    for (std::size_t k = 0; k < route.points.size(); ++k) {
      Tick tick;
      tick.time = static_cast<double>(k) * machine.sample_time;
      if (tick.time > d.duration) break;
      path::PathPoint<N> r = route.points[k];
      const Vec<double, N> programmed = r.position;
      if (tick.time >= d.command_lost) r.position[0] = std::numeric_limits<double>::quiet_NaN();
      Vec<double, N> measured;
      for (std::size_t i = 0; i < N; ++i) {
        tick.position[i] = drives[i].position();
        tick.error = std::max(tick.error, std::abs(tick.position[i] - programmed[i]));
        measured[i] = d.encoder ? d.encoder(tick.time, i, drives[i].encoder()) : drives[i].encoder();
      }
      Vec<double, N> force;
      if (supervisor.admit(watch, *state, r, measured)) {
        const auto wanted = detail::step_of<N>(law, *state, route.points, k, r, measured);
        force = supervisor.judge(watch, *state, r, wanted);
      } else {
        force = supervisor.stopped(watch);
      }
      if (watch.fault != control::Fault::kNone && result.tripped < 0.0) result.tripped = tick.time;
      for (std::size_t i = 0; i < N; ++i) {
        tick.limited = tick.limited || state->compensation[i].limited;
        tick.force[i] = force[i];
        const double acts = d.force ? d.force(tick.time, i, force[i]) : force[i];
        const double cutting = route.cutting.empty() ? 0.0 : route.cutting[k][i];
        drives[i].step(acts / machine.axes[axes[i]].second.plant.force_gain(), cutting);
      }
      result.ticks.push_back(tick);
    }
    result.fault = watch.fault;
    for (const auto& a : watch.axes) result.bridged += a.encoder.bridged;
  };
  std::visit(
      [&](const auto& params) {
        using Law = typename std::decay_t<decltype(params)>::template Controller<N>;
        loop(*std::make_unique<Law>(params, setup));
      },
      d.controller.law);
  return result;
}

template <std::size_t N>
sim::LoopMargins margins_of(const Drill& d) {
  const sim::Machine machine = d.drawn ? *d.drawn : machine_of(d.machine);
  sim::CompareSpec spec;
  spec.travels = {d.travel};
  spec.axes = d.axes;
  const auto axes = sim::chosen_axes(machine, spec);
  sim::DeclaredModes<N> modes;
  for (std::size_t i = 0; i < N; ++i)
    modes[i] = d.mode ? d.mode : machine.axes[axes[i]].second.plant.axial_mode;
  return sim::loop_margins<N>(d.controller.law, detail::setup_of<N>(d, machine, axes), modes);
}

extern template Drilled run_axes<1>(const Drill&);
extern template Drilled run_axes<2>(const Drill&);
extern template Drilled run_axes<3>(const Drill&);
extern template Drilled run_axes<5>(const Drill&);

}  // namespace stribeck::test
