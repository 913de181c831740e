#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/log/motion.hpp>
#include <stribeck/ident/map/periodic.hpp>
#include <stribeck/ident/methods/position_map.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/stats/uncertainty.hpp>
#include <string>

namespace stribeck::ident::methods {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Index = Eigen::Index;
using friction::EccentricForm;

constexpr int kTerms = 4;
constexpr int kTermsHeld = 10;
constexpr std::size_t kFewestRows = 60;
/// Way after a reversal that is left out, of the stroke and of the noise of x.
constexpr double kExcludedStroke = 2e-3;
constexpr double kExcludedNoise = 20.0;
constexpr double kSlowest = 0.02;  ///< of the largest speed
/// The window of the motion reaches at most over this share of the stroke, or it would wipe out short periods.
constexpr double kWindowWay = 1.0 / 400.0;
constexpr std::size_t kMostGroups = 100000;
/// The rise towards standstill lies within this share of the largest speed.
constexpr double kFastestRise = 0.35;
constexpr int kRiseSteps = 24;
constexpr std::size_t kFewestBlocks = 6;
constexpr double kWeakInstrument = 0.1;
constexpr std::size_t kPlotted = 1200;

std::string text(const char* format, auto... values) {
  char buffer[320];
  std::snprintf(buffer, sizeof buffer, format, values...);
  return buffer;
}

const char* const kHoming =
    "the phase of a periodic term belongs to the homing of this log: after another homing it must be found "
    "again";

Parameter parameter(std::string name, double value, const char* unit, const char* shown, double half,
                    bool seen = true) {
  Parameter p;
  p.name = std::move(name);
  p.value = value;
  p.unit = unit;
  p.shown = shown;
  p.ci_low = value - half;
  p.ci_high = value + half;
  p.identifiable = seen && std::isfinite(half) && half < std::abs(value);
  return p;
}

/// Consecutive rows of one stretch, averaged; one row each unless the log is very long.
struct Group {
  int record = 0;
  std::size_t first = 0;
  std::size_t rows = 1;
  double sign = 1.0;
  int block = 0;
};

/// a·sin(2πf·x) + b·cos(2πf·x), reversing with the direction or not.
struct Line {
  double f = 0.0;
  double a = 0.0;
  double b = 0.0;
  bool reversing = false;
  bool told = true;
};

/// Which columns a model has; the indices into its parameters, −1 where absent.
struct Shape {
  bool mass = true;
  bool load = true;
  bool asymmetric = false;
  bool rise = false;
  bool periodic = false;

  [[nodiscard]] int count(std::size_t lines) const {
    return (mass ? 1 : 0) + 2 + (load ? 1 : 0) + (asymmetric ? 1 : 0) + (rise ? 2 : 0) +
           (periodic ? 3 * static_cast<int>(lines) : 0);
  }
  [[nodiscard]] std::string name() const {
    std::string s = "conventional";
    if (rise) s += ", Stribeck rise";
    if (asymmetric) s += ", viscous by direction";
    if (periodic) s += ", periodic";
    return s;
  }
};

struct Fit {
  Shape shape;
  MatrixXd X;      ///< regressors
  MatrixXd W;      ///< the same, the acceleration projected on the instrument
  VectorXd theta;  ///< [mass] coulomb viscous [load] [viscous difference] [rise] [sin cos]…
  VectorXd e;
  bool weak = false;

  [[nodiscard]] Index coulomb() const { return shape.mass ? 1 : 0; }
  [[nodiscard]] Index viscous() const { return coulomb() + 1; }
  [[nodiscard]] Index load() const { return viscous() + 1; }
  [[nodiscard]] Index asymmetric() const { return viscous() + 1 + (shape.load ? 1 : 0); }
  [[nodiscard]] Index rise() const { return asymmetric() + (shape.asymmetric ? 1 : 0); }
  [[nodiscard]] Index line(std::size_t j) const {
    return rise() + (shape.rise ? 1 : 0) + 2 * static_cast<Index>(j);
  }
};

class Identification {
 public:
  Identification(const std::vector<log::Record>& records, const PositionMapOptions& options)
      : records_(records), options_(options) {}

  Result run() {
    prepare();
    gather();
    Shape full{!options_.mass, both_, both_, true, false};
    find_rise(full);
    Fit fit = solve(full);
    // Twice: the first fit knew nothing of the terms.
    for (int round = 0; round < 2; ++round) {
      search(fit, round == 0);
      if (lines_.empty()) break;
      full.periodic = true;
      fit = refine(full);
      find_rise(full);
      fit = refine(full);
    }
    const Shape best = choose(full);
    fit = refine(best);
    if (best.mass) {
      const MatrixXd D = derivatives(fit);
      const double half = width(uncertainty(fit, D), unseen(fit, D), unit(fit, D, 0));
      if (!(fit.theta(0) > half)) {
        result_.cannot_tell.push_back(
            "mass: this motion does not determine it" +
            (std::isfinite(half) ? text(" (%.3g ± %.3g)", fit.theta(0), half) : std::string()) +
            "; accelerate more, or give the mass");
        no_mass_ = true;
        Shape without = best;
        without.mass = false;
        fit = refine(without);
      }
    }
    return finish(fit);
  }

