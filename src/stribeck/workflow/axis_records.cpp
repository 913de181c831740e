// The logs of one axis, cleaned and put together; those that move apart from those that stand.
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <stribeck/ident/log/condition.hpp>
#include <stribeck/ident/methods/position_map.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/io/log/log.hpp>
#include <stribeck/report/said_once.hpp>
#include <stribeck/workflow/identify.hpp>
#include <stribeck/workflow/log/encoders.hpp>
#include <stribeck/workflow/log/fingerprint.hpp>
#include <stribeck/workflow/log/log_axis.hpp>
#include <stribeck/workflow/machine/axis_units.hpp>

namespace stribeck::workflow {
namespace {

/// A log, cleaned.
struct CleanedLog {
  std::string name;
  bool rotary = false;
  ident::log::Conditioned log;
  std::optional<ident::lost_motion::Positions> encoders{};
  std::vector<std::string> notes;
};

CleanedLog cleaned(const io::Log& log, const std::string& name, const LogOptions& options) {
  CleanedLog out;
  out.name = name;
  // Cleaning the log finds the gaps again and repairs them.
  for (const io::Note& note : log.notes) {
    if (note.about != io::Note::About::kGaps) out.notes.push_back(note.text);
  }
  LoggedAxis logged = logged_axis(log, options);
  out.notes.insert(out.notes.end(), logged.notes.begin(), logged.notes.end());
  out.rotary = logged.rotary;
  out.log = condition_axis(std::move(logged), log.source, options);
  for (const ident::log::Finding& f : out.log.findings) out.notes.push_back(f.text);
  out.encoders = both_encoders(log, options, out.notes);
  return out;
}

/// The records of one axis, log by log.
class RecordsOfAxis {
 public:
  explicit RecordsOfAxis(const LogOptions& options) {
    axis_.axis = options.axis;
    axis_.control_period = control_period(options);
    axis_.balanced = options.drive.balanced;
    axis_.weighted = options.drive.weighted;
  }

  void add(CleanedLog log) { logs_.push_back(std::move(log)); }

  [[nodiscard]] AxisRecords all() && {
    std::vector<Fingerprint> prints;
    for (const CleanedLog& log : logs_) prints.emplace_back(log.log.records);
    const std::vector<std::optional<std::size_t>> holders = holders_of(prints);
    for (std::size_t i = 0; i < logs_.size(); ++i) {
      if (holders[i]) axis_.notes.push_back(copy_note(logs_[i].name, logs_[*holders[i]].name));
    }
    for (std::size_t i = 0; i < logs_.size(); ++i) {
      if (!holders[i]) take(std::move(logs_[i]));
    }
    for (std::string& note : report::said_once(notes_, names_)) axis_.notes.push_back(std::move(note));
    constexpr double kFewRows = 100.0;  // fewer rows in a direction come from settling
    constexpr double kShare = 0.1;      // of a short log
    const double least = std::min(kFewRows, kShare * moving_);
    axis_.one_direction = !(forward_ > least) || !(backward_ > least);
    return std::move(axis_);
  }

 private:
  void take(CleanedLog log) {
    constexpr double kFewForward = 0.002;  // share of the moving rows; fewer are noise at standstill
    if (axis_.rotary) std::erase(log.notes, kRotaryNote);  // said of the first log
    axis_.rotary = axis_.rotary || log.rotary;
    for (const ident::log::Finding& f : log.log.findings) {
      if (f.kind == "irregular") axis_.irregular = log.name;
      if (f.kind == "commanded") axis_.commanded = log.name;
    }
    if (log.encoders) axis_.encoders.push_back(std::move(*log.encoders));
    for (const std::string& note : log.notes)
      notes_.push_back(note.starts_with(log.name) ? note : log.name + ": " + note);
    names_.push_back(log.name);
    const ident::log::Conditioned& clean = log.log;
    const double moving = static_cast<double>(clean.sampling.rows) * clean.coverage.moving;
    const auto counts = [&](double share) { return share > kFewForward ? share * moving : 0.0; };
    moving_ += moving;
    forward_ += counts(clean.coverage.forward);
    backward_ += counts(1.0 - clean.coverage.forward);
    axis_.runs += clean.run.empty() ? 1 : 1 + *std::max_element(clean.run.begin(), clean.run.end());
    for (ident::log::Record& r : log.log.records) axis_.records.push_back(std::move(r));
    axis_.sources += (axis_.sources.empty() ? "" : ", ") + log.name;
  }

  AxisRecords axis_;
  std::vector<std::string> notes_;
  std::vector<std::string> names_;
  std::vector<CleanedLog> logs_;
  double moving_ = 0.0;   ///< rows of all logs
  double forward_ = 0.0;  ///< those of them that go forward
  double backward_ = 0.0;
};

}  // namespace

AxisRecords read_axis(const std::vector<std::string>& logs, const LogOptions& options) {
  RecordsOfAxis records(options);
  for (const std::string& path : logs) records.add(cleaned(read_log(path, options), path, options));
  return std::move(records).all();
}

AxisRecords measured(AxisRecords axis) {
  if (axis.commanded.empty()) return axis;
  throw ident::Refused(
      axis.commanded +
      ": the position is its command and no measured one, so that it tells neither mass nor friction of the axis: record the position "
      "of the encoder, or map its column (--map x=...); --keep commanded takes the log all the same");
}

AxisRecords axis_records(const std::vector<io::Log>& logs, const LogOptions& options) {
  RecordsOfAxis records(options);
  for (const io::Log& log : logs) records.add(cleaned(log, log.source, options));
  return std::move(records).all();
}

namespace {

/// `each(add)` calls add(log, name) for every log, one after the other.
template <class Each>
std::pair<AxisRecords, Identification> identify_apart(std::size_t count, const Each& each,
                                                      const LogOptions& options, const IdentifyOptions& how) {
  RecordsOfAxis moving(options), standing(options);
  bool moves = false;
  bool stands = false;
  each([&](const io::Log& log, const std::string& name) {
    CleanedLog clean = cleaned(log, name, options);
    const bool held = count > 1 && ident::methods::held_at_standstill(clean.log.records);
    (held ? stands : moves) = true;
    (held ? standing : moving).add(std::move(clean));
  });
  AxisRecords axis = std::move(moves ? moving : standing).all();
  if (how.for_axis_file && !axis.records.empty())
    require_axis_file_units(axis.records.front().force_unit, axis.records.front().position_unit);
  Identification found = identify(axis, how);
  if (!moves || !stands) return {std::move(axis), std::move(found)};
  const AxisRecords held = std::move(standing).all();
  // The options are for logs that move: at standstill there is no travel of a turn, no mass and no map of velocity.
  found.beside.push_back(identify(held, {}).result);
  axis.sources += ", " + held.sources;
  return {std::move(axis), std::move(found)};
}

}  // namespace

std::pair<AxisRecords, Identification> identify_logs(const std::vector<std::string>& logs,
                                                     const LogOptions& options, const IdentifyOptions& how) {
  const auto each = [&](const auto& add) {
    for (const std::string& path : logs) add(read_log(path, options), path);
  };
  return identify_apart(logs.size(), each, options, how);
}

std::pair<AxisRecords, Identification> identify_logs(const std::vector<io::Log>& logs,
                                                     const LogOptions& options, const IdentifyOptions& how) {
  const auto each = [&](const auto& add) {
    for (const io::Log& log : logs) add(log, log.source);
  };
  return identify_apart(logs.size(), each, options, how);
}

}  // namespace stribeck::workflow
