#include <fmt/format.h>
#include <cmath>
#include <string_view>

#include <stribeck/io/error.hpp>
#include <stribeck/io/log/log.hpp>
#include <stribeck/io/units.hpp>
#include <stribeck/workflow/log/converted.hpp>
#include <stribeck/workflow/reference_file.hpp>

namespace stribeck::workflow {

ReferenceFile reference_of(const io::Log& table, const sim::Machine& machine, std::size_t axis) {
  const std::string& file = table.source;
  const auto column = [&](std::string_view name, const Quantity& q) {
    const io::Column* c = table.find(name);
    if (c == nullptr) return std::vector<double>{};
    // Of a rotary axis excite writes degrees and N m.
    const std::optional<Quantity> rotary = io::rotary_quantity(q, "");
    const bool turns = rotary && io::is_unit(c->unit_text) && conversion_between(c->unit_text, rotary->unit);
    return io::in_si(*c, turns ? *rotary : q);
  };
  for (const auto& [key, value] : table.metadata) {
    const std::string& name = machine.axes[axis].first;
    if (key == "axis" && value != name) {
      throw io::InputError({file, 0, "axis",
                            fmt::format("the file is for axis {}, but --axis says {} (excite that axis, or "
                                        "choose --axis {})",
                                        io::in_quotes(value), io::in_quotes(name), value)});
    }
  }
  const std::vector<double> t = io::in_si(table.at("t"), quantity("s", "s"));
  const io::TimeCheck time = io::check_time(t, file);
  const double period = machine.sample_time;
  if (!time.regular() || std::abs(time.sample_time - period) > 1e-6 * period) {
    throw io::InputError(
        {file, 0, "t",
         fmt::format("steps of {:.6g} ms, expected the control period of the machine, {:.6g} ms, throughout",
                     time.sample_time * 1e3, period * 1e3)});
  }
  ReferenceFile out;
  std::vector<double>& r = out.r;
  r = column("r", quantity("m", "mm"));
  std::vector<double>& f = out.force;
  f = column("f", quantity("N", "N"));
  if (f.empty()) {
    f = column("u", quantity("V", "V"));
    for (double& v : f) v *= machine.axes[axis].second.plant.force_gain();
  }
  if (r.empty() && f.empty()) {
    throw io::InputError(
        {file,
         0,
         {},
         "neither r (closed loop) nor f or u (open loop) among the columns (write one with excite)"});
  }
  const auto& limits = machine.axes[axis].second.limits;
  for (std::size_t k = 0; k < r.size(); ++k) {
    if (r[k] < limits.travel_min || r[k] > limits.travel_max) {
      throw io::InputError({file, 0, "r",
                            fmt::format("row {}: {:.6g} mm is outside the travel, {:.6g} to {:.6g} mm", k + 1,
                                        r[k] * 1e3, limits.travel_min * 1e3, limits.travel_max * 1e3)});
    }
  }
  if (!r.empty()) f.clear();  // in closed loop the controller makes the force
  return out;
}

std::optional<EndStop> cut_at_end_stop(sim::Recording& recording, const sim::AxisLimits& limits) {
  for (std::size_t k = 0; k < recording.x.size(); ++k) {
    const double x = recording.x[k];
    if (x >= limits.travel_min && x <= limits.travel_max) continue;
    const double before = recording.x[k > 0 ? k - 1 : 0];
    const EndStop stop{recording.t[k], x < limits.travel_min ? limits.travel_min : limits.travel_max,
                       std::abs(x - before) / recording.period};
    recording.cut(k + 1);
    return stop;
  }
  return std::nullopt;
}

}  // namespace stribeck::workflow
