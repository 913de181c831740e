#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>

#include <stribeck/ident/shown.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/printable.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/targets/cogging/moteus.hpp>
#include <stribeck/targets/pulse/options.hpp>
#include <stribeck/targets/steady/nearest_polyline.hpp>
#include <stribeck/targets/steady/steady_target.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::targets {

namespace {

using workflow::refuse_option;
using workflow::travel_si;

constexpr std::size_t kCells = 1024;
constexpr double kLargestCell = 127.0;
/// Positions of a turn at which the error is taken, some between each two cells.
constexpr std::size_t kPositions = 8 * kCells;
/// How far the lead may be from a whole number of periods, as a share of that number. An identified period is off by as much; where the
/// difference is real, the term drifts away from the table (drift_of).
constexpr double kPeriodTolerance = 5e-3;

constexpr double kLeastCurrent = 1e-9;  ///< [A]
constexpr double kLeastShare = 1e-6;    ///< of the sum of the amplitudes: the terms cancel but for rounding
constexpr double kLargestZero = 1e3;    ///< [m]: beyond it the digits of a position no longer tell the phase

using Terms = std::vector<friction::Eccentric<double>>;

bool fits_the_turn(const friction::Eccentric<double>& t, double lead) {
  const double waves = lead / t.period;
  const double whole = std::round(waves);
  return t.form == friction::EccentricForm::kAdditive && t.amplitude > 0.0 && whole >= 1.0 &&
         whole < 0.5 * kCells && std::abs(waves - whole) <= kPeriodTolerance * whole;
}

/// Force of the terms at a share of the turn that begins at `zero` [N], each with the whole number of periods per turn that it is
/// nearest to; at `zero` the terms have their own phase.
double table_force(const Terms& terms, double lead, double zero, double turn) {
  double force = 0.0;
  for (const auto& t : terms)
    force +=
        t.amplitude * std::sin(2.0 * kPi * (std::round(lead / t.period) * turn + zero / t.period) - t.phase);
  return force;
}

/// The same with the periods as they were identified.
double force_at(const Terms& terms, double x) {
  double force = 0.0;
  for (const auto& t : terms) force += t.amplitude * std::sin(2.0 * kPi * x / t.period - t.phase);
  return force;
}

/// Phase between a term and the table per travel [rad/m].
double drift_of(const friction::Eccentric<double>& t, double lead) {
  return 2.0 * kPi * std::abs(1.0 / t.period - std::round(lead / t.period) / lead);
}

/// Empty where a board could not tell the current from none, also because the terms cancel.
Terms terms_of_the_turn(const Axis& axis) {
  Terms out;
  double sum = 0.0, largest = 0.0;
  for (const auto& t : axis.model.friction.eccentric) {
    if (fits_the_turn(t, axis.lead)) out.push_back(t), sum += t.amplitude;
  }
  for (std::size_t k = 0; k < kCells; ++k) {
    const double turn = static_cast<double>(k) / kCells;
    largest = std::max(largest, std::abs(table_force(out, axis.lead, 0.0, turn)));
  }
  const double least = std::max(kLeastCurrent * axis.gain, kLeastShare * sum);
  return largest > least ? out : Terms{};
}

struct CoggingTable {
  double scale = 0.0;  ///< [A]
  std::array<int, kCells> cells{};

