// A table on a spring behind the motor (residual.hpp: Elastic). The table follows the measured motion, see Follower; Search
// looks for the numbers of the table with which least is left of the force.
//
// Source: two-mass drive with friction on both sides; docs/theory/identification.md, "A drive that gives way".

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/residual/residual_parts.hpp>
#include <stribeck/ident/stats/linear.hpp>
#include <stribeck/ident/stats/simplex.hpp>
#include <vector>

namespace stribeck::ident::residual {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kStep = 1e-3;                      // [s] of the search, at least
constexpr std::size_t kMostSteps = 60'000;          // of all records, for the search
constexpr double kLowestHz = 2.0, kHighestHz = 90;  // [Hz]
constexpr double kFewestSteps = 6.0;                // per oscillation
constexpr int kFrequencies = 44;
constexpr double kRoughGain = 0.9;      // of the square that is left, at frequencies some percent apart
constexpr double kGain = 0.5;           // of the square that is left
constexpr double kToldFrequency = 1.5;  // ends of the interval of the frequency
constexpr double kAsGood = 1.5;         // square of what explains nearly as much
constexpr double kLeastTable = 0.03;    // of the whole mass
constexpr double kMostTable = 1.05;     // of the whole mass
constexpr double kFromBorder = 1.1;     // in frequency
constexpr int kAround = 12;             // steps to half and to twice the frequency
constexpr double kUsualDamping = 0.04;
constexpr double kMostDamping = 0.15;  // ratio; more looks like a filter of the force
constexpr double kMuchDamping =
    0.1;  // ratio; at a frequency that is not told, this looks like an error of the shift
constexpr double kAtRest = 0.01;  // of the top speed
constexpr double kRings = 0.5;    // [s] after a start in motion
constexpr std::size_t kFewestTableRows = 200;
constexpr double kFrictionBehind = 0.1;  // of that of the axis: less is none on the table's side
constexpr double kTooLight = 0.4;        // see widen_for_friction()
constexpr double kMostLate = 5e-3;       // [s], beside the shift of the model
constexpr double kMostFriction = 1.5;    // of that of the axis, on the table's side

/// A part of a motion at equal steps.
struct Course {
  double step = 0.0;  ///< [s]
  double from = 0.0;  ///< time of the first step [s]
  std::vector<double> v, a, direction;
};

/// Means of as many rows as a step has, over rows whose window lies inside the record; their times are the middle of each step.
Course course_of(const log::Motion& m, double from, double step, std::size_t most) {
  Course c;
  const auto reach = static_cast<std::size_t>(m.reach);
  const auto rows = std::max<std::size_t>(1, static_cast<std::size_t>(step / m.sample_time + 0.5));
  c.step = static_cast<double>(rows) * m.sample_time;
  c.from = from + (static_cast<double>(reach) + 0.5 * static_cast<double>(rows - 1)) * m.sample_time;
  for (std::size_t k = reach; k + rows + reach <= m.rows() && c.a.size() < most; k += rows) {
    double v = 0.0, a = 0.0;
    for (std::size_t i = k; i < k + rows; ++i) v += m.v[i], a += m.a[i];
    c.v.push_back(v / static_cast<double>(rows));
    c.a.push_back(a / static_cast<double>(rows));
    c.direction.push_back(m.direction[k + rows / 2]);
  }
  return c;
}

/// What the table is made of.
struct Table {
  double omega = 0.0;     ///< of the table on the spring, motor held [rad/s]
  double damping = 0.0;   ///< ratio
  double friction = 0.0;  ///< over its mass [m/s²]
  double late = 0.0;      ///< time by which its force is later than the shift of the model says [s]
};

/// Motion of the table on its spring behind the given motion of the motor, from step to step. The acceleration of the motor is
/// straight between steps, for which the oscillator is solved exactly; within a step the table slides in one direction or
/// sticks.
class Follower {
 public:
  Follower(const Table& t, double step) : t_(t), step_(step), square_(t.omega * t.omega) {
    const double decay = t.damping * t.omega, turn = t.omega * std::sqrt(1.0 - t.damping * t.damping);
    const double e = std::exp(-decay * step), s = std::sin(turn * step) / turn, c = std::cos(turn * step);
    zz_ = e * (c + decay * s), zr_ = e * s, rz_ = -e * square_ * s, rr_ = e * (c - decay * s);
  }

