#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stribeck/ident/bristle/bristle_path.hpp>
#include <stribeck/ident/log/filter.hpp>
#include <stribeck/ident/stats/order.hpp>

namespace stribeck::ident::bristle {
namespace {

/// In break-away distances. After this distance e^-12 of a reversal is left in LuGre.
constexpr double kForgotten = 12.0;
constexpr double kNear = 8.0;
constexpr double kTurning = 5.0;
constexpr double kStep = 0.1;
constexpr double kSwing = 0.3;  ///< [rad] in a sub-step
constexpr std::size_t kMostSteps = 8;
/// Noise of D²x allowed after the window, as a share of the swing of friction.
constexpr double kNoiseShare = 0.01;
constexpr int kWidestBox = 20;
constexpr double kLoading = 0.3;
/// Relative change of the level within a break-away distance that a bristle follows without lag.
constexpr double kSteady = 1e-3;
constexpr double kSlowest = 1e-9;  ///< at rest, but with a direction [m/s]
/// The middle of a long rest adds no information. Where such rests are more than half of a record, their middles are left out.
constexpr std::size_t kLongRest = 2000;  ///< [rows]
constexpr std::size_t kRestKept = 200;   ///< at either end [rows]
constexpr double kRests = 0.02;          ///< of the break-away distance
constexpr double kRestSteps = 2.0;       ///< of the encoder

std::vector<double> smooth(const std::vector<double>& x, const std::vector<double>& weights) {
  const std::size_t half = weights.size() / 2;
  std::vector<double> y(x);
  for (std::size_t k = half; half > 0 && k + half < x.size(); ++k) {
    double sum = weights[half] * x[k];
    for (std::size_t i = 1; i <= half; ++i) sum += weights[half + i] * (x[k - i] + x[k + i]);
    y[k] = sum;
  }
  return y;
}

/// Second derivatives times T²/6 of the natural cubic spline through x.
std::vector<double> spline(const std::vector<double>& x) {
  const std::size_t n = x.size();
  std::vector<double> m(n, 0.0);
  std::vector<double> diagonal(n, 4.0);
  for (std::size_t k = 1; k + 1 < n; ++k) {
    m[k] = (x[k + 1] - x[k]) - (x[k] - x[k - 1]);
    if (k > 1) {
      diagonal[k] -= 1.0 / diagonal[k - 1];
      m[k] -= m[k - 1] / diagonal[k - 1];
    }
  }
  for (std::size_t k = n - 1; k-- > 1;) m[k] = (m[k] - m[k + 1]) / diagonal[k];
  return m;
}

/// Position relative to the tick before, at a share s of a sample after that tick.
double along(const std::vector<double>& x, const std::vector<double>& m, std::size_t k, double s) {
  const double r = 1.0 - s;
  return s * (x[k + 1] - x[k]) + (r * r * r - r) * m[k] + (s * s * s - s) * m[k + 1];
}

struct Span {
  std::size_t begin;
  std::size_t end;  ///< last tick
};

/// One record and the places of its reversals.
struct Course {
  const log::Record& record;
  const log::Motion& motion;
  const CutOptions& options;
  std::size_t half = 0;       ///< reach of window and whitening to either side [rows]
  std::vector<double> x;      ///< position without its fastest noise [m]
  std::vector<double> bends;  ///< of x, see spline()
  std::vector<double> ahead;  ///< travel to the end of the stretch that a row lies in [m]
  std::vector<char> resting;  ///< the middle of a long rest, which is left out; empty: nothing is

