#include <fmt/core.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <stribeck/ident/methods/jog/jog_parts.hpp>
#include <stribeck/ident/stats/least_squares.hpp>
#include <stribeck/ident/stats/linear.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <stribeck/ident/stats/simplex.hpp>
#include <utility>

namespace stribeck::ident::methods::jog {

namespace {

constexpr double kWidest = 1.0 / 3.0;  // largest v0 over the fastest speed
constexpr double kDeltas[2] = {0.5, 4.0};
constexpr int kStarts = 15;
constexpr std::size_t kFinalists = 3;
constexpr double kNarrowest = 0.04;  // narrowest Gaussian over the fastest speed

/// min Σ w·(f − B·c − φ(v; v0, δ)·P·a)² with c, a eliminated; slopes among c are kept from becoming negative.
class Separable : public stats::Residuals {
 public:
  Separable(const std::vector<Point>& points, MatrixXd base, MatrixXd pattern, std::vector<Index> slopes,
            double slowest, double widest, bool free_delta)
      : base_(std::move(base)),
        pattern_(std::move(pattern)),
        slopes_(std::move(slopes)),
        free_(free_delta),
        low_{std::log(slowest), std::log(kDeltas[0])},
        high_{std::log(widest), std::log(kDeltas[1])} {
    const auto n = static_cast<Index>(points.size());
    u_.resize(n), f_.resize(n), root_.resize(n);
    for (Index i = 0; i < n; ++i) {
      const Point& q = points[static_cast<std::size_t>(i)];
      u_(i) = std::abs(q.v);
      root_(i) = std::sqrt(q.weight);
      f_(i) = root_(i) * q.f;
    }
    base_ = root_.asDiagonal() * base_;
    pattern_ = root_.asDiagonal() * pattern_;
  }

  [[nodiscard]] int count() const override { return static_cast<int>(f_.size()); }
  [[nodiscard]] int parameters() const override { return free_ ? 2 : 1; }
  [[nodiscard]] Index linear() const { return base_.cols() + pattern_.cols(); }

  /// Converts from the unbounded coordinates of the solver.
  [[nodiscard]] double value(int i, double q) const {
    return std::exp(low_[i] + (high_[i] - low_[i]) / (1.0 + std::exp(-q)));
  }
  [[nodiscard]] double coordinate(int i, double x) const {
    const double share = std::clamp((std::log(x) - low_[i]) / (high_[i] - low_[i]), 0.01, 0.99);
    return std::log(share / (1.0 - share));
  }

  bool evaluate(const double* q, double* residuals, double* jacobian) const override {
    const double width = value(0, q[0]);
    const double delta = free_ ? value(1, q[1]) : 2.0;
    std::vector<Index> active;
    MatrixXd X;
    const VectorXd c = solve(width, delta, active, X);
    Eigen::Map<VectorXd> r(residuals, f_.size());
    r = f_ - X * c;
    if (jacobian == nullptr) return true;
    const VectorXd a = c.tail(pattern_.cols());
    const VectorXd weight = pattern_ * a;
    MatrixXd used(X.rows(), static_cast<Index>(active.size()));
    for (std::size_t i = 0; i < active.size(); ++i) used.col(static_cast<Index>(i)) = X.col(active[i]);
    MatrixXd slopes(f_.size(), parameters());
    for (int j = 0; j < parameters(); ++j) {
      const double share = 1.0 / (1.0 + std::exp(-q[j]));
      const double chain = (high_[j] - low_[j]) * share * (1.0 - share);
      for (Index i = 0; i < slopes.rows(); ++i) {
        const double power = std::pow(u_(i) / width, delta);
        const double fade = std::exp(-power);
        // ∂φ/∂log v0 and ∂φ/∂log δ
        const double slope = j == 0 ? fade * delta * power : -fade * power * delta * std::log(u_(i) / width);
        slopes(i, j) = slope * weight(i) * chain;
      }
    }
    const MatrixXd taken = stats::least_squares_of_columns(used, slopes);
    for (int j = 0; j < parameters(); ++j) {
      Eigen::Map<VectorXd>(jacobian + j * f_.size(), f_.size()) = -(slopes.col(j) - used * taken.col(j));
    }
    return true;
  }

