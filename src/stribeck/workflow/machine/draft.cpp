// A commented machine file from few values.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stribeck/core/walk_fields.hpp>
#include <stribeck/io/log/column_names.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::workflow {
namespace {

/// Tables of an axis that init writes, in the order of the file.
constexpr std::array<std::string_view, 4> kGroups{"limits", "drive", "drive_loop", "commissioning"};

const Type& type_of_group(std::string_view group) {
  if (group == "limits") return type_of<sim::AxisLimits>;
  if (group == "drive") return type_of<DriveData>;
  if (group == "drive_loop") return type_of<friction::DriveLoop>;
  return type_of<RoughAxis>;
}

/// The number behind an optional or a single-item list.
const Type& scalar_of(const Type& type) {
  return type.kind == Kind::kOptional || type.kind == Kind::kList ? scalar_of(*type.inner) : type;
}

bool is_number(const std::string& value) {
  const std::string_view digits = value.starts_with('+') ? std::string_view(value).substr(1) : value;
  return !digits.empty() && digits.find_first_not_of("0123456789.eE+-_") == std::string_view::npos;
}

/// A list as a file holds it: "[35 kg, 60 kg]" with its items in quotes. Lists of lists and of tables stay as they are.
std::string list_as_toml(const std::string& value) {
  const bool nested = value.find_first_of("[{\"'", 1) != std::string::npos;
  if (nested || !value.ends_with(']')) return value;
  std::string out;
  std::string_view rest = std::string_view(value).substr(1, value.size() - 2);
  while (!rest.empty()) {
    const auto comma = std::min(rest.find(','), rest.size());
    std::string item(rest.substr(0, comma));
    rest.remove_prefix(std::min(comma + 1, rest.size()));
    item.erase(0, std::min(item.find_first_not_of(' '), item.size()));
    item.erase(item.find_last_not_of(' ') + 1);
    const bool plain = is_number(item) || item == "true" || item == "false";
    if (!item.empty()) out += fmt::format("{}{}", out.empty() ? "" : ", ", plain ? item : '"' + item + '"');
  }
  return '[' + out + ']';
}

/// As the file holds it: quoted, unless it is a list, a table, a plain number or a switch.
std::string as_toml(const FieldInfo& info, const std::string& value) {
  const Kind kind = scalar_of(*info.type).kind;
  if (value.starts_with('{')) return value;
  if (value.starts_with('[')) return list_as_toml(value);
  if (kind == Kind::kSwitch) return value == "true" || value == "false" ? value : '"' + value + '"';
  const bool text = kind == Kind::kChoice || kind == Kind::kText;
  const bool bare = !text && info.quantity.unit.empty() && is_number(value);
  return bare ? value : '"' + value + '"';
}

std::string full_key(const std::string& axis, const Asked& a) {
  return fmt::format("{}.{}.{}", axis, a.group, a.key);
}

/// What the reader says of a file; here the text is no file, and quotes are none of its business.
std::string of_answer(std::string message) {
  for (const std::string_view of_file : {" (without quotes)", " without quotes"}) {
    if (const auto at = message.find(of_file); at != std::string::npos) message.erase(at, of_file.size());
  }
  return message;
}

/// What the reader of files says about one line of a group, of an axis that turns or not; empty: nothing.
template <class Group>
std::string problem_of(const std::string& line, std::string_view key, bool rotary) {
  try {
    io::Problems problems;
    // The draft grows line by line: an unknown key keeps the group from being judged as a whole.
    io::Node node = io::parse_toml(line + "unfinished = true\n", {});
    for (io::Node& child : node.children) {
      child.rotary = rotary;
      for (io::Node& item : child.children) item.rotary = rotary;
    }
    io::read<Group>(node, problems);
    for (const io::Problem& p : problems.all()) {
      if (p.key.substr(0, key.size()) == key) return of_answer(p.message);
    }
  } catch (const io::InputError& e) {
    return e.problems().front().message;
  }
  return {};
}

std::string problem_of(const Asked& asked, const std::string& value, bool rotary) {
  const std::string line = fmt::format("{} = {}\n", asked.key, as_toml(info_of(asked), value));
  return asked.group == "limits"       ? problem_of<sim::AxisLimits>(line, asked.key, rotary)
         : asked.group == "drive"      ? problem_of<DriveData>(line, asked.key, rotary)
         : asked.group == "drive_loop" ? problem_of<friction::DriveLoop>(line, asked.key, rotary)
                                       : problem_of<RoughAxis>(line, asked.key, rotary);
}

/// The axes that a value can belong to.
enum class OfAxis { kNone, kLinear, kRotary, kBoth };

OfAxis axis_of(const Asked& asked, const std::string& value) {
  const bool linear = problem_of(asked, value, false).empty();
  const bool rotary = problem_of(asked, value, true).empty();
  // Only an axis that turns has one, and its arm is a length.
  if (asked.key == "unbalance" && (linear || rotary)) return OfAxis::kRotary;
  return linear ? (rotary ? OfAxis::kBoth : OfAxis::kLinear) : rotary ? OfAxis::kRotary : OfAxis::kNone;
}

/// What a group of keys holds.
constexpr std::string_view heading_of(std::string_view group) {
  return group == "limits"  ? "what the axis may do"
         : group == "drive" ? "from the data sheets of motor and transmission; leave out what you do not have"
         : group == "drive_loop" ? "the loop that the drive closes itself, from its settings"
                                 : "known roughly before identification";
}

/// Keys of the loop of a drive, which the file has where one of them is given.
constexpr std::array<Asked, 5> kLoop{Asked{"drive_loop", "mode", "position", true},
                                     Asked{"drive_loop", "gain", "20 N s/mm", true, "5 N m s/deg"},
                                     Asked{"drive_loop", "integral_time", "10 ms", false},
                                     Asked{"drive_loop", "position_gain", "50 1/s", true},
                                     Asked{"drive_loop", "velocity_feedforward", "1", true}};

/// Keys of the file in the groups that init writes: those that it asks for, and behind them the others of the group.
const std::vector<Asked>& known_keys() {
  static const std::vector<Asked> kAll = [] {
    std::vector<Asked> all;
    for (const std::string_view group : kGroups) {
      std::vector<Asked> some;
      for (const Asked& a : asked_keys()) {
        if (a.group == group) some.push_back(a);
      }
      if (group == kLoop.front().group) some.assign(kLoop.begin(), kLoop.end());
      const Type& type = type_of_group(group);
      for (std::size_t i = 0; i < type.field_count; ++i) {
        const std::string_view key = type.fields[i].name;
        const bool asked =
            std::any_of(some.begin(), some.end(), [&](const Asked& a) { return a.key == key; });
        if (!asked) some.push_back({group, key, {}, false});
      }
      all.insert(all.end(), some.begin(), some.end());
    }
    return all;
  }();
  return kAll;
}

/// Whether a draft has a line for a key that is not given: of the loop of a drive where a key of it is given, and of its position loop where
/// the mode says so.
bool worth_a_line(const MachineDraft& draft, const std::string& axis, const Asked& key) {
  if (key.group != kLoop.front().group) return true;
  const auto given = [&](const Asked& a) { return draft.find(full_key(axis, a)) != nullptr; };
  if (std::none_of(known_keys().begin(), known_keys().end(),
                   [&](const Asked& a) { return a.group == key.group && given(a); }))
    return false;
  const std::string* mode = draft.find(full_key(axis, kLoop.front()));
  const bool position = mode != nullptr ? *mode == "position" : given(kLoop[3]) || given(kLoop[4]);
  return position || (key.key != "position_gain" && key.key != "velocity_feedforward");
}

/// Keys of a drive of which the file takes one: a motor has torque or force, and the travel per turn is said once.
constexpr std::array<std::string_view, 3> kOfForce{"rated_force", "force_constant", "peak_force"};
constexpr std::array<std::string_view, 3> kOfTorque{"rated_torque", "torque_constant", "peak_torque"};
constexpr std::array<std::string_view, 3> kTravelPerTurn{"lead", "pulley_diameter", "travel_per_turn"};

bool is_one_of(std::string_view key, const std::array<std::string_view, 3>& keys) {
  return std::find(keys.begin(), keys.end(), key) != keys.end();
}

bool exclude_each_other(std::string_view a, std::string_view b) {
  if (a == b) return false;
  const auto turns = [](std::string_view key) {
    return is_one_of(key, kOfTorque) || is_one_of(key, kTravelPerTurn);
  };
  return (is_one_of(a, kOfForce) && turns(b)) || (is_one_of(b, kOfForce) && turns(a)) ||
         (is_one_of(a, kTravelPerTurn) && is_one_of(b, kTravelPerTurn));
}

/// The key of the same drive that is given and leaves no room for this one; empty: none.
std::string excluded_by(const MachineDraft& draft, const std::string& axis, const Asked& asked) {
  if (asked.group != "drive") return {};
  for (const Asked& a : known_keys()) {
    if (a.group != "drive" || !exclude_each_other(a.key, asked.key)) continue;
    if (draft.find(full_key(axis, a)) != nullptr) return full_key(axis, a);
  }
  return {};
}

/// What a key that no group has could have been.
[[noreturn]] void refuse_key(const MachineDraft& draft, const std::string& option, const std::string& key,
                             const std::vector<std::string>& all) {
  const std::string_view near = io::nearest(key, {all.begin(), all.end()});
  for (const std::string& axis : draft.axes) {
    for (const std::string_view group : kGroups) {
      if (!key.starts_with(fmt::format("{}.{}.", axis, group))) continue;
      std::string keys;
      for (const Asked& a : known_keys()) {
        if (a.group == group) keys += fmt::format("{}{}", keys.empty() ? "" : ", ", a.key);
      }
      const std::string meant = near.empty() ? "" : fmt::format(" (meant {}?)", near);
      refuse_option(
          option, fmt::format("got {}, expected a key of {}: {}{}", io::in_quotes(key), group, keys, meant));
    }
  }
  constexpr std::string_view kRotary = ".rotary";
  if (key.size() > kRotary.size() && key.ends_with(kRotary))
    refuse_option(
        option,
        fmt::format(
            "got {}, but an axis is rotary by the units of its values: give travel, speed or lead in deg or rpm",
            io::in_quotes(key)));
  refuse_option(option,
                fmt::format("got {}, expected AXIS.GROUP.KEY=VALUE with one of the axes of --axes, e.g. {}",
                            io::in_quotes(key), near.empty() ? std::string_view(all.front()) : near));
}

}  // namespace

