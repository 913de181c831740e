// A year of daily tests on many random machines, with changes injected: what `health` finds, when, and how often it is wrong.
// For tools/health, which makes the table of docs/health-year.md.
//
//   health_year [--machines N] [--seed S] [--tables FILE]      fails where a declared bound is broken
//
// Of every machine the whole motion is simulated: eight times as it is, with other noise, and once for each thing that may change.
// A test of a day is one of the eight plus shares of these responses: its numbers are linear in the forces.
#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <stribeck/ident/excitation/excitation.hpp>
#include <stribeck/ident/health/findings.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/sim/study/variation.hpp>
#include <stribeck/workflow/commission.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>

namespace stribeck::health_year {
namespace {

namespace health = ident::health;
using health::Measured;

constexpr int kDays = 365;
constexpr std::size_t kNoises = 8;
constexpr double kBump = 0.2;  // of the level, as which responses are simulated

class Draws {
 public:
  explicit Draws(std::uint64_t seed) : generator_(seed) {}
  double within(double low, double high) { return low + (high - low) * share(); }
  double share() { return static_cast<double>(generator_() >> 11) * 0x1p-53; }
  /// Standard normal, by Box and Muller: the same on every platform.
  double normal() {
    return std::sqrt(-2.0 * std::log(1.0 - share())) * std::cos(2.0 * std::numbers::pi * share());
  }

 private:
  std::mt19937_64 generator_;
};

/// The numbers that a test adds up, in one order.
template <class M, class F>
void each_value(M& m, F&& f) {
  for (auto& s : m.friction) {
    f(s.forward.value);
    f(s.backward.value);
  }
  f(m.forward.value);
  f(m.backward.value);
  f(m.offset.value);
  if (m.coulomb) f(m.coulomb->value);
  if (m.viscous) f(m.viscous->value);
  if (m.mass) f(m.mass->value);
  for (auto& p : m.places) f(p.more.value);
  for (auto& p : m.periodic) f(p.amplitude.value);
}

std::vector<double> values_of(const Measured& m) {
  std::vector<double> out;
  each_value(m, [&](double v) { out.push_back(v); });
  return out;
}

/// How the machine is on a day: shares of what it was.
struct State {
  double coulomb = 0.0, viscous = 0.0, load = 0.0, mass = 0.0, place = 0.0, gain = 0.0;
};
constexpr std::array kParts{&State::coulomb, &State::viscous, &State::load, &State::mass, &State::place};

/// The health motion of one axis of a random machine, and what it measures.
class Bench {
 public:
  Bench(const sim::Machine& machine, std::uint64_t seed, double period) : machine_(machine), seed_(seed) {
    const sim::MachineAxis& a = machine.axes[0].second;
    const ident::excitation::Limits limits{a.limits.travel_min, a.limits.travel_max, a.limits.speed,
                                           a.limits.acceleration, a.force_limit()};
    ident::excitation::JogDesign jog;
    jog.start = 0.5 * (limits.travel_min + limits.travel_max);
    const double top = ident::excitation::fastest_jog(limits, machine.sample_time, jog);
    jog.speeds = {0.1 * top, 0.25 * top, 0.5 * top, top};
    jog.period = std::min(0.3 * (limits.travel_max - limits.travel_min), 3.0 * top);
    stretch_ = {jog.start, jog.period};
    jogs_ = ident::excitation::design_jog(limits, machine.sample_time, jog).r;
    triangles_ =
        workflow::design(machine, 0, ident::excitation::ExcitationMethod::kConstantAcceleration, 0).r;
    plan_ = health::plan_of(records({}, 0), period);
    for (std::size_t k = 0; k < kNoises; ++k) base_.push_back(measured({}, k));
    level_ = 0.5 * (base_[0].forward.value + base_[0].backward.value);
    mean_.assign(values_of(base_[0]).size(), 0.0);
    for (const Measured& m : base_) {
      const std::vector<double> v = values_of(m);
      for (std::size_t i = 0; i < v.size(); ++i) mean_[i] += v[i] / kNoises;
    }
    for (const auto part : kParts) {
      State state;
      state.*part = kBump;
      std::vector<double> v = values_of(measured(state, 0));
      const std::vector<double> from = values_of(base_[0]);
      for (std::size_t i = 0; i < v.size(); ++i) v[i] = (v[i] - from[i]) / kBump;
      responses_.push_back(v);
    }
  }

