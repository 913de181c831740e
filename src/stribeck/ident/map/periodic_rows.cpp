#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/map/periodic_parts.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <utility>

namespace stribeck::ident::map::periodic {
namespace {

constexpr std::size_t kFewestGroups = 40;
constexpr double kMostPeriods = 2000.0;   ///< shortest period as a share of the travel
constexpr double kGroupSpan = 1.0 / 6.0;  ///< share of the shortest period: travel over which rows are joined
/// Longer logs are searched for longer periods only; a million rows take 0.2 s.
constexpr double kMostGroups = 1.2e5;
constexpr int kHighestOrder = 3;  ///< order of the polynomial that is removed from each pass
constexpr double kShortOfLongest = 1.0 / 3.0;
constexpr double kTaper = 0.1;  ///< share of a pass at each end

void check(const PeriodicRows& rows, const PeriodicOptions& options) {
  for (const double length : {options.shortest, options.longest, options.turn}) {
    if (!std::isfinite(length) || length < 0.0) {
      throw Refused(fmt::format(
          "periodic terms: period of {:g} asked for, expected a positive one, or 0 for any", length));
    }
  }
  const std::size_t n = rows.x.size();
  if (!rows.blur.empty() && rows.blur.size() != n) {
    throw Refused(fmt::format("periodic terms: {} rows of blur, expected {} or none", rows.blur.size(), n));
  }
  if (rows.e.size() != n || rows.direction.size() != n || rows.record.size() != n || rows.at.size() != n) {
    throw Refused(fmt::format("periodic terms: columns of {}, {}, {}, {} and {} rows, expected one length", n,
                              rows.e.size(), rows.direction.size(), rows.record.size(), rows.at.size()));
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (!std::isfinite(rows.x[i]) || !std::isfinite(rows.e[i])) {
      throw Refused(fmt::format("periodic terms: row {}: position or residual is not a finite number", i));
    }
  }
}

/// Whether row i continues the pass of the row before. A jump over a part of the travel begins a new one.
bool same_pass(const PeriodicRows& rows, const Data& data, std::size_t i) {
  return rows.record[i] == rows.record[i - 1] && rows.direction[i] == rows.direction[i - 1] &&
         rows.at[i] > rows.at[i - 1] && std::abs(rows.x[i] - rows.x[i - 1]) < 0.25 * data.longest;
}

/// Powers of the position in a pass that begins at `low`, made orthonormal.
void make_basis(Data& data, const Pass& p, double low, double travel) {
  const int order = std::min(kHighestOrder, static_cast<int>(travel / data.longest));
  const auto first = static_cast<Index>(p.first);
  const auto rows = static_cast<Index>(p.last - p.first);
  for (int k = 0; k <= order; ++k) {
    VectorXd q(rows);
    for (Index i = 0; i < rows; ++i) {
      const double u = travel > 0.0
                           ? 2.0 * (data.groups[p.first + static_cast<std::size_t>(i)].x - low) / travel - 1.0
                           : 0.0;
      q(i) = data.root(first + i) * std::pow(u, k);
    }
    const double before = q.norm();
    for (int twice = 0; twice < 2; ++twice) {
      for (int j = 0; j < k; ++j) {
        const auto other = data.basis.block(first, j, rows, 1);
        q -= other * other.col(0).dot(q);
      }
    }
    if (q.norm() > 1e-9 * before) data.basis.block(first, k, rows, 1) = q / q.norm();
  }
}

}  // namespace

bool measure(const PeriodicRows& rows, const PeriodicOptions& options, bool behind, Data& data,
             PeriodicResult& result) {
  check(rows, options);
  const std::size_t n = rows.x.size();
  if (n < kFewestGroups) {
    result.notes.push_back(
        fmt::format("periodic terms: {} rows are too few, expected at least {}", n, kFewestGroups));
    return false;
  }
  const auto [low, high] = std::minmax_element(rows.x.begin(), rows.x.end());
  data.low = *low;
  data.shown = rows.shown;
  data.length = *high - *low;
  data.middle = 0.5 * (*low + *high);
  std::vector<double> steps;
  double path = 0.0;
  bool forward = false;
  bool backward = false;
  for (std::size_t i = 0; i < n; ++i) {
    forward |= rows.direction[i] > 0;
    backward |= rows.direction[i] < 0;
    if (i == 0 || rows.record[i] != rows.record[i - 1]) continue;
    const double d = std::abs(rows.x[i] - rows.x[i - 1]);
    if (d > 0.0) steps.push_back(d);
    path += std::min(d, data.length / kMostPeriods);
  }
  data.both = forward && backward;
  data.standstill = !forward && !backward;
  if (!(data.length > 0.0) || steps.empty()) {
    result.notes.emplace_back("periodic terms: the axis does not move");
    return false;
  }
  data.shortest = options.shortest > 0.0
                      ? options.shortest
                      : std::max({4.0 * stats::median(std::move(steps)), data.length / kMostPeriods,
                                  path / (kMostGroups * kGroupSpan)});
  data.longest = options.longest > 0.0 ? options.longest : data.length / 3.0;
  if (behind && rows.passed != nullptr && !rows.blur.empty()) {
    data.passed = rows.passed;
    // Periods that the low-pass leaves in nearly no row.
    constexpr double kSlowest = 0.1,
                     kPassed = 0.5;  // of the cut-off's period: about a fifth of an amplitude is left
    const double blurred =
        std::min(kPassed * stats::quantile(rows.blur, kSlowest), kShortOfLongest * data.longest);
    if (!(options.shortest > 0.0)) data.shortest = std::max(data.shortest, blurred);
  }
  if (!(data.longest > 1.5 * data.shortest)) {
    result.notes.push_back(
        fmt::format("periodic terms: the rows are {:g} apart on a travel of {:g}: no period lies between the "
                    "shortest one that they show and a third of the travel; log faster or move farther",
                    data.shortest / 4.0, data.length));
    return false;
  }
  return true;
}

bool join(const PeriodicRows& rows, Data& data, PeriodicResult& result) {
  const double span = kGroupSpan * data.shortest;
  std::size_t i = 0;
  const std::size_t n = rows.x.size();
  data.groups.reserve(std::min<std::size_t>(n, 1u << 16));
  data.passes.clear();
  while (i < n) {
    const std::size_t begin = i;
    const double x0 = rows.x[i];
    double sum_x = 0.0;
    double sum_xx = 0.0;
    double sum_e = 0.0;
    double sum_blur = 0.0;
    do {
      const double d = rows.x[i] - x0;
      sum_x += d;
      sum_xx += d * d;
      sum_e += rows.e[i];
      if (data.passed != nullptr) sum_blur += rows.blur[i];
      ++i;
    } while (i < n && same_pass(rows, data, i) && std::abs(rows.x[i] - x0) < span);
    if (begin == 0 || !same_pass(rows, data, begin)) {
      if (!data.passes.empty()) data.passes.back().last = data.groups.size();
      data.passes.push_back({data.groups.size(), 0});
    }
    const double count = static_cast<double>(i - begin);
    Group g;
    g.x = x0 + sum_x / count;
    g.spread = std::max(0.0, sum_xx / count - std::pow(sum_x / count, 2.0));
    g.e = sum_e / count;
    g.blur = sum_blur / count;
    g.weight = count;
    g.sign = rows.direction[begin] < 0 ? -1.0 : 1.0;
    data.groups.push_back(g);
  }
  data.passes.back().last = data.groups.size();
  if (data.groups.size() < kFewestGroups) {
    result.notes.push_back(
        fmt::format("periodic terms: the rows cover {} places of the travel, expected at least {}",
                    data.groups.size(), kFewestGroups));
    return false;
  }
  return true;
}

void prepare_passes(Data& data) {
  const auto n = static_cast<Index>(data.groups.size());
  data.root.resize(n);
  data.basis = MatrixXd::Zero(n, kHighestOrder + 1);
  data.e.resize(n);
  for (const Pass& p : data.passes) {
    double low = data.groups[p.first].x;
    double high = low;
    for (std::size_t i = p.first; i < p.last; ++i) {
      low = std::min(low, data.groups[i].x);
      high = std::max(high, data.groups[i].x);
    }
    const double travel = high - low;
    // At standstill, a part of the travel has no reversals at its ends.
    const double edge = data.standstill ? 0.0 : kTaper * travel;
    for (std::size_t i = p.first; i < p.last; ++i) {
      Group& g = data.groups[i];
      const double from_end = std::min(g.x - low, high - g.x);
      if (from_end < edge) g.weight *= std::pow(std::sin(0.5 * kPi * (from_end + 0.01 * edge) / edge), 2.0);
      data.root(static_cast<Index>(i)) = std::sqrt(g.weight);
    }
    make_basis(data, p, low, travel);
  }
  for (Index i = 0; i < n; ++i) data.e(i) = data.root(i) * data.groups[static_cast<std::size_t>(i)].e;
  project(data, data.e);
  data.total = data.e.squaredNorm();
}

void project(const Data& data, Eigen::Ref<VectorXd> column) {
  for (const Pass& p : data.passes) {
    const auto first = static_cast<Index>(p.first);
    const auto rows = static_cast<Index>(p.last - p.first);
    const auto q = data.basis.middleRows(first, rows);
    const Eigen::Matrix<double, kHighestOrder + 1, 1> c = q.transpose() * column.segment(first, rows);
    column.segment(first, rows) -= q * c;
  }
}

}  // namespace stribeck::ident::map::periodic
