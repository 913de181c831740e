#include <Eigen/Dense>
#include <algorithm>
#include <numeric>
#include <stribeck/ident/drive/drive_fit_parts.hpp>

namespace stribeck::ident::drive {

void DriveFit::solve(bool instruments) {
  const std::size_t q = columns();
  const std::size_t w = q + 4;  // columns, instruments of mass and shift, force without the map, force
  const std::size_t zi = q, si = q + 1, yi = q + 2, fi = q + 3;
  const std::size_t stride = w + 2;  // and rows, speed
  std::array<std::vector<double>, map::kSides> sums;
  for (std::size_t s = 0; s < map::kSides; ++s)
    sums[s].assign(blocks_ * static_cast<std::size_t>(grid_[s].bins) * stride, 0.0);
  std::vector<MatrixXd> cross(blocks_, MatrixXd::Zero(static_cast<Index>(w), static_cast<Index>(w)));
  std::vector<double> row(w);
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const std::size_t s = rows_.side[i];
    const log::Motion& m = motion(i);
    const std::size_t k = rows_.at[i];
    const double f = fill(i, row.data());
    const double speed = std::abs(m.v[k]);
    const double known = instruments ? map::kDirection[s] * line_[s](speed) : 0.0;
    row[fi] = f;
    row[yi] = f - known;
    row[zi] = q == 0                                   ? 0.0
              : options_.mass || !instruments || weak_ ? row[0]
              : m.loop == log::Loop::kOpen             ? (m.f[k] - rows_.lag[i] - known) / mass_
                                                       : m.instrument[k];
    row[si] = shift_free_ ? shift_instrument(i, row[q - 1]) : 0.0;
    MatrixXd& c = cross[block_[i]];
    for (std::size_t a = 0; a < w; ++a) {
      for (std::size_t b = 0; b <= a; ++b) c(static_cast<Index>(a), static_cast<Index>(b)) += row[a] * row[b];
    }
    double* sum = &sums[s][(block_[i] * static_cast<std::size_t>(grid_[s].bins) +
                            static_cast<std::size_t>(rows_.bin[i])) *
                           stride];
    for (std::size_t a = 0; a < w; ++a) sum[a] += row[a];
    sum[w] += 1.0;
    sum[w + 1] += speed;
  }
  raw_cross_.clear();
  for (const MatrixXd& c : cross) raw_cross_.emplace_back(c.selfadjointView<Eigen::Lower>());
  block_sums_ = sums;
  // Deviations from the mean of each bin over all blocks.
  std::array<std::vector<double>, map::kSides> total;
  for (std::size_t s = 0; s < map::kSides; ++s) {
    const std::size_t size = static_cast<std::size_t>(grid_[s].bins) * stride;
    total[s].assign(size, 0.0);
    for (std::size_t k = 0; k < blocks_; ++k) {
      for (std::size_t j = 0; j < size; ++j) total[s][j] += sums[s][k * size + j];
    }
  }
  MatrixXd all = MatrixXd::Zero(static_cast<Index>(w), static_cast<Index>(w));
  for (std::size_t k = 0; k < blocks_; ++k) {
    MatrixXd c = cross[k].selfadjointView<Eigen::Lower>();
    for (std::size_t s = 0; s < map::kSides; ++s) {
      for (std::size_t b = 0; b < static_cast<std::size_t>(grid_[s].bins); ++b) {
        const double* t = &total[s][b * stride];
        if (t[w] <= 0.0) continue;
        const double* own = &sums[s][(k * static_cast<std::size_t>(grid_[s].bins) + b) * stride];
        if (own[w] <= 0.0) continue;
        const Eigen::Map<const VectorXd> sum(own, static_cast<Index>(w));
        const VectorXd mean = Eigen::Map<const VectorXd>(t, static_cast<Index>(w)) / t[w];
        c += -sum * mean.transpose() - mean * sum.transpose() + own[w] * mean * mean.transpose();
      }
    }
    cross[k] = c;
    all += c;
  }
  const auto z = static_cast<Index>(zi);
  const auto solved = [&](const MatrixXd& c, bool with_instrument) -> VectorXd {
    if (q == 0) return {};
    MatrixXd a = c.topLeftCorner(static_cast<Index>(q), static_cast<Index>(q));
    VectorXd b = c.col(static_cast<Index>(yi)).head(static_cast<Index>(q));
    if (with_instrument && q > 0) {
      a.row(0) = c.row(z).head(static_cast<Index>(q));
      b(0) = c(z, static_cast<Index>(yi));
    }
    if (shift_free_) {
      const auto last = static_cast<Index>(q) - 1;
      a.row(last) = c.row(static_cast<Index>(si)).head(static_cast<Index>(q));
      b(last) = c(static_cast<Index>(si), static_cast<Index>(yi));
    }
    // Columns of very different size.
    const VectorXd scale =
        c.diagonal().head(static_cast<Index>(q)).cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    MatrixXd scaled = a * scale.asDiagonal();
    for (Index i = 0; i < scaled.rows(); ++i) {
      const double size = scaled.row(i).norm();
      if (size > 0.0) scaled.row(i) /= size, b(i) /= size;
    }
    return scale.asDiagonal() * scaled.fullPivLu().solve(b);
  };
  const bool by_instrument = instruments && !options_.mass && q > 0;
  if (by_instrument && !weak_ && !(all(z, 0) * all(z, 0) > 0.1 * all(z, z) * all(0, 0))) {
    warn("the reference hardly moves with the measured acceleration; the mass rests on the latter");
    weak_ = true;
    solve(instruments);
    return;
  }
  linear_ = solved(all, by_instrument);
  linear_held_.clear();
  for (std::size_t k = 0; k < blocks_; ++k) linear_held_.push_back(solved(all - cross[k], by_instrument));
  // What multiplies the residual in place of each column.
  std::vector<Index> by(q);
  std::iota(by.begin(), by.end(), Index{0});
  if (by_instrument) by.front() = z;
  if (shift_free_) by.back() = static_cast<Index>(si);
  moments_.resize(static_cast<Index>(q), static_cast<Index>(q));
  instrument_moments_.resize(static_cast<Index>(q), static_cast<Index>(q));
  for (std::size_t i = 0; i < q; ++i) {
    for (std::size_t j = 0; j < q; ++j) {
      moments_(static_cast<Index>(i), static_cast<Index>(j)) = all(by[i], static_cast<Index>(j));
      instrument_moments_(static_cast<Index>(i), static_cast<Index>(j)) = all(by[i], by[j]);
    }
  }
  if (!options_.mass) {
    mass_ = linear_(0);
    plain_mass_ = solved(all, false)(0);
  }
  mean_.assign(map::kSides, {});
  for (std::size_t s = 0; s < map::kSides; ++s) {
    const auto bins = static_cast<std::size_t>(grid_[s].bins);
    std::vector<double> count(bins), sum_v(bins), sum_f(bins);
    mean_[s] = total[s];
    for (std::size_t b = 0; b < bins; ++b) {
      const double* t = &total[s][b * stride];
      count[b] = t[w];
      sum_v[b] = t[w + 1];
      double f = t[fi];
      for (std::size_t j = 0; j < q; ++j) f -= linear_(static_cast<Index>(j)) * t[j];
      sum_f[b] = map::kDirection[s] * f;
    }
    line_[s].build(grid_[s], count, sum_v, sum_f);
  }
  const auto forward = line_[0].line(), back = line_[1].line();
  // A load beside which friction is small would make one direction drive the motion.
  const double mean_level = 0.5 * (forward.level + back.level);
  offset_ = std::min(forward.level, back.level) < 0.2 * std::abs(mean_level)
                ? 0.5 * (forward.level - back.level)
                : 0.0;
}

}  // namespace stribeck::ident::drive