  /// The test of a day.
  [[nodiscard]] Measured test(const State& s, std::size_t noise) const {
    Measured m = base_[noise % kNoises];
    std::size_t i = 0;
    each_value(m, [&](double& v) {
      for (std::size_t p = 0; p < kParts.size(); ++p) v += s.*kParts[p] * responses_[p][i];
      v *= 1.0 + s.gain;
      ++i;
    });
    return m;
  }

  /// Largest difference of a test that is simulated as a whole, as a share of the level.
  [[nodiscard]] double error(const State& s) const {
    const Measured whole = measured(s, 1), sum = test(s, 1);
    double most = 0.0;
    for (const auto part : {&Measured::forward, &Measured::backward, &Measured::offset})
      most = std::max(most, std::abs((whole.*part).value - (sum.*part).value) / level_);
    if (whole.coulomb) most = std::max(most, std::abs(whole.coulomb->value - sum.coulomb->value) / level_);
    return most;
  }

 private:
  [[nodiscard]] sim::Machine with(const State& s) const {
    sim::Machine machine = machine_;
    plant::AxisParams& p = machine.axes[0].second.plant;
    std::visit(
        [&](auto& map) {
          const auto viscous = map;
          map = map.scaled(1.0 + s.coulomb);
          if constexpr (requires { map.alpha2; }) {
            map.alpha2 = viscous.alpha2 * (1.0 + s.viscous);
          } else {
            map.positive.eta1 = viscous.positive.eta1 * (1.0 + s.viscous);
            map.negative.eta1 = viscous.negative.eta1 * (1.0 + s.viscous);
          }
        },
        p.friction.steady);
    p.load += s.load * level_;
    p.mass *= 1.0 + s.mass;
    return machine;
  }

  /// More friction in the third quarter of the stretch is added to the recorded force.
  [[nodiscard]] std::vector<ident::log::Record> records(const State& s, std::size_t noise) const {
    const sim::Machine machine = with(s);
    std::vector<ident::log::Record> out;
    for (const auto* r : {&jogs_, &triangles_}) {
      out.push_back(
          workflow::as_record(workflow::play(machine, 0, *r, {}, seed_ + 2 * noise + out.size()), "test"));
      ident::log::Record& log = out.back();
      for (std::size_t k = 1; k < log.x.size(); ++k) {
        const double at = (log.x[k] - stretch_[0]) / stretch_[1];
        const double moved = log.r[k] - log.r[k - 1];
        if (at > 0.5 && at < 0.75)
          log.f[k] += s.place * level_ * (moved > 0.0 ? 1.0 : moved < 0.0 ? -1.0 : 0.0);
      }
    }
    return out;
  }
  [[nodiscard]] Measured measured(const State& s, std::size_t noise) const {
    return health::measure(records(s, noise), plan_);
  }

  sim::Machine machine_;
  std::uint64_t seed_;
  std::array<double, 2> stretch_{};  ///< begin and length [m]
  std::vector<double> jogs_, triangles_;
  health::Plan plan_;
  double level_ = 0.0;
  std::vector<Measured> base_;
  std::vector<double> mean_;
  std::vector<std::vector<double>> responses_;
};

/// What every machine does without being ill, by day.
class Weather {
 public:
  explicit Weather(Draws& draws)
      : phase_(draws.within(0.0, 2.0 * std::numbers::pi)),
        coulomb_(draws.within(0.02, 0.06)),
        viscous_(draws.within(0.05, 0.2)),
        interval_(static_cast<int>(draws.within(20.0, 60.0))),
        dry_(draws.within(0.02, 0.06)),
        scatter_(draws.within(0.005, 0.02)) {}

