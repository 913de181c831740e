#pragma once
/// A study: many machines that differ from the identified one as a file says, each under the same controllers on the same motions.
///
///   run of a design           its number is that of the sample
///   run with Sobol' indices   sample n takes runs n·(k + 2) …: A, B, then A with factor 1 … k from B
///   run of a grid             the last factor changes first
///
/// Noise depends on the seed and the sample: it is the same for all controllers, and for all runs of one sample. Controllers are built
/// once, from the nominal machine and its identification.
/// Rows go to the disk run by run (results_file.hpp), and the summary is made of them. Memory does not grow with the number of runs.
/// Same file, same bytes, on any number of threads, killed or not.
/// Real time: no. Errors: InputError; sim::Refused of controllers.

#include <functional>
#include <optional>
#include <stribeck/report/study/study_report.hpp>
#include <stribeck/sim/compare.hpp>
#include <stribeck/workflow/parameters.hpp>
#include <stribeck/workflow/study/factors.hpp>
#include <stribeck/workflow/study/shared_runs.hpp>
#include <stribeck/workflow/study/study_file.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

/// A figure of merit as a column of the results.
struct StudyColumn {
  std::string key;
  const sim::Figure* figure = nullptr;
  std::size_t axis = 0;  ///< of the path, where the figure has one value for each

  [[nodiscard]] double of(const sim::Metrics& metrics) const;  ///< in the unit of the key
};

/// A study as its file says it, checked.
struct Study {
  std::string source;  ///< its file
  StudyFile file;
  std::string machine_file;
  sim::Machine machine;
  sim::CompareSpec spec;
  std::vector<std::size_t> axes;  ///< of the machine that move
  ParameterOptions parameters;
  std::vector<BoundFactor> factors;
  std::vector<StudyColumn> columns;
  std::uint64_t samples = 0;
  std::uint64_t runs = 0;
  std::vector<std::string> inputs;  ///< files that it reads
  std::string path_checksum;        ///< SHA-256 of the file that has the path; "" where none has

  /// Runs of one sample.
  [[nodiscard]] std::uint64_t runs_per_sample() const { return file.indices ? factors.size() + 2 : 1; }
  /// Values of the factors in a run, in SI.
  [[nodiscard]] std::vector<double> values(const sim::Design& design, std::uint64_t run) const;
  [[nodiscard]] sim::Design design() const;
};

Study read_study(const std::string& file);

/// Refuses draws from run `from` on that no machine file may hold, before hours of runs.
void check_machines(const Study& study, const sim::Design& design, std::uint64_t from, unsigned threads);

struct StudyOptions {
  std::string folder;
  unsigned threads = 0;
  std::string version;
  unsigned rank = 0;  ///< of several processes; where nothing is left to do, 0 gets the result
  std::function<void(std::uint64_t, std::uint64_t)> progress{};  ///< done, all; on one thread at a time
};

/// Runs what is not in the folder yet, and sums up.
report::StudyResult run_study(const Study& study, const StudyOptions& options);

/// The same by several processes that call it with the same study and folder (shared_runs.hpp). One of them leads and gets the result;
/// another one takes its place if it dies. Absent: this process helped until nothing was left. One of rank 0 that begins when the others
/// have ended gets the result, too.
std::optional<report::StudyResult> run_shared_study(const Study& study, const StudyOptions& options,
                                                    const SharedRuns::Note& note, SharedRuns::Pace pace = {});

/// The rows of a finished study as a netCDF-4 file: factors over `run`, figures over `run` and `case` (controller and motion), with units.
void write_netcdf(const Study& study, const std::string& folder, const std::string& path,
                  const std::string& version);

}  // namespace stribeck::workflow
