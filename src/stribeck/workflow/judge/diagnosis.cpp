#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include <stribeck/core/numbers.hpp>
#include <stribeck/core/scalar.hpp>
#include <stribeck/friction/unbalance.hpp>
#include <stribeck/ident/drive/load/lost_share.hpp>
#include <stribeck/ident/drive/smoothing/before_filter.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/residual/residual.hpp>
#include <stribeck/ident/shown.hpp>
#include <stribeck/workflow/judge/diagnosis.hpp>
#include <stribeck/workflow/judge/row_means.hpp>

namespace stribeck::workflow {
namespace {

constexpr int kPasses = 3;
constexpr double kBetter =
    0.95;  // largest ratio of residuals at which an uncertain force is removed from the logs
constexpr double kMuchBetter =
    0.75;  // the same for an elastic drive: any curvature of the force looks like a little of one
constexpr double kSure = 3.0;  // half widths of 95 %: noise may be much larger than the force

/// Methods whose result is a friction model over velocity, so that a residual can be taken.
bool has_residual(const Identification& found) {
  if (found.holding_only || found.result.curve.empty()) return false;
  switch (found.result.method) {
    case Method::kAuto:
    case Method::kVelocityMap:
    case Method::kJog:
    case Method::kLeastSquaresA:
    case Method::kIdimLs:
      return true;
    case Method::kPositionMap:
    case Method::kBreakAway:
    case Method::kGravity:
    case Method::kConstantAcceleration:
      break;
  }
  return false;
}

/// A published protocol keeps its numbers whatever the residual says.
bool may_run_again(Method method) {
  return method == Method::kAuto || method == Method::kVelocityMap || method == Method::kJog;
}

/// Takes a filter that the fit has found off the force of the logs too.
void take_off_filter(const ident::Result& found, AxisRecords& axis) {
  for (ident::log::Record& r : axis.records) {
    if (found.filter && !r.filter) ident::drive::take_off(*found.filter, r);
  }
}

/// The logs without the forces of the diagnosis; the shift between force and motion is that of `found`.
AxisRecords without(const AxisRecords& axis, const ident::residual::Diagnosis& d,
                    const ident::Result& found) {
  AxisRecords out = axis;
  for (ident::log::Record& r : out.records) {
    const double shift = ident::residual::shift_in_rows(found, r.sample_time);
    if (d.elastic) take_off(*d.elastic, shift, r);
    if (d.spring) r.spring = d.spring->stiffness;
    for (std::size_t k = 0; k < r.f.size(); ++k) {
      const double x = ident::residual::value_between(r.x, static_cast<double>(k) - shift);
      if (d.unbalance) r.f[k] -= d.unbalance->sine * std::sin(x) + d.unbalance->cosine * std::cos(x);
      if (d.spring) r.f[k] -= d.spring->stiffness * (x - d.spring->middle);
    }
  }
  return out;
}

/// An elastic drive that rings has another mass at that frequency: over the motion the difference looks like a spring.
std::string ringing(const ident::residual::Quality& q) {
  if (!q.strongest || q.strongest->moves < 0.5 * q.strongest->amplitude) return {};
  return fmt::format(
      "; the axis also vibrates at {:.3g} Hz: a drive that is elastic and rings looks the same, and then the mass is wrong by several percent too (damp the loop, or record with less acceleration, and compare the mass)",
      q.strongest->frequency);
}

void widen(std::string_view name, double half_width, ident::Result& r) {
  for (ident::Parameter& p : r.parameters) {
    if (p.name != name) continue;
    p.ci_low = std::min(p.ci_low, p.value - half_width);
    p.ci_high = std::max(p.ci_high, p.value + half_width);
  }
}

/// A mass that was fitted after a force was taken off knows nothing of the error of that force.
void widen_mass(double half_width, ident::Result& r) {
  if (!std::isfinite(r.mass) || !std::isfinite(half_width)) return;
  r.mass_interval.low = std::min(r.mass_interval.low, r.mass - half_width);
  r.mass_interval.high = std::max(r.mass_interval.high, r.mass + half_width);
  widen("mass", half_width, r);
}

void write_spring(const ident::residual::Spring& s, const ident::residual::Quality& q, bool rotary,
                  ident::Result& r) {
  widen_mass(s.mass_half_width, r);
  const std::string unit = "N/m", shown = "N/mm";  // result.hpp: N stands for the unit of the force
  r.parameters.push_back({"position_stiffness", s.stiffness, unit, shown, s.stiffness - s.half_width,
                          s.stiffness + s.half_width, true});
  // As far again on either side: a log of half of the travel serves the whole of it, and a short one no long axis.
  const double travel = s.to - s.from;
  r.friction.spring = friction::Spring{s.stiffness, s.middle, s.from - travel, s.to + travel};
  const ident::Shown people(r.position_unit, r.force_unit, rotary);
  r.warnings.push_back(fmt::format(
      "a force grows with position by {} (95 %: ±{}): a spring, a cable chain or a balance{}; it was taken off the log, the fit was made again, and it is part of the model as friction.spring; load and friction are those at {}, the middle of the logged motion; from {} to {} it is taken to go on, as far again on either side as was measured, and to stay beyond{}",
      people.force_per_length(s.stiffness), people.force_per_length(s.half_width),
      s.may_be_weight
          ? ", or a weight that hangs, which this angle is too small to tell (the interval of the mass holds "
            "both; move over a larger angle)"
          : "",
      people.length(s.middle), people.length(s.from - travel), people.length(s.to + travel), ringing(q)));
}

void write_elastic(const ident::residual::Elastic& e, ident::Result& r) {
  const ident::Parameter* mass = r.find("mass");
  const std::string unit = mass != nullptr ? mass->unit : "N s2/m";
  const std::string shown = mass != nullptr ? mass->shown : "N s2/mm";
  const double whole = std::isfinite(r.mass) ? r.mass : e.mass;
  // The numbers of the drive were found beside a free mass: that and the one of the fit should be the same.
  const double own = 0.5 * (r.mass_interval.high - r.mass_interval.low);
  widen_mass(own + e.mass_half_width + std::abs(e.mass - whole), r);
  const auto told = [](const ident::Interval& i) { return i.high < 1.5 * i.low; };
  r.parameters.push_back({"table_mass", e.table_mass, unit, shown, e.table_interval.low,
                          e.table_interval.high, told(e.table_interval)});
  r.parameters.push_back({"anti_resonance", e.frequency, "Hz", "Hz", e.frequency_interval.low,
                          e.frequency_interval.high, told(e.frequency_interval)});
  const double share = std::min(0.99, e.table_mass / whole);
  r.warnings.push_back(fmt::format(
      "the drive gives way between motor and table (a belt, a coupling, a long screw): {}{:.0f} % of the mass swings behind it at {:.3g} Hz while the motor stands (damping ratio {:.2g}); this force was taken off the log, and the fit was made again, so that the mass is that of motor and table; pre-sliding is what the motor sees, with the wind-up of the drive in it; this holds for an encoder at the motor, not for a scale at the table; as axial_mode of a virtual machine: frequency {:.3g} Hz, table_share {:.2g}, damping_ratio {:.2g}; stribeck frequency shows the resonance",
      told(e.table_interval) ? "" : "about ", 100.0 * share, e.frequency, e.damping, e.frequency, share,
      e.damping));
}

std::string in_words(double size, double half_width, double hangs_at, const ident::Shown& people) {
  return fmt::format(
      "a force of {} (95 %: ±{}) follows the sine of the angle, the heavy side hangs down at {}: weight of an arm or of an unbalanced table",
      people.force(size), people.force(half_width), people.length(hangs_at));
}

/// Over many turns the fit itself finds the weight.
void name_unbalance(bool rotary, ident::Result& r) {
  const ident::Parameter* size = r.find("unbalance");
  const ident::Parameter* angle = r.find("unbalance_hangs_at");
  if (size == nullptr || angle == nullptr) return;
  r.warnings.push_back(in_words(size->value, 0.5 * (size->ci_high - size->ci_low), angle->value,
                                ident::Shown(r.position_unit, r.force_unit, rotary)) +
                       "; it stands among the periodic terms, with one turn as its period");
}

void write_unbalance(const ident::residual::Unbalance& u, bool rotary, ident::Result& r) {
  const double size = std::hypot(u.sine, u.cosine);
  const double phase = std::atan2(-u.cosine, u.sine);
  const double turn = std::min(kPi, u.half_width / size);
  r.parameters.push_back({"unbalance", size, "N", "N", size - u.half_width, size + u.half_width, true});
  r.parameters.push_back({"unbalance_hangs_at", phase, "m", "mm", phase - turn, phase + turn, true});
  widen_mass(u.mass, r);
  widen("load", u.half_width, r);  // over part of a turn an error of the weight looks like a load
  const bool room = r.friction.eccentric.size() < friction::kMaxEccentricTerms;
  if (room) r.friction.eccentric.push_back({size, 2.0 * kPi, phase, friction::EccentricForm::kAdditive});
  const ident::Shown people(r.position_unit, r.force_unit, rotary);
  r.warnings.push_back(fmt::format(
      "{}; it was taken off the log and the fit made again{}", in_words(size, u.half_width, phase, people),
      room ? "; it stands among the periodic terms, with one turn as its period" : ""));
}

/// Constant speeds need not tell a mass: one whose interval holds zero is none.
void without_mass(ident::Result& r) {
  if (!std::isfinite(r.mass) || r.mass_interval.low > 0.0) return;
  r.mass = kNaN;
  r.mass_interval = {};
  std::erase_if(r.parameters, [](const ident::Parameter& p) { return p.name == "mass"; });
  r.cannot_tell.emplace_back("mass: the runs of constant speed accelerate too little");
}

/// Adds what a second look still finds.
void add(const ident::residual::Diagnosis& more, ident::residual::Diagnosis& all) {
  if (more.elastic && !all.elastic) all.elastic = more.elastic;
  if (more.spring && all.spring) {
    all.spring->stiffness += more.spring->stiffness;
    all.spring->half_width = std::max(all.spring->half_width, more.spring->half_width);
    all.spring->mass_half_width = std::max(all.spring->mass_half_width, more.spring->mass_half_width);
    all.spring->may_be_weight = all.spring->may_be_weight || more.spring->may_be_weight;
  }
  if (more.spring && !all.spring) all.spring = more.spring;
  if (more.unbalance && all.unbalance) {
    all.unbalance->sine += more.unbalance->sine;
    all.unbalance->cosine += more.unbalance->cosine;
    all.unbalance->half_width = more.unbalance->half_width;
    all.unbalance->mass = more.unbalance->mass;
  }
  if (more.unbalance && !all.unbalance) all.unbalance = more.unbalance;
}

bool shift_moved(const ident::Result& before, const ident::Result& after, const AxisRecords& axis) {
  constexpr double kMoved = 0.05;  // rows
  const double period = axis.records.front().sample_time;
  return std::abs(ident::residual::shift_in_rows(before, period) -
                  ident::residual::shift_in_rows(after, period)) > kMoved;
}

/// A spring that the logs show, but that was not taken off them.
void doubt_mass(const ident::residual::Spring& s, bool rotary, ident::Result& r) {
  if (!(s.half_width > 0.0)) return;
  widen_mass(s.mass_half_width * (1.0 + std::abs(s.stiffness) / s.half_width), r);
  const ident::Shown people(r.position_unit, r.force_unit, rotary);
  r.warnings.push_back(fmt::format(
      "a force may grow with position by {} (95 %: ±{}; a spring, a cable chain or a balance); it explains too little of this log to be "
      "part of the model, and the interval of the mass holds both: add strokes at constant speed over the travel (stribeck excite "
      "--method jog)",
      people.force_per_length(s.stiffness), people.force_per_length(s.half_width)));
}

/// Logs without the forces that were found in them, and the steady part of the result on them.
struct Cleaned {
  ident::residual::Diagnosis taken;
  AxisRecords axis;
  Identification found;

