#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <stribeck/plant/axis_group.hpp>
#include <stribeck/sim/contour_run.hpp>
#include <type_traits>

namespace stribeck::sim {
namespace {

constexpr int kLoopIsLost = 32;

ErrorSize size_of(const std::vector<ContourSample>& run) {
  ErrorSize size;
  for (const ContourSample& s : run) size.add(s.contour_error);
  return size;
}

/// Inputs and outputs of one tick.
template <std::size_t N>
struct Tick {
  double time = 0.0;
  Vec<double, N> encoder;
  Vec<double, N> position;  ///< true, of the table
  Vec<double, N> tracking;  ///< error of the table
  double error = 0.0;       ///< contour error
  double orientation = 0.0;
  Vec<double, N> force;
  Vec<double, N> command;  ///< voltage, or what the loop of the drive takes
  Vec<double, N> offset;   ///< force offset
  Vec<double, N> cutting;
  bool in_glitch = false;
  bool scored = false;
};

/// Contour error and, where there is a tool axis, its error. phi: start of the search for the nearest point of the path.
template <std::size_t N>
std::array<double, 2> errors(const AnyPath& path, const Vec<double, N>& position,
                             const Vec<double, N>& tracking, double phi) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  return std::visit(
      [&](const auto& curve) -> std::array<double, 2> {
        using Curve = std::decay_t<decltype(curve)>;
        if constexpr (Curve::kAxes != N) {
          return {kNone, kNone};
        } else if constexpr (N == 1) {
          return {tracking[0], kNone};
        } else if constexpr (path::ToolPath<Curve>) {
          const path::TipDeviation d = path::tip_deviation(curve, position, phi);
          return {d.contour, d.orientation};
        } else if constexpr (requires { curve.part; }) {
          return {curve.part->path.contour_error(position, phi), kNone};
        } else {
          return {path::contour_error(curve, position, phi), kNone};
        }
      },
      path);
}

/// The parameter of the reference, less the lag of a controller that slows down.
template <std::size_t N>
double near_phi(const LawRunner<N>& law, const std::vector<path::PathPoint<N>>& points, std::size_t k,
                double period) {
  const auto behind = static_cast<std::size_t>(law.lag() / period + 0.5);
  return points[k - std::min(behind, k)].phi;
}

template <std::size_t N>
ContourSample sample_of(const Tick<N>& tick, const path::PathPoint<N>& r,
                        const std::vector<plant::Axis>& axes) {
  Vec<double, N> friction;
  for (std::size_t i = 0; i < N; ++i) friction[i] = axes[i].friction_force();
  Vec<double, N> motor = control::spread<N>({}, Metrics::kUnknown);
  Vec<double, N> scale = motor;
  for (std::size_t i = 0; i < N; ++i)
    (axes[i].feedback() == plant::EncoderSide::kTable ? motor : scale)[i] = axes[i].second_encoder();
  return {tick.time,
          r.phi,
          widened(r.position),
          widened(r.velocity),
          widened(r.acceleration),
          widened(tick.position),
          widened(tick.encoder),
          widened(motor),
          widened(scale),
          widened(tick.command),
          widened(tick.force),
          widened(friction),
          widened(tick.cutting),
          {},
          widened(r.frame * tick.tracking),
          tick.error,
          tick.orientation,
          tick.scored};
}

template <std::size_t N>
void move_drives(std::vector<plant::Axis>& axes, const Tick<N>& tick) {
  const auto alone = [&](std::size_t i) { axes[i].step(tick.command[i], tick.cutting[i], tick.offset[i]); };
  std::size_t moved = 0;
  if (N >= 2 && !axes[0].has_loop() && !axes[1].has_loop()) {
    plant::Axis::step_together(axes[0], tick.command[0], axes[1], tick.command[1], tick.cutting[0],
                               tick.cutting[1]);
    moved = 2;
  }
  for (std::size_t i = moved; i < N; ++i) alone(i);
}

/// Mean forces of the past period as the drives report them; NaN where a drive does not [N].
template <std::size_t N>
Vec<double, N> reported(const std::vector<plant::Axis>& axes) {
  Vec<double, N> force;
  for (std::size_t i = 0; i < N; ++i)
    force[i] = axes[i].reports_force() ? axes[i].force() : Metrics::kUnknown;
  return force;
}

/// The force and voltage that the loops of the drives made, known only afterwards.
template <std::size_t N>
void note_loops(ContourSample& sample, const std::vector<plant::Axis>& axes) {
  for (std::size_t i = 0; i < N; ++i) {
    if (!axes[i].has_loop()) continue;
    sample.voltage[i] = axes[i].voltage();
    sample.force[i] = axes[i].force();
  }
}

/// What a tick begins with: the encoders, and the error of the table.
template <std::size_t N>
Tick<N> measured(const std::vector<plant::Axis>& axes, const AnyPath& path, const path::PathPoint<N>& r,
                 double time, double phi) {
  Tick<N> tick;
  tick.time = time;
  for (std::size_t i = 0; i < N; ++i) {
    tick.encoder[i] = axes[i].encoder();
    tick.position[i] = axes[i].position();
  }
  tick.tracking = tick.position - r.position;
  const auto [error, orientation] = errors<N>(path, tick.position, tick.tracking, phi);
  tick.error = error;
  tick.orientation = orientation;
  return tick;
}

/// What the law asks of the drives; `added`: forces beside its own, null: none.
template <std::size_t N>
void commanded(Tick<N>& tick, LawRunner<N>& law, std::span<const path::PathPoint<N>> points,
               const Vec<double, N>* added, const std::vector<plant::Axis>& axes,
               const std::vector<double>& gain) {
  law.acted(reported<N>(axes));
  tick.force = law.step_ahead(points, tick.encoder);
  if (added != nullptr) tick.force = tick.force + *added;
  tick.command = law.command();
  tick.offset = law.offset();
  for (std::size_t i = 0; i < N; ++i) {
    if (!axes[i].has_loop()) tick.command[i] = tick.force[i] / gain[i];
  }
}

/// Called after the drives have moved.
template <std::size_t N>
typename MetricsCollector<N>::Sample scored(const Tick<N>& tick, const std::vector<plant::Axis>& axes,
                                            double period) {
  typename MetricsCollector<N>::Sample s{tick.error,     tick.tracking,    {},  {},           {},
                                         tick.in_glitch, tick.orientation, 0.0, tick.position};
  for (std::size_t i = 0; i < N; ++i) {
    s.voltage[i] = axes[i].voltage();
    s.current[i] = axes[i].current();
    s.power[i] = axes[i].power();
    s.mechanical_power += axes[i].force() * (axes[i].position() - tick.position[i]) / period;
  }
  return s;
}

template <std::size_t N>
bool fits(const Route<N>& route) {
  return std::visit([](const auto& path) { return std::decay_t<decltype(path)>::kAxes; }, route.path) == N;
}

/// One run between its start and its figures, tick by tick.
template <std::size_t N>
class RunInProgress {
 public:
  /// The drives were started; they, their gains [N/V], the route and `seen` outlive the run. Null: no samples are kept.
  RunInProgress(const std::vector<plant::Axis>& axes, const std::vector<double>& gain, double period,
                const AnyController<N>& controller, const Route<N>& route, std::vector<ContourSample>* seen)
      : axes_(axes), gain_(gain), period_(period), route_(route), law_(controller->copy()), seen_(seen) {
    if (seen_ != nullptr) seen_->reserve(route_.points.size());
  }

