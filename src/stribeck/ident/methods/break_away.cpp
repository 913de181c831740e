#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stribeck/ident/map/steady_runs.hpp>
#include <stribeck/ident/methods/break_away.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/shown.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <stribeck/ident/stats/quantiles.hpp>

namespace stribeck::ident::methods {
namespace {

constexpr double kSmaller = 0.95;   // force of the earlier row
constexpr double kGrowth = 2.0;     // of the deflection since
constexpr double kAtRest = 0.02;    // share of the largest force: at rest between ramps
constexpr double kNotYet = 0.2;     // share of the ramp's largest force below which no slip is searched
constexpr double kStraight = 0.05;  // share of the force at the slip: RMS distance from the straight line
constexpr std::size_t kFewestQuiet = 5;  // rows without force before a ramp
constexpr double kRestBefore =
    0.1;  // share of the deflection at the slip by which the axis may move just before the ramp
constexpr std::size_t kFewestRampRows = 30;
constexpr double kElastic = 4.0;  // factor by which the deflection grows over the second half of the force
constexpr double kCounts = 8.0;   // encoder steps that a deflection needs to be seen
constexpr double kQuasi = 0.85;   // share of the slip's force up to which the distance is fitted
constexpr int kGrid = 60;

double smallest_step(const std::vector<double>& x) {
  double step = std::numeric_limits<double>::infinity();
  for (std::size_t k = 1; k < x.size(); ++k) {
    if (x[k] != x[k - 1]) step = std::min(step, std::abs(x[k] - x[k - 1]));
  }
  return std::isfinite(step) ? step : 0.0;
}

/// Residual of F = F_s·(1 − exp(−y/δ)) with the best F_s.
double misfit(const std::vector<double>& y, const std::vector<double>& f, double length) {
  double bb = 0.0, bf = 0.0, ff = 0.0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    const double b = -std::expm1(-std::max(0.0, y[i]) / length);
    bb += b * b, bf += b * f[i], ff += f[i] * f[i];
  }
  return bb > 0.0 ? ff - bf * bf / bb : ff;
}

/// First over lengths in a fixed ratio, then by golden section.
double fit_length(const std::vector<double>& y, const std::vector<double>& f) {
  const double longest = 10.0 * *std::max_element(y.begin(), y.end());
  const double ratio = std::pow(1000.0, 1.0 / kGrid);
  double best = longest;
  for (int i = 0; i <= kGrid; ++i) {
    const double length = longest * std::pow(ratio, -i);
    if (misfit(y, f, length) < misfit(y, f, best)) best = length;
  }
  double low = best / ratio, high = best * ratio;
  const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
  for (int i = 0; i < 40; ++i) {
    const double a = high - golden * (high - low);
    const double b = low + golden * (high - low);
    (misfit(y, f, a) < misfit(y, f, b) ? high : low) = misfit(y, f, a) < misfit(y, f, b) ? b : a;
  }
  return 0.5 * (low + high);
}

/// Acceleration of the parabola through rows first … last.
double acceleration(const std::vector<double>& y, std::size_t first, std::size_t last, double T) {
  const auto n = static_cast<double>(last - first + 1);
  const double middle = 0.5 * static_cast<double>(first + last);
  double s2 = 0, s4 = 0, sy = 0, s2y = 0;
  for (std::size_t k = first; k <= last; ++k) {
    const double t = (static_cast<double>(k) - middle) * T;
    s2 += t * t, s4 += t * t * t * t, sy += y[k], s2y += t * t * y[k];
  }
  const double det = n * s4 - s2 * s2;
  return det > 0.0 ? 2.0 * (n * s2y - s2 * sy) / det : 0.0;
}

/// Reason why a stretch of force is no ramp up to a slip.
enum class No { kReference, kMoving, kCrooked, kStill, kCreeping, kCount };

struct Judged {
  std::optional<Slip> slip;
  No why = No::kStill;
  double travel = 0.0;  ///< of a stretch in which the axis creeps [m]
};

/// RMS distance from the least-squares line of f[0…k], as a share of the last value.
double crooked(const std::vector<double>& f, std::size_t k) {
  const auto n = static_cast<double>(k + 1);
  const double middle = 0.5 * static_cast<double>(k);
  double mean = 0.0;
  for (std::size_t i = 0; i <= k; ++i) mean += f[i] / n;
  double tt = 0.0, tf = 0.0, ff = 0.0;
  for (std::size_t i = 0; i <= k; ++i) {
    const double t = static_cast<double>(i) - middle;
    tt += t * t, tf += t * (f[i] - mean), ff += (f[i] - mean) * (f[i] - mean);
  }
  return std::sqrt(std::max(0.0, ff - tf * tf / tt) / n) / std::abs(f[k]);
}

/// Rows first … last have one sign of force; from `begin` to `first` there is almost no force.
Judged first_slip(const log::Record& rec, std::size_t begin, std::size_t first, std::size_t last,
                  int direction, const BreakAwayOptions& options) {
  std::size_t top = first;
  for (std::size_t k = first; k <= last; ++k) {
    if (direction * rec.f[k] > direction * rec.f[top]) top = k;
  }
  std::vector<double> start(rec.x.begin() + static_cast<std::ptrdiff_t>(first),
                            rec.x.begin() + static_cast<std::ptrdiff_t>(std::min(first + 5, last + 1)));
  const double rest = stats::median(std::move(start));
  std::vector<double> y, f;
  for (std::size_t k = first; k <= top; ++k) {
    y.push_back(direction * (rec.x[k] - rest));
    f.push_back(direction * rec.f[k]);
  }
  const double visible = kCounts * smallest_step(rec.x);
  if (!rec.r.empty()) {
    const auto [low, high] = std::minmax_element(rec.r.begin() + static_cast<std::ptrdiff_t>(first),
                                                 rec.r.begin() + static_cast<std::ptrdiff_t>(top + 1));
    if (*high - *low > visible) return {{}, No::kReference};
  }
  std::size_t before = 0;
  for (std::size_t k = 1; k < y.size(); ++k) {
    while (before + 1 < k && f[before + 1] <= kSmaller * f[k]) ++before;
    if (k < kFewestRampRows || f[k] < kNotYet * f.back() || y[before] < visible) continue;
    if (y[k] < kGrowth * y[before]) continue;
    if (crooked(f, k) > kStraight) return {{}, No::kCrooked};
    // There is no force just before it, unless the record begins here; early in that pause the axis may still spring back.
    const std::size_t pause = first - begin;
    if (begin > 0 && pause < kFewestQuiet) return {{}, No::kMoving};
    for (std::size_t i = first - pause / 4; i < first; ++i) {
      if (std::abs(rec.x[i] - rest) > std::max(visible, kRestBefore * y[k])) return {{}, No::kMoving};
    }
    Slip slip;
    slip.row = first + k;
    slip.direction = direction;
    slip.deflection = y[k];
    double force = f[k];
    if (options.mass) {
      // The second half of the travel from `before` is the slip, and a parabola describes it.
      const std::size_t half = std::max<std::size_t>(2, (k - before) / 2);
      force -= *options.mass *
               acceleration(y, k - std::min(k, half), std::min(k + half, y.size() - 1), rec.sample_time);
    }
    slip.force = direction * force;
    // Close to the slip, the axis already lags behind the ramp.
    std::size_t quasi = k;
    while (quasi > 2 && f[quasi] > kQuasi * force) --quasi;
    y.resize(quasi + 1);
    f.resize(quasi + 1);
    slip.distance = fit_length(y, f);
    return {slip, {}};
  }
  // Elastic to its end, with F = F_s·(1 − exp(−y/δ)) below 0.9 F_s: it did not reach sliding.
  const std::size_t half = static_cast<std::size_t>(
      std::find_if(f.begin(), f.end(), [&](double force) { return force >= 0.5 * f.back(); }) - f.begin());
  if (!(y.back() > visible) || y.back() < kElastic * y[half]) return {{}, No::kStill};
  if (crooked(f, f.size() - 1) > kStraight) return {{}, No::kCrooked};
  return {{}, No::kCreeping, y.back()};
}

/// Classifies the stretches without a slip.
std::string reasons(const std::array<std::size_t, static_cast<std::size_t>(No::kCount)>& count, double travel,
                    const Shown& shown) {
  std::string out;
  const auto say = [&](No no, const std::string& what) {
    const std::size_t n = count[static_cast<std::size_t>(no)];
    if (n > 0) out += (out.empty() ? "" : "; ") + fmt::format("{} ", n) + what;
  };
  say(No::kReference, "while the reference moves, where the force follows the motion");
  say(No::kMoving, "not from rest");
  say(No::kCrooked, "with a force that does not rise steadily");
  say(No::kStill, "without any sliding (a higher force is needed)");
  say(No::kCreeping,
      fmt::format("during which the axis moves by as much as {} but never slips suddenly (the ramp is too "
                  "quick, or noise in force or friction lets the axis creep)",
                  shown.length(travel)));
  return out;
}

struct Mean {
  double value = std::numeric_limits<double>::quiet_NaN();
  Interval interval;
};

Mean mean_of(const std::vector<double>& values) {
  Mean m;
  if (values.empty()) return m;
  const auto n = static_cast<double>(values.size());
  m.value = 0.0;
  for (const double v : values) m.value += v / n;
  if (values.size() < 2) return m;
  double square = 0.0;
  for (const double v : values) square += (v - m.value) * (v - m.value);
  const double half = stats::student_factor(n - 1.0) * std::sqrt(square / (n - 1.0) / n);
  m.interval = {m.value - half, m.value + half};
  return m;
}

/// Stretches of one sign of force, and the reason for those without a slip.
struct Stretches {
  std::size_t count = 0;
  std::array<std::size_t, static_cast<std::size_t>(No::kCount)> no{};
  double creep = 0.0;  ///< longest travel of a stretch with creep [m]
};

/// Adds the quiet beginning to the ramp: the ramp starts at the first row at which the force begins to rise.
std::size_t begin_of_ramp(const std::vector<double>& f, std::size_t first, int direction) {
  while (first > 0 && direction * f[first - 1] >= 0.0 && std::abs(f[first - 1]) < std::abs(f[first])) --first;
  return first;
}

/// Finds all slips of record number `record`.
void find_slips(const log::Record& rec, std::size_t record, const BreakAwayOptions& options,
                std::vector<Slip>& slips, Stretches& stretches) {
  double largest = 0.0;
  for (const double f : rec.f) largest = std::max(largest, std::abs(f));
  const double quiet = kAtRest * largest;
  for (std::size_t k = 0; k < rec.f.size();) {
    if (std::abs(rec.f[k]) <= quiet) {
      ++k;
      continue;
    }
    const int direction = rec.f[k] > 0.0 ? 1 : -1;
    std::size_t end = k;
    while (end + 1 < rec.f.size() && direction * rec.f[end + 1] > quiet) ++end;
    if (end - k >= kFewestRampRows) {
      ++stretches.count;
      std::size_t begin = k;
      while (begin > 0 && std::abs(rec.f[begin - 1]) <= quiet) --begin;
      Judged judged = first_slip(rec, begin, begin_of_ramp(rec.f, k, direction), end, direction, options);
      if (judged.slip) {
        judged.slip->record = record;
        slips.push_back(*judged.slip);
      } else {
        ++stretches.no[static_cast<std::size_t>(judged.why)];
        stretches.creep = std::max(stretches.creep, judged.travel);
      }
    }
    k = end + 1;
  }
}

/// Means: force of each direction, and the distance of both.
void write_means(BreakAway& out, Result& r) {
  std::vector<double> force[2], distance;
  for (const Slip& s : out.slips) {
    force[s.direction > 0 ? 0 : 1].push_back(s.force);
    distance.push_back(s.distance);
  }
  for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
    const Mean m = mean_of(force[side]);
    out.force[side] = m.value;
    out.interval[side] = m.interval;
    const std::string name = side == 0 ? "positive" : "negative";
    if (force[side].empty()) {
      r.cannot_tell.push_back("break-away force of " + name + " motion: no ramp in that direction");
      continue;
    }
    r.parameters.push_back({"break_away_" + name, m.value, "N", "N", m.interval.low, m.interval.high, true});
    if (force[side].size() == 1) {
      r.cannot_tell.push_back("interval of the break-away force of " + name +
                              " motion: one ramp only, repeat it");
    }
  }
  const Mean d = mean_of(distance);
  out.distance = d.value;
  out.distance_interval = d.interval;
  r.break_away_distance = d.value;
  r.parameters.push_back({"break_away_distance", d.value, "m", "um", d.interval.low, d.interval.high, true});
}

}  // namespace

