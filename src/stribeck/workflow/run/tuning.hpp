#pragma once
/// The best gains of controllers on a virtual machine: what `stribeck tune` shows and writes.
///
///   workflow::Tuning t = workflow::plan_tuning(options, {}, "machines/biaxial-table.toml");
///   workflow::run_tuning(t);
///   workflow::write_tuned(t, "tuned", version);
///
/// Real time: no.
/// Errors: InputError for files and options; sim::Refused where no controller can be simulated.

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <stribeck/workflow/parameters.hpp>
#include <stribeck/workflow/run/comparison.hpp>
#include <stribeck/workflow/tune_options.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

struct Tuning {
  std::string machine_file;
  sim::Machine machine;
  ParameterOptions origin;
  sim::TuneSpec spec;
  Parameters parameters;   ///< of run_tuning()
  sim::TuneResult result;  ///< of run_tuning()
  bool wants_trade_off = false;
  sim::TradeOff trade_off;  ///< of run_tuning(), where it is wanted
};

/// Files that the options name, and other words among them.
std::vector<std::string> inputs_of(const TuneOptions& options, const ParameterOptions& origin,
                                   const std::string& machine_file);

/// Controllers, travels and limits, checked before anything is identified or simulated.
Tuning plan_tuning(const TuneOptions& options, const ParameterOptions& origin,
                   const std::string& machine_file);

/// progress(done, all) may be called from any thread, one call at a time.
void run_tuning(Tuning& tuning, const std::function<void(std::size_t, std::size_t)>& progress = {});

/// compare with every controller at the gains that tune finds for it within its usual limits; one without such gains keeps its own, and
/// a warning says so. progress() tells of the search first, then of the comparison.
Comparison run_tuned_comparison(const ComparisonOptions& options,
                                const std::function<void(std::size_t, std::size_t)>& progress = {});

/// Whether the name is that of a file for one controller, not of a folder.
bool is_controller_file(const std::string& out);
/// The files that write_tuned() would write; a file for several controllers is refused with place `option`.
std::vector<std::string> tuned_files(const Tuning& tuning, const std::string& out, const std::string& option);
/// Writes each tuned controller that was found.
void write_tuned(const Tuning& tuning, const std::string& out, std::string_view version);

/// Why some controllers have no gains within the limits, and the way out; empty: all have.
std::string missed(const Tuning& tuning);

/// The tables of the result.
std::string text_of(const Tuning& tuning);

}  // namespace stribeck::workflow
