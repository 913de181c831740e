#include <fmt/core.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <stribeck/core/numbers.hpp>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/health/measured.hpp>
#include <stribeck/ident/health/measured_rows.hpp>
#include <stribeck/ident/shown.hpp>
#include <stribeck/ident/stats/linear.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <stribeck/ident/stats/uncertainty.hpp>

namespace stribeck::ident::health {
namespace {

constexpr std::size_t kOwnSpeeds = 12;  // of rows between the speeds, each direction
constexpr double kAtSpeed = 0.05;       // share

/// Where the columns of each group begin.
struct Columns {
  std::size_t speeds = 0, places = 0, periods = 0, own = 0;
  bool spring = false, unbalance = false;

  [[nodiscard]] Eigen::Index force(std::size_t k, bool forward) const {
    return static_cast<Eigen::Index>(forward ? k : speeds + k);
  }
  [[nodiscard]] Eigen::Index mass() const { return static_cast<Eigen::Index>(2 * speeds); }
  /// Of `spring` alone.
  [[nodiscard]] Eigen::Index stiffness() const { return mass() + 1; }
  /// Sine of the angle, and behind it the cosine; of `unbalance` alone.
  [[nodiscard]] Eigen::Index weight() const { return mass() + (spring ? 2 : 1); }
  [[nodiscard]] Eigen::Index place(std::size_t j) const {
    return weight() + (unbalance ? 2 : 0) + static_cast<Eigen::Index>(j);
  }
  [[nodiscard]] Eigen::Index wave(std::size_t p) const {
    return place(places) + 2 * static_cast<Eigen::Index>(p);
  }
  /// Speed of its own of a row between the speeds.
  [[nodiscard]] Eigen::Index other(std::size_t k, bool forward) const {
    return wave(periods) + static_cast<Eigen::Index>(forward ? k : own + k);
  }
  [[nodiscard]] Eigen::Index count() const { return wave(periods) + 2 * static_cast<Eigen::Index>(own); }
};

/// The columns of a matrix that are nonzero in enough rows to be fitted, and the rows that use no other column.
struct Kept {
  std::vector<Eigen::Index> columns, rows;
};

Kept kept_of(const Eigen::MatrixXd& X, Eigen::Index from) {
  constexpr double kFew = 3.0;
  Kept kept;
  for (Eigen::Index j = 0; j < X.cols(); ++j) {
    if (j < from || X.col(j).squaredNorm() >= kFew) kept.columns.push_back(j);
  }
  for (Eigen::Index i = 0; i < X.rows(); ++i) {
    bool lost = false;
    for (Eigen::Index j = from; j < X.cols(); ++j)
      lost = lost || (X(i, j) != 0.0 && !std::binary_search(kept.columns.begin(), kept.columns.end(), j));
    if (!lost) kept.rows.push_back(i);
  }
  return kept;
}

/// The fit with its columns scaled to one.
class Fit {
 public:
  Fit(const Rows& rows, const Plan& plan, const std::string& source)
      : columns_{plan.speeds.size(),  plan.borders.empty() ? 0 : plan.borders.size() - 2,
                 plan.periods.size(), plan.dwells ? kOwnSpeeds : 0,
                 plan.spring,         plan.unbalance} {
    std::vector<std::size_t> used;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      if (plan.dwells || within(plan.speeds, std::abs(rows.v[k]))) used.push_back(k);
    }
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(used.size()), columns_.count());
    for (Eigen::Index i = 0; i < all.rows(); ++i) fill(rows, plan, used[static_cast<std::size_t>(i)], i, all);
    const Kept kept = kept_of(all, columns_.other(0, true));
    Eigen::MatrixXd X = all(kept.rows, kept.columns);
    Eigen::VectorXd y(X.rows());
    std::vector<int> record;
    std::vector<std::size_t> at;
    for (Eigen::Index i = 0; i < X.rows(); ++i) {
      const std::size_t k = used[static_cast<std::size_t>(kept.rows[static_cast<std::size_t>(i)])];
      y(i) = rows.f[k];
      record.push_back(rows.record[k]);
      at.push_back(rows.at[k]);
    }
    scale_ = X.colwise().norm().cwiseMax(1e-300);
    X = X * scale_.cwiseInverse().asDiagonal();
    const stats::LeastSquares solved = stats::least_squares(X, y);
    if (solved.rank < X.cols())
      throw Refused(
          source +
          ": the motion does not tell mass, friction and places apart (repeat the motion of the first test)");
    const Eigen::VectorXd e = y - X * solved.x;
    residual_ = std::sqrt(e.squaredNorm() / static_cast<double>(e.size()));
    theta_ = solved.x.cwiseQuotient(scale_);
    uncertainty_.emplace(X, e, stats::inverse(stats::gram(X)), record, at);
  }

