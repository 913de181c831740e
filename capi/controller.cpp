#include "controller.hpp"

#include <cmath>
#include <memory>
#include <new>

using namespace stribeck;
using capi::Controller;
using capi::good;
using capi::with;

namespace {

/// Below this speed the frame of the path is kept [m/s].
constexpr double kSlowest = 1e-5;
/// Largest rate at which a frame turns, as a share of the loop's lowest natural frequency.
constexpr double kTurning = 0.25;
/// Sliding mode: default bound of the error of the mass, as a share of the mass.
constexpr double kMassBound = 0.1;

constexpr std::string_view kAxis[] = {"axis 0: ", "axis 1: ", "axis 2: "};

Value initial_settings() noexcept { return initial_of(type_of<capi::AxisSettings>); }

/// The gains of an axis, for any law.
double kp_of(const capi::AxisSettings& s) noexcept { return s.kp.value_or(s.omega * s.omega); }
double kv_of(const capi::AxisSettings& s) noexcept { return s.kv.value_or(2.0 * s.omega); }

/// (ω·T)² of the slowest loop that is taken: below it the test of stability has no digits left.
constexpr double kSlowestLoop = 1e-10;

/// One element of a law's list: the value that was set, or the law's default for this direction.
void put(control::PerAxis& list, const control::PerAxis& otherwise, std::size_t i,
         const std::optional<double>& set) {
  list.push_back(set.value_or(otherwise[std::min(i, otherwise.size() - 1)]));
}

/// The parameters of a law from those of all axes. Calls refuse(axis, key, what) where they contradict each other.
template <std::size_t N, class Refuse>
void gather(const Controller<N>& c, double period, control::ContouringParams& p, Refuse&& refuse) {
  p.kp.clear();
  p.kv.clear();
  for (std::size_t i = 0; i < N; ++i) {
    p.kp.push_back(kp_of(c.settings[i]));
    p.kv.push_back(kv_of(c.settings[i]));
    const bool too_slow = p.kp[i] * period * period < kSlowestLoop;
    if (too_slow || !control::sampled_loop_stable(p.kp[i], p.kv[i], 0.0, period))
      refuse(i, c.settings[i].kp || c.settings[i].kv ? "kp" : "omega",
             too_slow ? "too slow at this period" : "unstable at this period");
  }
}

/// Refuses gains that a law does not have.
template <std::size_t N, class Refuse>
void refuse_gains(const Controller<N>& c, std::string_view what, Refuse&& refuse) {
  for (std::size_t i = 0; i < N; ++i) {
    if (c.settings[i].kp) refuse(i, "kp", what);
    if (c.settings[i].kv) refuse(i, "kv", what);
  }
}

template <std::size_t N, class Refuse>
void gather(const Controller<N>& c, double period, control::SlidingModeParams& p, Refuse&& refuse) {
  refuse_gains(c, "the sliding-mode law has no such gain: set omega, or lambda and a", refuse);
  const control::SlidingModeParams initial;
  for (control::PerAxis* list :
       {&p.lambda, &p.a, &p.gamma, &p.mass_bound, &p.force_bound, &p.gamma_least, &p.gamma_most})
    list->clear();
  Vec<double, N> masses;
  Vec<double, N> bounds;
  for (std::size_t i = 0; i < N; ++i) {
    const auto& law = std::get<capi::SlidingModeLaw>(c.settings[i].law);
    const double omega = c.settings[i].omega;
    const double mass = c.settings[i].compensation.model.mass;
    p.lambda.push_back(law.lambda.value_or(omega));
    p.a.push_back(law.a.value_or(omega));
    if (!control::sampled_loop_stable(p.lambda[i] * p.a[i], p.lambda[i] + p.a[i], 0.0, period))
      refuse(i, law.lambda || law.a ? "sliding-mode.lambda" : "omega", "unstable at this period");
    put(p.gamma, initial.gamma, i, law.gamma);
    put(p.force_bound, initial.force_bound, i, law.force_bound);
    put(p.gamma_least, initial.gamma_least, i, law.gamma_least);
    put(p.gamma_most, initial.gamma_most, i, law.gamma_most);
    const double bound = law.mass_bound.value_or(kMassBound * mass);
    p.mass_bound.push_back(bound);
    if (!(bound < mass)) refuse(i, "sliding-mode.mass_bound", "expected less than the mass");
    if (p.gamma_least[i] > p.gamma_most[i])
      refuse(i, "sliding-mode.gamma_most", "expected at least gamma_least");
    masses[i] = mass;
    bounds[i] = bound;
  }
  if (p.gain == control::SwitchingGain::kSufficient && !control::sufficient_gain_exists(masses, bounds)) {
    refuse(0, "sliding-mode.gain",
           "none is sufficient: mass_bound/(mass - mass_bound), summed over the axes, must be below 1");
  }
}

template <std::size_t N, class Refuse>
void gather(const Controller<N>& c, double period, control::PredictiveParams& p, Refuse&& refuse) {
  refuse_gains(c, "the predictive law has no such gain: set omega", refuse);
  p.omega = c.settings[0].omega;
  p.speed_limit.clear();
  for (std::size_t i = 0; i < N; ++i) {
    if (c.settings[i].omega != p.omega)
      refuse(i, "omega", "expected the same omega on all axes for the predictive law");
    p.speed_limit.push_back(std::get<capi::PredictiveLaw>(c.settings[i].law)
                                .speed_limit.value_or(std::numeric_limits<double>::infinity()));
  }
  if (!p.stable(period)) refuse(0, "omega", "unstable at this period");
}

template <std::size_t N, class Refuse>
void gather(const Controller<N>& c, double period, control::LearningParams& p, Refuse&& refuse) {
  p.kp.clear();
  p.kv.clear();
  const auto lap = std::get<capi::LearningLaw>(c.settings[0].law).lap;
  if (!lap) refuse(0, "learning.lap", "not set");
  for (std::size_t i = 0; i < N; ++i) {
    p.kp.push_back(kp_of(c.settings[i]));
    p.kv.push_back(kv_of(c.settings[i]));
    if (std::get<capi::LearningLaw>(c.settings[i].law).lap != lap)
      refuse(i, "learning.lap", "not that of axis 0");
  }
  if (!p.stable(period))
    refuse(0, "omega", "the loop is unstable at this period, or learning does not converge");
}

/// Checks the parameters of all axes for a law together, then starts the law.
template <std::size_t I, std::size_t N>
stribeck_result start(Controller<N>& c, double period) {
  using Settings = std::variant_alternative_t<I, capi::LawSettings>;
  using Law = capi::LawAt<N, I>;
  static_assert(Law::Params::kKind == Settings::kKind);
  bool sound = true;
  const auto refuse = [&](std::size_t axis, std::string_view key, std::string_view what) {
    if (!sound) return;
    sound = false;
    c.problem.set({kAxis[axis], key, ": ", what});
  };
  typename Law::Params params;
  if constexpr (requires { Settings::shared; }) {
    params = std::get<I>(c.settings[0].law).shared;
    for (std::size_t i = 1; i < N; ++i) {
      if (!same(value_of(std::get<I>(c.settings[0].law).shared),
                value_of(std::get<I>(c.settings[i].law).shared)))
        refuse(i, Settings::kKind, "what is not per axis must be the same on all axes");
    }
  }
  gather(c, period, params, refuse);
  if (sound && sizeof(capi::Running<Law>) > c.room)
    refuse(0, "law", "needs more memory: stribeck_controller_size_for()");
  if (!sound) return STRIBECK_REFUSED;
  params.error_rate = c.settings[0].error_rate;

  c.period = period;
  c.setup.period = period;
  if constexpr (std::is_same_v<Settings, capi::LearningLaw>)
    c.setup.lap = *std::get<I>(c.settings[0].law).lap;
  double slowest = std::numeric_limits<double>::infinity();
  double softest = slowest;
  control::Supervision<N> supervision;
  for (std::size_t i = 0; i < N; ++i) {
    const capi::AxisSettings& s = c.settings[i];
    slowest = std::min(slowest, std::sqrt(kp_of(s)));
    softest = std::min(softest, std::sqrt(kp_of(s)));
    if constexpr (std::is_same_v<Settings, capi::SlidingModeLaw>) {
      const double a = params.a[i] > 0.0 ? params.a[i] : params.lambda[i];
      slowest = std::min(slowest, std::min(params.lambda[i], a));
      softest = std::min(softest, std::sqrt(params.lambda[i] * a));
    }
    c.setup.compensation[i] = s.compensation;
    c.setup.force_limit[i] = s.force_limit.value_or(std::numeric_limits<double>::infinity());
    supervision[i] = s.supervision;
  }
  // Any axis may be moved by the softest of the gains along and across the path.
  for (control::SupervisionParams& p : supervision) {
    if (!p.omega) p.omega = softest;
  }
  c.supervisor = control::Supervisor<N>(supervision, c.setup);
  c.drives = control::DriveInterface<N>(c.setup);
  std::construct_at(&c.watch);
  ::new (capi::place_of<Law>(c)) capi::Running<Law>{Law(params, c.setup), {}};
  c.law = I;
  if constexpr (N > 1) c.frame.of_motion = path::MotionFrame<N>(period, kSlowest, kTurning * slowest);
  stribeck_controller_reset(&c);
  return STRIBECK_OK;
}

template <std::size_t N>
stribeck_result configure(Controller<N>& c, double period) {
  for (std::size_t i = 0; i < N; ++i) {
    const bool sound = capi::check(value_of(c.settings[i]), [&](std::string_view key, std::string_view what) {
      c.problem.set({kAxis[i], key, ": ", what});
    });
    if (!sound) return STRIBECK_REFUSED;
    if (!control::delay_fits(c.settings[i].compensation.model.delay_or_none(), period)) {
      c.problem.set({kAxis[i], "delay: longer than eight periods"});
      return STRIBECK_REFUSED;
    }
    const friction::AxisModel& model = c.settings[i].compensation.model;
    if (c.settings[i].force_limit && !model.drive_loop &&
        std::abs(model.load) >= *c.settings[i].force_limit) {
      c.problem.set({kAxis[i], "load: must be smaller than force_limit, otherwise the drive cannot hold it"});
      return STRIBECK_REFUSED;
    }
    if (!control::rate_is_known(c.settings[0].error_rate, c.settings[i].compensation.observer)) {
      c.problem.set({kAxis[i], "error_rate: ", control::kRateIsUnknown});
      return STRIBECK_REFUSED;
    }
    if (c.settings[i].law.index() != c.settings[0].law.index()) {
      c.problem.set({kAxis[i], "law: not that of axis 0"});
      return STRIBECK_REFUSED;
    }
  }
  stribeck_result result = STRIBECK_REFUSED;
  const auto one = [&](auto index) {
    if (c.settings[0].law.index() == index) result = start<index>(c, period);
  };
  [&]<std::size_t... I>(std::index_sequence<I...>) { (one(std::integral_constant<std::size_t, I>{}), ...); }
  (std::make_index_sequence<capi::kLaws>());
  return result;
}

}  // namespace

