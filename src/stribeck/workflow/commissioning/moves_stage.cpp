#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include <stribeck/report/text.hpp>
#include <stribeck/workflow/commissioning/parts.hpp>

namespace stribeck::workflow::commissioning {
namespace {

constexpr double kFirst = 0.05e-3;  // [m]
constexpr double kGrows = 3.0;
constexpr double kFarthest = 15e-3;     // [m]
constexpr double kSpeedShare = 0.5;     // of the limit
constexpr double kMoveTime = 0.5;       // of one move [s], where the speed allows it
constexpr double kForceShare = 0.98;    // of the largest force: more is a limit
constexpr double kMoveFerror = 0.5e-3;  // the controller stops there [m]
constexpr double kArrived = 0.1;        // share of a move, beside what friction holds back
constexpr double kHeldBack =
    2.5;  // of friction over stiffness of the loop: twice, as it changes its sign on the way

constexpr int kLostAlone = 1;  // of supervision.checks

struct Moved {
  double farthest_error = 0.0;  ///< largest |r − x| [m]
  double force = 0.0;           ///< largest [N]
  double friction = 0.0;        ///< half the difference of the mean force there and back [N]
};

/// Of a move there and back: each half by the direction of the command.
Moved judge_move(const AxisRows& rows, double period, double speed) {
  Moved out;
  double sum[2] = {0.0, 0.0};
  double count[2] = {0.0, 0.0};
  for (std::size_t k = 0; k < rows.r.size(); ++k) {
    out.farthest_error = std::max(out.farthest_error, std::abs(rows.r[k] - rows.x[k]));
    out.force = std::max(out.force, std::abs(rows.f[k]));
    const double step = k + 1 < rows.r.size() ? rows.r[k + 1] - rows.r[k] : 0.0;
    if (std::abs(step) < 0.9 * speed * period) continue;
    sum[step > 0.0] += rows.f[k];
    count[step > 0.0] += 1.0;
  }
  out.friction = count[0] > 0.0 && count[1] > 0.0 ? 0.5 * (sum[1] / count[1] - sum[0] / count[0]) : kNaN;
  return out;
}

/// Towards the side with more room.
double room_of_axis(const RunningAxis& a, double at) {
  const double up = a.limits.travel_max - at;
  const double down = at - a.limits.travel_min;
  return up >= down ? up : -down;
}

/// How far a loop without an integrator stays away from its command [m]; a loop inside the drive has one.
double held_back(Work& work, const RunningAxis& a) {
  const double omega = value_in_hal(work.machine, a.controller + ".omega");
  const double stiffness = a.rough.mass.middle() * omega * omega;
  return a.takes_force && stiffness > 0.0 ? kHeldBack * a.rough.friction.high() / stiffness : 0.02e-3;
}

Moved there_and_back(Work& work, const RunningAxis& a, double distance, double speed) {
  const std::string file = fmt::format("{}/{}.log", work.folder, a.name);
  const auto joint = static_cast<std::size_t>(a.joint);
  const auto at = [&] { return work.machine.state().joints.at(joint).position * work.axes.unit; };
  const double from = at();
  work.machine.begin_record(work.axes.sampler, file);
  jog(work, a, speed, distance);
  work.machine.sleep(0.1);
  const double went = at() - from;
  jog(work, a, speed, -distance);
  work.machine.end_record();
  const auto rows = read_record(work.axes, file);
  const Moved m =
      judge_move(rows[static_cast<std::size_t>(&a - work.axes.axes.data())], work.axes.period, speed);
  if (m.force > kForceShare * a.force_limit)
    throw Stopped(
        fmt::format("axis {}: a move of {} mm needs {} N of {} N: something blocks it, or it is too fast",
                    a.name, report::significant(1e3 * distance, 3), report::significant(m.force, 4),
                    report::significant(a.force_limit, 4)));
  if (std::abs(went - distance) > std::max(held_back(work, a), kArrived * std::abs(distance)))
    throw Stopped(fmt::format(
        "axis {}: of a move of {} mm the encoder shows {} mm (look at the scale of the encoder, and at "
        "what holds the axis)",
        a.name, report::significant(1e3 * distance, 3), report::significant(1e3 * went, 4)));
  return m;
}

io::Json move_axis(Work& work, ChangedValues& changed, const RunningAxis& a) {
  const auto joint = static_cast<std::size_t>(a.joint);
  const double room = room_of_axis(a, work.machine.state().joints.at(joint).position * work.axes.unit);
  const double most = std::min(kFarthest, 0.5 * std::abs(room));
  if (most < kFirst) throw Stopped(fmt::format("axis {}: it has no room to move", a.name));
  work.ask(fmt::format(
      "axis {}: moves by 0.05 mm towards {} and back, then each time {} times as far, up to {} mm at {} mm/s. It stops {} mm away from its "
      "command, or less where its ferror-limit is lower.",
      a.name, room > 0.0 ? '+' : '-', kGrows, report::significant(1e3 * most, 3),
      report::significant(1e3 * std::min(kSpeedShare * a.limits.speed, most / kMoveTime), 3),
      report::significant(1e3 * kMoveFerror, 2)));
  tighten(work, changed, a, kMoveFerror);
  Moved last;
  double farthest = 0.0;
  for (double d = kFirst; d <= most * 1.0001; d = d < most && d * kGrows > most ? most : d * kGrows) {
    const double speed = std::min(kSpeedShare * a.limits.speed, d / kMoveTime);
    last = there_and_back(work, a, room > 0.0 ? d : -d, speed);
    farthest = d;
    if (d >= most) break;
  }
  work.found(fmt::format(
      "axis {}: moved by up to {} mm; following error at most {} um, force at most {} N of {} N", a.name,
      report::significant(1e3 * farthest, 3), report::significant(1e6 * last.farthest_error, 3),
      report::significant(last.force, 4), report::significant(a.force_limit, 4)));
  if (std::isfinite(last.friction) &&
      (last.friction < a.rough.friction.low() || last.friction > a.rough.friction.high()))
    throw Stopped(fmt::format(
        "axis {}: friction is about {} N at that speed, and the machine file says {} to {} N. The scale of the force or the machine file "
        "is wrong (correct gain, lead or commissioning.friction)",
        a.name, report::significant(last.friction, 3), report::significant(a.rough.friction.low(), 3),
        report::significant(a.rough.friction.high(), 3)));
  return {{"axis", a.name},
          {"distance_mm", 1e3 * farthest},
          {"following_error_um", 1e6 * last.farthest_error},
          {"force_N", last.force},
          {"friction_N", io::number_or_null(last.friction)}};
}

}  // namespace

io::Json moves(Work& work) {
  require_ready(work);
  work.ask(
      "Switches the machine off and on, so that the supervision of the controllers looks for lost encoders alone: an axis that friction "
      "holds at the start of a slow move looks like a frozen one.");
  ChangedValues changed(work.machine, work.folders.path(kForAWhile));
  work.machine.switch_off();
  for (const RunningAxis& a : work.axes.axes) {
    const std::string name = a.controller + ".supervision.checks";
    if (value_in_hal(work.machine, name) > kLostAlone) changed.set({{name, fmt::format("{}", kLostAlone)}});
  }
  work.machine.switch_on();
  work.machine.sleep(0.1);
  io::Json axes = io::Json::array();
  for (const RunningAxis& a : work.axes.axes) axes.push_back(move_axis(work, changed, a));
  work.machine.switch_off();
  changed.give_back();
  work.machine.switch_on();
  work.machine.sleep(0.1);
  work.found(
      "Look at a dial gauge once: LinuxCNC cannot know whether one millimetre of the encoder is one millimetre of the table.");
  return {{"axes", axes}};
}

}  // namespace stribeck::workflow::commissioning
