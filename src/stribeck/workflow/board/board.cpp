#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <stribeck/core/numbers.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/process/outside_program.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/io/write_at_once.hpp>
#include <stribeck/sim/axis_file.hpp>
#include <stribeck/sim/parallel.hpp>
#include <stribeck/workflow/board/board.hpp>
#include <stribeck/workflow/board/control.hpp>
#include <stribeck/workflow/board/identification.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::workflow {
namespace {

constexpr double kFailed = std::numeric_limits<double>::infinity();
constexpr std::size_t kAxes = 2;

/// A folder for logs and answers, which is removed at the end unless the user named it.
class Workspace {
 public:
  explicit Workspace(const std::string& named) : path_(named), keep_(!named.empty()) {
    if (keep_) {
      io::make_directory(path_);
      path_ = std::filesystem::absolute(path_).string();
      return;
    }
    std::string name = (std::filesystem::temp_directory_path() / "stribeck-board-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr)
      refuse_option("--output", "there is no folder for temporary files (name one)");
    path_ = name;
  }
  ~Workspace() {
    std::error_code ignored;
    if (!keep_) std::filesystem::remove_all(path_, ignored);
  }
  Workspace(const Workspace&) = delete;
  Workspace& operator=(const Workspace&) = delete;
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
  bool keep_;
};

/// An identification that takes part.
struct Identifier {
  report::BoardEntrant entrant;
  const BuiltInIdentifier* built_in = nullptr;
  const BoardEntry* entry = nullptr;
};

/// An answer with its score, or why there is none.
struct Judged {
  std::optional<BoardAnswer> answer;
  AnswerScore score{kFailed, kFailed, kFailed, 0.0, 0.0, kNaN, kNaN};
  std::string failure;
};

/// Everything of one machine.
struct OfMachine {
  std::vector<Judged> answers;              ///< identifier by identifier, axis by axis
  std::vector<BoardRun> runs;               ///< travel by travel, controller by controller; empty: no model
  std::shared_ptr<BoardControl> control{};  ///< for the costs
};

/// What cannot be compared comes last.
bool is_better(const report::BoardFigure& a, const report::BoardFigure& b) {
  const auto rank = [](double x) { return std::isnan(x) ? kFailed : x; };
  return rank(a.median.value) < rank(b.median.value);
}

class Board {
 public:
  explicit Board(const BoardOptions& options)
      : o_(options), workspace_(options.folder), machines_(board_machines(options.seed, options.machines)) {
    const auto runs = [&](std::string_view id) {
      return o_.only.empty() || std::find(o_.only.begin(), o_.only.end(), id) != o_.only.end();
    };
    for (const BuiltInIdentifier& b : built_in_identifiers()) {
      if (o_.built_in && runs(b.id)) identifiers_.push_back({{b.id, b.label, {}, false}, &b, nullptr});
    }
    if (o_.built_in) {
      for (BoardController& c : built_in_contestants()) {
        if (runs(c.spec.id)) controllers_.push_back(std::move(c));
      }
    }
    for (const BoardEntry& e : o_.entries) {
      if (!runs(e.name)) continue;
      if (e.track == Track::kIdentification) {
        identifiers_.push_back({{e.name, e.label, e.source, true}, nullptr, &e});
      } else {
        controllers_.push_back(contestant(e, o_.host));
        controllers_.back().answer_seconds = o_.answer_seconds;
      }
    }
    check();
  }

  [[nodiscard]] OfMachine run(std::uint32_t i) const;
  [[nodiscard]] report::BoardResult result(const std::vector<OfMachine>& all) const;

 private:
  void check() const;
  /// A reason without the folder of the work, whose name differs from run to run.
  [[nodiscard]] std::string told(std::string reason) const;
  [[nodiscard]] Judged judged(const Identifier& who, const BoardLogs& logs, std::uint32_t machine,
                              std::size_t axis, const std::vector<std::string>& files) const;
  /// The answer of a built-in method: that which is judged, or computed for the controllers alone.
  [[nodiscard]] std::optional<BoardAnswer> model_by(const char* id, const OfMachine& so_far,
                                                    const BoardLogs& logs, std::uint32_t machine,
                                                    std::size_t axis) const;
  void run_controllers(OfMachine& out, const std::vector<BoardLogs>& logs, std::uint32_t machine) const;
  [[nodiscard]] report::IdentificationRow identification_row(std::size_t which,
                                                             const std::vector<OfMachine>& all) const;
  [[nodiscard]] report::ControlRow control_row(std::size_t which, std::size_t travel,
                                               const std::vector<OfMachine>& all) const;

