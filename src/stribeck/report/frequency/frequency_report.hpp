#pragma once
/// The measured frequency response of axes: answer in words, table, CSV, JSON, page.
///
///   json   {"schema": "stribeck.frequency/1", "axes": [{"axis", "sources", "method", "period_s", "stretches", "segments", "rows",
///           "rows_used", "speed_mm_per_s", "slowest_mm_per_s", "structure", "reason", "mass_kg", "viscous_N_s_per_m", "delay_s",
///           "resonance_Hz", "antiresonance_Hz", "damping", each {"value", "low", "high"} or null, "highest_Hz", "misfit_percent",
///           "excess", "rule", "proposed", "with_notch", "present": {"omega_rad_per_s", "mass_kg", "stable", "phase_deg", "sure_phase_deg",
///           "gain_dB", "sure_gain_dB", "crossover_rad_per_s", "limit", "limit_Hz", "notch"} or null, "closed_loop_bandwidth_Hz",
///           "lines": [{…}], "answer", "warnings"}]}
///          Where the scale of the force is not known, keys in kg and N are null, and the numbers stand under "mass", "viscous" and
///          "gain", in the units of the log.
///
/// Real time: no. Errors: io::InputError of files and of gnuplot.

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <stribeck/ident/frequency/plant_fit.hpp>
#include <stribeck/io/log/log.hpp>
#include <stribeck/report/page/output.hpp>
#include <stribeck/report/shown_units.hpp>
#include <stribeck/sim/study/measured_loop.hpp>
#include <string>
#include <vector>

namespace stribeck::report {

struct FrequencyAxis {
  std::string name;  ///< of the axis; empty: none was given
  std::string sources;
  ShownUnits units{};
  ident::frequency::Response response;
  ident::frequency::PlantFit fit;
  sim::MeasuredPlant plant;  ///< lines that are determined, and between them the shape of the fit
  sim::MarginRule rule;
  sim::LoopProposal proposed;
  bool resonance_limits = false;  ///< what a faster loop violates first lies at the resonance
  std::optional<sim::LoopProposal> with_notch{};
  std::optional<sim::MeasuredGains> present{};  ///< of the machine file
  bool present_is_proposed = false;  ///< the machine file holds no ω: its default is what `present` has
  sim::MeasuredMargins present_margins{};
  std::vector<std::string> warnings{};
};

struct FrequencyReportInput {
  std::vector<FrequencyAxis> axes;
  std::string command;
  std::string version;
  std::vector<InputFile> inputs = {};
};

/// What the user asked for, one sentence each, the most important first.
std::vector<std::string> answer_of(const FrequencyAxis& axis);
/// Frequency up to which the axis follows its reference within 3 dB [Hz]; NaN: not seen, or no reference.
double closed_loop_bandwidth(const FrequencyAxis& axis);

std::string text_table(const FrequencyReportInput& input);
nlohmann::ordered_json to_json(const FrequencyReportInput& input);
/// A row for each line.
io::Log table_of(const FrequencyAxis& axis);

std::string frequency_report(const FrequencyReportInput& input);
void write_frequency_report(const PageFolders& folders, const FrequencyReportInput& input);

}  // namespace stribeck::report
