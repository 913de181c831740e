#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <iterator>
#include <stribeck/io/error.hpp>
#include <stribeck/io/printable.hpp>
#include <stribeck/workflow/live/live_recording.hpp>
#include <system_error>

namespace stribeck::workflow {
namespace {

namespace fs = std::filesystem;

constexpr int kMostNumber = 9999;

[[noreturn]] void fail_at(const fs::path& file, int error) {
  throw io::InputError({file.string(), 0, {}, "cannot write: " + std::generic_category().message(error)});
}

/// The next free name of the folder, taken by an empty file.
fs::path take_name(const fs::path& folder) {
  for (int n = 1; n <= kMostNumber; ++n) {
    const fs::path file = folder / fmt::format("live-{}.csv", n);
    const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor >= 0) {
      ::close(descriptor);
      return file;
    }
    if (errno != EEXIST) fail_at(file, errno);
  }
  throw io::InputError(
      {folder.string(), 0, {}, "has 9999 recordings, live-1.csv to live-9999.csv (move them away)"});
}

}  // namespace

LiveRecording::LiveRecording(const fs::path& folder, const std::vector<std::string>& headers,
                             const std::vector<std::pair<std::string, std::string>>& metadata,
                             std::uint64_t most_bytes)
    : folder_(folder), most_(most_bytes) {
  std::string name = (folder / ".live-XXXXXX").string();
  const int descriptor = ::mkostemp(name.data(), O_CLOEXEC);
  if (descriptor < 0) fail_at(folder, errno);
  hidden_ = name;
  file_.reset(::fdopen(descriptor, "w"));
  if (!file_) {
    const int error = errno;
    ::close(descriptor);
    ::unlink(hidden_.c_str());
    fail_at(folder, error);
  }
  ::fchmod(descriptor, 0644);
  for (const auto& [key, value] : metadata)
    line_ += fmt::format("# {}: {}\n", io::printable(key), io::printable(value));
  line_ += "t [s]";
  for (const std::string& header : headers)
    line_ += header.find_first_of(",\"") == std::string::npos ? "," + header : ",\"" + header + '"';
  line_ += '\n';
  write(line_);
}

LiveRecording::~LiveRecording() {
  if (!hidden_.empty()) ::unlink(hidden_.c_str());
}

void LiveRecording::write(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), file_.get()) != text.size()) {
    why_ = "the disk: " + std::generic_category().message(errno);
    return;
  }
  bytes_ += text.size();
}

bool LiveRecording::row(double t, std::span<const double> values) {
  if (!why_.empty()) return false;
  line_.clear();
  // Ten digits: a picometre of 10 mm, and every digit that halsampler prints of them.
  fmt::format_to(std::back_inserter(line_), "{:.10g}", t);
  for (const double v : values) fmt::format_to(std::back_inserter(line_), ",{:.10g}", v);
  line_ += '\n';
  if (bytes_ + line_.size() > most_) {
    why_ = fmt::format("it has {} MB, the most that is recorded", most_ >> 20);
    return false;
  }
  write(line_);
  if (!why_.empty()) return false;
  ++rows_;
  return true;
}

fs::path LiveRecording::end() {
  errno = 0;
  if (std::fflush(file_.get()) != 0 || ::fsync(::fileno(file_.get())) != 0) {
    const std::string why = std::generic_category().message(errno);
    const fs::path kept = std::exchange(hidden_, {});
    throw io::InputError({kept.string(),
                          0,
                          {},
                          "cannot be completed: " + why + " (what was written stays in this hidden file)"});
  }
  const fs::path file = take_name(folder_);
  if (::rename(hidden_.c_str(), file.c_str()) != 0) {
    const int error = errno;
    ::unlink(file.c_str());
    fail_at(file, error);
  }
  hidden_.clear();
  return file;
}

}  // namespace stribeck::workflow
