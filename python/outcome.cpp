#include <pybind11/pybind11.h>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include <python/parts.hpp>
#include <stribeck/control/laws/contouring.hpp>
#include <stribeck/io/json.hpp>
#include <stribeck/workflow/parameters.hpp>
#include <stribeck/workflow/path/path_options.hpp>

namespace stribeck::python {

std::uint64_t seed_of(Keywords& keywords) {
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  return static_cast<std::uint64_t>(keywords.whole("seed", 0, kMost).value_or(1));
}

std::uint32_t trials_of(Keywords& keywords, std::uint32_t otherwise) {
  constexpr std::int64_t kMost = 100000;
  return static_cast<std::uint32_t>(keywords.whole("trials", 1, kMost).value_or(otherwise));
}

unsigned threads_of(Keywords& keywords) {
  constexpr std::int64_t kMost = 4096;
  return static_cast<unsigned>(keywords.whole("threads", 0, kMost).value_or(0));
}

workflow::ParameterOptions parameter_options(Keywords& keywords) {
  workflow::ParameterOptions o;
  if (const std::string source = keywords.word("parameters", {"identified", "thesis"}); !source.empty())
    o.source = source;
  o.axis_files = keywords.texts("axis_file");
  return o;
}

workflow::PathOptions path_options(Keywords& keywords) {
  constexpr double kLeastLaps = 0.25, kMostLaps = 1000.0;
  workflow::PathOptions o;
  const auto use = [&o](std::string text, std::string& out) {
    if (text.empty()) return;
    out = std::move(text);
    o.given = true;
  };
  use(keywords.path("path"), o.path);
  // A name without a dot or a slash is that of a shape, as at the command.
  if (o.path.find_first_of("./") == std::string::npos && !enum_value<path::Shape>(o.path)) {
    Keywords::refuse_choice("path", o.path, {kEnumWords<path::Shape>.begin(), kEnumWords<path::Shape>.end()});
  }
  o.axes = keywords.texts("axes");
  o.given = o.given || !o.axes.empty();
  use(keywords.quantity("size", "m"), o.size);
  if (const auto laps = keywords.number("laps", kLeastLaps, kMostLaps)) o.laps = *laps, o.given = true;
  use(keywords.quantity("omega_t", "rad/s"), o.omega_t);
  use(keywords.quantity("omega_n", "rad/s"), o.omega_n);
  use(keywords.quantity("observer_pole", "1/s"), o.observer_pole);
  use(keywords.word("observer", {"disturbance", "kalman"}), o.observer);
  use(keywords.word("error_rate",
                    {kEnumWords<control::ErrorRate>.begin(), kEnumWords<control::ErrorRate>.end()}),
      o.error_rate);
  use(keywords.quantity("accuracy", "m"), o.accuracy);
  use(keywords.quantity("acceleration", "m/s2"), o.acceleration);
  use(keywords.quantity("jerk", "m/s3"), o.jerk);
  use(keywords.quantity("corner_tolerance", "m"), o.corner_tolerance);
  if (const std::string join = keywords.word("join", {"corners", "spline"}); !join.empty()) {
    o.join = *enum_value<workflow::PointJoin>(join);
    o.given = true;
  }
  return o;
}

std::vector<std::string> names_of(const std::vector<io::Log>& logs) {
  std::vector<std::string> out;
  for (const io::Log& log : logs) out.push_back(log.source);
  return out;
}

void add_outcome(py::module_& module) {
  py::class_<Outcome, std::shared_ptr<Outcome>> c(
      module, "Result", "The result of a verb: result[\"key\"] as in its JSON, str(result) its tables.");
  c.def(
      "__getitem__",
      [](const Outcome& o, const std::string& key) {
        if (!o.json.is_object() || !o.json.contains(key)) throw py::key_error(key);
        return object_of(o.json.at(key));
      },
      py::arg("key"), "A value of the JSON.");
  c.def("__contains__", [](const Outcome& o, const std::string& key) { return o.json.contains(key); });
  c.def(
      "keys",
      [](const Outcome& o) {
        py::list out;
        for (const auto& [key, value] : o.json.items()) out.append(str_of(key));
        return out;
      },
      "keys($self)\n--\n\nThe keys of the JSON.");
  c.def_property_readonly(
      "log", [](const Outcome& o) { return o.log ? py::cast(*o.log) : py::object(py::none()); },
      "Log: the columns over time that the verb writes as a CSV; None where it writes none.");
  c.def_readonly("ok", &Outcome::ok,
                 "bool: False where the command ends with exit code 1, because the answer is no.");
  c.def(
      "to_dict", [](const Outcome& o) { return object_of(o.json); },
      "to_dict($self)\n--\n\nThe same keys and numbers as --json writes (docs/reference/json.md), without \"made\".");
  c.def(
      "to_json", [](const Outcome& o) { return str_of(io::dump(o.json)); },
      "to_json($self)\n--\n\nto_dict() as text.");
  c.def("__str__", [](const Outcome& o) { return str_of(o.text); });
  c.def("__repr__", [](const Outcome& o) {
    return str_of("<stribeck.Result " + o.json.value("schema", std::string("of a verb")) + ">");
  });
}

}  // namespace stribeck::python
