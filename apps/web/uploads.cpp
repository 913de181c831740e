#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <system_error>

#include <apps/web/uploads.hpp>
#include <stribeck/io/error.hpp>

namespace stribeck::web {
namespace {

namespace fs = std::filesystem;

/// The last part of a path, of letters that mean nothing to any file system.
std::string safe_name(std::string_view name) {
  name = name.substr(std::min(name.find_last_of("/\\") + 1, name.size()));
  constexpr std::size_t kLongest = 80;
  constexpr std::string_view kPermitted =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.+ ";
  std::string out;
  for (const char c : name) out += kPermitted.find(c) == std::string_view::npos ? '_' : c;
  // The end tells the format.
  if (out.size() > kLongest) out.erase(0, out.size() - kLongest);
  if (out.empty() || out.front() == '.' || out.front() == ' ') out.insert(0, "log");
  return out;
}

[[noreturn]] void fail(const fs::path& file, int error) {
  throw io::InputError({file.string(), 0, {}, "cannot write: " + std::generic_category().message(error)});
}

}  // namespace

Uploads::Uploads() {
  std::string name = (fs::temp_directory_path() / "stribeck-serve-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) fail(name, errno);
  folder_ = name;
}

Uploads::~Uploads() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

Upload Uploads::add(std::string_view name, std::string_view bytes) {
  const std::lock_guard lock(mutex_);
  Upload one{std::to_string(next_++), safe_name(name), {}, bytes.size()};
  const fs::path folder = folder_ / one.id;
  one.file = folder / one.name;
  std::error_code wrong;
  fs::create_directory(folder, wrong);
  errno = 0;
  std::ofstream out(one.file, std::ios::binary);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (wrong || !out) {
    const int error = errno;
    std::error_code ignored;
    fs::remove_all(folder, ignored);
    fail(one.file, error != 0 ? error : EIO);
  }
  files_.push_back(one);
  std::uintmax_t all = 0;
  for (const Upload& u : files_) all += u.bytes;
  while (files_.size() > kMostFiles || (all > kMostBytes && files_.size() > 1)) {
    all -= files_.front().bytes;
    fs::remove_all(files_.front().file.parent_path(), wrong);
    files_.pop_front();
  }
  return one;
}

Upload Uploads::find(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  const auto found = std::find_if(files_.begin(), files_.end(), [&](const Upload& u) { return u.id == id; });
  if (found == files_.end())
    throw io::InputError({"request", 0, "logs",
                          "got " + io::in_quotes(id) + ", which is not here any more (drop the log again)"});
  return *found;
}

void Uploads::remove(const std::string& id) {
  const std::lock_guard lock(mutex_);
  const auto found = std::find_if(files_.begin(), files_.end(), [&](const Upload& u) { return u.id == id; });
  if (found == files_.end()) return;
  std::error_code ignored;
  std::filesystem::remove_all(found->file.parent_path(), ignored);
  files_.erase(found);
}

}  // namespace stribeck::web
