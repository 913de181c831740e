#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include <stribeck/workflow/log/converted.hpp>
#include <stribeck/workflow/log/effort.hpp>
#include <stribeck/workflow/log/encoders.hpp>
#include <stribeck/workflow/log/log_times.hpp>
#include <stribeck/workflow/log/motion_columns.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::workflow {
namespace {

/// Values [m]; empty where the unit is none of a position, or an angle without --lead.
std::vector<double> metres_of(const NamedColumn& named, const MotionColumns& motion, bool of_motor) {
  if (const auto linear = conversion_between(named.unit, "m")) return converted(*named.column, *linear, 1.0);
  const auto turning = conversion_between(named.unit, "rad");
  if (!turning || motion.per_radian == 0.0) return {};
  return converted(*named.column, *turning, of_motor ? motion.per_radian : motion.per_radian_of(named.unit));
}

bool all_finite(const std::vector<double>& x) {
  return std::all_of(x.begin(), x.end(), [](double v) { return std::isfinite(v); });
}

}  // namespace

std::optional<ident::lost_motion::Positions> both_encoders(const io::Log& log, const LogOptions& options,
                                                           std::vector<std::string>& notes) {
  const AxisColumns columns(log, options);
  std::optional<NamedColumn> motor = columns.find(LogQuantity::kMotor);
  std::optional<NamedColumn> scale = columns.find(LogQuantity::kScale);
  if (!motor && !scale) return {};
  const std::optional<NamedColumn> x = columns.find(LogQuantity::kPosition);
  if (!motor) motor = x;
  if (!scale) scale = x;
  const auto unused = [&](const std::string& why) {
    notes.push_back(fmt::format("lost motion is not identified: {}", why));
    return std::nullopt;
  };
  if (!motor || !scale || motor->column == scale->column) return unused("one position only");
  if (!options.where.empty() || !options.runs.empty())
    return unused("it needs all rows of a log (leave out --where and --runs)");
  std::vector<std::string> ignored;
  const MotionColumns motion = find_motion(columns, options, ignored);
  const Effort effort = find_effort(columns, motion, options, ignored);
  ident::lost_motion::Positions p;
  p.motor = metres_of(*motor, motion, true);
  p.scale = metres_of(*scale, motion, false);
  if (p.motor.empty() || p.scale.empty())
    return unused("a position is an angle or has no unit (give --lead, or --map with the unit)");
  if (effort.unit == "N") p.force = converted(*effort.from.column, effort.conversion, effort.factor);
  LogTimes times(columns);
  const int index = times.index_of(*motor->column);
  if (index >= 0) {
    const io::TimeCheck check = io::check_time(times.seconds(index), log.source);
    if (!check.regular()) return unused("the times are not equally spaced");
    p.sample_time = check.sample_time;
  } else {
    p.sample_time = option_si("--sample-time", options.sample_time, quantity("s", "ms").positive());
  }
  if (p.scale.size() != p.motor.size() || (!p.force.empty() && p.force.size() != p.motor.size()))
    return unused("its columns have rows of their own");
  if (!all_finite(p.motor) || !all_finite(p.scale) || !all_finite(p.force))
    return unused("a row has no value");
  return p;
}

}  // namespace stribeck::workflow