 private:
  void prepare() {
    for (const log::Record& r : records_) {
      const auto wrong = log::problems(r);
      if (!wrong.empty()) throw Refused(wrong.front());
      if (r.force_unit != records_.front().force_unit || r.position_unit != records_.front().position_unit) {
        throw Refused(r.source + ": force in " + r.force_unit + " over " + r.position_unit + ", expected " +
                      records_.front().force_unit + " over " + records_.front().position_unit +
                      " as in the first log");
      }
      log::Motion m = log::reconstruct(r);
      std::vector<double> speed(m.v);
      for (double& v : speed) v = std::abs(v);
      const auto fast = speed.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(speed.size()));
      std::nth_element(speed.begin(), fast, speed.end());
      const double way = *fast * r.sample_time;
      if (way > 0.0 && m.window * way > kWindowWay * m.stroke) {
        m = log::reconstruct(r, {static_cast<int>(kWindowWay * m.stroke / way)});
      }
      if (m.loop == log::Loop::kAutomatic && !options_.mass) {
        result_.warnings.push_back(
            r.source +
            ": no reference and no programmed force: the mass rests on smoothed accelerations alone");
      }
      motions_.push_back(std::move(m));
    }
  }

  void gather() {
    double stroke = 0.0;
    double noise = 0.0;
    for (const log::Motion& m : motions_) {
      stroke = std::max(stroke, m.stroke);
      noise = std::max(noise, m.position_noise);
      for (std::size_t k = 0; k < m.rows(); ++k) top_ = m.valid(k) ? std::max(top_, std::abs(m.v[k])) : top_;
    }
    const double exclude = std::max(kExcludedStroke * stroke, kExcludedNoise * noise);
    const auto wanted = [&](const log::Motion& m, std::size_t k) {
      return m.v[k] * m.direction[k] >= kSlowest * top_ && top_ > 0.0 && m.sliding(k, exclude);
    };
    std::size_t count[2] = {0, 0};
    for (const log::Motion& m : motions_) {
      for (std::size_t k = 0; k < m.rows(); ++k) count[m.direction[k] > 0] += wanted(m, k) ? 1u : 0u;
    }
    rows_ = count[0] + count[1];
    both_ = count[0] >= kFewestRows && count[1] >= kFewestRows;
    if (rows_ < 2 * kFewestRows) {
      throw Refused(
          text("position map: %zu rows of sliding motion, expected at least %zu; move over several periods "
               "of the screw in both directions",
               rows_, 2 * kFewestRows));
    }
    together_ = 1 + rows_ / kMostGroups;
    int blocks = -1;
    for (std::size_t r = 0; r < motions_.size(); ++r) {
      const log::Motion& m = motions_[r];
      int stretch = -1;
      for (std::size_t k = 0; k < m.rows(); ++k) {
        if (!wanted(m, k)) continue;
        if (m.stretch[k] != stretch) ++blocks, stretch = m.stretch[k];
        Group* last = groups_.empty() ? nullptr : &groups_.back();
        if (last != nullptr && last->block == blocks && last->rows < together_ &&
            last->first + last->rows == k) {
          ++last->rows;
        } else {
          groups_.push_back({static_cast<int>(r), k, 1, static_cast<double>(m.direction[k]), blocks});
        }
      }
    }
    const auto n = static_cast<Index>(groups_.size());
    y_ = collect([&](std::size_t r) -> const std::vector<double>& { return motions_[r].f; });
    a_ = collect([&](std::size_t r) -> const std::vector<double>& { return motions_[r].a; });
    z_ = collect([&](std::size_t r) -> const std::vector<double>& { return motions_[r].instrument; });
    v_ = collect([&](std::size_t r) -> const std::vector<double>& { return motions_[r].v; });
    x_ = collect([&](std::size_t r) -> const std::vector<double>& { return records_[r].x; });
    s_.resize(n);
    for (Index i = 0; i < n; ++i) s_(i) = groups_[static_cast<std::size_t>(i)].sign;
    if (options_.mass) y_ -= *options_.mass * a_;
    middle_ = 0.5 * (x_.minCoeff() + x_.maxCoeff());
    length_ = x_.maxCoeff() - x_.minCoeff();
    low_speed_ = v_.cwiseAbs().minCoeff();
  }

  template <class Column>
  VectorXd collect(Column&& column) const {
    VectorXd out(static_cast<Index>(groups_.size()));
    for (std::size_t i = 0; i < groups_.size(); ++i) {
      const Group& g = groups_[i];
      const std::vector<double>& c = column(static_cast<std::size_t>(g.record));
      double sum = 0.0;
      for (std::size_t k = g.first; k < g.first + g.rows; ++k) sum += c[k];
      out(static_cast<Index>(i)) = sum / static_cast<double>(g.rows);
    }
    return out;
  }

  /// A function of position through the same window and means as everything else.
  template <class Function>
  VectorXd of_position(Function&& function) const {
    std::vector<std::vector<double>> columns;
    for (std::size_t r = 0; r < records_.size(); ++r) {
      std::vector<double> c(records_[r].x.size());
      for (std::size_t k = 0; k < c.size(); ++k) c[k] = function(records_[r].x[k] - middle_);
      columns.push_back(log::smooth_like(motions_[r], c));
    }
    return collect([&](std::size_t r) -> const std::vector<double>& { return columns[r]; });
  }
  [[nodiscard]] VectorXd signed_as(const Line& line, VectorXd column) const {
    return line.reversing ? VectorXd(column.cwiseProduct(s_)) : column;
  }
  [[nodiscard]] VectorXd rise_column(double v0) const {
    return s_.array() * (-(v_.array() / v0).square()).exp();
  }
  [[nodiscard]] VectorXd rise_slope(double v0) const {
    return rise_column(v0).array() * 2.0 * v_.array().square() / (v0 * v0 * v0);
  }

