#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/health/findings.hpp>
#include <stribeck/ident/stats/order.hpp>

namespace stribeck::ident::health {
namespace {

constexpr double kSeason = 2.0;      // limit of viscous friction without temperatures, times that of others
constexpr double kSameChange = 7.0;  // days between steps of one change, at most
constexpr double kBetweenChanges = 1.5;  // tests between the intervals of two changes
constexpr std::size_t kBeside = 10;      // tests before and after, at most
constexpr std::size_t kFewBeside = 3;
constexpr double kSeasonSlope = 0.002;  // of the scale, per day, as the slope of a trend
constexpr double kLeastShare = 0.02;    // that counts
constexpr double kMedianSpread = 1.25;  // standard deviation of a median to that of a mean

/// Value and half width of one number in one test; absent where the test does not have it.
using Get = std::function<std::optional<std::array<double, 2>>(const HealthTest&)>;

Channel channel_of(const std::vector<HealthTest>& tests, Number number, std::array<double, 2> at,
                   double scale, const Limits& limits, const Get& get) {
  Channel c{number, at, scale, {}, {}};
  for (const HealthTest& t : tests) {
    if (const auto value = get(t)) c.readings.push_back({t.day, (*value)[0], (*value)[1], t.temperature});
  }
  c.trend = trend_of(c.readings, {scale, limits.step, limits.drift});
  // The viscosity of a lubricant changes by some percent per kelvin: without temperatures a season may well pass the limit.
  if (number == Number::kViscous && !std::isfinite(c.trend.per_degree)) {
    c.trend.drift_limit = kSeason * limits.drift;
    c.trend.drifted =
        std::abs(c.trend.now - c.trend.reference) - c.trend.drift_half_width > c.trend.drift_limit * scale;
  }
  return c;
}

std::optional<std::array<double, 2>> pair_of(const Force& f) { return {{f.value, f.half_width}}; }

/// A number that a test may lack, times a factor.
template <class T>
Get scaled(std::optional<T> Measured::*number, double factor) {
  return [=](const HealthTest& t) -> std::optional<std::array<double, 2>> {
    const std::optional<T>& n = (*t.axis).*number;
    if (!n) return std::nullopt;
    return {{factor * n->value, factor * n->half_width}};
  };
}

void add_axis(const std::vector<HealthTest>& tests, const Limits& limits, std::vector<Channel>& out) {
  const Measured& first = *tests.front().axis;
  const double level = 0.5 * std::abs(first.forward.value + first.backward.value);
  if (!(level > 0.0)) return;
  const auto add = [&](Number number, std::array<double, 2> at, const Get& get, double scale) {
    out.push_back(channel_of(tests, number, at, scale, limits, get));
  };
  add(
      Number::kForward, {}, [](const HealthTest& t) { return pair_of(t.axis->forward); }, level);
  add(
      Number::kBackward, {}, [](const HealthTest& t) { return pair_of(t.axis->backward); }, level);
  if (first.coulomb && first.viscous) {
    const double top = first.motion.top_speed;
    // Beside much viscous friction a fifth of it is little of the whole; beside very much it is hardly measured.
    constexpr double kLeastPart = 0.3;
    add(Number::kCoulomb, {}, scaled(&Measured::coulomb, 1.0),
        std::clamp(std::abs(first.coulomb->value), kLeastPart * level, level));
    add(Number::kViscous, {}, scaled(&Measured::viscous, top),
        std::max(level, std::abs(top * first.viscous->value)));
  }
  add(
      Number::kOffset, {}, [](const HealthTest& t) { return pair_of(t.axis->offset); }, level);
  if (first.mass) add(Number::kMass, {}, scaled(&Measured::mass, 1.0), first.mass->value);
  if (first.spring) {
    const double end = 0.5 * (first.motion.travel[1] - first.motion.travel[0]);
    add(Number::kSpring, {}, scaled(&Measured::spring, end),
        std::max(level, std::abs(end * first.spring->value)));
  }
  if (first.unbalance)
    add(Number::kUnbalance, {}, scaled(&Measured::unbalance, 1.0), std::max(level, first.unbalance->value));
  for (std::size_t j = 0; j < first.places.size(); ++j)
    add(
        Number::kPlace, {first.places[j].from, first.places[j].to},
        [j](const HealthTest& t) { return pair_of(t.axis->places[j].more); }, level);
  for (std::size_t j = 0; j < first.periodic.size(); ++j)
    add(
        Number::kPeriodic, {first.periodic[j].period, 0.0},
        [j](const HealthTest& t) { return pair_of(t.axis->periodic[j].amplitude); }, level);
}

void add_circle(const std::vector<HealthTest>& tests, const Limits& limits, std::vector<Channel>& out) {
  constexpr double kLeast = 1e-6;  // [m]
  const CircleMeasured& first = *tests.front().circle;
  const auto add = [&](Number number, double value, const Get& get) {
    out.push_back(channel_of(tests, number, {}, 2.0 * std::max(value, kLeast), limits, get));
  };
  using Value = std::optional<std::array<double, 2>>;
  add(Number::kCircularDeviation, first.circular_deviation, [](const HealthTest& t) {
    return Value({t.circle->circular_deviation, 0.0});
  });
  if (first.hysteresis)
    add(Number::kHysteresis, *first.hysteresis, [](const HealthTest& t) {
      return t.circle->hysteresis ? Value({*t.circle->hysteresis, 0.0}) : Value();
    });
}

/// Usual time from test to test [days].
double spacing_of(const std::vector<Channel>& channels) {
  std::vector<double> steps;
  for (const Channel& c : channels)
    for (std::size_t i = 1; i < c.readings.size(); ++i)
      steps.push_back(c.readings[i].day - c.readings[i - 1].day);
  return steps.empty() ? 0.0 : stats::median(std::move(steps));
}

/// Whether a step may be the same event as a change: the intervals of their days meet, or nearly so.
bool is_of(const Change& change, const Step& step, double spacing) {
  const double gap = std::max(change.earliest - step.latest, step.earliest - change.latest);
  return std::abs(change.day - step.day) <= kSameChange && gap <= kBetweenChanges * spacing;
}

/// Values of a number before and after a day, up to `most` of each.
struct Beside {
  std::vector<double> days, values;  ///< days from the change on
  std::size_t after = 0;             ///< index of the first one after

