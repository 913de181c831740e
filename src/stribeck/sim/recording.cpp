#include <algorithm>
#include <cmath>
#include <limits>
#include <stribeck/control/drive_interface.hpp>
#include <stribeck/sim/contour_run.hpp>
#include <stribeck/sim/recording.hpp>

namespace stribeck::sim {
namespace {

/// Logs have their own random streams, so that no experiment has the noise of the log from which its compensator was
/// identified.
constexpr std::uint32_t kClosedLoopTrial = 0x10000;
constexpr std::uint32_t kOpenLoopTrial = 0x20000;

/// What goes to the drive at a tick.
struct Output {
  double force = 0.0;    ///< wanted [N]
  double command = 0.0;  ///< of a drive with a loop of its own [m/s] or [m]
  double offset = 0.0;   ///< force beside it [N]
};

/// The output at tick k for an encoder position. The log of a drive with a loop of its own has the force that its loop made.
template <class Control>
Recording record(const Machine& machine, std::size_t which, std::size_t rows, double start,
                 const plant::Fidelity& fidelity, const plant::Stream& stream, Control&& control) {
  const MachineAxis& axis = machine.axes[which].second;
  plant::Axis plant(axis.plant, machine.sample_time, axis.limits.speed);
  plant.start(start, fidelity, stream);
  const double gain = axis.plant.force_gain();
  Recording log;
  log.period = machine.sample_time;
  for (auto* column : {&log.t, &log.x, &log.u, &log.f}) column->reserve(rows);
  std::vector<double>& second = axis.plant.encoder.side == plant::EncoderSide::kTable ? log.motor : log.scale;
  for (std::size_t k = 0; k < rows; ++k) {
    const double x = plant.encoder();
    if (axis.plant.second_encoder) second.push_back(plant.second_encoder());
    const Output out = control(k, x);
    plant.step(plant.has_loop() ? out.command : out.force / gain, 0.0, out.offset);
    const double f = plant.has_loop() ? plant.force() : out.force;
    log.t.push_back(static_cast<double>(k) * machine.sample_time);
    log.x.push_back(x);
    log.u.push_back(plant.has_loop() ? plant.voltage() : f / gain);
    log.f.push_back(f);
  }
  return log;
}

/// Distances from the reference.
ErrorSize tracking_error(const Recording& run, const std::vector<double>& reference) {
  ErrorSize size;
  for (std::size_t k = 0; k < run.x.size(); ++k) size.add(run.x[k] - reference[k]);
  return size;
}

/// Whether the drive is hardly ever at its limit.
bool below_limit(const Recording& run, double limit) {
  const auto limited = std::count_if(run.f.begin(), run.f.end(),
                                     [&](double f) { return std::abs(f) >= (1.0 - 1e-9) * limit; });
  return static_cast<double>(limited) <= kMostAtLimit * static_cast<double>(run.f.size());
}

/// Weaker demands on an open loop that multiplies errors: a share of the travel so far, with many sub-steps before that.
constexpr double kShareOfTravel = 0.02;

/// Number of sub-steps for which the position, without quantisers and noise, is within `accuracy` [m] of a converged
/// one. `reference`: of a closed loop; null: open.
template <class Run>
int choose(const Machine& machine, std::size_t which, double accuracy, const std::vector<double>* reference,
           Run&& run) {
  const MachineAxis& axis = machine.axes[which].second;
  const plant::Axis plant(axis.plant, machine.sample_time, axis.limits.speed);
  std::optional<int> acceptable;
  bool runs_away = false;
  const auto judge = [&](int n, const Recording& coarse, const Recording& fine) {
    RunError error;       // [m]
    RunError open_error;  // the same less a share of the travel so far [m]
    double travel = 0.0;
    for (std::size_t k = 0; k < coarse.x.size(); ++k) {
      const double d = std::abs(coarse.x[k] - fine.x[k]);
      error.add(d);
      if (k > 0) travel += std::abs(fine.x[k] - fine.x[k - 1]);
      open_error.add(d - kShareOfTravel * travel);
    }
    if (error.within(accuracy)) return Substeps::kEnough;
    if (reference != nullptr) {
      const ErrorSize one = tracking_error(coarse, *reference), other = tracking_error(fine, *reference);
      const double travel_of_axis = axis.limits.travel_max - axis.limits.travel_min;
      runs_away = n >= kManySubsteps && std::min(one.largest(), other.largest()) > travel_of_axis;
      if (runs_away) return Substeps::kGiveUp;
      // Accuracy is still searched: more sub-steps may reach it.
      if (!acceptable && n >= kManySubsteps && one.alike(other) && below_limit(fine, axis.force_limit()))
        acceptable = n;
      return Substeps::kMore;
    }
    if (!acceptable && open_error.within(accuracy)) acceptable = n;
    return acceptable && n >= kManySubsteps ? Substeps::kGiveUp : Substeps::kMore;
  };
  const auto n = search_substeps(
      least_substeps(plant.rate_bound(), machine.sample_time),
      [&](int substeps) {
        return run(plant::Fidelity{substeps, false, false});
      },
      judge);
  if (n) return *n;
  if (acceptable) return *acceptable;
  if (runs_away)
    throw Refused(
        "axis " + machine.axes[which].first +
        ": the loop with the commissioning gains is unstable: the error grows beyond the travel (choose a lower "
        "commissioning.omega)");
  throw Refused("axis " + machine.axes[which].first +
                ": its position does not settle within the accuracy for up to 512 sub-steps per control "
                "period: unstable with the commissioning gains, or too stiff for sample_time");
}

}  // namespace

Recording record_closed_loop(const Machine& machine, std::size_t axis, const std::vector<double>& reference,
                             std::uint64_t seed, double accuracy) {
  const MachineAxis& a = machine.axes[axis].second;
  const double period = machine.sample_time;
  control::Pd::Params params;
  params.gains = control::Gains::critical(a.commissioning.omega);
  params.compensation.model.mass = a.commissioning.mass;
  params.compensation.observer = control::Observer::kDisturbance;
  params.compensation.observer_pole = a.commissioning.observer_pole;
  params.force_limit = a.force_limit();
  if (a.plant.drive_loop) {
    params.compensation.model.drive_loop = a.known_loop();
    params.compensation.model.drive_loop->force_feedback =
        false;  // the loop of the drive is enough to record
  }
  const control::Pd controller(params, period);
  const control::DriveInterface<1> drive({.period = period, .compensation = {params.compensation}});
  const auto run = [&](const plant::Fidelity& fidelity, std::size_t rows) {
    control::Pd::State state;
    control::DriveInterface<1>::State commands{};
    return record(
        machine, axis, rows, reference.front(), fidelity,
        {seed, kClosedLoopTrial, static_cast<std::uint32_t>(axis)}, [&](std::size_t k, double x) {
          const double before = reference[k > 0 ? k - 1 : 0];
          const double after = reference[k + 1 < reference.size() ? k + 1 : k];
          const path::PathPoint<1> r{
              .position = {{reference[k]}},
              .velocity = {{(after - before) / (2.0 * period)}},
              .acceleration = {{(after - 2.0 * reference[k] + before) / (period * period)}}};
          const double f = controller.step(state, {r.position[0], r.velocity[0], r.acceleration[0], x});
          drive.command(commands, state, r, {{x}}, {{f}});
          return Output{f, commands[0].command, commands[0].offset};
        });
  };
  // The first stretch contains reversals and speeds; a whole log would only double the work.
  const std::size_t part = std::min(reference.size(), static_cast<std::size_t>(20.0 / period) + 1);
  const int substeps = choose(machine, axis, accuracy, &reference,
                              [&](const plant::Fidelity& fidelity) { return run(fidelity, part); });
  Recording log = run({substeps, true, true}, reference.size());
  log.r = reference;
  return log;
}

Recording record_open_loop(const Machine& machine, std::size_t axis, const std::vector<double>& force,
                           double start, std::uint64_t seed, double accuracy) {
  if (machine.axes[axis].second.plant.drive_loop)
    throw Refused(
        "axis " + machine.axes[axis].first +
        ": its drive closes a loop of its own and takes no force: record a motion in closed loop (sine, jogs), whose log holds the drive's actual force");
  const double limit = machine.axes[axis].second.force_limit();
  const auto run = [&](const plant::Fidelity& fidelity) {
    return record(machine, axis, force.size(), start, fidelity,
                  {seed, kOpenLoopTrial, static_cast<std::uint32_t>(axis)},
                  [&](std::size_t k, double) { return Output{clamp_to(force[k], -limit, limit)}; });
  };
  // Without a loop the position keeps every error of the steps: a hundredth of the noise of the travel
  // is enough.
  const int substeps = choose(machine, axis, 100.0 * accuracy, nullptr, run);
  return run({substeps, true, true});
}

}  // namespace stribeck::sim
