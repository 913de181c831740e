#pragma once
/// A circle of two virtual axes in cascades, on which the targets with a pulse find and judge their numbers.
///
/// Noise and the steps of encoder and converter are left out: what differs between two runs is the compensation.
/// Real time: no.
/// Errors: sim::Refused when a loop cannot follow the circle.

#include <optional>
#include <stribeck/sim/compare.hpp>
#include <stribeck/targets/pulse/pulse_law.hpp>
#include <stribeck/targets/pulse/table_law.hpp>

namespace stribeck::targets {

/// Two axes, their loop, and what is known of them.
struct CircleAxes {
  sim::Machine machine;  ///< its first two axes
  std::array<friction::AxisModel, 2> known;
  sim::ControllerSpec loop;  ///< its law is a cascade

  [[nodiscard]] const control::CascadeParams& cascade() const {
    return std::get<control::CascadeParams>(loop.law);
  }
};

/// Virtual axes that are what was identified; both the same where there is one.
sim::Machine machine_of(const std::array<friction::AxisModel, 2>& axes, double period);

/// Contour errors of a circle [m].
struct CircleError {
  double quadrant = 0.0;  ///< largest within the first 0.15 mm after a reversal
  double largest = 0.0;
  /// Largest minus smallest signed error: the circular deviation about the centre of the path, which a circular test shows. A pulse that is too
  /// strong turns the peak round: the largest error falls, and this grows.
  double deviation = 0.0;
};

class Circle {
 public:
  /// laps: the part of the circle that is judged; half a circle has one reversal of each axis, or two of one.
  /// substeps: those of an equal circle; 0: they are found, which takes several runs.
  Circle(const CircleAxes& axes, double radius, double feed, double laps, int substeps = 0);

  [[nodiscard]] int substeps() const noexcept { return substeps_; }
  /// Steps of the simulation in one run.
  [[nodiscard]] double work() const noexcept {
    return static_cast<double>(route_.points.size()) * static_cast<double>(substeps_);
  }

  [[nodiscard]] CircleError without();
  [[nodiscard]] CircleError with(const std::array<Pulse, 2>& pulses);
  [[nodiscard]] CircleError with(const std::array<TableForce, 2>& tables);
  /// With all that is known fed forward to the force.
  [[nodiscard]] CircleError with_model();

 private:
  [[nodiscard]] sim::AnyController<2> controller(sim::FrictionUse use) const;
  CircleError error_of(const sim::AnyController<2>& controller);

  CircleAxes axes_;
  sim::Route<2> route_;
  sim::Drives drives_;
  int substeps_ = 0;
};

}  // namespace stribeck::targets
