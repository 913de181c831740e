#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <condition_variable>
#include <cstdio>
#include <filesystem>
#include <mutex>
#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/sha256.hpp>
#include <stribeck/workflow/study/shared_runs.hpp>
#include <system_error>
#include <utility>
#include <vector>

namespace stribeck::workflow {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kBlocks = 256;  // of a study, at least where it has so many runs
constexpr std::uint64_t kLargest = 64;  // runs of a block
constexpr const char* kPrefix = "shared-";
constexpr const char* kAlive = "alive-";

/// Computer, process, and when: a process of the same number was there before.
std::string new_owner() {
  static std::atomic<int> number{0};
  const auto now = std::chrono::system_clock::now().time_since_epoch().count();
  std::array<char, 256> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0) name[0] = '\0';
  std::string host(name.data());
  std::replace_if(
      host.begin(), host.end(), [](char c) { return c == '/' || c == ' ' || c == '\n'; }, '-');
  return fmt::format("{}-{}-{:x}", host.empty() ? "host" : host, ::getpid(),
                     static_cast<std::uint64_t>(now) + static_cast<std::uint64_t>(number++));
}

/// Absent: the file is not there, or was taken away meanwhile.
std::optional<std::string> text_if_there(const std::string& path) {
  if (::access(path.c_str(), R_OK) != 0) return std::nullopt;
  try {
    return io::read_text(path);
  } catch (const io::InputError&) {
    return std::nullopt;
  }
}

[[noreturn]] void cannot_write(const std::string& path, int code) {
  throw io::InputError(io::Problem{
      path, 0, {}, "cannot be written: " + std::generic_category().message(code == 0 ? EIO : code)});
}

/// Zero, or what went wrong.
int write_new(const std::string& path, int flags, std::string_view text) {
  const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | flags, 0666);
  if (fd < 0) return errno;
  int code = 0;
  while (code == 0 && !text.empty()) {
    const ssize_t n = ::write(fd, text.data(), text.size());
    if (n < 0 && errno != EINTR) code = errno;
    if (n > 0) text.remove_prefix(static_cast<std::size_t>(n));
  }
  if (::close(fd) != 0 && code == 0) code = errno;
  return code;
}

/// At once, and now: a command keeps the files that io writes until its end. Zero, or what went wrong.
int replace(const std::string& path, const std::string& owner, const std::string& text) {
  const std::string fresh = path + '~' + owner;
  int code = write_new(fresh, O_TRUNC, text);
  if (code == 0 && std::rename(fresh.c_str(), path.c_str()) != 0) code = errno;
  if (code != 0) ::unlink(fresh.c_str());
  return code;
}

std::optional<std::uint64_t> number_in(std::string_view text) {
  std::uint64_t n = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), n);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return n;
}

/// Blocks of which there is a file of this kind; empty where the folder is gone.
std::vector<std::uint64_t> blocks_with(const std::string& folder, std::string_view kind) {
  std::vector<std::uint64_t> out;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    const std::string name = at->path().filename().string();
    if (!name.ends_with(kind)) continue;
    if (const auto n = number_in(std::string_view(name).substr(0, name.size() - kind.size())))
      out.push_back(*n);
  }
  std::sort(out.begin(), out.end());
  return out;
}

bool among(const std::vector<std::uint64_t>& sorted, std::uint64_t n) {
  return std::binary_search(sorted.begin(), sorted.end(), n);
}

}  // namespace

SharedRuns::SharedRuns(const std::string& folder, const std::string& inputs, std::uint64_t runs, Note note,
                       Pace pace)
    : parent_(folder),
      folder_(
          fmt::format("{}/{}{}", folder, kPrefix,
                      io::hexadecimal(io::sha256(fmt::format("{} runs\n{}", runs, inputs))).substr(0, 16))),
      owner_(new_owner()),
      runs_(runs),
      size_(std::clamp<std::uint64_t>(runs / kBlocks, 1, kLargest)),
      note_(std::move(note)),
      pace_(pace),
      counting_([this](const std::stop_token& stop) { count(stop); }) {}

SharedRuns::~SharedRuns() {
  counting_.request_stop();
  counting_.join();
  std::error_code ignored;
  for (const std::uint64_t block : claimed_) fs::remove(file(block, ".claim"), ignored);
  fs::remove(folder_ + '/' + kAlive + owner_, ignored);
}

std::uint64_t SharedRuns::end_of(std::uint64_t block) const noexcept {
  return std::min(runs_, (block + 1) * size_);
}

std::string SharedRuns::file(std::uint64_t block, const char* kind) const {
  return fmt::format("{}/{}{}", folder_, block, kind);
}

std::optional<std::uint64_t> SharedRuns::first() const {
  const auto text = text_if_there(folder_ + "/first");
  return text ? number_in(*text) : std::nullopt;
}

bool SharedRuns::open() const { return first().has_value(); }

std::vector<std::string> SharedRuns::other_folders() const {
  std::vector<std::string> out;
  std::error_code error;
  for (fs::directory_iterator at(parent_, error), end; !error && at != end; at.increment(error)) {
    if (at->path().filename().string().starts_with(kPrefix) &&
        at->path().filename() != fs::path(folder_).filename())
      out.push_back(at->path().string());
  }
  return out;
}