  [[nodiscard]] std::size_t rows() const { return record.x.size(); }
  [[nodiscard]] bool last_stretch(std::size_t k) const {
    return motion.stretch[k] + 1 == static_cast<int>(motion.reversals.size());
  }
  /// Whether a row is so far from reversals on both sides that no bristle is affected by one.
  [[nodiscard]] bool free_of_turns(std::size_t k) const {
    const double far = kForgotten * options.break_away;
    return motion.distance[k] >= far && (last_stretch(k) || ahead[k] >= far);
  }
  [[nodiscard]] bool after_turn(std::size_t k, double distance) const {
    return k >= motion.reversals.front() && motion.distance[k] <= distance * options.break_away;
  }
  [[nodiscard]] bool rests(std::size_t k) const { return !resting.empty() && resting[k] != 0; }
  /// Whether the next row belongs to the end of a long rest: a piece may begin here.
  [[nodiscard]] bool leaves_rest(std::size_t k) const { return rests(k) && k + 1 < rows() && !rests(k + 1); }
  [[nodiscard]] double travel(std::size_t k) const {
    return std::abs(x[k + 1] - x[k]) + std::abs(along(x, bends, k, 0.5) - 0.5 * (x[k + 1] - x[k]));
  }
};

/// Window that removes most of the noise of the acceleration; in rows to either side.
int window_of(const log::Record& first, const BristleData& data, double mass) {
  const double T = first.sample_time;
  const double allowed = kNoiseShare * (data.level[0] + data.level[1]);
  for (int window = 0; window < kWidestBox; ++window) {
    const double left = std::sqrt(log::second_difference_variance(log::box_weights(window)));
    if (mass * data.noise * left / (T * T) <= allowed) return window;
  }
  return kWidestBox;
}

/// Smooths twice, so that curved motion keeps its height.
std::vector<double> without_noise(const std::vector<double>& x, const std::vector<double>& calm) {
  if (calm.size() <= 1) return x;
  const std::vector<double> once = smooth(x, calm);
  const std::vector<double> twice = smooth(once, calm);
  std::vector<double> out(x.size());
  for (std::size_t k = 0; k < x.size(); ++k) out[k] = 2.0 * once[k] - twice[k];
  return out;
}

std::vector<double> travel_ahead(const log::Record& record, const log::Motion& motion) {
  const std::size_t n = record.x.size();
  std::vector<double> ahead(n, 0.0);
  for (std::size_t k = n - 1; k-- > 0;) {
    ahead[k] = motion.stretch[k] == motion.stretch[k + 1]
                   ? ahead[k + 1] + motion.direction[k] * (record.x[k + 1] - record.x[k])
                   : 0.0;
  }
  return ahead;
}

/// The middles of long rests; empty where they are less than half of the record.
std::vector<char> resting_rows(const log::Record& record, const log::Motion& motion, double break_away) {
  const double play = std::max(kRests * break_away, kRestSteps * std::sqrt(12.0) * motion.position_noise);
  const std::size_t n = record.x.size();
  std::vector<char> resting(n, 0);
  std::size_t count = 0;
  for (std::size_t from = 0, to = 0; from < n; from = to) {
    double low = record.x[from], high = low;
    for (to = from + 1; to < n; ++to) {
      low = std::min(low, record.x[to]), high = std::max(high, record.x[to]);
      if (high - low > play) break;
    }
    if (to - from < kLongRest) continue;
    std::fill(resting.begin() + static_cast<std::ptrdiff_t>(from + kRestKept),
              resting.begin() + static_cast<std::ptrdiff_t>(to - kRestKept), char{1});
    count += to - from - 2 * kRestKept;
  }
  if (2 * count < n) resting.clear();
  return resting;
}

/// Rows near a reversal, or all rows.
std::vector<char> wanted_rows(const Course& c) {
  std::vector<char> wanted(c.rows(), 0);
  for (std::size_t k = c.half + 1; k + c.half + 1 < c.rows(); ++k) {
    const bool before = !c.last_stretch(k) && c.ahead[k] <= kNear * c.options.break_away;
    // The window of a row after a rest lies after it too, because a piece begins there.
    const bool rests = c.rests(k) || c.rests(k - c.half - 1);
    wanted[k] = !rests && (c.options.whole || c.after_turn(k, kNear) || before) ? 1 : 0;
  }
  return wanted;
}

/// The wanted rows with the rows before them from which the state of the bristles is known; spans that touch are joined.
std::vector<Span> spans_of(const Course& c, const std::vector<char>& wanted) {
  const std::size_t n = c.rows();
  std::vector<Span> spans;
  std::size_t begin = 0;  // the last row free of turns before the window of row k
  std::size_t looked = 0;
  for (std::size_t k = 0; k < n; ++k) {
    if (wanted[k] == 0) continue;
    for (; looked <= k - c.half - 1; ++looked) {
      if (looked == 0 || c.free_of_turns(looked) || c.leaves_rest(looked)) begin = looked;
    }
    const std::size_t end = k + c.half + 1;
    if (!spans.empty() && begin <= spans.back().end) {
      spans.back().begin = std::min(spans.back().begin, begin);
      spans.back().end = end;
    } else {
      spans.push_back({begin, end});
    }
  }
  for (std::size_t i = spans.size(); i-- > 1;) {
    if (spans[i].begin > spans[i - 1].end) continue;
    spans[i - 1].begin = std::min(spans[i - 1].begin, spans[i].begin);
    spans[i - 1].end = spans[i].end;
    spans.erase(spans.begin() + static_cast<std::ptrdiff_t>(i));
  }
  return spans;
}

/// Whether row k is so far from reversals, and its level so constant, that bristles follow without lag.
bool settled_at(const Course& c, const friction::AxisModel& known, std::size_t k) {
  if (!c.free_of_turns(k) || !c.free_of_turns(k + 1)) return false;
  if (!c.options.whole || k + 2 >= c.rows()) return true;
  const auto mean_level = [&](std::size_t i) {
    const int direction = c.motion.direction[i];
    const double speed = std::max(direction * (c.x[i + 1] - c.x[i]) / c.record.sample_time, kSlowest);
    return known.friction.parts(direction * speed, c.x[i]).level;
  };
  const double here = mean_level(k);
  return std::abs(mean_level(k + 1) - here) * c.options.break_away <=
         kSteady * here * std::abs(c.x[k + 1] - c.x[k]);
}

/// Sub-steps from row `begin` + i to the next; `direction` is that of the last one.
void add_sample(const Course& c, const friction::AxisModel& known, std::size_t i, double& direction,
                PathPiece& piece, std::vector<PathStep>& steps) {
  const std::size_t k = piece.begin + i;
  const double T = c.record.sample_time;
  PathSample sample;
  sample.first = steps.size();
  sample.settled = settled_at(c, known, k);
  const auto fine = static_cast<std::size_t>(std::ceil(c.travel(k) / (kStep * c.options.break_away)));
  const auto swings = static_cast<std::size_t>(std::ceil(c.options.swing / kSwing));
  sample.count = sample.settled ? 1 : std::clamp<std::size_t>(std::max(fine, swings), 1, kMostSteps);
  double before = 0.0;
  for (std::size_t s = 0; s < sample.count; ++s) {
    const double from = static_cast<double>(s) / static_cast<double>(sample.count);
    const double to = static_cast<double>(s + 1) / static_cast<double>(sample.count);
    PathStep step;
    const double after = along(c.x, c.bends, k, to);
    step.dt = T * (to - from);
    step.v = (after - before) / step.dt;
    if (sample.settled) {
      direction = c.motion.direction[k];
    } else if (step.v != 0.0) {
      direction = step.v > 0.0 ? 1.0 : -1.0;
    }
    step.direction = direction;
    step.late = 0.5 * (to * to - from * from);
    step.early = (to - from) - step.late;
    step.x = c.x[k] + 0.5 * (before + after);
    lay_step(known, step.x, step.v, i, piece, step);
    steps.push_back(step);
    before = after;
  }
  piece.samples.push_back(sample);
}

/// Acceleration and force of the ticks in a piece, and the ticks that are compared.
void add_rows(const Course& c, const std::vector<double>& force, const std::vector<char>& wanted,
              PathPiece& piece, BristlePath& path) {
  const double T = c.record.sample_time;
  const std::size_t ticks = piece.force.size();
  for (std::size_t i = 1; i + 1 < ticks; ++i) {
    const std::size_t k = piece.begin + i;
    piece.acceleration[i] =
        ((c.record.x[k + 1] - c.record.x[k]) - (c.record.x[k] - c.record.x[k - 1])) / (T * T);
    piece.force[i] = force[k];
    if (wanted[k] == 0 || (!c.record.skip.empty() && c.record.skip[k] != 0) || i < c.half + 1 ||
        i + c.half + 1 >= ticks)
      continue;
    piece.rows.push_back(i);
    path.rows.push_back({piece.record, k, path.stretches + c.motion.stretch[k], c.after_turn(k, kTurning)});
  }
}

/// Positions at the ticks, and the force that the drive holds between them.
void add_hold(const Course& c, PathPiece& piece) {
  const double rows = -c.options.shift - 0.5;
  const double whole = std::floor(rows);
  piece.late = rows - whole;
  const auto last = static_cast<std::ptrdiff_t>(c.rows()) - 1;
  // One force more, the one before the first tick.
  for (std::size_t i = 0; i <= piece.force.size(); ++i) {
    const auto from = static_cast<std::ptrdiff_t>(piece.begin + i) - 1 - static_cast<std::ptrdiff_t>(whole);
    piece.held.push_back(c.record.f[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(from, 0, last))]);
    if (i < piece.force.size()) piece.at.push_back(c.x[piece.begin + i]);
  }
}

PathPiece empty_piece(std::size_t record, const Span& span, bool unknown_start) {
  PathPiece piece;
  piece.record = static_cast<int>(record);
  piece.begin = span.begin;
  piece.unknown_start = unknown_start;
  const std::size_t ticks = span.end - span.begin + 1;
  piece.acceleration.assign(ticks, 0.0);
  piece.force.assign(ticks, 0.0);
  piece.given.assign(ticks, 0.0);
  piece.speed.assign(ticks, 0.0);
  return piece;
}

}  // namespace

