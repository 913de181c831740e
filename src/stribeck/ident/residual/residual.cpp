#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/digits.hpp>
#include <stribeck/ident/residual/residual_parts.hpp>
#include <utility>

namespace stribeck::ident::residual {
namespace {

constexpr double kSlowest = 0.04;          // of the top speed: below it friction has not settled
constexpr double kSnapLag = 5e-3;          // [s]
constexpr double kSettled = 6.0;           // break-away distances after a reversal
constexpr double kNearReversal = 0.005;    // of the travel, where the break-away distance is not known
constexpr std::size_t kMostRows = 20'000;  // for what is only looked at
constexpr double kLowRSquared = 0.9;
constexpr double kWorthALine = 0.1;  // of friction
constexpr double kHum = 0.006;       // of its frequency

struct Sums {
  double f = 0.0, ff = 0.0, ee = 0.0, raw = 0.0, friction = 0.0;
  std::size_t rows = 0;
};

/// Second derivative of the acceleration, over a lag of rows.
double snap_of(const log::Motion& m, std::size_t k, std::size_t lag) {
  if (k < lag || !m.valid(k - lag) || !m.valid(k + lag) || m.stretch[k - lag] != m.stretch[k + lag])
    return kNaN;
  const double time = static_cast<double>(lag) * m.sample_time;
  return (m.a[k + lag] - 2.0 * m.a[k] + m.a[k - lag]) / (time * time);
}

/// Mean of neighbouring rows: the noise of a long log averages out, which it would not in single rows.
struct MeanRow {
  static constexpr std::array kAveraged{&Row::t, &Row::x, &Row::v,         &Row::a,
                                        &Row::e, &Row::f, &Row::travelled, &Row::snap};
  Row sum;
  std::size_t block = 0;
  std::size_t count = 0;

  void add(const Row& row, std::size_t of_block) {
    if (count++ == 0) {
      sum = row, block = of_block;
      return;
    }
    for (double Row::*member : kAveraged) sum.*member += row.*member;
  }
  [[nodiscard]] Row taken() {
    const auto n = static_cast<double>(std::exchange(count, 0));
    for (double Row::*member : kAveraged) sum.*member /= n;
    return sum;
  }
};

class Collector {
 public:
  Collector(const std::vector<log::Record>& records, const Result& result) {
    mass_ = std::isfinite(result.mass) ? result.mass : 0.0;
    rows_.mass = mass_;
    rows_.force_unit = result.force_unit;
    rows_.position_unit = result.position_unit;
    rows_.rotary = !records.empty() && records.front().rotary;
    rows_.drifts = result.level_drifts;
    rows_.unbalanced = result.find("unbalance") != nullptr;
    for (const log::Record& r : records) add(r, result);
  }

  std::vector<Left> left;
  Sums sums;
  Rows take() {
    if (sums.rows > 0) rows_.friction = std::sqrt(sums.friction / static_cast<double>(sums.rows));
    return std::move(rows_);
  }

