#pragma once
/// A drive as a loop with a period sees it: force held over a period, late by a delay, rigid or with its first axial mode; exact.
///
///   x(k+1) = A x(k) + b_new u(k−w) + b_old u(k−w−1)        w whole periods of the delay; the encoder sees the drive side
///
/// Inside sim/study only. Not modelled: friction.
/// Real time: no.

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <optional>
#include <stribeck/core/vec.hpp>
#include <stribeck/plant/params.hpp>
#include <vector>

namespace stribeck::sim {

using Complex = std::complex<double>;

/// States of a drive: position, velocity, and those of the table where there is a mode.
inline constexpr std::size_t kMostStates = 4;
using Matrix = Mat<double, kMostStates + 1>;

/// exp(a·t) from its series on a step that is short enough, then squared. Written by hand, as the elimination below: Eigen's exp()
/// alone takes 4 s to compile.
inline Matrix exponential(const Matrix& a, double t) {
  double size = 0.0;
  for (const auto& row : a.row) {
    for (const double x : row.c) size = std::max(size, std::abs(x * t));
  }
  int halvings = 0;
  while (std::ldexp(size, -halvings) > 0.1) ++halvings;
  const double h = std::ldexp(t, -halvings);
  Matrix sum;
  Matrix term;
  for (std::size_t i = 0; i <= kMostStates; ++i) sum[i][i] = term[i][i] = 1.0;
  for (int n = 1; n <= 12; ++n) {
    term = term * a;
    for (auto& row : term.row) row = (h / n) * row;
    for (std::size_t i = 0; i <= kMostStates; ++i) sum[i] = sum[i] + term[i];
  }
  for (int i = 0; i < halvings; ++i) sum = sum * sum;
  return sum;
}

class HeldDrive {
 public:
  HeldDrive(double mass, double period, double delay, const std::optional<plant::AxialMode>& mode)
      : period_(period) {
    Matrix a;
    a[0][1] = 1.0;
    double driven = mass;
    if (mode) {
      states_ = 4;
      const double table = mode->table_share * mass;
      driven = mass - table;
      const double omega = 2.0 * kPi * mode->frequency;
      const double spring = table * omega * omega;
      const double damper = 2.0 * mode->damping_ratio * omega * table;
      a[1] = {{-spring / driven, -damper / driven, spring / driven, damper / driven, 0.0}};
      a[2][3] = 1.0;
      a[3] = {{spring / table, damper / table, -spring / table, -damper / table, 0.0}};
    }
    a[1][kMostStates] = 1.0 / driven;
    const double periods = delay / period;
    whole_ = static_cast<std::size_t>(periods);
    const double rest = periods - static_cast<double>(whole_);
    const Matrix all = exponential(a, period);
    const Matrix late = exponential(a, (1.0 - rest) * period);
    for (std::size_t i = 0; i < kMostStates; ++i) {
      for (std::size_t j = 0; j < kMostStates; ++j) a_[i][j] = all[i][j];
      new_[i] = late[i][kMostStates];
      old_[i] = all[i][kMostStates] - late[i][kMostStates];
    }
    past_.assign(whole_ + 2, 0.0);
  }

  /// Position for a unit force [m/N].
  [[nodiscard]] Complex at(double omega) const {
    const Complex z = std::polar(1.0, omega * period_);
    std::array<std::array<Complex, kMostStates + 1>, kMostStates> m{};
    for (std::size_t i = 0; i < states_; ++i) {
      for (std::size_t j = 0; j < states_; ++j) m[i][j] = (i == j ? z : 0.0) - a_[i][j];
      m[i][states_] = new_[i] + old_[i] / z;
    }
    // Gauss elimination with pivots, down to the first unknown, which is eliminated last.
    for (std::size_t c = states_; c-- > 0;) {
      std::size_t best = c;
      for (std::size_t r = 0; r < c; ++r) {
        if (std::abs(m[r][c]) > std::abs(m[best][c])) best = r;
      }
      std::swap(m[c], m[best]);
      for (std::size_t r = 0; r < c; ++r) {
        const Complex f = m[r][c] / m[c][c];
        for (std::size_t k = 0; k <= states_; ++k) m[r][k] -= f * m[c][k];
      }
    }
    return m[0][states_] / m[0][0] * std::polar(1.0, -omega * period_ * static_cast<double>(whole_));
  }

  void start(double position) {
    x_ = {};
    x_[0] = position;
    if (states_ > 2) x_[2] = position;
    std::fill(past_.begin(), past_.end(), 0.0);
  }
  void step(double force) {
    std::rotate(past_.begin(), past_.end() - 1, past_.end());
    past_[0] = force;
    std::array<double, kMostStates> next{};
    for (std::size_t i = 0; i < states_; ++i) {
      next[i] = new_[i] * past_[whole_] + old_[i] * past_[whole_ + 1];
      for (std::size_t j = 0; j < states_; ++j) next[i] += a_[i][j] * x_[j];
    }
    x_ = next;
  }
  [[nodiscard]] double position() const { return x_[0]; }

 private:
  double period_;
  std::size_t states_ = 2;
  std::size_t whole_ = 0;
  std::array<std::array<double, kMostStates>, kMostStates> a_{};
  std::array<double, kMostStates> new_{};
  std::array<double, kMostStates> old_{};
  std::array<double, kMostStates> x_{};
  std::vector<double> past_;
};

}  // namespace stribeck::sim
