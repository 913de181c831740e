#pragma once
/// The runs of one study shared by several processes, on one computer or on several with a common folder.
///
/// Runs are dealt in blocks. A process claims the first block that nobody has, computes it and leaves its rows as a file. The leader,
/// which holds the results (results_file.hpp), takes them over in order. Rows depend on the number of their run alone, so that a block
/// which two processes compute does no harm, and the results are the same bytes as those of one process.
///
///   FOLDER/shared-KEY/first        first block that the leader has not taken over
///   FOLDER/shared-KEY/12.claim     who computes block 12
///   FOLDER/shared-KEY/12.rows      its rows
///   FOLDER/shared-KEY/alive-OWNER  a number that its process counts up
///
/// KEY belongs to the inputs of the study and the number of its runs. A process whose number stands still for `patience` is taken for
/// dead, and what it has claimed is free again. No clock of another computer is read. The folder must create a file for one process alone,
/// and rename it in one step.
/// Real time: no. Errors: InputError where the folder cannot be written.

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

namespace stribeck::workflow {

class SharedRuns {
 public:
  struct Pace {
    std::chrono::milliseconds beat{1000};        ///< between two counts of a process
    std::chrono::milliseconds patience{20'000};  ///< without a count: it is dead
  };
  /// note(text): called for events that the user should see, e.g. that a process has died.
  using Note = std::function<void(const std::string&)>;

  SharedRuns(const std::string& folder, const std::string& inputs, std::uint64_t runs, Note note, Pace pace);
  /// Takes its own files away; what it has claimed is free again.
  ~SharedRuns();
  SharedRuns(const SharedRuns&) = delete;
  SharedRuns& operator=(const SharedRuns&) = delete;

  [[nodiscard]] std::uint64_t block_of(std::uint64_t run) const noexcept { return run / size_; }
  [[nodiscard]] std::uint64_t begin_of(std::uint64_t block) const noexcept { return block * size_; }
  [[nodiscard]] std::uint64_t end_of(std::uint64_t block) const noexcept;

  /// Whether a leader shares these runs at the moment.
  [[nodiscard]] bool open() const;
  /// Whether processes share another study in the folder at the moment: one of them has counted on since it was looked at first.
  [[nodiscard]] bool others();
  /// As the leader: takes away what other studies left.
  void clear_others() const;
  /// As the leader: shares the blocks from this one on, and again after each that it took over.
  void share_from(std::uint64_t block);
  /// As the leader: nothing is left to do.
  void close();

  /// The first block that nobody has; absent: all are claimed, or no leader shares them. Several may be held at a time.
  std::optional<std::uint64_t> claim();
  void finish(std::uint64_t block, const std::string& rows);
  /// Absent: not finished.
  [[nodiscard]] std::optional<std::string> rows(std::uint64_t block) const;
  /// Its rows are damaged; it is free again.
  void discard(std::uint64_t block) const;

 private:
  struct Count {
    std::string text;
    std::chrono::steady_clock::time_point since;  ///< it is seen
  };

  [[nodiscard]] std::string file(std::uint64_t block, const char* kind) const;
  [[nodiscard]] std::optional<std::uint64_t> first() const;
  [[nodiscard]] bool dead(const std::string& owner);
  [[nodiscard]] bool create(std::uint64_t block) const;
  void free_those_of_the_dead();
  [[nodiscard]] std::vector<std::string> other_folders() const;
  void count(const std::stop_token& stop);

  std::string parent_;
  std::string folder_;
  std::string owner_;
  std::uint64_t runs_;
  std::uint64_t size_;  ///< runs of a block
  Note note_;
  Pace pace_;
  std::map<std::string, Count> counts_;  ///< of the others
  std::vector<std::uint64_t> claimed_;
  std::jthread counting_;
};

}  // namespace stribeck::workflow
