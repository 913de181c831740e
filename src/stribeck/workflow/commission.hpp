#pragma once
/// Commissions an unknown axis of a virtual machine: excites it, records, and identifies the models for its compensators.
/// The models use only the commissioning data of the machine file and the logs.
/// Real time: no. Errors: ident::Refused, sim::Refused.

#include <cstdint>
#include <optional>
#include <stribeck/ident/excitation/excitation.hpp>
#include <stribeck/ident/lost_motion/lost_motion.hpp>
#include <stribeck/ident/result.hpp>
#include <stribeck/io/log/log.hpp>
#include <stribeck/sim/compare.hpp>
#include <stribeck/sim/recording.hpp>

namespace stribeck::workflow {

/// A model of an axis, its origin, and the result with its intervals.
struct CommissionedModel {
  std::string kind;                  ///< "conventional", "gaussian", "eccentric" or "whole"
  std::vector<std::string> sources;  ///< names of the logs, which CommissionedAxis::logs holds
  ident::Result result;
};

/// One excitation of an axis and what was recorded.
struct CommissionedLog {
  std::string file;
  ident::excitation::ExcitationMethod method = ident::excitation::ExcitationMethod::kPulses;
  sim::Recording recording;
};

/// Records of one axis and the models identified from them.
struct CommissionedAxis {
  std::vector<CommissionedLog> logs;
  std::vector<CommissionedModel> models;
  sim::AxisKnowledge knowledge;
  std::vector<std::string> assumed;  ///< in place of what the logs do not tell, in sentences
  std::optional<ident::lost_motion::LostMotion>
      lost_motion{};  ///< absent: one encoder only, or a loop over the table

  [[nodiscard]] const ident::Result* find(std::string_view kind) const;
};

/// The models that a set of controllers needs.
struct Needs {
  bool conventional = false;
  bool gaussian = false;
  bool eccentric = false;
  bool whole = false;
  bool mass_alone = false;  ///< no model of friction: any model that tells the mass will do

  static Needs of(const std::vector<sim::ControllerSpec>& controllers);
  /// The models that either of two needs.
  friend Needs operator|(const Needs& a, const Needs& b) noexcept {
    return {a.conventional || b.conventional, a.gaussian || b.gaussian, a.eccentric || b.eccentric,
            a.whole || b.whole, a.mass_alone && b.mass_alone};
  }
};

/// Number of periods of the sine in the main experiment.
inline constexpr int kSinePeriods = 8;
/// Number of periods of the sine about the middle, for the position map.
inline constexpr int kPositionPeriods = 4;

/// `known` replaces the rough estimate in the commissioning data.
ident::excitation::Excitation design(const sim::Machine& machine, std::size_t axis,
                                     ident::excitation::ExcitationMethod method, int periods,
                                     const std::optional<ident::excitation::RoughDrive>& known = {});
/// Runs an excitation on the virtual machine.
sim::Recording play(const sim::Machine& machine, std::size_t axis, const std::vector<double>& reference,
                    const std::vector<double>& force, std::uint64_t seed);
/// Excites, records and identifies: pulses, then a sine for the Gaussian model and a sine about the middle for the eccentric one.
/// The whole model, with bristles, comes from the pulses and the sine that the machine has. The conventional model comes from
/// pulses on machines with one or two axes, from jogs on larger ones, as in the thesis. On a machine without printed parameters
/// pulses, a sine and jogs give the whole model, which stands for the others: without jogs nothing would be known of
/// slow motion.
CommissionedAxis commission_axis(const sim::Machine& machine, std::size_t axis, const Needs& needs,
                                 std::uint64_t seed);

/// The kinds of model that an axis lacks, from the best it has: that model itself, and in place of the conventional one its map,
/// if it is one of Coulomb, viscous and Stribeck friction, or else the line through each side of it.
void fill_in(sim::AxisKnowledge& knowledge, const sim::MachineAxis& axis);

/// A recording as a log file contains it.
io::Log as_log(const sim::Recording& recording);
ident::log::Record as_record(const sim::Recording& recording, const std::string& source);

}  // namespace stribeck::workflow
