#pragma once
/// Reads and writes whole files.
/// Real time: no.
/// Errors: InputError with the path as given and the system's reason.

#include <string>
#include <string_view>
#include <vector>

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

enum class FileIs { kData, kProgram };  ///< who may read a program may also run it

/// Replaces the file at once: readers see the old bytes or the new ones, also after a power cut, and a failure leaves no file behind.
/// A pipe, a terminal and other special files are written to directly. Inside a WriteTogether the file appears at its commit().
void write_atomically(const std::string& path, std::string_view bytes, FileIs what = FileIs::kData);

/// The files of one command. All are written and on the disk before the first of them gets its name, so that a full disk or a file that
/// cannot be written leaves every earlier file as it was. For one thread. A WriteTogether inside another belongs to the outer one.
class WriteTogether {
 public:
  WriteTogether();
  /// Drops the files that were not committed.
  ~WriteTogether();
  WriteTogether(const WriteTogether&) = delete;
  WriteTogether& operator=(const WriteTogether&) = delete;

  /// Gives every file that was written since the beginning its name.
  void commit();

  /// Removes those of the folders (the deepest first) that are empty at the end of the WriteTogether; without one, at once.
  static void remove_at_end_if_empty(std::vector<std::string> folders);

 private:
  friend void write_atomically(const std::string& path, std::string_view bytes, FileIs what);
  class Pending;
  static void remove_if_empty(const std::vector<std::string>& folders) noexcept;

  static WriteTogether* current_;
  WriteTogether* outer_;
  std::vector<Pending> pending_;
  std::vector<std::string> folders_;
};

/// The file that a write to this path makes or replaces: symbolic links are followed, also to a file that does not exist yet.
std::string link_target(const std::string& path);

/// Refuses outputs that are the same file as an input or as each other; empty names are none.
void check_distinct(const std::vector<std::string>& inputs, const std::vector<std::string>& outputs);

/// Fails early where a result could not be written at the end: checks name, links and folder of a path that is not empty.
void check_writable(const std::string& path);

/// Makes the directory and those above it; one that exists is kept.
void make_directory(const std::string& path);

}  // namespace stribeck::io
