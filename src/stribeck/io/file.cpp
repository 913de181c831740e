#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>
#include <system_error>

namespace stribeck::io {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& path, std::string message) {
  throw InputError(Problem{path.empty() ? std::string("\"\"") : path, 0, "", std::move(message)});
}

std::string reason(int code) { return std::generic_category().message(code); }

/// A file descriptor that is closed on destruction.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  [[nodiscard]] int get() const noexcept { return fd_; }

 private:
  int fd_;
};

/// Reads to the end; about `expected` bytes.
std::string read_all(int fd, const std::string& path, std::size_t expected) {
  constexpr std::size_t kBlock = 1 << 16;
  std::string bytes(expected + kBlock, '\0');
  std::size_t used = 0;
  while (true) {
    if (bytes.size() - used < kBlock) bytes.resize(2 * bytes.size());
    const ssize_t n = ::read(fd, bytes.data() + used, bytes.size() - used);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail(path, "cannot be read: " + reason(errno));
    if (n == 0) break;
    used += static_cast<std::size_t>(n);
  }
  bytes.resize(used);
  return bytes;
}

}  // namespace

FileBytes::FileBytes(const std::string& path) {
  Descriptor fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (fd.get() < 0) {
    if (errno == ENOENT) fail(path, "no such file (check the name and the working directory)");
    fail(path, "cannot be opened: " + reason(errno));
  }
  struct stat info {};
  if (::fstat(fd.get(), &info) != 0) fail(path, "cannot be read: " + reason(errno));
  if (S_ISDIR(info.st_mode)) fail(path, "is a directory, expected a file (name a file inside it)");
  if (S_ISBLK(info.st_mode) || (S_ISCHR(info.st_mode) && ::isatty(fd.get()) == 0)) {
    fail(path, "is a device, expected a file");
  }
  const auto size = static_cast<std::size_t>(info.st_size);
  // The file is not mapped: if another program shortened it meanwhile, a signal would end this one.
  bytes_ = read_all(fd.get(), path, S_ISREG(info.st_mode) ? size : 0);
  if (S_ISREG(info.st_mode) && bytes_.size() < size) {
    fail(path, "became shorter while it was read: another program writes it (copy it first)");
  }
}

std::string read_text(const std::string& path) { return std::string(FileBytes(path).view()); }

void make_directory(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (!error && fs::is_directory(path, error)) return;
  fail(path, "cannot be made a directory: " + (error ? error.message() : reason(ENOTDIR)));
}

std::string link_target(const std::string& path) {
  constexpr int kMostLinks = 40;  // as the kernel follows
  fs::path target = path;
  std::error_code error;
  for (int i = 0; fs::is_symlink(target, error); ++i) {
    if (i == kMostLinks) fail(path, "cannot be written: " + reason(ELOOP));
    const fs::path to = fs::read_symlink(target, error);
    if (error) fail(path, "cannot be written: " + error.message());
    target = to.is_absolute() ? to : target.parent_path() / to;
  }
  return target.string();
}

void check_distinct(const std::vector<std::string>& inputs, const std::vector<std::string>& outputs) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  std::vector<fs::path> taken;
  // The file that a name means; one that cannot be followed is reported where it is opened.
  const auto meant = [&](const std::string& path) {
    return fs::weakly_canonical(link_target(path), ignored);
  };
  for (const std::string& path : inputs) {
    if (fs::exists(path, ignored)) taken.push_back(meant(path));
  }
  for (const std::string& path : outputs) {
    if (path.empty() || (fs::exists(path, ignored) && !fs::is_regular_file(path, ignored))) continue;
    const fs::path file = meant(path);
    if (std::find(taken.begin(), taken.end(), file) != taken.end()) {
      throw InputError(
          {path,
           0,
           {},
           "would be overwritten: it is an input or another output of this command (choose another name)"});
    }
    taken.push_back(file);
  }
}

void check_writable(const std::string& path) {
  if (path.empty()) return;
  struct stat info {};
  // Written to directly; what the links of /dev/stdout name is no path.
  if (::stat(path.c_str(), &info) == 0 && !S_ISREG(info.st_mode) && !S_ISDIR(info.st_mode)) {
    if (::access(path.c_str(), W_OK) != 0) fail(path, "cannot be written: " + reason(errno));
    return;
  }
  const std::string target = link_target(path);
  const int missing = ::stat(target.c_str(), &info) == 0 ? 0 : errno;
  if (missing == 0 && S_ISDIR(info.st_mode))
    fail(path, "is a directory, expected the name of a file to write");
  fs::path folder = fs::path(target).parent_path();
  if (folder.empty()) folder = ".";
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored))
    fail(path, "cannot be written: no folder " + in_quotes(folder.string()) + " (make it first)");
  if (missing != 0 && missing != ENOENT) fail(path, "cannot be written: " + reason(missing));
  if (::access(folder.c_str(), W_OK) != 0) fail(path, "cannot be written: " + reason(errno));
}

}  // namespace stribeck::io
