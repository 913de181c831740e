// Machines drawn at random, which are sound, on paths within their limits under laws with gains that suit their period: supervision must
// stop none. Drawn as in tools/sweep: 0.5 kg to 5 t, 50 mm to 4 m, 0.25 to 5 ms, with Stribeck rise, ripple, delay, load, axial mode.
//
//   sound_running [--minutes M] [--seed S] [--first N] [--machines N]      M of this process's own time on the processor
//
// A stop is a false one unless the loop is bad by itself:
//   unstable   the linear loop is, with the axial modes and the real masses of the machine (loop_margins.hpp)
//   rings      without supervision an axis vibrates for half a second so strongly that the whole force of its drive could not do it to a
//              rigid axis: friction that falls with speed, or a loop that is nearly unstable, feeds the axial mode
//   or the same run without supervision goes wrong as well: it leaves its path by a twentieth of its size, stays at its force limit
//   for 0.4 s, or an axis is faster than 1.5 times its limit
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <iostream>
#include <random>

#include "drill.hpp"

namespace stribeck::test {
namespace {

constexpr double kRun = 30.0;  // [s]

class Draw {
 public:
  Draw(std::uint64_t seed, std::uint64_t number) {
    std::seed_seq both{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(number)};
    random_.seed(both);
  }
  double between(double low, double high) { return std::uniform_real_distribution(low, high)(random_); }
  double spread(double low, double high) { return std::exp(between(std::log(low), std::log(high))); }
  bool chance(double p) { return between(0.0, 1.0) < p; }
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(random_() % n); }

