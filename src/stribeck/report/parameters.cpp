#include <algorithm>
#include <cmath>
#include <limits>
#include <stribeck/io/units.hpp>
#include <stribeck/report/parameters.hpp>
#include <stribeck/report/text.hpp>
#include <utility>

namespace stribeck::report {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr std::string_view kFitColor = "#0072b2";
constexpr std::string_view kConventionalColor = "#e69f00";
constexpr std::string_view kPointColor = "#b4bac0";

using Force = std::function<double(double)>;

Force steady(const friction::SteadyVariant& map) {
  return [map](double v) {
    return std::visit([v](const auto& m) { return friction::steady_force(m, v); }, map);
  };
}

/// Straight lines between the points of a fit's curve; NaN beyond it and across standstill.
Force interpolated(const std::vector<ident::CurvePoint>& curve, double ident::CurvePoint::*member) {
  return [&curve, member](double v) {
    const auto above = std::lower_bound(
        curve.begin(), curve.end(), v, [](const ident::CurvePoint& p, double at) { return p.velocity < at; });
    if (above == curve.end()) return kNaN;
    if (above->velocity == v) return (*above).*member;
    if (above == curve.begin()) return kNaN;
    const auto below = above - 1;
    if ((below->velocity < 0.0) != (above->velocity < 0.0)) return kNaN;
    const double share = (v - below->velocity) / (above->velocity - below->velocity);
    return (1.0 - share) * (*below).*member + share * (*above).*member;
  };
}

/// Velocities from low to high without zero, with a gap there.
std::vector<double> velocities(double low, double high) {
  constexpr int kEach = 160;
  std::vector<double> v;
  for (int i = kEach; i >= 1; --i) v.push_back(low * i / kEach);
  v.push_back(kNaN);
  for (int i = 1; i <= kEach; ++i) v.push_back(high * i / kEach);
  return v;
}

Series line(std::string label, const std::vector<double>& at, const Force& force, const Force& less,
            std::string_view color, double width, bool dashed) {
  Series s;
  s.label = std::move(label);
  s.color = std::string(color);
  s.width = width;
  s.dashed = dashed;
  for (const double v : at) {
    s.x.push_back(v * 1e3);
    s.y.push_back(std::isfinite(v) ? force(v) - less(v) : kNaN);
  }
  return s;
}

/// A range for differences from the fit that shows points, band and truth; the conventional model may leave
/// it.
std::optional<Range> close_range(const std::vector<Series>& series, double room) {
  std::vector<double> sizes;
  double most = 0.0;
  for (const Series& s : series) {
    if (s.style == Style::kPoints) {
      for (const double v : s.y) sizes.push_back(std::abs(v));
    } else if (s.style == Style::kBand || s.dashed) {
      for (const auto* column : {&s.y, &s.y_low, &s.y_high}) {
        for (const double v : *column) most = std::fmax(most, std::abs(v));
      }
    }
  }
  if (!sizes.empty()) {
    // A few points far out must not flatten the rest.
    const auto at = sizes.begin() + static_cast<std::ptrdiff_t>(0.98 * static_cast<double>(sizes.size() - 1));
    std::nth_element(sizes.begin(), at, sizes.end());
    most = std::max(most, *at);
  }
  if (!(most > 0.0)) return std::nullopt;
  return Range{-room * most, room * most};
}

}  // namespace

ShownParameter shown(const ident::Parameter& p) {
  const std::string unit = p.shown.empty() ? p.unit : p.shown;
  const io::Conversion to_shown = io::conversion(p.unit, unit);
  return {to_shown(p.value), to_shown(p.ci_low), to_shown(p.ci_high), unit};
}

std::string shown_number(double value, double low, double high) {
  const double half = 0.5 * (high - low);
  if (!std::isfinite(half) || half <= 0.0 || !std::isfinite(value)) return significant(value, 4);
  // Two digits of the half width, for the value and for the borders alike.
  const int digits = 1 - static_cast<int>(std::floor(std::log10(half)));
  return digits > 8 ? significant(value, 6) : decimals(value, std::max(digits, 0));
}

