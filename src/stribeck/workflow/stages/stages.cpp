#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include <stribeck/ident/digits.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/json.hpp>
#include <stribeck/io/sha256.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/report/shell_words.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/workflow/excitation.hpp>
#include <stribeck/workflow/identify.hpp>
#include <stribeck/workflow/judge/verify.hpp>
#include <stribeck/workflow/log/logs_by_axis.hpp>
#include <stribeck/workflow/log/names/column_words.hpp>
#include <stribeck/workflow/machine/axis_units.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <stribeck/workflow/machine/of_machine_file.hpp>
#include <stribeck/workflow/stages/sorted_logs.hpp>
#include <stribeck/workflow/stages/stages.hpp>

namespace stribeck::workflow {
namespace {

namespace fs = std::filesystem;
using io::Json;
using report::CommissionStage;
using Axis = report::CommissionedAxisReport;

constexpr double kMassKnown = 0.1;  // half width of its interval, as a share
constexpr std::string_view kVerify = "verify";

std::string name_in(const std::string& path) { return fs::path(path).filename().string(); }

/// Whether an excitation was recorded, by the name that excite was given here. The motion of a log that is named after another axis, as
/// x-sine.csv, is that of the other axis.
bool recorded(const std::vector<std::string>& logs, const std::string& method, const std::string& axis,
              const std::vector<std::string>& others) {
  return std::any_of(logs.begin(), logs.end(), [&](const std::string& log) {
    const std::string name = name_in(log);
    const std::vector<std::string> words = words_of_name(fs::path(log).stem().string());
    const auto has = [&](const std::string& word) {
      return std::find(words.begin(), words.end(), io::lower_case(word)) != words.end();
    };
    if (!has(axis) && std::any_of(others.begin(), others.end(), has)) return false;
    const bool other = method == "sine" && (name.find("position-sine") != std::string::npos ||
                                            name.find("multisine") != std::string::npos);
    return !other && name.find(method) != std::string::npos;
  });
}

/// What one identification from some of the logs gives.
struct Candidate {
  AxisRecords records;
  Identification found;
};

bool mass_known(const ident::Result& r) {
  return r.mass > 0.0 && r.mass_interval.high - r.mass_interval.low <= 2.0 * kMassKnown * r.mass;
}

/// The axis file cannot be written, as where a file of somebody else stands.
struct NoPlaceForFile : io::InputError {
  using io::InputError::InputError;
};

class AxisStages {
 public:
  /// `own`: SHA-256 of the axis file that an earlier command wrote; empty: none.
  AxisStages(const StageOptions& options, const MachineDescription& machine, LogsOfAxis logs, std::string own)
      : options_(options),
        description_(machine.axis(logs.axis)),
        known_(of_machine_file(machine, logs.axis)),
        logs_(std::move(logs)),
        own_(std::move(own)) {
    axis_.axis = logs_.axis;
    for (const auto& one : machine.axes)
      if (one.first != logs_.axis) other_axes_.push_back(one.first);
  }

  /// One axis that cannot be judged, or whose logs are wrong, does not end the others.
  Axis run() {
    try {
      axis_ = judged();
    } catch (const ident::Refused& e) {
      refused(e.what());
    } catch (const NoPlaceForFile&) {
      throw;
    } catch (const io::InputError& e) {
      refused(e.what());
    }
    name_old_file();
    return axis_;
  }

 private:
  Axis judged() {
    if (logs_.logs.empty()) {
      axis_.open.push_back("no log of this axis");
      record("sine");
      return axis_;
    }
    std::optional<Candidate> chosen;
    std::vector<std::string> said;
    for (const std::string& candidate : held_out_candidates()) {
      std::vector<std::string> others = logs_.logs;
      std::erase(others, candidate);
      chosen = with_known_mass(others);
      if (!chosen && is_named_verify(candidate)) {
        chosen = with_one_left_out(others, said);
        if (!chosen)
          said.push_back(fmt::format(
              "{} is used for the identification, although its name says verify: the other logs alone do not determine the mass",
              candidate));
      }
      if (!chosen) continue;
      axis_.held_out = candidate;
      axis_.logs = others;
      break;
    }
    axis_.open.clear();
    if (!scale_missing_.empty()) return without_scale();
    if (!chosen) return not_verified();
    describe(*chosen);
    axis_.warnings.insert(axis_.warnings.begin(), said.begin(), said.end());
    verify_and_promote(*chosen);
    return axis_;
  }