  [[nodiscard]] Fit solve(const Shape& shape) const {
    Fit fit;
    fit.shape = shape;
    const std::size_t lines = shape.periodic ? lines_.size() : 0;
    const Index p = fit.line(lines);
    MatrixXd& X = fit.X;
    X.resize(y_.size(), p);
    if (shape.mass) X.col(0) = a_;
    X.col(fit.coulomb()) = s_;
    X.col(fit.viscous()) = v_;
    if (shape.load) X.col(fit.load()).setOnes();
    if (shape.asymmetric) X.col(fit.asymmetric()) = v_.cwiseAbs();
    if (shape.rise) X.col(fit.rise()) = rise_column(v0_);
    for (std::size_t j = 0; j < lines; ++j) {
      const double w = 2.0 * kPi * lines_[j].f;
      X.col(fit.line(j)) = signed_as(lines_[j], of_position([&](double u) { return std::sin(w * u); }));
      X.col(fit.line(j) + 1) = signed_as(lines_[j], of_position([&](double u) { return std::cos(w * u); }));
    }
    fit.W = X;
    if (shape.mass) {
      // First stage: the acceleration from the instrument and the other columns.
      MatrixXd Z = X;
      Z.col(0) = z_;
      const VectorXd c = normal(Z, a_);
      const VectorXd projected = Z * c;
      VectorXd rest = X.rightCols(p - 1) * normal(X.rightCols(p - 1), a_);
      const double own = (a_ - rest).squaredNorm();
      fit.weak = !((projected - rest).squaredNorm() > kWeakInstrument * own);
      if (!fit.weak) fit.W.col(0) = projected;
    }
    fit.theta = normal(fit.W, y_);
    fit.e = y_ - X * fit.theta;
    return fit;
  }

  /// Least squares by scaled normal equations.
  static VectorXd normal(const MatrixXd& X, const VectorXd& y) {
    const VectorXd scale = X.colwise().norm().cwiseMax(std::numeric_limits<double>::min()).cwiseInverse();
    const MatrixXd gram = scale.asDiagonal() * (X.transpose() * X) * scale.asDiagonal();
    return scale.asDiagonal() *
           gram.completeOrthogonalDecomposition().solve(scale.asDiagonal() * (X.transpose() * y));
  }

  /// v0 with the least squares, over a grid and then closer.
  void find_rise(const Shape& shape) {
    const double low = std::log(1.2 * low_speed_);
    const double high = std::log(kFastestRise * top_);
    if (!(high > low)) return;
    const auto cost = [&](double at, const MatrixXd& Q, const VectorXd& e) {
      // The column alone against what the others leave.
      const VectorXd c = rise_column(std::exp(at));
      const VectorXd own = c - Q * (Q.transpose() * c);
      const double power = own.squaredNorm();
      if (!(power > 1e-9 * c.squaredNorm())) return 0.0;
      return -std::pow(own.dot(e), 2.0) / power;
    };
    Shape others = shape;
    others.rise = false;
    const Fit fit = solve(others);
    const MatrixXd Q =
        Eigen::HouseholderQR<MatrixXd>(fit.X).householderQ() * MatrixXd::Identity(fit.X.rows(), fit.X.cols());
    const VectorXd e = y_ - Q * (Q.transpose() * y_);
    double best = low;
    double least = std::numeric_limits<double>::infinity();
    const double step = (high - low) / kRiseSteps;
    for (int i = 0; i <= kRiseSteps; ++i) {
      const double c = cost(low + i * step, Q, e);
      if (c < least) least = c, best = low + i * step;
    }
    double left = std::max(low, best - step);
    double right = std::min(high, best + step);
    constexpr double kGolden = 0.6180339887498949;
    for (int i = 0; i < 24; ++i) {
      const double a = right - kGolden * (right - left);
      const double b = left + kGolden * (right - left);
      (cost(a, Q, e) < cost(b, Q, e) ? right : left) = cost(a, Q, e) < cost(b, Q, e) ? b : a;
    }
    v0_ = std::exp(0.5 * (left + right));
  }

  void search(const Fit& fit, bool first) {
    // What the terms found before took is put back.
    VectorXd e = fit.e;
    if (fit.shape.periodic) {
      for (std::size_t j = 0; j < lines_.size(); ++j)
        e += fit.X.middleCols(fit.line(j), 2) * fit.theta.segment(fit.line(j), 2);
    }
    map::PeriodicRows rows;
    for (std::size_t i = 0; i < groups_.size(); ++i) {
      rows.x.push_back(x_(static_cast<Index>(i)));
      rows.e.push_back(e(static_cast<Index>(i)));
      rows.direction.push_back(groups_[i].sign > 0.0 ? 1 : -1);
      rows.record.push_back(groups_[i].record);
      rows.at.push_back(groups_[i].first);
    }
    map::PeriodicOptions options;
    options.most = options_.most_terms.value_or(kTerms);
    options.turn = options_.turn.value_or(0.0);
    map::PeriodicResult found = map::find_periodic(rows, options);
    if (!first && found.terms.empty()) return;
    lines_.clear();
    for (const map::PeriodicTerm& t : found.terms) {
      Line line;
      line.f = 1.0 / t.term.period;
      line.reversing = t.term.form == EccentricForm::kProportional;
      line.told = t.form_told;
      lines_.push_back(line);
    }
    result_.spectrum = std::move(found.spectrum);
    periodic_notes_ = std::move(found.notes);
    periodic_cannot_ = std::move(found.cannot_tell);
  }

