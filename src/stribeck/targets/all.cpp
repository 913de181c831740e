#include <fmt/format.h>
#include <exception>
#include <filesystem>

#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/output_folder.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/targets/all.hpp>
#include <stribeck/targets/cogging/moteus.hpp>
#include <stribeck/targets/pulse/options.hpp>
#include <stribeck/targets/pulse/pulse_target.hpp>
#include <stribeck/targets/steady/gain.hpp>
#include <stribeck/targets/steady/steady_target.hpp>

namespace stribeck::targets {

namespace {

/// Why a target cannot be written with these options, as words; empty: it can.
std::string lacking(const SteadyTarget& t, const ExportRequest& o) {
  if (!o.gain.empty() && !can_count(t, o))
    return t.counts == GainUnit::kBits ? "--gain of one bit, % or V" : "--gain in % or ‰";
  return missing_options(t, o);
}

std::string file_in(const ExportRequest& o, std::string_view target, std::string_view extension) {
  return (std::filesystem::path(o.output) / (std::string(target) + std::string(extension))).string();
}

double quadrant(const nlohmann::ordered_json& circle, const char* of) {
  return circle[of]["quadrant_um"].get<double>();
}

double deviation(const nlohmann::ordered_json& circle, const char* of) {
  return circle[of]["circular_deviation_um"].get<double>();
}

/// A line of the table of peaks, and the same as JSON.
std::string peak_line(std::string_view target, std::string_view what, const nlohmann::ordered_json& circle) {
  const auto peak = [&](const char* of) { return report::micrometres(1e-6 * quadrant(circle, of)) + " µm"; };
  return fmt::format("{} {} {} {}  {}\n", report::left_aligned(std::string(target), 16),
                     report::right_aligned(peak("without"), 14), report::right_aligned(peak("pulse"), 12),
                     report::right_aligned(peak("model"), 12), what);
}

/// A target that does harm must not be taken for the rest of its table; empty: none does.
std::string harm_in_words(const std::vector<std::string>& harmful) {
  if (harmful.empty()) return {};
  return fmt::format(
      "Warning: on this circle {} {} the peaks larger, or the circle no rounder, than no compensation. Choose a target with a smaller peak, or "
      "enter half of the numbers and measure a circle.\n",
      report::listed(harmful), harmful.size() == 1 ? "makes" : "make");
}

/// The peak that each target in a control leaves at the quadrants of the user's circle: tables, then pulses; returns a sentence for each
/// pulse that could not be found.
std::vector<std::string> add_peaks(const ExportRequest& o,
                                   const std::vector<std::pair<const SteadyTarget*, SteadyText>>& steady,
                                   Exported& out) {
  const PulseTask task = *circle_task("all", o);
  UserCircle c = user_circle(task);
  out.text += fmt::format("{} {} {} {}  {}\n", report::left_aligned("target", 16),
                          report::right_aligned("peak without", 14), report::right_aligned("with it", 12),
                          report::right_aligned("whole model", 12), "what is written");
  std::vector<std::string> harmful;
  const auto add = [&](std::string_view target, std::string_view what, const nlohmann::ordered_json& circle) {
    constexpr double kMore = 1.02;
    const bool peak = quadrant(circle, "pulse") > kMore * quadrant(circle, "without");
    if (peak || deviation(circle, "pulse") >= deviation(circle, "without")) harmful.emplace_back(target);
    out.text += peak_line(target, what, circle);
  };
  for (std::size_t i = 0; i < steady.size(); ++i) {
    const auto& [t, w] = steady[i];
    if (t->simulator) continue;
    const CircleError with = c.circle.with(std::array{w.tables[c.axes[0]], w.tables[c.axes[1]]});
    out.json["targets"][i]["circle"] = circle_json(task, c, with);
    add(t->name, t->what, out.json["targets"][i]["circle"]);
  }
  ExportRequest each = o;
  // Names of axes are those of the control.
  each.names.clear();
  each.gain.clear();
  each.lead.clear();
  each.resolution.clear();
  each.zero.clear();
  std::vector<std::string> refused;
  for (const PulseTarget* t : pulse_targets()) {
    each.output = file_in(o, t->name, ".txt");
    Exported written;
    try {
      written = write_pulse(*t, each);
    } catch (const sim::Refused& e) {
      refused.push_back(fmt::format("{}, because {}", t->name, e.what()));
      continue;
    }
    out.json["targets"].push_back({{"to", t->name},
                                   {"file", each.output},
                                   {"axes", written.json["axes"]},
                                   {"circle", written.json["circle"]}});
    add(t->name, t->what, written.json["circle"]);
  }
  out.text += harm_in_words(harmful);
  return refused;
}

/// Why no pulse can be found with these axis files; empty: it can. Other errors of the options are thrown.
std::string lack_of_pulses(const ExportRequest& o) {
  try {
    static_cast<void>(circle_task("all", o));
  } catch (const io::InputError& e) {
    if (e.problems().front().key != "friction.dynamics") throw;
    return e.problems().front().text();
  }
  return {};
}

void add_moteus(const ExportRequest& o, Exported& out) {
  const MoteusText w = moteus_text(o);
  const std::string file = file_in(o, "moteus", ".txt");
  io::write_atomically(file, w.text);
  out.json["targets"].push_back({{"to", "moteus"}, {"file", file}, {"axes", w.axes}});
  out.text += "moteus: " + w.words.substr(0, w.words.find('\n') + 1);
}

/// The steady targets that take the axes, and why the others do not.
struct SteadyTexts {
  std::vector<std::pair<const SteadyTarget*, SteadyText>> all;
  std::vector<std::string> open;     ///< targets that lack an option
  std::vector<std::string> linear;   ///< targets without a place for a rotary axis
  std::vector<std::string> refused;  ///< targets with a reason
};

SteadyTexts steady_texts(const ExportRequest& o) {
  SteadyTexts out;
  std::exception_ptr first;
  const bool rotary = any_rotary(o);
  for (const SteadyTarget* t : steady_targets()) {
    if (t->linear_only && rotary) {
      out.linear.emplace_back(t->name);
      continue;
    }
    const std::string missing = lacking(*t, o);
    if (!missing.empty()) {
      out.open.push_back(fmt::format("{} ({})", t->name, missing));
      continue;
    }
    try {
      out.all.emplace_back(t, steady_text(*t, o));
    } catch (const io::InputError& e) {
      out.refused.push_back(fmt::format("{}, because of {}", t->name, e.problems().front().text()));
      if (!first) first = std::current_exception();
    } catch (const sim::Refused& e) {
      out.refused.push_back(fmt::format("{}, because {}", t->name, e.what()));
    }
  }
  // If no target accepts them, the files or the options are wrong.
  if (out.all.empty() && first) std::rethrow_exception(first);
  return out;
}

}  // namespace

Exported write_all(const ExportRequest& asked) {
  refuse_linuxcnc_options(asked);
  if (asked.controller.empty()) refuse_pulse_options(asked);
  ExportRequest o = asked;
  std::error_code ignored;
  if (std::filesystem::exists(o.output, ignored) && !std::filesystem::is_directory(o.output, ignored))
    throw io::InputError({o.output, 0, {}, "is a file, expected a folder for one file per target"});
  // What the pulses need is asked for before anything is computed.
  const std::string lack = o.controller.empty() ? std::string() : lack_of_pulses(o);
  if (!lack.empty()) {
    for (std::string* option : {&o.controller, &o.machine, &o.period, &o.size}) option->clear();
  }
  const bool pulses = !o.controller.empty();
  auto [all, open, linear, refused] = steady_texts(o);
  // A target that fails leaves the folder as it was.
  io::WriteTogether together;
  const io::OutputFolder folder(o.output);
  Exported out;
  out.json = {{"schema", "stribeck.export/1"},
              {"to", "all"},
              {"folder", o.output},
              {"targets", nlohmann::ordered_json::array()}};
  out.text = fmt::format("{} {} {} {}  {}\n", report::left_aligned("target", 16),
                         report::left_aligned("axis", 6), report::right_aligned("largest error", 14),
                         report::right_aligned("RMS error", 12), "what is written");
  std::string besides = word_of_common_gain(o);
  for (const auto& [t, w] : all) {
    const std::string file = file_in(o, t->name, t->extension);
    io::write_atomically(file, w.text);
    out.json["targets"].push_back({{"to", t->name}, {"file", file}, {"axes", w.json}});
    const WrittenBeside beside = write_beside(*t, file);
    if (!beside.file.empty()) out.json["targets"].back()["beside"] = beside.file;
    besides += beside.words;
    for (const auto& axis : w.json) {
      out.text +=
          fmt::format("{} {} {} {}  {}\n", report::left_aligned(std::string(t->name), 16),
                      report::left_aligned(axis["name"].get<std::string>(), 6),
                      report::right_aligned(report::significant(axis["max_error_N"], 3) + " N", 14),
                      report::right_aligned(report::significant(axis["rms_error_N"], 3) + " N", 12), t->what);
    }
  }
  if (pulses) {
    try {
      const std::vector<std::string> not_found = add_peaks(o, all, out);
      refused.insert(refused.end(), not_found.begin(), not_found.end());
    } catch (const sim::Refused& e) {  // of the user's own circle
      refused.push_back(fmt::format("what the targets leave on a circle, because {}", e.what()));
    }
  }
  const std::string lacks = moteus_lacks(o);
  if (lacks.empty()) add_moteus(o, out);
  std::vector<std::string> names;
  for (const PulseTarget* t : pulse_targets()) {
    if (asked.controller.empty()) open.push_back(fmt::format("{} (--controller)", t->name));
    names.emplace_back(t->name);
  }
  if (!lack.empty()) refused.push_back(fmt::format("{}, because of {}", report::listed(names), lack));
  out.text += fmt::format("{} files in {}.\n", out.json["targets"].size(), o.output) + besides;
  if (!open.empty())
    out.text += fmt::format("Not written, because an option is missing: {}.\n", report::listed(open));
  if (!linear.empty())
    out.text += fmt::format("Not written, because they have no place for a rotary axis: {}.\n",
                            report::listed(linear));
  for (const std::string& words : refused) out.text += fmt::format("Not written: {}.\n", words);
  if (!lacks.empty()) out.text += fmt::format("Not written: moteus, which needs {}.\n", lacks);
  together.commit();
  return out;
}

}  // namespace stribeck::targets
