#include <pybind11/pybind11.h>
#include <exception>
#include <string>

#include <python/parts.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/sim/experiments.hpp>

namespace stribeck::python {
namespace {

// They live as long as the interpreter.
PyObject* input_error = nullptr;
PyObject* refused = nullptr;

/// Options of the command that a message names, as arguments: "--sample-time" → "sample_time".
std::string with_arguments(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    const bool begins = i == 0 || text[i - 1] == ' ' || text[i - 1] == '(';
    if (!begins || text.compare(i, 2, "--") != 0 || i + 2 >= text.size() || text[i + 2] < 'a' ||
        text[i + 2] > 'z') {
      out += text[i++];
      continue;
    }
    for (i += 2; i < text.size() && (text[i] == '-' || (text[i] >= 'a' && text[i] <= 'z')); ++i)
      out += text[i] == '-' ? '_' : text[i];
  }
  return out;
}

void raise(PyObject* type, const std::string& message, const std::vector<std::string>& problems) {
  const py::object error = py::reinterpret_borrow<py::object>(type)(str_of(with_arguments(message)));
  py::list lines;
  for (const std::string& problem : problems) lines.append(str_of(with_arguments(problem)));
  error.attr("problems") = lines;
  PyErr_SetObject(type, error.ptr());
}

void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(std::move(thrown));
  } catch (const io::InputError& e) {
    std::vector<std::string> lines;
    for (const io::Problem& problem : e.problems()) lines.push_back(problem.text());
    raise(input_error, e.what(), lines);
  } catch (const ident::Refused& e) {
    raise(refused, e.what(), {e.what()});
  } catch (const sim::Refused& e) {
    raise(refused, e.what(), {e.what()});
  }
}

}  // namespace

std::function<void(std::uint64_t, std::uint64_t)> interruptible() {
  return [](std::uint64_t, std::uint64_t) {
    const py::gil_scoped_acquire lock;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  };
}

void add_errors(py::module_& module) {
  input_error = PyErr_NewExceptionWithDoc(
      "stribeck.InputError",
      "A file, an array or an argument that cannot be used. The message is one line: place, key, what was found, what was expected, "
      "way out. `problems` is the list of all such lines.",
      PyExc_ValueError, nullptr);
  refused = PyErr_NewExceptionWithDoc(
      "stribeck.Refused",
      "The data do not determine what was asked for; the message says why and what would help.", input_error,
      nullptr);
  if (input_error == nullptr || refused == nullptr) throw py::error_already_set();
  module.add_object("InputError", input_error);
  module.add_object("Refused", refused);
  py::register_exception_translator(&translate);
}

}  // namespace stribeck::python

PYBIND11_MODULE(stribeck, module) {
  namespace py = pybind11;
  // Docstrings carry their signatures themselves.
  py::options options;
  options.disable_function_signatures();
  module.doc() =
      "Friction of machine-tool feed drives: identified, shown, taken out.\n\n"
      "Numbers and arrays are SI: m, rad, N, kg, s. A quantity that is an argument may be text with its unit, as at the command "
      "(\"57.65 N s2/mm\"), or a number in its SI unit. Errors are stribeck.InputError, a ValueError with one line that says what to "
      "do, and its kind stribeck.Refused where data do not determine an answer. Long calls let other threads run.\n\n"
      "Guide: docs/guides/python.md.";
  module.attr("__version__") = STRIBECK_VERSION;
  stribeck::python::add_errors(module);
  stribeck::python::add_logs(module);
  stribeck::python::add_models(module);
  stribeck::python::add_identify(module);
  stribeck::python::add_outcome(module);
  stribeck::python::add_runs(module);
  stribeck::python::add_comparison(module);
  stribeck::python::add_judges(module);
  stribeck::python::add_study(module);
  stribeck::python::add_tuning(module);
  stribeck::python::add_commission(module);
  stribeck::python::add_export(module);
  stribeck::python::add_reproduction(module);
}
