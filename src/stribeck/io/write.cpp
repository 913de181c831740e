// Files are replaced as a whole, and those of one command together.
#include <dirent.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <filesystem>
#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/write_at_once.hpp>
#include <system_error>
#include <utility>

namespace stribeck::io {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& path, int code) {
  throw InputError(Problem{path.empty() ? std::string("\"\"") : path, 0, "",
                           "cannot be written: " + std::generic_category().message(code)});
}

/// 0, or the error.
int write_all(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return errno;
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
  return 0;
}

std::string folder_of(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  return folder.empty() ? "." : folder.string();
}

constexpr std::string_view kPrefix = ".stribeck-";
constexpr std::string_view kSuffix = ".tmp";

/// A name in a folder that nobody has. Not longer with a longer name of the file to write: 255 bytes are the most.
std::string temporary_in(const std::string& folder) {
  static std::atomic<unsigned> count{0};
  return (fs::path(folder) / (std::string(kPrefix) + std::to_string(::getpid()) + "-" +
                              std::to_string(count++) + std::string(kSuffix)))
      .string();
}

/// The names in a folder reach the disk. Some file systems cannot be asked for that, which is no failure of the write.
void sync_folder(const std::string& folder) {
  const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return;
  ::fsync(fd);
  ::close(fd);
}

thread_local bool at_once = false;  // see WriteAtOnce

/// What a killed program has left: temporary files that nobody holds locked.
void remove_abandoned(const std::string& folder) {
  DIR* const entries = ::opendir(folder.c_str());
  if (entries == nullptr) return;
  while (const dirent* entry = ::readdir(entries)) {
    const std::string_view name = entry->d_name;
    if (!name.starts_with(kPrefix) || !name.ends_with(kSuffix)) continue;
    const int fd = ::openat(::dirfd(entries), entry->d_name, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (fd < 0) continue;
    if (::flock(fd, LOCK_EX | LOCK_NB) == 0) ::unlinkat(::dirfd(entries), entry->d_name, 0);
    ::close(fd);
  }
  ::closedir(entries);
}

}  // namespace

/// A file on its way: its bytes are on the disk, its name is not yet.
class WriteTogether::Pending {
 public:
  Pending(std::string path, std::string_view bytes, bool program)
      : path_(std::move(path)), target_(link_target(path_)) {
    struct stat info {};
    const bool exists = ::stat(target_.c_str(), &info) == 0;
    if (!exists && errno != ENOENT) fail(path_, errno);
    open();
    int error = write_all(fd_, bytes);
    if (error == 0 && (exists || program)) {
      if (!exists && ::fstat(fd_, &info) != 0) error = errno;
      const mode_t mode = info.st_mode & 07777;
      // Who may read a program may run it.
      if (error == 0 && ::fchmod(fd_, program ? mode | ((mode & 0444) >> 2) : mode) != 0) error = errno;
    }
    // Before the name: after a power cut there is the old file or the new one, not an empty one.
    if (error == 0 && ::fsync(fd_) != 0) error = errno;
    if (error == 0) return;
    drop();
    fail(path_, error);
  }
  ~Pending() { drop(); }
  Pending(Pending&& other) noexcept
      : path_(std::move(other.path_)),
        target_(std::move(other.target_)),
        temporary_(std::exchange(other.temporary_, {})),
        fd_(std::exchange(other.fd_, -1)) {}
  Pending(const Pending&) = delete;
  Pending& operator=(const Pending&) = delete;
  Pending& operator=(Pending&&) = delete;

  [[nodiscard]] const std::string& target() const { return target_; }

  /// The file has its name.
  void finish() {
    if (temporary_.empty()) {
      // linkat() cannot replace a file: the link gets a temporary name, and is then renamed.
      temporary_ = temporary_in(folder_of(target_));
      ::flock(fd_, LOCK_EX | LOCK_NB);
      const std::string self = "/proc/self/fd/" + std::to_string(fd_);
      if (::linkat(AT_FDCWD, self.c_str(), AT_FDCWD, temporary_.c_str(), AT_SYMLINK_FOLLOW) != 0) {
        const int error = errno;
        temporary_.clear();
        fail(path_, error);
      }
    }
    if (::rename(temporary_.c_str(), target_.c_str()) != 0) fail(path_, errno);
    temporary_.clear();
  }

