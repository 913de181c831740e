#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <utility>

#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/units.hpp>
#include <stribeck/workflow/inspect.hpp>
#include <stribeck/workflow/log/columns.hpp>
#include <stribeck/workflow/log/encoders.hpp>

namespace stribeck::workflow {
namespace {

constexpr std::size_t kMostColumns = 40;
constexpr std::size_t kMostNotes = 20;

std::string short_text(double value) { return fmt::format("{:.4g}", value); }

std::string header_of(const io::Column& c) {
  const std::string& header = c.header.empty() ? c.name : c.header;
  if (c.unit_text.empty() || header.find('[') != std::string::npos) return header;
  return c.unit_text == "1" ? header : header + " [" + c.unit_text + "]";
}

/// "x ≥ …" lines with a hanging indent.
void add_lines(std::string& out, const std::vector<std::string>& lines, const char* mark) {
  constexpr std::size_t kWidth = 108;
  for (const std::string& line : lines) {
    std::string rest = line;
    bool first = true;
    while (!rest.empty()) {
      std::size_t cut = rest.size();
      if (cut > kWidth) {
        cut = rest.rfind(' ', kWidth);
        if (cut == std::string::npos || cut == 0) cut = kWidth;
      }
      out += fmt::format("  {} {}\n", first ? mark : " ", rest.substr(0, cut));
      rest.erase(0, cut);
      rest.erase(
          0, rest.find_first_not_of(' ') == std::string::npos ? rest.size() : rest.find_first_not_of(' '));
      first = false;
    }
  }
}

/// Without the name of the file, which is in the heading.
std::string without_source(const std::string& text, const std::string& source) {
  return text.rfind(source + ": ", 0) == 0 ? text.substr(source.size() + 2) : text;
}

void add_columns(const io::Log& log, Inspection& out) {
  out.text += fmt::format("\nColumns ({})\n", log.columns.size());
  std::size_t shown = 0;
  for (const io::Column& c : log.columns) {
    nlohmann::ordered_json one{{"name", c.name}, {"unit", c.unit_text}};
    one["rows"] = c.texts.empty() ? c.values.size() : c.texts.size();
    std::string range = c.texts.empty() ? "text" : "text, such as " + io::in_quotes(c.texts.front());
    if (!c.values.empty()) {
      const auto [low, high] = std::minmax_element(c.values.begin(), c.values.end());
      range = *low == *high ? "always " + short_text(*low) : short_text(*low) + " to " + short_text(*high);
      one["min"] = *low;
      one["max"] = *high;
    }
    if (shown++ < kMostColumns) {
      const std::size_t rows = c.texts.empty() ? c.values.size() : c.texts.size();
      out.text += fmt::format("  {:<40} {}{}\n", header_of(c), range,
                              rows == log.rows ? "" : fmt::format("  ({} rows)", rows));
    }
    out.json["columns"].push_back(std::move(one));
  }
  if (log.columns.size() > kMostColumns)
    out.text += fmt::format("  and {} more\n", log.columns.size() - kMostColumns);
}

std::string every(double hold) { return hold > 1.0 ? fmt::format(", new every {:.4g} rows", hold) : ""; }

std::string step_text(double quantum, double large, const std::string& unit, double scale) {
  if (!(quantum > 0.0)) return "no steps seen";
  if (large > 1.5 * quantum)
    return fmt::format("steps of {:.3g} to {:.3g} {}", scale * quantum, scale * large, unit);
  return fmt::format("steps of {:.3g} {}", scale * quantum, unit);
}

void add_sampling(const ident::log::Conditioned& c, Inspection& out) {
  const ident::log::Sampling& s = c.sampling;
  const ident::log::Record& r = c.records.front();
  const bool angle = r.position_unit == "rad";
  const double scale = r.rotary ? 180.0 / kPi : angle ? 1.0 : 1e3;
  const std::string way = r.rotary ? "deg" : angle ? "rad" : "mm";
  const std::string force = r.rotary && r.force_unit == "N" ? "N m" : r.force_unit;
  out.text += "\nSampling\n";
  out.text += fmt::format("  time      {} rows, {:.6g} s, {:.6g} ms between rows, jitter {:.2g} %, {}\n",
                          s.rows, s.duration, 1e3 * s.logged_time, 100.0 * s.jitter,
                          s.gaps == 0 ? "no gap" : fmt::format("{} gaps", s.gaps));
  const bool integrated = std::any_of(c.findings.begin(), c.findings.end(),
                                      [](const ident::log::Finding& f) { return f.kind == "no-position"; });
  if (integrated) {
    out.text += "  position  integrated from the velocity\n";
  } else {
    out.text += fmt::format("  position  {}, noise {:.2g} {} RMS{}\n",
                            step_text(s.x_quantum, s.x_quantum_large, way, scale), scale * s.x_noise, way,
                            every(s.x_hold));
  }
  if (!r.v.empty()) {
    out.text +=
        fmt::format("  velocity  {}, noise {:.2g} {}/s RMS{}\n",
                    step_text(s.v_quantum, 0.0, way + "/s", scale), scale * s.v_noise, way, every(s.v_hold));
  }
  out.text += fmt::format("  force     {}, noise {:.2g} {} RMS{}\n", step_text(s.f_quantum, 0.0, force, 1.0),
                          s.f_noise, force, every(s.f_hold));
  out.json["sampling"] = {{"rows", s.rows},
                          {"duration_s", s.duration},
                          {"logged_sample_time_s", s.logged_time},
                          {"sample_time_s", s.sample_time},
                          {"jitter", s.jitter},
                          {"gaps", s.gaps},
                          {"position_step", s.x_quantum},
                          {"position_step_largest", s.x_quantum_large},
                          {"velocity_step", s.v_quantum},
                          {"force_step", s.f_quantum},
                          {"position_hold_rows", s.x_hold},
                          {"velocity_hold_rows", s.v_hold},
                          {"force_hold_rows", s.f_hold},
                          {"position_noise", s.x_noise},
                          {"velocity_noise", s.v_noise},
                          {"force_noise", s.f_noise}};
  const ident::log::Coverage& m = c.coverage;
  out.text += "\nMotion\n";
  out.text +=
      fmt::format("  from {:.6g} to {:.6g} {}, {:.4g} to {:.4g} {}/s, up to {:.4g} {}/s2\n", scale * m.x_min,
                  scale * m.x_max, way, scale * m.v_min, scale * m.v_max, way, scale * m.a_max, way);
  out.text +=
      fmt::format("  {} strokes, {} reversals, moving in {:.0f} % of the rows, {:.0f} % of these forward\n",
                  m.strokes, m.reversals, 100.0 * m.moving, 100.0 * m.forward);
  out.text += fmt::format("  force {:.4g} to {:.4g} {}\n", m.f_min, m.f_max, force);
  out.json["motion"] = {{"position_unit", r.position_unit},
                        {"force_unit", r.force_unit},
                        {"position", {m.x_min, m.x_max}},
                        {"velocity", {m.v_min, m.v_max}},
                        {"slowest", m.slowest},
                        {"acceleration", m.a_max},
                        {"force", {m.f_min, m.f_max}},
                        {"moving", m.moving},
                        {"forward", m.forward},
                        {"strokes", m.strokes},
                        {"reversals", m.reversals}};
}

void add_findings(const ident::log::Conditioned& c, const io::Log& log, Inspection& out) {
  out.text += "\nFindings\n";
  std::vector<std::string> lines;
  for (const ident::log::Finding& f : c.findings) {
    lines.push_back(fmt::format("{}{}: {}", f.kind, f.repaired ? "" : " (not repaired)",
                                without_source(f.text, log.source)));
    out.json["findings"].push_back(
        {{"kind", f.kind},
         {"text", f.text},
         {"row", f.row == 0 ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(f.row)},
         {"time_s", f.row == 0 ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(f.time)},
         {"repaired", f.repaired}});
  }
  if (lines.empty()) lines.emplace_back("none: the log is used as it is");
  constexpr std::size_t kMost = 30;
  if (lines.size() > kMost) {
    const std::size_t more = lines.size() - kMost;
    lines.resize(kMost);
    lines.push_back(fmt::format("and {} more (all of them in --json)", more));
  }
  add_lines(out.text, lines, "-");
  std::size_t rows = 0;
  std::size_t left_out = 0;
  for (const ident::log::Record& r : c.records) {
    rows += r.t.size();
    left_out += static_cast<std::size_t>(std::count(r.skip.begin(), r.skip.end(), 1));
  }
  out.text +=
      fmt::format("\nUsed: {} record{} with {} rows in total, {:.6g} ms between rows{}\n", c.records.size(),
                  c.records.size() == 1 ? "" : "s", rows, 1e3 * c.sampling.sample_time,
                  left_out > 0 ? fmt::format("; {} rows are marked and not fitted", left_out) : "");
  for (std::size_t i = 0; i < c.records.size(); ++i) {
    const ident::log::Record& r = c.records[i];
    out.json["records"].push_back({{"source", r.source},
                                   {"first_row", c.rows[i].front()},
                                   {"last_row", c.rows[i].back()},
                                   {"rows", r.t.size()},
                                   {"sample_time_s", r.sample_time},
                                   {"from_s", r.t.front()},
                                   {"to_s", r.t.back()}});
  }
}

/// The positions of motor and table; whether both tell the lost motion.
bool add_encoders(const io::Log& log, const LogOptions& options, std::vector<std::string>& why_not,
                  Inspection& out) {
  const AxisColumns columns(log, options);
  for (const LogQuantity encoder : {LogQuantity::kMotor, LogQuantity::kScale}) {
    const auto found = columns.find(encoder);
    if (!found) continue;
    const std::string quantity(enum_name(encoder));
    out.text += fmt::format("  {:<9} {}\n", quantity, header_with_unit(*found));
    out.json["axis"][quantity] = header_with_unit(*found);
  }
  return both_encoders(log, options, why_not).has_value();
}

}  // namespace

Inspection inspect(const io::Log& log, const LogOptions& options) {
  Inspection out;
  out.json["schema"] = "stribeck.inspect/1";
  out.json["file"] = log.source;
  out.json["format"] = log.format;
  out.json["rows"] = log.rows;
  out.text = fmt::format("{}\n  {}, {} rows\n", log.source, log.format, log.rows);
  constexpr std::size_t kMostMetadata = 8;
  out.json["metadata"] = nlohmann::ordered_json::object();
  for (std::size_t i = 0; i < log.metadata.size(); ++i) {
    out.json["metadata"][log.metadata[i].first] = log.metadata[i].second;
    if (i < kMostMetadata)
      out.text += fmt::format("  {}: {}\n", log.metadata[i].first, log.metadata[i].second);
  }
  if (log.metadata.size() > kMostMetadata)
    out.text += fmt::format("  and {} more\n", log.metadata.size() - kMostMetadata);
  out.json["columns"] = nlohmann::ordered_json::array();
  add_columns(log, out);
  out.json["notes"] = nlohmann::ordered_json::array();
  for (const io::Note& note : log.notes) out.json["notes"].push_back(note.text);
  if (!log.notes.empty()) {
    std::vector<std::string> notes;
    const bool runs = !options.runs.empty() || !options.where.empty();
    for (const io::Note& note : log.notes) {
      // The time restarts where runs follow each other.
      if (!(runs && note.about == io::Note::About::kTimeBack)) notes.push_back(note.text);
    }
    const std::size_t more = notes.size() > kMostNotes ? notes.size() - kMostNotes : 0;
    notes.resize(notes.size() - more);
    if (more > 0) notes.push_back(fmt::format("and {} more", more));
    if (!notes.empty()) out.text += "\nReading\n";
    add_lines(out.text, notes, "-");
  }
  for (const char* list : {"findings", "records", "can_tell", "cannot_tell"})
    out.json[list] = nlohmann::ordered_json::array();
  out.json["refused"] = nullptr;
  const auto refuse = [&](const std::string& why) {
    out.text += "\nCannot be used\n";
    add_lines(out.text, {without_source(why, log.source)}, "-");
    out.json["refused"] = why;
  };
  try {
    LoggedAxis axis = logged_axis(log, options);
    out.text += "\nTaken as\n";
    for (const auto& [quantity, column] : axis.columns) {
      out.text += fmt::format("  {:<9} {}\n", quantity, column);
      out.json["axis"][quantity] = column;
    }
    std::vector<std::string> why_no_encoders;
    const bool encoders = add_encoders(log, options, why_no_encoders, out);
    if (axis.runs.size() > 1) out.text += fmt::format("  {} runs\n", axis.runs.size());
    add_lines(out.text, axis.notes, "-");
    for (const std::string& note : axis.notes) out.json["notes"].push_back(note);
    ident::log::Conditioned c = condition_axis(std::move(axis), log.source, options);
    add_sampling(c, out);
    add_findings(c, log, out);
    if (encoders)
      c.determinable.emplace_back(
          "lost motion: backlash and wind-up between motor and table, from both positions");
    c.cannot_tell.insert(c.cannot_tell.end(), why_no_encoders.begin(), why_no_encoders.end());
    out.text += "\nCan be identified\n";
    add_lines(out.text, c.determinable, "+");
    out.text += "\nCannot be identified from this log\n";
    add_lines(out.text,
              c.cannot_tell.empty() ? std::vector<std::string>{"nothing is missing"} : c.cannot_tell, "-");
    out.json["can_tell"] = c.determinable;
    out.json["cannot_tell"] = c.cannot_tell;
    out.usable = true;
  } catch (const io::InputError& e) {
    refuse(e.problems().front().text());
  } catch (const ident::Refused& e) {
    refuse(e.what());
  }
  return out;
}

}  // namespace stribeck::workflow
