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
#include <stribeck/ident/log/motion.hpp>
#include <stribeck/ident/shown.hpp>
#include <stribeck/ident/stats/linear.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <stribeck/ident/stats/uncertainty.hpp>

namespace stribeck::ident::health {
namespace {

constexpr std::size_t kFewRows = 20;      // of one speed and direction
constexpr std::size_t kMostRows = 30000;  // more add time and no knowledge
constexpr std::size_t kPlaces = 4;
constexpr double kAfterReversal = 1.0 / 400.0;  // of the stroke
constexpr std::size_t kOwnSpeeds = 12;          // of rows between the speeds, each direction
constexpr double kAtSpeed = 0.05;               // share
constexpr double kOutside = 1.1;  // speeds beyond the plan by more than this factor are left out

/// The rows of all logs that a test uses.
struct Rows {
  std::vector<double> x, v, a, f;
  std::vector<int> record;
  std::vector<std::size_t> at;
  double duration = 0.0;  ///< [s]

  [[nodiscard]] std::size_t size() const { return x.size(); }
};

Rows rows_of(const std::vector<log::Record>& records, double shift) {
  std::size_t all = 0;
  for (const log::Record& r : records) all += r.x.size();
  const std::size_t stride = 1 + all / kMostRows;
  Rows rows;
  for (std::size_t n = 0; n < records.size(); ++n) {
    if (records[n].force_unit != "N" || records[n].position_unit != "m")
      throw Refused(
          fmt::format("{}: got a force in {} and a position in {}, expected N and m (--gain, --lead)",
                      records[n].source, records[n].force_unit, records[n].position_unit));
    log::MotionOptions options;
    options.shift = shift;
    const log::Motion motion = log::reconstruct(records[n], options);
    const double exclude = std::max(kAfterReversal * motion.stroke, 10.0 * motion.position_noise);
    for (std::size_t k = 0; k < motion.rows(); k += stride) {
      if (!motion.sliding(k, exclude) || motion.v[k] == 0.0) continue;
      if (!records[n].skip.empty() && records[n].skip[k] != 0) continue;
      rows.x.push_back(motion.x[k]);
      rows.v.push_back(motion.v[k]);
      rows.a.push_back(motion.a[k]);
      rows.f.push_back(motion.f[k]);
      rows.record.push_back(static_cast<int>(n));
      rows.at.push_back(k);
      rows.duration += static_cast<double>(stride) * motion.sample_time;
    }
  }
  if (rows.size() < 10 * kFewRows)
    throw Refused(fmt::format("{}: only {} rows of sliding, expected {} (record the whole motion)",
                              records.empty() ? std::string("no log") : records.front().source, rows.size(),
                              10 * kFewRows));
  return rows;
}

/// Speeds at which a jog dwells, ascending; empty: the speed changes all the time.
std::vector<double> constant_speeds(const std::vector<double>& speed) {
  constexpr double kWidth = 0.04;  // of the logarithm
  constexpr double kShare = 0.03, kMost = 0.6;
  const double top = *std::max_element(speed.begin(), speed.end());
  std::vector<std::size_t> bins(250, 0);
  for (const double v : speed) {
    const auto bin = static_cast<std::size_t>(std::log(top / v) / kWidth);
    if (bin < bins.size()) ++bins[bin];
  }
  std::vector<double> found;
  double held = 0.0;
  const auto all = static_cast<double>(speed.size());
  for (std::size_t b = 0; b < bins.size(); ++b) {
    const std::size_t before = b > 0 ? bins[b - 1] : 0, after = b + 1 < bins.size() ? bins[b + 1] : 0;
    const auto near = static_cast<double>(before + bins[b] + after);
    if (bins[b] < before || bins[b] <= after || near < kShare * all) continue;
    std::vector<double> inside;
    for (const double v : speed) {
      if (std::abs(std::log(top / v) / kWidth - static_cast<double>(b) - 0.5) <= 1.5) inside.push_back(v);
    }
    found.insert(found.begin(), stats::median(inside));
    held += near / all;
  }
  return found.size() >= 2 && held >= kMost ? found : std::vector<double>{};
}

/// A length or speed with the digits that matter to a reader of the file.
double rounded(double value, double per_unit) { return std::round(value * per_unit) / per_unit + 0.0; }

/// Index of the speed below, and the share of the one above.
std::pair<std::size_t, double> between(const std::vector<double>& speeds, double v) {
  const auto above = std::upper_bound(speeds.begin(), speeds.end(), v);
  if (above == speeds.begin()) return {0, 0.0};
  if (above == speeds.end()) return {speeds.size() - 1, 0.0};
  const auto i = static_cast<std::size_t>(above - speeds.begin()) - 1;
  return {i, (v - speeds[i]) / (speeds[i + 1] - speeds[i])};
}

bool within(const std::vector<double>& speeds, double v) {
  return v >= speeds.front() / kOutside && v <= speeds.back() * kOutside;
}

/// Number of rows nearest to each speed, towards −x and +x.
std::vector<std::array<std::size_t, 2>> counts_of(const Rows& rows, const std::vector<double>& speeds,
                                                  double from = -kInfinity, double to = kInfinity) {
  std::vector<std::array<std::size_t, 2>> counts(speeds.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const double v = std::abs(rows.v[k]);
    if (!within(speeds, v) || rows.x[k] < from || rows.x[k] > to) continue;
    const auto [i, share] = between(speeds, v);
    ++counts[i + (share > 0.5 ? 1 : 0)][rows.v[k] > 0.0];
  }
  return counts;
}

/// Quarters of the travel, where each quarter has rows in both directions at half of the speeds, at least at two.
std::vector<double> borders_of(const Rows& rows, const std::vector<double>& speeds) {
  const auto [low, high] = std::minmax_element(rows.x.begin(), rows.x.end());
  std::vector<double> borders;
  for (std::size_t j = 0; j <= kPlaces; ++j)
    borders.push_back(rounded(*low + (*high - *low) * static_cast<double>(j) / kPlaces, 1e6));
  for (std::size_t j = 0; j < kPlaces; ++j) {
    const auto counts = counts_of(rows, speeds, borders[j], borders[j + 1]);
    const auto both = std::count_if(counts.begin(), counts.end(),
                                    [](const auto& c) { return c[0] >= kFewRows && c[1] >= kFewRows; });
    if (2 * both < static_cast<std::ptrdiff_t>(speeds.size()) || both < 2) return {};
  }
  return borders;
}

/// Where the columns of each group begin.
struct Columns {
  std::size_t speeds = 0, places = 0, periods = 0, own = 0;
  bool spring = false;