  void refused(const std::string& why) {
    refuse("the model cannot be used, and no axis file was written: " + why, logs_.logs);
  }
  void refuse(const std::string& why, const std::vector<std::string>& logs) {
    axis_.stage = CommissionStage::kRefused;
    axis_.axis_file.clear();
    axis_.open.push_back(why);
    axis_.next = {fmt::format("stribeck identify {} {} --axis {} --report identify-{}",
                              report::shell_quoted(options_.machine), report::shell_quoted(logs), axis_.axis,
                              axis_.axis)};
  }

  /// An axis file of an earlier command stays, and nobody shall take it for the result of this one.
  void name_old_file() {
    const std::string path = options_.output + "/" + axis_.axis + ".toml";
    if (std::error_code ignored; axis_.axis_file.empty() && fs::exists(path, ignored))
      axis_.open.push_back(path + " is still that of earlier logs");
  }

  static bool is_named_verify(const std::string& log) {
    return name_in(log).find(kVerify) != std::string::npos;
  }

  /// Absent: they do not determine the mass.
  std::optional<Candidate> with_known_mass(const std::vector<std::string>& logs) {
    std::optional<Candidate> found = identified(logs);
    if (found && !mass_known(found->found.result)) found.reset();
    return found;
  }

  /// A log that tells little of the mass, as slow jogs do, may make its interval wider: without it the others may tell it. The logs are
  /// then those that were used.
  std::optional<Candidate> with_one_left_out(std::vector<std::string>& logs, std::vector<std::string>& said) {
    if (logs.size() < 2 || !scale_missing_.empty()) return std::nullopt;
    std::vector<std::string> order = logs;
    std::stable_partition(order.begin(), order.end(), [](const std::string& log) {
      return name_in(log).find("jog") != std::string::npos ||
             name_in(log).find("stroke") != std::string::npos;
    });
    for (const std::string& log : order) {
      std::vector<std::string> fewer = logs;
      std::erase(fewer, log);
      std::optional<Candidate> found = with_known_mass(fewer);
      if (!found) continue;
      logs = fewer;
      said.push_back(
          fmt::format("{} is left out: with it the mass is not determined, without it it is", log));
      return found;
    }
    return std::nullopt;
  }

  std::optional<Candidate> identified(const std::vector<std::string>& logs) {
    if (logs.empty()) return std::nullopt;
    try {
      auto [records, found] = identify_logs(logs, logs_.options, {});
      if (found.result.force_unit != "N" || found.result.position_unit != "m") {
        scale_missing_ = missing_scale(found.result);
        return std::nullopt;
      }
      return Candidate{std::move(records), std::move(found)};
    } catch (const ident::Refused& e) {
      axis_.open.push_back(e.what());
      return std::nullopt;
    }
  }

  /// What a log in units of its own lacks. Its numbers are no newtons and millimetres and are not shown as such.
  [[nodiscard]] std::string missing_scale(const ident::Result& r) const {
    std::string what;
    if (r.position_unit != "m") what = "the position is an angle";
    if (r.force_unit != "N")
      what += fmt::format("{}the force of the logs is in {}, whose scale is not known",
                          what.empty() ? "" : " and ", r.force_unit);
    const char* keys = r.force_unit == "A"   ? "torque_constant and lead"
                       : r.force_unit == "V" ? "voltage_at_rated, rated_torque and lead"
                       : r.force_unit == "N" ? "lead"
                                             : "rated_torque and lead";
    return fmt::format(
        "{} (write {}, or what else the data sheet says, into [axes.{}.drive] of {}, or give "
        "{} for this axis alone: --axis {})",
        what, keys, axis_.axis, options_.machine,
        r.position_unit == "m" ? "--gain"
        : r.force_unit == "N"  ? "--lead (of a rotary axis an angle, \"360 deg\" without a gear)"
                               : "--gain and --lead (of a rotary axis an angle, \"360 deg\" without a gear)",
        axis_.axis);
  }

  Axis without_scale() {
    axis_.stage = CommissionStage::kNotDetermined;
    axis_.logs = logs_.logs;
    axis_.open = {scale_missing_};
    axis_.next = {fmt::format("stribeck machine {}", report::shell_quoted(options_.machine))};
    return axis_;
  }

