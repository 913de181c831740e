#pragma once
/// Identified parameters as text for people, and the sentences and tables about them that several reports share.
/// Real time: no.

#include <array>
#include <functional>
#include <optional>
#include <stribeck/ident/result.hpp>
#include <stribeck/report/html.hpp>
#include <stribeck/report/shown_units.hpp>
#include <string>
#include <vector>

namespace stribeck::report {

/// A parameter in its shown unit.
struct ShownParameter {
  double value = 0.0;
  double low = 0.0;
  double high = 0.0;
  std::string unit = {};
};

ShownParameter shown(const ident::Parameter& parameter, const ShownUnits& units = {});
ShownUnits units_of(const ident::Result& result);

/// Where the curve begins: its velocities next to rest, backward (< 0) and forward [m/s]; NaN where there is none.
std::array<double, 2> curve_begin(const ident::Result& result);

/// With the decimals that the interval deserves: 57.65 for 57.18 … 58.14.
std::string shown_number(double value, double low, double high);

Table parameter_table(const ident::Result& result);
/// Number of decimals that distinguishes the candidates' errors.
int candidate_digits(const ident::Result& result);
Table candidate_table(const ident::Result& result);

/// The parts of one axis to plot; absent parts are left out.
struct FrictionMap {
  std::string axis = {};
  const ident::Result* fit = nullptr;                 ///< points, curve and band
  std::optional<friction::SteadyVariant> model = {};  ///< the curve where there is no fit
  std::string model_label = {};
  std::optional<friction::SteadyVariant> conventional = {};
  std::optional<friction::SteadyVariant> truth = {};
  std::string truth_label = "true friction";
  double speed = 0.0;   ///< largest velocity to draw where there is no fit [m/s]
  bool rotary = false;  ///< without a fit, which knows it
};

/// The map, and the difference of everything in it from the fit (or the model). Periodic terms are not included.
std::vector<Plot> friction_plots(const FrictionMap& map);

/// Residual of the model against velocity, position and time, with the mean of slices and twice its standard
/// error; nothing where the result holds no residuals.
std::vector<Plot> residual_plots(const ident::Result& result);

/// Amplitude over the period in position of the residual before periodic terms, those of the model marked; none
/// without lines.
std::optional<Plot> spectrum_plot(const ident::Result& result);

}  // namespace stribeck::report