  [[nodiscard]] ident::residual::LogsAndModel both() const { return {axis.records, found.result}; }
};

/// Whether `a` leaves less than this share of what `b` leaves.
bool leaves_less(const ident::residual::LogsAndModel& a, double share,
                 const ident::residual::LogsAndModel& b) {
  const auto [of_a, of_b] = ident::residual::both_leave(a, b);
  return of_a < share * of_b;
}

/// `by` has the shift between force and motion.
Cleaned clean(const AxisRecords& axis, const ident::residual::Diagnosis& taken, const ident::Result& by,
              const Identify& method) {
  Cleaned out{taken, without(axis, taken, by), {}};
  out.found = method(out.axis, Depth::kSteady);
  take_off_filter(out.found.result, out.axis);
  return out;
}

/// Again with the shift and the mass that hold without the forces: `before` and `by` are those of the pass before.
Cleaned refined(Cleaned first, const ident::residual::Diagnosis& before, const ident::Result& by,
                const AxisRecords& axis, const Identify& method) {
  const ident::Result& result = first.found.result;
  if (result.filter && !axis.records.front().filter) return first;  // found just now: `axis` still has it
  bool moved = shift_moved(by, result, axis);
  if (first.taken.elastic && !before.elastic) {
    const auto finer =
        ident::residual::diagnose(without(axis, before, result).records, result, false).elastic;
    if (finer) first.taken.elastic = finer;
    moved = moved || finer;
  }
  return moved ? clean(axis, first.taken, result, method) : first;
}

bool is_sure(const ident::residual::Diagnosis& d) {
  if (d.spring) return std::abs(d.spring->stiffness) > kSure * d.spring->half_width;
  return d.unbalance && std::hypot(d.unbalance->sine, d.unbalance->cosine) > kSure * d.unbalance->half_width;
}

/// What the next pass takes off. Beside an elastic drive a spring may be one of its errors: it is looked for again afterwards. A force
/// that pushes away from the middle is rare (a chain that hangs): what looks like it, but is not sure, is an error of the mass.
bool prepare(ident::residual::Diagnosis& found, ident::residual::Diagnosis& all) {
  if (all.elastic) found.elastic.reset();
  if (found.elastic) found.spring.reset(), found.unbalance.reset();
  if (found.spring && found.spring->stiffness < 0.0 && !is_sure(found)) found.spring.reset();
  add(found, all);
  return found.elastic || found.spring || found.unbalance;
}

/// A force that acts in one direction is no friction, and no number of a fit that contains it holds.
void doubt_all(const std::string& what, ident::Result& r) {
  for (ident::Parameter& p : r.parameters) p.identifiable = false;
  r.cannot_tell.push_back(what + ": record the motion without it; no number of this result holds");
}

/// Forces that the logs hold beside friction and mass, taken off them one after the other.
struct TakenOff {
  ident::residual::Diagnosis taken;
  ident::residual::Diagnosis left;  ///< in the logs without them
  std::optional<Cleaned> last;      ///< absent where nothing was tried
};

/// `d`: what the logs hold. `rigid`: no elastic drive among it.
TakenOff taken_off(const AxisRecords& axis, ident::residual::Diagnosis d, Method by, const Identify& method,
                   bool rigid) {
  TakenOff out;
  auto& [taken, left_now, last] = out;
  for (int pass = 0; pass < kPasses && may_run_again(by); ++pass) {
    if (rigid) d.elastic.reset();
    ident::residual::Diagnosis next = d, more = taken;
    if (!prepare(next, more)) break;
    // Both sides of the comparison are identified in the same way.
    if (!last) last = Cleaned{taken, axis, method(axis, Depth::kSteady)};
    const ident::Result before = last->found.result;
    Cleaned now = refined(clean(axis, more, before, method), taken, before, axis, method);
    const double least = next.elastic ? kMuchBetter : is_sure(next) ? 1.0 : kBetter;
    if (!leaves_less(now.both(), least, last->both())) {
      if (!next.elastic) break;
      d.elastic.reset();  // the other forces remain
      continue;
    }
    taken = now.taken;
    d = ident::residual::diagnose(now.axis.records, now.found.result, false);
    last = std::move(now);
  }
  if (taken.elastic && (taken.spring || taken.unbalance)) {
    // A force of the place that was still in the log may have looked like a drive that gives way.
    ident::residual::Diagnosis without_elastic = taken;
    without_elastic.elastic.reset();
    Cleaned now = clean(axis, without_elastic, last->found.result, method);
    if (leaves_less(now.both(), 1.0 / kMuchBetter, last->both())) {
      taken = std::move(without_elastic);
      last = std::move(now);
    }
  }
  left_now = std::move(d);
  return out;
}

/// A table that swings on its drive for long looks like a shift of the force by many rows, which then hides most of it. The forces
/// taken off the logs with the force as commanded; absent where that does not leave much less than `off`.
std::optional<TakenOff> elastic_in_place_of_shift(const AxisRecords& axis, const Identification& found,
                                                  const TakenOff& off, const Identify& method) {
  constexpr double kMany = 1.5;     // rows away from a force that is held
  constexpr double kAsGood = 1.05;  // ratio of residuals
  const ident::Result& result = found.result;
  if (!may_run_again(result.method) || result.given_shift || result.find("force_shift") == nullptr) return {};
  const double away = ident::residual::shift_in_rows(result, axis.records.front().sample_time) + 0.5;
  if (!(std::abs(away) > kMany)) return {};
  AxisRecords held = axis;
  held.as_commanded = true;
  const ident::Result rigid = method(held, Depth::kSteady).result;
  const ident::residual::Diagnosis d = ident::residual::diagnose(held.records, rigid, false);
  if (!d.elastic) return {};
  TakenOff rival = taken_off(held, d, result.method, method, false);
  if (!rival.taken.elastic) return {};
  // Without the swing the shift that the logs really have can be found.
  rival.last->axis.as_commanded = false;
  rival.last->found = method(rival.last->axis, Depth::kSteady);
  const ident::residual::LogsAndModel own =
      off.last ? off.last->both() : ident::residual::LogsAndModel{axis.records, result};
  // Where both hold a swing, the one that needs no shift is as simple as it can be.
  if (!leaves_less(rival.last->both(), off.taken.elastic ? kAsGood : kMuchBetter, own)) return {};
  return rival;
}

/// `found`: by the method on these logs. `rounds`: how often rows with a force in one direction may be left out.
Identification diagnosed(const AxisRecords& logged, Identification found, const Identify& method,
                         int rounds = 2) {
  if (!has_residual(found)) return found;
  std::optional<AxisRecords> before_filter;
  if (found.result.filter) take_off_filter(found.result, before_filter.emplace(logged));
  const AxisRecords& axis = before_filter ? *before_filter : logged;
  ident::residual::Diagnosis d = ident::residual::diagnose(axis.records, found.result, rounds > 0);
  if (d.one_sided) {
    const std::string what = in_words(
        *d.one_sided, ident::Shown(found.result.position_unit, found.result.force_unit, logged.rotary));
    if (d.one_sided->enough_left && may_run_again(found.result.method)) {
      AxisRecords clean = logged;
      for (ident::log::Record& r : clean.records) leave_out(*d.one_sided, r);
      Identification again = diagnosed(clean, method(clean, Depth::kWhole), method, rounds - 1);
      again.result.warnings.push_back(what + "; these rows are left out");
      return again;
    }
    doubt_all(what, found.result);
    found.quality = std::move(d.quality);
    found.result.warnings.insert(found.result.warnings.end(), d.warnings.begin(), d.warnings.end());
    return found;
  }
  TakenOff off = taken_off(axis, d, found.result.method, method, false);
  // An elastic drive that is slow follows the position of the motor as a spring does: where the spring alone explains as much, it is one.
  if (off.taken.elastic && (d.spring || d.unbalance)) {
    TakenOff rigid = taken_off(axis, d, found.result.method, method, true);
    if (rigid.last && off.last && leaves_less(rigid.last->both(), 1.0 / kMuchBetter, off.last->both()))
      off = std::move(rigid);
  }
  if (std::optional<TakenOff> rival = elastic_in_place_of_shift(axis, found, off, method))
    off = std::move(*rival);
  const ident::residual::Diagnosis& taken = off.taken;
  const std::optional<Cleaned>& last = off.last;
  d = std::move(off.left);
  if (taken.elastic || taken.spring || taken.unbalance) {
    found = method(last->axis, Depth::kWhole);
    d = ident::residual::diagnose(last->axis.records, found.result, false);
    if (found.result.method == Method::kJog) without_mass(found.result);
  }
  name_unbalance(axis.rotary, found.result);
  if (taken.elastic) write_elastic(*taken.elastic, found.result);
  found.elastic = taken.elastic;
  if (taken.spring) write_spring(*taken.spring, d.quality, axis.rotary, found.result);
  if (taken.unbalance) write_unbalance(*taken.unbalance, axis.rotary, found.result);
  if (d.spring && !taken.spring && may_run_again(found.result.method))
    doubt_mass(*d.spring, axis.rotary, found.result);
  constexpr double kBeyondTheSecondTerm = 1.25;
  if (d.elastic_mass > 0.0) widen_mass(kBeyondTheSecondTerm * d.elastic_mass, found.result);
  found.quality = std::move(d.quality);
  ident::Result& r = found.result;
  r.warnings.insert(r.warnings.end(), d.warnings.begin(), d.warnings.end());
  r.cannot_tell.insert(r.cannot_tell.end(), d.cannot_tell.begin(), d.cannot_tell.end());
  return found;
}

/// What was found on logs as_driving(): mass, load and spring stand for their parts of the force, friction for that at constant speed.
void write_lost_share(const ident::drive::LostShare& lost, ident::Result& r) {
  const double part = 1.0 - lost.share;
  r.mass *= part;
  r.plain_mass *= part;
  r.load *= part;
  r.mass_interval = {part * r.mass_interval.low, part * r.mass_interval.high};
  if (r.friction.spring) r.friction.spring->stiffness *= part;
  for (auto& term : r.friction.eccentric) {
    if (friction::is_unbalance(term)) term.amplitude *= part;
  }
  constexpr std::array<std::string_view, 5> kOfTheAxis{"mass", "load", "position_stiffness", "unbalance",
                                                       "table_mass"};
  for (ident::Parameter& p : r.parameters) {
    if (std::find(kOfTheAxis.begin(), kOfTheAxis.end(), p.name) == kOfTheAxis.end()) continue;
    p.value *= part, p.ci_low *= part, p.ci_high *= part;
  }
  if (r.open) {
    for (auto& d : r.open->deviations) d.mass *= part;
  }
  const double own = 0.5 * (r.mass_interval.high - r.mass_interval.low);
  widen_mass(std::hypot(own, r.mass * lost.half_width / part), r);
  r.parameters.push_back(
      {"lost_share", lost.share, "1", "1", lost.share - lost.half_width, lost.share + lost.half_width, true});
  r.warnings.push_back(fmt::format(
      "friction grows with the force: {:.1f} ± {:.1f} % of what the drive makes is lost (a nut, a worm or a gear with an efficiency of "
      "{:.2g}); mass and load are those without it, friction is that at constant speed; no axis file holds the rest: while the axis "
      "accelerates a compensation is that much too weak, and while it brakes too strong",
      100.0 * lost.share, 100.0 * lost.half_width, part));
}

/// With friction that grows with the force, where the logs show it and are explained better; absent elsewhere.
std::optional<Identification> with_lost_share(const AxisRecords& logged, const Identify& method) {
  constexpr double kExplainsMore = 0.85;  // of the error on held-out motion
  const auto lost = ident::drive::lost_share(logged.records);
  if (!lost) return {};
  AxisRecords mended = logged;
  for (ident::log::Record& r : mended.records) ident::drive::as_driving(lost->share, r);
  try {
    const double before = method(logged, Depth::kSteady).result.held_out_rms;
    const double after = method(mended, Depth::kSteady).result.held_out_rms;
    if (!(after < kExplainsMore * before)) return {};
    Identification found = diagnosed(mended, method(mended, Depth::kWhole), method);
    if (!std::isfinite(found.result.mass)) return {};
    write_lost_share(*lost, found.result);
    if (found.elastic)
      found.elastic->mass *= 1.0 - lost->share, found.elastic->table_mass *= 1.0 - lost->share;
    return found;
  } catch (const ident::Refused&) {
    return {};  // the logs as they are can be identified
  }
}

}  // namespace

Identification diagnosed(const AxisRecords& logged, const Identify& method) {
  Identification found = method(logged, Depth::kWhole);
  if (has_residual(found) && may_run_again(found.result.method)) {
    if (std::optional<Identification> lost = with_lost_share(logged, method)) return std::move(*lost);
  }
  if (has_residual(found) && may_run_again(found.result.method)) {
    if (const std::optional<AxisRecords> mended = without_row_means(logged, found, method)) {
      found = diagnosed(*mended, method(*mended, Depth::kWhole), method);
      found.result.warnings.push_back(fmt::format(
          "the force of this log is the mean over each row of {:.3g} ms, as of a trend; this is taken into account: log faster for the mass",
          1e3 * logged.records.front().sample_time));
      return found;
    }
  }
  return diagnosed(logged, std::move(found), method);
}

}  // namespace stribeck::workflow
