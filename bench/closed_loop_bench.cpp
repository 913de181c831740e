/// W1: two revolutions of a circle of 10 mm at 9.5 mm/s on the biaxial table, controller (f), no noise, no quantisers, LuGre
/// with 2.5e5 N/mm over Table 2.3. Everyone runs the same loop: reference, controller, contour error; only the solver of the
/// plant differs. Two readings of "over Table 2.3":
///
///   whole      g = |f(v)|, nothing outside the bristle: fastest rate times control period 5.7
///   level      g = |f(v) - eta1 v|, eta1 v outside, as in machines/biaxial-table.toml: up to 15 on y, v < 0
///
/// level/Together: sixteen machines with other friction in step, with packs and without.
///
/// Counters: sim_s_per_s  simulated seconds per second of one core
///           deviation_nm largest difference of the contour error at the ticks from a converged run of the peer

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <boost/numeric/odeint/stepper/runge_kutta4.hpp>
#include <cmath>
#include <stribeck/friction/table.hpp>
#include <stribeck/plant/axis_group.hpp>
#include <stribeck/plant/mechanics.hpp>
#include <stribeck/sim/test_machine.hpp>

namespace {

using namespace stribeck;

/// Table 2.3 with its viscous part inside the level; beyond the range the border is held.
struct WholeCurve {
  friction::Gaussian<double> map;
  [[nodiscard]] friction::SteadyParts<double> parts(double v, double x) const noexcept {
    const auto p = map.parts(clamp_to(v, map.velocity_range[0], map.velocity_range[1]), x);
    return {p.level + std::abs(p.viscous), 0.0, 0.0};
  }
  [[nodiscard]] double viscous_coefficient(double) const noexcept { return 0.0; }
};

struct Level {
  friction::Gaussian<double> map;
  [[nodiscard]] friction::SteadyParts<double> parts(double v, double x) const noexcept {
    return map.parts(v, x);
  }
  [[nodiscard]] double viscous_coefficient(double side) const noexcept {
    return map.viscous_coefficient(side);
  }
};

struct W1 {
  sim::Machine machine = sim::test::biaxial_table();
  path::Curve curve{path::Shape::kCircle, 10e-3};
  std::vector<path::PathPoint<2>> reference =
      sim::sample<2>(sim::test::circle(9.5e-3), machine.sample_time).points;
  control::Contouring<2> controller{
      control::ContouringParams::critical(40.0, 40.0),
      sim::make_setup<2>(machine, sim::test::printed(), {0, 1}, sim::biaxial_controllers()[5])};
  friction::LuGre<double> law{2.5e8, 600e3, 0.05e-3};

  [[nodiscard]] const friction::Gaussian<double>& map(std::size_t i) const {
    return std::get<friction::Gaussian<double>>(machine.axes[i].second.plant.friction.steady);
  }
  [[nodiscard]] double seconds() const { return static_cast<double>(reference.size()) * machine.sample_time; }
};

const W1& w1() {
  static const W1 instance;
  return instance;
}

/// The loop that everyone runs. Drives: position(i), advance(forces over one period).
template <class Drives, class OnTick>
void run(Drives& drives, OnTick&& on_tick) {
  const W1& w = w1();
  control::Contouring<2>::State state;
  drives.start(w.reference[0].position);
  for (const path::PathPoint<2>& r : w.reference) {
    const Vec2 position{{drives.position(0), drives.position(1)}};
    on_tick(path::contour_error(w.curve, position, r.phi));
    drives.advance(w.controller.step(state, r, position), w.machine.sample_time);
  }
}

// ---- Stribeck

template <class Map>
class StribeckDrives {
 public:
  explicit StribeckDrives(int substeps) : substeps_(substeps), axes_{make(0), make(1)} {}

  void start(const Vec2& x) {
    for (std::size_t i = 0; i < 2; ++i) axes_[i].reset(x[i]);
  }
  [[nodiscard]] double position(std::size_t i) const { return axes_[i].table_position(); }
  void advance(const Vec2& force, double dt) {
    advance_together(axes_[0], {force[0], 0.0, 0.0}, substeps_, axes_[1], {force[1], 0.0, 0.0}, substeps_,
                     dt);
  }

 private:
  using Axis = plant::Mechanics<friction::Composed<friction::Table>, friction::LuGre<double>, false, false>;
  static Axis make(std::size_t i) {
    plant::AxisParams p = w1().machine.axes[i].second.plant;
    p.drive = plant::CurrentDrive{1.0, {}};
    const auto& map = w1().map(i);
    // The level ends at its border like the map's own table; the whole curve is held there.
    if constexpr (std::is_same_v<Map, Level>)
      return {p, {friction::Table::build(map, map.velocity_range[1]), {}}, w1().law};
    return {p, {friction::Table::build(Map{map}, map.velocity_range[1]), {}}, w1().law};
  }

  int substeps_;
  std::array<Axis, 2> axes_;
};

// ---- the peer: Boost.odeint, classical RK4, the friction curve evaluated as it is written

template <class Map>
class OdeintDrives {
 public:
  explicit OdeintDrives(int substeps) : substeps_(substeps) {
    for (std::size_t i = 0; i < 2; ++i) plant_.map[i] = {w1().map(i)};
  }

