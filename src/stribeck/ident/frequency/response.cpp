#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <map>

#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/digits.hpp>
#include <stribeck/ident/frequency/response.hpp>
#include <stribeck/ident/frequency/stretches.hpp>
#include <stribeck/ident/log/motion.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/stats/quantiles.hpp>

namespace stribeck::ident::frequency {
namespace {

constexpr double kOfHalfRate = 0.95;     ///< of half the sampling frequency: highest line
constexpr double kRatio = 1.06;          ///< of neighbouring lines without a period
constexpr double kLongestSegment = 4.0;  ///< [s]
constexpr std::size_t kShortestSegment = 64;
constexpr std::size_t kEnoughSegments = 16;
constexpr std::size_t kFirstBin = 3;  ///< what a window leaks from the mean and the slope ends below it
constexpr std::size_t kEnoughStretches = 4;
constexpr double kSettle = 0.1;         ///< after a reversal, without a period [s]
constexpr double kExcited = 3e-5;       ///< power of acceleration of an excited line, of the largest one
constexpr double kAboveQuiet = 10.0;    ///< the same, above the quiet harmonics
constexpr double kOwn = 2.6;            ///< a variance above its neighbours' by this factor stands alone
constexpr double kOverlap = 1.0 / 6.0;  ///< correlation of Hann segments that overlap by half

/// A record and the signal that excites it.
struct Source {
  const log::Record* record = nullptr;
  const std::vector<double>* z = nullptr;
};

/// A stretch that counts, and the parts of it that are transformed.
struct Part {
  Source source;
  std::vector<std::size_t> segments;  ///< first rows
};

struct Plan {
  std::size_t window = 0;  ///< rows of a segment
  std::size_t repeat = 0;  ///< rows of a period; 0: none
  std::vector<Part> parts;
};

struct Signals {
  Complex z{}, f{}, x{};
};

/// Sums over the segments of a unit, for one line.
struct Sums {
  Complex xz{}, fz{}, xf{};
  double zz = 0.0, ff = 0.0, xx = 0.0;

  void add(const Signals& s) {
    xz += s.x * std::conj(s.z);
    fz += s.f * std::conj(s.z);
    xf += s.x * std::conj(s.f);
    zz += std::norm(s.z);
    ff += std::norm(s.f);
    xx += std::norm(s.x);
  }
  void add(const Sums& o) {
    xz += o.xz, fz += o.fz, xf += o.xf;
    zz += o.zz, ff += o.ff, xx += o.xx;
  }
};

/// Transforms of segments at whole numbers of turns within them.
class Transform {
 public:
  Transform(std::size_t rows, std::size_t repeat) : rows_(rows), repeat_(repeat) {
    const double step = 2.0 * kPi / static_cast<double>(rows);
    for (std::size_t k = 0; k < rows; ++k) {
      turn_.push_back(std::polar(1.0, -step * static_cast<double>(k)));
      window_.push_back(0.5 - 0.5 * std::cos(step * static_cast<double>(k)));
    }
  }

  /// The segment without its line, under the window.
  [[nodiscard]] std::vector<double> prepared(const std::vector<double>& y, std::size_t begin) const {
    const double slope = slope_of(y, begin);
    double mean = 0.0;
    std::vector<double> out(rows_);
    for (std::size_t k = 0; k < rows_; ++k) {
      out[k] = y[begin + k] - y[begin] - slope * static_cast<double>(k);
      mean += out[k];
    }
    mean /= static_cast<double>(rows_);
    for (std::size_t k = 0; k < rows_; ++k) out[k] = (out[k] - mean) * window_[k];
    return out;
  }

  [[nodiscard]] Complex at(const std::vector<double>& prepared, std::size_t bin) const {
    double re = 0.0;
    double im = 0.0;
    std::size_t place = 0;
    for (std::size_t k = 0; k < rows_; ++k) {
      re += prepared[k] * turn_[place].real();
      im += prepared[k] * turn_[place].imag();
      place += bin;
      if (place >= rows_) place -= rows_;
    }
    return {re, im};
  }

