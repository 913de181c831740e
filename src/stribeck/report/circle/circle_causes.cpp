#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <stribeck/core/scalar.hpp>
#include <stribeck/io/json.hpp>
#include <stribeck/report/circle/circle_parts.hpp>
#include <stribeck/report/columns.hpp>
#include <stribeck/report/factors.hpp>
#include <stribeck/report/text.hpp>

namespace stribeck::report {
namespace {

using ident::circle::Cause;
using ident::circle::CauseKind;
using ident::circle::Diagnosis;
using ident::circle::QuadrantPeak;

std::string printed_figure(const Cause::Figure& f) {
  std::string text = fmt::format("{} {}", f.name, significant(f.value, 4));
  if (std::isfinite(f.half_width)) text += " ± " + significant(f.half_width, 2);
  return text + " " + printed_unit(f.unit);
}

std::string printed_figures(const Cause& c) {
  std::vector<std::string> all;
  for (const Cause::Figure& f : c.figures) all.push_back(printed_figure(f));
  return joined(all, ", ");
}

std::string share_of(const Cause& c) {
  return is_set_up(c.kind) ? "set-up" : decimals(100.0 * c.share, 0) + " %";
}

/// A form that the encoder of an axis cannot have seen.
bool only_looks_like(const Diagnosis& d, const Cause& c) {
  return d.own_encoder && (c.kind == CauseKind::kSquareness || c.kind == CauseKind::kStraightness ||
                           c.kind == CauseKind::kLateralPlay);
}

std::string cured(const Diagnosis& d, const Cause& c) {
  if (is_set_up(c.kind)) return "no fault";
  if (only_looks_like(d, c)) return "not seen";
  return words_of(d, c).parameter ? "yes" : "no";
}

/// "reversal spike y (3.93 µm) and backlash x (2.00 µm)" of the first causes that are not the set-up, with their effects.
std::string largest(const Diagnosis& d) {
  std::vector<std::string> names;
  for (const Cause& c : d.causes) {
    if (!c.found || is_set_up(c.kind) || names.size() == 3) continue;
    names.push_back(fmt::format("{} ({} µm)", cause_name(d, c), micrometres(c.effect)));
  }
  return listed(names);
}

/// Degrees, travel of the axis and time behind its reversal.
struct Behind {
  double degrees;
  double travel_mm;
  double time_ms;  ///< NaN: the feed is not known
};

Behind behind(double angle, const QuadrantPeak& p, double radius) {
  return {angle * 180.0 / kPi, radius * (1.0 - std::cos(angle)) * 1e3, 1e3 * angle * radius / p.feed};
}

}  // namespace

std::string cause_name(const Diagnosis& d, const Cause& c) {
  std::string name(enum_name(c.kind));
  if (c.axis) name += ' ' + d.axes[static_cast<std::size_t>(*c.axis)];
  return name;
}

std::string peak_name(const Diagnosis& d, const QuadrantPeak& p) {
  return fmt::format("{} {:.0f}°", d.axes[static_cast<std::size_t>(p.axis)], p.angle * 180.0 / kPi);
}

std::string next_step(const Diagnosis& d, const Cause& c) {
  const bool open = c.kind == CauseKind::kBacklash || c.kind == CauseKind::kSquareness ||
                    c.kind == CauseKind::kScaleMismatch || c.kind == CauseKind::kStraightness ||
                    c.kind == CauseKind::kCyclic;
  const std::string next(words_of(d, c).next_step);
  if (d.own_encoder && (c.kind == CauseKind::kBacklash || only_looks_like(d, c)))
    return next;  // nothing is set right by it
  return open && !d.both_directions ? "measure the other direction too, then " + next : next;
}

std::string causes_text(const std::string& label, const Diagnosis& d) {
  std::string out = "Causes" + (label.empty() ? "" : " of " + clean_text(label)) + "\n";
  std::vector<TextColumn> columns{{"cause", "", {}, false}, {"size", "µm", {}}, {"±", "µm", {}},
                                  {"effect", "µm", {}},     {"share", "", {}},  {"parameter", "", {}, false}};
  for (const Cause& c : d.causes) {
    if (!c.found) continue;
    std::size_t k = 0;
    for (const std::string& entry :
         {cause_name(d, c), micrometres(c.size), significant(c.half_width * kMicro, 2), micrometres(c.effect),
          share_of(c), cured(d, c)})
      columns[k++].entries.push_back(entry);
  }
  if (columns[0].entries.empty()) {
    out += "none found beyond the scatter\n";
  } else {
    out += lay_out(columns);
    out += fmt::format(
        "Largest less smallest radius: {} µm; left by these causes outside of the reversals: {} µm RMS.\n",
        micrometres(d.span), micrometres(d.rest_rms));
    for (const Cause& c : d.causes) {
      if (!c.found) continue;
      const auto words = words_of(d, c);
      const std::string figures = printed_figures(c);
      out += fmt::format("{}: {}{}. Next: {}.\n", cause_name(d, c), words.meaning,
                         figures.empty() ? "" : " (" + figures + ")", next_step(d, c));
    }
  }
  for (const std::string& remark : d.remarks) out += "Note: " + remark + ".\n";
  return out;
}

std::string causes_line(const std::string& label, const Diagnosis& d) {
  const std::string names = largest(d);
  return fmt::format("Causes of {}: {}\n", clean_text(label),
                     names.empty() ? "none beyond the scatter" : names);
}

void add_causes(Page& page, const std::string& label, const Diagnosis& d, double radius) {
  page.section(label.empty() ? "Causes" : "Causes of " + label);
  const std::string names = largest(d);
  page.paragraph(names.empty() ? "No cause stands out of the scatter."
                               : fmt::format("Largest effect first: {}. The rest is {} µm RMS.", names,
                                             micrometres(d.rest_rms)));
  Table table;
  table.columns = {{"cause", "", false},     {"size", "µm", true},     {"effect", "µm", true},
                   {"share", "", true},      {"parameter", "", false}, {"figures", "", false},
                   {"what to do", "", false}};
  for (const Cause& c : d.causes) {
    if (!c.found) continue;
    const auto words = words_of(d, c);
    table.rows.push_back(
        {Cell{.text = cause_name(d, c), .best = table.rows.empty()},
         Cell{.text = micrometres(c.size), .spread = "± " + significant(c.half_width * kMicro, 2)},
         Cell{.text = micrometres(c.effect)}, Cell{.text = share_of(c)}, Cell{.text = cured(d, c)},
         Cell{.text = printed_figures(c)},
         Cell{.text = next_step(d, c), .note = std::string(words.meaning)}});
  }
  if (!table.rows.empty()) page.table(table);
  page.remark(
      "size: as the trade states it, with the 95 % interval; effect: how far it moves the path between its largest "
      "and smallest radius; share: of the effects of all causes; parameter: whether a parameter of the control can "
      "cure it; not seen: the encoders of the axes cannot see such a fault, what looks like it is made by the loops.");
  page.list("What these measurements cannot tell apart:", d.remarks);
  page.details("Quadrant peaks", [&] {
    Table peaks;
    peaks.columns = {{"reversal", "", false}, {"feed", "mm/min", true}, {"height", "µm", true},
                     {"width", "deg", true},  {"width", "mm", true},    {"width", "ms", true},
                     {"delay", "deg", true},  {"delay", "ms", true},    {"repeats", "µm", true},
                     {"laps", "", true}};
    for (const QuadrantPeak& p : d.peaks) {
      const Behind width = behind(p.width, p, radius);
      const Behind delay = behind(p.delay, p, radius);
      peaks.rows.push_back(
          {Cell{.text = peak_name(d, p) + (p.counter_clockwise ? " ccw" : " cw")},
           Cell{.text = decimals(p.feed * 6e4, 0)},
           Cell{.text = micrometres(p.height), .spread = "± " + micrometres(p.half_width_95)},
           Cell{.text = decimals(width.degrees, 2)}, Cell{.text = decimals(p.width * radius * 1e3, 3)},
           Cell{.text = decimals(width.time_ms, 1)}, Cell{.text = decimals(delay.degrees, 2)},
           Cell{.text = decimals(delay.time_ms, 1)}, Cell{.text = micrometres(p.repeatability)},
           Cell{.text = fmt::format("{}", p.laps)}});
    }
    page.table(peaks);
    page.remark(
        "height: beyond what the other causes explain, outwards positive; width at half the height, along the path in "
        "mm; delay from the reversal to the top; repeats: standard deviation of the height over laps.");
  });
}

nlohmann::ordered_json causes_json(const Diagnosis& d, double radius) {
  io::Json out;
  out["causes"] = io::Json::array();
  int place = 0;
  for (const Cause& c : d.causes) {
    const auto words = words_of(d, c);
    io::Json one{{"cause", enum_name(c.kind)},
                 {"axis", c.axis ? io::Json(d.axes[static_cast<std::size_t>(*c.axis)]) : io::Json(nullptr)},
                 {"found", c.found},
                 {"rank", c.found ? io::Json(++place) : io::Json(nullptr)},
                 {"size_um", io::number_or_null(c.size * kMicro)},
                 {"ci95_um",
                  {io::number_or_null((c.size - c.half_width) * kMicro),
                   io::number_or_null((c.size + c.half_width) * kMicro)}},
                 {"effect_um", io::number_or_null(c.effect * kMicro)},
                 {"share", io::number_or_null(c.share)},
                 {"figures", io::Json::array()},
                 {"meaning", words.meaning},
                 {"next_step", next_step(d, c)},
                 {"parameter_cures", words.parameter}};
    for (const Cause::Figure& f : c.figures)
      one["figures"].push_back({{"name", f.name},
                                {"value", io::number_or_null(f.value)},
                                {"half_width_95", io::number_or_null(f.half_width)},
                                {"unit", f.unit}});
    out["causes"].push_back(std::move(one));
  }
  out["peaks"] = io::Json::array();
  for (const QuadrantPeak& p : d.peaks) {
    const Behind width = behind(p.width, p, radius);
    const Behind delay = behind(p.delay, p, radius);
    out["peaks"].push_back({{"axis", d.axes[static_cast<std::size_t>(p.axis)]},
                            {"direction", p.counter_clockwise ? "counter-clockwise" : "clockwise"},
                            {"angle_deg", io::number_or_null(p.angle * 180.0 / kPi)},
                            {"feed_mm_per_min", io::number_or_null(p.feed * 6e4)},
                            {"height_um", io::number_or_null(p.height * kMicro)},
                            {"half_width_95_um", io::number_or_null(p.half_width_95 * kMicro)},
                            {"width_deg", io::number_or_null(width.degrees)},
                            {"width_mm", io::number_or_null(p.width * radius * 1e3)},
                            {"width_ms", io::number_or_null(width.time_ms)},
                            {"delay_deg", io::number_or_null(delay.degrees)},
                            {"delay_travel_mm", io::number_or_null(delay.travel_mm)},
                            {"delay_ms", io::number_or_null(delay.time_ms)},
                            {"repeatability_um", io::number_or_null(p.repeatability * kMicro)},
                            {"laps", p.laps}});
  }
  out["remarks"] = d.remarks;
  out["rest_rms_um"] = io::number_or_null(d.rest_rms * kMicro);
  out["window_deg"] = io::number_or_null(d.window * 180.0 / kPi);
  return out;
}

}  // namespace stribeck::report
