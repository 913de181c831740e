#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <memory>
#include <stribeck/core/numbers.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/units.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/sim/in_order.hpp>
#include <stribeck/workflow/study/results_file.hpp>
#include <stribeck/workflow/study/study.hpp>
#include <stribeck/workflow/study/study_runs.hpp>
#include <stribeck/workflow/study/uncertain_models.hpp>
#include <thread>
#include <vector>

namespace stribeck::workflow {
namespace {

std::string head_of(const Study& s) {
  std::string head = "run,sample";
  for (const BoundFactor& f : s.factors) head += ',' + text_of_cell(f.head());
  head += ",controller,motion,state,at_limit_percent";
  for (const StudyColumn& c : s.columns) head += ',' + c.key;
  return head;
}

/// Everything on which the rows depend. The number of samples is not among it where more of them leave the earlier ones as they were.
std::string inputs_of(const Study& s, const Parameters& parameters, const StudyRuns& runner,
                      const std::string& version) {
  std::string study = io::write_toml(s.file);
  if (s.file.sampling == sim::Sampling::kRandom || s.file.sampling == sim::Sampling::kSobol) {
    const std::string line = fmt::format("samples = {}\n", s.file.samples);
    if (const auto at = study.find(line); at != std::string::npos) study.erase(at, line.size());
  }
  std::string text = fmt::format(
      "# What results.csv was made with. The study goes on with the same alone.\nversion = \"{}\"\n\n# study\n{}"
      "\n# machine\n{}",
      version, study, io::write_toml(s.machine));
  text += deviations_text(s.factors);
  for (const sim::ControllerSpec& c : s.spec.controllers)
    text += fmt::format("\n# controller {}\n{}", c.id, io::write_toml(c));
  for (const sim::MachineRuns::Calmed& c : runner.calmed())
    text += fmt::format("\n# controller {}, axis {}: disturbance observer in place of the Kalman observer\n",
                        s.spec.controllers[c.controller].id, s.machine.axes[s.axes[c.axis]].first);
  for (const sim::Travel& t : s.spec.travels)
    text += fmt::format("\n# motion: {}, {}, {} laps and {} to settle\n", report::clean_text(t.name),
                        t.pace_in_words(), io::number_text(t.laps), io::number_text(t.settle_laps));
  if (!s.path_checksum.empty()) text += fmt::format("# file of the path: SHA-256 {}\n", s.path_checksum);
  for (const std::size_t i : s.axes) {
    const sim::AxisKnowledge& k = parameters.knowledge[i];
    for (const auto& [kind, model] :
         {std::pair{"conventional", &k.conventional}, std::pair{"gaussian", &k.gaussian},
          std::pair{"eccentric", &k.eccentric}, std::pair{"whole", &k.whole}}) {
      if (*model)
        text += fmt::format("\n# axis {}, {} model of the compensators\n{}", s.machine.axes[i].first, kind,
                            io::write_toml(**model));
    }
    if (k.lost_motion)
      text += fmt::format("\n# axis {}, lost motion that is compensated\n{}", s.machine.axes[i].first,
                          io::write_toml(*k.lost_motion));
  }
  return text;
}

// ---- summary

/// Sums up the rows, one after the other.
class Summary {
 public:
  Summary(const Study& s, const StudyRuns& runner)
      : s_(s),
        runner_(runner),
        rows_(s.spec.travels.size() * s.spec.controllers.size()),
        lost_(rows_, 0),
        refused_(rows_, 0),
        spreads_(rows_ * s.columns.size()),
        group_(spreads_.size() * s.runs_per_sample()) {
    if (s.file.indices) indices_.assign(spreads_.size(), sim::SobolIndices(s.factors.size()));
  }

