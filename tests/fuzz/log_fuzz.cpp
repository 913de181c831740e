/// libFuzzer target of the log readers: whatever the bytes, a log whose values are finite or an InputError that
/// names the file. The first byte chooses what the caller gives; the samples of all formats are the start.
/// Run by tools/fuzz.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/log/log.hpp>
#include <stribeck/io/log/test_logs.hpp>
#include <string>
#include <string_view>

namespace io = stribeck::io;

namespace {

constexpr std::uint8_t kNames = 1;
constexpr std::uint8_t kSampleTime = 2;
constexpr std::uint8_t kTable = 4;

void demand(bool good, const char* what) {
  if (good) return;
  std::fprintf(stderr, "log_fuzz: %s\n", what);
  std::abort();
}

void check(const io::Log& log) {
  demand(log.rows >= 2, "fewer than two rows");
  demand(!log.columns.empty(), "no columns");
  for (const auto& c : log.columns) {
    const std::size_t n = c.texts.empty() ? c.values.size() : c.texts.size();
    demand(n > 0 && n <= log.rows, "a column of wrong length");
    for (const double x : c.values) demand(std::isfinite(x), "a value that is not finite");
    if (c.time < 0) continue;
    demand(static_cast<std::size_t>(c.time) < log.columns.size(), "a time column that is not there");
    demand(log.columns[static_cast<std::size_t>(c.time)].values.size() == n, "a time of another length");
  }
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* /*argc*/, char*** /*argv*/) {
  const char* folder = std::getenv("STRIBECK_FUZZ_SAMPLES");
  if (folder == nullptr) return 0;
  io::make_directory(folder);
  int i = 0;
  for (const auto& sample : io::test::sample_logs()) {
    std::string bytes(1, static_cast<char>((sample.names.empty() ? 0 : kNames) |
                                           (sample.sample_time > 0.0 ? kSampleTime : 0)));
    io::write_atomically(std::string(folder) + "/sample-" + std::to_string(i++), bytes + sample.text);
  }
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::uint8_t mode = data[0];
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  try {
    if ((mode & kTable) != 0) {
      check(io::parse_csv(bytes, "fuzz.log", {}));
      return 0;
    }
    io::ReadOptions options;
    if ((mode & kNames) != 0) options.names = {"x mm", "f N", "in-position"};
    if ((mode & kSampleTime) != 0) options.sample_time = 1e-3;
    check(io::parse_log(bytes, "fuzz.log", options));
  } catch (const io::InputError& e) {
    demand(std::string_view(e.what()).find("fuzz.log") != std::string_view::npos,
           "a refusal without the file");
  }
  return 0;
}
