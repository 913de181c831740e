#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include <stribeck/ident/drive/drive_fit.hpp>
#include <stribeck/ident/methods/jog.hpp>
#include <stribeck/ident/methods/least_squares_a.hpp>
#include <stribeck/ident/methods/position_map.hpp>
#include <stribeck/ident/methods/velocity_map.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/replay/replay.hpp>
#include <stribeck/ident/stats/uncertainty.hpp>
#include <stribeck/report/parameters.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/sim/parallel.hpp>
#include <stribeck/workflow/commission.hpp>
#include <stribeck/workflow/reproduce/identification.hpp>

namespace stribeck::workflow {
namespace {

using ident::Interval;
using report::decimals;
using report::Plot;
using report::ReproducedFigure;
using report::ReproducedSection;
using report::Series;
using report::Style;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kMilli = 1e-3;  ///< mm, mm/s
constexpr double kKilo = 1e3;    ///< N s/mm, N s2/mm

constexpr const char* kPointColor = "#b4bac0";
constexpr const char* kOursColor = "#0072b2";
constexpr const char* kOtherColor = "#e69f00";
constexpr const char* kPrintColor = "#000000";

// ---- what was printed -----------------------------------------------------------------------------------

/// A row of a table of the thesis, in its units (N, mm, rad). Never an input of an identification.
struct Printed {
  std::string_view table;
  std::string_view of;  ///< axis; with + or − one direction
  std::array<double, 11> value;
};

constexpr std::array kPrinted{
    // m [N s2/mm, printed as "Kg"], α0, α1, α2; v0 = δ = 0: no Stribeck part
    Printed{"2.1", "x", {57.65, 1255.38, 1255.38, 105.54}},
    Printed{"2.1", "y", {58.93, 1066.05, 1066.05, 138.86}},
    Printed{"2.2", "x", {56.61, 1352.63, 1185.45, 113.54}},
    Printed{"2.2", "y", {59.03, 1162.05, 1066.23, 111.86}},
    // η0, η1, then a, b, c of three Gaussians
    Printed{"2.3", "x+", {768.6, 102.48, 517.4, 1.763, 3.091, 509.3, 5.806, 1.825, 1995.9, 10.668, 1.876}},
    Printed{
        "2.3", "x-", {-768.6, 102.48, -378.2, -2.163, 2.265, -547.5, -5.912, 1.761, -4472.0, -13.99, 3.659}},
    Printed{"2.3", "y+", {640.5, 140.91, 518.0, 1.766, 1.986, 852.0, 5.872, 2.733, 1059.1, 10.27, 1.744}},
    Printed{
        "2.3", "y-", {-640.5, 140.91, -371.34, -1.963, 2.997, -236.1, -5.804, 1.223, -354.97, -9.311, 0.475}},
    // α0, α1, α2, v0, δ
    Printed{"4.2", "x", {20.0, 35.0, 5.0, 0.6, 2.0}},
    Printed{"4.2", "y", {15.0, 30.0, 3.0, 0.9, 2.0}},
    Printed{"4.2", "z", {25.0, 40.0, 5.0, 0.4, 2.0}},
    // η0, η1, η2, η3; Table 2.4 prints the same
    Printed{"4.3", "x", {18.0, 4.5, 4.2, 0.28}},
    Printed{"4.3", "y", {15.0, 3.0, 11.2, -0.27}},
    Printed{"4.3", "z", {24.0, 4.0, 2.5, 0.31}},
    // m [N s2/mm], g [N]
    Printed{"4.4", "x", {1.0, 0.0}},
    Printed{"4.4", "y", {0.8, 0.0}},
    Printed{"4.4", "z", {0.8, 10.0}},
};

constexpr int kPrintedGaussians = 3;

double printed(std::string_view table, std::string_view of, std::size_t column) {
  for (const Printed& p : kPrinted) {
    if (p.table == table && p.of == of) return p.value[column];
  }
  return kNaN;
}

/// Table 2.3 as a map.
friction::Gaussian<double> printed_map(const std::string& axis) {
  const auto branch = [&](const char* direction) {
    const auto p = [&](std::size_t i) { return printed("2.3", axis + direction, i); };
    friction::GaussianBranch<double> b;
    b.eta0 = p(0);
    b.eta1 = p(1) * kKilo;
    for (std::size_t i = 2; i < 11; i += 3)
      b.gaussians.push_back({p(i), p(i + 1) * kMilli, p(i + 2) * kMilli});
    return b;
  };
  friction::Gaussian<double> map;
  map.velocity_range = {-9.5e-3, 9.5e-3};
  map.positive = branch("+");
  map.negative = branch("-");
  return map;
}

double force_of(const friction::SteadyVariant& map, double v) {
  return std::visit([v](const auto& m) { return friction::steady_force(m, v); }, map);
}

// ---- logs and models of one axis ------------------------------------------------------------------------

/// Runs have noise of their own: a model must not know that of the run it is judged on.
enum Run : std::uint64_t { kPulses, kFewJogs, kJogs, kSine, kUnseen };
constexpr std::uint64_t kBetweenRuns = 1000003;

struct Wanted {
  bool a = false, b = false, c = false, d = false, verify = false;
};

/// Model A from the pulses of one height.
struct Scale {
  double k_u = 0.0;
  ident::methods::LeastSquaresA found;
};

struct Replayed {
  std::string name;
  bool of_thesis = false;  ///< drawn, and among the figures
  ident::replay::OpenLoop open;
};

struct Study {
  const sim::Machine* machine = nullptr;
  std::size_t axis = 0;
  bool biaxial = false;
  std::uint64_t seed = 1;
  Wanted wanted;

