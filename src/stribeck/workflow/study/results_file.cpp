#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/workflow/study/results_file.hpp>
#include <system_error>
#include <utility>

namespace stribeck::workflow {
namespace {

/// So many runs may be lost by a power cut; by a kill, none.
constexpr std::uint64_t kUnsaved = 500;

[[noreturn]] void no_write(const std::string& path, int code) {
  throw io::InputError(
      io::Problem{path, 0, {}, "cannot be written: " + std::generic_category().message(code)});
}

void write_whole(int fd, std::string_view bytes, const std::string& path) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) no_write(path, errno);
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
}

/// Reads a file line by line, in memory that its longest line needs.
class Lines {
 public:
  Lines(int fd, std::string path) : fd_(fd), path_(std::move(path)) {}

  /// The next line without its end; false at the end of the file and before a last line without an end.
  bool next(std::string_view& line) {
    for (;;) {
      const std::size_t end = buffer_.find('\n', at_);
      if (end != std::string::npos) {
        line = std::string_view(buffer_).substr(at_, end - at_);
        offset_ += line.size() + 1;
        at_ = end + 1;
        return true;
      }
      buffer_.erase(0, at_);
      at_ = 0;
      const std::size_t before = buffer_.size();
      buffer_.resize(before + kChunk);
      const ssize_t n = ::pread(fd_, buffer_.data() + before, kChunk, static_cast<off_t>(read_));
      if (n < 0 && errno != EINTR)
        throw io::InputError(
            io::Problem{path_, 0, {}, "cannot be read: " + std::generic_category().message(errno)});
      buffer_.resize(before + static_cast<std::size_t>(std::max<ssize_t>(n, 0)));
      read_ += static_cast<std::uint64_t>(std::max<ssize_t>(n, 0));
      if (n == 0) return false;
    }
  }
  /// Bytes of the lines that were given.
  [[nodiscard]] std::uint64_t offset() const noexcept { return offset_; }

 private:
  static constexpr std::size_t kChunk = 1U << 16U;
  int fd_;
  std::string path_;
  std::string buffer_;
  std::size_t at_ = 0;
  std::uint64_t read_ = 0;
  std::uint64_t offset_ = 0;
};

bool is_row(std::string_view line, std::uint64_t run, std::size_t commas) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), number);
  return error == std::errc() && number == run && line.find('\0') == std::string_view::npos &&
         end != line.data() + line.size() && *end == ',' &&
         static_cast<std::size_t>(std::count(line.begin(), line.end(), ',')) == commas;
}

/// The first line in which two texts differ, of the second; for a message.
std::string first_difference(std::string_view a, std::string_view b) {
  while (!a.empty() || !b.empty()) {
    const std::size_t end_a = std::min(a.find('\n'), a.size());
    const std::size_t end_b = std::min(b.find('\n'), b.size());
    if (a.substr(0, end_a) != b.substr(0, end_b)) return std::string(b.substr(0, end_b));
    a.remove_prefix(std::min(end_a + 1, a.size()));
    b.remove_prefix(std::min(end_b + 1, b.size()));
  }
  return {};
}

}  // namespace

