#pragma once
/// The track "identification": logs of the budget, answers, scores.
///
///   budget    pulses.csv   force in open loop, 20 trapezoids; sized with mass and friction known within 10 %
///             sine.csv     position in closed loop, 8 periods of the machine file's sine
///   held out  position in closed loop, 3 periods about the middle, 0.6 of the amplitude and 1.3 times the frequency of the sine
///
/// Columns: t [s], r [mm] (sine), x [mm], u [V], f [N].
/// Real time: no.
/// Errors: of an entry become the reason of its failure; ident::Refused and sim::Refused where a machine cannot be excited.

#include <cstdint>
#include <stribeck/ident/log/record.hpp>
#include <stribeck/ident/result.hpp>
#include <stribeck/io/log/log.hpp>
#include <stribeck/workflow/board/entry.hpp>
#include <stribeck/workflow/board/machines.hpp>
#include <stribeck/workflow/board/score.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

/// What is recorded of one axis.
struct BoardLogs {
  std::vector<io::Log> logs;  ///< pulses, sine
  ident::log::Record held_out{};
};

/// `machine`: number of the machine on the board.
BoardLogs board_logs(const BoardMachine& board, std::uint64_t seed, std::uint32_t machine, std::size_t axis);
/// FOLDER/MACHINE-AXIS-pulses.csv and -sine.csv; their paths.
std::vector<std::string> write_logs(const BoardLogs& logs, const BoardMachine& board, std::size_t axis,
                                    const std::string& folder);
/// "biaxial-table-1-x"
std::string name_of(const BoardMachine& board, std::size_t axis);

/// The methods of `identify` that take part.
struct BuiltInIdentifier {
  const char* id;
  const char* label;
  ident::Method method;
  bool pulses_only = false;
};
const std::vector<BuiltInIdentifier>& built_in_identifiers();

BoardAnswer answer_of(const BuiltInIdentifier& how, const BoardLogs& logs, const std::string& axis);
/// folder: where the logs are and answers of programs go. seconds: limit of a program.
BoardAnswer answer_of(const BoardEntry& entry, const BoardMachine& board, std::size_t axis,
                      const std::vector<std::string>& logs, const std::string& folder, double seconds);

/// With the held-out error.
AnswerScore full_score(const BoardAnswer& answer, const sim::MachineAxis& axis, const BoardLogs& logs);

}  // namespace stribeck::workflow
