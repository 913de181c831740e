// --to fanuc: two-stage backlash acceleration.
#include <fmt/format.h>
#include <array>
#include <cmath>

#include <stribeck/report/text.hpp>
#include <stribeck/targets/pulse/fanuc.hpp>
#include <stribeck/targets/pulse/pulse_target.hpp>

namespace stribeck::targets {

namespace {

constexpr double kDetectionUnit = 1e-6;  ///< [m]
constexpr std::array kCoefficients{0.0, 0.25, 0.5, 0.75, 1.0};
constexpr std::array kStarts{1e-6, 2e-6, 5e-6, 10e-6, 20e-6, 50e-6, 100e-6};
constexpr std::array kEnds{2.0, 3.0};

constexpr const char* kCoefficient = "stage 1 acceleration coefficient [%]";
constexpr const char* kAmount = "stage 2 acceleration amount [mm/min]";
constexpr const char* kStart = "stage 2 start/end [detection unit of 1 um]";

double servo_parameter(const std::string& text, const std::string& axis, const char* name) {
  return number_after(fmt::format("{} {} = ", axis, name), text, "servo parameters");
}

/// Both stages as a pulse on the set-point of speed: with the integral time of the loop, one that decays is a step of force.
Pulse pulse_of(const TwoStages& s, const PulseTask& t, std::size_t axis) {
  const friction::AxisModel& known = t.axes[axis];
  const auto& loop = std::get<control::CascadeParams>(t.loop.law);
  const double step = s.coefficient * jump_of_friction(known, t.feed) / (known.mass * loop.velocity_gain[0]);
  Pulse p;
  p.amplitude = [step](double) { return step; };
  p.time_constant = t.integral_time();
  p.block = s.amount;
  p.block_travel = {s.start, s.end * s.start};
  return p;
}

WrittenPulse write_stages(const PulseTask& t, std::size_t axis) {
  std::vector<TwoStages> all;
  for (const double coefficient : kCoefficients) {
    for (const double start : kStarts) {
      for (const double end : kEnds) all.push_back({coefficient, 0.0, start, end});
    }
  }
  std::vector<PulseShape> shapes;
  for (const TwoStages& s : all) {
    shapes.emplace_back([s, &t, axis](double amount) {
      TwoStages with = s;
      with.amount = amount;
      return pulse_of(with, t, axis);
    });
  }
  const PulseSearch found = search_pulses(t.axes[axis], t.loop, t.period, t.radius, t.feed, shapes,
                                          t.search_progress("fanuc", axis));
  TwoStages best = all[found.shape];
  best.amount = constant_amplitude(points_of(found));
  WrittenPulse w;
  w.text = servo_parameters(best, t.names[axis]);
  const TwoStages s = read_servo_parameters(w.text, t.names[axis]);
  w.pulse = pulse_of(s, t, axis);
  w.words = fmt::format("{:.0f} % of the friction at the reversal, {} mm/min from {} to {} µm after it",
                        100.0 * s.coefficient, report::significant(s.amount / kMmPerMinute, 3),
                        report::significant(1e6 * s.start, 3), report::significant(1e6 * s.start * s.end, 3));
  w.json = {{"stage1_percent", 100.0 * s.coefficient},
            {"stage2_mm_per_min", s.amount / kMmPerMinute},
            {"stage2_from_um", 1e6 * s.start},
            {"stage2_to_um", 1e6 * s.start * s.end}};
  judge_on_grid(
      t, axis, found, [&](double) { return s.amount; }, w);
  return w;
}

std::string axis_letter(std::size_t axis) { return std::string(1, "XYZABCUVW"[axis % 9]); }

}  // namespace

std::string servo_parameters(const TwoStages& s, const std::string& axis) {
  const double start = std::round(s.start / kDetectionUnit);
  return fmt::format("{0} {1} = {2:.0f}\n{0} {3} = {4:.2f}\n{0} {5} = {6:.0f}\n", axis, kCoefficient,
                     100.0 * s.coefficient, kAmount, s.amount / kMmPerMinute, kStart,
                     s.end > 2.5 ? -start : start);
}

TwoStages read_servo_parameters(const std::string& text, const std::string& axis) {
  const double start = servo_parameter(text, axis, kStart);
  return {servo_parameter(text, axis, kCoefficient) / 100.0,
          servo_parameter(text, axis, kAmount) * kMmPerMinute, std::abs(start) * kDetectionUnit,
          start < 0.0 ? 3.0 : 2.0};
}

extern const PulseTarget kFanuc;
const PulseTarget kFanuc{
    "fanuc",
    "two-stage backlash acceleration of Fanuc servo axes",
    "#",
    "",
    "Servo parameters of the axis; their numbers differ between the series, see two-stage backlash acceleration in the parameter manual "
    "of the motor. Check first the detection unit (with 0.1 µm the start is ten times the number), in which unit the control counts the "
    "stage 2 amount, and begin on the circle with stage 1 alone: too much cuts into the contour.",
    "",
    axis_letter,
    write_stages};

}  // namespace stribeck::targets
