#include <cmath>
#include <utility>

#include <stribeck/workflow/traces.hpp>

namespace stribeck::workflow {

io::Log as_log(const std::vector<std::string>& axes, const std::vector<sim::ContourSample>& trace) {
  io::Log log;
  log.rows = trace.size();
  const auto add = [&](const std::string& name, const char* unit, double scale, auto&& get) {
    io::Column column{name, unit, {}};
    column.values.reserve(trace.size());
    for (const sim::ContourSample& s : trace) column.values.push_back(get(s) / scale);
    log.columns.push_back(std::move(column));
  };
  using S = sim::ContourSample;
  add("t", "s", 1.0, [](const S& s) { return s.time; });
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const std::string& axis = axes[i];
    add("r_" + axis, "mm", 1e-3, [i](const S& s) { return s.reference[i]; });
    add("x_" + axis, "mm", 1e-3, [i](const S& s) { return s.encoder[i]; });
    if (!trace.empty() && std::isfinite(trace.front().motor[i]))
      add("motor_" + axis, "mm", 1e-3, [i](const S& s) { return s.motor[i]; });
    if (!trace.empty() && std::isfinite(trace.front().scale[i]))
      add("scale_" + axis, "mm", 1e-3, [i](const S& s) { return s.scale[i]; });
    add("table_" + axis, "mm", 1e-3, [i](const S& s) { return s.position[i]; });
    add("u_" + axis, "V", 1.0, [i](const S& s) { return s.voltage[i]; });
    add("f_" + axis, "N", 1.0, [i](const S& s) { return s.force[i]; });
    add("friction_" + axis, "N", 1.0, [i](const S& s) { return s.friction[i]; });
  }
  add("contour_error", "um", 1e-6, [](const S& s) { return s.contour_error; });
  return log;
}

io::Log errors_first(const io::Log& log, const std::vector<std::string>& axes) {
  io::Log shown = log;
  const io::Column contour = std::move(shown.columns.back());
  shown.columns.pop_back();
  std::vector<io::Column> errors{contour};
  for (const std::string& axis : axes) {
    io::Column e{"e_" + axis, "um", {}};
    const io::Column& r = log.at("r_" + axis);
    const io::Column& table = log.at("table_" + axis);
    for (std::size_t k = 0; k < log.rows; ++k) e.values.push_back(1e3 * (table.values[k] - r.values[k]));
    errors.push_back(std::move(e));
  }
  // The error of a single axis is its tracking error.
  if (axes.size() == 1) errors.erase(errors.begin());
  shown.columns.insert(shown.columns.begin() + 1, errors.begin(), errors.end());
  return shown;
}

}  // namespace stribeck::workflow
