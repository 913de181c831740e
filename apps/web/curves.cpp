#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include <apps/web/curves.hpp>
#include <stribeck/core/walk_fields.hpp>
#include <stribeck/io/units.hpp>
#include <stribeck/report/shown_units.hpp>

namespace stribeck::web {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kBins = 300;  // along the time, each with the extremes of every drawn quantity
constexpr int kMapPoints = 80;      // of a friction curve, in each direction

/// Few digits make a short text: what is drawn needs 1/`parts` of the unit.
Json rounded(double x, double parts) {
  if (!std::isfinite(x)) return nullptr;
  return std::round(x * parts) / parts + 0.0;  // no −0
}

/// Indices of the samples that are drawn.
std::vector<std::size_t> drawn(const std::vector<sim::ContourSample>& trace, std::size_t axes) {
  std::vector<std::size_t> kept;
  const std::size_t bins = std::min(kBins, trace.size());
  for (std::size_t b = 0; b < bins; ++b) {
    const std::size_t from = b * trace.size() / bins;
    const std::size_t to = (b + 1) * trace.size() / bins;
    const std::size_t before = kept.size();
    const auto keep_extremes = [&](auto&& value) {
      const auto less = [&](const sim::ContourSample& p, const sim::ContourSample& q) {
        return value(p) < value(q);
      };
      const auto [low, high] = std::minmax_element(trace.begin() + static_cast<std::ptrdiff_t>(from),
                                                   trace.begin() + static_cast<std::ptrdiff_t>(to), less);
      kept.push_back(static_cast<std::size_t>(low - trace.begin()));
      kept.push_back(static_cast<std::size_t>(high - trace.begin()));
    };
    keep_extremes([](const sim::ContourSample& s) { return s.contour_error; });
    for (std::size_t i = 0; i < axes; ++i)
      keep_extremes([i](const sim::ContourSample& s) { return s.force[i]; });
    std::sort(kept.begin() + static_cast<std::ptrdiff_t>(before), kept.end());
    kept.erase(std::unique(kept.begin() + static_cast<std::ptrdiff_t>(before), kept.end()), kept.end());
  }
  return kept;
}

/// Deviation across the path [m].
sim::AxisValues across(const sim::ContourSample& s, std::size_t axes) {
  double square = 0.0;
  double along = 0.0;
  for (std::size_t i = 0; i < axes; ++i) {
    square += s.velocity[i] * s.velocity[i];
    along += s.velocity[i] * (s.position[i] - s.reference[i]);
  }
  sim::AxisValues e;
  for (std::size_t i = 0; i < axes; ++i)
    e[i] = s.position[i] - s.reference[i] - (square > 0.0 ? along / square * s.velocity[i] : 0.0);
  return e;
}

Json curve_of(const sim::CompareRow& row, std::size_t axes) {
  Json t = Json::array();
  Json error = Json::array();
  Json scored = Json::array();
  struct Drawn {
    const char* key;
    double scale;
    double parts;
    Json values;
  };
  std::array<Drawn, 5> of_axes{{{"reference_mm", 1e3, 1e4, {}},
                                {"across_um", 1e6, 1e4, {}},
                                {"velocity_mm_per_s", 1e3, 1e4, {}},
                                {"force_N", 1.0, 1e2, {}},
                                {"friction_N", 1.0, 1e2, {}}}};
  for (Drawn& d : of_axes) d.values = Json(axes, Json::array());
  for (const std::size_t k : drawn(row.trace, axes)) {
    const sim::ContourSample& s = row.trace[k];
    t.push_back(rounded(s.time, 1e5));
    error.push_back(rounded(s.contour_error * 1e6, 1e4));
    scored.push_back(s.scored ? 1 : 0);
    const sim::AxisValues e = across(s, axes);
    const std::array<const sim::AxisValues*, 5> from{&s.reference, &e, &s.velocity, &s.force, &s.friction};
    for (std::size_t j = 0; j < of_axes.size(); ++j) {
      for (std::size_t i = 0; i < axes; ++i)
        of_axes[j].values[i].push_back(rounded((*from[j])[i] * of_axes[j].scale, of_axes[j].parts));
    }
  }
  Json out{{"controller", row.controller.id}, {"label", row.controller.label}, {"t_s", std::move(t)}};
  out["error_um"] = std::move(error);
  out["scored"] = std::move(scored);
  for (Drawn& d : of_axes) out[d.key] = std::move(d.values);
  return out;
}

Json map_of(const friction::Model& model, const std::vector<double>& speeds) {
  Json out = Json::array();
  for (const double v : speeds) {
    const auto p = model.parts(v, 0.0);
    out.push_back(rounded(std::copysign(p.level, v) + p.viscous, 1e2));
  }
  return out;
}

/// Steady friction of an axis: the truth, and what the controllers know of it.
Json friction_of(const workflow::Comparison& c, std::size_t axis, double fastest) {
  std::vector<double> speeds;
  for (int k = -kMapPoints; k <= kMapPoints; ++k) {
    // Close together where friction bends: at low speed.
    const double share = static_cast<double>(k) / kMapPoints;
    if (k != 0) speeds.push_back(fastest * share * std::abs(share));
  }
  Json v = Json::array();
  for (const double speed : speeds) v.push_back(rounded(speed * 1e3, 1e4));
  Json out{{"axis", c.machine.axes[axis].first}, {"velocity_mm_per_s", std::move(v)}};
  out["truth_N"] = map_of(c.machine.axes[axis].second.plant.friction, speeds);
  out["models"] = Json::array();
  const sim::AxisKnowledge& known = c.parameters.knowledge[axis];
  const auto add = [&](const char* kind, const std::optional<friction::AxisModel>& model) {
    if (model) out["models"].push_back({{"kind", kind}, {"friction_N", map_of(model->friction, speeds)}});
  };
  add("conventional", known.conventional);
  add("gaussian", known.gaussian);
  add("eccentric", known.eccentric);
  add("whole", known.whole);
  return out;
}

// ---- what can be changed

/// What people turn first, by its key below the plant, and what they call it.
struct Named {
  std::string_view key;
  std::string_view label;
};
/// Scales of the whole curve, which no single key is.
constexpr std::array<Named, 3> kParts{{{"friction.coulomb", "Level of friction (Coulomb)"},
                                       {"friction.viscous", "Viscous friction"},
                                       {"friction.stiffness", "Stiffness of the bristles"}}};
constexpr std::array<Named, 10> kMain{{{"friction.steady.stribeck.alpha1", "Static friction"},
                                       {"friction.steady.stribeck.v0", "Stribeck velocity"},
                                       {"friction.steady.stribeck.delta", "Shape of the Stribeck part"},
                                       {"mass", "Mass"},
                                       {"load", "Load"},
                                       {"encoder.resolution", "Step of the encoder"},
                                       {"delay_periods", "Delay in control periods"},
                                       {"noise.rms", "Force noise (RMS)"},
                                       {"lost_motion.backlash", "Backlash"},
                                       {"lost_motion.stiffness", "Stiffness between motor and table"}}};

/// Empty: not one of them.
std::string_view main_label(std::string_view key) {
  const auto found = std::find_if(kMain.begin(), kMain.end(), [&](const Named& n) { return n.key == key; });
  return found == kMain.end() ? std::string_view() : found->label;
}

struct MachineAxisName {
  std::string name;
  bool rotary = false;
};

/// Numbers below a group with their keys, as the factors of a study name them.
void walk(const Value& value, const std::string& key, const FieldInfo* info, const MachineAxisName& axis,
          Json& list) {
  switch (value.kind()) {
    case Kind::kOptional:
      if (value.size() > 0) walk(value[0], key, info, axis, list);
      return;
    case Kind::kVariant:
      return walk(value.chosen(), key, info, axis, list);
    case Kind::kGroup:
      for_each_member(value, [&](const Member& m) {
        const std::string below =
            key.empty() ? std::string(m.info.name) : key + "." + std::string(m.info.name);
        if (below == "drive" || below == "converter") return;
        walk(m.value, below, &m.info, axis, list);
      });
      return;
    case Kind::kList:
      if (value.has_fixed_size()) return;
      for (std::size_t i = 0; i < value.size(); ++i)
        walk(value[i], key + "[" + std::to_string(i + 1) + "]", info, axis, list);
      return;
    case Kind::kNumber:
    case Kind::kCount:
      break;
    default:
      return;
  }
  const Quantity& q = info->quantity;
  const std::string unit(q.unit.empty() ? std::string_view() : q.shown);
  auto known = std::find_if(list.begin(), list.end(), [&](const Json& p) { return p["key"] == key; });
  if (known == list.end()) {
    list.push_back({{"key", key},
                    {"doc", std::string(info->doc)},
                    {"unit", unit},
                    {"kind", value.kind() == Kind::kCount ? "count" : "number"},
                    {"label", std::string(main_label(key))},
                    {"main", !main_label(key).empty()},
                    {"values", Json::object()}});
    known = list.end() - 1;
  }
  const double shown = unit.empty() ? value.number() : io::conversion(q.unit, unit)(value.number());
  (*known)["values"][axis.name] = shown;
  if (!axis.rotary || unit.empty()) return;
  // The axis is carried at a radius of 1 m; a factor of it turns the shown value into one in N m and degrees.
  const auto [turning, factor] = report::ShownUnits::degrees_of(q.unit);
  if (turning != q.unit)
    (*known)["turning"][axis.name] = {{"unit", turning},
                                      {"factor", factor / io::conversion(q.unit, unit)(1.0)}};
}

}  // namespace

