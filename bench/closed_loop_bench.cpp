/// W1: two revolutions of a circle of 10 mm at 9.5 mm/s on the biaxial table, controller (f), no noise, no
/// quantisers, LuGre with 2.5e5 N/mm. Same controller, same reference, same contour error for everyone; only
/// the solver of the plant differs.
///
/// Counters: sim_s_per_s  simulated seconds per second of one core
///           deviation_nm largest difference of the contour error at the ticks from a converged run

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <boost/numeric/odeint/stepper/runge_kutta4.hpp>
#include <cmath>
#include <stribeck/sim/test_machine.hpp>

namespace {

using namespace stribeck;

struct W1 {
  sim::Machine machine = sim::test::biaxial_table();
  sim::Travel travel{{path::Shape::kCircle, 10e-3}, 9.5e-3, 2.0, 1.0};
  std::vector<path::PathPoint> reference;
  control::Contouring controller;

  W1()
      : reference((adapt(machine), sim::sample_reference(travel, machine.sample_time))),
        controller(sim::make_controller(machine, sim::test::printed(), sim::test::bi_table(),
                                        sim::biaxial_controllers()[5])) {}

  static void adapt(sim::Machine& m) {
    for (auto& [name, axis] : m.axes) {
      std::get<friction::LuGre<double>>(axis.plant.friction.dynamics).sigma0 = 2.5e8;
      axis.plant.noise.reset();
    }
  }
  [[nodiscard]] double seconds() const { return static_cast<double>(reference.size()) * machine.sample_time; }
};

const W1& w1() {
  static const W1 instance;
  return instance;
}

std::vector<double> stribeck_trace(int substeps) {
  const W1& w = w1();
  sim::Table2 table(w.machine, 1.05 * w.travel.speed);
  std::vector<sim::ContourSample> seen;
  table.run(w.controller, w.travel, w.reference, {substeps, false, false}, 1, 0, &seen);
  std::vector<double> trace;
  for (const auto& s : seen) trace.push_back(s.contour_error);
  return trace;
}

const std::vector<double>& converged() {
  static const std::vector<double> trace = stribeck_trace(600);
  return trace;
}

double deviation_nm(const std::vector<double>& trace) {
  double worst = 0.0;
  for (std::size_t k = 0; k < trace.size(); ++k) worst = std::max(worst, std::abs(trace[k] - converged()[k]));
  return worst * 1e9;
}

void set_counters(benchmark::State& state, double deviation) {
  state.counters["sim_s_per_s"] = benchmark::Counter(w1().seconds() * static_cast<double>(state.iterations()),
                                                     benchmark::Counter::kIsRate);
  state.counters["deviation_nm"] = deviation;
}

void Stribeck(benchmark::State& state) {
  const W1& w = w1();
  sim::Table2 table(w.machine, 1.05 * w.travel.speed);
  const int substeps =
      sim::choose_substeps(table, w.controller, w.travel, w.reference, w.machine.sample_time, 1e-9);
  for (auto _ : state) {
    benchmark::DoNotOptimize(table.run(w.controller, w.travel, w.reference, {substeps, false, false}, 1, 0));
  }
  state.counters["substeps"] = substeps;
  set_counters(state, deviation_nm(stribeck_trace(substeps)));
}
BENCHMARK(Stribeck)->Unit(benchmark::kMillisecond);

// ---- the peer: Boost.odeint, classical RK4, the friction curve evaluated as it is written

using State = std::array<double, 6>;  // x, v, z of both axes

struct Plant {
  std::array<friction::Gaussian<double>, 2> map;
  std::array<friction::LuGre<double>, 2> law;
  std::array<double, 2> mass;
  std::array<double, 2> force{};

  void operator()(const State& y, State& d, double) const {
    for (std::size_t i = 0; i < 2; ++i) {
      const double v = y[3 * i + 1];
      const double z = y[3 * i + 2];
      const auto p = map[i].parts(v, y[3 * i]);
      const double rate = law[i].rate(z, v, p);
      d[3 * i] = v;
      d[3 * i + 1] = (force[i] - law[i].force(z, rate, v, p)) / mass[i];
      d[3 * i + 2] = rate;
    }
  }
};

template <class OnTick>
void odeint_run(int substeps, OnTick&& on_tick) {
  const W1& w = w1();
  Plant plant;
  State y{};
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& p = w.machine.axes[i].second.plant;
    plant.map[i] = std::get<friction::Gaussian<double>>(p.friction.steady);
    plant.law[i] = std::get<friction::LuGre<double>>(p.friction.dynamics);
    plant.mass[i] = p.mass;
    y[3 * i] = w.reference[0].position[i];
  }
  boost::numeric::odeint::runge_kutta4<State> stepper;
  control::Contouring::State state;
  const double h = w.machine.sample_time / substeps;
  for (const path::PathPoint& r : w.reference) {
    const Vec2 position{{y[0], y[3]}};
    on_tick(path::contour_error(w.travel.curve, position, r.phi));
    const Vec2 force = w.controller.step(state, r, position);
    plant.force = {force[0], force[1]};
    for (int i = 0; i < substeps; ++i) stepper.do_step(std::cref(plant), y, 0.0, h);
  }
}

void OdeintRk4(benchmark::State& state) {
  const int substeps = static_cast<int>(state.range(0));
  std::vector<double> trace;
  odeint_run(substeps, [&](double e) { trace.push_back(e); });
  for (auto _ : state) {
    double worst = 0.0;
    odeint_run(substeps, [&](double e) { worst = std::max(worst, std::abs(e)); });
    benchmark::DoNotOptimize(worst);
  }
  set_counters(state, deviation_nm(trace));
}
BENCHMARK(OdeintRk4)->Arg(3)->Arg(5)->Arg(6)->Arg(8)->Unit(benchmark::kMillisecond);

}  // namespace