void lay_step(const friction::AxisModel& known, double x, double v, std::size_t i, PathPiece& piece,
              PathStep& step) {
  step.x = x;
  step.v = v;
  const double to = step.direction;
  const auto p = known.friction.parts(to * std::max(to * v, kSlowest), x);
  step.level = p.level;
  piece.given[i] += step.early * (p.viscous + p.additive);
  piece.given[i + 1] += step.late * (p.viscous + p.additive);
  piece.speed[i] += step.early * v;
  piece.speed[i + 1] += step.late * v;
}

void filter_like(const BristlePath& path, bool white, std::size_t n, const double* column, double* out,
                 std::vector<double>& work) {
  const auto j = static_cast<std::size_t>(path.window);
  work.assign(column, column + n);
  for (int pass = 0; j > 0 && pass < 3; ++pass) {
    const double scale = 1.0 / static_cast<double>(2 * j + 1);
    double sum = 0.0;
    // Row k of the last pass is stored j rows later, so that nothing has to be moved.
    for (std::size_t k = 0; k < n; ++k) {
      sum += work[k];
      if (k > 2 * j) sum -= out[k - 2 * j - 1];
      out[k] = work[k];
      work[k] = sum * scale;
    }
  }
  for (std::size_t k = 0; k + 3 * j < n; ++k) out[k] = work[k + 3 * j];
  if (!white || path.whitening.empty()) return;
  std::copy(out, out + n, work.begin());
  const std::size_t p = path.whitening.size();
  for (std::size_t k = p; k < n; ++k) {
    for (std::size_t l = 1; l <= p; ++l) out[k] += path.whitening[l - 1] * work[k - l];
  }
}