  /// Gauss–Newton over the periods; all else is linear.
  Fit refine(const Shape& shape) {
    Fit fit = solve(shape);
    if (!shape.periodic) return fit;
    const bool exact = options_.turn.has_value();
    for (int iteration = 0; iteration < 8; ++iteration) {
      take_amplitudes(fit);
      if (exact) break;
      MatrixXd X(fit.W.rows(), fit.W.cols() + static_cast<Index>(lines_.size()));
      X.leftCols(fit.W.cols()) = fit.W;
      for (std::size_t j = 0; j < lines_.size(); ++j)
        X.col(fit.W.cols() + static_cast<Index>(j)) = line_slope(lines_[j]);
      const VectorXd step = normal(X, fit.e).tail(static_cast<Index>(lines_.size()));
      double largest = 0.0;
      for (std::size_t j = 0; j < lines_.size(); ++j) {
        const double d = std::clamp(step(static_cast<Index>(j)), -0.1 / length_, 0.1 / length_);
        lines_[j].f += d;
        largest = std::max(largest, std::abs(d) * length_);
      }
      fit = solve(shape);
      if (largest < 1e-7) break;
    }
    take_amplitudes(fit);
    return fit;
  }
  void take_amplitudes(const Fit& fit) {
    for (std::size_t j = 0; j < lines_.size(); ++j) {
      lines_[j].a = fit.theta(fit.line(j));
      lines_[j].b = fit.theta(fit.line(j) + 1);
    }
  }
  [[nodiscard]] VectorXd line_slope(const Line& line) const {
    const double w = 2.0 * kPi * line.f;
    return signed_as(line, of_position([&](double u) {
                       return 2.0 * kPi * u * (line.a * std::cos(w * u) - line.b * std::sin(w * u));
                     }));
  }

  /// Columns of the parameters that are not linear: v0, periods.
  [[nodiscard]] MatrixXd derivatives(const Fit& fit) const {
    std::vector<VectorXd> columns;
    if (fit.shape.rise) columns.push_back(fit.theta(fit.rise()) * rise_slope(v0_));
    if (fit.shape.periodic && !options_.turn) {
      for (const Line& line : lines_) columns.push_back(line_slope(line));
    }
    MatrixXd D(fit.X.rows(), static_cast<Index>(columns.size()));
    for (std::size_t j = 0; j < columns.size(); ++j) D.col(static_cast<Index>(j)) = columns[j];
    return D;
  }
  [[nodiscard]] static VectorXd unit(const Fit& fit, const MatrixXd& D, Index i) {
    return VectorXd::Unit(fit.X.cols() + D.cols(), i);
  }
  /// Combinations of parameters that these rows do not see at all, e.g. Coulomb against viscous at one speed.
  struct Unseen {
    VectorXd scale;  ///< of the parameters, one over the norm of each column
    MatrixXd null;   ///< in these scales, orthonormal columns
  };
  [[nodiscard]] Unseen unseen(const Fit& fit, const MatrixXd& D) const {
    constexpr double kNothing = 1e-10;
    MatrixXd X(fit.W.rows(), fit.W.cols() + D.cols());
    X << fit.W, D;
    Unseen out;
    out.scale = X.colwise().norm().cwiseMax(std::numeric_limits<double>::min()).cwiseInverse();
    X = X * out.scale.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(X.transpose() * X);
    Index none = 0;
    while (none < X.cols() && eigen.eigenvalues()(none) < kNothing) ++none;
    out.null = eigen.eigenvectors().leftCols(none);
    return out;
  }
  /// Half width of gᵀθ; NaN where it leans on what is not seen.
  [[nodiscard]] static double width(const stats::Uncertainty& u, const Unseen& unseen, const VectorXd& g) {
    constexpr double kLeans = 1e-3;
    const VectorXd scaled = g.cwiseProduct(unseen.scale);
    if ((unseen.null.transpose() * scaled).norm() > kLeans * scaled.norm())
      return std::numeric_limits<double>::quiet_NaN();
    return u.half_width(g);
  }
  [[nodiscard]] stats::Uncertainty uncertainty(const Fit& fit, const MatrixXd& D) const {
    MatrixXd X(fit.W.rows(), fit.W.cols() + D.cols());
    X << fit.W, D;
    const VectorXd scale = X.colwise().norm().cwiseMax(std::numeric_limits<double>::min()).cwiseInverse();
    const MatrixXd gram = scale.asDiagonal() * (X.transpose() * X) * scale.asDiagonal();
    const MatrixXd inverse = scale.asDiagonal() *
                             MatrixXd(gram.completeOrthogonalDecomposition().pseudoInverse()) *
                             scale.asDiagonal();
    std::vector<int> record;
    std::vector<std::size_t> at;
    for (const Group& g : groups_) {
      record.push_back(g.record);
      at.push_back(g.first / together_);
    }
    return {X, fit.e, inverse, record, at};
  }