BreakAway identify_break_away(const std::vector<log::Record>& records, const BreakAwayOptions& options) {
  if (records.empty()) throw Refused("break-away: no record given");
  BreakAway out;
  Stretches stretches;
  for (std::size_t r = 0; r < records.size(); ++r)
    find_slips(map::with_positions(records[r]), r, options, out.slips, stretches);
  if (out.slips.empty()) {
    const std::string why = reasons(stretches.no, stretches.creep, Shown(records.front()));
    throw Refused(
        fmt::format(
            "break-away: none of {} stretches with one sign of force is a slow ramp that ends in a slip",
            stretches.count) +
        (why.empty() ? "" : ": " + why) +
        "; ramp the force from rest until the axis slips (excite --method ramp)");
  }
  Result& r = out.result;
  r.method = Method::kBreakAway;
  r.set_steady(SteadyModel::kNone);
  r.force_unit = records.front().force_unit;
  r.position_unit = records.front().position_unit;
  r.mass = std::numeric_limits<double>::quiet_NaN();
  write_means(out, r);
  r.rows = out.slips.size();
  if (out.slips.size() < stretches.count) {
    r.warnings.push_back(
        fmt::format(
            "{} of {} stretches with one sign of force were left out, because they are not slow ramps that end in a slip: ",
            stretches.count - out.slips.size(), stretches.count) +
        reasons(stretches.no, stretches.creep, Shown(records.front())));
  }
  if (!options.mass) {
    r.warnings.push_back(
        "without the mass the force at the slip holds the small part that accelerates the axis");
  }
  r.cannot_tell.push_back(
      "friction at speed, mass, and a load, which cannot be distinguished from break-away forces that differ");
  return out;
}

}  // namespace stribeck::ident::methods
