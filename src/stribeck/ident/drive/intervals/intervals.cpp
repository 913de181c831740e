#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <stribeck/ident/drive/intervals/intervals.hpp>
#include <stribeck/ident/drive/shift.hpp>
#include <stribeck/ident/drive/smoothing/filter_search.hpp>
#include <stribeck/ident/stats/linear.hpp>
#include <stribeck/ident/stats/uncertainty.hpp>

namespace stribeck::ident::drive {
namespace {

constexpr double kFast = 0.2;               ///< of the top speed
constexpr std::size_t kManyRows = 300'000;  ///< more are sampled where a look is enough
// Shares of a speed: the friction of the rows within them is compared with the map, the narrow one for a knee, the wide one
// where rows are few.
constexpr double kNear = 0.05, kAround = 0.15;

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
      if (q == 0) continue;
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
    const double speed = std::abs(velocity_of(log, rows, i));
    if (rows.bin[i] < grid.slow_bins) {  // a cell would be too wide
      out[i] = e - map::kDirection[s] * map.force(static_cast<int>(s), speed);
      continue;
    }
    const double place = (speed - grid.low) / (grid.high - grid.low) * kTable;
    const int cell = std::clamp(static_cast<int>(place), 0, kTable - 1);
    const double share = place - cell;
    const auto u = static_cast<std::size_t>(cell);
    out[i] = e - map::kDirection[s] * (table[s][u] + share * (table[s][u + 1] - table[s][u]));
  }
  return out;
}

/// Sums of multiplier·residual: their long-run covariance, and each record's.
struct Scores {
  MatrixXd long_run;
  MatrixXd of_record;  ///< a column for each record
};
Scores scores_of(const AlignedLog& log, const Rows& rows, const Terms& terms, const LinearFit& fit,
                 const MapChoice& choice, const MapMoments& map, const std::vector<double>& residual,
                 const stats::Memory& memory) {
  const SumsLayout& at = fit.sums.layout;
  const std::size_t q = at.terms, p = choice.map.fit.parameters();
  stats::LongRun moments(q + p, memory);
  std::vector<double> c(q + 1);
  Scores out;
  out.of_record = MatrixXd::Zero(static_cast<Index>(q + p), static_cast<Index>(log.records.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::size_t s = rows.side[i];
    const double e = residual[i];
    double* row = moments.row(rows.record[i], rows.at[i]);
    double* of_record = out.of_record.col(rows.record[i]).data();
    terms.fill(log, rows, i, c.data());
    const BinSums t = fit.sums.of(s, static_cast<std::size_t>(rows.bin[i]));
    // When fitted together with the map, the linear terms are not centred.
    const double centre = choice.joint ? 0.0 : 1.0 / t.rows();
    for (std::size_t j = 0; j < q; ++j) {
      const std::size_t by = fit.multiplier[j];
      const double z = by == at.mass_instrument()    ? mass_instrument(log, rows, fit, i)
                       : by == at.shift_instrument() ? shift_instrument(log, rows, i, c[j])
                                                     : c[j];
      const double score = (z - t.column(by) * centre) * e;
      row[j] += score;
      of_record[j] += score;
    }
    const auto [first, count] = choice.map.fit.span(static_cast<int>(s));
    const double signed_e = map::kDirection[s] * e;
    for (std::size_t j = 0; j < count; ++j) {
      const double score = map.slope[s](rows.bin[i], static_cast<Index>(j)) * signed_e;
      row[q + first + j] += score;
      of_record[q + first + j] += score;
    }
  }
  const std::vector<double> raw = moments.covariance();
  const auto size = static_cast<Index>(q + p);
  out.long_run = Eigen::Map<const MatrixXd>(raw.data(), size, size);
  return out;
}

/// Records that differ by more than their noise says: covariance of the mean from the scores of the records.
MatrixXd between_records(const MatrixXd& of_record) {
  const auto records = static_cast<double>(of_record.cols());
  if (records < 2.0) return MatrixXd::Zero(of_record.rows(), of_record.rows());
  return records / (records - 1.0) * of_record * of_record.transpose();
}

/// Covariance of the linear terms from the fits without each block, in `size` parameters; `factor` is that of the other forms.
MatrixXd between_folds(const std::vector<VectorXd>& held_out, Index size, double factor) {
  MatrixXd out = MatrixXd::Zero(size, size);
  const auto folds = static_cast<double>(held_out.size());
  if (folds < 2.0 || held_out.front().size() == 0) return out;
  const Index Q = held_out.front().size();
  VectorXd mean = VectorXd::Zero(Q);
  for (const VectorXd& value : held_out) mean += value / folds;
  for (const VectorXd& value : held_out)
    out.topLeftCorner(Q, Q) += (folds - 1.0) / folds * (value - mean) * (value - mean).transpose();
  // The scatter of few blocks is itself uncertain.
  return out * std::pow(stats::student_factor(folds - 1.0) / factor, 2.0);
}

/// Rows above a share of the top speed of their direction.
Rows fast_rows(const AlignedLog& log, const Rows& rows) {
  std::vector<std::size_t> fast;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (std::abs(velocity_of(log, rows, i)) >= kFast * rows.grid[rows.side[i]].high) fast.push_back(i);
  }
  return picked(rows, fast);
}

