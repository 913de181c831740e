#include <stribeck/workflow/reproduce/drawing.hpp>

namespace stribeck::workflow::reproduction {

ReproducedSection section(std::string id, std::string title, std::string source, std::string setting,
                          const sim::Machine& machine) {
  ReproducedSection s;
  s.id = std::move(id);
  s.title = std::move(title);
  s.source = std::move(source);
  s.setting = std::move(setting);
  s.machine = machine.name;
  return s;
}

void add(ReproducedSection& s, std::string what, std::string of, std::string unit, double print,
         const Estimate& ours, std::string source, int digits) {
  s.figures.push_back({std::move(what), std::move(of), "", std::move(unit), print, ours.value,
                       ours.interval.low, ours.interval.high, std::move(source), digits});
}

Plot plot(std::string title, std::string x_label, std::string y_label) {
  Plot p;
  p.title = std::move(title);
  p.x_label = std::move(x_label);
  p.y_label = std::move(y_label);
  p.width = 560;
  p.height = 340;
  return p;
}

Series points(std::string label, const char* color, double size) {
  Series s;
  s.label = std::move(label);
  s.style = Style::kPoints;
  s.color = color;
  s.width = size;
  return s;
}

Series curve(std::string label, const char* color, bool dashed) {
  Series s;
  s.label = std::move(label);
  s.color = color;
  s.dashed = dashed;
  return s;
}

}  // namespace stribeck::workflow::reproduction
