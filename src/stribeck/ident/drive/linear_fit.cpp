#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <stribeck/ident/drive/linear_fit.hpp>
#include <stribeck/ident/stats/linear.hpp>

namespace stribeck::ident::drive {
namespace {

/// Squared correlation of instrument and acceleration below which the instrument is not used.
constexpr double kWeakInstrument = 0.1;

Sums sum_up(const AlignedLog& log, const Rows& rows, const Terms& terms, const LinearFit* before,
            bool with_instrument) {
  Sums out;
  const SumsLayout& at = out.layout = {terms.count()};
  const std::size_t width = at.columns();
  const auto W = static_cast<Index>(width);
  out.blocks = rows.blocks;
  for (std::size_t s = 0; s < map::kSides; ++s) {
    out.bins[s] = static_cast<std::size_t>(rows.grid[s].bins);
    out.by_block[s].assign(out.blocks * out.bins[s] * at.size(), 0.0);
    out.total[s].assign(out.bins[s] * at.size(), 0.0);
  }
  std::vector<MatrixXd> lower(out.blocks, MatrixXd::Zero(W, W));
  std::vector<double> row(width);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::size_t s = rows.side[i];
    const double f = terms.fill(log, rows, i, row.data());
    const double speed = std::abs(velocity_of(log, rows, i));
    row[at.force()] = f;
    row[at.force_beside_curve()] =
        f - (before != nullptr ? map::kDirection[s] * before->curve[s](speed) : 0.0);
    row[at.mass_instrument()] = at.terms == 0     ? 0.0
                                : with_instrument ? mass_instrument(log, rows, *before, i)
                                                  : row[0];
    row[at.shift_instrument()] = terms.shift ? shift_instrument(log, rows, i, row[at.terms - 1]) : 0.0;
    MatrixXd& c = lower[rows.block[i]];
    for (std::size_t a = 0; a < width; ++a) {
      for (std::size_t b = 0; b <= a; ++b) c(static_cast<Index>(a), static_cast<Index>(b)) += row[a] * row[b];
    }
    const auto bin = static_cast<std::size_t>(rows.bin[i]);
    double* sum = &out.by_block[s][(rows.block[i] * out.bins[s] + bin) * at.size()];
    for (std::size_t a = 0; a < width; ++a) sum[a] += row[a];
    sum[at.rows()] += 1.0;
    sum[at.speed()] += speed;
  }
  for (const MatrixXd& c : lower) out.products.emplace_back(c.selfadjointView<Eigen::Lower>());
  for (std::size_t s = 0; s < map::kSides; ++s) {
    const std::size_t size = out.total[s].size();
    for (std::size_t k = 0; k < out.blocks; ++k) {
      for (std::size_t j = 0; j < size; ++j) out.total[s][j] += out.by_block[s][k * size + j];
    }
  }
  return out;
}

/// Products of deviations from the mean of each bin over all blocks, for each block.
std::vector<MatrixXd> about_the_means(const Sums& sums) {
  const std::size_t width = sums.layout.columns();
  std::vector<MatrixXd> out;
  for (std::size_t k = 0; k < sums.blocks; ++k) {
    MatrixXd c = sums.products[k];
    for (std::size_t s = 0; s < map::kSides; ++s) {
      for (std::size_t b = 0; b < sums.bins[s]; ++b) {
        const BinSums all = sums.of(s, b);
        const BinSums own = sums.of(s, k, b);
        if (all.rows() <= 0.0 || own.rows() <= 0.0) continue;
        const auto sum = own.first(width);
        const VectorXd mean = all.first(width) / all.rows();
        c += -sum * mean.transpose() - mean * sum.transpose() + own.rows() * mean * mean.transpose();
      }
    }
    out.push_back(std::move(c));
  }
  return out;
}

/// θ from products about the means; each column is multiplied by its multiplier.
VectorXd solved(const MatrixXd& c, const SumsLayout& at, const std::vector<std::size_t>& multiplier) {
  const auto q = static_cast<Index>(at.terms);
  if (q == 0) return {};
  MatrixXd a(q, q);
  VectorXd b(q);
  for (Index i = 0; i < q; ++i) {
    const auto by = static_cast<Index>(multiplier[static_cast<std::size_t>(i)]);
    a.row(i) = c.row(by).head(q);
    b(i) = c(by, static_cast<Index>(at.force_beside_curve()));
  }
  // The columns differ much in size.
  const VectorXd scale = c.diagonal().head(q).cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  MatrixXd scaled = a * scale.asDiagonal();
  for (Index i = 0; i < q; ++i) {
    const double size = scaled.row(i).norm();
    if (size > 0.0) scaled.row(i) /= size, b(i) /= size;
  }
  return scale.asDiagonal() * stats::solve_full_lu(scaled, b);
}

std::vector<std::size_t> multipliers(const Terms& terms, const SumsLayout& at, bool with_instrument) {
  std::vector<std::size_t> by(at.terms);
  for (std::size_t j = 0; j < by.size(); ++j) by[j] = j;
  if (with_instrument) by.front() = at.mass_instrument();
  if (terms.shift) by.back() = at.shift_instrument();
  return by;
}

/// Friction over the bins after the linear terms are subtracted.
std::array<map::BinCurve, map::kSides> curves(const Sums& sums, const Rows& rows, const VectorXd& value) {
  std::array<map::BinCurve, map::kSides> out;
  for (std::size_t s = 0; s < map::kSides; ++s) {
    std::vector<double> count(sums.bins[s]), speed(sums.bins[s]), force(sums.bins[s]);
    for (std::size_t b = 0; b < sums.bins[s]; ++b) {
      const BinSums t = sums.of(s, b);
      count[b] = t.rows();
      speed[b] = t.speed();
      double f = t.force();
      for (std::size_t j = 0; j < sums.layout.terms; ++j) f -= value(static_cast<Index>(j)) * t.column(j);
      force[b] = map::kDirection[s] * f;
    }
    out[s].build(rows.grid[s], count, speed, force);
  }
  return out;
}

/// A load that is large beside friction: without it one direction would drive the motion.
double load_of(const std::array<map::BinCurve, map::kSides>& curve) {
  const double forward = curve[0].line().level, back = curve[1].line().level;
  const double mean_level = 0.5 * (forward + back);
  return std::min(forward, back) < 0.2 * std::abs(mean_level) ? 0.5 * (forward - back) : 0.0;
}

}  // namespace