  [[nodiscard]] const Columns& columns() const { return columns_; }
  [[nodiscard]] double residual() const { return residual_; }
  [[nodiscard]] Eigen::VectorXd none() const { return Eigen::VectorXd::Zero(theta_.size()); }
  [[nodiscard]] double value(const Eigen::VectorXd& g) const { return g.dot(theta_); }
  [[nodiscard]] double half_width(const Eigen::VectorXd& g) const {
    return uncertainty_->half_width(g.cwiseQuotient(scale_));
  }
  [[nodiscard]] Force force(const Eigen::VectorXd& g) const { return {value(g), half_width(g)}; }
  [[nodiscard]] double coefficient(Eigen::Index k) const { return theta_(k); }

 private:
  void fill(const Rows& rows, const Plan& plan, std::size_t k, Eigen::Index i, Eigen::MatrixXd& X) const {
    const bool forward = rows.v[k] > 0.0;
    fill_friction(plan, std::abs(rows.v[k]), forward, i, X);
    X(i, columns_.mass()) = rows.a[k];
    if (plan.spring) X(i, columns_.stiffness()) = rows.x[k] - plan.middle;
    if (plan.unbalance)
      X(i, columns_.weight()) = std::sin(rows.x[k]), X(i, columns_.weight() + 1) = std::cos(rows.x[k]);
    if (columns_.places > 0) {
      // The last place is what the others leave, so that the sum over all is zero.
      std::size_t j = 0;
      while (j < columns_.places && rows.x[k] > plan.borders[j + 1]) ++j;
      const double sign = forward ? 1.0 : -1.0;
      if (j < columns_.places) {
        X(i, columns_.place(j)) = sign;
      } else {
        for (std::size_t other = 0; other < columns_.places; ++other) X(i, columns_.place(other)) = -sign;
      }
    }
    for (std::size_t p = 0; p < plan.periods.size(); ++p) {
      const double angle = 2.0 * std::numbers::pi * rows.x[k] / plan.periods[p];
      X(i, columns_.wave(p)) = std::sin(angle);
      X(i, columns_.wave(p) + 1) = std::cos(angle);
    }
  }

  void fill_friction(const Plan& plan, double speed, bool forward, Eigen::Index i, Eigen::MatrixXd& X) const {
    const auto [s, share] = between(plan.speeds, speed);
    if (!plan.dwells) {
      X(i, columns_.force(s, forward)) = 1.0 - share;
      if (share > 0.0) X(i, columns_.force(s + 1, forward)) = share;
      return;
    }
    const std::size_t nearest = s + (share > 0.5 ? 1 : 0);
    if (std::abs(speed - plan.speeds[nearest]) <= kAtSpeed * plan.speeds[nearest]) {
      X(i, columns_.force(nearest, forward)) = 1.0;
      return;
    }
    const double at =
        std::min(speed / (kOutside * plan.speeds.back()), 1.0) * static_cast<double>(kOwnSpeeds - 1);
    const auto low = std::min(static_cast<std::size_t>(at), kOwnSpeeds - 2);
    X(i, columns_.other(low, forward)) = 1.0 - (at - static_cast<double>(low));
    X(i, columns_.other(low + 1, forward)) = at - static_cast<double>(low);
  }

