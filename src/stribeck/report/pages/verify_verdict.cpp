#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stribeck/core/numbers.hpp>
#include <stribeck/ident/shown.hpp>
#include <stribeck/report/pages/verify_parts.hpp>
#include <stribeck/report/text.hpp>
#include <utility>

namespace stribeck::report {
namespace {

std::string in_percent(double share) { return std::isfinite(share) ? decimals(100.0 * share, 2) : "–"; }

/// Sum of squares over all parts of what a share and its RMS belong to.
struct Pooled {
  double error = 0.0;
  double measured = 0.0;
  bool exact = false;  ///< in one part at least

  void add(double relative, double rms, std::size_t rows) {
    if (!std::isfinite(relative) || !std::isfinite(rms)) return;
    exact = exact || relative == 0.0;
    if (relative == 0.0) return;
    const double square = rms * rms * static_cast<double>(rows);
    error += square;
    measured += square / (relative * relative);
  }
  [[nodiscard]] double share() const {
    return measured > 0.0 ? std::sqrt(error / measured) : exact ? 0.0 : kNaN;
  }
};

}  // namespace

std::string_view name_of(Grade grade) noexcept {
  switch (grade) {
    case Grade::kGood:
      return "good";
    case Grade::kUsable:
      return "usable";
    case Grade::kUndecided:
      return "undecided";
    case Grade::kNotUsable:
      break;
  }
  return "not usable";
}

namespace {

/// By the force alone. The part of the error that the log itself causes does not count against the model.
Grade grade_of_force(const Verdict& v, const GradeLimits& limits) {
  if (!std::isfinite(v.error)) return Grade::kUndecided;
  if (100.0 * v.error <= limits.good) return Grade::kGood;
  if (100.0 * v.error <= limits.usable) return Grade::kUsable;
  const double of_log = std::isfinite(v.of_log) ? v.of_log : 0.0;
  const double of_model = std::sqrt(std::max(0.0, v.error * v.error - of_log * of_log));
  return 100.0 * of_model <= limits.usable ? Grade::kUndecided : Grade::kNotUsable;
}

/// Friction that differs for certain by more than its limit.
bool beyond(const ident::replay::FrictionChange& change, double limit) {
  return 100.0 * change.certain() > GradeLimits::kOfFriction * limit;
}

/// Of both directions together, or of one of them. A load that differs is an error of both.
bool friction_beyond(const Verdict& v, double limit) {
  return beyond(v.friction, limit) || beyond(v.forward, limit) || beyond(v.backward, limit);
}

/// Whether most of the log is slower than the speeds that the file knows of.
bool mostly_untold(const Verdict& v) { return v.untold > 0.5; }

/// The force of a motion of much acceleration is that of the mass: friction counts beside it.
Grade grade_of(const Verdict& v, const GradeLimits& limits) {
  const Grade by_force = grade_of_force(v, limits);
  if (friction_beyond(v, limits.usable)) return Grade::kNotUsable;
  if (by_force == Grade::kNotUsable && mostly_untold(v)) return Grade::kUndecided;
  return by_force == Grade::kGood && friction_beyond(v, limits.good) ? Grade::kUsable : by_force;
}

/// Of all parts, each with the weight of its interval; where they disagree, the one that is further off for certain.
struct PooledFriction {
  double sum = 0.0, speed = 0.0, varies = 0.0, weight = 0.0;
  ident::replay::FrictionChange most{};
  bool more = false, less = false;  ///< for certain, in one part at least

