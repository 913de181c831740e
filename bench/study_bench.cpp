/// A study as a user types it: the biaxial table under controller (f), one revolution at 9.5 mm/s, six factors drawn at random, rows
/// streamed to a file, summary. Number of runs and of threads vary; the memory of the process must not grow with the runs.

#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <apps/cli/commands.hpp>
#include <array>
#include <filesystem>
#include <fstream>
#include <string>

namespace {

namespace fs = std::filesystem;

constexpr const char* kFactors = R"toml(
[motion]
laps = 1
speeds = ["9.5 mm/s"]
[[factors]]
key = "x.friction"
scale = { kind = "uniform", low = 0.7, high = 1.3 }
[[factors]]
key = "y.friction"
scale = { kind = "uniform", low = 0.7, high = 1.3 }
[[factors]]
key = "*.friction.stiffness"
scale = { kind = "log-normal", median = 1.0, sigma = 0.25, low = 0.5, high = 2.0 }
[[factors]]
key = "*.mass"
scale = { kind = "normal", mean = 1.0, sd = 0.08, low = 0.8, high = 1.2 }
[[factors]]
key = "*.delay_periods"
value = { kind = "list", values = ["0", "1"] }
[[factors]]
key = "*.noise.rms"
value = { kind = "uniform", low = "5 N", high = "40 N" }
)toml";

void Study(benchmark::State& state) {
  const fs::path folder = fs::temp_directory_path() / "stribeck-study-bench";
  const std::string file = (folder / "study.toml").string();
  const std::string out = (folder / "out").string();
  const std::string threads = std::to_string(state.range(1));
  const std::array<const char*, 8> argv{"stribeck",  "study",     file.c_str(),    "-o",
                                        out.c_str(), "--threads", threads.c_str(), "--quiet"};
  for (auto _ : state) {
    state.PauseTiming();
    fs::remove_all(folder);
    fs::create_directories(folder);
    std::ofstream(file) << "machine = \"" << fs::absolute("machines/biaxial-table.toml").string()
                        << "\"\ncontrollers = [\"f\"]\nsampling = \"random\"\nsamples = " << state.range(0)
                        << '\n'
                        << kFactors;
    state.ResumeTiming();
    if (stribeck::cli::run(static_cast<int>(argv.size()), argv.data()) != 0)
      state.SkipWithError("run it from the repository's folder");
  }
  fs::remove_all(folder);
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  state.counters["runs_per_s"] = benchmark::Counter(static_cast<double>(state.range(0) * state.iterations()),
                                                    benchmark::Counter::kIsRate);
  state.counters["peak_MB"] = static_cast<double>(used.ru_maxrss) / 1024.0;
}
BENCHMARK(Study)
    ->ArgNames({"runs", "threads"})
    ->Args({1000, 1})
    ->Args({1000, 2})
    ->Args({10000, 2})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(1);

}  // namespace