  Columns columns_;
  Eigen::VectorXd theta_, scale_;
  double residual_ = 0.0;
  std::optional<stats::Uncertainty> uncertainty_;
};

/// Straight line through the mean of both directions, at the speeds above a fifth of the top.
void add_line(const Plan& plan, const Fit& fit, Measured& out) {
  std::vector<std::size_t> used;
  double mean = 0.0, spread = 0.0;
  for (std::size_t k = 0; k < plan.speeds.size(); ++k) {
    if (plan.speeds[k] >= 0.2 * plan.speeds.back()) used.push_back(k);
  }
  if (used.size() < 2) return;
  for (const std::size_t k : used) mean += plan.speeds[k] / static_cast<double>(used.size());
  for (const std::size_t k : used) spread += (plan.speeds[k] - mean) * (plan.speeds[k] - mean);
  Eigen::VectorXd slope = fit.none(), level = fit.none();
  for (const std::size_t k : used) {
    const double by_slope = 0.5 * (plan.speeds[k] - mean) / spread;
    const double by_level = 0.5 / static_cast<double>(used.size()) - mean * by_slope;
    slope(fit.columns().force(k, true)) = by_slope;
    slope(fit.columns().force(k, false)) = -by_slope;
    level(fit.columns().force(k, true)) = by_level;
    level(fit.columns().force(k, false)) = -by_level;
  }
  out.coulomb = fit.force(level);
  out.viscous = Viscous{fit.value(slope), fit.half_width(slope)};
}

void add_friction(const Plan& plan, const Fit& fit, Measured& out) {
  Eigen::VectorXd forward = fit.none(), backward = fit.none();
  const double share = 1.0 / static_cast<double>(plan.speeds.size());
  for (std::size_t k = 0; k < plan.speeds.size(); ++k) {
    Eigen::VectorXd up = fit.none(), down = fit.none();
    up(fit.columns().force(k, true)) = 1.0;
    down(fit.columns().force(k, false)) = -1.0;
    out.friction.push_back({plan.speeds[k], fit.force(up), fit.force(down)});
    forward += share * up;
    backward += share * down;
  }
  out.forward = fit.force(forward);
  out.backward = fit.force(backward);
  out.offset = fit.force(0.5 * (forward - backward));
}

void add_places(const Plan& plan, const Fit& fit, Measured& out) {
  if (plan.borders.empty()) return;
  const std::size_t free = plan.borders.size() - 2;
  for (std::size_t j = 0; j <= free; ++j) {
    Eigen::VectorXd g = fit.none();
    for (std::size_t other = 0; other < free; ++other)
      g(fit.columns().place(other)) = j == free ? -1.0 : other == j ? 1.0 : 0.0;
    out.places.push_back({plan.borders[j], plan.borders[j + 1], fit.force(g)});
  }
}

/// Amplitude of a sine and the cosine in the column behind it.
Force amplitude_of(const Fit& fit, Eigen::Index sine) {
  const double s = fit.coefficient(sine), c = fit.coefficient(sine + 1);
  const double amplitude = std::hypot(s, c);
  Eigen::VectorXd g = fit.none();
  g(sine) = amplitude > 0.0 ? s / amplitude : 1.0;
  g(sine + 1) = amplitude > 0.0 ? c / amplitude : 0.0;
  return {amplitude, fit.half_width(g)};
}

void add_waves(const Plan& plan, const Fit& fit, Measured& out) {
  for (std::size_t p = 0; p < plan.periods.size(); ++p)
    out.periodic.push_back({plan.periods[p], amplitude_of(fit, fit.columns().wave(p))});
}

/// A force of the position that stands out: by more than is left open, and more than the scatter of friction from day to day.
struct ForceOfPlace {
  bool there = false;
  double residual = kInfinity;  ///< RMS beside it [N]
};

