#pragma once
/// The main experiment: several controllers on one machine along one path, at several speeds, over several
/// trials.
///
/// Every trial has its own noise, the same for every controller, so that controllers are compared under equal conditions.
/// Runs are spread over threads; the result does not depend on their number.
/// Real time: no.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stribeck/control/compensation/lost_motion_params.hpp>
#include <stribeck/sim/contour_run.hpp>

namespace stribeck::sim {

/// The model of an axis that a controller feeds forward.
enum class FrictionUse {
  kNone,
  kViscous,  ///< the viscous part of the conventional model
  kConventional,
  kGaussian,
  kEccentric,
  kWhole,    ///< everything that was identified together: map, periodic terms, bristles
  kNominal,  ///< the straight line through each side of the eccentric model's map: Γ, Λ of adaptive friction
};

}  // namespace stribeck::sim

template <>
struct stribeck::EnumNames<stribeck::sim::FrictionUse> {
  using enum stribeck::sim::FrictionUse;
  static constexpr std::array names{std::pair{kNone, std::string_view{"none"}},
                                    std::pair{kViscous, std::string_view{"viscous"}},
                                    std::pair{kConventional, std::string_view{"conventional"}},
                                    std::pair{kGaussian, std::string_view{"gaussian"}},
                                    std::pair{kEccentric, std::string_view{"eccentric"}},
                                    std::pair{kWhole, std::string_view{"whole"}},
                                    std::pair{kNominal, std::string_view{"nominal"}}};
};

namespace stribeck::sim {

/// A control law with its feed-forward and its observer.
struct ControllerSpec : control::CompensationSettings<control::PerAxis> {
  std::string id;
  std::string label;
  FrictionUse friction = FrictionUse::kNone;
  control::LawParams law{};
  bool lost_motion = true;  ///< compensate it where it is known

  ControllerSpec() : ControllerSpec({}, {}, FrictionUse::kNone, control::Observer::kNone) {}
  ControllerSpec(std::string its_id, std::string its_label, FrictionUse use, control::Observer added,
                 control::LawParams its_law = {})
      : id(std::move(its_id)), label(std::move(its_label)), friction(use), law(std::move(its_law)) {
    feedforward = control::Feedforward::kSteady;
    observer = added;
  }

  static constexpr auto fields() {
    using S = ControllerSpec;
    return std::tuple_cat(
        std::tuple{field("id", &S::id, "short name, at most 16 letters, digits and hyphens"),
                   field("label", &S::label, "what it is, in words"),
                   field("friction", &S::friction,
                         "which identified model is fed forward: none, viscous, conventional, gaussian, "
                         "eccentric, whole (with pre-sliding) or nominal")
                       .or_default()},
        std::apply(
            [](const auto& feedforward_field, const auto&... rest) {
              return std::tuple{feedforward_field.template of<S>().when(
                                    [](const S& s) { return s.friction != FrictionUse::kNone; },
                                    "goes with a friction model (friction other than \"none\")"),
                                rest...};
            },
            CompensationSettings::fields()),
        std::tuple{field("law", &S::law, "control law with its gains"),
                   field("lost_motion", &S::lost_motion,
                         "compensate backlash and wind-up of axes whose axis file (or log) tells them")
                       .or_default()});
  }
  template <class Report>
  void validate(Report&& report) const {
    constexpr std::string_view kPermitted = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-";
    if (id.empty() || id.size() > 16 || id.find_first_not_of(kPermitted) != std::string::npos)
      report("id", "expected 1 to 16 letters, digits and hyphens, e.g. pid");
    if (label.empty() || label.size() > 60) report("label", "expected 1 to 60 characters");
    CompensationSettings::validate(report);
    if (looks_ahead() && friction == FrictionUse::kViscous)
      report("feedforward",
             "dynamic and reversal need a friction model with a level: friction = \"whole\" or \"gaussian\"");
    std::visit(
        [&](const auto& params) {
          if constexpr (requires { params.error_rate; }) {
            if (!control::rate_is_known(params.error_rate, observer))
              report("law.error_rate", control::kRateIsUnknown);
          }
        },
        law);
  }
};

/// (a) none, (b) conventional, (c) Gaussian, (d) observer, (e) observer + conventional, (f) observer +
/// Gaussian, all with the given law and observer.
std::vector<ControllerSpec> biaxial_controllers(
    const control::LawParams& law = control::ContouringParams::critical(40.0, 40.0),
    control::Observer observer = control::Observer::kDisturbance, double observer_pole = 20.0);

/// Models of one axis, from identification or from the thesis.
struct AxisKnowledge {
  std::optional<friction::AxisModel> conventional{};
  std::optional<friction::AxisModel> gaussian{};
  std::optional<friction::AxisModel> eccentric{};
  std::optional<friction::AxisModel> whole{};
  std::optional<control::LostMotionParams>
      lost_motion{};  ///< between the motor, which the control sees, and the table