  /// Current [A] at this share of a turn of the encoder, as the firmware interpolates.
  [[nodiscard]] double at(double turn) const {
    const double cell = turn * kCells;
    const auto k = std::min(static_cast<std::size_t>(cell), kCells - 1);
    const double s = cell - static_cast<double>(k);
    return scale * ((1.0 - s) * cells[k] + s * cells[(k + 1) % kCells]);
  }
};

CoggingTable cogging_table(const Axis& axis, const Terms& terms, double zero) {
  std::array<double, kCells> current{};
  double largest = 0.0;
  for (std::size_t k = 0; k < kCells; ++k) {
    current[k] = table_force(terms, axis.lead, zero, static_cast<double>(k) / kCells) / axis.gain;
    largest = std::max(largest, std::abs(current[k]));
  }
  CoggingTable table;
  table.scale = with_digits(largest / kLargestCell, 6);
  for (std::size_t k = 0; k < kCells; ++k) {
    table.cells[k] =
        static_cast<int>(std::clamp(std::round(current[k] / table.scale), -kLargestCell, kLargestCell));
  }
  return table;
}

struct CoggingError {
  double largest = 0.0;  ///< [N]
  double rms = 0.0;
  double force = 0.0;  ///< RMS of the terms themselves
};

CoggingError cogging_error(const Axis& axis, const Terms& terms, double zero, const CoggingTable& table) {
  CoggingError e;
  for (std::size_t i = 0; i < kPositions; ++i) {
    const double turn = (static_cast<double>(i) + 0.5) / kPositions;
    const double force = force_at(terms, zero + axis.lead * turn);
    const double off = axis.gain * table.at(turn) - force;
    e.largest = std::max(e.largest, std::abs(off));
    e.rms += off * off / kPositions;
    e.force += force * force / kPositions;
  }
  e.rms = std::sqrt(e.rms);
  e.force = std::sqrt(e.force);
  return e;
}

/// Steady friction is always among it: the table knows positions alone.
std::vector<std::string> not_in_the_table(const Axis& axis) {
  const ident::Shown shown("m", "N", axis.rotary);
  std::vector<std::string> out{"friction over velocity"};
  if (friction::has_pre_sliding(axis.model.friction.dynamics)) out.emplace_back("pre-sliding");
  if (!axis.model.friction.places.empty()) out.emplace_back("friction along the travel");
  if (const auto& spring = axis.model.friction.spring)
    out.push_back("a spring of " + shown.force_per_length(spring->stiffness));
  for (const auto& t : axis.model.friction.eccentric) {
    if (t.amplitude <= 0.0 || fits_the_turn(t, axis.lead)) continue;
    const char* why = t.form == friction::EccentricForm::kProportional
                          ? "which changes its sign with the velocity"
                          : "of which the lead is no whole number of periods";
    out.push_back(
        fmt::format("{} with a period of {}, {}", shown.force(t.amplitude), shown.length(t.period), why));
  }
  if (axis.model.load != 0.0) out.push_back("the load of " + shown.force(axis.model.load));
  return out;
}

/// A sentence for each term that is a degree or more off the table after a hundred turns; "" where none is.
std::string drift_in_words(const Axis& axis, const Terms& terms) {
  constexpr double kTurns = 100.0;
  constexpr double kDegree = kPi / 180.0;
  const ident::Shown shown("m", "N", axis.rotary);
  std::string words;
  for (const auto& t : terms) {
    const double off = kTurns * axis.lead * drift_of(t, axis.lead) / kDegree;
    if (off < 1.0) continue;
    words += fmt::format(
        "The period of {} does not divide the lead exactly: if that is true of the machine, the term and the table are {} deg apart after "
        "{} of travel from --zero (a period that is bound to the motor divides it; look at its interval).\n",
        shown.length(t.period), ident::digits(off, 2), shown.length(kTurns * axis.lead));
  }
  return words;
}

/// What the options leave out, from the drive in the axis file.
Axis with_drive_of_file(Axis axis) {
  if (!axis.drive) return axis;
  if (axis.unit.empty() && axis.drive->force_per_ampere) {
    axis.gain = *axis.drive->force_per_ampere;
    axis.unit = "A";
  }
  if (std::isnan(axis.lead) && axis.drive->travel_per_turn) axis.lead = *axis.drive->travel_per_turn;
  return axis;
}

/// The axis, with what the table needs of the options.
Axis moteus_axis(const ExportRequest& o) {
  if (o.files.size() != 1)
    refuse_option("AXIS.toml",
                  fmt::format("got {}, expected one: every motor has a board of its own", o.files.size()));
  const Axis axis = with_drive_of_file(axes_of(o).front());
  if (axis.unit.empty())
    refuse_option("--gain", "missing: moteus counts amperes; say the force of one, e.g. \"140 N/A\"");
  if (std::isnan(axis.lead))
    refuse_option("--lead", "missing: moteus counts at the motor; say the travel per turn, e.g. \"10 mm\"");
  if (axis.unit != "A")
    refuse_option(
        "--gain",
        fmt::format("got the unit {}, expected A: moteus counts amperes of the q axis, e.g. \"140 N/A\"",
                    io::in_quotes(axis.unit)));
  return axis;
}

constexpr const char* kNoTerm =
    "no additive term has a period that divides the lead (--lead): a table over the motor's turn can hold nothing of this file";

Exported write_moteus(const ExportRequest& o) {
  refuse_linuxcnc_options(o);
  refuse_pulse_options(o);
  if (!o.resolution.empty()) refuse_option("--resolution", "applies only to --to pid and --to all");
  if (!o.speed.empty())
    refuse_option("--speed", "does not apply to --to moteus, whose table is over the position");
  io::check_writable(o.output);
  const MoteusText w = moteus_text(o);
  io::write_atomically(o.output, w.text);
  return {{{"schema", "stribeck.export/1"}, {"to", "moteus"}, {"file", o.output}, {"axes", w.axes}},
          w.words + fmt::format("Written to {}.\n", o.output)};
}

}  // namespace

