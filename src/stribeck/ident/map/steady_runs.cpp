#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stribeck/ident/map/constant_speed.hpp>
#include <stribeck/ident/map/run_periodic.hpp>
#include <stribeck/ident/map/steady_runs.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/shown.hpp>
#include <stribeck/ident/stats/long_run.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <utility>

namespace stribeck::ident::map {
namespace {

constexpr std::size_t kFewestRows = 20;
constexpr double kRelaxations = 6.0;
constexpr double kSameWay = 4.0;     // factor within which lengths agree
constexpr std::size_t kSlowest = 6;  // one run in this many counts as slow; slow runs show the bristle best
constexpr std::size_t kNamed = 6;    // number of stretches left out that are noted one by one

/// Distance in which the force relaxes to 1/e after the reversal before a run [m]; NaN: the rows do not resolve it.
double relaxation_of(const log::Record& rec, const ConstantSpeed& f) {
  constexpr std::size_t kResolved = 6;
  constexpr double kLengths = 2.0;  // exp(−2) is well above the noise
  constexpr double kShortOfRun = 0.2;
  const double none = std::numeric_limits<double>::quiet_NaN();
  if (!f.reversal) return none;
  const std::size_t half = f.run.first + (f.run.last - f.run.first) / 2;
  const double end = mean_over(rec.f, half, f.run.last + 1);
  const double begin = rec.f[*f.reversal];
  const double change = end - begin;
  if (change * f.run.speed <= 0.0 || std::abs(change) < 0.5 * std::abs(end))
    return none;  // the force does not reverse
  for (std::size_t k = *f.reversal; k <= f.run.last; ++k) {
    if ((end - rec.f[k]) / change > std::exp(-kLengths)) continue;
    if (k - *f.reversal < kResolved) return none;
    const double way = std::abs(rec.x[k] - rec.x[*f.reversal]);
    return way < kShortOfRun * std::abs(rec.x[f.run.last] - rec.x[f.run.first]) ? way / kLengths : none;
  }
  return none;
}

/// The relaxation length on which the slow runs agree [m]; NaN: none. At higher speeds the force for the acceleration hides
/// the bristle.
double relaxation_of_slow(const std::vector<log::Record>& records, const std::vector<ConstantSpeed>& found) {
  std::vector<std::pair<double, double>> lengths;  // speed, length
  std::vector<double> speeds;
  for (const ConstantSpeed& f : found) {
    const double length = relaxation_of(records[f.run.record], f);
    if (std::isfinite(length)) lengths.push_back({std::abs(f.run.speed), length});
    speeds.push_back(std::abs(f.run.speed));
  }
  std::sort(speeds.begin(), speeds.end());
  std::sort(lengths.begin(), lengths.end());
  std::vector<double> slow;
  for (const auto& [speed, length] : lengths) {
    const bool enough = slow.size() >= std::max<std::size_t>(2, found.size() / kSlowest);
    if (!enough && speed <= speeds[speeds.size() / 3]) slow.push_back(length);
  }
  if (slow.size() < 2) return std::numeric_limits<double>::quiet_NaN();
  const auto [least, most] = std::minmax_element(slow.begin(), slow.end());
  return *most < kSameWay * *least ? stats::median(slow) : std::numeric_limits<double>::quiet_NaN();
}

/// Leaves out the beginning of a run and computes its measured speed. Returns why the whole run is left out, or an empty text.
std::string settle(ConstantSpeed& f, const log::Record& rec, double exclude, const SteadyOptions& options) {
  SteadyRun& run = f.run;
  const double T = rec.sample_time;
  const double duration = T * static_cast<double>(run.last - run.first);
  const double way = std::abs(rec.x[run.last] - rec.x[f.reversal.value_or(run.first)]);
  if (f.from_change) {
    run.first += static_cast<std::size_t>(std::ceil(std::min(options.settle, 0.3 * duration) / T));
  }
  if (f.reversal) {
    while (run.first < run.last && std::abs(rec.x[run.first] - rec.x[*f.reversal]) < exclude) ++run.first;
  }
  if (run.last - run.first + 1 < kFewestRows ||
      T * static_cast<double>(run.last - run.first) < options.shortest) {
    return f.reversal && way < 1.5 * exclude
               ? fmt::format(
                     "{}: {} from {:.4g} s: moved {}, and pre-sliding lasts {} after a reversal; left out",
                     rec.source, Shown(rec).speed(run.speed), rec.t[run.first], Shown(rec).length(way),
                     Shown(rec).length(exclude))
               : fmt::format("{}: {} from {:.4g} s: less than {:g} s of constant speed; left out", rec.source,
                             Shown(rec).speed(run.speed), rec.t[run.first], options.shortest);
  }
  const double rows = static_cast<double>(run.last - run.first);
  const double speed = (rec.x[run.last] - rec.x[run.first]) / (rows * T);
  if (!rec.r.empty() && std::abs(speed - run.speed) > 0.1 * std::abs(run.speed)) {
    return fmt::format("{}: {} asked from {:.4g} s on, but the axis moved with {}; left out", rec.source,
                       Shown(rec).speed(run.speed), rec.t[run.first], Shown(rec).speed(speed));
  }
  run.speed = speed;
  run.way = std::abs(rec.x[run.last] - rec.x[run.first]);
  return {};
}

std::vector<std::string> notes_of(const std::vector<std::string>& left_out) {
  std::vector<std::string> out(
      left_out.begin(), left_out.begin() + static_cast<std::ptrdiff_t>(std::min(left_out.size(), kNamed)));
  if (left_out.size() > kNamed)
    out.push_back(
        fmt::format("and {} more stretches were left out for similar reasons", left_out.size() - kNamed));
  return out;
}

bool skipped(const log::Record& rec, std::size_t k) { return !rec.skip.empty() && rec.skip[k] != 0; }

/// Why a run does not count whose rows are mostly not fitted, as those of a clipped force; else empty.
std::string mostly_skipped(const SteadyRun& run, const log::Record& rec) {
  constexpr double kMost = 0.3;
  std::size_t rows = 0;
  for (std::size_t k = run.first; k <= run.last; ++k) rows += skipped(rec, k) ? 1 : 0;
  if (static_cast<double>(rows) <= kMost * static_cast<double>(run.last - run.first + 1)) return {};
  return fmt::format("{}: {} from {:.4g} s: {} of its {} rows are not fitted; left out", rec.source,
                     Shown(rec).speed(run.speed), rec.t[run.first], rows, run.last - run.first + 1);
}

/// Mean force of a run without the periodic term, and its standard error; returns the long-run variance per time [N² s].
double take_mean(SteadyRun& run, const log::Record& rec,
                 const std::optional<friction::Eccentric<double>>& periodic, double& variance) {
  std::vector<double> e;
  std::vector<std::size_t> at;
  for (std::size_t k = run.first; k <= run.last; ++k) {
    if (skipped(rec, k)) continue;
    double f = rec.f[k];
    if (periodic) {
      friction::SteadyParts<double> p;
      periodic->add_to(p, rec.x[k]);
      f -= p.additive + (run.speed > 0.0 ? p.level : -p.level);
    }
    e.push_back(f);
    at.push_back(k);
  }
  const double n = static_cast<double>(e.size());
  double mean = 0.0;
  for (const double f : e) mean += f / n;
  variance = 0.0;
  for (double& f : e) f -= mean, variance += f * f / n;
  const stats::Memory memory = stats::memory_of(e, std::vector<int>(e.size(), 0), at);
  run.force = mean;
  run.error = std::sqrt(variance * 2.0 * std::max(0.5, memory.rows) / n);
  return 2.0 * std::max(0.5, memory.rows) * variance * rec.sample_time;
}

}  // namespace

log::Record with_positions(const log::Record& record) {
  log::Record out = record;
  if (out.x.empty() && out.v.size() == out.t.size() && !out.v.empty()) {
    out.x.assign(out.v.size(), 0.0);
    for (std::size_t k = 1; k < out.v.size(); ++k) {
      out.x[k] = out.x[k - 1] + 0.5 * out.sample_time * (out.v[k] + out.v[k - 1]);
    }
  }
  const auto wrong = log::problems(out);
  if (!wrong.empty()) throw Refused(wrong.front());
  return out;
}

SteadyRuns find_steady_runs(const std::vector<log::Record>& records, const SteadyOptions& options) {
  SteadyRuns out;
  std::vector<log::Record> whole;
  whole.reserve(records.size());
  bool measured = true;  // whether positions of all records are measured from the same zero
  for (const log::Record& r : records) {
    whole.push_back(with_positions(r));
    measured = measured && !r.x.empty();
  }
  std::vector<ConstantSpeed> found;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    for (ConstantSpeed& f : find_constant_speeds(whole[i], i)) found.push_back(std::move(f));
  }
  out.relaxation = relaxation_of_slow(whole, found);
  out.exclude = options.exclude.value_or(std::isfinite(out.relaxation) ? kRelaxations * out.relaxation : 0.0);
  std::vector<std::string> left_out;
  for (ConstantSpeed& f : found) {
    std::string why = settle(f, whole[f.run.record], out.exclude, options);
    if (why.empty()) why = mostly_skipped(f.run, whole[f.run.record]);
    if (!why.empty()) {
      left_out.push_back(std::move(why));
    } else if (f.run.speed != 0.0) {
      out.runs.push_back(f.run);
    }
  }
  out.notes = notes_of(left_out);
  if (measured) out.periodic = find_run_periodic(whole, out.runs, options.period);
  double square = 0.0, correlated = 0.0, time = 0.0;
  for (SteadyRun& run : out.runs) {
    const log::Record& rec = whole[run.record];
    double variance = 0.0;
    correlated += take_mean(run, rec, out.periodic, variance);
    square += variance;
    time += rec.sample_time * static_cast<double>(run.last - run.first + 1);
  }
  // Error of the amplitude: the long-run variance over the whole time that was used.
  if (out.periodic && square > 0.0)
    out.periodic_error = std::sqrt(2.0 * correlated / static_cast<double>(out.runs.size()) / time);
  return out;
}

}  // namespace stribeck::ident::map