  /// The simplest shape that predicts held-out passes within one standard error of the best.
  Shape choose(const Shape& full) {
    struct Tried {
      Shape shape;
      std::vector<double> cost;  // mean square of each block
      double mean = 0.0;
      double error = 0.0;
      int parameters = 0;
    };
    const std::vector<int> block = blocks();
    const std::size_t count = static_cast<std::size_t>(*std::max_element(block.begin(), block.end())) + 1;
    std::vector<Tried> tried;
    for (const bool periodic : {false, true}) {
      for (const bool asymmetric : {false, true}) {
        for (const bool rise : {false, true}) {
          if ((periodic && !full.periodic) || (asymmetric && !full.asymmetric)) continue;
          Tried t;
          t.shape = full;
          t.shape.periodic = periodic;
          t.shape.asymmetric = asymmetric;
          t.shape.rise = rise;
          t.parameters = t.shape.count(lines_.size());
          t.cost = held_out(solve(t.shape), block, count);
          for (const double c : t.cost) t.mean += c / static_cast<double>(count);
          tried.push_back(std::move(t));
        }
      }
    }
    const auto best = std::min_element(tried.begin(), tried.end(),
                                       [](const Tried& a, const Tried& b) { return a.mean < b.mean; });
    const Tried* chosen = &*best;
    for (Tried& t : tried) {
      double square = 0.0;
      for (std::size_t b = 0; b < count; ++b)
        square += std::pow(t.cost[b] - best->cost[b] - (t.mean - best->mean), 2.0);
      t.error = std::sqrt(square / static_cast<double>(count * (count - 1)));
      if (t.mean - best->mean <= t.error && t.parameters < chosen->parameters) chosen = &t;
    }
    for (const Tried& t : tried) {
      const double rms = std::sqrt(std::max(0.0, t.mean));
      Candidate c;
      c.name = t.shape.name();
      c.terms = t.shape.periodic ? static_cast<int>(lines_.size()) : 0;
      c.parameters = t.parameters;
      c.held_out_rms = rms;
      c.standard_error = rms > 0.0 ? t.error / (2.0 * rms) : 0.0;
      c.chosen = &t == chosen;
      result_.models.push_back(std::move(c));
      if (&t == chosen) result_.held_out_rms = rms;
    }
    return chosen->shape;
  }

  /// Passes; halved while there are too few.
  [[nodiscard]] std::vector<int> blocks() const {
    std::vector<int> block(groups_.size());
    for (std::size_t i = 0; i < block.size(); ++i) block[i] = groups_[i].block;
    std::size_t count = static_cast<std::size_t>(block.back()) + 1;
    while (count < kFewestBlocks) {
      std::vector<std::size_t> rows(count, 0);
      for (const int b : block) ++rows[static_cast<std::size_t>(b)];
      std::vector<std::size_t> seen(count, 0);
      for (int& b : block) {
        const auto k = static_cast<std::size_t>(b);
        b = 2 * b + (2 * seen[k]++ >= rows[k] ? 1 : 0);
      }
      count *= 2;
    }
    return block;
  }

  [[nodiscard]] std::vector<double> held_out(const Fit& fit, const std::vector<int>& block,
                                             std::size_t count) const {
    const Index p = fit.X.cols();
    const VectorXd scale = fit.X.colwise().norm().cwiseMax(std::numeric_limits<double>::min()).cwiseInverse();
    struct Sums {
      MatrixXd ww, xx;
      VectorXd wy, xy;
      double yy = 0.0;
      double rows = 0.0;
    };
    const auto empty = [p] {
      return Sums{MatrixXd::Zero(p, p), MatrixXd::Zero(p, p), VectorXd::Zero(p), VectorXd::Zero(p), 0.0, 0.0};
    };
    std::vector<Sums> part(count, empty());
    for (std::size_t first = 0; first < block.size();) {
      std::size_t last = first;
      while (last < block.size() && block[last] == block[first]) ++last;
      Sums& s = part[static_cast<std::size_t>(block[first])];
      const auto from = static_cast<Index>(first);
      const auto rows = static_cast<Index>(last - first);
      const MatrixXd X = fit.X.middleRows(from, rows) * scale.asDiagonal();
      const MatrixXd W = fit.W.middleRows(from, rows) * scale.asDiagonal();
      const auto y = y_.segment(from, rows);
      s.ww += W.transpose() * W;
      s.xx += X.transpose() * X;
      s.wy += W.transpose() * y;
      s.xy += X.transpose() * y;
      s.yy += y.squaredNorm();
      s.rows += static_cast<double>(rows);
      first = last;
    }
    Sums all = empty();
    for (const Sums& s : part) all.ww += s.ww, all.wy += s.wy;
    std::vector<double> cost;
    for (const Sums& s : part) {
      const VectorXd theta =
          MatrixXd(all.ww - s.ww).completeOrthogonalDecomposition().solve(VectorXd(all.wy - s.wy));
      const double square = s.yy - 2.0 * theta.dot(s.xy) + theta.dot(s.xx * theta);
      cost.push_back(s.rows > 0.0 ? std::max(0.0, square) / s.rows : 0.0);
    }
    return cost;
  }

