#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stribeck/core/numbers.hpp>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/methods/position_map_parts.hpp>
#include <stribeck/ident/stats/linear.hpp>
#include <utility>

namespace stribeck::ident::methods::position_map {
namespace {

/// Columns of the nonlinear parameters: v0, periods.
MatrixXd derivatives(const Rows& rows, const Fit& fit, const Nonlinear& nonlinear, bool exact) {
  std::vector<VectorXd> columns;
  if (fit.shape.rise) columns.push_back(fit.theta(fit.rise()) * rise_slope(rows, nonlinear.v0));
  if (fit.shape.periodic && !exact) {
    for (const Term& term : nonlinear.terms) columns.push_back(term_slope(rows, term));
  }
  MatrixXd D(fit.X.rows(), static_cast<Index>(columns.size()));
  for (std::size_t j = 0; j < columns.size(); ++j) D.col(static_cast<Index>(j)) = columns[j];
  return D;
}

/// Columns of all parameters, with the acceleration projected on the instrument.
MatrixXd all_columns(const Rows& rows, const Fit& fit, const Nonlinear& nonlinear, bool exact) {
  const MatrixXd D = derivatives(rows, fit, nonlinear, exact);
  MatrixXd X(fit.W.rows(), fit.W.cols() + D.cols());
  X << fit.W, D;
  return X;
}

VectorXd scale_of(const MatrixXd& X) {
  return X.colwise().norm().cwiseMax(std::numeric_limits<double>::min()).cwiseInverse();
}

/// Combinations of scaled parameters that do not change the model force: the rows do not determine them.
MatrixXd unseen_by(const MatrixXd& X, const VectorXd& scale) {
  constexpr double kNothing = 1e-10;
  const MatrixXd scaled = X * scale.asDiagonal();
  const stats::SymmetricEigen eigen = stats::symmetric_eigen(stats::gram(scaled));
  Index none = 0;
  while (none < X.cols() && eigen.values(none) < kNothing) ++none;
  return eigen.vectors.leftCols(none);
}

stats::Uncertainty uncertainty_of(const Rows& rows, const Fit& fit, const MatrixXd& X,
                                  const VectorXd& scale) {
  const MatrixXd gram = scale.asDiagonal() * stats::gram(X) * scale.asDiagonal();
  const MatrixXd inverse = scale.asDiagonal() * stats::pseudo_inverse(gram) * scale.asDiagonal();
  std::vector<int> record;
  std::vector<std::size_t> at;
  for (const Group& g : rows.groups) {
    record.push_back(g.record);
    at.push_back(g.first / rows.together);
  }
  return {X, fit.e, inverse, record, at};
}

struct Coefficients {
  double eta0 = 0.0;        ///< [N]
  double eta1 = 0.0;        ///< mean of the directions [N·s/m]
  double difference = 0.0;  ///< half of that between the directions [N·s/m]
  double rise = 0.0;        ///< [N]
};

Coefficients coefficients_of(const Fit& fit) {
  return {fit.theta(fit.coulomb()), fit.theta(fit.viscous()),
          fit.shape.asymmetric ? fit.theta(fit.asymmetric()) : 0.0,
          fit.shape.rise ? fit.theta(fit.rise()) : 0.0};
}

void write_friction(const Described& d, const Coefficients& c, Result& r) {
  r.parameters.push_back(parameter("eta0", c.eta0, "N", "N", d.intervals.half(d.fit.coulomb())));
  if (d.fit.shape.asymmetric) {
    for (const double sign : {1.0, -1.0}) {
      const VectorXd g = d.intervals.unit(d.fit.viscous()) + sign * d.intervals.unit(d.fit.asymmetric());
      r.parameters.push_back(parameter(sign > 0.0 ? "eta1_positive" : "eta1_negative",
                                       c.eta1 + sign * c.difference, "N s/m", "N s/mm",
                                       d.intervals.width(g)));
    }
  } else {
    r.parameters.push_back(parameter("eta1", c.eta1, "N s/m", "N s/mm", d.intervals.half(d.fit.viscous())));
  }
  if (d.fit.shape.rise) {
    // On V3 the bristle lags by 2 N of 15 N behind the rise where the axis brakes, and is not built up after a reversal: the value
    // belongs to the curve of this motion.
    r.parameters.push_back(
        parameter("stribeck_rise", c.rise, "N", "N", d.intervals.half(d.fit.rise()), false));
    r.parameters.push_back(parameter("stribeck_velocity", d.nonlinear.v0, "m/s", "mm/s",
                                     d.intervals.half(d.fit.X.cols()), false));
    r.cannot_tell.emplace_back(
        "Stribeck rise: accelerated motion may pass low speeds too fast for pre-sliding to settle; "
        "its value is valid for this motion only, jogs at low speeds determine it");
  }
}

/// The law as an axis file holds it.
void write_law(const Described& d, const Coefficients& c, Result& r) {
  if (d.fit.shape.asymmetric) {
    r.set_steady(SteadyModel::kAsymmetric);
    friction::Gaussian<double> map;
    map.velocity_range = r.velocity_range;
    map.positive.eta0 = c.eta0;
    map.positive.eta1 = c.eta1 + c.difference;
    map.negative.eta0 = -c.eta0;
    map.negative.eta1 = c.eta1 - c.difference;
    if (d.fit.shape.rise) {
      map.positive.gaussians.push_back({c.rise, 0.0, d.nonlinear.v0});
      map.negative.gaussians.push_back({-c.rise, 0.0, d.nonlinear.v0});
    }
    r.friction.steady = map;
  } else {
    r.set_steady(SteadyModel::kConventional);
    friction::Conventional<double> map;
    map.alpha0 = c.eta0;
    map.alpha2 = c.eta1;
    if (d.fit.shape.rise) map.stribeck = friction::Stribeck<double>{c.eta0 + c.rise, d.nonlinear.v0, 2.0};
    r.friction.steady = map;
  }
  if (!(c.eta0 > 0.0)) {
    r.warnings.push_back(fmt::format(
        "Coulomb friction came out as {:.4g}, which no axis has: check the sign of the force, and a delay between force and position",
        c.eta0));
  }
}

void write_curve(const Described& d, const Coefficients& c, Result& r) {
  const int points = std::max(2, d.options.curve_points);
  for (int i = -points; i <= points; ++i) {
    if (i == 0 || (i < 0 ? r.velocity_range[0] == 0.0 : r.velocity_range[1] == 0.0)) continue;
    const double sign = i < 0 ? -1.0 : 1.0;
    const double limit = std::abs(r.velocity_range[i < 0 ? 0 : 1]);
    const double v = sign * (d.rows.slowest + (limit - d.rows.slowest) * (std::abs(i) - 1) / (points - 1));
    VectorXd g = sign * d.intervals.unit(d.fit.coulomb()) + v * d.intervals.unit(d.fit.viscous());
    if (d.fit.shape.asymmetric) g += std::abs(v) * d.intervals.unit(d.fit.asymmetric());
    double f = sign * c.eta0 + c.eta1 * v + c.difference * std::abs(v);
    if (d.fit.shape.rise) {
      const double fade = std::exp(-std::pow(v / d.nonlinear.v0, 2.0));
      f += sign * c.rise * fade;
      g += sign * fade * d.intervals.unit(d.fit.rise());
      g += sign * c.rise * fade * 2.0 * v * v / (d.nonlinear.v0 * d.nonlinear.v0 * d.nonlinear.v0) *
           d.intervals.unit(d.fit.X.cols());
    }
    const double w = d.intervals.width(g);
    r.curve.push_back({v, f, f - w, f + w});
  }
}

/// Largest amplitude first.
void write_terms(const Described& d, Result& r) {
  r.model += "+periodic";
  std::vector<std::size_t> order(d.nonlinear.terms.size());
  for (std::size_t j = 0; j < order.size(); ++j) order[j] = j;
  const auto amplitude = [&](std::size_t j) {
    return std::hypot(d.nonlinear.terms[j].a, d.nonlinear.terms[j].b);
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return amplitude(a) > amplitude(b); });
  int number = 0;
  for (const std::size_t j : order) {
    const Term& found = d.nonlinear.terms[j];
    const double A = amplitude(j);
    const bool exact = d.options.turn.has_value();
    const Index slope = d.fit.X.cols() + (d.fit.shape.rise ? 1 : 0) + static_cast<Index>(j);
    const VectorXd sine = d.intervals.unit(d.fit.term(j));
    const VectorXd cosine = d.intervals.unit(d.fit.term(j) + 1);
    const VectorXd frequency = exact ? VectorXd(VectorXd::Zero(sine.size())) : d.intervals.unit(slope);
    friction::Eccentric<double> term;
    term.amplitude = A;
    term.period = 1.0 / found.f;
    term.phase =
        std::remainder(2.0 * kPi * found.f * d.rows.middle - std::atan2(found.b, found.a), 2.0 * kPi);
    term.form = found.reversing ? friction::EccentricForm::kProportional : friction::EccentricForm::kAdditive;
    const std::string name = "eccentric_" + std::to_string(++number) + "_";
    r.parameters.push_back(parameter(name + "amplitude", A, "N", "N",
                                     d.intervals.width(found.a / A * sine + found.b / A * cosine)));
    r.parameters.push_back(parameter(name + "period", term.period, "m", "mm",
                                     d.intervals.width(frequency) * term.period * term.period));
    r.parameters.push_back(parameter(name + "phase", term.phase, "rad", "rad",
                                     d.intervals.width(found.b / (A * A) * sine - found.a / (A * A) * cosine +
                                                       2.0 * kPi * d.rows.middle * frequency)));
    // A phase is known by the width of its interval alone; it is not compared with zero.
    r.parameters.back().identifiable = r.parameters.back().ci_high - r.parameters.back().ci_low < 2.0 * kPi;
    r.friction.eccentric.push_back(term);
  }
  if (d.nonlinear.terms.size() > friction::kMaxEccentricTerms) {
    r.warnings.push_back(fmt::format("{} periodic terms found; an axis file holds the largest {}",
                                     d.nonlinear.terms.size(), friction::kMaxEccentricTerms));
  }
  r.warnings.emplace_back(kHoming);
}

void write_points(const Described& d, Result& r) {
  const std::size_t step = std::max<std::size_t>(1, d.rows.groups.size() / kPlotted);
  VectorXd terms = VectorXd::Zero(d.rows.y.size());
  if (d.fit.shape.periodic) {
    const Index first = d.fit.term(0);
    terms = d.fit.X.rightCols(d.fit.X.cols() - first) * d.fit.theta.tail(d.fit.X.cols() - first);
  }
  for (std::size_t i = 0; i < d.rows.groups.size(); i += step) {
    const auto k = static_cast<Index>(i);
    const Group& g = d.rows.groups[i];
    const log::Record& record = (*d.rows.records)[static_cast<std::size_t>(g.record)];
    const double inertia = d.fit.shape.mass ? d.fit.theta(0) * d.rows.a(k) : 0.0;
    r.residuals.push_back({record.t[g.first], d.rows.x(k), d.rows.v(k), d.fit.e(k), g.record});
    r.map.push_back({d.rows.v(k), d.rows.y(k) - inertia - r.load - terms(k), g.sign > 0.0 ? 1 : -1});
  }
}

}  // namespace

