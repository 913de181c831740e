#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stribeck/ident/methods/least_squares_a.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/shown.hpp>
#include <stribeck/ident/stats/uncertainty.hpp>

namespace stribeck::ident::methods {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix4d;
using Eigen::Vector2d;
using Eigen::Vector4d;
using Eigen::VectorXd;

constexpr std::size_t kFewestFitRows = 60;

struct FitRow {
  int record;
  std::size_t at;
  double next;  // w[k+1]
  Vector4d phi;
};

/// FitRows of the thesis's fit, and the sums of the simple fit over all rows.
struct FitRows {
  std::vector<FitRow> rows;
  Matrix2d simple_normal = Matrix2d::Zero();
  Vector2d simple_right = Vector2d::Zero();
  double fastest[2] = {0.0, 0.0};  ///< forward, backward [m/s]
  double T = 0.0;                  ///< [s]
  double dead_band = 0.0;          ///< [m/s]
};

/// Of a micro stage, whose speeds are below the usual dead band, a share of its top speed.
double dead_band_of(const std::vector<log::Record>& records, const LeastSquaresAOptions& options) {
  if (options.dead_band) return *options.dead_band;
  constexpr double kUsual = 0.5e-3, kShare = 0.1;
  double top = 0.0;
  for (const log::Record& rec : records) {
    for (std::size_t k = 1; k < rec.x.size(); ++k)
      top = std::max(top, std::abs(rec.x[k] - rec.x[k - 1]) / rec.sample_time);
  }
  return std::min(kUsual, kShare * top);
}

FitRows gather_rows(const std::vector<log::Record>& records, const LeastSquaresAOptions& options) {
  FitRows out;
  const double T = out.T = records.front().sample_time;
  const double dead_band = out.dead_band = dead_band_of(records, options);
  std::size_t count[2] = {0, 0};
  for (std::size_t r = 0; r < records.size(); ++r) {
    const log::Record& rec = records[r];
    const auto wrong = log::problems(rec);
    if (!wrong.empty()) throw Refused(wrong.front());
    if (std::abs(rec.sample_time - T) > 1e-9 * T) {
      throw Refused(rec.source + ": sample time differs from that of " + records.front().source +
                    "; identify them apart");
    }
    for (std::size_t k = 1; k + 1 < rec.x.size(); ++k) {
      if (!rec.skip.empty() && rec.skip[k] != 0) continue;
      const double w = (rec.x[k] - rec.x[k - 1]) / T;
      const double next = (rec.x[k + 1] - rec.x[k]) / T;
      const Vector2d phi(w, rec.f[k]);
      out.simple_normal += phi * phi.transpose();
      out.simple_right += phi * next;
      if (std::abs(w) <= dead_band || std::abs(next) <= dead_band || w * next < 0.0) continue;
      const int side = w > 0.0 ? 0 : 1;
      ++count[side];
      out.fastest[side] = std::max(out.fastest[side], std::abs(w));
      out.rows.push_back(
          {static_cast<int>(r), k, next,
           Vector4d(w, 0.5 * (rec.f[k - 1] + rec.f[k]), side == 0 ? -1.0 : 0.0, side == 1 ? -1.0 : 0.0)});
    }
  }
  for (int side = 0; side < 2; ++side) {
    if (count[side] < kFewestFitRows) {
      throw Refused("least squares A: " + std::to_string(count[side]) + " rows of " +
                    (side == 0 ? "positive" : "negative") +
                    " motion beyond the dead band, expected at least " + std::to_string(kFewestFitRows) +
                    "; stronger or more pulses are needed");
    }
  }
  return out;
}

struct Solution {
  Vector4d theta;
  Matrix4d inverse;
};

/// Columns differ by many orders of magnitude, so each is scaled to length one.
Solution solve(const std::vector<FitRow>& rows) {
  Matrix4d normal = Matrix4d::Zero();
  Vector4d right = Vector4d::Zero();
  for (const FitRow& row : rows) {
    normal += row.phi * row.phi.transpose();
    right += row.phi * row.next;
  }
  const Vector4d scale = normal.diagonal().cwiseSqrt().cwiseInverse();
  const Matrix4d scaled = scale.asDiagonal() * normal * scale.asDiagonal();
  const Matrix4d inverse =
      scale.asDiagonal() * Matrix4d(scaled.ldlt().solve(Matrix4d::Identity())) * scale.asDiagonal();
  Vector4d theta = inverse * right;
  // One step of iterative refinement, because 1 − θ1 is a small difference.
  Vector4d correction = Vector4d::Zero();
  for (const FitRow& row : rows) correction += row.phi * (row.next - row.phi.dot(theta));
  theta += inverse * correction;
  if (!(theta(1) > 0.0) || !(theta(0) > 0.0)) {
    throw Refused(
        "least squares A: force and motion do not fit together (negative mass); check the sign of the force");
  }
  return {theta, inverse};
}

stats::Uncertainty uncertainty_of(const std::vector<FitRow>& rows, const Solution& s) {
  Eigen::MatrixXd X(static_cast<Eigen::Index>(rows.size()), 4);
  VectorXd e(X.rows());
  std::vector<int> record;
  std::vector<std::size_t> at;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    X.row(k) = rows[i].phi.transpose();
    e(k) = rows[i].next - rows[i].phi.dot(s.theta);
    record.push_back(rows[i].record);
    at.push_back(rows[i].at);
  }
  return {X, e, s.inverse, record, at};
}

