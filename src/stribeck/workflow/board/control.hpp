#pragma once
/// The track "control": every controller on the same machines along the same motions, with the same identified model of each axis.
///
///   motions   circle of 10 mm at 9.5 mm/s, eight of 10 mm at 4 mm/s; two laps to settle, one is scored
///   model     what method auto identified from the logs of the machine (identification.hpp); the Coulomb and viscous model of
///             controllers (b) and (e) is that of the pulses
///   lost      as in sim/study/machine_runs.hpp
///
/// The noise of a run depends on seed and machine, and is the same for all controllers.
/// Real time: no. Errors: of an entry become the reason of its failure.

#include <cstdint>
#include <memory>
#include <stribeck/sim/study/machine_runs.hpp>
#include <stribeck/workflow/board/entry.hpp>
#include <stribeck/workflow/board/identification.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

/// A controller that takes part: one of Stribeck's, or a program.
struct BoardController {
  sim::ControllerSpec spec;        ///< id and label always
  std::vector<std::string> words;  ///< of the program; empty: spec is the controller
  std::string folder{};
  std::string source{};
  bool outside = false;
  double answer_seconds = 5.0;
};

const std::vector<sim::Travel>& board_travels();
/// Controllers that take part without being asked for.
std::vector<BoardController> built_in_contestants();
/// host: words of the program that runs a shared object, before its file.
BoardController contestant(const BoardEntry& entry, const std::vector<std::string>& host);

/// The knowledge of an axis from its answers; `conventional` may be null.
sim::AxisKnowledge board_knowledge(const BoardAnswer& model, const BoardAnswer* conventional);

/// One run; a failure has a text.
struct BoardRun {
  sim::RobustRun run;
  std::string failure{};
  std::vector<std::string> notes{};  ///< axes on which the controller goes without its Kalman observer
};

/// Runs on one machine.
class BoardControl {
 public:
  /// model_files: axis files of the model, one for each axis.
  BoardControl(const BoardMachine& board, std::vector<sim::AxisKnowledge> knowledge,
               std::vector<std::string> model_files, std::uint64_t seed, std::uint32_t machine);
  ~BoardControl();
  BoardControl(const BoardControl&) = delete;
  BoardControl& operator=(const BoardControl&) = delete;

  BoardRun run(const BoardController& controller, std::size_t travel);
  /// Time of a step, the least of three passes over the encoders of a run; NaN where the run fails.
  report::BoardCost cost(const BoardController& controller);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace stribeck::workflow