 private:
  void add(const log::Record& r, const Result& result) {
    Left one;
    one.record = &r;
    log::MotionOptions options;
    options.shift = shift_in_rows(result, r.sample_time);
    options.cut_off = result.cut_off;  // what the fit did not see is no error of it
    one.motion = log::reconstruct(r, options);
    const log::Motion& m = one.motion;
    // As it stands in the log: the mean over a hold would take off a part of a fast line.
    const auto later = static_cast<std::ptrdiff_t>(std::lround(options.shift));
    const std::size_t n = m.rows();
    one.raw.assign(n, 0.0);
    double top = 0.0;
    for (std::size_t k = 0; k < n; ++k) {
      if (m.valid(k)) top = std::max(top, std::abs(m.v[k]));
    }
    const double exclude = std::isfinite(result.break_away_distance) ? kSettled * result.break_away_distance
                                                                     : kNearReversal * m.stroke;
    const auto number = static_cast<int>(rows_.records.size());
    rows_.records.push_back(&r);
    const std::size_t step = std::max<std::size_t>(1, n / kMostRows);
    int last = 0;
    MeanRow mean;
    const auto lag = static_cast<std::size_t>(
        std::max({1L, std::lround(kSnapLag / r.sample_time), static_cast<long>(m.window)}));
    for (std::size_t k = 0; k < n; ++k) {
      const double v = m.v[k];
      if (std::abs(v) < kSlowest * top || !m.sliding(k, exclude)) continue;
      if (!r.skip.empty() && r.skip[k] != 0) continue;
      const auto p = result.friction.parts(v, m.x[k]);
      const double friction = p.level * (v > 0.0 ? 1.0 : -1.0) + p.viscous + p.additive;
      const double model = mass_ * m.a[k] + result.load + friction;
      const double e = m.f[k] - model;
      const auto at =
          std::clamp<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(k) + later, 0, std::ssize(r.f) - 1);
      one.raw[k] = r.f[static_cast<std::size_t>(at)] - model;
      one.counted.push_back(k);
      ++sums.rows;
      sums.f += m.f[k], sums.ff += m.f[k] * m.f[k], sums.ee += e * e;
      sums.raw += one.raw[k] * one.raw[k];
      sums.friction += friction * friction;
      last = m.stretch[k];
      if (sums.rows == 1) rows_.low = rows_.high = m.x[k];
      rows_.low = std::min(rows_.low, m.x[k]), rows_.high = std::max(rows_.high, m.x[k]);
      const Row row{
          number, k / step, first_stretch_ + m.stretch[k], r.t[k], m.x[k],        v,
          m.a[k], e,        v > 0.0 ? 1.0 : -1.0,          m.f[k], m.distance[k], snap_of(m, k, lag)};
      if (mean.count > 0 &&
          (k / step != mean.block || row.stretch != mean.sum.stretch || row.sign != mean.sum.sign))
        rows_.rows.push_back(mean.taken());
      mean.add(row, k / step);
    }
    if (mean.count > 0) rows_.rows.push_back(mean.taken());
    first_stretch_ += last + 1;
    left.push_back(std::move(one));
  }

  double mass_ = 0.0;
  Rows rows_;
  int first_stretch_ = 0;
};

/// The residual behind the low-pass of the noise, where the one of the result is higher (it shows a fast periodic force). There the noise of
/// the acceleration looks like too large a mass, and the spring that makes up for it like a cause.
std::optional<Collector> behind_noise(const std::vector<log::Record>& records, const Result& result,
                                      double cut_off) {
  if (!(result.cut_off > 0.0)) return {};
  Result smoothed = result;
  smoothed.cut_off = 0.0;
  std::optional<Collector> out;
  out.emplace(records, smoothed);
  if (out->left.empty() || !(log::cut_off_of(out->left.front().motion) < cut_off)) out.reset();
  return out;
}

const char* hum_of(double frequency) {
  for (const double f : {50.0, 100.0, 150.0}) {
    if (std::abs(frequency - f) < kHum * f) return "hum of 50 Hz mains";
  }
  for (const double f : {60.0, 120.0, 180.0}) {
    if (std::abs(frequency - f) < kHum * f) return "hum of 60 Hz mains";
  }
  return nullptr;
}

/// What a line of this kind is, and what helps.
std::string line_in_words(const Line& line, const std::string& unit) {
  const char* hum = hum_of(line.frequency);
  const bool moves = line.moves > 0.5 * line.amplitude;
  const std::string what =
      hum != nullptr && line.narrow && !moves
          ? std::string(hum) + " (shield the signal, or filter it with --cut-off below)"
      : !line.narrow
          ? "a mode of the drive (an axial or torsional one) that rings: mass and friction hold below it"
      : moves
          ? "the axis vibrates with it: the control loop, the machine or something outside excites it"
          : "a vibration that the rigid model does not have: a mode of the drive, or a force from outside";
  return fmt::format("the force has a line of {:.3g} {} at {:.4g} Hz that the model does not explain: {}",
                     line.amplitude, unit, line.frequency, what);
}

void judge(const Quality& q, const std::string& unit, std::vector<std::string>& warnings) {
  if (q.rms > q.friction_rms) {
    warnings.push_back(fmt::format(
        "the model leaves {:.3g} {} RMS of the force, more than friction itself ({:.3g} {}): friction cannot be identified from this log; look at the residual, and for columns that do not belong together",
        q.rms, unit, q.friction_rms, unit));
  } else if (q.r_squared < kLowRSquared) {
    warnings.push_back(fmt::format(
        "the model explains only {:.3g} % of the force (R² {:.3f}), and leaves {:.3g} {} RMS beside {:.3g} {} of friction: another force acts that the model does not contain",
        100.0 * std::max(0.0, q.r_squared), q.r_squared, q.rms, unit, q.friction_rms, unit));
  }
  if (q.strongest && q.strongest->amplitude > kWorthALine * q.friction_rms)
    warnings.push_back(line_in_words(*q.strongest, unit));
}

}  // namespace

