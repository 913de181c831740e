// --to tnc: compensation of reversal spikes, MP711 and MP712.
#include <fmt/format.h>

#include <stribeck/core/scalar.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/targets/pulse/pulse_target.hpp>
#include <stribeck/targets/pulse/tnc.hpp>

namespace stribeck::targets {

namespace {

constexpr double kMillimetre = 1e-3;
constexpr double kQuadrant = 90.0;  // degrees

double parameter(const std::string& text, int number, const std::string& axis) {
  return kMillimetre * number_after(fmt::format("MP{}.{} : ", number, axis), text, "machine parameters");
}

Pulse spike_pulse(double speed, double time) {
  Pulse p;
  p.block = speed;
  p.block_time = time;
  return p;
}

WrittenPulse write_spikes(const PulseTask& t, std::size_t axis) {
  std::vector<PulseShape> shapes;
  for (const double time : kPulseTimes) {
    shapes.emplace_back([time = time * t.integral_time()](double speed) { return spike_pulse(speed, time); });
  }
  const PulseSearch found =
      search_pulses(t.axes[axis], t.loop, t.period, t.radius, t.feed, shapes, t.search_progress("tnc", axis));
  const double speed = constant_amplitude(points_of(found));
  const double time = kPulseTimes[found.shape] * t.integral_time();
  WrittenPulse w;
  w.text = machine_parameters({speed * time, speed * t.period}, t.names[axis]);
  const SpikeCompensation c = read_machine_parameters(w.text, t.names[axis]);
  w.pulse = spike_pulse(c.speed(t.period), c.time(t.period));
  const double width = spike_width(c, t.radius, t.feed, t.period) * 180.0 / kPi;
  w.words = fmt::format("{} mm/min over {} ms, as for a spike of {} µm and {}° on the circle below",
                        report::significant(c.speed(t.period) / kMmPerMinute, 3),
                        report::significant(1e3 * c.time(t.period), 3),
                        report::significant(1e6 * c.height, 3), report::significant(width, 3));
  if (width > kQuadrant)
    w.words += " (longer than a quadrant: give --speed and --size of a slower or larger circle)";
  w.json = {{"mp711_mm", c.height / kMillimetre},
            {"mp712_mm", c.increment / kMillimetre},
            {"time_s", c.time(t.period)},
            {"spike_width_deg", width}};
  judge_on_grid(
      t, axis, found, [&](double) { return c.speed(t.period); }, w);
  w.words += ", another pulse for another feed";
  return w;
}

std::string axis_number(std::size_t axis) { return fmt::format("{}", axis); }

}  // namespace

SpikeCompensation spike_compensation(double height, double width, double radius, double feed, double cycle) {
  const double spike_time = width * radius / feed;
  return {height, height * cycle / (0.5 * spike_time)};
}

double spike_width(const SpikeCompensation& c, double radius, double feed, double cycle) {
  return 2.0 * c.time(cycle) * feed / radius;
}

std::string machine_parameters(const SpikeCompensation& c, const std::string& axis) {
  return fmt::format("MP711.{0} : {1:.4f}\nMP712.{0} : {2:.6f}\n", axis, c.height / kMillimetre,
                     c.increment / kMillimetre);
}

SpikeCompensation read_machine_parameters(const std::string& text, const std::string& axis) {
  return {parameter(text, 711, axis), parameter(text, 712, axis)};
}

extern const PulseTarget kTnc;
const PulseTarget kTnc{
    "tnc",
    "compensation of reversal spikes of HEIDENHAIN TNC controls, MP711 and MP712",
    ";",
    "",
    "Machine parameters MP711.x and MP712.x, x the number of the axis, behind the code number of the machine maker; MP715 and MP716 are "
    "the same for M105. Check first that --period is the control loop cycle time of the control, that the backlash compensation (MP750) "
    "is off, and begin with half of both in a circular test with the grid encoder: too much cuts into the contour.",
    "MP1510 with velocity feed-forward, MP1810 without",
    axis_number,
    write_spikes};

}  // namespace stribeck::targets