  void add(std::uint64_t line, const std::vector<std::string_view>& cells, const std::string& path) {
    const std::size_t begin = 2 + s_.factors.size();
    if (cells.size() != begin + 4 + s_.columns.size())
      throw io::InputError(io::Problem{path, line, {}, "is no row of this study"});
    const std::uint64_t number = line - 2;
    const std::size_t row = number % rows_;
    const std::uint64_t within = number / rows_ % s_.runs_per_sample();
    if (row == 0) beginning_ = runner_.beginning(number / rows_);
    const std::string_view& last = cells[begin + 1];
    const std::string_view own(cells[0].data(),
                               static_cast<std::size_t>(last.data() + last.size() - cells[0].data()));
    if (own != beginning_ + runner_.case_of(row)) throw changed(path, line);
    const std::string_view state = cells[begin + 2];
    if (state != kRunDone && state != kRunLost && state != kRunRefused) throw changed(path, line);
    const bool refused = state == kRunRefused;
    const bool any_figure = std::any_of(cells.begin() + static_cast<std::ptrdiff_t>(begin) + 4, cells.end(),
                                        [](std::string_view cell) { return !cell.empty(); });
    const bool at_limit = std::isfinite(number_of(cells[begin + 3], path, line));
    // A run that was done may have no figure: not every path has quadrants.
    if (refused == at_limit || (refused && any_figure)) throw changed(path, line);
    const bool lost = state == kRunLost;
    lost_[row] += lost ? 1 : 0;
    refused_[row] += refused ? 1 : 0;
    for (std::size_t c = 0; c < s_.columns.size(); ++c) {
      const std::size_t at = row * s_.columns.size() + c;
      double x = number_of(cells[begin + 4 + c], path, line);
      if (lost) x = kInfinity;
      // With indices, the other runs of a sample repeat values of A and B: they would count them several times.
      if (!std::isnan(x) && within < 2) spreads_[at].add(x);
      if (s_.file.indices) group_[at * s_.runs_per_sample() + within] = x;
    }
    if (s_.file.indices && row + 1 == rows_ && within + 1 == s_.runs_per_sample()) close_sample();
  }

  /// nominal: the runs on the machine as its file says it.
  report::StudyResult result(const std::vector<sim::RobustRun>& nominal, const Parameters& parameters) const {
    report::StudyResult r;
    r.machine = s_.machine.name;
    r.sampling = s_.file.sampling;
    r.samples = s_.samples;
    r.runs = s_.runs;
    r.seed = s_.file.seed;
    r.parameters = parameters.words;
    if (s_.file.identification == StudyIdentification::kRepeated)
      r.parameters += ", identified again in every sample under other noise";
    if (s_.file.identification == StudyIdentification::kOfEachMachine)
      r.parameters += ", each machine from its own logs";
    for (const BoundFactor& f : s_.factors) r.factors.push_back({f.key, f.in_words()});
    r.has_band = only_uncertainty(s_.factors);
    r.warnings = untold_at_rest(s_.machine, s_.factors);
    for (const sim::MachineRuns::Calmed& c : runner_.calmed()) {
      const sim::ControllerSpec& controller = s_.spec.controllers[c.controller];
      const std::string& axis = s_.machine.axes[s_.axes[c.axis]].first;
      const double delay =
          parameters.knowledge[s_.axes[c.axis]].model(controller.friction, axis).delay_or_none();
      r.warnings.push_back(without_kalman_observer(axis, delay / s_.machine.sample_time, controller.id));
    }
    for (const StudyColumn& c : s_.columns) {
      const std::string head(c.figure->head(s_.axes.size() == 1));
      const bool per_axis = std::holds_alternative<sim::Figure::OfAxis>(c.figure->member);
      r.columns.push_back({c.key, per_axis ? head + ' ' + s_.machine.axes[s_.axes[c.axis]].first : head,
                           std::string(c.figure->unit), c.figure->scale / c.figure->key_scale});
    }
    for (std::size_t row = 0; row < rows_; ++row) {
      const sim::ControllerSpec& controller = s_.spec.controllers[row % s_.spec.controllers.size()];
      report::StudiedRow one;
      one.controller = controller.id;
      one.label = controller.label;
      one.motion = motion_of(s_, row);
      one.lost = lost_[row];
      one.refused = refused_[row];
      one.nominal_lost = nominal[row].lost;
      for (std::size_t c = 0; c < s_.columns.size(); ++c) {
        const std::size_t at = row * s_.columns.size() + c;
        report::StudiedFigure f{s_.columns[c].of(nominal[row].metrics), spreads_[at], {}, 0};
        if (s_.file.indices) {
          f.index_samples = indices_[at].samples();
          for (std::size_t i = 0; i < s_.factors.size(); ++i) f.indices.push_back(indices_[at].index(i));
        }
        one.figures.push_back(std::move(f));
      }
      warn(one, r.warnings);
      r.rows.push_back(std::move(one));
    }
    warn_of_unknown(r);
    return r;
  }

