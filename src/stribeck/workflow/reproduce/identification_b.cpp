#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include <stribeck/report/text.hpp>
#include <stribeck/workflow/reproduce/printed_tables.hpp>
#include <stribeck/workflow/reproduce/sections.hpp>

namespace stribeck::workflow::reproduction {

namespace {

using report::decimals;

std::string chosen_name(const ident::Result& r) {
  for (const ident::Candidate& c : r.models) {
    if (c.chosen) return c.name;
  }
  return r.model;
}

/// Means of the jogs, the fit and the printed curve.
template <class Force>
Plot jog_plot(const Study& s, const std::string& label, Force&& print) {
  const ident::Result& r = s.b->result;
  Plot p =
      plot(fmt::format("Axis {}: friction at constant speeds", s.name()), "velocity [mm/s]", "friction [N]");
  const double top = 1.03 * std::max(r.velocity_range[1], -r.velocity_range[0]);
  p.series.push_back(
      map_curve("fit", kOursColor, false, top, [&](double v) { return force_of(r.friction.steady, v); }));
  p.series.push_back(map_curve(label, kPrintColor, true, top, print));
  Series means = points("means", kPrintColor, 4.0);
  for (const ident::MapPoint& m : r.map) {
    means.x.push_back(m.velocity / kMilli);
    means.y.push_back(m.friction);
  }
  p.series.push_back(std::move(means));
  return p;
}

}  // namespace

ReproducedSection section_b_table(const std::vector<Study>& all) {
  ReproducedSection out = section("ident-B", "Jogs and nonlinear fit, mass from a sine",
                                  "§2.3.3, Table 2.2, fig 2.14", "biaxial table", *all.front().machine);
  out.table = {"",
               {{"axis", "", false},
                {"from", "", false},
                {"mass", "N s2/mm"},
                {"α2", "N s/mm"},
                {"α0, v > 0", "N"},
                {"α0, v < 0", "N"}},
               {}};
  std::vector<Plot> drawings;
  for (const Study& s : all) {
    const std::string& axis = s.name();
    const ident::Result& r = s.b->result;
    const std::string table = "Table 2.2";
    const Line ours = line_through(means_of(*s.b));
    const Line own = line_through_print(means_of(*s.b), axis);
    const auto print = [&](std::size_t i) { return printed("2.2", axis, i); };
    add(out, "mass", axis, "N s2/mm", print(0),
        {r.mass / kKilo, {r.mass_interval.low / kKilo, r.mass_interval.high / kKilo}}, table, 2);
    add(out, "α0, v > 0 (printed as α0)", axis, "N", print(1), plus_minus(ours.level[0], ours.level_half[0]),
        table, 0);
    add(out, "α0, v < 0 (printed as α1)", axis, "N", print(2), plus_minus(ours.level[1], ours.level_half[1]),
        table, 0);
    add(out, "α2", axis, "N s/mm", print(3), plus_minus(ours.slope / kKilo, ours.slope_half / kKilo), table,
        1);
    const auto row = [&](const std::string& from, double mass, double alpha2, double plus, double minus) {
      out.table.rows.push_back({{axis},
                                {from},
                                {decimals(mass, 2)},
                                {decimals(alpha2, 1)},
                                {decimals(plus, 0)},
                                {decimals(minus, 0)}});
    };
    row(table, print(0), print(3), print(1), print(2));
    row("jogs", r.mass / kKilo, ours.slope / kKilo, ours.level[0], ours.level[1]);
    row("line through Table 2.3 at the jogs", kNaN, own.slope / kKilo, own.level[0], own.level[1]);
    row("the machine itself", s.truth().plant.mass / kKilo, kNaN, kNaN, kNaN);
    drawings.push_back(
        jog_plot(s, table, [&](double v) { return two_levels(v, print(1), print(2), print(3) * kKilo); }));
    out.remarks.push_back(
        fmt::format("Axis {}: held-out speeds choose \"{}\"; the figures are those of the printed form, "
                    "one level for each direction and one slope, fitted to the same means.",
                    axis, chosen_name(r)));
  }
  out.remarks.insert(out.remarks.begin(),
                     "Table 2.2 prints α0 above α1, which cannot be Coulomb and static friction, and no v0 "
                     "and δ. Read as the two directions it has the same sign of the difference as Table "
                     "2.3 on both axes.");
  out.plots.emplace_back(std::move(drawings),
                         "Mean friction at 23 speeds from 0.01 to 9 mm/s, both ways (fig 2.14).");
  return out;
}

ReproducedSection section_b_tool(const std::vector<Study>& all) {
  ReproducedSection out = section("ident-B", "Jogs and nonlinear fit", "§4.4.1, Table 4.2, fig 4.4",
                                  "triaxial machine tool", *all.front().machine);
  out.table = {"",
               {{"axis", "", false},
                {"from", "", false},
                {"α0", "N"},
                {"α1", "N"},
                {"α2", "N s/mm"},
                {"v0", "mm/s"},
                {"mass", "N s2/mm"}},
               {}};
  std::vector<Plot> drawings;
  for (const Study& s : all) {
    const std::string& axis = s.name();
    const std::string table = "Table 4.2";
    const ident::Result& r = s.b->result;
    const Conventional c = conventional_of(r);
    const auto print = [&](std::size_t i) { return printed("4.2", axis, i); };
    add(out, "α0", axis, "N", print(0), c.alpha0, table, 2);
    add(out, "α1", axis, "N", print(1), c.alpha1, table, 2);
    add(out, "α2", axis, "N s/mm", print(2), c.alpha2, table, 3);
    add(out, "v0", axis, "mm/s", print(3), c.v0, table, 3);
    add(out, "mass, from the sine", axis, "N s2/mm", printed("4.4", axis, 0),
        {r.mass / kKilo, {r.mass_interval.low / kKilo, r.mass_interval.high / kKilo}}, "Table 4.4", 3);
    const auto row = [&](const std::string& from, double alpha0, double alpha1, double alpha2, double v0,
                         double mass) {
      out.table.rows.push_back({{axis},
                                {from},
                                {decimals(alpha0, 2)},
                                {decimals(alpha1, 2)},
                                {decimals(alpha2, 3)},
                                {decimals(v0, 3)},
                                {decimals(mass, 3)}});
    };
    row(table, print(0), print(1), print(2), print(3), printed("4.4", axis, 0));
    row("jogs", c.alpha0.value, c.alpha1.value, c.alpha2.value, c.v0.value, r.mass / kKilo);
    const auto* truth = std::get_if<friction::Conventional<double>>(&s.truth().plant.friction.steady);
    if (truth != nullptr && truth->stribeck) {
      row("the machine itself", truth->alpha0, truth->stribeck->alpha1, truth->alpha2 / kKilo,
          truth->stribeck->v0 / kMilli, s.truth().plant.mass / kKilo);
    }
    friction::Conventional<double> map{print(0), print(2) * kKilo,
                                       friction::Stribeck<double>{print(1), print(3) * kMilli, print(4)}};
    drawings.push_back(jog_plot(s, table, [map](double v) { return friction::steady_force(map, v); }));
    if (&s == &all.front())
      out.remarks.push_back(fmt::format(
          "Held-out speeds choose \"{}\"; the figures are means of both directions.", chosen_name(r)));
  }
  out.remarks.emplace_back(
      "Tables 4.2 and 4.3 print different Coulomb and viscous friction for x and z. The virtual machine "
      "has Table 4.3's, with the Stribeck rise of Table 4.2 on top; so Table 4.2 cannot be reached there, "
      "and is for y.");
  out.remarks.emplace_back(
      "The shape δ is 2 in the form that was chosen. The screw's sine is found in the jogs and subtracted from the means.");
  out.remarks.emplace_back(
      "The thesis takes the mass of this machine from constant acceleration, not from this method: here "
      "from a sine, by rows of equal speed, accelerating against braking, with the screw's sine partialled "
      "out. Left in, it counts as inertia and makes the mass 7 to 31 % too large.");
  out.plots.emplace_back(std::move(drawings),
                         "Mean friction at 29 speeds from 0.01 to 15 mm/s, both ways (fig 4.4).");
  return out;
}

}  // namespace stribeck::workflow::reproduction