/// Derivatives of (m exact, α2, α0⁺, α0⁻) with respect to θ.
Matrix4d derivatives(const LeastSquaresA& out, const Vector4d& theta, double T) {
  const double loss = 1.0 - theta(0);
  Matrix4d d = Matrix4d::Zero();
  const double log_pole = std::log(theta(0));
  d(0, 0) = std::abs(loss) < 1e-12
                ? 0.0
                : T / theta(1) * (1.0 / log_pole + loss / (theta(0) * log_pole * log_pole));
  d(0, 1) = -out.mass_exact / theta(1);
  d(1, 0) = -1.0 / theta(1);
  d(1, 1) = -out.alpha2 / theta(1);
  d(2, 1) = -out.alpha0_positive / theta(1);
  d(2, 2) = 1.0 / theta(1);
  d(3, 1) = -out.alpha0_negative / theta(1);
  d(3, 3) = 1.0 / theta(1);
  return d;
}

/// Mass, Coulomb and viscous friction from θ.
LeastSquaresA parameters_of(const FitRows& rows, const Vector4d& theta) {
  const double T = rows.T;
  LeastSquaresA out;
  out.dead_band = rows.dead_band;
  for (int i = 0; i < 4; ++i) out.theta[static_cast<std::size_t>(i)] = theta(i);
  out.alpha2 = (1.0 - theta(0)) / theta(1);
  out.alpha0_positive = theta(2) / theta(1);
  out.alpha0_negative = theta(3) / theta(1);
  out.mass_euler = T / theta(1);
  // (1 − θ1)/(−ln θ1) → 1 as θ1 → 1.
  const double loss = 1.0 - theta(0);
  out.mass_exact = out.mass_euler * (std::abs(loss) < 1e-12 ? 1.0 : loss / -std::log1p(-loss));
  const Vector2d simple = rows.simple_normal.ldlt().solve(rows.simple_right);
  out.simple_mass = T / simple(1);
  out.simple_alpha2 = (1.0 - simple(0)) / simple(1);
  return out;
}

/// Pulses that bend the bristles alone look like a heavy axis that friction drives.
void refuse_axis_that_springs_back(const stats::Uncertainty& uncertainty, const Matrix4d& d,
                                   const LeastSquaresA& out, const Shown& shown) {
  const double coulomb = 0.5 * (out.alpha0_positive - out.alpha0_negative);
  const double half = uncertainty.half_width(0.5 * (d.row(2) - d.row(3)).transpose());
  const bool no_mass = uncertainty.half_width(d.row(0).transpose()) > out.mass_exact;
  if (coulomb + half < 0.0 || (coulomb < 0.0 && no_mass)) {
    throw Refused(
        "least squares A: the Coulomb force came out as " + shown.force(coulomb) +
        ", expected above zero; the axis hardly slides and springs back: stronger pulses are needed");
  }
}

