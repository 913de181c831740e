#pragma once
/// Programs to which parameters can be exported. Each target is one function; targets.cpp lists them.
///
/// A new target is a folder with one source file that defines its Target, and its name in targets.cpp.
/// A target that holds the steady friction alone is one function in steady/: steady_target.hpp tells how.
///
/// Real time: no.
/// Errors: InputError naming file or option. A target refuses options that it does not take.

#include <functional>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::targets {

/// How far a search of many circles has come: "fanuc x", circles done, circles in all. Called under a lock.
using ExportProgress = std::function<void(std::string_view what, std::size_t done, std::size_t all)>;

/// The options of an export, as a user gives them: texts with units; empty where not given.
struct ExportRequest {
  std::vector<std::string> files;       ///< axis files, or one machine file
  std::string output;                   ///< file or folder
  std::vector<std::string> names;       ///< names of the axes in the target
  std::string omega;                    ///< double pole of the position loops
  std::string feedforward;              ///< none, steady, dynamic or reversal
  bool lincurve = false;                ///< a table of the steady friction instead of controllers
  std::string speed;                    ///< largest speed of the table
  std::string parameters;               ///< parameters of a machine file: identified or commissioning
  std::vector<std::string> axis_files;  ///< AXIS=FILE replaces these parameters
  std::string gain;                     ///< force of one unit of the target: "12.5 N/%"
  std::string lead;                     ///< travel per turn of the motor
  std::string resolution;               ///< step of the encoder
  std::string zero;                     ///< position of the axis at which the motor's encoder reads zero
  std::string controller;               ///< file of the loop, or name of a built-in one
  std::string machine;                  ///< virtual machine for the prediction of the contour error
  std::string period;                   ///< control period
  std::string size;                     ///< radius of the user's circle
  std::string command;                  ///< command of the export, for the comment at its head
  ExportProgress progress;              ///< may be empty
};

/// The files that an export reads.
std::vector<std::string> inputs_of(const ExportRequest& request);

struct Exported {
  nlohmann::ordered_json json;  ///< for programs; contains the error of the export where there is one
  std::string text;             ///< the same as text for people
};

struct Target {
  std::string_view name;    ///< word of --to
  std::string_view takes;   ///< input files
  std::string_view writes;  ///< output files
  std::string_view error;   ///< what is lost in the export, and where its size is reported
  std::function<Exported(const ExportRequest&)> write;
};

/// All targets.
std::span<const Target> all_targets();

/// Letters of axes in the order of their numbers.
inline constexpr std::string_view kAxisLetters = "xyzabcuvw";
/// Which axis of a control each name is, from 0: the place of its letter in X, Y, Z, A, B, C, U, V, W, where all are such letters and
/// differ; else their order.
std::vector<std::size_t> axis_numbers(const std::vector<std::string>& names);
/// What the axis files call their axes; empty texts where a file does not say it.
std::vector<std::string> axes_in_files(const ExportRequest& request);

/// Whether one of the files is an axis file of a rotary axis.
bool any_rotary(const ExportRequest& request);
/// What an export does not show of its axis files, a line each: what the units of a rotary axis mean, a backlash; empty: nothing.
std::string axis_notes(const ExportRequest& request);

/// The target of this name; null when there is none.
const Target* find_target(std::string_view name);

}  // namespace stribeck::targets
