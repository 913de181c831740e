#include <stribeck/report/plot/force_plot.hpp>
#include <stribeck/report/plot/time_axis.hpp>
#include <utility>

namespace stribeck::report {

Plot force_plot(const ForceOverTime& force, std::string title, const std::string& unit,
                const std::string& color) {
  Plot p;
  p.title = std::move(title);
  const TimeAxis time = time_axis(force.t);
  p.x_label = time.label;
  p.y_label = "force [" + unit + "]";
  p.width = 920;
  p.height = 270;
  Series measured, modelled, left;
  measured.label = "measured", measured.color = std::string(kMeasuredColor), measured.width = 3.0;
  modelled.label = "modelled", modelled.color = color, modelled.width = 1.2;
  left.label = "measured less modelled", left.color = "#e69f00", left.width = 1.0;
  for (const double t : force.t) measured.x.push_back(t - time.origin);
  modelled.x = left.x = measured.x;
  measured.y = force.measured;
  modelled.y = force.modelled;
  for (std::size_t k = 0; k < force.t.size(); ++k) left.y.push_back(force.measured[k] - force.modelled[k]);
  p.series = {std::move(measured), std::move(modelled), std::move(left)};
  return p;
}

}  // namespace stribeck::report
