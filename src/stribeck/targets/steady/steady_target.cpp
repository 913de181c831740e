#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <limits>
#include <set>

#include <stribeck/ident/shown.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/printable.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/sim/axis_file.hpp>
#include <stribeck/targets/pulse/build_up.hpp>
#include <stribeck/targets/pulse/options.hpp>
#include <stribeck/targets/steady/approximation.hpp>
#include <stribeck/targets/steady/gain.hpp>
#include <stribeck/targets/steady/steady_target.hpp>
#include <stribeck/workflow/machine/axis_units.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::targets {

namespace {

using workflow::option_si;
using workflow::refuse_option;
using workflow::travel_si;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
/// Slowest speed that counts, as a share of the fastest, and of the width of a rise towards standstill: a table that began at a wider
/// speed would leave that out.
constexpr double kSlowest = 1e-3;
constexpr double kSlowestOfRise = 0.05;
constexpr double kLeastOfAll = 1e-6;  // of the fastest
/// Places between two telling speeds at which the error is taken.
constexpr int kBetween = 4;
constexpr int kEven = 1000;          // more places, at even distance
constexpr double kBeyond = 1.05;     // of the identified speed
constexpr double kWorthRange = 1.2;  // ratio of the speeds of both directions that is worth a word

std::string refuse_name(const std::string& name) {
  refuse_option("--name",
                fmt::format("got {}, expected a letter, then letters, digits and underscores, 16 at most",
                            io::in_quotes(name)));
}

bool is_name(const std::string& name) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  return !name.empty() && name.size() <= 16 && letter(name.front()) &&
         std::all_of(name.begin(), name.end(),
                     [&](char c) { return letter(c) || (c >= '0' && c <= '9') || c == '_'; });
}

/// What the axis files call their axes; none where one does not say it, or two say the same.
std::vector<std::string> names_in_files(const ExportRequest& o) {
  std::vector<std::string> names = axes_in_files(o);
  if (std::set(names.begin(), names.end()).size() != names.size() ||
      !std::all_of(names.begin(), names.end(), is_name))
    return {};
  return names;
}

/// A line where the axes have other names than their files say, and nobody asked for them; else nothing.
std::string word_of_names(const ExportRequest& o, const std::vector<std::string>& names) {
  std::vector<std::string> said = axes_in_files(o);
  for (std::string& name : said) {
    if (name.empty()) name = "–";
  }
  for (std::size_t i = 0; o.names.empty() && i < names.size(); ++i) {
    if (said[i] != "–" && said[i] != names[i])
      return fmt::format("The axes are called {} here; their files say {} (--name calls them otherwise).\n",
                         report::joined(names, ", "), io::one_line(report::joined(said, ", "), 100));
  }
  return {};
}

std::vector<std::string> names_of(const ExportRequest& o) {
  constexpr std::string_view kLetters = "xyzabcuvw";
  if (o.files.size() > kLetters.size()) refuse_option("AXIS.toml", "got more than nine axes");
  std::vector<std::string> names = o.names.empty() ? names_in_files(o) : o.names;
  for (std::size_t i = 0; names.size() < o.files.size() && o.names.empty(); ++i)
    names.emplace_back(1, kLetters[i]);
  if (names.size() != o.files.size())
    refuse_option("--name",
                  fmt::format("got {}, expected {}, one for each axis", names.size(), o.files.size()));
  for (const std::string& name : names) {
    if (!is_name(name)) refuse_name(name);
  }
  if (std::set(names.begin(), names.end()).size() != names.size())
    refuse_option("--name", "expected names that differ");
  return names;
}

Axis axis_of(const ExportRequest& o, std::size_t i, const std::string& name) {
  Axis a;
  a.name = name;
  a.file = o.files[i];
  const auto file = workflow::read_axis_file(a.file);
  a.said = file.axis.value_or("");
  a.model = file.model;
  a.rotary = file.rotary.value_or(false);
  a.fastest = a.identified = file.identified_speed().value_or(0.0);
  a.drive = file.drive;
  a.control_period = file.control_period;
  if (file.uncertainty) a.told_from = file.uncertainty->told_from;
  if (const auto range = file.range()) a.widest = std::max(-(*range)[0], (*range)[1]);
  a.lead = o.lead.empty() ? kUnknown
                          : travel_si("--lead", workflow::of_one_turn(text_of_axis("--lead", o.lead, name)),
                                      quantity("m", "mm").positive().at_most(100.0), a.rotary);
  std::tie(a.gain, a.unit) = gain_of(o, name, a.rotary, a.lead);
  const auto of_file = a.drive ? a.drive->encoder_resolution : std::nullopt;
  a.resolution = o.resolution.empty() ? of_file.value_or(kUnknown)
                                      : travel_si("--resolution", o.resolution,
                                                  quantity("m", "um").positive().at_most(0.01), a.rotary);
  return a;
}