std::vector<double> whitening_of(const BristlePath& path, const double* e) {
  std::array<double, kMostWhitening + 1> gamma{};
  std::array<double, kMostWhitening + 1> pairs{};
  for (std::size_t k = 0; k < path.rows.size(); ++k) {
    for (std::size_t l = 0; l <= std::min(k, kMostWhitening); ++l) {
      const PathRow& a = path.rows[k];
      const PathRow& b = path.rows[k - l];
      if (a.record != b.record || a.at - b.at != l) break;
      gamma[l] += e[k] * e[k - l];
      pairs[l] += 1.0;
    }
  }
  std::vector<double> c;
  if (!(gamma[0] > 0.0)) return c;
  for (std::size_t l = 0; l <= kMostWhitening; ++l) gamma[l] /= std::max(pairs[l], 1.0);
  // Levinson's recursion; the small load on the diagonal prevents that what the window removed is amplified again.
  double error = gamma[0] * (1.0 + kLoading);
  for (std::size_t p = 1; p <= kMostWhitening; ++p) {
    double sum = gamma[p];
    for (std::size_t l = 1; l < p; ++l) sum += c[l - 1] * gamma[p - l];
    const double k = -sum / error;
    if (!(std::abs(k) < 1.0)) break;
    std::vector<double> next(c);
    next.push_back(k);
    for (std::size_t l = 1; l < p; ++l) next[l - 1] += k * c[p - l - 1];
    c = std::move(next);
    error *= 1.0 - k * k;
  }
  return c;
}