  const BoardOptions& o_;
  Workspace workspace_;
  std::vector<BoardMachine> machines_;
  std::vector<Identifier> identifiers_;
  std::vector<BoardController> controllers_;
};

void Board::check() const {
  std::vector<std::string> known;
  for (const BuiltInIdentifier& b : built_in_identifiers()) known.emplace_back(b.id);
  for (const BoardController& c : built_in_contestants()) known.push_back(c.spec.id);
  for (const BoardEntry& e : o_.entries) {
    if (std::find(known.begin(), known.end(), e.name) != known.end())
      refuse_option("ENTRY",
                    fmt::format("{} is the name of an entry that is built in (choose another)", e.name));
    if (!e.answers.empty() && !std::filesystem::is_directory(e.answers))
      refuse_option("--answers", fmt::format("there is no folder {}", io::in_quotes(e.answers)));
    if (!e.shared_object.empty() && !std::filesystem::exists(e.shared_object))
      refuse_option("--controller", fmt::format("there is no file {}", io::in_quotes(e.shared_object)));
  }
  for (const BoardEntry& e : o_.entries) known.push_back(e.name);
  check_names(o_.entries);
  for (const std::string& id : o_.only) {
    if (std::find(known.begin(), known.end(), id) != known.end()) continue;
    const std::string_view near = io::nearest(id, {known.begin(), known.end()});
    refuse_option("--only",
                  fmt::format("got {}, expected the name of an entry{}", io::in_quotes(id),
                              near.empty() ? std::string() : fmt::format(" (did you mean {}?)", near)));
  }
  if (identifiers_.empty() && controllers_.empty())
    refuse_option("--only", "no entry is left (leave out --no-built-in, or give an entry)");
}

std::string Board::told(std::string reason) const {
  const std::string folder = workspace_.path() + "/";
  for (std::size_t at = reason.find(folder); at != std::string::npos; at = reason.find(folder, at))
    reason.erase(at, folder.size());
  return reason;
}

Judged Board::judged(const Identifier& who, const BoardLogs& logs, std::uint32_t machine, std::size_t axis,
                     const std::vector<std::string>& files) const {
  const auto& [name, truth] = machines_[machine].machine.axes[axis];
  Judged j;
  try {
    j.answer = who.built_in != nullptr ? answer_of(*who.built_in, logs, name)
                                       : answer_of(*who.entry, machines_[machine], axis, files,
                                                   workspace_.path(), o_.identifier_seconds);
    j.score = full_score(*j.answer, truth, logs);
  } catch (const std::runtime_error& e) {
    // What refuses, fails or answers nonsense: a result, not an error of the board.
    j.answer.reset();
    j.failure = told(e.what());
  }
  return j;
}

std::optional<BoardAnswer> Board::model_by(const char* id, const OfMachine& so_far, const BoardLogs& logs,
                                           std::uint32_t machine, std::size_t axis) const {
  for (std::size_t k = 0; k < identifiers_.size(); ++k) {
    if (identifiers_[k].entrant.id == id) return so_far.answers[k * kAxes + axis].answer;
  }
  for (const BuiltInIdentifier& b : built_in_identifiers()) {
    if (std::string_view(b.id) == id) return judged({{}, &b, nullptr}, logs, machine, axis, {}).answer;
  }
  return {};
}

OfMachine Board::run(std::uint32_t i) const {
  OfMachine out;
  const BoardMachine& board = machines_[i];
  const auto outside = [](const Identifier& who) {
    return who.entry != nullptr && who.entry->answers.empty();
  };
  const bool files_wanted =
      !o_.folder.empty() || std::any_of(identifiers_.begin(), identifiers_.end(), outside);
  std::vector<BoardLogs> logs;
  std::vector<std::vector<std::string>> files(kAxes);
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    logs.push_back(board_logs(board, o_.seed, i, axis));
    if (files_wanted) files[axis] = write_logs(logs.back(), board, axis, workspace_.path());
  }
  for (const Identifier& who : identifiers_) {
    for (std::size_t axis = 0; axis < kAxes; ++axis)
      out.answers.push_back(judged(who, logs[axis], i, axis, files[axis]));
  }
  if (!controllers_.empty()) run_controllers(out, logs, i);
  return out;
}

void Board::run_controllers(OfMachine& out, const std::vector<BoardLogs>& logs, std::uint32_t machine) const {
  const BoardMachine& board = machines_[machine];
  std::vector<sim::AxisKnowledge> knowledge;
  std::vector<std::string> files;
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    const auto model = model_by("auto", out, logs[axis], machine, axis);
    if (!model) return;
    const auto conventional = model_by("least-squares", out, logs[axis], machine, axis);
    knowledge.push_back(board_knowledge(*model, conventional ? &*conventional : nullptr));
    files.push_back(workspace_.path() + "/" + name_of(board, axis) + "-model.toml");
    sim::AxisFile file;
    file.axis = board.machine.axes[axis].first;
    file.model = model->model;
    const io::WriteAtOnce now;  // other programs read it before the end of the command
    io::write_atomically(files.back(),
                         io::write_toml(file, "The model that every controller of the board gets."));
  }
  out.control =
      std::make_shared<BoardControl>(board, std::move(knowledge), std::move(files), o_.seed, machine);
  for (std::size_t travel = 0; travel < board_travels().size(); ++travel) {
    for (const BoardController& c : controllers_) {
      out.runs.push_back(out.control->run(c, travel));
      out.runs.back().failure = told(out.runs.back().failure);
    }
  }
  if (!o_.cost) out.control.reset();
}