 private:
  /// Of a line on which a periodic signal lies: from one period to the next. Else by least squares.
  [[nodiscard]] double slope_of(const std::vector<double>& y, std::size_t begin) const {
    double sum = 0.0;
    const auto n = static_cast<double>(rows_);
    if (repeat_ > 0) {
      for (std::size_t k = 0; k < repeat_; ++k) sum += y[begin + repeat_ + k] - y[begin + k];
      return sum / (static_cast<double>(repeat_) * static_cast<double>(repeat_));
    }
    for (std::size_t k = 0; k < rows_; ++k)
      sum += (static_cast<double>(k) - 0.5 * (n - 1.0)) * (y[begin + k] - y[begin]);
    return sum / (n * (n * n - 1.0) / 12.0);
  }

  std::size_t rows_;
  std::size_t repeat_;
  std::vector<Complex> turn_;
  std::vector<double> window_;
};

std::vector<Source> sources_of(const std::vector<log::Record>& records, Response& out) {
  std::vector<Source> sources;
  if (records.empty()) throw Refused("frequency response: no rows (give a log with force and position)");
  out.sample_time = records.front().sample_time;
  out.closed_loop = !records.front().r.empty();
  for (const log::Record& record : records) {
    if (std::abs(record.sample_time - out.sample_time) > 1e-6 * out.sample_time) {
      throw Refused(fmt::format(
          "{}: rows every {} ms, those of the other logs every {} ms: one response has one period of the "
          "controller (give the logs one by one)",
          record.source, digits(record.sample_time * 1e3), digits(out.sample_time * 1e3)));
    }
    if (record.r.empty() == out.closed_loop)
      throw Refused(
          record.source +
          ": with other columns than the first log, one has a reference and one has none (give them one by one)");
    out.rows += record.x.size();
    if (!out.closed_loop && log::reconstruct(record).loop != log::Loop::kOpen) {
      throw Refused(
          record.source +
          ": no reference, and a controller made the force: force and position alone would show the controller, not the "
          "axis (log the reference position as well)");
    }
    sources.push_back({&record, out.closed_loop ? &record.r : &record.f});
  }
  return sources;
}

/// Longest segments of which there are enough; then as many as there are.
void choose_window(Plan& plan, const std::vector<std::pair<Source, Stretch>>& all, double sample_time) {
  const auto count = [&](std::size_t window) {
    std::size_t n = 0;
    for (const auto& [source, s] : all) n += s.rows() < window ? 0 : 2 * (s.rows() - window) / window + 1;
    return n;
  };
  auto window = static_cast<std::size_t>(kLongestSegment / sample_time);
  while (window > kShortestSegment && count(window) < kEnoughSegments) window = window * 4 / 5;
  plan.window = std::max(kShortestSegment, window + window % 2);
}

Plan plan_for(const std::vector<Source>& sources, const ResponseOptions& options, Response& out) {
  std::vector<std::pair<Source, Stretch>> all;
  std::size_t sliding = 0;
  for (const Source& source : sources) {
    for (const Stretch& s : sliding_stretches(*source.record)) {
      all.emplace_back(source, s);
      sliding += s.rows();
    }
  }
  out.rows_reversal = out.rows - sliding;
  Plan plan;
  constexpr double kFewestRows = 4.0;
  if (options.period && *options.period < kFewestRows * out.sample_time)
    throw Refused(fmt::format("--period: got {:.4g} ms, expected at least {:g} rows of this log, {:.4g} ms",
                              1e3 * *options.period, kFewestRows, 1e3 * kFewestRows * out.sample_time));
  const auto longest = std::max_element(
      all.begin(), all.end(), [](const auto& a, const auto& b) { return a.second.rows() < b.second.rows(); });
  if (longest == all.end()) return plan;
  if (options.period && *options.period > out.sample_time * static_cast<double>(longest->second.rows()))
    throw Refused(
        fmt::format("--period: got {:.4g} s, expected at most the longest motion of this log, {:.4g} s",
                    *options.period, out.sample_time * static_cast<double>(longest->second.rows())));
  plan.repeat = options.period ? static_cast<std::size_t>(std::lround(*options.period / out.sample_time))
                               : repeat_of(*longest->first.z, longest->second);
  if (plan.repeat > 0) {
    plan.window = 2 * plan.repeat;
    out.period = out.sample_time * static_cast<double>(plan.repeat);
  } else {
    const auto settle = static_cast<std::size_t>(kSettle / out.sample_time);
    for (auto& [source, s] : all) s.begin = std::min(s.begin + settle, s.end);
    choose_window(plan, all, out.sample_time);
  }
  for (const auto& [source, s] : all) {
    const Stretch part = plan.repeat > 0 ? settled_part(*source.z, s, plan.repeat) : s;
    Part p{source, {}};
    for (std::size_t k = part.begin; k + plan.window <= part.end; k += plan.window / 2)
      p.segments.push_back(k);
    if (p.segments.empty()) continue;
    out.rows_used += p.segments.back() + plan.window - p.segments.front();
    plan.parts.push_back(std::move(p));
  }
  out.rows_settling = sliding - out.rows_used;
  return plan;
}

/// Turns within a segment of each line.
std::vector<std::size_t> bins_of(const Plan& plan) {
  std::vector<std::size_t> bins;
  const double last = 0.5 * kOfHalfRate * static_cast<double>(plan.window);
  if (plan.repeat > 0) {
    for (std::size_t b = 2; static_cast<double>(b) <= last; b += 2) bins.push_back(b);
    return bins;
  }
  for (auto b = static_cast<double>(kFirstBin); std::round(b) <= last;) {
    bins.push_back(static_cast<std::size_t>(std::round(b)));
    b = std::max(b * kRatio, std::round(b) + 1.0);
  }
  return bins;
}

/// Sums of each line [line][unit].
using Table = std::vector<std::vector<Sums>>;

Table transform(const Plan& plan, const std::vector<std::size_t>& bins, bool stretch_is_unit) {
  const Transform turn(plan.window, plan.repeat);
  Table table(bins.size());
  for (const Part& part : plan.parts) {
    bool first = true;
    for (const std::size_t begin : part.segments) {
      const std::vector<double> z = turn.prepared(*part.source.z, begin);
      const std::vector<double> f = turn.prepared(part.source.record->f, begin);
      const std::vector<double> x = turn.prepared(part.source.record->x, begin);
      for (std::size_t i = 0; i < bins.size(); ++i) {
        if (first || !stretch_is_unit) table[i].emplace_back();
        table[i].back().add(Signals{turn.at(z, bins[i]), turn.at(f, bins[i]), turn.at(x, bins[i])});
      }
      first = false;
    }
  }
  return table;
}

/// The step to which all values are rounded; 0: none is seen. log::quantum() looks at part of the values, which at a fast stroke are
/// hundreds of steps apart.
double rounding_step(std::vector<double> values) {
  constexpr double kFarthest = 1e4;  // steps of a gap that is looked at
  constexpr double kOff = 0.05;      // of a step
  std::sort(values.begin(), values.end());
  const double rounding = 1e-11 * std::max(std::abs(values.front()), std::abs(values.back()));
  std::vector<double> gaps;
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (values[i] - values[i - 1] > rounding) gaps.push_back(values[i] - values[i - 1]);
  }
  if (gaps.size() < 20) return 0.0;
  std::sort(gaps.begin(), gaps.end());
  // A single edited value may cause the very smallest gap.
  for (const double share : {0.0, 0.002}) {
    const double q = gaps[static_cast<std::size_t>(share * static_cast<double>(gaps.size() - 1))];
    std::size_t looked = 0;
    std::size_t whole = 0;
    for (const double gap : gaps) {
      const double steps = gap / q;
      if (steps < 1.5) continue;
      if (steps > kFarthest) break;
      ++looked;
      whole += std::abs(steps - std::round(steps)) < kOff ? 1 : 0;
    }
    if (looked >= 20 && whole * 100 >= looked * 98) return q;
  }
  return 0.0;
}

/// Power that the rounding of a periodic z has in a harmonic, over all segments: q²/12 in each row. It repeats with z, so that no scatter
/// from period to period tells it from an excitation.
double rounding_power(const Plan& plan) {
  constexpr double kHann = 3.0 / 8.0;   // mean square of the window
  constexpr double kOnHarmonics = 2.0;  // of two lines of a segment of two periods one is a harmonic
  double power = 0.0;
  std::map<const std::vector<double>*, double> steps;  // a record has many parts
  for (const Part& part : plan.parts) {
    const auto [known, is_new] = steps.try_emplace(part.source.z, 0.0);
    if (is_new) known->second = rounding_step(*part.source.z);
    const double q = known->second;
    power += static_cast<double>(part.segments.size()) * q * q / 12.0;
  }
  return kOnHarmonics * kHann * static_cast<double>(plan.window) * power;
}

/// Leaves the harmonics that the excitation has; `rounding` is rounding_power().
void keep_excited(std::vector<std::size_t>& bins, Table& table, bool closed, double rounding) {
  constexpr double kAboveRounding = 20.0;
  std::vector<double> power;
  for (std::size_t i = 0; i < bins.size(); ++i) {
    double sum = 0.0;
    for (const Sums& s : table[i]) sum += s.zz;
    if (!(sum >= kAboveRounding * rounding)) sum = 0.0;
    // A reference counts by its acceleration, which falls less over frequency than its position.
    const auto b = static_cast<double>(bins[i]);
    power.push_back(closed ? sum * b * b * b * b : sum);
  }
  if (power.empty()) return;
  std::vector<double> sorted = power;
  std::sort(sorted.begin(), sorted.end());
  const double quiet = sorted[sorted.size() / 4];
  double least = kExcited * sorted.back();
  if (quiet < 1e-2 * sorted.back()) least = std::max(least, kAboveQuiet * quiet);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < bins.size(); ++i) {
    if (!(power[i] >= least) || power[i] <= 0.0) continue;
    bins[kept] = bins[i];
    table[kept++] = std::move(table[i]);
  }
  bins.resize(kept);
  table.resize(kept);
}

