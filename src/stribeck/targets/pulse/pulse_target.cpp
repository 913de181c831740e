// What the targets with a pulse share: which axes, which loop, the judgement on the grid, and what the pulses do on the user's circle.
#include <fmt/format.h>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include <stribeck/core/scalar.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/log/column_names.hpp>
#include <stribeck/io/printable.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/sim/axis_file.hpp>
#include <stribeck/targets/pulse/pulse_target.hpp>
#include <stribeck/targets/steady/nearest_polyline.hpp>
#include <stribeck/workflow/built_in.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::targets {

namespace {

using workflow::option_si;
using workflow::refuse_option;

std::vector<std::string> axis_names(AxisNamer namer, const ExportRequest& o) {
  std::vector<std::string> names = o.names;
  if (o.names.empty()) {
    for (const std::size_t number : axis_numbers(axes_in_files(o))) names.push_back(namer(number));
  }
  if (names.size() != o.files.size())
    refuse_option("--name",
                  fmt::format("got {}, expected {}, one for each axis", names.size(), o.files.size()));
  for (const std::string& name : names) {
    constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_";
    if (name.empty() || name.size() > 16 || name.find_first_not_of(kLetters) != std::string::npos)
      refuse_option("--name",
                    fmt::format("got {}, expected a machine axis, e.g. {}", io::in_quotes(name), namer(0)));
  }
  if (std::set(names.begin(), names.end()).size() != names.size())
    refuse_option("--name", "expected names that differ");
  return names;
}

sim::AxisFile axis_file(const std::string& file) {
  sim::AxisFile axis = workflow::read_axis_file(file);
  if (axis.rotary.value_or(false))
    throw io::InputError(
        {file, 0, "rotary", "a pulse is found on a circle of two linear axes, this one turns"});
  if (!friction::has_pre_sliding(axis.model.friction.dynamics)) {
    throw io::InputError(
        {file, 0, "friction.dynamics",
         "is missing: the pulse depends on pre-sliding; identify from a log with reversals that shows it"});
  }
  return axis;
}

sim::ControllerSpec cascade_of(const ExportRequest& o, double period) {
  sim::ControllerSpec loop = workflow::read_controller(o.controller.empty() ? "cascade" : o.controller);
  const auto* cascade = std::get_if<control::CascadeParams>(&loop.law);
  if (cascade == nullptr || cascade->error_rate != control::ErrorRate::kDifferenceOfError) {
    refuse_option(
        "--controller",
        "expected a file whose law has the kind cascade, with error_rate left out: position, speed and "
        "current in a cascade is what the control has");
  }
  if (!cascade->stable(period))
    refuse_option(
        "--controller",
        fmt::format("the loop is unstable at a period of {:.4g} ms, expected lower gains", 1e3 * period));
  return loop;
}

/// The control period that the files name; absent: none does [s]. Refused where they differ.
std::optional<double> period_of(const std::vector<sim::AxisFile>& axes,
                                const std::vector<std::string>& names) {
  std::size_t of = axes.size();
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (!axes[i].control_period) continue;
    if (of < i && *axes[of].control_period != *axes[i].control_period)
      refuse_option(
          "--period",
          fmt::format("missing: {} says {:.4g} ms, {} {:.4g} ms; give that of the position loops", names[of],
                      1e3 * *axes[of].control_period, names[i], 1e3 * *axes[i].control_period));
    if (of == axes.size()) of = i;
  }
  return of < axes.size() ? axes[of].control_period : std::nullopt;
}

/// That of --speed; else the lowest that was identified, as far as the axes can accelerate on the circle.
double feed_of(const ExportRequest& o, const std::vector<sim::AxisFile>& axes,
               const std::optional<sim::Machine>& machine, double radius) {
  constexpr double kUsual = 1.0;  // [m/s²] of a contour, where no machine file says it
  if (!o.speed.empty()) return option_si("--speed", o.speed, quantity("m/s", "mm/s").positive());
  double feed = std::numeric_limits<double>::infinity();
  for (const sim::AxisFile& axis : axes) feed = std::min(feed, axis.identified_speed().value_or(feed));
  if (!std::isfinite(feed))
    refuse_option("--speed", "missing: the files do not say how fast the axes go, e.g. \"100 mm/s\"");
  double acceleration = machine ? std::numeric_limits<double>::infinity() : kUsual;
  if (machine) {
    for (const auto& [name, axis] : machine->axes)
      acceleration = std::min(acceleration, axis.limits.acceleration);
  }
  return std::min(feed, with_digits(std::sqrt(acceleration * radius), 2));
}

