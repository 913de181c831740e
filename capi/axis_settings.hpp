#pragma once
/// The parameters of one axis of a controller, with their names in the C interface. Those of the compensation are
/// declared in control/compensation; those that no file has are declared here.
/// Real time: configure only.

#include "law_settings.hpp"
#include "parameters.hpp"

#include <stribeck/control/supervision/limits.hpp>

namespace stribeck::capi {

struct AxisSettings {
  double omega = 40.0;       ///< [rad/s]
  std::optional<double> kp;  ///< [1/s²]
  std::optional<double> kv;  ///< [1/s]
  std::optional<double> force_limit;
  control::ErrorRate error_rate = control::ErrorRate::kDifferenceOfError;
  LawSettings law;
  control::CompensationParams compensation;
  /// A host that gives no limits keeps its old behaviour: the law handles bad numbers, and only a lost encoder or command is a fault.
  control::SupervisionParams supervision{.checks = control::Checks::kLost};

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
        embedded(&S::compensation),
        field("supervision", &S::supervision, "supervision of the axis")};
  }
};

}  // namespace stribeck::capi