/// Relative variances of one ratio: own, then pooled with neighbours; half widths of 95 %.
std::vector<double> half_widths(const std::vector<double>& own, double freedom) {
  std::vector<double> out;
  constexpr std::ptrdiff_t kSide = 2;
  const auto n = static_cast<std::ptrdiff_t>(own.size());
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    double sum = 0.0;
    int others = 0;
    for (std::ptrdiff_t k = std::max<std::ptrdiff_t>(0, i - kSide); k <= std::min(n - 1, i + kSide); ++k) {
      if (k == i || !std::isfinite(own[k])) continue;
      sum += own[k];
      ++others;
    }
    const bool alone = others == 0 || own[i] > kOwn * sum / others;
    const double variance = alone ? own[i] : (sum + own[i]) / (others + 1);
    const double t = stats::student_factor(alone ? freedom : freedom * (others + 1));
    const double half = t * std::sqrt(0.5 * variance);
    out.push_back(std::isfinite(half) ? half : 1e9);
  }
  return out;
}

/// The coherence of two noises is beyond this in one line of a hundred. In a closed loop both signals are then the noise of the encoder
/// through the controller: their ratio scatters little, and is that of the controller, not of the plant.
double coherence_by_chance(std::size_t segments) {
  constexpr double kIndependent = 0.9;  // of the segments, which overlap
  const double parts = kIndependent * static_cast<double>(segments);
  return parts < 2.0 ? 1.0 : 1.0 - std::pow(0.01, 1.0 / (parts - 1.0));
}