const std::vector<Asked>& asked_keys() {
  static const std::vector<Asked> kKeys{
      {"limits", "travel_min", "-600 mm", true, "-180 deg"},
      {"limits", "travel_max", "600 mm", true, "180 deg"},
      {"limits", "speed", "30 m/min", true, "20 rpm"},
      {"limits", "acceleration", "2 m/s2", true, "500 deg/s2"},
      {"drive", "rated_torque", "2.4 N m", false},
      {"drive", "peak_torque", "7.2 N m", false},
      {"drive", "rated_force", "300 N", false, "300 N m"},
      {"drive", "torque_limit", "300 %", false},
      {"drive", "lead", "10 mm", false, "360 deg"},
      {"drive", "travel_per_turn", "120 mm", false, "4 deg"},
      {"drive", "gear", "3", false},
      {"drive", "motors", "1", false},
      {"drive", "rotor_inertia", "0.05 kg cm2", false},
      {"drive", "brake", "true", false},
      {"commissioning", "mass", "45 kg", true, "2 kg m2"},
      {"commissioning", "friction", "40 N", true, "8 N m"},
      {"commissioning", "load", "176 N", false, "5 N m"},
      {"commissioning", "encoder_resolution", "1 um", false, "0.0001 deg"},
  };
  return kKeys;
}

