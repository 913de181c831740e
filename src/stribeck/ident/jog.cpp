#include <ceres/tiny_solver.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/equal_speed.hpp>
#include <stribeck/ident/gaussian_fit.hpp>
#include <stribeck/ident/jog.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/simplex.hpp>
#include <stribeck/ident/uncertainty.hpp>

namespace stribeck::ident {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kOneSpeed = 0.05;        // speeds that are left out together
constexpr std::size_t kFewestSpeeds = 3;  // that any candidate needs
constexpr std::size_t kFewestFolds = 6;   // below it nothing can be chosen by leaving out
constexpr double kWidest = 1.0 / 3.0;     // v0 over the fastest speed
constexpr double kDeltas[2] = {0.5, 4.0};
constexpr int kStarts = 15;
constexpr std::size_t kFinalists = 3;
constexpr int kMostGaussians = 6;
constexpr double kNarrowest = 0.04;  // of a Gaussian, over the fastest speed
constexpr double kMisses = 2.5;      // misfit up to which nothing is missing
constexpr double kTooMuch = 0.3;     // half sum over half difference: a load, whatever else
/// Half width over force between two speeds from which on a term is seen by one of them only, if it is as many
/// times that of the middle gap.
constexpr double kOpen = 0.02;
constexpr double kOpenBeside = 5.0;

template <class... T>
std::string text(const char* format, T... values) {
  char buffer[400];
  std::snprintf(buffer, sizeof buffer, format, values...);
  return buffer;
}

struct Point {
  double v = 0.0;      // [m/s]
  double f = 0.0;      // [N]
  double error = 0.0;  // [N]
  double weight = 1.0;
  std::size_t fold = 0;
  std::size_t run = 0;
};

enum class Family { kLine, kStribeck, kFreeStribeck, kLines, kCommonStribeck, kOwnStribeck, kGaussians };

struct Kind {
  Family family;
  int terms;  // of kGaussians
  [[nodiscard]] bool symmetric() const { return family <= Family::kFreeStribeck; }
};

/// Parameters in the order of the law, linear ones first:
///   kLine α0, α2, load;  kStribeck + rise, v0;  kFreeStribeck + rise, v0, δ
///   kLines η0+, η1+, η0−, η1− (against the motion);  kCommonStribeck + a+, a−, c;  kOwnStribeck + a+, a−, c+, c−
///   kGaussians: in `branch`
struct Fit {
  Kind kind{};
  std::vector<double> p;
  std::array<BranchFit, 2> branch;
  double top = 0.0;  // speed that stands for u = 1