 private:
  static io::InputError changed(const std::string& path, std::uint64_t line) {
    return io::InputError(io::Problem{
        path,
        static_cast<std::size_t>(line),
        {},
        "is no row that this study writes: the file was changed (delete this line and all behind it: the study computes them again)"});
  }

  /// NaN: the cell is blank.
  static double number_of(std::string_view cell, const std::string& path, std::uint64_t line) {
    if (cell.empty()) return kNaN;
    double x = kNaN;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), x);
    if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(x))
      throw changed(path, line);
    return x;
  }

  void close_sample() {
    const std::vector<unsigned char> counts = sim::bootstrap_counts(s_.file.seed, sample_++);
    const std::size_t n = s_.runs_per_sample();
    for (std::size_t at = 0; at < spreads_.size(); ++at) {
      const double* const f = &group_[at * n];
      if (!std::all_of(f, f + n, [](double x) { return std::isfinite(x); })) continue;
      indices_[at].add(f[0], f[1], std::span<const double>(f + 2, n - 2), counts);
    }
  }

  /// A figure that the study asks for and no run has would be missing from the tables without a word.
  void warn_of_unknown(report::StudyResult& r) const {
    if (s_.file.figures == StudyFile{}.figures) return;
    for (std::size_t c = 0; c < s_.columns.size(); ++c) {
      const bool any = std::any_of(r.rows.begin(), r.rows.end(), [&](const report::StudiedRow& row) {
        return row.figures[c].spread.count() > 0;
      });
      if (!any)
        r.warnings.push_back(fmt::format(
            "figure {}: no run has a value of it on this machine and path, so the tables do not show it",
            s_.columns[c].key));
    }
  }

  void warn(const report::StudiedRow& row, std::vector<std::string>& warnings) const {
    const std::string who = fmt::format("({}) at {}", row.controller, row.motion);
    if (row.refused > 0) {
      warnings.push_back(
          fmt::format("{}: {} of {} machines could not be simulated or identified; they are left out", who,
                      row.refused, s_.runs));
    }
    if (row.lost > 0 && s_.file.indices && !row.figures.empty()) {
      warnings.push_back(fmt::format("{}: the indices leave out {} of {} samples, in which a run was lost",
                                     who, s_.samples - row.figures.front().index_samples, s_.samples));
    }
  }

  const Study& s_;
  const StudyRuns& runner_;
  std::string beginning_;  ///< of the run whose rows are added
  std::size_t rows_;
  std::vector<std::uint64_t> lost_;
  std::vector<std::uint64_t> refused_;
  std::vector<sim::Spread> spreads_;  ///< row by row
  std::vector<sim::SobolIndices> indices_;
  std::vector<double> group_;  ///< results of the runs of one sample
  std::uint64_t sample_ = 0;
};

Summary sum_up(const Study& study, const StudyRuns& runner, const ResultsFile& file) {
  Summary summary(study, runner);
  for_each_row(file.path(), [&](std::uint64_t line, const std::vector<std::string_view>& cells) {
    summary.add(line, cells, file.path());
  });
  return summary;
}

/// What the processes of a study have in common: compensators, how a run is computed, where its rows go.
class Task {
 public:
  Task(const Study& study, const StudyOptions& options)
      : study_(study),
        options_(options),
        parameters_(parameters_of(study, options)),
        runner_(study, parameters_),
        inputs_(inputs_of(study, parameters_, runner_, options.version)) {}

