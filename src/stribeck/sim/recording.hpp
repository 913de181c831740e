#pragma once
/// One axis of a virtual machine moved for identification, and the log of it: what a control would record.
///
///   closed loop   PD with disturbance observer follows a position reference; it knows the nominal mass only
///   open loop     a given force goes to the drive
///
/// Sub-steps are as many as a converged position needs. In open loop a slip after break-away multiplies every error
/// (on the y axis of V3 0.1 µm before it become millimetres after some ramps, at any number of sub-steps). Where that
/// makes the position unreachable, one that is right up to break-away and within 2 % of the way after it will do: it is
/// as good a run of this axis as another one, with another noise.
///
/// The log holds what a real control could log, nothing that only the simulation knows.
/// Real time: no.
/// Errors: Refused, where no number of sub-steps is enough.

#include <cstdint>
#include <stribeck/control/pd.hpp>
#include <stribeck/plant/axis.hpp>
#include <stribeck/sim/machine.hpp>

namespace stribeck::sim {

/// Columns of a log, SI, one row per control period.
struct Recording {
  double period = 0.0;    ///< [s]
  std::vector<double> t;  ///< [s]
  std::vector<double> r;  ///< reference position [m]; empty in open loop
  std::vector<double> x;  ///< encoder [m]
  std::vector<double> u;  ///< voltage asked of the converter [V]
  std::vector<double> f;  ///< force asked of the drive [N]
};

/// Positions [m], one per control period, from rest.
Recording record_closed_loop(const Machine& machine, std::size_t axis, const std::vector<double>& reference,
                             std::uint64_t seed, double accuracy = 1e-9);

/// Forces [N], one per control period; starts at position start [m].
Recording record_open_loop(const Machine& machine, std::size_t axis, const std::vector<double>& force,
                           double start, std::uint64_t seed, double accuracy = 1e-9);

}  // namespace stribeck::sim