  std::optional<ident::methods::LeastSquaresA> pulses;  ///< Model A before the viscous correction
  std::optional<ident::methods::LeastSquaresA> a;
  std::vector<Scale> scales;
  std::optional<ident::methods::Jog> b;
  std::optional<ident::Result> c;
  std::optional<ident::Result> d;
  std::optional<ident::Result>
      whole;  ///< what commission_axis would take: mass, friction, periodic terms and bristles in one fit
  ident::log::Record unseen;
  std::vector<Replayed> replayed;

  [[nodiscard]] const std::string& name() const { return machine->axes[axis].first; }
  [[nodiscard]] const sim::MachineAxis& truth() const { return machine->axes[axis].second; }
};

ident::log::Record log_of(const Study& s, const ident::excitation::Excitation& e, Run run) {
  return as_record(play(*s.machine, s.axis, e.r, e.force, s.seed + run * kBetweenRuns),
                   s.name() + "-" + e.method);
}

ident::excitation::Limits limits_of(const Study& s) {
  const sim::AxisLimits& l = s.truth().limits;
  return {l.travel_min, l.travel_max, l.speed, l.acceleration, s.truth().force_limit()};
}

ident::log::Record jog(const Study& s, std::vector<double> speeds, Run run) {
  ident::excitation::JogDesign design;
  design.speeds = std::move(speeds);
  return log_of(s, ident::excitation::design_jog(limits_of(s), s.machine->sample_time, design), run);
}

/// Each pair of pulses by itself; those that do not move the axis are left out (fig 2.11).
std::vector<Scale> by_scale(const ident::log::Record& log, const std::vector<double>& force) {
  std::vector<std::size_t> starts;
  for (std::size_t k = 1; k < force.size(); ++k) {
    if (force[k] > 0.0 && force[k - 1] <= 0.0) starts.push_back(k - 1);
  }
  starts.push_back(log.x.size());
  const std::vector<double> k_u = ident::excitation::PulseDesign().scales;
  std::vector<Scale> scales;
  for (std::size_t i = 0; i + 1 < starts.size() && i < k_u.size(); ++i) {
    ident::log::Record part = log;
    for (auto* column : {&part.t, &part.x, &part.f}) {
      const auto begin = column->begin();
      *column = {begin + static_cast<std::ptrdiff_t>(starts[i]),
                 begin + static_cast<std::ptrdiff_t>(starts[i + 1])};
    }
    try {
      scales.push_back({k_u[i], ident::methods::identify_least_squares_a({part})});
    } catch (const ident::Refused&) {
      continue;
    }
  }
  return scales;
}

/// r = 10 cos 0.85 t mm (§3.1.4) for the biaxial table, y of (4.6) for the machine tool.
ident::excitation::Excitation unseen_motion(const Study& s) {
  const ident::excitation::SineDesign table{10e-3, 10e-3, 0.85, 3};
  ident::excitation::SineDesign tool{0.0, 10e-3, 4.0 * kPi / 15.0, 2};
  tool.from_middle = true;
  return ident::excitation::design_sine(limits_of(s), s.machine->sample_time, s.biaxial ? table : tool);
}

void replay(Study& s) {
  s.unseen = log_of(s, unseen_motion(s), kUnseen);
  const auto add = [&](const char* name, bool of_thesis, const friction::AxisModel& model) {
    s.replayed.push_back({name, of_thesis, ident::replay::replay_open_loop(model, s.unseen)});
  };
  add("Model A", true, as_model(s.a->result));
  add("Model B", true, as_model(s.b->result));
  if (s.c) add("Model C", true, as_model(*s.c));
  if (s.d) add("Model D", true, as_model(*s.d));
  add("Model A without the viscous correction", false, as_model(s.pulses->result));
  add("whole, with bristles", false, as_model(*s.whole));
  const plant::AxisParams& p = s.truth().plant;
  add("the machine itself", false, {p.mass, p.load, p.friction});
}

void study(Study& s) {
  const Wanted& w = s.wanted;
  ident::log::Record pulses;
  if (w.a || w.c || w.verify) {
    // A first run only tells how hard to push in the second.
    const ident::excitation::Excitation first = design(*s.machine, s.axis, "pulses", 0);
    const auto drive = ident::excitation::rough_drive(
        ident::methods::identify_least_squares_a({log_of(s, first, kPulses)}).result);
    const ident::excitation::Excitation second = design(*s.machine, s.axis, "pulses", 0, drive);
    pulses = log_of(s, second, kPulses);
    if (w.a) s.scales = by_scale(pulses, second.force);
  }
  if (w.a || w.verify) {
    s.pulses = ident::methods::identify_least_squares_a({pulses});
    // Speeds of §2.3.2.
    const std::vector<double> speeds{0.1e-3, 0.2e-3, 0.3e-3, 0.5e-3, 1e-3, 2e-3, 4e-3, 6e-3, 8e-3, 10e-3};
    s.a = ident::methods::identify_least_squares_a({pulses}, {jog(s, speeds, kFewJogs)});
  }
  const ident::log::Record sine =
      w.b || w.c || w.d || w.verify ? log_of(s,
                                             design(*s.machine, s.axis, s.biaxial ? "sine" : "position-sine",
                                                    s.biaxial ? kSinePeriods : kPositionPeriods),
                                             kSine)
                                    : ident::log::Record{};
  if (w.b || w.verify) {
    ident::methods::JogOptions conventional;
    conventional.gaussians = false;
    const double fastest = s.biaxial ? 9e-3 : 15e-3;  // §2.3.3, §4.4.1
    s.b = ident::methods::identify_jog({jog(s, ident::excitation::jog_speeds(fastest), kJogs), sine},
                                       conventional);
  }
  if (s.biaxial && (w.c || w.verify)) {
    ident::methods::VelocityMapOptions options;
    options.curve_points = 96;  // drawn with straight lines between them
    s.c = ident::methods::identify_velocity_map({pulses, sine}, options);
  }
  if (!s.biaxial && (w.d || w.verify)) s.d = ident::methods::identify_position_map({sine});
  if (w.verify) {
    s.whole = ident::drive::identify_drive({pulses, sine});
    replay(s);
  }
}

// ---- numbers --------------------------------------------------------------------------------------------

/// f = α0±·sgn v + α2·v with one slope for both directions, the printed form of Tables 2.1 and 2.2.
/// Intervals of the scatter about it.
struct Line {
  std::array<double, 2> level{kNaN, kNaN};  ///< v > 0, v < 0, both positive [N]
  double slope = kNaN;                      ///< [N·s/m]
  std::array<double, 2> level_half{kNaN, kNaN};
  double slope_half = kNaN;
};

struct SpeedAndForce {
  double speed = 0.0;
  double force = 0.0;
};

Line line_through(const std::vector<SpeedAndForce>& points) {
  std::array<double, 2> n{}, v{}, f{};
  const auto side = [](const SpeedAndForce& p) { return p.speed > 0.0 ? 0U : 1U; };
  for (const SpeedAndForce& p : points) {
    n[side(p)] += 1.0;
    v[side(p)] += p.speed;
    f[side(p)] += p.force;
  }
  double vv = 0.0, vf = 0.0, left = 0.0;
  for (unsigned i : {0U, 1U}) {
    v[i] /= n[i];
    f[i] /= n[i];
  }
  for (const SpeedAndForce& p : points) {
    vv += (p.speed - v[side(p)]) * (p.speed - v[side(p)]);
    vf += (p.speed - v[side(p)]) * (p.force - f[side(p)]);
  }
  Line line;
  line.slope = vf / vv;
  for (const SpeedAndForce& p : points) {
    const double e = p.force - f[side(p)] - line.slope * (p.speed - v[side(p)]);
    left += e * e;
  }
  const double freedom = static_cast<double>(points.size()) - 3.0;
  const double half = ident::stats::student_factor(freedom) * std::sqrt(left / freedom);
  line.slope_half = half / std::sqrt(vv);
  for (unsigned i : {0U, 1U}) {
    line.level[i] = (i == 0 ? 1.0 : -1.0) * (f[i] - line.slope * v[i]);
    line.level_half[i] = half * std::sqrt(1.0 / n[i] + v[i] * v[i] / vv);
  }
  return line;
}

std::vector<SpeedAndForce> means_of(const ident::methods::Jog& jog) {
  std::vector<SpeedAndForce> points;
  for (const ident::map::SteadyRun& r : jog.runs) points.push_back({r.speed, r.force});
  return points;
}

/// The same line through Table 2.3 at the same speeds: what Tables 2.1 and 2.2 would be if they described the
/// same friction.
Line line_through_print(std::vector<SpeedAndForce> points, const std::string& axis) {
  const friction::SteadyVariant map = printed_map(axis);
  for (SpeedAndForce& p : points) p.force = force_of(map, p.speed);
  return line_through(points);
}

struct Estimate {
  double value = kNaN;
  Interval interval;
};

Estimate estimate(const ident::Result& r, std::string_view name, double scale = 1.0) {
  for (const ident::Parameter& p : r.parameters) {
    if (p.name != name) continue;
    Estimate e{p.value * scale, {p.ci_low * scale, p.ci_high * scale}};
    if (scale < 0.0) std::swap(e.interval.low, e.interval.high);
    return e;
  }
  return {};
}

/// Mean of both directions; halves of the intervals do not shrink, as the errors may be common.
Estimate mean_of(const Estimate& a, const Estimate& b) {
  return {0.5 * (a.value + b.value),
          {0.5 * (a.interval.low + b.interval.low), 0.5 * (a.interval.high + b.interval.high)}};
}

Estimate plus_minus(double value, double half) { return {value, {value - half, value + half}}; }

/// Conventional parameters of a jog fit: of (2.9), or the means of both directions where it was fitted by
/// direction.
struct Conventional {
  Estimate alpha0, alpha1, alpha2, v0;
};

Conventional conventional_of(const ident::Result& r) {
  if (std::isfinite(estimate(r, "alpha0").value)) {
    return {estimate(r, "alpha0"), estimate(r, "alpha1"), estimate(r, "alpha2", 1.0 / kKilo),
            estimate(r, "v0", 1.0 / kMilli)};
  }
  Conventional c;
  c.alpha0 = mean_of(estimate(r, "eta0_positive"), estimate(r, "eta0_negative", -1.0));
  c.alpha2 = mean_of(estimate(r, "eta1_positive", 1.0 / kKilo), estimate(r, "eta1_negative", 1.0 / kKilo));
  c.v0 = mean_of(estimate(r, "gaussian_1_c_positive", 1.0 / kMilli),
                 estimate(r, "gaussian_1_c_negative", 1.0 / kMilli));
  const Estimate rise =
      mean_of(estimate(r, "gaussian_1_a_positive"), estimate(r, "gaussian_1_a_negative", -1.0));
  // The sum is known as the curve is at its slow end, better than either part.
  double half = kNaN;
  for (const ident::CurvePoint& p : r.curve) {
    if (p.velocity > 0.0) {
      half = 0.5 * (p.ci_high - p.ci_low);
      break;
    }
  }
  c.alpha1 = plus_minus(c.alpha0.value + rise.value, half);
  return c;
}

/// The curve and its interval at a velocity, straight between its points.
Estimate curve_at(const ident::Result& r, double v) {
  for (std::size_t i = 1; i < r.curve.size(); ++i) {
    const ident::CurvePoint& a = r.curve[i - 1];
    const ident::CurvePoint& b = r.curve[i];
    if (v < a.velocity || v > b.velocity || (a.velocity < 0.0) != (b.velocity < 0.0)) continue;
    const double share = (v - a.velocity) / (b.velocity - a.velocity);
    const auto between = [share](double x, double y) { return (1.0 - share) * x + share * y; };
    const double half = 0.5 * between(a.ci_high - a.ci_low, b.ci_high - b.ci_low);
    return plus_minus(force_of(r.friction.steady, v), half);
  }
  return {force_of(r.friction.steady, v), {}};
}

struct Deviation {
  double force = 0.0;    ///< [N]
  double percent = 0.0;  ///< of the printed curve
};

/// Largest over 0.5–9.5 mm/s of one direction.
Deviation deviation(const ident::Result& r, const std::string& axis, double direction) {
  const friction::SteadyVariant map = printed_map(axis);
  Deviation most;
  for (int i = 10; i <= 190; ++i) {
    const double v = direction * 0.05 * i * kMilli;
    const double print = force_of(map, v);
    const double d = std::abs(force_of(r.friction.steady, v) - print);
    most.force = std::max(most.force, d);
    most.percent = std::max(most.percent, 100.0 * d / std::abs(print));
  }
  return most;
}

// ---- sections -------------------------------------------------------------------------------------------

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

std::string chosen_name(const ident::Result& r) {
  for (const ident::Candidate& c : r.models) {
    if (c.chosen) return c.name;
  }
  return r.model;
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

/// A map from −top to top, with a gap at standstill.
template <class Force>
Series map_curve(std::string label, const char* color, bool dashed, double top, Force&& force) {
  constexpr int kEach = 150;
  Series s = curve(std::move(label), color, dashed);
  for (int i = -kEach; i <= kEach; ++i) {
    const double v = top * i / kEach;
    s.x.push_back(v / kMilli);
    s.y.push_back(i == 0 ? kNaN : force(v));
  }
  return s;
}

double two_levels(double v, double plus, double minus, double slope) {
  return (v > 0.0 ? plus : -minus) + slope * v;
}

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
    row(table, print(0), print(3), print(1), print(2));
    unbiased("unbiased, all pulses", p);
    if (!s.scales.empty())
      unbiased(fmt::format("unbiased, K_u = {:g} alone", s.scales.front().k_u), s.scales.front().found);
    if (s.scales.size() > 1)
      unbiased(fmt::format("unbiased, K_u = {:g} alone", s.scales.back().k_u), s.scales.back().found);
    row("simple, all pulses", p.simple_mass / kKilo, p.simple_alpha2 / kKilo, kNaN, kNaN);
    row("jogs, observer", kNaN, a.observer->alpha2 / kKilo, a.observer->alpha0_positive,
        -a.observer->alpha0_negative);
    row("jogs, Kalman", kNaN, a.kalman->alpha2 / kKilo, a.kalman->alpha0_positive,
        -a.kalman->alpha0_negative);
    std::vector<SpeedAndForce> fast;
    for (const ident::methods::ObservedFriction& j : a.jogs) {
      if (std::abs(j.speed) > 0.95e-3) fast.push_back({j.speed, j.observer});
    }
    const Line own = line_through_print(fast, axis);
    row("line through Table 2.3 at the jogs", kNaN, own.slope / kKilo, own.level[0], own.level[1]);
    row("the machine itself", s.truth().plant.mass / kKilo, kNaN, kNaN, kNaN);
    most_simple = std::max(most_simple, 100.0 * (p.simple_mass / p.mass_exact - 1.0));

    const double top = 10.3e-3;
    Plot map = plot(fmt::format("Axis {}: friction observed while jogging", axis), "velocity [mm/s]",
                    "friction [N]");
    map.series.push_back(map_curve("pulses", kOtherColor, false, top, [&](double v) {
      return two_levels(v, p.alpha0_positive, -p.alpha0_negative, p.alpha2);
    }));
    map.series.push_back(map_curve("corrected", kOursColor, false, top, [&](double v) {
      return two_levels(v, a.observer->alpha0_positive, -a.observer->alpha0_negative, a.observer->alpha2);
    }));
    map.series.push_back(map_curve(table, kPrintColor, true, top, [&](double v) {
      return two_levels(v, print(1), print(1), print(3) * kKilo);
    }));
    Series observed = points("observer", kPrintColor, 5.0);
    for (const ident::methods::ObservedFriction& j : a.jogs) {
      observed.x.push_back(j.speed / kMilli);
      observed.y.push_back(j.observer);
    }
    map.series.push_back(std::move(observed));
    std::vector<Plot> drawings = scale_plots(s);
    drawings.push_back(std::move(map));
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
      "Friction of this machine is no straight line: α0 and α2 depend on which speeds the rows have, and "
      "their intervals hold for the scatter, not for the choice of a line."};
  return out;
}

/// Means of the jogs, our fit and the printed curve.
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
      "The shape δ is 2 in the form that was chosen. The screw's sine is found in the jogs and taken off "
      "the means.");
  out.remarks.emplace_back(
      "The thesis takes the mass of this machine from constant acceleration, not from this method: here "
      "from a sine, by rows of equal speed, accelerating against braking, with the screw's sine partialled "
      "out. Left in, it counts as inertia and makes the mass 7 to 31 % too large.");
  out.plots.emplace_back(std::move(drawings),
                         "Mean friction at 29 speeds from 0.01 to 15 mm/s, both ways (fig 4.4).");
  return out;
}

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
      "Curves are compared, not parameters: Gaussians that overlap trade with each other and with η0 and "
      "η1, so that very different sets give the same curve.",
      "The number of Gaussians is the smallest within one standard error of the best on held-out periods. "
      "The thesis counts peaks of the smoothed map, its border included.",
      "Deviations are the largest over 0.5 to 9.5 mm/s. The sine just reaches 9.5 mm/s, so that its border "
      "is the least certain; what is drawn beyond it comes from a few rows of the pulses."};
  return out;
}

