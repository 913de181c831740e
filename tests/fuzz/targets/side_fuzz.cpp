// Side files and map files, with the log beside them: text before the first NUL is the TOML, the rest the log.
#include <unistd.h>

#include <filesystem>
#include <stribeck/io/log/test_logs.hpp>
#include <stribeck/workflow/log/log_options.hpp>
#include <tests/fuzz/targets/log_checks.hpp>

namespace stribeck::fuzz {
namespace {

/// In memory where the system has such a folder.
const std::string& folder() {
  static const std::string name = [] {
    std::string path =
        (std::filesystem::is_directory("/dev/shm") ? "/dev/shm"
                                                   : std::filesystem::temp_directory_path().string()) +
        "/stribeck-fuzz-XXXXXX";
    demand(mkdtemp(path.data()) != nullptr, "no folder");
    return path;
  }();
  return name;
}

struct Cleaner {
  Cleaner() { static_cast<void>(folder()); }  // made first, so that it is there at the end
  ~Cleaner() {
    if (owner == getpid()) std::filesystem::remove_all(folder());
  }
  pid_t owner = getpid();
};

}  // namespace

std::vector<std::string> seeds() {
  const std::string log = io::test::halsampler_sample();
  const std::string zero(1, '\0');
  return {
      zero + "columns = [\"x mm\", \"y mm\", \"f N\", \"in\"]\nsample_time = \"1 ms\"\n" + zero + log,
      zero + file_of("hal/examples/biaxial/run.log.toml") + zero + log,
      "\1axis = \"x\"\nmap = [\"r=x-cmd mm\", \"x=x-fb mm\", \"force=x-force N\"]\ngain = \"3 N/V\"\nlead = \"5 mm\"\nwhere = [\"line=7\"]\nruns = [\"line\"]\nsample_time = \"1 ms\"\nkeep = [\"gap\"]\n" +
          zero + "t [s],x [mm],force [N]\n0,0,1\n0.001,1,2\n0.002,2,3\n"};
}

std::vector<std::string> words() {
  return {"columns", "sample_time", "period", "axis",     "map",      "gain",   "lead",
          "where",   "runs",        "keep",   "\"x mm\"", "\"1 ms\"", "[\"\"]", " = "};
}

void one(std::string_view input) {
  static const Cleaner cleaner;
  const std::uint8_t mode = mode_of(input);
  const std::size_t zero = std::min(input.find('\0'), input.size());
  const std::string log = folder() + "/fuzz-" + std::to_string(getpid()) + ".log";
  std::ofstream(log, std::ios::binary) << input.substr(std::min(zero + 1, input.size()));
  std::ofstream(log + ".toml", std::ios::binary) << input.substr(0, zero);
  try {
    if (mode % 2 == 0) {
      check(io::read_log(log));
    } else {
      const workflow::LogOptions options = workflow::with_map_file({}, log + ".toml");
      std::filesystem::remove(log + ".toml");
      check(workflow::read_log(log, options));
    }
  } catch (const io::InputError& e) {
    check(e);
  }
  std::error_code ignored;
  std::filesystem::remove(log, ignored);
  std::filesystem::remove(log + ".toml", ignored);
}

}  // namespace stribeck::fuzz
