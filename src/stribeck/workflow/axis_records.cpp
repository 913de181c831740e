// The logs of one axis, cleaned and put together; those that move apart from those that stand.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <stribeck/ident/log/condition.hpp>
#include <stribeck/ident/methods/position_map.hpp>
#include <stribeck/io/log/log.hpp>
#include <stribeck/workflow/identify.hpp>
#include <stribeck/workflow/log/encoders.hpp>
#include <stribeck/workflow/log/log_axis.hpp>
#include <stribeck/workflow/machine/axis_units.hpp>

namespace stribeck::workflow {
namespace {

/// The records of one axis, log by log.
class RecordsOfAxis {
 public:
  explicit RecordsOfAxis(const LogOptions& options) : options_(options) { axis_.axis = options.axis; }

  void add(const io::Log& log, const std::string& name) {
    constexpr double kFewForward = 0.002;  // share of the moving rows; fewer are noise at standstill
    std::vector<std::string> notes;
    // Cleaning the log finds the gaps again and repairs them.
    for (const io::Note& note : log.notes) {
      if (note.about != io::Note::About::kGaps) notes.push_back(note.text);
    }
    LoggedAxis logged = logged_axis(log, options_);
    if (axis_.rotary) std::erase(logged.notes, kRotaryNote);  // said of the first log
    notes.insert(notes.end(), logged.notes.begin(), logged.notes.end());
    axis_.rotary = axis_.rotary || logged.rotary;
    ident::log::Conditioned clean = condition_axis(std::move(logged), log.source, options_);
    for (const ident::log::Finding& f : clean.findings) {
      notes.push_back(f.text);
      if (f.kind == "irregular") axis_.irregular = name;
    }
    if (auto encoders = both_encoders(log, options_, notes)) axis_.encoders.push_back(std::move(*encoders));
    for (std::string& note : notes) {
      axis_.notes.push_back(note.starts_with(name) ? std::move(note) : fmt::format("{}: {}", name, note));
    }
    forward_ = forward_ || clean.coverage.forward > kFewForward;
    backward_ = backward_ || clean.coverage.forward < 1.0 - kFewForward;
    axis_.runs += clean.run.empty() ? 1 : 1 + *std::max_element(clean.run.begin(), clean.run.end());
    for (ident::log::Record& r : clean.records) axis_.records.push_back(std::move(r));
    axis_.sources += (axis_.sources.empty() ? "" : ", ") + name;
  }

  [[nodiscard]] AxisRecords all() && {
    axis_.one_direction = forward_ != backward_;
    return std::move(axis_);
  }

 private:
  const LogOptions& options_;
  AxisRecords axis_;
  bool forward_ = false;
  bool backward_ = false;
};

}  // namespace

AxisRecords read_axis(const std::vector<std::string>& logs, const LogOptions& options) {
  RecordsOfAxis records(options);
  for (const std::string& path : logs) records.add(read_log(path, options), path);
  return std::move(records).all();
}

AxisRecords axis_records(const std::vector<io::Log>& logs, const LogOptions& options) {
  RecordsOfAxis records(options);
  for (const io::Log& log : logs) records.add(log, log.source);
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
    bool held = false;
    if (count > 1) {
      RecordsOfAxis alone(options);
      alone.add(log, name);
      held = ident::methods::held_at_standstill(std::move(alone).all().records);
    }
    (held ? stands : moves) = true;
    (held ? standing : moving).add(log, name);
  });
  AxisRecords axis = std::move(moves ? moving : standing).all();
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
