#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stribeck/io/error.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/io/units.hpp>
#include <stribeck/workflow/machine/axis_units.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <stribeck/workflow/option.hpp>
#include <utility>

namespace stribeck::workflow {
namespace {

constexpr double kRoundedRotor = 0.98;  // of its value in the data sheet

/// What is heavy in an unbalance, and its distance, are a mass and a length on a rotary axis too.
void set_rotary(io::Node& node) {
  if (node.key == "unbalance") return;
  node.rotary = true;
  for (io::Node& child : node.children) set_rotary(child);
}

/// Whether the text is an angle.
bool is_angle(const io::Node& node) {
  if (node.kind != io::Node::Kind::kText) return false;
  try {
    io::to_si(node.text, quantity("rad", "deg"));
    return true;
  } catch (const io::InputError&) {
    return false;
  }
}

/// A limit of travel that is an angle; null: there is none.
const io::Node* angle_in_limits(const io::Node& axis) {
  const io::Node* limits = axis.find("limits");
  if (limits == nullptr) return nullptr;
  const auto found =
      std::find_if(limits->children.begin(), limits->children.end(),
                   [](const io::Node& limit) { return limit.key.starts_with("travel") && is_angle(limit); });
  return found == limits->children.end() ? nullptr : &*found;
}

/// A motor behind a gear turns the table; without a lead one turn behind the gear is one of the table.
void set_turn_of_table(io::Node& axis, const std::string& file) {
  for (io::Node& drive : axis.children) {
    if (drive.key != "drive") continue;
    if (const io::Node* pulley = drive.find("pulley_diameter"))
      throw io::InputError({file, pulley->line, fmt::format("axes.{}.drive.pulley_diameter", axis.key),
                            "a rotary axis has none (write lead = \"360 deg\" and gear)"});
    const bool told = drive.find("lead") != nullptr || drive.find("travel_per_turn") != nullptr;
    const bool motor_turns = drive.find("rated_force") == nullptr && drive.find("force_constant") == nullptr;
    if (told || !motor_turns) continue;
    io::Node lead;
    lead.kind = io::Node::Kind::kText;
    lead.key = "lead";
    lead.text = "360 deg";
    lead.rotary = true;
    lead.line = drive.line;
    drive.children.push_back(std::move(lead));
  }
}

/// What a file is by its tables; empty: nothing that is known here.
std::string_view kind_of(const io::Node& file) {
  return file.find("axes") != nullptr       ? "a machine file"
         : file.find("friction") != nullptr ? "an axis file"
         : file.find("law") != nullptr      ? "a controller file"
         : file.find("factors") != nullptr  ? "a study"
                                            : "";
}

/// A file of another kind misses every key of the one that is expected.
void refuse_other_kind(const io::Node& file, const std::string& name, std::string_view kind,
                       const char* expected) {
  const std::string_view is = kind_of(file);
  if (is.empty() || is == kind) return;
  throw io::InputError(
      {name, 0, is == "a machine file" ? "axes" : "", fmt::format("is {}, expected {}", is, expected)});
}

MachineDescription described(io::Node file, const std::string& name) {
  refuse_other_kind(file, name, "a machine file",
                    "a machine file, with a table for each axis (stribeck init writes one)");
  for (io::Node& table : file.children) {
    if (table.key != "axes") continue;
    for (io::Node& axis : table.children) {
      const io::Node* rotary = axis.find("rotary");
      if (rotary != nullptr) {
        if (!rotary->flag) continue;
        set_rotary(axis);
        set_turn_of_table(axis, name);
      } else if (const io::Node* angle = angle_in_limits(axis)) {
        throw io::InputError(
            {name, angle->line, fmt::format("axes.{}.limits.{}", axis.key, angle->key),
             fmt::format("got {}, expected a unit like mm (if the axis turns, write rotary = "
                         "true below [axes.{}])",
                         io::in_quotes(angle->text), axis.key)});
      }
    }
  }
  io::Problems problems(name);
  auto machine = io::read<MachineDescription>(file, problems);
  problems.throw_if_any();
  return machine;
}

}  // namespace

bool describes_machine(const std::string& file) {
  if (!file.ends_with(".toml")) return false;
  try {
    return io::load_toml(file).find("axes") != nullptr;
  } catch (const io::InputError&) {
    return false;
  }
}

sim::AxisFile read_axis_file(const std::string& file) {
  refuse_other_kind(io::load_toml(file), file, "an axis file", "an axis file written by identify");
  return io::read_toml<sim::AxisFile>(file);
}

MachineDescription read_description(const std::string& file) {
  try {
    return described(io::load_toml(file), file);
  } catch (const io::NotToml& e) {
    if (file.ends_with(".toml")) throw;
    io::Problem why = e.problems().front();
    why.message += " (expected a machine file in TOML; this may be a log)";
    throw io::InputError(std::move(why));
  }
}

MachineDescription parse_description(std::string_view text, const std::string& file) {
  return described(io::parse_toml(text, file), file);
}

sim::Machine read_virtual_machine(const std::string& file, const std::vector<std::string>& axis_files,
                                  AxisWithoutTruth without_truth) {
  MachineDescription machine = read_description(file);
  // A name that the machine does not have is told before what its axes lack.
  if (!axis_files.empty()) {
    const sim::Machine all = as_machine(machine);
    for (const std::string& text : axis_files)
      static_cast<void>(axis_index(all, file, axis_and_file(text).first));
  }
  std::vector<std::string> from(machine.axes.size());
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    auto& [name, axis] = machine.axes[i];
    if (axis.plant) continue;
    for (const std::string& text : axis_files) {
      const auto [given, axis_file] = axis_and_file(text);
      if (given != name) continue;
      require_force_limit(machine, file, i);
      axis.plant = model_as_truth(axis, name, machine.sample_time, file, axis_file);
      from[i] = axis_file;
      break;
    }
  }
  const auto has_truth = [](const auto& axis) { return axis.second.plant.has_value(); };
  const auto first_without = std::find_if_not(machine.axes.begin(), machine.axes.end(), has_truth);
  if (first_without != machine.axes.end() &&
      (without_truth == AxisWithoutTruth::kRefused ||
       std::none_of(machine.axes.begin(), machine.axes.end(), has_truth)))
    throw no_truth(file, first_without->first);
  sim::Machine virtual_machine = as_machine(machine);
  std::vector<std::pair<std::string, sim::MachineAxis>> all = std::exchange(virtual_machine.axes, {});
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!machine.axes[i].second.plant) {
      virtual_machine.left_out.push_back(std::move(all[i].first));
      continue;
    }
    all[i].second.truth_from = std::move(from[i]);
    virtual_machine.axes.push_back(std::move(all[i]));
  }
  return virtual_machine;
}

