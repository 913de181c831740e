#pragma once
/// Programs that parameters are exported to. One function per target; the list of them is in targets.cpp.
///
/// A further target is a folder with one source file that defines its Target, and its name in targets.cpp.
///
/// Real time: no.
/// Errors: InputError naming file or option; options that a target does not take are refused by it.

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::targets {

/// What is to be exported and how, as a user says it: texts with units; empty where nothing was said.
struct ExportRequest {
  std::vector<std::string> files;       ///< axis files, or one machine file
  std::string output;                   ///< file or folder
  std::vector<std::string> names;       ///< of each axis in the target
  std::string omega;                    ///< double pole of the position loops
  std::string feedforward;              ///< none, steady, dynamic or reversal
  bool lincurve = false;                ///< a table of the steady friction in place of controllers
  std::string speed;                    ///< largest of the table
  std::string parameters;               ///< of a machine: identified or commissioning
  std::vector<std::string> axis_files;  ///< AXIS=FILE, in place of these
  std::string command;                  ///< how the export was asked for, for the comment at its head
};

struct Exported {
  nlohmann::ordered_json json;  ///< for programs; holds the error that the target makes, where it makes one
  std::string text;             ///< the same for people
};

struct Target {
  std::string_view name;    ///< word of --to
  std::string_view takes;   ///< which files
  std::string_view writes;  ///< which output
  std::string_view error;   ///< what is lost on the way, and where its size is told
  Exported (*write)(const ExportRequest&);
};

/// All there are.
std::span<const Target* const> all_targets();

/// By its name; null when there is none.
const Target* find_target(std::string_view name);

}  // namespace stribeck::targets
