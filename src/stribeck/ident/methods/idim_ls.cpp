#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <stribeck/ident/log/filter.hpp>
#include <stribeck/ident/methods/idim_ls.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/stats/linear.hpp>
#include <stribeck/ident/stats/uncertainty.hpp>
#include <string>

namespace stribeck::ident::methods {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Index = Eigen::Index;

/// Central differences, one-sided at the ends.
std::vector<double> derivative(const std::vector<double>& y, double T) {
  const std::size_t n = y.size();
  std::vector<double> d(n);
  for (std::size_t k = 1; k + 1 < n; ++k) d[k] = (y[k + 1] - y[k - 1]) / (2.0 * T);
  d[0] = (y[1] - y[0]) / T;
  d[n - 1] = (y[n - 1] - y[n - 2]) / T;
  return d;
}

struct Column {
  const char* name;
  const char* unit;
  const char* shown;
  std::vector<double> values;
};

void check(const log::Record& record, const IdimOptions& options) {
  const auto wrong = log::problems(record);
  if (!wrong.empty()) throw Refused(wrong.front());
  const double T = record.sample_time;
  const std::size_t n = record.x.size();
  if (!(options.cut_off > 0.0 && options.cut_off < 0.5 / T)) {
    throw Refused(fmt::format(
        "idim-ls: cut-off of {:g} Hz{}, expected above 0 Hz and below {:g} Hz, half the sampling frequency of the log",
        options.cut_off, options.cut_off == IdimOptions{}.cut_off ? ", the default" : "", 0.5 / T));
  }
  if (n < options.drop + 40 * options.decimation) {
    throw Refused("idim-ls: " + std::to_string(n) + " rows are too few for decimation by " +
                  std::to_string(options.decimation));
  }
}

/// The regressors over all rows, in the order of the law.
std::vector<Column> columns_of(const std::vector<double>& v, const std::vector<double>& a,
                               bool by_direction) {
  const std::size_t n = v.size();
  std::vector<Column> columns{{"mass", "kg", "N s2/mm", a}};
  auto add = [&](const char* name, const char* unit, const char* shown, auto value) {
    Column c{name, unit, shown, std::vector<double>(n)};
    std::transform(v.begin(), v.end(), c.values.begin(), value);
    columns.push_back(std::move(c));
  };
  if (by_direction) {
    add("viscous_positive", "N s/m", "N s/mm", [](double s) { return s > 0.0 ? s : 0.0; });
    add("coulomb_positive", "N", "N", [](double s) { return s > 0.0 ? 1.0 : 0.0; });
    add("viscous_negative", "N s/m", "N s/mm", [](double s) { return s < 0.0 ? s : 0.0; });
    add("coulomb_negative", "N", "N", [](double s) { return s < 0.0 ? -1.0 : 0.0; });
  } else {
    add("viscous", "N s/m", "N s/mm", [](double s) { return s; });
    add("coulomb", "N", "N", [](double s) { return s > 0.0 ? 1.0 : s < 0.0 ? -1.0 : 0.0; });
    add("offset", "N", "N", [](double) { return 1.0; });
  }
  return columns;
}

/// Drops the first rows and decimates.
std::vector<double> thin(const std::vector<double>& column, const IdimOptions& options) {
  return log::decimate({column.begin() + static_cast<std::ptrdiff_t>(options.drop), column.end()},
                       options.decimation);
}

/// The figures that papers print.
IdimResult::Published published(const VectorXd& theta, const VectorXd& e, const VectorXd& y,
                                const MatrixXd& inverse, double condition) {
  IdimResult::Published pub;
  pub.rows = static_cast<std::size_t>(y.size());
  pub.error_norm = e.norm();
  pub.relative_error = e.norm() / y.norm();
  pub.error_deviation = std::sqrt((e.array() - e.mean()).square().sum() / static_cast<double>(y.size() - 1));
  pub.condition = condition;
  for (Index j = 0; j < theta.size(); ++j) {
    pub.value.push_back(theta(j));
    pub.deviation.push_back(pub.error_deviation * std::sqrt(inverse(j, j)));
  }
  return pub;
}

void write_law(const VectorXd& theta, bool by_direction, Result& r) {
  if (by_direction) {
    r.set_steady(SteadyModel::kAsymmetric);
    friction::Gaussian<double> map;
    map.velocity_range = r.velocity_range;
    map.positive.eta1 = theta(1);
    map.positive.eta0 = theta(2);
    map.negative.eta1 = theta(3);
    map.negative.eta0 = -theta(4);
    r.friction.steady = map;
  } else {
    r.set_steady(SteadyModel::kConventional);
    r.load = theta(3);
    friction::Conventional<double> map;
    map.alpha0 = theta(2);
    map.alpha2 = theta(1);
    r.friction.steady = map;
  }
}

/// The curve without the load, in both directions from a fiftieth of the largest speed.
void write_curve(const VectorXd& theta, const stats::Uncertainty& uncertainty, bool by_direction, Result& r) {
  constexpr int kPoints = 24;
  for (int i = -kPoints; i <= kPoints; ++i) {
    if (i == 0) continue;
    const double limit = i < 0 ? -r.velocity_range[0] : r.velocity_range[1];
    const double s = (i < 0 ? -1.0 : 1.0) * limit * (0.02 + 0.98 * (std::abs(i) - 1) / (kPoints - 1));
    VectorXd g = VectorXd::Zero(theta.size());
    if (by_direction) {
      g(s > 0 ? 1 : 3) = s;
      g(s > 0 ? 2 : 4) = s > 0 ? 1.0 : -1.0;
    } else {
      g(1) = s;
      g(2) = s > 0 ? 1.0 : -1.0;
    }
    const double f = g.dot(theta);
    const double half = uncertainty.half_width(g);
    r.curve.push_back({s, f, f - half, f + half});
  }
}

}  // namespace