  [[nodiscard]] const std::string& inputs() const { return inputs_; }
  [[nodiscard]] std::uint64_t rows() const { return runner_.rows(); }
  [[nodiscard]] std::unique_ptr<ResultsFile> open() const {
    return std::make_unique<ResultsFile>(options_.folder, inputs_,
                                         ResultsLayout{head_of(study_), runner_.rows(), study_.runs});
  }
  /// Refuses a changed file and draws that are no machine, before hours of runs.
  void check(const ResultsFile& file) const {
    if (file.finished() > 0) sum_up(study_, runner_, file);
    check_machines(study_, runner_.design(), file.finished(), options_.threads);
  }
  /// Runs that a process of several computes at a time: they keep all threads busy, fill the packs where the study has so many, and
  /// leave some for the others.
  [[nodiscard]] std::uint64_t at_a_time() const {
    constexpr std::uint64_t kShares = 16;
    return std::clamp(study_.runs / kShares, threads(), 2 * threads() * runner_.most_together());
  }
  [[nodiscard]] std::uint64_t threads() const {
    return options_.threads > 0 ? options_.threads : std::max(1U, std::thread::hardware_concurrency());
  }
  /// The rows of these runs, handed over in their order: take(run, rows).
  template <class Take>
  void compute(std::span<const std::uint64_t> runs, Take&& take) const {
    compute_some(
        runs.size(), [&](std::uint64_t i) { return runs[i]; }, take);
  }
  /// The same of all runs from `begin` on.
  template <class Take>
  void compute_from(std::uint64_t begin, Take&& take) const {
    compute_some(
        study_.runs - begin, [&](std::uint64_t i) { return begin + i; }, take);
  }
  void progress(std::uint64_t done) const {
    if (options_.progress) options_.progress(done, study_.runs);
  }
  [[nodiscard]] report::StudyResult result(ResultsFile& file) const {
    file.keep();
    report::StudyResult result = sum_up(study_, runner_, file).result(runner_.nominal(), parameters_);
    std::vector<std::string> first = parameters_.assumed;
    for (std::string& warning : coverage_of(study_.machine, study_.spec, parameters_))
      first.push_back(std::move(warning));
    result.warnings.insert(result.warnings.begin(), first.begin(), first.end());
    return result;
  }

 private:
  static Parameters parameters_of(const Study& study, const StudyOptions& options) {
    sim::CompareSpec spec = study.spec;
    spec.threads = options.threads;
    return get_parameters(study.machine, study.machine_file, study.parameters, spec);
  }

  /// Runs number(0) to number(count − 1), as many together as fill the packs where all threads have enough of them.
  template <class Number, class Take>
  void compute_some(std::uint64_t count, Number&& number, Take&& take) const {
    const std::uint64_t kept_busy = 2 * threads();
    const std::uint64_t together = std::clamp<std::uint64_t>(count / kept_busy, 1, runner_.most_together());
    const auto runs_of = [&](std::uint64_t block) {
      std::vector<std::uint64_t> runs;
      for (std::uint64_t i = block * together; i < std::min(count, (block + 1) * together); ++i)
        runs.push_back(number(i));
      return runs;
    };
    sim::in_order(
        0, (count + together - 1) / together, options_.threads,
        [&](std::uint64_t block) { return runner_.texts(runs_of(block)); },
        [&](std::uint64_t block, const std::vector<std::string>& rows) {
          for (std::size_t i = 0; i < rows.size(); ++i) take(number(block * together + i), rows[i]);
        });
  }

  const Study& study_;
  const StudyOptions& options_;
  Parameters parameters_;
  StudyRuns runner_;
  std::string inputs_;
};

constexpr std::chrono::milliseconds kLook{50};  // between two looks at what the others do