BristlePath cut_path(const std::vector<log::Record>& records, const BristleData& data,
                     const friction::AxisModel& known, const CutOptions& options) {
  BristlePath path;
  path.window = window_of(records.front(), data, known.mass);
  const std::size_t half = 3 * static_cast<std::size_t>(path.window) + kMostWhitening;
  const std::vector<double> calm = log::box_weights(path.window / 2);
  for (std::size_t r = 0; r < records.size(); ++r) {
    const log::Record& record = records[r];
    const log::Motion& motion = data.motion[r];
    if (record.x.size() < 2 * half + 4 || motion.reversals.empty()) continue;
    Course c{record,
             motion,
             options,
             half,
             without_noise(record.x, calm),
             {},
             travel_ahead(record, motion),
             resting_rows(record, motion, options.break_away)};
    c.bends = spline(c.x);
    const std::vector<double> force = log::align_force(record.f, options.shift);
    const std::vector<char> wanted = wanted_rows(c);
    for (const Span& span : spans_of(c, wanted)) {
      PathPiece piece = empty_piece(r, span, !c.free_of_turns(span.begin));
      add_hold(c, piece);
      if (piece.unknown_start) ++path.starts;
      double direction = motion.direction[span.begin];
      for (std::size_t i = 0; i + 1 < piece.force.size(); ++i)
        add_sample(c, known, i, direction, piece, path.steps);
      add_rows(c, force, wanted, piece, path);
      path.pieces.push_back(std::move(piece));
    }
    path.stretches += static_cast<int>(motion.reversals.size());
  }
  return path;
}

double guess_break_away(const std::vector<log::Record>& records, const BristleData& data,
                        const friction::AxisModel& known) {
  std::vector<double> crossings;
  double stiffness = 0.0;
  double weight = 0.0;
  double most = 0.0;
  for (std::size_t r = 0; r < records.size(); ++r) {
    const log::Motion& m = data.motion[r];
    const std::vector<double> x = log::smooth_like(m, records[r].x);
    // Friction as a share of its level, from the smoothed motion.
    std::vector<double> share(m.rows(), 0.0);
    for (std::size_t k = 0; k < m.rows(); ++k) {
      if (!m.valid(k)) continue;
      const auto p = known.friction.parts(m.v[k] != 0.0 ? m.v[k] : m.direction[k] * kSlowest, x[k]);
      share[k] = (m.f[k] - known.mass * m.a[k] - known.load - p.viscous - p.additive) / p.level;
      if (k > 0 && m.valid(k - 1)) {
        const double dx = x[k] - x[k - 1];
        stiffness += dx * (share[k] - share[k - 1]);
        weight += dx * dx;
        most = std::max(most, std::abs(share[k]));
      }
    }
    for (const std::size_t turn : m.reversals) {
      const double to = m.direction[turn];
      bool loaded = false;
      const std::size_t last = std::min(m.rows(), turn + 2000);
      for (std::size_t k = turn > 5 ? turn - 5 : 0; k < last; ++k) {
        if (k > turn && m.stretch[k] != m.stretch[turn]) break;
        loaded = loaded || to * share[k] < -0.5;
        if (!loaded || k == 0 || to * share[k] < 0.0) continue;
        const double from = to * share[k - 1];
        const double part = from < 0.0 ? from / (from - to * share[k]) : 1.0;
        const double low = k - 1 >= turn ? m.distance[k - 1] : 0.0;
        // LuGre starts from F = g·(1 − 2·exp(−x/δ)).
        crossings.push_back((low + part * (m.distance[k] - low)) / std::log(2.0));
        break;
      }
    }
  }
  if (!crossings.empty()) {
    const double middle = stats::median(std::move(crossings));
    if (middle > 0.0) return middle;
  }
  if (most > 0.0 && stiffness > 0.0) return weight / stiffness;
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace stribeck::ident::bristle
