#pragma once
/// The page of a comparison: which controller is best and by how much, figures beside printed ones, the contour with its
/// error magnified, the quadrants, the friction that the compensators know, and the settings that reproduce it.
///
/// True friction is drawn only where it is passed in, and is labelled as true. Drawings show contour errors of the first
/// trial; tables give means over all trials and the standard deviation between them.
/// Real time: no. Errors:
/// io::InputError of files and of gnuplot.

#include <optional>
#include <span>
#include <stribeck/ident/result.hpp>
#include <stribeck/report/page/output.hpp>
#include <stribeck/report/printed.hpp>
#include <stribeck/sim/compare.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stribeck::report {

/// Parameters of the compensators of one axis, and their origin.
struct AxisEvidence {
  std::optional<sim::AxisKnowledge> knowledge = {};  ///< parameters of the controllers
  /// What was identified here, by kind of model: "conventional", "gaussian", "eccentric"; empty for printed parameters.
  std::vector<std::pair<std::string, ident::Result>> models = {};
  std::optional<friction::Model> truth = {};  ///< of a virtual machine only
  bool rotary = false;                        ///< the axis turns: forces are torques

  [[nodiscard]] const ident::Result* find(std::string_view kind) const {
    for (const auto& [name, result] : models) {
      if (name == kind) return &result;
    }
    return nullptr;
  }
};

struct CompareReportInput {
  sim::CompareResult result = {};
  std::vector<AxisEvidence> axes = {};      ///< as result.axes; may be shorter
  std::string experiment = {};              ///< "bi-table"; empty: none of the known ones
  std::string origin = {};                  ///< of the machine's numbers
  std::string parameters = {};              ///< where the compensators' parameters come from, in words
  std::string command = {};                 ///< reproduces the page
  std::string version = {};                 ///< of the program
  std::span<const PrintedTable> printed{};  ///< kBiaxialTables for bi-table; empty: nothing to compare with
  std::vector<std::string> warnings = {};   ///< from the caller, in addition to those found here
  std::vector<InputFile> inputs = {};       ///< that the result came from
  std::string what_if = {};  ///< file beside the page in which this machine can be changed; empty: none
};

/// The page as text.
std::string compare_report(const CompareReportInput& input);

/// Writes index.html, and the parts of the page where a folder for them is given.
void write_compare_report(const PageFolders& folders, const CompareReportInput& input);

}  // namespace stribeck::report