void fill_lines(Response& out, const std::vector<std::size_t>& bins, const Table& table, const Plan& plan,
                bool overlapping) {
  std::vector<double> plant_variance;
  std::vector<double> closed_variance;
  for (std::size_t i = 0; i < bins.size(); ++i) {
    Sums all;
    for (const Sums& s : table[i]) all.add(s);
    Line line;
    line.omega =
        2.0 * kPi * static_cast<double>(bins[i]) / (static_cast<double>(plan.window) * out.sample_time);
    line.plant = all.xz / all.fz;
    line.plain = all.xf / all.ff;
    line.force_coherence = std::norm(all.fz) / (all.ff * all.zz);
    line.motion_coherence = std::norm(all.xz) / (all.xx * all.zz);
    if (out.closed_loop) line.closed = all.xz / all.zz;
    double plant = 0.0;
    double closed = 0.0;
    for (const Sums& s : table[i]) {
      plant += std::norm(s.xz - line.plant * s.fz);
      closed += std::norm(s.xz - line.closed * s.zz);
    }
    const auto m = static_cast<double>(table[i].size());
    const double more = (m / (m - 1.0)) * (overlapping ? 1.0 + 2.0 * kOverlap * (m - 1.0) / m : 1.0);
    plant_variance.push_back(more * plant / std::norm(all.xz));
    closed_variance.push_back(more * closed / std::norm(all.xz));
    out.lines.push_back(line);
  }
  const double freedom = 2.0 * (static_cast<double>(out.units) - 1.0) * (overlapping ? 0.9 : 1.0);
  const std::vector<double> plant = half_widths(plant_variance, freedom);
  const std::vector<double> closed = half_widths(closed_variance, freedom);
  const double chance = coherence_by_chance(out.segments);
  for (std::size_t i = 0; i < out.lines.size(); ++i) {
    const bool excited = std::min(out.lines[i].force_coherence, out.lines[i].motion_coherence) > chance;
    out.lines[i].half_width = excited ? plant[i] : std::max(plant[i], 1.0);
    out.lines[i].closed_half_width = closed[i];
  }
}

