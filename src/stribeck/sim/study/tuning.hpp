#pragma once
/// Every controller at its best gains: one search method for every law, under the same limits.
///
///   gains      every positive number of the law and of its controller that counts in powers of time (1/s, 1/s², 1/s³, rad/s, s,
///              m/s, m/s², N²/s) and has an effect; entries of a list one by one. Shares, bounds and choices are not gains.
///   unknowns   logarithms of the gains over their start, within a factor of 20
///   objective  J = mean over machines, travels and trials of max |ε| + RMS (accuracy), of quadrant glitch + SD (surface), or of mean
///              |e| of the axes + RMS (speed: the lag that grows with the feed)
///   machines   the given one; or with nearby_machines() those that it may be, so that gains suit more than the model
///   limits     phase, gain and delay margin of loop_margins.hpp; mean |Δu| on each travel not above that of a reference
///              controller at its own gains under the same noise, or above a value
///   method     the start, or where that breaks a limit the start made slower as a whole (each gain by its power of time: damping
///              ratios stay), or where no speed has the margins the best of six other shapes that have them, of 128 looked at by
///              margins alone; a third of the evaluations for shapes spread evenly (Halton), each as fast as the margins let it
///              be; the rest for COBYLA (linear models of J and of the limits in a trust region), from the start and from the best
///              there is. Of the six best points that keep all limits under other noise as well, the best under that noise.
///
/// A point whose loop is unstable is not simulated. Search and confirmation have noise of their own (trials from kSearchTrial on);
/// before and after are compare() with the spec's seed and trials. Same spec, same bytes, on any number of threads.
/// Source: Powell 1994, doi:10.1007/978-94-015-8330-5_4 (COBYLA); NLopt.
/// Not modelled: what margins do not show (see there); several minima: the search is local.
/// Real time: no. Errors: Refused as of compare(). No gains within the limits is an answer, not an error: TunedController::miss.

#include <stribeck/sim/compare.hpp>
#include <stribeck/sim/study/loop_margins.hpp>
#include <stribeck/sim/study/stick_slip.hpp>
#include <stribeck/sim/study/variation.hpp>

namespace stribeck::sim {

/// First trial number of the search's noise: no experiment has that many trials.
inline constexpr std::uint32_t kSearchTrial = 1000000;

/// The report has other noise than the search. This share of the limit of variation is kept in reserve for the difference. Over ten
/// trials on V2 the mean of a controller moves by 0.2 %, and that of the reference with it.
inline constexpr double kKeptBack = 0.005;

/// What the gains are chosen for.
enum class TuneGoal { kAccuracy, kSurface, kSpeed };

struct TuneLimits {
  double phase_margin = kPi / 4.0;          ///< [rad]
  double gain_margin = 1.9952623149688795;  ///< factor; 6 dB
  double delay_margin = 1.0;                ///< control periods
  std::optional<double> input_variation;    ///< [V]; empty: that of the reference on each travel
  double variation_share = 1.0;             ///< of that limit: trade_off() asks for several
  std::vector<std::optional<plant::AxialMode>> axial_mode;  ///< per axis of the spec, declared; empty: none
};

struct TuneSpec {
  CompareSpec compare;  ///< travels, axes, controllers; trials and seed of the report
  std::optional<ControllerSpec>
      reference;  ///< its variation is the limit; empty: the last of the controllers
  TuneLimits limits;
  TuneGoal goal = TuneGoal::kAccuracy;
  bool nearby = false;              ///< gains for all nearby_machines()
  int evaluations = 300;            ///< of J, for each controller
  std::uint32_t search_trials = 2;  ///< of each evaluation
  bool stick_slip = false;          ///< look for the slowest smooth speeds too
};

struct TunedGain {
  std::string name;  ///< "law.kp[0]"
  Quantity quantity;
  double start = 0.0;
  double tuned = 0.0;
};

/// The results of one travel.
struct TravelScore {
  Metrics mean;
  Metrics spread;
};

/// Largest contour error on one of the machines, mean over travels and trials [m]; NaN: refused there, infinite: the path was lost.
struct MachineScore {
  std::string machine;
  double before = 0.0;
  double after = 0.0;
};

enum class Limit { kStability, kPhaseMargin, kGainMargin, kDelayMargin, kInputVariation, kPath };

/// The worst violated limit of the gains that came nearest to the limits.
struct Miss {
  Limit limit = Limit::kStability;  ///< kStability: no loop was stable; kPath: the path was lost
  double nearest = 0.0;  ///< its value, in the unit of TuneLimits; NaN for the two without a number
  double asked = 0.0;
  std::size_t travel = 0;  ///< for the variation
  bool other_noise =
      false;  ///< the gains met the limits under the search's noise, but not under that of the confirmation
};

struct TunedController {
  ControllerSpec start;
  ControllerSpec tuned;          ///< equals the start where no gains meet the limits
  std::vector<TunedGain> gains;  ///< those with an effect
  std::optional<Miss> miss;      ///< no gains meet the limits
  std::string refused;           ///< why there is no result; empty: there is one
  LoopMargins start_margins;
  LoopMargins tuned_margins;              ///< where found()
  LoopResponse start_loop;                ///< empty where the law has none
  LoopResponse tuned_loop;                ///< where found()
  std::vector<SmoothSpeed> start_smooth;  ///< per axis; empty: not looked for, or the loop is not stable
  std::vector<SmoothSpeed> tuned_smooth;  ///< the same where found()
  std::vector<TravelScore> before;        ///< per travel; empty where the start cannot be run
  std::vector<TravelScore> after;         ///< per travel; empty where no gains meet the limits
  std::string before_refused;             ///< why the start cannot be run
  std::vector<MachineScore> machines;     ///< of nearby_machines(); empty: the given one alone
  int evaluations = 0;                    ///< of J
  int tries = 0;                          ///< gains that were tried, by their margins or by a run

