#pragma once
/// A control law together with its state, as one class for all laws of N axes.
///
/// A loop over this class is compiled once for each number of axes, not again for each law. A call costs a few nanoseconds; a
/// period of a simulated drive takes some hundred. law_runner_of.hpp holds the class of one law;
/// law_runner_plane.cpp and law_runner_space.cpp instantiate the laws.
/// Real time: no.

#include <memory>
#include <span>
#include <stribeck/control/compensation/drift_monitor.hpp>
#include <stribeck/control/drive_interface.hpp>
#include <stribeck/control/laws.hpp>
#include <stribeck/control/setup.hpp>
#include <vector>

namespace stribeck::sim {

template <std::size_t N>
class LawRunner {
 public:
  using Point = path::PathPoint<N>;

  LawRunner() = default;
  LawRunner& operator=(const LawRunner&) = delete;
  virtual ~LawRunner() = default;

  /// A copy of the law with its state.
  [[nodiscard]] virtual std::unique_ptr<LawRunner> copy() const = 0;

  /// Forces for the coming period [N], from the present point of the reference alone and the measured positions [m].
  virtual Vec<double, N> step(const Point& now, const Vec<double, N>& measured) = 0;
  /// The same with the points ahead, one per period, the present one first. A law that does not look ahead takes the first.
  virtual Vec<double, N> step_ahead(std::span<const Point> points, const Vec<double, N>& measured) = 0;

  /// Call before a step: mean forces of the past period, as drives with a loop of their own report them [N].
  virtual void acted(const Vec<double, N>& /*force*/) {}
  /// Commands after a step for drives with a loop of their own: velocity [m/s] or position [m]. Zero from a runner that only gives
  /// forces.
  [[nodiscard]] virtual Vec<double, N> command() const { return {}; }
  /// Force offsets that are sent with these commands [N].
  [[nodiscard]] virtual Vec<double, N> offset() const { return {}; }

  /// Lag of the reference behind its programme [s]; 0 for a law that does not slow down.
  [[nodiscard]] virtual double lag() const = 0;
  [[nodiscard]] virtual const StatusCounter& status() const = 0;
  /// State of adaptation, one entry per axis that adapts.
  [[nodiscard]] virtual std::vector<control::Drift> drift(double period) const = 0;

 protected:
  LawRunner(const LawRunner&) = default;
};

/// A control law at rest, for N axes. A run begins with its copy().
template <std::size_t N>
using AnyController = std::shared_ptr<const LawRunner<N>>;

/// For 1, 2, 3 and 5 axes.
template <std::size_t N>
AnyController<N> make_controller(const control::LawParams& law, const control::Setup<N>& setup);

}  // namespace stribeck::sim