  /// The model that a controller with this use gets; for kNone, mass and load of the best model. Throws Refused when there is no
  /// such model, naming the axis.
  [[nodiscard]] friction::AxisModel model(FrictionUse use, const std::string& axis) const;
  /// The model that says most; null where there is none.
  [[nodiscard]] const friction::AxisModel* best() const {
    for (const auto* m : {&whole, &gaussian, &eccentric, &conventional}) {
      if (*m) return &**m;
    }
    return nullptr;
  }
};

struct CompareSpec {
  std::vector<Travel> travels;    ///< the same path at several speeds, or one
  std::vector<std::size_t> axes;  ///< of the machine, in the order of the path's axes; empty: the first ones
  std::vector<ControllerSpec> controllers;
  std::uint32_t trials = 10;
  std::uint64_t seed = 1;
  double accuracy = 1e-9;  ///< of the simulated contour error, quantisers off [m]
  unsigned threads = 0;    ///< 0: as many as the machine has
};

/// One controller on one travel.
struct CompareRow {
  ControllerSpec controller;
  std::size_t travel = 0;       ///< index into the spec's travels
  double speed = 0.0;           ///< along the path [m/s]; NaN where the law of motion is not one of speed
  Metrics mean;                 ///< over the trials
  Metrics spread;               ///< standard deviation over the trials; NaN for a single trial
  std::vector<Metrics> trials;  ///< results of the single trials
  std::vector<ContourSample> trace;   ///< of the first trial
  StatusCounter status;               ///< of all trials together
  std::vector<control::Drift> drift;  ///< per axis, at the end of the first trial; empty without adaptation
  int substeps = 0;
  std::vector<std::size_t> calmed;  ///< axes without the Kalman observer of the controller, see calm()
  bool repeatable = true;           ///< false: the loop multiplies every difference (choose_substeps())
  std::string refused;              ///< why there is no result, and what would help; empty otherwise
};

struct CompareResult {
  std::string machine;
  CompareSpec spec;
  double period = 0.0;  ///< [s]
  std::vector<std::string> axes;
  std::vector<CompareRow> rows;  ///< travel by travel, controller by controller
};

/// progress(done, all) may be called from any thread, one call at a time. A row whose run would mean nothing says so and has no
/// figures. Throws Refused when that is so for every row.
CompareResult compare(const Machine& machine, const std::vector<AxisKnowledge>& knowledge,
                      const CompareSpec& spec,
                      const std::function<void(std::size_t, std::size_t)>& progress = {});

/// A single trial of the first controller on the first travel, as compare() runs it; other travels count for the largest speed alone.
CompareResult run_once(const Machine& machine, const std::vector<AxisKnowledge>& knowledge,
                       const CompareSpec& spec, std::uint32_t trial);

/// Γ sgn v + Λ v: the least-squares line through each side of a map, over the speeds of the axis up to `fastest` [m/s]. A model
/// without a Stribeck part that is fitted to friction with one gives this result (Table 4.3). A spring and an unbalance stay: they are no friction.
friction::Model straightened(const friction::Model& model, double fastest);

/// The feed-forward that a controller gets with this model. A dynamic law without bristles is a step at the reversal; the controller that
/// adapts, which is the default, then lets friction build up over a distance (decision 0008). Others do what they are told.
control::Feedforward feedforward_with(const ControllerSpec& which, const friction::AxisModel& model);

/// Data of the chosen axes that a controller in compare() may use.
template <std::size_t N>
control::Setup<N> make_setup(const Machine& machine, const std::vector<AxisKnowledge>& knowledge,
                             const std::vector<std::size_t>& axes, const ControllerSpec& which);

/// A delay takes the margin of a Kalman observer, also one that the models know: the feed-forward comes earlier by it, the feedback
/// cannot. Where the loop of a controller that adapts then has a gain margin below 2.5 dB, the axes that are
/// late begin with the disturbance observer, which the guard would put there after some swings. Returns these axes.
template <std::size_t N>
std::vector<std::size_t> calm(control::Setup<N>& setup, const ControllerSpec& which);

/// Whether this controller compensates the lost motion of an axis: where it is known, and the loop closes over the motor.
bool guides(const MachineAxis& axis, const AxisKnowledge& knowledge, const ControllerSpec& which);
/// The route with the set-points of the motors where a controller compensates lost motion (lost_motion_move.hpp), else the same route.
template <std::size_t N>
std::shared_ptr<const Route<N>> guide_motors(const std::shared_ptr<const Route<N>>& route,
                                             const Machine& machine,
                                             const std::vector<AxisKnowledge>& knowledge,
                                             const std::vector<std::size_t>& axes,
                                             const ControllerSpec& which, const control::Setup<N>& setup);

/// Sub-steps for a controller on a route, as compare() finds them.
template <std::size_t N>
int substeps_for(Drives& drives, const control::Setup<N>& setup, const ControllerSpec& which,
                 const Route<N>& route, double accuracy, bool* repeatable = nullptr);

/// The axes of a spec: spec.axes, or the first ones. Throws Refused when the machine has too few.
std::vector<std::size_t> chosen_axes(const Machine& machine, const CompareSpec& spec);

}  // namespace stribeck::sim
