#pragma once
/// One closed-loop run of a two-axis machine along a plane path.
///
/// Every tick: encoders are read, the controller gives forces for the coming period, they become voltages,
/// the drives move. A run begins at rest on the path, reaches its speed within the run-in, travels whole laps
/// at constant speed and runs out; it is scored on the laps.
/// Real time: no.

#include <cstdint>
#include <stdexcept>
#include <stribeck/control/contouring.hpp>
#include <stribeck/path/contour_error.hpp>
#include <stribeck/plant/axis.hpp>
#include <stribeck/sim/machine.hpp>
#include <stribeck/sim/metrics.hpp>

namespace stribeck::sim {

/// A path travelled at one speed.
struct Travel {
  path::Curve curve;
  double speed = 0.0;   ///< [m/s]
  double laps = 2.0;    ///< at constant speed
  double run_in = 1.0;  ///< [s]

  [[nodiscard]] path::SpeedLaw law() const { return {speed, run_in, laps * curve.lap_length()}; }
};

/// One sample of a recorded run; SI.
struct ContourSample {
  double time = 0.0;
  path::PathPoint reference;
  Vec2 position;  ///< true, of the table
  Vec2 encoder;
  Vec2 voltage;   ///< asked of the converters at this tick
  Vec2 force;     ///< asked of the drives at this tick
  Vec2 friction;  ///< true friction
  double contour_error = 0.0;
  bool scored = false;
};

/// No run is simulated with more sub-steps per control period.
inline constexpr int kMostSubsteps = 512;

/// The reference of a travel, sampled once and shared by every run on it.
std::vector<path::PathPoint> sample_reference(const Travel& travel, double period);

/// The drives of a two-axis machine, ready for run after run.
class Table2 {
 public:
  explicit Table2(const Machine& machine, double v_max);

  /// Runs a controller along a sampled reference; `seen` may be null. Returns the figures of the scored part.
  Metrics run(const control::Contouring& controller, const Travel& travel,
              const std::vector<path::PathPoint>& reference, const plant::Fidelity& fidelity,
              std::uint64_t seed, std::uint32_t trial, std::vector<ContourSample>* seen = nullptr,
              StatusCounter* status = nullptr);

  [[nodiscard]] double rate_bound() const;

 private:
  std::array<plant::Axis, 2> axes_;
  std::array<double, 2> gain_;
  double period_;
};

/// A run that cannot be simulated, or whose result would mean nothing; what() says why and what would help.
struct Refused : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Smallest number of sub-steps for which the trace of the contour error of this run, with quantisers and
/// noise off, is within `accuracy` [m] of a converged one. Doubles the number until a run and one of twice as
/// many agree.
int choose_substeps(Table2& table, const control::Contouring& controller, const Travel& travel,
                    const std::vector<path::PathPoint>& reference, double period, double accuracy);

}  // namespace stribeck::sim
