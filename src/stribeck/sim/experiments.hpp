#pragma once
/// The experiments of the thesis on the virtual machines, with their printed figures. docs/theory/experiments.md
/// holds the same list in words.
///
/// Every run starts from rest, reaches the printed law of motion within a run-in of 1 s, and is scored without the run-in. Printed
/// figures are shown beside results; they are never an input of a computation.
/// Real time: no.

#include <stribeck/sim/compare.hpp>

namespace stribeck::sim {

/// A printed figure.
struct Claim {
  std::string what;  ///< "mean contour error", as the thesis calls it
  double Metrics::*figure = nullptr;
  std::string controller;
  std::string
      against;  ///< another controller: `printed` is then a relative change; empty: `printed` is a value
  double printed = 0.0;    ///< −0.26, or SI
  std::string source;      ///< "§4.4.4.1"
  std::size_t travel = 0;  ///< of the setting
};

enum class ParameterSource { kIdentified, kPrinted };

/// One machine, one set of parameters and gains, one set of controllers.
struct Setting {
  std::string name;     ///< "ω 40/60 rad/s"; empty where there is only one
  std::string machine;  ///< name of a file in machines/, without .toml
  ParameterSource parameters = ParameterSource::kIdentified;
  CompareSpec spec;
  std::vector<Claim> claims;
};

struct Experiment {
  std::string id;
  std::string title;
  std::string source;                ///< place in the thesis
  std::vector<Setting> settings;     ///< the first is the one that `compare` runs
  std::vector<std::string> remarks;  ///< assumptions where the thesis gives no value or a wrong one
};

/// All experiments, in the order of the thesis.
std::vector<Experiment> experiments();

/// The experiment of this name; null when there is none.
const Experiment* find_experiment(const std::vector<Experiment>& all, std::string_view id);

/// Controllers beyond the thesis, (g) and following, with the law and the gains of one of the thesis's controllers.
std::vector<ControllerSpec> beyond_controllers(const ControllerSpec& thesis);

/// A plane curve travelled at a speed.
Travel along(path::Shape shape, double size, double speed, double laps = 2.0);

}  // namespace stribeck::sim

template <>
struct stribeck::EnumNames<stribeck::sim::ParameterSource> {
  static constexpr std::array names{
      std::pair{stribeck::sim::ParameterSource::kIdentified, std::string_view{"identified"}},
      std::pair{stribeck::sim::ParameterSource::kPrinted, std::string_view{"thesis"}}};
};
