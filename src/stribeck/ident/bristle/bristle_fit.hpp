#pragma once
/// Dynamic friction, LuGre and GMS, from the reversals of logs.
///
///   f̄_k − m·D²x[k] − load = ∫ F(t)·w dt/T + e_k        f̄, D², w: bristle_path.hpp
///
/// Friction is simulated along the measured position, with its state advanced inside the samples. It is compared with the
/// force through one linear window (output error of the force; derivatives are automatic). Fitted parameters:
///
///   LuGre   σ0 [N/m], σ1 [N·s/m], v_d [m/s]
///   GMS     k_i [N/m], α_i, C [N/s], σ [N·s/m], v_d; elements in order of their break-away α_i·g/k_i
///
/// Fitted with them are a factor on the level of each direction, the load, the viscous coefficient and, from open-loop logs,
/// the mass, because the steady map is only an estimate, as good as BristleOptions says. `break_away` is g/σ0 or g/Σk_i.
/// After a reversal LuGre is twice as stiff as σ0, but GMS as stiff as Σk_i: on one log the two may differ by a factor of two.
///
/// Intervals (95 %) hold under correlated residuals (bristle_solve.hpp). Models compete on stretches that were
/// left out; the simplest one within one standard error wins. The result names a reason where nothing can be determined: no
/// reversal, encoder or sampling too coarse, interval too wide, level at odds with the map, no gain over the static model.
///
/// Source: Canudas de Wit et al. 1995, doi:10.1109/9.376053; Al-Bender, Lampaert, Swevers 2005,
/// doi:10.1109/TAC.2005.858676.
/// Not modelled: noise of the position between ticks; dependence of stiffness on position.
/// Real time: no.
/// Errors: Refused for records with problems(), different sampling times or an axis model without mass or level.

#include <array>
#include <optional>
#include <stribeck/friction/axis_model.hpp>
#include <stribeck/ident/log/record.hpp>
#include <stribeck/ident/result.hpp>
#include <string>
#include <vector>

namespace stribeck::ident::bristle {

/// Standard deviations of what the axis model gives.
struct BristleOptions {
  std::optional<double> mass_tolerance;  ///< relative; absent: 5 % if every log is open loop, else 0.5 %
  double level_tolerance = 0.1;          ///< relative
  double load_tolerance = 0.05;          ///< as a share of the level
  double viscous_tolerance = 0.05;       ///< as a share of the level, at the largest speed of the rows used
  /// Speed below which the steady map was not measured [m/s]: a rise of friction towards rest is fitted with the others. 0: none.
  double unseen_below = 0.0;
  /// Break-away distance that an earlier fit to the same reversals has found [m]. The search begins there; other starts are not tried.
  std::optional<double> near{};
  double shift = -0.5;  ///< of the force, in rows, as in MotionOptions
  int elements = 4;     ///< of GMS, 2 … 6; 0: LuGre only
};

/// Begins the reason where nothing was determined.
inline constexpr const char* kNotDeterminable = "pre-sliding is not determinable from this log: ";

struct BristleFit {
  bool determinable = false;
  bool too_coarse = false;         ///< the encoder does not show the break-away distance, in any motion
  std::string reason;              ///< a sentence: what was determined, or why nothing
  friction::DynamicsVariant best;  ///< Static when not determinable
  std::optional<friction::LuGre<double>> lugre;
  std::optional<friction::Gms<double>> gms;
  std::vector<Parameter> lugre_parameters;  ///< sigma0, sigma1, damping_velocity
  std::vector<Parameter> gms_parameters;  ///< stiffness (sum), stiffness_1 …, share_1 …, attraction, damping
  double break_away = std::numeric_limits<double>::quiet_NaN();  ///< of the best model, else of LuGre [m]
  Interval break_away_interval;
  double mass = 0.0;  ///< after the fit [kg]
  Interval mass_interval;
  double load = 0.0;  ///< after the fit [N]
  Interval load_interval;
  std::array<double, 2> level_factor{1.0, 1.0};  ///< forward, backward: level found over level given
  std::vector<Candidate> models;                 ///< static, LuGre, GMS over the rows after reversals
  std::size_t reversals = 0;
  std::size_t rows = 0;            ///< number of rows that were fitted
  double rows_per_reversal = 0.0;  ///< median number of rows within three break-away distances
};

/// All records must belong to one axis and have no delay.
BristleFit fit_bristle(const std::vector<log::Record>& records, const friction::AxisModel& known,
                       const BristleOptions& options = {});

}  // namespace stribeck::ident::bristle