  Result finish(const Fit& fit) {
    const MatrixXd D = derivatives(fit);
    const stats::Uncertainty u = uncertainty(fit, D);
    const Unseen null = unseen(fit, D);
    const auto half = [&](Index i) { return width(u, null, unit(fit, D, i)); };
    Result& r = result_;
    r.method = "position-map";
    r.force_unit = records_.front().force_unit;
    r.position_unit = records_.front().position_unit;
    r.rows = rows_;
    r.velocity_range = {std::min(0.0, v_.minCoeff()), std::max(0.0, v_.maxCoeff())};
    if (options_.mass) {
      r.mass = *options_.mass;
      r.mass_interval = {r.mass, r.mass};
    } else if (no_mass_) {
      r.mass = std::numeric_limits<double>::quiet_NaN();
    } else {
      r.mass = fit.theta(0);
      r.mass_interval = {r.mass - half(0), r.mass + half(0)};
      r.parameters.push_back(parameter("mass", r.mass, "kg", "N s2/mm", half(0)));
      if (fit.weak) {
        r.warnings.emplace_back(
            "the reference hardly moves with the measured acceleration; the mass rests on the latter");
      }
    }
    if (fit.shape.load) {
      r.load = fit.theta(fit.load());
      r.parameters.push_back(parameter("load", r.load, "N", "N", half(fit.load())));
    } else {
      r.cannot_tell.emplace_back(
          "load: the log has one direction only; the Coulomb friction contains the load");
    }
    write_friction(fit, D, u, null);
    if (fit.shape.periodic) write_terms(fit, D, u, null);
    if (options_.turn && !fit.shape.periodic) {
      r.cannot_tell.emplace_back(
          "periodic terms: at the given turn and its integer fractions none is above the noise");
    }
    if (null.null.cols() > 0) {
      r.cannot_tell.emplace_back(
          "every parameter without an interval: this motion does not separate it from the others (one speed only, or one motion repeated); together they describe the friction of this motion");
    }
    for (auto& note : periodic_notes_) r.warnings.push_back(std::move(note));
    if (fit.shape.periodic || !both_) {
      for (auto& note : periodic_cannot_) r.cannot_tell.push_back(std::move(note));
    }
    write_points(fit);
    return std::move(result_);
  }

  void write_friction(const Fit& fit, const MatrixXd& D, const stats::Uncertainty& u, const Unseen& null) {
    Result& r = result_;
    const double eta0 = fit.theta(fit.coulomb());
    const double eta1 = fit.theta(fit.viscous());
    const double difference = fit.shape.asymmetric ? fit.theta(fit.asymmetric()) : 0.0;
    const double rise = fit.shape.rise ? fit.theta(fit.rise()) : 0.0;
    const auto half = [&](Index i) { return width(u, null, unit(fit, D, i)); };
    r.parameters.push_back(parameter("eta0", eta0, "N", "N", half(fit.coulomb())));
    if (fit.shape.asymmetric) {
      for (const double sign : {1.0, -1.0}) {
        const VectorXd g = unit(fit, D, fit.viscous()) + sign * unit(fit, D, fit.asymmetric());
        r.parameters.push_back(parameter(sign > 0.0 ? "eta1_positive" : "eta1_negative",
                                         eta1 + sign * difference, "N s/m", "N s/mm", width(u, null, g)));
      }
    } else {
      r.parameters.push_back(parameter("eta1", eta1, "N s/m", "N s/mm", half(fit.viscous())));
    }
    if (fit.shape.rise) {
      // On V3 the bristle lags 2 N of 15 N behind the rise where the axis brakes, and after a reversal it is
      // not there yet: the value belongs to the curve of this motion.
      r.parameters.push_back(parameter("stribeck_rise", rise, "N", "N", half(fit.rise()), false));
      r.parameters.push_back(parameter("stribeck_velocity", v0_, "m/s", "mm/s", half(fit.X.cols()), false));
      r.cannot_tell.emplace_back(
          "Stribeck rise: accelerated motion may pass low speeds too fast for pre-sliding to settle; its value is valid for this motion only, jogs at low speeds determine it");
    }
    if (fit.shape.asymmetric) {
      r.model = "asymmetric";
      friction::Gaussian<double> map;
      map.velocity_range = r.velocity_range;
      map.positive.eta0 = eta0;
      map.positive.eta1 = eta1 + difference;
      map.negative.eta0 = -eta0;
      map.negative.eta1 = eta1 - difference;
      if (fit.shape.rise) {
        map.positive.gaussians.push_back({rise, 0.0, v0_});
        map.negative.gaussians.push_back({-rise, 0.0, v0_});
      }
      r.friction.steady = map;
    } else {
      r.model = "conventional";
      friction::Conventional<double> map;
      map.alpha0 = eta0;
      map.alpha2 = eta1;
      if (fit.shape.rise) map.stribeck = friction::Stribeck<double>{eta0 + rise, v0_, 2.0};
      r.friction.steady = map;
    }
    if (!(eta0 > 0.0)) {
      r.warnings.push_back(
          text("Coulomb friction came out as %.4g, which no axis has: look at the sign of the force and at "
               "a delay between force and position",
               eta0));
    }
    const int points = std::max(2, options_.curve_points);
    for (int i = -points; i <= points; ++i) {
      if (i == 0 || (i < 0 ? r.velocity_range[0] == 0.0 : r.velocity_range[1] == 0.0)) continue;
      const double sign = i < 0 ? -1.0 : 1.0;
      const double limit = std::abs(r.velocity_range[i < 0 ? 0 : 1]);
      const double v = sign * (low_speed_ + (limit - low_speed_) * (std::abs(i) - 1) / (points - 1));
      VectorXd g = sign * unit(fit, D, fit.coulomb()) + v * unit(fit, D, fit.viscous());
      if (fit.shape.asymmetric) g += std::abs(v) * unit(fit, D, fit.asymmetric());
      double f = sign * eta0 + eta1 * v + difference * std::abs(v);
      if (fit.shape.rise) {
        const double fade = std::exp(-std::pow(v / v0_, 2.0));
        f += sign * rise * fade;
        g += sign * fade * unit(fit, D, fit.rise());
        g += sign * rise * fade * 2.0 * v * v / (v0_ * v0_ * v0_) * unit(fit, D, fit.X.cols());
      }
      const double w = width(u, null, g);
      r.curve.push_back({v, f, f - w, f + w});
    }
  }