  /// `missed`: from this day on nobody lubricates.
  State day(int d, Draws& draws, int missed) {
    constexpr double kNeighbours = 0.5;
    const double year = std::sin(2.0 * std::numbers::pi * d / kDays + phase_);
    const double new_part = std::sqrt(1.0 - kNeighbours * kNeighbours);
    slow_c_ = kNeighbours * slow_c_ + new_part * draws.normal();
    slow_v_ = kNeighbours * slow_v_ + new_part * draws.normal();
    degrees = 20.0 - 8.0 * year + slow_v_;
    const int since = d < missed ? d % interval_ : d - (missed - missed % interval_);
    const double dryness = dry_ * since / interval_;
    State s;
    s.coulomb = coulomb_ * year + dryness + scatter_ * slow_c_;
    s.viscous = viscous_ * year - dryness - 2.0 * scatter_ * slow_v_;
    s.load = 0.3 * scatter_ * draws.normal();
    return s;
  }

  double degrees = 20.0;  ///< of the last day [°C]

 private:
  double phase_, coulomb_, viscous_;
  int interval_;
  double dry_, scatter_;
  double slow_c_ = 0.0, slow_v_ = 0.0;
};

/// A change of the machine. `days`: 0: a step; otherwise until it is complete.
struct Scenario {
  std::string name;
  std::string cause;  ///< begin of the right cause
  std::array<double, 2> size{};
  State per_size;
  std::array<double, 2> days{};
  bool missed = false;
  bool thermometer = false;
};

const std::vector<Scenario>& scenarios() {
  const auto part = [](double State::*member, double value) {
    State s;
    s.*member = value;
    return s;
  };
  State dry;
  dry.coulomb = 1.0;
  dry.viscous = -1.0;
  static const std::vector<Scenario> all{
      {"nothing", "", {}, {}, {}},
      {"nothing, temperature given", "", {}, {}, {}, false, true},
      {"preload lost at once, Coulomb -20 to -40 %",
       "preload lost",
       {0.2, 0.4},
       part(&State::coulomb, -1.0),
       {}},
      {"preload lost over 30 to 90 days, Coulomb -60 to -80 %",
       "preload lost",
       {0.6, 0.8},
       part(&State::coulomb, -1.0),
       {30, 90}},
      {"tighter at once, Coulomb +20 to +50 %", "tighter", {0.2, 0.5}, part(&State::coulomb, 1.0), {}},
      {"lubricator fails, Coulomb up and viscous down by 25 to 50 %",
       "lubricant missing",
       {0.25, 0.5},
       dry,
       {}},
      {"nobody lubricates any more", "lubricant missing", {1.0, 1.0}, {}, {}, true},
      {"wear in a quarter of the stretch over 30 to 90 days, +40 to +80 %",
       "wear",
       {0.4, 0.8},
       part(&State::place, 1.0),
       {30, 90}},
      {"chip in a quarter of the stretch, +25 to +60 %", "wear", {0.25, 0.6}, part(&State::place, 1.0), {}},
      {"counterbalance or load, 15 to 40 % of the friction",
       "load",
       {0.15, 0.4},
       part(&State::load, 1.0),
       {}},
      {"mass +15 to +40 %", "more mass", {0.15, 0.4}, part(&State::mass, 1.0), {}},
      {"scale of the force +12 to +25 %", "scale", {0.12, 0.25}, part(&State::gain, 1.0), {}},
  };
  return all;
}

/// What became of one scenario over all machines.
struct Outcome {
  double years = 0.0;  ///< machine-years watched without a change
  int alarms = 0;      ///< false ones
  int alarmed_days = 0;
  int machines = 0;
  int before = 0;  ///< in alarm already on the day before the change, which says nothing then
  int found = 0;
  int right = 0;              ///< the right cause is the first one
  int named = 0;              ///< it is among them
  std::vector<double> delay;  ///< [days]
  std::vector<double> size;   ///< as share of the whole change when it was found
};

double grown(const Scenario& scenario, double length, int day, int onset) {
  if (day < onset) return 0.0;
  return scenario.days[1] > 0.0 ? std::min(1.0, (day - onset) / length) : 1.0;
}

/// The year of one machine: daily tests, `health` after each of them.
void live(const Bench& bench, const Scenario& scenario, std::uint64_t seed, Outcome& out) {
  Draws draws(seed);
  Weather weather(draws);
  const bool ill = !scenario.cause.empty();
  const int onset =
      static_cast<int>(draws.within(60.0, scenario.days[1] > 0.0 || scenario.missed ? 150.0 : 300.0));
  const double size = draws.within(scenario.size[0], scenario.size[1]);
  const double length = draws.within(scenario.days[0], scenario.days[1]);
  std::vector<health::HealthTest> tests;
  bool was_changed = false;
  if (ill) ++out.machines;
  for (int d = 0; d < kDays; ++d) {
    State s = weather.day(d, draws, scenario.missed ? onset : 2 * kDays);
    const double share = grown(scenario, length, d, onset);
    for (const auto part :
         {&State::coulomb, &State::viscous, &State::load, &State::mass, &State::place, &State::gain})
      s.*part += share * size * scenario.per_size.*part;
    health::HealthTest test;
    test.day = d;
    if (scenario.thermometer) test.temperature = weather.degrees;
    test.axis = bench.test(s, static_cast<std::size_t>(kNoises * draws.share()));
    tests.push_back(std::move(test));
    if (ill && d < onset - 1) continue;
    const health::Health now = health::health_of(tests);
    if (ill && d < onset) {
      if (!now.changed()) continue;
      --out.machines;
      ++out.before;
      return;
    }
    if (!ill) {
      out.alarms += now.changed() && !was_changed;
      out.alarmed_days += now.changed();
      was_changed = now.changed();
      continue;
    }
    const auto change = std::find_if(now.changes.begin(), now.changes.end(), [&](const health::Change& c) {
      return c.matters() && (c.slow || c.day >= onset - 7);
    });
    if (change == now.changes.end()) continue;
    ++out.found;
    out.delay.push_back(d - onset);
    out.size.push_back(share);
    const auto fits = [&](const health::Cause& c) { return c.what.starts_with(scenario.cause); };
    out.right += fits(change->causes.front());
    out.named += std::any_of(change->causes.begin(), change->causes.end(), fits);
    return;
  }
  if (!ill) out.years += 1.0;
}

Bench bench_of(std::uint64_t seed, std::uint32_t number, const std::string& folder) {
  static const std::array<std::string, 3> kMachines{"biaxial-table", "triaxial-tool", "uniaxial-drive"};
  const sim::Machine nominal =
      workflow::read_virtual_machine(folder + "/machines/" + kMachines[number % 3] + ".toml");
  sim::Variation variation;
  variation.delay = 0;
  variation.axial_mode.reset();
  variation.warming = 0.05;
  const sim::Deviation drawn = sim::draw(variation, seed, number, 0);
  const double period = drawn.periodic ? drawn.periodic->period : 0.0;
  return Bench(sim::vary(nominal, variation, seed, number), seed + 1000U * number, period);
}

std::string quantiles(const std::vector<double>& days) {
  if (days.empty()) return "–";
  return fmt::format("{:.0f} / {:.0f} / {:.0f}", ident::stats::median(days),
                     ident::stats::quantile(days, 0.9), ident::stats::quantile(days, 1.0));
}

std::string tables(const std::vector<Outcome>& outcomes, double worst) {
  std::string text =
      "| Without a change | machine-years | false alarms | per machine-year | days in alarm |\n|---|---|---|---|---|\n";
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const Outcome& o = outcomes[i];
    if (!scenarios()[i].cause.empty()) continue;
    text += fmt::format("| {} | {:.0f} | {} | {:.2f} | {:.1f} % |\n", scenarios()[i].name, o.years, o.alarms,
                        o.alarms / o.years, 100.0 * o.alarmed_days / (o.years * kDays));
  }
  text +=
      "\n| Change | found | days after onset, p50 / p90 / max | complete by then, p50 | right cause first | among the causes |\n"
      "|---|---|---|---|---|---|\n";
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const Outcome& o = outcomes[i];
    if (scenarios()[i].cause.empty()) continue;
    text += fmt::format("| {} | {} of {} | {} | {} | {} of {} | {} of {} |\n", scenarios()[i].name, o.found,
                        o.machines, quantiles(o.delay),
                        scenarios()[i].days[1] > 0.0 && !o.size.empty()
                            ? fmt::format("{:.0f} %", 100.0 * ident::stats::median(o.size))
                            : std::string("–"),
                        o.right, o.found, o.named, o.found);
  }
  int before = 0;
  for (const Outcome& o : outcomes) before += o.before;
  text += fmt::format(
      "\nLeft out of the second table, because of an alarm on the day before the change: {}.\n", before);
  text += fmt::format(
      "\nA test that is simulated as a whole, with all changes at once, differs from the sum of its responses by at most {:.2f} % of the friction level.\n",
      100.0 * worst);
  return text;
}

