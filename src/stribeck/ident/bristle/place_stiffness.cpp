#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <stribeck/ident/bristle/bristle_parts.hpp>
#include <stribeck/ident/bristle/place_stiffness.hpp>
#include <stribeck/ident/stats/linear.hpp>

namespace stribeck::ident::bristle {
namespace {

constexpr std::size_t kMostPathRows = 8'000;
constexpr double kExpectedShare = 0.4;  // prior standard deviation of ln ρ
constexpr double kSmoothShare =
    0.15;  // prior standard deviation of the second difference between neighbouring places
constexpr double kBeside = 0.05;     // of the levels, the load and the viscous part, as shares of the level
constexpr double kLeastShare = 0.1;  // that is stored
constexpr double kPredictsBetter = 0.95;
constexpr int kRounds = 6;
constexpr double kNudge = 1e-3;
constexpr Index kNuisance = 4;  // two levels, load, viscous

/// Residuals of the reversals for stiffness at places; parameters: ln ρ of each place, then the nuisances.
class PlacedModel {
 public:
  PlacedModel(const friction::AxisModel& known, BristlePath path) : known_(known), path_(std::move(path)) {
    level_ = 0.5 * (known.friction.parts(1e-9, 0.0).level + known.friction.parts(-1e-9, 0.0).level);
    for (const PathStep& s : path_.steps) fastest_ = std::max(fastest_, std::abs(s.v));
    for (std::size_t i = 0; i < path_.pieces.size(); ++i) {
      for (std::size_t j = 0; j < path_.pieces[i].rows.size(); ++j)
        fold_.push_back(static_cast<char>(i / 2 % 2));
    }
  }

  [[nodiscard]] Index places() const { return static_cast<Index>(known_.friction.places.size()); }
  [[nodiscard]] Index parameters() const { return places() + kNuisance; }
  [[nodiscard]] const std::vector<char>& fold() const { return fold_; }

  void whiten(const VectorXd& p) {
    path_.whitening.clear();
    const VectorXd e = residual(p);
    path_.whitening = whitening_of(path_, e.data());
  }
  /// Variance of a row that counts as independent [N²].
  [[nodiscard]] double variance(const VectorXd& e) const {
    return std::max(e.squaredNorm() / static_cast<double>(e.size()) * 2.0 * memory_of_rows(path_, e).rows,
                    1e-18 * level_ * level_);
  }

 private:
  template <class Law>
  [[nodiscard]] VectorXd along(const Law& law, const VectorXd& p) const {
    VectorXd e(static_cast<Index>(path_.rows.size()));
    friction::Places shares = known_.friction.places;
    for (Index k = 0; k < places(); ++k) shares[static_cast<std::size_t>(k)].stiffness = std::exp(p(k));
    std::vector<double> raw, filtered, work;
    Index row = 0;
    for (const PathPiece& piece : path_.pieces) {
      raw.assign(piece.force.size(), 0.0);
      filtered.resize(raw.size());
      simulate(law, piece, shares, p, raw);
      filter_like(path_, true, raw.size(), raw.data(), filtered.data(), work);
      for (const std::size_t i : piece.rows) e(row++) = filtered[i];
    }
    return e;
  }

  template <class Law>
  void simulate(const Law& law, const PathPiece& piece, const friction::Places& shares, const VectorXd& p,
                std::vector<double>& raw) const {
    typename Law::State state{};
    bool running = false;
    for (std::size_t i = 0; i + 1 < raw.size(); ++i) {
      const PathSample& sample = piece.samples[i];
      for (std::size_t j = sample.first; j < sample.first + sample.count; ++j) {
        const PathStep& step = path_.steps[j];
        const double level = step.level * (1.0 + p(places() + (step.direction > 0.0 ? 0 : 1)));
        double force = level * step.direction;
        if (sample.settled || !running) {
          law.slide(state, force);
          running = true;
        } else {
          const auto before = state;
          law.advance(state, friction::shares_at(shares, step.x).stiffness * step.v, level, step.dt);
          force = law.mean_bristle(before, state, step.v, step.dt);
        }
        raw[i] += step.early * force;
        raw[i + 1] += step.late * force;
      }
    }
    const double load = known_.load + level_ * p(places() + 2);
    const double viscous = level_ / fastest_ * p(places() + 3);
    for (std::size_t i = 0; i < raw.size(); ++i)
      raw[i] += known_.mass * piece.acceleration[i] + load + piece.given[i] + viscous * piece.speed[i] -
                piece.force[i];
  }

  /// A function object: clang 14 does not instantiate what only a generic lambda calls.
  struct Along {
    const PlacedModel* model;
    const VectorXd* p;
    template <class Law>
    VectorXd operator()(const Law& law) const {
      if constexpr (friction::PreSlidingLaw<Law>) {
        return model->along(law, *p);
      } else {
        return VectorXd::Zero(static_cast<Index>(model->path_.rows.size()));
      }
    }
  };

