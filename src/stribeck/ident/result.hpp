#pragma once
/// Result of an identification: numbers with 95 % intervals, the curve, the models that were tried.
///
/// Everything is SI; `unit` is the SI unit as text and `shown` the unit for people (N s/m, N s/mm). A log whose force has no
/// known scale is identified in its own unit: force_unit names it ("A", "%", "V"), and "N" in a unit then stands for it; likewise
/// position_unit "rad" for an axis without a lead. Intervals hold under correlated residuals. A parameter that the data cannot
/// determine has identifiable = false: its value is part of the curve but means nothing alone. An interval that could not be
/// computed is NaN on both sides.
///
/// Real time: no.

#include <array>
#include <limits>
#include <optional>
#include <stribeck/core/fields.hpp>
#include <stribeck/friction/axis_model.hpp>
#include <stribeck/friction/uncertainty.hpp>
#include <stribeck/ident/force_filter.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stribeck::ident {

struct Interval {
  double low = std::numeric_limits<double>::quiet_NaN();
  double high = std::numeric_limits<double>::quiet_NaN();
};

struct Parameter {
  std::string name;  ///< mass, eta0_positive, gaussian_1_a_negative, exponential_a_positive, …
  double value = 0.0;
  std::string unit;   ///< SI
  std::string shown;  ///< unit for people
  double ci_low = std::numeric_limits<double>::quiet_NaN();
  double ci_high = std::numeric_limits<double>::quiet_NaN();
  bool identifiable = true;
};

struct CurvePoint {
  double velocity = 0.0;  ///< [m/s]
  double friction = 0.0;  ///< [N]
  double ci_low = 0.0;    ///< [N]
  double ci_high = 0.0;   ///< [N]
};

/// One model that was tried.
struct Candidate {
  std::string name;             ///< e.g. "Gaussian, 2 terms, v > 0"
  int terms = 0;                ///< number of Gaussians
  int parameters = 0;           ///< number of fitted parameters
  double held_out_rms = 0.0;    ///< [N], on motion that was not fitted
  double standard_error = 0.0;  ///< [N], of its difference from the best candidate
  bool chosen = false;
};

/// One point of the measured velocity–friction map, for plots.
struct MapPoint {
  double velocity = 0.0;  ///< [m/s]
  double friction = 0.0;  ///< [N]
  int direction = 0;      ///< +1 or −1
};

/// Residual of the model in one row, for plots.
struct ResidualPoint {
  double t = 0.0;      ///< [s]
  double x = 0.0;      ///< [m]
  double v = 0.0;      ///< [m/s]
  double error = 0.0;  ///< measured less modelled force [N]
  int record = 0;
};

/// One line of the spectrum of the residual over position.
struct SpectrumLine {
  double period = 0.0;     ///< [m]
  double amplitude = 0.0;  ///< [N]
};

/// How an axis is identified. EnumNames has the words of options, name_of() those of files and reports.
enum class Method {
  kAuto,
  kVelocityMap,
  kLeastSquaresA,
  kJog,
  kPositionMap,
  kIdimLs,
  kBreakAway,
  kGravity,
  kConstantAcceleration
};

/// The steady part of the model.
enum class SteadyModel {
  kNone,          ///< single values only
  kConventional,  ///< Coulomb, viscous, Stribeck; equal in both directions
  kAsymmetric,    ///< Coulomb and viscous, by direction
  kGaussian,
  kCogging  ///< only forces periodic in position
};
constexpr std::string_view name_of(SteadyModel model) noexcept {
  constexpr std::array<std::string_view, 5> kNames{"none", "conventional", "asymmetric", "gaussian",
                                                   "cogging"};
  return kNames[static_cast<std::size_t>(model)];
}

