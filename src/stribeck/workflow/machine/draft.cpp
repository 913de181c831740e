// A commented machine file from few values.
#include <fmt/format.h>

#include <algorithm>
#include <stribeck/core/walk_fields.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::workflow {
namespace {

const Type& type_of_group(std::string_view group) {
  if (group == "limits") return type_of<sim::AxisLimits>;
  if (group == "drive") return type_of<DriveData>;
  return type_of<RoughAxis>;
}

/// The number behind an optional or a single-item list.
const Type& scalar_of(const Type& type) {
  return type.kind == Kind::kOptional || type.kind == Kind::kList ? scalar_of(*type.inner) : type;
}

/// As the file holds it: quoted, unless it is a list, a count or a switch.
std::string as_toml(const FieldInfo& info, const std::string& value) {
  const bool bare = scalar_of(*info.type).kind != Kind::kNumber ||
                    (info.quantity.unit.empty() && value.find('%') == std::string::npos);
  if (bare || (!value.empty() && value[0] == '[')) return value;
  return '"' + value + '"';
}

std::string full_key(const std::string& axis, const Asked& a) {
  return fmt::format("{}.{}.{}", axis, a.group, a.key);
}

/// What the reader of files says about one line of a group; empty: nothing.
template <class Group>
std::string problem_of(const std::string& line, std::string_view key) {
  try {
    io::Problems problems;
    // The draft grows line by line: an unknown key keeps the group from being judged as a whole.
    io::read<Group>(io::parse_toml(line + "unfinished = true\n", {}), problems);
    for (const io::Problem& p : problems.all()) {
      if (p.key.substr(0, key.size()) == key) return p.message;
    }
  } catch (const io::InputError& e) {
    return e.problems().front().message;
  }
  return {};
}

/// What a group of keys holds.
constexpr std::string_view heading_of(std::string_view group) {
  return group == "limits"  ? "what the axis may do"
         : group == "drive" ? "from the data sheets of motor and transmission; leave out what you do not have"
                            : "known roughly before identification";
}

/// Keys of the file in the groups that init writes: those that it asks for, and behind them the others of the group.
const std::vector<Asked>& known_keys() {
  static const std::vector<Asked> kAll = [] {
    std::vector<Asked> all;
    for (const std::string_view group : {"limits", "drive", "commissioning"}) {
      std::vector<Asked> some;
      for (const Asked& a : asked_keys()) {
        if (a.group == group) some.push_back(a);
      }
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

/// What a key that no group has could have been.
[[noreturn]] void refuse_key(const MachineDraft& draft, const std::string& option, const std::string& key,
                             const std::vector<std::string>& all) {
  const std::string_view near = io::nearest(key, {all.begin(), all.end()});
  for (const std::string& axis : draft.axes) {
    for (const std::string_view group : {"limits", "drive", "commissioning"}) {
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
  refuse_option(option,
                fmt::format("got {}, expected AXIS.GROUP.KEY=VALUE with one of the axes of --axes, e.g. {}",
                            io::in_quotes(key), near.empty() ? std::string_view(all.front()) : near));
}

}  // namespace

const std::vector<Asked>& asked_keys() {
  static const std::vector<Asked> kKeys{
      {"limits", "travel_min", "-600 mm", true},
      {"limits", "travel_max", "600 mm", true},
      {"limits", "speed", "30 m/min", true},
      {"limits", "acceleration", "2 m/s2", true},
      {"drive", "rated_torque", "2.4 N m", false},
      {"drive", "rated_force", "300 N", false},
      {"drive", "torque_limit", "300 %", false},
      {"drive", "lead", "10 mm", false},
      {"drive", "travel_per_turn", "120 mm", false},
      {"drive", "gear", "3", false},
      {"drive", "motors", "1", false},
      {"drive", "brake", "true", false},
      {"commissioning", "mass", "45 kg", true},
      {"commissioning", "friction", "40 N", true},
      {"commissioning", "load", "176 N", false},
      {"commissioning", "encoder_resolution", "1 um", false},
  };
  return kKeys;
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

void check_value(const MachineDraft& draft, const std::string& option, const std::string& key,
                 const std::string& value) {
  std::vector<std::string> all;
  for (const std::string& axis : draft.axes) {
    for (const Asked& a : known_keys()) all.push_back(full_key(axis, a));
  }
  const auto hit = std::find(all.begin(), all.end(), key);
  if (hit == all.end()) refuse_key(draft, option, key, all);
  const auto at = static_cast<std::size_t>(hit - all.begin()) % known_keys().size();
  const Asked& asked = known_keys()[at];
  const std::string line = fmt::format("{} = {}\n", asked.key, as_toml(info_of(asked), value));
  const std::string problem = asked.group == "limits"  ? problem_of<sim::AxisLimits>(line, asked.key)
                              : asked.group == "drive" ? problem_of<DriveData>(line, asked.key)
                                                       : problem_of<RoughAxis>(line, asked.key);
  if (!problem.empty()) refuse_option(option, key + ": " + problem);
}

std::string draft_text(const MachineDraft& d) {
  std::string out = fmt::format(
      "# Machine file of stribeck. Every value is a number with its unit. Lines that begin with # are comments.\n"
      "# `stribeck machine FILE` explains the values and says what is missing.\n\n"
      "name = \"{}\"\nsample_time = \"{}\"  # control period, the time between rows of a log\n",
      d.name, d.sample_time);
  for (const std::string& axis : d.axes) {
    std::string_view group;
    for (const Asked& a : known_keys()) {
      const std::string* value = d.find(full_key(axis, a));
      if (a.example.empty() && value == nullptr) continue;
      if (a.group != group) {
        group = a.group;
        out += fmt::format("\n[axes.{}.{}]  # {}\n", axis, group, heading_of(group));
      }
      const FieldInfo& info = info_of(a);
      const std::string text = as_toml(info, value != nullptr ? *value : std::string(a.example));
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
  }
  return open;
}

}  // namespace stribeck::workflow
