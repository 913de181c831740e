#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <stribeck/core/numbers.hpp>
#include <stribeck/ident/drive/shift.hpp>
#include <stribeck/ident/drive/smoothing/smoothing.hpp>
#include <stribeck/ident/stats/linear.hpp>

namespace stribeck::ident::drive {
namespace {

constexpr double kCertain = 4.0;     // standard errors
constexpr double kLeastGain = 2e-3;  // of the squares of the residual
constexpr double kWidest = 1.5;  // σ as a share of the delay: 1 for a filter of first order, 0.6 for a mean
constexpr double kUnseenDelay = 1.0;  // rows of delay that a log may have and not show

/// Second difference of the force that the reference asks for at each of these rows, less the mean of its bin of speed [N]; NaN where the
/// reference does not tell.
std::vector<double> asked_bend(const AlignedLog& log, const Rows& rows, const Terms& terms,
                               const LinearFit& fit, const std::vector<std::size_t>& used) {
  std::vector<double> bend(used.size(), kNaN);
  std::array<std::vector<double>, map::kSides> sum, count;
  for (std::size_t s = 0; s < map::kSides; ++s) {
    sum[s].assign(static_cast<std::size_t>(rows.grid[s].bins), 0.0);
    count[s] = sum[s];
  }
  for (std::size_t j = 0; j < used.size(); ++j) {
    const std::size_t i = used[j], k = rows.at[i];
    const auto r = static_cast<std::size_t>(rows.record[i]);
    if (!log.by_reference(r) || k < 2 || k + 2 >= log.predicted[r].size()) continue;
    const auto asked = [&](std::size_t row) { return asked_force(log, terms, fit, r, row); };
    bend[j] = asked(k + 1) - 2.0 * asked(k) + asked(k - 1);
    sum[rows.side[i]][static_cast<std::size_t>(rows.bin[i])] += bend[j];
    count[rows.side[i]][static_cast<std::size_t>(rows.bin[i])] += 1.0;
  }
  for (std::size_t j = 0; j < used.size(); ++j) {
    const std::size_t s = rows.side[used[j]];
    const auto b = static_cast<std::size_t>(rows.bin[used[j]]);
    if (count[s][b] > 0.0) bend[j] -= sum[s][b] / count[s][b];
  }
  return bend;
}

/// Columns of a row about the means of its bin, and their multipliers.
struct RowTerms {
  VectorXd column, multiplier;
};

RowTerms terms_of(const AlignedLog& log, const Rows& rows, const Terms& terms, const LinearFit& fit,
                  std::size_t i) {
  const auto q = static_cast<Index>(terms.count());
  RowTerms out{VectorXd(q), VectorXd(q)};
  terms.fill(log, rows, i, out.column.data());
  out.multiplier = out.column;
  if (fit.multiplier.front() != 0) out.multiplier(0) = mass_instrument(log, rows, fit, i);
  if (terms.shift) out.multiplier(q - 1) = shift_instrument(log, rows, i, out.column(q - 1));
  const BinSums means = fit.sums.of(rows.side[i], static_cast<std::size_t>(rows.bin[i]));
  out.column -= means.first(terms.count()) / means.rows();
  return out;
}

}  // namespace

double Smoothing::spread() const { return std::sqrt(2.0 * std::max(0.0, kappa)); }

std::optional<Smoothing> find_smoothing(const AlignedLog& log, const Rows& rows, const Terms& terms,
                                        const LinearFit& fit, const std::vector<double>& residual,
                                        double memory) {
  if (terms.count() == 0) return {};
  const std::vector<std::size_t> used = sample(rows);
  const std::vector<double> bend = asked_bend(log, rows, terms, fit, used);
  const auto q = static_cast<Index>(terms.count());
  VectorXd with_bend = VectorXd::Zero(q);
  MatrixXd moments = MatrixXd::Zero(q, q);
  for (std::size_t j = 0; j < used.size(); ++j) {
    if (!std::isfinite(bend[j])) continue;
    const RowTerms row = terms_of(log, rows, terms, fit, used[j]);
    with_bend += bend[j] * row.multiplier;
    moments += row.multiplier * row.column.transpose();
  }
  const std::optional<VectorXd> solution = stats::solve_if_regular(moments, with_bend);
  if (!solution) return {};
  Smoothing out;
  const VectorXd& per_kappa = *solution;
  double ww = 0.0, we = 0.0, ee = 0.0, n = 0.0;
  for (std::size_t j = 0; j < used.size(); ++j) {
    if (!std::isfinite(bend[j])) continue;
    const double w = bend[j] - terms_of(log, rows, terms, fit, used[j]).column.dot(per_kappa);
    const double e = residual[used[j]];
    ww += w * w, we += w * e, ee += e * e, n += 1.0;
  }
  if (!(ww > 0.0)) return {};
  out.kappa = we / ww;
  out.error = std::sqrt(2.0 * memory * ee / n / ww);
  out.moved = out.kappa * per_kappa;
  const double delay = std::max(0.0, log.shift - kHeldForce) + kUnseenDelay;
  const bool possible = out.kappa < 0.5 * std::pow(kWidest * delay, 2.0);
  const bool shows = out.kappa > kCertain * out.error && out.kappa * we > kLeastGain * ee;
  if (!possible || !shows) return {};
  return out;
}

}  // namespace stribeck::ident::drive
