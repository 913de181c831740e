#include <fmt/format.h>
#include <pybind11/pybind11.h>
#include <nlohmann/json.hpp>

#include <python/parts.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/log/log.hpp>
#include <stribeck/report/study/study_report.hpp>
#include <stribeck/workflow/study/study.hpp>

namespace stribeck::python {
namespace {

Outcome study(const py::object& file, const py::object& folder, const py::kwargs& given) {
  Keywords keywords("study", given);
  workflow::StudyOptions o{path_of(folder), 0, STRIBECK_VERSION};
  o.threads = threads_of(keywords);
  const std::string netcdf = keywords.path("netcdf");
  keywords.done();
  const std::string path = path_of(file);
  return unlocked([&] {
    const workflow::Study what = workflow::read_study(path);
    io::make_directory(o.folder);
    io::check_writable(netcdf);
    workflow::StudyOptions with_progress = o;
    with_progress.progress = interruptible();
    const report::StudyResult result = workflow::run_study(what, with_progress);
    if (!netcdf.empty()) workflow::write_netcdf(what, o.folder, netcdf, STRIBECK_VERSION);
    return Outcome{report::to_json(result), report::text_table(result), std::nullopt, true};
  });
}

}  // namespace

void add_study(py::module_& module) {
  module.def(
      "study", &study, py::arg("file"), py::arg("folder"),
      "study(file, folder, *, threads=0, netcdf=None)\n--\n\n"
      "Runs controllers on many machines that differ as a study file says.\n\n"
      "folder: of the results; folder/results.csv grows run by run, and the same call goes on where one was stopped. netcdf: "
      "name of a netCDF-4 file of all rows.\n"
      "Returns a Result with the quantiles and indices; read_table(folder + \"/results.csv\") gives the rows as arrays. Ctrl-C ends "
      "it after the present run.\n"
      "Raises InputError for files and arguments.");
  module.def(
      "read_table",
      [](const py::object& path) {
        const std::string file = path_of(path);
        io::ReadOptions options;
        options.times_needed = false;
        return unlocked([&] { return io::read_log(file, options); });
      },
      py::arg("path"),
      "read_table(path)\n--\n\n"
      "Reads a table without times, such as the results.csv of a study: a Log, table[\"column\"] an array in SI, a list of str for a "
      "column of text. A figure of one axis (NAME_um.x) stays in the unit of its name. Raises InputError with file, line and column.");
}

}  // namespace stribeck::python
