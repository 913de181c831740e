#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <tuple>

#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/shown.hpp>
#include <stribeck/io/printable.hpp>
#include <stribeck/io/units.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/targets/steady/gain.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::targets {

using workflow::option_si;
using workflow::refuse_option;

namespace {

std::string_view without_blanks(std::string_view part) {
  const std::size_t first = part.find_first_not_of(' ');
  if (first == std::string_view::npos) return {};
  return part.substr(first, part.find_last_not_of(' ') - first + 1);
}

/// Axis and value of "x=10 mm,y=5 mm"; a part without an axis has an empty one.
std::vector<std::pair<std::string, std::string>> entries_of(const std::string& text) {
  std::vector<std::pair<std::string, std::string>> out;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    const std::string_view part = std::string_view(text).substr(at, end - at);
    const std::size_t equal = part.find('=');
    if (equal == std::string_view::npos)
      out.emplace_back("", without_blanks(part));
    else
      out.emplace_back(without_blanks(part.substr(0, equal)), without_blanks(part.substr(equal + 1)));
    at = end + 1;
  }
  return out;
}

bool is_torque(std::string_view force) {
  static const Quantity kTorque = quantity("N m", "N m");
  return io::is_convertible(force, kTorque);
}

/// The unit behind the last slash, without blanks.
std::string unit_behind(const std::string& gain) {
  std::string unit = gain.substr(std::min(gain.rfind('/') + 1, gain.size()));
  unit.erase(std::remove(unit.begin(), unit.end(), ' '), unit.end());
  return unit;
}

}  // namespace

std::string text_of_axis(const char* option, const std::string& text, const std::string& axis) {
  if (text.find('=') == std::string::npos) return text;
  for (const auto& [name, value] : entries_of(text)) {
    if (name == axis) return value;
  }
  refuse_option(option, fmt::format("got {}, which says nothing of axis {} (write {}=… for each axis)",
                                    io::in_quotes(text), axis, axis));
}

void refuse_unknown_axes(const char* option, const std::string& text, const std::vector<std::string>& names) {
  if (text.find('=') == std::string::npos) return;
  std::vector<std::string> seen;
  for (const auto& [name, value] : entries_of(text)) {
    if (std::find(names.begin(), names.end(), name) == names.end())
      refuse_option(option,
                    fmt::format("got {} for {}, expected axes of this export: {}", io::in_quotes(value),
                                io::in_quotes(name), report::joined(names, ", ")));
    if (std::find(seen.begin(), seen.end(), name) != seen.end())
      refuse_option(option, fmt::format("axis {} stands there twice", name));
    seen.push_back(name);
  }
}

std::string word_of_common_gain(const ExportRequest& o) {
  const auto common = [](const std::string& text) {
    return !text.empty() && text.find('=') == std::string::npos;
  };
  if (o.files.size() < 2 || (!common(o.gain) && !common(o.lead))) return {};
  return fmt::format("One {} counts for all axes; where their drives differ, give each its own: {}.\n",
                     common(o.gain) ? "--gain" : "--lead",
                     common(o.gain) ? "--gain \"x=12 N/%,y=20 N/%\"" : "--lead \"x=10 mm,y=5 mm\"");
}

bool gives_torque(const ExportRequest& o) {
  const auto entries = entries_of(o.gain);
  return std::any_of(entries.begin(), entries.end(), [](const auto& entry) {
    return is_torque(entry.second.substr(0, entry.second.rfind('/')));
  });
}

std::pair<double, std::string> gain_of(const ExportRequest& o, const std::string& axis, bool rotary,
                                       double lead) {
  if (o.gain.empty()) return {std::numeric_limits<double>::quiet_NaN(), {}};
  const std::string text = text_of_axis("--gain", o.gain, axis);
  const std::size_t slash = text.rfind('/');
  if (slash == std::string::npos || slash + 1 == text.size()) {
    refuse_option(
        "--gain",
        fmt::format("got {}, expected the force of one unit of the control, e.g. \"12.5 N/%\" or \"140 N/A\"",
                    io::in_quotes(text)));
  }
  std::string unit = unit_behind(text);
  constexpr std::string_view kLetters =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789%\xe2\x80\xb0._-";
  if (unit.empty() || unit.size() > 16 || unit.find_first_not_of(kLetters) != std::string::npos)
    refuse_option("--gain",
                  fmt::format("got the unit {}, expected letters, digits, % or ‰", io::in_quotes(unit)));
  const std::string force = text.substr(0, slash);
  if (!is_torque(force)) return {option_si("--gain", force, quantity("N", "N").positive()), unit};
  const double torque = option_si("--gain", force, quantity("N m", "N m").positive());
  if (rotary) return {torque, unit};
  if (!(lead > 0.0))
    refuse_option(
        "--gain",
        fmt::format(
            "got {}, a torque of the motor, expected the force of axis {}, e.g. \"12.5 N/%\" (or give "
            "--lead, its travel per turn of the motor, too: the force is 2π times the torque over it)",
            io::in_quotes(text), axis));
  return {2.0 * kPi * torque / lead, unit};
}