/// By how much the linear terms change on the fast rows, less what noise does; the map follows.
VectorXd change_of_fast_rows(const AlignedLog& log, const Rows& used, const Terms& terms,
                             const LinearFit& found, double noise, Index size) {
  VectorXd out = VectorXd::Zero(size);
  const auto Q = static_cast<Index>(terms.count());
  if (Q == 0) return out;
  Rows rows = used.size() > kManyRows ? sampled(used) : used;
  Rows fast = fast_rows(log, rows);
  if (fast.size() < rows.size() / 4 || fast.size() == rows.size()) return out;
  if (terms.shift) {
    ask_reference(log, rows, terms, found);
    ask_reference(log, fast, terms, found);
  }
  const LinearFit part = solve(log, fast, terms, &found);
  const LinearFit all = solve(log, rows, terms, &found);
  const auto variance = [&](const LinearFit& fit) -> VectorXd {
    const MatrixXd inverse = stats::inverse_full_lu(fit.moments);
    return noise * (inverse * fit.instrument_moments * inverse.transpose()).diagonal();
  };
  const VectorXd own = variance(all), of_part = variance(part);
  for (Index j = 0; j < Q; ++j) {
    const double change = part.value(j) - all.value(j);
    const double left = change * change - std::max(0.0, of_part(j) - own(j));
    if (left > 0.0 && std::isfinite(left)) out(j) = std::copysign(std::sqrt(left), change);
  }
  return out;
}

/// Terms and fit with the column of the shift, whose value is 0.
struct WithShift {
  Terms terms;
  LinearFit fit;
  VectorXd
      moved;  ///< what the linear terms change by with the shift that the rows show in place of a held force; empty: none is seen
  double later = 0.0;  ///< that shift, from a held force on [rows]
};

WithShift with_shift(const AlignedLog& log, Rows& rows, const Terms& terms, const LinearFit& fit) {
  WithShift out;
  out.terms = terms;
  out.terms.shift = true;
  ask_reference(log, rows, terms, fit);
  out.fit = solve(log, rows, out.terms, &fit);
  const Index size = fit.value.size();
  constexpr double kSeen = 1.5;    // half widths
  constexpr double kLeast = 0.02;  // rows
  out.later = -out.fit.value(size);
  const double away = std::abs(out.later);
  if (away > kLeast && away > kSeen * shift_half_width(log, rows, out.terms, out.fit)) {
    out.moved = out.fit.value;
    out.moved.head(size) -= solve(log, rows, terms, &fit).value;
  }
  out.fit.value.head(size) = fit.value;
  out.fit.value(size) = 0.0;
  out.fit.curve = fit.curve;
  out.fit.mass = fit.mass;
  return out;
}

