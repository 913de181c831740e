#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stribeck/ident/drive/intervals.hpp>
#include <stribeck/ident/stats/uncertainty.hpp>

namespace stribeck::ident::drive {
namespace {

/// Derivatives of the map at the mean speed of each bin, and their products.
struct MapMoments {
  std::array<MatrixXd, map::kSides> slope;  ///< bin, parameter of the side
  MatrixXd normal;                          ///< map with map
  MatrixXd with_columns;                    ///< map with linear columns
  MatrixXd with_multipliers;                ///< map with the multipliers of the residual
};

MapMoments moments_of(const map::StaticFit& map, const Rows& rows, const LinearFit& fit) {
  const std::size_t q = fit.sums.layout.terms;
  const auto Q = static_cast<Index>(q), P = static_cast<Index>(map.parameters());
  MapMoments out;
  out.normal = MatrixXd::Zero(P, P);
  out.with_columns = out.with_multipliers = MatrixXd::Zero(P, Q);
  for (int s = 0; s < map::kSides; ++s) {
    const auto side = static_cast<std::size_t>(s);
    const Index bins = rows.grid[side].bins;
    const auto [first, count] = map.span(s);
    const auto F = static_cast<Index>(first);
    out.slope[side] = MatrixXd::Zero(bins, static_cast<Index>(count));
    VectorXd g(static_cast<Index>(count));
    for (Index b = 0; b < bins; ++b) {
      const BinSums t = fit.sums.of(side, static_cast<std::size_t>(b));
      const double speed = t.rows() > 0.0 ? t.speed() / t.rows() : rows.grid[side].low;
      map.gradient(s, speed, g.data());
      out.slope[side].row(b) = g.transpose();
      if (t.rows() <= 0.0) continue;
      out.normal.block(F, F, g.size(), g.size()) += t.rows() * g * g.transpose();
      out.with_columns.middleRows(F, g.size()) += map::kDirection[side] * g * t.first(q).transpose();
      for (std::size_t j = 0; j < q; ++j) {
        out.with_multipliers.block(F, static_cast<Index>(j), g.size(), 1) +=
            map::kDirection[side] * g * t.column(fit.multiplier[j]);
      }
    }
  }
  return out;
}

/// Residual of the force at every row, without linear terms and map.
std::vector<double> residuals(const AlignedLog& log, const Rows& rows, const Terms& terms,
                              const LinearFit& fit, const map::StaticFit& map) {
  // Curves over speed are tabulated: exponentials for every row would take longer than everything else.
  constexpr int kTable = 2048;
  std::array<std::vector<double>, map::kSides> table;
  for (int s = 0; s < map::kSides; ++s) {
    const map::Grid& grid = rows.grid[static_cast<std::size_t>(s)];
    for (int i = 0; i <= kTable; ++i)
      table[static_cast<std::size_t>(s)].push_back(
          map.force(s, grid.low + (grid.high - grid.low) * i / kTable));
  }
  std::vector<double> out(rows.size());
  std::vector<double> c(terms.count() + 1);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::size_t s = rows.side[i];
    const map::Grid& grid = rows.grid[s];
    double e = terms.fill(log, rows, i, c.data());
    for (std::size_t j = 0; j < terms.count(); ++j) e -= fit.value(static_cast<Index>(j)) * c[j];
    const double place = (std::abs(velocity_of(log, rows, i)) - grid.low) / (grid.high - grid.low) * kTable;
    const int cell = std::clamp(static_cast<int>(place), 0, kTable - 1);
    const double share = place - cell;
    const auto u = static_cast<std::size_t>(cell);
    out[i] = e - map::kDirection[s] * (table[s][u] + share * (table[s][u + 1] - table[s][u]));
  }
  return out;
}

/// Long-run covariance of multiplier·residual.
MatrixXd long_run_of(const AlignedLog& log, const Rows& rows, const Terms& terms, const LinearFit& fit,
                     const MapChoice& choice, const MapMoments& map, const std::vector<double>& residual,
                     const stats::Memory& memory) {
  const SumsLayout& at = fit.sums.layout;
  const std::size_t q = at.terms, p = choice.map.fit.parameters();
  stats::LongRun moments(q + p, memory);
  std::vector<double> c(q + 1);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::size_t s = rows.side[i];
    const double e = residual[i];
    double* row = moments.row(rows.record[i], rows.at[i]);
    terms.fill(log, rows, i, c.data());
    const BinSums t = fit.sums.of(s, static_cast<std::size_t>(rows.bin[i]));
    // When fitted together with the map, the linear terms are not centred.
    const double centre = choice.joint ? 0.0 : 1.0 / t.rows();
    for (std::size_t j = 0; j < q; ++j) {
      const std::size_t by = fit.multiplier[j];
      const double z = by == at.mass_instrument()    ? mass_instrument(log, rows, fit, i)
                       : by == at.shift_instrument() ? shift_instrument(log, rows, i, c[j])
                                                     : c[j];
      row[j] += (z - t.column(by) * centre) * e;
    }
    const auto [first, count] = choice.map.fit.span(static_cast<int>(s));
    const double signed_e = map::kDirection[s] * e;
    for (std::size_t j = 0; j < count; ++j)
      row[q + first + j] += map.slope[s](rows.bin[i], static_cast<Index>(j)) * signed_e;
  }
  const std::vector<double> raw = moments.covariance();
  const auto size = static_cast<Index>(q + p);
  return Eigen::Map<const MatrixXd>(raw.data(), size, size);
}