/// The machine of --machine, its axes in the order of the files. The files say which axis theirs is; where one does not, the order of
/// the files is that of the machine. An axis without a plant is the model in its file.
sim::Machine machine_of_files(const ExportRequest& o) {
  const std::vector<std::string> names = axes_in_files(o);
  const bool named = std::none_of(names.begin(), names.end(), [](const std::string& n) { return n.empty(); });
  if (!named) return workflow::read_virtual_machine(o.machine);
  std::vector<std::string> models;
  for (const auto& [own, axis] : workflow::read_description(o.machine).axes) {
    for (std::size_t i = 0; i < names.size(); ++i)
      if (io::lower_case(own) == io::lower_case(names[i])) models.push_back(own + "=" + o.files[i]);
  }
  sim::Machine machine =
      workflow::read_virtual_machine(o.machine, models, workflow::AxisWithoutTruth::kLeftOut);
  std::vector<std::pair<std::string, sim::MachineAxis>> ordered;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto same = [&](const auto& axis) {
      return io::lower_case(axis.first) == io::lower_case(names[i]);
    };
    if (std::any_of(ordered.begin(), ordered.end(), same))
      throw io::InputError({o.files[i], 0, "axis",
                            fmt::format("two files are of axis {}, expected each axis once", names[i])});
    const auto found = std::find_if(machine.axes.begin(), machine.axes.end(), same);
    if (found == machine.axes.end()) {
      std::vector<std::string> known;
      for (const auto& [name, axis] : machine.axes) known.push_back(name);
      throw io::InputError({o.files[i], 0, "axis",
                            fmt::format("is {}, and {} has {} (give --machine with this axis)",
                                        io::in_quotes(names[i]), o.machine, report::listed(known))});
    }
    ordered.push_back(*found);
  }
  machine.axes = std::move(ordered);
  return machine;
}

nlohmann::ordered_json json_of(const CircleError& e) {
  return {{"quadrant_um", 1e6 * e.quadrant},
          {"max_um", 1e6 * e.largest},
          {"circular_deviation_um", 1e6 * e.deviation}};
}

/// A peak as a share of that without compensation; where there was none, any peak is all of it.
double share_of(double peak, double without) {
  return without > 0.0 ? peak / without : peak > 0.0 ? 1.0 : 0.0;
}

std::string line_of(const char* what, const CircleError& e, const CircleError& without) {
  return fmt::format("  {} {} {} {}   {:.0f} %\n", report::left_aligned(what, 26),
                     report::right_aligned(report::micrometres(e.quadrant), 9),
                     report::right_aligned(report::micrometres(e.largest), 9),
                     report::right_aligned(report::micrometres(e.deviation), 9),
                     100.0 * share_of(e.quadrant, without.quadrant));
}

/// What is written may lower the peak and yet make the circle no rounder; empty: it makes it rounder.
std::string harm_in_words(const CircleError& without, const CircleError& with) {
  constexpr double kMore = 1.02;
  if (with.quadrant > kMore * without.quadrant)
    return fmt::format(
        "Warning: with it the peaks are larger than without, {} µm in place of {} µm: enter a part of the numbers and measure a circle.\n",
        report::micrometres(with.quadrant), report::micrometres(without.quadrant));
  if (with.deviation >= without.deviation)
    return fmt::format(
        "Warning: the circular deviation is no smaller with it than without, {} µm in place of {} µm, most likely because a part of the peaks is turned "
        "round: enter half of the numbers and measure a circle.\n",
        report::micrometres(with.deviation), report::micrometres(without.deviation));
  return {};
}

/// The gains of an axis as a control has them. Kp acts on the speed of the axis, in force.
struct LoopGains {
  double kv = 0.0;  ///< [1/s]
  double kp = 0.0;  ///< [N s/m]
  double tn = 0.0;  ///< [s]
};