/// `plan`: with a spring or with an unbalance.
ForceOfPlace force_of_place(const Rows& rows, const Plan& plan, const std::string& source) {
  constexpr double kSure = 3.0, kWorth = 0.05;  // half widths; of the friction
  try {
    const Fit fit(rows, plan, source);
    double level = 0.0;
    for (std::size_t k = 0; k < plan.speeds.size(); ++k) {
      level +=
          0.5 *
          (fit.coefficient(fit.columns().force(k, true)) - fit.coefficient(fit.columns().force(k, false))) /
          static_cast<double>(plan.speeds.size());
    }
    Force most;
    if (plan.unbalance) {
      most = amplitude_of(fit, fit.columns().weight());
    } else {
      const auto [low, high] = std::minmax_element(rows.x.begin(), rows.x.end());
      Eigen::VectorXd g = fit.none();
      g(fit.columns().stiffness()) = 0.5 * (*high - *low);
      most = fit.force(g);
    }
    const double size = std::abs(most.value);
    return {size > kSure * most.half_width && size > kWorth * std::abs(level), fit.residual()};
  } catch (const Refused&) {
    return {};  // the motion does not tell it from the mass
  }
}

/// A spring, or the weight of an axis that turns, whichever leaves less.
void choose_force_of_place(const Rows& rows, bool turns, const std::string& source, Plan& plan) {
  constexpr double kLeastTurn = 0.7;  // [rad] of travel, to tell sine and cosine from a straight line
  Plan spring = plan;
  spring.spring = true;
  const ForceOfPlace of_spring = force_of_place(rows, spring, source);
  const auto [low, high] = std::minmax_element(rows.x.begin(), rows.x.end());
  if (turns && *high - *low >= kLeastTurn) {
    Plan weight = plan;
    weight.unbalance = true;
    std::erase_if(weight.periods, [](double period) { return std::abs(period / (2.0 * kPi) - 1.0) < 1e-3; });
    const ForceOfPlace of_weight = force_of_place(rows, weight, source);
    if (of_weight.there && !(of_spring.there && of_spring.residual <= of_weight.residual)) {
      plan = std::move(weight);
      return;
    }
  }
  plan.spring = of_spring.there;
}

}  // namespace

Plan plan_of(const std::vector<log::Record>& records, double period) {
  const Rows rows = rows_of(records, -0.5);
  std::vector<double> speed;
  for (const double v : rows.v) speed.push_back(std::abs(v));
  Plan plan;
  plan.speeds = constant_speeds(speed);
  plan.dwells = !plan.speeds.empty();
  if (!plan.dwells) {
    const double top = stats::quantile(speed, 0.99);
    for (const double share : {0.1, 0.2, 0.4, 0.7, 0.95}) plan.speeds.push_back(share * top);
  }
  const auto counts = counts_of(rows, plan.speeds);
  std::vector<double> seen;
  for (std::size_t k = 0; k < counts.size(); ++k) {
    if (counts[k][0] >= kFewRows && counts[k][1] >= kFewRows) seen.push_back(plan.speeds[k]);
  }
  if (seen.empty())
    throw Refused(fmt::format("{}: no speed has {} rows in both directions, expected a motion to and fro",
                              records.front().source, kFewRows));
  for (double& v : seen) v = rounded(v, std::pow(10.0, 3.0 - std::floor(std::log10(v))));
  plan.speeds = seen;
  plan.borders = borders_of(rows, plan.speeds);
  const auto [low, high] = std::minmax_element(rows.x.begin(), rows.x.end());
  // Shorter travels cannot tell a wave from places, a level and a spring. Rows after reversals are missing at both ends.
  constexpr double kPeriods = 1.9;
  if (period > 0.0 && *high - *low >= kPeriods * period) plan.periods = {period, 0.5 * period};
  plan.middle = 0.5 * (*low + *high);
  choose_force_of_place(rows, records.front().turns(), records.front().source, plan);
  return plan;
}

