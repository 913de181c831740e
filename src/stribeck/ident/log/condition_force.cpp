#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <stribeck/ident/log/condition_parts.hpp>
#include <stribeck/ident/log/motion.hpp>
#include <stribeck/ident/refused.hpp>

namespace stribeck::ident::log::parts {
namespace {

constexpr int kColumns = 5;  // a, v, sgn v, x, 1
constexpr std::size_t kRowsOfRoughFit = 20000;
constexpr std::size_t kFewestRows = 100;

/// A stretch of one table with its motion.
struct Block {
  const Table* table = nullptr;
  std::size_t first = 0;
  Motion motion;
  std::vector<double> x;      ///< from the middle of the travel
  std::vector<double> force;  ///< as logged
  std::vector<double> f;      ///< through the window of the motion
};

void smooth_force(Block& b, const std::vector<double>& force) {
  const std::vector<double> calm = smooth_like(b.motion, force);
  b.f.assign(calm.size(), 0.0);
  for (std::size_t k = 1; k < calm.size(); ++k) b.f[k] = 0.5 * (calm[k - 1] + calm[k]);
}

Block block_of(const Table& m, std::size_t first, std::size_t last, double middle) {
  Block b;
  b.table = &m;
  b.first = first;
  const Table part = slice(m, first, last);
  Record record;
  record.source = m.source;
  record.sample_time = m.sample_time;
  record.t = part.t;
  record.x = part.x;
  record.f = part.f;
  record.loop = Loop::kClosed;  // leaves the force alone; instruments are not used here
  b.motion = reconstruct(record);
  b.force = part.f;
  b.x = part.x;
  for (double& x : b.x) x -= middle;
  smooth_force(b, b.force);
  return b;
}

/// Up to `most` rows of all tables, spread evenly.
std::vector<Block> blocks_of(const std::vector<Table>& tables, std::size_t most) {
  std::size_t rows = 0;
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const Table& m : tables) {
    rows += m.rows();
    for (const double x : m.x) {
      low = std::min(low, x);
      high = std::max(high, x);
    }
  }
  const double share =
      std::min(1.0, static_cast<double>(most) / static_cast<double>(std::max<std::size_t>(rows, 1)));
  std::vector<Block> blocks;
  for (const Table& m : tables) {
    if (m.rows() < kFewestRows) continue;
    constexpr std::size_t kParts = 5;
    const auto wanted = static_cast<std::size_t>(share * static_cast<double>(m.rows()));
    if (share >= 1.0 || wanted < kParts * kFewestRows) {
      if (share < 1.0 && wanted < kFewestRows && tables.size() > 50 && (&m - tables.data()) % 5 != 0)
        continue;
      blocks.push_back(block_of(m, 0, m.rows(), 0.5 * (low + high)));
      continue;
    }
    const std::size_t length = wanted / kParts;
    for (std::size_t i = 0; i < kParts; ++i) {
      const std::size_t first = i * (m.rows() - length) / (kParts - 1);
      blocks.push_back(block_of(m, first, first + length, 0.5 * (low + high)));
    }
  }
  return blocks;
}

using Vector = Eigen::Matrix<double, kColumns, 1>;

/// Sums of one pairing of motion and force.
struct Sums {
  Eigen::Matrix<double, kColumns, kColumns> a = Eigen::Matrix<double, kColumns, kColumns>::Zero();
  Vector b = Vector::Zero();
  double ff = 0.0;
  double f = 0.0;
  std::size_t n = 0;
  std::size_t forward = 0;

