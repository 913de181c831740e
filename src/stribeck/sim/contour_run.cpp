#include <algorithm>
#include <span>
#include <stribeck/sim/contour_run.hpp>
#include <type_traits>

namespace stribeck::sim {
namespace {

constexpr int kLoopIsLost = 32;

/// Contour error and, where there is a tool axis, its error.
template <class Curve, std::size_t N>
std::array<double, 2> errors(const Curve& curve, const Vec<double, N>& position,
                             const Vec<double, N>& tracking, double phi) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if constexpr (N == 1) {
    return {tracking[0], kNone};
  } else if constexpr (path::ToolPath<Curve>) {
    const path::TipDeviation d = path::tip_deviation(curve, position, phi);
    return {d.contour, d.orientation};
  } else if constexpr (requires { curve.part; }) {
    return {curve.part->path.contour_error(position, phi), kNone};
  } else {
    return {path::contour_error(curve, position, phi), kNone};
  }
}

/// Forces of a controller at the k-th point; one that looks ahead gets the points that follow as well.
template <class Controller, std::size_t N>
Vec<double, N> asked_of(const Controller& controller, typename Controller::State& state,
                        const std::vector<path::PathPoint<N>>& points, std::size_t k,
                        const Vec<double, N>& encoder) {
  if constexpr (requires { Controller::kPreview; }) {
    const std::size_t seen = std::min(Controller::kPreview + 1, points.size() - k);
    return controller.step(state, std::span(points).subspan(k, seen), encoder);
  } else {
    return controller.step(state, points[k], encoder);
  }
}

/// Where to look for the nearest point of the path: at the reference, or behind it by the lag of a controller that slows down.
template <class State, std::size_t N>
double near_phi(const State& state, const std::vector<path::PathPoint<N>>& points, std::size_t k,
                double period) {
  if constexpr (std::is_same_v<State, typename control::Predictive<N>::State>) {
    const auto behind = static_cast<std::size_t>(state.lag / period + 0.5);
    return points[k - std::min(behind, k)].phi;
  } else {
    return points[k].phi;
  }
}

template <class Controller, class Curve, std::size_t N>
Metrics run_loop(std::vector<plant::Axis>& axes, const std::vector<double>& gain, double period,
                 const Controller& controller, const Curve& curve, const Route<N>& route,
                 std::vector<ContourSample>* seen, StatusCounter* status,
                 std::vector<control::Drift>* drift) {
  typename Controller::State state;
  GlitchWindow<N> glitch;
  MetricsCollector<N> metrics;
  for (std::size_t k = 0; k < route.points.size(); ++k) {
    const path::PathPoint<N>& r = route.points[k];
    const double t = static_cast<double>(k) * period;
    Vec<double, N> encoder;
    Vec<double, N> position;
    for (std::size_t i = 0; i < N; ++i) {
      encoder[i] = axes[i].encoder();
      position[i] = axes[i].position();
    }
    const Vec<double, N> tracking = position - r.position;
    const auto [error, orientation] =
        errors(curve, position, tracking, near_phi(state, route.points, k, period));
    const Vec<double, N> force = asked_of(controller, state, route.points, k, encoder);
    Vec<double, N> voltage;
    for (std::size_t i = 0; i < N; ++i) voltage[i] = force[i] / gain[i];
    const Vec<double, N> cutting = route.cutting.empty() ? Vec<double, N>{} : route.cutting[k];
    const bool in_glitch = glitch.step(r);
    const bool scored = t >= route.scored_from && t <= route.scored_to;
    if (seen != nullptr) {
      Vec<double, N> friction;
      for (std::size_t i = 0; i < N; ++i) friction[i] = axes[i].friction_force();
      seen->push_back({t,
                       r.phi,
                       widened(r.position),
                       widened(r.velocity),
                       widened(r.acceleration),
                       widened(position),
                       widened(encoder),
                       widened(voltage),
                       widened(force),
                       widened(friction),
                       widened(cutting),
                       {},
                       widened(r.frame * tracking),
                       error,
                       orientation,
                       scored});
    }
    if constexpr (N >= 2) {
      plant::Axis::step_together(axes[0], voltage[0], axes[1], voltage[1], cutting[0], cutting[1]);
      for (std::size_t i = 2; i < N; ++i) axes[i].step(voltage[i], cutting[i]);
    } else {
      axes[0].step(voltage[0], cutting[0]);
    }
    if (scored) {
      typename MetricsCollector<N>::Sample s{error, tracking, {}, {}, {}, in_glitch, orientation, 0.0};
      for (std::size_t i = 0; i < N; ++i) {
        s.voltage[i] = axes[i].voltage();
        s.current[i] = axes[i].current();
        s.power[i] = axes[i].power();
        s.mechanical_power += gain[i] * axes[i].voltage() * (axes[i].position() - position[i]) / period;
      }
      metrics.add(s);
    }
  }
  if (status != nullptr) *status = state.status;
  if (drift != nullptr) {
    drift->clear();
    for (const auto& c : state.compensation) {
      if (c.adaptation.informed)
        drift->push_back(control::DriftMonitor::report(c.drift, c.adaptation, period));
    }
  }
  return metrics.result();
}

}  // namespace

