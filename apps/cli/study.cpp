#include <fmt/format.h>
#include <sched.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>

#include <apps/cli/commands.hpp>
#include <apps/cli/expected.hpp>
#include <apps/cli/shared.hpp>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <stribeck/io/file.hpp>
#include <stribeck/io/printable.hpp>
#include <stribeck/report/study/study_report.hpp>
#include <stribeck/workflow/study/study.hpp>
#include <thread>

namespace stribeck::cli {
namespace {

struct StudyCommand {
  Common common;
  std::string file;
  std::string out;
  std::string netcdf;
  unsigned threads = 0;
  bool shared = false;
};

/// What mpirun (Open MPI, MPICH) and srun (Slurm) tell a process that they started; 0 where they did not.
unsigned from_launcher(std::initializer_list<const char*> names) {
  for (const char* name : names) {
    const char* text = std::getenv(name);
    unsigned n = 0;
    if (text != nullptr && std::from_chars(text, text + std::strlen(text), n).ec == std::errc()) return n;
  }
  return 0;
}

/// Cores for one of the processes that a launcher started on this computer: those that it bound the process to, or its part of all.
unsigned threads_of_launched() {
  const unsigned all = std::max(1U, std::thread::hardware_concurrency());
  cpu_set_t own;
  CPU_ZERO(&own);
  if (sched_getaffinity(0, sizeof own, &own) == 0 && CPU_COUNT(&own) > 0 &&
      static_cast<unsigned>(CPU_COUNT(&own)) < all)
    return static_cast<unsigned>(CPU_COUNT(&own));
  const unsigned beside = from_launcher({"OMPI_COMM_WORLD_LOCAL_SIZE", "MPI_LOCALNRANKS"});
  return std::max(1U, all / std::max(1U, beside));
}

int study(const StudyCommand& o) {
  const Study study = read_study(o.file);
  check_distinct(study.inputs,
                 {o.out + "/results.csv", o.out + "/inputs.txt", o.netcdf, page_of(o.common), o.common.json});
  const OutputFolder folder(o.out);
  const bool shared =
      o.shared || from_launcher({"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"}) > 1;
  // Of several processes only the one that gets the result makes folders for it: another would take them away at its end.
  std::optional<OutputFolder> page_folder;
  if (!shared) page_folder.emplace(check_outputs(o.common));
  io::check_writable(o.netcdf);
  StudyOptions options{o.out, o.threads, STRIBECK_VERSION};
  options.rank = from_launcher({"OMPI_COMM_WORLD_RANK", "PMI_RANK", "SLURM_PROCID"});
  if (shared && options.threads == 0) options.threads = threads_of_launched();
  report::StudyResult result;
  {
    Progress progress("study", o.common.quiet);
    options.progress = [&](std::uint64_t done, std::uint64_t all) {
      progress(static_cast<std::size_t>(done), static_cast<std::size_t>(all));
    };
    if (shared) {
      const auto ours = run_shared_study(study, options, [](const std::string& text) {
        fmt::print(stderr, "stribeck: {}\n", io::printable(text));
      });
      if (!ours) return 0;  // another process tells the result
      result = *ours;
    } else {
      result = run_study(study, options);
    }
  }
  if (!page_folder) page_folder.emplace(check_outputs(o.common));
  if (!o.netcdf.empty()) write_netcdf(study, o.out, o.netcdf, STRIBECK_VERSION);
  const report::Made made = made_from(study.inputs);
  write_json(o.common.json, report::to_json(result), made);
  report::write_study_report(folders_of(o.common), {result, made.command, made.version, made.inputs});
  say(o.common, report::text_table(result));
  say(o.common, "Compensators: " + result.parameters + ".\nRows: " + o.out + "/results.csv.\n");
  return 0;
}

}  // namespace

void add_study(CLI::App& app, Action& action) {
  auto* verb = app.add_subcommand(
      "study", "Run controllers on many machines that differ as a file says, and tell how the errors spread");
  auto o = std::make_shared<StudyCommand>();
  verb->add_option("study", o->file, "Study file")->required()->type_name("STUDY.toml");
  verb->add_option(
          "-o,--output", o->out,
          "Folder of the results: results.csv grows run by run; with the same folder, a study that was "
          "stopped goes on")
      ->required()
      ->type_name("DIR");
  verb->add_option("--netcdf", o->netcdf,
                   "Write the rows as a netCDF-4 file too, with units, for Python, MATLAB, Octave and R")
      ->type_name("FILE.nc");
  verb->add_option("--threads", o->threads,
                   "Number of threads; 0: all cores. The result does not depend on it")
      ->check(whole_from(0, 4096))
      ->capture_default_str();
  verb->add_flag(
      "--shared", o->shared,
      "Share the runs with other processes that were started with the same study and folder, here or on computers "
      "that have the folder too; mpirun and srun turn it on");
  add_common(*verb, o->common);
  refuse_empty_options(*verb);
  verb->footer("Example:\n  stribeck study examples/study/friction.toml -o friction --report friction");
  verb->callback([o, &action] { action = [o] { return study(*o); }; });
}

}  // namespace stribeck::cli
