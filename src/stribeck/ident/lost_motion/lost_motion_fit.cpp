#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stribeck/ident/lost_motion/lost_motion_parts.hpp>
#include <stribeck/ident/stats/least_squares.hpp>
#include <stribeck/ident/stats/linear.hpp>

namespace stribeck::ident::lost_motion {
namespace {

constexpr double kMicro = 1e-6;

/// Nonlinear parameters: backlash, offset [µm], log of ℓ/µm, delay [ms], log of the speed of the dip/(mm/s), slope [10 µm/m].
constexpr int kBacklash = 0, kOffset = 1, kDistance = 2, kDelay = 3, kDip = 4, kSlope = 5, kMost = 6;
/// Linear ones: load, mass, friction of the motor, its dip at rest, damping and stiffness in contact.
constexpr int kLoad = 0, kMass = 1, kFriction = 2, kDipForce = 3, kDamping = 4, kStiffness = 5, kLinear = 6;

/// What is believed before: ℓ of about 3 µm, no delay within 2 ms, a dip within 0.1 mm/s, a slope of some 100 µm/m. It counts as
/// much as 25 rows, since neighbouring rows carry nearly the same noise.
constexpr double kUsualDistance = 1.2, kDistanceSpread = 1.0, kDelaySpread = 2.0, kUsualDip = -2.3,
                 kDipSpread = 0.7, kSlopeSpread = 10.0, kBelieved = 5.0;

/// Columns of one stretch before the low-pass.
struct Raw {
  Eigen::VectorXd friction, dip, stretch, damped, turning;
};

/// Residuals of the motor's side, with the linear parameters solved inside.
class MotorSide final : public stats::Residuals {
 public:
  MotorSide(const std::vector<const Stretch*>& stretches, const Sliding& sliding, bool slope)
      : stretches_(stretches), sliding_(sliding), slope_(slope) {
    for (const Stretch* s : stretches_) rows_ += s->force.size();
    force_.resize(rows_);
    plain_.setOnes(rows_, kLinear);
    Eigen::Index at = 0;
    for (const Stretch* s : stretches_) {
      force_.segment(at, s->force.size()) = s->force;
      plain_.block(at, kMass, s->force.size(), 1) = s->acceleration;
      at += s->force.size();
    }
    level_ = std::sqrt(force_.squaredNorm() / static_cast<double>(rows_));
  }

  /// Weights by the noise of the force [N] and, at an earlier fit, by what the steps of the encoders do.
  void weigh(double noise, const Fit* earlier, const double* p) {
    weights_.setConstant(rows_, 1.0 / noise);
    if (earlier != nullptr) {
      Eigen::Index at = 0;
      for (const Stretch* s : stretches_) at = weigh_one(*s, noise, *earlier, p, at);
    }
    X_ = weights_.asDiagonal() * plain_;
    target_ = weights_.cwiseProduct(force_);
  }

  [[nodiscard]] int count() const override { return static_cast<int>(rows_) + parameters(); }
  [[nodiscard]] int parameters() const override { return slope_ ? kMost : kMost - 1; }
  bool evaluate(const double* p, double* residuals, double* jacobian) const override {
    Eigen::Map<Eigen::VectorXd> r(residuals, count());
    left(p, r);
    if (jacobian == nullptr) return true;
    Eigen::Map<Eigen::MatrixXd> J(jacobian, count(), parameters());
    std::array<double, kMost> q{};
    std::copy_n(p, parameters(), q.begin());
    Eigen::VectorXd other(count());
    for (int i = 0; i < parameters(); ++i) {
      constexpr double kStep = 1e-3;
      q[static_cast<std::size_t>(i)] = p[i] + kStep;
      left(q.data(), other);
      J.col(i) = (other - r) / kStep;
      q[static_cast<std::size_t>(i)] = p[i];
    }
    return true;
  }

  /// The linear parameters at p; stiffness per µm.
  [[nodiscard]] Eigen::VectorXd linear(const double* p) const {
    fill(p);
    return solve();
  }
  /// Noise of the force [N], from what is left at p.
  [[nodiscard]] double noise(const double* p) const {
    fill(p);
    return (target_ - X_ * solve()).norm() / weights_.norm();
  }