  /// Residual sum of squares of the columns that are used; coefficients of the others are 0.
  double solve(const std::array<bool, kColumns>& use, Vector& c) const {
    Vector scale;
    for (int i = 0; i < kColumns; ++i)
      scale[i] = a(i, i) > 0.0 && use[static_cast<std::size_t>(i)] ? 1.0 / std::sqrt(a(i, i)) : 0.0;
    const Eigen::Matrix<double, kColumns, kColumns> normal = scale.asDiagonal() * a * scale.asDiagonal();
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, kColumns, kColumns>> eigen(normal);
    const Vector rhs = scale.asDiagonal() * b;
    Vector solution = Vector::Zero();
    for (int i = 0; i < kColumns; ++i) {
      // Columns that say the same (one direction only, a sine) share what they explain.
      if (eigen.eigenvalues()[i] < 1e-7) continue;
      solution +=
          eigen.eigenvectors().col(i) * (eigen.eigenvectors().col(i).dot(rhs) / eigen.eigenvalues()[i]);
    }
    c = scale.asDiagonal() * solution;
    return std::max(0.0, ff - 2.0 * c.dot(b) + c.dot(a * c));
  }
};

Vector regressors(const Block& b, std::size_t k) {
  const double v = b.motion.v[k];
  Vector row;
  row << b.motion.a[k], v, v > 0.0 ? 1.0 : v < 0.0 ? -1.0 : 0.0, b.x[k], 1.0;
  return row;
}

Sums sums_of(const std::vector<Block>& blocks, int delay, double slowest) {
  Sums s;
  for (const Block& b : blocks) {
    const auto n = static_cast<std::ptrdiff_t>(b.motion.rows());
    for (std::ptrdiff_t k = 0; k < n; ++k) {
      const std::ptrdiff_t j = k + delay;
      const auto row = static_cast<std::size_t>(k);
      if (j < 0 || j >= n || !b.motion.valid(row) || !b.motion.valid(static_cast<std::size_t>(j))) continue;
      if (std::abs(b.motion.v[row]) < slowest) continue;
      const Vector x = regressors(b, row);
      const double f = b.f[static_cast<std::size_t>(j)];
      s.a.noalias() += x * x.transpose();
      s.b += x * f;
      s.ff += f * f;
      s.f += f;
      ++s.n;
      if (b.motion.v[row] > 0.0) ++s.forward;
    }
  }
  return s;
}

double slowest_moving(const std::vector<Block>& blocks) {
  std::vector<double> speeds;
  for (const Block& b : blocks) {
    for (std::size_t k = 0; k < b.motion.rows(); ++k) {
      if (b.motion.valid(k)) speeds.push_back(std::abs(b.motion.v[k]));
    }
  }
  return speeds.empty() ? 0.0 : 0.03 * quantile(std::move(speeds), 0.99);
}

constexpr std::array<bool, kColumns> kAll{true, true, true, true, true};

struct Fit {
  Vector c = Vector::Zero();
  Sums sums;
  double rss = std::numeric_limits<double>::infinity();
  int delay = 0;
};

Fit best_fit(const std::vector<Block>& blocks, double slowest, int most = 100) {
  const double T = blocks.front().motion.sample_time;
  const int late = std::clamp(static_cast<int>(std::ceil(0.05 / T)), 1, 8);
  const int early = std::clamp(static_cast<int>(std::ceil(0.02 / T)), 1, 3);
  Fit best;
  for (int d = -std::min(early, most); d <= std::min(late, most); ++d) {
    Fit one;
    one.sums = sums_of(blocks, d, slowest);
    one.delay = d;
    if (one.sums.n < 50) continue;
    one.rss = one.sums.solve(kAll, one.c) / static_cast<double>(one.sums.n);
    if (one.rss < best.rss) best = one;
  }
  return best;
}

RoughFit as_rough(const Fit& fit) {
  RoughFit r;
  if (!(fit.sums.n >= 50)) return r;
  const auto n = static_cast<double>(fit.sums.n);
  r.good = true;
  r.mass = fit.c[0];
  r.viscous = fit.c[1];
  r.coulomb = fit.c[2];
  r.stiffness = fit.c[3];
  r.offset = fit.c[4];
  r.delay = fit.delay;
  r.rms = std::sqrt(fit.rss);
  const double total = fit.sums.ff / n - fit.sums.f * fit.sums.f / (n * n);
  r.r_squared = total > 0.0 ? 1.0 - fit.rss / total : 0.0;
  const double rounding = 1e-9 * fit.sums.ff / n;
  Vector unused;
  const double without_mass = fit.sums.solve({false, true, true, true, true}, unused) / n;
  const double without_friction = fit.sums.solve({true, false, false, true, true}, unused) / n;
  constexpr double kShows = 0.9;
  r.mass_shows = fit.rss + rounding < kShows * without_mass;
  const double forward = static_cast<double>(fit.sums.forward) / n;
  r.friction_shows = fit.rss + rounding < kShows * without_friction && forward > 0.03 && forward < 0.97;
  return r;
}

/// Model force at the rows of a block, as the force column has it.
std::vector<double> predicted(const Block& b, const Fit& fit) {
  const auto n = static_cast<std::ptrdiff_t>(b.motion.rows());
  std::vector<double> at_motion(b.motion.rows());
  for (std::size_t k = 0; k < at_motion.size(); ++k) at_motion[k] = fit.c.dot(regressors(b, k));
  std::vector<double> out(b.motion.rows());
  for (std::ptrdiff_t k = 0; k < n; ++k) {
    const std::ptrdiff_t i = std::clamp<std::ptrdiff_t>(k - fit.delay, 0, n - 1);
    const std::ptrdiff_t j = std::min(i + 1, n - 1);
    out[static_cast<std::size_t>(k)] =
        0.5 * (at_motion[static_cast<std::size_t>(i)] + at_motion[static_cast<std::size_t>(j)]);
  }
  return out;
}

double mean_of(const std::vector<double>& y, std::size_t first, std::size_t last) {
  double sum = 0.0;
  for (std::size_t k = first; k < last; ++k) sum += y[k];
  return sum / static_cast<double>(last - first);
}

/// Rows at the end that stand without drive; 0: none.
std::size_t rows_without_drive(const std::vector<double>& x, const std::vector<double>& f, double& level,
                               double& rest) {
  const std::size_t n = x.size();
  const std::vector<double> some = sample_of(x, 20000);
  const double play = 20.0 * std::max(quantum(some), position_noise(some));
  std::size_t first = n;
  while (first > 0 && std::abs(x[first - 1] - x[n - 1]) <= play) --first;
  const std::size_t rows = n - first;
  constexpr std::size_t kShortest = 40;
  if (rows < kShortest || first == 0) return 0;
  const std::size_t tenth = rows / 10;
  rest = mean_of(f, n - tenth, n);
  // The hold level is the median of the part before the force leaves it.
  std::size_t last = n;
  double largest = 0.0;
  for (std::size_t k = first + tenth; k < n; ++k) largest = std::max(largest, std::abs(f[k] - rest));
  while (last > first && std::abs(f[last - 1] - rest) < 0.8 * largest) --last;
  if (last < first + tenth + 8 || n - last < kShortest / 4) return 0;
  level = quantile(
      {f.begin() + static_cast<std::ptrdiff_t>(first + tenth), f.begin() + static_cast<std::ptrdiff_t>(last)},
      0.5);
  double spread = 0.0;
  for (std::size_t k = first + tenth; k < last; ++k) spread = std::max(spread, std::abs(f[k] - level));
  if (std::abs(rest) > 0.1 * std::abs(level) || spread > 0.3 * std::abs(level)) return 0;
  std::size_t down = last;
  while (down < n && std::abs(f[down] - rest) > 0.2 * std::abs(level - rest)) ++down;
  if ((down - last) * 3 > n - last) return 0;  // it creeps down: a controller at work
  while (last > first && std::abs(f[last - 1] - level) > spread * 0.7) --last;
  return n - last;
}

}  // namespace

