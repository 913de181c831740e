#include <fmt/format.h>

#include <stribeck/io/log/log.hpp>
#include <stribeck/workflow/commissioning/records.hpp>

namespace stribeck::workflow::commissioning {
namespace {

io::Column column_of_log(const char* name, const char* unit, const std::vector<double>& si, double scale) {
  io::Column c{name, unit, {}};
  c.values.reserve(si.size());
  for (const double v : si) c.values.push_back(scale * v);
  return c;
}

}  // namespace

std::vector<AxisRows> read_record(const RunningAxes& all, const std::string& file) {
  io::ReadOptions options;
  for (std::size_t i = 0; i < all.columns.size(); ++i) options.names.push_back(fmt::format("pin{}", i));
  options.sample_time = all.period;
  const io::Log log = io::read_log(file, options);
  const auto values = [&](const std::string& signal, double scale) {
    std::vector<double> out = log.at(fmt::format("pin{}", all.column(signal))).values;
    for (double& v : out) v *= scale;
    return out;
  };
  std::vector<AxisRows> out;
  for (const RunningAxis& a : all.axes)
    out.push_back({values(a.command_signal, all.unit), values(a.encoder_signal, all.unit),
                   values(a.force_signal, a.force_unit)});
  return out;
}

void write_axis_log(const RunningAxes& all, const AxisRows& rows, const std::string& file) {
  io::Log log;
  log.rows = rows.r.size();
  std::vector<double> t;
  t.reserve(log.rows);
  for (std::size_t k = 0; k < log.rows; ++k) t.push_back(all.period * static_cast<double>(k));
  log.columns = {column_of_log("t", "s", t, 1.0), column_of_log("r", "mm", rows.r, 1e3),
                 column_of_log("x", "mm", rows.x, 1e3), column_of_log("f", "N", rows.f, 1.0)};
  io::write_csv(file, log);
}

void write_circle_log(const std::vector<std::pair<AxisRows, AxisRows>>& circles, const std::string& file) {
  AxisRows u;
  AxisRows v;
  std::vector<double> number;
  const auto append = [](std::vector<double>& to, const std::vector<double>& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  for (std::size_t i = 0; i < circles.size(); ++i) {
    const auto& [a, b] = circles[i];
    append(u.r, a.r);
    append(u.x, a.x);
    append(v.r, b.r);
    append(v.x, b.x);
    number.resize(u.r.size(), static_cast<double>(i + 1));
  }
  io::Log log;
  log.rows = number.size();
  log.columns = {column_of_log("x", "mm", u.x, 1e3), column_of_log("y", "mm", v.x, 1e3),
                 column_of_log("rx", "mm", u.r, 1e3), column_of_log("ry", "mm", v.r, 1e3),
                 column_of_log("circle", "1", number, 1.0)};
  io::write_csv(file, log);
}

}  // namespace stribeck::workflow::commissioning
