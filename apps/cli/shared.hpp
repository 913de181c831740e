#pragma once
/// Options and services that every verb has.
/// Real time: no. Errors: InputError with the option as its place.

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <stribeck/io/output_folder.hpp>
#include <stribeck/report/page/output.hpp>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

namespace CLI {
class App;
}

namespace stribeck::workflow {}

namespace stribeck::cli {

using io::OutputFolder;
using namespace workflow;  // a verb reads its options and hands them to the workflow

struct Common {
  std::string json;    ///< file for programs, or kStandardOutput; empty: none
  std::string report;  ///< directory of the HTML page; empty: none
  std::string plots;   ///< directory of its figures and tables as files; empty: none
  bool quiet = false;
};
/// Whether a verb writes a page.
enum class Page { kNone, kReport };
void add_common(CLI::App& verb, Common& common, Page page = Page::kReport);

/// --seed, for verbs with noise.
void add_seed(CLI::App& verb, std::uint64_t& seed);

/// --trials and --threads, for verbs that repeat an experiment.
void add_trials(CLI::App& verb, std::uint32_t& trials, unsigned& threads);

/// How far work has come, on stderr: a bar for work that takes longer than a second, and a line every half a minute where stderr is no
/// terminal.
class Progress {
 public:
  Progress(std::string what, bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void operator()(std::size_t done, std::size_t all);
  /// The same of another part of the work.
  void operator()(std::string_view what, std::size_t done, std::size_t all);

 private:
  std::string what_;
  bool enabled_;
  bool terminal_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point begin_;
  std::chrono::steady_clock::time_point last_;
};

/// How long a verb has been computing, on stderr, where nobody knows how much is left: the seconds after the first two, and a line every half
/// a minute where stderr is no terminal.
class Working {
 public:
  Working(std::string what, bool quiet);
  ~Working();
  Working(const Working&) = delete;
  Working& operator=(const Working&) = delete;

 private:
  void tick();

  std::string what_;
  bool terminal_;
  bool drawn_ = false;
  bool done_ = false;
  std::mutex mutex_;
  std::condition_variable ended_;
  std::thread ticker_;
};

/// What `work` returns; Working meanwhile.
template <class Work>
auto computing(std::string what, const Common& common, const Work& work) {
  const Working working(std::move(what), common.quiet);
  return work();
}

/// Stands for standard output in place of the name of a JSON file.
inline constexpr std::string_view kStandardOutput = "-";

/// Text on standard output, unless --quiet is given or the JSON goes there.
void say(const Common& common, const std::string& text);

/// Refuses, for every option of the verb, empty texts, which would count as not given, and "-" where no standard output is meant.
void refuse_empty_options(CLI::App& verb);

/// Refuses outputs that are the same file as an input or as each other.
void check_distinct(const std::vector<std::string>& inputs, std::vector<std::string> outputs);

/// The file that --report writes; empty: none.
std::string page_of(const Common& common);

/// Checks the outputs that every verb may have, and makes the folder of its page.
[[nodiscard]] OutputFolder check_outputs(const Common& common);

/// Where the page and its parts go.
report::PageFolders folders_of(const Common& common);

/// The command as typed, the version and the checksums of the files among `inputs`; other words among them, such as names of
/// built-in controllers, are left out.
report::Made made_from(const std::vector<std::string>& inputs);

/// Writes to the file, or to standard output; does nothing for an empty path. With `made` under "made", in every item of a list.
void write_json(const std::string& path, const nlohmann::ordered_json& json);
void write_json(const std::string& path, nlohmann::ordered_json json, const report::Made& made);

}  // namespace stribeck::cli
