/// The main job as a user types it, on all cores: both axes identified from logs recorded here, 120 runs (57
/// simulated minutes), JSON and report written.

#include <benchmark/benchmark.h>

#include <apps/cli/commands.hpp>
#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace {

void CompareWithReport(benchmark::State& state) {
  const std::string folder = (std::filesystem::temp_directory_path() / "stribeck-compare-bench").string();
  const std::string json = folder + "/compare.json";
  const std::array<const char*, 9> argv{"stribeck",     "compare",  "machines/biaxial-table.toml",
                                        "--experiment", "bi-table", "--json",
                                        json.c_str(),   "--report", folder.c_str()};
  std::vector<const char*> all(argv.begin(), argv.end());
  all.push_back("--quiet");
  for (auto _ : state) {
    if (stribeck::cli::run(static_cast<int>(all.size()), all.data()) != 0)
      state.SkipWithError("run it from the repository's folder");
  }
}
BENCHMARK(CompareWithReport)->Unit(benchmark::kMillisecond)->UseRealTime()->Iterations(3);

}  // namespace