/// Inverse of the map's moments without the directions that the data do not determine; their shares are written to `unseen`.
MatrixXd inverse_seen(const MatrixXd& normal, std::vector<double>& unseen) {
  const VectorXd scale = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const auto [values, vectors] = stats::symmetric_eigen(scale.asDiagonal() * normal * scale.asDiagonal());
  VectorXd inverse = VectorXd::Zero(values.size());
  unseen.assign(static_cast<std::size_t>(values.size()), 0.0);
  for (Index j = 0; j < values.size(); ++j) {
    if (values(j) > 1e-9 * values.maxCoeff()) {
      inverse(j) = 1.0 / values(j);
    } else {
      for (std::size_t i = 0; i < unseen.size(); ++i)
        unseen[i] += std::pow(vectors(static_cast<Index>(i), j), 2.0);
    }
  }
  return scale.asDiagonal() * vectors * inverse.asDiagonal() * vectors.transpose() * scale.asDiagonal();
}

/// Moments whose inverse says how θ moves with the scores, and the scores' covariance under white noise of one unit.
struct Bread {
  MatrixXd moments, white;
  bool together = false;  ///< map and linear terms were fitted together

  [[nodiscard]] MatrixXd inverse(const MatrixXd& map_inverse) const;
};

Bread bread_of(const LinearFit& fit, const MapMoments& map, bool together) {
  const auto Q = static_cast<Index>(fit.sums.layout.terms), P = map.normal.rows();
  Bread out{MatrixXd::Zero(Q + P, Q + P), MatrixXd::Zero(Q + P, Q + P), together};
  out.moments.bottomRightCorner(P, P) = out.white.bottomRightCorner(P, P) = map.normal;
  out.moments.bottomLeftCorner(P, Q) = map.with_columns;
  if (!together) {
    out.moments.topLeftCorner(Q, Q) = fit.moments;
    out.white.topLeftCorner(Q, Q) = fit.instrument_moments;
    return out;
  }
  const auto W = static_cast<Index>(fit.sums.layout.columns());
  MatrixXd all = MatrixXd::Zero(W, W);
  for (const MatrixXd& block : fit.sums.products) all += block;
  for (Index i = 0; i < Q; ++i) {
    const auto zi = static_cast<Index>(fit.multiplier[static_cast<std::size_t>(i)]);
    for (Index j = 0; j < Q; ++j) {
      out.moments(i, j) = all(zi, j);
      out.white(i, j) = all(zi, static_cast<Index>(fit.multiplier[static_cast<std::size_t>(j)]));
    }
  }
  out.moments.topRightCorner(Q, P) = map.with_multipliers.transpose();
  out.white.bottomLeftCorner(P, Q) = map.with_multipliers;
  out.white.topRightCorner(Q, P) = map.with_multipliers.transpose();
  return out;
}

MatrixXd Bread::inverse(const MatrixXd& map_inverse) const {
  const Index P = map_inverse.rows(), Q = moments.rows() - P;
  if (together) {
    const VectorXd size = moments.diagonal().cwiseAbs().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    return size.asDiagonal() * stats::pseudo_inverse(size.asDiagonal() * moments * size.asDiagonal()) *
           size.asDiagonal();
  }
  // The linear terms move by their own moments, the map by its own less what the linear terms take along.
  MatrixXd out = MatrixXd::Zero(Q + P, Q + P);
  out.bottomRightCorner(P, P) = map_inverse;
  if (Q > 0) {
    const MatrixXd gain = stats::inverse_full_lu(moments.topLeftCorner(Q, Q));
    out.topLeftCorner(Q, Q) = gain;
    out.bottomLeftCorner(P, Q) = -map_inverse * moments.bottomLeftCorner(P, Q) * gain;
  }
  return out;
}

