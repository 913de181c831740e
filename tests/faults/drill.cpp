#include "drill.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <stribeck/io/toml.hpp>

#include "drill_run.hpp"

namespace stribeck::test {

double Drilled::worst(double begin, double end) const {
  double most = 0.0;
  for (const Tick& t : ticks) {
    if (t.time >= begin && t.time < end) most = std::max(most, t.error);
  }
  return most;
}

double Drilled::moved(std::size_t axis, double since, double until) const {
  double from = NAN;
  double most = 0.0;
  for (const Tick& t : ticks) {
    if (t.time < since || t.time > until) continue;
    if (std::isnan(from)) from = t.position[axis];
    most = std::max(most, std::abs(t.position[axis] - from));
  }
  return most;
}

double Drilled::speed(double time) const {
  for (std::size_t k = 1; k < ticks.size(); ++k) {
    if (ticks[k].time < time) continue;
    double most = 0.0;
    for (std::size_t i = 0; i < control::kMostAxes; ++i)
      most = std::max(most, std::abs(ticks[k].position[i] - ticks[k - 1].position[i]) / period);
    return most;
  }
  return 0.0;
}

std::size_t Drilled::limited(double begin, double end) const {
  std::size_t n = 0;
  for (const Tick& t : ticks) n += t.time >= begin && t.time < end && t.limited ? 1 : 0;
  return n;
}

bool Drilled::forces_good() const {
  for (const Tick& t : ticks) {
    for (std::size_t i = 0; i < control::kMostAxes; ++i) {
      if (!(std::abs(t.force[i]) <= limit[i])) return false;
    }
  }
  return true;
}

double Drilled::safe_after(double since) const {
  if (tripped < 0.0) return std::numeric_limits<double>::infinity();
  double last = since;
  for (const Tick& t : ticks) {
    for (std::size_t i = 0; i < control::kMostAxes; ++i) {
      if (t.force[i] != ticks.back().force[i]) last = t.time + period;
    }
  }
  return std::max(last - since, 0.0);
}

sim::Machine machine_of(const std::string& name) {
  return io::read_toml<sim::Machine>(std::string(STRIBECK_SOURCE_DIR) + "/machines/" + name + ".toml");
}

std::vector<Drill> drills_of(const std::string& experiment) {
  static const std::vector<sim::Experiment> kAll = sim::experiments();
  const sim::Experiment* e = sim::find_experiment(kAll, experiment);
  if (e == nullptr) throw std::invalid_argument("no experiment " + experiment);
  std::vector<Drill> all;
  for (const sim::ControllerSpec& c : e->settings.front().spec.controllers) {
    Drill d;
    d.machine = e->settings.front().machine;
    d.controller = c;
    d.travel = e->settings.front().spec.travels.back();
    d.axes = e->settings.front().spec.axes;
    all.push_back(d);
  }
  return all;
}

std::vector<Drill> all_drills() {
  std::vector<Drill> all;
  for (const char* id : {"beyond-bi-table", "beyond-tri-circle", "beyond-smc-circle", "five-axis"}) {
    for (Drill& d : drills_of(id)) all.push_back(std::move(d));
  }
  const auto like = [](const char* id, control::LawParams law) {
    Drill d = drills_of("beyond-bi-table").back();
    for (const Drill& g : drills_of("beyond-bi-table")) {
      if (g.controller.id == "g") d = g;
    }
    d.controller.id = id;
    d.controller.label = "with dynamic friction and observer";
    d.controller.law = std::move(law);
    return d;
  };
  all.push_back(like("pid", control::PidParams::triple(30.0)));
  all.push_back(like("cascade", control::CascadeParams{}));
  all.push_back(like("zpetc", control::ZpetcParams{}));
  all.push_back(like("cross-coupled", control::CrossCoupledParams{}));
  all.push_back(like("repetitive", control::RepetitiveParams{}));
  all.push_back(like("learning", control::LearningParams{}));
  return all;
}

std::string name_of(const Drill& d) { return d.machine + " (" + d.controller.id + ") " + d.controller.label; }

Drilled run(const Drill& d) {
  switch (d.travel.axes()) {
    case 1:
      return run_axes<1>(d);
    case 2:
      return run_axes<2>(d);
    case 3:
      return run_axes<3>(d);
    default:
      return run_axes<5>(d);
  }
}

sim::LoopMargins margins(const Drill& d) {
  switch (d.travel.axes()) {
    case 1:
      return margins_of<1>(d);
    case 2:
      return margins_of<2>(d);
    case 3:
      return margins_of<3>(d);
    default:
      return margins_of<5>(d);
  }
}

}  // namespace stribeck::test
