#pragma once
/// An entry of the board: somebody's identification, or somebody's controller.
///
///   identification   `command`        PROGRAM WORDS… ANSWER.toml LOG.csv…   writes the axis file (and ANSWER.json with intervals)
///                    `answers`        a folder with MACHINE-AXIS.toml, made from the logs of --write-logs
///   control          `command`        a program that answers one line per period (protocol.hpp)
///                    `shared_object`  a library with the interface of <stribeck/board.h>
///                    `controller`     a controller file of Stribeck
///
/// An entry file holds these as keys; paths in it count from its folder, and its command runs there.
/// Real time: no. Errors: InputError.

#include <array>
#include <stribeck/core/fields.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stribeck::workflow {

enum class Track { kIdentification, kControl };

}  // namespace stribeck::workflow

template <>
struct stribeck::EnumNames<stribeck::workflow::Track> {
  static constexpr std::array names{
      std::pair{stribeck::workflow::Track::kIdentification, std::string_view{"identification"}},
      std::pair{stribeck::workflow::Track::kControl, std::string_view{"control"}}};
};

namespace stribeck::workflow {

struct BoardEntry {
  std::string name;
  std::string label;
  std::string source;
  Track track = Track::kControl;
  std::string command;
  std::string shared_object;
  std::string controller;
  std::string answers;

  std::string folder{};  ///< in which the command runs; empty: that of this program

  static constexpr auto fields() {
    using E = BoardEntry;
    return std::tuple{
        field("name", &E::name, "short name, at most 16 letters, digits and hyphens"),
        field("label", &E::label, "what it is, in words, at most 60 characters"),
        field("source", &E::source, "paper, program or person that it comes from").or_default(),
        field("track", &E::track, "identification or control"),
        field("command", &E::command,
              "program and its arguments, split at blanks, run without a shell in the folder of this file")
            .or_default(),
        field("shared_object", &E::shared_object, "library with the interface of stribeck/board.h (control)")
            .or_default(),
        field("controller", &E::controller, "controller file of Stribeck (control)").or_default(),
        field("answers", &E::answers,
              "folder with an axis file MACHINE-AXIS.toml for each axis (identification)")
            .or_default()};
  }
  template <class Report>
  void validate(Report&& report) const {
    constexpr std::string_view kPermitted = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-";
    if (name.empty() || name.size() > 16 || name.find_first_not_of(kPermitted) != std::string::npos)
      report("name", "expected 1 to 16 letters, digits and hyphens, e.g. karnopp");
    if (label.empty() || label.size() > 60) report("label", "expected 1 to 60 characters");
    const auto count = static_cast<int>(!command.empty()) + static_cast<int>(!shared_object.empty()) +
                       static_cast<int>(!controller.empty()) + static_cast<int>(!answers.empty());
    if (count != 1) report("command", "expected one of command, shared_object, controller and answers");
    if (track == Track::kControl && !answers.empty())
      report("answers", "belongs to track = \"identification\"");
    if (track == Track::kIdentification && !shared_object.empty())
      report("shared_object", "belongs to track = \"control\"");
    if (track == Track::kIdentification && !controller.empty())
      report("controller", "belongs to track = \"control\"");
  }
};

BoardEntry read_entry(const std::string& file);

/// From an option: --identifier COMMAND, --answers DIR, --controller FILE.so, FILE.toml or COMMAND. Its name is that of the file.
BoardEntry entry_of(const std::string& option, const std::string& text);

/// Refuses two entries of a track with the same name.
void check_names(const std::vector<BoardEntry>& entries);

}  // namespace stribeck::workflow
