#pragma once
/// The command `stribeck`: one file per verb, and their shared parts.
///
/// Exit codes: 0 done; 1 the answer is "no"; 2 wrong usage or bad input, with a line `stribeck: FILE:LINE:
/// what is wrong`.
/// Real time: no.

#include <array>
#include <functional>
#include <string>
#include <string_view>

namespace CLI {
class App;
}

namespace stribeck::cli {

/// Runs the command; returns its exit code. Throws nothing.
int run(int argc, const char* const* argv);

/// The action of a verb after its options are read; returns the exit code.
using Action = std::function<int()>;

/// Adds a verb to the command, with the action to run when it is chosen.
using AddVerb = void(CLI::App& app, Action& action);
AddVerb add_compare, add_identify, add_excite, add_simulate, add_reproduce, add_verify, add_export,
    add_evaluate, add_health, add_tune, add_init, add_machine, add_study, add_bench, add_commission,
    add_serve, add_frequency;
/// All verbs, in the order of --help. A new verb is declared above and entered here.
inline constexpr std::array<AddVerb*, 17> kVerbs{
    add_compare,   add_identify, add_init,   add_machine,    add_excite, add_simulate,
    add_reproduce, add_verify,   add_export, add_evaluate,   add_health, add_frequency,
    add_tune,      add_study,    add_bench,  add_commission, add_serve};
/// Not in --help: tools/make-reference calls it.
AddVerb add_reference;
/// Not in --help: `bench` starts it to run a shared object.
AddVerb add_board_host;

/// The command as it was typed, for pages that show how to make them again.
const std::string& typed_command();

}  // namespace stribeck::cli