bool worth_asking(const MachineDraft& draft, const std::string& axis, const Asked& asked) {
  if (!excluded_by(draft, axis, asked).empty()) return false;
  const auto given = [&](std::string_view key) {
    return draft.find(fmt::format("{}.drive.{}", axis, key)) != nullptr;
  };
  if (asked.group != "drive") return true;
  if (asked.key == "peak_torque" || asked.key == "rotor_inertia") return given("rated_torque");
  if (asked.key == "gear")
    return std::any_of(kTravelPerTurn.begin(), kTravelPerTurn.end(),
                       given);  // without it the gear has no effect
  return true;
}

std::string as_answered(const Asked& asked, const std::string& answer) {
  if (scalar_of(*info_of(asked).type).kind != Kind::kSwitch) return answer;
  const std::string word = io::lower_case(answer);
  for (const char* yes : {"yes", "y", "ja", "j"}) {
    if (word == yes) return "true";
  }
  for (const char* no : {"no", "n", "nein"}) {
    if (word == no) return "false";
  }
  return answer;
}

const FieldInfo& info_of(const Asked& asked) {
  const Type& type = type_of_group(asked.group);
  for (std::size_t i = 0; i + 1 < type.field_count; ++i) {
    if (type.fields[i].name == asked.key) return type.fields[i];
  }
  return type.fields[type.field_count - 1];
}