  [[nodiscard]] std::size_t parameters() const {
    return kind.family == Family::kGaussians ? branch[0].parameters() + branch[1].parameters() : p.size();
  }
  [[nodiscard]] double operator()(double v) const {
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
  /// ∂f/∂parameters.
  [[nodiscard]] VectorXd gradient(double v) const {
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
};

/// min Σ w·(f − B·c − φ(v; v0, δ)·P·a)² with c, a eliminated; slopes among c are kept from going below zero.
class Separable {
 public:
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = Eigen::Dynamic };

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

  [[nodiscard]] int NumResiduals() const { return static_cast<int>(f_.size()); }
  [[nodiscard]] int NumParameters() const { return free_ ? 2 : 1; }
  [[nodiscard]] Index linear() const { return base_.cols() + pattern_.cols(); }

  /// From the unbounded coordinates of the solver.
  [[nodiscard]] double value(int i, double q) const {
    return std::exp(low_[i] + (high_[i] - low_[i]) / (1.0 + std::exp(-q)));
  }
  [[nodiscard]] double coordinate(int i, double x) const {
    const double share = std::clamp((std::log(x) - low_[i]) / (high_[i] - low_[i]), 0.01, 0.99);
    return std::log(share / (1.0 - share));
  }

  bool operator()(const double* q, double* residuals, double* jacobian) const {
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
    const auto qr = used.colPivHouseholderQr();
    for (int j = 0; j < NumParameters(); ++j) {
      VectorXd d(f_.size());
      for (Index i = 0; i < d.size(); ++i) {
        const double power = std::pow(u_(i) / width, delta);
        const double fade = std::exp(-power);
        // ∂φ/∂log v0 and ∂φ/∂log δ
        d(i) = j == 0 ? fade * delta * power : -fade * power * delta * std::log(u_(i) / width);
      }
      d = d.cwiseProduct(weight);
      const double share = 1.0 / (1.0 + std::exp(-q[j]));
      d *= (high_[j] - low_[j]) * share * (1.0 - share);
      Eigen::Map<VectorXd>(jacobian + j * f_.size(), f_.size()) = -(d - used * qr.solve(d));
    }
    return true;
  }

  /// Linear parameters for a shape; X is the weighted regressor, active its columns that are not held at zero.
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
      const VectorXd part = used.colPivHouseholderQr().solve(f_);
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
      Eigen::Matrix<double, Eigen::Dynamic, 1> q(NumParameters());
      q(0) = coordinate(0, starts[i].width);
      if (free_) q(1) = coordinate(1, starts[i].delta);
      ceres::TinySolver<Separable> descent;
      descent.options.max_num_iterations = 60;
      descent.options.gradient_tolerance = 1e-14;
      descent.options.parameter_tolerance = 1e-12;
      descent.Solve(*this, &q);
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
  /// As the papers do it: all parameters at once, from one start.
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
    const SimplexResult found = minimise_simplex(
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

/// Regressors of the linear part; a column for the load where both directions are there.
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

std::vector<Point> side_of(const std::vector<Point>& points, int side) {
  std::vector<Point> out;
  for (const Point& p : points) {
    if ((p.v > 0.0 ? 0 : 1) == side) out.push_back(p);
  }
  return out;
}

/// Gaussian fits of one set of points with 0, 1, … terms: each needs the one before.
struct Ladders {
  bool done = false;
  std::vector<BranchFit> side[2];
};

class Fitter {
 public:
  Fitter(const JogOptions& options, bool both) : options_(options), both_(both) {}

  /// Empty where the points do not carry the candidate.
  [[nodiscard]] std::optional<Fit> fit(const Kind& kind, const std::vector<Point>& points,
                                       Ladders& ladders) const {
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
        const auto qr = base.colPivHouseholderQr();
        if (qr.rank() < base.cols()) return {};
        const VectorXd p = qr.solve(f);
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

 private:
  [[nodiscard]] std::vector<BranchFit> ladder_of(const std::vector<Point>& points, int side, double top,
                                                 int terms) const {
    std::vector<Point> part = side_of(points, side);
    std::stable_sort(part.begin(), part.end(),
                     [](const Point& a, const Point& b) { return std::abs(a.v) < std::abs(b.v); });
    if (part.empty()) return {};
    Bins bins;
    double highest = 0.0;
    std::vector<double> errors;
    for (const Point& p : part) {
      bins.u.push_back(std::abs(p.v) / top);
      bins.force.push_back(p.v > 0.0 ? p.f : -p.f);
      bins.weight.push_back(p.weight);
      highest = std::max(highest, std::abs(p.f));
      errors.push_back(p.error);
    }
    std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2),
                     errors.end());
    FitSettings settings;
    settings.noise = std::max(errors[errors.size() / 2], 1e-7 * highest);
    settings.height_scale = 10.0 * highest;
    settings.slope_scale = 0.2 * highest;
    settings.narrowest = kNarrowest;
    settings.polished = 6;  // few points: starts cost little
    settings.scattered = 64;
    return fit_ladder(bins, terms, settings);
  }

  const JogOptions& options_;
  bool both_;
};

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
      return text("Gaussian, %d %s, by direction", kind.terms, kind.terms == 1 ? "term" : "terms");
  }
  return {};
}

/// As friction::Gaussian; branches signed as in Table 2.3.
friction::Gaussian<double> as_map(const Fit& fit, const std::array<double, 2>& range) {
  friction::Gaussian<double> map;
  map.velocity_range = range;
  for (const int side : {0, 1}) {
    const double s = side == 0 ? 1.0 : -1.0;
    const auto k = static_cast<std::size_t>(side);
    friction::GaussianBranch<double>& b = side == 0 ? map.positive : map.negative;
    if (fit.kind.family == Family::kGaussians) {
      const BranchFit& from = fit.branch[k];
      b.eta0 = s * from.eta0;
      b.eta1 = from.eta1 / fit.top;
      for (const FitTerm& g : from.terms) b.gaussians.push_back({s * g.a, s * g.b * fit.top, g.c * fit.top});
      continue;
    }
    b.eta0 = s * fit.p[2 * k];
    b.eta1 = fit.p[2 * k + 1];
    if (fit.kind.family == Family::kCommonStribeck) b.gaussians.push_back({s * fit.p[4 + k], 0.0, fit.p[6]});
    if (fit.kind.family == Family::kOwnStribeck) b.gaussians.push_back({s * fit.p[4 + k], 0.0, fit.p[6 + k]});
  }
  return map;
}

/// What does not oppose the motion cannot be the level of a hysteresis.
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

/// Friction of one direction over speed; speeds that are one joined.
struct SpeedMean {
  double v = 0.0, f = 0.0, variance = 0.0, n = 0.0;
};

std::vector<SpeedMean> means_of(const std::vector<Point>& ascending, int side) {
  std::vector<SpeedMean> out;
  for (const Point& p : side_of(ascending, side)) {
    const double v = std::abs(p.v);
    if (out.empty() || v > (1.0 + kOneSpeed) * out.back().v / out.back().n) out.push_back({});
    SpeedMean& m = out.back();
    m.n += 1.0, m.v += v, m.f += p.v > 0.0 ? p.f : -p.f, m.variance += p.error * p.error;
  }
  for (SpeedMean& m : out) m.v /= m.n, m.f /= m.n, m.variance /= m.n * m.n;
  return out;
}

/// A step between two neighbouring speeds that no friction curve has: another day.
struct Jump {
  double below = 0.0, above = 0.0;  // [m/s]
  double share = 0.0;               // of the force, signed
  double errors = 0.0;              // its size in standard errors
};

std::vector<Jump> jumps_of(const std::vector<SpeedMean>& mean) {
  constexpr double kLargest = 1.6;    // ratio of the two speeds
  constexpr double kVisible = 0.06;   // of the force
  constexpr double kSteeper = 2.0;    // than the neighbours, per ratio of speeds
  constexpr double kErrors = 2.0;     // of one direction
  constexpr std::size_t kFewest = 3;  // speeds on either side
  std::vector<Jump> out;
  const auto slope = [&](std::size_t i) {
    return (mean[i + 1].f - mean[i].f) / std::log(mean[i + 1].v / mean[i].v);
  };
  for (std::size_t j = kFewest - 1; j + kFewest < mean.size(); ++j) {
    const SpeedMean& a = mean[j];
    const SpeedMean& b = mean[j + 1];
    const double share = (b.f - a.f) / (0.5 * (std::abs(a.f) + std::abs(b.f)));
    const double errors = std::abs(b.f - a.f) / std::sqrt(a.variance + b.variance);
    const double beside = std::max(std::abs(slope(j - 1)), std::abs(slope(j + 1)));
    if (b.v <= kLargest * a.v && std::abs(share) > kVisible && std::abs(slope(j)) > kSteeper * beside &&
        errors > kErrors) {
      out.push_back({a.v, b.v, share, errors});
    }
  }
  return out;
}

/// The largest step that both directions have between the same speeds and in the same sense.
std::optional<Jump> find_jump(const std::vector<Point>& ascending) {
  constexpr double kBoth = 5.0;  // standard errors of both directions together
  std::optional<Jump> found;
  const std::vector<Jump> backward = jumps_of(means_of(ascending, 1));
  for (const Jump& a : jumps_of(means_of(ascending, 0))) {
    for (const Jump& b : backward) {
      const double below = std::max(a.below, b.below);
      const double above = std::min(a.above, b.above);
      const double errors = std::hypot(a.errors, b.errors);
      if (below >= above || a.share * b.share <= 0.0 || errors < kBoth) continue;
      const double share = 0.5 * (a.share + b.share);
      if (!found || std::abs(share) > std::abs(found->share)) found = Jump{below, above, share, errors};
    }
  }
  return found;
}

std::size_t number_folds(std::vector<Point>& points) {
  std::stable_sort(points.begin(), points.end(),
                   [](const Point& a, const Point& b) { return std::abs(a.v) < std::abs(b.v); });
  std::size_t folds = 0;
  double first = 0.0;
  for (Point& p : points) {
    if (folds == 0 || std::abs(p.v) > (1.0 + kOneSpeed) * first) {
      first = std::abs(p.v);
      ++folds;
    }
    p.fold = folds - 1;
  }
  return folds;
}

double typical_error(const std::vector<Point>& points) {
  std::vector<double> errors;
  for (const Point& p : points) errors.push_back(p.error);
  const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
  std::nth_element(errors.begin(), middle, errors.end());
  return *middle;
}

void weigh(std::vector<Point>& points) {
  const double typical = typical_error(points);
  if (!(typical > 0.0)) return;
  // The curve errs too: no mean counts more than twice a typical one.
  for (Point& p : points) p.weight = 2.0 * typical * typical / (p.error * p.error + typical * typical);
}

/// Mean square of what a fit leaves, in standard errors of the means; 1 for a true model.
double misfit(const Fit& fit, const std::vector<Point>& points) {
  // No mean is trusted beyond a typical one: what was taken off for the screw has errors too.
  const double typical = typical_error(points);
  if (!(typical > 0.0)) return 0.0;
  double sum = 0.0;
  for (const Point& p : points) sum += std::pow((p.f - fit(p.v)) / std::max(p.error, typical), 2.0);
  return sum / std::max(1.0, static_cast<double>(points.size()) - static_cast<double>(fit.parameters()));
}

struct Chosen {
  Fit fit;
  std::vector<Candidate> candidates;
  double held_out = std::numeric_limits<double>::quiet_NaN();
  bool chosen_by_leaving_out = false;
};

Chosen choose(const std::vector<Point>& points, std::size_t folds, const Fitter& fitter,
              const JogOptions& options, bool both, double low, double high) {
  std::vector<Kind> kinds;
  if (options.terms) {
    kinds.push_back(*options.terms == 0 ? Kind{Family::kLines, 0} : Kind{Family::kGaussians, *options.terms});
  } else {
    kinds = {{Family::kLine, 0}, {Family::kStribeck, 0}, {Family::kFreeStribeck, 0}};
    if (both) {
      for (const Family f : {Family::kLines, Family::kCommonStribeck, Family::kOwnStribeck})
        kinds.push_back({f, 0});
      for (int n = 1; options.gaussians && n <= kMostGaussians; ++n) kinds.push_back({Family::kGaussians, n});
    }
  }
  struct Tried {
    Fit fit;
    std::vector<double> loss;  // mean square of each fold
    double mean = 0.0;
  };
  // The fastest speed is not left out: beyond the others a curve is not determined, and rich ones would pay for it.
  const std::size_t judged = folds - 1;
  std::vector<Tried> tried;
  std::vector<Ladders> ladders(folds + 1);  // of each fold left out, the last of all points
  for (const Kind& kind : kinds) {
    const auto whole = fitter.fit(kind, points, ladders.back());
    if (!whole || !opposes(*whole, low, high)) continue;
    Tried t;
    t.fit = *whole;
    bool complete = folds >= kFewestFolds;
    for (std::size_t k = 0; complete && k < judged; ++k) {
      std::vector<Point> rest;
      for (const Point& p : points) {
        if (p.fold != k) rest.push_back(p);
      }
      const auto part = fitter.fit(kind, rest, ladders[k]);
      if (!part) {
        complete = false;
        break;
      }
      double square = 0.0, n = 0.0;
      for (const Point& p : points) {
        if (p.fold == k) square += std::pow(p.f - (*part)(p.v), 2.0), n += 1.0;
      }
      t.loss.push_back(square / n);
    }
    // Too few speeds to leave one out: only the simplest stays.
    if (!complete && !tried.empty()) continue;
    if (!complete) t.loss.clear();
    for (const double l : t.loss) t.mean += l / static_cast<double>(t.loss.size());
    tried.push_back(std::move(t));
  }
  if (tried.empty()) {
    throw Refused(text("jog: %zu mean forces at %zu speeds do not give a friction that opposes the motion%s",
                       points.size(), folds, options.terms ? "; fewer Gaussians need fewer speeds" : ""));
  }
  Chosen out;
  std::size_t best = 0;
  for (std::size_t i = 1; i < tried.size(); ++i) {
    if (!tried[i].loss.empty() && (tried[best].loss.empty() || tried[i].mean < tried[best].mean)) best = i;
  }
  std::vector<double> error(tried.size(), 0.0);
  std::vector<std::size_t> equal;  // as good held out as the best
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < tried.size(); ++i) {
    double difference = 0.0;
    if (!tried[i].loss.empty() && !tried[best].loss.empty()) {
      const auto n = static_cast<double>(judged);
      difference = tried[i].mean - tried[best].mean;
      double square = 0.0;
      for (std::size_t k = 0; k < judged; ++k) {
        square += std::pow(tried[i].loss[k] - tried[best].loss[k] - difference, 2.0);
      }
      error[i] = std::sqrt(square / (n * (n - 1.0)));
    } else if (i != best) {
      continue;
    }
    if (difference > error[i]) continue;
    equal.push_back(i);
    least = std::min(least, misfit(tried[i].fit, points));
  }
  // Of these the simplest that does not plainly miss what the means say with their small errors.
  std::size_t chosen = best;
  bool found = false;
  for (const std::size_t i : equal) {
    if (misfit(tried[i].fit, points) > std::max(kMisses, 2.0 * least)) continue;
    if (!found || tried[i].fit.parameters() < tried[chosen].fit.parameters()) chosen = i;
    found = true;
  }
  for (std::size_t i = 0; i < tried.size(); ++i) {
    Candidate c;
    c.name = name_of(tried[i].fit.kind);
    c.terms = tried[i].fit.kind.terms;
    c.parameters = static_cast<int>(tried[i].fit.parameters());
    c.held_out_rms =
        tried[i].loss.empty() ? std::numeric_limits<double>::quiet_NaN() : std::sqrt(tried[i].mean);
    c.standard_error = c.held_out_rms > 0.0 ? error[i] / (2.0 * c.held_out_rms) : 0.0;
    c.chosen = i == chosen;
    out.candidates.push_back(std::move(c));
  }
  out.fit = tried[chosen].fit;
  out.chosen_by_leaving_out = !tried[chosen].loss.empty();
  if (out.chosen_by_leaving_out) out.held_out = std::sqrt(tried[chosen].mean);
  return out;
}