Plan plan_of(const Measured& earlier) {
  Plan plan;
  plan.dwells = earlier.motion.dwells;
  for (const AtSpeed& s : earlier.friction) plan.speeds.push_back(s.speed);
  for (const AtPlace& p : earlier.places) plan.borders.push_back(p.from);
  if (!earlier.places.empty()) plan.borders.push_back(earlier.places.back().to);
  for (const Periodic& p : earlier.periodic) plan.periods.push_back(p.period);
  plan.spring = earlier.spring.has_value();
  plan.unbalance = earlier.unbalance.has_value();
  plan.middle = 0.5 * (earlier.motion.travel[0] + earlier.motion.travel[1]);
  return plan;
}

Measured measure(const std::vector<log::Record>& records, const Plan& plan, double shift) {
  const Rows rows = rows_of(records, shift);
  const auto counts = counts_of(rows, plan.speeds);
  for (std::size_t k = 0; k < counts.size(); ++k) {
    const std::size_t fewest = std::min(counts[k][0], counts[k][1]);
    if (fewest < kFewRows / 2)
      throw Refused(fmt::format(
          "{}: got {} rows near {} towards {}x, expected {} (repeat the motion of the first test)",
          records.front().source, fewest, Shown(records.front()).speed(plan.speeds[k]),
          counts[k][0] < counts[k][1] ? '-' : '+', kFewRows / 2));
  }
  const Fit fit(rows, plan, records.front().source);
  Measured out;
  const auto [low, high] = std::minmax_element(rows.x.begin(), rows.x.end());
  double squares = 0.0;
  for (const double a : rows.a) squares += a * a;
  out.motion = {{*low, *high},
                plan.speeds.back(),
                std::sqrt(squares / static_cast<double>(rows.size())),
                rows.duration,
                plan.dwells};
  add_friction(plan, fit, out);
  add_line(plan, fit, out);
  Eigen::VectorXd mass = fit.none();
  mass(fit.columns().mass()) = 1.0;
  const Mass found{fit.value(mass), fit.half_width(mass)};
  constexpr double kDetermined = 0.3;
  if (found.value > 0.0 && found.half_width < kDetermined * found.value) out.mass = found;
  if (plan.spring) {
    Eigen::VectorXd g = fit.none();
    g(fit.columns().stiffness()) = 1.0;
    out.spring = Stiffness{fit.value(g), fit.half_width(g)};
  }
  if (plan.unbalance) out.unbalance = amplitude_of(fit, fit.columns().weight());
  add_places(plan, fit, out);
  add_waves(plan, fit, out);
  out.residual = fit.residual();
  return out;
}

std::vector<std::string> motion_differs(const TestMotion& motion, const TestMotion& reference, bool rotary) {
  const double shown = rotary ? 180.0 / kPi : 1e3;
  const char* const unit = rotary ? "deg" : "mm";
  std::vector<std::string> why;
  const double stroke = reference.travel[1] - reference.travel[0];
  for (std::size_t end = 0; end < 2; ++end) {
    if (std::abs(motion.travel[end] - reference.travel[end]) > 0.1 * stroke)
      why.push_back(fmt::format("got a travel from {:.4g} to {:.4g} {}, expected {:.4g} to {:.4g} {}",
                                shown * motion.travel[0], shown * motion.travel[1], unit,
                                shown * reference.travel[0], shown * reference.travel[1], unit));
    if (!why.empty()) break;
  }
  constexpr double kLonger = 1.1, kFaster = 2.0;  // a tight spot or a vibration is no other motion
  if (motion.duration > kLonger * reference.duration || reference.duration > kLonger * motion.duration)
    why.push_back(
        fmt::format("got {:.3g} s of sliding, expected {:.3g} s", motion.duration, reference.duration));
  if (motion.acceleration > kFaster * reference.acceleration ||
      reference.acceleration > kFaster * motion.acceleration)
    why.push_back(fmt::format("got an RMS acceleration of {:.3g} {}/s2, expected {:.3g} {}/s2",
                              shown * motion.acceleration, unit, shown * reference.acceleration, unit));
  return why;
}

}  // namespace stribeck::ident::health