 private:
  [[nodiscard]] Eigen::VectorXd solve() const {
    Eigen::MatrixXd A = X_.transpose() * X_;
    // The dip is at most about half of friction.
    const double believed = kBelieved / (0.5 * level_);
    A(kDipForce, kDipForce) += believed * believed;
    A.diagonal().array() += 1e-12;
    return stats::solve_ldlt(A, X_.transpose() * target_);
  }
  void left(const double* p, Eigen::Ref<Eigen::VectorXd> r) const {
    fill(p);
    r.head(rows_) = target_ - X_ * solve();
    auto prior = r.tail(parameters());
    prior.setZero();
    prior(kDelay) = kBelieved * p[kDelay] / kDelaySpread;
    prior(kDistance) = kBelieved * (p[kDistance] - kUsualDistance) / kDistanceSpread;
    prior(kDip) = kBelieved * (p[kDip] - kUsualDip) / kDipSpread;
    if (slope_) prior(kSlope) = kBelieved * p[kSlope] / kSlopeSpread;
  }

  [[nodiscard]] Raw raw_of(const Stretch& s, const double* p) const {
    const auto n = s.difference.size();
    Raw raw;
    for (auto* column : {&raw.friction, &raw.dip, &raw.stretch, &raw.damped, &raw.turning}) column->resize(n);
    const double per_distance = 1.0 / (kMicro * std::exp(p[kDistance]));
    const double per_speed = 1.0 / (1e-3 * std::exp(p[kDip]));
    double h = -s.direction;
    for (Eigen::Index k = 0; k < n; ++k) {
      double to = h;
      if (k > 0) {
        const double dx = s.motor(k) - s.motor(k - 1);
        to = dx > 0.0 ? 1.0 : -1.0;
        h = to + (h - to) * std::exp(-std::abs(dx) * per_distance);
      }
      const double v = s.velocity(k);
      const double speed = std::abs(v);
      raw.turning(k) = std::abs(h - to);
      raw.friction(k) =
          h * (1.0 - sliding_.fallen * (1.0 - std::exp(-speed / sliding_.stribeck))) + sliding_.viscous * v;
      raw.dip(k) = h * std::exp(-speed * per_speed);
      const double slope = slope_ ? 10.0 * p[kSlope] * s.position(k) : 0.0;
      const double half = 0.5 * std::max(0.0, p[kBacklash] + slope);
      const double d = (s.difference(k) - sliding_.offset - sliding_.scale_error * s.position(k) -
                        1e-3 * p[kDelay] * s.speed(k)) /
                           kMicro -
                       p[kOffset];
      raw.stretch(k) = d > half ? d - half : d < -half ? d + half : 0.0;
      raw.damped(k) = raw.stretch(k) != 0.0 ? 1e3 * (v - s.speed(k)) : 0.0;
    }
    return raw;
  }

  void fill(const double* p) const {
    Eigen::Index at = 0;
    for (const Stretch* s : stretches_) {
      const Raw raw = raw_of(*s, p);
      const Smoothing smooth = smoothing_for(s->sample_time);
      const auto n = static_cast<Eigen::Index>(smooth.weights.size());
      const Eigen::Map<const Eigen::VectorXd> w(smooth.weights.data(), n);
      for (Eigen::Index k = 0; k < s->force.size(); ++k) {
        const double weight = weights_(at + k);
        X_(at + k, kFriction) = weight * w.dot(raw.friction.segment(k, n));
        X_(at + k, kDipForce) = weight * w.dot(raw.dip.segment(k, n));
        X_(at + k, kDamping) = weight * w.dot(raw.damped.segment(k, n));
        X_(at + k, kStiffness) = weight * w.dot(raw.stretch.segment(k, n));
      }
      at += s->force.size();
    }
  }