/// Of a task with the gains of this axis.
LoopGains loop_gains(const PulseTask& t, std::size_t axis) {
  const auto& law = std::get<control::CascadeParams>(t.loop.law);
  return {law.position_gain[0], law.velocity_gain[0] * t.axes[axis].mass, law.integral_time[0]};
}

std::string gain_words(const LoopGains& g, std::string_view name) {
  constexpr double kMetrePerMinuteAndMillimetre = 1000.0 / 60.0;  // [1/s]
  return fmt::format("found for Kv {} (m/min)/mm{}, Kp {} N s/mm at the axis, Tn {} ms",
                     report::significant(g.kv / kMetrePerMinuteAndMillimetre, 4),
                     name.empty() ? "" : fmt::format(" ({})", name), report::significant(1e-3 * g.kp, 4),
                     report::significant(1e3 * g.tn, 4));
}

}  // namespace

PulseTask pulse_task(std::string_view target, AxisNamer axis_name, const ExportRequest& o) {
  const auto refuse = [&](const char* option) {
    refuse_option(option, fmt::format("does not apply to --to {}", target));
  };
  if (!o.omega.empty()) refuse("--omega");
  if (!o.feedforward.empty()) refuse("--feedforward");
  if (o.lincurve) refuse("--lincurve");
  if (!o.parameters.empty()) refuse("--parameters");
  if (!o.axis_files.empty()) refuse("--axis-file");
  if (!o.gain.empty()) refuse("--gain");
  if (!o.lead.empty()) refuse("--lead");
  if (!o.resolution.empty()) refuse("--resolution");
  if (!o.zero.empty()) refuse("--zero");
  PulseTask t;
  t.progress = o.progress;
  t.names = axis_names(axis_name, o);
  t.numbers = axis_numbers(axes_in_files(o));
  std::vector<sim::AxisFile> files;
  for (const std::string& file : o.files) {
    files.push_back(axis_file(file));
    t.axes.push_back(files.back().model);
    // On the circle, the cascade of the control stands in place of the drive's own loops.
    t.axes.back().drive_loop.reset();
  }
  if (!o.machine.empty()) {
    if (!o.period.empty()) refuse_option("--period", "is that of the machine; leave it out with --machine");
    t.machine = machine_of_files(o);
    if (t.machine->axes.size() < 2 || t.axes.size() < 2)
      refuse_option("--machine", "expected two axes of the machine and two axis files, for a circle");
    t.period = t.machine->sample_time;
  } else {
    const auto period = quantity("s", "ms").positive().at_least(1e-5).at_most(0.1);
    t.period =
        o.period.empty() ? period_of(files, o.files).value_or(1e-3) : option_si("--period", o.period, period);
  }
  t.loop = cascade_of(o, t.period);
  t.radius = option_si("--size", o.size.empty() ? "10 mm" : o.size, quantity("m", "mm").positive());
  t.feed = feed_of(o, files, t.machine, t.radius);
  constexpr double kMostTicks = 4e6, kLaps = 2.0;
  const double ticks = kLaps * 2.0 * kPi * t.radius / t.feed / t.period;
  if (!(ticks <= kMostTicks))
    refuse_option(
        "--size",
        fmt::format(
            "two circles of {:.4g} mm at {:.4g} mm/s take {:.3g} control periods, at most {:.3g} are simulated "
            "(give a smaller radius, a higher --speed or a longer --period)",
            1e3 * t.radius, 1e3 * t.feed, ticks, kMostTicks));
  return t;
}

UserCircle user_circle(const PulseTask& t) {
  const std::size_t second = t.axes.size() > 1 ? 1 : 0;
  const std::array known{t.axes[0], t.axes[second]};
  // Each axis of the circle has its own gains, which the lists of the controller file need not hold in the order of the axis files.
  sim::ControllerSpec loop = t.loop;
  auto& law = std::get<control::CascadeParams>(loop.law);
  const auto one = std::get<control::CascadeParams>(with_gains_of(t, 0).loop.law);
  const auto other = std::get<control::CascadeParams>(with_gains_of(t, second).loop.law);
  law.position_gain = {one.position_gain[0], other.position_gain[0]};
  law.velocity_gain = {one.velocity_gain[0], other.velocity_gain[0]};
  law.integral_time = {one.integral_time[0], other.integral_time[0]};
  const CircleAxes axes{t.machine ? *t.machine : machine_of(known, t.period), known, loop};
  UserCircle c{Circle(axes, t.radius, t.feed, 2.0),
               {},
               {},
               t.machine ? t.machine->name : "the identified axes",
               {0, second}};
  c.without = c.circle.without();
  c.model = c.circle.with_model();
  return c;
}