/// Width of the narrowest rise of friction towards standstill [m/s]; infinite: there is none.
double narrowest_rise(const friction::Model& model) {
  double narrowest = std::numeric_limits<double>::infinity();
  std::visit(
      [&]<class Map>(const Map& map) {
        if constexpr (std::is_same_v<Map, friction::Conventional<double>>) {
          if (map.stribeck) narrowest = map.stribeck->v0;
        } else {
          for (const auto* branch : {&map.positive, &map.negative}) {
            for (const auto& term : branch->gaussians) {
              if (std::abs(term.b) < term.c) narrowest = std::min(narrowest, term.c);
            }
          }
        }
      },
      model.steady);
  return narrowest;
}

/// With the speeds of the request, or of the identification.
Axis axis_with_speeds(const ExportRequest& o, std::size_t i, const std::string& name) {
  Axis a = axis_of(o, i, name);
  if (!o.speed.empty()) {
    a.fastest = travel_si("--speed", o.speed, quantity("m/s", "mm/s").positive(), a.rotary);
    // Beside a loop it is the feed on a circle: the table goes on to where the axis was identified.
    if (!o.controller.empty()) a.fastest = std::max(a.fastest, a.identified);
  } else if (!(a.fastest > 0.0)) {
    refuse_option("--speed",
                  fmt::format("missing: {} does not say how fast the axis goes, e.g. \"100 mm/s\"", a.file));
  }
  a.slowest = std::clamp(kSlowestOfRise * narrowest_rise(a.model.friction), kLeastOfAll * a.fastest,
                         kSlowest * a.fastest);
  return a;
}

/// Refuses what the target would not look at: its numbers are in SI units of the axis, whatever was given.
void refuse_without_effect(const SteadyTarget& t, const ExportRequest& o) {
  if (!o.gain.empty() && !t.needs_gain() && !t.takes_gain)
    refuse_option("--gain", fmt::format("does not apply to --to {}: its numbers are in SI units", t.name));
  if (!o.lead.empty() && !t.needs_lead() && !t.takes_lead && !gives_torque(o))
    refuse_option(
        "--lead",
        fmt::format("does not apply to --to {}: its numbers are those of the axis, not of the motor",
                    t.name));
}

void check_needs(const SteadyTarget& t, const ExportRequest& o) {
  const std::string missing = missing_options(t, o);
  if (missing.starts_with("--gain")) {
    refuse_option(
        "--gain",
        fmt::format(
            "missing: {} counts in a unit of its own; say the force of one, e.g. {}", t.name,
            t.counts == GainUnit::kBits
                ? "\"120 N/V\" (no axis file says it: the full output of the converter is mostly the peak of the drive)"
                : "\"12.5 N/%\" (an axis file that identify wrote with a machine file that has [axes.NAME.drive] says it itself)"));
  }
  if (!missing.empty())
    refuse_option(
        "--lead",
        fmt::format("missing: {} counts at the motor; say the travel per turn, e.g. \"10 mm\"", t.name));
}

struct Error {
  double largest = 0.0;  ///< [N]
  double rms = 0.0;
  double friction = 0.0;  ///< RMS of the friction itself [N]
};

/// From where the form holds on; the axis then says so.
Error error_of(Axis& axis, const Form& form) {
  axis.slowest = std::clamp(form.from, axis.slowest, axis.fastest);
  Error e;
  double squares = 0.0;
  double friction = 0.0;
  const std::vector<double> telling = telling_speeds(axis);
  const double range = telling.back() - telling.front();
  const auto add = [&](double speed, double share) {
    for (const double v : {speed, -speed}) {
      const double f = axis.friction(v);
      const double off = std::abs(form.held(v) - f);
      e.largest = std::max(e.largest, off);
      squares += 0.5 * share * off * off;
      friction += 0.5 * share * f * f;
    }
  };
  for (int i = 0; i <= kEven; ++i) add(telling.front() + range * i / kEven, 0.0);
  for (std::size_t i = 1; i < telling.size(); ++i) {
    const double step = (telling[i] - telling[i - 1]) / kBetween;
    for (int k = 0; k < kBetween; ++k) add(telling[i - 1] + k * step, step / range);
  }
  add(telling.back(), 0.0);
  e.rms = std::sqrt(squares);
  e.friction = std::sqrt(friction);
  return e;
}