bool is_of_thesis(const sim::Machine& machine) {
  return std::any_of(machine.axes.begin(), machine.axes.end(), [](const auto& axis) {
    const sim::Published& p = axis.second.published;
    return p.conventional || p.gaussian || p.eccentric;
  });
}

void require_force_limit(const MachineDescription& machine, const std::string& file, std::size_t axis) {
  const auto& [name, a] = machine.axes[axis];
  if (a.force_limit() > 0.0) return;
  throw io::InputError(
      {file, 0, fmt::format("axes.{}.limits.force", name),
       "missing, expected the largest force of the drive (write force = \"500 N\", with your "
       "value, or [axes." +
           name + ".drive] with rated_torque, peak_torque and lead)"});
}

std::string travel_contradiction(const AxisDescription& axis, const std::vector<ident::log::Record>& records,
                                 double allowed) {
  const double from = axis.limits.travel_min, to = axis.limits.travel_max;
  if (axis.rotary && to - from > kPi) return {};  // turns may be counted on
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const ident::log::Record& record : records) {
    if (record.position_unit != "m" || record.x.empty()) return {};
    const auto [least, most] = std::minmax_element(record.x.begin(), record.x.end());
    low = std::min(low, *least);
    high = std::max(high, *most);
  }
  if (!(high - low > allowed * (to - from)) || !(to > from)) return {};
  const double scale = axis.rotary ? 180.0 / kPi : 1e3;
  const char* const unit = axis.rotary ? "deg" : "mm";
  return fmt::format(
      "the log moves over {:.4g} {}, from {:.4g} to {:.4g} {}, and the axis has a travel of {:.4g} {} in the machine file: the "
      "positions are in another unit, of the motor{}, or the file is wrong",
      scale * (high - low), unit, scale * low, scale * high, unit, scale * (to - from), unit,
      axis.rotary ? " (behind a gear)" : ", or in diameter (of a lathe; then give --map x=\"… 0.5 mm\")");
}

