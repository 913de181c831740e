#pragma once
/// The laws of bristle_fit.hpp on the pieces of bristle_path.hpp: residuals of all rows and their derivatives.
///
/// A case names the law, its own parameters in scales of one, and the mean force over a sub-step; the laws
/// themselves are those of friction/, on jets. Behind the own parameters stand the common ones: factors of the
/// levels less 1, mass less 1, load and viscous force as shares of the level, then the unknown starts.
///
/// Inside ident only: includes Eigen and Ceres.
/// Real time: no.

#include <ceres/jet.h>

#include <Eigen/Dense>
#include <array>
#include <stribeck/friction/gms.hpp>
#include <stribeck/friction/lugre.hpp>
#include <stribeck/ident/bristle/bristle_path.hpp>
#include <type_traits>
#include <vector>

namespace stribeck::ident::bristle {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Index = Eigen::Index;

inline constexpr int kMostElements = 6;

/// What the fits are scaled with.
struct Scales {
  double level = 1.0;       ///< at rest, mean of the directions [N]
  double break_away = 1.0;  ///< first idea [m]
  double damping = 1.0;     ///< [N·s/m]
  double fading = 1.0;      ///< v_d [m/s]
};

/// A law with its state along a path.
template <class AnyLaw, class T>
struct Bristle {
  AnyLaw law;
  typename AnyLaw::State state;

  void start(const T& share, double level) { law.carry(state, share * T(level)); }
  void settle(const T& level, double direction) { law.slide(state, level * T(direction)); }
  /// Mean force over a step.
  T advance(const PathStep& step, const T& level) {
    const auto before = state;
    const T v(step.v);
    law.advance(state, v, level, step.dt);
    return law.mean_bristle(before, state, v, step.dt);
  }
};

/// Own parameters of LuGre: ln(σ0·δ/g), σ1 and ln v_d in their scales.
struct LuGreCase {
  static constexpr int kMostOwn = 3;

  template <class T>
  using Law = Bristle<friction::LuGre<T>, T>;

  template <class T>
  static Law<T> make(const T* p, int, const Scales& s) {
    Law<T> out;
    out.law.sigma0 = T(s.level / s.break_away) * exp(p[0]);
    out.law.sigma1 = T(s.damping) * p[1];
    out.law.damping_velocity = T(s.fading) * exp(p[2]);
    return out;
  }
};

/// Own parameters of GMS with N elements: ln of the first break-away distance over δ, N − 1 logs of the
/// logs of the ratios of the next, N − 1 logits of shares, ln C, σ and ln v_d in their scales.
struct GmsCase {
  static constexpr int kMostOwn = 2 * kMostElements + 2;

  template <class T>
  using Law = Bristle<friction::Gms<T>, T>;

  template <class T>
  static Law<T> make(const T* p, int own, const Scales& s) {
    const int n = (own - 2) / 2;
    Law<T> out;
    T total(1.0);
    for (int i = 0; i + 1 < n; ++i) total = total + exp(p[n + i]);
    T distance = T(s.break_away) * exp(p[0]);
    for (int i = 0; i < n; ++i) {
      if (i > 0) distance = distance * exp(exp(p[i]));
      const T share = (i + 1 < n ? exp(p[n + i]) : T(1.0)) / total;
      out.law.elements.push_back({T(s.level) * share / distance, share});
    }
    out.law.attraction = T(s.level / 0.01) * exp(p[2 * n - 1]);
    out.law.damping_coefficient = T(s.damping) * p[2 * n];
    out.law.damping_velocity = T(s.fading) * exp(p[2 * n + 1]);
    return out;
  }
};

/// Friction is its level at once.
struct StaticCase {
  static constexpr int kMostOwn = 0;
  template <class T>
  struct Law {
    void start(const T&, double) {}
    void settle(const T&, double) {}
    T advance(const PathStep& step, const T& level) { return level * T(step.direction); }
  };
  template <class T>
  static Law<T> make(const T*, int, const Scales&) {
    return {};
  }
};

enum Common { kForward, kBackward, kMass, kLoad, kViscous, kCommon };

/// Everything but the law.
struct Setting {
  const BristlePath* path = nullptr;
  Scales scales;
  double mass = 0.0;
  double load = 0.0;
  double fastest = 1.0;  ///< [m/s] speed at which the viscous parameter is the force
};

template <class Case>
class Model {
 public:
  Model(const Setting& setting, int own) : setting_(&setting), own_(own) {}

  [[nodiscard]] int own() const { return own_; }
  [[nodiscard]] const BristlePath& path() const { return *setting_->path; }
  /// The force at all rows, through the window: an instrument for the mass, free of the noise of the motion.
  [[nodiscard]] VectorXd force() const {
    VectorXd out(static_cast<Index>(path().rows.size()));
    Index row = 0;
    for (const PathPiece& piece : path().pieces) {
      filtered_.resize(static_cast<Index>(piece.force.size()));
      filter_like(path(), true, piece.force.size(), piece.force.data(), filtered_.data(), work_);
      for (const std::size_t i : piece.rows) out(row++) = filtered_(static_cast<Index>(i));
    }
    return out;
  }
  [[nodiscard]] int parameters() const { return own_ + kCommon + setting_->path->starts; }

