/// How often the 95 % intervals of identify_drive hold the truth: 200 logs of sines in closed loop, seeds 1–200, on
/// the virtual machines as they are (odd seeds) and with mass, heights of friction, viscous part and periodic
/// amplitude changed by up to 30 % each (even seeds). The loop knows the nominal mass only.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <map>
#include <random>
#include <stribeck/friction/gaussian.hpp>
#include <stribeck/ident/drive/drive_fit.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/sim/parallel.hpp>
#include <stribeck/sim/recording.hpp>
#include <string>
#include <variant>
#include <vector>

namespace stribeck::test::coverage_test {
namespace {

constexpr std::uint64_t kLogs = 200;
constexpr double kSlowest = 0.5e-3, kFastest = 9e-3;  // [m/s] where the curve is asked for

/// Factors in [0.7, 1.3].
class Factor {
 public:
  explicit Factor(std::uint64_t seed) : engine_(seed) {}
  double operator()() { return 0.7 + 0.6 * static_cast<double>(engine_() >> 11) * 0x1p-53; }

 private:
  std::mt19937_64 engine_;
};

void change(plant::AxisParams& p, Factor factor) {
  p.mass *= factor();
  const auto branch = [&](friction::GaussianBranch<double>& b, double level, double viscous) {
    b.eta0 *= level;
    b.eta1 *= viscous;
    for (auto& g : b.gaussians) g.a *= factor();
  };
  if (auto* c = std::get_if<friction::Conventional<double>>(&p.friction.steady)) {
    const double rise = c->stribeck ? (c->stribeck->alpha1 - c->alpha0) * factor() : 0.0;
    c->alpha0 *= factor();
    c->alpha2 *= factor();
    if (c->stribeck) c->stribeck->alpha1 = c->alpha0 + rise;
  } else if (auto* g = std::get_if<friction::Gaussian<double>>(&p.friction.steady)) {
    const double level = factor(), viscous = factor();
    branch(g->positive, level, viscous);
    branch(g->negative, level, viscous);
  }
  for (auto& e : p.friction.eccentric) e.amplitude *= factor();
}

constexpr double kHold = -0.5;  // rows: a commanded force under its zero-order hold

struct Kind {
  const char* name;
  const char* file;
  std::uint64_t axes;
  double periods;
};
constexpr std::array kKinds{Kind{"V1", "uniaxial-drive", 1, 4.0}, Kind{"V2", "biaxial-table", 2, 8.0},
                            Kind{"V3", "triaxial-tool-5ms", 3, 4.0}};

struct Hit {
  std::string what;
  int inside = 0;
  int asked = 0;
};
struct Outcome {
  std::size_t kind = 0;
  std::vector<Hit> hits;
  std::string failed;
};

/// `known`: the user says that the force is commanded, under its hold (--force-shift). Otherwise the intervals allow for any shift.
Outcome run(const std::array<sim::Machine, 3>& machines, std::uint64_t seed, bool known) {
  Outcome out;
  out.kind = (seed - 1) / 2 % kKinds.size();
  const Kind& kind = kKinds[out.kind];
  sim::Machine machine = machines[out.kind];
  const std::size_t which = (seed - 1) / (2 * kKinds.size()) % kind.axes;
  sim::MachineAxis& axis = machine.axes[which].second;
  if (seed % 2 == 0) change(axis.plant, Factor(seed));
  const sim::Commissioning& c = axis.commissioning;
  std::vector<double> r;
  const double end = kind.periods * 2.0 * kPi / c.sine_frequency;
  for (std::size_t k = 0; static_cast<double>(k) * machine.sample_time < end; ++k) {
    r.push_back(c.sine_offset +
                c.sine_amplitude * std::cos(c.sine_frequency * static_cast<double>(k) * machine.sample_time));
  }
  const sim::Recording log = sim::record_closed_loop(machine, which, r, seed);
  ident::log::Record record;
  record.source =
      std::string(kind.name) + ", axis " + machine.axes[which].first + ", seed " + std::to_string(seed);
  record.sample_time = log.period;
  record.t = log.t, record.r = log.r, record.x = log.x, record.f = log.f;
  ident::drive::DriveFitOptions options;
  options.dynamics = false;
  if (known) options.shift = kHold;
  ident::Result result;
  try {
    result = ident::drive::identify_drive({record}, options);
  } catch (const ident::Refused& why) {
    out.failed = record.source + ": " + why.what();
    return out;
  }

  const auto ask = [&](const char* what, const ident::Parameter* p, double truth) {
    if (p == nullptr || !p->identifiable) return;
    out.hits.push_back({what, p->ci_low <= truth && truth <= p->ci_high ? 1 : 0, 1});
  };
  ask("mass", result.find("mass"), axis.plant.mass);
  if (const auto* map = std::get_if<friction::Conventional<double>>(&axis.plant.friction.steady)) {
    ask("Coulomb", result.find("alpha0"), map->alpha0);
    ask("viscous", result.find("alpha2"), map->alpha2);
    // A Gaussian away from v = 0 takes its part of the line; a straight line over a Stribeck rise is none.
    const bool load_told = result.find("load") != nullptr;
    for (const char* side : {"positive", "negative"}) {
      const std::string tail = std::string("_") + side;
      if (result.find("gaussian_1_b" + tail) != nullptr ||
          (map->stribeck && result.find("gaussian_1_a" + tail) == nullptr))
        continue;
      const double sign = side[0] == 'p' ? 1.0 : -1.0;
      ask("Coulomb", result.find("eta0" + tail), sign * map->alpha0 + (load_told ? 0.0 : axis.plant.load));
      ask("viscous", result.find("eta1" + tail), map->alpha2);
    }
  }
  for (const auto& e : axis.plant.friction.eccentric) {
    const ident::Parameter* found = nullptr;
    for (int w = 1; w <= 4; ++w) {
      const auto* period = result.find("periodic_period_" + std::to_string(w));
      if (period != nullptr && std::abs(period->value / e.period - 1.0) < 0.02)
        found = result.find("periodic_amplitude_" + std::to_string(w));
    }
    ask("periodic amplitude", found, e.amplitude);
  }
  Hit curve{"curve", 0, 0};
  for (const auto& p : result.curve) {
    const double speed = std::abs(p.velocity);
    if (speed < kSlowest || speed > kFastest) continue;
    const auto parts =
        std::visit([&](const auto& m) { return m.parts(p.velocity, 0.0); }, axis.plant.friction.steady);
    double truth = parts.level * (p.velocity > 0.0 ? 1.0 : -1.0) + parts.viscous;
    // Where no load was told from friction, the curve contains it, and the result says so.
    if (result.find("load") == nullptr) truth += axis.plant.load;
    curve.inside += p.ci_low <= truth && truth <= p.ci_high;
    ++curve.asked;
  }
  out.hits.push_back(curve);
  return out;
}

using Table = std::map<std::string, std::array<Hit, 4>>;  // by quantity: V1, V2, V3, all

Table covered(bool known) {
  std::array<sim::Machine, 3> machines;
  for (std::size_t i = 0; i < kKinds.size(); ++i) {
    machines[i] = io::read_toml<sim::Machine>(std::string(STRIBECK_SOURCE_DIR) + "/machines/" +
                                              kKinds[i].file + ".toml");
  }
  std::vector<Outcome> outcomes(kLogs);
  sim::parallel_for(
      kLogs, 2, [] { return 0; }, [&](int, std::size_t i) { outcomes[i] = run(machines, i + 1, known); });

  Table table;
  for (const Outcome& o : outcomes) {
    EXPECT_EQ(o.failed, "");
    for (const Hit& h : o.hits) {
      for (const std::size_t column : {o.kind, kKinds.size()}) {
        table[h.what][column].inside += h.inside;
        table[h.what][column].asked += h.asked;
      }
    }
  }
  std::printf("%-20s%18s%18s%18s%18s\n", "truth inside 95 %", "V1", "V2", "V3", "all");
  for (const auto& [what, row] : table) {
    std::printf("%-20s", what.c_str());
    for (const Hit& h : row) {
      if (h.asked > 0) {
        std::printf("%6.1f %% of %5d ", 100.0 * h.inside / h.asked, h.asked);
      } else {
        std::printf("%18s", "-");
      }
    }
    std::printf("\n");
  }
  return table;
}

void expect_shares(const Table& table, double most) {
  for (const auto& [what, row] : table) {
    for (std::size_t i = 0; i < kKinds.size(); ++i) {
      if (row[i].asked == 0) continue;
      const double share = static_cast<double>(row[i].inside) / row[i].asked;
      EXPECT_GE(share, 0.85) << what << ", " << kKinds[i].name;
      EXPECT_LE(share, most) << what << ", " << kKinds[i].name;
      EXPECT_GE(row[i].asked, 60) << what << ", " << kKinds[i].name << ": hardly ever found";
    }
  }
}

// Measured 2026-11-21, V1, V2, V3: mass 89.7, 95.5, 92.4 %, Coulomb 91.2, -, 95.5 %, viscous 91.2, -, 93.9 %, periodic
// amplitude -, -, 93.9 %, curve 97.1, 96.2, 96.0 %. Of 66 logs with 95 % each, two standard deviations are 5 %; a
// band that always holds the truth is too wide.
TEST(Coverage, IntervalsHoldTheTruth) { expect_shares(covered(true), 0.995); }

// Where nobody says how late the force is, the intervals allow for it. Here it is not late, so that mass and amplitude are
// always inside (measured 2026-11-22: 100 %, curve 96.8 to 99.3 %).
TEST(Coverage, IntervalsHoldTheTruthForAnyShift) { expect_shares(covered(false), 1.0); }

}  // namespace
}  // namespace stribeck::test::coverage_test
