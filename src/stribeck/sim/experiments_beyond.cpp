#include <cmath>
#include <stribeck/sim/experiments_beyond.hpp>

namespace stribeck::sim {
namespace {

using control::ContouringParams;
using control::Observer;
using control::PerAxis;

constexpr double kMm = 1e-3;
constexpr double kDegree = kPi / 180.0;

ControllerSpec with(std::string id, std::string label, control::LawParams law, FrictionUse friction,
                    Observer observer, double pole = 20.0) {
  ControllerSpec c;
  c.id = std::move(id);
  c.label = std::move(label);
  c.friction = friction;
  c.observer = observer;
  c.law = std::move(law);
  c.observer_pole = pole;
  return c;
}

/// Gains of the feedback across the path [rad/s]; they limit the speed of an observer beside it.
double speed_of(const control::LawParams& law) {
  if (const auto* c = std::get_if<ContouringParams>(&law)) return std::sqrt(c->kp[c->kp.size() - 1]);
  if (const auto* s = std::get_if<control::SlidingModeParams>(&law)) return s->lambda[s->lambda.size() - 1];
  return 40.0;
}

}  // namespace

std::vector<ControllerSpec> beyond_controllers(const ControllerSpec& thesis) {
  ControllerSpec g = thesis;
  g.id = "g";
  g.label = "dynamic friction, observer";
  g.friction = FrictionUse::kWhole;
  g.feedforward = control::Feedforward::kDynamic;
  g.observer = Observer::kDisturbance;
  ControllerSpec i = g;
  i.id = "i";
  i.label = "dynamic friction, Kalman";
  i.observer = Observer::kKalman;
  i.observer_pole = 1.5 * speed_of(thesis.law);
  std::visit(
      [](auto& law) {
        if constexpr (requires { law.error_rate; }) law.error_rate = control::ErrorRate::kObserved;
      },
      i.law);
  ControllerSpec h = i;
  h.id = "h";
  h.label = "dynamic friction, adapting";
  h.adaptation.enabled = true;
  ControllerSpec j = g;
  j.id = "j";
  j.label = "reversal logic, observer";
  j.feedforward = control::Feedforward::kReversal;
  std::vector<ControllerSpec> all{g, h, i, j};
  if (std::holds_alternative<ContouringParams>(thesis.law)) {
    ControllerSpec k = g;
    k.id = "k";
    k.label = "predictive, dynamic friction";
    control::PredictiveParams law;
    law.omega = speed_of(thesis.law);
    k.law = law;
    all.push_back(k);
  }
  if (const auto* sliding = std::get_if<control::SlidingModeParams>(&thesis.law)) {
    // Super-twisting contains an integrator.
    ControllerSpec m = g;
    m.observer = Observer::kNone;
    m.id = "m";
    m.label = "adaptive sliding mode, dynamic";
    control::SlidingModeParams law = *sliding;
    law.gain = control::SwitchingGain::kAdaptive;
    law.switching = control::Switching::kSuperTwisting;
    law.layer = 1.0;
    law.mass_bound = {};
    m.law = law;
    all.push_back(m);
  }
  return all;
}

namespace {

ControllerSpec learning_controller(const ControllerSpec& thesis) {
  // Together with (i), which leaves the smallest error to learn.
  ControllerSpec l = beyond_controllers(thesis)[2];
  l.id = "l";
  l.label = "learning over (i)";
  control::LearningParams law;
  law.error_rate = control::ErrorRate::kObserved;
  if (const auto* c = std::get_if<ContouringParams>(&thesis.law)) {
    law.kp = c->kp;
    law.kv = c->kv;
  }
  l.law = law;
  return l;
}

}  // namespace

Experiment passes(const Experiment& thesis) {
  Experiment e{
      "beyond-passes", "Beyond the thesis: the sixth pass of the same circle", "§5.2 (future work)", {}, {}};
  Setting s = thesis.settings.front();
  s.name.clear();
  s.claims.clear();
  const ControllerSpec f = s.spec.controllers.back();
  for (Travel& t : s.spec.travels) {
    t.settle_laps = 5.0;
    t.laps = 1.0;
  }
  s.spec.controllers = {f};
  for (const ControllerSpec& c : beyond_controllers(f)) {
    if (c.id == "g" || c.id == "i") s.spec.controllers.push_back(c);
  }
  ControllerSpec over_f = learning_controller(f);
  over_f.id = "l-f";
  over_f.label = "learning over (f)";
  over_f.friction = f.friction;
  over_f.feedforward = f.feedforward;
  over_f.observer = f.observer;
  over_f.observer_pole = f.observer_pole;
  std::get<control::LearningParams>(over_f.law).error_rate = control::ErrorRate::kDifferenceOfError;
  s.spec.controllers.push_back(over_f);
  s.spec.controllers.push_back(learning_controller(f));
  e.settings = {s};
  e.remarks = {"Five laps for learning, then one lap that is evaluated.", "Nothing of this was printed."};
  return e;
}

Experiment beyond(const Experiment& thesis) {
  Experiment e{"beyond-" + thesis.id, "Beyond the thesis: " + thesis.title, "§5.2 (future work)", {}, {}};
  for (const Setting& s : thesis.settings) {
    if (s.parameters != ParameterSource::kIdentified) continue;
    Setting more = s;
    more.claims.clear();
    for (ControllerSpec& c : beyond_controllers(s.spec.controllers.back()))
      more.spec.controllers.push_back(std::move(c));
    e.settings.push_back(std::move(more));
  }
  e.remarks = {
      "(g) and the following have the law and the gains of the last controller of the thesis; they differ in feed-forward and observer.",
      "Nothing of this was printed."};
  return e;
}

Experiment five_axis() {
  path::ConeFrustum cone;
  cone.table = {100.0 * kMm, {{0.0, 0.0, 50.0 * kMm}}};
  cone.radius = 20.0 * kMm;
  cone.inclination = 30.0 * kDegree;
  cone.half_angle = 15.0 * kDegree;
  Travel t;
  t.path = cone;
  t.name = "cone frustum, radius 20 mm, half angle 15°, inclined by 30°";
  t.pace = path::Pace::kRate;
  // The tool tip moves at 10 mm/s over the workpiece.
  t.speed = 10.0 * kMm / cone.radius;
  t.laps = 2.0;

  const ContouringParams law = ContouringParams::critical(40.0, 60.0);
  // The double pole across the path for every axis, and an integrator a tenth as fast.
  control::PidParams pid;
  pid.kp = PerAxis{3600.0};
  pid.kv = PerAxis{120.0};
  pid.ki = PerAxis{21600.0};
  Setting s;
  s.machine = "five-axis-mill";
  s.spec.travels = {t};
  s.spec.controllers = {
      with("a", "contouring, no friction compensation", law, FrictionUse::kNone, Observer::kNone),
      with("b", "contouring, eccentric friction model", law, FrictionUse::kEccentric, Observer::kNone),
      with("c", "contouring, observer + eccentric model", law, FrictionUse::kEccentric,
           Observer::kDisturbance),
      with("d", "PID on every axis, no friction model", pid, FrictionUse::kNone, Observer::kNone),
      with("e", "PID on every axis, eccentric friction model", pid, FrictionUse::kEccentric,
           Observer::kNone)};
  Experiment e{
      "five-axis", "Five axes: flank milling of a cone frustum", "§5.2 (future work)", {std::move(s)}, {}};
  e.remarks = {
      "The contour error is the distance of the tool tip from its path in the workpiece; the orientation "
      "error is the angle between the tool axis and the one wanted at the nearest point of the path.",
      "The contouring law works in the space of the five axes, where a rotary axis counts as its travel at "
      "a radius of 100 mm.",
      "Nothing of this was printed: machine, path and gains are Stribeck's."};
  return e;
}

Experiment milling() {
  Travel t = along(path::Shape::kCircle, 10.0 * kMm, 10.0 * kMm, 2.0);
  CuttingForce f;
  f.spindle_speed = 1500.0 / 60.0;
  f.teeth = 4;
  f.along = 40.0;
  f.across = 20.0;
  f.entry = 0.5 * t.run_in;
  f.exit = t.law().duration() - 0.5 * t.run_in;
  t.cutting = f;
  t.name = "circle of 10 mm, milling force of 40 N against the feed and 20 N across";

  const ContouringParams law = ContouringParams::critical(60.0, 60.0);
  Setting s;
  s.machine = "triaxial-tool";
  s.spec.travels = {t};
  s.spec.controllers = {
      with("a", "no friction compensation", law, FrictionUse::kNone, Observer::kNone),
      with("b", "eccentric friction model", law, FrictionUse::kEccentric, Observer::kNone),
      with("c", "observer 20 1/s + eccentric model", law, FrictionUse::kEccentric, Observer::kDisturbance),
      with("d", "observer 60 1/s + eccentric model", law, FrictionUse::kEccentric, Observer::kDisturbance,
           60.0)};
  Experiment e{"milling", "Two axes under a cutting force", "§5.2 (future work)", {std::move(s)}, {}};
  e.remarks = {
      "1500 turns a minute, four teeth: ripples at 25, 100 and 200 Hz. The control period is 1 ms, the "
      "force its mean over it.",
      "At 6000 turns a minute the second tooth-passing harmonic lies above half the sampling rate, and the "
      "first moves the axis by some nanometres, less than the encoder of 100 nm can resolve.",
      "Nothing of this was printed: force and gains are Stribeck's."};
  return e;
}

}  // namespace stribeck::sim
