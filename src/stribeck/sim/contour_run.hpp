#pragma once
/// One closed-loop run of a machine along a path.
///
/// At every tick the encoders are read, the controller gives forces for the coming period, these become voltages, and the drives
/// move. A run begins at rest on the path, reaches its law within the run-in, travels whole laps and runs out; the laps are scored.
/// With a single axis the tracking error replaces the contour error; where the path has a tool axis, the distance of the tool tip
/// from its path in the workpiece does.
/// Real time: no.

#include <cstdint>
#include <span>
#include <stdexcept>
#include <stribeck/plant/axis.hpp>
#include <stribeck/sim/law/law_runner.hpp>
#include <stribeck/sim/machine.hpp>
#include <stribeck/sim/metrics.hpp>
#include <stribeck/sim/part/travel.hpp>
#include <stribeck/sim/substeps.hpp>

namespace stribeck::sim {

/// One sample of a recorded run; SI.
struct ContourSample {
  double time = 0.0;
  double phi = 0.0;         ///< parameter of the path
  AxisValues reference;     ///< position
  AxisValues velocity;      ///< of the reference
  AxisValues acceleration;  ///< of the reference
  AxisValues position;      ///< true, of the table
  AxisValues encoder;
  AxisValues motor;  ///< second encoder, on the motor; NaN: none there
  AxisValues scale;  ///< second encoder, on the table; NaN: none there
  AxisValues
      voltage;  ///< commanded to the converters at this tick; mean of the coming period if the drive has a loop
  AxisValues
      force;  ///< commanded to the drives at this tick; mean of the coming period if the drive has a loop
  AxisValues friction;          ///< true friction
  AxisValues cutting;           ///< true cutting force, mean over the coming period
  AxisValues cutting_estimate;  ///< its estimate (cutting_estimate.hpp)
  AxisValues local;             ///< true tracking error in the path's frame: along, then across
  double contour_error = 0.0;
  double orientation_error = std::numeric_limits<double>::quiet_NaN();  ///< [rad]; NaN without a tool axis
  bool scored = false;
};

/// A loop that is farther from its path than this share of the path's extent has lost the path.
inline constexpr double kLost = 0.1;

class Drives;

/// One of several runs that take place together.
template <std::size_t N>
struct RunTogether {
  Drives* drives = nullptr;
  AnyController<N> controller;
  plant::Fidelity fidelity;
  std::uint32_t trial = 0;
  std::vector<ContourSample>* seen = nullptr;    ///< filled; null: not kept
  std::vector<control::Drift>* drift = nullptr;  ///< the same
};
struct RunResult {
  Metrics metrics;
  StatusCounter status;
};

/// The drives of some axes of a machine; they can be used for many runs.
class Drives {
 public:
  /// which: indices of the machine's axes; v_max [m/s] bounds the tables of the friction curves.
  Drives(const Machine& machine, const std::vector<std::size_t>& which, double v_max);

  /// Runs a controller, from rest, along a route and returns the figures of the scored part; they are unknown when the path of
  /// the route has another number of axes. Null outputs are not filled; `drift` gets one entry per axis that adapts.
  template <std::size_t N>
  Metrics run(const AnyController<N>& controller, const Route<N>& route, const plant::Fidelity& fidelity,
              std::uint64_t seed, std::uint32_t trial, std::vector<ContourSample>* seen = nullptr,
              StatusCounter* status = nullptr, std::vector<control::Drift>* drift = nullptr);

  /// run() of several machines along the same route, in step, so that their drives move in packs (plant/axis_group.hpp): the same
  /// figures to the last bit, in less time. Each run has drives of its own.
  template <std::size_t N>
  static std::vector<RunResult> run_together(std::span<const RunTogether<N>> runs, const Route<N>& route,
                                             std::uint64_t seed);

  /// The same without an end, one period after the other: start() at rest, then tick() again and again. points: the present one first,
  /// then those ahead; phi: where the search for the nearest point of the path begins.
  template <std::size_t N>
  void start(const Vec<double, N>& position, const plant::Fidelity& fidelity, std::uint64_t seed,
             std::uint32_t trial);
  template <std::size_t N>
  ContourSample tick(LawRunner<N>& law, const AnyPath& path, std::span<const path::PathPoint<N>> points,
                     double time, double phi);

  [[nodiscard]] double rate_bound() const;
  [[nodiscard]] double period() const { return period_; }

 private:
  std::vector<plant::Axis> axes_;
  std::vector<double> gain_;
  double period_;
};

/// A run that cannot be simulated, or whose result would mean nothing; what() says why and what would help.
struct Refused : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Smallest number of sub-steps for which the trace of the contour error of this run, with quantisers and noise off, is within
/// `accuracy` [m] of a converged one. Doubles the number until a run agrees with one of twice as many. A law that switches is
/// not reproducible sample by sample with any number; pass the contouring law on the same route instead. A loop in stick-slip
/// multiplies every difference: where no number is enough, its largest and RMS errors must agree within a tenth. Such a run is as
/// good as one with other noise, and `repeatable` is then false.
template <std::size_t N>
int choose_substeps(Drives& drives, const AnyController<N>& controller, const Route<N>& route,
                    double accuracy, bool* repeatable = nullptr);

}  // namespace stribeck::sim
