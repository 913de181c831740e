#pragma once
/// The machines of the board: two axes each, drawn by the seed around three machine files.
///
///   bases      biaxial-table (5 ms), triaxial-tool (x and y, 1 ms), unlike-table (5 ms; friction that no model of Stribeck has)
///   factors    board_variation(): friction × 0.7…1.3, stiffness × 0.5…1.5, mass × 0.8…1.2, 0 or 1 more period of delay, encoder
///              1…4 times coarser, a periodic term of 0…5 %  (sim/study/variation.hpp)
///   shape      Gaussian map: height of every term × 0.6…1.4, width × 0.8…1.25;
///              conventional map: Stribeck part × 0.6…1.4, its speed × 0.7…1.4
///
/// Machine i of a seed has base i mod 3. What depends on the hour is taken out (warming), so that there is one true curve. The data
/// of the name plates, limits and commissioning data stay those of the base: they are wrong by what was drawn, as on real machines.
///
///   true force at a steady speed   F̄(v) = mean over the travel of the sine of {level·sgn v + viscous + additive}   [N]
///
/// Real time: no.

#include <cstdint>
#include <stribeck/sim/machine.hpp>
#include <stribeck/sim/study/variation.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

struct BoardMachine {
  std::string name;  ///< "biaxial-table-1"
  std::string base;
  sim::Machine machine;
};

/// Ranges of the factors.
sim::Variation board_variation();
/// Machine files around which machines are drawn.
const std::vector<std::string>& board_bases();
/// Machines 0 … count−1 of a seed; the same for any larger count.
std::vector<BoardMachine> board_machines(std::uint64_t seed, std::uint32_t count);

/// Speeds at which curves are compared, both directions, ascending [m/s]: nine shares of the sine's top speed.
std::vector<double> board_speeds(const sim::MachineAxis& axis);
/// The true steady force without load at a speed v ≠ 0 [N].
double true_force(const sim::MachineAxis& axis, double v);
/// That of a model, over the same travel, with its load [N].
double model_force(const friction::AxisModel& model, const sim::MachineAxis& axis, double v);

}  // namespace stribeck::workflow