namespace {

bool is_per_mille(std::string_view unit) {
  constexpr std::array<std::string_view, 5> kWords{"‰", "per_mille", "per-mille", "permille", "promille"};
  return std::find(kWords.begin(), kWords.end(), unit) != kWords.end();
}

constexpr double kFull = 32767.0;  // bits of the converter at 100 %, and at 10 V

/// Bits of the converter for one unit; 0: it is none of an output.
double bits_per(std::string_view unit) {
  const auto is_one_of = [&](std::initializer_list<std::string_view> words) {
    return std::find(words.begin(), words.end(), unit) != words.end();
  };
  if (is_one_of({"bit", "bits", "count", "counts"})) return 1.0;
  if (is_one_of({"%", "percent"})) return kFull / 100.0;
  if (is_per_mille(unit)) return kFull / 1000.0;
  return unit == "V" ? kFull / 10.0 : 0.0;
}

/// The gain in bits of the converter.
void count_in_bits(const SteadyTarget& target, Axis& axis) {
  const double per_unit = bits_per(axis.unit);
  if (per_unit == 0.0) {
    refuse_option(
        "--gain",
        fmt::format(
            "got the force of one {}, but {} counts in bits of a 16-bit output (32 767 are 100 %, or 10 V), expected the force "
            "of one bit, % or V, e.g. \"12.5 N/%\"",
            axis.unit, target.name));
  }
  axis.gain /= per_unit;
  axis.unit = "bit";
}

}  // namespace

void count_as(const SteadyTarget& target, Axis& axis) {
  if (target.counts == GainUnit::kAny) return;
  if (target.counts == GainUnit::kBits) return count_in_bits(target, axis);
  const bool per_cent = target.counts == GainUnit::kPercent;
  if (!is_share(axis.unit)) {
    refuse_option(
        "--gain",
        fmt::format(
            "got the force of one {}, but {} counts in {} of the rated torque or current, expected the force of one "
            "% or ‰ of it, e.g. \"12.5 N/%\"",
            axis.unit, target.name, per_cent ? "%" : "‰"));
  }
  if (per_cent == is_per_mille(axis.unit)) axis.gain *= per_cent ? 10.0 : 0.1;
  axis.unit = per_cent ? "%" : "‰";
}

bool can_count(const SteadyTarget& target, std::string_view unit) {
  if (target.counts == GainUnit::kAny) return true;
  return target.counts == GainUnit::kBits ? bits_per(unit) > 0.0 : is_share(unit);
}

bool can_count(const SteadyTarget& target, const ExportRequest& o) {
  const auto entries = entries_of(o.gain);
  return std::all_of(entries.begin(), entries.end(),
                     [&](const auto& entry) { return can_count(target, unit_behind(entry.second)); });
}

namespace {

/// The force of one unit in which the target can count, from what an axis file says of the drive; NaN: it does not say it.
std::pair<double, std::string> gain_of_file(const SteadyTarget& target,
                                            const std::optional<friction::DriveNumbers>& drive) {
  // The full output of a converter is mostly the peak of the drive, which only its user knows.
  if (drive && drive->rated_force && target.counts != GainUnit::kBits)
    return {*drive->rated_force / 100.0, "%"};
  if (drive && drive->force_per_ampere && target.counts == GainUnit::kAny)
    return {*drive->force_per_ampere, "A"};
  return {std::numeric_limits<double>::quiet_NaN(), {}};
}

}  // namespace

std::string take_from_file(const SteadyTarget& target, Axis& axis) {
  const ident::Shown shown("m", "N", axis.rotary);
  std::vector<std::string> taken;
  if (target.needs_gain() && std::isnan(axis.gain)) {
    std::tie(axis.gain, axis.unit) = gain_of_file(target, axis.drive);
    if (!std::isnan(axis.gain)) {
      const bool share = axis.unit == "%";
      taken.push_back(fmt::format("{} for {}", shown.force(share ? 100.0 * axis.gain : axis.gain),
                                  share ? "100 % of the rated torque" : "1 A"));
    }
  }
  if (target.needs_lead() && std::isnan(axis.lead) && axis.drive && axis.drive->travel_per_turn) {
    axis.lead = *axis.drive->travel_per_turn;
    taken.push_back(fmt::format("{} per turn of the motor", shown.length(axis.lead)));
  }
  if (taken.empty()) return {};
  const int motors = axis.drive->motors.value_or(1);
  return fmt::format(
      "{}: {}, from the drive in {}{}.\n", axis.name, report::listed(taken), axis.file,
      motors > 1 ? fmt::format(" (force of {} motors together: write the number into each drive)", motors)
                 : "");
}

std::string missing_options(const SteadyTarget& target, const ExportRequest& o) {
  bool gain = target.needs_gain() && o.gain.empty();
  bool lead = target.needs_lead() && o.lead.empty();
  if (!gain && !lead) return {};
  bool every_gain = true, every_lead = true;
  for (const std::string& file : o.files) {
    const auto drive = workflow::read_axis_file(file).drive;
    every_gain = every_gain && !std::isnan(gain_of_file(target, drive).first);
    every_lead = every_lead && drive && drive->travel_per_turn;
  }
  gain = gain && !every_gain;
  lead = lead && !every_lead;
  return gain && lead ? "--gain, --lead" : gain ? "--gain" : lead ? "--lead" : "";
}

std::string word_of_gain(const SteadyTarget& target, const Axis& axis) {
  if (target.counts == GainUnit::kAny) return {};
  double most = 0.0;
  for (const double v : {axis.slowest, axis.fastest})
    most = std::max({most, std::abs(axis.friction(v)), std::abs(axis.friction(-v))});
  const bool bits = target.counts == GainUnit::kBits;
  const double whole = target.counts == GainUnit::kPercent ? 100.0 : bits ? kFull : 1000.0;
  const double share = most / axis.gain / whole;
  if (!(share > 1.0)) return {};
  return fmt::format("{}: friction of {} is {} % of the {}: check --gain.\n", axis.name,
                     ident::Shown("m", "N", axis.rotary).force(most), report::significant(100.0 * share, 3),
                     bits ? "output" : "rated torque or current");
}

bool is_share(std::string_view unit) { return unit == "%" || unit == "percent" || is_per_mille(unit); }

}  // namespace stribeck::targets