std::vector<std::string> left_out(const Axis& axis, const Form& form) {
  const ident::Shown shown("m", "N", axis.rotary);
  std::vector<std::string> out;
  if (axis.fastest == axis.identified && axis.widest > kWorthRange * axis.fastest)
    out.push_back(fmt::format(
        "what was identified beyond {} in one direction, up to {} (the other ends there; --speed goes on)",
        shown.speed(axis.fastest), shown.speed(axis.widest)));
  double periodic = 0.0;
  for (const auto& term : axis.model.friction.eccentric) periodic += term.amplitude;
  if (periodic > 0.0 && !form.periodic)
    out.push_back(
        fmt::format("{} {} periodic in position", report::significant(periodic, 3), shown.force_unit()));
  if (const auto& spring = axis.model.friction.spring; spring && !form.periodic)
    out.push_back(fmt::format("a spring of {}", shown.force_per_length(spring->stiffness)));
  double most = 0.0;
  for (const friction::Place& p : axis.model.friction.places) most = std::max(most, std::abs(p.level - 1.0));
  if (most > 0.0)
    out.push_back(
        fmt::format("up to {} % of friction along the travel", report::significant(100.0 * most, 2)));
  double stiffest = 0.0;
  for (const friction::Place& p : axis.model.friction.places)
    stiffest = std::max(stiffest, std::abs(p.stiffness - 1.0));
  if (stiffest > 0.0 && form.pre_sliding)
    out.push_back(
        fmt::format("up to {} % of stiffness along the travel", report::significant(100.0 * stiffest, 2)));
  if (friction::has_pre_sliding(axis.model.friction.dynamics) && !form.pre_sliding)
    out.emplace_back("pre-sliding (the force jumps at a reversal)");
  if (axis.model.load != 0.0 && !form.load)
    out.push_back(
        fmt::format("the load of {} {}", report::significant(axis.model.load, 4), shown.force_unit()));
  return out;
}

/// A comment line of the target. The text cannot end it, nor take in the next line by a backslash at its end.
std::string remark(std::string_view comment, const std::string& words) {
  constexpr std::size_t kLongest = 1000;
  std::string text = io::one_line(words, kLongest);
  const auto without = [&](std::string_view mark) {
    for (std::size_t at = text.find(mark); at != std::string::npos; at = text.find(mark, at))
      text.replace(at, mark.size(), "_");
  };
  if (comment == "(*") {
    without("*)");
    without("(*");
    return "(* " + text + " *)\n";
  }
  if (comment == "/*") {
    without("*/");
    without("/*");
    return "/* " + text + " */\n";
  }
  if (comment == "<!--") {
    // XML permits no two hyphens in a comment.
    without("--");
    return "<!-- " + text + " -->\n";
  }
  return std::string(comment) + " " + text + "\n";
}

/// How the force of an axis comes and goes around a reversal: found, written and told.
void add_build_up(const SteadyTarget& target, const PulseTask& task, std::size_t i, const Axis& axis,
                  SteadyText& w) {
  TableForce& table = w.tables.back();
  table = best_build_up(task, i, table.force);
  w.text += target.build_up(table, task.period);
  w.json.back()["build_up_um"] = 1e6 * table.build_up;
  w.json.back()["look_ahead_ms"] = 1e3 * table.look_ahead;
  const std::string before =
      table.look_ahead > 0.0
          ? fmt::format("goes over {} ms before it", report::significant(1e3 * table.look_ahead, 3))
          : "stays until it";
  w.words += fmt::format("{}: the force comes over {} µm after a reversal and {}.\n", axis.name,
                         report::significant(1e6 * table.build_up, 3), before);
}

/// A unit that is too large for the format leaves nothing to compensate, and so does friction of which the format holds no part.
void refuse_nothing(const SteadyTarget& target, const Axis& axis, const Form& form, const Error& e) {
  if (!(e.friction > 0.0)) return;
  for (const double share : {-1.0, -0.3, -0.03, 0.03, 0.3, 1.0}) {
    if (form.held(share * axis.fastest) != 0.0) return;
  }
  const ident::Shown shown("m", "N", axis.rotary);
  if (target.needs == SteadyNeeds::kLead || target.needs == SteadyNeeds::kNothing)
    throw io::InputError(
        {axis.file, 0, "friction.steady",
         fmt::format("{} ({}) would hold nothing of this friction of {} RMS (choose another target)",
                     target.name, target.what, shown.force(e.friction))});
  refuse_option(
      "--gain",
      fmt::format(
          "got {} per {}: in whole steps of this format the friction of {} RMS becomes 0; give the force of the unit "
          "in which the control counts, e.g. of one bit of its output",
          shown.force(axis.gain), axis.unit, shown.force(e.friction)));
}