/// Model D along one period of the motion that it was identified on.
Series along_motion(const Study& s, bool eccentric) {
  constexpr int kPoints = 720;
  const sim::Commissioning& c = s.truth().commissioning;
  Series line = curve(eccentric ? "Model D along the motion" : "without the sine",
                      eccentric ? kOursColor : kOtherColor, false);
  line.width = eccentric ? 1.2 : 2.0;
  double before = 0.0;
  for (int i = 0; i <= kPoints; ++i) {
    const double phi = 2.0 * kPi * (i + 0.5) / kPoints;
    const double v = c.sine_amplitude * c.sine_frequency * std::cos(phi);
    const double x = c.sine_offset + c.sine_amplitude * std::sin(phi);
    if (v * before < 0.0) {
      line.x.push_back(0.0);
      line.y.push_back(kNaN);
    }
    before = v;
    const friction::SteadyParts<double> p =
        eccentric ? s.d->friction.parts(v, x)
                  : std::visit([v](const auto& m) { return m.parts(v, 0.0); }, s.d->friction.steady);
    line.x.push_back(v / kMilli);
    line.y.push_back((v > 0.0 ? p.level : -p.level) + p.viscous + p.additive);
  }
  return line;
}

std::vector<Plot> position_plots(const Study& s) {
  constexpr double kSlow = 2e-3;  // below it the Stribeck rise, which (2.37) does not have
  const std::string& axis = s.name();
  const double eta0 = estimate(*s.d, "eta0").value;
  const double eta1 = estimate(*s.d, "eta1").value;
  Plot position = plot(fmt::format("Axis {}: (2.39) over position", axis), "position [mm]",
                       "friction − η0 sgn v − η1 v [N]");
  Plot velocity =
      plot(fmt::format("Axis {}: friction over velocity", axis), "velocity [mm/s]", "friction [N]");
  Series rest = points("measured", kPointColor, 1.6);
  Series map = points("measured", kPointColor, 1.6);
  for (const ident::ResidualPoint& r : s.d->residuals) {
    const double sign = r.v > 0.0 ? 1.0 : -1.0;
    const friction::SteadyParts<double> p = s.d->friction.parts(r.v, r.x);
    const double f = sign * p.level + p.viscous + p.additive + r.error;
    map.x.push_back(r.v / kMilli);
    map.y.push_back(f);
    if (std::abs(r.v) < kSlow) continue;
    rest.x.push_back(r.x / kMilli);
    rest.y.push_back(f - eta0 * sign - eta1 * r.v);
  }
  Series fit = curve("fit", kOursColor, false);
  Series print = curve("Table 2.4", kPrintColor, true);
  const double top = s.truth().commissioning.sine_amplitude;
  for (int i = -400; i <= 400; ++i) {
    const double x = top * i / 400.0;
    friction::SteadyParts<double> p;
    for (const auto& term : s.d->friction.eccentric) {
      if (term.form == friction::EccentricForm::kAdditive) term.add_to(p, x);
    }
    fit.x.push_back(x / kMilli);
    fit.y.push_back(p.additive);
    print.x.push_back(x / kMilli);
    print.y.push_back(printed("4.3", axis, 2) * std::sin(2.0 * kPi * x / 2e-3 - printed("4.3", axis, 3)));
  }
  position.series = {std::move(rest), std::move(fit), std::move(print)};
  velocity.series = {std::move(map), along_motion(s, true), along_motion(s, false)};
  return {std::move(position), std::move(velocity)};
}

