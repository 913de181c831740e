#pragma once
/// Scores of the board.
///
///   curve error      100·√(Σ(F − F̄)²/ΣF̄²) over nine speeds in both directions: F of the answer, F̄ the truth (machines.hpp)  [%]
///   mass error       100·|m − m̄|/m̄  [%]
///   held-out error   100·‖f − f̂‖/‖f‖ on a motion that nobody saw, force and motion aligned (ident/replay/model_force.hpp)  [%]
///   covered          share of the F̄ at these speeds that lie within the stated intervals of 95 %  [%]
///
/// Confidence of a median: percentile bootstrap with 2000 draws of whole machines, so that the axes of one machine stay together.
/// Of a 99th percentile: the same for the lower end; the upper end exists only from 368 machines on (0.99^n ≤ 2.5 %).
/// Source: Efron, Tibshirani 1993, An Introduction to the Bootstrap, chapter 13.
/// Real time: no.

#include <array>
#include <cstdint>
#include <optional>
#include <stribeck/friction/axis_model.hpp>
#include <stribeck/report/board/board_report.hpp>
#include <stribeck/sim/machine.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

/// Interval of the friction at a speed.
struct StatedPoint {
  double velocity = 0.0;  ///< [m/s]
  double low = 0.0;       ///< [N]
  double high = 0.0;      ///< [N]
};

/// What an entry answers for an axis.
struct BoardAnswer {
  friction::AxisModel model;
  std::vector<StatedPoint> curve{};             ///< ascending speed; empty: no intervals are stated
  std::optional<std::array<double, 2>> mass{};  ///< [kg]
};

/// Scores of one axis; NaN: not known.
struct AnswerScore {
  double curve_error;
  double mass_error;
  double held_out_error;
  double points = 0.0;   ///< speeds with an interval
  double covered = 0.0;  ///< of them
  double half_width;     ///< mean, as a share of the true force there [%]
  double mass_covered;   ///< 1, 0 or NaN
};

/// All but the held-out error, which is NaN.
AnswerScore score_answer(const BoardAnswer& answer, const sim::MachineAxis& axis);

/// Median and 99th percentile of values, `group` consecutive ones for each machine.
report::BoardFigure board_figure(std::vector<double> values, std::size_t group, std::uint64_t seed);
/// Ratio of two sums over the machines, times 100, with its interval.
sim::Confident board_share(const std::vector<double>& part, const std::vector<double>& whole,
                           std::size_t group, std::uint64_t seed);

}  // namespace stribeck::workflow