IdimResult identify_idim_ls(const log::Record& record, const IdimOptions& options) {
  check(record, options);
  const double T = record.sample_time;
  const std::vector<double> x =
      log::forward_backward(log::butterworth(options.order, options.cut_off * 2.0 * T), record.x);
  const std::vector<double> v = derivative(x, T);
  const std::vector<double> a = derivative(v, T);
  const std::vector<Column> columns = columns_of(v, a, options.by_direction);
  const std::vector<double> force = thin(record.f, options);
  const auto rows = static_cast<Index>(force.size());
  const auto p = static_cast<Index>(columns.size());
  MatrixXd X(rows, p);
  for (Index j = 0; j < p; ++j) {
    const std::vector<double> c = thin(columns[static_cast<std::size_t>(j)].values, options);
    X.col(j) = Eigen::Map<const VectorXd>(c.data(), rows);
  }
  const VectorXd y = Eigen::Map<const VectorXd>(force.data(), rows);
  const auto [theta, singular, rank] = stats::solve_svd(X, y);
  if (rank < p)
    throw Refused(
        "idim-ls: the log does not determine all parameters; move in both directions at several speeds");
  const VectorXd e = y - X * theta;
  const MatrixXd inverse = stats::inverse(stats::gram(X));

  IdimResult out;
  out.published = published(theta, e, y, inverse, singular(0) / singular(p - 1));

  std::vector<std::size_t> at(force.size());
  for (std::size_t k = 0; k < at.size(); ++k) at[k] = k;
  const stats::Uncertainty uncertainty(X, e, inverse, std::vector<int>(force.size(), 0), at);

  Result& r = out.result;
  r.method = Method::kIdimLs;
  r.force_unit = record.force_unit;
  r.position_unit = record.position_unit;
  r.rows = out.published.rows;
  r.mass = theta(0);
  const auto [low, high] =
      std::minmax_element(v.begin() + static_cast<std::ptrdiff_t>(options.drop), v.end());
  r.velocity_range = {*low, *high};
  for (Index j = 0; j < p; ++j) {
    const Column& c = columns[static_cast<std::size_t>(j)];
    const double half = uncertainty.half_width(VectorXd::Unit(p, j));
    r.parameters.push_back(
        {c.name, theta(j), c.unit, c.shown, theta(j) - half, theta(j) + half, half < std::abs(theta(j))});
  }
  r.mass_interval = {r.parameters[0].ci_low, r.parameters[0].ci_high};
  write_law(theta, options.by_direction, r);
  write_curve(theta, uncertainty, options.by_direction, r);
  const std::size_t step = std::max<std::size_t>(1, (record.x.size() - options.drop) / 1200);
  for (std::size_t k = options.drop; k < record.x.size(); k += step) {
    r.map.push_back({v[k], record.f[k] - r.mass * a[k] - r.load, v[k] > 0 ? 1 : -1});
  }
  return out;
}

}  // namespace stribeck::ident::methods