 private:
  /// Without a name where the file system and /proc allow that: then nothing is left when this program is killed.
  void open() {
    const std::string folder = folder_of(target_);
    remove_abandoned(folder);
    if (::access("/proc/self/fd", X_OK) == 0)
      fd_ = ::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
    // Another one may take a file that has just been made for abandoned.
    for (int i = 0; i < 100 && fd_ < 0; ++i) {
      temporary_ = temporary_in(folder);
      fd_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      if (fd_ < 0 && errno != EEXIST) break;
      struct stat info {};
      if (fd_ >= 0 &&
          (::flock(fd_, LOCK_EX | LOCK_NB) != 0 || ::fstat(fd_, &info) != 0 || info.st_nlink == 0)) {
        ::close(fd_);
        fd_ = -1;
        errno = EBUSY;
      }
    }
    if (fd_ >= 0) return;
    const int error = errno;
    temporary_.clear();
    if (error != ENOENT) fail(path_, error);
    throw InputError(Problem{path_.empty() ? std::string("\"\"") : path_, 0, "",
                             "cannot be written: no such directory (make it first)"});
  }

  void drop() noexcept {
    if (!temporary_.empty()) ::unlink(temporary_.c_str());
    if (fd_ >= 0) ::close(fd_);
    fd_ = -1;
    temporary_.clear();
  }

  std::string path_;
  std::string target_;
  std::string temporary_;  ///< empty: a file without a name
  int fd_ = -1;
};

WriteTogether* WriteTogether::current_ = nullptr;

WriteTogether::WriteTogether() : outer_(current_) {
  if (outer_ == nullptr) current_ = this;
}

WriteTogether::~WriteTogether() {
  if (outer_ != nullptr) return;
  current_ = nullptr;
  pending_.clear();
  remove_if_empty(folders_);
}

void WriteTogether::commit() {
  if (outer_ != nullptr) return;
  std::vector<std::string> folders;
  for (Pending& p : pending_) {
    p.finish();
    const std::string folder = folder_of(p.target());
    if (std::find(folders.begin(), folders.end(), folder) == folders.end()) folders.push_back(folder);
  }
  pending_.clear();
  for (const std::string& folder : folders) sync_folder(folder);
}

void write_atomically(const std::string& path, std::string_view bytes, FileIs what) {
  struct stat info {};
  const bool exists = ::stat(path.c_str(), &info) == 0;
  if (exists && S_ISDIR(info.st_mode))
    throw InputError(Problem{path, 0, "", "is a directory, expected a file to write"});
  if (exists && !S_ISREG(info.st_mode)) {
    const int fd = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
    int error = fd < 0 ? errno : write_all(fd, bytes);
    // Some file systems report a failed write only here.
    if (fd >= 0 && ::close(fd) != 0 && error == 0) error = errno;
    if (error != 0) fail(path, error);
    return;
  }
  if (at_once) {
    WriteTogether::Pending file(path, bytes, what == FileIs::kProgram);
    file.finish();
    return sync_folder(folder_of(file.target()));
  }
  WriteTogether alone;
  WriteTogether& all = *WriteTogether::current_;
  all.pending_.emplace_back(path, bytes, what == FileIs::kProgram);
  alone.commit();
}

WriteAtOnce::WriteAtOnce() noexcept : before_(std::exchange(at_once, true)) {}

WriteAtOnce::~WriteAtOnce() { at_once = before_; }

void WriteTogether::remove_at_end_if_empty(std::vector<std::string> folders) {
  if (current_ == nullptr) return remove_if_empty(folders);
  // The newest first: it may be a subfolder of an older one.
  current_->folders_.insert(current_->folders_.begin(), folders.begin(), folders.end());
}

void WriteTogether::remove_if_empty(const std::vector<std::string>& folders) noexcept {
  for (const std::string& folder : folders) {
    // Only an empty one can be removed.
    std::error_code ignored;
    if (fs::is_directory(folder, ignored)) fs::remove(folder, ignored);
  }
}

}  // namespace stribeck::io