  /// Linear parameters for a shape; X is the weighted regressor, `active` its columns that are not held at zero.
  VectorXd solve(double width, double delta, std::vector<Index>& active, MatrixXd& X) const {
    X.resize(f_.size(), linear());
    X.leftCols(base_.cols()) = base_;
    VectorXd fade(f_.size());
    for (Index i = 0; i < fade.size(); ++i) fade(i) = std::exp(-std::pow(u_(i) / width, delta));
    X.rightCols(pattern_.cols()) = fade.asDiagonal() * pattern_;
    active.clear();
    for (Index i = 0; i < X.cols(); ++i) active.push_back(i);
    for (;;) {
      MatrixXd used(X.rows(), static_cast<Index>(active.size()));
      for (std::size_t i = 0; i < active.size(); ++i) used.col(static_cast<Index>(i)) = X.col(active[i]);
      const VectorXd part = stats::least_squares(used, f_).x;
      VectorXd c = VectorXd::Zero(X.cols());
      for (std::size_t i = 0; i < active.size(); ++i) c(active[i]) = part(static_cast<Index>(i));
      const auto falling = std::find_if(slopes_.begin(), slopes_.end(), [&](Index s) { return c(s) < 0.0; });
      if (falling == slopes_.end()) return c;
      active.erase(std::find(active.begin(), active.end(), *falling));
    }
  }
  [[nodiscard]] double cost(double width, double delta, const VectorXd& c) const {
    VectorXd e = f_ - base_ * c.head(base_.cols());
    for (Index i = 0; i < e.size(); ++i) {
      e(i) -= std::exp(-std::pow(u_(i) / width, delta)) * pattern_.row(i).dot(c.tail(pattern_.cols()));
    }
    return e.squaredNorm();
  }

  struct Solution {
    VectorXd linear;
    double width = 0.0, delta = 2.0, cost = std::numeric_limits<double>::infinity();
  };
  [[nodiscard]] Solution minimise(Solver solver) const {
    struct Start {
      double cost, width, delta;
    };
    std::vector<Start> starts;
    std::vector<Index> active;
    MatrixXd X;
    for (int i = 0; i < kStarts; ++i) {
      const double width = std::exp(low_[0] + (high_[0] - low_[0]) * (i + 0.5) / kStarts);
      for (const double delta : {0.6, 1.0, 2.0, 3.5}) {
        if (!free_ && delta != 2.0) continue;
        const VectorXd c = solve(width, delta, active, X);
        starts.push_back({(f_ - X * c).squaredNorm(), width, delta});
      }
    }
    std::stable_sort(starts.begin(), starts.end(),
                     [](const Start& a, const Start& b) { return a.cost < b.cost; });
    Solution best;
    if (solver == Solver::kSimplex) return simplex(starts.front().width, starts.front().delta);
    for (std::size_t i = 0; i < std::min(kFinalists, starts.size()); ++i) {
      VectorXd q(parameters());
      q(0) = coordinate(0, starts[i].width);
      if (free_) q(1) = coordinate(1, starts[i].delta);
      stats::DescentOptions closely;
      closely.iterations = 60;
      closely.gradient_tolerance = 1e-14;
      closely.parameter_tolerance = 1e-12;
      stats::minimise_squares(*this, q, closely);
      Solution s;
      s.width = value(0, q(0));
      s.delta = free_ ? value(1, q(1)) : 2.0;
      s.linear = solve(s.width, s.delta, active, X);
      s.cost = (f_ - X * s.linear).squaredNorm();
      if (s.cost < best.cost) best = s;
    }
    return best;
  }