bool SharedRuns::others() {
  bool any = false;
  for (const std::string& folder : other_folders()) {
    std::error_code error;
    for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
      const std::string path = at->path().string();
      if (!at->path().filename().string().starts_with(kAlive)) continue;
      const std::string text = text_if_there(path).value_or("");
      const auto [known, fresh] = counts_.try_emplace(path, Count{text, std::chrono::steady_clock::now()});
      any = any || (!fresh && known->second.text != text);
    }
  }
  return any;
}

void SharedRuns::clear_others() const {
  std::error_code ignored;
  for (const std::string& folder : other_folders()) fs::remove_all(folder, ignored);
}

void SharedRuns::share_from(std::uint64_t block) {
  io::make_directory(folder_);
  if (const int code = replace(folder_ + "/first", owner_, std::to_string(block)); code != 0)
    cannot_write(folder_ + "/first", code);
  std::error_code ignored;
  for (const char* kind : {".rows", ".claim"}) {
    for (const std::uint64_t done : blocks_with(folder_, kind)) {
      if (done < block) fs::remove(file(done, kind), ignored);
    }
  }
}

void SharedRuns::close() {
  // Others may write a last count into it meanwhile.
  constexpr int kTries = 50;
  std::error_code ignored;
  for (int k = 0; k < kTries && fs::exists(folder_, ignored); ++k) {
    fs::remove_all(folder_, ignored);
    if (fs::exists(folder_, ignored)) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

std::optional<std::uint64_t> SharedRuns::claim() {
  free_those_of_the_dead();
  const auto from = first();
  if (!from) return std::nullopt;
  const std::vector<std::uint64_t> taken = blocks_with(folder_, ".claim"),
                                   done = blocks_with(folder_, ".rows");
  for (std::uint64_t b = *from; begin_of(b) < runs_; ++b) {
    if (among(taken, b) || among(done, b) || !create(b)) continue;
    // It may have been finished and taken over while the folder was read.
    const auto now = first();
    if (now && *now <= b && ::access(file(b, ".rows").c_str(), F_OK) != 0) {
      claimed_.push_back(b);
      return b;
    }
    std::error_code ignored;
    fs::remove(file(b, ".claim"), ignored);
    if (!now) return std::nullopt;
  }
  return std::nullopt;
}

bool SharedRuns::create(std::uint64_t block) const {
  const std::string path = file(block, ".claim");
  const int code = write_new(path, O_EXCL, owner_);
  if (code == EEXIST || code == ENOENT) return false;  // another one has it, or the leader has ended
  if (code == 0) return true;
  ::unlink(path.c_str());
  cannot_write(path, code);
}

void SharedRuns::finish(std::uint64_t block, const std::string& rows) {
  // Where the folder is gone, the leader has ended: somebody else has finished the block.
  const int code = open() ? replace(file(block, ".rows"), owner_, rows) : 0;
  if (code != 0 && open()) cannot_write(file(block, ".rows"), code);
  std::erase(claimed_, block);
}

std::optional<std::string> SharedRuns::rows(std::uint64_t block) const {
  return text_if_there(file(block, ".rows"));
}

void SharedRuns::discard(std::uint64_t block) const {
  std::error_code ignored;
  fs::remove(file(block, ".rows"), ignored);
  fs::remove(file(block, ".claim"), ignored);
}

bool SharedRuns::dead(const std::string& owner) {
  const auto now = std::chrono::steady_clock::now();
  const std::string text = text_if_there(folder_ + '/' + kAlive + owner).value_or("");
  const auto [known, fresh] = counts_.try_emplace(owner, Count{text, now});
  if (!fresh && known->second.text != text) known->second = {text, now};
  return now - known->second.since > pace_.patience;
}

void SharedRuns::free_those_of_the_dead() {
  for (const std::uint64_t b : blocks_with(folder_, ".claim")) {
    const auto owner = text_if_there(file(b, ".claim"));
    if (!owner || *owner == owner_ || ::access(file(b, ".rows").c_str(), F_OK) == 0 || !dead(*owner))
      continue;
    std::error_code ignored;
    if (!fs::remove(file(b, ".claim"), ignored)) continue;
    fs::remove(folder_ + '/' + kAlive + *owner, ignored);
    if (note_)
      note_(fmt::format("process {} does not answer any more: runs {} to {} are computed again", *owner,
                        begin_of(b), end_of(b) - 1));
  }
}

void SharedRuns::count(const std::stop_token& stop) {
  std::mutex mutex;
  std::condition_variable_any wake;
  std::unique_lock lock(mutex);
  for (std::uint64_t n = 0; !stop.stop_requested(); ++n) {
    // The folder comes and goes with the leader.
    static_cast<void>(write_new(folder_ + '/' + kAlive + owner_, O_TRUNC, std::to_string(n)));
    wake.wait_for(lock, stop, pace_.beat, [] { return false; });
  }
}

}  // namespace stribeck::workflow
