#include <filesystem>
#include <system_error>
#include <utility>

#include <stribeck/io/file.hpp>
#include <stribeck/io/output_folder.hpp>

namespace stribeck::io {

OutputFolder::OutputFolder(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  fs::path missing = fs::absolute(path, error);
  if (!missing.has_filename()) missing = missing.parent_path();  // "report/"
  for (; !missing.empty() && !fs::exists(missing, error); missing = missing.parent_path())
    made_.push_back(missing.string());
  try {
    make_directory(path);
  } catch (...) {
    WriteTogether::remove_at_end_if_empty(made_);
    throw;
  }
}

OutputFolder::OutputFolder(OutputFolder&& other) noexcept : made_(std::exchange(other.made_, {})) {}

OutputFolder::~OutputFolder() { WriteTogether::remove_at_end_if_empty(made_); }

}  // namespace stribeck::io
