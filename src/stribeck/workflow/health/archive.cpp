#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/file.h>
#include <unistd.h>
#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <utility>

#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/sha256.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/workflow/health/archive.hpp>

namespace stribeck::workflow {
namespace {

namespace fs = std::filesystem;

constexpr double kLater = 1e-3;  // days between tests of one day, which have no hour

/// The name of an axis as part of a file name.
std::string in_file_name(const std::string& axis) {
  std::string out;
  for (const char c : axis) out += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' ? c : '_';
  return out;
}

/// The number of a test of its day: 2 of 2026-11-23-x-2.toml, 1 where there is none.
int number_of(const std::string& path, const ArchivedTest& test) {
  const std::string stem = fs::path(path).stem().string();
  const std::string begin = test.date + "-" + in_file_name(test.axis) + "-";
  int number = 1;
  if (stem.starts_with(begin))
    static_cast<void>(std::from_chars(stem.data() + begin.size(), stem.data() + stem.size(), number));
  return number;
}

ArchiveFile as_file(std::string path, ArchivedTest test) {
  const double day = *ident::health::day_of(test.date) + kLater * (number_of(path, test) - 1);
  return {std::move(path), std::move(test), day};
}

void sort(std::vector<ArchiveFile>& files) {
  std::sort(files.begin(), files.end(), [](const ArchiveFile& a, const ArchiveFile& b) {
    return a.day != b.day ? a.day < b.day : a.path < b.path;
  });
}

[[noreturn]] void fail(const std::string& path, const std::string& message) {
  throw io::InputError({path, 0, {}, message});
}

}  // namespace

ArchiveFolder::ArchiveFolder(std::string path) : path_(std::move(path)) {
  io::make_directory(path_);
  lock_ = open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (lock_ < 0) fail(path_, std::string("cannot be opened: ") + std::strerror(errno));
  if (flock(lock_, LOCK_EX | LOCK_NB) != 0) {
    const int error = errno;
    close(std::exchange(lock_, -1));
    if (error == EWOULDBLOCK)
      fail(path_, "another command is adding to this archive (wait until it has ended)");
    // A file system without locks: names are still never taken twice by one command.
    if (error != ENOLCK && error != EOPNOTSUPP)
      fail(path_, std::string("cannot be locked: ") + std::strerror(error));
  }
}

ArchiveFolder::~ArchiveFolder() {
  if (lock_ >= 0) close(lock_);
}

ArchiveFolder::ArchiveFolder(ArchiveFolder&& other) noexcept
    : path_(std::move(other.path_)), lock_(std::exchange(other.lock_, -1)) {}

ArchiveFolder& ArchiveFolder::operator=(ArchiveFolder&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(lock_, other.lock_);
  return *this;
}

std::vector<ArchiveFile> ArchiveFolder::read(const std::string& machine) const {
  std::vector<ArchiveFile> files;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(path_, error)) {
    if (entry.path().extension() != ".toml") continue;
    const std::string path = entry.path().string();
    auto test = io::read_toml<ArchivedTest>(path);
    if (test.machine != machine)
      throw io::InputError({path, 0, "machine",
                            fmt::format("got {}, expected {} (one archive holds one machine)",
                                        io::in_quotes(test.machine), io::in_quotes(machine))});
    files.push_back(as_file(path, std::move(test)));
  }
  if (error) fail(path_, "cannot be read: " + error.message());
  sort(files);
  return files;
}

void ArchiveFolder::add(const ArchivedTest& test, std::vector<ArchiveFile>& files) const {
  const std::string begin = path_ + "/" + test.date + "-" + in_file_name(test.axis);
  const auto taken = [&](const std::string& path) {
    std::error_code ignored;
    return fs::exists(fs::symlink_status(path, ignored)) ||
           std::any_of(files.begin(), files.end(), [&](const ArchiveFile& f) { return f.path == path; });
  };
  std::string path = begin + ".toml";
  for (int number = 2; taken(path); ++number) path = fmt::format("{}-{}.toml", begin, number);
  io::write_atomically(path, io::write_toml(test,
                                            "A test of stribeck health. Values are never changed; "
                                            "half_width is that of the 95 % interval."));
  files.push_back(as_file(path, test));
  sort(files);
}

std::string checksum_of(const std::vector<std::string>& files) {
  std::vector<std::string> sums;
  for (const std::string& file : files) sums.push_back(io::sha256_of_file(file));
  std::sort(sums.begin(), sums.end());  // the same files in another order are the same test
  return sums.size() == 1 ? sums.front()
                          : io::hexadecimal(io::sha256(fmt::format("{}", fmt::join(sums, ""))));
}

}  // namespace stribeck::workflow