std::string speed_contradiction(const AxisDescription& axis, const std::vector<ident::log::Record>& records) {
  constexpr double kSpan = 0.02;   // [s], so that steps of an encoder are no speed
  constexpr double kBeyond = 1.2;  // overshoot and rounded limits lie below
  constexpr int kOften = 3;
  const double limit = axis.limits.speed;
  double most = 0.0;
  int beyond = 0;
  for (const ident::log::Record& record : records) {
    if (record.position_unit != "m" || record.x.size() != record.t.size()) return {};
    const auto n = static_cast<std::size_t>(std::max(1.0, std::round(kSpan / record.sample_time)));
    for (std::size_t i = n; i < record.x.size(); i += n) {
      const double v = std::abs(record.x[i] - record.x[i - n]) / (record.t[i] - record.t[i - n]);
      // Where positions are set anew they jump.
      if (!(v > kBeyond * limit) || v > 20.0 * limit) continue;
      most = std::max(most, v);
      ++beyond;
    }
  }
  if (!(limit > 0.0) || beyond < kOften) return {};
  const double scale = axis.rotary ? 180.0 / kPi : 1e3;
  const char* const unit = axis.rotary ? "deg/s" : "mm/s";
  return fmt::format(
      "the log moves at up to {:.4g} {}, and the machine file allows {:.4g} {}: the time between the rows is another (say it with "
      "--sample-time), the positions are in another unit or of the motor, or the file is wrong",
      scale * most, unit, scale * limit, unit);
}

std::string force_contradiction(const AxisDescription& axis, const std::vector<ident::log::Record>& records) {
  // A servo drive makes a few times its rated force for a short time; where the file says neither peak nor limit, that is no contradiction.
  const bool only_rated = !axis.limits.force && !axis.plant && axis.drive && !axis.drive->peak();
  constexpr double kPeakOfRated = 5.0;
  const double allowed = only_rated ? kPeakOfRated : 1.1;
  const double limit = axis.force_limit();
  double most = 0.0;
  std::size_t beyond = 0, rows = 0;
  for (const ident::log::Record& record : records) {
    if (record.force_unit != "N") return {};
    rows += record.f.size();
    for (const double f : record.f) {
      most = std::max(most, std::abs(f));
      beyond += std::abs(f) > allowed * limit ? 1 : 0;
    }
  }
  // A single spike is no demand.
  constexpr double kShare = 1e-3;
  if (!(limit > 0.0) || beyond < 3 || static_cast<double>(beyond) < kShare * static_cast<double>(rows))
    return {};
  const std::string_view unit = units_of(axis.rotary).force;
  return fmt::format(
      "the force of the log goes up to {:.4g} {}, and the drive makes {} {:.4g} {} ({} of {} rows are beyond it): the column holds what "
      "was asked for before the limit (log the actual force or current), or the scale of the force is wrong, or the file is",
      most, unit, only_rated ? "hardly more than five times its rated" : "at most", limit, unit, beyond,
      rows);
}

