#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stribeck/ident/drive/drive_fit_parts.hpp>
#include <stribeck/ident/stats/uncertainty.hpp>

namespace stribeck::ident::drive {
namespace {

constexpr double kLongestShift = 0.03;  // [s]
constexpr double kMostShiftRows = 40.0;
constexpr double kWorthwhileShift = 1.02;  // ratio of the sums of squares: 1 % of the residual
constexpr double kPlainShift = 1.1;

}  // namespace

void DriveFit::ask() {
  asked_.assign(rows_.size(), 0.0);
  // Neighbouring rows share what they difference.
  std::size_t behind = 0;
  std::array<double, 3> f{};
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const auto r = static_cast<std::size_t>(rows_.record[i]);
    if (!asks(r)) continue;
    const std::vector<double>& v = predicted_[r];
    const std::vector<double>& a = motions_[r].instrument;
    const std::size_t k = rows_.at[i];
    if (k < 2 || k + 2 >= v.size()) continue;
    const auto at = [&](std::size_t row) {
      const std::size_t s = v[row] > 0.0 ? 0 : 1;
      return mass_ * a[row] + map::kDirection[s] * line_[s](std::abs(v[row]));
    };
    const bool next =
        i > 0 && i == behind + 1 && rows_.record[i - 1] == rows_.record[i] && rows_.at[i - 1] + 1 == k;
    f = next ? std::array{f[1], f[2], at(k + 1)} : std::array{at(k - 1), at(k), at(k + 1)};
    behind = i;
    asked_[i] = 0.5 * (f[2] - f[0]);
  }
}

void DriveFit::align(double shift) {
  shift_ = shift;
  if (!thin_) {
    for (std::size_t r = 0; r < motions_.size(); ++r)
      log::align_force(force_[r], shift_, 0, force_[r].size(), motions_[r].f);
  } else {
    for (std::size_t i = 0; i < rows_.size();) {
      // A run of consecutive rows and its neighbours.
      std::size_t last = i;
      while (last + 1 < rows_.size() && rows_.record[last + 1] == rows_.record[i] &&
             rows_.at[last + 1] == rows_.at[last] + 1)
        ++last;
      const auto r = static_cast<std::size_t>(rows_.record[i]);
      const std::size_t from = rows_.at[i] > 0 ? rows_.at[i] - 1 : 0;
      log::align_force(force_[r], shift_, from, std::min(force_[r].size(), rows_.at[last] + 2),
                       motions_[r].f);
      i = last + 1;
    }
  }
  for (log::Motion& m : motions_) {
    if (m.loop == log::Loop::kOpen) m.instrument = m.f;
  }
}

void DriveFit::find_shift() {
  const double T = records_.front().sample_time;
  for (const log::Record& r : records_) {
    if (std::abs(r.sample_time - T) > 0.01 * T) {
      warn("records of different sample times: the shift of the force is not estimated");
      return;
    }
  }
  const std::vector<std::size_t> rows = sample();
  std::array<std::vector<double>, map::kSides> count;
  for (std::size_t s = 0; s < map::kSides; ++s) count[s].assign(static_cast<std::size_t>(grid_[s].bins), 0.0);
  for (const std::size_t i : rows) count[rows_.side[i]][static_cast<std::size_t>(rows_.bin[i])] += 1.0;
  const auto centred = [&](std::vector<double> column) {
    std::array<std::vector<double>, map::kSides> sum;
    for (std::size_t s = 0; s < map::kSides; ++s) sum[s].assign(count[s].size(), 0.0);
    for (std::size_t j = 0; j < rows.size(); ++j)
      sum[rows_.side[rows[j]]][static_cast<std::size_t>(rows_.bin[rows[j]])] += column[j];
    for (std::size_t j = 0; j < rows.size(); ++j) {
      const std::size_t s = rows_.side[rows[j]];
      const auto b = static_cast<std::size_t>(rows_.bin[rows[j]]);
      column[j] -= sum[s][b] / count[s][b];
    }
    return column;
  };
  std::vector<double> a(rows.size()), v(rows.size()), known(rows.size());
  for (std::size_t j = 0; j < rows.size(); ++j) {
    const std::size_t i = rows[j];
    a[j] = motion(i).a[rows_.at[i]];
    v[j] = velocity(i);
  }
  a = centred(std::move(a));
  v = centred(std::move(v));  // slope within a bin
  const auto dot = [](const std::vector<double>& x, const std::vector<double>& y) {
    return std::inner_product(x.begin(), x.end(), y.begin(), 0.0);
  };
  const double vv = dot(v, v);
  const double va = dot(v, a) / vv;
  for (std::size_t j = 0; j < rows.size(); ++j) a[j] -= va * v[j];
  const double aa = dot(a, a);
  // The force at a fraction of a row is a straight line between two whole ones: products of whole rows do.
  struct Whole {
    double ff = 0.0, next = 0.0, af = 0.0, vf = 0.0;  // next: with the row after
  };
  const double reach = std::min(kMostShiftRows, std::max(3.0, std::ceil(kLongestShift / T)));
  const auto lowest = -static_cast<std::ptrdiff_t>(reach) - 2;
  const auto highest = static_cast<std::ptrdiff_t>(reach) + 2;
  std::vector<Whole> products;
  std::vector<double> before;
  for (std::ptrdiff_t late = lowest; late <= highest; ++late) {
    std::vector<double> f(rows.size());
    for (std::size_t j = 0; j < rows.size(); ++j) {
      const std::size_t i = rows[j];
      const std::vector<double>& raw = force_[static_cast<std::size_t>(rows_.record[i])];
      const auto at = static_cast<std::ptrdiff_t>(rows_.at[i]) + late;
      f[j] = raw[static_cast<std::size_t>(
          std::clamp<std::ptrdiff_t>(at, 0, static_cast<std::ptrdiff_t>(raw.size()) - 1))];
    }
    f = centred(std::move(f));
    if (!products.empty()) products.back().next = dot(before, f);
    products.push_back({dot(f, f), 0.0, dot(a, f), dot(v, f)});
    before = std::move(f);
  }
  const auto cost = [&](double shift) {
    const double whole = std::floor(shift);
    const double part = shift - whole;
    const auto at = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(whole) - lowest);
    const Whole &p = products[at], &n = products[at + 1];
    const double left = 1.0 - part;
    const double ff = left * left * p.ff + 2.0 * left * part * p.next + part * part * n.ff;
    const double af = left * p.af + part * n.af;
    const double vf = left * p.vf + part * n.vf;
    const double total = ff - vf * vf / vv;
    return options_.mass ? total - 2.0 * *options_.mass * af + *options_.mass * *options_.mass * aa
                         : total - af * af / aa;
  };
  double best = -0.5;
  double least = cost(best);
  for (double s = -reach - 0.5; s <= reach; s += 0.5) {
    const double c = cost(s);
    if (c < least) least = c, best = s;
  }
  for (double half = 0.25; half > 1e-3; half *= 0.5) {
    for (const double s : {best - half, best + half}) {
      const double c = cost(s);
      if (c < least) least = c, best = s;
    }
  }
  if (best <= -reach || best >= reach - 0.25 || !(vv > 0.0 && aa > 0.0)) return;
  shift_free_ = true;
  align(best);
  solve(true);
  newton_shift();
}