 private:
  std::mt19937_64 random_;
};

/// Gains that a period with a delay permits.
double omega_for(Draw& d, double period, int delay) {
  return std::min(d.between(0.08, 0.2) / (period * (1.0 + delay)), 300.0);
}

sim::MachineAxis draw_axis(Draw& d, double period, int delay, double omega) {
  sim::MachineAxis a;
  plant::AxisParams& p = a.plant;
  sim::AxisLimits& l = a.limits;
  p.mass = d.spread(0.5, 5000.0);
  const double travel = d.spread(0.05, 4.0);
  l.travel_min = -0.5 * travel;
  l.travel_max = 0.5 * travel;
  l.acceleration = d.spread(0.2, 10.0);
  l.speed = std::min(d.spread(0.02, 1.5), std::sqrt(0.25 * l.acceleration * travel));
  const double coulomb = p.mass * l.acceleration * d.spread(0.05, 2.0);
  const double rise = d.chance(0.7) ? d.between(0.05, 0.6) : 0.0;
  friction::Conventional<double> map;
  map.alpha0 = coulomb;
  map.alpha2 = coulomb * d.between(0.1, 1.5) / l.speed;
  if (rise > 0.0) {
    map.stribeck.emplace();
    map.stribeck->alpha1 = coulomb * (1.0 + rise);
    map.stribeck->v0 = l.speed * d.spread(0.003, 0.05);
    map.stribeck->delta = d.chance(0.5) ? 1.0 : 2.0;
  }
  p.friction.steady = map;
  const double slip = d.spread(2e-6, 30e-6);
  const double sigma0 = coulomb / slip;
  p.friction.dynamics = friction::LuGre<double>{
      sigma0, d.between(0.2, 0.7) * 2.0 * std::sqrt(sigma0 * p.mass), l.speed * d.spread(0.002, 0.02)};
  if (d.chance(0.6))
    p.friction.eccentric.push_back({coulomb * d.between(0.03, 0.2), d.spread(2e-3, 20e-3),
                                    d.between(-3.0, 3.0), friction::EccentricForm::kAdditive});
  if (d.chance(0.2)) p.load = coulomb * d.between(0.3, 2.0);
  p.noise =
      plant::ForceNoise{coulomb * d.spread(0.003, 0.03), d.spread(1e-3, 5e-2), plant::NoiseKind::kGaussian};
  p.delay_periods = delay;
  // An encoder whose step makes the loop shake is no sound machine.
  p.encoder.resolution =
      std::min({d.spread(1e-9, 1e-5), 0.05 * coulomb * period / (2.0 * omega * p.mass), slip / 3.0});
  if (d.chance(0.1)) {
    const double frequency = std::max(d.between(20.0, 200.0), omega * 8.0 / (2.0 * kPi));
    p.axial_mode = plant::AxialMode{frequency, d.between(0.02, 0.1), d.between(0.2, 0.6)};
  }
  const double needed =
      coulomb * (1.0 + rise) + map.alpha2 * l.speed + p.mass * l.acceleration + std::abs(p.load);
  const double force = d.between(1.5, 4.0) * needed;
  p.drive = plant::CurrentDrive{force / 10.0, {}};
  return a;
}

control::LawParams draw_law(Draw& d, double omega, const sim::Machine& machine) {
  switch (d.below(6)) {
    case 0:
      return control::PidParams::triple(0.6 * omega);
    case 1: {
      control::SlidingModeParams p;
      p.lambda = {omega, omega};
      p.a = {0.25 * omega};
      p.switching = control::Switching::kBoundaryLayer;
      p.mass_bound = {};
      p.boundary = 1e9;
      for (const auto& [name, axis] : machine.axes) {
        p.mass_bound.push_back(0.1 * axis.plant.mass);
        p.boundary = std::min(p.boundary, 0.1 * axis.limits.speed);
      }
      return p;
    }
    case 2: {
      control::PredictiveParams p;
      p.omega = omega;
      p.horizon = 30.0 * machine.sample_time;
      return p;
    }
    case 3: {
      control::LearningParams p;
      p.kp = {omega * omega};
      p.kv = {2.0 * omega};
      p.cutoff = 2.0 * omega;
      return p;
    }
    default:
      return control::ContouringParams::critical(omega, omega);
  }
}

sim::ControllerSpec draw_controller(Draw& d, double omega, const sim::Machine& machine) {
  sim::ControllerSpec thesis("f", "drawn", sim::FrictionUse::kWhole, control::Observer::kDisturbance,
                             draw_law(d, omega, machine));
  thesis.observer_pole = 0.5 * omega;
  if (d.chance(0.2)) return thesis;
  const auto all = sim::beyond_controllers(thesis);
  sim::ControllerSpec c = all[d.below(std::min<std::size_t>(all.size(), 4))];
  c.law = thesis.law;
  if (c.observer != control::Observer::kKalman) c.observer_pole = 0.5 * omega;
  return c;
}

/// The square root of the proportional gain, as docs/guides/faults.md says.
double omega_of(const control::LawParams& law, double drawn) {
  if (const auto* p = std::get_if<control::PidParams>(&law)) return std::sqrt(p->kp[0]);
  if (const auto* p = std::get_if<control::SlidingModeParams>(&law)) return std::sqrt(p->lambda[0] * p->a[0]);
  return drawn;
}

/// A sum of two harmonics on each axis, as fast as the slowest axis may be and as slow as a fiftieth of that.
template <std::size_t N>
sim::Travel draw_travel(Draw& d, const sim::Machine& machine) {
  path::Fourier<N> f;
  double most = 1e9;
  for (std::size_t i = 0; i < N; ++i) {
    const sim::AxisLimits& l = machine.axes[i].second.limits;
    const double size = 0.5 * l.travel_max * d.spread(0.05, 1.0);
    const bool second = d.chance(0.5);
    f.axis[i].terms.push_back({size, 1.0, d.between(0.0, 2.0 * kPi)});
    if (second) f.axis[i].terms.push_back({0.3 * size, 2.0, d.between(0.0, 2.0 * kPi)});
    const double speed = size * (second ? 1.6 : 1.0);
    const double acceleration = size * (second ? 2.2 : 1.0);
    most = std::min({most, 0.9 * l.speed / speed, std::sqrt(0.8 * l.acceleration / acceleration)});
  }
  sim::Travel t;
  t.path = f;
  t.name = "drawn";
  t.pace = path::Pace::kRate;
  t.speed = most * d.spread(0.02, 1.0);
  // The run-in takes the acceleration that the path leaves.
  t.run_in = 1.0;
  for (std::size_t i = 0; i < N; ++i) {
    const sim::AxisLimits& l = machine.axes[i].second.limits;
    t.run_in = std::max(t.run_in, 8.0 * l.speed / l.acceleration);
  }
  t.laps = std::max(1.0, std::ceil((kRun - 2.0 * t.run_in) * t.speed / (2.0 * kPi)));
  return t;
}

Drill draw_drill(std::uint64_t seed, std::uint64_t number) {
  Draw d(seed, number);
  constexpr double kPeriods[] = {2.5e-4, 5e-4, 1e-3, 1e-3, 2e-3, 4e-3, 5e-3};
  sim::Machine m;
  m.name = "drawn";
  m.sample_time = kPeriods[d.below(std::size(kPeriods))];
  const int delay = d.chance(0.5) ? 0 : 1 + static_cast<int>(d.below(2));
  const double omega = omega_for(d, m.sample_time, delay);
  const std::size_t axes = 1 + d.below(3);
  for (std::size_t i = 0; i < axes; ++i)
    m.axes.emplace_back(std::string(1, static_cast<char>('x' + i)),
                        draw_axis(d, m.sample_time, delay, omega));
  Drill drill;
  drill.machine = "drawn";
  drill.controller = draw_controller(d, omega, m);
  drill.travel = axes == 1 ? draw_travel<1>(d, m) : axes == 2 ? draw_travel<2>(d, m) : draw_travel<3>(d, m);
  drill.drawn = m;
  drill.duration = kRun;
  drill.omega = omega_of(drill.controller.law, omega);
  // What controllers believe of the machine is up to a fifth off.
  drill.friction = d.between(0.8, 1.2);
  drill.mass = d.between(0.85, 1.15);
  drill.seed = seed + number;
  return drill;
}

std::string_view kind_of(const control::LawParams& law) {
  return std::visit([](const auto& p) { return std::decay_t<decltype(p)>::kKind; }, law);
}

/// Whether the linear loop oscillates by itself. A lighter machine than the model's is more gain.
bool unstable(const Drill& d) {
  try {
    const sim::LoopMargins m = margins(d);
    return !m.stable || m.gain_up * d.mass < 1.0;
  } catch (const std::exception&) {
    return false;  // a law whose answer does not settle says nothing
  }
}

/// Whether a run shows an axis that rings on its axial mode: more acceleration than all its force in each of ten spans of 50 ms in a row.
bool rings(const Drill& d, const Drilled& o) {
  const auto span = static_cast<std::size_t>(50e-3 / o.period);
  for (std::size_t i = 0; i < d.travel.axes(); ++i) {
    const sim::MachineAxis& a = d.drawn->axes[i].second;
    if (!a.plant.axial_mode) continue;
    const double level = d.friction * a.plant.friction.parts(0.0, 0.0).level;
    const double most = (a.force_limit() + level + std::abs(a.plant.load)) / (a.plant.mass * d.mass);
    std::size_t last = 0;  // tick at which it was last more
    std::size_t since = 0;
    for (std::size_t k = 2; k < o.ticks.size(); ++k) {
      const double second =
          o.ticks[k].position[i] - 2.0 * o.ticks[k - 1].position[i] + o.ticks[k - 2].position[i];
      if (!(std::abs(second) > most * o.period * o.period)) continue;
      if (k - last > span) since = k;
      last = k;
      if (k - since >= 10 * span) return true;
    }
  }
  return false;
}

/// What goes wrong in a run without supervision; empty: nothing.
std::string_view goes_wrong(const Drill& d, const Drilled& o) {
  double size = 0.0;
  for (std::size_t i = 0; i < d.travel.axes(); ++i) size = std::max(size, 2.0 * o.moved(i, 0.0));
  std::size_t limited = 0;
  const Tick* last = &o.ticks.front();
  for (const Tick& t : o.ticks) {
    if (!(t.error <= 0.05 * size)) return "leaves its path without supervision as well";
    for (std::size_t i = 0; i < d.travel.axes(); ++i) {
      const double moved = std::abs(t.position[i] - last->position[i]);
      if (moved > 1.5 * d.drawn->axes[i].second.limits.speed * o.period)
        return "is too fast without supervision as well";
    }
    last = &t;
    limited = t.limited ? limited + 1 : 0;
    if (static_cast<double>(limited) * o.period > 0.4)
      return "stays at its force limit without supervision as well";
  }
  return "";
}

/// What is bad about the loop itself; empty: nothing.
std::string_view fault_of_loop(Drill d) {
  if (unstable(d)) return "its linear loop is unstable";
  d.supervised = false;
  const Drilled alone = run(d);
  return rings(d, alone) ? "rings on its axial mode" : goes_wrong(d, alone);
}

int main_with(int argc, char** argv) {
  double minutes = 1.0;
  std::uint64_t seed = 900001;
  std::uint64_t first = 0;
  std::uint64_t machines = UINT64_MAX;
  for (int i = 1; i < argc; ++i) {
    const auto is = [&](const char* name) { return std::strcmp(argv[i], name) == 0 && i + 1 < argc; };
    if (is("--minutes")) {
      minutes = std::strtod(argv[++i], nullptr);
    } else if (is("--seed")) {
      seed = std::strtoull(argv[++i], nullptr, 10);
    } else if (is("--first")) {
      first = std::strtoull(argv[++i], nullptr, 10);
    } else if (is("--machines")) {
      machines = std::strtoull(argv[++i], nullptr, 10);
      minutes = 1e9;
    } else {
      std::cerr << "usage: sound_running [--minutes M | --machines N] [--seed S] [--first N]\n";
      return 2;
    }
  }
  const auto spent = [] { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC / 60.0; };
  double seconds = 0.0;
  std::uint64_t n = 0;
  std::uint64_t wrong = 0;
  std::uint64_t bad = 0;
  std::uint64_t bridged = 0;
  for (; n < machines && spent() < minutes; ++n) {
    const Drill d = draw_drill(seed, first + n);
    const Drilled o = run(d);
    seconds += o.tripped < 0.0 ? static_cast<double>(o.ticks.size()) * o.period : o.tripped;
    bridged += o.bridged;
    if (o.fault == control::Fault::kNone) continue;
    const std::string_view why = fault_of_loop(d);
    ++(why.empty() ? wrong : bad);
    std::cout << "machine " << first + n << ", " << d.travel.axes() << " axes of " << o.period * 1e3
              << " ms, " << kind_of(d.controller.law) << " (" << d.controller.id << "): " << name_of(o.fault)
              << " after " << o.tripped << " s, " << (why.empty() ? "a false stop" : why) << std::endl;
  }
  std::cout << seconds / 3600.0 << " hours on " << n << " machines of seed " << seed << ": " << wrong
            << " false stops, " << bad << " stops of loops that are bad by themselves, " << bridged
            << " samples bridged\n";
  return wrong == 0 ? 0 : 1;
}

}  // namespace
}  // namespace stribeck::test

int main(int argc, char** argv) {
  try {
    return stribeck::test::main_with(argc, argv);
  } catch (const std::exception& e) {
    std::cerr << "sound_running: " << e.what() << '\n';
    return 2;
  }
}
