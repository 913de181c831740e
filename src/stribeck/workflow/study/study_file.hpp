#pragma once
/// The file of a study: which machine, what of it varies and how, which controllers and figures of merit.
///
/// Paths in it count from the folder of the file.
/// Real time: no.

#include <cstdint>
#include <optional>
#include <stribeck/core/fields.hpp>
#include <stribeck/sim/uncertainty/design.hpp>
#include <stribeck/sim/uncertainty/distribution.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

/// Most runs of a study.
inline constexpr std::uint64_t kMostRuns = 5'000'000;
inline constexpr std::size_t kMostFactors = 50;

enum class StudyParameters { kIdentified, kThesis };

/// Whose logs the compensators of a run come from.
enum class StudyIdentification { kOnce, kRepeated, kOfEachMachine };

struct StudyFactor {
  std::string key;
  std::optional<sim::AnyDistribution<double>> scale;
  std::optional<sim::AnyDistribution<std::string>> value;

  /// Whether it stands for everything that an axis file leaves open.
  [[nodiscard]] bool is_uncertainty() const {
    const std::size_t dot = key.find('.');
    return dot != std::string::npos && std::string_view(key).substr(dot) == ".uncertainty";
  }

  static constexpr auto fields() {
    using F = StudyFactor;
    return std::tuple{
        field(
            "key", &F::key,
            "what varies: AXIS.KEY, as the key stands below [axes.AXIS.plant] of the machine file (x.mass, "
            "x.friction.dynamics.sigma0), *.KEY for all moved axes alike, or AXIS.friction, "
            "AXIS.friction.coulomb, AXIS.friction.viscous, AXIS.friction.stiffness; AXIS.uncertainty, without scale and value: "
            "the identified model of its axis file is the machine, and what the logs leave open of it varies"),
        field("scale", &F::scale, "by which factor the value of the machine file is multiplied: pure numbers")
            .or_default(),
        field("value", &F::value,
              "the value itself, in place of that of the machine file: texts with units, "
              "e.g. \"20 N\"")
            .or_default()};
  }
  template <class Report>
  void validate(Report&& report) const {
    if (is_uncertainty()) {
      if (scale || value)
        report("key", "takes neither scale nor value: the axis file says how far its model may be off");
      return;
    }
    if (key.find(".uncert") != std::string::npos) {
      report("key", "expected AXIS.uncertainty, for all that the axis file of AXIS leaves open");
      return;
    }
    if (scale.has_value() == value.has_value())
      report("key", "expected one of scale and value: what the factor multiplies, or what it is");
  }
};

struct StudyMotion {
  std::string experiment;
  std::string path;
  std::string size;
  double laps = 2.0;
  double settle_laps = 0.0;
  std::vector<std::string> speeds;

  static constexpr auto fields() {
    using M = StudyMotion;
    return std::tuple{
        field("experiment", &M::experiment,
              "as --experiment of compare; left out: by the axes of the machine")
            .or_default(),
        field("path", &M::path,
              "circle, eight, trifolium, a G-code file or a CSV file of points, as --path of compare")
            .or_default(),
        field("size", &M::size, "size of a shape, as --size of compare").or_default(),
        field("laps", &M::laps, pure_number().positive().at_most(1e6), "laps that are scored").or_default(),
        field("settle_laps", &M::settle_laps, pure_number().not_negative().at_most(1e6),
              "laps before the scored ones, in which adaptation settles")
            .or_default(),
        field("speeds", &M::speeds, "speeds along the path, as --speed of compare, e.g. [\"9.5 mm/s\"]")
            .or_default()};
  }
};

