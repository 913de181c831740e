#include <fmt/core.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stribeck/core/number_text.hpp>
#include <stribeck/ident/drive/intervals/open_model.hpp>
#include <stribeck/ident/drive/summary.hpp>
#include <stribeck/ident/stats/linear.hpp>
#include <string>
#include <variant>
#include <vector>

namespace stribeck::ident::drive {
namespace {

constexpr double kFactor = 1.96;           // half width of a printed interval in standard errors
constexpr double kLeast = 1e-8;            // share of a variance that is rounding
constexpr double kMostOfPreSliding = 0.7;  // of the logarithm
constexpr double kUsualRiseSpeed = 2e-3;   // [m/s] where no Stribeck part was found
constexpr double kWorthRise = 1.5;         // errors of usual size
constexpr double kSlowestRise = 2.0;       // slowest rows
constexpr double kFastestRise = 0.2;       // of the top speed
constexpr double kLeastWidening = 0.5, kMostWidening = 3.0;
constexpr Index kOfSide = 3;  // level, viscous, rise
constexpr Index kFigures = 1 + map::kSides * kOfSide;

/// Four digits, so that files can be read.
double rounded(double x) { return number_in(fmt::format("{:.4g}", x)) + 0.0; }  // no −0

/// Mass and the points of the curve.
struct Points {
  std::vector<VectorXd> slopes;  ///< derivatives by θ
  VectorXd error;                ///< printed standard errors
  std::vector<int> side;         ///< −1: the mass
  std::vector<double> speed;     ///< [m/s]
  [[nodiscard]] Index size() const { return error.size(); }
};

Points points_of(const Found& found, const Result& result) {
  const map::StaticFit& map = found.choice.map.fit;
  Points out;
  std::vector<double> errors;
  const auto add = [&](VectorXd slope, double half, int side, double speed) {
    out.slopes.push_back(std::move(slope));
    errors.push_back(half / kFactor);
    out.side.push_back(side);
    out.speed.push_back(speed);
  };
  VectorXd mass = found.intervals.zero();
  mass(0) = 1.0;
  add(std::move(mass), found.terms.known_mass ? 0.0 : result.mass_interval.high - result.mass, -1, 0.0);
  // The error of the split into load and friction does not affect their sum.
  const double of_load = found.load ? found.intervals.factor * found.load->error : 0.0;
  const auto add_friction = [&](double whole, int side, double speed) {
    if (!std::isfinite(whole) || !(whole > 0.0)) return;
    const double half = std::sqrt(std::max(whole * whole - of_load * of_load, kLeast * whole * whole));
    const Figure f = friction_at(map, side, speed);
    VectorXd h = found.intervals.zero();
    h.segment(static_cast<Index>(found.intervals.linear + map.span(side).first), f.slope.size()) = f.slope;
    add(std::move(h), half, side, speed);
  };
  for (int s = 0; s < map::kSides; ++s) {
    const Parameter* rest = result.find(std::string("static_") + map::kSideName[static_cast<std::size_t>(s)]);
    if (rest != nullptr && rest->identifiable) add_friction(rest->ci_high - rest->value, s, 0.0);
  }
  for (const CurvePoint& p : result.curve)
    add_friction(p.ci_high - p.friction, p.velocity < 0.0 ? 1 : 0, std::abs(p.velocity));
  out.error = Eigen::Map<const VectorXd>(errors.data(), static_cast<Index>(errors.size()));
  return out;
}

/// Correlations of the points.
MatrixXd correlations(const Points& points, const Intervals& intervals) {
  const Index n = points.size();
  MatrixXd H(n, intervals.long_run.rows());
  for (Index i = 0; i < n; ++i) H.row(i) = points.slopes[static_cast<std::size_t>(i)].transpose();
  MatrixXd most = MatrixXd::Zero(n, n);
  double largest = -1.0;
  for (const MatrixXd* form :
       {&intervals.long_run, &intervals.stationary, &intervals.between, &intervals.folds}) {
    const MatrixXd C = H * *form * H.transpose();
    double sum = 0.0;
    for (Index i = 0; i < n; ++i) {
      if (points.error(i) > 0.0) sum += C(i, i) / (points.error(i) * points.error(i));
    }
    if (sum > largest) largest = sum, most = C;
  }
  for (const VectorXd* bias : {&intervals.unsettled, &intervals.filtered, &intervals.held}) {
    const VectorXd moved = H * *bias;
    most += moved * moved.transpose();
  }
  const VectorXd own = most.diagonal().cwiseMax(0.0).cwiseSqrt();
  for (Index i = 0; i < n; ++i) {
    for (Index k = 0; k < n; ++k) {
      if (i != k) most(i, k) = own(i) > 0.0 && own(k) > 0.0 ? most(i, k) / (own(i) * own(k)) : 0.0;
    }
  }
  most.diagonal().setOnes();
  return most;
}

/// The rise over the speed as deviate() will draw it: a map's own Stribeck part, or a Gaussian of this width.
struct RiseShape {
  double speed = 1e-3;
  double exponent = 2.0;

