#pragma once
/// The runs of a study, each as the text of its rows. A row depends on the study and the number of its run alone.
/// Threads: all is safe once it is made. Real time: no. Errors: Refused for controllers that cannot be built; a machine that cannot be
/// simulated or identified is a row that says so.

#include <cstdint>
#include <span>
#include <stribeck/sim/study/machine_runs.hpp>
#include <stribeck/workflow/study/study.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

/// Text of a cell of its own: neither commas nor quotes.
std::string text_of_cell(std::string text);
/// Speed of a row.
std::string motion_of(const Study& s, std::size_t row);

/// Runs a study's controllers on its machines.
class StudyRuns {
 public:
  /// Both must outlive it.
  StudyRuns(const Study& s, const Parameters& parameters);

  [[nodiscard]] const sim::Design& design() const { return design_; }
  /// Number of rows of a run.
  [[nodiscard]] std::size_t rows() const { return once_.size(); }
  /// Runs that are worth computing together: packs are for those under the same compensators.
  [[nodiscard]] std::size_t most_together() const;
  /// Axes on which a controller goes without its Kalman observer.
  [[nodiscard]] const std::vector<sim::MachineRuns::Calmed>& calmed() const { return once_.calmed(); }
  /// On the machine as its file says it.
  [[nodiscard]] std::vector<sim::RobustRun> nominal() const { return once_.run(s_.machine, 0); }

  /// Number, sample and drawn values, with which all rows of a run begin.
  [[nodiscard]] std::string beginning(std::uint64_t run) const;
  /// Controller and motion of a row, which follow.
  [[nodiscard]] std::string case_of(std::size_t row) const;
  /// The rows of some runs, which take place together.
  [[nodiscard]] std::vector<std::string> texts(std::span<const std::uint64_t> runs) const;

 private:
  [[nodiscard]] std::vector<sim::RunsOfMachine> run_together(
      const std::vector<sim::MachineTrial>& machines) const;
  [[nodiscard]] sim::Machine machine_of(std::uint64_t run) const;
  [[nodiscard]] std::uint32_t trial_of(std::uint64_t run) const;
  [[nodiscard]] std::vector<sim::RobustRun> run_identified(std::uint64_t run) const;
  [[nodiscard]] std::string text(std::uint64_t run, const std::vector<sim::RobustRun>& all) const;

  const Study& s_;
  sim::Design design_;
  sim::MachineRuns once_;
};

}  // namespace stribeck::workflow
