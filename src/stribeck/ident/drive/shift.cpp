#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <stribeck/ident/drive/reversals/around_reversals.hpp>
#include <stribeck/ident/drive/shift.hpp>
#include <stribeck/ident/stats/linear.hpp>
#include <stribeck/ident/stats/uncertainty.hpp>

namespace stribeck::ident::drive {
namespace {

constexpr double kWorthwhileShift = 1.02;  // ratio of the sums of squares: 1 % of the residual
constexpr double kPlainShift = 1.1;

double dot(const std::vector<double>& x, const std::vector<double>& y) {
  return std::inner_product(x.begin(), x.end(), y.begin(), 0.0);
}

/// Subtracts the mean of each bin of speed from columns over a sample of the rows.
class Centring {
 public:
  Centring(const Rows& rows, const std::vector<std::size_t>& used) : rows_(rows), used_(used) {
    for (std::size_t s = 0; s < map::kSides; ++s)
      count_[s].assign(static_cast<std::size_t>(rows.grid[s].bins), 0.0);
    for (const std::size_t i : used) count_[rows.side[i]][static_cast<std::size_t>(rows.bin[i])] += 1.0;
  }

  [[nodiscard]] std::vector<double> operator()(std::vector<double> column) const {
    std::array<std::vector<double>, map::kSides> sum;
    for (std::size_t s = 0; s < map::kSides; ++s) sum[s].assign(count_[s].size(), 0.0);
    for (std::size_t j = 0; j < used_.size(); ++j)
      sum[rows_.side[used_[j]]][static_cast<std::size_t>(rows_.bin[used_[j]])] += column[j];
    for (std::size_t j = 0; j < used_.size(); ++j) {
      const std::size_t s = rows_.side[used_[j]];
      const auto b = static_cast<std::size_t>(rows_.bin[used_[j]]);
      column[j] -= sum[s][b] / count_[s][b];
    }
    return column;
  }

 private:
  const Rows& rows_;
  const std::vector<std::size_t>& used_;
  std::array<std::vector<double>, map::kSides> count_;
};

/// Residual as a function of the shift. The force between two rows is interpolated linearly, so that products of whole rows
/// suffice.
class ShiftCost {
 public:
  ShiftCost(const AlignedLog& log, const Rows& rows, double reach)
      : lowest_(-static_cast<std::ptrdiff_t>(reach) - 2) {
    const std::vector<std::size_t> used = sample(rows);
    const Centring centred(rows, used);
    std::vector<double> a(used.size()), v(used.size());
    for (std::size_t j = 0; j < used.size(); ++j) {
      const std::size_t i = used[j];
      a[j] = motion_of(log, rows, i).a[rows.at[i]];
      v[j] = velocity_of(log, rows, i);
    }
    a = centred(std::move(a));
    v = centred(std::move(v));  // remove the slope within a bin
    vv_ = dot(v, v);
    const double va = dot(v, a) / vv_;
    for (std::size_t j = 0; j < used.size(); ++j) a[j] -= va * v[j];
    aa_ = dot(a, a);
    std::vector<double> before;
    for (std::ptrdiff_t late = lowest_; late <= static_cast<std::ptrdiff_t>(reach) + 2; ++late) {
      std::vector<double> f(used.size());
      for (std::size_t j = 0; j < used.size(); ++j) {
        const std::size_t i = used[j];
        const std::vector<double>& raw = log.force[static_cast<std::size_t>(rows.record[i])];
        const auto at = static_cast<std::ptrdiff_t>(rows.at[i]) + late;
        f[j] = raw[static_cast<std::size_t>(
            std::clamp<std::ptrdiff_t>(at, 0, static_cast<std::ptrdiff_t>(raw.size()) - 1))];
      }
      f = centred(std::move(f));
      if (!products_.empty()) products_.back().next = dot(before, f);
      products_.push_back({dot(f, f), 0.0, dot(a, f), dot(v, f)});
      before = std::move(f);
    }
  }

  /// Σ residual² at a shift [N²].
  [[nodiscard]] double operator()(double shift, const std::optional<double>& mass) const {
    const double whole = std::floor(shift);
    const double part = shift - whole;
    const auto at = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(whole) - lowest_);
    const Whole &p = products_[at], &n = products_[at + 1];
    const double left = 1.0 - part;
    const double ff = left * left * p.ff + 2.0 * left * part * p.next + part * part * n.ff;
    const double af = left * p.af + part * n.af;
    const double vf = left * p.vf + part * n.vf;
    const double total = ff - vf * vf / vv_;
    return mass ? total - 2.0 * *mass * af + *mass * *mass * aa_ : total - af * af / aa_;
  }
  [[nodiscard]] bool tells() const noexcept { return vv_ > 0.0 && aa_ > 0.0; }

 private:
  struct Whole {
    double ff = 0.0, next = 0.0, af = 0.0, vf = 0.0;  // next: with the row after
  };
  std::ptrdiff_t lowest_;
  double vv_ = 0.0, aa_ = 0.0;
  std::vector<Whole> products_;
};

/// Σ residual² with friction of every bin free [N²].
double squares_left(const AlignedLog& log, const Rows& rows, const Terms& terms, const LinearFit& fit) {
  std::vector<double> columns(terms.count() + 1);
  double sum = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double e = residual_of(log, rows, terms, fit, i, columns);
    sum += e * e;
  }
  return sum;
}

}  // namespace