Table parameter_table(const ident::Result& result) {
  Table t{
      "",
      {{"parameter", "", false}, {"value", ""}, {"95 % interval", ""}, {"unit", "", false}, {"", "", false}},
      {}};
  for (const ident::Parameter& p : result.parameters) {
    const ShownParameter s = shown(p);
    const bool known = std::isfinite(s.low) && std::isfinite(s.high);
    t.rows.push_back(
        {{p.name},
         {shown_number(s.value, s.low, s.high)},
         {known ? shown_number(s.low, s.low, s.high) + " … " + shown_number(s.high, s.low, s.high)
                : "not known"},
         {s.unit},
         {p.identifiable ? "" : "not determined by the data: means nothing alone"}});
  }
  return t;
}

Table candidate_table(const ident::Result& result) {
  Table t{"Models that were tried",
          {{"model", "", false},
           {"parameters", ""},
           {"RMS on held-out motion", "N"},
           {"standard error of the difference from the best", "N"},
           {"", "", false}},
          {}};
  for (const ident::Candidate& c : result.models) {
    t.rows.push_back({{c.name, "", "", c.chosen},
                      {std::to_string(c.parameters)},
                      {decimals(c.held_out_rms, 2), "", "", c.chosen},
                      {decimals(c.standard_error, 2)},
                      {c.chosen ? "chosen" : ""}});
  }
  return t;
}

std::vector<Plot> friction_plots(const FrictionMap& map) {
  const bool fitted = map.fit != nullptr && map.fit->curve.size() > 1;
  const double low = fitted ? map.fit->curve.front().velocity : -map.speed;
  const double high = fitted ? map.fit->curve.back().velocity : map.speed;
  std::vector<double> at = velocities(low, high);
  if (!(low < 0.0 && high > 0.0)) {
    at.clear();
    for (int i = 0; i <= 320; ++i) at.push_back(low + (high - low) * i / 320.0);
  }
  const Force zero = [](double) { return 0.0; };
  Force fit = zero;
  if (fitted && !map.fit->curve.empty()) {
    fit = interpolated(map.fit->curve, &ident::CurvePoint::friction);
  } else if (map.model) {
    fit = steady(*map.model);
  }

  const auto draw = [&](const Force& less, bool difference) {
    Plot p;
    p.title =
        difference ? "Axis " + map.axis + ": difference from the fit" : "Axis " + map.axis + ": friction map";
    p.x_label = "velocity [mm/s]";
    p.y_label = difference ? "difference [N]" : "friction [N]";
    p.width = 560;
    p.height = 380;
    p.legend = Legend::kAbove;
    p.x_range = Range{low * 1e3 * 1.02, high * 1e3 * 1.02};
    if (map.fit != nullptr && !map.fit->map.empty()) {
      Series points{
          .label = "measured", .style = Style::kPoints, .color = std::string(kPointColor), .width = 1.2};
      for (const ident::MapPoint& m : map.fit->map) {
        const double base = less(m.velocity);
        if (!std::isfinite(base)) continue;
        points.x.push_back(m.velocity * 1e3);
        points.y.push_back(m.friction - base);
      }
      p.series.push_back(std::move(points));
    }
    if (fitted) {
      Series band{.label = "95 %", .style = Style::kBand, .color = std::string(kFitColor)};
      double before = kNaN;
      for (const ident::CurvePoint& c : map.fit->curve) {
        if (before < 0.0 && c.velocity >= 0.0) {
          for (auto* column : {&band.x, &band.y_low, &band.y_high}) column->push_back(kNaN);
        }
        before = c.velocity;
        const double base = less(c.velocity);
        band.x.push_back(c.velocity * 1e3);
        band.y_low.push_back(c.ci_low - base);
        band.y_high.push_back(c.ci_high - base);
      }
      p.series.push_back(std::move(band));
    }
    if (map.conventional) {
      p.series.push_back(
          line("conventional", at, steady(*map.conventional), less, kConventionalColor, 1.6, false));
    }
    if (fitted || map.model) {
      p.series.push_back(line(fitted ? "fit" : map.model_label, at, fit, less, kFitColor, 2.0, false));
    }
    if (map.truth)
      p.series.push_back(line(map.truth_label, at, steady(*map.truth), less, "#000000", 1.3, true));
    if (difference) p.y_range = close_range(p.series, map.conventional ? 2.5 : 1.15);
    return p;
  };
  std::vector<Plot> plots{draw(zero, false)};
  if (fitted || map.model) plots.push_back(draw(fit, true));
  return plots;
}

}  // namespace stribeck::report
