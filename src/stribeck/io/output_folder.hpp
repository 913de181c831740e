#pragma once
/// A folder for results, which goes away with a command that fails.
/// Real time: no.
/// Errors: InputError with the path and the system's reason.

#include <string>
#include <vector>

namespace stribeck::io {

/// A folder for results, made with those above it before the work begins. Those that it made and that nothing was written to go
/// away with it, so that a command that fails leaves none behind.
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
  void remove_empty() noexcept;

  std::vector<std::string> made_;  ///< the deepest first
};

}  // namespace stribeck::io