/// Half widths of 95 % intervals of anything linear in the parameters.
class Spread {
 public:
  Spread(const Fit& fit, const std::vector<Point>& points) {
    const auto n = static_cast<Index>(points.size());
    const auto p = static_cast<Index>(fit.parameters());
    MatrixXd J(n, p);
    double chi = 0.0;
    for (Index i = 0; i < n; ++i) {
      const Point& q = points[static_cast<std::size_t>(i)];
      J.row(i) = fit.gradient(q.v).transpose();
      chi += q.weight * std::pow(q.f - fit(q.v), 2.0);
    }
    VectorXd w(n), variance(n);
    for (Index i = 0; i < n; ++i) {
      const Point& q = points[static_cast<std::size_t>(i)];
      w(i) = q.weight;
      variance(i) = q.weight * q.weight * q.error * q.error;
    }
    scale_ = VectorXd::Ones(p);
    for (Index j = 0; j < p; ++j) {
      const double length = std::sqrt((w.array() * J.col(j).array().square()).sum());
      if (length > 0.0) scale_(j) = 1.0 / length;
    }
    J = J * scale_.asDiagonal();
    const MatrixXd normal = J.transpose() * w.asDiagonal() * J;
    const MatrixXd inverse = normal.completeOrthogonalDecomposition().pseudoInverse();
    const double freedom = static_cast<double>(n - p);
    if (freedom >= 1.0) {
      left_ = chi / freedom * inverse;
      factor_ = student_factor(freedom);
    }
    means_ = inverse * J.transpose() * variance.asDiagonal() * J * inverse;
  }
  [[nodiscard]] double half_width(const VectorXd& gradient) const {
    const VectorXd g = scale_.asDiagonal() * gradient;
    if (factor_ == 0.0) return std::numeric_limits<double>::quiet_NaN();
    return factor_ * std::sqrt(std::max({0.0, g.dot(left_ * g), g.dot(means_ * g)}));
  }

