#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <stribeck/ident/digits.hpp>
#include <stribeck/ident/lost_motion/indicator.hpp>
#include <stribeck/ident/stats/linear.hpp>
#include <stribeck/ident/stats/quantiles.hpp>

namespace stribeck::ident::lost_motion {
namespace {

constexpr int kFewestReadings = 3;  ///< of each direction
constexpr int kFewestFreedom = 3;   ///< rows beyond the unknowns
constexpr int kRowsForDrift = 8;    ///< with fewer, a drift is not asked for
constexpr int kScanned = 400;       ///< frictions between 0 and the largest load
constexpr double kMostError = 0.5;  ///< half width as a share of the stiffness; wider: not determined
constexpr int kFewestAtPlace = 2;   ///< readings of each direction, so that a place tells its own lost motion
constexpr double kByChance =
    1e-3;  ///< of one lost motion everywhere: rarer than this, it differs along the travel

/// Positions that are the same for a person [m].
double rounded(double x) { return std::round(x * 1e8) / 1e8; }

/// A linear fit of the readings.
struct Line {
  bool good = false;
  double left = 0.0;       ///< sum of the squared residuals [µm²]
  double freedom = 0.0;    ///< rows less unknowns
  Eigen::VectorXd x;       ///< unknowns; the last ones are those of the lost motion
  Eigen::MatrixXd spread;  ///< their covariance for a scatter of one

  /// Variance of the readings, at least that of their steps [µm²].
  [[nodiscard]] double scatter(double step) const { return std::max(left / freedom, step * step / 12.0); }
};

/// What the lost motion may do along the travel.
enum class Along { kOne, kPlaces, kSlope };

class Series {
 public:
  explicit Series(const std::vector<Reading>& series) : series_(series) {
    std::map<double, Eigen::Index> places;
    for (const Reading& r : series_) place_.push_back(places.emplace(rounded(r.position), 0).first->first);
    Eigen::Index n = 0;
    for (auto& [at, index] : places) {
      index = n++;
      places_.push_back(at);
    }
    const auto rows = static_cast<Eigen::Index>(series_.size());
    const bool drift = rows >= kRowsForDrift;
    common_ = Eigen::MatrixXd::Zero(rows, n + (drift ? 1 : 0));
    y_.resize(rows);
    for (Eigen::Index i = 0; i < rows; ++i) {
      common_(i, places[place_[static_cast<std::size_t>(i)]]) = 1.0;
      if (drift) common_(i, n) = static_cast<double>(i) / static_cast<double>(rows) - 0.5;
      y_(i) = 1e6 * at(i).value;
      most_load_ = std::max(most_load_, std::abs(at(i).load));
    }
    step_ = step_of_readings();
  }

  /// Lost motion [µm], and with loads compliance [µm/N], where no load is larger than friction.
  [[nodiscard]] Line together(Along along = Along::kOne) const {
    Eigen::VectorXd side(y_.size()), load(loaded() ? y_.size() : 0);
    for (Eigen::Index i = 0; i < y_.size(); ++i) {
      side(i) = -0.5 * at(i).direction;
      if (loaded()) load(i) = -at(i).load;
    }
    return solved(side, load, along);
  }
  /// Backlash [µm] and compliance [µm/N] with a friction of the table [N].
  [[nodiscard]] Line apart(double friction, Along along = Along::kOne) const {
    Eigen::VectorXd side(y_.size()), load(y_.size());
    for (Eigen::Index i = 0; i < y_.size(); ++i) {
      const double s = at(i).direction * friction + at(i).load;
      side(i) = s > 0.0 ? -0.5 : s < 0.0 ? 0.5 : 0.0;
      load(i) = -s;
    }
    return solved(side, load, along);
  }

  [[nodiscard]] const std::vector<double>& places() const { return places_; }
  [[nodiscard]] bool loaded() const { return most_load_ > 0.0; }
  [[nodiscard]] double most_load() const { return most_load_; }
  [[nodiscard]] double step() const { return step_; }