struct StudyFile {
  std::string machine;
  std::vector<std::string> controllers;
  std::vector<std::string> figures{"max_contour_error_um", "rms_um",
                                   "mean_abs_um",          "quadrant_glitch_um",
                                   "input_variation_V",    "mean_abs_tracking_um"};
  sim::Sampling sampling = sim::Sampling::kLatinHypercube;
  std::uint64_t samples = 1000;
  bool indices = false;
  std::uint64_t seed = 1;
  StudyParameters parameters = StudyParameters::kIdentified;
  StudyIdentification identification = StudyIdentification::kOnce;
  std::vector<std::string> axis_files;
  StudyMotion motion;
  std::vector<StudyFactor> factors;

  static constexpr auto fields() {
    using S = StudyFile;
    return std::tuple{
        field("machine", &S::machine, "machine file"),
        field("controllers", &S::controllers,
              "ids of the experiment (a, b, …), names of built-in controllers, or controller files"),
        field("figures", &S::figures, "figures of merit, by their names in the JSON of compare").or_default(),
        field("sampling", &S::sampling,
              "how the factors are drawn; grid: every combination of lists and steps")
            .or_default(),
        field("samples", &S::samples, pure_number().at_least(1.0).at_most(5e6),
              "number of draws; of a Sobol' sequence best a power of two")
            .or_default()
            .when([](const S& s) { return s.sampling != sim::Sampling::kGrid; },
                  "goes with sampling other than \"grid\""),
        field("indices", &S::indices,
              "Sobol' indices: which factor has which share of the variance; each sample then takes "
              "2 + (number of factors) runs")
            .or_default()
            .when([](const S& s) { return s.sampling != sim::Sampling::kGrid; },
                  "goes with sampling other than \"grid\""),
        field("seed", &S::seed, "of the draws and of the noise").or_default(),
        field("parameters", &S::parameters,
              "of the compensators: identified (from simulated logs of the machine as its file says it) or "
              "thesis (as printed there)")
            .or_default(),
        field(
            "identification", &S::identification,
            "once: from logs of the machine as its file says it; repeated: the same again in every sample, under other noise; "
            "of-each-machine: from logs of the machine of every run")
            .or_default()
            .when([](const S& s) { return s.parameters == StudyParameters::kIdentified; },
                  "goes with parameters = \"identified\""),
        field("axis_files", &S::axis_files,
              "axis files that replace the identified parameters, each \"AXIS=FILE\"")
            .or_default(),
        field("motion", &S::motion, "path and speeds").or_default(),
        field(
            "factors", &S::factors,
            "what varies, one [[factors]] each; they act in this order; may be left out with identification = "
            "\"repeated\"")
            .or_default()};
  }
  template <class Report>
  void validate(Report&& report) const {
    if (factors.empty() && identification != StudyIdentification::kRepeated)
      report("factors", "got none, expected one or more (write [[factors]] with a key and a scale)");
    if (factors.empty() && indices)
      report("indices", "there is no factor whose share they could tell (leave it out)");
    if (factors.empty() && sampling == sim::Sampling::kGrid)
      report("sampling", "a grid needs factors (choose another sampling)");
    if (factors.size() > kMostFactors) report("factors", "got more than 50 factors, expected at most 50");
    if (controllers.empty()) report("controllers", "got an empty list, expected one or more, e.g. [\"f\"]");
    if (figures.empty())
      report("figures", "got an empty list, expected one or more (leave the key out for six)");
  }
};

}  // namespace stribeck::workflow

template <>
struct stribeck::EnumNames<stribeck::workflow::StudyParameters> {
  using enum stribeck::workflow::StudyParameters;
  static constexpr std::array names{std::pair{kIdentified, std::string_view{"identified"}},
                                    std::pair{kThesis, std::string_view{"thesis"}}};
};

template <>
struct stribeck::EnumNames<stribeck::workflow::StudyIdentification> {
  using enum stribeck::workflow::StudyIdentification;
  static constexpr std::array names{std::pair{kOnce, std::string_view{"once"}},
                                    std::pair{kRepeated, std::string_view{"repeated"}},
                                    std::pair{kOfEachMachine, std::string_view{"of-each-machine"}}};
};