std::string in_words(const Quality& q, const std::string& unit) {
  if (q.rows == 0) return {};
  std::string out = fmt::format("The model explains {:.4g} % of the force (R² {:.4f}). It leaves {} {} RMS",
                                100.0 * std::max(0.0, q.r_squared), q.r_squared, digits(q.rms), unit);
  if (q.friction_rms > 0.0)
    out += fmt::format(", {} % of friction ({} {} RMS)", digits(100.0 * q.rms / q.friction_rms),
                       digits(q.friction_rms), unit);
  if (std::isfinite(q.cut_off))
    out += fmt::format(", behind a low-pass of {} Hz; without it {} {}", digits(q.cut_off), digits(q.raw_rms),
                       unit);
  out += ".";
  if (q.strongest)
    out += fmt::format(" Strongest line: {} {} at {:.4g} Hz.", digits(q.strongest->amplitude), unit,
                       q.strongest->frequency);
  return out;
}

double shift_in_rows(const Result& result, double period) {
  if (result.given_shift) return *result.given_shift / period;
  const Parameter* shift = result.find("force_shift");
  return shift != nullptr ? shift->value / period : -0.5;
}

Diagnosis diagnose(const std::vector<log::Record>& records, const Result& result, bool one_sided) {
  Diagnosis out;
  Collector collected(records, result);
  const Sums& s = collected.sums;
  if (s.rows < 100) return out;
  Quality& q = out.quality;
  const auto n = static_cast<double>(s.rows);
  q.rows = s.rows;
  q.rms = std::sqrt(s.ee / n);
  q.raw_rms = std::sqrt(s.raw / n);
  q.friction_rms = std::sqrt(s.friction / n);
  const double spread = s.ff - s.f * s.f / n;
  if (spread > 0.0) q.r_squared = 1.0 - s.ee / spread;
  q.cut_off = log::cut_off_of(collected.left.front().motion);
  find_lines(collected.left, std::isfinite(result.mass) ? result.mass : 0.0, q);
  judge(q, Shown(result.position_unit, result.force_unit, records.front().rotary).force_unit(), out.warnings);
  std::optional<Collector> smoother = behind_noise(records, result, q.cut_off);
  Collector& by = smoother ? *smoother : collected;
  const Rows rows = by.take();
  if (rows.high > rows.low && rows.friction > 0.0) {
    if (one_sided) find_one_sided(rows, out);
    if (out.one_sided) return out;  // it would look like any of the causes below
    find_causes(by.left, rows, out);
    find_changes(rows, out);
  }
  return out;
}

std::array<double, 2> both_leave(const LogsAndModel& a, const LogsAndModel& b) {
  constexpr double kAlike = 1.05;
  std::array<double, 2> rms{}, cut_off{};
  const std::array both{&a, &b};
  const auto collect = [&](std::size_t i, const Result& result) {
    const Collector c(both[i]->records, result);
    rms[i] = c.sums.rows > 0 ? std::sqrt(c.sums.ee / static_cast<double>(c.sums.rows)) : kNaN;
    cut_off[i] = c.left.empty() ? kNaN : log::cut_off_of(c.left.front().motion);
    if (std::isnan(cut_off[i])) cut_off[i] = std::numeric_limits<double>::infinity();  // no low-pass
  };
  for (const std::size_t i : {0U, 1U}) collect(i, both[i]->result);
  const std::size_t higher = cut_off[0] > cut_off[1] ? 0 : 1, lower = 1 - higher;
  if (!(cut_off[higher] > kAlike * cut_off[lower])) return rms;
  Result smoothed = both[higher]->result;
  smoothed.cut_off = cut_off[lower];
  collect(higher, smoothed);
  return rms;
}

}  // namespace stribeck::ident::residual
