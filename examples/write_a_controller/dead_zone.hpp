#pragma once
/// PD that leaves an error within ±zone alone, so that a coarse encoder does not make the drive rattle.
///
///   z = e − clamp(e, ±zone)        F = m·(r̈ − k_v ż − k_p z) + F_friction + load + d̂        e = x − r [m]
///
/// k_p = ω², k_v = 2ω. Stable in continuous time: V = (ė² + k_p z²)/2 falls outside the zone and stands inside it.
/// Source: Lyapunov's direct method. Not modelled: friction, which holds the axis inside the zone.
/// Real time: safe; the constructor configure only.

#include <stribeck/control/setup.hpp>

namespace stribeck::control {
template <std::size_t N>
class DeadZone;

struct DeadZoneParams {
  template <std::size_t N>
  using Controller = DeadZone<N>;
  static constexpr std::string_view kKind = "dead-zone";
  static constexpr std::string_view kLabel = "PD with a dead zone";

  double omega = 40.0;
  double zone = 1e-6;

  static constexpr auto fields() {
    return std::tuple{field("omega", &DeadZoneParams::omega, quantity("rad/s", "rad/s").positive(),
                            "double pole outside the zone")
                          .or_default(),
                      field("zone", &DeadZoneParams::zone, quantity("m", "um").not_negative(),
                            "error that is left alone, to either side")
                          .or_default()};
  }
};

template <std::size_t N>
class DeadZone {
 public:
  using Params = DeadZoneParams;
  using State = typename Common<N>::State;

  DeadZone(const Params& params, const Setup<N>& setup) noexcept
      : common_(setup, ErrorRate::kDifferenceOfError), params_(params) {}

  Vec<double, N> step(State& s, const path::PathPoint<N>& r, const Vec<double, N>& measured) const noexcept {
    if (!common_.begin(s, r, measured)) return s.force;  // not finite: the last forces, and a status
    Vec<double, N> wanted = r.acceleration;
    for (std::size_t i = 0; i < N; ++i) {
      const double e = s.error[i].e;
      const double z = e - clamp_to(e, -params_.zone, params_.zone);
      const double z_rate = z == 0.0 ? 0.0 : s.error[i].rate;
      wanted[i] -= params_.omega * (2.0 * z_rate + params_.omega * z);
    }
    return common_.finish(s, r, wanted);  // mass, friction, observer, limits
  }

 private:
  Common<N> common_;
  Params params_;
};
}  // namespace stribeck::control
