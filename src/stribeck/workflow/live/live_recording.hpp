#pragma once
/// A recording of a stream: a CSV log that grows in a hidden temporary file of a folder and gets its name at the end, live-1.csv or the
/// next free number. An existing file is never written over. Without end() nothing but the hidden file is there, and the destructor
/// removes it.
///
/// Bounds: kMostBytes; a row beyond them is refused, and what was recorded can still be saved.
/// Real time: no.
/// Errors: InputError where the folder cannot be written to.

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace stribeck::workflow {

class LiveRecording {
 public:
  /// Less than the largest log that the dashboard identifies.
  static constexpr std::uint64_t kMostBytes = 120ULL << 20;

  /// headers: "x [mm]"; metadata goes above them as "# key: value".
  LiveRecording(const std::filesystem::path& folder, const std::vector<std::string>& headers,
                const std::vector<std::pair<std::string, std::string>>& metadata,
                std::uint64_t most_bytes = kMostBytes);
  ~LiveRecording();
  LiveRecording(const LiveRecording&) = delete;
  LiveRecording& operator=(const LiveRecording&) = delete;

  /// False: the recording is full, or the disk is; why() says which.
  bool row(double t, std::span<const double> values);
  /// Gives the file its name and returns it. Throws where that fails; then nothing is left behind.
  std::filesystem::path end();

  [[nodiscard]] std::uint64_t rows() const { return rows_; }
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }
  [[nodiscard]] const std::string& why() const { return why_; }

 private:
  struct Close {
    void operator()(std::FILE* f) const { std::fclose(f); }
  };
  void write(const std::string& text);

  std::filesystem::path folder_;
  std::filesystem::path hidden_;
  std::unique_ptr<std::FILE, Close> file_;
  std::uint64_t most_;
  std::uint64_t rows_ = 0;
  std::uint64_t bytes_ = 0;
  std::string line_;
  std::string why_;
};

}  // namespace stribeck::workflow