  [[nodiscard]] bool found() const noexcept { return !miss && refused.empty(); }
};

struct TuneResult {
  std::string machine;
  double period = 0.0;                  ///< [s]
  std::vector<std::string> axes;        ///< names
  std::vector<double> variation_limit;  ///< per travel [V]
  std::string reference;  ///< id of the controller whose variation is the limit; empty: a number was given
  std::vector<TunedController> controllers;
};

/// progress(done, all) may be called from any thread, one call at a time.
TuneResult tune(const Machine& machine, const std::vector<AxisKnowledge>& knowledge, const TuneSpec& spec,
                const std::function<void(std::size_t, std::size_t)>& progress = {});

/// Contour error against input variation: the same search under several shares of the limit of variation.
struct TradeOff {
  std::vector<double> shares;       ///< of the limit; empty: not looked for
  std::vector<TuneResult> results;  ///< of tune(), one for each share
};

/// What a rougher input buys. Each share is a search of its own.
TradeOff trade_off(const Machine& machine, const std::vector<AxisKnowledge>& knowledge, const TuneSpec& spec,
                   const std::vector<double>& shares,
                   const std::function<void(std::size_t, std::size_t)>& progress = {});

/// A number that the search may change.
struct Gain {
  std::string name;
  Quantity quantity;
  int time = 0;  ///< power of time in its unit: −2 for 1/s²
  double* value = nullptr;
};

/// The gains of a controller with this many axes, in the order of declaration; they point into it.
std::vector<Gain> gains_of(ControllerSpec& controller, std::size_t axes);

/// Makes a controller slower as a whole (share < 1): multiplies each gain by share to the power of 1/time in its unit.
ControllerSpec slowed(const ControllerSpec& controller, std::size_t axes, double share);

}  // namespace stribeck::sim

template <>
struct stribeck::EnumNames<stribeck::sim::TuneGoal> {
  static constexpr std::array names{
      std::pair{stribeck::sim::TuneGoal::kAccuracy, std::string_view{"accuracy"}},
      std::pair{stribeck::sim::TuneGoal::kSurface, std::string_view{"surface"}},
      std::pair{stribeck::sim::TuneGoal::kSpeed, std::string_view{"speed"}}};
};