std::string circle_words(const PulseTask& t, const UserCircle& c, const char* what, const CircleError& with) {
  return fmt::format(
             "Circle of {} mm at {} mm/s on {}, loop {}, period {} ms; contour error in µm at the quadrants, largest, circular deviation (largest less smallest); then the share of the first:\n",
             report::significant(1e3 * t.radius, 4), report::significant(1e3 * t.feed, 4), c.where, t.loop.id,
             report::significant(1e3 * t.period, 3)) +
         line_of("no friction compensation", c.without, c.without) + line_of(what, with, c.without) +
         line_of("whole model to the force", c.model, c.without) + harm_in_words(c.without, with);
}

nlohmann::ordered_json circle_json(const PulseTask& t, const UserCircle& c, const CircleError& with) {
  return {{"radius_mm", 1e3 * t.radius}, {"feed_mm_per_s", 1e3 * t.feed}, {"on", c.where},
          {"controller", t.loop.id},     {"period_ms", 1e3 * t.period},   {"without", json_of(c.without)},
          {"pulse", json_of(with)},      {"model", json_of(c.model)}};
}

double PulseTask::integral_time() const {
  return std::get<control::CascadeParams>(loop.law).integral_time[0];
}

double number_after(const std::string& left, const std::string& text, const char* what) {
  const auto found = text.find(left);
  const char* const begin = text.data() + (found == std::string::npos ? text.size() : found + left.size());
  double value = 0.0;
  const auto read = std::from_chars(begin, text.data() + text.size(), value);
  if (found == std::string::npos || read.ec != std::errc())
    throw io::InputError({what, 0, left, "is missing, or not followed by a number"});
  return value;
}

std::vector<PulsePoint> points_of(const PulseSearch& found) {
  std::vector<PulsePoint> points;
  for (const PulseRow& r : found.rows) {
    const double gained = std::max(r.without.quadrant - r.best.quadrant, 0.0);
    points.push_back({r.acceleration, r.amplitude, gained / r.amplitude});
  }
  return points;
}

double constant_amplitude(const std::vector<PulsePoint>& points) {
  double weighted = 0.0;
  double weights = 0.0;
  for (const PulsePoint& p : points) {
    weighted += p.weight * p.weight * p.amplitude;
    weights += p.weight * p.weight;
  }
  return weights > 0.0 ? weighted / weights : 0.0;
}

void judge_on_grid(const PulseTask& t, std::size_t axis, const PulseSearch& found,
                   const std::function<double(double)>& amplitude, WrittenPulse& w) {
  const std::vector<CircleError> tried = try_pulse(t.axes[axis], t.loop, t.period, found.rows, w.pulse);
  nlohmann::ordered_json grid = nlohmann::ordered_json::array();
  double squares = 0.0;
  double worst = 0.0;
  double worst_best = 0.0;
  for (std::size_t k = 0; k < tried.size(); ++k) {
    const PulseRow& r = found.rows[k];
    const double written = amplitude(r.acceleration);
    squares += (written - r.amplitude) * (written - r.amplitude);
    worst = std::max(worst, share_of(tried[k].quadrant, r.without.quadrant));
    worst_best = std::max(worst_best, share_of(r.best.quadrant, r.without.quadrant));
    grid.push_back({{"radius_mm", 1e3 * r.radius},
                    {"feed_mm_per_s", 1e3 * r.feed},
                    {"acceleration_mm_per_s2", 1e3 * r.acceleration},
                    {"best_mm_per_min", r.amplitude / kMmPerMinute},
                    {"written_mm_per_min", written / kMmPerMinute},
                    {"quadrant_without_um", 1e6 * r.without.quadrant},
                    {"quadrant_best_um", 1e6 * r.best.quadrant},
                    {"quadrant_written_um", 1e6 * tried[k].quadrant}});
  }
  const double residual = std::sqrt(squares / static_cast<double>(tried.size())) / kMmPerMinute;
  w.words += fmt::format(
      "; from the best amplitudes on {} circles {} mm/min RMS; peak at the quadrants there at most {:.0f} % "
      "of that without{}, with the best amplitude of each {:.0f} %; not in it: terms periodic in position, different amplitudes for the two directions",
      tried.size(), report::significant(residual, 3), 100.0 * worst,
      worst > 1.0 ? " (larger than without: it does not serve all of these feeds)" : "", 100.0 * worst_best);
  if (found.left_out > 0)
    w.words += fmt::format("; {} of {} circles were left out: {}", found.left_out,
                           found.left_out + found.rows.size(), found.why);
  w.json["residual_mm_per_min"] = residual;
  w.json["grid"] = grid;
}

