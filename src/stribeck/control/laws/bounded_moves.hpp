#pragma once
/// Accelerations, each held for a period and within bounds, that bring the error of a mass to zero over a horizon.
///
///   least of  Σ_{j<n} (q_e·e_j² + q_v·v_j² + u_j²) + value(e_n, v_n)      low_j ≤ u_j ≤ high_j
///
///   Model, weights and value: mass_regulator.hpp. Without bounds the solution is the regulator plus a part for the known drifts w_j
///   (free()). With bounds: accelerated projected gradient, y = u + β·(u − u_before), u⁺ = clip(y − ∇J(y)/L), with a limited number
///   of iterations. L is the largest eigenvalue of the Hessian, found at configuration; the smallest is ≥ 1, so
///   β = (√L − 1)/(√L + 1), and the error falls by a factor of 1 − 1/√L per iteration. Gradients take one sweep forwards and one back.
///
/// Source: Nesterov, Introductory Lectures on Convex Optimization, 2004, 2.2.4; Richter, Jones, Morari 2012,
/// doi:10.1109/TAC.2011.2176389.
/// Not modelled: bounds of e and v.
/// Real time: safe, 20 to 30 operations per move and iteration; the constructor configure only.

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <stribeck/control/laws/mass_regulator.hpp>

namespace stribeck::control {

template <std::size_t Most>
class BoundedMoves {
 public:
  using Row = std::array<double, Most>;

  /// Error at the beginning of the horizon.
  struct Begin {
    double e = 0.0;  ///< [m]
    double v = 0.0;  ///< [m/s]
  };
  /// Working memory.
  struct Work {
    std::array<double, Most + 1> e{};
    std::array<double, Most + 1> v{};
    Row y{};
    Row gradient{};
  };

  BoundedMoves() = default;
  /// Number of moves, 1 to Most.
  BoundedMoves(const MassRegulator& regulator, std::size_t moves) noexcept : lqr_(regulator), n_(moves) {
    // Power iteration, started from the smoothest moves; the margin covers its remaining error.
    Work w;
    w.y.fill(1.0);
    double largest = 1.0;
    for (int k = 0; k < kPowerIterations; ++k) {
      gradient(w, {}, [](std::size_t) { return 0.0; });
      double sum = 0.0;
      for (std::size_t j = 0; j < n_; ++j) sum += w.gradient[j] * w.gradient[j];
      double before = 0.0;
      for (std::size_t j = 0; j < n_; ++j) before += w.y[j] * w.y[j];
      largest = sqrt(sum / before);
      for (std::size_t j = 0; j < n_; ++j) w.y[j] = w.gradient[j] / largest;
    }
    largest *= 1.01;
    step_ = 1.0 / largest;
    const double root = sqrt(largest);
    momentum_ = (root - 1.0) / (root + 1.0);
  }

  /// The best moves without bounds.
  void free(Begin x, const Row& drift, Row& moves) const noexcept {
    const double t = lqr_.period;
    const double h = 0.5 * t * t;
    // (a, b) = P·w + demand of later drifts; each move answers its own part.
    double later_e = 0.0;
    double later_v = 0.0;
    for (std::size_t j = n_; j-- > 0;) {
      const double a = lqr_.pee * drift[j] + later_e;
      const double b = lqr_.pev * drift[j] + later_v;
      const double back = h * a + t * b;
      moves[j] = lqr_.share * back;
      later_e = a - lqr_.kp * back;
      later_v = t * a + b - lqr_.kv * back;
    }
    for (std::size_t j = 0; j < n_; ++j) {
      moves[j] = lqr_.law(x.e, x.v) - moves[j];
      x = next(x, moves[j], drift[j]);
    }
  }

  /// Improves moves that lie within the bounds, in at most `most` iterations; returns how many it took.
  int bounded(Begin x, const Row& drift, const Row& low, const Row& high, Row& moves, int most,
              Work& w) const noexcept {
    for (std::size_t j = 0; j < n_; ++j) w.y[j] = moves[j];
    for (int k = 1; k <= most; ++k) {
      gradient(w, x, [&](std::size_t j) { return drift[j]; });
      double change = 0.0;
      double size = 0.0;
      for (std::size_t j = 0; j < n_; ++j) {
        const double to = clamp_to(w.y[j] - step_ * w.gradient[j], low[j], high[j]);
        const double delta = to - moves[j];
        change = max_of(change, abs(delta));
        size = max_of(size, abs(to));
        w.y[j] = to + momentum_ * delta;
        moves[j] = to;
      }
      if (change <= kAccuracy * size) return k;
    }
    return most;
  }

  /// The function that is minimised [m²/s⁴].
  [[nodiscard]] double cost(Begin x, const Row& drift, const Row& moves) const noexcept {
    double sum = 0.0;
    for (std::size_t j = 0; j < n_; ++j) {
      sum += lqr_.qe * x.e * x.e + lqr_.qv * x.v * x.v + moves[j] * moves[j];
      x = next(x, moves[j], drift[j]);
    }
    return sum + lqr_.pee * x.e * x.e + 2.0 * lqr_.pev * x.e * x.v + lqr_.pvv * x.v * x.v;
  }

  [[nodiscard]] Begin next(Begin x, double u, double drift) const noexcept {
    const double t = lqr_.period;
    return {x.e + t * x.v + 0.5 * t * t * u + drift, x.v + t * u};
  }
  [[nodiscard]] std::size_t moves() const noexcept { return n_; }
  [[nodiscard]] const MassRegulator& regulator() const noexcept { return lqr_; }
  /// Largest eigenvalue of the Hessian.
  [[nodiscard]] double largest() const noexcept { return 1.0 / step_; }

 private:
  static constexpr int kPowerIterations = 60;
  /// Change of the moves that ends the iteration, as a share of the largest move.
  static constexpr double kAccuracy = 1e-7;

  /// Half the gradient at w.y.
  template <class Drift>
  void gradient(Work& w, Begin x, Drift drift) const noexcept {
    const double t = lqr_.period;
    const double h = 0.5 * t * t;
    for (std::size_t j = 0; j < n_; ++j) {
      w.e[j] = x.e;
      w.v[j] = x.v;
      x = next(x, w.y[j], drift(j));
    }
    double a = lqr_.pee * x.e + lqr_.pev * x.v;
    double b = lqr_.pev * x.e + lqr_.pvv * x.v;
    for (std::size_t j = n_; j-- > 0;) {
      w.gradient[j] = w.y[j] + h * a + t * b;
      b = lqr_.qv * w.v[j] + t * a + b;
      a = lqr_.qe * w.e[j] + a;
    }
  }

  MassRegulator lqr_;
  std::size_t n_ = 0;
  double step_ = 1.0;
  double momentum_ = 0.0;
};

}  // namespace stribeck::control
