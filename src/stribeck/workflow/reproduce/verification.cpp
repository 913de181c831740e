#include <fmt/format.h>
#include <algorithm>
#include <array>

#include <stribeck/report/text.hpp>
#include <stribeck/workflow/reproduce/sections.hpp>

namespace stribeck::workflow::reproduction {

namespace {

using report::decimals;

}  // namespace

ReproducedSection section_verify(const Study& s) {
  const std::string& axis = s.name();
  ReproducedSection out =
      section("verify", "Models driven open loop with the measured force of an unseen run",
              s.biaxial ? "§2.6, fig 2.30" : "§2.6, fig 2.31",
              fmt::format("{}, axis {}", s.machine->name, axis), *s.machine);
  const std::string figure = s.biaxial ? "fig 2.30" : "fig 2.31";
  out.table = {"",
               {{"model", "", false},
                {"from the first row on", "mm/s RMS"},
                {"", "%"},
                {"anew at each reversal", "mm/s RMS"},
                {"", "%"}},
               {}};
  Plot velocity =
      plot(fmt::format("Axis {}: velocity under the measured force", axis), "time [s]", "velocity [mm/s]");
  Plot error = plot(fmt::format("Axis {}: error of the predicted velocity", axis), "time [s]",
                    "predicted − measured [mm/s]");
  const std::vector<double>& measured = s.replayed.front().open.measured_velocity;
  const auto column = [&](std::string label, const char* color, const std::vector<double>& v, bool less) {
    Series c = curve(std::move(label), color, false);
    for (std::size_t k = 0; k < v.size(); ++k) {
      c.x.push_back(s.unseen.t[k]);
      c.y.push_back((v[k] - (less ? measured[k] : 0.0)) / kMilli);
    }
    return c;
  };
  velocity.series.push_back(column("measured", "#9aa0a6", measured, false));
  velocity.series.back().width = 4.0;
  constexpr std::array kColors{kOtherColor, "#009e73", kOursColor};
  std::size_t color = 0;
  for (const Replayed& m : s.replayed) {
    const ident::replay::Replay& free = m.open.free;
    const ident::replay::Replay& anew = m.open.restarted;
    if (m.of_thesis) {
      add(out, "velocity error, RMS", m.name, "mm/s", kNaN, {free.velocity_rms / kMilli, {}}, figure, 3);
      add(out, "the same, of the measured velocity", m.name, "%", kNaN, {100.0 * free.velocity_relative, {}},
          figure, 1);
      velocity.series.push_back(column(m.name, kColors[color], free.v, false));
      error.series.push_back(column(m.name, kColors[color], free.v, true));
      color = std::min(color + 1, kColors.size() - 1);
    }
    out.table.rows.push_back({{m.name},
                              {decimals(free.velocity_rms / kMilli, 3)},
                              {decimals(100.0 * free.velocity_relative, 1)},
                              {decimals(anew.velocity_rms / kMilli, 3)},
                              {decimals(100.0 * anew.velocity_relative, 1)}});
  }
  out.plots.push_back(
      {{std::move(velocity), std::move(error)},
       fmt::format("Measured and predicted velocity over time, and the error ({}).", figure)});
  out.remarks = {
      s.biaxial
          ? "The run is r = 10 cos 0.85 t mm of §3.1.4, with different noise; the thesis does not say which run it used."
          : "The run is the y reference of (4.6), 10 sin(4πt/15) mm, with different noise; the thesis does not say which run it used.",
      "The figures are lost and have no numbers. \"The machine itself\" is driven with the "
      "plant's own parameters: its error is noise of the force, which no model can predict. "
      "Friction without bristles may stay stuck after a reversal for longer than the machine, "
      "when its level is a little high; \"whole, with bristles\" is the one fit of everything "
      "that the compensators of the other experiments get."};
  if (s.biaxial) {
    out.remarks.emplace_back(
        "The viscous correction makes Model A worse here: it is the slope of a straight line up to 10 "
        "mm/s, where the friction of Table 2.3 turns upwards.");
  }
  return out;
}

}  // namespace stribeck::workflow::reproduction