  void write_terms(const Fit& fit, const MatrixXd& D, const stats::Uncertainty& u, const Unseen& null) {
    Result& r = result_;
    r.model += "+periodic";
    std::vector<std::size_t> order(lines_.size());
    for (std::size_t j = 0; j < order.size(); ++j) order[j] = j;
    const auto amplitude = [&](std::size_t j) { return std::hypot(lines_[j].a, lines_[j].b); };
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return amplitude(a) > amplitude(b); });
    int number = 0;
    for (const std::size_t j : order) {
      const Line& line = lines_[j];
      const double A = amplitude(j);
      const bool exact = options_.turn.has_value();
      const Index slope = fit.X.cols() + (fit.shape.rise ? 1 : 0) + static_cast<Index>(j);
      const VectorXd sine = unit(fit, D, fit.line(j));
      const VectorXd cosine = unit(fit, D, fit.line(j) + 1);
      const VectorXd frequency = exact ? VectorXd(VectorXd::Zero(sine.size())) : unit(fit, D, slope);
      friction::Eccentric<double> term;
      term.amplitude = A;
      term.period = 1.0 / line.f;
      term.phase = std::remainder(2.0 * kPi * line.f * middle_ - std::atan2(line.b, line.a), 2.0 * kPi);
      term.form = line.reversing ? EccentricForm::kProportional : EccentricForm::kAdditive;
      const std::string name = "eccentric_" + std::to_string(++number) + "_";
      r.parameters.push_back(parameter(name + "amplitude", A, "N", "N",
                                       width(u, null, line.a / A * sine + line.b / A * cosine)));
      r.parameters.push_back(parameter(name + "period", term.period, "m", "mm",
                                       width(u, null, frequency) * term.period * term.period));
      r.parameters.push_back(parameter(
          name + "phase", term.phase, "rad", "rad",
          width(u, null,
                line.b / (A * A) * sine - line.a / (A * A) * cosine + 2.0 * kPi * middle_ * frequency)));
      // A phase is known or not by its width alone, not against zero.
      r.parameters.back().identifiable = r.parameters.back().ci_high - r.parameters.back().ci_low < 2.0 * kPi;
      r.friction.eccentric.push_back(term);
    }
    if (lines_.size() > friction::kMaxEccentricTerms) {
      r.warnings.push_back(text("%zu periodic terms found; an axis file holds the largest %zu", lines_.size(),
                                friction::kMaxEccentricTerms));
    }
    r.warnings.emplace_back(kHoming);
  }

  void write_points(const Fit& fit) {
    const std::size_t step = std::max<std::size_t>(1, groups_.size() / kPlotted);
    VectorXd terms = VectorXd::Zero(y_.size());
    if (fit.shape.periodic) {
      const Index first = fit.line(0);
      terms = fit.X.rightCols(fit.X.cols() - first) * fit.theta.tail(fit.X.cols() - first);
    }
    for (std::size_t i = 0; i < groups_.size(); i += step) {
      const auto k = static_cast<Index>(i);
      const Group& g = groups_[i];
      const log::Record& record = records_[static_cast<std::size_t>(g.record)];
      const double inertia = fit.shape.mass ? fit.theta(0) * a_(k) : 0.0;
      result_.residuals.push_back({record.t[g.first], x_(k), v_(k), fit.e(k), g.record});
      result_.map.push_back({v_(k), y_(k) - inertia - result_.load - terms(k), g.sign > 0.0 ? 1 : -1});
    }
  }

  const std::vector<log::Record>& records_;
  const PositionMapOptions& options_;
  Result result_;
  std::vector<log::Motion> motions_;
  std::vector<Group> groups_;
  std::size_t rows_ = 0;
  std::size_t together_ = 1;
  bool both_ = false;
  bool no_mass_ = false;
  double top_ = 0.0;
  double low_speed_ = 0.0;
  double middle_ = 0.0;
  double length_ = 0.0;
  double v0_ = 1e-3;
  VectorXd y_, a_, z_, v_, x_, s_;
  std::vector<Line> lines_;
  std::vector<std::string> periodic_notes_, periodic_cannot_;
};

/// Columns of a held record; its time need not be uniform.
void check_held(const log::Record& r) {
  if (r.x.size() != r.f.size() || r.t.size() != r.x.size()) {
    throw Refused(r.source + text(": columns t, x and f have %zu, %zu and %zu rows, expected one length",
                                  r.t.size(), r.x.size(), r.f.size()));
  }
  for (std::size_t k = 0; k < r.x.size(); ++k) {
    if (!std::isfinite(r.x[k]) || !std::isfinite(r.f[k])) {
      throw Refused(r.source +
                    text(": row %zu: position or force is not a finite number; repair or cut the log", k));
    }
  }
}