void write_parameters(const FitRows& rows, const stats::Uncertainty& uncertainty, const Matrix4d& d,
                      LeastSquaresA& out) {
  Result& r = out.result;
  r.method = Method::kLeastSquaresA;
  r.rows = rows.rows.size();
  r.mass = out.mass_exact;
  r.velocity_range = {-rows.fastest[1], rows.fastest[0]};
  auto add = [&](const char* name, double value, const char* unit, const char* shown, int i) {
    const double half = uncertainty.half_width(d.row(i).transpose());
    r.parameters.push_back({name, value, unit, shown, value - half, value + half, half < std::abs(value)});
  };
  add("mass", out.mass_exact, "kg", "N s2/mm", 0);
  add("alpha2", out.alpha2, "N s/m", "N s/mm", 1);
  add("alpha0_positive", out.alpha0_positive, "N", "N", 2);
  add("alpha0_negative", out.alpha0_negative, "N", "N", 3);
  r.mass_interval = {r.parameters[0].ci_low, r.parameters[0].ci_high};
  r.set_steady(SteadyModel::kConventional);
  friction::Gaussian<double> map;  // no terms: Coulomb and viscous friction, separate for each direction
  map.velocity_range = r.velocity_range;
  map.positive.eta0 = out.alpha0_positive;
  map.negative.eta0 = out.alpha0_negative;
  map.positive.eta1 = map.negative.eta1 = out.alpha2;
  r.friction.steady = map;
  if (!(out.alpha0_positive > 0.0 && out.alpha0_negative < 0.0)) {
    r.warnings.push_back(
        "the Coulomb friction found drives the motion instead of opposing it: Coulomb and viscous friction do not describe these pulses");
  }
}

void write_curve(const FitRows& rows, const LeastSquaresAOptions& options,
                 const stats::Uncertainty& uncertainty, const Matrix4d& d, LeastSquaresA& out) {
  Result& r = out.result;
  for (int side = 1; side >= 0; --side) {
    const double direction = side == 0 ? 1.0 : -1.0;
    for (int i = 0; i < options.curve_points; ++i) {
      const int n = side == 0 ? i : options.curve_points - 1 - i;
      const double v = direction * (rows.dead_band +
                                    (rows.fastest[side] - rows.dead_band) * n / (options.curve_points - 1));
      Vector4d g(0.0, v, side == 0 ? 1.0 : 0.0, side == 1 ? 1.0 : 0.0);
      const double f = out.alpha2 * v + (side == 0 ? out.alpha0_positive : out.alpha0_negative);
      const double half = uncertainty.half_width(d.transpose() * g);
      r.curve.push_back({v, f, f - half, f + half});
    }
  }
  const std::size_t step = std::max<std::size_t>(1, rows.rows.size() / 1200);
  for (std::size_t i = 0; i < rows.rows.size(); i += step) {
    const FitRow& row = rows.rows[i];
    r.map.push_back({0.5 * (row.phi(0) + row.next), row.phi(1) - r.mass * (row.next - row.phi(0)) / rows.T,
                     row.phi(0) > 0 ? 1 : -1});
  }
}

}  // namespace

LeastSquaresA identify_least_squares_a(const std::vector<log::Record>& records,
                                       const LeastSquaresAOptions& options) {
  if (records.empty()) throw Refused("least squares A: no record given");
  const FitRows rows = gather_rows(records, options);
  const Solution solution = solve(rows.rows);
  const stats::Uncertainty uncertainty = uncertainty_of(rows.rows, solution);
  LeastSquaresA out = parameters_of(rows, solution.theta);
  const Matrix4d d = derivatives(out, solution.theta, rows.T);
  refuse_axis_that_springs_back(uncertainty, d, out, Shown(records.front()));
  write_parameters(rows, uncertainty, d, out);
  out.result.force_unit = records.front().force_unit;
  out.result.position_unit = records.front().position_unit;
  write_curve(rows, options, uncertainty, d, out);
  return out;
}

}  // namespace stribeck::ident::methods