void measure_speed(Response& out, const Plan& plan) {
  // No longer than half of a segment, so that every segment has a speed.
  const auto lag = std::clamp<std::size_t>(static_cast<std::size_t>(std::ceil(0.02 / out.sample_time)), 2,
                                           std::max<std::size_t>(2, plan.window / 2));
  double way = 0.0;
  double time = 0.0;
  out.slowest = 1e300;
  for (const Part& p : plan.parts) {
    const std::vector<double>& x = p.source.record->x;
    const std::size_t end = p.segments.back() + plan.window - 1;
    way += std::abs(x[end] - x[p.segments.front()]);
    time += out.sample_time * static_cast<double>(end - p.segments.front());
    for (std::size_t k = p.segments.front(); k + lag <= end; ++k)
      out.slowest =
          std::min(out.slowest, std::abs(x[k + lag] - x[k]) / (out.sample_time * static_cast<double>(lag)));
  }
  out.speed = way / time;
}

constexpr const char* kCure =
    "record a multisine on strokes at constant speed: stribeck excite MACHINE.toml --method multisine";

void refuse_too_few_segments(const std::vector<log::Record>& records, const ResponseOptions& options,
                             const Response& out) {
  if (out.segments >= 3) return;
  if (options.period) {
    throw Refused(fmt::format(
        "{}: {} segments of two periods of {:.6g} s fit into its strokes, expected 3 or more (leave the period out: the program then finds it)",
        records.front().source, out.segments, *options.period));
  }
  throw Refused(fmt::format(
      "{}: the axis stands or reverses in {} of {} rows, and no stretch of motion in one direction is long enough ({} segments, expected "
      "3 or more): friction that changes its sign or holds the axis hides the plant ({})",
      records.front().source, out.rows_reversal, out.rows, out.segments, kCure));
}

void refuse_quiet(const std::vector<log::Record>& records, const Response& out) {
  const auto determined =
      std::count_if(out.lines.begin(), out.lines.end(), [](const Line& l) { return l.determined(); });
  if (determined >= 3) return;
  throw Refused(fmt::format(
      "{}: {} excites too few frequencies: {} of {} lines are determined, expected 3 or more ({})",
      records.front().source, out.closed_loop ? "the reference" : "the force", determined, out.lines.size(),
      kCure));
}

}  // namespace

double Response::highest() const noexcept {
  double most = 0.0;
  for (const Line& line : lines) {
    if (line.determined()) most = std::max(most, line.omega);
  }
  return most;
}

Response estimate(const std::vector<log::Record>& records, const ResponseOptions& options) {
  Response out;
  const std::vector<Source> sources = sources_of(records, out);
  const Plan plan = plan_for(sources, options, out);
  for (const Part& p : plan.parts) out.segments += p.segments.size();
  out.stretches = plan.parts.size();
  refuse_too_few_segments(records, options, out);
  const bool by_stretch = out.stretches >= kEnoughStretches;
  out.units = by_stretch ? out.stretches : out.segments;
  measure_speed(out, plan);
  std::vector<std::size_t> bins = bins_of(plan);
  Table table = transform(plan, bins, by_stretch);
  if (plan.repeat > 0) keep_excited(bins, table, out.closed_loop, rounding_power(plan));
  fill_lines(out, bins, table, plan, !by_stretch);
  refuse_quiet(records, out);
  return out;
}

}  // namespace stribeck::ident::frequency