ReproducedSection section_d(const std::vector<Study>& all) {
  ReproducedSection out =
      section("ident-D", "Position–friction map with an eccentric term",
              "§2.5.3, §4.4.2, Tables 2.4 and 4.3, figs 2.28, 2.29 and 4.7", "", *all.front().machine);
  const std::string table = "Tables 2.4, 4.3";
  for (const Study& s : all) {
    const std::string& axis = s.name();
    const ident::Result& r = *s.d;
    const auto print = [&](std::size_t i) { return printed("4.3", axis, i); };
    add(out, "η0", axis, "N", print(0), estimate(r, "eta0"), table, 2);
    add(out, "η1", axis, "N s/mm", print(1), estimate(r, "eta1", 1.0 / kKilo), table, 3);
    add(out, "η2", axis, "N", print(2), estimate(r, "eccentric_1_amplitude"), table, 2);
    add(out, "η3", axis, "rad", print(3), estimate(r, "eccentric_1_phase"), table, 3);
    add(out, "period", axis, "mm", 2.0, estimate(r, "eccentric_1_period", 1.0 / kMilli), "§2.5.3, the lead",
        4);
    add(out, "mass", axis, "N s2/mm", printed("4.4", axis, 0), estimate(r, "mass", 1.0 / kKilo), "Table 4.4",
        3);
    add(out, "load", axis, "N", printed("4.4", axis, 1), estimate(r, "load"), "Table 4.4", 2);
    out.plots.emplace_back(
        position_plots(s),
        "Left: what Coulomb and viscous friction leave, over position, above 2 mm/s (fig 2.28). Right: "
        "friction over velocity, the model along the motion and without its sine (figs 2.29 and 4.7).");
  }
  out.remarks = {"The period is found, not given. The phase belongs to the homing of the log.",
                 "The model that held-out passes choose has a Stribeck rise, which (2.37) has not: without "
                 "it η0 and η1 would take up part of it.",
                 "Tables 2.4 and 4.3 print the same values, and the virtual machine has them: what is off "
                 "here is our error."};
  return out;
}

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
  out.remarks = {s.biaxial ? "The run is r = 10 cos 0.85 t mm of §3.1.4, with noise of its own; which one "
                             "the thesis took is not printed."
                           : "The run is the y reference of (4.6), 10 sin(4πt/15) mm, with noise of its "
                             "own; which one the thesis took is not printed.",
                 "The figures are lost and have no numbers. \"The machine itself\" is driven with the "
                 "plant's own parameters: what it leaves is noise of the force, which no model can know. "
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

bool has(const std::vector<std::string>& ids, std::string_view id) {
  return std::find(ids.begin(), ids.end(), id) != ids.end();
}

}  // namespace

