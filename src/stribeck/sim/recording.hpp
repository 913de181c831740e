#pragma once
/// Moves one axis of a virtual machine for identification, and returns the log that a control would record.
///
///   closed loop   PD with disturbance observer follows a position reference; it knows the nominal mass only
///   open loop     the drive gets a given force
///
/// The number of sub-steps is what a converged position needs. In open loop, a slip after break-away multiplies every error
/// (on the y axis of V3, 0.1 µm before it become millimetres after some ramps, with any number of sub-steps). Where the position
/// therefore does not converge, it must be right up to break-away and within 2 % of the travel after it: such a run is as good as
/// another run of this axis with other noise. The same holds in closed loop for an axis that hunts around standstill: where its position
/// does not converge, largest and RMS tracking error must agree within 10 %, without a drive at its limit.
///
/// The log holds what a real control could log, and nothing that only the simulation knows.
/// Real time: no.
/// Errors: Refused, where no number of sub-steps is enough.

#include <cstdint>
#include <stribeck/control/pd.hpp>
#include <stribeck/plant/axis.hpp>
#include <stribeck/sim/machine.hpp>

namespace stribeck::sim {

/// Columns of a log, SI, one row per control period.
struct Recording {
  double period = 0.0;          ///< [s]
  std::vector<double> t;        ///< [s]
  std::vector<double> r;        ///< reference position [m]; empty in open loop
  std::vector<double> x;        ///< encoder [m]
  std::vector<double> motor{};  ///< second encoder, on the motor [m]; empty: none there
  std::vector<double> scale{};  ///< second encoder, on the table [m]; empty: none there
  std::vector<double> u;        ///< voltage commanded to the converter [V]
  std::vector<double> f;        ///< force commanded to the drive [N]
  bool rotary = false;          ///< positions are arcs at a radius of 1 m

  /// Ends after so many rows.
  void cut(std::size_t rows) {
    for (auto* column : {&t, &r, &x, &motor, &scale, &u, &f}) {
      if (column->size() > rows) column->resize(rows);
    }
  }
};

/// Positions [m], one per control period, from rest.
Recording record_closed_loop(const Machine& machine, std::size_t axis, const std::vector<double>& reference,
                             std::uint64_t seed, double accuracy = 1e-9);

/// Forces [N], one per control period; starts at position start [m].
Recording record_open_loop(const Machine& machine, std::size_t axis, const std::vector<double>& force,
                           double start, std::uint64_t seed, double accuracy = 1e-9);

}  // namespace stribeck::sim