 private:
  /// The form of the papers: all parameters at once, from one start.
  [[nodiscard]] Solution simplex(double width, double delta) const {
    std::vector<Index> active;
    MatrixXd X;
    const VectorXd c = solve(width, delta, active, X);
    std::vector<double> start(c.data(), c.data() + c.size());
    start.push_back(std::log(width));
    if (free_) start.push_back(std::log(delta));
    std::vector<double> step;
    for (Index i = 0; i < c.size(); ++i)
      step.push_back(0.05 * std::abs(c(i)) + 1e-3 * c.cwiseAbs().maxCoeff());
    while (step.size() < start.size()) step.push_back(0.2);
    const auto unpack = [&](const std::vector<double>& x) {
      Solution s;
      s.linear = Eigen::Map<const VectorXd>(x.data(), linear());
      s.width = std::exp(x[static_cast<std::size_t>(linear())]);
      if (free_) s.delta = std::exp(x.back());
      return s;
    };
    const stats::SimplexResult found = stats::minimise_simplex(
        [&](const std::vector<double>& x) {
          const Solution s = unpack(x);
          bool outside = std::log(s.width) < low_[0] || std::log(s.width) > high_[0];
          outside = outside || (free_ && (s.delta < kDeltas[0] || s.delta > kDeltas[1]));
          for (const Index i : slopes_) outside = outside || s.linear(i) < 0.0;
          return outside ? std::numeric_limits<double>::max() : cost(s.width, s.delta, s.linear);
        },
        start, step);
    Solution s = unpack(found.x);
    s.cost = found.value;
    return s;
  }

  MatrixXd base_, pattern_;
  VectorXd u_, f_, root_;
  std::vector<Index> slopes_;
  bool free_;
  double low_[2], high_[2];
};

/// Regressors of the linear part, with a column for the load where both directions are present.
struct Columns {
  MatrixXd base, pattern;
  std::vector<Index> slopes;
};

Columns columns(const std::vector<Point>& points, bool symmetric, bool load) {
  Columns c;
  const auto n = static_cast<Index>(points.size());
  c.base = MatrixXd::Zero(n, symmetric ? (load ? 3 : 2) : 4);
  c.pattern = MatrixXd::Zero(n, symmetric ? 1 : 2);
  for (Index i = 0; i < n; ++i) {
    const double v = points[static_cast<std::size_t>(i)].v;
    const double s = v > 0.0 ? 1.0 : -1.0;
    if (symmetric) {
      c.base(i, 0) = s;
      c.base(i, 1) = v;
      if (load) c.base(i, 2) = 1.0;
      c.pattern(i, 0) = s;
    } else {
      const Index side = v > 0.0 ? 0 : 1;
      c.base(i, 2 * side) = s;
      c.base(i, 2 * side + 1) = v;
      c.pattern(i, side) = s;
    }
  }
  if (symmetric) {
    c.slopes = {1};
  } else {
    c.slopes = {1, 3};
  }
  return c;
}

}  // namespace

double Fit::operator()(double v) const {
  const double s = v > 0.0 ? 1.0 : -1.0;
  const double u = std::abs(v);
  const std::size_t side = v > 0.0 ? 0 : 1;
  const auto fade = [&](double width, double delta) { return std::exp(-std::pow(u / width, delta)); };
  switch (kind.family) {
    case Family::kLine:
      return s * (p[0] + p[1] * u) + p[2];
    case Family::kStribeck:
      return s * (p[0] + p[1] * u + p[3] * fade(p[4], 2.0)) + p[2];
    case Family::kFreeStribeck:
      return s * (p[0] + p[1] * u + p[3] * fade(p[4], p[5])) + p[2];
    case Family::kLines:
      return s * (p[2 * side] + p[2 * side + 1] * u);
    case Family::kCommonStribeck:
      return s * (p[2 * side] + p[2 * side + 1] * u + p[4 + side] * fade(p[6], 2.0));
    case Family::kOwnStribeck:
      return s * (p[2 * side] + p[2 * side + 1] * u + p[4 + side] * fade(p[6 + side], 2.0));
    case Family::kGaussians:
      return s * branch[side].force(u / top);
  }
  return 0.0;
}

VectorXd Fit::gradient(double v) const {
  VectorXd g = VectorXd::Zero(static_cast<Index>(parameters()));
  if (kind.family == Family::kGaussians) {
    const std::size_t side = v > 0.0 ? 0 : 1;
    branch[side].gradient(std::abs(v) / top, g.data() + (side == 0 ? 0 : branch[0].parameters()));
    return v > 0.0 ? g : VectorXd(-g);
  }
  Fit moved = *this;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double h = 1e-6 * std::max(std::abs(p[i]), 1e-9);
    moved.p[i] = p[i] + h;
    const double above = moved(v);
    moved.p[i] = p[i] - h;
    g(static_cast<Index>(i)) = (above - moved(v)) / (2.0 * h);
    moved.p[i] = p[i];
  }
  return g;
}

