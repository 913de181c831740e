#include <algorithm>
#include <array>
#include <cmath>
#include <stribeck/ident/bristle/bristle_fit.hpp>
#include <stribeck/ident/drive/load/load_of_reversals.hpp>
#include <stribeck/ident/refused.hpp>
#include <utility>

namespace stribeck::ident::drive {
namespace {

constexpr double kSameDirections = 0.05;  ///< of the level: directions that differ by less need no load
constexpr double kNoMoreLoad = 0.01;      ///< of the level: a smaller step ends the search
constexpr int kMostLoads = 8;
constexpr double kLeastLevel =
    2.0 / 3.0;                     ///< of the mean of both levels: friction differs by at most two to one
constexpr double kMostLeft = 0.1;  ///< of the mean of both levels, that one bristle may leave after reversals
constexpr double kHopeless = 4.0;  ///< ratio of the ends of the interval of the break-away distance
constexpr double kLeastGain = 0.9;  ///< of the variance that was believed before: the data must tell more

struct Levels {
  double forward = 0.0, backward = 0.0;
  [[nodiscard]] double mean() const { return 0.5 * (forward + backward); }
};

/// At rest, as the bristle takes them.
Levels levels_of(const friction::AxisModel& axis) {
  constexpr double kAtRest = 1e-9;
  return {axis.friction.parts(kAtRest, 0.0).level, axis.friction.parts(-kAtRest, 0.0).level};
}

friction::AxisModel with_load(friction::AxisModel axis, double load) {
  auto& steady = std::get<friction::Gaussian<double>>(axis.friction.steady);
  const double more = load - axis.load;
  steady.positive.eta0 -= more;
  steady.negative.eta0 -= more;
  axis.load = load;
  return axis;
}

/// By how much the load of the axis must grow for the levels that a fit found.
double asked_by(const bristle::BristleFit& fit, const Levels& level) {
  return 0.5 * (level.forward * (1.0 - fit.level_factor[0]) + level.backward * (fit.level_factor[1] - 1.0));
}

/// Standard error of the load by the data alone. The fit also holds what was believed of load and levels before, which lay around
/// the same load; absent: the data add nothing to it.
std::optional<double> error_of(const bristle::BristleFit& fit, const bristle::BristleOptions& options,
                               const Levels& level, double factor) {
  const double after = std::pow(0.5 * (fit.load_interval.high - fit.load_interval.low) / factor, 2.0);
  const auto weight = [](double sd) { return 1.0 / (sd * sd); };
  const double before =
      1.0 / (weight(options.load_tolerance * level.mean()) + weight(options.level_tolerance * level.forward) +
             weight(options.level_tolerance * level.backward));
  if (!(after < kLeastGain * before)) return {};
  return std::sqrt(1.0 / (1.0 / after - 1.0 / before));
}

/// Standard error of half the difference of the levels at rest, as the map has it. Between the slowest rows and rest the map may err,
/// and an error that differs between the directions looks like a load.
double error_of_levels(const Result& result, double factor) {
  double sum = 0.0;
  for (const char* name : {"static_positive", "static_negative"}) {
    const Parameter* p = result.find(name);
    if (p != nullptr) sum = std::hypot(sum, 0.5 * (p->ci_high - p->ci_low));
  }
  return 0.5 * sum / factor;
}

struct Search {
  bristle::BristleFit last;
  friction::AxisModel axis;
  double step = 0.0;  ///< the last one that was asked for [N]
};

/// Fits until a fit asks for no other load; absent where a level would vanish or the search does not end.
std::optional<Search> search(const std::vector<log::Record>& records, const friction::AxisModel& start,
                             bristle::BristleOptions options) {
  Search s{{}, start};
  for (int i = 0; i < kMostLoads; ++i) {
    s.last = bristle::fit_bristle(records, s.axis, options);
    if (s.last.models.size() < 2) return {};
    // Reversals that do not tell a break-away distance tell no load from it; another load changes nothing about that.
    const Interval& told = s.last.break_away_interval;
    if (!s.last.determinable && told.high > kHopeless * told.low) return {};
    const Levels level = levels_of(s.axis);
    s.step = asked_by(s.last, level);
    if (std::abs(s.step) < kNoMoreLoad * level.mean()) return s;
    const double least = std::min(level.forward - s.step, level.backward + s.step);
    if (!(least > kLeastLevel * level.mean())) return {};
    s.axis = with_load(s.axis, s.axis.load + s.step);
    if (s.last.break_away > 0.0) options.near = s.last.break_away;
  }
  return {};
}

}  // namespace

std::optional<ToldLoad> load_of_reversals(const Result& result, const Found& found) {
  const auto* map = std::get_if<friction::Gaussian<double>>(&result.friction.steady);
  if (map == nullptr || found.choice.map.fit.family != map::StaticFit::Family::kByDirection ||
      !(result.mass > 0.0) || result.position_unit != "m" || below_the_noise(result))
    return {};
  const friction::AxisModel start{result.mass, result.load, result.friction};
  const Levels level = levels_of(start);
  if (!(level.forward > 0.0 && level.backward > 0.0)) return {};
  const double apart = 0.5 * std::abs(level.forward - level.backward);
  if (start.load == 0.0 && !(apart > kSameDirections * level.mean())) return {};
  bristle::BristleOptions options;
  options.shift = found.log.shift;
  options.elements = 0;
  std::optional<Search> s;
  try {
    s = search(records_of_reversals(found.log), start, options);
  } catch (const Refused&) {
    // add_bristle() reports what the bristle fit cannot determine.
    return {};
  }
  if (!s || !s->last.determinable) return {};
  // Where one bristle does not describe the reversals, what it asks for is no load.
  if (s->last.models[1].held_out_rms > kMostLeft * levels_of(s->axis).mean()) return {};
  const double factor = found.intervals.factor;
  const std::optional<double> own = error_of(s->last, options, levels_of(s->axis), factor);
  if (!own) return {};
  const double error = std::hypot(*own, error_of_levels(result, factor));
  if (!(std::abs(s->last.load - start.load) > factor * error)) return {};
  return ToldLoad{s->last.load, std::hypot(error, s->step)};
}

MapChoice with_load(MapChoice choice, double load) {
  map::StaticFit& fit = choice.map.fit;
  const double more = load - fit.load;
  fit.load = load;
  for (std::size_t s = 0; s < fit.branch.size(); ++s) fit.branch[s].eta0 -= map::kDirection[s] * more;
  return choice;
}

}  // namespace stribeck::ident::drive
