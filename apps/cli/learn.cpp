#include <fmt/format.h>
#include <cmath>

#include <apps/cli/commands.hpp>
#include <apps/cli/learn.hpp>
#include <apps/cli/shared.hpp>
#include <stribeck/ident/least_squares_a.hpp>
#include <stribeck/ident/velocity_map.hpp>
#include <stribeck/report/trace_report.hpp>

namespace stribeck::cli {

ident::Excitation design(const sim::Machine& machine, std::size_t axis, const std::string& method,
                         int periods, const std::optional<ident::RoughDrive>& known) {
  const sim::MachineAxis& a = machine.axes[axis].second;
  const ident::Limits limits{a.limits.travel_min, a.limits.travel_max, a.limits.speed, a.limits.acceleration,
                             a.force_limit()};
  const sim::Commissioning& c = a.commissioning;
  if (method == "pulses") {
    ident::PulseDesign pulses;
    pulses.start = 0.5 * (limits.travel_min + limits.travel_max);
    return ident::design_pulses(limits, known.value_or(ident::RoughDrive{c.mass, c.friction, 0.0}),
                                machine.sample_time, pulses);
  }
  if (method == "jog") {
    ident::JogDesign jog;
    jog.start = 0.5 * (limits.travel_min + limits.travel_max);
    return ident::design_jog(limits, machine.sample_time, jog);
  }
  return ident::design_sine(limits, machine.sample_time,
                            {c.sine_offset + c.sine_amplitude, c.sine_amplitude, c.sine_frequency, periods});
}

sim::Recording play(const sim::Machine& machine, std::size_t axis, const std::vector<double>& reference,
                    const std::vector<double>& force, std::uint64_t seed) {
  if (!reference.empty()) return sim::record_closed_loop(machine, axis, reference, seed);
  const auto& limits = machine.axes[axis].second.limits;
  return sim::record_open_loop(machine, axis, force, 0.5 * (limits.travel_min + limits.travel_max), seed);
}

io::Log as_log(const sim::Recording& recording) {
  io::Log log;
  log.rows = recording.t.size();
  const auto add = [&](const char* name, const char* unit, const std::vector<double>& si, double scale) {
    if (si.empty()) return;
    io::Column column{name, unit, {}};
    column.values.reserve(si.size());
    for (const double v : si) column.values.push_back(v / scale);
    log.columns.push_back(std::move(column));
  };
  add("t", "s", recording.t, 1.0);
  add("r", "mm", recording.r, 1e-3);
  add("x", "mm", recording.x, 1e-3);
  add("u", "V", recording.u, 1.0);
  add("f", "N", recording.f, 1.0);
  return log;
}

ident::Record as_record(const sim::Recording& recording, const std::string& source) {
  ident::Record record;
  record.source = source;
  record.sample_time = recording.period;
  record.t = recording.t;
  record.r = recording.r;
  record.x = recording.x;
  record.f = recording.f;
  record.loop = recording.r.empty() ? ident::Loop::kOpen : ident::Loop::kClosed;
  return record;
}

void refuse_nonsense(const ident::Result& result, const std::string& source) {
  if (!std::isfinite(result.mass)) {
    throw ident::Refused(
        fmt::format("{}: no mass comes out of these data: force and motion do not belong together", source));
  }
  if (!(result.mass > 0.0)) {
    throw ident::Refused(
        fmt::format("{}: the mass comes out as {:.4g} N s2/mm, expected above 0: force and motion have "
                    "opposite signs, or "
                    "columns are exchanged (see --map and --gain)",
                    source, result.mass * 1e-3));
  }
  if (!(result.mass_interval.low > 0.0)) {
    throw ident::Refused(fmt::format(
        "{}: the mass is not determined, {:.4g} N s2/mm with a 95 % interval from {:.4g} to {:.4g}: the log "
        "has too little acceleration (add a log of pulses), or its columns are not what they are called",
        source, result.mass * 1e-3, result.mass_interval.low * 1e-3, result.mass_interval.high * 1e-3));
  }
  for (const ident::CurvePoint& p : result.curve) {
    if (!std::isfinite(p.friction))
      throw ident::Refused(fmt::format("{}: no friction comes out of these data", source));
  }
}

void report_log(const std::string& directory, const io::Log& log, const std::string& title,
                const std::string& summary) {
  if (directory.empty()) return;
  report::TraceReportInput input{
      title, summary, typed_command(), STRIBECK_VERSION, log.columns.front().values, {}};
  for (std::size_t i = 1; i < log.columns.size(); ++i) {
    const io::Column& c = log.columns[i];
    input.columns.push_back({c.name, c.unit_text, c.values});
  }
  report::write_trace_report(directory, input);
}

friction::AxisModel as_model(const ident::Result& result) {
  friction::AxisModel model;
  model.mass = result.mass;
  model.load = result.load;
  model.friction = result.friction;
  return model;
}

Learned learn_axis(const sim::Machine& machine, std::size_t axis, std::uint64_t seed) {
  const std::string& name = machine.axes[axis].first;
  Learned l;
  // A first run only tells how hard to push in the second, which then covers the speeds that the axis may
  // have.
  const ident::Excitation first = design(machine, axis, "pulses", 0);
  const ident::Record tried =
      as_record(play(machine, axis, first.r, first.force, seed), name + ", first pulses");
  const ident::Excitation pulses =
      design(machine, axis, "pulses", 0, ident::rough_drive(ident::identify_least_squares_a({tried}).result));
  const ident::Excitation sine = design(machine, axis, "sine", kSinePeriods);
  l.pulses = play(machine, axis, pulses.r, pulses.force, seed);
  l.sine = play(machine, axis, sine.r, sine.force, seed);
  const ident::Record pulse_record = as_record(l.pulses, name + "-pulses.csv");
  const ident::Record sine_record = as_record(l.sine, name + "-sine.csv");
  l.conventional = ident::identify_least_squares_a({pulse_record}).result;
  l.gaussian = ident::identify_velocity_map({pulse_record, sine_record});
  refuse_nonsense(l.conventional, pulse_record.source);
  refuse_nonsense(l.gaussian, sine_record.source);
  l.knowledge = {as_model(l.conventional), as_model(l.gaussian)};
  return l;
}

}  // namespace stribeck::cli