/// What an export should say of friction that the logs did not tell; empty: they told it, or it is not known whether.
std::string untold(const Axis& axis) {
  if (!(axis.told_from > axis.slowest)) return {};
  const ident::Shown shown("m", "N", axis.rotary);
  const double force = 0.5 * (axis.friction(axis.slowest) - axis.friction(-axis.slowest));
  return fmt::format("; below {} the logs do not tell the friction ({} stand there: record slow jogs)",
                     shown.speed(axis.told_from), shown.force(force));
}

nlohmann::ordered_json json_of(const Axis& axis, const Error& e, const std::vector<std::string>& missing) {
  return {{"name", axis.name},
          {"file", axis.file},
          {"rotary", axis.rotary},
          {"slowest_mm_per_s", 1e3 * axis.slowest},
          {"fastest_mm_per_s", 1e3 * axis.fastest},
          {"told_from_mm_per_s", axis.told_from > 0.0 ? nlohmann::ordered_json(1e3 * axis.told_from)
                                                      : nlohmann::ordered_json(nullptr)},
          {"max_error_N", e.largest},
          {"rms_error_N", e.rms},
          {"rms_friction_N", e.friction},
          {"left_out", missing}};
}

}  // namespace

SteadyText steady_text(const SteadyTarget& target, const ExportRequest& o) {
  check_needs(target, o);
  if (target.linear_only && any_rotary(o))
    throw io::InputError(
        {o.files.front(), 0, "rotary",
         fmt::format(
             "{} has no place for a rotary axis (choose csv, json, c or cia402, where N stands for N m and mm for mrad)",
             target.name)});
  const std::vector<std::string> names = names_of(o);
  refuse_unknown_axes("--gain", o.gain, names);
  refuse_unknown_axes("--lead", o.lead, names);
  const std::vector<std::size_t> numbers = axis_numbers(names);
  SteadyText w;
  w.words = word_of_names(o, names);
  w.json = nlohmann::ordered_json::array();
  std::vector<std::string> to_do;
  std::vector<Axis> axes;
  const std::optional<PulseTask> task = target.takes_circle() ? circle_task(target.name, o) : std::nullopt;
  for (std::size_t i = 0; i < o.files.size(); ++i) {
    Axis axis = axis_with_speeds(o, i, names[i]);
    axis.number = numbers[i];
    const std::string taken = take_from_file(target, axis);
    count_as(target, axis);
    const Form form = target.write(axis);
    const Error e = error_of(axis, form);
    refuse_nothing(target, axis, form, e);
    const std::vector<std::string> missing = left_out(axis, form);
    const ident::Shown shown("m", "N", axis.rotary);
    std::string words = fmt::format(
        "from {6} to {0} {1}/s at most {2} {5} beside the friction of {3} {5} RMS, RMS {4} {5}",
        report::significant(shown.scale() * axis.fastest, 4), shown.length_unit(),
        report::significant(e.largest, 3), report::significant(e.friction, 3), report::significant(e.rms, 3),
        shown.force_unit(), report::significant(shown.scale() * axis.slowest, 2));
    if (axis.widest > 0.0 && axis.fastest > kBeyond * axis.widest) {
      words += fmt::format("; nothing was identified beyond {}", shown.speed(axis.widest));
    } else if (axis.identified > 0.0 && axis.fastest > kBeyond * axis.identified) {
      words +=
          fmt::format("; in one direction nothing was identified beyond {}", shown.speed(axis.identified));
    }
    words += untold(axis);
    if (!missing.empty()) words += "; not in it: " + report::joined(missing, ", ");
    w.text += remark(target.comment, fmt::format("Axis {} from {}: {}", axis.name, axis.file, words));
    if (axis.rotary)
      w.text += remark(target.comment, fmt::format("Axis {} is {}", axis.name, workflow::kRotaryAsLinear));
    w.text += form.text;
    w.tables.push_back({form.held, 0.0, 0.0, form.bristles});
    w.words += fmt::format("{}: {}.\n", axis.name, words) + taken + word_of_gain(target, axis);
    if (std::find(to_do.begin(), to_do.end(), form.to_do) == to_do.end()) to_do.push_back(form.to_do);
    w.json.push_back(json_of(axis, e, missing));
    if (task && target.build_up != nullptr) add_build_up(target, with_gains_of(*task, i), i, axis, w);
    axes.push_back(axis);
  }
  if (target.check_names != nullptr) target.check_names(axes);
  const std::string head = target.head == nullptr ? std::string() : target.head(axes);
  w.text = remark(target.comment, "Written by: " + o.command) + std::string(target.begin) + head + w.text +
           std::string(target.end);
  if (target.pack != nullptr) {
    const Packed packed = target.pack(axes, w, o.command);
    w.text = packed.bytes;
    if (!packed.words.empty()) w.words += packed.words + "\n";
  }
  if (task) {
    UserCircle c = user_circle(*task);
    const CircleError with = c.circle.with(std::array{w.tables[c.axes[0]], w.tables[c.axes[1]]});
    w.words += circle_words(*task, c, "this table", with);
    w.circle = circle_json(*task, c, with);
  }
  for (const std::string& words : to_do) w.words += words + "\n";
  return w;
}