  /// Until the drives move.
  void begin(std::size_t k) {
    const std::span<const path::PathPoint<N>> points = route_.points;
    const std::span<const path::PathPoint<N>> motors = route_.motors.empty() ? points : route_.motors;
    const path::PathPoint<N>& r = points[k];
    tick_ = measured<N>(axes_, route_.path, r, static_cast<double>(k) * period_,
                        near_phi(*law_, route_.points, k, period_));
    commanded<N>(tick_, *law_, motors.subspan(k), route_.added.empty() ? nullptr : &route_.added[k], axes_,
                 gain_);
    if (!route_.cutting.empty()) tick_.cutting = route_.cutting[k];
    tick_.in_glitch = glitch_.step(r);
    tick_.scored = tick_.time >= route_.scored_from && tick_.time <= route_.scored_to;
    if (seen_ != nullptr) seen_->push_back(sample_of(tick_, r, axes_));
  }
  /// After they have moved.
  void end() {
    if (seen_ != nullptr) note_loops<N>(seen_->back(), axes_);
    if (tick_.scored) metrics_.add(scored(tick_, axes_, period_));
  }

  [[nodiscard]] const Tick<N>& tick() const { return tick_; }
  [[nodiscard]] const LawRunner<N>& law() const { return *law_; }
  [[nodiscard]] Metrics result() const { return metrics_.result(); }

