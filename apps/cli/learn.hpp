#pragma once
/// The whole way from an unknown axis of a virtual machine to the models its compensators use: excite,
/// record, identify. Nothing but the commissioning data of the machine file and the logs goes into the
/// models.

#include <cstdint>
#include <optional>
#include <stribeck/ident/excitation.hpp>
#include <stribeck/ident/result.hpp>
#include <stribeck/io/log.hpp>
#include <stribeck/sim/compare.hpp>
#include <stribeck/sim/recording.hpp>

namespace stribeck::cli {

/// What was recorded of one axis and what came out of it.
struct Learned {
  sim::Recording pulses;
  sim::Recording sine;
  ident::Result conventional;  ///< unbiased least squares from the pulses
  ident::Result gaussian;      ///< velocity–friction map from pulses and sine together
  sim::AxisKnowledge knowledge;
};

/// Periods of the sine that the main job records.
inline constexpr int kSinePeriods = 8;

/// method is pulses, jog or sine; `known` replaces the commissioning data's rough idea of the drive.
ident::Excitation design(const sim::Machine& machine, std::size_t axis, const std::string& method,
                         int periods, const std::optional<ident::RoughDrive>& known = {});
/// Plays an excitation on the virtual machine.
sim::Recording play(const sim::Machine& machine, std::size_t axis, const std::vector<double>& reference,
                    const std::vector<double>& force, std::uint64_t seed);
/// Throws ident::Refused when a result is no answer: a mass that is not positive or not determined, numbers that are not finite.
void refuse_nonsense(const ident::Result& result, const std::string& source);
/// What goes into an axis file.
friction::AxisModel as_model(const ident::Result& result);
Learned learn_axis(const sim::Machine& machine, std::size_t axis, std::uint64_t seed);

/// Writes a page of a log's columns over time; nothing when `directory` is empty.
void report_log(const std::string& directory, const io::Log& log, const std::string& title,
                const std::string& summary);

/// A recording as a log file has it.
io::Log as_log(const sim::Recording& recording);
ident::Record as_record(const sim::Recording& recording, const std::string& source);

}  // namespace stribeck::cli