ResultsFile::ResultsFile(const std::string& folder, const std::string& inputs, ResultsLayout layout)
    : path_(folder + "/results.csv"), inputs_path_(folder + "/inputs.txt"), layout_(std::move(layout)) {
  fd_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC | O_NOFOLLOW, 0666);
  if (fd_ < 0) no_write(path_, errno);
  try {
    struct stat info {};
    if (::fstat(fd_, &info) != 0) no_write(path_, errno);
    if (!S_ISREG(info.st_mode))
      throw io::InputError(io::Problem{path_, 0, {}, "is no regular file, to which runs could be added"});
    if (::flock(fd_, LOCK_EX | LOCK_NB) != 0) {
      throw ResultsInUse(io::Problem{
          path_,
          0,
          {},
          "another program adds runs to it at the moment (wait for it, choose another folder, or give --shared to both)"});
    }
    const std::string head = layout_.head + '\n';
    std::string begin(std::min<std::size_t>(static_cast<std::size_t>(info.st_size), head.size()), '\0');
    if (::pread(fd_, begin.data(), begin.size(), 0) != static_cast<ssize_t>(begin.size()))
      no_write(path_, EIO);
    // Without a finished head there is no row, and what the inputs were does not matter.
    const bool fresh = begin.size() < head.size() && head.starts_with(begin);
    if (fresh) {
      const int in =
          ::open(inputs_path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0666);
      if (in < 0) no_write(inputs_path_, errno);
      try {
        write_whole(in, inputs, inputs_path_);
        if (::fsync(in) != 0) no_write(inputs_path_, errno);
      } catch (...) {
        ::close(in);
        throw;
      }
      ::close(in);
      if (::ftruncate(fd_, 0) != 0) no_write(path_, errno);
      write_whole(fd_, head, path_);
      return;
    }
    std::string there;
    try {
      there = io::read_text(inputs_path_);
    } catch (const io::InputError&) {
      throw io::InputError(io::Problem{
          path_,
          0,
          {},
          "is there without the inputs.txt that tells what it was made with (choose another folder)"});
    }
    if (there != inputs) {
      throw io::InputError(io::Problem{
          path_,
          0,
          {},
          fmt::format(
              "holds the runs of another study, machine or version, first difference {} (choose another "
              "folder, or remove this one)",
              io::in_quotes(first_difference(there, inputs)))});
    }
    take_up();
  } catch (...) {
    ::close(fd_);
    throw;
  }
}

ResultsFile::~ResultsFile() { ::close(fd_); }

void ResultsFile::take_up() {
  Lines lines(fd_, path_);
  std::string_view line;
  const auto commas = static_cast<std::size_t>(std::count(layout_.head.begin(), layout_.head.end(), ','));
  if (!lines.next(line) || line != layout_.head)
    throw io::InputError(io::Problem{path_, 1, {}, "is no head of this study (choose another folder)"});
  std::uint64_t number = 0;  // of rows
  std::uint64_t kept = lines.offset();
  bool whole = true;
  while (whole && lines.next(line)) {
    whole = is_row(line, number / layout_.lines, commas);
    if (!whole) break;
    if (++number % layout_.lines == 0) kept = lines.offset();
  }
  // A power cut may leave zeros for rows that were not on the disk yet; what is behind them goes with them.
  if (!whole && line.find('\0') == std::string_view::npos) {
    throw io::InputError(io::Problem{
        path_,
        number + 2,
        {},
        "is no row that this study writes: the file was changed (delete this line and all behind it: the study computes them again)"});
  }
  finished_ = number / layout_.lines;
  if (finished_ > layout_.runs) {
    throw io::InputError(
        io::Problem{path_,
                    0,
                    {},
                    fmt::format("holds {} runs, the study asks for {} (choose another folder)", finished_,
                                layout_.runs)});
  }
  if (::ftruncate(fd_, static_cast<off_t>(kept)) != 0) no_write(path_, errno);
}

void ResultsFile::add(std::string_view lines) {
  write_whole(fd_, lines, path_);
  ++finished_;
  if (++unsaved_ >= kUnsaved) keep();
}

void ResultsFile::keep() {
  if (::fsync(fd_) != 0) no_write(path_, errno);
  unsaved_ = 0;
}

void for_each_row(const std::string& path,
                  const std::function<void(std::uint64_t, const std::vector<std::string_view>&)>& row) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0)
    throw io::InputError(
        io::Problem{path, 0, {}, "cannot be read: " + std::generic_category().message(errno)});
  try {
    Lines lines(fd, path);
    std::string_view line;
    std::vector<std::string_view> cells;
    lines.next(line);
    for (std::uint64_t number = 2; lines.next(line); ++number) {
      cells.clear();
      for (std::size_t at = 0; at <= line.size();) {
        const std::size_t end = std::min(line.find(',', at), line.size());
        cells.push_back(line.substr(at, end - at));
        at = end + 1;
      }
      row(number, cells);
    }
  } catch (...) {
    ::close(fd);
    throw;
  }
  ::close(fd);
}

}  // namespace stribeck::workflow