bool quiet(const std::vector<double>& column) {
  const std::vector<double> f = sample_of(column, 20000);
  std::vector<double> second;
  for (std::size_t k = 1; k + 1 < f.size(); ++k) second.push_back(std::abs(f[k + 1] - 2.0 * f[k] + f[k - 1]));
  const auto [low, high] = std::minmax_element(f.begin(), f.end());
  return quantile(std::move(second), 0.75) < 1e-3 * (*high - *low);
}

RoughFit rough_fit(const std::vector<Table>& tables) {
  const std::vector<Block> blocks = blocks_of(tables, kRowsOfRoughFit);
  if (blocks.empty()) return {};
  const double slowest = slowest_moving(blocks);
  return as_rough(best_fit(blocks, slowest));
}

void recover_signs(std::vector<Table>& tables, Notes& notes) {
  if (!notes.wanted("unsigned")) return;
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  std::size_t rows = 0;
  for (const Table& m : tables) {
    for (const double f : m.f) {
      low = std::min(low, f);
      high = std::max(high, f);
    }
    rows += m.rows();
  }
  if (!(low >= 0.0 || high <= 0.0) || low == high) return;
  const double side = low >= 0.0 ? 1.0 : -1.0;
  std::vector<Block> blocks = blocks_of(tables, std::numeric_limits<std::size_t>::max());
  if (blocks.empty()) return;
  const double slowest = slowest_moving(blocks);
  const Fit plus = best_fit(blocks, slowest);
  if (plus.sums.n < 50) return;
  const bool both_ways =
      plus.sums.forward * 33 > plus.sums.n && (plus.sums.n - plus.sums.forward) * 33 > plus.sums.n;
  if (!both_ways) return;

  Fit best;
  std::vector<std::vector<double>> signs;
  // Inertia against friction decides where the sign changes; their ratio is not known yet.
  std::vector<double> accelerations;
  for (const Block& b : blocks) {
    const std::vector<double> some = sample_of(magnitudes(b.motion.a), 20000);
    accelerations.insert(accelerations.end(), some.begin(), some.end());
  }
  const double usual = std::max(quantile(std::move(accelerations), 0.95), std::numeric_limits<double>::min());
  constexpr std::array<double, 5> kRatios{0.0, 0.3, 1.0, 3.0, 1e6};
  for (std::size_t start = 0; start <= kRatios.size(); ++start) {
    std::vector<std::vector<double>> s;
    for (Block& b : blocks) {
      std::vector<double> guess = predicted(b, plus);
      for (std::size_t k = 0; start > 0 && k < guess.size(); ++k) {
        const double v = b.motion.v[k];
        guess[k] = (v > 0.0 ? 1.0 : v < 0.0 ? -1.0 : 0.0) + kRatios[start - 1] * b.motion.a[k] / usual;
      }
      std::vector<double> one(guess.size());
      for (std::size_t k = 0; k < one.size(); ++k) one[k] = side * guess[k] < 0.0 ? -1.0 : 1.0;
      s.push_back(std::move(one));
    }
    Fit fit;
    constexpr int kMostRounds = 25;
    for (int round = 0; round < kMostRounds; ++round) {
      for (std::size_t i = 0; i < blocks.size(); ++i) {
        std::vector<double> f = blocks[i].force;
        for (std::size_t k = 0; k < f.size(); ++k) f[k] *= s[i][k];
        smooth_force(blocks[i], f);
      }
      // A wrong start likes a wrong delay; first without one.
      constexpr int kRoundsAtFirst = 4;
      fit = best_fit(blocks, slowest, round < kRoundsAtFirst && start > 0 ? 2 : 100);
      std::size_t changed = 0;
      for (std::size_t i = 0; i < blocks.size(); ++i) {
        const std::vector<double> p = predicted(blocks[i], fit);
        for (std::size_t k = 0; k < p.size(); ++k) {
          const double sign = side * p[k] < 0.0 ? -1.0 : 1.0;
          if (sign != s[i][k]) ++changed;
          s[i][k] = sign;
        }
      }
      if (changed == 0 && round >= kRoundsAtFirst) break;
    }
    if (fit.rss < best.rss) {
      best = fit;
      signs = std::move(s);
    }
  }
  const double rms = std::sqrt(best.rss);
  std::size_t flipped = 0;
  std::size_t sure = 0;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const std::vector<double> p = predicted(blocks[i], best);
    for (std::size_t k = 0; k < p.size(); ++k) {
      if (signs[i][k] > 0.0) continue;
      ++flipped;
      if (std::abs(p[k]) > 2.0 * rms) ++sure;
    }
  }
  // A loaded axis may honestly never pull the other way; then the folded model fits no better.
  constexpr std::size_t kFewest = 8;
  if (sure < kFewest || best.rss > 0.8 * plus.rss) return;
  const RoughFit recovered = as_rough(best);
  constexpr double kEnough = 0.7;
  if (recovered.r_squared < kEnough) {
    throw Refused(
        tables.front().source +
        text(": the force has no sign in this log, and the motion does not determine it (R2 = %.2f of the "
             "best model found): log the signed channel (--keep unsigned uses it as it is)",
             recovered.r_squared));
  }
  // The magnitude fits both ways round; friction and inertia decide.
  const double turn = best.c[2] < 0.0 && best.c[0] < 0.0 ? -1.0 : 1.0;
  if (turn < 0.0) flipped = rows - flipped;
  std::size_t unsure = 0;
  const Table* first_table = nullptr;
  std::size_t first_row = 0;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    auto& table = tables[static_cast<std::size_t>(blocks[i].table - tables.data())];
    const std::vector<double> p = predicted(blocks[i], best);
    for (std::size_t k = 0; k < p.size(); ++k) {
      const std::size_t at = blocks[i].first + k;
      table.f[at] *= turn * signs[i][k];
      if (turn * signs[i][k] < 0.0 && first_table == nullptr) {
        first_table = &table;
        first_row = at;
      }
      // At rest friction may hold either way; only a load beyond it is sure.
      const auto at_motion = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(
          static_cast<std::ptrdiff_t>(k) - best.delay, 0, static_cast<std::ptrdiff_t>(p.size()) - 1));
      const bool rests = std::abs(blocks[i].motion.v[at_motion]) < slowest;
      const double holding = std::abs(best.c[4] + best.c[3] * blocks[i].x[k]);
      const bool held = rests && holding < 1.5 * std::abs(best.c[2]) + 2.0 * rms;
      if (std::abs(p[k]) < 2.0 * rms || held) {
        table.mark[at] |= kSignUnsure;
        ++unsure;
      }
    }
  }
  notes.add(
      "unsigned", *first_table, first_row, true,
      text("the force is a magnitude, never %s zero: a model with signs goes below zero where the log "
           "comes back up. Sign recovered: %zu of %zu rows turned over, from this one on; %zu rows at rest "
           "or nearer to zero than twice the remainder (%.3g) are marked unsure. Rest %.3g instead of %.3g "
           "as logged",
           low >= 0.0 ? "below" : "above", flipped, rows, unsure, 2.0 * rms, rms, std::sqrt(plus.rss)),
      {static_cast<double>(flipped), static_cast<double>(unsure), rms, std::sqrt(plus.rss)});
}

