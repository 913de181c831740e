#pragma once
/// Sixteen drives in arrays, as packed_period.hpp advances them. Plain data: it is shared by files that are compiled for different
/// instruction sets.
/// Real time: safe.

#include <array>
#include <cstddef>
#include <cstdint>

namespace stribeck::plant {

struct LaneBlock {
  static constexpr std::size_t kLanes = 16;
  static constexpr std::size_t kMostStates = 6;  ///< x, v, z, i, x_t, v_t
  static constexpr std::size_t kValues = 10;     ///< of DriveEquations
  template <class T>
  using Row = std::array<T, kLanes>;
  struct Side {
    Row<double> scale;
    Row<double> viscous;
    Row<std::int64_t> cells;   ///< doubles from `tables` on
    Row<std::int64_t> border;  ///< doubles from `tables` on
  };

  alignas(64) std::array<Row<double>, kMostStates> state{};
  Row<double> voltage{};
  Row<double> force{};
  Row<double> cutting{};
  Row<double> substeps{};  ///< of a period, at least
  Row<double> level{};     ///< of friction at the start of the period [N]
  std::array<Row<double>, kValues> value{};
  Row<double> sigma0{};
  Row<double> sigma1{};
  Row<double> damping_velocity{};
  bool fades = false;  ///< whether damping_velocity counts
  std::array<Side, 2> side{};
  const double* tables = nullptr;
  Row<int> spare{};  ///< sub-steps that may still be added in this period

  /// One sub-step of h [s] of one drive, where it must be divided; reads and writes state and spare of the lane.
  void (*substep_alone)(void* drive, LaneBlock& block, std::size_t lane, double h) = nullptr;
  Row<void*> drive{};
};

/// Advances all lanes by dt [s].
using AdvanceLanes = void (*)(LaneBlock& block, double dt);

/// One function for each kind of drive, for one instruction set.
struct PackedDrive {
  AdvanceLanes current = nullptr;
  AdvanceLanes voltage = nullptr;
  AdvanceLanes current_mode = nullptr;  ///< with an axial mode
  AdvanceLanes voltage_mode = nullptr;
};

}  // namespace stribeck::plant
