#pragma once
/// Files as a whole.
/// Real time: no.
/// Errors: InputError with the path as given and the system's reason.

#include <string>
#include <string_view>

namespace stribeck::io {

/// The bytes of a file or a pipe, as they were when it was opened: what happens to the file later changes nothing.
class FileBytes {
 public:
  explicit FileBytes(const std::string& path);
  FileBytes(const FileBytes&) = delete;
  FileBytes& operator=(const FileBytes&) = delete;

  [[nodiscard]] std::string_view view() const noexcept { return bytes_; }

 private:
  std::string bytes_;
};

/// The whole text of a file; an empty file is an empty text.
std::string read_text(const std::string& path);

/// Replaces the file at once: readers see the old bytes or the new ones, and a failure leaves no file behind.
/// What is not an ordinary file (a pipe, a terminal) is written to directly.
void write_atomically(const std::string& path, std::string_view bytes);

/// Fails early when a result could not be written at the end: checks the folder of a path that is not empty.
void check_writable(const std::string& path);

/// Makes the directory and those above it; one that exists is kept.
void make_directory(const std::string& path);

}  // namespace stribeck::io
