#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <memory>
#include <nlohmann/json.hpp>

#include <python/parts.hpp>
#include <stribeck/ident/bristle/told_break_away.hpp>
#include <stribeck/ident/log/record.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/json.hpp>
#include <stribeck/report/pages/identify_report.hpp>
#include <stribeck/workflow/identify.hpp>
#include <stribeck/workflow/identify_text.hpp>

namespace stribeck::python {
namespace {

/// An identification with the records that it was made from.
struct Found {
  workflow::AxisRecords axis;
  workflow::Identification found;
};

workflow::IdentifyOptions identify_options(Keywords& keywords) {
  constexpr int kMostTerms = 6;
  workflow::IdentifyOptions o;
  o.method = keywords.choice("method", o.method);
  o.model = keywords.choice("model", o.model);
  if (keywords.word("solver", {"derivatives", "simplex"}) == "simplex")
    o.solver = ident::methods::Solver::kSimplex;
  if (const auto terms = keywords.whole("terms", 0, kMostTerms)) o.terms = static_cast<int>(*terms);
  o.mass = keywords.quantity("mass", "kg");
  o.force_shift = keywords.quantity("force_shift", "s");
  o.cut_off = keywords.quantity("cut_off", "Hz");
  o.turn = keywords.quantity("turn", "m");
  return o;
}

Found identify(const py::args& logs, const py::kwargs& given) {
  Keywords keywords("identify", given);
  const workflow::LogOptions reading = log_options(keywords);
  const workflow::IdentifyOptions options = identify_options(keywords);
  keywords.done();
  workflow::check_options(options);
  const std::vector<io::Log> read = logs_of(logs, reading_with(reading));
  return unlocked([&] {
    auto [axis, found] = workflow::identify_logs(read, reading, options);
    return Found{std::move(axis), std::move(found)};
  });
}

py::tuple pair(double low, double high) { return py::make_tuple(low, high); }

py::dict parameters_of(const ident::Result& result) {
  py::dict out;
  for (const ident::Parameter& p : result.parameters) {
    py::dict one;
    one["value"] = p.value;
    one["unit"] = str_of(p.unit);
    one["ci95"] = pair(p.ci_low, p.ci_high);
    one["identifiable"] = p.identifiable;
    out[str_of(p.name)] = one;
  }
  return out;
}

py::dict curve_of(const ident::Result& result) {
  using P = ident::CurvePoint;
  py::dict out;
  out["velocity"] = array_of(result.curve, &P::velocity);
  out["friction"] = array_of(result.curve, &P::friction);
  out["ci_low"] = array_of(result.curve, &P::ci_low);
  out["ci_high"] = array_of(result.curve, &P::ci_high);
  return out;
}

py::dict map_of(const ident::Result& result) {
  using P = ident::MapPoint;
  py::dict out;
  out["velocity"] = array_of(result.map, &P::velocity);
  out["friction"] = array_of(result.map, &P::friction);
  out["direction"] = array_of(result.map, &P::direction);
  return out;
}

py::dict residuals_of(const ident::Result& result) {
  using P = ident::ResidualPoint;
  py::dict out;
  out["t"] = array_of(result.residuals, &P::t);
  out["x"] = array_of(result.residuals, &P::x);
  out["v"] = array_of(result.residuals, &P::v);
  out["error"] = array_of(result.residuals, &P::error);
  out["record"] = array_of(result.residuals, &P::record);
  return out;
}

py::list records_of(const workflow::AxisRecords& axis) {
  py::list out;
  for (const ident::log::Record& r : axis.records) {
    py::dict one;
    one["t"] = array_of(r.t);
    one["x"] = array_of(r.x);
    one["force"] = array_of(r.f);
    if (!r.r.empty()) one["r"] = array_of(r.r);
    if (!r.v.empty()) one["v"] = array_of(r.v);
    one["sample_time"] = r.sample_time;
    one["source"] = str_of(r.source);
    one["force_unit"] = str_of(r.force_unit);
    one["position_unit"] = str_of(r.position_unit);
    out.append(one);
  }
  return out;
}

using FoundClass = py::class_<Found, std::shared_ptr<Found>>;

/// property(NAME, GET, DOC): something of the result, read only.
template <class Get>
void property(FoundClass& c, const char* name, Get get, const char* doc) {
  c.def_property_readonly(
      name, [get](const Found& f) { return get(f.found.result); }, doc);
}

void add_numbers(FoundClass& c) {
  using R = ident::Result;
  property(
      c, "mass", [](const R& r) { return r.mass; },
      "float: equivalent mass [kg], of an axis that turns its inertia [kg m2], reflected inertia included; NaN: not determined.");
  property(
      c, "mass_ci95", [](const R& r) { return pair(r.mass_interval.low, r.mass_interval.high); },
      "(low, high): its 95 % interval [kg].");
  property(
      c, "load", [](const R& r) { return r.load; },
      "float: constant force against +x, e.g. a weight [N], of an axis that turns a torque [N m].");
  property(
      c, "delay", [](const R& r) { return r.delay; },
      "float: from the command of a force to the beginning of its hold [s]; 0: none was found.");
  property(
      c, "velocity_range", [](const R& r) { return pair(r.velocity_range[0], r.velocity_range[1]); },
      "(lowest, highest): velocities of the data [m/s].");
  property(
      c, "break_away_distance", [](const R& r) { return ident::told_break_away(r); },
      "float: travel until the axis slides [m]; NaN: not determined.");
  property(
      c, "held_out_rms", [](const R& r) { return r.held_out_rms; },
      "float: error on motion that was not fitted, RMS [N].");
  property(
      c, "r_squared", [](const R& r) { return r.r_squared; }, "float: share of the force that is explained.");
  property(
      c, "rows", [](const R& r) { return r.rows; }, "int: rows that were fitted.");
  property(
      c, "method", [](const R& r) { return str_of(ident::name_of(r.method)); },
      "str: the method that was used.");
  property(
      c, "model", [](const R& r) { return str_of(r.model); }, "str: the friction law in words.");
  property(
      c, "force_unit", [](const R& r) { return str_of(r.force_unit); },
      "str: \"N\"; \"A\", \"V\", \"%\" or \"N m\" for a log without a gain: it then stands for N everywhere.");
  property(
      c, "position_unit", [](const R& r) { return str_of(r.position_unit); },
      "str: \"m\"; \"rad\" for an axis without a lead: it then stands for m everywhere.");
}

void add_arrays(FoundClass& c) {
  property(c, "parameters", &parameters_of,
           "dict: name → {\"value\", \"unit\" (SI), \"ci95\" (low, high), \"identifiable\"}.");
  property(
      c, "curve", &curve_of,
      "dict of arrays of equal length, ascending velocity: velocity [m/s], friction, ci_low, ci_high (95 %) [N].");
  property(
      c, "map", &map_of,
      "dict of arrays: measured velocity [m/s], friction [N] and direction (+1, -1), thinned for plots.");
  property(
      c, "residuals", &residuals_of,
      "dict of arrays: t [s], x [m], v [m/s], error (measured less modelled force) [N], record (index), thinned for plots.");
  property(
      c, "warnings", [](const ident::Result& r) { return list_of(r.warnings); },
      "list of str: what to know before the numbers are used.");
  property(
      c, "cannot_tell", [](const ident::Result& r) { return list_of(r.cannot_tell); },
      "list of str: what these logs do not determine.");
  c.def_property_readonly(
      "records", [](const Found& f) { return records_of(f.axis); },
      "list of dict: the cleaned signals that were fitted, arrays t [s], x, r [m], v [m/s], force [N] with equal rows; r and v only where "
      "logged.");
}

void add_files(FoundClass& c) {
  c.def(
      "as_model", [](const Found& f) { return model_object(workflow::axis_file(f.found, f.axis)); },
      "as_model($self)\n--\n\nThe AxisModel: mass, load and friction to evaluate. Raises InputError where force or position has no scale.");
  c.def(
      "save",
      [](const Found& f, const py::object& path) {
        const std::string file = path_of(path);
        unlocked(
            [&] { io::write_atomically(file, workflow::axis_file_text(f.found, f.axis, STRIBECK_VERSION)); });
      },
      py::arg("path"),
      "save($self, path)\n--\n\nWrites the axis file (TOML), which compensators, exports and verify() read.");
  c.def(
      "save_report",
      [](const Found& f, const py::object& folder) {
        const std::string path = path_of(folder);
        unlocked([&] {
          report::IdentifyReportInput page = workflow::page_of(f.found, f.axis);
          page.version = STRIBECK_VERSION;
          report::write_identify_report({path, ""}, page);
        });
      },
      py::arg("folder"),
      "save_report($self, folder)\n--\n\nWrites the HTML page of identify, folder/index.html.");
  c.def(
      "to_dict", [](const Found& f) { return object_of(workflow::to_json(f.found, f.axis.axis)); },
      "to_dict($self)\n--\n\nThe same keys and numbers as `stribeck identify --json` writes (docs/reference/json.md), without \"made\".");
  c.def(
      "to_json", [](const Found& f) { return str_of(io::dump(workflow::to_json(f.found, f.axis.axis))); },
      "to_json($self)\n--\n\nto_dict() as text.");
  c.def("__str__", [](const Found& f) { return str_of(workflow::text_of(f.found, f.axis.axis)); });
  c.def("__repr__", [](const Found& f) {
    const ident::Result& r = f.found.result;
    return str_of(
        fmt::format("<stribeck.Identification of {}: {}, mass {:.6g} kg>", f.axis.sources, r.model, r.mass));
  });
}

}  // namespace

void add_identify(py::module_& module) {
  FoundClass found(
      module, "Identification",
      "Mass and friction of an axis with 95 % intervals; str() gives the tables of the command.");
  add_numbers(found);
  add_arrays(found);
  add_files(found);
  module.def(
      "identify", &identify,
      "identify(*logs, axis=None, map=None, gain=None, lead=None, where=None, runs=None, sample_time=None, keep=None, "
      "map_file=None, method='auto', model='auto', terms=None, mass=None, cut_off=None, force_shift=None, turn=None, "
      "solver='derivatives')\n--\n\n"
      "Identifies mass and friction of an axis.\n\n"
      "logs: files of any format, Log objects, or dicts of arrays {\"t\": t, \"x\": x, \"force\": f} in SI (see Log); several are "
      "fitted together.\n"
      "axis: name of the axis in logs of several.\n"
      "map: {\"x\": \"Istposition mm\"}, which column is what: t, r, x, v, v_ref, a, force, torque, current, voltage, percent.\n"
      "gain: force per volt, ampere, newton metre or percent, \"1048 N/V\". lead: travel per turn, \"5 mm\" or in m.\n"
      "where: {\"column\": value}, rows that count. runs: columns whose change begins a new run.\n"
      "method, model, terms, mass [kg], cut_off [Hz], force_shift [s], turn [m], solver: as the options of `stribeck identify`.\n"
      "Returns an Identification.\n"
      "Raises InputError for logs and arguments, Refused where the logs do not determine the mass.");
}

}  // namespace stribeck::python
