#include <fmt/format.h>

#include <stribeck/report/parameters.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/workflow/reproduce/printed_tables.hpp>
#include <stribeck/workflow/reproduce/sections.hpp>

namespace stribeck::workflow::reproduction {

namespace {

using report::decimals;

}  // namespace

ReproducedSection section_c(const std::vector<Study>& all) {
  ReproducedSection out = section("ident-C", "Velocity–friction map with Gaussians",
                                  "§2.4.3, Table 2.3, fig 2.20", "", *all.front().machine);
  const std::string table = "Table 2.3";
  out.table = {
      "",
      {{"branch", "", false}, {"velocity", "mm/s"}, {"Table 2.3", "N"}, {"Stribeck", "N"}, {"95 %", "N"}},
      {}};
  for (const Study& s : all) {
    const std::string& axis = s.name();
    const ident::Result& r = *s.c;
    const friction::SteadyVariant print = printed_map(axis);
    const auto* map = std::get_if<friction::Gaussian<double>>(&r.friction.steady);
    for (const double direction : {1.0, -1.0}) {
      const std::string of = axis + (direction > 0.0 ? ", v ≥ 0" : ", v < 0");
      for (const double v : {1.0, 5.0, 9.0}) {
        const double at = direction * v * kMilli;
        add(out, fmt::format("friction at {:g} mm/s", direction * v), of, "N", force_of(print, at),
            curve_at(r, at), table, 0);
      }
      const Deviation d = deviation(r, axis, direction);
      add(out, "largest deviation from the printed curve", of, "N", kNaN, {d.force, {}}, table, 1);
      add(out, "the same, of the printed curve", of, "%", kNaN, {d.percent, {}}, table, 2);
      const std::size_t terms = map == nullptr    ? 0
                                : direction > 0.0 ? map->positive.gaussians.size()
                                                  : map->negative.gaussians.size();
      add(out, "number of Gaussians", of, "", kPrintedGaussians, {static_cast<double>(terms), {}}, table, 0);
      if (r.peaks) {
        add(out, "the same, by the peaks of the map", of, "", kPrintedGaussians,
            {static_cast<double>((*r.peaks)[direction > 0.0 ? 0 : 1]), {}}, table, 0);
      }
      for (const double v : {0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 9.5}) {
        const double at = direction * v * kMilli;
        const Estimate e = curve_at(r, at);
        out.table.rows.push_back({{of},
                                  {decimals(direction * v, 1)},
                                  {decimals(force_of(print, at), 1)},
                                  {decimals(e.value, 1)},
                                  {decimals(e.interval.low, 1) + " … " + decimals(e.interval.high, 1)}});
      }
    }
    report::FrictionMap drawing;
    drawing.axis = axis;
    drawing.fit = &r;
    drawing.truth = print;
    drawing.truth_label = table;
    out.plots.emplace_back(report::friction_plots(drawing),
                           "Left: velocity–friction map of eight periods and the pulses, with the fit (fig "
                           "2.20). Right: the same as difference from the fit.");
  }
  out.remarks = {
      "Curves are compared, not parameters: overlapping Gaussians can replace each other and η0 and η1, so that very different sets give the same curve.",
      "The number of Gaussians is the smallest within one standard error of the best on held-out periods. "
      "The thesis counts peaks of the smoothed map, its border included.",
      "Deviations are the largest over 0.5 to 9.5 mm/s. The sine just reaches 9.5 mm/s, so that its border "
      "is the least certain; what is drawn beyond it comes from a few rows of the pulses."};
  return out;
}

}  // namespace stribeck::workflow::reproduction