void DriveFit::newton_shift() {
  constexpr int kSteps = 6;
  for (int i = 0; i < kSteps; ++i) {
    ask();
    solve(true);
    const double step = std::clamp(linear_(linear_.size() - 1), -1.0, 1.0);
    align(shift_ - step);
    if (std::abs(step) < 1e-3) break;
  }
  ask();
  solve(true);
}

void DriveFit::judge_shift() {
  const double limit = std::max(3.0, std::ceil(kLongestShift / records_.front().sample_time));
  double half_width = 0.0;
  double gain = 1.0;
  if (shift_free_) {
    newton_shift();
    half_width = shift_half_width();
    const double with = left_over();
    const double found = shift_;
    shift_free_ = false;
    align(-0.5);
    solve(true);
    gain = left_over() / std::max(with, 1e-300);
    shift_free_ = true;
    shift_ = found;
  }
  const bool told = shift_free_ && half_width < 2.0 && std::abs(shift_) < limit;
  if (!told) {
    result_.cannot_tell.emplace_back(
        "the shift between force and motion: the force changes too little or too seldom; taken as a "
        "commanded force under its zero-order hold");
  }
  // A shift that leaves as much of the force as none has no reason to be believed; one that leaves much less needs
  // no further witness: its half width is taken from the residual, which remembers longer than what moves it.
  const double away = std::abs(shift_ + 0.5);
  const bool seen = gain > kWorthwhileShift && away > std::max(1.5 * half_width, 0.02);
  const bool plain = gain > kPlainShift && away > std::max(0.5 * half_width, 0.02);
  if (told && (seen || plain)) {
    align(shift_);
    ask();
    solve(true);
    return;
  }
  shift_free_ = false;
  align(-0.5);
  solve(true);
  solve(true);
}

double DriveFit::left_over() const {
  const std::size_t q = columns();
  std::vector<double> c(q + 1);
  double sum = 0.0;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    double e =
        fill(i, c.data()) - map::kDirection[rows_.side[i]] * line_[rows_.side[i]](std::abs(velocity(i)));
    for (std::size_t j = 0; j < q; ++j) e -= linear_(static_cast<Index>(j)) * c[j];
    sum += e * e;
  }
  return sum;
}

double DriveFit::shift_half_width() const {
  const std::vector<std::size_t> rows = sample();
  const std::size_t q = columns();
  const auto n = static_cast<Index>(rows.size());
  MatrixXd X(n, static_cast<Index>(q)), Z(n, static_cast<Index>(q));
  VectorXd e(n);
  std::vector<int> record(rows.size());
  std::vector<std::size_t> at(rows.size());
  std::vector<double> c(q + 1);
  for (std::size_t j = 0; j < rows.size(); ++j) {
    const auto k = static_cast<Index>(j);
    const std::size_t i = rows[j];
    const std::size_t s = rows_.side[i];
    const double* t = &mean_[s][static_cast<std::size_t>(rows_.bin[i]) * (q + 6)];
    double left = fill(i, c.data()) - map::kDirection[s] * line_[s](std::abs(velocity(i)));
    for (std::size_t col = 0; col < q; ++col) {
      const auto K = static_cast<Index>(col);
      left -= linear_(K) * c[col];
      X(k, K) = c[col] - t[col] / t[q + 4];
      Z(k, K) = col + 1 == q ? shift_instrument(i, c[col]) - t[q + 1] / t[q + 4] : X(k, K);
    }
    e(k) = left;
    record[j] = rows_.record[i];
    at[j] = rows_.at[i];
  }
  const Eigen::FullPivLU<MatrixXd> lu(Z.transpose() * X);
  if (!lu.isInvertible()) return std::numeric_limits<double>::infinity();
  return stats::Uncertainty(Z, e, lu.inverse(), record, at)
      .half_width(VectorXd::Unit(static_cast<Index>(q), static_cast<Index>(q) - 1));
}

}  // namespace stribeck::ident::drive
