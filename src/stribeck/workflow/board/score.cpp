#include <algorithm>
#include <cmath>
#include <functional>
#include <stribeck/core/numbers.hpp>
#include <stribeck/sim/study/robustness.hpp>
#include <stribeck/sim/uncertainty/design.hpp>
#include <stribeck/workflow/board/machines.hpp>
#include <stribeck/workflow/board/score.hpp>

namespace stribeck::workflow {
namespace {

constexpr std::uint64_t kBootstrap = 0x626f6f74;
constexpr std::uint64_t kDraws = 2000;
constexpr std::size_t kEnoughForP99 = 368;  // machines: the fewest n with 0.99ⁿ ≤ 2.5 %

/// Interpolated in the stated intervals; absent beyond their ends.
std::optional<StatedPoint> stated_at(const std::vector<StatedPoint>& curve, double v) {
  for (std::size_t i = 1; i < curve.size(); ++i) {
    const StatedPoint& a = curve[i - 1];
    const StatedPoint& b = curve[i];
    if (v == a.velocity) return a;
    if (v == b.velocity) return b;
    // Friction jumps at zero: a stretch across it says nothing of the speeds inside.
    if (v < a.velocity || v > b.velocity || (a.velocity < 0.0 && b.velocity > 0.0)) continue;
    const double share = (v - a.velocity) / (b.velocity - a.velocity);
    return StatedPoint{v, a.low + share * (b.low - a.low), a.high + share * (b.high - a.high)};
  }
  return {};
}

/// Interval of a statistic by drawing whole machines; infinite values keep their rank.
std::array<double, 2> bootstrap(std::size_t machines, std::uint64_t seed,
                                const std::function<double(const std::vector<std::size_t>&)>& statistic) {
  std::vector<double> all;
  std::vector<std::size_t> drawn(machines);
  for (std::uint64_t d = 0; d < kDraws; ++d) {
    for (std::size_t i = 0; i < machines; ++i) {
      const double share = sim::random_share(seed ^ kBootstrap, d, i);
      drawn[i] = std::min(static_cast<std::size_t>(share * static_cast<double>(machines)), machines - 1);
    }
    const double x = statistic(drawn);
    if (!std::isnan(x)) all.push_back(x);
  }
  return {sim::interpolated_quantile(all, 0.025), sim::interpolated_quantile(all, 0.975)};
}

}  // namespace

AnswerScore score_answer(const BoardAnswer& answer, const sim::MachineAxis& axis) {
  AnswerScore s{kNaN, kNaN, kNaN, 0.0, 0.0, kNaN, kNaN};
  double wrong = 0.0;
  double all = 0.0;
  double width = 0.0;
  for (const double v : board_speeds(axis)) {
    const double truth = true_force(axis, v);
    const double error = model_force(answer.model, axis, v) - truth;
    wrong += error * error;
    all += truth * truth;
    if (const auto stated = stated_at(answer.curve, v)) {
      s.points += 1.0;
      const double load = answer.model.load;
      if (truth >= stated->low + load && truth <= stated->high + load) s.covered += 1.0;
      width += 50.0 * (stated->high - stated->low) / std::abs(truth);
    }
  }
  s.curve_error = 100.0 * std::sqrt(wrong / all);
  const double mass = axis.plant.total_mass();
  s.mass_error = 100.0 * std::abs(answer.model.mass - mass) / mass;
  if (s.points > 0.0) s.half_width = width / s.points;
  if (answer.mass) s.mass_covered = mass >= (*answer.mass)[0] && mass <= (*answer.mass)[1] ? 1.0 : 0.0;
  return s;
}

report::BoardFigure board_figure(std::vector<double> values, std::size_t group, std::uint64_t seed) {
  report::BoardFigure f{{kNaN, kNaN, kNaN}, {kNaN, kNaN, kNaN}, std::move(values)};
  std::vector<double> known;
  for (const double x : f.values) {
    if (!std::isnan(x)) known.push_back(x);
  }
  if (known.empty()) return f;
  const std::size_t machines = f.values.size() / group;
  const auto quantile = [&](double p) {
    return [&f, group, p](const std::vector<std::size_t>& drawn) {
      std::vector<double> some;
      for (const std::size_t m : drawn) {
        for (std::size_t k = 0; k < group; ++k) {
          if (!std::isnan(f.values[m * group + k])) some.push_back(f.values[m * group + k]);
        }
      }
      return sim::interpolated_quantile(std::move(some), p);
    };
  };
  const auto median = bootstrap(machines, seed, quantile(0.5));
  const auto high = bootstrap(machines, seed, quantile(0.99));
  f.median = {sim::interpolated_quantile(known, 0.5), median[0], median[1]};
  f.p99 = {sim::interpolated_quantile(known, 0.99), high[0], machines >= kEnoughForP99 ? high[1] : kNaN};
  return f;
}

sim::Confident board_share(const std::vector<double>& part, const std::vector<double>& whole,
                           std::size_t group, std::uint64_t seed) {
  const auto share = [&](const std::vector<std::size_t>& drawn) {
    double a = 0.0;
    double b = 0.0;
    for (const std::size_t m : drawn) {
      for (std::size_t k = 0; k < group; ++k) {
        a += part[m * group + k];
        b += whole[m * group + k];
      }
    }
    return b > 0.0 ? 100.0 * a / b : kNaN;
  };
  std::vector<std::size_t> once(part.size() / group);
  for (std::size_t i = 0; i < once.size(); ++i) once[i] = i;
  const double value = share(once);
  if (std::isnan(value)) return {kNaN, kNaN, kNaN};
  const auto interval = bootstrap(once.size(), seed, share);
  return {value, interval[0], interval[1]};
}

}  // namespace stribeck::workflow