report::IdentificationRow Board::identification_row(std::size_t which,
                                                    const std::vector<OfMachine>& all) const {
  report::IdentificationRow row;
  row.entrant = identifiers_[which].entrant;
  std::vector<double> curve;
  std::vector<double> mass;
  std::vector<double> held_out;
  std::vector<double> points;
  std::vector<double> covered;
  double width = 0.0;
  double widths = 0.0;
  double masses = 0.0;
  double mass_covered = 0.0;
  for (const OfMachine& m : all) {
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
      const Judged& j = m.answers[which * kAxes + axis];
      curve.push_back(j.score.curve_error);
      mass.push_back(j.score.mass_error);
      held_out.push_back(j.score.held_out_error);
      points.push_back(j.score.points);
      covered.push_back(j.score.covered);
      if (!std::isnan(j.score.half_width)) {
        width += j.score.half_width;
        widths += 1.0;
      }
      if (!std::isnan(j.score.mass_covered)) {
        mass_covered += j.score.mass_covered;
        masses += 1.0;
      }
      row.failures.push_back(j.failure);
    }
  }
  row.curve_error = board_figure(curve, kAxes, o_.seed);
  row.mass_error = board_figure(mass, kAxes, o_.seed);
  row.held_out_error = board_figure(held_out, kAxes, o_.seed);
  row.covered = board_share(covered, points, kAxes, o_.seed);
  row.half_width = widths > 0.0 ? width / widths : kNaN;
  row.covered_mass = masses > 0.0 ? 100.0 * mass_covered / masses : kNaN;
  return row;
}