/// What the program promises: of steps nearly all are found, and false alarms are rare.
int broken(const std::vector<Outcome>& outcomes) {
  constexpr double kAlarms = 0.5, kFound = 0.8;
  int count = 0;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const Scenario& s = scenarios()[i];
    const Outcome& o = outcomes[i];
    const bool bad = s.cause.empty() ? o.alarms > kAlarms * o.years
                                     : s.days[1] == 0.0 && !s.missed && o.found < kFound * o.machines;
    if (!bad) continue;
    fmt::print(stderr, "health_year: {}: beyond its bound\n", s.name);
    ++count;
  }
  return count;
}

}  // namespace

int main(int argc, char** argv) {
  std::map<std::string, std::string> options{{"--machines", "24"}, {"--seed", "1"}, {"--tables", ""}};
  for (int i = 1; i + 1 < argc; i += 2) {
    if (!options.contains(argv[i])) {
      fmt::print(stderr, "health_year [--machines N] [--seed S] [--tables FILE]\n");
      return 2;
    }
    options[argv[i]] = argv[i + 1];
  }
  const auto machines = static_cast<std::uint32_t>(std::stoul(options["--machines"]));
  const std::uint64_t seed = std::stoull(options["--seed"]);
  std::vector<Outcome> outcomes(scenarios().size());
  double worst = 0.0;
  for (std::uint32_t number = 0; number < machines; ++number) {
    const Bench bench = bench_of(seed, number, STRIBECK_SOURCE_DIR);
    State all;
    all.coulomb = -0.15;
    all.viscous = 0.2;
    all.load = 0.2;
    all.mass = 0.1;
    all.place = 0.3;
    worst = std::max(worst, bench.error(all));
    for (std::size_t i = 0; i < scenarios().size(); ++i)
      live(bench, scenarios()[i], seed + 100000U * (number + 1) + i, outcomes[i]);
    fmt::print(stderr, "\r{} of {} machines", number + 1, machines);
  }
  fmt::print(stderr, "\n");
  const std::string text = tables(outcomes, worst);
  if (!options["--tables"].empty()) io::write_atomically(options["--tables"], text);
  fmt::print("{}", text);
  return broken(outcomes) > 0 ? 1 : 0;
}

}  // namespace stribeck::health_year

int main(int argc, char** argv) { return stribeck::health_year::main(argc, argv); }
