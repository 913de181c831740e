#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <stribeck/io/gcode/interpreter.hpp>
#include <stribeck/report/table.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/workflow/option.hpp>
#include <stribeck/workflow/path/part_program.hpp>
#include <stribeck/workflow/path/planned_path.hpp>

namespace stribeck::workflow {
namespace {

Vec<double, 3> as_vector(const std::array<double, 3>& p) { return {{p[0], p[1], p[2]}}; }

std::vector<sim::PartMove> as_moves(const std::vector<io::CanonicalMove>& from, double tolerance) {
  std::vector<sim::PartMove> moves;
  moves.reserve(from.size());
  for (const io::CanonicalMove& c : from) {
    sim::PartMove m;
    m.to = as_vector(c.to);
    m.arc = c.arc;
    m.centre = as_vector(c.centre);
    m.normal = as_vector(c.normal);
    m.turns = c.turns;
    m.feed = c.feed;
    m.dwell = c.dwell;
    m.tolerance = c.tolerance.value_or(tolerance);
    if (c.waits || c.control == io::PathControl::kExactStop) {
      m.junction = sim::Junction::kStop;
    } else if (c.control == io::PathControl::kExactPath) {
      m.junction = sim::Junction::kExact;
    }
    moves.push_back(m);
  }
  return moves;
}

/// Position of an axis before the program: its home, 0, or the middle of a travel that does not contain 0 (as `export` writes HOME).
double home_of(const sim::AxisLimits& l) {
  return l.travel_min <= 0.0 && l.travel_max >= 0.0 ? 0.0 : 0.5 * (l.travel_min + l.travel_max);
}

/// The interpreter assumes that every axis begins at 0. An axis that cannot be at 0 stays at its home until a move takes it away
/// from 0, as it would on the machine. Returns the homes.
Vec<double, 3> begin_at_home(std::vector<sim::PartMove>& moves, const sim::Machine& machine,
                             const std::vector<std::size_t>& axes, const std::string& file,
                             std::string& note) {
  constexpr double kStill = 5e-6;  // sums of offsets and places as printed, in inches in the worst case
  Vec<double, 3> home;
  std::vector<std::string> names;
  std::vector<std::string> places;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const auto& [name, axis] = machine.axes[axes[i]];
    home[i] = home_of(axis.limits);
    if (home[i] == 0.0) continue;
    names.push_back(name);
    places.push_back(fmt::format("{:.6g}", home[i] * 1e3));
    for (sim::PartMove& m : moves) {
      if (std::abs(m.to[i]) > kStill && !m.arc) break;
      if (m.arc && std::abs(m.normal[i]) < 0.5) {
        throw io::InputError(
            {file,
             0,
             {},
             fmt::format(
                 "begins with an arc from {} = 0 mm, which is outside the travel of that axis, {:.6g} to "
                 "{:.6g} mm (begin with G0 to a place inside)",
                 name, axis.limits.travel_min * 1e3, axis.limits.travel_max * 1e3)});
      }
      if (std::abs(m.to[i]) > kStill) break;
      m.to[i] = home[i];
    }
  }
  const bool one = names.size() == 1;
  if (!names.empty())
    note += fmt::format(
        "{} {} at {} mm, the middle of {} (0 is outside), and {} there until the program moves {} from 0\n",
        (one ? "axis " : "axes ") + report::listed(names), one ? "begins" : "begin", report::listed(places),
        one ? "its travel" : "their travels", one ? "stays" : "stay", one ? "it" : "them");
  return home;
}

constexpr std::array<const char*, 3> kLetters{"x", "y", "z"};

/// Sets the axes x, y and z that the machine has, at least two; returns which of the three these are.
std::vector<std::size_t> use_axes(sim::CompareSpec& spec, const sim::Machine& machine,
                                  const std::string& machine_file) {
  spec.axes.clear();
  std::vector<std::size_t> letters;
  for (std::size_t k = 0; k < kLetters.size(); ++k) {
    const auto found = std::find_if(machine.axes.begin(), machine.axes.end(),
                                    [&](const auto& axis) { return axis.first == kLetters[k]; });
    if (found == machine.axes.end()) continue;
    spec.axes.push_back(static_cast<std::size_t>(found - machine.axes.begin()));
    letters.push_back(k);
  }
  if (letters.size() >= 2) return letters;
  std::string without_model;
  for (const std::string& name : machine.left_out)
    without_model += fmt::format("{0}--axis-file {1}=FILE", without_model.empty() ? "" : " ", name);
  throw io::InputError(
      {machine_file, 0, "axes",
       without_model.empty()
           ? "has not two of the axes x, y and z, expected those that the part program moves"
           : fmt::format(
                 "a part program moves two of the axes x, y and z or all three, but there is no model of {} (add {})",
                 report::listed(machine.left_out), without_model)});
}

/// Leaves the two coordinates that the machine has as the first two of every move. Refuses moves of the third.
void keep_axes(std::vector<sim::PartMove>& moves, const std::vector<std::size_t>& letters,
               const sim::Machine& machine, const std::string& file, const std::string& machine_file) {
  const std::size_t missing = 3 - letters[0] - letters[1];
  const std::string name = kLetters[missing];
  const bool no_model =
      std::find(machine.left_out.begin(), machine.left_out.end(), name) != machine.left_out.end();
  // The order x, z, y mirrors the space: what turned counter-clockwise then turns clockwise.
  const double hand = missing == 1 ? -1.0 : 1.0;
  const auto ordered = [&](const Vec<double, 3>& p) {
    return Vec<double, 3>{{p[letters[0]], p[letters[1]], p[missing]}};
  };
  for (std::size_t k = 0; k < moves.size(); ++k) {
    sim::PartMove& m = moves[k];
    m.to = ordered(m.to);
    m.centre = ordered(m.centre);
    m.normal = hand * ordered(m.normal);
    if (std::abs(m.to[2]) <= sim::kExactTolerance && (!m.arc || std::abs(m.normal[2]) >= 1.0)) continue;
    const bool along = std::abs(m.to[2]) > sim::kExactTolerance;
    const std::string what = along ? fmt::format("goes to {} = {:.6g} mm", name, m.to[2] * 1e3)
                                   : fmt::format("is an arc outside of the plane of {} and {}",
                                                 kLetters[letters[0]], kLetters[letters[1]]);
    const std::string why = no_model ? fmt::format("there is no model of axis {}", name)
                                     : fmt::format("{} has no axis {}", machine_file, name);
    const std::string way_out =
        no_model ? fmt::format("add --axis-file {}=FILE", name) : "choose another machine";
    throw io::InputError(
        {file, 0, fmt::format("move {}", k + 1),
         fmt::format("{}, but {} (take the moves of {} out, or {})", what, why, name, way_out)});
  }
}

template <std::size_t N>
void plan(sim::CompareSpec& spec, const PathOptions& o, const sim::Machine& machine,
          const Vec<double, 3>& start, const std::vector<sim::PartMove>& moves) {
  const sim::PartLimits<N> limits = part_limits<N>(o, machine, spec.axes);
  const auto part = sim::plan_part<N>(start, moves, limits);
  if (part == nullptr) throw io::InputError({o.path, 0, {}, "has no motion, expected at least one move"});
  check_places<N>(*part, machine, spec.axes, o.path,
                  "move the program with G10 L2 or G92, or make it smaller");
  spec.travels = {planned_travel<N>(part, std::filesystem::path(o.path).filename().string())};
}

}  // namespace

