#pragma once
/// The parameters of one axis of a controller, with the names that the C interface gives them. What is in no file has its
/// fields here.
/// Real time: configure only.

#include "law_settings.hpp"
#include "parameters.hpp"

namespace stribeck::capi {

struct AxisSettings {
  double omega = 40.0;       ///< [rad/s]
  std::optional<double> kp;  ///< [1/s²]
  std::optional<double> kv;  ///< [1/s]
  std::optional<double> force_limit;
  control::ErrorRate error_rate = control::ErrorRate::kDifferenceOfError;
  LawSettings law;
  control::CompensationParams compensation;

  static constexpr auto fields() {
    using S = AxisSettings;
    return std::tuple{
        field("omega", &S::omega, quantity("rad/s", "rad/s").positive(),
              "double pole of the position loop; axis 0: along the path, others: across it"),
        field("kp", &S::kp, quantity("1/s2", "1/s2").positive(),
              "proportional gain; left out: omega squared"),
        field("kv", &S::kv, quantity("1/s", "1/s").positive(), "derivative gain; left out: twice omega"),
        field("force_limit", &S::force_limit, quantity("N", "N").positive(), "largest force; left out: none"),
        field("error_rate", &S::error_rate,
              "rate of the error: difference-of-error, late, or observed by kalman; axis 0 decides"),
        field("law", &S::law,
              "control law: contouring, sliding-mode, predictive or learning; the same on all axes"),
        field("", &S::compensation, "")};
  }
};

template <>
struct FieldsOf<control::CompensationParams> {
  static constexpr auto get() {
    using P = control::CompensationParams;
    return std::tuple{
        field("", &P::model, ""),
        field("feedforward", &P::feedforward, "how friction is fed forward: none, steady, dynamic, reversal"),
        field("observer", &P::observer, "whose estimate is added: none, disturbance, kalman, adaptive"),
        field("observer_pole", &P::observer_pole, quantity("1/s", "1/s").positive(),
              "poles of the disturbance observer, or bandwidth of the Kalman observer"),
        field("adaptive_gain", &P::adaptive_gain, quantity("1/s", "1/s").positive(),
              "gain of adaptive friction"),
        field("disturbance_density", &P::disturbance_density, quantity("N2/s", "N2/s").positive(),
              "Kalman observer: how fast the disturbance walks; left out: as observer_pole asks for"),
        field("encoder_resolution", &P::encoder_resolution, quantity("m", "nm").positive(),
              "step of the encoder"),
        field("adaptation", &P::adaptation, ""),
        field("reversal", &P::reversal, ""),
        field("guarded", &P::guarded, "back off when the loop oscillates")};
  }
};

template <>
struct FieldsOf<control::AdaptationParams> {
  static constexpr auto get() {
    using P = control::AdaptationParams;
    return std::tuple{
        field("enabled", &P::enabled, "correct the friction model on line"),
        field("memory", &P::memory, quantity("s", "s").positive(), "time over which it forgets"),
        field("level_spread", &P::level_spread, pure_number().not_negative(),
              "how far the level may be off, as a share"),
        field("viscous_spread", &P::viscous_spread, pure_number().not_negative(),
              "the same of viscous friction"),
        field("stiffness_spread", &P::stiffness_spread, pure_number().not_negative(),
              "the same of bristle stiffness"),
        field("mass_spread", &P::mass_spread, pure_number().not_negative(), "the same of the mass"),
        field("delay_spread", &P::delay_spread, pure_number().not_negative(),
              "how far the delay may be off, in periods"),
        field("noise_share", &P::noise_share, pure_number().positive(),
              "least noise, as a share of the level at rest"),
        field("correlation", &P::correlation, quantity("s", "ms").positive(),
              "correlation time of that noise")};
  }
};

}  // namespace stribeck::capi