  /// Force of the spring over the table's mass, less that of a rigid drive [m/s²], at each step.
  void follow(const Course& c, std::vector<double>& out) {
    out.resize(c.a.size());
    if (c.a.empty()) return;
    side_ = std::abs(c.v[0]) > 0.0 ? (c.v[0] > 0.0 ? 1.0 : -1.0) : 0.0;
    stretch_ = (c.a[0] + side_ * t_.friction) / square_, rate_ = 0.0;
    for (std::size_t k = 0;; ++k) {
      out[k] = carried() - c.a[k] - t_.friction * c.direction[k];
      if (k + 1 == c.a.size()) return;
      advance(c.a[k], c.a[k + 1], c.v[k], c.v[k + 1]);
    }
  }

 private:
  [[nodiscard]] double carried() const { return square_ * stretch_ + 2.0 * t_.damping * t_.omega * rate_; }

  void advance(double a, double next_a, double v, double next_v) {
    if (side_ == 0.0 && t_.friction > 0.0) {
      stretch_ += 0.5 * (v + next_v) * step_, rate_ = next_v;
      if (std::abs(carried()) > t_.friction) side_ = carried() > 0.0 ? 1.0 : -1.0;
      return;
    }
    const double u = a + side_ * t_.friction, slope = (next_a - a) / step_;
    const double at = u / square_ - 2.0 * t_.damping * slope / (square_ * t_.omega), moves = slope / square_;
    const double z = stretch_ - at, r = rate_ - moves;
    stretch_ = at + moves * step_ + zz_ * z + zr_ * r;
    rate_ = moves + rz_ * z + rr_ * r;
    if (t_.friction == 0.0 || side_ * (next_v - rate_) >= 0.0) return;
    rate_ = next_v;  // the table stands
    side_ = 0.0;
    if (std::abs(carried()) > t_.friction) side_ = carried() > 0.0 ? 1.0 : -1.0;
  }

  Table t_;
  double step_, square_;
  double zz_ = 1.0, zr_ = 0.0, rz_ = 0.0, rr_ = 1.0;
  double stretch_ = 0.0, rate_ = 0.0, side_ = 0.0;
};

/// Time from which on the swing of the table is known: one that was there when the record began has died out.
double begin_of(const Course& c) {
  if (c.v.empty()) return c.from;
  double top = 0.0;
  for (const double v : c.v) top = std::max(top, std::abs(v));
  return c.from + (std::abs(c.v.front()) > kAtRest * top ? kRings : 0.0);
}

/// Whether the motion of the table is known at a time; `begin`: see begin_of().
bool tells(const Course& c, double begin, double t) {
  return c.a.size() > 2 && t >= begin && t <= c.from + c.step * static_cast<double>(c.a.size() - 1);
}

/// Searches the table that explains most of what the columns of the rigid model leave.
class Search {
 public:
  Search(const std::vector<Left>& left, const Rows& rows, const MatrixXd& base, const VectorXd& force,
         double rigid_mass)
      : rigid_mass_(rigid_mass) {
    std::size_t steps = 0;
    for (const Left& l : left) {
      courses_.push_back(course_of(l.motion, l.record->t.front(), kStep, kMostSteps - steps));
      steps += courses_.back().a.size();
      longest_ = std::max(longest_, courses_.back().step);
    }
    std::vector<double> begin;
    for (const Course& c : courses_) begin.push_back(begin_of(c));
    std::vector<Index> used;
    for (std::size_t i = 0; i < rows.rows.size(); ++i) {
      const auto record = static_cast<std::size_t>(rows.rows[i].record);
      if (!tells(courses_[record], begin[record], rows.rows[i].t)) continue;
      used.push_back(static_cast<Index>(i));
      at_.push_back({record, rows.rows[i].t});
    }
    const auto n = static_cast<Index>(used.size());
    base_.resize(n, base.cols() + 1);
    base_.leftCols(base.cols()) = base(used, Eigen::all);
    // A shift of the force that was found with the wrong mass: the derivative of the acceleration.
    std::vector<std::vector<double>> jerk;
    for (const Course& c : courses_) {
      jerk.emplace_back(c.a.size(), 0.0);
      for (std::size_t k = 1; k + 1 < c.a.size(); ++k)
        jerk.back()[k] = (c.a[k + 1] - c.a[k - 1]) / (2.0 * c.step);
    }
    base_.rightCols(1) = column(jerk, 0.0);
    const VectorXd scale = base_.colwise().norm().cwiseMax(1e-300);
    base_ = base_ * scale.cwiseInverse().asDiagonal();
    mass_scale_ = scale(0);
    inverse_ = stats::pseudo_inverse(stats::gram(base_));
    weights_ = inverse_ * (base_.transpose() * force(used));
    left_ = force(used) - base_ * weights_;
    square_ = left_.squaredNorm();
  }

