#include <fmt/format.h>

#include <algorithm>
#include <stribeck/core/scalar.hpp>
#include <stribeck/sim/uncertainty/design.hpp>
#include <stribeck/workflow/board/machines.hpp>
#include <stribeck/workflow/built_in.hpp>

namespace stribeck::workflow {
namespace {

/// Separates the draws of the shape from all others.
constexpr std::uint64_t kShape = 0x7368617065;
constexpr int kPlaces = 400;  ///< of the travel over which a curve is averaged

/// Uniform within two numbers.
class ShapeDraws {
 public:
  ShapeDraws(std::uint64_t seed, std::uint64_t machine, std::uint64_t axis)
      : seed_(seed ^ kShape), stream_(16 * machine + axis) {}
  double within(double low, double high) {
    return low + (high - low) * sim::random_share(seed_, stream_, next_++);
  }

 private:
  std::uint64_t seed_;
  std::uint64_t stream_;
  std::uint64_t next_ = 0;
};

void reshape(friction::Conventional<double>& map, ShapeDraws& draws) {
  if (!map.stribeck) return;
  map.stribeck->alpha1 = map.alpha0 + draws.within(0.6, 1.4) * (map.stribeck->alpha1 - map.alpha0);
  map.stribeck->v0 *= draws.within(0.7, 1.4);
}

void reshape(friction::Gaussian<double>& map, ShapeDraws& draws) {
  for (auto* branch : {&map.positive, &map.negative}) {
    for (auto& term : branch->gaussians) {
      term.a *= draws.within(0.6, 1.4);
      term.c *= draws.within(0.8, 1.25);
    }
  }
}

/// Mean over the travel of the sine; `level` gives the level's share at a place, parts(x) the parts there.
template <class Parts>
double mean_over_travel(const sim::MachineAxis& axis, double v, Parts&& parts) {
  const sim::Commissioning& c = axis.commissioning;
  double sum = 0.0;
  for (int i = 0; i < kPlaces; ++i) {
    const double x = c.sine_offset + c.sine_amplitude * (2.0 * (i + 0.5) / kPlaces - 1.0);
    const auto p = parts(x);
    sum += p.level * sign(v) + p.viscous + p.additive;
  }
  return sum / kPlaces;
}

}  // namespace

sim::Variation board_variation() {
  sim::Variation v;
  v.encoder = 4.0;
  v.axial_mode.reset();
  v.warming = 0.0;
  return v;
}

const std::vector<std::string>& board_bases() {
  static const std::vector<std::string> bases{"biaxial-table", "triaxial-tool", "unlike-table"};
  return bases;
}

std::vector<BoardMachine> board_machines(std::uint64_t seed, std::uint32_t count) {
  const std::vector<std::string>& bases = board_bases();
  std::vector<sim::Machine> nominal;
  for (const std::string& base : bases) {
    nominal.push_back(built_in_machine(base));
    nominal.back().axes.resize(2);
  }
  std::vector<BoardMachine> all;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::size_t b = i % bases.size();
    BoardMachine m{fmt::format("{}-{}", bases[b], i / bases.size() + 1), bases[b],
                   sim::vary(nominal[b], board_variation(), seed, i)};
    m.machine.name = m.name;
    for (std::size_t axis = 0; axis < m.machine.axes.size(); ++axis) {
      plant::AxisParams& p = m.machine.axes[axis].second.plant;
      ShapeDraws draws(seed, i, axis);
      std::visit([&](auto& map) { reshape(map, draws); }, p.friction.steady);
      p.warming.reset();
    }
    all.push_back(std::move(m));
  }
  return all;
}

std::vector<double> board_speeds(const sim::MachineAxis& axis) {
  constexpr double kShares[] = {0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.95};
  const double top = axis.commissioning.sine_amplitude * axis.commissioning.sine_frequency;
  std::vector<double> all;
  for (const double share : kShares) {
    all.push_back(-share * top);
    all.push_back(share * top);
  }
  std::sort(all.begin(), all.end());
  return all;
}

double true_force(const sim::MachineAxis& axis, double v) {
  const plant::AxisParams& p = axis.plant;
  return mean_over_travel(axis, v, [&](double x) {
    auto parts = p.friction.parts(v, x);
    if (p.friction_along_travel) {
      const double share = 1.0 + p.friction_along_travel->level * p.friction_along_travel->wave(x);
      parts.level *= share;
    }
    if (p.viscous_exponent) parts.viscous *= p.viscous_exponent->share(v);
    return parts;
  });
}

double model_force(const friction::AxisModel& model, const sim::MachineAxis& axis, double v) {
  return model.load + mean_over_travel(axis, v, [&](double x) { return model.friction.parts(v, x); });
}

}  // namespace stribeck::workflow