double Terms::fill(const AlignedLog& log, const Rows& rows, std::size_t i, double* c) const {
  const log::Motion& m = motion_of(log, rows, i);
  const std::size_t k = rows.at[i];
  double f = m.f[k] - rows.lag[i];
  if (known_mass) {
    f -= *known_mass * m.a[k];
  } else {
    *c++ = m.a[k];
  }
  const auto r = static_cast<std::size_t>(rows.record[i]);
  for (const PeriodicColumns& p : periodic) {
    const double d = p.form == friction::EccentricForm::kProportional ? map::kDirection[rows.side[i]] : 1.0;
    *c++ = d * p.sine[r][k];
    *c++ = d * p.cosine[r][k];
  }
  // Change of the whole force from row to row: the spring that was taken off has the same shift.
  if (shift)
    *c = 0.5 * (m.f[k + 1] - m.f[k - 1]) + log.records[r].spring * m.v[k] * log.records[r].sample_time;
  return f;
}

double mass_instrument(const AlignedLog& log, const Rows& rows, const LinearFit& fit, std::size_t i) {
  const log::Motion& m = motion_of(log, rows, i);
  const std::size_t k = rows.at[i];
  if (m.loop != log::Loop::kOpen) return m.instrument[k];
  const std::size_t s = rows.side[i];
  const double known = map::kDirection[s] * fit.curve[s](std::abs(m.v[k]));
  return (m.f[k] - rows.lag[i] - known) / fit.mass;
}

double shift_instrument(const AlignedLog& log, const Rows& rows, std::size_t i, double change) {
  const bool asks = !log.predicted[static_cast<std::size_t>(rows.record[i])].empty();
  return asks && !rows.asked_change.empty() ? rows.asked_change[i] : change;
}

double residual_of(const AlignedLog& log, const Rows& rows, const Terms& terms, const LinearFit& fit,
                   std::size_t i, std::vector<double>& columns) {
  const std::size_t s = rows.side[i];
  double e = terms.fill(log, rows, i, columns.data()) -
             map::kDirection[s] * fit.curve[s](std::abs(velocity_of(log, rows, i)));
  for (std::size_t j = 0; j < terms.count(); ++j) e -= fit.value(static_cast<Index>(j)) * columns[j];
  return e;
}

LinearFit solve(const AlignedLog& log, const Rows& rows, const Terms& terms, const LinearFit* before) {
  LinearFit fit;
  const SumsLayout at{terms.count()};
  const auto q = static_cast<Index>(at.terms);
  fit.mass = before != nullptr ? before->mass : terms.known_mass.value_or(0.0);
  fit.mass_by_acceleration = before != nullptr && before->mass_by_acceleration;
  bool with_instrument = before != nullptr && !terms.known_mass && !fit.mass_by_acceleration;
  std::vector<MatrixXd> blocks;
  MatrixXd all;
  const auto add_up = [&] {
    fit.sums = sum_up(log, rows, terms, before, with_instrument);
    blocks = about_the_means(fit.sums);
    all = MatrixXd::Zero(static_cast<Index>(at.columns()), static_cast<Index>(at.columns()));
    for (const MatrixXd& c : blocks) all += c;
  };
  add_up();
  const auto z = static_cast<Index>(at.mass_instrument());
  if (with_instrument && !(all(z, 0) * all(z, 0) > kWeakInstrument * all(z, z) * all(0, 0))) {
    fit.mass_by_acceleration = true;
    with_instrument = false;
    add_up();
  }
  fit.multiplier = multipliers(terms, at, with_instrument);
  fit.value = solved(all, at, fit.multiplier);
  for (const MatrixXd& c : blocks) fit.held_out.push_back(solved(all - c, at, fit.multiplier));
  fit.moments.resize(q, q);
  fit.instrument_moments.resize(q, q);
  for (Index i = 0; i < q; ++i) {
    const auto by = static_cast<Index>(fit.multiplier[static_cast<std::size_t>(i)]);
    for (Index j = 0; j < q; ++j) {
      fit.moments(i, j) = all(by, j);
      fit.instrument_moments(i, j) = all(by, static_cast<Index>(fit.multiplier[static_cast<std::size_t>(j)]));
    }
  }
  if (!terms.known_mass) {
    fit.mass = fit.value(0);
    fit.plain_mass = solved(all, at, multipliers(terms, at, false))(0);
  }
  fit.curve = curves(fit.sums, rows, fit.value);
  fit.load = load_of(fit.curve);
  return fit;
}

}  // namespace stribeck::ident::drive
