// --to sinumerik: a pulse that decays, with an amplitude over the acceleration at the quadrant.
#include <fmt/format.h>
#include <algorithm>

#include <stribeck/report/text.hpp>
#include <stribeck/targets/pulse/pulse_target.hpp>
#include <stribeck/targets/pulse/sinumerik.hpp>

namespace stribeck::targets {

namespace {

Pulse qec_pulse(const Qec& qec) {
  return {[qec](double a) { return qec.amplitude(a); }, qec.time_constant};
}

WrittenPulse write_qec(const PulseTask& t, std::size_t axis) {
  std::vector<PulseShape> shapes;
  for (const double time : kPulseTimes) {
    shapes.emplace_back([time = time * t.integral_time()](double amplitude) {
      return Pulse{[amplitude](double) { return amplitude; }, time};
    });
  }
  const PulseSearch found = search_pulses(t.axes[axis], t.loop, t.period, t.radius, t.feed, shapes,
                                          t.search_progress("sinumerik", axis));
  WrittenPulse w;
  w.text = archive_text(nearest_qec(points_of(found), kPulseTimes[found.shape] * t.integral_time()),
                        t.names[axis]);
  const Qec q = read_archive(w.text, t.names[axis]);
  w.pulse = qec_pulse(q);
  w.words = fmt::format("pulse of {} to {} mm/min, {} ms",
                        report::significant(std::min(q.largest, q.smallest) / kMmPerMinute, 3),
                        report::significant(std::max(q.largest, q.smallest) / kMmPerMinute, 3),
                        report::significant(1e3 * q.time_constant, 3));
  w.json = {{"const_max_mm_per_min", q.largest / kMmPerMinute},
            {"const_min_mm_per_min", q.smallest / kMmPerMinute},
            {"time_s", q.time_constant},
            {"accel_m_per_s2", {q.a1, q.a2, q.a3}}};
  judge_on_grid(
      t, axis, found, [&](double a) { return q.amplitude(a); }, w);
  return w;
}

std::string machine_axis(std::size_t axis) { return fmt::format("AX{}", axis + 1); }

}  // namespace

extern const PulseTarget kSinumerik;
const PulseTarget kSinumerik{
    "sinumerik",
    "quadrant error compensation of SINUMERIK, MD32490 to MD32570: a pulse on the set-point of speed",
    ";",
    "M17\n",
    "Read in as an archive of axis machine data, or typed under Setup, Machine data, Axis MD; with password, then NCK reset. Check first, "
    "on an archive of the machine, that its units are mm/min, s and m/s² and that the data have no further index, and begin with half of "
    "MD32520 and MD32530 in the circularity test. MD32580 (short blocks) is found by trial.",
    "MD32200",
    machine_axis,
    write_qec};

}  // namespace stribeck::targets