report::ControlRow Board::control_row(std::size_t which, std::size_t travel,
                                      const std::vector<OfMachine>& all) const {
  const BoardController& c = controllers_[which];
  const sim::Travel& motion = board_travels()[travel];
  report::ControlRow row;
  row.entrant = {c.spec.id, c.spec.label, c.source, c.outside};
  row.motion = motion.name + " at " + motion.pace_in_words();
  std::vector<double> largest;
  std::vector<double> rms;
  std::vector<double> variation;
  for (const OfMachine& m : all) {
    // Without a model nobody could run on this machine.
    const bool none = m.runs.empty();
    const BoardRun run = none ? BoardRun{} : m.runs[travel * controllers_.size() + which];
    const bool bad = !run.failure.empty() || run.run.lost;
    row.lost += run.failure.empty() && run.run.lost ? 1 : 0;
    row.failures.push_back(run.failure);
    largest.push_back(none ? kNaN : bad ? kFailed : 1e6 * run.run.metrics.max_contour_error);
    rms.push_back(none ? kNaN : bad ? kFailed : 1e6 * run.run.metrics.rms);
    variation.push_back(none ? kNaN : bad ? kFailed : 1e3 * run.run.metrics.input_variation);
  }
  row.max_error = board_figure(largest, 1, o_.seed);
  row.rms = board_figure(rms, 1, o_.seed);
  row.input_variation = board_figure(variation, 1, o_.seed);
  return row;
}

report::BoardResult Board::result(const std::vector<OfMachine>& all) const {
  report::BoardResult r;
  r.seed = o_.seed;
  for (const BoardMachine& m : machines_) {
    r.machines.push_back(m.name);
    for (const auto& axis : m.machine.axes) r.axes.push_back(m.name + " " + axis.first);
  }
  for (std::size_t k = 0; k < identifiers_.size(); ++k)
    r.identification.push_back(identification_row(k, all));
  std::stable_sort(r.identification.begin(), r.identification.end(),
                   [](const auto& a, const auto& b) { return is_better(a.curve_error, b.curve_error); });
  for (std::size_t travel = 0; travel < board_travels().size(); ++travel) {
    const auto begin = static_cast<std::ptrdiff_t>(r.control.size());
    for (std::size_t k = 0; k < controllers_.size(); ++k) r.control.push_back(control_row(k, travel, all));
    std::stable_sort(r.control.begin() + begin, r.control.end(),
                     [](const auto& a, const auto& b) { return is_better(a.max_error, b.max_error); });
  }
  for (std::size_t i = 0; i < all.size() && !controllers_.empty(); ++i) {
    if (all[i].runs.empty())
      r.warnings.push_back(
          fmt::format("{}: method auto identified no model from its logs, so that no controller ran on it",
                      r.machines[i]));
    // Each motion would say the same.
    for (std::size_t k = 0; k < controllers_.size() && k < all[i].runs.size(); ++k) {
      for (const std::string& note : all[i].runs[k].notes)
        r.warnings.push_back(fmt::format("{}: {}", r.machines[i], note));
    }
  }
  // Alone, after everything else: other threads would be measured too.
  const auto with_model =
      std::find_if(all.begin(), all.end(), [](const OfMachine& m) { return m.control != nullptr; });
  if (with_model != all.end()) {
    for (const BoardController& c : controllers_) r.costs.push_back(with_model->control->cost(c));
  }
  return r;
}

}  // namespace

report::BoardResult run_board(const BoardOptions& options,
                              const std::function<void(std::size_t, std::size_t)>& progress) {
  const Board board(options);
  std::vector<OfMachine> all(options.machines);
  sim::parallel_for(
      all.size(), options.threads, [] { return 0; },
      [&](int&, std::size_t i) { all[i] = board.run(static_cast<std::uint32_t>(i)); }, progress);
  return board.result(all);
}

std::vector<std::string> write_board_logs(const std::string& folder, std::uint64_t seed,
                                          std::uint32_t machines, unsigned threads) {
  const std::vector<BoardMachine> all = board_machines(seed, machines);
  io::make_directory(folder);
  std::vector<std::vector<std::string>> written(all.size());
  sim::parallel_for(
      all.size(), threads, [] { return 0; },
      [&](int&, std::size_t i) {
        for (std::size_t axis = 0; axis < kAxes; ++axis) {
          const BoardLogs logs = board_logs(all[i], seed, static_cast<std::uint32_t>(i), axis);
          for (std::string& name : write_logs(logs, all[i], axis, folder))
            written[i].push_back(std::move(name));
        }
      });
  std::vector<std::string> names;
  for (auto& some : written) names.insert(names.end(), some.begin(), some.end());
  return names;
}

}  // namespace stribeck::workflow