 private:
  /// Smallest step of the indicator [µm]: by readings of one place, direction and load that differ. Where they are all the same, the
  /// power of ten that all readings are multiples of, at most half of what any two differ by; 0: they are all the same.
  [[nodiscard]] double step_of_readings() const {
    constexpr double kSame = 1e-3;  // [µm]
    const auto smallest = [](std::vector<double> values) {
      std::sort(values.begin(), values.end());
      double step = std::numeric_limits<double>::infinity();
      for (std::size_t i = 1; i < values.size(); ++i) {
        if (values[i] - values[i - 1] > kSame) step = std::min(step, values[i] - values[i - 1]);
      }
      return step;
    };
    std::map<std::array<double, 3>, std::vector<double>> alike;
    for (Eigen::Index i = 0; i < y_.size(); ++i)
      alike[{place_[static_cast<std::size_t>(i)], static_cast<double>(at(i).direction), at(i).load}]
          .push_back(y_(i));
    double step = std::numeric_limits<double>::infinity();
    for (const auto& [of, values] : alike) step = std::min(step, smallest(values));
    if (std::isfinite(step)) return step;
    const double apart = smallest({y_.data(), y_.data() + y_.size()});
    if (!std::isfinite(apart)) return 0.0;
    const double power = std::log10(apart);
    if (std::abs(power - std::round(power)) < 1e-3) return apart;  // perhaps one step of a coarse indicator
    step = std::pow(10.0, std::floor(std::log10(0.5 * apart)));
    const auto fits = [&] {
      return std::all_of(y_.data(), y_.data() + y_.size(),
                         [&](double y) { return std::abs(y / step - std::round(y / step)) < 1e-3; });
    };
    while (step > kSame && !fits()) step *= 0.1;
    return step;
  }

  [[nodiscard]] const Reading& at(Eigen::Index i) const { return series_[static_cast<std::size_t>(i)]; }

  /// `side`, of the lost motion, as it is, for each place, or with a second one that grows from 0 to 1 along the travel.
  [[nodiscard]] Eigen::MatrixXd sides(const Eigen::VectorXd& side, Along along) const {
    if (along == Along::kOne) return side;
    const auto n = static_cast<Eigen::Index>(places_.size());
    if (along == Along::kPlaces) return (common_.leftCols(n).array().colwise() * side.array()).matrix();
    Eigen::MatrixXd both(side.size(), 2);
    for (Eigen::Index i = 0; i < side.size(); ++i) {
      const double share = (place_[static_cast<std::size_t>(i)] - places_.front()) /
                           std::max(places_.back() - places_.front(), 1e-12);
      both(i, 0) = side(i);
      both(i, 1) = side(i) * share;
    }
    return both;
  }

  /// The columns of the lost motion, then that of the loads if there are any.
  [[nodiscard]] Line solved(const Eigen::VectorXd& side, const Eigen::VectorXd& load, Along along) const {
    const Eigen::MatrixXd columns = sides(side, along);
    Eigen::MatrixXd A(y_.size(), common_.cols() + columns.cols() + (load.size() > 0 ? 1 : 0));
    A.leftCols(common_.cols()) = common_;
    A.middleCols(common_.cols(), columns.cols()) = columns;
    if (load.size() > 0) A.rightCols(1) = load;
    Line line;
    line.freedom = static_cast<double>(A.rows() - A.cols());
    if (line.freedom < kFewestFreedom) return line;
    // Columns of one size, so that rank means something.
    Eigen::VectorXd size(A.cols());
    for (Eigen::Index c = 0; c < A.cols(); ++c) {
      size(c) = A.col(c).norm();
      if (!(size(c) > 0.0)) return line;
      A.col(c) /= size(c);
    }
    const stats::LeastSquares fit = stats::least_squares(A, y_);
    if (fit.rank < A.cols()) return line;
    line.left = (y_ - A * fit.x).squaredNorm();
    line.spread = stats::inverse(A.transpose() * A);
    line.x = fit.x.cwiseQuotient(size);
    for (Eigen::Index r = 0; r < size.size(); ++r) {
      for (Eigen::Index c = 0; c < size.size(); ++c) line.spread(r, c) /= size(r) * size(c);
    }
    line.good = true;
    return line;
  }