std::vector<ReproducedSection> reproduce_identification(const std::vector<std::string>& ids,
                                                        const sim::Machine& v2, const sim::Machine& v3,
                                                        std::uint64_t seed, unsigned threads) {
  std::vector<Study> table;
  std::vector<Study> tool;
  for (const sim::Machine* machine : {&v2, &v3}) {
    for (std::size_t i = 0; i < machine->axes.size(); ++i) {
      Study s;
      s.machine = machine;
      s.axis = i;
      s.biaxial = machine == &v2;
      s.seed = seed;
      s.wanted.a = s.biaxial && has(ids, "ident-A");
      s.wanted.b = has(ids, "ident-B");
      s.wanted.c = s.biaxial && has(ids, "ident-C");
      s.wanted.d = !s.biaxial && has(ids, "ident-D");
      s.wanted.verify = has(ids, "verify") && s.name() == (s.biaxial ? "x" : "y");
      (s.biaxial ? table : tool).push_back(std::move(s));
    }
  }
  // The machine tool first: its axes take longest.
  std::vector<Study*> jobs;
  for (auto* studies : {&tool, &table}) {
    for (Study& s : *studies) jobs.push_back(&s);
  }
  sim::parallel_for(
      jobs.size(), threads, [] { return 0; }, [&](int&, std::size_t i) { study(*jobs[i]); });

  std::vector<ReproducedSection> sections;
  for (const std::string& id : ids) {
    if (id == "ident-A") sections.push_back(section_a(table));
    if (id == "ident-B") {
      sections.push_back(section_b_table(table));
      sections.push_back(section_b_tool(tool));
    }
    if (id == "ident-C") sections.push_back(section_c(table));
    if (id == "ident-D") sections.push_back(section_d(tool));
    if (id != "verify") continue;
    for (auto* studies : {&table, &tool}) {
      for (const Study& s : *studies) {
        if (s.wanted.verify) sections.push_back(section_verify(s));
      }
    }
  }
  return sections;
}

}  // namespace stribeck::workflow
