#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stribeck/core/numbers.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <stribeck/io/units.hpp>
#include <stribeck/report/parameters.hpp>
#include <stribeck/report/plot/time_axis.hpp>
#include <stribeck/report/text.hpp>
#include <utility>

namespace stribeck::report {
namespace {

constexpr std::string_view kFitColor = "#0072b2";
constexpr std::string_view kConventionalColor = "#e69f00";
constexpr std::string_view kPointColor = "#b4bac0";

using Force = std::function<double(double)>;

Force steady(const friction::SteadyVariant& map) {
  return [map](double v) {
    return std::visit([v](const auto& m) { return friction::steady_force(m, v); }, map);
  };
}

/// The points of a fit's curve joined by straight lines; NaN outside it and across standstill.
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

/// Velocities from low to high without zero; there is a gap at zero.
std::vector<double> velocities(double low, double high) {
  constexpr int kEach = 160;
  // Ever closer towards rest, where a Stribeck part is a few per cent of the range wide.
  const auto share = [](int i) { return std::pow(static_cast<double>(i) / kEach, 2.0); };
  std::vector<double> v;
  for (int i = kEach; i >= 1; --i) v.push_back(low * share(i));
  v.push_back(kNaN);
  for (int i = 1; i <= kEach; ++i) v.push_back(high * share(i));
  return v;
}

Series line(std::string label, const std::vector<double>& at, double scale, const Force& force,
            const Force& less, std::string_view color, double width, bool dashed) {
  Series s;
  s.label = std::move(label);
  s.color = std::string(color);
  s.width = width;
  s.dashed = dashed;
  for (const double v : at) {
    s.x.push_back(v * scale);
    s.y.push_back(std::isfinite(v) ? force(v) - less(v) : kNaN);
  }
  return s;
}

/// Range for differences from the fit that includes points, band and truth; the conventional model may lie outside
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
    // A few outliers must not flatten the rest.
    most = std::max(most, ident::stats::quantile(std::move(sizes), 0.98));
  }
  if (!(most > 0.0)) return std::nullopt;
  return Range{-room * most, room * most};
}

}  // namespace

ShownUnits units_of(const ident::Result& result) {
  const ShownUnits units{result.force_unit, result.position_unit};
  return result.rotary && units.physical() ? ShownUnits::turning() : units;
}

ShownParameter shown(const ident::Parameter& p, const ShownUnits& units) {
  if (units.in_degrees()) {
    const auto [unit, factor] = ShownUnits::degrees_of(p.unit);
    // What has no length in it keeps its unit for people, e.g. ms.
    if (unit != p.unit) return {factor * p.value, factor * p.ci_low, factor * p.ci_high, std::string(unit)};
  }
  const std::string unit(units.chosen(
      p.unit, units.physical() ? io::shown_unit(p.value, {p.unit, p.shown}) : std::string_view(p.shown)));
  const io::Conversion to_shown = io::conversion(p.unit, unit);
  return {to_shown(p.value), to_shown(p.ci_low), to_shown(p.ci_high), units.named(unit)};
}

std::array<double, 2> curve_begin(const ident::Result& result) {
  std::array<double, 2> begin{kNaN, kNaN};
  for (const ident::CurvePoint& p : result.curve) {
    if (p.velocity < 0.0) begin[0] = p.velocity;
    if (p.velocity > 0.0 && !(begin[1] <= p.velocity)) begin[1] = p.velocity;
  }
  return begin;
}

std::string shown_number(double value, double low, double high) {
  const double half = 0.5 * (high - low);
  if (!std::isfinite(half) || half <= 0.0 || !std::isfinite(value)) return significant(value, 4);
  // Two digits of the half width, for the value and for the limits alike.
  int digits = 1 - static_cast<int>(std::floor(std::log10(half)));
  // Of an interval over decades that excludes zero, two digits of each number: the smaller ones would be shown as zero.
  if (low * high > 0.0 && value != 0.0)
    digits = std::max(digits, 1 - static_cast<int>(std::floor(std::log10(std::abs(value)))));
  if (digits > 8) return significant(value, 6);
  if (digits >= 0) return decimals(value, digits);
  const double last = std::pow(10.0, -digits);
  return decimals(std::round(value / last) * last + 0.0, 0);
}