std::vector<Point> side_of(const std::vector<Point>& points, int side) {
  std::vector<Point> out;
  for (const Point& p : points) {
    if ((p.v > 0.0 ? 0 : 1) == side) out.push_back(p);
  }
  return out;
}

std::optional<Fit> Fitter::fit(const Kind& kind, const std::vector<Point>& points, Ladders& ladders) const {
  Fit out;
  out.kind = kind;
  double slowest = std::numeric_limits<double>::infinity();
  for (const Point& p : points) {
    out.top = std::max(out.top, std::abs(p.v));
    slowest = std::min(slowest, std::abs(p.v));
  }
  const double widest = kWidest * out.top;
  switch (kind.family) {
    case Family::kLine:
    case Family::kLines: {
      const Columns c = columns(points, kind.symmetric(), both_);
      if (static_cast<Index>(points.size()) < c.base.cols()) return {};
      MatrixXd base = c.base;
      VectorXd f(base.rows());
      for (Index i = 0; i < f.size(); ++i) {
        const Point& p = points[static_cast<std::size_t>(i)];
        f(i) = std::sqrt(p.weight) * p.f;
        base.row(i) *= std::sqrt(p.weight);
      }
      const auto [p, rank] = stats::least_squares(base, f);
      if (rank < base.cols()) return {};
      out.p.assign(p.data(), p.data() + p.size());
      if (kind.symmetric() && !both_) out.p.push_back(0.0);
      return out;
    }
    case Family::kStribeck:
    case Family::kFreeStribeck:
    case Family::kCommonStribeck: {
      const bool free_delta = kind.family == Family::kFreeStribeck;
      const Columns c = columns(points, kind.symmetric(), both_);
      const Index all = c.base.cols() + c.pattern.cols() + (free_delta ? 2 : 1);
      if (static_cast<Index>(points.size()) <= all || !(slowest < 0.9 * widest)) return {};
      const auto s = Separable(points, c.base, c.pattern, c.slopes, slowest, widest, free_delta)
                         .minimise(options_.solver);
      for (Index i = 0; i < c.base.cols(); ++i) out.p.push_back(s.linear(i));
      if (kind.symmetric() && !both_) out.p.push_back(0.0);
      for (Index i = c.base.cols(); i < s.linear.size(); ++i) out.p.push_back(s.linear(i));
      out.p.push_back(s.width);
      if (free_delta) out.p.push_back(s.delta);
      return out;
    }
    case Family::kOwnStribeck: {
      out.p.assign(8, 0.0);
      for (const int side : {0, 1}) {
        const std::vector<Point> part = side_of(points, side);
        double first = std::numeric_limits<double>::infinity(), last = 0.0;
        for (const Point& p : part)
          first = std::min(first, std::abs(p.v)), last = std::max(last, std::abs(p.v));
        if (part.size() <= 4 || !(first < 0.9 * kWidest * last)) return {};
        const Columns c = columns(part, true, false);
        const auto s = Separable(part, c.base, c.pattern, c.slopes, first, kWidest * last, false)
                           .minimise(options_.solver);
        const auto k = static_cast<std::size_t>(side);
        out.p[2 * k] = s.linear(0);
        out.p[2 * k + 1] = s.linear(1);
        out.p[4 + k] = s.linear(2);
        out.p[6 + k] = s.width;
      }
      return out;
    }
    case Family::kGaussians: {
      if (!ladders.done) {
        const int most = options_.terms.value_or(kMostGaussians);
        for (const int side : {0, 1}) ladders.side[side] = ladder_of(points, side, out.top, most);
        ladders.done = true;
      }
      for (const int side : {0, 1}) {
        const auto& ladder = ladders.side[side];
        if (ladder.size() <= static_cast<std::size_t>(kind.terms)) return {};
        out.branch[static_cast<std::size_t>(side)] = ladder[static_cast<std::size_t>(kind.terms)];
      }
      return out;
    }
  }
  return {};
}

