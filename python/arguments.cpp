#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include <python/arguments.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/units.hpp>

namespace stribeck::python {
namespace {

std::string type_name(const py::handle& object) {
  return py::cast<std::string>(py::type::handle_of(object).attr("__name__"));
}

[[noreturn]] void wrong_type(const std::string& name, const py::handle& object, const char* expected) {
  throw py::type_error(fmt::format("{}: got {}, expected {}", name, type_name(object), expected));
}

/// int or float, NumPy's as well; not bool.
bool is_number(const py::handle& object) {
  return !py::isinstance<py::bool_>(object) && !py::isinstance<py::array>(object) &&
         (PyFloat_Check(object.ptr()) != 0 || PyIndex_Check(object.ptr()) != 0 ||
          py::hasattr(object, "__float__"));
}

double number_of(const std::string& name, const py::handle& object) {
  const double value = PyFloat_AsDouble(object.ptr());
  if (PyErr_Occurred() != nullptr) throw py::error_already_set();
  if (!std::isfinite(value)) refuse(name, fmt::format("got {}, expected a finite number", value));
  return value;
}

std::string text_of(const std::string& name, const py::handle& object) {
  if (!py::isinstance<py::str>(object)) wrong_type(name, object, "str");
  std::string text = py::cast<std::string>(object);
  if (text.find_first_not_of(" \t") == std::string::npos)
    refuse(name, "got \"\", expected a value (leave the argument out to do without)");
  return text;
}

std::string text_or_number(const std::string& name, const py::handle& object, std::string_view unit) {
  if (is_number(object)) {
    const std::string number = io::number_text(number_of(name, object));
    return unit.empty() ? number : fmt::format("{} {}", number, unit);
  }
  return py::hasattr(object, "__fspath__") ? path_of(object, name) : text_of(name, object);
}

std::string quantity_of(const std::string& name, const py::handle& object, std::string_view unit) {
  if (is_number(object)) return fmt::format("{} {}", io::number_text(number_of(name, object)), unit);
  if (!py::isinstance<py::str>(object))
    wrong_type(name, object, fmt::format("text with its unit, or a number in {}", unit).c_str());
  return text_of(name, object);
}

bool is_list(const py::handle& object) {
  return py::isinstance<py::list>(object) || py::isinstance<py::tuple>(object);
}

/// A list from which a program has taken everything must not mean "all of them".
void refuse_none(const std::string& name, const std::vector<std::string>& list) {
  if (list.empty())
    refuse(name, "got an empty list, expected at least one (leave the argument out to do without)");
}

}  // namespace

py::str str_of(std::string_view text) {
  PyObject* made = PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "replace");
  if (made == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::str>(made);
}

py::list list_of(const std::vector<std::string>& texts) {
  py::list out;
  for (const std::string& text : texts) out.append(str_of(text));
  return out;
}

py::object object_of(const nlohmann::ordered_json& json) {
  using Kind = nlohmann::ordered_json::value_t;
  switch (json.type()) {
    case Kind::object: {
      py::dict out;
      for (const auto& [key, value] : json.items()) out[str_of(key)] = object_of(value);
      return out;
    }
    case Kind::array: {
      py::list out;
      for (const auto& value : json) out.append(object_of(value));
      return out;
    }
    case Kind::string:
      return str_of(json.get_ref<const std::string&>());
    case Kind::boolean:
      return py::bool_(json.get<bool>());
    case Kind::number_integer:
      return py::int_(json.get<std::int64_t>());
    case Kind::number_unsigned:
      return py::int_(json.get<std::uint64_t>());
    case Kind::number_float: {
      // Absent values are None, as null in a file.
      const double value = json.get<double>();
      return std::isfinite(value) ? py::object(py::float_(value)) : py::object(py::none());
    }
    default:
      return py::none();
  }
}

py::array_t<double> array_of(const std::vector<double>& values) {
  return py::array_t<double>(static_cast<py::ssize_t>(values.size()), values.data());
}

bool is_path(const py::handle& object) {
  return py::isinstance<py::str>(object) || py::isinstance<py::bytes>(object) ||
         py::hasattr(object, "__fspath__");
}

std::string path_of(const py::handle& object, const std::string& name) {
  if (!is_path(object)) wrong_type(name, object, "str or os.PathLike");
  // Names that are not UTF-8 keep their bytes.
  std::string path = py::cast<std::string>(py::module_::import("os").attr("fsencode")(object));
  if (path.empty()) refuse(name, "got \"\", expected the name of a file");
  if (path.find('\0') != std::string::npos)
    refuse(name, "got a name with a zero byte, expected that of a file");
  return path;
}

std::vector<std::string> paths_of(const py::handle& object, const std::string& name) {
  if (is_path(object)) return {path_of(object, name)};
  if (!is_list(object)) wrong_type(name, object, "str, os.PathLike or a list of these");
  std::vector<std::string> out;
  for (const py::handle& one : object) out.push_back(path_of(one, name));
  return out;
}

Values values_of(const py::handle& object, const std::string& name) {
  // NumPy would hand over what stands behind the mask.
  if (py::isinstance(object, py::module_::import("numpy.ma").attr("MaskedArray")))
    refuse(name, "got a masked array, expected every value (cut the masked rows out of all columns)");
  const py::array any = py::array::ensure(object);
  if (!any) {
    PyErr_Clear();
    wrong_type(name, object, "an array of numbers");
  }
  const char kind = any.dtype().kind();
  if (kind != 'f' && kind != 'i' && kind != 'u') {
    throw py::type_error(fmt::format("{}: got an array of {}, expected numbers (integers or floats)", name,
                                     py::cast<std::string>(py::str(any.dtype()))));
  }
  const auto numbers = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(any);
  if (!numbers) throw py::error_already_set();
  Values out{{numbers.shape(), numbers.shape() + numbers.ndim()},
             {numbers.data(), numbers.data() + numbers.size()}};
  for (std::size_t k = 0; k < out.values.size(); ++k) {
    if (!std::isfinite(out.values[k]))
      refuse(name, fmt::format("got {} at index {}, expected finite numbers", out.values[k], k));
  }
  return out;
}

std::vector<double> column_of(const py::handle& object, const std::string& name) {
  Values found = values_of(object, name);
  if (found.shape.size() != 1)
    refuse(name, fmt::format("got an array of {} dimensions, expected one", found.shape.size()));
  return std::move(found.values);
}

py::object Keywords::take(const char* name) {
  if (!left_.contains(name)) return py::none();
  py::object value = left_[name];
  PyDict_DelItemString(left_.ptr(), name);
  return value;
}

std::string Keywords::text(const char* name) {
  const py::object value = take(name);
  return value.is_none() ? "" : text_of(name, value);
}

std::string Keywords::quantity(const char* name, std::string_view unit) {
  const py::object value = take(name);
  return value.is_none() ? "" : quantity_of(name, value, unit);
}

std::vector<std::string> Keywords::quantities(const char* name, std::string_view unit) {
  const py::object value = take(name);
  if (value.is_none()) return {};
  if (!is_list(value) && !py::isinstance<py::array>(value)) return {quantity_of(name, value, unit)};
  std::vector<std::string> out;
  for (const py::handle& one : value) out.push_back(quantity_of(name, one, unit));
  refuse_none(name, out);
  return out;
}

std::string Keywords::word(const char* name, const std::vector<std::string>& words) {
  std::string given = text(name);
  if (!given.empty() && std::find(words.begin(), words.end(), given) == words.end())
    refuse_choice(name, given, words);
  return given;
}

std::vector<std::string> Keywords::texts(const char* name, std::string_view unit) {
  const py::object value = take(name);
  if (value.is_none()) return {};
  if (is_number(value) || is_path(value)) return {text_or_number(name, value, unit)};
  std::vector<std::string> out;
  if (py::isinstance<py::dict>(value)) {
    for (const auto& [key, one] : py::reinterpret_borrow<py::dict>(value))
      out.push_back(text_of(name, key) + "=" + text_or_number(name, one, unit));
    return out;
  }
  if (!is_list(value)) wrong_type(name, value, "str, a list of str or a dict");
  for (const py::handle& one : value) out.push_back(text_or_number(name, one, unit));
  // An empty list of options is none of them; an empty choice would be everything.
  if (std::string_view(name) == "only" || std::string_view(name) == "controllers") refuse_none(name, out);
  return out;
}

std::string Keywords::path(const char* name) {
  const py::object value = take(name);
  return value.is_none() ? "" : path_of(value, name);
}

std::vector<std::string> Keywords::paths(const char* name) {
  const py::object value = take(name);
  return value.is_none() ? std::vector<std::string>() : paths_of(value, name);
}

std::optional<std::int64_t> Keywords::whole(const char* name, std::int64_t least, std::int64_t most) {
  const py::object value = take(name);
  if (value.is_none()) return std::nullopt;
  if (PyIndex_Check(value.ptr()) == 0 || py::isinstance<py::bool_>(value)) wrong_type(name, value, "int");
  int beyond = 0;
  const py::object number = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
  if (!number) throw py::error_already_set();
  const long long got = PyLong_AsLongLongAndOverflow(number.ptr(), &beyond);
  if (beyond != 0 || got < least || got > most) {
    refuse(name,
           fmt::format("got {}, expected {} to {}", py::cast<std::string>(py::str(value)), least, most));
  }
  return got;
}

std::optional<double> Keywords::si(const char* name, std::string_view unit, double least, double most) {
  if (!left_.contains(name) || !py::isinstance<py::str>(left_[name])) return number(name, least, most);
  const std::string text = quantity(name, unit);
  try {
    return io::to_si(text, stribeck::quantity(unit, unit).at_least(least).at_most(most));
  } catch (const io::InputError& e) {
    refuse(name, e.problems().front().message);
  }
}

std::optional<double> Keywords::number(const char* name, double least, double most) {
  const py::object value = take(name);
  if (value.is_none()) return std::nullopt;
  if (!is_number(value)) wrong_type(name, value, "a number");
  const double got = number_of(name, value);
  if (!(got >= least && got <= most))
    refuse(name, fmt::format("got {}, expected {} to {}", got, least, most));
  return got;
}

bool Keywords::flag(const char* name, bool otherwise) {
  const py::object value = take(name);
  if (value.is_none()) return otherwise;
  if (!py::isinstance<py::bool_>(value)) wrong_type(name, value, "bool");
  return value.is(py::bool_(true));
}

void Keywords::refuse_choice(const char* name, const std::string& word,
                             const std::vector<std::string>& words) {
  refuse(name, fmt::format("got {}, expected one of {}", io::in_quotes(word), fmt::join(words, ", ")));
}

void Keywords::done() const {
  if (left_.empty()) return;
  throw py::type_error(fmt::format("{}() has no argument {}", function_,
                                   io::in_quotes(py::cast<std::string>(py::str(left_.begin()->first)))));
}

void refuse(const std::string& name, const std::string& message) {
  throw io::InputError({"", 0, name, message});
}

}  // namespace stribeck::python
