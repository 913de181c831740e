#include <ceres/tiny_solver.h>
#include <ceres/tiny_solver_autodiff_function.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stribeck/core/numbers.hpp>
#include <stribeck/ident/map/steady_runs.hpp>
#include <stribeck/ident/methods/least_squares_a.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/stats/linear.hpp>
#include <stribeck/ident/stats/quantiles.hpp>
#include <stribeck/ident/stats/simplex.hpp>

namespace stribeck::ident::methods {
namespace {

constexpr double kPole = 20.0;  // of the disturbance observer [rad/s]
constexpr double kWander =
    0.2;  // share of the Coulomb force in one second: random walk of the Kalman estimate
constexpr double kExplained = 0.5;  // share of the squares at low speeds that a Stribeck part must explain
constexpr std::size_t kFewest = 3;  // speeds

/// d̂ of the disturbance observer, row by row.
std::vector<double> observe(const log::Record& rec, double mass) {
  std::vector<double> d(rec.x.size(), 0.0);
  const double T = rec.sample_time;
  double speed = 0.0, estimate = 0.0;
  for (std::size_t k = 1; k < rec.x.size(); ++k) {
    const double v = (rec.x[k] - rec.x[k - 1]) / T;
    const double force =
        0.5 * (rec.f[k - 1] + rec.f[k > 1 ? k - 2 : 0]);  // force over the time for which v is a mean
    const double change = (force - estimate) / mass - 2.0 * kPole * (speed - v);
    estimate += T * kPole * kPole * mass * (speed - v);
    speed += T * change;
    d[k] = estimate;
  }
  return d;
}

/// d̂ of a Kalman filter on position, velocity and disturbance.
std::vector<double> filter(const log::Record& rec, double mass, double walk, double position_noise) {
  std::vector<double> d(rec.x.size(), 0.0);
  const double T = rec.sample_time;
  Eigen::Matrix3d A;
  A << 1.0, T, -0.5 * T * T / mass, 0.0, 1.0, -T / mass, 0.0, 0.0, 1.0;
  const Eigen::Vector3d b(0.5 * T * T / mass, T / mass, 0.0);
  Eigen::Vector3d s(rec.x.front(), 0.0, 0.0);
  Eigen::Matrix3d P = Eigen::Vector3d(position_noise * position_noise, 0.0, walk).asDiagonal();
  for (std::size_t k = 1; k < rec.x.size(); ++k) {
    s = A * s + b * rec.f[k - 1];
    P = A * P * A.transpose();
    P(2, 2) += walk * T;
    const Eigen::Vector3d gain = P.col(0) / (P(0, 0) + position_noise * position_noise);
    s += gain * (rec.x[k] - s(0));
    P -= (gain * P.row(0)).eval();
    P = 0.5 * (P + P.transpose()).eval();
    d[k] = s(2);
  }
  return d;
}

double mean_of(const std::vector<double>& d, const map::SteadyRun& run) {
  double sum = 0.0;
  for (std::size_t k = run.first; k <= run.last; ++k) sum += d[k];
  return sum / static_cast<double>(run.last - run.first + 1);
}

struct Level {
  double speed, force;  // magnitudes; force above the straight line
};

/// rise·exp(−(v/v0)^δ), with all three parameters as logarithms.
struct Rise {
  const std::vector<Level>& levels;
  [[nodiscard]] int NumResiduals() const { return static_cast<int>(levels.size()); }
  template <class T>
  bool operator()(const T* p, T* residuals) const {
    using std::exp;
    using std::log;
    for (std::size_t i = 0; i < levels.size(); ++i) {
      residuals[i] = exp(p[0]) * exp(-exp(exp(p[2]) * (log(levels[i].speed) - p[1]))) - levels[i].force;
    }
    return true;
  }
};

std::optional<friction::Stribeck<double>> fit_rise(const std::vector<Level>& levels, double alpha0,
                                                   Solver solver) {
  double highest = 0.0, none = 0.0, slowest = std::numeric_limits<double>::infinity(), fastest = 0.0;
  for (const Level& l : levels) {
    highest = std::max(highest, l.force);
    none += l.force * l.force;
    slowest = std::min(slowest, l.speed);
    fastest = std::max(fastest, l.speed);
  }
  if (levels.size() < 5 || !(highest > 0.0)) return {};
  const Rise rise{levels};
  const auto cost = [&](const std::vector<double>& p) {
    std::vector<double> e(levels.size());
    rise(p.data(), e.data());
    double sum = 0.0;
    for (const double x : e) sum += x * x;
    const bool outside =
        p[1] < std::log(slowest) || p[1] > std::log(fastest) || p[2] < std::log(0.5) || p[2] > std::log(4.0);
    return outside ? std::numeric_limits<double>::infinity() : sum;
  };
  std::vector<double> best;
  double least = std::numeric_limits<double>::infinity();
  for (const double v0 : {1.5, 3.0, 6.0, 12.0}) {
    const std::vector<double> start{std::log(highest), std::log(std::min(0.9 * fastest, v0 * slowest)),
                                    std::log(1.5)};
    std::vector<double> found = start;
    if (solver == Solver::kSimplex) {
      found = stats::minimise_simplex(cost, start, {0.2, 0.2, 0.2}).x;
    } else {
      using Function = ceres::TinySolverAutoDiffFunction<Rise, Eigen::Dynamic, 3>;
      const Function function(rise);
      Eigen::Vector3d p(start[0], start[1], start[2]);
      ceres::TinySolver<Function> descent;
      descent.Solve(function, &p);
      found = {p(0), p(1), p(2)};
    }
    if (const double c = cost(found); c < least) least = c, best = found;
  }
  if (best.empty() || !(least < (1.0 - kExplained) * none)) return {};
  return friction::Stribeck<double>{alpha0 + std::exp(best[0]), std::exp(best[1]), std::exp(best[2])};
}

ViscousCorrection correct(const std::vector<ObservedFriction>& jogs, double ObservedFriction::*which,
                          const LeastSquaresAOptions& options) {
  // One slope for both directions, a level for each.
  constexpr double kShare = 0.2;
  double top = 0.0;
  for (const ObservedFriction& j : jogs) top = std::max(top, std::abs(j.speed));
  const double from = std::min(options.viscous_from, kShare * top);
  std::vector<const ObservedFriction*> fast;
  for (const ObservedFriction& j : jogs) {
    if (std::abs(j.speed) >= (1.0 - 1e-3) * from) fast.push_back(&j);
  }
  const auto n = static_cast<Eigen::Index>(fast.size());
  Eigen::MatrixXd X = Eigen::MatrixXd::Zero(n, 3);
  Eigen::VectorXd f(n);
  Eigen::VectorXd variance(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const ObservedFriction& j = *fast[static_cast<std::size_t>(i)];
    X(i, j.speed > 0.0 ? 0 : 1) = 1.0;
    X(i, 2) = j.speed;
    f(i) = j.*which;
    variance(i) = j.error * j.error;
  }
  const stats::LeastSquares solution = stats::least_squares(X, f);
  if (solution.rank < 3 || n < 4) {
    throw Refused("least squares A: jogs at " + std::to_string(n) +
                  " speeds fast enough for the viscous correction, expected at least two in each direction");
  }
  const Eigen::Vector3d p = solution.x;
  const Eigen::VectorXd e = f - X * p;
  const Eigen::Matrix3d inverse = (X.transpose() * X).inverse();
  const double left = e.squaredNorm() / static_cast<double>(n - 3) * inverse(2, 2);
  const double means = (inverse * X.transpose() * variance.asDiagonal() * X * inverse)(2, 2);
  const double half = stats::student_factor(static_cast<double>(n - 3)) * std::sqrt(std::max(left, means));
  ViscousCorrection out;
  out.alpha0_positive = p(0);
  out.alpha0_negative = p(1);
  out.alpha2 = p(2);
  out.alpha2_interval = {p(2) - half, p(2) + half};
  std::vector<Level> levels;
  for (const ObservedFriction& j : jogs) {
    const double s = j.speed > 0.0 ? 1.0 : -1.0;
    levels.push_back({std::abs(j.speed), s * (j.*which - p(2) * j.speed - (s > 0.0 ? p(0) : p(1)))});
  }
  const double alpha0 = 0.5 * (p(0) - p(1));
  if (alpha0 > 0.0) out.stribeck = fit_rise(levels, alpha0, options.solver);
  return out;
}

/// Means of both observers at every constant speed.
std::vector<ObservedFriction> observe_jogs(const std::vector<log::Record>& jogs, const map::SteadyRuns& found,
                                           const LeastSquaresA& pulses) {
  std::vector<ObservedFriction> out;
  const double level = 0.5 * (std::abs(pulses.alpha0_positive) + std::abs(pulses.alpha0_negative));
  for (std::size_t r = 0; r < jogs.size(); ++r) {
    const log::Record rec = map::with_positions(jogs[r]);
    double step = std::numeric_limits<double>::infinity();
    for (std::size_t k = 1; k < rec.x.size(); ++k) {
      if (rec.x[k] != rec.x[k - 1]) step = std::min(step, std::abs(rec.x[k] - rec.x[k - 1]));
    }
    if (!std::isfinite(step)) continue;
    const std::vector<double> observer = observe(rec, pulses.mass_exact);
    const std::vector<double> kalman =
        filter(rec, pulses.mass_exact, kWander * kWander * level * level, step / std::sqrt(12.0));
    for (const map::SteadyRun& run : found.runs) {
      if (run.record == r)
        out.push_back({run.speed, mean_of(observer, run), mean_of(kalman, run), run.error});
    }
  }
  return out;
}

/// Replaces the friction from pulses by the corrected one; the mass stays.
void write_parameters(const LeastSquaresA& out, const std::vector<std::string>& notes, Result& r) {
  const ViscousCorrection& c = *out.observer;
  r.warnings.push_back(
      "viscous coefficient and Coulomb forces come from the jogs; alpha2_pulses is the coefficient from the pulses alone");
  r.warnings.insert(r.warnings.end(), notes.begin(), notes.end());
  const Parameter from_pulses = r.parameters[1];
  r.parameters.resize(1);
  const auto add = [&](const char* name, double value, const char* unit, const char* shown,
                       const Interval& i) {
    r.parameters.push_back({name, value, unit, shown, i.low, i.high, true});
  };
  add("alpha2", c.alpha2, "N s/m", "N s/mm", c.alpha2_interval);
  add("alpha0_positive", c.alpha0_positive, "N", "N", {kNaN, kNaN});
  add("alpha0_negative", c.alpha0_negative, "N", "N", {kNaN, kNaN});
  if (c.stribeck) {
    add("alpha1", c.stribeck->alpha1, "N", "N", {kNaN, kNaN});
    add("v0", c.stribeck->v0, "m/s", "mm/s", {kNaN, kNaN});
    add("delta", c.stribeck->delta, "1", "1", {kNaN, kNaN});
  }
  add("alpha2_kalman", out.kalman->alpha2, "N s/m", "N s/mm", out.kalman->alpha2_interval);
  r.parameters.push_back(from_pulses);
  r.parameters.back().name = "alpha2_pulses";
}

void write_law(const ViscousCorrection& c, Result& r) {
  if (c.stribeck) {
    friction::Conventional<double> map;
    map.alpha0 = 0.5 * (c.alpha0_positive - c.alpha0_negative);
    map.alpha2 = c.alpha2;
    map.stribeck = c.stribeck;
    r.friction.steady = map;
    r.load = 0.5 * (c.alpha0_positive + c.alpha0_negative);
    r.parameters.push_back({"load", r.load, "N", "N", kNaN, kNaN, true});
    r.cannot_tell.push_back(
        "load and a Coulomb friction that differs between the directions cannot be distinguished: half the sum of both was taken as the load");
  } else {
    friction::Gaussian<double> map;
    map.velocity_range = r.velocity_range;
    map.positive.eta0 = c.alpha0_positive;
    map.negative.eta0 = c.alpha0_negative;
    map.positive.eta1 = map.negative.eta1 = c.alpha2;
    r.friction.steady = map;
  }
}

void write_curve(const std::vector<ObservedFriction>& jogs, const ViscousCorrection& c, int points,
                 Result& r) {
  const auto force = [&](double v) {
    const double s = v > 0.0 ? 1.0 : -1.0;
    const double rise = c.stribeck ? (c.stribeck->alpha1 - 0.5 * (c.alpha0_positive - c.alpha0_negative)) *
                                         std::exp(-std::pow(std::abs(v) / c.stribeck->v0, c.stribeck->delta))
                                   : 0.0;
    return (v > 0.0 ? c.alpha0_positive : c.alpha0_negative) + s * rise + c.alpha2 * v;
  };
  r.curve.clear();
  r.map.clear();
  for (const int side : {1, 0}) {
    for (int i = 0; i < points; ++i) {
      const double share = static_cast<double>(side == 0 ? i + 1 : points - i) / points;
      const double v = share * (side == 0 ? r.velocity_range[1] : r.velocity_range[0]);
      const double f = force(v) - r.load;
      r.curve.push_back({v, f, kNaN, kNaN});
    }
  }
  for (const ObservedFriction& j : jogs)
    r.map.push_back({j.speed, j.observer - r.load, j.speed > 0.0 ? 1 : -1});
}

}  // namespace

LeastSquaresA identify_least_squares_a(const std::vector<log::Record>& pulses,
                                       const std::vector<log::Record>& jogs,
                                       const LeastSquaresAOptions& options) {
  LeastSquaresA out = identify_least_squares_a(pulses, options);
  if (jogs.empty()) return out;
  const map::SteadyRuns found = map::find_steady_runs(jogs);
  if (found.runs.size() < 2 * kFewest) {
    throw Refused("least squares A: " + std::to_string(found.runs.size()) +
                  " stretches of constant speed in the jogs, expected at least 6 (excite --method jog)");
  }
  out.jogs = observe_jogs(jogs, found, out);
  out.observer = correct(out.jogs, &ObservedFriction::observer, options);
  out.kalman = correct(out.jogs, &ObservedFriction::kalman, options);
  Result& r = out.result;
  write_parameters(out, found.notes, r);
  double slowest = 0.0, fastest = 0.0;
  for (const ObservedFriction& j : out.jogs)
    slowest = std::min(slowest, j.speed), fastest = std::max(fastest, j.speed);
  r.velocity_range = {slowest, fastest};
  write_law(*out.observer, r);
  write_curve(out.jogs, *out.observer, options.curve_points, r);
  return out;
}

}  // namespace stribeck::ident::methods
