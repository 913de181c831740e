#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <algorithm>
#include <array>
#include <memory>
#include <optional>

#include <python/parts.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/log/log.hpp>
#include <stribeck/io/units.hpp>
#include <stribeck/workflow/log/columns.hpp>
#include <stribeck/workflow/log/converted.hpp>

namespace stribeck::python {
namespace {

using workflow::LogQuantity;

/// Units in which the values of a log are handed over; a column of another kind keeps its own.
constexpr std::array<std::string_view, 14> kHandedOver{"s", "m",   "m/s", "m/s2", "rad", "rad/s", "rad/s2",
                                                       "N", "N m", "A",   "V",    "W",   "Hz",    "K"};

struct InSi {
  std::string unit;
  io::Conversion conversion;
};

InSi in_si_of(const io::Column& column) {
  for (const std::string_view si : kHandedOver) {
    if (const auto c = workflow::conversion_between(column.unit_text, si)) return {std::string(si), *c};
  }
  return {column.unit_text, {}};
}

py::object values_in_si(const io::Column& column) {
  if (!column.texts.empty()) return list_of(column.texts);
  return array_of(workflow::converted(column, in_si_of(column).conversion, 1.0));
}

/// The SI unit of a quantity of identify ("x", "force", …), of an excitation or of a circle; "" for another name.
std::string unit_of_name(const std::string& name) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 8> kFurther{{{"y", "m"},
                                                                                   {"rx", "m"},
                                                                                   {"ry", "m"},
                                                                                   {"radius", "m"},
                                                                                   {"deviation", "m"},
                                                                                   {"angle", "rad"},
                                                                                   {"f", "N"},
                                                                                   {"u", "V"}}};
  for (const auto& [known, unit] : kFurther) {
    if (name == known) return std::string(unit);
  }
  const auto what = enum_value<LogQuantity>(name);
  if (!what) return "";
  return *what == LogQuantity::kPercent ? "%" : std::string(workflow::known_column(*what).quantity.unit);
}

/// "x [mm]" → name and unit.
io::Column named(const std::string& header) {
  io::Column column;
  column.header = header;
  const std::size_t begin = header.rfind('[');
  if (begin == std::string::npos || header.back() != ']') {
    column.name = header;
    column.unit_text = unit_of_name(header);
    return column;
  }
  column.name = header.substr(0, header.find_last_not_of(' ', begin == 0 ? 0 : begin - 1) + 1);
  column.unit_text = header.substr(begin + 1, header.size() - begin - 2);
  if (!io::is_unit(column.unit_text))
    refuse(header,
           fmt::format("got the unit {}, expected one like mm, s or N", io::in_quotes(column.unit_text)));
  return column;
}

io::Log log_of_arrays(const py::dict& columns, const std::string& name) {
  io::Log log;
  log.source = name;
  log.format = "arrays";
  for (const auto& [key, values] : columns) {
    if (!py::isinstance<py::str>(key)) throw py::type_error("Log: expected the names of columns as str");
    io::Column column = named(py::cast<std::string>(key));
    if (column.name.empty()) refuse("Log", "got a column without a name, expected one like x or \"x [mm]\"");
    column.values = column_of(values, column.name);
    if (!log.columns.empty() && column.values.size() != log.rows) {
      refuse(column.name, fmt::format("got {} values, expected {}, as many as {} has", column.values.size(),
                                      log.rows, io::in_quotes(log.columns.front().name)));
    }
    log.rows = column.values.size();
    log.columns.push_back(std::move(column));
  }
  if (log.rows < 2) refuse("Log", fmt::format("got {} rows, expected at least two", log.rows));
  return log;
}

const io::Column& column_at(const io::Log& log, const std::string& name) {
  if (const io::Column* column = log.find(name)) return *column;
  throw py::key_error(name);
}

py::list names_of(const io::Log& log) {
  py::list out;
  for (const io::Column& c : log.columns) out.append(str_of(c.name));
  return out;
}

io::Log read(const py::object& path, const py::kwargs& given) {
  Keywords keywords("read_log", given);
  workflow::LogOptions options;
  options.sample_time = keywords.quantity("sample_time", "s");
  options.maps = keywords.texts("map");
  keywords.done();
  const std::string file = path_of(path);
  return unlocked([&] { return workflow::read_log(file, options); });
}

void add_log_members(py::class_<io::Log, std::shared_ptr<io::Log>>& log) {
  log.def(
      py::init([](const py::dict& columns, const std::string& name) { return log_of_arrays(columns, name); }),
      py::arg("columns"), py::arg("name") = "arrays",
      "Log(columns, name='arrays')\n--\n\n"
      "A log of arrays.\n\n"
      "columns: dict of one-dimensional arrays of equal length. t [s], x, y, r, rx, ry, radius, deviation [m], v [m/s], force, f [N], torque [N m], "
      "current [A], voltage, u [V], angle [rad] and percent are in these units; any other unit stands in the name: {\"x [mm]\": x}.\n"
      "name: what messages call it.\n"
      "Raises InputError for NaN, unequal lengths, unknown units.");
  log.def(
      "__getitem__",
      [](const io::Log& self, const py::object& name) {
        if (!py::isinstance<py::str>(name))
          throw py::type_error(fmt::format("log[...]: got {}, expected the name of a column, one of keys()",
                                           std::string(py::str(py::type::of(name).attr("__name__")))));
        return values_in_si(column_at(self, py::cast<std::string>(name)));
      },
      py::arg("name"), "The values of a column, in SI (unit(name)); a list of str for a column of text.");
  log.def("__contains__",
          [](const io::Log& self, const std::string& name) { return self.find(name) != nullptr; });
  log.def("__len__", [](const io::Log& self) { return self.columns.size(); });
  log.def("__iter__", [](const io::Log& self) { return py::iter(names_of(self)); });
  log.def("keys", &names_of, "keys($self)\n--\n\nThe names of the columns.");
  log.def(
      "unit",
      [](const io::Log& self, const std::string& name) {
        return str_of(in_si_of(column_at(self, name)).unit);
      },
      py::arg("name"),
      "unit($self, name)\n--\n\nThe unit of log[name]: SI where the file names a unit of motion, force or electricity, else that of "
      "the file; \"\" where it names none.");
  log.def_property_readonly(
      "units",
      [](const io::Log& self) {
        py::dict out;
        for (const io::Column& c : self.columns) out[str_of(c.name)] = str_of(in_si_of(c).unit);
        return out;
      },
      "dict: unit of each column, as unit() gives it.");
  log.def_property_readonly(
      "notes",
      [](const io::Log& self) {
        py::list out;
        for (const io::Note& note : self.notes) out.append(str_of(note.text));
        return out;
      },
      "list of str: what was found, repaired or left out when the file was read.");
  log.def_property_readonly(
      "metadata",
      [](const io::Log& self) {
        py::dict out;
        for (const auto& [key, value] : self.metadata) out[str_of(key)] = str_of(value);
        return out;
      },
      "dict: what the head of the file says.");
  log.def_property_readonly(
      "rows", [](const io::Log& self) { return self.rows; }, "int: rows of the longest column.");
  log.def_property_readonly(
      "source", [](const io::Log& self) { return str_of(self.source); }, "str: name of the file.");
  log.def_property_readonly(
      "format", [](const io::Log& self) { return str_of(self.format); }, "str: its format.");
  log.def(
      "save",
      [](const io::Log& self, const py::object& path) {
        const std::string file = path_of(path);
        unlocked([&] { io::write_csv(file, self); });
      },
      py::arg("path"),
      "save($self, path)\n--\n\nWrites a CSV file with units in its header, which read_log() reads back bit for bit.");
  log.def("__repr__", [](const io::Log& self) {
    return str_of(fmt::format("<stribeck.Log {}, {}, {} rows: {}>", self.source, self.format, self.rows,
                              workflow::column_names(self)));
  });
}

}  // namespace

