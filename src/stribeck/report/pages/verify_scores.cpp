#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <stribeck/core/numbers.hpp>
#include <stribeck/ident/shown.hpp>
#include <stribeck/io/json.hpp>
#include <stribeck/report/columns.hpp>
#include <stribeck/report/pages/verify_parts.hpp>
#include <stribeck/report/text.hpp>
#include <utility>

namespace stribeck::report {
namespace {

using io::Json;
using io::number_or_null;

std::string percent(double share) { return std::isfinite(share) ? decimals(100.0 * share, 2) : "–"; }

/// A drift, in words where it is longer than the way that the axis went.
std::string drift_text(double drift, const VerifiedModel& m, const ShownUnits& u) {
  return drift > m.travel ? "> travel" : significant(drift * u.per_position, 3);
}

/// One figure of a model, for the terminal and for the page.
struct Score {
  std::string group, head, unit;
  std::string (*text)(const VerifiedModel&, const ShownUnits&);
  double (*size)(const VerifiedModel&);  ///< by which the best is found; null: not compared
};

std::vector<Score> scores_of(const VerifiedPart& part) {
  using M = const VerifiedModel&;
  using U = const ShownUnits&;
  const ShownUnits u = units_of(part);
  std::vector<Score> all{{"force", "protocol", "%", [](M m, U) { return percent(m.force.relative); },
                          [](M m) { return m.force.relative; }},
                         {"force", "as filed", "%", [](M m, U) { return percent(m.force.filed_relative); },
                          [](M m) { return m.force.filed_relative; }}};
  if (std::any_of(part.models.begin(), part.models.end(), [](M m) { return !m.force.phases.empty(); })) {
    all.push_back({"force", "phases", "%", [](M m, U) { return percent(m.force.own_relative); },
                   [](M m) { return m.force.own_relative; }});
  }
  all.insert(all.end(),
             {{"stroke", "velocity", "%", [](M m, U) { return percent(m.open.restarted.velocity_relative); },
               [](M m) { return m.open.restarted.velocity_relative; }},
              {"stroke", "position", u.fine,
               [](M m, U s) { return significant(m.open.restarted.position_rms * s.per_fine, 3); }, nullptr},
              {"free run", "drift", u.position,
               [](M m, U s) { return drift_text(m.open.free.position_most, m, s); }, nullptr},
              {"free run", "within", "± " + u.position,
               [](M m, U s) { return drift_text(m.drift.end, m, s); }, nullptr}});
  if (!has_closed(part)) return all;
  all.push_back({"loop", "force", "%",
                 [](M m, U) { return percent(m.closed ? m.closed->force_relative : kNaN); },
                 [](M m) { return m.closed ? m.closed->force_relative : kNaN; }});
  all.push_back(
      {"loop", "position", u.fine,
       [](M m, U s) { return significant(m.closed ? m.closed->position_rms * s.per_fine : kNaN, 3); },
       nullptr});
  return all;
}

Json replay_json(const ident::replay::Replay& r, const ShownUnits& u, bool force) {
  Json out;
  const auto put = [&](const std::string& name, const std::string& unit, bool holds, double value,
                       double scale) {
    out[name + "_" + unit] = holds ? number_or_null(value * scale) : Json(nullptr);
    if (!holds) out[name] = number_or_null(value);
  };
  if (force) {
    put("force_rms", "N", u.force == "N" || u.in_degrees(), r.force_rms, 1.0);
    out["force_relative_percent"] = number_or_null(100.0 * r.force_relative);
  }
  put("velocity_rms", "mm_per_s", u.linear(), r.velocity_rms, 1e3);
  out["velocity_relative_percent"] = number_or_null(100.0 * r.velocity_relative);
  put("position_rms", "um", u.linear(), r.position_rms, 1e6);
  put("position_max", "um", u.linear(), r.position_most, 1e6);
  out["rows_outside_range"] = r.outside;
  return out;
}

Json force_json(const ident::replay::ForceError& e) {
  Json out;
  out["error_percent"] = number_or_null(100.0 * e.relative);
  out["error_rms_N"] = number_or_null(e.rms);
  out["filed_error_percent"] = number_or_null(100.0 * e.filed_relative);
  out["filed_error_rms_N"] = number_or_null(e.filed_rms);
  out["own_error_percent"] = number_or_null(100.0 * e.own_relative);
  out["own_error_rms_N"] = number_or_null(e.own_rms);
  out["at_rest_percent"] = number_or_null(100.0 * e.at_rest);
  out["moving_error_percent"] = number_or_null(100.0 * e.moving_relative);
  out["of_log_percent"] = number_or_null(100.0 * e.of_log);
  const auto change = [&](const std::string& name, const ident::replay::FrictionChange& c) {
    out[name + "_friction_more_percent"] = number_or_null(100.0 * c.share);
    out[name + "_friction_more_half_width_percent"] = number_or_null(100.0 * c.half_width);
    out[name + "_friction_at_mm_per_s"] = number_or_null(1e3 * c.speed);
  };
  change("slow", e.friction.slow);
  change("fast", e.friction.fast);
  change("forward", e.friction.forward);
  change("backward", e.friction.backward);
  out["load_more_N"] = number_or_null(e.friction.load);
  out["load_more_half_width_N"] = number_or_null(e.friction.load_half_width);
  out["untold_percent"] = number_or_null(100.0 * e.untold);
  out["shift_ms"] = number_or_null(1e3 * e.shift);
  out["shift_half_width_ms"] = number_or_null(1e3 * e.shift_half);
  out["shift_differs"] = e.shifted;
  Json phases = Json::array();
  for (const ident::replay::RecordPhase& p : e.phases) {
    phases.push_back({{"period_mm", number_or_null(1e3 * p.period)},
                      {"stored_rad", number_or_null(p.stored)},
                      {"found_rad", number_or_null(p.found)},
                      {"half_width_rad", number_or_null(p.half_width)},
                      {"determined", p.determined},
                      {"differs", p.differs}});
  }
  out["phases"] = std::move(phases);
  out["low_pass_Hz"] = number_or_null(e.cut_off);
  out["band_Hz"] = number_or_null(e.band);
  return out;
}

Json controller_json(const std::optional<ident::replay::ControllerCheck>& check) {
  if (!check) return nullptr;
  return {{"command_error_percent", number_or_null(100.0 * check->relative)},
          {"added_rows_percent", number_or_null(100.0 * check->added_share)},
          {"added_rms_N", number_or_null(check->added_rms)}};
}

}  // namespace

ShownUnits units_of(const VerifiedPart& part) {
  const ShownUnits units{part.record.force_unit, part.record.position_unit};
  return part.record.rotary && units.physical() ? ShownUnits::turning() : units;
}

bool has_closed(const VerifiedPart& part) {
  return std::any_of(part.models.begin(), part.models.end(),
                     [](const VerifiedModel& m) { return m.closed.has_value(); });
}

VerifyReportInput with_short_names(VerifyReportInput input) {
  for (VerifiedPart& part : input.parts) {
    if (part.models.empty()) continue;
    std::string common = part.models.front().name;
    for (const VerifiedModel& m : part.models) {
      const auto differ = std::mismatch(common.begin(), common.end(), m.name.begin(), m.name.end()).first;
      common.erase(differ, common.end());
    }
    const auto folder = common.rfind('/');
    if (folder == std::string::npos) continue;
    for (VerifiedModel& m : part.models) m.name.erase(0, folder + 1);
  }
  return input;
}

std::string part_name(const VerifyReportInput& input, std::size_t i) {
  const std::vector<double>& t = input.parts[i].record.t;
  if (t.empty()) return fmt::format("part {}", i + 1);
  return fmt::format("part {} of {}, {} s to {} s", i + 1, input.parts.size(), significant(t.front(), 4),
                     significant(t.back(), 4));
}

std::string model_color(std::size_t i) {
  constexpr std::array<std::string_view, 6> kModelColors{"#0072b2", "#d55e00", "#009e73",
                                                         "#cc79a7", "#e69f00", "#56b4e9"};
  return std::string(kModelColors[i % kModelColors.size()]);
}

Table score_table(const VerifiedPart& part) {
  const ShownUnits u = units_of(part);
  Table t{"", {{"model", "", false}}, {}};
  const std::vector<Score> scores = scores_of(part);
  std::vector<double> least;
  for (const Score& s : scores) {
    t.columns.push_back({s.group + ": " + s.head, s.unit});
    double best = std::numeric_limits<double>::infinity();
    for (const VerifiedModel& m : part.models) {
      if (s.size != nullptr) best = std::fmin(best, s.size(m));
    }
    least.push_back(part.models.size() > 1 ? best : kNaN);
  }
  for (std::size_t i = 0; i < part.models.size(); ++i) {
    const VerifiedModel& m = part.models[i];
    std::vector<Cell> row{{m.name, "", "", false, model_color(i)}};
    for (std::size_t j = 0; j < scores.size(); ++j) {
      const Score& s = scores[j];
      row.push_back({s.text(m, u), "", "", s.size != nullptr && s.size(m) == least[j]});
    }
    t.rows.push_back(std::move(row));
  }
  return t;
}

namespace {

/// "at each of 7 reversals"; where the axis also turned within micrometres "17 times, at 7 reversals and where it starts or rests".
std::string restarts_in_words(const ident::replay::OpenLoop& open) {
  const std::size_t restarts = open.starts.size() - 1;
  const std::size_t reversals = open.reversals.size();
  if (restarts <= reversals) return fmt::format("at each of {} reversals", reversals);
  return fmt::format("{} times, at {} reversals and where it starts or rests", restarts, reversals);
}

}  // namespace

std::string summary(const VerifiedPart& part) {
  const VerifiedModel* open = nullptr;
  const VerifiedModel* closed = nullptr;
  for (const VerifiedModel& m : part.models) {
    if (!std::isfinite(m.open.restarted.velocity_relative)) continue;
    if (open == nullptr || m.open.restarted.velocity_relative < open->open.restarted.velocity_relative)
      open = &m;
    if (m.closed && (closed == nullptr || m.closed->force_relative < closed->closed->force_relative))
      closed = &m;
  }
  if (open == nullptr) return "No run in open loop is shown; the warnings say why.";
  const ShownUnits u = units_of(part);
  std::string text = fmt::format(
      "Driven by the measured force and started anew {}, {} predicts the velocity to {} % ({} {} RMS)",
      restarts_in_words(open->open), open->name, percent(open->open.restarted.velocity_relative),
      significant(open->open.restarted.velocity_rms * u.per_velocity, 3), u.velocity);
  if (part.models.size() > 1) text += ", the best of " + std::to_string(part.models.size()) + " models";
  text += ".";
  if (closed != nullptr) {
    text += fmt::format(" In its closed loop {} predicts the force to {} % and the position to {} {} RMS.",
                        closed->name, percent(closed->closed->force_relative),
                        significant(closed->closed->position_rms * u.per_fine, 3), u.fine);
  }
  return text;
}

std::string text_table(const VerifyReportInput& given) {
  const VerifyReportInput input = with_short_names(given);
  std::string out;
  for (std::size_t i = 0; i < input.parts.size(); ++i) {
    const VerifiedPart& part = input.parts[i];
    const ShownUnits u = units_of(part);
    if (!out.empty()) out += '\n';
    out += fmt::format("{}{}{} rows", input.axis.empty() ? "" : "axis " + clean_text(input.axis) + ": ",
                       input.parts.size() > 1 ? part_name(input, i) + ", " : "", part.record.x.size());
    if (!part.models.empty()) out += fmt::format(", {} reversals", part.models.front().open.reversals.size());
    out += '\n';
    std::vector<TextColumn> columns{{"model", "", {}, false}};
    for (const VerifiedModel& m : part.models) columns.front().entries.push_back(clean_text(m.name));
    for (const Score& s : scores_of(part)) {
      columns.push_back({s.head, s.unit, {}, true, s.group});
      for (const VerifiedModel& m : part.models) columns.back().entries.push_back(s.text(m, u));
    }
    out += lay_out(std::move(columns));
  }
  if (!out.empty()) {
    out +=
        "Errors in % of the RMS of what was measured. force: under the measured motion; protocol: rows paired\n"
        "as the EMPS benchmark does; as filed: force aligned, in % of the force less the load; phases: of\n"
        "periodic terms, from the log. stroke: open loop, anew at each reversal. free run: largest drift, and\n"
        "what the error of the force explains (95 %). loop: closed loop.\n";
    for (const Verdict& v : verdicts(input)) out += clean_text(sentence(v, input)) + '\n';
  }
  for (const std::string& w : input.warnings) out += "warning: " + clean_text(w) + '\n';
  return out;
}

nlohmann::ordered_json to_json(const VerifyReportInput& input) {
  Json out;
  out["schema"] = "stribeck.verify/1";
  out["axis"] = input.axis.empty() ? Json(nullptr) : Json(input.axis);
  const VerifiedPart none;
  const VerifiedPart& first = input.parts.empty() ? none : input.parts.front();
  out["force_unit"] = first.record.force_unit;
  out["position_unit"] = first.record.position_unit;
  out["limits_percent"] = {{"good", input.limits.good}, {"usable", input.limits.usable}};
  Json judged = Json::array();
  for (const Verdict& v : verdicts(input)) {
    judged.push_back({{"file", v.name},
                      {"force_error_percent", v.of_force ? number_or_null(100.0 * v.error) : Json(nullptr)},
                      {"where_it_moves", v.moving},
                      {"of_log_percent", number_or_null(100.0 * v.of_log)},
                      {"friction_more_percent", number_or_null(100.0 * v.friction.share)},
                      {"friction_more_half_width_percent", number_or_null(100.0 * v.friction.half_width)},
                      {"friction_at_mm_per_s", number_or_null(1e3 * v.friction.speed)},
                      {"forward_friction_more_percent", number_or_null(100.0 * v.forward.share)},
                      {"backward_friction_more_percent", number_or_null(100.0 * v.backward.share)},
                      {"load_more_N", number_or_null(v.load.share)},
                      {"untold_percent", number_or_null(100.0 * v.untold)},
                      {"told_from_mm_per_s", number_or_null(1e3 * v.told_from)},
                      {"verdict", std::string(name_of(v.grade))}});
  }
  out["verdicts"] = std::move(judged);
  Json parts = Json::array();
  for (const VerifiedPart& part : input.parts) {
    const ShownUnits u = units_of(part);
    Json one;
    one["log"] = part.record.source;
    one["rows"] = part.record.x.size();
    one["duration_s"] = number_or_null(static_cast<double>(part.record.x.size()) * part.record.sample_time);
    one["restarts"] = part.models.empty() ? Json(nullptr) : Json(part.models.front().open.starts.size() - 1);
    one["controller"] = controller_json(part.controller);
    Json models = Json::array();
    for (const VerifiedModel& m : part.models) {
      Json model;
      model["file"] = m.name;
      model["force"] = force_json(m.force);
      const bool beyond = m.drift.end > m.travel;
      model["drift"] = {{"expected_mm", beyond ? Json(nullptr) : number_or_null(1e3 * m.drift.end)},
                        {"beyond_travel", beyond},
                        {"inside_percent", number_or_null(100.0 * m.drift.inside)}};
      model["open_loop"] = replay_json(m.open.restarted, u, false);
      model["open_loop_free"] = replay_json(m.open.free, u, false);
      model["closed_loop"] = m.closed ? replay_json(*m.closed, u, true) : Json(nullptr);
      models.push_back(std::move(model));
    }
    one["models"] = std::move(models);
    parts.push_back(std::move(one));
  }
  out["parts"] = std::move(parts);
  out["warnings"] = input.warnings;
  return out;
}

}  // namespace stribeck::report