 private:
  const std::vector<plant::Axis>& axes_;
  const std::vector<double>& gain_;
  double period_;
  const Route<N>& route_;
  std::unique_ptr<LawRunner<N>> law_;
  std::vector<ContourSample>* seen_;
  GlitchWindow<N> glitch_;
  MetricsCollector<N> metrics_;
  Tick<N> tick_;
};

}  // namespace

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
  if (!fits(route)) return Metrics::unknown();
  start<N>(route.points[0].position, fidelity, seed, trial);
  RunInProgress<N> run(axes_, gain_, period_, controller, route, seen);
  for (std::size_t k = 0; k < route.points.size(); ++k) {
    run.begin(k);
    move_drives(axes_, run.tick());
    run.end();
  }
  if (status != nullptr) *status = run.law().status();
  if (drift != nullptr) *drift = run.law().drift(period_);
  return run.result();
}

template <std::size_t N>
std::vector<RunResult> Drives::run_together(std::span<const RunTogether<N>> runs, const Route<N>& route,
                                            std::uint64_t seed) {
  std::vector<RunResult> results(runs.size(), RunResult{Metrics::unknown(), {}});
  if (!fits(route)) return results;
  std::vector<RunInProgress<N>> running;
  std::vector<plant::Axis*> axes;
  running.reserve(runs.size());
  for (const RunTogether<N>& r : runs) {
    Drives& d = *r.drives;
    d.start<N>(route.points[0].position, r.fidelity, seed, r.trial);
    running.emplace_back(d.axes_, d.gain_, d.period_, r.controller, route, r.seen);
  }
  // The same axis of all machines side by side: such drives need about the same number of sub-steps.
  for (std::size_t i = 0; i < N; ++i) {
    for (const RunTogether<N>& r : runs) axes.push_back(&r.drives->axes_[i]);
  }
  plant::AxisGroup group(axes);
  std::vector<plant::AxisInput> inputs(axes.size());
  for (std::size_t k = 0; k < route.points.size(); ++k) {
    for (std::size_t m = 0; m < running.size(); ++m) {
      running[m].begin(k);
      const Tick<N>& tick = running[m].tick();
      for (std::size_t i = 0; i < N; ++i)
        inputs[i * runs.size() + m] = {tick.command[i], tick.cutting[i], tick.offset[i]};
    }
    group.step(inputs);
    for (RunInProgress<N>& r : running) r.end();
  }
  for (std::size_t m = 0; m < running.size(); ++m) {
    results[m] = {running[m].result(), running[m].law().status()};
    if (runs[m].drift != nullptr) *runs[m].drift = running[m].law().drift(runs[m].drives->period_);
  }
  return results;
}

template <std::size_t N>
void Drives::start(const Vec<double, N>& position, const plant::Fidelity& fidelity, std::uint64_t seed,
                   std::uint32_t trial) {
  for (std::uint32_t i = 0; i < N; ++i) axes_[i].start(position[i], fidelity, {seed, trial, i});
}

template <std::size_t N>
ContourSample Drives::tick(LawRunner<N>& law, const AnyPath& path, std::span<const path::PathPoint<N>> points,
                           double time, double phi) {
  Tick<N> tick = measured<N>(axes_, path, points.front(), time, phi);
  commanded<N>(tick, law, points, nullptr, axes_, gain_);
  ContourSample sample = sample_of(tick, points.front(), axes_);
  move_drives(axes_, tick);
  note_loops<N>(sample, axes_);
  return sample;
}