/// Inverse of the map's moments without the directions that the data do not determine; their shares are written to `unseen`.
MatrixXd inverse_seen(const MatrixXd& normal, std::vector<double>& unseen) {
  const VectorXd scale = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(scale.asDiagonal() * normal * scale.asDiagonal());
  const VectorXd& values = eigen.eigenvalues();
  VectorXd inverse = VectorXd::Zero(values.size());
  unseen.assign(static_cast<std::size_t>(values.size()), 0.0);
  for (Index j = 0; j < values.size(); ++j) {
    if (values(j) > 1e-9 * values.maxCoeff()) {
      inverse(j) = 1.0 / values(j);
    } else {
      for (std::size_t i = 0; i < unseen.size(); ++i)
        unseen[i] += std::pow(eigen.eigenvectors()(static_cast<Index>(i), j), 2.0);
    }
  }
  return scale.asDiagonal() * eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose() *
         scale.asDiagonal();
}

/// Derivative of θ with respect to the moments of the residual, and the moments' covariance under white noise of variance 1.
struct Bread {
  MatrixXd inverse, white;
};

/// The case of map and linear terms fitted together.
Bread joint_bread(const LinearFit& fit, const MapMoments& map) {
  const auto Q = static_cast<Index>(fit.sums.layout.terms), P = map.normal.rows();
  const auto W = static_cast<Index>(fit.sums.layout.columns());
  MatrixXd all = MatrixXd::Zero(W, W);
  for (const MatrixXd& block : fit.sums.products) all += block;
  MatrixXd white = MatrixXd::Zero(Q + P, Q + P);
  white.bottomRightCorner(P, P) = map.normal;
  MatrixXd A = white;
  for (Index i = 0; i < Q; ++i) {
    const auto zi = static_cast<Index>(fit.multiplier[static_cast<std::size_t>(i)]);
    for (Index j = 0; j < Q; ++j) {
      A(i, j) = all(zi, j);
      white(i, j) = all(zi, static_cast<Index>(fit.multiplier[static_cast<std::size_t>(j)]));
    }
  }
  A.bottomLeftCorner(P, Q) = map.with_columns;
  A.topRightCorner(Q, P) = map.with_multipliers.transpose();
  white.bottomLeftCorner(P, Q) = map.with_multipliers;
  white.topRightCorner(Q, P) = map.with_multipliers.transpose();
  const VectorXd size = A.diagonal().cwiseAbs().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  return {size.asDiagonal() *
              (size.asDiagonal() * A * size.asDiagonal()).completeOrthogonalDecomposition().pseudoInverse() *
              size.asDiagonal(),
          white};
}

/// The linear terms depend on their own moments; the map on its own moments less the part that the linear terms take.
Bread bread_in_turn(const LinearFit& fit, const MapMoments& map, const MatrixXd& map_inverse) {
  const auto Q = static_cast<Index>(fit.sums.layout.terms), P = map.normal.rows();
  Bread out{MatrixXd::Zero(Q + P, Q + P), MatrixXd::Zero(Q + P, Q + P)};
  out.white.bottomRightCorner(P, P) = map.normal;
  if (Q > 0) {
    const MatrixXd gain = fit.moments.fullPivLu().inverse();
    out.inverse.topLeftCorner(Q, Q) = gain;
    out.inverse.bottomLeftCorner(P, Q) = -map_inverse * map.with_columns * gain;
    out.white.topLeftCorner(Q, Q) = fit.instrument_moments;
  }
  out.inverse.bottomRightCorner(P, P) = map_inverse;
  return out;
}

}  // namespace

double Intervals::error_of(const VectorXd& h) const {
  return std::sqrt(std::max({0.0, h.dot(long_run * h), h.dot(stationary * h)}));
}

double Intervals::error_at(std::size_t i) const {
  return error_of(VectorXd::Unit(long_run.rows(), static_cast<Index>(i)));
}

LinearFit with_terms_of(const MapChoice& choice, const Terms& terms, LinearFit fit) {
  if (!choice.joint) return fit;
  fit.value = *choice.joint;
  if (!terms.known_mass) fit.mass = fit.value(0);
  return fit;
}

Intervals intervals(const AlignedLog& log, const Rows& rows, const Terms& terms, const LinearFit& fit,
                    const MapChoice& choice) {
  const MapMoments map = moments_of(choice.map.fit, rows, fit);
  Intervals out;
  out.residual = residuals(log, rows, terms, fit, choice.map.fit);
  const stats::Memory memory = stats::memory_of(out.residual, rows.record, rows.at);
  const MatrixXd meat = long_run_of(log, rows, terms, fit, choice, map, out.residual, memory);
  const MatrixXd map_inverse = inverse_seen(map.normal, out.unseen);
  const Bread bread = choice.joint ? joint_bread(fit, map) : bread_in_turn(fit, map, map_inverse);
  double square = 0.0;
  for (const double e : out.residual) square += e * e;
  const auto n = static_cast<double>(rows.size());
  const double independent = n / (2.0 * memory.rows);
  const double freedom = std::max(3.0, independent - static_cast<double>(meat.rows()));
  const double correction = std::max(1.0, independent / freedom);
  out.long_run = correction * bread.inverse * meat * bread.inverse.transpose();
  const double noise = 2.0 * memory.rows * square / n * correction;
  out.stationary = noise * bread.inverse * bread.white * bread.inverse.transpose();
  out.factor = stats::student_factor(freedom);
  return out;
}

}  // namespace stribeck::ident::drive
