#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <stribeck/ident/log/rough_fit.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <utility>

namespace stribeck::ident::log::parts {
namespace {

constexpr std::size_t kRowsOfRoughFit = 100000;  // 25 s at 4 kHz
constexpr std::array<bool, kColumns> kAll{true, true, true, true, true};

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
  record.loop = Loop::kClosed;  // keeps the force unchanged; instruments are not used here
  b.motion = reconstruct(record);
  b.force = part.f;
  b.x = part.x;
  for (double& x : b.x) x -= middle;
  smooth_force(b, b.force);
  return b;
}

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

}  // namespace

void smooth_force(Block& b, const std::vector<double>& force) {
  const std::vector<double> calm = smooth_like(b.motion, force);
  b.f.assign(calm.size(), 0.0);
  for (std::size_t k = 1; k < calm.size(); ++k) b.f[k] = 0.5 * (calm[k - 1] + calm[k]);
}

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

double Sums::solve(const std::array<bool, kColumns>& use, Vector& c) const {
  Vector scale;
  for (int i = 0; i < kColumns; ++i)
    scale[i] = a(i, i) > 0.0 && use[static_cast<std::size_t>(i)] ? 1.0 / std::sqrt(a(i, i)) : 0.0;
  const Eigen::Matrix<double, kColumns, kColumns> normal = scale.asDiagonal() * a * scale.asDiagonal();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, kColumns, kColumns>> eigen(normal);
  const Vector rhs = scale.asDiagonal() * b;
  Vector solution = Vector::Zero();
  for (int i = 0; i < kColumns; ++i) {
    // Columns that are linearly dependent (one direction only, a sine) share what they explain.
    if (eigen.eigenvalues()[i] < 1e-7) continue;
    solution += eigen.eigenvectors().col(i) * (eigen.eigenvectors().col(i).dot(rhs) / eigen.eigenvalues()[i]);
  }
  c = scale.asDiagonal() * solution;
  return std::max(0.0, ff - 2.0 * c.dot(b) + c.dot(a * c));
}

double slowest_moving(const std::vector<Block>& blocks) {
  std::vector<double> speeds;
  for (const Block& b : blocks) {
    for (std::size_t k = 0; k < b.motion.rows(); ++k) {
      if (b.motion.valid(k)) speeds.push_back(std::abs(b.motion.v[k]));
    }
  }
  return speeds.empty() ? 0.0 : 0.03 * stats::thinned_quantile(std::move(speeds), 0.99);
}

Fit best_fit(const std::vector<Block>& blocks, double slowest, int most) {
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
  const double without_spring = fit.sums.solve({true, true, true, false, true}, unused) / n;
  const double without_both = fit.sums.solve({false, true, true, false, true}, unused) / n;
  r.mass_shows_without_spring = without_spring + rounding < kShows * without_both;
  const double forward = static_cast<double>(fit.sums.forward) / n;
  r.friction_shows = fit.rss + rounding < kShows * without_friction && forward > 0.03 && forward < 0.97;
  return r;
}

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

RoughFit rough_fit(const std::vector<Table>& tables) {
  const std::vector<Block> blocks = blocks_of(tables, kRowsOfRoughFit);
  if (blocks.empty()) return {};
  const double slowest = slowest_moving(blocks);
  return as_rough(best_fit(blocks, slowest));
}

}  // namespace stribeck::ident::log::parts