void mend_sign(std::vector<Table>& tables, Notes& notes) {
  if (!notes.wanted("inverted")) return;
  const RoughFit r = rough_fit(tables);
  if (!r.good) return;
  // The viscous part may honestly be negative: a low-speed rise looks like that.
  const bool negative = r.coulomb < 0.0;
  if (r.friction_shows && negative && r.mass_shows && r.mass > 0.0) {
    notes.add_all(
        "contradiction", tables.front().source, false,
        text("inertia and friction have opposite signs (m = %.4g, F = %.4g in the units of the log): force "
             "and motion may not belong together, or another force acts",
             r.mass, r.coulomb),
        {r.mass, r.coulomb});
    return;
  }
  const bool inverted =
      (r.friction_shows && negative && r.viscous <= 0.0 && (!r.mass_shows || r.mass < 0.0)) ||
      (r.friction_shows && negative && r.mass_shows && r.mass < 0.0) ||
      (!r.friction_shows && r.mass_shows && r.mass < 0.0 && r.r_squared > 0.9);
  if (!inverted) return;
  for (Table& m : tables) {
    for (double& f : m.f) f = -f;
  }
  notes.add_all(
      "inverted", tables.front().source, true,
      text("the force is positive towards smaller positions (as logged m = %.4g, F = %.4g, R2 = %.3f): "
           "sign of the force turned",
           r.mass, r.coulomb, r.r_squared),
      {r.mass, r.coulomb, r.r_squared});
}

