#pragma once
/// Tuned controllers: table, JSON, page.
///
///   json   {"schema": "stribeck.tune/1", "machine", "seed", "trials", "evaluations", "limits": {"phase_margin_deg",
///           "gain_margin_dB", "delay_margin_periods", "input_variation_V": [per travel], "reference"},
///           "controllers": [{"controller", "label", "missed": null or why, "tries", "gains": [{"name", "unit", "start", "tuned"}],
///           "margins": {"start": {"stable", "phase_deg", "gain_dB", "delay_periods", "modulus", "crossover_rad_per_s",
///           "response": of the loop nearest to instability (report/run/loop_figures.hpp) or null},
///           "tuned": the same or null}, "rows": [{"travel", "start": {"max_contour_error_um", "quadrant_glitch_um", "rms_um",
///           "input_variation_V", "power_W"} or null, "tuned": the same or null}]}], "goal", "trade_off" and "machines" of each
///           controller (report/run/tune_choice.hpp), "warnings": of the paths}
///
/// Real time: no. Errors: io::InputError of files.

#include <nlohmann/json_fwd.hpp>
#include <stribeck/report/page/output.hpp>
#include <stribeck/sim/study/tuning.hpp>
#include <string>

namespace stribeck::report {

/// Why there are no tuned gains, and how near the nearest ones came; empty where there are some.
std::string why_none(const sim::TunedController& controller, const sim::TuneSpec& spec);

std::string text_table(const sim::TuneResult& result, const sim::TuneSpec& spec,
                       const sim::TradeOff& trade_off = {});

/// `warnings`: what the parameters assume; those of the paths are added.
nlohmann::ordered_json to_json(const sim::TuneResult& result, const sim::TuneSpec& spec,
                               const sim::TradeOff& trade_off = {},
                               const std::vector<std::string>& warnings = {});

struct TuneReportInput {
  sim::TuneResult result;
  sim::TuneSpec spec;
  std::string parameters;  ///< origin of the compensators' parameters
  std::string command;
  std::string version;
  std::vector<InputFile> inputs = {};  ///< that the result came from
  sim::TradeOff trade_off = {};
  std::vector<std::string> warnings = {};  ///< what the parameters assume
};

std::string tune_report(const TuneReportInput& input);

/// Writes DIR/index.html.
void write_tune_report(const PageFolders& folders, const TuneReportInput& input);

}  // namespace stribeck::report