Table parameter_table(const ident::Result& result) {
  const ShownUnits units = units_of(result);
  Table t{"", {{"parameter", "", false}, {"value", ""}, {"95 % interval", ""}, {"unit", "", false}}, {}};
  for (const ident::Parameter& p : result.parameters) {
    const ShownParameter s = shown(p, units);
    const bool known = std::isfinite(s.low) && std::isfinite(s.high);
    t.rows.push_back(
        // On a small screen only the first column is always in view.
        {Cell{.text = p.name,
              .note = p.identifiable ? "" : "not determined by the data: do not use it alone"},
         {shown_number(s.value, s.low, s.high)},
         {known ? shown_number(s.low, s.low, s.high) + "\u00A0… " + shown_number(s.high, s.low, s.high)
                : "not known"},
         {printed_unit(s.unit)}});
  }
  return t;
}

int candidate_digits(const ident::Result& result) {
  double least = std::numeric_limits<double>::infinity();
  for (const ident::Candidate& c : result.models) {
    if (c.held_out_rms > 0.0) least = std::fmin(least, c.held_out_rms);
  }
  if (!std::isfinite(least)) return 2;
  return std::clamp(3 - static_cast<int>(std::floor(std::log10(least))), 2, 8);
}

Table candidate_table(const ident::Result& result) {
  const std::string unit = units_of(result).force;
  Table t{"Models that were tried",
          {{"model", "", false},
           {"parameters", ""},
           {"RMS on held-out motion", unit},
           {"± from the best", unit},
           {"", "", false}},
          {}};
  const int digits = candidate_digits(result);
  for (const ident::Candidate& c : result.models) {
    t.rows.push_back({{c.name, "", "", c.chosen},
                      {std::to_string(c.parameters)},
                      {decimals(c.held_out_rms, digits), "", "", c.chosen},
                      {decimals(c.standard_error, digits)},
                      {c.chosen ? "chosen" : ""}});
  }
  return t;
}

std::vector<Plot> friction_plots(const FrictionMap& map) {
  const ShownUnits units = map.fit != nullptr ? units_of(*map.fit)
                           : map.rotary       ? ShownUnits::turning()
                                              : ShownUnits();
  const double scale = units.per_velocity;
  const bool periodic = map.fit != nullptr && !map.fit->friction.eccentric.empty();
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
    const std::string of = map.axis.empty() ? "" : "Axis " + map.axis + ": ";
    p.title = of + (difference ? "difference from the fit" : "friction map");
    p.x_label = "velocity [" + units.velocity + "]";
    p.y_label = (difference ? "difference [" : "friction [") + units.force + "]";
    p.width = 560;
    p.height = 380;
    p.legend = Legend::kAbove;
    p.x_range = Range{low * scale * 1.02, high * scale * 1.02};
    if (map.fit != nullptr && !map.fit->map.empty()) {
      Series points{.label = periodic ? "measured, less periodic terms" : "measured",
                    .style = Style::kPoints,
                    .color = std::string(kPointColor),
                    .width = 1.2};
      for (const ident::MapPoint& m : map.fit->map) {
        const double base = less(m.velocity);
        if (!std::isfinite(base)) continue;
        points.x.push_back(m.velocity * scale);
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
        band.x.push_back(c.velocity * scale);
        band.y_low.push_back(c.ci_low - base);
        band.y_high.push_back(c.ci_high - base);
      }
      p.series.push_back(std::move(band));
    }
    if (map.conventional) {
      p.series.push_back(
          line("conventional", at, scale, steady(*map.conventional), less, kConventionalColor, 1.6, false));
    }
    if (fitted || map.model) {
      p.series.push_back(line(fitted ? "fit" : map.model_label, at, scale, fit, less, kFitColor, 2.0, false));
    }
    if (map.truth)
      p.series.push_back(line(map.truth_label, at, scale, steady(*map.truth), less, "#000000", 1.3, true));
    if (difference) p.y_range = close_range(p.series, map.conventional ? 2.5 : 1.15);
    return p;
  };
  std::vector<Plot> plots{draw(zero, false)};
  if (fitted || map.model) plots.push_back(draw(fit, true));
  return plots;
}