  void add(const ident::replay::FrictionChange& c) {
    if (!std::isfinite(c.share) || !(c.half_width > 0.0)) return;
    const double w = 1.0 / (c.half_width * c.half_width);
    sum += w * c.share, speed += w * c.speed, varies += w * c.varies, weight += w;
    if (c.certain() > most.certain()) most = c;
    if (c.certain() > 0.0) (c.share > 0.0 ? more : less) = true;
  }
  [[nodiscard]] ident::replay::FrictionChange change() const {
    if (!(weight > 0.0)) return {};
    if (more && less) return most;
    return {sum / weight, std::sqrt(1.0 / weight), speed / weight, varies / weight};
  }
};

/// The one that leaves more beyond its interval; the other one where it is not told.
ident::replay::FrictionChange larger(const ident::replay::FrictionChange& a,
                                     const ident::replay::FrictionChange& b) {
  if (!std::isfinite(a.share)) return b;
  return b.certain() > a.certain() ? b : a;
}

std::string more_in_words(const ident::replay::FrictionChange& c) {
  return fmt::format("{:.3g} ± {:.2g} % {}", 100.0 * std::abs(c.share), 100.0 * c.half_width,
                     c.share > 0.0 ? "more" : "less");
}

/// Friction that differs by direction, and the load that explains it where one becomes more and the other one less.
std::string directions_in_words(const Verdict& v, const ident::Shown& shown) {
  constexpr double kAlike = 0.5;  // of the larger change: friction of one direction alone is no load
  std::string words = "friction is ";
  if (std::isfinite(v.forward.share)) words += more_in_words(v.forward) + " forward";
  if (std::isfinite(v.forward.share) && std::isfinite(v.backward.share)) words += " and ";
  if (std::isfinite(v.backward.share)) words += more_in_words(v.backward) + " backward";
  words += " than that of the file";
  const double f = v.forward.share, b = v.backward.share;
  if (f * b < 0.0 && std::min(std::abs(f), std::abs(b)) > kAlike * std::max(std::abs(f), std::abs(b)) &&
      std::isfinite(v.load.share))
    words += fmt::format(": the constant force, a load or an offset, is {} ± {} {} than in the file",
                         shown.force(std::abs(v.load.share)), shown.force(v.load.half_width),
                         v.load.share > 0.0 ? "more" : "less");
  return words;
}

/// Friction that the verdict is lower for, in words; empty: none.
std::string friction_in_words(const Verdict& v, const VerifyReportInput& input) {
  if (!friction_beyond(v, input.limits.good)) return {};
  const ident::Shown shown(input.parts.front().record);
  const double limit = friction_beyond(v, input.limits.usable) ? input.limits.usable : input.limits.good;
  // Both directions together, where they alone are beyond the same limit.
  const std::string what = beyond(v.friction, limit)
                               ? fmt::format("friction at {} is {} than that of the file",
                                             shown.speed(v.friction.speed), more_in_words(v.friction))
                               : directions_in_words(v, shown);
  return fmt::format(", but {} (good up to {} %, usable up to {} %)", what,
                     short_number(GradeLimits::kOfFriction * input.limits.good),
                     short_number(GradeLimits::kOfFriction * input.limits.usable));
}

}  // namespace

std::vector<Verdict> verdicts(const VerifyReportInput& input) {
  std::vector<Verdict> all;
  if (input.parts.empty()) return all;
  for (std::size_t i = 0; i < input.parts.front().models.size(); ++i) {
    const bool moving = std::any_of(input.parts.begin(), input.parts.end(), [&](const VerifiedPart& p) {
      return i < p.models.size() && p.models[i].force.of_rests();
    });
    Pooled force, velocity, of_log;
    PooledFriction slow, fast, forward, backward, load;
    double untold = 0.0, in_motion = 0.0;
    for (const VerifiedPart& part : input.parts) {
      if (i >= part.models.size()) continue;
      const VerifiedModel& m = part.models[i];
      const ident::replay::ForceError& f = m.force;
      const double relative = moving ? f.moving_relative : f.own_relative;
      const double rms = moving ? f.moving_rms : f.own_rms;
      const double noise = moving ? f.of_log_moving : f.of_log;
      const std::size_t rows = moving ? f.moving : f.row.size();
      force.add(relative, rms, rows);
      of_log.add(noise, noise * rms / relative, rows);
      const ident::replay::FrictionChanges& of = f.friction;
      slow.add(of.slow), fast.add(of.fast), forward.add(of.forward), backward.add(of.backward);
      load.add({of.load, of.load_half_width, 0.0});
      untold += f.untold * static_cast<double>(f.moving), in_motion += static_cast<double>(f.moving);
      velocity.add(m.open.restarted.velocity_relative, m.open.restarted.velocity_rms, part.record.x.size());
    }
    Verdict v;
    v.name = input.parts.front().models[i].name;
    v.of_force = std::isfinite(force.share());
    v.moving = v.of_force && moving;
    v.error = v.of_force ? force.share() : velocity.share();
    if (v.of_force) v.of_log = of_log.share();
    v.friction = larger(slow.change(), fast.change());
    v.forward = forward.change(), v.backward = backward.change();
    v.load = load.change();
    v.untold = in_motion > 0.0 ? untold / in_motion : 0.0;
    v.told_from = input.parts.front().models[i].told_from;
    v.grade = grade_of(v, input.limits);
    v.settled =
        v.moving && std::any_of(input.parts.begin(), input.parts.end(), [&](const VerifiedPart& p) {
          return i < p.models.size() && p.models[i].force.of_rests() && p.models[i].force.unsettled > 0.0;
        });
    if (v.settled && v.grade == Grade::kGood) v.grade = Grade::kUsable;
    all.push_back(std::move(v));
  }
  return all;
}

bool usable(const VerifyReportInput& input) {
  const std::vector<Verdict> all = verdicts(input);
  return std::any_of(all.begin(), all.end(),
                     [](const Verdict& v) { return v.grade == Grade::kGood || v.grade == Grade::kUsable; });
}

namespace {

/// Behind the error: where the model was judged.
const char* where_judged(const Verdict& v) {
  if (v.settled)
    return " where friction has settled after a reversal; it has no pre-sliding, and is no more than usable";
  return v.moving ? " where the axis moves" : "";
}

}  // namespace

std::string sentence(const Verdict& v, const VerifyReportInput& input) {
  const GradeLimits& limits = input.limits;
  if (!std::isfinite(v.error))
    return v.name + " is undecided: the log is too short to compare forces, and no run in open loop is left.";
  if (v.grade == Grade::kUndecided && mostly_untold(v)) {
    const ident::Shown shown(input.parts.front().record);
    return fmt::format(
        "{} is undecided: error of the force {} %{} (good up to {} %, usable up to {} %), but in {:.0f} % of the motion the axis is slower "
        "than {}, from which on the file tells friction: verify with a faster motion, or identify slow jogs.",
        v.name, in_percent(v.error), where_judged(v), short_number(limits.good), short_number(limits.usable),
        100.0 * v.untold, shown.speed(v.told_from));
  }
  if (v.grade == Grade::kUndecided) {
    return fmt::format(
        "{} is undecided: error of the force {} %{} (good up to {} %, usable up to {} %), but noise, resolution and the time between rows of this log make a right model miss up to {} %: record more rows a second, or with finer values.",
        v.name, in_percent(v.error), where_judged(v), short_number(limits.good), short_number(limits.usable),
        in_percent(v.of_log));
  }
  return fmt::format("{} is {}: error of the {} {} %{} (good up to {} %, usable up to {} %){}.", v.name,
                     name_of(v.grade), v.of_force ? "force" : "velocity", in_percent(v.error),
                     where_judged(v), short_number(limits.good), short_number(limits.usable),
                     friction_in_words(v, input));
}

}  // namespace stribeck::report
