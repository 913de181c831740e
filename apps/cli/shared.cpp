#include <fmt/format.h>
#include <unistd.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include <apps/cli/commands.hpp>
#include <apps/cli/expected.hpp>
#include <apps/cli/shared.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/json.hpp>
#include <stribeck/io/printable.hpp>
#include <stribeck/io/sha256.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/io/units.hpp>

namespace stribeck::cli {

void add_common(CLI::App& verb, Common& common, Page page) {
  verb.add_option("--json", common.json,
                  "Write the result as JSON to this file; -: to standard output, without the tables")
      ->type_name("FILE");
  if (page == Page::kReport) {
    verb.add_option("--report", common.report, "Write a self-contained HTML page, DIR/index.html")
        ->type_name("DIR");
    verb.add_option(
            "--plots", common.plots,
            "Write every figure of the page as SVG, PDF, PNG and CSV, and every table as Markdown, CSV and LaTeX")
        ->type_name("DIR");
  }
  verb.add_flag("--quiet", common.quiet, "Print nothing but errors");
}

void add_trials(CLI::App& verb, std::uint32_t& trials, unsigned& threads) {
  verb.add_option("--trials", trials, "Number of trials, each with different noise")
      ->check(whole_from(1, 100000))
      ->capture_default_str();
  verb.add_option("--threads", threads, "Number of threads; 0: all cores. The result does not depend on it")
      ->check(whole_from(0, 4096))
      ->capture_default_str();
}

void add_seed(CLI::App& verb, std::uint64_t& seed) {
  verb.add_option("--seed", seed, "Seed of the noise")
      ->check(whole_from(0, std::numeric_limits<std::uint64_t>::max()))
      ->capture_default_str();
}

Progress::Progress(std::string what, bool quiet)
    : what_(std::move(what)),
      enabled_(!quiet),
      terminal_(isatty(STDERR_FILENO) == 1),
      begin_(std::chrono::steady_clock::now()),
      last_(begin_) {}

Progress::~Progress() {
  if (drawn_) fmt::print(stderr, "\r\033[K");
}

void Progress::operator()(std::size_t done, std::size_t all) {
  if (!enabled_) return;
  const auto now = std::chrono::steady_clock::now();
  using std::chrono::milliseconds;
  if (!terminal_) {
    if (now - last_ < std::chrono::seconds(30)) return;
    last_ = now;
    fmt::print(stderr, "{}: {} of {} done\n", io::printable(what_), done, all);
    return;
  }
  if (now - begin_ < milliseconds(1000) || now - last_ < milliseconds(100)) return;
  last_ = now;
  drawn_ = true;
  constexpr std::size_t kWidth = 30;
  const std::size_t filled = all > 0 ? kWidth * done / all : 0;
  fmt::print(stderr, "\r{} [{}{}] {}/{}", io::printable(what_), std::string(filled, '#'),
             std::string(kWidth - filled, '.'), done, all);
  std::fflush(stderr);
}

void Progress::operator()(std::string_view what, std::size_t done, std::size_t all) {
  // What stood there may be longer.
  if (drawn_ && what != what_) fmt::print(stderr, "\r\033[K");
  what_ = what;
  (*this)(done, all);
}

Working::Working(std::string what, bool quiet)
    : what_(std::move(what)), terminal_(isatty(STDERR_FILENO) == 1) {
  if (!quiet) ticker_ = std::thread([this] { tick(); });
}

Working::~Working() {
  {
    const std::lock_guard lock(mutex_);
    done_ = true;
  }
  ended_.notify_all();
  if (ticker_.joinable()) ticker_.join();
  if (drawn_) fmt::print(stderr, "\r\033[K");
}

void Working::tick() {
  const std::chrono::seconds every(terminal_ ? 1 : 30), quiet(terminal_ ? 2 : 30);
  std::chrono::seconds passed(0);
  std::unique_lock lock(mutex_);
  while (!ended_.wait_for(lock, every, [this] { return done_; })) {
    passed += every;
    if (passed < quiet) continue;
    drawn_ = terminal_;
    fmt::print(stderr, "{}{}: computing, {} s{}", terminal_ ? "\r" : "", io::printable(what_), passed.count(),
               terminal_ ? "" : "\n");
    std::fflush(stderr);
  }
}

void say(const Common& common, const std::string& text) {
  if (common.quiet || common.json == kStandardOutput) return;
  // Names in a table are as long as a file has them.
  constexpr std::size_t kLongest = 4000;
  const std::string clean = io::printable_lines(text);
  std::string shown;
  for (std::string_view rest = clean; !rest.empty();) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    shown += io::shortened(rest.substr(0, end), kLongest);
    if (end < rest.size()) shown += '\n';
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  // A reader that is gone must not keep files from being written; run() tells.
  static_cast<void>(std::fwrite(shown.data(), 1, shown.size(), stdout));
}

void refuse_empty_options(CLI::App& verb) {
  for (CLI::Option* option : verb.get_options()) {
    if (option->get_expected_min() == 0) continue;  // a flag
    // --json writes there, and --live reads the standard input.
    const bool takes_standard_output = option->check_lname("json") || option->check_lname("live");
    option->check([takes_standard_output](const std::string& text) {
      if (text.find_first_not_of(" \t") == std::string::npos)
        return std::string("got \"\", expected a value (leave the option out to do without)");
      if (text == kStandardOutput && !takes_standard_output)
        return std::string("got \"-\", expected a name (only --json writes to standard output)");
      return std::string();
    });
  }
}

void check_distinct(const std::vector<std::string>& inputs, std::vector<std::string> outputs) {
  std::erase(outputs, kStandardOutput);
  io::check_distinct(inputs, outputs);
}

std::string page_of(const Common& common) {
  return common.report.empty() ? "" : common.report + "/index.html";
}

OutputFolder check_outputs(const Common& common) {
  // The JSON may go to the folder of the report, so that folder is made first.
  OutputFolder page = common.report.empty() ? OutputFolder() : OutputFolder(common.report);
  if (common.json != kStandardOutput) io::check_writable(common.json);
  io::check_writable(page_of(common));
  if (!common.plots.empty()) {
    const OutputFolder plots(common.plots);  // is removed again until there is something to write
    io::check_writable(common.plots + "/figure-01.svg");
  }
  return page;
}

report::PageFolders folders_of(const Common& common) { return {common.report, common.plots}; }

report::Made made_from(const std::vector<std::string>& inputs) {
  report::Made made{typed_command(), STRIBECK_VERSION, {}};
  std::error_code ignored;
  for (const std::string& file : inputs) {
    if (!file.empty() && std::filesystem::is_regular_file(file, ignored))
      made.inputs.push_back({file, io::sha256_of_file(file)});
  }
  return made;
}

void write_json(const std::string& path, nlohmann::ordered_json json, const report::Made& made) {
  if (json.is_array()) {
    for (auto& one : json) one["made"] = report::to_json(made);
  } else {
    json["made"] = report::to_json(made);
  }
  write_json(path, json);
}

void write_json(const std::string& path, const nlohmann::ordered_json& json) {
  if (path == kStandardOutput) {
    fmt::print("{}", io::dump(json));
  } else if (!path.empty()) {
    io::write_atomically(path, io::dump(json));
  }
}

}  // namespace stribeck::cli