extern "C" {

std::uint32_t stribeck_abi(void) noexcept { return STRIBECK_ABI; }

std::uint32_t stribeck_capabilities(void) noexcept {
  return STRIBECK_HAS_CONTOURING | STRIBECK_HAS_DYNAMIC_FEEDFORWARD | STRIBECK_HAS_REVERSAL_FEEDFORWARD |
         STRIBECK_HAS_DISTURBANCE_OBSERVER | STRIBECK_HAS_KALMAN_OBSERVER | STRIBECK_HAS_ADAPTIVE_FRICTION |
         STRIBECK_HAS_FRICTION_ADAPTATION | STRIBECK_HAS_SLIDING_MODE | STRIBECK_HAS_PREDICTIVE |
         STRIBECK_HAS_LEARNING | STRIBECK_HAS_SUPERVISION | STRIBECK_HAS_DRIVE_LOOPS;
}

const char* stribeck_version(void) noexcept { return STRIBECK_VERSION; }

const char* stribeck_describe(stribeck_result r) noexcept {
  switch (r) {
    case STRIBECK_OK:
      return "done";
    case STRIBECK_BAD_HANDLE:
      return "no handle: null, or memory that was not initialised";
    case STRIBECK_BAD_ARGUMENT:
      return "an index too high, a null pointer, or a period that is no time";
    case STRIBECK_UNKNOWN_NAME:
      return "no parameter has this name";
    case STRIBECK_OUT_OF_RANGE:
      return "the value is out of range";
    case STRIBECK_NOT_SELECTED:
      return "belongs to a kind that is not chosen; choose it first";
    case STRIBECK_REFUSED:
      return "the parameters mean nothing together";
    case STRIBECK_NOT_CONFIGURED:
      return "configure first";
    case STRIBECK_NOT_FINITE:
      return "an input was not a finite number, or numbers overflowed";
    case STRIBECK_NO_MEMORY:
      return "out of memory";
    case STRIBECK_FAULT:
      return "supervision has stopped the axes; stribeck_controller_supervision() tells why";
    default:
      return "unknown result";
  }
}

const char* stribeck_fault_name(std::int32_t f) noexcept {
  return f < 0 || f >= STRIBECK_FAULTS ? nullptr : control::name_of(static_cast<control::Fault>(f)).data();
}

const char* stribeck_fault_describe(std::int32_t f) noexcept {
  return f < 0 || f >= STRIBECK_FAULTS ? "unknown fault"
                                       : control::describe(static_cast<control::Fault>(f)).data();
}

std::size_t stribeck_alignment(void) noexcept { return alignof(Controller<3>); }

std::size_t stribeck_controller_size(std::uint32_t axes) noexcept {
  return stribeck_controller_size_for(axes, capi::ContouringLaw::kKind.data());
}

std::size_t stribeck_controller_size_for(std::uint32_t axes, const char* law) noexcept {
  if (axes < 1 || axes > STRIBECK_MAX_AXES || law == nullptr) return 0;
  return capi::with_axes(axes, [&](auto n) {
    std::size_t size = 0;
    const auto one = [&](auto index) {
      using Law = capi::LawAt<n, index>;
      if (Law::Params::kKind == law) size = sizeof(Controller<n>) + sizeof(capi::Running<Law>);
    };
    [&]<std::size_t... I>(std::index_sequence<I...>) { (one(std::integral_constant<std::size_t, I>{}), ...); }
    (std::make_index_sequence<capi::kLaws>());
    return size;
  });
}

stribeck_controller* stribeck_controller_init(void* memory, std::size_t size, std::uint32_t axes) noexcept {
  const std::size_t needed = stribeck_controller_size(axes);
  if (memory == nullptr || needed == 0 || size < needed ||
      reinterpret_cast<std::uintptr_t>(memory) % stribeck_alignment() != 0)
    return nullptr;
  return capi::with_axes(axes, [&](auto n) -> stribeck_controller* {
    auto* c = ::new (memory) Controller<n>();
    c->axes = axes;
    c->room = size - sizeof *c;
    return c;
  });
}

stribeck_result stribeck_controller_parameter(std::uint32_t index, stribeck_parameter* out) noexcept {
  return capi::parameter_at(initial_settings(), index, out);
}

const char* stribeck_controller_parameter_word(const char* name, std::uint32_t index) noexcept {
  return capi::word_at(initial_settings(), name, index);
}

stribeck_result stribeck_controller_set(stribeck_controller* c, std::uint32_t axis, const char* name,
                                        double value) noexcept {
  if (!good(c)) return STRIBECK_BAD_HANDLE;
  if (axis >= c->axes)
    return capi::bad_argument(c, "axis: expected a number below that of the axes of the controller");
  return with(c, [&](auto& whole) {
    return capi::set_parameter(target_of(whole.settings[axis]), name, value, kAxis[axis], whole.problem);
  });
}

stribeck_result stribeck_controller_choose(stribeck_controller* c, std::uint32_t axis, const char* name,
                                           const char* word) noexcept {
  if (!good(c)) return STRIBECK_BAD_HANDLE;
  if (axis >= c->axes)
    return capi::bad_argument(c, "axis: expected a number below that of the axes of the controller");
  return with(c, [&](auto& whole) {
    return capi::choose_parameter(target_of(whole.settings[axis]), name, word, kAxis[axis], whole.problem);
  });
}

stribeck_result stribeck_controller_configure(stribeck_controller* c, double period) noexcept {
  if (!good(c)) return STRIBECK_BAD_HANDLE;
  if (!(period >= capi::kShortestPeriod && period < 1.0)) return capi::bad_argument(c, capi::kPeriodExpected);
  return with(c, [&](auto& whole) { return configure(whole, period); });
}

const char* stribeck_controller_problem(const stribeck_controller* c) noexcept {
  return good(c) ? c->problem.text() : stribeck_describe(STRIBECK_BAD_HANDLE);
}

}  // extern "C"