/// What is known of the shift before, as if it were a row more. Beside it the size of the instruments matters, and that they explain
/// only a part of the columns: the columns are replaced by what the instruments say of them, X̂ = Z·(ZᵀZ)⁻¹·ZᵀX, which changes nothing
/// without that row.
void add_prior(Index shift, double noise, Bread& bread, Scores& scores) {
  const Index Q = shift + 1;
  const MatrixXd white = bread.white.topLeftCorner(Q, Q);
  const VectorXd size = white.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const MatrixXd inverse = size.asDiagonal() *
                           stats::pseudo_inverse(size.asDiagonal() * white * size.asDiagonal()) *
                           size.asDiagonal();
  const MatrixXd to_columns = bread.moments.topLeftCorner(Q, Q).transpose() * inverse;
  const auto transform_rows = [&](MatrixXd& m) { m.topRows(Q) = (to_columns * m.topRows(Q)).eval(); };
  transform_rows(bread.moments);
  transform_rows(scores.of_record);
  for (MatrixXd* products : {&bread.white, &scores.long_run}) {
    transform_rows(*products);
    products->leftCols(Q) = (products->leftCols(Q) * to_columns.transpose()).eval();
  }
  const double precision = noise / (kDelayDeviation * kDelayDeviation);
  bread.moments(shift, shift) += precision;
  bread.white(shift, shift) += precision;
  scores.long_run(shift, shift) += noise * precision;
}

}  // namespace

Misfit::Misfit(const AlignedLog& log, const Rows& rows, const std::vector<double>& residual, double memory)
    : grid_(rows.grid), memory_(memory) {
  for (std::size_t s = 0; s < map::kSides; ++s) bins_[s].resize(static_cast<std::size_t>(grid_[s].bins));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::size_t s = rows.side[i];
    Bin& bin = bins_[s][static_cast<std::size_t>(rows.bin[i])];
    const bool goes_on = i > 0 && rows.record[i] == rows.record[i - 1] && rows.at[i] == rows.at[i - 1] + 1 &&
                         rows.side[i] == rows.side[i - 1] && rows.bin[i] == rows.bin[i - 1];
    bin.rows += 1.0;
    bin.passes += goes_on ? 0.0 : 1.0;
    bin.speed += std::abs(velocity_of(log, rows, i));
    bin.left += map::kDirection[s] * residual[i];
    variance_ += residual[i] * residual[i];
  }
  variance_ /= static_cast<double>(std::max<std::size_t>(1, rows.size()));
}

double Misfit::within(int side, double speed, double wide) const {
  const auto s = static_cast<std::size_t>(side);
  const map::Grid& grid = grid_[s];
  double weight = 0.0, sum = 0.0, square = 0.0, passes = 0.0;
  for (int b = grid.bin(speed - wide); b <= grid.bin(speed + wide); ++b) {
    const Bin& bin = bins_[s][static_cast<std::size_t>(b)];
    if (bin.rows <= 0.0) continue;
    const double w = 1.0 - std::abs(bin.speed / bin.rows - speed) / wide;
    if (w <= 0.0) continue;
    weight += w * bin.rows, sum += w * bin.left, square += w * w * bin.rows;
    passes = std::max(passes, bin.passes);
  }
  if (weight <= 0.0) return 0.0;
  // Rows of one pass carry the same noise where the pass is short.
  const double independent = std::max(passes, weight * weight / square / (2.0 * memory_));
  return std::sqrt(std::max(0.0, sum * sum / (weight * weight) - variance_ / independent));
}

double Misfit::at(int side, double speed) const {
  const double least = 1.5 * grid_[static_cast<std::size_t>(side)].width(speed);
  return std::max(within(side, speed, std::max(least, kNear * speed)),
                  within(side, speed, std::max(least, kAround * speed)));
}