struct Result {
  Method method = Method::kAuto;
  SteadyModel steady = SteadyModel::kNone;
  std::string model;  ///< as text for people: the name of `steady` and of further parts, " + periodic", …
  std::string force_unit = "N";                                  ///< unit of every force here
  std::string position_unit = "m";                               ///< "m" or "rad"
  bool rotary = false;                                           ///< positions are arcs at a radius of 1 m
  double mass = 0.0;                                             ///< [kg]
  Interval mass_interval;                                        ///< [kg]
  double plain_mass = std::numeric_limits<double>::quiet_NaN();  ///< by ordinary least squares, biased [kg]
  std::optional<double>
      delay{};  ///< from the command of a force to the beginning of its hold [s]; absent: the log does not tell it
  std::optional<double> given_shift{};  ///< given time by which the force is later than its motion [s]
  std::optional<ForceFilter> filter{};  ///< of the drive, that was taken off the force before the fit
  double cut_off = 0.0;       ///< of a given or found low-pass of the motion [Hz]; 0: the window of its noise
  bool level_drifts = false;  ///< friction rises or falls over the time of a log
  double load = 0.0;          ///< constant force against +x, e.g. a weight [N]
  std::array<double, 2> velocity_range{};  ///< [m/s] lowest (< 0), highest (> 0)
  std::vector<Parameter> parameters;
  std::vector<CurvePoint> curve;                                   ///< ascending velocity
  double held_out_rms = std::numeric_limits<double>::quiet_NaN();  ///< [N]
  double r_squared = std::numeric_limits<double>::quiet_NaN();     ///< share of the force that is explained
  std::vector<Candidate> models;
  std::vector<MapPoint> map;             ///< thinned
  std::vector<ResidualPoint> residuals;  ///< thinned
  std::vector<SpectrumLine> spectrum;    ///< of the residual over position, ascending period
  std::vector<std::string> warnings;
  std::vector<std::string> cannot_tell;              ///< what this log does not determine
  friction::Model friction;                          ///< is written into an axis file unchanged
  std::optional<friction::ModelUncertainty> open{};  ///< what the log leaves open of mass and friction
  double break_away_distance = std::numeric_limits<double>::quiet_NaN();  ///< [m]; NaN: not determined
  bool bristles_too_fine = false;  ///< for the encoder: no other motion would tell them
  std::size_t rows = 0;            ///< rows that were fitted
  std::optional<std::array<int, 2>>
      peaks;  ///< number of terms for v > 0 and v < 0 by the rule of the thesis, for comparison

  /// First part of the name of the model: its steady part.
  void set_steady(SteadyModel part) {
    steady = part;
    model = name_of(part);
  }
  /// The parameter with this name; nullptr where there is none.
  [[nodiscard]] const Parameter* find(std::string_view name) const noexcept {
    for (const Parameter& p : parameters) {
      if (p.name == name) return &p;
    }
    return nullptr;
  }
};

}  // namespace stribeck::ident

template <>
struct stribeck::EnumNames<stribeck::ident::Method> {
  using M = stribeck::ident::Method;
  static constexpr std::array names{
      std::pair{M::kAuto, std::string_view{"auto"}},
      std::pair{M::kVelocityMap, std::string_view{"velocity-map"}},
      std::pair{M::kPositionMap, std::string_view{"position-map"}},
      std::pair{M::kJog, std::string_view{"jog"}},
      std::pair{M::kLeastSquaresA, std::string_view{"least-squares"}},
      std::pair{M::kBreakAway, std::string_view{"break-away"}},
      std::pair{M::kGravity, std::string_view{"gravity"}},
      std::pair{M::kConstantAcceleration, std::string_view{"constant-acceleration"}},
      std::pair{M::kIdimLs, std::string_view{"idim-ls"}}};
};

namespace stribeck::ident {

/// The word of files and reports. Result files call the method of the thesis's Model A by that name.
constexpr std::string_view name_of(Method method) noexcept {
  return method == Method::kLeastSquaresA ? "least-squares-a" : enum_name(method);
}

}  // namespace stribeck::ident