  RiseShape(const friction::Model& model, double rise_speed) : speed(rise_speed) {
    const auto* map = std::get_if<friction::Conventional<double>>(&model.steady);
    if (map == nullptr || !map->stribeck) return;
    speed = map->stribeck->v0;
    exponent = map->stribeck->delta;
  }
  [[nodiscard]] double at(double v) const { return std::exp(-std::pow(v / speed, exponent)); }
};

/// Mass and three figures of each direction as linear functions of the points.
MatrixXd figures_of(const Points& points, const RiseShape& rise) {
  MatrixXd T = MatrixXd::Zero(kFigures, points.size());
  // With the square of this, the slow end of the curve, which is told least, would count for nothing.
  const auto weight = [&](Index i) { return 1.0 / std::sqrt(points.error(i)); };
  T(0, 0) = 1.0;
  for (int s = 0; s < map::kSides; ++s) {
    std::vector<Index> own;
    for (Index i = 0; i < points.size(); ++i) {
      if (points.side[static_cast<std::size_t>(i)] == s) own.push_back(i);
    }
    if (static_cast<Index>(own.size()) < kOfSide) continue;
    const auto n = static_cast<Index>(own.size());
    MatrixXd basis(n, kOfSide);
    double top = 0.0;
    for (const Index i : own) top = std::max(top, points.speed[static_cast<std::size_t>(i)]);
    for (Index i = 0; i < n; ++i) {
      const Index at = own[static_cast<std::size_t>(i)];
      const double v = points.speed[static_cast<std::size_t>(at)];
      basis.row(i) << 1.0, v / top, rise.at(v);
      basis.row(i) *= weight(at);
    }
    const MatrixXd inverse = stats::pseudo_inverse(basis);
    for (Index i = 0; i < n; ++i) {
      const Index at = own[static_cast<std::size_t>(i)];
      const Index first = 1 + s * kOfSide;
      T(first, at) = inverse(0, i) * weight(at);
      T(first + 1, at) = inverse(1, i) * weight(at) / top;
      T(first + 2, at) = inverse(2, i) * weight(at);
    }
  }
  return T;
}

/// Factor on the figures of a direction that makes its curve as uncertain as the printed intervals, in the mean square over the speeds.
/// Errors that change fast with speed (a misfit of the map) are no level, slope or rise, and would be missing.
double widening(const Points& points, const MatrixXd& C, const RiseShape& rise, int side) {
  double ratio = 0.0, count = 0.0;
  for (Index i = 0; i < points.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (points.side[k] != side) continue;
    const Eigen::Vector3d shape(1.0, points.speed[k], rise.at(points.speed[k]));
    const Index first = 1 + side * kOfSide;
    const double own = shape.dot(C.block<kOfSide, kOfSide>(first, first) * shape);
    ratio += own / (points.error(i) * points.error(i));
    count += 1.0;
  }
  return ratio > 0.0 ? std::clamp(std::sqrt(count / ratio), kLeastWidening, kMostWidening) : 1.0;
}

friction::ModelDeviation as_deviation(const VectorXd& y) {
  friction::ModelDeviation d;
  d.mass = rounded(y(0));
  for (std::size_t s = 0; s < map::kSides; ++s) {
    const auto first = static_cast<Index>(1 + s * kOfSide);
    d.level[s] = rounded(y(first));
    d.viscous[s] = rounded(y(first + 1));
    d.rise[s] = rounded(y(first + 2));
  }
  return d;
}

/// Speed at which the error of friction has come down from its value at the slowest speed to its usual size, but for 1/e of the
/// difference [m/s]; 0: it is no larger at slow speeds.
double fading_speed(const Points& points, int side) {
  std::vector<std::pair<double, double>> at;
  for (Index i = 0; i < points.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (points.side[k] == side) at.emplace_back(points.speed[k], points.error(i));
  }
  if (at.size() < 3) return 0.0;
  std::sort(at.begin(), at.end());
  std::vector<double> errors;
  for (const auto& [speed, error] : at) errors.push_back(error);
  std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2),
                   errors.end());
  const double usual = errors[errors.size() / 2], most = at.front().second;
  if (!(most > kWorthRise * usual)) return 0.0;
  const double faded = usual + (most - usual) / std::exp(1.0);
  for (const auto& [speed, error] : at) {
    if (error <= faded) return speed;
  }
  return 0.0;
}