 private:
  VectorXd scale_;
  MatrixXd left_, means_;
  double factor_ = 0.0;
};

void add_parameters(const Fit& fit, const Spread& spread, Result& r) {
  const auto add = [&](const std::string& name, double value, const char* unit, const char* shown,
                       const VectorXd& g) {
    const double half = spread.half_width(g);
    r.parameters.push_back({name, value, unit, shown, value - half, value + half, half < std::abs(value)});
  };
  const auto n = static_cast<Index>(fit.parameters());
  const auto unit = [&](std::size_t i, double sign_of = 1.0) {
    VectorXd g = VectorXd::Zero(n);
    g(static_cast<Index>(i)) = sign_of;
    return g;
  };
  if (fit.kind.symmetric()) {
    add("alpha0", fit.p[0], "N", "N", unit(0));
    if (fit.kind.family != Family::kLine) {
      add("alpha1", fit.p[0] + fit.p[3], "N", "N", unit(0) + unit(3));
    }
    add("alpha2", fit.p[1], "N s/m", "N s/mm", unit(1));
    if (fit.kind.family != Family::kLine) add("v0", fit.p[4], "m/s", "mm/s", unit(4));
    if (fit.kind.family == Family::kFreeStribeck) add("delta", fit.p[5], "1", "1", unit(5));
    return;
  }
  for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
    const std::string name = side == 0 ? "_positive" : "_negative";
    const double s = side == 0 ? 1.0 : -1.0;
    if (fit.kind.family == Family::kGaussians) {
      const BranchFit& b = fit.branch[side];
      const std::size_t at = side == 0 ? 0 : fit.branch[0].parameters();
      add("eta0" + name, s * b.eta0, "N", "N", unit(at, s));
      add("eta1" + name, b.eta1 / fit.top, "N s/m", "N s/mm", unit(at + 1, 1.0 / fit.top));
      for (std::size_t i = 0; i < b.terms.size(); ++i) {
        const std::string term = "gaussian_" + std::to_string(i + 1);
        add(term + "_a" + name, s * b.terms[i].a, "N", "N", unit(at + 2 + 3 * i, s));
        add(term + "_b" + name, s * b.terms[i].b * fit.top, "m/s", "mm/s", unit(at + 3 + 3 * i, s * fit.top));
        add(term + "_c" + name, b.terms[i].c * fit.top, "m/s", "mm/s", unit(at + 4 + 3 * i, fit.top));
      }
      continue;
    }
    add("eta0" + name, s * fit.p[2 * side], "N", "N", unit(2 * side, s));
    add("eta1" + name, fit.p[2 * side + 1], "N s/m", "N s/mm", unit(2 * side + 1));
    if (fit.kind.family == Family::kLines) continue;
    const std::size_t width = fit.kind.family == Family::kCommonStribeck ? 6 : 6 + side;
    add("gaussian_1_a" + name, s * fit.p[4 + side], "N", "N", unit(4 + side, s));
    add("gaussian_1_c" + name, fit.p[width], "m/s", "mm/s", unit(width));
  }
}

