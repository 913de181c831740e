#pragma once
/// The command `stribeck`: one file per verb, and what they share.
///
/// Exit codes: 0 done; 1 the answer is "no"; 2 wrong usage or bad input, with a line `stribeck: FILE:LINE:
/// what is wrong`.

#include <functional>
#include <string>
#include <string_view>

namespace CLI {
class App;
}

namespace stribeck::cli {

/// Runs the command; returns its exit code. Throws nothing.
int run(int argc, const char* const* argv);

/// What a verb does once its options are read; the exit code.
using Action = std::function<int()>;

// Each adds its verb to the command and says what to do when it was chosen.
void add_compare(CLI::App& app, Action& action);
void add_identify(CLI::App& app, Action& action);
void add_excite(CLI::App& app, Action& action);
void add_reproduce(CLI::App& app, Action& action);
void add_simulate(CLI::App& app, Action& action);
void add_tune(CLI::App& app, Action& action);
void add_verify(CLI::App& app, Action& action);
void add_export(CLI::App& app, Action& action);
void add_evaluate(CLI::App& app, Action& action);

/// A word as a shell takes it.
std::string shell_quoted(std::string_view word);

/// The command as it was typed, for pages that say how to make them again.
const std::string& typed_command();

}  // namespace stribeck::cli
