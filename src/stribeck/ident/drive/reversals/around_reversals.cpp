#include <algorithm>
#include <cmath>
#include <limits>
#include <stribeck/ident/drive/reversals/around_reversals.hpp>

namespace stribeck::ident::drive {
namespace {

constexpr std::size_t kDistances = AroundReversals::kDistances;
using Products = Eigen::Matrix<double, kDistances, kDistances>;

/// One distance, between two of the row: wᵀGw with w of neighbours alone.
double least_of_two(const Products& G) {
  double least = G.diagonal().minCoeff();
  for (Index i = 1; i < G.rows(); ++i) {
    const double bend = G(i, i) + G(i - 1, i - 1) - 2.0 * G(i, i - 1);
    const double share = (G(i - 1, i - 1) - G(i, i - 1)) / bend;
    if (share > 0.0 && share < 1.0) least = std::min(least, G(i - 1, i - 1) - share * share * bend);
  }
  return least;
}

/// Least wᵀGw with w ≥ 0 and Σ w = 1: one share after the other is moved to where it is worth most.
double least_mixed(const Products& G) {
  constexpr int kSteps = 200;
  Eigen::Matrix<double, kDistances, 1> w;
  w.setZero();
  Index best = 0;
  G.diagonal().minCoeff(&best);
  w(best) = 1.0;
  for (int step = 0; step < kSteps; ++step) {
    const Eigen::Matrix<double, kDistances, 1> slope = G * w;
    Index to = 0, from = 0;
    slope.minCoeff(&to);
    double worst = -1.0;
    for (Index i = 0; i < w.size(); ++i) {
      if (w(i) > 0.0 && slope(i) > worst) worst = slope(i), from = i;
    }
    const double bend = G(to, to) + G(from, from) - 2.0 * G(to, from);
    const double moved = std::min(w(from), (slope(from) - slope(to)) / bend);
    if (!(moved > 1e-6)) break;
    w(to) += moved;
    w(from) -= moved;
  }
  return w.dot(G * w);
}

/// Direction of each row and its distance since the reversal, which lies between two rows; of the first stretch infinite.
struct Course {
  std::vector<double> direction, distance;
};

Course course_of(const log::Motion& m) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  Course out{{m.direction.begin(), m.direction.end()}, m.distance};
  const auto near = static_cast<std::size_t>(m.reach) + 3;
  for (std::size_t i = 0; i < m.reversals.size(); ++i) {
    const std::size_t row = m.reversals[i], next = i + 1 < m.reversals.size() ? m.reversals[i + 1] : m.rows();
    if (i == 0) {
      std::fill_n(out.distance.begin(), next, kNone);
      continue;
    }
    const double now = m.direction[row];
    const std::size_t low = row > near ? row - near : 0, high = std::min(m.rows() - 1, row + near);
    std::size_t k = high;
    while (k > low && !(now * m.v[k - 1] <= 0.0 && now * m.v[k] > 0.0)) --k;
    if (k == low) continue;
    // Row k is the first of the new direction.
    for (std::size_t j = row; j < k; ++j) out.direction[j] = -now, out.distance[j] = kNone;
    for (std::size_t j = k; j < row; ++j) out.direction[j] = now;
    const double share = m.v[k] / (m.v[k] - m.v[k - 1]);
    double distance = 0.5 * share * std::abs(m.v[k]) * m.sample_time;
    for (std::size_t j = k; j < std::max(next, k + 1); ++j) {
      if (j > k) distance += std::max(0.0, 0.5 * now * (m.v[j - 1] + m.v[j])) * m.sample_time;
      out.distance[j] = distance;
    }
  }
  return out;
}

}  // namespace

double longest_rows(double sample_time) { return std::max(3.0, std::ceil(kLongestShift / sample_time)); }

double most_shift(double sample_time) { return std::min(kMostShiftRows, longest_rows(sample_time)); }

AroundReversals::AroundReversals(const AlignedLog& log) {
  constexpr std::size_t kMost = 100;  // reversals
  std::size_t count = 0;
  for (const log::Motion& m : log.motions) count += m.reversals.size();
  const std::size_t every = (count / kMost + 1) | 1;  // odd: both directions
  std::size_t number = 0;
  for (std::size_t r = 0; r < log.motions.size() && count > 0; ++r) {
    const log::Motion& m = log.motions[r];
    const std::size_t first = stretches_.size();
    for (std::size_t i = 1; i < m.reversals.size(); ++i) {  // the first is where the motion begins
      const std::size_t row = m.reversals[i];
      if (number++ % every == 0 && m.valid(row)) stretches_.push_back(stretch_around(m, r, row));
    }
    if (first < stretches_.size()) add_columns(m, first);
  }
}