/// For telling days apart: where each record is one run and its speed wandered, the mean of the record stands for
/// each of its pieces.
std::vector<Point> by_record(const std::vector<Point>& points, const std::vector<SteadyRun>& runs,
                             const std::vector<Record>& records) {
  std::vector<Point> out = points;
  for (Point& p : out) {
    const std::size_t record = runs[p.run].record;
    if (!records[record].r.empty()) continue;
    double rows = 0.0, v = 0.0, f = 0.0, slowest = std::abs(p.v), fastest = slowest;
    for (const Point& q : points) {
      if (runs[q.run].record != record || q.v * p.v < 0.0) continue;
      const auto n = static_cast<double>(runs[q.run].last - runs[q.run].first);
      rows += n, v += n * q.v, f += n * q.f;
      slowest = std::min(slowest, std::abs(q.v));
      fastest = std::max(fastest, std::abs(q.v));
    }
    if (fastest < 1.5 * slowest) p.v = v / rows, p.f = f / rows;
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const Point& a, const Point& b) { return std::abs(a.v) < std::abs(b.v); });
  return out;
}

struct Group {
  Result result;
  double residual_rms = 0.0;
};

Group fit_group(std::vector<Point> points, const std::vector<SteadyRun>& runs,
                const std::vector<Record>& records, const JogOptions& options) {
  const std::size_t folds = number_folds(points);
  weigh(points);
  double low = 0.0, high = 0.0;
  std::vector<SteadyRun> own;
  for (const Point& p : points) {
    low = std::min(low, p.v);
    high = std::max(high, p.v);
    own.push_back(runs[p.run]);
  }
  const bool both = low < 0.0 && high > 0.0;
  if (folds < kFewestSpeeds) {
    throw Refused(
        text("jog: %zu different constant speeds, expected at least %zu; excite --method jog writes a motion "
             "through many",
             folds, kFewestSpeeds));
  }
  Group out;
  Result& r = out.result;
  const LoadEstimate load = load_of(own);
  const Fitter fitter(options, both);

  // By direction, and only there, a load must be taken out before.
  double taken = 0.0;
  if (both && !load.pairs.empty()) {
    double friction = 0.0;
    for (const SpeedPair& p : load.pairs) friction += p.friction / static_cast<double>(load.pairs.size());
    if (load.constant || std::abs(load.value) > kTooMuch * std::abs(friction)) taken = load.value;
  }
  // A load of its own is a parameter of the symmetric candidates, so it may be taken out of all alike.
  std::vector<Point> lifted = points;
  for (Point& p : lifted) p.f -= taken;
  Chosen chosen = choose(lifted, folds, fitter, options, both, low, high);
  Fit& fit = chosen.fit;
  const Spread spread(fit, lifted);

  r.method = "jog";
  r.force_unit = records.front().force_unit;
  r.position_unit = records.front().position_unit;
  r.models = std::move(chosen.candidates);
  r.held_out_rms = chosen.held_out;
  r.mass = std::numeric_limits<double>::quiet_NaN();
  if (!both) {
    low = -std::max(-low, high);
    high = -low;
  }
  r.velocity_range = {low, high};
  add_parameters(fit, spread, r);
  if (fit.kind.symmetric()) {
    r.model = "conventional";
    friction::Conventional<double> map;
    map.alpha0 = fit.p[0];
    map.alpha2 = fit.p[1];
    if (fit.kind.family != Family::kLine) {
      map.stribeck = friction::Stribeck<double>{fit.p[0] + fit.p[3], fit.p[4],
                                                fit.kind.family == Family::kFreeStribeck ? fit.p[5] : 2.0};
    }
    if (map.alpha2 < 0.0) {
      r.warnings.push_back(
          "friction falls with the speed over the whole range; a conventional model has no such "
          "viscous coefficient, and an axis file will refuse it");
    }
    r.friction.steady = map;
    r.load = taken + fit.p[2];
    if (both) {
      VectorXd g = VectorXd::Zero(static_cast<Index>(fit.parameters()));
      g(2) = 1.0;
      const double half = spread.half_width(g);
      r.parameters.push_back(
          {"load", r.load, "N", "N", r.load - half, r.load + half, half < std::abs(r.load)});
      r.cannot_tell.push_back(
          "load against a Coulomb friction that differs between the directions: they look the same at "
          "constant speed");
    } else {
      r.cannot_tell.push_back("load, and friction of the other direction: only one direction was run");
      r.warnings.push_back("only one direction was run: the other is taken to be its mirror image");
    }
  } else {
    r.model = "gaussian";
    r.friction.steady = as_map(fit, r.velocity_range);
    r.load = taken;
    if (taken != 0.0) {
      r.parameters.push_back({"load", taken, "N", "N", load.interval.low, load.interval.high,
                              load.interval.low > 0.0 || load.interval.high < 0.0});
      r.cannot_tell.push_back(
          "load against a Coulomb friction that differs between the directions: half the sum of both was "
          "taken for "
          "the load");
    } else {
      r.cannot_tell.push_back(
          text("load: half the sum of both directions, %.4g on average, varies with the speed; "
               "it was taken for friction of each direction",
               load.value));
    }
  }
  if (!chosen.chosen_by_leaving_out && !options.terms) {
    r.warnings.push_back(
        text("%zu speeds are too few to choose a model by leaving one out; the simplest was taken", folds));
  }

  double square = 0.0;
  for (const Point& p : lifted) {
    const SteadyRun& run = runs[p.run];
    const double e = p.f - fit(p.v);
    square += e * e;
    const Record& rec = records[run.record];
    const std::size_t middle = (run.first + run.last) / 2;
    r.residuals.push_back(
        {rec.t[middle], rec.x.empty() ? 0.0 : rec.x[middle], p.v, e, static_cast<int>(run.record)});
    r.map.push_back({p.v, p.f - (r.load - taken), p.v > 0.0 ? 1 : -1});
    r.rows += run.last - run.first + 1;
  }
  out.residual_rms = std::sqrt(square / static_cast<double>(lifted.size()));

  double slow[2] = {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  double fast[2] = {0.0, 0.0};
  for (const Point& p : points) {
    const int side = p.v > 0.0 ? 0 : 1;
    slow[side] = std::min(slow[side], std::abs(p.v));
    fast[side] = std::max(fast[side], std::abs(p.v));
  }
  std::vector<Point> by_speed = points;
  std::stable_sort(by_speed.begin(), by_speed.end(),
                   [](const Point& a, const Point& b) { return std::abs(a.v) < std::abs(b.v); });
  for (const int side : {1, 0}) {
    if (!(fast[side] > 0.0)) continue;
    for (int i = 0; i < options.curve_points; ++i) {
      const int k = side == 0 ? i : options.curve_points - 1 - i;
      const double v = (side == 0 ? 1.0 : -1.0) *
                       (slow[side] + (fast[side] - slow[side]) * k / (options.curve_points - 1));
      VectorXd g = fit.gradient(v);
      if (fit.kind.symmetric()) g(2) = 0.0;
      const double f = fit(v) - (r.load - taken);
      const double half = spread.half_width(g);
      r.curve.push_back({v, f, f - half, f + half});
    }
    // A term narrower than the steps of speed fits any height between them.
    const std::vector<SpeedMean> mean = means_of(by_speed, side);
    std::vector<double> share;  // half width over force, halfway to the next speed
    for (std::size_t i = 0; i + 1 < mean.size(); ++i) {
      const double v = (side == 0 ? 0.5 : -0.5) * (mean[i].v + mean[i + 1].v);
      VectorXd g = fit.gradient(v);
      if (fit.kind.symmetric()) g(2) = 0.0;
      share.push_back(spread.half_width(g) / std::max(std::abs(fit(v) - (r.load - taken)), 1e-300));
    }
    if (share.empty()) continue;
    const auto widest = std::max_element(share.begin(), share.end());
    const auto at = static_cast<std::size_t>(widest - share.begin());
    const double most = *widest;
    std::nth_element(share.begin(), share.begin() + static_cast<std::ptrdiff_t>(share.size() / 2),
                     share.end());
    if (most > std::max(kOpen, kOpenBeside * share[share.size() / 2])) {
      r.cannot_tell.push_back(
          text("friction between %.4g and %.4g mm/s%s: it bends more than these speeds show; jog at %.4g "
               "mm/s as well",
               1e3 * mean[at].v, 1e3 * mean[at + 1].v, side == 0 ? "" : " of the negative direction",
               0.5e3 * (mean[at].v + mean[at + 1].v)));
    }
  }
  return out;
}

/// Records that move without holding a speed: they tell the mass.
std::vector<Record> moving_records(const std::vector<Record>& records, const SteadyRuns& found) {
  constexpr double kMostlySteady = 0.3;
  std::vector<Record> out;
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (records[i].x.empty()) continue;
    double steady = 0.0;
    for (const SteadyRun& run : found.runs) {
      if (run.record == i) steady += static_cast<double>(run.last - run.first + 1);
    }
    const auto [low, high] = std::minmax_element(records[i].x.begin(), records[i].x.end());
    if (steady < kMostlySteady * static_cast<double>(records[i].t.size()) && *high > *low)
      out.push_back(records[i]);
  }
  return out;
}

}  // namespace