  /// Logs to hold out, the most suitable one first.
  [[nodiscard]] std::vector<std::string> held_out_candidates() const {
    std::vector<std::string> order(logs_.logs.rbegin(), logs_.logs.rend());
    std::stable_partition(order.begin(), order.end(), is_named_verify);
    return order;
  }

  void describe(const Candidate& c) {
    const ident::Result& r = c.found.result;
    axis_.rotary = r.rotary;
    axis_.mass = r.mass;
    axis_.mass_low = r.mass_interval.low;
    axis_.mass_high = r.mass_interval.high;
    axis_.load = r.load;
    axis_.velocity_low = r.velocity_range[0];
    axis_.velocity_high = r.velocity_range[1];
    axis_.open.insert(axis_.open.end(), r.cannot_tell.begin(), r.cannot_tell.end());
    constexpr double kFarBelow = 0.25;  // of the speed of the axis
    const double reached = std::max(std::abs(axis_.velocity_low), std::abs(axis_.velocity_high));
    if (const AxisUnits& u = units_of(r.rotary); reached < kFarBelow * description_.limits.speed)
      axis_.open.push_back(fmt::format(
          "friction above {} {}/s is not known, and the axis may move at {} {}/s: add constant-acceleration or a faster sine",
          report::significant(u.per_metre * reached, 3), u.travel,
          report::significant(u.per_metre * description_.limits.speed, 3), u.travel));
    axis_.read = c.records.notes;
    const std::size_t read = std::min(c.records.notes.size(), r.warnings.size());
    axis_.warnings.assign(r.warnings.begin() + static_cast<std::ptrdiff_t>(read), r.warnings.end());
    const std::string travel = travel_contradiction(description_, c.records.records);
    if (!travel.empty()) axis_.warnings.push_back(travel);
    const std::string friction = friction_unlike_file(description_, r);
    if (!friction.empty()) axis_.warnings.push_back(friction);
    const std::vector<std::string> wrong = contradictions(c);
    axis_.warnings.insert(axis_.warnings.end(), wrong.begin(), wrong.end());
  }

  /// Where log and machine file cannot both be right: with one of their scales wrong, every number of an axis file would be.
  [[nodiscard]] std::vector<std::string> contradictions(const Candidate& c) const {
    const ident::Result& r = c.found.result;
    std::vector<std::string> all{
        mass_contradiction(description_, r.mass_interval.low, r.mass_interval.high),
        r.force_unit == "N" ? load_contradiction(description_, r.load) : std::string(),
        speed_contradiction(description_, c.records.records),
        force_contradiction(description_, c.records.records)};
    std::erase(all, std::string());
    return all;
  }

  /// A model that a log has shown to be right stays out while the machine file says other numbers: a wrong scale is in both logs.
  void contradicted(const std::vector<std::string>& wrong) {
    refuse(fmt::format("log and machine file contradict each other, and no axis file was written: {}",
                       report::joined(wrong, "; ")),
           axis_.logs);
    std::erase_if(axis_.warnings, [&](const std::string& warning) {
      return std::find(wrong.begin(), wrong.end(), warning) != wrong.end();
    });
    axis_.next = {fmt::format(
        "correct {} or the scale of the logs, and give this command again (stribeck machine {} shows what follows from "
        "the file)",
        options_.machine, report::shell_quoted(options_.machine))};
  }

  /// No log can be held out: the model of all of them, if they determine one.
  Axis not_verified() {
    const std::optional<Candidate> all = identified(logs_.logs);
    if (!scale_missing_.empty()) return without_scale();
    if (!all || !mass_known(all->found.result)) return not_determined(all);
    axis_.logs = logs_.logs;
    describe(*all);
    axis_.stage = CommissionStage::kNotVerified;
    axis_.open.push_back("no log is left to verify the model: the others alone do not determine the mass");
    record("position-sine");
    return axis_;
  }