  const std::vector<Reading>& series_;
  std::vector<double> place_;   ///< of each reading
  std::vector<double> places_;  ///< ascending
  Eigen::MatrixXd common_;
  Eigen::VectorXd y_;  ///< [µm]
  double most_load_ = 0.0;
  double step_ = 0.0;  ///< of the indicator [µm]
};

/// Unknown number `from_end` from the last one, with its interval.
Estimate unknown(const Line& line, double step, int from_end) {
  const Eigen::Index i = line.x.size() - 1 - from_end;
  return {line.x(i), stats::student_factor(line.freedom) * std::sqrt(line.scatter(step) * line.spread(i, i))};
}

/// 1/c, for a compliance c [µm/N] that is certainly above 0 [N/m].
Estimate stiffness_of(const Estimate& c) {
  const double k = 1e6 / c.value;
  return {k, k * c.half_width / c.value};
}

/// Says where the lost motion is smallest and largest, if one for all places fits the readings clearly worse. `friction`: of the table
/// where loads exceed it, else absent.
std::string differs_along(const std::vector<Reading>& readings, std::optional<double> friction) {
  std::map<double, std::array<int, 2>> count;
  for (const Reading& r : readings) ++count[rounded(r.position)][r.direction > 0 ? 1 : 0];
  std::vector<Reading> twice;
  std::copy_if(readings.begin(), readings.end(), std::back_inserter(twice), [&](const Reading& r) {
    const std::array<int, 2>& n = count[rounded(r.position)];
    return std::min(n[0], n[1]) >= kFewestAtPlace;
  });
  if (twice.empty()) return {};
  const Series series(twice);
  const auto fit = [&](Along along) {
    return friction ? series.apart(*friction, along) : series.together(along);
  };
  const auto places = static_cast<Eigen::Index>(series.places().size());
  const Line one = fit(Along::kOne);
  if (places < 2 || !one.good) return {};
  for (const Along along : {Along::kPlaces, Along::kSlope}) {
    const Line line = fit(along);
    if (!line.good) continue;
    const double more = one.freedom - line.freedom;
    const double ratio = (one.left - line.left) / (more * line.scatter(series.step()));
    if (!(stats::fisher_above(std::max(0.0, ratio), more, line.freedom) < kByChance)) continue;
    const bool loaded = friction || series.loaded();
    const Eigen::Index first = line.x.size() - (loaded ? 1 : 0) - (along == Along::kPlaces ? places : 2);
    const double wind_up = friction ? 2.0 * *friction * line.x(line.x.size() - 1) : 0.0;
    Eigen::VectorXd at = line.x.segment(first, along == Along::kPlaces ? places : 2).array() + wind_up;
    std::vector<double> where = series.places();
    if (along == Along::kSlope) {
      at = Eigen::Vector2d(line.x(first) + wind_up, line.x(first) + line.x(first + 1) + wind_up);
      where = {where.front(), where.back()};
    }
    Eigen::Index least = 0, most = 0;
    at.minCoeff(&least);
    at.maxCoeff(&most);
    if (at(most) - at(least) < series.step()) continue;  // rounding alone makes that much
    if (at(least) < -series.step())
      return fmt::format(
          "the readings are {} um larger where {:.4g} mm is approached in direction +, and {} um smaller at {:.4g} mm: the directions are "
          "exchanged in some rows, or the indicator has slipped; one number stands for the mean",
          digits(-at(least), 2), 1e3 * where[static_cast<std::size_t>(least)], digits(at(most), 2),
          1e3 * where[static_cast<std::size_t>(most)]);
    return fmt::format(
        "lost motion differs along the travel: from {} um at {:.4g} mm to {} um at {:.4g} mm (wear of the screw or of the guide); one number "
        "stands for the mean",
        digits(at(least), 2), 1e3 * where[static_cast<std::size_t>(least)], digits(at(most), 2),
        1e3 * where[static_cast<std::size_t>(most)]);
  }
  return {};
}

/// Whether the largest load exceeds the friction of the table although the line without such loads fits, as it does without a backlash:
/// loads below friction are at most (lost motion)/(2·compliance).
bool beyond_friction(const Series& series, const Line& together) {
  const Estimate total = unknown(together, series.step(), 1);
  const Estimate compliance = unknown(together, series.step(), 0);
  return total.low() > 0.0 && compliance.low() > 0.0 &&
         total.high() < 2.0 * series.most_load() * compliance.low();
}

/// With loads that exceed friction: every friction that the readings permit widens the intervals.
/// Leaves the friction in `friction`.
bool told_apart(LostMotion& out, const Series& series, const Line& together, double& friction) {
  Line best;
  std::vector<std::pair<double, Line>> scanned;
  for (int i = 1; i < kScanned; ++i) {
    const double F = series.most_load() * i / kScanned;
    scanned.emplace_back(F, series.apart(F));
    const Line& line = scanned.back().second;
    if (line.good && (!best.good || line.left < best.left)) {
      best = line;
      friction = F;
    }
  }
  if (!best.good) return false;
  const double t = stats::student_factor(best.freedom);
  const double permitted = best.left + t * t * best.scatter(series.step());
  if (together.left <= permitted && !beyond_friction(series, together)) return false;
  const auto widened = [&](int from_end, double scale) {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (const auto& [F, line] : scanned) {
      if (!line.good || line.left > permitted) continue;
      const Estimate e = unknown(line, series.step(), from_end);
      low = std::min(low, e.low());
      high = std::max(high, e.high());
    }
    const double value = unknown(best, series.step(), from_end).value;
    return Estimate{scale * value, scale * std::max(high - value, value - low)};
  };
  const Estimate compliance = widened(0, 1.0);
  const Estimate backlash = widened(1, 1e-6);
  if (!(compliance.high() > 0.0)) return false;  // the sign of the loads is another
  if (compliance.half_width < kMostError * compliance.value) {
    out.stiffness = stiffness_of(compliance);
    out.table_friction = friction;
  } else {
    // Too stiff for these loads and this indicator. The line through all readings was rejected above, so its stiffness is not given instead.
    out.words.push_back(fmt::format(
        "the wind-up is too small to be measured with these loads: the stiffness is at least {} N/um (larger loads tell it)",
        digits(1.0 / std::max(compliance.high(), 1e-12), 2)));
  }
  if (backlash.low() > 0.0) {
    out.backlash = backlash;
  } else {
    out.words.push_back(fmt::format("no backlash was found; it is at most {} um",
                                    digits(1e6 * std::max(0.0, backlash.high()), 2)));
  }
  const double total = unknown(best, series.step(), 1).value + 2.0 * friction * compliance.value;
  double low = total, high = total;
  for (const auto& [F, line] : scanned) {
    if (!line.good || line.left > permitted) continue;
    const Eigen::Index c = line.x.size() - 1;
    const double value = line.x(c - 1) + 2.0 * F * line.x(c);
    const double variance =
        line.spread(c - 1, c - 1) + 4.0 * F * F * line.spread(c, c) + 4.0 * F * line.spread(c, c - 1);
    const double half = t * std::sqrt(line.scatter(series.step()) * std::max(0.0, variance));
    low = std::min(low, value - half);
    high = std::max(high, value + half);
  }
  out.total = Estimate{1e-6 * total, 1e-6 * std::max(high - total, total - low)};
  return true;
}

/// +1 or -1: how the readings count along the axis; 0: unknown, because all readings are at one position.
int orientation(const std::vector<Reading>& series) {
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  const auto n = static_cast<double>(series.size());
  // The rounding of their mean is no travel.
  if (std::all_of(series.begin(), series.end(),
                  [&](const Reading& r) { return r.position == series.front().position; }))
    return 0;
  for (const Reading& r : series) {
    x += r.position / n;
    y += r.value / n;
  }
  for (const Reading& r : series) {
    xx += (r.position - x) * (r.position - x);
    xy += (r.position - x) * (r.value - y);
  }
  // An indicator that follows the axis reads its travel; a tenth of it is no noise.
  if (!(xx > 0.0) || std::abs(xy) < 0.1 * xx) return 0;
  return xy > 0.0 ? 1 : -1;
}

}  // namespace

LostMotion identify(const std::vector<Reading>& readings) {
  LostMotion out;
  std::array<int, 2> count{};
  for (const Reading& r : readings) ++count[r.direction > 0 ? 1 : 0];
  out.reversals = std::min(count[0], count[1]);
  if (out.reversals < kFewestReadings) {
    out.words.push_back(fmt::format(
        "lost motion is not determined: {} readings in direction + and {} in direction -, expected at least {} of each "
        "(approach every position several times from both sides)",
        count[1], count[0], kFewestReadings));
    return out;
  }
  std::vector<Reading> series = readings;
  if (orientation(series) < 0) {
    for (Reading& r : series) r.value = -r.value;
  }
  const Series all(series);
  const Line together = all.together();
  if (!together.good) {
    out.words.emplace_back(
        "lost motion is not determined: direction, load and order of the rows cannot be distinguished (approach the same positions in "
        "turn from both sides, with each load in both directions)");
    return out;
  }
  const Estimate total = unknown(together, all.step(), all.loaded() ? 1 : 0);
  if (total.high() < 0.0) {
    out.words.emplace_back(
        "lost motion is not determined: the readings are larger where the position is approached in direction +; the indicator counts "
        "against the axis, or the directions are exchanged (change the sign of the readings)");
    return out;
  }
  double friction = 0.0;
  const bool apart = all.loaded() && told_apart(out, all, together, friction);
  std::string differs = differs_along(series, apart ? std::optional(friction) : std::nullopt);
  const bool one = differs.empty();
  if (!one) out.words.insert(out.words.begin(), std::move(differs));
  if (apart) return out;
  out.total = Estimate{1e-6 * total.value, 1e-6 * total.half_width};
  if (!(total.low() > 0.0) && !one) return out;
  if (!(total.low() > 0.0)) {
    out.none = true;
    out.words.push_back(
        fmt::format("no lost motion was found; it is at most {} um", digits(std::max(0.0, total.high()), 2)));
    return out;
  }
  if (!all.loaded()) {
    out.words.emplace_back(
        "without loads, backlash and wind-up cannot be distinguished: only their sum is known (repeat the series with loads on the table "
        "that exceed its friction, in both directions)");
    return out;
  }
  const Estimate compliance = unknown(together, all.step(), 0);
  if (compliance.value > 0.0 && compliance.half_width < kMostError * compliance.value) {
    out.stiffness = stiffness_of(compliance);
    out.words.emplace_back(
        "backlash and wind-up cannot be distinguished: no load exceeds the friction of the table clearly; the stiffness and the sum are "
        "known (give larger loads)");
  } else {
    out.words.emplace_back(
        "the wind-up is not determined: the readings change too little with the load (give larger loads, or more readings)");
  }
  return out;
}

}  // namespace stribeck::ident::lost_motion
