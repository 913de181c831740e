#pragma once
/// The rows of a study on the disk: FOLDER/results.csv, to which every finished run is added at once, and FOLDER/inputs.txt, which
/// holds what they were made with.
///
/// A run is a fixed number of lines that begin with its number. It is finished when all of them are there. After a kill or a power
/// cut the file ends with a part of a run at most, which is cut off, and the study goes on behind it. Rows are never taken for those of
/// other inputs: inputs.txt must have the same text. It is on the disk before the first row.
/// Real time: no. Errors: InputError with the file and what to do.

#include <cstdint>
#include <functional>
#include <stribeck/io/error.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::workflow {

/// What the column `state` of a line says.
inline constexpr std::string_view kRunDone = "ok";
inline constexpr std::string_view kRunLost = "lost";
inline constexpr std::string_view kRunRefused = "refused";

struct ResultsLayout {
  std::string head;         ///< first line, without its end
  std::uint64_t lines = 1;  ///< of each run
  std::uint64_t runs = 1;   ///< of the whole study
};

/// Another program adds runs at the moment.
class ResultsInUse : public io::InputError {
 public:
  using io::InputError::InputError;
};

class ResultsFile {
 public:
  /// Opens the results in a folder for more runs, or begins them. One at a time: ResultsInUse where another program writes them.
  ResultsFile(const std::string& folder, const std::string& inputs, ResultsLayout layout);
  ~ResultsFile();
  ResultsFile(const ResultsFile&) = delete;
  ResultsFile& operator=(const ResultsFile&) = delete;

  /// Number of finished runs.
  [[nodiscard]] std::uint64_t finished() const noexcept { return finished_; }
  [[nodiscard]] const std::string& path() const noexcept { return path_; }

  /// Adds the lines of the next run, each with its end.
  void add(std::string_view lines);
  /// Puts what was added on the disk.
  void keep();

 private:
  void take_up();

  std::string path_;
  std::string inputs_path_;
  ResultsLayout layout_;
  std::uint64_t finished_ = 0;
  std::uint64_t unsaved_ = 0;
  int fd_ = -1;
};

/// Calls row(number of the line, its cells) for each line of a results file below its head.
void for_each_row(const std::string& path,
                  const std::function<void(std::uint64_t, const std::vector<std::string_view>&)>& row);

}  // namespace stribeck::workflow
