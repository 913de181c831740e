#pragma once
/// The laws of bristle_fit.hpp on the pieces of bristle_path.hpp: residuals of all rows and their derivatives.
///
/// A case names the law, its own parameters scaled to about one, and the mean force over a sub-step. The laws themselves
/// are those of friction/, evaluated on jets. The own parameters are followed by the common ones: factor of each level less 1,
/// mass less 1, load and viscous force as shares of the level, the unseen rise, then the unknown starts.
///
/// Inside ident only: includes Eigen.
/// Real time: no.

#include <Eigen/Core>
#include <memory>
#include <stribeck/friction/axis_model.hpp>
#include <stribeck/friction/gms.hpp>
#include <stribeck/friction/lugre.hpp>
#include <stribeck/ident/bristle/bristle_path.hpp>
#include <vector>

namespace stribeck::ident::bristle {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Index = Eigen::Index;

inline constexpr int kMostElements = 6;

/// Scales of the parameters.
struct Scales {
  double level = 1.0;       ///< at rest, mean of the directions [N]
  double break_away = 1.0;  ///< first estimate [m]
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
  /// Mean force over a sub-step.
  T advance(const PathStep& step, const T& level) {
    const auto before = state;
    const T v(step.v);
    law.advance(state, v, level, step.dt);
    return law.mean_bristle(before, state, v, step.dt);
  }
};

/// Value without its derivatives.
inline double value_of(double value) { return value; }
template <class Jet>
double value_of(const Jet& jet) {
  return jet.a;
}

/// LuGre along a path. The step is that of friction/lugre.hpp for a velocity without derivatives, which takes a third of the products.
template <class T>
struct LuGreBristle : Bristle<friction::LuGre<T>, T> {
  T advance(const PathStep& step, const T& level) {
    using std::exp;
    const friction::LuGre<T>& lugre = this->law;
    const T before = this->state.z;
    const T y = lugre.sigma0 * (std::abs(step.v) * step.dt) / level;
    const T decay = exp(-y);
    const T gain = value_of(y) < 1e-3 ? friction::hold_gain(y) : (1.0 - decay) / y;
    this->state.z = decay * before + gain * (step.v * step.dt);
    const T force = lugre.sigma0 * (before + this->state.z) * 0.5;
    const double fading = lugre.damping_velocity ? step.v / value_of(*lugre.damping_velocity) : 0.0;
    if (fading * fading > 40.0) return force;
    return force + lugre.damping(T(step.v)) * (this->state.z - before) * (1.0 / step.dt);
  }
};

/// The law's own parameters: ln(σ0·δ/g), σ1 and ln v_d, each in its scale.
struct LuGreCase {
  static constexpr int kMostOwn = 3;

  template <class T>
  using Law = LuGreBristle<T>;

  template <class T>
  static Law<T> make(const T* p, int, const Scales& s) {
    Law<T> out;
    out.law.sigma0 = T(s.level / s.break_away) * exp(p[0]);
    out.law.sigma1 = T(s.damping) * p[1];
    out.law.damping_velocity = T(s.fading) * exp(p[2]);
    return out;
  }
};

/// The law's own parameters for N elements: ln of the first break-away distance over δ, N − 1 logs of the
/// logs of the ratios of the next ones, N − 1 logits of shares, ln C, σ and ln v_d, each in its scale.
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

/// The same for fewer parameters: derivatives of shorter jets.
template <int kOwn>
struct GmsOfAtMost : GmsCase {
  static constexpr int kMostOwn = kOwn;
};

/// Static friction: its force is the level at once.
struct StaticCase {
  static constexpr int kMostOwn = 0;
  template <class T>
  struct Law {
    struct State {};
    State state{};
    void start(const T&, double) {}
    void settle(const T&, double) {}
    T advance(const PathStep& step, const T& level) { return level * T(step.direction); }
  };
  template <class T>
  static Law<T> make(const T*, int, const Scales&) {
    return {};
  }
};

/// kRise, the logarithm of a share of the level at rest, and kWidth, a logarithm too, are a rise towards rest that the steady map has not seen:
/// level + rise·exp(−(v/w)²).
enum Common { kForward, kBackward, kMass, kLoad, kViscous, kRise, kWidth, kCommon };

/// Everything that does not depend on the law.
struct Setting {
  const BristlePath* path = nullptr;
  Scales scales;
  double mass = 0.0;
  double load = 0.0;
  double unseen =
      0.0;  ///< speed below which the steady map was not measured, w = unseen·exp(kWidth) [m/s]; 0: seen to rest
  double fastest = 1.0;  ///< speed at which the viscous parameter equals the force [m/s]
};

/// Residuals of one law over all rows. A law is chosen by one of the functions below.
class Model {
 public:
  virtual ~Model() = default;
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;

  [[nodiscard]] int own() const { return own_; }
  [[nodiscard]] const BristlePath& path() const { return *setting_->path; }
  [[nodiscard]] int parameters() const { return own_ + kCommon + setting_->path->starts; }
  /// The modelled force at all rows, through the window. It is an instrument for the mass, free of the noise of the motion.
  [[nodiscard]] VectorXd force() const;
  /// Residuals [N] of all rows: modelled less measured force, and their derivatives.
  virtual void evaluate(const VectorXd& p, VectorXd& e, MatrixXd* jacobian, bool white = true) const = 0;
  /// Lays the motion between the ticks of `path` anew, which is path(): that of the mass on its bristles with the parameters p, under the
  /// held force. Each sample begins with the velocity that leads to the next measured position. A sample for which none is found
  /// keeps its motion.
  virtual void follow(const VectorXd& p, const friction::AxisModel& known, BristlePath& path) const = 0;

 protected:
  Model(const Setting& setting, int own) : setting_(&setting), own_(own) {}

  const Setting* setting_;
  int own_;
};

/// The setting must live as long as the model. `own` is the number of GMS's own parameters: 2·N + 2 for N elements.
std::unique_ptr<Model> static_model(const Setting& setting);
std::unique_ptr<Model> lugre_model(const Setting& setting);
std::unique_ptr<Model> gms_model(const Setting& setting, int own);

}  // namespace stribeck::ident::bristle
