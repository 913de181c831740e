#pragma once
/// Logs that a page sent. They stand in a temporary folder of this session, readable by its user alone and removed at its end; nothing is
/// written anywhere else. Number and size are bounded: the oldest go first.
/// Threads: safe. Real time: no.
/// Errors: InputError.

#include <cstdint>
#include <filesystem>
#include <list>
#include <mutex>
#include <string>
#include <string_view>

namespace stribeck::web {

struct Upload {
  std::string id;
  std::string name;            ///< as the page gave it, without folders and odd characters
  std::filesystem::path file;  ///< in a folder of its own
  std::uintmax_t bytes = 0;
};

class Uploads {
 public:
  Uploads();
  ~Uploads();
  Uploads(const Uploads&) = delete;
  Uploads& operator=(const Uploads&) = delete;

  Upload add(std::string_view name, std::string_view bytes);
  /// Throws for an unknown id.
  [[nodiscard]] Upload find(const std::string& id) const;
  void remove(const std::string& id);

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

  static constexpr std::size_t kMostFiles = 32;
  static constexpr std::uintmax_t kMostBytes = 512ULL << 20;  ///< of all together
  static constexpr std::uint64_t kLargest = 128ULL << 20;

 private:
  mutable std::mutex mutex_;
  std::filesystem::path folder_;
  std::list<Upload> files_;
  std::uint64_t next_ = 1;
};

}  // namespace stribeck::web