double Intervals::error_of(const VectorXd& h) const {
  const double of_noise = std::max({0.0, h.dot(long_run * h), h.dot(stationary * h)});
  double of_records = std::max(0.0, h.dot(between * h));
  if (of_records > of_noise) {
    // Where they differ by far more than noise, few records tell little of how much they differ.
    constexpr double kMore = 1.5, kFarMore = 3.0;  // of the standard error by noise
    const double ratio = std::sqrt(of_records / std::max(of_noise, 1e-300));
    const double share = std::clamp((ratio - kMore) / (kFarMore - kMore), 0.0, 1.0);
    of_records *= std::pow(1.0 + share * (few_records - 1.0), 2.0);
  }
  const double variance = std::max({of_noise, of_records, h.dot(folds * h)});
  return std::hypot(std::hypot(std::sqrt(variance), h.dot(unsettled)), h.dot(filtered), h.dot(held));
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

Intervals intervals(const AlignedLog& log, const Rows& used, const Terms& narrow, const LinearFit& found,
                    const MapChoice& choice, bool shift_known) {
  const bool nuisance = !shift_known && !narrow.shift;
  Rows rows = used;
  const WithShift wide = nuisance ? with_shift(log, rows, narrow, found) : WithShift{narrow, found, {}};
  const Terms& terms = wide.terms;
  const LinearFit& fit = wide.fit;
  const MapMoments map = moments_of(choice.map.fit, rows, fit);
  Intervals out;
  out.linear = terms.count();
  out.residual = residuals(log, rows, terms, fit, choice.map.fit);
  const stats::Memory memory = stats::memory_of(out.residual, rows.record, rows.at);
  out.misfit = Misfit(log, rows, out.residual, memory.rows);
  Scores scores = scores_of(log, rows, terms, fit, choice, map, out.residual, memory);
  const MatrixXd map_inverse = inverse_seen(map.normal, out.unseen);
  double square = 0.0;
  for (const double e : out.residual) square += e * e;
  const auto n = static_cast<double>(rows.size());
  const double noise = 2.0 * memory.rows * square / n;
  Bread bread = bread_of(fit, map, choice.joint.has_value());
  const auto shift = static_cast<Index>(out.linear) - 1;
  if (nuisance) add_prior(shift, noise, bread, scores);
  const MatrixXd inverse = bread.inverse(map_inverse);
  const double independent = n / (2.0 * memory.rows);
  const double freedom = std::max(3.0, independent - static_cast<double>(scores.long_run.rows()));
  const double correction = std::max(1.0, independent / freedom);
  out.long_run = correction * inverse * scores.long_run * inverse.transpose();
  out.stationary = noise * correction * inverse * bread.white * inverse.transpose();
  out.between = inverse * between_records(scores.of_record) * inverse.transpose();
  out.factor = stats::student_factor(freedom);
  // Of two records Student's factor would be 12.7, of which nobody has use.
  constexpr double kFewestFreedoms = 2.0;
  const double between = std::max(kFewestFreedoms, static_cast<double>(log.records.size()) - 1.0);
  out.few_records = std::max(1.0, stats::student_factor(between) / out.factor);
  const Index size = out.long_run.rows();
  out.folds = choice.joint ? MatrixXd::Zero(size, size) : between_folds(found.held_out, size, out.factor);
  out.unsettled = change_of_fast_rows(log, used, narrow, found, noise, size);
  const auto Q = static_cast<Index>(out.linear);
  out.filtered = VectorXd::Zero(size);
  if (const auto& filter = log.records.front().filter) {
    const double T = log.records.front().sample_time;
    out.filtered.head(Q) =
        filter->half_width / T / out.factor * moved_by_filter(log, rows, terms, fit, filter->time / T);
  }
  out.held = VectorXd::Zero(size);
  if (wide.moved.size() > 0) {
    constexpr double kBeyond = 1.5;  // the truth lies that far off, give or take its own error
    out.untaken_shift = wide.later;
    out.held.head(Q) = kBeyond / out.factor * wide.moved;
  }
  for (VectorXd* moved : {&out.unsettled, &out.filtered, &out.held}) {
    moved->tail(size - Q) = -map_inverse * bread.moments.bottomLeftCorner(size - Q, Q) * moved->head(Q);
  }
  if (terms.shift) out.shift_error = out.error_at(static_cast<std::size_t>(shift));
  return out;
}

}  // namespace stribeck::ident::drive