void cut_drive_off(std::vector<Table>& tables, Notes& notes) {
  if (!notes.wanted("drive-off")) return;
  for (Table& m : tables) {
    if (m.rows() < kFewestRows || quiet(m.f)) continue;
    double level = 0.0;
    double rest = 0.0;
    const std::size_t end = rows_without_drive(m.x, m.f, level, rest);
    if (end > 0) {
      const std::size_t k = m.rows() - end;
      notes.add_range(
          "drive-off", m, k, m.rows() - 1, true,
          text("at standstill the force falls from %.4g to %.3g and stays there: drive off, brake; cut off",
               level, rest),
          {m.t[k], level, rest});
      const bool gap = m.gap_before;
      m = slice(m, 0, k);
      m.gap_before = gap;
    }
    // The start is the end of the log read backwards.
    if (m.rows() < kFewestRows ||
        std::abs(m.f.front()) > 0.3 * quantile(magnitudes(sample_of(m.f, 2000)), 0.9))
      continue;
    const std::vector<double> x(m.x.rbegin(), m.x.rend());
    const std::vector<double> f(m.f.rbegin(), m.f.rend());
    const std::size_t begin = rows_without_drive(x, f, level, rest);
    if (begin > 0) {
      notes.add_range(
          "drive-off", m, 0, begin - 1, true,
          text("at standstill the force is %.3g and then rises to %.4g: drive not yet on; cut off", rest,
               level),
          {m.t[begin - 1], level, rest});
      const bool gap = m.gap_before;
      m = slice(m, begin, m.rows());
      m.gap_before = gap;
    }
  }
}

