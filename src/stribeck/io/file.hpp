#pragma once
/// Reads and writes whole files.
/// Real time: no.
/// Errors: InputError with the path as given and the system's reason.

#include <string>
#include <string_view>

namespace stribeck::io {

/// The bytes of a file or a pipe at the time when it was opened; later changes of the file have no effect.
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
/// A pipe, a terminal and other special files are written to directly.
void write_atomically(const std::string& path, std::string_view bytes);

/// Fails early where a result could not be written at the end: checks the folder of a path that is not empty.
void check_writable(const std::string& path);

/// Makes the directory and those above it; one that exists is kept.
void make_directory(const std::string& path);

}  // namespace stribeck::io
