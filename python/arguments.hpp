#pragma once
/// What Python hands over, and what it gets back: texts, paths, arrays, JSON.
///
/// Numbers are SI. A quantity may be given as text with its unit ("57.65 N s2/mm") or as a number in its SI unit.
/// Real time: no. Errors: InputError with the name of the argument as its place; TypeError for values of another kind.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <stribeck/core/fields.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stribeck::python {

namespace py = pybind11;

/// Bytes that are not UTF-8 become U+FFFD.
py::str str_of(std::string_view text);
py::list list_of(const std::vector<std::string>& texts);
/// dict, list, str, int, float, bool or None.
py::object object_of(const nlohmann::ordered_json& json);
/// A new array that owns its values.
py::array_t<double> array_of(const std::vector<double>& values);
/// One number of each item: array_of(points, &Point::x).
template <class Item, class Number>
py::array_t<double> array_of(const std::vector<Item>& items, Number Item::*member) {
  std::vector<double> values;
  values.reserve(items.size());
  for (const Item& item : items) values.push_back(static_cast<double>(item.*member));
  return array_of(values);
}

/// str, bytes or os.PathLike.
std::string path_of(const py::handle& object, const std::string& name = "path");
/// Whether path_of() takes it.
bool is_path(const py::handle& object);
/// One path, or a list or tuple of them.
std::vector<std::string> paths_of(const py::handle& object, const std::string& name = "path");

/// The shape of an array of numbers, and its values in C order; from any array or list of integers or floats, wherever its values
/// are. Refuses what is no number, NaN and infinity.
struct Values {
  std::vector<py::ssize_t> shape;
  std::vector<double> values;
};
Values values_of(const py::handle& object, const std::string& name);
/// The same for one dimension.
std::vector<double> column_of(const py::handle& object, const std::string& name);

/// Keyword arguments, taken one by one. None stands for one that is left out.
class Keywords {
 public:
  Keywords(std::string function, const py::kwargs& given) : function_(std::move(function)), left_(given) {}

  /// "": left out.
  std::string text(const char* name);
  /// The same, one of these words.
  std::string word(const char* name, const std::vector<std::string>& words);
  /// A quantity; `unit` is that of a number.
  std::string quantity(const char* name, std::string_view unit);
  /// Several quantities, or one.
  std::vector<std::string> quantities(const char* name, std::string_view unit);
  /// One text or several; a dict {"x": "position mm"} stands for "x=position mm". Numbers among them are written out, with
  /// the unit where there is one.
  std::vector<std::string> texts(const char* name, std::string_view unit = {});
  std::string path(const char* name);
  /// One of a list as well.
  std::vector<std::string> paths(const char* name);
  std::optional<std::int64_t> whole(const char* name, std::int64_t least, std::int64_t most);
  std::optional<double> number(const char* name, double least, double most);
  /// The same for a quantity: its number in the SI unit, or a text with a unit, "1 ms".
  std::optional<double> si(const char* name, std::string_view unit, double least, double most);
  bool flag(const char* name, bool otherwise);
  template <NamedEnum E>
  E choice(const char* name, E otherwise) {
    const std::string word = text(name);
    if (word.empty()) return otherwise;
    if (const std::optional<E> value = enum_value<E>(word)) return *value;
    std::vector<std::string> words;
    for (const auto& [value, one] : EnumNames<E>::names) words.emplace_back(one);
    refuse_choice(name, word, words);
  }
  [[noreturn]] static void refuse_choice(const char* name, const std::string& word,
                                         const std::vector<std::string>& words);

  /// TypeError for what nobody has taken.
  void done() const;

 private:
  py::object take(const char* name);

  std::string function_;
  py::dict left_;
};

/// Refused with the name of the argument as its place.
[[noreturn]] void refuse(const std::string& name, const std::string& message);

}  // namespace stribeck::python
