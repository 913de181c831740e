#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stribeck/io/error.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/sim/axis_file.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>

namespace stribeck::workflow {
namespace {

constexpr double kSlow = 1e-3;              // [m/s]: where the level of friction counts for its build-up
constexpr double kPreSlidingDamping = 0.1;  // ratio, of the mass on the bristles
constexpr double kFaded = 1e-4;             // [m/s]: where that damping has faded
constexpr double kDrive = 10.0;             // [V] at the largest force
constexpr double kWindUpDamping = 0.15;     // ratio
constexpr double kStiffDrive = 100.0;       // [Hz]: of the table where only the backlash is known
constexpr int kMostDelay = 8;               // [control periods]

/// Bristles on which friction builds up within kBreakAway.
friction::LuGre<double> usual_bristles(const friction::AxisModel& model) {
  const double level =
      0.5 * (model.friction.parts(kSlow, 0.0).level + model.friction.parts(-kSlow, 0.0).level);
  friction::LuGre<double> bristles;
  bristles.sigma0 = level / kBreakAway;
  bristles.sigma1 = 2.0 * kPreSlidingDamping * std::sqrt(bristles.sigma0 * model.mass);
  bristles.damping_velocity = kFaded;
  return bristles;
}

std::optional<plant::LostMotion> lost_motion(const sim::AxisFile& file) {
  if (!file.lost_motion) return std::nullopt;
  const control::LostMotionParams& known = *file.lost_motion;
  plant::LostMotion lost;
  lost.backlash = known.backlash;
  lost.backlash_slope = known.backlash_slope;
  lost.damping_ratio = kWindUpDamping;
  if (known.table_mass > 0.0) lost.table_share = std::clamp(known.table_mass / file.model.mass, 0.05, 0.95);
  const double rate = 2.0 * kPi * kStiffDrive;
  lost.stiffness = known.stiffness.value_or(lost.table_share * file.model.mass * rate * rate);
  const double level = file.model.friction.parts(kSlow, 0.0).level;
  if (known.table_friction > 0.0 && level > 0.0)
    lost.table_friction = std::min(known.table_friction / level, 1.0);
  return lost;
}

}  // namespace

plant::AxisParams model_as_truth(const AxisDescription& axis, const std::string& name, double sample_time,
                                 const std::string& machine_file, const std::string& axis_file) {
  return model_as_truth(axis, name, sample_time, machine_file, axis_file, read_axis_file(axis_file));
}

plant::AxisParams model_as_truth(const AxisDescription& axis, const std::string& name, double sample_time,
                                 const std::string& machine_file, const std::string& axis_file,
                                 const sim::AxisFile& file) {
  const sim::NamePlate plate = axis.name_plate();
  if (!(plate.encoder_resolution > 0.0)) {
    throw io::InputError(
        {machine_file, 0, fmt::format("axes.{}.commissioning.encoder_resolution", name),
         fmt::format(
             "missing, expected the step of the encoder, with which the axis is simulated (write encoder_resolution = "
             "\"{}\", with your value)",
             axis.rotary ? "0.0001 deg" : "1 um")});
  }
  const double friction = file.model.friction.parts(kSlow, 0.0).level;
  double standing = std::abs(file.model.load);
  if (const auto& spring = file.model.friction.spring) {
    for (const double end : {axis.limits.travel_min, axis.limits.travel_max})
      standing = std::max(standing, std::abs(file.model.load + spring->at(end)));
  }
  if (!(friction + standing < plate.force)) {
    throw io::InputError(
        {axis_file, 0, "friction",
         fmt::format(
             "friction of {:.4g} N and a load{} of {:.4g} N need more than the {:.4g} N of the drive in {} (check the scale of "
             "the log, --gain, and the data of the drive)",
             friction, file.model.friction.spring ? " with the spring" : "", standing, plate.force,
             machine_file)});
  }
  plant::AxisParams truth;
  truth.mass = file.model.mass;
  truth.load = file.model.load;
  truth.drive = plant::CurrentDrive{plate.force / kDrive, std::nullopt};
  truth.converter.range = kDrive;
  truth.encoder.resolution = plate.encoder_resolution;
  const double periods = file.model.delay_or_none() / sample_time;
  if (!(periods <= kMostDelay)) {
    throw io::InputError(
        {axis_file, 0, "delay",
         fmt::format(
             "got {:.4g} ms, expected at most {:.4g} ms, {} control periods of {}, to simulate the axis",
             1e3 * file.model.delay_or_none(), 1e3 * kMostDelay * sample_time, kMostDelay, machine_file)});
  }
  truth.delay_periods = static_cast<int>(std::floor(periods));
  truth.friction = file.model.friction;
  if (!friction::has_pre_sliding(truth.friction.dynamics))
    truth.friction.dynamics = usual_bristles(file.model);
  truth.lost_motion = lost_motion(file);
  // The machine file may say nothing of a loop that the axis file has.
  const auto& told = axis.drive_loop ? axis.drive_loop : file.model.drive_loop;
  if (told) {
    plant::DriveLoop loop;
    loop.loop = *told;
    loop.cycle = sample_time;
    truth.drive_loop = loop;
  } else if (const double rest = periods - truth.delay_periods; rest > 1e-6) {
    truth.delay_fraction = rest;
  }
  io::Problems problems(axis_file);
  truth.validate([&](std::string_view key, std::string_view what) {
    problems.add(0, std::string(key), std::string(what));
  });
  problems.throw_if_any();
  return truth;
}

}  // namespace stribeck::workflow