Jog identify_jog(const std::vector<Record>& records, const JogOptions& options) {
  if (records.empty()) throw Refused("jog: no record given");
  for (const Record& r : records) {
    if (r.force_unit != records.front().force_unit || r.position_unit != records.front().position_unit) {
      throw Refused(r.source + ": its units differ from those of " + records.front().source +
                    "; identify them apart");
    }
  }
  const SteadyRuns found = find_steady_runs(records, options.steady);
  Jog jog;
  jog.runs = found.runs;
  if (found.runs.empty()) {
    throw Refused("jog: no stretch of constant speed was found; excite --method jog writes such a motion" +
                  (found.notes.empty() ? std::string() : " (" + found.notes.front() + ")"));
  }
  std::vector<Point> points;
  for (std::size_t i = 0; i < found.runs.size(); ++i) {
    const SteadyRun& run = found.runs[i];
    points.push_back({run.speed, run.force, run.error, 1.0, 0, i});
  }
  number_folds(points);

  std::vector<std::vector<Point>> groups{points};
  std::string jump_said;
  const std::vector<Point> whole = by_record(points, found.runs, records);
  if (const auto jump = find_jump(whole)) {
    const bool angle = records.front().position_unit == "rad";
    const double scale = angle ? 1.0 : 1e3;
    groups.assign(2, {});
    for (const Point& p : points) {
      const auto same =
          std::find_if(whole.begin(), whole.end(), [&](const Point& q) { return q.run == p.run; });
      const Point& judged = same != whole.end() ? *same : p;
      groups[std::abs(judged.v) > jump->below ? 0 : 1].push_back(p);
    }
    jump_said = text(
        "friction jumps by %+.0f %% in both directions between %.4g and %.4g %s, which no friction curve "
        "does: two "
        "measuring days or states of the machine; the %zu runs below and the %zu runs above are identified "
        "apart",
        100.0 * jump->share, jump->below * scale, jump->above * scale, angle ? "rad/s" : "mm/s",
        groups[1].size(), groups[0].size());
    if (groups[1].size() > groups[0].size()) std::swap(groups[0], groups[1]);
  }
  std::vector<Group> fitted;
  for (const auto& g : groups) {
    try {
      fitted.push_back(fit_group(g, found.runs, records, options));
    } catch (const Refused& e) {
      if (fitted.empty()) throw;
      jump_said += text("; the smaller group: %s", e.what());
    }
  }
  jog.result = fitted.front().result;
  jog.residual_rms = fitted.front().residual_rms;
  for (std::size_t i = 1; i < fitted.size(); ++i) jog.groups.push_back(fitted[i].result);

  Result& r = jog.result;
  if (!jump_said.empty()) r.warnings.insert(r.warnings.begin(), jump_said);
  r.warnings.insert(r.warnings.end(), found.notes.begin(), found.notes.end());
  if (found.periodic) {
    const auto& e = *found.periodic;
    const double half = 1.96 * found.periodic_error;
    r.friction.eccentric.push_back(e);
    r.parameters.push_back(
        {"eta2", e.amplitude, "N", "N", e.amplitude - half, e.amplitude + half, half < e.amplitude});
    const double nan = std::numeric_limits<double>::quiet_NaN();
    r.parameters.push_back({"period", e.period, "m", "mm", nan, nan, true});
    r.parameters.push_back(
        {"eta3", e.phase, "rad", "rad", e.phase - half / e.amplitude, e.phase + half / e.amplitude, true});
    r.warnings.push_back("the phase of the periodic term belongs to this homing of the axis");
  }
  if (std::isfinite(found.relaxation)) {
    r.break_away_distance = found.relaxation;
  } else {
    r.cannot_tell.push_back("pre-sliding: no reversal is resolved by the rows");
  }
  if (options.mass) {
    r.mass = *options.mass;
    r.mass_interval = {*options.mass, *options.mass};
  } else {
    EqualSpeedOptions equal;
    equal.exclude = std::max(found.exclude, 20e-6);
    if (found.periodic) equal.periods = {found.periodic->period};
    const std::vector<Record> moving = moving_records(records, found);
    MassEstimate mass;
    if (!moving.empty()) mass = mass_at_equal_speed(moving, equal);
    if (std::isfinite(mass.value) && mass.interval.low > 0.0) {
      r.mass = mass.value;
      r.mass_interval = mass.interval;
      r.parameters.insert(r.parameters.begin(),
                          {"mass", mass.value, "kg", "N s2/mm", mass.interval.low, mass.interval.high, true});
    } else if (moving.empty()) {
      r.cannot_tell.push_back("mass: constant speeds say nothing about it (add the log of a sine)");
    } else {
      r.cannot_tell.push_back(
          "mass: the records without constant speed accelerate too little, or their force does not "
          "follow the acceleration");
    }
  }
  return jog;
}

}  // namespace stribeck::ident
