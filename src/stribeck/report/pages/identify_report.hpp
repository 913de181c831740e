#pragma once
/// The page of an identification: the map with the fit and its 95 % band; parameters with their intervals and whether the data
/// determine them; the measured and the modelled force over time; the residual against velocity, position and time, and its spectrum over position; the models that were
/// tried; what the log cannot tell; warnings. Where the log has no scale, all values are in its own units
/// (shown_units.hpp).
/// Real time: no.
/// Errors: io::InputError of files and of gnuplot.

#include <optional>
#include <stribeck/ident/lost_motion/lost_motion.hpp>
#include <stribeck/ident/residual/residual.hpp>
#include <stribeck/ident/result.hpp>
#include <stribeck/report/page/output.hpp>
#include <stribeck/report/plot/force_plot.hpp>
#include <string>
#include <vector>

namespace stribeck::report {

struct IdentifyReportInput {
  std::string axis = {};
  std::vector<ident::Result> results = {};  ///< the chosen one first; others are shown beside it
  std::string source = {};                  ///< log or recording, as the user named it
  std::string command = {};
  std::string version = {};
  std::optional<ident::residual::Quality> quality = {};            ///< what the chosen one leaves, over time
  std::vector<InputFile> inputs = {};                              ///< that the result came from
  std::optional<ident::lost_motion::LostMotion> lost_motion = {};  ///< of an axis with two encoders
  std::optional<ForceOverTime> force = {};  ///< of the longest record, by the chosen one
};

/// Kind of result and method, e.g. "conventional model by jog"; a method without a model in plain words.
std::string headline(const ident::Result& result);
/// The data used: "5000 rows", "8 slips".
std::string counted(const ident::Result& result);

std::string identify_report(const IdentifyReportInput& input);

/// Writes index.html, and the parts of the page where a folder for them is given.
void write_identify_report(const PageFolders& folders, const IdentifyReportInput& input);

}  // namespace stribeck::report