/// Smallest speed whose friction is told [m/s]; 0: down to rest.
double told_from(const Result& result) {
  double from = 0.0;
  for (int s = 0; s < map::kSides; ++s) {
    const Parameter* rest = result.find(std::string("static_") + map::kSideName[static_cast<std::size_t>(s)]);
    if (rest != nullptr && rest->identifiable) continue;
    double slowest = std::numeric_limits<double>::infinity();
    for (const CurvePoint& p : result.curve) {
      if ((p.velocity < 0.0) == (s == 1)) slowest = std::min(slowest, std::abs(p.velocity));
    }
    if (std::isfinite(slowest)) from = std::max(from, slowest);
  }
  return rounded(from);
}

double rise_speed(const Found& found, const Result& result, const Points& points) {
  double sum = 0.0, known = 0.0;
  const auto add = [&](double speed) {
    if (speed > 0.0) sum += speed, known += 1.0;
  };
  for (int s = 0; s < map::kSides; ++s) add(fading_speed(points, s));
  if (known == 0.0) {
    for (const char* name : {"stribeck_speed_positive", "stribeck_speed_negative"}) {
      if (const Parameter* p = result.find(name)) add(p->value);
    }
  }
  const double top = std::max(found.rows.grid[0].high, found.rows.grid[1].high);
  const double slowest = std::max(found.rows.grid[0].low, found.rows.grid[1].low);
  // Of an angle no speed is usual.
  const bool turns = found.log.records.front().turns();
  const double usual = std::max(turns ? 0.0 : kUsualRiseSpeed, kSlowestRise * slowest);
  return rounded(std::min(known > 0.0 ? sum / known : usual, kFastestRise * top));
}

/// Standard deviation of the logarithm of a parameter of pre-sliding; 0: the model does not have it.
double log_error(const Result& result, const char* of_lugre, const char* of_gms) {
  for (const char* name : {of_lugre, of_gms}) {
    const Parameter* p = result.find(name);
    if (p == nullptr || !(p->value > 0.0)) continue;
    if (!(p->ci_low > 0.0) || !std::isfinite(p->ci_high)) return kMostOfPreSliding;
    return std::min(std::log(p->ci_high / p->ci_low) / (2.0 * kFactor), kMostOfPreSliding);
  }
  return 0.0;
}

}  // namespace

std::optional<friction::ModelUncertainty> open_model(const Found& found, const Result& result) {
  if (result.force_unit != "N" || result.position_unit != "m" || result.curve.empty()) return std::nullopt;
  const Points points = points_of(found, result);
  if (points.size() < 2 || !points.error.allFinite()) return std::nullopt;
  friction::ModelUncertainty out;
  out.rise_speed = rise_speed(found, result, points);
  out.told_from = told_from(result);
  const MatrixXd R = correlations(points, found.intervals);
  const RiseShape rise(result.friction, out.rise_speed);
  const MatrixXd T = figures_of(points, rise);
  MatrixXd C = T * points.error.asDiagonal() * R * points.error.asDiagonal() * T.transpose();
  if (!C.allFinite()) return std::nullopt;
  VectorXd wider = VectorXd::Ones(kFigures);
  for (int s = 0; s < map::kSides; ++s)
    wider.segment<kOfSide>(1 + s * kOfSide).setConstant(widening(points, C, rise, s));
  C = wider.asDiagonal() * C * wider.asDiagonal();
  VectorXd scale = C.diagonal().cwiseMax(0.0).cwiseSqrt();
  for (Index i = 0; i < scale.size(); ++i) {
    if (!(scale(i) > 0.0)) scale(i) = 1.0;
  }
  const VectorXd inverse = scale.cwiseInverse();
  const stats::SymmetricEigen axes = stats::symmetric_eigen(inverse.asDiagonal() * C * inverse.asDiagonal());
  for (Index k = axes.values.size(); k-- > 0;) {
    if (!(axes.values(k) > kLeast)) continue;
    VectorXd axis = axes.vectors.col(k);
    // The sign of an axis is that of its largest part.
    Index largest = 0;
    axis.cwiseAbs().maxCoeff(&largest);
    if (axis(largest) < 0.0) axis = -axis;
    out.deviations.push_back(as_deviation(std::sqrt(axes.values(k)) * scale.cwiseProduct(axis)));
  }
  friction::ModelDeviation stiffness, damping;
  stiffness.stiffness = rounded(log_error(result, "sigma0", "stiffness"));
  damping.damping = rounded(log_error(result, "sigma1", "damping"));
  if (stiffness.stiffness > 0.0) out.deviations.push_back(stiffness);
  if (damping.damping > 0.0) out.deviations.push_back(damping);
  return out;
}

}  // namespace stribeck::ident::drive
