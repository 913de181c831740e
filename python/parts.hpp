#pragma once
/// The parts of the Python module, one file each, and what they share. A function reads its arguments, calls the workflow without the
/// interpreter's lock and hands the result over; nothing is computed here.
///
/// Docstrings begin with the signature and a line "--", which inspect.signature() reads.
/// Real time: no.

#include <pybind11/pybind11.h>
#include <python/arguments.hpp>
#include <stribeck/friction/axis_model.hpp>
#include <stribeck/workflow/log/log_options.hpp>
#include <string>
#include <vector>

namespace stribeck::python {

void add_errors(py::module_& module);
void add_logs(py::module_& module);
void add_models(py::module_& module);
void add_identify(py::module_& module);

/// Takes the arguments on reading the columns of a log.
workflow::LogOptions log_options(Keywords& keywords);

/// A path, a stribeck.Log or a dict of arrays. Paths are read with the options.
std::vector<io::Log> logs_of(const py::args& logs, const workflow::LogOptions& options);

/// An axis model as a Python object.
py::object model_object(friction::AxisModel model);

/// Calls `work` without the interpreter's lock.
template <class Work>
auto unlocked(Work&& work) {
  const py::gil_scoped_release release;
  return work();
}

}  // namespace stribeck::python
