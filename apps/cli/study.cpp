#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <apps/cli/commands.hpp>
#include <apps/cli/expected.hpp>
#include <apps/cli/shared.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/report/study/study_report.hpp>
#include <stribeck/workflow/study/study.hpp>

namespace stribeck::cli {
namespace {

struct StudyCommand {
  Common common;
  std::string file;
  std::string out;
  std::string netcdf;
  unsigned threads = 0;
};

int study(const StudyCommand& o) {
  const Study study = read_study(o.file);
  check_distinct(study.inputs,
                 {o.out + "/results.csv", o.out + "/inputs.txt", o.netcdf, page_of(o.common), o.common.json});
  const OutputFolder folder(o.out);
  const OutputFolder page_folder = check_outputs(o.common);
  io::check_writable(o.netcdf);
  StudyOptions options{o.out, o.threads, STRIBECK_VERSION};
  report::StudyResult result;
  {
    Progress progress("study", o.common.quiet);
    result = run_study(study, options, [&](std::uint64_t done, std::uint64_t all) {
      progress(static_cast<std::size_t>(done), static_cast<std::size_t>(all));
    });
  }
  if (!o.netcdf.empty()) write_netcdf(study, o.out, o.netcdf, STRIBECK_VERSION);
  write_json(o.common.json, report::to_json(result), made_from(study.inputs));
  report::write_study_report(folders_of(o.common), {result, typed_command(), STRIBECK_VERSION});
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
  add_common(*verb, o->common);
  refuse_empty_options(*verb);
  verb->footer("Example:\n  stribeck study examples/study/friction.toml -o friction --report friction");
  verb->callback([o, &action] { action = [o] { return study(*o); }; });
}

}  // namespace stribeck::cli