  [[nodiscard]] Beside nearest(std::size_t most) const {
    const std::size_t first = after - std::min(after, most), last = std::min(days.size(), after + most);
    const auto at = [](const std::vector<double>& v, std::size_t from, std::size_t to) {
      return std::vector<double>(v.begin() + static_cast<std::ptrdiff_t>(from),
                                 v.begin() + static_cast<std::ptrdiff_t>(to));
    };
    return {at(days, first, last), at(values, first, last), after - first};
  }
};

/// Of a number no farther than the changes beside this one.
Beside beside(const Channel& c, double day, const std::vector<Change>& all) {
  double from = -std::numeric_limits<double>::infinity();
  double to = -from;
  for (const Change& other : all) {
    if (other.day < day) from = std::max(from, other.day);
    if (other.day > day) to = std::min(to, other.day);
  }
  Beside out;
  for (std::size_t i = 0; i < c.trend.values.size(); ++i) {
    const double at = c.readings[i].day;
    if (at < from || at >= to) continue;
    out.days.push_back(at - day);
    out.values.push_back(c.trend.values[i]);
    if (at < day) ++out.after;
  }
  return out;
}

/// A jump at day 0, and its standard deviation.
struct Jump {
  double value = 0.0;
  double deviation = 0.0;
};

/// Difference of the medians after and before, less the slope that both sides share. `scatter`: of one value. `slope_prior`: of a season.
Jump jump_of(const Beside& b, double scatter, double slope_prior) {
  const std::size_t n = b.days.size();
  std::vector<double> slopes;
  double spread = 0.0;
  std::array<double, 2> centre{};
  for (std::size_t side = 0; side < 2; ++side) {
    const std::size_t first = side == 0 ? 0 : b.after, last = side == 0 ? b.after : n;
    const auto count = static_cast<double>(last - first);
    for (std::size_t i = first; i < last; ++i) {
      centre[side] += b.days[i] / count;
      for (std::size_t k = first; k < i; ++k) {
        if (b.days[i] > b.days[k]) slopes.push_back((b.values[i] - b.values[k]) / (b.days[i] - b.days[k]));
      }
    }
    for (std::size_t i = first; i < last; ++i) spread += std::pow(b.days[i] - centre[side], 2.0);
  }
  const double information = spread / (scatter * scatter), prior = 1.0 / (slope_prior * slope_prior);
  const double slope =
      slopes.empty() ? 0.0 : stats::median(std::move(slopes)) * information / (information + prior);
  std::vector<double> before, after;
  for (std::size_t i = 0; i < n; ++i)
    (i < b.after ? before : after).push_back(b.values[i] - slope * b.days[i]);
  const auto m = static_cast<double>(after.size());
  const double medians =
      kMedianSpread * scatter * std::sqrt(1.0 / static_cast<double>(before.size()) + 1.0 / m);
  const double apart = centre[1] - centre[0];
  return {stats::median(after) - stats::median(before),
          std::hypot(medians, apart / std::sqrt(information + prior))};
}

/// The jump that is known best from three to ten tests before and after. What bends in a season, at any phase, widens it: of few
/// tests a month it is the most of it.
Jump best_jump(const Beside& all, double scatter, double scale) {
  constexpr double kYear = 2.0 * kPi / 365.25;  // [1/day]
  const double slope = kSeasonSlope * scale;
  // Tests that are alike to the last digit have no scatter.
  scatter = std::max(scatter, 1e-9 * scale);
  Jump best{0.0, std::numeric_limits<double>::infinity()};
  for (std::size_t most = kBeside; most >= kFewBeside; --most) {
    const Beside b = all.nearest(most);
    Jump jump = jump_of(b, scatter, slope);
    std::array<Beside, 2> season{b, b};
    for (std::size_t i = 0; i < b.days.size(); ++i) {
      season[0].values[i] = slope / kYear * std::cos(kYear * b.days[i]);
      season[1].values[i] = slope / kYear * std::sin(kYear * b.days[i]);
    }
    const double bend =
        std::hypot(jump_of(season[0], scatter, slope).value, jump_of(season[1], scatter, slope).value) /
        std::sqrt(2.0);
    jump.deviation = std::hypot(jump.deviation, bend);
    if (jump.deviation < best.deviation) best = jump;
  }
  return best;
}

/// The step of a number that belongs to a change; none: null.
const Step* own_step(const Channel& c, const Change& change, double spacing) {
  const Step* own = nullptr;
  for (const Step& step : c.trend.steps) {
    if (!is_of(change, step, spacing)) continue;
    if (own == nullptr || std::abs(step.day - change.day) < std::abs(own->day - change.day)) own = &step;
  }
  return own;
}

/// How much a number changed at a change: its own step, or what its tests before and after show beside their slope.
Shift shift_at(const Channel& c, std::size_t index, const Change& change, const std::vector<Change>& all,
               double spacing) {
  Shift s{index, 0.0, 0.0, false};
  if (!c.trend.known()) return s;
  if (const Step* own = own_step(c, change, spacing)) {
    s.share = c.share(own->change);
    s.deviation = c.share(own->half_width) / 1.96;
    return s;
  }
  const Beside tests = beside(c, change.day, all);
  if (tests.after == 0 || tests.after == tests.days.size()) return s;
  const Jump jump = best_jump(tests, c.trend.scatter, c.scale);
  s.share = c.share(jump.value);
  s.deviation = c.share(jump.deviation);
  return s;
}

Shift drift_of(const Channel& c, std::size_t index) {
  if (!c.trend.known()) return {index, 0.0, 0.0, false};
  return {index, c.share(c.trend.now - c.trend.reference), c.share(c.trend.drift_half_width) / 1.96, false};
}

/// Least share that counts: no more than the limit of a step.
double least_of(const Limits& limits) { return std::min(kLeastShare, limits.step); }

/// What counts, and the causes that fit it.
void judge(Change& change, const std::vector<Channel>& channels, double least) {
  for (Shift& s : change.shifts) s.counts = std::abs(s.share) >= std::max(least, 3.0 * s.deviation);
  change.causes = causes_of(channels, change.shifts);
}

/// Whether a number goes back to what it was before an earlier change.
bool goes_back(const Health& health, const Change& change, const Shift& s, double spacing) {
  if (const Step* own = own_step(health.channels[s.channel], change, spacing)) return own->restores;
  for (const Change& other : health.changes) {
    const Shift& e = other.shifts[s.channel];
    if (other.day < change.day && e.counts && e.share * s.share < 0.0 &&
        std::abs(e.share + s.share) <= 0.5 * std::abs(e.share))
      return true;
  }
  return false;
}

/// Of a change whose largest step goes back: whether all of it does, and the causes of what does not.
void judge_return(const Health& health, Change& change, double spacing) {
  std::vector<Shift> others = change.shifts;
  for (Shift& s : others) s.counts = s.counts && !goes_back(health, change, s, spacing);
  change.causes.clear();  // the cause of the earlier step has ended
  if (std::none_of(others.begin(), others.end(), [](const Shift& s) { return s.counts; })) return;
  change.restores = false;
  change.restores_part = true;
  change.causes = causes_of(health.channels, others);
}

void add_steps(Health& health, const Limits& limits) {
  struct Found {
    const Step* step;
    double size;
  };
  const double least = least_of(limits);
  std::vector<Found> all;
  for (const Channel& c : health.channels) {
    for (const Step& s : c.trend.steps) {
      // A step that does not count makes no change of its own.
      if (const double size = c.share(std::abs(s.change)); size >= least) all.push_back({&s, size});
    }
  }
  // The largest first: it gives the day of its change.
  std::stable_sort(all.begin(), all.end(), [](const Found& a, const Found& b) { return a.size > b.size; });
  const double spacing = spacing_of(health.channels);
  for (const Found& found : all) {
    const Step& s = *found.step;
    auto same = health.changes.end();
    for (auto c = health.changes.begin(); c != health.changes.end(); ++c) {
      if (!is_of(*c, s, spacing)) continue;
      if (same == health.changes.end() || std::abs(c->day - s.day) < std::abs(same->day - s.day)) same = c;
    }
    if (same == health.changes.end()) {
      Change change;
      change.day = s.day;
      change.earliest = s.earliest;
      change.latest = s.latest;
      change.probability = s.probability;
      change.beyond_limit = s.beyond_limit;
      change.undone = s.undone;
      change.restores = s.restores;
      health.changes.push_back(std::move(change));
    } else if (s.matters()) {
      same->beyond_limit = true;
      same->undone = false;
      same->restores = false;
    }
  }
  for (Change& change : health.changes) {
    for (std::size_t i = 0; i < health.channels.size(); ++i)
      change.shifts.push_back(shift_at(health.channels[i], i, change, health.changes, spacing));
    judge(change, health.channels, least);
  }
  for (Change& change : health.changes) {
    if (change.restores) judge_return(health, change, spacing);
  }
}

void add_drift(Health& health, const Limits& limits) {
  const auto drifted = std::find_if(health.channels.begin(), health.channels.end(),
                                    [](const Channel& c) { return c.trend.drifted; });
  if (drifted == health.channels.end()) return;
  // Steps beyond the limit report this change already.
  const bool by_steps = std::all_of(health.channels.begin(), health.channels.end(),
                                    [](const Channel& c) { return !c.trend.drifted || c.trend.stepped; });
  if (by_steps) return;
  Change change;
  change.slow = true;
  change.day = change.earliest = change.latest = drifted->readings.back().day;
  change.beyond_limit = true;
  for (std::size_t i = 0; i < health.channels.size(); ++i)
    change.shifts.push_back(drift_of(health.channels[i], i));
  judge(change, health.channels, least_of(limits));
  health.changes.push_back(std::move(change));
}

}  // namespace

Health health_of(const std::vector<HealthTest>& tests, const Limits& limits, bool rotary) {
  Health out;
  if (tests.empty()) return out;
  if (tests.front().axis) add_axis(tests, limits, out.channels);
  if (tests.front().circle) add_circle(tests, limits, out.channels);
  for (Channel& c : out.channels) c.rotary = rotary;
  add_steps(out, limits);
  add_drift(out, limits);
  std::stable_sort(out.changes.begin(), out.changes.end(),
                   [](const Change& a, const Change& b) { return a.day < b.day; });
  return out;
}

}  // namespace stribeck::ident::health