template <std::size_t N>
AnyController<N> make_controller(const control::LawParams& law, const control::Setup<N>& setup) {
  return std::visit(
      [&](const auto& params) -> AnyController<N> {
        return typename std::decay_t<decltype(params)>::template Controller<N>(params, setup);
      },
      law);
}

Drives::Drives(const Machine& machine, const std::vector<std::size_t>& which, double v_max)
    : period_(machine.sample_time) {
  for (const std::size_t i : which) {
    axes_.emplace_back(machine.axes[i].second.plant, machine.sample_time, v_max);
    gain_.push_back(machine.axes[i].second.plant.force_gain());
  }
}

double Drives::rate_bound() const {
  double fastest = 0.0;
  for (const plant::Axis& a : axes_) fastest = std::max(fastest, a.rate_bound());
  return fastest;
}

template <std::size_t N>
Metrics Drives::run(const AnyController<N>& controller, const Route<N>& route,
                    const plant::Fidelity& fidelity, std::uint64_t seed, std::uint32_t trial,
                    std::vector<ContourSample>* seen, StatusCounter* status,
                    std::vector<control::Drift>* drift) {
  for (std::uint32_t i = 0; i < N; ++i)
    axes_[i].start(route.points[0].position[i], fidelity, {seed, trial, i});
  if (seen != nullptr) seen->reserve(route.points.size());
  return std::visit(
      [&](const auto& law, const auto& curve) {
        if constexpr (std::decay_t<decltype(curve)>::kAxes == N) {
          return run_loop<std::decay_t<decltype(law)>>(axes_, gain_, period_, law, curve, route, seen, status,
                                                       drift);
        } else {
          return Metrics::unknown();
        }
      },
      controller, route.path);
}

template <std::size_t N>
int choose_substeps(Drives& drives, const AnyController<N>& controller, const Route<N>& route,
                    double accuracy) {
  // One lap and the run-in show every reversal there is.
  const double period = drives.period();
  Route<N> part = route;
  part.points.resize(std::min(static_cast<std::size_t>(route.first_lap / period) + 2, route.points.size()));
  if (!part.cutting.empty()) part.cutting.resize(part.points.size());
  const auto trace = [&](int substeps) {
    std::vector<ContourSample> seen;
    drives.run<N>(controller, part, {substeps, false, false}, 1, 0, &seen);
    return seen;
  };
  const double least = least_substeps(drives.rate_bound(), period);
  if (!(least <= kMostSubsteps)) {
    throw Refused(
        "the machine needs more than 512 sub-steps per control period for its fastest rate (friction "
        "stiffness and damping over mass, armature or axial mode); a shorter sample_time or a softer "
        "machine can be simulated");
  }
  const auto follows = [&](const std::vector<ContourSample>& run) {
    for (const ContourSample& s : run) {
      if (!(std::abs(s.contour_error) <= kLost * route.size)) return false;
    }
    return true;
  };
  bool followed = false;
  const auto judge = [&](int n, const auto& coarse, const auto& fine) {
    const bool follows_now = follows(coarse) && follows(fine);
    // Too few sub-steps can lose the path; when many lose it too, it is the loop.
    if (!follows_now && n >= kLoopIsLost) return Substeps::kGiveUp;
    followed = followed || follows_now;
    RunError error;
    for (std::size_t k = 0; k < coarse.size(); ++k)
      error.add(std::abs(fine[k].contour_error - coarse[k].contour_error));
    return error.within(accuracy) && follows_now ? Substeps::kEnough : Substeps::kMore;
  };
  if (const auto n = search_substeps(least, trace, judge)) return *n;
  if (!followed) {
    throw Refused(
        "the loop does not follow the path (error above a tenth of its extent): it is unstable or too slow "
        "with these gains, delay and sample_time");
  }
  throw Refused(
      "the contour error does not settle within the accuracy for up to 512 sub-steps: the loop is at the "
      "edge of stability, or the accuracy is finer than rounding allows");
}

#define STRIBECK_INSTANTIATE(N)                                                                              \
  template AnyController<N> make_controller<N>(const control::LawParams&, const control::Setup<N>&);         \
  template Metrics Drives::run<N>(const AnyController<N>&, const Route<N>&, const plant::Fidelity&,          \
                                  std::uint64_t, std::uint32_t, std::vector<ContourSample>*, StatusCounter*, \
                                  std::vector<control::Drift>*);                                             \
  template int choose_substeps<N>(Drives&, const AnyController<N>&, const Route<N>&, double);
STRIBECK_INSTANTIATE(1)
STRIBECK_INSTANTIATE(2)
STRIBECK_INSTANTIATE(3)
STRIBECK_INSTANTIATE(5)
#undef STRIBECK_INSTANTIATE

}  // namespace stribeck::sim