std::vector<map::BranchFit> Fitter::ladder_of(const std::vector<Point>& points, int side, double top,
                                              int terms) const {
  std::vector<Point> part = side_of(points, side);
  std::stable_sort(part.begin(), part.end(),
                   [](const Point& a, const Point& b) { return std::abs(a.v) < std::abs(b.v); });
  if (part.empty()) return {};
  map::Bins bins;
  double highest = 0.0;
  std::vector<double> errors;
  for (const Point& p : part) {
    bins.u.push_back(std::abs(p.v) / top);
    bins.force.push_back(p.v > 0.0 ? p.f : -p.f);
    bins.weight.push_back(p.weight);
    highest = std::max(highest, std::abs(p.f));
    errors.push_back(p.error);
  }
  map::FitSettings settings;
  settings.noise = std::max(stats::median(std::move(errors)), 1e-7 * highest);
  settings.height_scale = 10.0 * highest;
  settings.slope_scale = 0.2 * highest;
  settings.narrowest = kNarrowest;
  settings.polished = 6;  // with few points, starts cost little
  settings.scattered = 64;
  return map::fit_ladder(bins, terms, settings);
}

std::string name_of(const Kind& kind) {
  switch (kind.family) {
    case Family::kLine:
      return "Coulomb-viscous, symmetric";
    case Family::kStribeck:
      return "Stribeck, symmetric, delta 2";
    case Family::kFreeStribeck:
      return "Stribeck, symmetric, delta free";
    case Family::kLines:
      return "Coulomb-viscous, by direction";
    case Family::kCommonStribeck:
      return "Stribeck, by direction, one width";
    case Family::kOwnStribeck:
      return "Stribeck, by direction";
    case Family::kGaussians:
      return fmt::format("Gaussian, {} {}, by direction", kind.terms, kind.terms == 1 ? "term" : "terms");
  }
  return {};
}

friction::Gaussian<double> as_map(const Fit& fit, const std::array<double, 2>& range) {
  friction::Gaussian<double> map;
  map.velocity_range = range;
  for (const int side : {0, 1}) {
    const double s = side == 0 ? 1.0 : -1.0;
    const auto k = static_cast<std::size_t>(side);
    friction::GaussianBranch<double>& b = side == 0 ? map.positive : map.negative;
    if (fit.kind.family == Family::kGaussians) {
      const map::BranchFit& from = fit.branch[k];
      b.eta0 = s * from.eta0;
      b.eta1 = from.eta1 / fit.top;
      for (const map::FitTerm& g : from.terms)
        b.gaussians.push_back({s * g.a, s * g.b * fit.top, g.c * fit.top});
      continue;
    }
    b.eta0 = s * fit.p[2 * k];
    b.eta1 = fit.p[2 * k + 1];
    if (fit.kind.family == Family::kCommonStribeck) b.gaussians.push_back({s * fit.p[4 + k], 0.0, fit.p[6]});
    if (fit.kind.family == Family::kOwnStribeck) b.gaussians.push_back({s * fit.p[4 + k], 0.0, fit.p[6 + k]});
  }
  return map;
}

bool opposes(const Fit& fit, double low, double high) {
  for (int i = 0; i <= 200; ++i) {
    const double share = i / 200.0;
    for (const double v : {share * low - 1e-12, share * high + 1e-12}) {
      if (fit.kind.symmetric()) {
        const double rise = fit.kind.family == Family::kLine ? 0.0 : fit.p[3];
        if (!(fit.p[0] > 0.0) || !(fit.p[0] + rise > 0.0)) return false;
      } else if (!(as_map(fit, {low, high}).parts(v, 0.0).level > 0.0)) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace stribeck::ident::methods::jog