SearchProgress PulseTask::search_progress(std::string_view target, std::size_t axis) const {
  if (!progress) return {};
  return [tell = progress, what = fmt::format("{} {}: circles", target, names[axis])](
             std::size_t done, std::size_t all) { tell(what, done, all); };
}

PulseTask with_gains_of(PulseTask t, std::size_t axis) {
  auto& law = std::get<control::CascadeParams>(t.loop.law);
  const std::size_t number = t.numbers[axis];
  const auto rank = static_cast<std::size_t>(
      std::count_if(t.numbers.begin(), t.numbers.end(), [&](std::size_t other) { return other < number; }));
  for (control::PerAxis* list : {&law.position_gain, &law.velocity_gain, &law.integral_time}) {
    const std::size_t at = list->size() > t.numbers.size() ? number : rank;
    *list = {control::spread<control::kMostAxes>(*list)[std::min(at, control::kMostAxes - 1)]};
  }
  return t;
}

Exported write_pulse(const PulseTarget& target, const ExportRequest& o) {
  const PulseTask t = pulse_task(target.name, target.axis_name, o);
  io::check_writable(o.output);
  const auto remark = [&](const std::string& words) {
    constexpr std::size_t kLongest = 200;
    return fmt::format("{} {}\n", target.comment, io::one_line(words, kLongest));
  };
  std::string text = remark("Written by: " + o.command);
  std::string words;
  Exported out;
  out.json = {{"schema", "stribeck.export/1"},
              {"to", target.name},
              {"file", o.output},
              {"axes", nlohmann::ordered_json::array()}};
  std::vector<WrittenPulse> written;
  for (std::size_t i = 0; i < t.axes.size(); ++i) {
    const PulseTask of_axis = with_gains_of(t, i);
    written.push_back(target.write(of_axis, i));
    const LoopGains gains = loop_gains(of_axis, i);
    const std::string loop = gain_words(gains, target.kv);
    text += remark(fmt::format("{} from {}", t.names[i], o.files[i])) +
            remark(fmt::format("{} {}", t.names[i], loop)) + written.back().text;
    words += fmt::format("{} from {}: {}; {}.\n", t.names[i], o.files[i], written.back().words, loop);
    nlohmann::ordered_json axis{{"name", t.names[i]},
                                {"file", o.files[i]},
                                {"position_gain_per_s", gains.kv},
                                {"velocity_gain_N_s_per_mm", 1e-3 * gains.kp},
                                {"integral_time_ms", 1e3 * gains.tn}};
    axis.update(written.back().json);
    out.json["axes"].push_back(axis);
  }
  UserCircle c = user_circle(t);
  const CircleError with = c.circle.with(std::array{written[c.axes[0]].pulse, written[c.axes[1]].pulse});
  text += target.end;
  io::write_atomically(o.output, text);
  out.json["circle"] = circle_json(t, c, with);
  if (o.names.empty())
    words +=
        "The axes have the numbers that x, y, z, a, b, c have in this order, by their names in the files (where these do not "
        "tell them apart, by the order of the files); --name says other ones.\n";
  if (with.largest >= c.without.largest)
    words +=
        "This pulse makes the circle below no better: do not type it in. Give the loop of the machine with --controller, and radius and "
        "feed of your circles with --size and --speed.\n";
  out.text = words + circle_words(t, c, "this pulse", with) + std::string(target.to_do) +
             fmt::format("\nWritten to {}.\n", o.output);
  return out;
}

}  // namespace stribeck::targets
