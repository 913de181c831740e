#pragma once
/// Identified models on motion that they have not seen (ident/replay): table, JSON, and the
/// page with measured beside modelled force, measured beside predicted velocity of every model, reversals in detail, and
/// the closed loop.
///
///   json   {"schema": "stribeck.verify/1", "axis", "force_unit", "position_unit", "limits_percent": {"good", "usable"},
///           "verdicts": [{"file", "force_error_percent", "of_log_percent", "verdict"}], "parts": [{"log", "rows", "duration_s",
///           "restarts", "controller": {"command_error_percent", "added_rows_percent", "added_rms_N"} or null, "models":
///           [{"file", "force": {…}, "drift": {…}, "open_loop": {"velocity_rms_mm_per_s", "velocity_relative_percent",
///           "position_rms_um", "position_max_um", "rows_outside_range"}, "open_loop_free": {the same}, "closed_loop":
///           {the same, "force_rms_N", "force_relative_percent"} or null}]}], "warnings": [...]}
///
/// "open_loop" starts anew at every reversal. Keys whose unit would be wrong are null, and the number has a key without the
/// unit, as in identify (json.hpp).
///
/// Source: thesis §2.6, figs 2.30 and 2.31.
/// Real time: no.
/// Errors: io::InputError of files and of gnuplot.

#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <stribeck/ident/replay/drift_band.hpp>
#include <stribeck/ident/replay/model_force.hpp>
#include <stribeck/ident/replay/replay.hpp>
#include <stribeck/report/page/output.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::report {

struct VerifiedModel {
  std::string name = {};  ///< axis file, as the user named it
  ident::replay::OpenLoop open = {};
  ident::replay::ForceError force = {};
  ident::replay::DriftBand drift = {};
  std::optional<ident::replay::Replay> closed = {};
  double travel =
      std::numeric_limits<double>::quiet_NaN();  ///< of the record [m]: no drift beyond it is a number
  double told_from = 0.0;  ///< slowest speed whose friction the logs behind the file tell [m/s]
};

/// One record; a log that was cut at gaps has several.
struct VerifiedPart {
  ident::log::Record record = {};
  std::vector<VerifiedModel> models = {};
  std::optional<ident::replay::ControllerCheck> controller = {};
};

/// Largest error of the force [%]. Friction may be further off: it is a part of the force, and changes with temperature and load.
struct GradeLimits {
  static constexpr double kOfFriction = 2.0;  ///< limit of friction over that of the force
  double good = 5.0;
  double usable = 15.0;
};

/// Undecided: the error is too large, but not larger than what the log makes a right model miss, or the log is mostly slower than the
/// model tells.
enum class Grade { kGood, kUsable, kUndecided, kNotUsable };
std::string_view name_of(Grade grade) noexcept;

/// A model on all parts together.
struct Verdict {
  std::string name;
  double error =
      0.0;  ///< share of the force, with shift and phases of each record; without it of the velocity
  bool moving = false;  ///< of the force where the axis moves: rests would make most of the error
  bool settled =
      false;  ///< and where friction has settled after a reversal: the model has no pre-sliding, and is no more than usable
  bool of_force = true;
  double of_log = std::numeric_limits<double>::quiet_NaN();  ///< share that the log makes a right model miss
  ident::replay::FrictionChange
      friction{};  ///< of the logs, beside that of the model, in both directions together
  ident::replay::FrictionChange forward{}, backward{};  ///< in one direction
  ident::replay::FrictionChange load{};  ///< constant force beside that of the model: its "share" is in N
  double untold = 0.0;                   ///< share of the rows in motion that are slower than the model tells
  double told_from = 0.0;                ///< [m/s]
  Grade grade = Grade::kNotUsable;
};

struct VerifyReportInput {
  std::string axis = {};
  std::vector<VerifiedPart> parts = {};
  std::vector<std::string> warnings = {};
  std::string source = {};  ///< log, as the user named it
  std::string command = {};
  std::string version = {};
  GradeLimits limits = {};
  std::vector<InputFile> inputs = {};  ///< that the result came from
};

std::vector<Verdict> verdicts(const VerifyReportInput& input);
/// At least one model is good or usable.
bool usable(const VerifyReportInput& input);

std::string text_table(const VerifyReportInput& input);

nlohmann::ordered_json to_json(const VerifyReportInput& input);

std::string verify_report(const VerifyReportInput& input);

/// Writes index.html, and the parts of the page where a folder for them is given.
void write_verify_report(const PageFolders& folders, const VerifyReportInput& input);

}  // namespace stribeck::report
