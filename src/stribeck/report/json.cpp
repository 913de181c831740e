#include <algorithm>
#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <stribeck/core/walk_fields.hpp>
#include <stribeck/ident/bristle/told_break_away.hpp>
#include <stribeck/io/json.hpp>
#include <stribeck/io/units.hpp>
#include <stribeck/report/factors.hpp>
#include <stribeck/report/json.hpp>
#include <stribeck/report/parameters.hpp>
#include <stribeck/report/shown_units.hpp>
#include <stribeck/report/table.hpp>
#include <stribeck/sim/cutting_estimate.hpp>

namespace stribeck::report {
namespace {

using io::Json;
using io::number_or_null;

/// Writes the metrics into an object, in the order that users know.
void write_metrics(Json& out, const sim::Metrics& m, std::size_t axes) {
  for (const sim::Figure& f : sim::kFigures) {
    if (const auto* run = std::get_if<sim::Figure::OfRun>(&f.member)) {
      out[f.key] = number_or_null(m.**run * f.key_scale);
    } else {
      const sim::AxisValues& values = m.*std::get<sim::Figure::OfAxis>(f.member);
      Json each = Json::array();
      for (std::size_t i = 0; i < std::min(axes, control::kMostAxes); ++i)
        each.push_back(number_or_null(values[i] * f.key_scale));
      out[f.key] = std::move(each);
    }
  }
}

/// Cutting force against the feed, true and estimated.
Json cutting_json(const sim::CuttingFigures& c) {
  const auto of = [](const sim::CuttingFigures::Of& f) {
    return Json{{"mean_N", number_or_null(f.mean)},
                {"once_per_turn_N", number_or_null(f.turn)},
                {"once_per_tooth_N", number_or_null(f.tooth)}};
  };
  return {{"truth", of(c.truth)},
          {"estimate", of(c.estimate)},
          {"rms_truth_N", number_or_null(c.rms_truth)},
          {"rms_error_N", number_or_null(c.rms_error)}};
}

Json members(const Value& group, const ShownUnits& units);

/// Numbers in the shown unit, and the name of that unit.
struct InUnit {
  std::string unit;
  io::Conversion to_shown;