  Axis not_determined(const std::optional<Candidate>& all) {
    axis_.stage = CommissionStage::kNotDetermined;
    axis_.logs = logs_.logs;
    if (all) {
      describe(*all);
      axis_.open.push_back(
          fmt::format("the mass is known to {} %, expected {:g} %",
                      ident::digits(50.0 * (axis_.mass_high - axis_.mass_low) / std::abs(axis_.mass), 2),
                      100.0 * kMassKnown));
    }
    for (const char* method : {"constant-acceleration", "sine", "jog"}) {
      if (recorded(logs_.logs, method, logs_.axis, other_axes_)) continue;
      record(method);
      return axis_;
    }
    axis_.open.push_back("sine, constant-acceleration and jog are recorded: look at what the logs contain");
    axis_.next.push_back(fmt::format("stribeck identify --inspect {} --axis {}",
                                     report::shell_quoted(logs_.logs), axis_.axis));
    return axis_;
  }

  /// The command that designs the log to record next.
  void record(const std::string& method) {
    const std::string suffix = axis_.stage == CommissionStage::kNotVerified ? std::string(kVerify) : method;
    axis_.next.push_back(fmt::format("stribeck excite {} --axis {} --method {} -o {}-{}-reference.csv{}",
                                     report::shell_quoted(options_.machine), axis_.axis, method, axis_.axis,
                                     suffix, gcode_option(axis_.axis, axis_.axis + "-" + suffix)));
    axis_.next.push_back(fmt::format("run it, record it as {}/{}-{}.csv, and give this command again",
                                     options_.folder, axis_.axis, suffix));
  }

  void verify_and_promote(const Candidate& chosen) {
    const sim::AxisFile file = axis_file(chosen.found, chosen.records, known_);
    const std::string text = io::write_toml(
        file, fmt::format("Axis {}: {}, identified from {} by stribeck {} ({}), verified on {}.", axis_.axis,
                          chosen.found.result.model, chosen.records.sources, options_.version,
                          ident::name_of(chosen.found.result.method), axis_.held_out));
    const std::string path = options_.output + "/" + axis_.axis + ".toml";
    VerifyOptions what;
    what.log = logs_.options;
    what.logs = {axis_.held_out};
    what.limits = options_.limits;
    what.models = {{path, file}};
    std::string why = why_unreadable(text);
    // With such a scale every number of the file would be wrong. Each log by itself: they may have other zeros.
    constexpr double kFarBeyond = 1.5;
    for (const ident::log::Record& one : chosen.records.records)
      if (why.empty()) why = travel_contradiction(description_, {one}, kFarBeyond);
    if (!why.empty()) return refused(why);
    const report::VerifyReportInput judged = verify(what);
    const report::Verdict verdict = report::verdicts(judged).front();
    axis_.force_error = 100.0 * verdict.error;
    axis_.verdict = name_of(verdict.grade);
    if (verdict.grade == report::Grade::kUndecided) {
      axis_.stage = CommissionStage::kNotVerified;
      axis_.open.push_back(fmt::format(
          "{} cannot show whether the model is right, so the model is not promoted: noise, resolution and the time between its rows make a right model miss up to {:.3g} % of the force",
          axis_.held_out, 100.0 * verdict.of_log));
      record("position-sine");
      return;
    }
    if (!report::usable(judged)) {
      refuse(fmt::format("the model fails on {} and is not promoted; expected at most {:g} %", axis_.held_out,
                         options_.limits.usable),
             axis_.logs);
      return;
    }
    std::vector<std::string> wrong = contradictions(chosen);
    // A file that says nothing of a load contradicts none: that stays a warning.
    if (description_.commissioning.load.empty())
      std::erase(wrong, load_contradiction(description_, chosen.found.result.load));
    if (!wrong.empty()) return contradicted(wrong);
    if (std::error_code ignored; fs::exists(path, ignored) && io::sha256_of_file(path) != own_)
      throw NoPlaceForFile(io::Problem{
          path,
          0,
          {},
          "was not written by this command, or has been changed since: it is not replaced (move it away, or choose another --output)"});
    try {
      io::write_atomically(path, text);
    } catch (const io::InputError& e) {
      throw NoPlaceForFile(e.problems());
    }
    axis_.stage = CommissionStage::kReady;
    axis_.axis_file = path;
    axis_.axis_file_sha256 = io::hexadecimal(io::sha256(text));
    axis_.next.push_back(
        fmt::format("stribeck export {} --to all -o exports-{}", report::shell_quoted(path), axis_.axis));
  }

