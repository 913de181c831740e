#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <stribeck/core/scalar.hpp>
#include <stribeck/io/json.hpp>
#include <stribeck/report/factors.hpp>
#include <stribeck/report/frequency/frequency_parts.hpp>
#include <stribeck/report/table.hpp>
#include <stribeck/report/text.hpp>

namespace stribeck::report {
namespace {

using ident::frequency::Line;
using ident::frequency::Structure;
using ident::frequency::Value;
using sim::LoopLimit;
using sim::LoopProposal;
using sim::MeasuredMargins;

double in_dB(double factor) { return 20.0 * std::log10(factor); }

std::string hertz(const Value& v) { return with_half_width(v.value / kPerTurn, v.half_width / kPerTurn); }

std::string margins_in_words(const MeasuredMargins& m) {
  if (!m.stable) return "unstable";
  std::string words = fmt::format("phase margin {}°", decimals(m.phase * kDegrees, 1));
  words += std::isfinite(m.gain_up)
               ? fmt::format(", gain margin {} dB", decimals(in_dB(m.gain_up), 1))
               : fmt::format(", gain margin at least {} dB", decimals(in_dB(m.sure_gain), 1));
  return words;
}

std::string limit_in_words(const FrequencyAxis& a, const LoopProposal& p) {
  // A loop that amplifies at every frequency has no line at which its gain margin is measured.
  const std::string at =
      p.limit_at > 0.0 ? fmt::format(" at {} Hz", significant(p.limit_at / kPerTurn, 3)) : std::string();
  if (p.limit == LoopLimit::kMeasured)
    return fmt::format(
        "a faster loop is not judged, because its margins lie beyond the highest line, {} Hz: measure to a higher "
        "frequency or with a shorter period of the controller",
        significant(p.limit_at / kPerTurn, 3));
  const char* what = p.limit == LoopLimit::kGain ? "the gain margin" : "the phase margin";
  if (p.unsure)
    return fmt::format(
        "a faster loop keeps {}{} too, but its interval is too wide to be sure of that: record more strokes, or excite more strongly",
        what, at);
  if (a.resonance_limits) return fmt::format("beyond it the resonance takes {}{}", what, at);
  const std::string delay = a.fit.delay.low() > 0.0 ? fmt::format(", difference and the delay of {} ms",
                                                                  significant(a.fit.delay.value * 1e3, 3))
                                                    : std::string(" and difference");
  return fmt::format("beyond it hold{} take {}{}", delay, what, at);
}

std::string rule_in_words(const FrequencyAxis& a) {
  return fmt::format("{}° and {} dB", decimals(a.rule.phase * kDegrees, 0), decimals(in_dB(a.rule.gain), 0));
}

std::string proposal_in_words(const FrequencyAxis& a) {
  const LoopProposal& p = a.proposed;
  if (p.omega <= 0.0)
    return fmt::format(
        "No loop with kv = 2ω, kp = ω² keeps {} at the worse edge of the intervals within the measured frequencies",
        rule_in_words(a));
  return fmt::format(
      "The loop may go to ω = {} rad/s (kv = 2ω, kp = ω²): {}, at the worse edge of the intervals at least {}; {}",
      significant(p.omega, 3), margins_in_words(p.margins), rule_in_words(a), limit_in_words(a, p));
}

std::string resonance_in_words(const FrequencyAxis& a) {
  const double top = a.response.highest() / kPerTurn;
  if (a.fit.beyond)
    return fmt::format(
        "No resonance is determined up to {} Hz, but one mass misses the lines by {} times their noise: a resonance stands at the highest "
        "lines or above them (record with a shorter period of the controller, or excite higher frequencies)",
        significant(top, 3), significant(a.fit.excess, 2));
  if (!a.fit.resonance) return fmt::format("No resonance is visible up to {} Hz", significant(top, 3));
  std::string words = fmt::format("The first resonance is at {} Hz", hertz(*a.fit.resonance));
  if (a.fit.antiresonance) words += fmt::format(", its anti-resonance at {} Hz", hertz(*a.fit.antiresonance));
  return words +
         fmt::format(" (damping ratio {})", with_half_width(a.fit.damping->value, a.fit.damping->half_width));
}

std::string notch_in_words(const FrequencyAxis& a) {
  if (!a.fit.resonance) return {};
  if (!a.with_notch) {
    if (a.proposed.omega <= 0.0) return {};
    return a.resonance_limits
               ? "No notch at the resonance makes the loop a sixth faster: it takes as much phase as it saves gain"
               : "The resonance does not limit the loop: no notch is needed";
  }
  const sim::Notch& n = *a.with_notch->notch;
  return fmt::format(
      "A notch at {} Hz, {} dB deep and {} Hz wide, lets the loop go to ω = {} rad/s ({}), also when the resonance moves by "
      "5 %",
      significant(n.frequency / kPerTurn, 3), decimals(-in_dB(n.depth), 0),
      significant(2.0 * n.damping * n.frequency / kPerTurn, 2), significant(a.with_notch->omega, 3),
      margins_in_words(a.with_notch->margins));
}

std::string measured_in_words(const FrequencyAxis& a) {
  const ident::frequency::Response& r = a.response;
  const ShownUnits& u = a.units;
  return fmt::format(
      "Measured at {} {}, never below {} {}: Coulomb friction is no linear response and stands outside of it, only its slope at this "
      "speed is inside; at standstill the axis is stiffer",
      significant(r.speed * u.per_velocity, 3), u.velocity, significant(r.slowest * u.per_velocity, 2),
      u.velocity);
}

}  // namespace

std::string with_half_width(double value, double half_width) {
  if (!std::isfinite(half_width) || half_width <= 0.0) return significant(value, 4);
  const int digits = std::clamp(1 - static_cast<int>(std::floor(std::log10(half_width))), 0, 9);
  return fmt::format("{} ± {}", decimals(value, digits), decimals(half_width, digits));
}

std::vector<std::string> answer_of(const FrequencyAxis& a) {
  std::vector<std::string> out{proposal_in_words(a)};
  out.push_back(resonance_in_words(a));
  if (a.present) {
    const std::string omega = significant(a.present->omega, 3);
    const std::string margins = margins_in_words(a.present_margins);
    out.push_back(
        a.present_is_proposed
            ? fmt::format(
                  "The ω = {} rad/s that the program proposes for recording, because the machine file has no "
                  "commissioning.omega, has: {}",
                  omega, margins)
            : fmt::format("The present ω = {} rad/s of the machine file has: {}", omega, margins));
    if (!a.present_margins.inside) out.back() += ", as far as the lines reach";
  }
  if (const std::string notch = notch_in_words(a); !notch.empty()) out.push_back(notch);
  out.push_back(measured_in_words(a));
  return out;
}

double closed_loop_bandwidth(const FrequencyAxis& a) {
  if (!a.response.closed_loop) return std::numeric_limits<double>::quiet_NaN();
  const double level = std::sqrt(0.5);
  const Line* last = nullptr;
  for (const Line& line : a.response.lines) {
    if (!(line.closed_half_width < ident::frequency::kUnsure)) continue;
    const double now = std::abs(line.closed);
    if (last != nullptr && now < level) {
      const double before = std::abs(last->closed);
      const double share = std::log(before / level) / std::log(before / now);
      return last->omega * std::pow(line.omega / last->omega, share) / kPerTurn;
    }
    last = &line;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

Table plant_table(const FrequencyAxis& a) {
  Table t{"", {{"plant", "", false}, {"value", ""}, {"95 % interval", ""}, {"unit", "", false}}, {}};
  const auto row = [&](const char* name, const Value& v, double scale, const std::string& unit) {
    const double half = v.half_width * scale;
    const int digits = half > 0.0 && std::isfinite(half)
                           ? std::clamp(1 - static_cast<int>(std::floor(std::log10(half))), 0, 9)
                           : 4;
    t.rows.push_back({{name},
                      {decimals(v.value * scale, digits)},
                      {decimals(v.low() * scale, digits) + " … " + decimals(v.high() * scale, digits)},
                      {printed_unit(unit)}});
  };
  if (a.units.in_degrees()) {
    row("inertia", a.fit.mass, 1.0, "kg m2");
    row("slope of friction", a.fit.viscous, 1.0, "N m s/rad");
  } else {
    row("mass", a.fit.mass, 1.0, a.units.named("kg"));
    row("slope of friction", a.fit.viscous, 1e-3, a.units.named("N s/mm"));
  }
  row("delay beyond the hold", a.fit.delay, 1e3, "ms");
  if (a.fit.lag) row("lag of the force", *a.fit.lag, 1e3, "ms");
  if (a.fit.antiresonance) row("anti-resonance", *a.fit.antiresonance, 1.0 / kPerTurn, "Hz");
  if (a.fit.resonance) row("resonance", *a.fit.resonance, 1.0 / kPerTurn, "Hz");
  if (a.fit.damping) row("damping ratio", *a.fit.damping, 1.0, "");
  return t;
}

Table loop_table(const FrequencyAxis& a) {
  Table t{"",
          {{"loop", "", false},
           {"ω", "rad/s", true},
           {"phase margin", "deg", true},
           {"sure", "deg", true},
           {"gain margin", "dB", true},
           {"sure", "dB", true},
           {"crossover", "Hz", true},
           {"notch", "", false}},
          {}};
  const auto row = [&](const std::string& name, double omega, const MeasuredMargins& m,
                       const std::optional<sim::Notch>& n) {
    std::string notch = "none";
    if (n)
      notch = fmt::format("{} Hz, {} dB, {} Hz wide", significant(n->frequency / kPerTurn, 3),
                          decimals(-in_dB(n->depth), 0),
                          significant(2.0 * n->damping * n->frequency / kPerTurn, 2));
    const bool s = m.stable;
    t.rows.push_back({{name},
                      {significant(omega, 3)},
                      {s ? decimals(m.phase * kDegrees, 1) : "unstable"},
                      {s ? decimals(m.sure_phase * kDegrees, 1) : "–"},
                      {!s                         ? "–"
                       : std::isfinite(m.gain_up) ? decimals(in_dB(m.gain_up), 1)
                                                  : "> " + decimals(in_dB(m.sure_gain), 1)},
                      {s ? decimals(in_dB(m.sure_gain), 1) : "–"},
                      {decimals(m.crossover / kPerTurn, 1)},
                      {notch}});
  };
  if (a.present)
    row(a.present_is_proposed ? "proposed for recording" : "present", a.present->omega, a.present_margins,
        {});
  if (a.proposed.omega > 0.0) row("proposed", a.proposed.omega, a.proposed.margins, {});
  if (a.with_notch)
    row("proposed with a notch", a.with_notch->omega, a.with_notch->margins, a.with_notch->notch);
  return t;
}

std::string text_table(const FrequencyReportInput& input) {
  std::string out;
  for (const FrequencyAxis& a : input.axes) {
    if (input.axes.size() > 1)
      out += fmt::format("{}axis {}, from {}\n", out.empty() ? "" : "\n", a.name, a.sources);
    for (const std::string& words : answer_of(a)) out += words + ".\n";
    const ident::frequency::Response& r = a.response;
    const auto determined =
        std::count_if(r.lines.begin(), r.lines.end(), [](const Line& l) { return l.determined(); });
    out += fmt::format("\n{:<24}{:>14}{:>26}  unit\n", "plant", "value", "95 % interval");
    for (const auto& row : plant_table(a).rows)
      out += left_aligned(row[0].text, 24) + right_aligned(row[1].text, 14) + right_aligned(row[2].text, 26) +
             "  " + row[3].text + "\n";
    out += fmt::format("Model: {} ({}); it misses the lines by {} %, {} times their noise.\n",
                       enum_name(a.fit.plant.structure), a.fit.reason, significant(100.0 * a.fit.misfit, 2),
                       significant(a.fit.excess, 2));
    out += fmt::format(
        "{} of {} lines determined, from {} segments in {} stretches; left out: {} rows at standstill or reversal, {} of settling.\n",
        determined, r.lines.size(), r.segments, r.stretches, r.rows_reversal, r.rows_settling);
    for (const std::string& warning : a.warnings) out += "Warning: " + warning + ".\n";
  }
  return out;
}

namespace {

nlohmann::ordered_json json_of(const std::optional<Value>& v, double scale = 1.0) {
  if (!v) return nullptr;
  return {{"value", io::number_or_null(v->value * scale)},
          {"low", io::number_or_null(v->low() * scale)},
          {"high", io::number_or_null(v->high() * scale)}};
}

nlohmann::ordered_json json_of(const std::optional<sim::Notch>& n) {
  if (!n) return nullptr;
  return {{"frequency_Hz", n->frequency / kPerTurn},
          {"depth_dB", in_dB(n->depth)},
          {"width_Hz", 2.0 * n->damping * n->frequency / kPerTurn}};
}

nlohmann::ordered_json margins_json(const MeasuredMargins& m) {
  return {{"stable", m.stable},
          {"inside", m.inside},
          {"phase_deg", io::number_or_null(m.phase * kDegrees)},
          {"sure_phase_deg", io::number_or_null(m.sure_phase * kDegrees)},
          {"gain_dB", io::number_or_null(in_dB(m.gain_up))},
          {"sure_gain_dB", io::number_or_null(in_dB(m.sure_gain))},
          {"crossover_rad_per_s", m.crossover}};
}

/// A key with a unit; null where the scale of the force is not known, and then the number stands under the key without it, in the units
/// of the log.
void put_scaled(nlohmann::ordered_json& out, const char* name, const char* unit, bool physical,
                const nlohmann::ordered_json& value, const nlohmann::ordered_json& plain) {
  out[std::string(name) + "_" + unit] = physical ? value : nlohmann::ordered_json();
  if (!physical) out[name] = plain;
}

nlohmann::ordered_json json_of(double omega, double mass, bool physical, const MeasuredMargins& m) {
  nlohmann::ordered_json json{{"omega_rad_per_s", omega}};
  put_scaled(json, "mass", "kg", physical, mass, mass);
  json.update(margins_json(m));
  return json;
}

nlohmann::ordered_json json_of(const LoopProposal& p, double mass, bool physical) {
  if (p.omega <= 0.0) return nullptr;
  nlohmann::ordered_json json = json_of(p.omega, mass, physical, p.margins);
  constexpr const char* kLimits[] = {"phase", "gain", "measured", "unstable"};
  json["limit"] = kLimits[static_cast<int>(p.limit)];
  json["limit_Hz"] = p.limit_at / kPerTurn;
  json["notch"] = json_of(p.notch);
  return json;
}

nlohmann::ordered_json lines_json(const FrequencyAxis& a) {
  nlohmann::ordered_json lines = nlohmann::ordered_json::array();
  for (const Line& l : a.response.lines) {
    const bool closed = a.response.closed_loop;
    const double gain = std::abs(l.plant);
    nlohmann::ordered_json line{{"frequency_Hz", l.omega / kPerTurn}};
    put_scaled(line, "gain", "um_per_N", a.units.physical(), io::number_or_null(gain * 1e6),
               io::number_or_null(gain));
    line.update(nlohmann::ordered_json{
        {"phase_deg", io::number_or_null(std::arg(l.plant) * kDegrees)},
        {"half_width_percent", io::number_or_null(l.half_width * 100.0)},
        {"determined", l.determined()},
        {"force_coherence", io::number_or_null(l.force_coherence)},
        {"motion_coherence", io::number_or_null(l.motion_coherence)},
        {"closed_gain", closed ? io::number_or_null(std::abs(l.closed)) : nlohmann::ordered_json()},
        {"closed_phase_deg",
         closed ? io::number_or_null(std::arg(l.closed) * kDegrees) : nlohmann::ordered_json()}});
    lines.push_back(std::move(line));
  }
  return lines;
}

}  // namespace

nlohmann::ordered_json to_json(const FrequencyReportInput& input) {
  nlohmann::ordered_json json{{"schema", "stribeck.frequency/1"}, {"axes", nlohmann::ordered_json::array()}};
  for (const FrequencyAxis& a : input.axes) {
    const ident::frequency::Response& r = a.response;
    nlohmann::ordered_json one{
        {"axis", a.name.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(a.name)},
        {"sources", a.sources},
        {"method", r.period ? "periodic" : "welch"},
        {"period_s", io::number_or_null(r.period)},
        {"sample_time_s", r.sample_time},
        {"stretches", r.stretches},
        {"segments", r.segments},
        {"rows", r.rows},
        {"rows_used", r.rows_used},
        {"rows_reversal", r.rows_reversal},
        {"rows_settling", r.rows_settling},
        {"speed_mm_per_s", r.speed * 1e3},
        {"slowest_mm_per_s", r.slowest * 1e3},
        {"force_unit", a.units.in_degrees() ? "N" : a.units.force},
        {"structure", enum_name(a.fit.plant.structure)},
        {"reason", a.fit.reason},
    };
    const bool physical = a.units.physical();
    put_scaled(one, "mass", "kg", physical, json_of(a.fit.mass), json_of(a.fit.mass));
    put_scaled(one, "viscous", "N_s_per_m", physical, json_of(a.fit.viscous), json_of(a.fit.viscous));
    one.update(nlohmann::ordered_json{
        {"delay_s", json_of(a.fit.delay)},
        {"antiresonance_Hz", json_of(a.fit.antiresonance, 1.0 / kPerTurn)},
        {"resonance_Hz", json_of(a.fit.resonance, 1.0 / kPerTurn)},
        {"damping", json_of(a.fit.damping)},
        {"lag_s", json_of(a.fit.lag)},
        {"highest_Hz", r.highest() / kPerTurn},
        {"misfit_percent", a.fit.misfit * 100.0},
        {"excess", a.fit.excess},
        {"rule", {{"phase_deg", a.rule.phase * kDegrees}, {"gain_dB", in_dB(a.rule.gain)}}},
        {"proposed", json_of(a.proposed, a.fit.mass.value, physical)},
        {"with_notch", nullptr},
        {"present", nullptr},
        {"closed_loop_bandwidth_Hz", io::number_or_null(closed_loop_bandwidth(a))},
        {"lines", lines_json(a)},
        {"answer", answer_of(a)},
        {"warnings", a.warnings}});
    if (a.with_notch) one["with_notch"] = json_of(*a.with_notch, a.fit.mass.value, physical);
    if (a.present) one["present"] = json_of(a.present->omega, a.present->mass, physical, a.present_margins);
    json["axes"].push_back(std::move(one));
  }
  return json;
}

io::Log table_of(const FrequencyAxis& a) {
  io::Log log;
  log.rows = a.response.lines.size();
  const auto add = [&](const char* name, const std::string& unit, const auto& value) {
    io::Column column{name, unit, {}};
    for (const Line& l : a.response.lines) column.values.push_back(value(l));
    log.columns.push_back(std::move(column));
  };
  add("frequency", "Hz", [](const Line& l) { return l.omega / kPerTurn; });
  add("gain", a.units.fine + "/" + a.units.force,
      [&](const Line& l) { return std::abs(l.plant) * a.units.per_fine; });
  add("phase", "deg", [](const Line& l) { return std::arg(l.plant) * kDegrees; });
  add("half_width", "%", [](const Line& l) { return l.half_width * 100.0; });
  add("determined", "", [](const Line& l) { return l.determined() ? 1.0 : 0.0; });
  add("fit_gain", a.units.fine + "/" + a.units.force, [&](const Line& l) {
    return std::abs(ident::frequency::sampled_response(a.fit.plant, l.omega, a.response.sample_time)) *
           a.units.per_fine;
  });
  add("force_coherence", "", [](const Line& l) { return l.force_coherence; });
  add("motion_coherence", "", [](const Line& l) { return l.motion_coherence; });
  if (!a.response.closed_loop) return log;
  add("closed_gain", "", [](const Line& l) { return std::abs(l.closed); });
  add("closed_phase", "deg", [](const Line& l) { return std::arg(l.closed) * kDegrees; });
  return log;
}

}  // namespace stribeck::report