  InUnit(const Quantity& q, const ShownUnits& units)
      : unit(units.chosen(q.unit, q.shown)),
        to_shown(unit == q.unit ? io::Conversion() : io::conversion(q.unit, unit)) {}
  [[nodiscard]] Json operator()(double v) const { return number_or_null(to_shown(v)); }
};

/// A declared parameter (core/fields.hpp): a number with its unit, a name, a table or a list of these.
Json value_of_field(const Value& value, const Quantity& q, const ShownUnits& units) {
  switch (value.kind()) {
    case Kind::kOptional:
      return value.size() > 0 ? value_of_field(value[0], q, units) : Json(nullptr);
    case Kind::kNumber: {
      const InUnit in_unit(q, units);
      const Json x = in_unit(value.number());
      return in_unit.unit.empty() ? x : Json{{"value", x}, {"unit", units.named(in_unit.unit)}};
    }
    case Kind::kSwitch:
      return value.number() != 0.0;
    case Kind::kCount:
      return static_cast<std::int64_t>(value.number());
    case Kind::kText:
      return std::string(value.text());
    case Kind::kChoice:
      return std::string(value.word());
    case Kind::kGroup:
      return members(value, units);
    case Kind::kVariant: {
      Json out = {{"kind", std::string(value.word())}};
      out.update(members(value.chosen(), units));
      return out;
    }
    case Kind::kList:
    case Kind::kNamed:
      break;
  }
  Json list = Json::array();
  // From, to: one unit for both.
  const bool range = value.has_fixed_size() && value.type().inner->kind == Kind::kNumber;
  const InUnit in_unit(q, units);
  for (std::size_t i = 0; i < value.size(); ++i)
    list.push_back(range ? in_unit(value[i].number()) : value_of_field(value[i], q, units));
  return range ? Json{{"value", std::move(list)}, {"unit", units.named(in_unit.unit)}} : list;
}

Json members(const Value& group, const ShownUnits& units) {
  Json out = Json::object();
  for_each_member(group, [&](const Member& m) {
    out[std::string(m.info.name)] = value_of_field(m.value, m.info.quantity, units);
  });
  return out;
}

Json part_json(const sim::Travel& travel) {
  const sim::PartSummary& part = *travel.part();
  return {{"name", travel.name},
          {"moves", part.moves},
          {"length_mm", number_or_null(part.length * kMilli)},
          {"duration_s", number_or_null(part.duration)},
          {"stops", part.stops},
          {"rounded_corners", part.corners},
          {"slower_moves", part.limited},
          {"rounding_um", number_or_null(part.deviation * 1e6)}};
}

Json interval(double low, double high) { return Json::array({number_or_null(low), number_or_null(high)}); }

}  // namespace

nlohmann::ordered_json to_json(const sim::CompareResult& result, std::string_view experiment) {
  Json out;
  out["schema"] = "stribeck.compare/1";
  out["machine"] = result.machine;
  out["experiment"] = experiment.empty() ? Json(nullptr) : Json(std::string(experiment));
  out["seed"] = result.spec.seed;
  out["trials"] = result.spec.trials;
  const auto& travels = result.spec.travels;
  if (!travels.empty() && travels.front().part() != nullptr) out["part"] = part_json(travels.front());
  Json rows = Json::array();
  for (const sim::CompareRow& r : result.rows) {
    Json row;
    row["controller"] = r.controller.id;
    row["label"] = r.controller.label;
    const double speed = r.speed > 0.0 ? r.speed : travels.at(r.travel).feed;
    row["speed_mm_per_s"] = number_or_null(speed * kMilli);
    row["refused"] = r.refused.empty() ? Json(nullptr) : Json(r.refused);
    write_metrics(row, r.mean, result.axes.size());
    Json spread = Json::object();
    write_metrics(spread, r.spread, result.axes.size());
    row["spread"] = std::move(spread);
    if (const auto& cutting = result.spec.travels.at(r.travel).cutting; cutting && !r.trace.empty())
      row["cutting"] = cutting_json(sim::cutting_figures(r.trace, *cutting));
    if (!r.drift.empty()) {
      Json drift = Json::object();
      for (std::size_t i = 0; i < r.drift.size(); ++i) {
        const control::Drift& d = r.drift[i];
        drift[result.axes[i]] = {
            {"level_percent", number_or_null(100.0 * d.level)},
            {"level_deviation_percent", number_or_null(100.0 * d.level_deviation)},
            {"forwards_percent", number_or_null(100.0 * d.positive)},
            {"backwards_percent", number_or_null(100.0 * d.negative)},
            {"viscous_percent", number_or_null(100.0 * d.viscous)},
            {"viscous_deviation_percent", number_or_null(100.0 * d.viscous_deviation)},
            {"break_away_distance_percent", number_or_null(100.0 * d.break_away)},
            {"break_away_distance_deviation_percent", number_or_null(100.0 * d.break_away_deviation)},
            {"mass_percent", number_or_null(100.0 * d.mass)},
            {"mass_deviation_percent", number_or_null(100.0 * d.mass_deviation)},
            {"delay_ms", number_or_null(1e3 * d.delay)},
            {"delay_deviation_ms", number_or_null(1e3 * d.delay_deviation)},
            {"trend_percent_per_hour", number_or_null(100.0 * 3600.0 * d.trend)},
            {"verdict", std::string(describe(d.verdict))}};
      }
      row["drift"] = std::move(drift);
    }
    row["solver"] = {
        {"substeps", r.substeps > 0 ? Json(r.substeps) : Json(nullptr)},
        {"accuracy_nm", r.repeatable ? number_or_null(result.spec.accuracy * 1e9) : Json(nullptr)}};
    rows.push_back(std::move(row));
  }
  out["rows"] = std::move(rows);
  out["warnings"] = status_warnings(result);
  return out;
}

nlohmann::ordered_json to_json(const ident::Result& result, std::string_view axis) {
  const ShownUnits units{result.force_unit, result.position_unit};
  // A key with a unit, and the way out where that unit does not hold.
  const auto put = [](Json& out, std::string_view name, std::string_view unit, bool holds, const Json& scaled,
                      const Json& plain) {
    const std::string with_unit = std::string(name) + "_" + std::string(unit);
    if (holds) {
      out[with_unit] = scaled;
      return;
    }
    out[with_unit] = nullptr;
    out[std::string(name)] = plain;
  };
  const bool newton = units.force == "N";
  const auto force = [&](Json& out, std::string_view name, double value) {
    put(out, name, "N", newton, number_or_null(value), number_or_null(value));
  };
  Json out;
  out["schema"] = "stribeck.identify/1";
  out["axis"] = axis.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(std::string(axis));
  out["method"] = ident::name_of(result.method);
  out["model"] = result.model;
  out["force_unit"] = units.force;
  out["position_unit"] = result.position_unit;
  const Json mass = number_or_null(result.mass);
  const Json mass_interval = interval(result.mass_interval.low, result.mass_interval.high);
  put(out, "mass", "kg", units.physical(), mass, mass);
  put(out, "mass_ci95", "kg", units.physical(), mass_interval, mass_interval);
  force(out, "load", result.load);
  const auto& range = result.velocity_range;
  put(out, "velocity_range", "mm_per_s", units.linear(), interval(range[0] * kMilli, range[1] * kMilli),
      interval(range[0], range[1]));
  const auto begin = curve_begin(result);
  put(out, "curve_from", "mm_per_s", units.linear(), interval(begin[0] * kMilli, begin[1] * kMilli),
      interval(begin[0], begin[1]));
  out["rows"] = result.rows;
  Json parameters = Json::array();
  for (const ident::Parameter& p : result.parameters) {
    const ShownParameter s = shown(p, units);
    Json one;
    one["name"] = p.name;
    one["value"] = number_or_null(s.value);
    one["unit"] = s.unit;
    one["ci95"] = interval(s.low, s.high);
    one["identifiable"] = p.identifiable;
    parameters.push_back(std::move(one));
  }
  out["parameters"] = std::move(parameters);
  Json curve = Json::array();
  for (const ident::CurvePoint& c : result.curve) {
    Json one;
    put(one, "velocity", "mm_per_s", units.linear(), number_or_null(c.velocity * kMilli),
        number_or_null(c.velocity));
    force(one, "friction", c.friction);
    const Json band = interval(c.ci_low, c.ci_high);
    put(one, "ci95", "N", newton, band, band);
    curve.push_back(std::move(one));
  }
  out["curve"] = std::move(curve);
  force(out, "held_out_rms", result.held_out_rms);
  out["r_squared"] = number_or_null(result.r_squared);
  Json models = Json::array();
  for (const ident::Candidate& c : result.models) {
    Json one;
    one["name"] = c.name;
    one["terms"] = c.terms;
    one["parameters"] = c.parameters;
    force(one, "held_out_rms", c.held_out_rms);
    force(one, "standard_error", c.standard_error);
    one["chosen"] = c.chosen;
    models.push_back(std::move(one));
  }
  out["models"] = std::move(models);
  out["friction"] = members(value_of(result.friction), units);
  const double way = ident::told_break_away(result);
  put(out, "break_away", "um", units.linear(), number_or_null(way * kMicro), number_or_null(way));
  out["cannot_tell"] = result.cannot_tell;
  out["warnings"] = result.warnings;
  return out;
}

}  // namespace stribeck::report