 public:
  [[nodiscard]] VectorXd residual(const VectorXd& p) const {
    const friction::DynamicsVariant& law = known_.friction.dynamics;
    return std::visit(Along{this, &p}, law);
  }

 private:
  const friction::AxisModel& known_;
  BristlePath path_;
  double level_ = 0.0;
  double fastest_ = 1e-12;
  std::vector<char> fold_;  ///< of each row
};

/// What is known before of ln ρ and the nuisances, as an information matrix.
MatrixXd before_seen(Index places) {
  MatrixXd info = MatrixXd::Zero(places + kNuisance, places + kNuisance);
  for (Index i = 0; i < places; ++i) info(i, i) += 1.0 / (kExpectedShare * kExpectedShare);
  for (Index i = 1; i + 1 < places; ++i) {
    VectorXd bend = VectorXd::Zero(places + kNuisance);
    bend(i - 1) = bend(i + 1) = 1.0, bend(i) = -2.0;
    info += bend * bend.transpose() / (kSmoothShare * kSmoothShare);
  }
  for (Index i = places; i < places + kNuisance; ++i) info(i, i) += 1.0 / (kBeside * kBeside);
  return info;
}

struct Solved {
  VectorXd p;
  MatrixXd information;
};

/// Gauss–Newton over the rows of one fold; 2: over all. Without `places` only the nuisances are free.
Solved solve_places(const PlacedModel& model, int fold, bool places, double variance) {
  const Index n = model.parameters();
  const MatrixXd known = before_seen(model.places());
  Solved out{VectorXd::Zero(n), known};
  const Index first = places ? 0 : model.places();
  for (int round = 0; round < kRounds; ++round) {
    const VectorXd e = model.residual(out.p);
    MatrixXd slope(e.size(), n);
    slope.setZero();
    for (Index j = first; j < n; ++j) {
      VectorXd moved = out.p;
      moved(j) += kNudge;
      slope.col(j) = (model.residual(moved) - e) / kNudge;
    }
    VectorXd weight(e.size());
    for (Index i = 0; i < e.size(); ++i)
      weight(i) = fold == 2 || model.fold()[static_cast<std::size_t>(i)] == fold ? 1.0 / variance : 0.0;
    const MatrixXd weighted = weight.asDiagonal() * slope;
    out.information = slope.transpose() * weighted + known;
    VectorXd step = stats::solve_ldlt(out.information, -(weighted.transpose() * e) - known * out.p);
    if (!step.allFinite()) break;
    for (Index j = 0; j < first; ++j) step(j) = 0.0;
    step = step.cwiseMax(-0.5).cwiseMin(0.5);
    out.p += step;
    if (step.cwiseAbs().maxCoeff() < 1e-4) break;
  }
  return out;
}

double left_out(const PlacedModel& model, const VectorXd& p, int fold) {
  const VectorXd e = model.residual(p);
  double sum = 0.0;
  for (Index i = 0; i < e.size(); ++i) {
    if (model.fold()[static_cast<std::size_t>(i)] != fold) sum += e(i) * e(i);
  }
  return sum;
}

/// The pieces whose start is known; about as many rows as a fit can use.
BristlePath reversals_of(const std::vector<log::Record>& records, const friction::AxisModel& known,
                         double break_away, double shift) {
  BristleData data;
  data.level = {known.friction.parts(1e-9, 0.0).level, known.friction.parts(-1e-9, 0.0).level};
  for (const log::Record& record : records) {
    log::MotionOptions as_logged;
    as_logged.shift = shift;
    data.motion.push_back(log::reconstruct(record, as_logged));
    data.noise = std::max(data.noise, data.motion.back().position_noise);
  }
  return part_of(cut_path(records, data, known, {break_away, shift, false}), kMostPathRows);
}

}  // namespace

PlaceStiffness fit_place_stiffness(const std::vector<log::Record>& records, const friction::AxisModel& known,
                                   double break_away, double shift) {
  PlaceStiffness out;
  PlacedModel model(known, reversals_of(records, known, break_away, shift));
  if (model.fold().empty() || model.places() < 2) return out;
  const VectorXd even = VectorXd::Zero(model.parameters());
  model.whiten(even);
  const double variance = model.variance(model.residual(even));
  double without = 0.0, with = 0.0;
  for (const int fold : {0, 1}) {
    without += left_out(model, solve_places(model, fold, false, variance).p, fold);
    with += left_out(model, solve_places(model, fold, true, variance).p, fold);
  }
  if (!(with < kPredictsBetter * without)) return out;
  const Solved first = solve_places(model, 2, true, variance);
  const Solved all = solve_places(model, 2, true, model.variance(model.residual(first.p)));
  const MatrixXd spread = stats::inverse(all.information);
  for (Index k = 0; k < model.places(); ++k) {
    out.share.push_back(std::clamp(std::exp(all.p(k)), kLeastShare, 1.0 / kLeastShare));
    out.half.push_back(1.96 * std::sqrt(spread(k, k)));
  }
  return out;
}

}  // namespace stribeck::ident::bristle