namespace {

/// Means of equal slices of x with twice their standard error; slices with few points are gaps.
void add_means(Plot& plot) {
  constexpr int kSlices = 30;
  constexpr std::size_t kFewest = 5;
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const Series& s : plot.series) {
    for (const double x : s.x) {
      low = std::fmin(low, x);
      high = std::fmax(high, x);
    }
  }
  if (!(high > low)) return;
  struct Slice {
    std::size_t n = 0;
    double sum = 0.0;
    double squares = 0.0;
  };
  std::array<Slice, kSlices> slices{};
  for (const Series& s : plot.series) {
    for (std::size_t k = 0; k < s.x.size(); ++k) {
      const auto i = static_cast<std::size_t>(
          std::clamp(std::floor((s.x[k] - low) / (high - low) * kSlices), 0.0, kSlices - 1.0));
      ++slices[i].n;
      slices[i].sum += s.y[k];
      slices[i].squares += s.y[k] * s.y[k];
    }
  }
  Series band{
      .label = "± 2 standard errors", .style = Style::kBand, .color = std::string(kConventionalColor)};
  Series mean{.label = "mean of slices", .color = std::string(kConventionalColor), .width = 2.0};
  for (std::size_t i = 0; i < kSlices; ++i) {
    const Slice& s = slices[i];
    const double x = low + (high - low) * (static_cast<double>(i) + 0.5) / kSlices;
    const auto n = static_cast<double>(s.n);
    const bool known = s.n >= kFewest;
    const double m = known ? s.sum / n : kNaN;
    const double error = known ? std::sqrt(std::fmax(s.squares / n - m * m, 0.0) / (n - 1.0)) : kNaN;
    mean.x.push_back(x);
    mean.y.push_back(m);
    band.x.push_back(x);
    band.y_low.push_back(m - 2.0 * error);
    band.y_high.push_back(m + 2.0 * error);
  }
  plot.series.push_back(std::move(band));
  plot.series.push_back(std::move(mean));
}

}  // namespace

std::vector<Plot> residual_plots(const ident::Result& result) {
  if (result.residuals.empty()) return {};
  const ShownUnits units = units_of(result);
  struct View {
    std::string over;
    std::string unit;
    double ident::ResidualPoint::*member;
    double scale;
    double origin = 0.0;
  };
  std::vector<double> times;
  for (const auto& r : result.residuals) times.push_back(r.t);
  const TimeAxis time = time_axis(times);
  const std::array views{
      View{"velocity", units.velocity, &ident::ResidualPoint::v, units.per_velocity},
      View{"position", units.position, &ident::ResidualPoint::x, units.per_position},
      View{"time", "s", &ident::ResidualPoint::t, 1.0, time.origin},
  };
  std::vector<double> sizes;
  for (const auto& p : result.residuals) {
    if (std::isfinite(p.error)) sizes.push_back(std::abs(p.error));
  }
  if (sizes.empty()) return {};
  // A few outliers must not flatten the rest.
  const double border = 1.25 * ident::stats::quantile(std::move(sizes), 0.995);
  std::vector<Plot> plots;
  for (const View& view : views) {
    Plot p;
    p.title = "Residual against " + view.over;
    p.x_label = view.over + " [" + view.unit + "]";
    if (view.member == &ident::ResidualPoint::t) p.x_label = time.label;
    p.y_label = "residual [" + units.force + "]";
    p.width = 560;
    p.height = 300;
    if (border > 0.0) p.y_range = Range{-border, border};
    Series points{.label = "measured less model",
                  .style = Style::kPoints,
                  .color = std::string(kPointColor),
                  .width = 1.2};
    for (const auto& r : result.residuals) {
      if (!std::isfinite(r.error) || !std::isfinite(r.*view.member)) continue;
      points.x.push_back((r.*view.member - view.origin) * view.scale);
      points.y.push_back(r.error);
    }
    p.series.push_back(std::move(points));
    add_means(p);
    plots.push_back(std::move(p));
  }
  return plots;
}

std::optional<Plot> spectrum_plot(const ident::Result& result) {
  if (result.spectrum.size() < 2) return std::nullopt;
  const ShownUnits units = units_of(result);
  Plot p;
  p.title = "What repeats with the position";
  p.x_label = "period [" + units.position + "]";
  p.y_label = "amplitude [" + units.force + "]";
  p.width = 560;
  p.height = 300;
  p.log_x = true;
  Series line{.label = "residual before periodic terms", .color = std::string(kFitColor), .width = 1.4};
  for (const auto& s : result.spectrum) {
    if (!(s.period > 0.0)) continue;
    line.x.push_back(s.period * units.per_position);
    line.y.push_back(s.amplitude);
  }
  if (line.x.size() < 2) return std::nullopt;
  const double low = line.x.front();
  const double high = line.x.back();
  p.series.push_back(std::move(line));
  Series terms{
      .label = "terms that the model took", .style = Style::kPoints, .color = "#d55e00", .width = 5.0};
  for (const auto& term : result.friction.eccentric) {
    const double period = term.period * units.per_position;
    if (period < low || period > high) continue;
    terms.x.push_back(period);
    terms.y.push_back(term.amplitude);
    p.markers.push_back({period, significant(period, 3) + " " + units.position});
  }
  if (!terms.x.empty()) p.series.push_back(std::move(terms));
  return p;
}

}  // namespace stribeck::report