  [[nodiscard]] std::size_t rows() const { return at_.size(); }
  [[nodiscard]] double fastest() const { return std::min(kHighestHz, 1.0 / (kFewestSteps * longest_)); }
  [[nodiscard]] double square_without() const { return square_; }

  struct Found {
    Table table;
    double square = std::numeric_limits<double>::infinity();
    double table_mass = 0.0;
    double mass = 0.0;
  };

  /// The masses that go with a table, and what they leave.
  Found judge(const Table& t) {
    Found f;
    f.table = t;
    std::vector<std::vector<double>> forces(courses_.size());
    for (std::size_t r = 0; r < courses_.size(); ++r)
      Follower(t, courses_[r].step).follow(courses_[r], forces[r]);
    const VectorXd c = column(forces, t.late);
    const VectorXd by_base = inverse_ * (base_.transpose() * c);
    const VectorXd alone = c - base_ * by_base;
    const double size = alone.squaredNorm();
    if (!(size > 1e-9 * c.squaredNorm())) return f;
    f.table_mass = alone.dot(left_) / size;
    f.square = square_ - f.table_mass * f.table_mass * size;
    f.mass = rigid_mass_ + (weights_(0) - f.table_mass * by_base(0)) / mass_scale_;
    if (!(f.table_mass > 0.0) || !std::isfinite(f.square)) f.square = std::numeric_limits<double>::infinity();
    tried_.push_back(f);
    return f;
  }

  /// Whether a drive can be like this; a filter of the force looks like a spring with much damping.
  [[nodiscard]] bool believable(const Found& f) const {
    const double hz = f.table.omega / (2.0 * kPi);
    return f.table_mass > kLeastTable * f.mass && f.table_mass < kMostTable * f.mass &&
           f.table.damping <= kMostDamping && hz > kFromBorder * kLowestHz && hz * kFromBorder < fastest();
  }

  /// The best of those that were tried; of the believable ones alone, where asked for.
  [[nodiscard]] Found best(bool only_believable) const {
    Found best;
    for (const Found& f : tried_) {
      if (f.square < best.square && (!only_believable || believable(f))) best = f;
    }
    return best;
  }

  /// Best over frequencies, without friction on the table and with some over its mass [m/s²].
  Found over_frequencies(double some) {
    Found best;
    for (int i = 0; i < kFrequencies; ++i) {
      const double hz = kLowestHz * std::pow(fastest() / kLowestHz, i / (kFrequencies - 1.0));
      for (const double friction : {0.0, some}) {
        const Found f = judge({2.0 * kPi * hz, kUsualDamping, friction});
        if (f.square < best.square) best = f;
      }
    }
    return best;
  }

  /// Searches on from there; `friction` is that of the axis [N]. At first without a shift of its own: far below the anti-resonance it
  /// does the same as the damping.
  void refine(const Found& start, double friction) {
    for (const double share : {0.0, 0.3, 0.9})
      descend(start.table, share, friction / start.table_mass, false);
    const Found found = best(true);
    if (!std::isfinite(found.square)) return;
    const double scale = friction / found.table_mass;
    descend(found.table, found.table.friction / scale, scale, true);
  }

