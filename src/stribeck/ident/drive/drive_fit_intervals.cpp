#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stribeck/ident/drive/drive_fit_parts.hpp>
#include <stribeck/ident/stats/uncertainty.hpp>

namespace stribeck::ident::drive {

void DriveFit::intervals() {
  if (joint_) {
    linear_ = *joint_;
    if (!options_.mass) mass_ = linear_(0);
  }
  const map::StaticFit& fit = choice_.fit;
  const std::size_t n = rows_.size();
  const std::size_t q = columns();
  const std::size_t p = fit.parameters();
  const auto Q = static_cast<Index>(q), P = static_cast<Index>(p);
  // The fit and its derivatives by bin, at the mean speed of the bin.
  std::array<MatrixXd, map::kSides> slope;
  std::array<VectorXd, map::kSides> at_bin, per_speed;
  const std::size_t stride = q + 6;
  MatrixXd normal = MatrixXd::Zero(P, P);
  MatrixXd along = MatrixXd::Zero(P, Q), along_instruments = along;
  for (int s = 0; s < map::kSides; ++s) {
    const auto S = static_cast<std::size_t>(s);
    const Index bins = grid_[S].bins;
    const auto [first, count] = fit.span(s);
    slope[S] = MatrixXd::Zero(bins, static_cast<Index>(count));
    VectorXd g(static_cast<Index>(count));
    for (Index b = 0; b < bins; ++b) {
      const double* t = &mean_[S][static_cast<std::size_t>(b) * stride];
      const double rows = t[q + 4];
      const double speed = rows > 0.0 ? t[q + 5] / rows : grid_[S].low;
      fit.gradient(s, speed, g.data());
      slope[S].row(b) = g.transpose();
      if (rows <= 0.0) continue;
      normal.block(static_cast<Index>(first), static_cast<Index>(first), g.size(), g.size()) +=
          rows * g * g.transpose();
      along.middleRows(static_cast<Index>(first), g.size()) +=
          map::kDirection[S] * g * Eigen::Map<const VectorXd>(t, Q).transpose();
      for (std::size_t j = 0; j < q; ++j) {
        along_instruments.block(static_cast<Index>(first), static_cast<Index>(j), g.size(), 1) +=
            map::kDirection[S] * g * t[multiplier(j)];
      }
    }
  }
  // Curves over speed as tables: exponentials for every row would take longer than all the rest.
  constexpr int kTable = 2048;
  std::array<std::vector<double>, map::kSides> table;
  for (int s = 0; s < map::kSides; ++s) {
    const auto S = static_cast<std::size_t>(s);
    for (int i = 0; i <= kTable; ++i)
      table[S].push_back(fit.force(s, grid_[S].low + (grid_[S].high - grid_[S].low) * i / kTable));
  }
  residual_.resize(n);
  std::vector<double> c(q + 1);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t s = rows_.side[i];
    double e = fill(i, c.data());
    for (std::size_t j = 0; j < q; ++j) e -= linear_(static_cast<Index>(j)) * c[j];
    const double place = (std::abs(velocity(i)) - grid_[s].low) / (grid_[s].high - grid_[s].low) * kTable;
    const int cell = std::clamp(static_cast<int>(place), 0, kTable - 1);
    const double share = place - cell;
    const auto u = static_cast<std::size_t>(cell);
    residual_[i] = e - map::kDirection[s] * (table[s][u] + share * (table[s][u + 1] - table[s][u]));
  }
  memory_ = stats::memory_of(residual_, rows_.record, rows_.at);
  stats::LongRun moments(q + p, memory_);
  double square = 0.0;
  const bool by_instrument = !options_.mass && q > 0 && !weak_;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t s = rows_.side[i];
    const double e = residual_[i];
    square += e * e;
    double* row = moments.row(rows_.record[i], rows_.at[i]);
    fill(i, c.data());
    const double* t = &mean_[s][static_cast<std::size_t>(rows_.bin[i]) * stride];
    // Fitted together with the map, the linear terms are not centred.
    const double centre = joint_ ? 0.0 : 1.0 / t[q + 4];
    for (std::size_t j = 0; j < q; ++j) {
      if (j == 0 && by_instrument) {
        const log::Motion& m = motion(i);
        const std::size_t k = rows_.at[i];
        const double known = map::kDirection[s] * line_[s](std::abs(m.v[k]));
        const double z =
            m.loop == log::Loop::kOpen ? (m.f[k] - rows_.lag[i] - known) / mass_ : m.instrument[k];
        row[0] += (z - t[q] * centre) * e;
      } else if (shift_free_ && j + 1 == q) {
        row[j] += (shift_instrument(i, c[j]) - t[q + 1] * centre) * e;
      } else {
        row[j] += (c[j] - t[j] * centre) * e;
      }
    }
    const auto [first, count] = fit.span(static_cast<int>(s));
    const double signed_e = map::kDirection[s] * e;
    const Index b = rows_.bin[i];
    for (std::size_t j = 0; j < count; ++j)
      row[q + first + j] += slope[s](b, static_cast<Index>(j)) * signed_e;
  }
  const std::vector<double> raw = moments.covariance();
  const Eigen::Map<const MatrixXd> meat(raw.data(), Q + P, Q + P);

  // Directions that the data do not see are taken out; the curve on the data does not move along them.
  const VectorXd scale = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(scale.asDiagonal() * normal * scale.asDiagonal());
  const VectorXd& values = eigen.eigenvalues();
  VectorXd inverse = VectorXd::Zero(values.size());
  blind_.assign(p, 0.0);
  for (Index j = 0; j < values.size(); ++j) {
    if (values(j) > 1e-9 * values.maxCoeff()) {
      inverse(j) = 1.0 / values(j);
    } else {
      for (std::size_t i = 0; i < p; ++i)
        blind_[i] += std::pow(eigen.eigenvectors()(static_cast<Index>(i), j), 2.0);
    }
  }
  const MatrixXd bread = scale.asDiagonal() * eigen.eigenvectors() * inverse.asDiagonal() *
                         eigen.eigenvectors().transpose() * scale.asDiagonal();
  // The linear terms move by their own moments, the map by its own less what the linear terms take along.
  MatrixXd map = MatrixXd::Zero(Q + P, Q + P);
  MatrixXd white = MatrixXd::Zero(Q + P, Q + P);
  white.bottomRightCorner(P, P) = normal;
  if (joint_) {
    MatrixXd all = MatrixXd::Zero(Q + 4, Q + 4);
    for (const MatrixXd& block : raw_cross_) all += block;
    MatrixXd A = white;
    for (Index i = 0; i < Q; ++i) {
      for (Index j = 0; j < Q; ++j) {
        const auto zi = static_cast<Index>(multiplier(static_cast<std::size_t>(i)));
        const auto zj = static_cast<Index>(multiplier(static_cast<std::size_t>(j)));
        A(i, j) = all(zi, j);
        white(i, j) = all(zi, zj);
      }
    }
    A.bottomLeftCorner(P, Q) = along;
    A.topRightCorner(Q, P) = along_instruments.transpose();
    white.bottomLeftCorner(P, Q) = along_instruments;
    white.topRightCorner(Q, P) = along_instruments.transpose();
    const VectorXd size = A.diagonal().cwiseAbs().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    map = size.asDiagonal() *
          (size.asDiagonal() * A * size.asDiagonal()).completeOrthogonalDecomposition().pseudoInverse() *
          size.asDiagonal();
  } else {
    if (q > 0) {
      const MatrixXd gain = moments_.fullPivLu().inverse();
      map.topLeftCorner(Q, Q) = gain;
      map.bottomLeftCorner(P, Q) = -bread * along * gain;
      white.topLeftCorner(Q, Q) = instrument_moments_;
    }
    map.bottomRightCorner(P, P) = bread;
  }
  const double independent = static_cast<double>(n) / (2.0 * memory_.rows);
  const double freedom = std::max(3.0, independent - static_cast<double>(p + q));
  const double correction = std::max(1.0, independent / freedom);
  covariance_ = correction * map * meat * map.transpose();
  // The same under stationary noise. Newey–West sees at each speed only the few passes through it and is
  // often too small there by chance; the stationary form pools all rows but misses noise that depends on
  // speed. The larger of the two stands.
  const double noise = 2.0 * memory_.rows * square / static_cast<double>(n) * correction;
  pooled_ = noise * map * white * map.transpose();
  factor_ = stats::student_factor(freedom);
}

double DriveFit::error_of(const VectorXd& h) const {
  return std::sqrt(std::max({0.0, h.dot(covariance_ * h), h.dot(pooled_ * h)}));
}

double DriveFit::error_at(std::size_t i) const {
  return error_of(VectorXd::Unit(covariance_.rows(), static_cast<Index>(i)));
}

}  // namespace stribeck::ident::drive