std::optional<double> find_shift(const AlignedLog& log, const Rows& rows,
                                 const std::optional<double>& known_mass) {
  const double reach = most_shift(log.records.front().sample_time);
  const ShiftCost cost(log, rows, reach);
  double best = kHeldForce;
  double least = cost(best, known_mass);
  for (double s = -reach - 0.5; s <= reach; s += 0.5) {
    const double c = cost(s, known_mass);
    if (c < least) least = c, best = s;
  }
  for (double half = 0.25; half > 1e-3; half *= 0.5) {
    for (const double s : {best - half, best + half}) {
      const double c = cost(s, known_mass);
      if (c < least) least = c, best = s;
    }
  }
  if (best <= -reach || best >= reach - 0.25 || !cost.tells()) return std::nullopt;
  return best;
}

double asked_force(const AlignedLog& log, const Terms& terms, const LinearFit& fit, std::size_t record,
                   std::size_t row) {
  const double v = log.predicted[record][row];
  const std::size_t s = v > 0.0 ? 0 : 1;
  double force =
      fit.mass * log.motions[record].instrument[row] + map::kDirection[s] * fit.curve[s](std::abs(v));
  auto j = static_cast<Index>(terms.first_periodic());
  for (const PeriodicColumns& p : terms.periodic) {
    const double d = p.form == friction::EccentricForm::kProportional ? map::kDirection[s] : 1.0;
    force += d * (fit.value(j) * p.sine[record][row] + fit.value(j + 1) * p.cosine[record][row]);
    j += 2;
  }
  return force;
}

void ask_reference(const AlignedLog& log, Rows& rows, const Terms& terms, const LinearFit& fit) {
  rows.asked_change.assign(rows.size(), 0.0);
  // Neighbouring rows contain the same values in their differences.
  std::size_t behind = 0;
  std::array<double, 3> f{};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto r = static_cast<std::size_t>(rows.record[i]);
    const std::vector<double>& v = log.predicted[r];
    const std::size_t k = rows.at[i];
    if (v.empty() || k < 2 || k + 2 >= v.size()) continue;
    const auto at = [&](std::size_t row) { return asked_force(log, terms, fit, r, row); };
    const bool next =
        i > 0 && i == behind + 1 && rows.record[i - 1] == rows.record[i] && rows.at[i - 1] + 1 == k;
    f = next ? std::array{f[1], f[2], at(k + 1)} : std::array{at(k - 1), at(k), at(k + 1)};
    behind = i;
    rows.asked_change[i] = 0.5 * (f[2] - f[0]);
  }
}

LinearFit refine_shift(AlignedLog& log, Rows& rows, const Terms& terms, LinearFit fit) {
  constexpr int kSteps = 6;
  for (int i = 0; i < kSteps; ++i) {
    ask_reference(log, rows, terms, fit);
    fit = solve(log, rows, terms, &fit);
    const double step = std::clamp(fit.value(fit.value.size() - 1), -1.0, 1.0);
    align(log, log.shift - step, rows);
    if (std::abs(step) < 1e-3) break;
  }
  ask_reference(log, rows, terms, fit);
  return solve(log, rows, terms, &fit);
}

namespace {

/// The shift that leaves least, on whole rows and then finer.
template <class Left>
void search(double reach, const Left& left, Reversed& out) {
  constexpr double kStep = 4.0, kLeastStep = 0.1;  // [rows]
  const auto take_better = [&](double shift) {
    if (std::abs(shift) > reach) return;
    const double squares = left(shift);
    if (squares < out.least) out.shift = shift, out.least = squares;
  };
  for (double shift = -kStep * std::floor(reach / kStep); shift <= reach; shift += kStep) take_better(shift);
  for (double step = 0.5 * kStep; step > kLeastStep; step *= 0.5) {
    const double at = out.shift;
    take_better(at - step);
    take_better(at + step);
  }
  // A shift at the border of the search is none.
  if (std::abs(out.shift) > reach - 0.25) out.shift = kHeldForce, out.least = out.of_held;
}

}  // namespace

Told ask_reversals(AlignedLog& log, const Rows& rows, Terms terms, const LinearFit& fit, double found) {
  const double before = log.shift;
  terms.shift = false;
  const double reach = most_shift(log.records.front().sample_time);
  const AroundReversals reversals(log);
  std::map<double, AroundReversals::Left> known;
  const auto left = [&](double shift) {
    const auto old = known.find(shift);
    if (old != known.end()) return old->second;
    align(log, shift, rows);
    return known[shift] = reversals.left(log, solve(log, rows, terms, &fit), shift);
  };
  const AroundReversals::Left of_found = left(found), of_held = left(kHeldForce);
  Told told;
  told.found = found;
  told.friction = of_held.friction;
  told.simple = {kHeldForce, of_held.simple, of_found.simple, of_held.simple};
  told.mixed = {kHeldForce, of_held.mixed, of_found.mixed, of_held.mixed};
  if (std::isfinite(of_held.simple)) {
    search(
        reach, [&](double shift) { return left(shift).simple; }, told.simple);
    search(
        reach, [&](double shift) { return left(shift).mixed; }, told.mixed);
    align(log, told.simple.shift, rows);
    told.of_sliding = squares_left(log, rows, terms, solve(log, rows, terms, &fit)) /
                      static_cast<double>(std::max<std::size_t>(1, rows.size()));
  }
  align(log, before, rows);
  return told;
}

