#pragma once
/// How far the axes of a machine are commissioned: table and JSON.
///
///   json   {"schema": "stribeck.commission/1", "machine", "ready", "axes": [{"axis", "stage", "logs": [file], "held_out", "unchanged",
///           "mass_kg", "mass_ci95_kg": [from, to], "load_N", "velocity_range_mm_per_s": [from, to], "force_error_percent", "verdict",
///           "axis_file", "read": [text], "warnings": [text], "open": [text], "next": [command]}], "skipped": [text]}
///
/// Real time: no. Errors: none.

#include <nlohmann/json_fwd.hpp>
#include <stribeck/core/numbers.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::report {

/// How far an axis is.
enum class CommissionStage { kNoLog, kNotDetermined, kNotVerified, kRefused, kReady };
std::string_view name_of(CommissionStage stage) noexcept;

struct CommissionedAxisReport {
  std::string axis;
  CommissionStage stage = CommissionStage::kNoLog;
  std::vector<std::string> logs;  ///< from which the model was identified
  std::string held_out;           ///< log of the verification; empty: none
  bool unchanged = false;         ///< taken from the state: the inputs are the same
  bool rotary = false;            ///< angles are arcs at a radius of 1 m: mm stands for mrad, N for N m
  double mass = kNaN;             ///< [kg]
  double mass_low = kNaN;         ///< 95 %
  double mass_high = kNaN;
  double load = kNaN;          ///< [N]
  double velocity_low = kNaN;  ///< [m/s]
  double velocity_high = kNaN;
  double force_error = kNaN;           ///< of the verification [%]
  std::string verdict;                 ///< good, usable, not usable; empty: not verified
  std::string axis_file;               ///< that was promoted; empty: none
  std::string axis_file_sha256;        ///< of the bytes that were written
  std::vector<std::string> open;       ///< what the logs do not tell, or why there is no model
  std::vector<std::string> read = {};  ///< how the columns of the logs were read
  std::vector<std::string> warnings;   ///< of the identification
  std::vector<std::string> next;       ///< commands to type
};

struct CommissionReportInput {
  std::string machine;
  std::vector<CommissionedAxisReport> axes;
  std::vector<std::string> skipped;  ///< files of the folder that are no logs, with the reason

  [[nodiscard]] bool ready() const noexcept {
    for (const CommissionedAxisReport& a : axes) {
      if (a.stage != CommissionStage::kReady) return false;
    }
    return !axes.empty();
  }
};

std::string text_table(const CommissionReportInput& input);
nlohmann::ordered_json to_json(const CommissionReportInput& input);
/// One axis as in the state file, and back. Absent: the JSON is none of an axis.
nlohmann::ordered_json to_json(const CommissionedAxisReport& axis);
bool read_axis_state(const nlohmann::ordered_json& json, CommissionedAxisReport& out);

}  // namespace stribeck::report
