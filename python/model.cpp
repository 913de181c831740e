#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <cmath>
#include <memory>
#include <variant>

#include <python/parts.hpp>
#include <stribeck/friction/axis_model.hpp>
#include <stribeck/ident/replay/model_force.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/sim/axis_file.hpp>

namespace stribeck::python {
namespace {

using friction::AxisModel;
using sim::AxisFile;

/// Velocities, and positions of the same shape.
struct Places {
  Values v;
  std::vector<double> x;
};

Places places_of(const py::object& v, const py::object& x) {
  Places out{values_of(v, "v"), {}};
  Values given = values_of(x, "x");
  if (given.shape.empty()) {
    out.x.assign(out.v.values.size(), given.values.front());
  } else if (given.shape == out.v.shape) {
    out.x = std::move(given.values);
  } else {
    refuse("x", fmt::format("got {} values, expected one, or an array of the shape of v ({} values)",
                            given.values.size(), out.v.values.size()));
  }
  return out;
}

/// An array of the shape of v; a float for a single velocity.
py::object shaped(const Values& like, const std::vector<double>& values) {
  if (like.shape.empty()) return py::float_(values.front());
  return py::array_t<double>(like.shape, values.data());
}

py::object friction_at(const AxisFile& file, const py::object& v, const py::object& x) {
  const AxisModel& m = file.model;
  const Places at = places_of(v, x);
  std::vector<double> f(at.x.size());
  for (std::size_t k = 0; k < f.size(); ++k) {
    const double speed = at.v.values[k];
    const friction::SteadyParts<double> p = m.friction.parts(speed, at.x[k]);
    f[k] = p.level * sign(speed) + p.viscous + p.additive;
  }
  return shaped(at.v, f);
}

py::dict parts_at(const AxisFile& file, const py::object& v, const py::object& x) {
  const AxisModel& m = file.model;
  const Places at = places_of(v, x);
  const std::size_t n = at.x.size();
  std::vector<double> level(n), viscous(n), additive(n);
  for (std::size_t k = 0; k < n; ++k) {
    const friction::SteadyParts<double> p = m.friction.parts(at.v.values[k], at.x[k]);
    level[k] = p.level, viscous[k] = p.viscous, additive[k] = p.additive;
  }
  py::dict out;
  out["level"] = shaped(at.v, level);
  out["viscous"] = shaped(at.v, viscous);
  out["additive"] = shaped(at.v, additive);
  return out;
}

/// Positions that belong to the velocities, by trapezoids.
std::vector<double> way_of(const std::vector<double>& v, double period, double start) {
  std::vector<double> x(v.size(), start);
  for (std::size_t k = 1; k < v.size(); ++k) x[k] = x[k - 1] + 0.5 * (v[k - 1] + v[k]) * period;
  return x;
}

py::dict simulate_motion(const AxisFile& file, const py::object& velocities, const py::kwargs& given) {
  constexpr double kLeast = 1e-9, kMost = 1e6, kFar = 1e9;
  Keywords keywords("simulate", given);
  const auto period = keywords.si("sample_time", "s", kLeast, kMost);
  const double start = keywords.si("x0", "m", -kFar, kFar).value_or(0.0);
  const double push = keywords.si("push", "N", -kFar, kFar).value_or(0.0);
  keywords.done();
  if (!period) refuse("sample_time", "missing, expected the time between two velocities in s");
  const std::vector<double> v = column_of(velocities, "v");
  if (v.empty()) refuse("v", "got no value, expected velocities");
  const std::vector<double> x = way_of(v, *period, start);
  std::vector<double> t(v.size());
  for (std::size_t k = 0; k < t.size(); ++k) t[k] = static_cast<double>(k) * *period;
  const std::vector<double> f =
      unlocked([&] { return ident::replay::friction_along(file.model.friction, x, v, *period, push); });
  for (std::size_t k = 0; k < f.size(); ++k) {
    if (!std::isfinite(f[k]))
      refuse("v", fmt::format("the friction is not finite at index {}, where v is {} m/s", k, v[k]));
  }
  py::dict out;
  out["t"] = array_of(t);
  out["x"] = array_of(x);
  out["v"] = array_of(v);
  out["friction"] = array_of(f);
  return out;
}

std::string_view kind_of(const auto& laws) {
  return std::visit([]<class Law>(const Law&) -> std::string_view { return Law::kKind; }, laws);
}

std::string toml_of(const AxisFile& file) { return io::write_toml(file); }

py::object number_or_none(const std::optional<double>& number) {
  return number ? py::object(py::float_(*number)) : py::object(py::none());
}

}  // namespace

py::object model_object(AxisFile file) { return py::cast(std::make_shared<AxisFile>(std::move(file))); }

void add_models(py::module_& module) {
  py::class_<AxisFile, std::shared_ptr<AxisFile>> c(
      module, "AxisModel",
      "What a compensator knows of an axis: mass, load, and friction with its pre-sliding.");
  c.def_property_readonly(
      "mass", [](const AxisFile& f) { return f.model.mass; },
      "float: equivalent mass [kg]; of a rotary axis [kg m2].");
  c.def_property_readonly(
      "load", [](const AxisFile& f) { return f.model.load; },
      "float: constant force against +x [N]; of a rotary axis [N m].");
  c.def_property_readonly(
      "delay", [](const AxisFile& f) { return number_or_none(f.model.delay); },
      "float: from the sample to the instant at which its force begins to act [s]; None where it is not known.");
  c.def_property_readonly(
      "axis", [](const AxisFile& f) { return f.axis ? str_of(*f.axis) : py::object(py::none()); },
      "str: name of the axis; None where it is not known.");
  c.def_property_readonly(
      "rotary", [](const AxisFile& f) { return f.rotary.value_or(false); },
      "bool: an axis that turns, carried at a radius of 1 m: positions are rad, forces N m.");
  c.def_property_readonly(
      "steady", [](const AxisFile& f) { return str_of(kind_of(f.model.friction.steady)); },
      "str: kind of the steady map, conventional or gaussian.");
  c.def_property_readonly(
      "dynamics", [](const AxisFile& f) { return str_of(kind_of(f.model.friction.dynamics)); },
      "str: law of pre-sliding: static (none), lugre or gms.");
  c.def_property_readonly(
      "velocity_range",
      [](const AxisFile& f) -> py::object {
        const auto of_map = f.model.friction.identified_range();
        const auto& range = of_map ? of_map : f.velocity_range;
        if (!range) return py::none();
        return py::make_tuple((*range)[0], (*range)[1]);
      },
      "(lowest, highest): velocities of the data behind it [m/s]; None where it does not know them.");
  c.def(
      "friction", &friction_at, py::arg("v"), py::arg("x") = 0.0,
      "friction($self, v, x=0.0)\n--\n\n"
      "Steady friction [N] while sliding with v [m/s] at position x [m]: positive for v > 0; at v = 0 without level.\n\n"
      "v: a number or an array of any shape. x: one number, or an array of the same shape; it matters for terms that are periodic "
      "in position, places and a spring.\n"
      "Returns an array of that shape. Raises InputError for NaN and for shapes that differ.");
  c.def(
      "parts", &parts_at, py::arg("v"), py::arg("x") = 0.0,
      "parts($self, v, x=0.0)\n--\n\n"
      "The three parts of friction() [N] as a dict: level (>= 0, follows the direction), viscous, additive (keeps its sign).");
  c.def(
      "simulate", &simulate_motion, py::arg("v"),
      "simulate($self, v, *, sample_time, x0=0.0, push=0.0)\n--\n\n"
      "Friction along a motion, with the bristles of the dynamic law: v [m/s] at rows sample_time [s] apart.\n\n"
      "x0: position of the first row [m]; the others follow by trapezoids. push: force on the axis where it begins at rest [N].\n"
      "Returns a dict of arrays of equal length: t [s], x [m], v [m/s], friction [N].\n"
      "Raises InputError for NaN, no rows, more than one dimension.");
  c.def(
      "save",
      [](const AxisFile& f, const py::object& path) {
        const std::string file = path_of(path);
        unlocked([&] { io::write_atomically(file, toml_of(f)); });
      },
      py::arg("path"), "save($self, path)\n--\n\nWrites an axis file (TOML).");
  c.def("__str__", [](const AxisFile& f) { return str_of(toml_of(f)); });
  c.def("__repr__", [](const AxisFile& f) {
    return str_of(fmt::format("<stribeck.AxisModel {}, {}, mass {:.6g} {}>", kind_of(f.model.friction.steady),
                              kind_of(f.model.friction.dynamics), f.model.mass,
                              f.rotary.value_or(false) ? "kg m2" : "kg"));
  });
  module.def(
      "read_model",
      [](const py::object& path) {
        const std::string file = path_of(path);
        return model_object(unlocked([&] { return io::read_toml<AxisFile>(file); }));
      },
      py::arg("path"),
      "read_model(path)\n--\n\nReads an axis file (TOML), as identify writes it. Returns an AxisModel. Raises InputError with file, line and "
      "key.");
  module.def(
      "parse_model",
      [](const std::string& text) { return model_object(io::read_toml_text<AxisFile>(text, "model")); },
      py::arg("text"), "parse_model(text)\n--\n\nThe same from the text of an axis file.");
}

}  // namespace stribeck::python
