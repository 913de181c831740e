#pragma once
/// What the logs of an axis leave open: independent deviations of its model.
///
///   model of a draw = model + Σ z_k·d_k      z_k independent, normal, with mean 0 and standard deviation 1
///
///   d_k   mass [kg]; level [N], viscous [N·s/m] and rise [N] of friction against the motion, for v > 0 and for v < 0; stiffness of
///         pre-sliding and its damping, as changes of their logarithms
///
/// The rise is added to friction as rise·exp(−(v/w)²), w = rise_speed; where the map has a Stribeck part, that part rises. A map that is
/// the same in both directions takes the mean of both; of the level, half the difference is load. Load and friction of one
/// direction always come as their sum, which is all that a log tells.
///
/// Not modelled: what the logs leave open of shift, periodic terms, springs, places and lost motion; the shape of the Stribeck part.
/// Real time: safe.

#include <algorithm>
#include <array>
#include <cmath>
#include <stribeck/core/fields.hpp>
#include <stribeck/core/fixed_vector.hpp>
#include <stribeck/friction/axis_model.hpp>

namespace stribeck::friction {

/// Mass, three figures of each direction, stiffness and damping.
inline constexpr std::size_t kMaxDeviations = 9;

struct ModelDeviation {
  double mass = 0.0;                ///< [kg]
  std::array<double, 2> level{};    ///< [N]
  std::array<double, 2> viscous{};  ///< [N·s/m]
  std::array<double, 2> rise{};     ///< [N]
  double stiffness = 0.0;           ///< of its logarithm
  double damping = 0.0;             ///< the same

  static constexpr auto fields() {
    using D = ModelDeviation;
    return std::tuple{
        field("mass", &D::mass, quantity("kg", "N s2/mm"), "change of the equivalent mass").or_default(),
        field("level", &D::level, quantity("N", "N"),
              "change of the level of friction against the motion: forward, backward")
            .or_default(),
        field("viscous", &D::viscous, quantity("N s/m", "N s/mm"),
              "change of the viscous coefficient: forward, backward")
            .or_default(),
        field("rise", &D::rise, quantity("N", "N"),
              "change of the rise of friction towards standstill: forward, backward")
            .or_default(),
        field("stiffness", &D::stiffness, pure_number(),
              "change of the stiffness of pre-sliding, as that of its natural logarithm")
            .or_default(),
        field("damping", &D::damping, pure_number(),
              "change of the damping of pre-sliding, as that of its natural logarithm")
            .or_default()};
  }

  void add(double factor, const ModelDeviation& other) noexcept {
    mass += factor * other.mass;
    for (std::size_t s = 0; s < 2; ++s) {
      level[s] += factor * other.level[s];
      viscous[s] += factor * other.viscous[s];
      rise[s] += factor * other.rise[s];
    }
    stiffness += factor * other.stiffness;
    damping += factor * other.damping;
  }
};

struct ModelUncertainty {
  double rise_speed = 1e-3;  ///< [m/s]
  double told_from = 0.0;    ///< smallest speed whose friction the logs tell [m/s]
  FixedVector<ModelDeviation, kMaxDeviations> deviations;

  static constexpr auto fields() {
    using U = ModelUncertainty;
    return std::tuple{
        field("rise_speed", &U::rise_speed, quantity("m/s", "mm/s").positive(),
              "speed at which a rise towards standstill has faded to 1/e"),
        field(
            "told_from", &U::told_from, quantity("m/s", "mm/s").not_negative(),
            "smallest speed whose friction the logs tell; 0: down to rest. What may be below it is in no deviation")
            .or_default(),
        field("deviations", &U::deviations,
              "each is one standard deviation of the model in one direction; all are independent")};
  }
};

inline void deviate(Conventional<double>& map, double& load, const ModelDeviation& d,
                    double rise_speed) noexcept {
  const auto mean = [](const std::array<double, 2>& x) { return 0.5 * (x[0] + x[1]); };
  load += 0.5 * (d.level[0] - d.level[1]);
  map.alpha0 += mean(d.level);
  map.alpha2 = std::max(0.0, map.alpha2 + mean(d.viscous));
  if (map.stribeck) {
    map.stribeck->alpha1 += mean(d.level) + mean(d.rise);
  } else if (mean(d.rise) != 0.0) {
    map.stribeck = Stribeck<double>{map.alpha0 + mean(d.rise), rise_speed, 2.0};
  }
}

inline void deviate(Gaussian<double>& map, double&, const ModelDeviation& d, double rise_speed) noexcept {
  const auto of = [&](GaussianBranch<double>& branch, std::size_t s, double sign) {
    branch.eta0 += sign * d.level[s];
    branch.eta1 += d.viscous[s];
    // If the branch already has six terms, its rise is not changed.
    if (d.rise[s] != 0.0) branch.gaussians.push_back({sign * d.rise[s], 0.0, rise_speed});
  };
  of(map.positive, 0, 1.0);
  of(map.negative, 1, -1.0);
}

/// stiffened() keeps the damping ratio; here the damping is told by itself.
inline void deviate(LuGre<double>& law, const ModelDeviation& d) noexcept {
  law.sigma0 *= std::exp(d.stiffness);
  law.sigma1 *= std::exp(d.damping);
}
inline void deviate(Gms<double>& law, const ModelDeviation& d) noexcept {
  for (auto& e : law.elements) e.stiffness *= std::exp(d.stiffness);
  law.damping_coefficient *= std::exp(d.damping);
}
inline void deviate(Static&, const ModelDeviation&) noexcept {}

/// Whether there is a mass, and a level of friction above zero at every speed of the map.
inline bool is_possible(const AxisModel& model) noexcept {
  bool possible = model.mass > 0.0;
  std::visit(
      [&](const auto& map) {
        const std::array<double, 2> range = map.identified_range().value_or(std::array{-1.0, 1.0});
        for (int i = 0; i <= 100; ++i) {
          // Closer towards standstill, where a map bends.
          const double share = std::pow(i / 100.0, 4.0);
          for (const double end : range) possible = possible && map.parts(share * end, 0.0).level > 0.0;
        }
      },
      model.friction.steady);
  return possible;
}

/// The model with this change. One that would leave no mass, or no friction at some speed, is halved until it does.
inline AxisModel deviated(const AxisModel& model, const ModelDeviation& change, double rise_speed) noexcept {
  ModelDeviation d = change;
  for (int i = 0; i < 8; ++i) {
    AxisModel m = model;
    m.mass += d.mass;
    std::visit([&](auto& map) { deviate(map, m.load, d, rise_speed); }, m.friction.steady);
    std::visit([&](auto& law) { deviate(law, d); }, m.friction.dynamics);
    if (is_possible(m)) return m;
    ModelDeviation half;
    half.add(0.5, d);
    d = half;
  }
  return model;
}

}  // namespace stribeck::friction
