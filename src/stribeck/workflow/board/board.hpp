#pragma once
/// The board: what `stribeck bench` shows. Protocol: docs/board.md.
///
///   workflow::BoardOptions o;
///   o.entries = {workflow::read_entry("examples/board/pid.toml")};
///   const report::BoardResult result = workflow::run_board(o);
///
/// Machines run on all cores; the result does not depend on their number, but for the costs.
/// Real time: no. Errors: InputError of entries and options.

#include <cstdint>
#include <functional>
#include <stribeck/report/board/board_report.hpp>
#include <stribeck/workflow/board/entry.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

struct BoardOptions {
  std::uint64_t seed = 1;
  std::uint32_t machines = 12;
  unsigned threads = 0;  ///< 0: as many as the computer has
  std::vector<BoardEntry> entries;
  std::vector<std::string> only;  ///< names of the entries that run; empty: all
  bool built_in = true;           ///< Stribeck's own entries take part
  bool cost = false;              ///< measure the time of a step
  std::string folder;             ///< keeps logs, models and answers; empty: a temporary one
  std::vector<std::string> host;  ///< program that runs a shared object, before its file
  double identifier_seconds = 60.0;
  double answer_seconds =
      5.0;  ///< most time that a controller may take for a period; four times as long for the first answer
};

/// progress(done, all) may be called from any thread, one call at a time.
report::BoardResult run_board(const BoardOptions& options,
                              const std::function<void(std::size_t, std::size_t)>& progress = {});

/// The logs of all machines into a folder, for entries with `answers`; their names.
std::vector<std::string> write_board_logs(const std::string& folder, std::uint64_t seed,
                                          std::uint32_t machines, unsigned threads);

}  // namespace stribeck::workflow
