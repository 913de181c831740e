#pragma once
/// Origin of the compensators' parameters: identified here, printed by the thesis, or axis files.
/// Real time: no. Errors: InputError.

#include <map>
#include <stribeck/workflow/commission.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

struct ParameterOptions {
  std::string source = "identified";    ///< identified or thesis
  std::vector<std::string> axis_files;  ///< AXIS=FILE replaces the source for that axis and kind of model
  std::string lost_motion = "on";       ///< off: lost motion that is known is not compensated
};

struct Parameters {
  std::vector<sim::AxisKnowledge> knowledge;  ///< per axis of the machine
  std::vector<CommissionedAxis> axes;         ///< per axis of the machine; empty unless identified
  std::vector<std::string> files;  ///< per axis of the machine: the file that gave a model; empty: none did
  std::vector<double>
      told_from;  ///< per axis: smallest speed whose friction the logs behind the file tell [m/s]; 0: not known
  std::string words;                   ///< their origin in words
  std::vector<std::string> assumed{};  ///< axes whose identified model stands for the truth: warnings
};
/// Only the models that the controllers need, for the axes that they drive; other axes have no knowledge.
Parameters get_parameters(const sim::Machine& machine, const std::string& path,
                          const ParameterOptions& options, const sim::CompareSpec& spec);

/// Axis files that do not say the delay of the drive, on which every margin of a loop depends: one warning each. Of axes that rest, and
/// of drives with a loop of their own, the delay has no effect.
std::vector<std::string> unknown_delays(const sim::Machine& machine, const sim::CompareSpec& spec,
                                        const Parameters& parameters);

/// Axes whose drive closes a loop of its own: the margins count with the settings of that loop, but not with what a command needs to get
/// there. One warning each.
std::vector<std::string> uncounted_delays(const sim::Machine& machine, const sim::CompareSpec& spec);

/// Warns of axes that move for long below the speeds at which a model of theirs was identified; `axes` are those of the machine
/// that the result has. There a change of friction that adaptation found says nothing about the machine: its verdict becomes
/// that the model does not hold. At its reversals every axis is slow for a short time, which is no reason to warn. Of a file it is
/// the uncertainty in it that says from which speed on its logs tell the friction. What the parameters assume comes first.
std::vector<std::string> check_coverage(sim::CompareResult& result, const std::vector<std::size_t>& axes,
                                        const Parameters& parameters);

/// The warnings of check_coverage() beyond `assumed`, from one run of the first controller on each travel: for work that keeps no traces.
std::vector<std::string> coverage_of(const sim::Machine& machine, const sim::CompareSpec& spec,
                                     const Parameters& parameters);

/// What to say of an axis on which a controller goes without its Kalman observer (sim::calm()).
std::string without_kalman_observer(const std::string& axis, double delay_periods,
                                    const std::string& controller);

}  // namespace stribeck::workflow
