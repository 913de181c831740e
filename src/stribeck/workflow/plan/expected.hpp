#pragma once
/// What a log would tell of an axis, before it is recorded: the excitation is run on a virtual axis that stands for the real one, and
/// the log is identified as a real one would be. The intervals are those to expect.
///
///   stand-in   the axis file of an earlier identification; without one the rough mass m and friction F of the machine file:
///              level 1.08·F forward and 0.92·F backward with a Stribeck rise of 20 %, a hill of 6 % in the middle of the speeds, viscous
///              friction of 0.3·F at the limit of speed, a screw of 3 %, bristles that build friction up over 5 µm (or four steps of the encoder)
///   both       noise of 2 % of F that lasts 20 ms, the step of the encoder from the data sheet, 1.5 periods of delay where none is known
///
/// Not modelled: what the stand-in does not have, e.g. an axial mode, drift: a log of an axis that has it tells less. An axis of simpler
/// friction tells more.
/// Real time: no.
/// Errors: InputError for a machine file without force limit or encoder step.

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <stribeck/core/fields.hpp>
#include <stribeck/ident/excitation/excitation.hpp>
#include <stribeck/ident/log/record.hpp>
#include <stribeck/workflow/identify.hpp>
#include <stribeck/workflow/machine/description.hpp>
#include <string>
#include <utility>
#include <vector>

namespace stribeck::workflow {

/// What is wanted of an axis. EnumNames has the words of the option.
enum class Wanted { kMass, kFriction, kBristles, kDelay };
inline constexpr std::size_t kWantedCount = 4;

/// Half of the 95 % interval: of mass, friction and break-away distance as a share of the value, of the delay in control periods.
/// Infinite: such a log does not determine it.
struct ExpectedHalf {
  static constexpr double kOpen = std::numeric_limits<double>::infinity();
  std::array<double, kWantedCount> half{kOpen, kOpen, kOpen, kOpen};
  bool at_rest = false;  ///< static friction is told as well

  [[nodiscard]] double operator[](Wanted w) const { return half[static_cast<std::size_t>(w)]; }
  double& operator[](Wanted w) { return half[static_cast<std::size_t>(w)]; }
  /// Narrow enough to compensate with.
  [[nodiscard]] bool good(Wanted w) const;
};

/// What an identification has told, in the same measure.
ExpectedHalf told_by(const Identification& found, const AxisDescription& axis, double period);
/// What it leaves too wide to compensate with: mass, friction or bristles. A log without delay shows none, so that the delay is not
/// asked for. Bristles that the encoder cannot resolve are not asked for either.
std::vector<Wanted> not_yet(const Identification& found, const AxisDescription& axis, double period);

/// One method of excitation.
struct CandidateLog {
  ident::excitation::ExcitationMethod method = ident::excitation::ExcitationMethod::kPulses;
  std::string refused;    ///< why there is no such log, or why it tells nothing; empty: there is one
  double duration = 0.0;  ///< [s]
  ExpectedHalf expected;
};

/// (done, all) of the steps of a plan; from any thread, one call at a time.
using Progress = std::function<void(std::size_t, std::size_t)>;

/// The virtual axis that stands for a real one, and the logs that it gives.
class StandIn {
 public:
  /// `known`: axis file; empty: none yet.
  StandIn(const MachineDescription& machine, const std::string& file, std::size_t axis,
          const std::string& known);

  /// Designs, runs and identifies a log of each method alone, on all cores; one that takes more than `longest` [s] is refused.
  std::vector<CandidateLog> logs_of(std::span<const ident::excitation::ExcitationMethod> methods,
                                    double longest, const Progress& progress = {});
  /// What several of these logs tell together.
  ExpectedHalf together(const std::vector<ident::excitation::ExcitationMethod>& methods) const;

 private:
  using Records = std::map<ident::excitation::ExcitationMethod, ident::log::Record>;
  /// The log of one method, and what it tells.
  std::pair<CandidateLog, ident::log::Record> log_of(ident::excitation::ExcitationMethod method,
                                                     double longest) const;
  ExpectedHalf told_together(const std::vector<const ident::log::Record*>& records) const;

  MachineDescription machine_;  ///< with the stand-in as plant of the axis
  MachineDescription real_;     ///< without: designs are as careful as for the real axis
  std::size_t axis_;
  std::string known_;
  Records records_;
};

}  // namespace stribeck::workflow

template <>
struct stribeck::EnumNames<stribeck::workflow::Wanted> {
  using W = stribeck::workflow::Wanted;
  static constexpr std::array names{
      std::pair{W::kMass, std::string_view{"mass"}}, std::pair{W::kFriction, std::string_view{"friction"}},
      std::pair{W::kBristles, std::string_view{"bristles"}}, std::pair{W::kDelay, std::string_view{"delay"}}};
};
