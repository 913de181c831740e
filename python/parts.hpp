#pragma once
/// The parts of the Python module, one file each, and what they share. A function reads its arguments, calls the workflow without the
/// interpreter's lock and hands the result over; nothing is computed here.
///
/// Docstrings begin with the signature and a line "--", which inspect.signature() reads.
/// Real time: no.

#include <pybind11/pybind11.h>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <python/arguments.hpp>
#include <stribeck/sim/axis_file.hpp>
#include <stribeck/workflow/log/log_options.hpp>
#include <stribeck/workflow/path/path_options.hpp>
#include <string>
#include <vector>

namespace stribeck::python {

void add_errors(py::module_& module);
void add_logs(py::module_& module);
void add_models(py::module_& module);
void add_identify(py::module_& module);
void add_outcome(py::module_& module);
void add_runs(py::module_& module);
void add_comparison(py::module_& module);
void add_judges(py::module_& module);
void add_study(py::module_& module);
void add_tuning(py::module_& module);
void add_commission(py::module_& module);
void add_export(py::module_& module);
void add_reproduction(py::module_& module);

/// Take seed, trials and threads of a computation with random noise.
std::uint64_t seed_of(Keywords& keywords);
std::uint32_t trials_of(Keywords& keywords, std::uint32_t otherwise);
unsigned threads_of(Keywords& keywords);

/// Takes the arguments on reading the columns of a log; on the origin of parameters; on a path.
workflow::LogOptions log_options(Keywords& keywords);
workflow::ParameterOptions parameter_options(Keywords& keywords);
workflow::PathOptions path_options(Keywords& keywords);

/// Reads a file.
using LogReader = std::function<io::Log(const std::string&)>;
LogReader reading_with(const workflow::LogOptions& options);
/// One or a list of: a path, which is read, a stribeck.Log or a dict of arrays.
std::vector<io::Log> logs_of(const py::handle& logs, const LogReader& reader);
std::vector<std::string> names_of(const std::vector<io::Log>& logs);

/// What a verb has written: its JSON, its tables, the log where there is one, and the answer.
struct Outcome {
  nlohmann::ordered_json json;
  std::string text;
  std::optional<io::Log> log;
  bool ok = true;
};

/// The content of an axis file as a Python object, an AxisModel there.
py::object model_object(sim::AxisFile file);

/// Lets Ctrl-C end the work: a progress function.
std::function<void(std::uint64_t, std::uint64_t)> interruptible();

/// Calls `work` without the interpreter's lock.
template <class Work>
auto unlocked(Work&& work) {
  const py::gil_scoped_release release;
  return work();
}

}  // namespace stribeck::python