void add_curves(Json& json, const workflow::Comparison& c) {
  const std::vector<std::size_t> axes = sim::chosen_axes(c.machine, c.result.spec);
  json["axes"] = c.result.axes;
  json["rotary"] = Json::array();
  for (const std::size_t i : axes) json["rotary"].push_back(c.machine.axes[i].second.rotary);
  json["sample_time_ms"] = c.result.period * 1e3;
  json["signed"] = axes.size() == 2;
  json["curves"] = Json::array();
  std::vector<double> fastest(axes.size(), 1e-3);
  for (const sim::CompareRow& row : c.result.rows) {
    if (row.trace.empty()) continue;
    json["curves"].push_back(curve_of(row, axes.size()));
    for (const sim::ContourSample& s : row.trace) {
      for (std::size_t i = 0; i < axes.size(); ++i)
        fastest[i] = std::fmax(fastest[i], std::abs(s.velocity[i]));
    }
  }
  json["friction"] = Json::array();
  for (std::size_t i = 0; i < axes.size(); ++i)
    json["friction"].push_back(friction_of(c, axes[i], 1.1 * fastest[i]));
}

Json machine_form(const sim::Machine& machine) {
  Json json{{"name", machine.name}, {"origin", machine.origin}};
  json["sample_time_ms"] = machine.sample_time * 1e3;
  json["axes"] = Json::array();
  Json list = Json::array();
  for (const Named& part : kParts) {
    list.push_back({{"key", part.key},
                    {"doc", std::string(part.label) + " of the whole curve, as a factor"},
                    {"unit", ""},
                    {"kind", "scale"},
                    {"label", part.label},
                    {"main", true},
                    {"values", Json::object()}});
  }
  bool published = !machine.axes.empty();
  for (const auto& [name, axis] : machine.axes) {
    json["axes"].push_back(name);
    json["rotary"].push_back(axis.rotary);
    for (std::size_t i = 0; i < kParts.size(); ++i) list[i]["values"][name] = 1.0;
    walk(value_of(axis.plant), "", nullptr, {name, axis.rotary}, list);
    published = published && axis.published.conventional && axis.published.gaussian;
  }
  json["published"] = published;
  json["parameters"] = std::move(list);
  return json;
}

}  // namespace stribeck::web