Result identify_held(const std::vector<log::Record>& records, const PositionMapOptions& options) {
  Result r;
  r.method = "position-map";
  r.model = "cogging";
  r.force_unit = records.front().force_unit;
  r.position_unit = records.front().position_unit;
  r.mass = std::numeric_limits<double>::quiet_NaN();
  map::PeriodicRows rows;
  double mean = 0.0;
  for (std::size_t i = 0; i < records.size(); ++i) {
    const log::Record& record = records[i];
    check_held(record);
    for (std::size_t k = 0; k < record.x.size(); ++k) {
      rows.x.push_back(record.x[k]);
      rows.e.push_back(record.f[k]);
      rows.direction.push_back(0);
      rows.record.push_back(static_cast<int>(i));
      rows.at.push_back(k);
      mean += record.f[k];
    }
  }
  r.rows = rows.x.size();
  mean /= std::max(1.0, static_cast<double>(r.rows));
  map::PeriodicOptions search;
  search.most = options.most_terms.value_or(kTermsHeld);
  search.turn = options.turn.value_or(r.position_unit == "rad" ? 2.0 * kPi : 0.0);
  const map::PeriodicResult found = map::find_periodic(rows, search);
  r.spectrum = found.spectrum;
  r.warnings = found.notes;
  r.cannot_tell = found.cannot_tell;
  if (found.terms.empty()) {
    r.cannot_tell.emplace_back("periodic terms: none is above the noise");
  }
  int number = 0;
  for (const map::PeriodicTerm& t : found.terms) {
    ++number;
    const std::string name = search.turn > 0.0 ? "harmonic_" + std::to_string(t.harmonic) + "_"
                                               : "eccentric_" + std::to_string(number) + "_";
    const auto half = [](const Interval& i) { return 0.5 * (i.high - i.low); };
    r.parameters.push_back(parameter(name + "amplitude", t.term.amplitude, "N", "N", half(t.amplitude)));
    r.parameters.push_back(parameter(name + "period", t.term.period, "m", "mm", half(t.period)));
    r.parameters.push_back(parameter(name + "phase", t.term.phase, "rad", "rad", half(t.phase)));
    r.parameters.back().identifiable = half(t.phase) < kPi;
    r.friction.eccentric.push_back(t.term);
  }
  if (found.terms.size() > friction::kMaxEccentricTerms) {
    r.warnings.push_back(text("%zu periodic terms found; an axis file holds the largest %zu",
                              found.terms.size(), friction::kMaxEccentricTerms));
  }
  if (!found.terms.empty()) r.warnings.emplace_back(kHoming);
  r.cannot_tell.emplace_back("mass, Coulomb and viscous friction: the axis is held at standstill");
  r.cannot_tell.push_back(text(
      "load: the mean force of %.4g may also be static friction that holds the axis; move in both directions",
      mean));
  const std::size_t step = std::max<std::size_t>(1, r.rows / kPlotted);
  std::size_t at = 0;
  for (std::size_t i = 0; i < records.size(); ++i) {
    const log::Record& record = records[i];
    for (std::size_t k = 0; k < record.x.size(); ++k, ++at) {
      if (at % step != 0) continue;
      double e = record.f[k] - mean;
      for (const map::PeriodicTerm& t : found.terms)
        e -= t.term.amplitude * std::sin(2.0 * kPi * record.x[k] / t.term.period - t.term.phase);
      r.residuals.push_back({record.t[k], record.x[k], 0.0, e, static_cast<int>(i)});
    }
  }
  return r;
}

}  // namespace

bool held_at_standstill(const std::vector<log::Record>& records) {
  // Rests all along the way, and steps between them that are longer than a count of the encoder. (A slow jog
  // on a coarse encoder rests too, but moves by single counts; a stop between motions rests at few places.)
  constexpr double kAtRest = 0.4;
  constexpr double kLongSteps = 0.3;
  constexpr int kPlaces = 64;
  std::size_t rest = 0;
  std::size_t moving = 0;
  std::size_t far = 0;
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  double count = low;
  for (const log::Record& r : records) {
    for (std::size_t k = 0; k < r.x.size(); ++k) {
      low = std::min(low, r.x[k]);
      high = std::max(high, r.x[k]);
      const double d = k > 0 ? std::abs(r.x[k] - r.x[k - 1]) : 0.0;
      if (d > 0.0) count = std::min(count, d);
    }
  }
  if (!(high > low)) return false;
  count = std::max(count, 1e-6 * (high - low));
  std::vector<bool> place(kPlaces, false);
  for (const log::Record& r : records) {
    for (std::size_t k = 1; k < r.x.size(); ++k) {
      const double d = std::abs(r.x[k] - r.x[k - 1]);
      if (d == 0.0) {
        ++rest;
        const int i = static_cast<int>((r.x[k] - low) / (high - low) * kPlaces);
        place[static_cast<std::size_t>(std::clamp(i, 0, kPlaces - 1))] = true;
      } else {
        ++moving;
        if (d > 1.5 * count) ++far;
      }
    }
  }
  const auto places = std::count(place.begin(), place.end(), true);
  return static_cast<double>(rest) > kAtRest * static_cast<double>(rest + moving) &&
         static_cast<double>(far) > kLongSteps * static_cast<double>(moving) && 4 * places >= 3 * kPlaces;
}

Result identify_position_map(const std::vector<log::Record>& records, const PositionMapOptions& options) {
  if (records.empty()) throw Refused("position map: no record given");
  if (options.holding.value_or(held_at_standstill(records))) return identify_held(records, options);
  return Identification(records, options).run();
}

}  // namespace stribeck::ident::methods