  /// Tries the tables around the best one, so that the spread of those that explain nearly as much shows.
  void look_around(const Found& best) {
    for (int i = -kAround; i <= kAround; ++i) {
      // Far below the anti-resonance table_mass/ω² is what the motion tells, and the friction stays.
      const double times = std::exp2(static_cast<double>(i) / kAround);
      for (const double damping : {0.5, 1.0, 2.0}) {
        judge({times * best.table.omega, std::min(damping * best.table.damping, 2.0 * kMostDamping),
               best.table.friction / (times * times), best.table.late});
      }
    }
  }

  /// Least and largest value among those that explain nearly as much.
  template <class Value>
  [[nodiscard]] Interval spread(const Found& best, Value value) const {
    Interval out{value(best), value(best)};
    for (const Found& f : tried_) {
      if (!believable(f) || f.square >= kAsGood * best.square) continue;
      out.low = std::min(out.low, value(f)), out.high = std::max(out.high, value(f));
    }
    return out;
  }

 private:
  /// Simplex from a table on; `share` of the friction lies behind the spring, which is `scale` over the mass of the table.
  void descend(const Table& from, double share, double scale, bool with_shift) {
    const auto value = [&](const std::vector<double>& p) {
      const Found f = judge({std::exp(p[0]), std::clamp(std::exp(p[1]), 1e-3, 2.0 * kMostDamping),
                             std::clamp(p[2], 0.0, kMostFriction) * scale,
                             p.size() > 3 ? std::clamp(p[3], -1.0, 1.0) * kMostLate : 0.0});
      return std::isfinite(f.square) ? f.square / square_ : 2.0;
    };
    stats::SimplexOptions options;
    options.tolerance = 1e-4;
    options.evaluations = 150;
    std::vector<double> start{std::log(from.omega), std::log(from.damping), share};
    std::vector<double> step{0.05, -0.7, share == 0.0 ? 0.1 : 0.2};
    if (with_shift) start.push_back(0.0), step.push_back(0.1);
    stats::minimise_simplex(value, start, step, options);
  }

  [[nodiscard]] VectorXd column(const std::vector<std::vector<double>>& values, double late) const {
    VectorXd c(static_cast<Index>(at_.size()));
    for (std::size_t i = 0; i < at_.size(); ++i)
      c(static_cast<Index>(i)) =
          value_between(values[at_[i].record],
                        (at_[i].t - late - courses_[at_[i].record].from) / courses_[at_[i].record].step);
    return c;
  }

  struct At {
    std::size_t record = 0;
    double t = 0.0;
  };
  std::vector<Course> courses_;
  std::vector<At> at_;
  double longest_ = 0.0;
  MatrixXd base_, inverse_;
  VectorXd weights_, left_;
  double rigid_mass_ = 0.0, mass_scale_ = 1.0;
  double square_ = 0.0;
  std::vector<Found> tried_;
};

/// Marks the rows whose force is not known: those near the ends, and those at the start of a record that does not start at rest.
void skip_start(const log::Motion& m, log::Record& record) {
  const auto reach = static_cast<std::size_t>(m.reach);
  record.skip.resize(record.x.size(), 0);
  const double end = begin_of(course_of(m, 0.0, m.sample_time, m.rows()));
  for (std::size_t k = 0; k < record.skip.size(); ++k) {
    const bool outside = k < reach || k + reach >= record.skip.size();
    if (outside || static_cast<double>(k) * m.sample_time < end) record.skip[k] = 1;
  }
}

/// Where the table is held by friction, what it does at a reversal passes the low-pass of the motion only in part: the table was
/// found too light, by 3 to 15 % where the anti-resonance was 0.6 of the cut-off, by 25 to 40 % where it was as high.
void widen_for_friction(const std::vector<Left>& left, double friction, Elastic& e) {
  if (!(e.friction > kFrictionBehind * friction)) return;
  double cut_off = std::numeric_limits<double>::infinity();
  for (const Left& l : left) {
    const double own = log::cut_off_of(l.motion);
    if (own < cut_off) cut_off = own;
  }
  const double more = 1.0 + kTooLight * std::pow(e.frequency / cut_off, 2.0);
  e.table_interval.high = std::min(more * e.table_interval.high, std::max(e.mass, e.table_interval.high));
  e.frequency_interval.high *= std::sqrt(more);
}

}  // namespace