  Eigen::Index weigh_one(const Stretch& s, double noise, const Fit& earlier, const double* p,
                         Eigen::Index at) {
    const Raw raw = raw_of(s, p);
    const Smoothing smooth = smoothing_for(s.sample_time);
    const double stiffness = kMicro * earlier.stiffness;
    const double turning = earlier.motor_friction / std::exp(p[kDistance]);
    for (Eigen::Index k = 0; k < s.force.size(); ++k) {
      double in_contact = 0.0;
      double in_turn = 0.0;
      for (std::size_t i = 0; i < smooth.weights.size(); ++i) {
        const auto row = k + static_cast<Eigen::Index>(i);
        if (raw.stretch(row) != 0.0) in_contact += smooth.weights[i];
        in_turn += smooth.weights[i] * raw.turning(row);
      }
      const double a = stiffness * in_contact;
      const double b = turning * in_turn;
      weights_(at + k) = 1.0 / std::sqrt(noise * noise + a * a * sliding_.rounding_difference +
                                         b * b * sliding_.rounding_motor);
    }
    return at + s.force.size();
  }

  std::vector<const Stretch*> stretches_;
  Sliding sliding_;
  bool slope_;
  Eigen::Index rows_ = 0;
  double level_ = 1.0;  ///< of the force [N]
  Eigen::VectorXd force_;
  Eigen::VectorXd weights_;
  Eigen::VectorXd target_;     ///< force, weighted
  Eigen::MatrixXd plain_;      ///< columns that no nonlinear parameter changes
  mutable Eigen::MatrixXd X_;  ///< weighted, at the last parameters
};

Eigen::VectorXd start_of(const Fit& f, bool slope) {
  Eigen::VectorXd p(slope ? kMost : kMost - 1);
  p(kBacklash) = f.backlash / kMicro;
  p(kOffset) = f.offset / kMicro;
  p(kDistance) = std::log(f.distance / kMicro);
  p(kDelay) = f.delay * 1e3;
  p(kDip) = std::log(f.dip * 1e3);
  if (slope) p(kSlope) = f.backlash_slope * 1e5;
  return p;
}

Fit solved(const MotorSide& side, const Fit& start, bool slope) {
  Eigen::VectorXd p = start_of(start, slope);
  const stats::Descent end = stats::minimise_squares(side, p);
  if (!std::isfinite(end.cost)) return {};
  const Eigen::VectorXd l = side.linear(p.data());
  return {true,
          p(kBacklash) * kMicro,
          slope ? p(kSlope) * 1e-5 : 0.0,
          p(kOffset) * kMicro,
          std::exp(p(kDistance)) * kMicro,
          p(kDelay) * 1e-3,
          std::exp(p(kDip)) * 1e-3,
          l(kStiffness) / kMicro,
          l(kFriction),
          l(kMass),
          side.noise(p.data())};
}

}  // namespace

std::vector<Fit> starts_for(const Sliding& sliding) {
  std::vector<Fit> starts;
  for (const double share : {0.05, 0.4, 0.75}) {
    for (const double distance : {2e-6, 6e-6}) {
      Fit s;
      s.backlash = 2.0 * share * sliding.half;
      s.distance = distance;
      starts.push_back(s);
    }
  }
  return starts;
}

Fit fit(const std::vector<Stretch>& stretches, const Sliding& sliding, bool slope, const Fit& start) {
  std::vector<const Stretch*> used;
  for (const Stretch& s : stretches) used.push_back(&s);
  if (used.size() < 2) return {};
  constexpr double kUsualNoise = 0.02;  // of the largest force
  MotorSide side(used, sliding, slope);
  side.weigh(std::max(kUsualNoise * used.front()->force.cwiseAbs().maxCoeff(), 1e-6), nullptr, nullptr);
  return solved(side, start, slope);
}

Fit fit(const std::vector<Stretch>& stretches, const Sliding& sliding, bool slope, const Fit* earlier,
        const Part& part) {
  std::vector<const Stretch*> used;
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    if (part.has(i / 2)) used.push_back(&stretches[i]);
  }
  if (used.size() < 2) return {};
  MotorSide side(used, sliding, slope);
  side.weigh(std::max(earlier->noise, 1e-6), earlier, start_of(*earlier, slope).data());
  return solved(side, *earlier, slope);
}

}  // namespace stribeck::ident::lost_motion