  /// Residuals [N] of all rows: modelled less measured force, and their derivatives.
  void evaluate(const VectorXd& p, VectorXd& e, MatrixXd* jacobian, bool white = true) const {
    const BristlePath& path = *setting_->path;
    e.resize(static_cast<Index>(path.rows.size()));
    if (jacobian != nullptr) jacobian->setZero(e.size(), parameters());
    Index row = 0;
    int start = 0;
    for (const PathPiece& piece : path.pieces) {
      const int my_start = piece.unknown_start ? own_ + kCommon + start++ : -1;
      if (jacobian != nullptr) {
        using Jet = ceres::Jet<double, Case::kMostOwn + 3>;
        this->template simulate<Jet>(piece, p, my_start);
      } else {
        this->template simulate<double>(piece, p, my_start);
      }
      const Index columns = jacobian != nullptr ? raw_.cols() : 1;
      const auto ticks = static_cast<std::size_t>(raw_.rows());
      filtered_.resize(raw_.rows());
      for (Index c = 0; c < columns; ++c) {
        const Index to = c == 0 ? 0 : column_of(c - 1, my_start);
        if (to < 0) continue;
        filter_like(path, white, ticks, raw_.col(c).data(), filtered_.data(), work_);
        double* out = c == 0 ? e.data() + row : jacobian->col(to).data() + row;
        for (std::size_t i = 0; i < piece.rows.size(); ++i)
          out[i] = filtered_(static_cast<Index>(piece.rows[i]));
      }
      row += static_cast<Index>(piece.rows.size());
    }
  }

 private:
  /// Columns of raw_: force, own parameters, the two levels, start, mass, load, viscous.
  [[nodiscard]] Index column_of(Index c, int my_start) const {
    if (c < own_ + 2) return c;
    if (c == own_ + 2) return my_start;
    return c - 1;
  }

  template <class T>
  static T variable(double value, int at) {
    if constexpr (std::is_same_v<T, double>) {
      return value;
    } else {
      return T(value, at);
    }
  }

  template <class T>
  void simulate(const PathPiece& piece, const VectorXd& p, int my_start) const {
    const Setting& s = *setting_;
    constexpr bool kJets = !std::is_same_v<T, double>;
    const auto ticks = static_cast<Index>(piece.force.size());
    raw_.setZero(ticks, kJets ? own_ + kCommon + 2 : 1);
    std::array<T, static_cast<std::size_t>(Case::kMostOwn) + 1> own;
    for (int i = 0; i < own_; ++i) own[static_cast<std::size_t>(i)] = variable<T>(p(i), i);
    auto law = Case::template make<T>(own.data(), own_, s.scales);
    const T forward = variable<T>(1.0 + p(own_ + kForward), own_);
    const T backward = variable<T>(1.0 + p(own_ + kBackward), own_ + 1);
    if (my_start >= 0) {
      law.start(variable<T>(p(my_start), own_ + 2), s.scales.level);
    }
    bool running = my_start >= 0;
    for (Index i = 0; i + 1 < ticks; ++i) {
      const PathSample& sample = piece.samples[static_cast<std::size_t>(i)];
      for (std::size_t j = sample.first; j < sample.first + sample.count; ++j) {
        const PathStep& step = s.path->steps[j];
        const T level = T(step.level) * (step.direction > 0.0 ? forward : backward);
        T force;
        if (sample.settled || !running) {
          law.settle(level, step.direction);
          running = true;
          force = level * T(step.direction);
        } else {
          force = law.advance(step, level);
        }
        if constexpr (kJets) {
          raw_(i, 0) += step.early * force.a;
          raw_(i + 1, 0) += step.late * force.a;
          for (int c = 0; c < own_ + 3; ++c) {
            raw_(i, 1 + c) += step.early * force.v[c];
            raw_(i + 1, 1 + c) += step.late * force.v[c];
          }
        } else {
          raw_(i, 0) += step.early * force;
          raw_(i + 1, 0) += step.late * force;
        }
      }
    }
    const double mass = s.mass * (1.0 + p(own_ + kMass));
    const double load = s.load + s.scales.level * p(own_ + kLoad);
    const double per_speed = s.scales.level / s.fastest;
    for (Index i = 0; i < ticks; ++i) {
      const auto k = static_cast<std::size_t>(i);
      raw_(i, 0) += mass * piece.acceleration[k] + load + piece.given[k] +
                    per_speed * p(own_ + kViscous) * piece.speed[k] - piece.force[k];
      if constexpr (kJets) {
        raw_(i, 1 + own_ + 3) = s.mass * piece.acceleration[k];
        raw_(i, 1 + own_ + 4) = s.scales.level;
        raw_(i, 1 + own_ + 5) = per_speed * piece.speed[k];
      }
    }
  }

  const Setting* setting_;
  int own_;
  mutable MatrixXd raw_;
  mutable VectorXd filtered_;
  mutable std::vector<double> work_;
};

}  // namespace stribeck::ident::bristle