/// Computes blocks that nobody has; false: there is none.
bool compute_some(const Task& task, SharedRuns& shared) {
  std::vector<std::uint64_t> runs;
  while (runs.size() < task.at_a_time()) {
    const auto block = shared.claim();
    if (!block) break;
    for (std::uint64_t run = shared.begin_of(*block); run < shared.end_of(*block); ++run) runs.push_back(run);
  }
  std::string rows;
  task.compute(runs, [&](std::uint64_t run, const std::string& some) {
    rows += some;
    const std::uint64_t block = shared.block_of(run);
    if (run + 1 != shared.end_of(block)) return;
    shared.finish(block, rows);
    rows.clear();
  });
  return !runs.empty();
}

/// Whether these are the lines of one run: each begins with its number.
bool are_of_run(std::string_view lines, std::uint64_t run) {
  const std::string begin = std::to_string(run) + ',';
  while (!lines.empty()) {
    if (!lines.starts_with(begin)) return false;
    lines.remove_prefix(lines.find('\n') + 1);
  }
  return true;
}

/// Adds the rows of a block from the next run of the file on; false: they are damaged.
bool take_over(const std::string& rows, const Task& task, const SharedRuns& shared, std::uint64_t block,
               ResultsFile& file) {
  const auto lines = static_cast<std::uint64_t>(std::count(rows.begin(), rows.end(), '\n'));
  if (rows.empty() || rows.back() != '\n' ||
      lines != task.rows() * (shared.end_of(block) - shared.begin_of(block)))
    return false;
  std::size_t at = 0;
  for (std::uint64_t run = shared.begin_of(block); run < shared.end_of(block); ++run) {
    std::size_t end = at;
    for (std::uint64_t k = 0; k < task.rows(); ++k) end = rows.find('\n', end) + 1;
    const std::string_view own = std::string_view(rows).substr(at, end - at);
    if (!are_of_run(own, run)) return false;
    if (run == file.finished()) file.add(own);
    at = end;
  }
  return true;
}

/// Takes blocks over in order, and computes those that nobody has.
void lead(const Task& task, std::uint64_t runs, SharedRuns& shared, ResultsFile& file) {
  std::optional<std::uint64_t> shared_from;
  while (file.finished() < runs) {
    const std::uint64_t block = shared.block_of(file.finished());
    if (shared_from != block) shared.share_from(block);
    shared_from = block;
    if (const auto rows = shared.rows(block)) {
      if (!take_over(*rows, task, shared, block, file)) shared.discard(block);
      task.progress(file.finished());
    } else if (!compute_some(task, shared)) {
      std::this_thread::sleep_for(kLook);
    }
  }
  shared.close();
}

/// Null where another process leads, as long as it does.
std::unique_ptr<ResultsFile> open_if_free(const Task& task) {
  try {
    return task.open();
  } catch (const ResultsInUse&) {
    return nullptr;
  }
}

}  // namespace

report::StudyResult run_study(const Study& study, const StudyOptions& options) {
  const Task task(study, options);
  const auto file = task.open();
  task.check(*file);
  task.compute_from(file->finished(), [&](std::uint64_t run, const std::string& rows) {
    file->add(rows);
    task.progress(run + 1);
  });
  return task.result(*file);
}

std::optional<report::StudyResult> run_shared_study(const Study& study, const StudyOptions& options,
                                                    const SharedRuns::Note& note, SharedRuns::Pace pace) {
  const Task task(study, options);
  SharedRuns shared(options.folder, task.inputs(), study.runs, note, pace);
  for (bool helped = options.rank > 0;; helped = true) {
    if (const auto file = open_if_free(task)) {
      // The leader has ended, and has said the result.
      if (helped && file->finished() == study.runs) return std::nullopt;
      shared.clear_others();
      task.check(*file);
      lead(task, study.runs, shared, *file);
      return task.result(*file);
    }
    if (!shared.open() && shared.others())
      throw io::InputError(io::Problem{
          options.folder,
          0,
          {},
          "other processes share the runs of another study, machine or version there (choose another folder; processors of "
          "another kind may identify other last digits)"});
    if (!compute_some(task, shared)) std::this_thread::sleep_for(kLook);
  }
}

}  // namespace stribeck::workflow