Intervals::Intervals(const Rows& rows, const Fit& fit, const Nonlinear& nonlinear, bool exact)
    : Intervals(rows, fit, all_columns(rows, fit, nonlinear, exact)) {}

Intervals::Intervals(const Rows& rows, const Fit& fit, const MatrixXd& X)
    : scale_(scale_of(X)),
      unseen_(unseen_by(X, scale_)),
      uncertainty_(uncertainty_of(rows, fit, X, scale_)) {}

double Intervals::width(const VectorXd& g) const {
  constexpr double kLeans = 1e-3;
  const VectorXd scaled = g.cwiseProduct(scale_);
  if ((unseen_.transpose() * scaled).norm() > kLeans * scaled.norm()) return kNaN;
  return uncertainty_.half_width(g);
}

void describe(const Described& d, bool no_mass, Result& r) {
  r.method = Method::kPositionMap;
  r.force_unit = (*d.rows.records).front().force_unit;
  r.position_unit = (*d.rows.records).front().position_unit;
  r.rows = d.rows.rows;
  r.velocity_range = {std::min(0.0, d.rows.v.minCoeff()), std::max(0.0, d.rows.v.maxCoeff())};
  if (d.options.mass) {
    r.mass = *d.options.mass;
    r.mass_interval = {r.mass, r.mass};
  } else if (no_mass) {
    r.mass = kNaN;
  } else {
    r.mass = d.fit.theta(0);
    r.mass_interval = {r.mass - d.intervals.half(0), r.mass + d.intervals.half(0)};
    r.parameters.push_back(parameter("mass", r.mass, "kg", "N s2/mm", d.intervals.half(0)));
    if (d.fit.weak) {
      r.warnings.emplace_back(
          "the acceleration of the reference hardly agrees with the measured one; the mass is found from the measured acceleration");
    }
  }
  if (d.fit.shape.load) {
    r.load = d.fit.theta(d.fit.load());
    r.parameters.push_back(parameter("load", r.load, "N", "N", d.intervals.half(d.fit.load())));
  } else {
    r.cannot_tell.emplace_back(
        "load: the log has one direction only; the Coulomb friction contains the load");
  }
  const Coefficients c = coefficients_of(d.fit);
  write_friction(d, c, r);
  write_law(d, c, r);
  write_curve(d, c, r);
  if (d.fit.shape.periodic) write_terms(d, r);
  if (d.options.turn && !d.fit.shape.periodic) {
    r.cannot_tell.emplace_back(
        "periodic terms: at the given turn and its integer fractions none is above the noise");
  }
  if (d.intervals.some_unseen()) {
    r.cannot_tell.emplace_back(
        "every parameter without an interval: this motion does not separate it from the others (one "
        "speed only, or one motion repeated); together they describe the friction of this motion");
  }
  for (const std::string& note : d.found.notes) r.warnings.push_back(note);
  if (d.fit.shape.periodic || !d.rows.both) {
    for (const std::string& note : d.found.cannot_tell) r.cannot_tell.push_back(note);
  }
  r.spectrum = d.found.spectrum;
  write_points(d, r);
}

}  // namespace stribeck::ident::methods::position_map
