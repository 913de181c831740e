#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include <stribeck/report/text.hpp>
#include <stribeck/workflow/reproduce/printed_tables.hpp>
#include <stribeck/workflow/reproduce/sections.hpp>

namespace stribeck::workflow::reproduction {

namespace {

using report::decimals;

std::vector<Plot> scale_plots(const Study& s) {
  const auto draw = [&](const char* title, const char* unit, const auto& unbiased, const auto& half,
                        const auto& simple, double truth) {
    Plot p = plot(fmt::format("Axis {}: {}", s.name(), title), "scale K_u of the pulses", unit);
    Series band;
    band.label = "95 %";
    band.style = Style::kBand;
    band.color = kOursColor;
    Series ours = curve("unbiased", kOursColor, false);
    Series other = curve("simple", kOtherColor, false);
    Series right = curve("machine", kPrintColor, true);
    for (const Scale& k : s.scales) {
      for (Series* x : {&band, &ours, &other, &right}) x->x.push_back(k.k_u);
      band.y_low.push_back(unbiased(k.found) - half(k.found));
      band.y_high.push_back(unbiased(k.found) + half(k.found));
      ours.y.push_back(unbiased(k.found));
      other.y.push_back(simple(k.found));
      right.y.push_back(truth);
    }
    p.series = {std::move(band), std::move(other), std::move(ours)};
    if (std::isfinite(truth)) p.series.push_back(std::move(right));
    return p;
  };
  const auto half = [](std::size_t i, double scale) {
    return [i, scale](const ident::methods::LeastSquaresA& a) {
      return 0.5 * scale * (a.result.parameters[i].ci_high - a.result.parameters[i].ci_low);
    };
  };
  using A = ident::methods::LeastSquaresA;
  Plot coulomb =
      plot(fmt::format("Axis {}: Coulomb force, unbiased", s.name()), "scale K_u of the pulses", "α0 [N]");
  Series plus = curve("v > 0", kOursColor, false);
  Series minus = curve("v < 0", kOtherColor, false);
  for (const Scale& k : s.scales) {
    for (Series* x : {&plus, &minus}) x->x.push_back(k.k_u);
    plus.y.push_back(k.found.alpha0_positive);
    minus.y.push_back(-k.found.alpha0_negative);
  }
  coulomb.series = {std::move(plus), std::move(minus)};
  return {draw(
              "mass", "mass [N s2/mm]", [](const A& a) { return a.mass_exact / kKilo; }, half(0, 1.0 / kKilo),
              [](const A& a) { return a.simple_mass / kKilo; }, s.truth().plant.mass / kKilo),
          draw(
              "viscous coefficient", "α2 [N s/mm]", [](const A& a) { return a.alpha2 / kKilo; },
              half(1, 1.0 / kKilo), [](const A& a) { return a.simple_alpha2 / kKilo; }, kNaN),
          std::move(coulomb)};
}

/// Figures with the printed value beside the computed one.
void add_figures(ReproducedSection& out, const Study& s) {
  const std::string& axis = s.name();
  const ident::methods::LeastSquaresA& p = *s.pulses;
  const ident::methods::LeastSquaresA& a = *s.a;
  const std::string table = "Table 2.1";
  const auto print = [&](std::size_t i) { return printed("2.1", axis, i); };
  add(out, "mass", axis, "N s2/mm", print(0), estimate(p.result, "mass", 1.0 / kKilo), table, 2);
  add(out, "α0, v > 0", axis, "N", print(1), estimate(p.result, "alpha0_positive"), table, 0);
  add(out, "α0, v < 0", axis, "N", print(1), estimate(p.result, "alpha0_negative", -1.0), table, 0);
  add(out, "α2", axis, "N s/mm", print(3), estimate(p.result, "alpha2", 1.0 / kKilo), table, 1);
  const auto corrected = [&](const char* what, const ident::methods::ViscousCorrection& c) {
    add(out, what, axis, "N s/mm", print(3),
        {c.alpha2 / kKilo, {c.alpha2_interval.low / kKilo, c.alpha2_interval.high / kKilo}}, table, 1);
  };
  corrected("α2 corrected by jogging, observer", *a.observer);
  corrected("α2 corrected by jogging, Kalman", *a.kalman);
}

/// Results of all methods, one row each.
void add_rows(ReproducedSection& out, const Study& s) {
  const std::string& axis = s.name();
  const ident::methods::LeastSquaresA& p = *s.pulses;
  const ident::methods::LeastSquaresA& a = *s.a;
  const auto print = [&](std::size_t i) { return printed("2.1", axis, i); };
  const auto row = [&](const std::string& from, double mass, double alpha2, double plus, double minus) {
    out.table.rows.push_back({{axis},
                              {from},
                              {decimals(mass, 2)},
                              {decimals(alpha2, 1)},
                              {decimals(plus, 0)},
                              {decimals(minus, 0)}});
  };
  const auto unbiased = [&](const std::string& from, const ident::methods::LeastSquaresA& x) {
    row(from, x.mass_exact / kKilo, x.alpha2 / kKilo, x.alpha0_positive, -x.alpha0_negative);
  };
  row("Table 2.1", print(0), print(3), print(1), print(2));
  unbiased("unbiased, all pulses", p);
  if (!s.scales.empty())
    unbiased(fmt::format("unbiased, K_u = {:g} alone", s.scales.front().k_u), s.scales.front().found);
  if (s.scales.size() > 1)
    unbiased(fmt::format("unbiased, K_u = {:g} alone", s.scales.back().k_u), s.scales.back().found);
  row("simple, all pulses", p.simple_mass / kKilo, p.simple_alpha2 / kKilo, kNaN, kNaN);
  row("jogs, observer", kNaN, a.observer->alpha2 / kKilo, a.observer->alpha0_positive,
      -a.observer->alpha0_negative);
  row("jogs, Kalman", kNaN, a.kalman->alpha2 / kKilo, a.kalman->alpha0_positive, -a.kalman->alpha0_negative);
  std::vector<SpeedAndForce> fast;
  for (const ident::methods::ObservedFriction& j : a.jogs) {
    if (std::abs(j.speed) > 0.95e-3) fast.push_back({j.speed, j.observer});
  }
  const Line own = line_through_print(fast, axis);
  row("line through Table 2.3 at the jogs", kNaN, own.slope / kKilo, own.level[0], own.level[1]);
  row("the machine itself", s.truth().plant.mass / kKilo, kNaN, kNaN, kNaN);
}

/// Friction observed during the jogs, and the lines through it.
Plot observed_plot(const Study& s) {
  const std::string& axis = s.name();
  const ident::methods::LeastSquaresA& p = *s.pulses;
  const ident::methods::LeastSquaresA& a = *s.a;
  const auto print = [&](std::size_t i) { return printed("2.1", axis, i); };
  const double top = 10.3e-3;
  Plot map =
      plot(fmt::format("Axis {}: friction observed while jogging", axis), "velocity [mm/s]", "friction [N]");
  map.series.push_back(map_curve("pulses", kOtherColor, false, top, [&](double v) {
    return two_levels(v, p.alpha0_positive, -p.alpha0_negative, p.alpha2);
  }));
  map.series.push_back(map_curve("corrected", kOursColor, false, top, [&](double v) {
    return two_levels(v, a.observer->alpha0_positive, -a.observer->alpha0_negative, a.observer->alpha2);
  }));
  map.series.push_back(map_curve("Table 2.1", kPrintColor, true, top, [&](double v) {
    return two_levels(v, print(1), print(1), print(3) * kKilo);
  }));
  Series observed = points("observer", kPrintColor, 5.0);
  for (const ident::methods::ObservedFriction& j : a.jogs) {
    observed.x.push_back(j.speed / kMilli);
    observed.y.push_back(j.observer);
  }
  map.series.push_back(std::move(observed));
  return map;
}

}  // namespace

ReproducedSection section_a(const std::vector<Study>& all) {
  ReproducedSection out =
      section("ident-A", "Unbiased least squares from pulses, viscous correction by jogging",
              "§2.3.2, Table 2.1, figs 2.11 and 2.13", "", *all.front().machine);
  out.table = {"",
               {{"axis", "", false},
                {"from", "", false},
                {"mass", "N s2/mm"},
                {"α2", "N s/mm"},
                {"α0, v > 0", "N"},
                {"α0, v < 0", "N"}},
               {}};
  double most_simple = 0.0;
  for (const Study& s : all) {
    add_figures(out, s);
    add_rows(out, s);
    most_simple = std::max(most_simple, 100.0 * (s.pulses->simple_mass / s.pulses->mass_exact - 1.0));
    std::vector<Plot> drawings = scale_plots(s);
    drawings.push_back(observed_plot(s));
    out.plots.emplace_back(
        std::move(drawings),
        "Pulses of each height by themselves, simple against unbiased least squares (fig 2.11); friction "
        "observed at constant speeds (fig 2.13).");
  }
  out.remarks = {
      "The thesis prints one Coulomb force for both directions; Table 2.3, which is the friction of this "
      "virtual machine, has two. The line through Table 2.3 at the speeds of the jogs is what Table 2.1 "
      "would be if both tables described the same friction: what remains of the difference is in the thesis itself. Of the jogs ±10 mm/s is beyond the range of Table 2.3; there the Gaussians of the machine hold "
      "the value of the border.",
      "Our pulses have all heights that move the axis. The thesis uses K_u = 4, which just moves it; the table has the lowest one that moves it here.",
      fmt::format("Simple least squares, without Coulomb friction, finds up to {:.0f} % more mass.",
                  most_simple),
      "Friction of this machine is not a straight line: α0 and α2 depend on the speeds in the log, and their intervals cover the scatter, not the choice of a line."};
  return out;
}

}  // namespace stribeck::workflow::reproduction