  const StageOptions& options_;
  const AxisDescription& description_;
  OfMachineFile known_;
  LogsOfAxis logs_;
  std::string own_;
  std::vector<std::string> other_axes_;
  std::string scale_missing_;  ///< what the units of the logs lack; empty: nothing
  Axis axis_;
};

/// What the result of an axis depends on.
std::string key_of(const StageOptions& o, const LogsOfAxis& logs) {
  std::string all = fmt::format("{}\n{}\n{}\n{}\n{}\n{:g} {:g}\n", o.version, io::sha256_of_file(o.machine),
                                o.machine, o.folder, o.output, o.limits.good, o.limits.usable);
  const LogOptions& l = logs.options;
  for (const auto* list : {&l.maps, &l.where, &l.runs, &l.keep}) all += report::joined(*list, "\n") + "\n\n";
  all += fmt::format("{}\n{}\n{}\n{}\n", l.axis, l.gain, l.lead, l.sample_time);
  for (const std::string& log : logs.logs) {
    all += log + " " + io::sha256_of_file(log);
    // A side file says how its log is read.
    if (const std::string side = log + ".toml"; fs::exists(side)) all += " " + io::sha256_of_file(side);
    all += "\n";
  }
  return io::hexadecimal(io::sha256(all));
}

constexpr std::string_view kSchema = "stribeck.commission-state/1";

/// Results of earlier commands, by axis: {"key", "result"}; empty where there is no such file. A file that is no state is refused.
Json read_state(const std::string& path) {
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return Json::object();
  const Json state = Json::parse(io::read_text(path), nullptr, false);
  if (!state.is_object() || state.value("schema", "") != kSchema || !state.contains("axes") ||
      !state["axes"].is_object())
    throw io::InputError(
        {path, 0, {}, "is no state of stribeck commission (remove it: everything is then computed again)"});
  return state["axes"];
}

/// The stored result of an axis; absent: its inputs are others, or its axis file is gone or was changed.
std::optional<Axis> stored(const Json& state, const std::string& axis, const std::string& key) {
  const auto at = state.find(axis);
  Axis out;
  if (at == state.end() || !at->is_object() || at->value("key", "") != key || !at->contains("result") ||
      !report::read_axis_state((*at)["result"], out))
    return std::nullopt;
  std::error_code ignored;
  if (!out.axis_file.empty() && (!fs::exists(out.axis_file, ignored) ||
                                 io::sha256_of_file(out.axis_file) != at->value("axis_file_sha256", "")))
    return std::nullopt;
  out.unchanged = true;
  return out;
}

}  // namespace

report::CommissionReportInput commission_from_logs(const StageOptions& o) {
  const MachineDescription description = read_description(o.machine);
  report::CommissionReportInput input;
  input.machine = description.name;
  const std::vector<LogsOfAxis> all = sorted_logs(o, description, input.skipped);
  if (all.empty())
    throw io::InputError(
        {{},
         0,
         "--axis",
         fmt::format("got {}, which {} does not have", io::in_quotes(o.log.axis), o.machine)});
  const std::string path = o.output + "/commission.json";
  Json state = read_state(path);
  io::make_directory(o.output);
  std::exception_ptr no_place;  // the other axes are done first, and known to the next command
  for (const LogsOfAxis& logs : all) {
    const std::string key = key_of(o, logs);
    if (const auto known = stored(state, logs.axis, key)) {
      input.axes.push_back(*known);
      continue;
    }
    std::string own;
    if (const auto at = state.find(logs.axis); at != state.end() && at->is_object())
      own = at->value("axis_file_sha256", "");
    Axis axis;
    try {
      axis = AxisStages(o, description, logs, own).run();
    } catch (const NoPlaceForFile&) {
      if (!no_place) no_place = std::current_exception();
      continue;
    }
    Json entry{{"key", key}, {"result", report::to_json(axis)}};
    entry["axis_file_sha256"] = axis.axis_file.empty() ? own : axis.axis_file_sha256;
    state[logs.axis] = std::move(entry);
    input.axes.push_back(axis);
  }
  io::write_atomically(path, io::dump({{"schema", kSchema}, {"axes", state}}));
  if (no_place) std::rethrow_exception(no_place);
  return input;
}

}  // namespace stribeck::workflow