std::string mass_contradiction(const AxisDescription& axis, double low, double high) {
  const Rough& rough = axis.commissioning.mass;
  if (!std::isfinite(low) || !std::isfinite(high)) return {};
  const std::optional<double> rotor = axis.drive ? axis.drive->reflected_mass() : std::nullopt;
  if (rotor && high < kRoundedRotor * *rotor) {
    const std::string_view its = units_of(axis.rotary).mass;
    return fmt::format(
        "the mass, {:.4g} to {:.4g} {}, is less than that of the rotor alone, {:.4g} {} (drive.rotor_inertia through the "
        "transmission): a scale of the log is wrong (positions in diameter or in another unit, the scale of the force), or the file is",
        low, high, its, *rotor, its);
  }
  if (rough.empty()) return {};
  if (low <= rough.high() && high >= rough.low()) return {};
  const std::string_view unit = units_of(axis.rotary).mass;
  // Mass is often given without the motor, which a screw multiplies.
  std::string rotor_left_out;
  const std::optional<double> radius = axis.drive ? axis.drive->radius() : std::nullopt;
  if (low > rough.high() && radius && !rotor) {
    const double excess = 0.5 * (low + high) - rough.middle();
    rotor_left_out = fmt::format(
        "commissioning.mass is that without the rotor of the motor, which would have {:.2g} kg m2 (write drive.rotor_inertia, and the mass with "
        "it), ",
        excess * *radius * *radius / axis.drive->motors);
  }
  return fmt::format(
      "the mass, {:.4g} to {:.4g} {}, contradicts the machine file, which allows {:.4g} to {:.4g} {}: {}a scale of the log is wrong (positions in counts of another "
      "length, the force in another unit, another time between rows, one motor of two, a second motor whose force has the other sign), a drive rings, or the file "
      "is wrong",
      low, high, unit, rough.low(), rough.high(), unit, rotor_left_out);
}

std::string load_contradiction(const AxisDescription& axis, double load) {
  const RoughAxis& rough = axis.commissioning;
  if (rough.friction.empty() || rough.unbalance || !std::isfinite(load)) return {};
  const double told = rough.load_force();
  const double apart = std::abs(load - told) - rough.load_spread();
  // Friction that differs between the directions looks like a small load.
  if (apart < std::max(0.25 * std::abs(told), rough.friction.high())) return {};
  const std::string_view unit = units_of(axis.rotary).force;
  return fmt::format(
      "the log shows a load of {:.4g} {}, and the machine file says {}: without force the axis may fall. Write commissioning.load = \"{:.4g} {}\" "
      "(positive: it pulls towards the lower end of the travel), or the sign of the force in the log is wrong",
      load, unit, rough.load.empty() ? std::string("none") : fmt::format("one of {:.4g} {}", told, unit),
      load, unit);
}

std::string friction_unlike_file(const AxisDescription& axis, const ident::Result& result) {
  const Rough& rough = axis.commissioning.friction;
  if (rough.empty() || result.force_unit != "N") return {};
  double low = std::numeric_limits<double>::infinity(), high = 0.0;
  for (const char* name : {"coulomb_positive", "coulomb_negative", "static_positive", "static_negative"}) {
    const ident::Parameter* found = result.find(name);
    if (found == nullptr || !std::isfinite(found->value)) continue;
    low = std::min(low, std::abs(found->value));
    high = std::max(high, std::abs(found->value));
  }
  if (!(high > 0.0) || (low <= rough.high() && high >= rough.low())) return {};
  const std::string_view unit = units_of(axis.rotary).force;
  return fmt::format(
      "friction at low speed, {:.4g} to {:.4g} {}, is not what the machine file allows, {:.4g} to {:.4g} {}: where the mass is right, correct "
      "commissioning.friction, by which excite designs motions; where it is wrong too, so is the scale of the force",
      low, high, unit, rough.low(), rough.high(), unit);
}

}  // namespace stribeck::workflow