template <std::size_t N>
int choose_substeps(Drives& drives, const AnyController<N>& controller, const Route<N>& route,
                    double accuracy, bool* repeatable) {
  // One lap and the run-in contain every kind of reversal.
  const double period = drives.period();
  Route<N> part = route;
  part.points.resize(std::min(static_cast<std::size_t>(route.first_lap / period) + 2, route.points.size()));
  if (!part.cutting.empty()) part.cutting.resize(part.points.size());
  if (!part.motors.empty()) part.motors.resize(part.points.size());
  if (!part.added.empty()) part.added.resize(part.points.size());
  StatusCounter status;  // of the last run
  const auto trace = [&](int substeps) {
    std::vector<ContourSample> seen;
    status = {};
    drives.run<N>(controller, part, {substeps, false, false}, 1, 0, &seen, &status);
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
  double at_limit = 0.0;  // share of the ticks
  std::optional<int> acceptable;
  const auto judge = [&](int n, const auto& coarse, const auto& fine) {
    const bool follows_now = follows(coarse) && follows(fine);
    at_limit = static_cast<double>(status.count(Status::kOutputLimited)) / static_cast<double>(coarse.size());
    // Too few sub-steps may lose the path; if many sub-steps lose it too, the loop does.
    if (!follows_now && n >= kLoopIsLost) return Substeps::kGiveUp;
    followed = followed || follows_now;
    RunError error;
    for (std::size_t k = 0; k < coarse.size(); ++k)
      error.add(std::abs(fine[k].contour_error - coarse[k].contour_error));
    // A loop that swings between the limits of its drive is unstable, however alike its swings are.
    const bool swings = at_limit > kMostAtLimit;
    if (follows_now && !swings && !acceptable && n >= kManySubsteps && size_of(coarse).alike(size_of(fine)))
      acceptable = n;
    return error.within(accuracy) && follows_now ? Substeps::kEnough : Substeps::kMore;
  };
  if (const auto n = search_substeps(least, trace, judge)) return *n;
  if (acceptable) {
    if (repeatable != nullptr) *repeatable = false;
    return *acceptable;
  }
  if (!followed) {
    constexpr double kOften = 0.2;
    if (at_limit > kOften) {
      throw Refused(
          "the loop does not follow the path (error above a tenth of its extent), and drives are at the limit of their force: the path "
          "needs more force than they have, or the loop is unstable; a lower speed tells which");
    }
    throw Refused(
        "the loop does not follow the path (error above a tenth of its extent): it is unstable or too slow "
        "with these gains, delay and sample_time");
  }
  throw Refused(
      "the contour error does not settle within the accuracy for up to 512 sub-steps: the loop is at the "
      "edge of stability, or the accuracy is finer than rounding allows");
}

#define STRIBECK_INSTANTIATE(N)                                                                              \
  template Metrics Drives::run<N>(const AnyController<N>&, const Route<N>&, const plant::Fidelity&,          \
                                  std::uint64_t, std::uint32_t, std::vector<ContourSample>*, StatusCounter*, \
                                  std::vector<control::Drift>*);                                             \
  template std::vector<RunResult> Drives::run_together<N>(std::span<const RunTogether<N>>, const Route<N>&,  \
                                                          std::uint64_t);                                    \
  template void Drives::start<N>(const Vec<double, N>&, const plant::Fidelity&, std::uint64_t,               \
                                 std::uint32_t);                                                             \
  template ContourSample Drives::tick<N>(LawRunner<N>&, const AnyPath&, std::span<const path::PathPoint<N>>, \
                                         double, double);                                                    \
  template int choose_substeps<N>(Drives&, const AnyController<N>&, const Route<N>&, double, bool*);
STRIBECK_INSTANTIATE(1)
STRIBECK_INSTANTIATE(2)
STRIBECK_INSTANTIATE(3)
STRIBECK_INSTANTIATE(5)
#undef STRIBECK_INSTANTIATE

}  // namespace stribeck::sim