LinearFit judge_shift(AlignedLog& log, Rows& rows, Terms& terms, LinearFit fit) {
  double half_width = 0.0;
  double gain = 1.0;
  bool told = false, supported = false;
  double found = log.shift;
  LinearFit refined;
  if (terms.shift) {
    refined = refine_shift(log, rows, terms, std::move(fit));
    fit = refined;
    found = log.shift;
    half_width = shift_half_width(log, rows, terms, fit);
    told = half_width < 2.0 && std::abs(found) < longest_rows(log.records.front().sample_time);
    const double with = squares_left(log, rows, terms, fit);
    terms.shift = false;
    align(log, log.held, rows);
    fit = solve(log, rows, terms, &fit);
    const double without = squares_left(log, rows, terms, fit);
    gain = without / std::max(with, 1e-300);
    const AroundReversals reversals(log);
    const AroundReversals::Left of_found = reversals.left(log, refined, found),
                                of_held = reversals.left(log, fit, log.held);
    const auto n = static_cast<double>(std::max<std::size_t>(1, rows.size()));
    const double small = std::pow(of_held.friction, 2.0) * kOfFriction;
    supported = of_held.simple > kMuchMoreLeft * of_found.simple &&
                of_held.mixed > kMuchMoreLeft * of_found.mixed &&
                of_found.simple < std::min(small, kMostLeft * with / n);
    const bool refuted = of_found.simple > kMuchMoreLeft * of_held.simple &&
                         of_found.mixed > kMuchMoreLeft * of_held.mixed &&
                         of_held.simple < std::min(small, kMostLeft * without / n);
    told = told && !(refuted && std::abs(found - log.held) > kNearShift);
  }
  // A shift that does not reduce the residual of the force is not believed. One that reduces it much needs no further evidence: its
  // half width follows from the residual, whose correlation is longer than that of the motion.
  const double away = std::abs(found - log.held);
  const bool seen = gain > kWorthwhileShift && away > std::max(1.5 * half_width, 0.02);
  const bool plain = gain > kPlainShift && away > std::max(0.5 * half_width, 0.02);
  if (told && (seen || plain || (supported && away > std::max(0.5 * half_width, 0.02)))) {
    // With a shift of many rows the fit of a held force is far off; the reference must not be asked by it.
    terms.shift = true;
    align(log, found, rows);
    ask_reference(log, rows, terms, refined);
    return solve(log, rows, terms, &refined);
  }
  align(log, log.held, rows);
  fit = solve(log, rows, terms, &fit);
  return solve(log, rows, terms, &fit);
}

double shift_half_width(const AlignedLog& log, const Rows& rows, const Terms& terms, const LinearFit& fit) {
  const std::vector<std::size_t> used = sample(rows);
  const std::size_t q = terms.count();
  const auto n = static_cast<Index>(used.size());
  MatrixXd X(n, static_cast<Index>(q)), Z(n, static_cast<Index>(q));
  VectorXd e(n);
  std::vector<int> record(used.size());
  std::vector<std::size_t> at(used.size());
  std::vector<double> c(q + 1);
  for (std::size_t j = 0; j < used.size(); ++j) {
    const auto k = static_cast<Index>(j);
    const std::size_t i = used[j];
    const BinSums t = fit.sums.of(rows.side[i], static_cast<std::size_t>(rows.bin[i]));
    e(k) = residual_of(log, rows, terms, fit, i, c);
    for (std::size_t col = 0; col < q; ++col)
      X(k, static_cast<Index>(col)) = c[col] - t.column(col) / t.rows();
    Z.row(k) = X.row(k);
    Z(k, static_cast<Index>(q) - 1) =
        shift_instrument(log, rows, i, c[q - 1]) - t.shift_instrument() / t.rows();
    record[j] = rows.record[i];
    at[j] = rows.at[i];
  }
  const std::optional<MatrixXd> inverse = stats::inverse_if_regular(Z.transpose() * X);
  if (!inverse) return std::numeric_limits<double>::infinity();
  return stats::Uncertainty(Z, e, *inverse, record, at)
      .half_width(VectorXd::Unit(static_cast<Index>(q), static_cast<Index>(q) - 1));
}

std::optional<double> delay_of(double shift, double half, double sample_time, double hold) {
  constexpr double kRounding = 1e-9;  // rows
  const double delay = -shift * sample_time - 0.5 * hold;
  if (delay < -std::max(kRounding, half) * sample_time) return {};
  return std::max(0.0, delay);
}

}  // namespace stribeck::ident::drive