AroundReversals::Left AroundReversals::left(const AlignedLog& log, const LinearFit& fit, double shift) const {
  const std::array<map::BinCurve::Line, map::kSides> line{fit.curve[0].line(), fit.curve[1].line()};
  // Below the slowest bin friction changes with speed as it does above.
  const auto settled = [&](std::size_t side, double speed) {
    const map::BinCurve& curve = fit.curve[side];
    const double slowest = curve.speed.front();
    return speed < slowest ? curve.force.front() - line[side].slope * (slowest - speed) : curve(speed);
  };
  const double forward = settled(0, 0.0), backward = -settled(1, 0.0);
  const double mean = 0.5 * (forward + backward), half = 0.5 * (forward - backward);
  // The force that is left with each distance alone, in products with each other: the shares are mixed afterwards.
  Eigen::Matrix<double, kDistances, 1> left;
  Products products = Products::Zero();
  double rows = 0.0;
  std::vector<double> force;
  for (const Stretch& s : stretches_) {
    const log::Motion& m = log.motions[s.record];
    force.resize(m.rows());
    log::align_force(log.force[s.record], shift, s.first, s.last, force);
    for (std::size_t k = s.first; k < s.last; ++k) {
      if (!m.skip.empty() && m.skip[k] != 0) continue;
      const std::size_t side = m.direction[k] > 0 ? 0 : 1;
      const double grows = map::kDirection[side] * (settled(side, std::abs(m.v[k])) - settled(side, 0.0));
      const double e = force[k] - fit.mass * m.a[k] - grows - mean;
      const double* model = &s.columns[(k - s.first) * (kDistances + 1)];
      for (std::size_t i = 0; i < kDistances; ++i)
        left(static_cast<Index>(i)) = e - half * (model[kDistances] - 2.0 * model[i]);
      products.selfadjointView<Eigen::Lower>().rankUpdate(left);
      rows += 1.0;
    }
  }
  if (!(rows > 0.0))
    return {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN(), half};
  const Products all = products.selfadjointView<Eigen::Lower>();
  return {least_of_two(all) / rows, least_mixed(all) / rows, half};
}

AroundReversals::Stretch AroundReversals::stretch_around(const log::Motion& m, std::size_t record,
                                                         std::size_t row) {
  constexpr double kSettled = 4e-3;  // distance, as a share of the travel
  constexpr std::ptrdiff_t kMostAfter = 1000;
  const double reach = most_shift(m.sample_time);
  const auto n = static_cast<std::ptrdiff_t>(reach) + m.reach;
  const auto at = static_cast<std::ptrdiff_t>(row), end = static_cast<std::ptrdiff_t>(m.rows()) - m.reach;
  std::ptrdiff_t last = std::min(end, at + n);
  while (last < std::min(end, at + kMostAfter) &&
         m.stretch[static_cast<std::size_t>(last)] == m.stretch[row] &&
         m.distance[static_cast<std::size_t>(last)] < kSettled * m.stroke)
    ++last;
  Stretch s;
  s.record = record;
  s.first = static_cast<std::size_t>(std::max<std::ptrdiff_t>(m.reach, at - n));
  s.last = static_cast<std::size_t>(last);
  s.columns.resize((s.last - s.first) * (kDistances + 1));
  return s;
}

void AroundReversals::add_columns(const log::Motion& m, std::size_t first) {
  constexpr double kLongest = 0.02;  // distance, as a share of the travel
  const Course course = course_of(m);
  const auto pad = static_cast<std::size_t>(3 * m.reach + 10);
  std::vector<double> column;
  for (std::size_t j = first; j < stretches_.size(); ++j) {
    Stretch& s = stretches_[j];
    const std::size_t from = s.first > pad ? s.first - pad : 0, to = std::min(m.rows(), s.last + pad);
    double distance = kLongest * m.stroke;
    for (std::size_t i = 0; i <= kDistances; ++i, distance *= 0.5) {
      column.resize(to - from);
      for (std::size_t k = from; k < to; ++k) {
        const double missing = i + 1 < kDistances ? std::exp(-course.distance[k] / distance) : 0.0;
        column[k - from] = course.direction[k] * (i < kDistances ? missing : 1.0);
      }
      const std::vector<double> passed = log::smooth_like(m, column);
      for (std::size_t k = s.first; k < s.last; ++k)
        s.columns[(k - s.first) * (kDistances + 1) + i] = passed[k - from];
    }
  }
}

}  // namespace stribeck::ident::drive
