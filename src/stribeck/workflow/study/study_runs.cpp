#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stribeck/core/numbers.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/io/units.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/workflow/study/results_file.hpp>
#include <stribeck/workflow/study/study_runs.hpp>

namespace stribeck::workflow {
namespace {

/// Separates the noise of an identification from that of the runs.
constexpr std::uint64_t kLogs = 0x6c6f6773;

}  // namespace

std::string text_of_cell(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == ',' || c == '"'; }, ' ');
  return report::clean_text(text);
}

std::string motion_of(const Study& s, std::size_t row) {
  return s.spec.travels[row / s.spec.controllers.size()].pace_in_words();
}

StudyRuns::StudyRuns(const Study& s, const Parameters& parameters)
    : s_(s),
      design_(s.design()),
      once_(s.machine, parameters.knowledge, s.spec.travels, s.axes, s.spec.controllers, s.file.seed) {}

std::size_t StudyRuns::most_together() const {
  return s_.file.identification == StudyIdentification::kOnce ? sim::MachineRuns::kTogether : 1;
}

std::string StudyRuns::beginning(std::uint64_t run) const {
  const std::vector<double> values = s_.values(design_, run);
  std::string begin = fmt::format("{},{}", run, run / s_.runs_per_sample());
  for (std::size_t i = 0; i < values.size(); ++i)
    begin += ',' + io::number_text(s_.factors[i].shown(values[i]));
  return begin;
}

std::string StudyRuns::case_of(std::size_t row) const {
  return fmt::format(",{},{}", s_.spec.controllers[row % s_.spec.controllers.size()].id,
                     text_of_cell(motion_of(s_, row)));
}

std::vector<std::string> StudyRuns::texts(std::span<const std::uint64_t> runs) const {
  std::vector<std::string> all;
  if (s_.file.identification == StudyIdentification::kOnce) {
    std::vector<sim::MachineTrial> machines;
    for (const std::uint64_t run : runs) machines.push_back({machine_of(run), trial_of(run)});
    const std::vector<sim::RunsOfMachine> results = run_together(machines);
    for (std::size_t i = 0; i < runs.size(); ++i) all.push_back(text(runs[i], results[i].runs));
    return all;
  }
  for (const std::uint64_t run : runs) all.push_back(text(run, run_identified(run)));
  return all;
}

/// A machine that is refused in the middle of its run stops the others too: then each runs alone.
std::vector<sim::RunsOfMachine> StudyRuns::run_together(
    const std::vector<sim::MachineTrial>& machines) const {
  try {
    return once_.run_together(machines);
  } catch (const sim::Refused&) {
    std::vector<sim::RunsOfMachine> all(machines.size());
    for (std::size_t i = 0; i < machines.size(); ++i) {
      try {
        all[i].runs = once_.run(machines[i].machine, machines[i].trial);
      } catch (const sim::Refused&) {
        all[i].refused = std::current_exception();
      }
    }
    return all;
  }
}

sim::Machine StudyRuns::machine_of(std::uint64_t run) const {
  return with_values(s_.machine, s_.factors, s_.values(design_, run));
}

std::uint32_t StudyRuns::trial_of(std::uint64_t run) const {
  return static_cast<std::uint32_t>(run / s_.runs_per_sample());
}

/// Runs under compensators of their own; none for a machine that cannot be simulated, or whose logs do not identify it.
std::vector<sim::RobustRun> StudyRuns::run_identified(std::uint64_t run) const {
  try {
    const sim::Machine machine = machine_of(run);
    sim::CompareSpec spec = s_.spec;
    spec.threads = 1;
    spec.seed = sim::random_bits(s_.file.seed, kLogs, trial_of(run));
    const bool repeated = s_.file.identification == StudyIdentification::kRepeated;
    const Parameters own =
        get_parameters(repeated ? s_.machine : machine, s_.machine_file, s_.parameters, spec);
    const sim::MachineRuns runs(s_.machine, own.knowledge, spec.travels, s_.axes, spec.controllers,
                                s_.file.seed);
    return runs.run(machine, trial_of(run));
  } catch (const sim::Refused&) {
  } catch (const ident::Refused&) {
  }
  return {};
}

/// The rows of one run as text; without runs: refused.
std::string StudyRuns::text(std::uint64_t run, const std::vector<sim::RobustRun>& all) const {
  const std::string begin = beginning(run);
  std::string text;
  for (std::size_t row = 0; row < rows(); ++row) {
    text += fmt::format("{}{},{}", begin, case_of(row),
                        all.empty()     ? kRunRefused
                        : all[row].lost ? kRunLost
                                        : kRunDone);
    text += all.empty() ? "," : ',' + io::number_text(100.0 * all[row].limited);
    for (const StudyColumn& c : s_.columns) {
      const double x = all.empty() ? kNaN : c.of(all[row].metrics);
      text += std::isfinite(x) ? ',' + io::number_text(x) : ",";
    }
    text += '\n';
  }
  return text;
}

}  // namespace stribeck::workflow
