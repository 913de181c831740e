#pragma once
/// Two masses with a spring and a damper between them, integrated in small steps, in a sampled loop: the reference of the tests of
/// this folder. Nothing here knows a transfer function.

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <stribeck/ident/excitation/excitation.hpp>
#include <stribeck/ident/log/record.hpp>
#include <vector>

namespace stribeck::ident::frequency {

struct TwoMass {
  double drive = 600.0;      ///< [kg]
  double table = 400.0;      ///< [kg]; 0: rigid
  double stiffness = 3.0e7;  ///< [N/m]
  double damping = 4.0e3;    ///< [N·s/m]
  double friction = 30.0;    ///< Coulomb, on the drive side [N]
  double late = 0.0;         ///< delay of the force [periods], below 1
  double lag = 0.0;          ///< of first order, of the force [s]; 0: none
  double noise = 0.0;        ///< RMS of a force that changes every period [N]
  double encoder = 1e-8;     ///< step [m]
  double period = 1e-3;      ///< [s]
  double omega = 40.0;       ///< of the loop [rad/s]
  double fed = 1.0;          ///< share of the acceleration that is fed forward
  double holds = 0.0;  ///< holds the axis up to this force; above 0: a stuck axis on a spring of 1e9 N/m

  [[nodiscard]] double mass() const { return drive + table; }
  [[nodiscard]] double antiresonance() const { return std::sqrt(stiffness / table); }
  [[nodiscard]] double resonance() const { return std::sqrt(stiffness * (1.0 / table + 1.0 / drive)); }
};

/// The log of a reference under PD with the acceleration fed forward.
inline log::Record recorded(const TwoMass& p, const std::vector<double>& r, std::uint64_t seed) {
  constexpr int kParts = 8;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::array<double, 4> s{r.front(), 0.0, r.front(), 0.0};
  const auto rate = [&](const std::array<double, 4>& y, double force) {
    const double spring = p.table > 0.0 ? p.stiffness * (y[2] - y[0]) + p.damping * (y[3] - y[1]) : 0.0;
    const double stuck = p.holds > 0.0 ? 1e9 * (y[0] - r.front()) + 1e5 * y[1] : 0.0;
    const double friction = p.friction * std::tanh(y[1] / 1e-5);
    return std::array<double, 4>{y[1], (force + spring - friction - stuck) / p.drive, y[3],
                                 p.table > 0.0 ? -spring / p.table : 0.0};
  };
  double made = 0.0;  // behind the lag
  const auto advance = [&](double asked, double time, int parts) {
    const double h = time / parts;
    for (int i = 0; i < parts; ++i) {
      // Its mean over the step is exact enough.
      const double kept = p.lag > 0.0 ? std::exp(-h / p.lag) : 0.0;
      const double force = p.lag > 0.0 ? asked + (made - asked) * (1.0 - kept) * p.lag / h : asked;
      made = asked + (made - asked) * kept;
      const auto at = [&](const std::array<double, 4>& k, double share) {
        std::array<double, 4> y = s;
        for (std::size_t j = 0; j < 4; ++j) y[j] += share * h * k[j];
        return y;
      };
      const auto k1 = rate(s, force);
      const auto k2 = rate(at(k1, 0.5), force);
      const auto k3 = rate(at(k2, 0.5), force);
      const auto k4 = rate(at(k3, 1.0), force);
      for (std::size_t j = 0; j < 4; ++j) s[j] += h / 6.0 * (k1[j] + 2.0 * k2[j] + 2.0 * k3[j] + k4[j]);
    }
  };
  log::Record out;
  out.source = "two masses";
  out.sample_time = p.period;
  out.r = r;
  out.loop = log::Loop::kClosed;
  double error_before = 0.0;
  double force_before = 0.0;
  for (std::size_t k = 0; k < r.size(); ++k) {
    const double x = p.encoder * std::nearbyint(s[0] / p.encoder);
    const double before = r[k > 0 ? k - 1 : 0];
    const double after = r[std::min(k + 1, r.size() - 1)];
    const double error = x - r[k];
    const double force =
        p.mass() * (p.fed * (after - 2.0 * r[k] + before) / (p.period * p.period) -
                    2.0 * p.omega * (error - error_before) / p.period - p.omega * p.omega * error);
    error_before = error;
    out.t.push_back(static_cast<double>(k) * p.period);
    out.x.push_back(x);
    out.f.push_back(force);
    const double disturbance = p.noise * normal(random);
    if (p.late > 0.0)
      advance(force_before + disturbance, p.late * p.period, std::max(1, static_cast<int>(kParts * p.late)));
    advance(force + disturbance, (1.0 - p.late) * p.period,
            std::max(1, static_cast<int>(kParts * (1.0 - p.late))));
    force_before = force;
  }
  return out;
}

/// A short multisine for an axis of about a tonne.
inline std::vector<double> short_multisine(double period, int repeats = 4, double highest = 100.0) {
  excitation::MultisineDesign design;
  design.period = 1.0;
  design.lowest = 2.0;
  design.highest = highest;
  design.repeats = repeats;
  return excitation::design_multisine({-0.2, 0.2, 0.05, 1.0, 5000.0}, {1000.0, 30.0, 0.0}, period, design).r;
}

}  // namespace stribeck::ident::frequency
