#pragma once
/// What varies in a study: keys of the machine file, found and checked once, then set for every run.
///
///   AXIS.KEY                  key below [axes.AXIS.plant]; items of lists count from 1: x.friction.eccentric[1].amplitude
///   AXIS.friction             level and viscous part of the whole curve; proportional periodic terms with it
///   AXIS.friction.coulomb     the level alone            AXIS.friction.viscous    the viscous part alone
///   AXIS.friction.stiffness   stiffness of pre-sliding; its damping by the square root, the same damping ratio
///   *.…                       all axes that move, with one draw
///
///   AXIS.uncertainty          the model of its axis file is the plant, and changes by what the logs leave open: one factor for
///                             each deviation, AXIS.uncertainty.1 …, normal, in standard deviations; *: each axis by itself
///
/// The four of friction are scales. Uncertainties act first. Factors change the truth of the plant alone: controllers keep the models,
/// limits and name plates of the nominal machine. Keys of `drive` are refused, because the simulated loop converts forces with the
/// drive's own gain.
/// Real time: no. Errors: InputError with the file, the line and the key of the factor.

#include <optional>
#include <stribeck/friction/uncertainty.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/sim/axis_file.hpp>
#include <stribeck/sim/machine.hpp>
#include <stribeck/workflow/study/study_file.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

struct BoundFactor {
  std::string key;   ///< as the file has it
  std::string unit;  ///< of its values in files; empty: a scale or a pure number
  double to_unit = 1.0;
  bool is_scale = false;
  sim::Distribution distribution;
  std::vector<std::size_t> axes;                        ///< of the machine
  std::string below;                                    ///< the key without its axis
  std::optional<friction::ModelDeviation> deviation{};  ///< of the model of an axis file
  double rise_speed = 0.0;                              ///< that belongs to it [m/s]
  double told_from = 0.0;                               ///< smallest speed whose friction its logs tell [m/s]

  /// Head of its column: "x.mass [N s2/mm]", "x.friction (scale)".
  [[nodiscard]] std::string head() const;
  /// As the file writes it.
  [[nodiscard]] double shown(double si) const { return si * to_unit; }
  /// Its distribution in words.
  [[nodiscard]] std::string in_words() const;
};

/// An axis file of the study.
struct KnownAxis {
  std::size_t axis = 0;  ///< of the machine
  std::string path;
  sim::AxisFile file;
};

/// Finds and checks all of them; `moved` are the axes that the study moves, `nominal` is a machine with_models(). Throws all problems
/// together.
std::vector<BoundFactor> bind_factors(const StudyFile& study, const io::Node& node, const std::string& file,
                                      const sim::Machine& nominal, const std::vector<std::size_t>& moved,
                                      const std::vector<KnownAxis>& known = {});

/// The nominal machine with these values, in SI.
sim::Machine with_values(const sim::Machine& nominal, const std::vector<BoundFactor>& factors,
                         const std::vector<double>& values);

/// Why a machine file with these parameters would be refused, with the key; empty: it would not.
std::string why_impossible(const sim::Machine& machine, const std::vector<std::size_t>& axes);

}  // namespace stribeck::workflow