void find_saturation(std::vector<Table>& tables, Notes& notes) {
  if (!notes.wanted("saturated")) return;
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const Table& m : tables) {
    for (const double f : m.f) {
      low = std::min(low, f);
      high = std::max(high, f);
    }
  }
  if (!(low < high)) return;
  std::size_t longest_elsewhere = 1;
  std::size_t longest[2] = {0, 0};
  std::size_t at[2] = {0, 0};
  struct Place {
    Table* table = nullptr;
    std::size_t row = 0;
  } where[2];
  for (Table& m : tables) {
    std::size_t begin = 0;
    for (std::size_t k = 1; k <= m.rows(); ++k) {
      if (k < m.rows() && m.f[k] == m.f[begin]) continue;
      const std::size_t run = k - begin;
      const double f = m.f[begin];
      if (f == low || f == high) {
        const std::size_t side = f == high ? 1 : 0;
        at[side] += run > 1 ? run : 0;
        longest[side] = std::max(longest[side], run);
        if (run > 2 && where[side].table == nullptr) where[side] = {&m, begin};
      } else {
        longest_elsewhere = std::max(longest_elsewhere, run);
      }
      begin = k;
    }
  }
  for (const std::size_t side : {0, 1}) {
    // Tops of a programmed force are no longer than its other steps.
    if (longest[side] < 6 || longest[side] < 3 * longest_elsewhere) continue;
    const double value = side == 1 ? high : low;
    notes.add(
        "saturated", *where[side].table, where[side].row, false,
        text("the force is at its %s value %.4g in %zu rows, up to %zu in a row: the drive was at its "
             "limit (then this is the force) or the channel is cut off (then the result is biased); rows "
             "marked",
             side == 1 ? "largest" : "smallest", value, at[side], longest[side]),
        {value, static_cast<double>(at[side])});
    for (Table& m : tables) {
      for (std::size_t k = 0; k < m.rows(); ++k) {
        if (m.f[k] == value) m.mark[k] |= kAtLimit;
      }
    }
  }
}

}  // namespace stribeck::ident::log::parts