double Axis::friction(double v) const noexcept {
  return std::visit([&](const auto& map) { return friction::steady_force(map, v, 0.0); },
                    model.friction.steady);
}

std::optional<PulseTask> circle_task(std::string_view target, const ExportRequest& o) {
  if (o.controller.empty()) return {};
  // What else the target takes is its own affair.
  ExportRequest circle = o;
  circle.names.clear();
  circle.gain.clear();
  circle.lead.clear();
  circle.resolution.clear();
  circle.zero.clear();
  return pulse_task(
      target, [](std::size_t axis) { return fmt::format("{}", axis); }, circle);
}

std::vector<Axis> axes_of(const ExportRequest& o) {
  const std::vector<std::string> names = names_of(o);
  std::vector<Axis> out;
  for (std::size_t i = 0; i < names.size(); ++i) out.push_back(axis_of(o, i, names[i]));
  return out;
}

void refuse_linuxcnc_options(const ExportRequest& o) {
  const auto refuse = [](const char* option) { refuse_option(option, "applies to --to linuxcnc alone"); };
  if (!o.omega.empty()) refuse("--omega");
  if (!o.feedforward.empty()) refuse("--feedforward");
  if (o.lincurve) refuse("--lincurve");
  if (!o.parameters.empty()) refuse("--parameters");
  if (!o.axis_files.empty()) refuse("--axis-file");
}

WrittenBeside write_beside(const SteadyTarget& target, const std::string& output) {
  if (!target.beside) return {};
  namespace fs = std::filesystem;
  const std::string file = (fs::path(output).parent_path() / std::string(target.beside->name)).string();
  std::error_code ignored;
  if (fs::exists(file, ignored) && io::read_text(file) != target.beside->text)
    return {file, fmt::format("Kept, because it is another one: {} (remove it to write it anew).\n", file)};
  io::write_atomically(file, target.beside->text);
  return {file, fmt::format("Beside it: {}.\n", file)};
}

Exported write_steady(const SteadyTarget& target, const ExportRequest& o) {
  refuse_linuxcnc_options(o);
  refuse_without_effect(target, o);
  if (!target.encoder && !o.resolution.empty())
    refuse_option("--resolution", "applies only to --to pid and --to all");
  if (!o.zero.empty()) refuse_option("--zero", "applies only to --to moteus and --to all");
  if (!target.takes_circle() || o.controller.empty()) refuse_pulse_options(o);
  io::check_writable(o.output);
  if (target.beside && std::filesystem::path(o.output).filename() == target.beside->name)
    refuse_option("--output",
                  fmt::format("{} is the name of the source that is written beside, expected another one",
                              target.beside->name));
  const SteadyText w = steady_text(target, o);
  io::write_atomically(o.output, w.text);
  Exported out;
  out.json = {{"schema", "stribeck.export/1"}, {"to", target.name}, {"file", o.output}, {"axes", w.json}};
  if (!w.circle.is_null()) out.json["circle"] = w.circle;
  const WrittenBeside beside = write_beside(target, o.output);
  if (!beside.file.empty()) out.json["beside"] = beside.file;
  out.text = w.words + word_of_common_gain(o) + fmt::format("Written to {}.\n", o.output) + beside.words;
  return out;
}

}  // namespace stribeck::targets