double value_between(const std::vector<double>& values, double row) {
  const double at = std::clamp(row, 0.0, static_cast<double>(values.size() - 1));
  const auto before = std::min(static_cast<std::size_t>(at), values.size() - 1);
  const std::size_t after = std::min(before + 1, values.size() - 1);
  const double share = at - static_cast<double>(before);
  return (1.0 - share) * values[before] + share * values[after];
}

std::vector<double> force_of(const Elastic& e, const log::Motion& m) {
  const Course c = course_of(m, 0.0, m.sample_time, m.rows());
  std::vector<double> force(m.rows(), 0.0), inside;
  Follower({2.0 * kPi * e.frequency, e.damping, e.friction / e.table_mass}, c.step).follow(c, inside);
  for (std::size_t k = 0; k < inside.size(); ++k)
    force[k + static_cast<std::size_t>(m.reach)] = e.table_mass * inside[k];
  return force;
}

void take_off(const Elastic& elastic, double shift, log::Record& record) {
  const log::Motion motion = log::reconstruct(record);
  // This force has passed the window W of the motion, the logged one has not: W(3 − 3W + W²) = 1 − (1 − W)³ is nearly 1.
  std::vector<double> force = force_of(elastic, motion);
  const std::vector<double> once = log::smooth_like(motion, force), twice = log::smooth_like(motion, once);
  for (std::size_t k = 0; k < force.size(); ++k) force[k] = 3.0 * (force[k] - once[k]) + twice[k];
  skip_start(motion, record);
  const double late = shift + elastic.late / record.sample_time;
  for (std::size_t k = 0; k < record.f.size(); ++k)
    record.f[k] -= value_between(force, static_cast<double>(k) - late);
}

std::optional<Elastic> find_table(const std::vector<Left>& left, const Rows& rows, const MatrixXd& base,
                                  const VectorXd& force, double rigid_mass) {
  Search search(left, rows, base, force, rigid_mass);
  if (search.rows() < kFewestTableRows || !(search.square_without() > 0.0) || !(rigid_mass > 0.0) ||
      search.fastest() < 2.0 * kLowestHz)
    return {};
  const Search::Found rough = search.over_frequencies(rows.friction / rigid_mass);
  if (!(rough.square < kRoughGain * search.square_without())) return {};
  search.refine(rough, rows.friction);
  if (!std::isfinite(search.best(true).square)) return {};
  search.look_around(search.best(true));
  const Search::Found best = search.best(true);
  if (!(best.square < kGain * search.square_without())) return {};
  if (best.square > kAsGood * search.best(false).square) return {};
  Elastic e;
  e.frequency = best.table.omega / (2.0 * kPi);
  e.damping = best.table.damping;
  e.table_mass = std::min(best.table_mass, best.mass);
  e.friction = best.table.friction * e.table_mass;
  e.mass = best.mass;
  e.late = best.table.late;
  e.frequency_interval =
      search.spread(best, [](const Search::Found& f) { return f.table.omega / (2.0 * kPi); });
  const bool told = e.frequency_interval.high < kToldFrequency * e.frequency_interval.low;
  if (!told && e.damping > kMuchDamping) return {};
  e.table_interval = search.spread(best, [](const Search::Found& f) { return f.table_mass; });
  e.table_interval.low = std::min(e.table_interval.low, e.table_mass);
  widen_for_friction(left, rows.friction, e);
  const Interval masses = search.spread(best, [](const Search::Found& f) { return f.mass; });
  e.mass_half_width = std::max(best.mass - masses.low, masses.high - best.mass);
  return e;
}

}  // namespace stribeck::ident::residual