void use_part(sim::CompareSpec& spec, const PathOptions& o, const sim::Machine& machine,
              const std::string& machine_file) {
  const PathOptions standard;
  if (o.size != standard.size || o.laps != standard.laps)
    refuse_option("--path", "a part program has its own size and runs once (leave out --size and --laps)");
  const double tolerance =
      option_si("--corner-tolerance", o.corner_tolerance, quantity("m", "um").at_least(1e-9));
  const std::vector<std::size_t> letters = use_axes(spec, machine, machine_file);
  const io::PartProgram program = io::read_part_program(o.path);
  std::vector<sim::PartMove> moves = as_moves(program.moves, tolerance);
  if (spec.axes.size() == 2) keep_axes(moves, letters, machine, o.path, machine_file);
  std::string note;
  const Vec<double, 3> start = begin_at_home(moves, machine, spec.axes, o.path, note);
  if (spec.axes.size() == 2) {
    plan<2>(spec, o, machine, start, moves);
  } else {
    plan<3>(spec, o, machine, start, moves);
  }
  if (const auto& foreign = program.foreign_feed) {
    const double millimetres = foreign->feed * 60e3;
    note +=
        foreign->in_inches
            ? fmt::format(
                  "a feed of {:.6g} in/min remains in force under G21, as {:.6g} mm/min: LinuxCNC reads F before a G21 of the same line (give F in a later line)\n",
                  millimetres / 25.4, millimetres)
            : fmt::format(
                  "a feed of {:.6g} mm/min remains in force under G20, as {:.6g} in/min: LinuxCNC reads F before a G20 of the same line (give F in a later line)\n",
                  millimetres, millimetres / 25.4);
  }
  if (program.inches)
    note += "the interpreter prints four decimals: positions in inches are known to 2.54 um only\n";
  if (program.tools) note += "the interpreter has no tool table: tools have length and radius 0\n";
  spec.travels.front().note = note;
}

std::string part_words(const sim::CompareSpec& spec) {
  std::string words;
  bool rounded = false;
  for (const sim::Travel& travel : spec.travels) {
    if (travel.part() == nullptr) continue;
    words += fmt::format("Part {}: {}.\n", travel.name, report::in_words(*travel.part()));
    rounded = rounded || travel.part()->corners > 0;
  }
  if (rounded) words += "The contour error is the distance from the rounded path, without the rounding.\n";
  return words;
}

}  // namespace stribeck::workflow