  [[nodiscard]] Eigen::Index force(std::size_t k, bool forward) const {
    return static_cast<Eigen::Index>(forward ? k : speeds + k);
  }
  [[nodiscard]] Eigen::Index mass() const { return static_cast<Eigen::Index>(2 * speeds); }
  /// Of `spring` alone.
  [[nodiscard]] Eigen::Index stiffness() const { return mass() + 1; }
  [[nodiscard]] Eigen::Index place(std::size_t j) const {
    return mass() + (spring ? 2 : 1) + static_cast<Eigen::Index>(j);
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
      : columns_{plan.speeds.size(), plan.borders.empty() ? 0 : plan.borders.size() - 2, plan.periods.size(),
                 plan.dwells ? kOwnSpeeds : 0, plan.spring} {
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

void add_waves(const Plan& plan, const Fit& fit, Measured& out) {
  for (std::size_t p = 0; p < plan.periods.size(); ++p) {
    const Eigen::Index k = fit.columns().wave(p);
    const double s = fit.coefficient(k), c = fit.coefficient(k + 1);
    const double amplitude = std::hypot(s, c);
    Eigen::VectorXd g = fit.none();
    g(k) = amplitude > 0.0 ? s / amplitude : 1.0;
    g(k + 1) = amplitude > 0.0 ? c / amplitude : 0.0;
    out.periodic.push_back({plan.periods[p], {amplitude, fit.half_width(g)}});
  }
}

/// Whether a force grows with position, by more than is left open and more than the scatter of friction from day to day.
bool has_spring(const Rows& rows, Plan plan, const std::string& source) {
  constexpr double kSure = 3.0, kWorth = 0.05;  // half widths; of the friction
  plan.spring = true;
  try {
    const Fit fit(rows, plan, source);
    Eigen::VectorXd g = fit.none();
    g(fit.columns().stiffness()) = 1.0;
    double level = 0.0;
    for (std::size_t k = 0; k < plan.speeds.size(); ++k) {
      level +=
          0.5 *
          (fit.coefficient(fit.columns().force(k, true)) - fit.coefficient(fit.columns().force(k, false))) /
          static_cast<double>(plan.speeds.size());
    }
    const auto [low, high] = std::minmax_element(rows.x.begin(), rows.x.end());
    const double most = std::abs(fit.value(g)) * 0.5 * (*high - *low);
    return std::abs(fit.value(g)) > kSure * fit.half_width(g) && most > kWorth * std::abs(level);
  } catch (const Refused&) {
    return false;  // the motion does not tell it from the mass
  }
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
  plan.spring = has_spring(rows, plan, records.front().source);
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