  void start(const Vec2& x) { y_ = {x[0], 0.0, 0.0, x[1], 0.0, 0.0}; }
  [[nodiscard]] double position(std::size_t i) const { return y_[3 * i]; }
  void advance(const Vec2& force, double dt) {
    plant_.force = {force[0], force[1]};
    for (int i = 0; i < substeps_; ++i) stepper_.do_step(std::cref(plant_), y_, 0.0, dt / substeps_);
  }

 private:
  using State = std::array<double, 6>;  // x, v, z of both axes
  struct Plant {
    std::array<Map, 2> map;
    friction::LuGre<double> law = w1().law;
    std::array<double, 2> mass{w1().machine.axes[0].second.plant.mass,
                               w1().machine.axes[1].second.plant.mass};
    std::array<double, 2> force{};

    void operator()(const State& y, State& d, double) const {
      for (std::size_t i = 0; i < 2; ++i) {
        const double v = y[3 * i + 1];
        const double z = y[3 * i + 2];
        const auto p = map[i].parts(v, y[3 * i]);
        const double rate = law.rate(z, v, p);
        d[3 * i] = v;
        d[3 * i + 1] = (force[i] - law.force(z, rate, v, p)) / mass[i];
        d[3 * i + 2] = rate;
      }
    }
  };

  int substeps_;
  Plant plant_;
  State y_{};
  boost::numeric::odeint::runge_kutta4<State> stepper_;
};

// ---- measuring

template <class Drives>
std::vector<double> trace(int substeps) {
  Drives drives(substeps);
  std::vector<double> errors;
  run(drives, [&](double e) { errors.push_back(e); });
  return errors;
}

template <class Drives, class Map>
void measure(benchmark::State& state) {
  const int substeps = static_cast<int>(state.range(0));
  static const std::vector<double> converged = trace<OdeintDrives<Map>>(60);
  const std::vector<double> got = trace<Drives>(substeps);
  double deviation = 0.0;
  for (std::size_t k = 0; k < got.size(); ++k) {
    const double d = std::abs(got[k] - converged[k]);
    if (!(d <= deviation)) deviation = d;
  }
  Drives drives(substeps);
  for (auto _ : state) {
    double worst = 0.0;
    run(drives, [&](double e) { worst = std::max(worst, std::abs(e)); });
    benchmark::DoNotOptimize(worst);
  }
  state.counters["sim_s_per_s"] = benchmark::Counter(w1().seconds() * static_cast<double>(state.iterations()),
                                                     benchmark::Counter::kIsRate);
  state.counters["deviation_nm"] = deviation * 1e9;
}

// ---- sixteen machines in step

/// W1 with level, on machines whose friction differs, each under its own copy of the controller. Per core and machine.
void together(benchmark::State& state) {
  constexpr std::size_t kMachines = 16;
  const W1& w = w1();
  std::vector<plant::Axis> axes;
  std::vector<plant::Axis*> members;
  std::array<double, 2> gain{};
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t m = 0; m < kMachines; ++m) {
      plant::AxisParams p = w.machine.axes[i].second.plant;
      gain[i] = p.force_gain();
      p.friction.dynamics = w.law;
      p.friction.steady = w.map(i).scaled(0.8 + 0.4 * static_cast<double>(m) / kMachines);
      axes.emplace_back(p, w.machine.sample_time, w.map(i).velocity_range[1]);
    }
  }
  for (plant::Axis& a : axes) members.push_back(&a);
  std::vector<plant::AxisInput> inputs(axes.size());
  for (auto _ : state) {
    for (std::size_t k = 0; k < axes.size(); ++k)
      axes[k].start(w.reference[0].position[k / kMachines], {static_cast<int>(state.range(0)), false, false},
                    {});
    plant::AxisGroup group =
        state.range(1) != 0 ? plant::AxisGroup(members) : plant::AxisGroup(members, nullptr);
    std::vector<control::Contouring<2>::State> states(kMachines);
    double worst = 0.0;
    for (const path::PathPoint<2>& r : w.reference) {
      for (std::size_t m = 0; m < kMachines; ++m) {
        const Vec2 position{{axes[m].position(), axes[kMachines + m].position()}};
        worst = std::max(worst, std::abs(path::contour_error(w.curve, position, r.phi)));
        const Vec2 force = w.controller.step(states[m], r, position);
        for (std::size_t i = 0; i < 2; ++i) inputs[i * kMachines + m].command = force[i] / gain[i];
      }
      group.step(inputs);
    }
    benchmark::DoNotOptimize(worst);
  }
  state.counters["sim_s_per_s"] = benchmark::Counter(
      w.seconds() * kMachines * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

BENCHMARK(together)
    ->Name("level/Together")
    ->ArgNames({"substeps", "packs"})
    ->Args({3, 0})
    ->Args({3, 1})
    ->Args({6, 0})
    ->Args({6, 1})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(measure<StribeckDrives<WholeCurve>, WholeCurve>)
    ->Name("whole/Stribeck")
    ->Arg(2)
    ->Arg(3)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(measure<OdeintDrives<WholeCurve>, WholeCurve>)
    ->Name("whole/OdeintRk4")
    ->Arg(3)
    ->Arg(4)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(measure<StribeckDrives<Level>, Level>)
    ->Name("level/Stribeck")
    ->Arg(3)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(measure<OdeintDrives<Level>, Level>)
    ->Name("level/OdeintRk4")
    ->Arg(3)
    ->Arg(5)
    ->Arg(6)
    ->Unit(benchmark::kMillisecond);

}  // namespace