const std::string* MachineDraft::find(std::string_view key) const {
  for (const auto& [known, value] : values) {
    if (known == key) return &value;
  }
  return nullptr;
}

bool MachineDraft::rotary(const std::string& axis) const {
  return std::any_of(known_keys().begin(), known_keys().end(), [&](const Asked& a) {
    const std::string* value = find(full_key(axis, a));
    return value != nullptr && axis_of(a, *value) == OfAxis::kRotary;
  });
}

void check_value(const MachineDraft& draft, const std::string& option, const std::string& key,
                 const std::string& value) {
  std::vector<std::string> all;
  for (const std::string& axis : draft.axes) {
    for (const Asked& a : known_keys()) all.push_back(full_key(axis, a));
  }
  const auto hit = std::find(all.begin(), all.end(), key);
  if (hit == all.end()) refuse_key(draft, option, key, all);
  if (const std::string* given = draft.find(key)) {
    refuse_option(option, fmt::format("{} is given twice, as {} and {} (leave one out)", key,
                                      io::in_quotes(*given), io::in_quotes(value)));
  }
  const auto at = static_cast<std::size_t>(hit - all.begin()) % known_keys().size();
  const Asked& asked = known_keys()[at];
  const OfAxis kind = axis_of(asked, value);
  // Asked for on a terminal, the key is what the message names in place of an option.
  const std::string of_key = option == key ? std::string() : key + ": ";
  if (kind == OfAxis::kNone) refuse_option(option, of_key + problem_of(asked, value, false));
  const std::string axis = key.substr(0, key.find('.'));
  if (const std::string other = excluded_by(draft, axis, asked); !other.empty())
    refuse_option(option, fmt::format("{}got {} beside {} = {}: expected one of both (leave one out)", of_key,
                                      io::in_quotes(value), other, io::in_quotes(*draft.find(other))));
  if (kind == OfAxis::kBoth) return;
  for (const Asked& a : known_keys()) {
    const std::string* given = draft.find(full_key(axis, a));
    if (given == nullptr || full_key(axis, a) == key) continue;
    const OfAxis other = axis_of(a, *given);
    if (other == OfAxis::kBoth || other == kind) continue;
    refuse_option(
        option,
        fmt::format(
            "{}got {} beside {} = {}: one value is for a rotary axis, the other for a linear one (give both in deg or both in mm)",
            of_key, io::in_quotes(value), full_key(axis, a), io::in_quotes(*given)));
  }
}

std::string draft_text(const MachineDraft& d) {
  std::string out = fmt::format(
      "# Machine file of stribeck. Every value is a number with its unit. Lines that begin with # are comments.\n"
      "# `stribeck machine FILE` explains the values and says what is missing.\n\n"
      "name = \"{}\"\nsample_time = \"{}\"  # control period, the time between rows of a log\n",
      d.name, d.sample_time);
  for (const std::string& axis : d.axes) {
    std::string_view group;
    const bool rotary = d.rotary(axis);
    if (rotary)
      out += fmt::format(
          "\n[axes.{}]\nrotary = true  # angles for lengths, N m for forces, kg m2 for the mass\n", axis);
    for (const Asked& a : known_keys()) {
      const std::string* value = d.find(full_key(axis, a));
      if (value == nullptr && (a.example.empty() || !worth_a_line(d, axis, a))) continue;
      if (a.group != group) {
        group = a.group;
        out += fmt::format("\n[axes.{}.{}]  # {}\n", axis, group, heading_of(group));
      }
      const FieldInfo& info = info_of(a);
      const std::string_view example = rotary && !a.rotary_example.empty() ? a.rotary_example : a.example;
      const std::string text = as_toml(info, value != nullptr ? *value : std::string(example));
      const char* lead = value != nullptr ? "" : a.needed ? "# FILL IN: " : "# ";
      out += fmt::format("{}{} = {}  # {}\n", lead, a.key, text, info.doc);
    }
  }
  return out;
}

std::vector<std::string> open_keys(const MachineDraft& d) {
  std::vector<std::string> open;
  for (const std::string& axis : d.axes) {
    for (const Asked& a : asked_keys()) {
      if (a.needed && d.find(full_key(axis, a)) == nullptr) open.push_back(full_key(axis, a));
    }
    for (const Asked& a : kLoop) {
      if (a.needed && d.find(full_key(axis, a)) == nullptr && worth_a_line(d, axis, a))
        open.push_back(full_key(axis, a));
    }
  }
  return open;
}

}  // namespace stribeck::workflow
