#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
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
  ~Descriptor() { close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  [[nodiscard]] int get() const noexcept { return fd_; }
  /// Closes; returns 0 or the error, because some file systems report a failed write only here.
  int close() noexcept {
    const int result = fd_ < 0 || ::close(fd_) == 0 ? 0 : errno;
    fd_ = -1;
    return result;
  }

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

/// Writes everything; returns 0 or the error.
int write_all(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return errno;
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
  return 0;
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

void write_atomically(const std::string& path, std::string_view bytes) {
  struct stat info {};
  const bool exists = ::stat(path.c_str(), &info) == 0;
  if (exists && S_ISDIR(info.st_mode)) fail(path, "is a directory, expected a file to write");
  if (exists && !S_ISREG(info.st_mode)) {
    Descriptor fd(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
    int error = fd.get() < 0 ? errno : write_all(fd.get(), bytes);
    if (error == 0) error = fd.close();
    if (error != 0) fail(path, "cannot be written: " + reason(error));
    return;
  }

  std::error_code ignored;
  fs::path target = path;
  if (exists && fs::is_symlink(target, ignored)) target = fs::canonical(target, ignored);
  static std::atomic<unsigned> count{0};
  const std::string temporary =
      (target.parent_path() / ("." + target.filename().string() + "." + std::to_string(::getpid()) + "-" +
                               std::to_string(count++) + ".tmp"))
          .string();
  Descriptor fd(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (fd.get() < 0) {
    if (errno == ENOENT) fail(path, "cannot be written: no such directory (make it first)");
    fail(path, "cannot be written: " + reason(errno));
  }
  int error = write_all(fd.get(), bytes);
  if (error == 0 && exists && ::fchmod(fd.get(), info.st_mode & 07777) != 0) error = errno;
  if (const int closing = fd.close(); error == 0) error = closing;
  if (error == 0 && ::rename(temporary.c_str(), target.c_str()) != 0) error = errno;
  if (error != 0) {
    ::unlink(temporary.c_str());
    fail(path, "cannot be written: " + reason(error));
  }
}

void make_directory(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (!error && fs::is_directory(path, error)) return;
  fail(path, "cannot be made a directory: " + (error ? error.message() : reason(ENOTDIR)));
}

void check_writable(const std::string& path) {
  if (path.empty()) return;
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) fail(path, "is a directory, expected the name of a file to write");
  fs::path folder = fs::path(path).parent_path();
  if (folder.empty()) folder = ".";
  if (!fs::is_directory(folder, ignored))
    fail(path, "cannot be written: no folder " + in_quotes(folder.string()) + " (make it first)");
  if (access(folder.c_str(), W_OK) != 0) fail(path, "cannot be written: " + reason(errno));
}

}  // namespace stribeck::io
