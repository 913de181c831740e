#pragma once
/// A folder for results, which is removed if the command fails.
/// Real time: no.
/// Errors: InputError with the path and the system's reason.

#include <string>
#include <vector>

namespace stribeck::io {

/// A folder for results; it and missing folders above it are made before the work begins. At the end, the new folders into which
/// nothing was written are removed, so that a command that fails leaves none behind.
class OutputFolder {
 public:
  OutputFolder() = default;
  explicit OutputFolder(const std::string& path);
  ~OutputFolder();
  OutputFolder(OutputFolder&& other) noexcept;
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
  OutputFolder& operator=(OutputFolder&&) = delete;

 private:
  std::vector<std::string> made_;  ///< the deepest one first
};

}  // namespace stribeck::io
