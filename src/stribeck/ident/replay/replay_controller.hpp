#pragma once
/// The position controller of a log, in the few laws that common controls have, so that a model can be replayed in its closed
/// loop. Read from a TOML file like other parameters.
///
///   cascade   w = kp·(r − x) + c·ṙ − v_m       F = kv·(w + ∫w dt / T_i) + M_f·r̈
///   pd        F = k·(r − x) + d·Δ(r − x)/T + k_i·∫(r − x) dt + M_f·r̈
///
///   v_m(k) = (y(k) − y(k−1))/T,  y(k) mean of the last n positions;  ṙ, r̈ central differences of r
///
///   kp [1/s], kv [N·s/m], T_i [s], c share of the reference velocity [-], n [-], k [N/m], d [N·s/m],
///   k_i [N/(m·s)], M_f [kg]; F positive towards +x, limited to ±limit [N]; at the limit an integral stops
///
/// F(k) is computed from x(k) and acts from t(k) to t(k+1). For a drive commanded in volts, multiply its gains and its limit
/// by the force per volt (EMPS: 243.45 V·s/m · 35.15065 N/V = 8557.42 N·s/m). The integral starts with the value that makes F(0)
/// the first force of the log.
///
/// Not modelled: friction feed-forward, observers, notch filters, resolution of encoder and D/A.
/// Real time: configure only.

#include <optional>
#include <stribeck/core/fields.hpp>
#include <variant>

namespace stribeck::ident::replay {

struct CascadeLaw {
  static constexpr std::string_view kKind = "cascade";

  double position_gain = 0.0;           ///< kp [1/s]
  double velocity_gain = 0.0;           ///< kv [N·s/m]
  std::optional<double> integral_time;  ///< T_i [s]; absent: proportional only
  double velocity_feedforward = 0.0;    ///< c [-]
  double mass_feedforward = 0.0;        ///< M_f [kg]
  int velocity_average = 1;             ///< n

  static constexpr auto fields() {
    return std::tuple{
        field("position_gain", &CascadeLaw::position_gain, quantity("1/s", "1/s").positive(),
              "velocity asked for per position error"),
        field("velocity_gain", &CascadeLaw::velocity_gain, quantity("N s/m", "N s/mm").positive(),
              "force per velocity error"),
        field("integral_time", &CascadeLaw::integral_time, quantity("s", "ms").positive(),
              "of the velocity loop; left out: no integral")
            .or_default(),
        field("velocity_feedforward", &CascadeLaw::velocity_feedforward, pure_number(),
              "share of the reference velocity that is asked for directly")
            .or_default(),
        field("mass_feedforward", &CascadeLaw::mass_feedforward, quantity("kg", "N s2/mm").not_negative(),
              "mass times acceleration of the reference is added")
            .or_default(),
        field("velocity_average", &CascadeLaw::velocity_average, pure_number().at_least(1).at_most(64),
              "positions averaged before the difference is taken")
            .or_default()};
  }
};

struct PdLaw {
  static constexpr std::string_view kKind = "pd";

  double stiffness = 0.0;         ///< k [N/m]
  double damping = 0.0;           ///< d [N·s/m]
  double integral = 0.0;          ///< k_i [N/(m·s)]
  double mass_feedforward = 0.0;  ///< M_f [kg]

  static constexpr auto fields() {
    return std::tuple{
        field("stiffness", &PdLaw::stiffness, quantity("N/m", "N/mm").positive(), "force per position error"),
        field("damping", &PdLaw::damping, quantity("N s/m", "N s/mm").not_negative(),
              "force per rate of the position error"),
        field("integral", &PdLaw::integral, quantity("N/(m s)", "N/(mm s)").not_negative(),
              "force per integral of the position error")
            .or_default(),
        field("mass_feedforward", &PdLaw::mass_feedforward, quantity("kg", "N s2/mm").not_negative(),
              "mass times acceleration of the reference is added")
            .or_default()};
  }
};

struct ReplayController {
  std::variant<CascadeLaw, PdLaw> law;
  std::optional<double> limit;  ///< of the force, in both directions [N]

  static constexpr auto fields() {
    return std::tuple{
        field("controller", &ReplayController::law, "law of the position controller"),
        field("limit", &ReplayController::limit, quantity("N", "N").positive(), "largest force of the drive")
            .or_default()};
  }
};

}  // namespace stribeck::ident::replay