std::string moteus_lacks(const ExportRequest& o) {
  std::vector<Axis> axes = axes_of(o);
  for (Axis& axis : axes) {
    axis = with_drive_of_file(axis);
    if (axis.unit.empty() || std::isnan(axis.lead)) return "--gain in N/A and --lead";
  }
  if (axes.size() != 1) return "a single axis file";
  if (axes.front().unit != "A") return "--gain in N/A";
  return terms_of_the_turn(axes.front()).empty() ? "a term periodic in the motor's turn" : "";
}

MoteusText moteus_text(const ExportRequest& o) {
  const Axis axis = moteus_axis(o);
  const double zero = o.zero.empty() ? 0.0 : travel_si("--zero", o.zero, quantity("m", "mm"), axis.rotary);
  if (std::abs(zero) > kLargestZero)
    refuse_option("--zero", fmt::format("got {}, expected at most 1 km", o.zero));
  const Terms terms = terms_of_the_turn(axis);
  if (terms.empty()) throw io::InputError({axis.file, 0, "friction.eccentric", kNoTerm});
  const ident::Shown shown("m", "N", axis.rotary);
  const CoggingTable table = cogging_table(axis, terms, zero);
  const CoggingError e = cogging_error(axis, terms, zero, table);
  const std::vector<std::string> missing = not_in_the_table(axis);
  const std::string words = fmt::format(
      "over a turn of the motor at most {} beside the {} RMS of the periodic terms, RMS {}; not in it: {}",
      shown.force(e.largest), shown.force(e.force), shown.force(e.rms), report::joined(missing, ", "));
  MoteusText w;
  w.text = io::comment_lines("Written by: " + o.command) +
           io::comment_lines(fmt::format("Axis {} from {}: {}", axis.name, axis.file, words)) +
           fmt::format("conf set motor.cogging_dq_scale {:.6g}\n", table.scale);
  for (std::size_t k = 0; k < kCells; ++k)
    w.text += fmt::format("conf set motor.cogging_dq_comp.{} {}\n", k, table.cells[k]);
  w.text += "conf write\n";
  w.words =
      fmt::format(
          "{}: {}.\n"
          "Goes line by line to the diagnostic console of the board (tview); it acts in position mode. Check first that the "
          "commutation encoder reads zero where the axis is at {} (--zero) and counts up in the positive direction, and that "
          "the motor at rest is pushed to and fro by at most {} A (control.q_comp_A).\n",
          axis.name, words, shown.length(zero), report::significant(table.scale * kLargestCell, 3)) +
      drift_in_words(axis, terms);
  w.axes = nlohmann::ordered_json::array({{{"name", axis.name},
                                           {"file", axis.file},
                                           {"max_error_N", e.largest},
                                           {"rms_error_N", e.rms},
                                           {"rms_periodic_N", e.force},
                                           {"left_out", missing}}});
  return w;
}

extern const Target kMoteus;
const Target kMoteus{
    "moteus", "one axis file of identify",
    "cogging table of a moteus controller: current over the position of the motor",
    "steps of a 127th of the largest current; the largest and the RMS error over a turn are printed",
    write_moteus};

}  // namespace stribeck::targets