workflow::LogOptions log_options(Keywords& keywords) {
  workflow::LogOptions o;
  o.axis = keywords.text("axis");
  o.maps = keywords.texts("map");
  o.gain = keywords.text("gain");
  o.lead = keywords.quantity("lead", "m");
  o.where = keywords.texts("where");
  o.runs = keywords.texts("runs");
  o.sample_time = keywords.quantity("sample_time", "s");
  o.keep = keywords.texts("keep");
  return workflow::with_map_file(std::move(o), keywords.path("map_file"));
}

LogReader reading_with(const workflow::LogOptions& options) {
  return [options](const std::string& path) { return workflow::read_log(path, options); };
}

std::vector<io::Log> logs_of(const py::handle& logs, const LogReader& reader) {
  if (py::isinstance<py::list>(logs))
    return logs_of(py::tuple(py::reinterpret_borrow<py::list>(logs)), reader);
  if (!py::isinstance<py::tuple>(logs)) return logs_of(py::make_tuple(logs), reader);
  const auto all = py::reinterpret_borrow<py::tuple>(logs);
  if (all.empty()) refuse("log", "missing, expected a file, a stribeck.Log or a dict of arrays");
  std::vector<io::Log> out;
  for (const py::handle& log : all) {
    if (py::isinstance<io::Log>(log)) {
      out.push_back(py::cast<const io::Log&>(log));
    } else if (py::isinstance<py::dict>(log)) {
      out.push_back(log_of_arrays(py::reinterpret_borrow<py::dict>(log),
                                  all.size() == 1 ? "arrays" : fmt::format("arrays {}", out.size() + 1)));
    } else if (is_path(log)) {
      const std::string path = path_of(log);
      out.push_back(unlocked([&] { return reader(path); }));
    } else {
      throw py::type_error("expected logs as names of files, stribeck.Log or dict of arrays");
    }
  }
  return out;
}

void add_logs(py::module_& module) {
  py::class_<io::Log, std::shared_ptr<io::Log>> log(
      module, "Log",
      "Columns over time: a file that read_log() has read, or arrays. log[\"x\"] is an array in SI, log.units tells the units.");
  add_log_members(log);
  module.def("read_log", &read, py::arg("path"),
             "read_log(path, *, map=None, sample_time=None)\n--\n\n"
             "Reads a log of any format that identify reads (docs/log-formats.md), plain or gzip.\n\n"
             "map: {\"t\": \"COLUMN\"} names the column of the time where it is not found by its name.\n"
             "sample_time: time between rows of a log without times, \"1 ms\" or in s.\n"
             "Returns a Log: log[\"x\"] is an array of float64 in SI, log.units the units.\n"
             "Raises InputError with file, line and column of what cannot be read.");
}

}  // namespace stribeck::python
