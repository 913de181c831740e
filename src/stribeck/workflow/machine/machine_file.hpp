#pragma once
/// The machine file as people write it: what a verb needs of it, what it says in derived numbers, and a commented one to begin
/// with.
///
/// Real time: no.
/// Errors: InputError naming file and key.

#include <nlohmann/json.hpp>
#include <optional>
#include <stribeck/core/field_types.hpp>
#include <stribeck/ident/log/record.hpp>
#include <stribeck/ident/result.hpp>
#include <stribeck/sim/axis_file.hpp>
#include <stribeck/workflow/machine/description.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stribeck::workflow {

MachineDescription read_description(const std::string& file);
/// The same from a text; `file` is for messages.
MachineDescription parse_description(std::string_view text, const std::string& file);

/// Whether a file is a machine file and not an axis file or a log: it has a table `axes`. False where it cannot be read.
bool describes_machine(const std::string& file);

/// An axis file; a machine file or a controller file in its place is called so. Errors: InputError with file, line and key.
sim::AxisFile read_axis_file(const std::string& file);

/// What to do with an axis that has neither a truth nor an identified model.
enum class AxisWithoutTruth {
  kRefused,
  kLeftOut,  ///< it does not move (sim::Machine::left_out); refused where no axis is left
};

/// A virtual machine. An axis without a truth is simulated as its identified model where `axis_files` (AXIS=FILE) has one
/// (model_as_truth.cpp).
sim::Machine read_virtual_machine(const std::string& file, const std::vector<std::string>& axis_files = {},
                                  AxisWithoutTruth without_truth = AxisWithoutTruth::kRefused);

/// Makes the model that was identified of an axis its truth, with force, encoder and loop of the machine file. Noise, drift, an axial
/// mode and everything else that the model does not hold are left out; a model without pre-sliding gets kBreakAway.
/// `machine_file` and `axis_file` are for messages and for the note in MachineAxis::truth_from.
plant::AxisParams model_as_truth(const AxisDescription& axis, const std::string& name, double sample_time,
                                 const std::string& machine_file, const std::string& axis_file);
/// The same of a model that was read or made already.
plant::AxisParams model_as_truth(const AxisDescription& axis, const std::string& name, double sample_time,
                                 const std::string& machine_file, const std::string& axis_file,
                                 const sim::AxisFile& model);
/// Travel in which friction builds up where a model does not say it: usual for ball screws with rolling guides [m].
inline constexpr double kBreakAway = 5e-6;

/// Whether parameters of a machine were printed: it is excited as they were found.
bool is_of_thesis(const sim::Machine& machine);

/// Refuses an axis whose largest force is not said.
void require_force_limit(const MachineDescription& machine, const std::string& file, std::size_t axis);

/// A virtual machine as a file that can be read again. Axes that turn are in degrees and N m, as their files are.
std::string machine_text(const sim::Machine& machine, const std::string& comment);

/// A sentence where an identified mass (95 % from low to high) is not one that the file allows; empty: it is, or low is not finite.
std::string mass_contradiction(const AxisDescription& axis, double low, double high);

/// A sentence where an identified load is not that of the file; empty: it is, or friction explains the difference.
std::string load_contradiction(const AxisDescription& axis, double load);

/// A sentence where no part of the identified friction, from Coulomb to static, is what the file allows; empty: one is, or none is known.
/// It is no contradiction: friction is the quantity that nobody knows beforehand.
std::string friction_unlike_file(const AxisDescription& axis, const ident::Result& result);

/// A sentence where logs hold a larger force than the drive makes; empty: they do not, or it is not known.
std::string force_contradiction(const AxisDescription& axis, const std::vector<ident::log::Record>& records);

/// A sentence where logs move farther than `allowed` times the travel of the axis; empty: they do not, or it is not known. End stops lie
/// a little behind the travel of a file.
std::string travel_contradiction(const AxisDescription& axis, const std::vector<ident::log::Record>& records,
                                 double allowed = 1.02);

/// A sentence where logs move faster than the axis may; empty: they do not, or it is not known.
std::string speed_contradiction(const AxisDescription& axis, const std::vector<ident::log::Record>& records);

/// A line of the explanation: what, value, why or what follows.
struct Explained {
  std::string what;
  std::string value;
  std::string note;
};

struct ExplainedAxis {
  std::string name;
  std::string drawing;  ///< the way of the force, in one line
  std::vector<Explained> lines;
  std::vector<std::string> lacks;  ///< verb and what it needs
  nlohmann::ordered_json numbers;
};

ExplainedAxis explain(const MachineDescription& machine, std::size_t axis);

/// A key of a machine file that `init` asks for.
struct Asked {
  std::string_view group;  ///< "limits", "drive", "drive_loop" or "commissioning"
  std::string_view key;
  std::string_view example;
  bool needed = false;                ///< no verb does without
  std::string_view rotary_example{};  ///< of an axis that turns; empty: the same
};

/// In the order of the file.
const std::vector<Asked>& asked_keys();
/// What the key means, and what it may be.
const FieldInfo& info_of(const Asked& asked);

/// Values by full key ("x.limits.speed"), as text with a unit.
struct MachineDraft {
  std::string name;
  std::string sample_time;
  std::vector<std::string> axes;
  std::vector<std::pair<std::string, std::string>> values;

  [[nodiscard]] const std::string* find(std::string_view key) const;
  /// Whether a value of the axis is one of an axis that turns: an angle, a torque or an inertia for the axis itself.
  [[nodiscard]] bool rotary(const std::string& axis) const;
};

/// Whether to ask for a key of an axis after the answers that are there: a motor with a torque has no force, a lead is the travel per turn.
bool worth_asking(const MachineDraft& draft, const std::string& axis, const Asked& asked);

/// The answer of a person as the file has it: yes and no of a switch are true and false.
std::string as_answered(const Asked& asked, const std::string& answer);

/// Refuses keys that init does not know and values that the file could not hold. `option`: where the text came from.
void check_value(const MachineDraft& draft, const std::string& option, const std::string& key,
                 const std::string& value);

/// The file, with a comment on every line. What is needed and not given is a line to fill in, which is a comment.
std::string draft_text(const MachineDraft& draft);

/// Keys that are needed and not given.
std::vector<std::string> open_keys(const MachineDraft& draft);

}  // namespace stribeck::workflow
