#pragma once
/// Runs the same controllers on the same travels on one machine after another.
///
/// Controllers are built once, from the nominal machine and its identification; only the machines differ.
///
///   lost    the contour error passed a tenth of the path's extent; an axis moved less than half as far as it should; or a drive was at its limit for more than 0.1 % of the
///           ticks and mean |Δu| is above 2 % of its range: an unstable loop that the limit holds together. A
///           result, not an error.
///
/// As in compare(), a controller that adapts begins with the disturbance observer on late axes where a Kalman observer would leave too
/// little margin (calm()).
///
/// The number of sub-steps follows from the fastest rate of the machine; choose_substeps() would cost more than the runs. Measured
/// on 40 machines: docs/theory/robustness.md.
/// Several machines run in step (Drives::run_together), which gives the same results in less time; kTogether of them fill the packs.
/// Threads: run() and run_together() are safe. Real time: no. Errors: Refused for controllers that cannot be built, and for a machine that needs too many
/// sub-steps.

#include <cstdint>
#include <exception>
#include <memory>
#include <span>
#include <stribeck/sim/compare.hpp>
#include <vector>

namespace stribeck::sim {

/// One controller on one machine.
struct RobustRun {
  Metrics metrics;
  double limited = 0.0;  ///< share of the ticks and axes at the limit of the drive
  bool lost = false;
};

/// The runs of one machine; or why there are none.
struct RunsOfMachine {
  std::vector<RobustRun> runs;
  std::exception_ptr refused;
};

/// A machine and the number that its noise depends on.
struct MachineTrial {
  Machine machine;
  std::uint32_t trial = 0;
};

/// Drives of one machine, for runs that are judged as those of MachineRuns: with any controller, also one that is no law of Stribeck.
template <std::size_t N>
class JudgedRuns {
 public:
  /// v_max [m/s] bounds the tables of the friction curves.
  JudgedRuns(const Machine& machine, const std::vector<std::size_t>& axes, double v_max);

  /// Null for no trace.
  RobustRun run(const AnyController<N>& controller, const Route<N>& route, std::uint64_t seed,
                std::uint32_t trial, std::vector<ContourSample>* seen = nullptr);

  struct Member {
    JudgedRuns* runs = nullptr;
    std::uint32_t trial = 0;
  };
  /// run() of several machines in step.
  static std::vector<RobustRun> run_together(std::span<const Member> members,
                                             const AnyController<N>& controller, const Route<N>& route,
                                             std::uint64_t seed);

 private:
  [[nodiscard]] RobustRun judged(const Metrics& metrics, const StatusCounter& status,
                                 const Route<N>& route) const;

  Drives drives_;
  double range_;  ///< smallest of the converters [V]
  int substeps_;
};

class MachineRuns {
 public:
  /// knowledge is that of the nominal machine, for its axes.
  MachineRuns(const Machine& nominal, const std::vector<AxisKnowledge>& knowledge,
              const std::vector<Travel>& travels, const std::vector<std::size_t>& axes,
              const std::vector<ControllerSpec>& controllers, std::uint64_t seed);

  /// Number of travels times controllers.
  [[nodiscard]] std::size_t size() const;

  /// An axis on which a controller goes without its Kalman observer, see calm(). The gains are the same on all travels.
  struct Calmed {
    std::size_t controller = 0;
    std::size_t axis = 0;  ///< of the path
  };
  [[nodiscard]] const std::vector<Calmed>& calmed() const;

  /// On a machine with the axes of the nominal one; travel by travel, controller by controller. The noise depends on seed and trial.
  [[nodiscard]] std::vector<RobustRun> run(const Machine& machine, std::uint32_t trial) const;

  /// The same for several machines. A machine that is refused does not stop the others.
  static constexpr std::size_t kTogether = 16;
  [[nodiscard]] std::vector<RunsOfMachine> run_together(std::span<const MachineTrial> machines) const;

 private:
  class Loops;
  template <std::size_t N>
  class LoopsOf;
  std::shared_ptr<const Loops> loops_;
};

}  // namespace stribeck::sim
