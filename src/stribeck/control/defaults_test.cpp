// Every setting of the real-time tier that may be left out, with the value that it has then and its bounds. Where a change is meant,
// STRIBECK_PRINT_DEFAULTS=1 prints the new list; the reference of the files is made from the same declarations.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <sstream>
#include <stribeck/control/compensation/lost_motion_params.hpp>
#include <stribeck/control/laws.hpp>
#include <stribeck/control/setup.hpp>
#include <stribeck/control/supervision/limits.hpp>
#include <stribeck/friction/unbalance.hpp>
#include <stribeck/friction/uncertainty.hpp>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

namespace stribeck::control::defaults_test {
namespace {

template <class T>
void write(std::ostream& out, const T& value, const std::string& name);

template <HasFields T>
void write_fields(std::ostream& out, const T& owner, const std::string& name) {
  for_each_field<T>([&](const auto& f) {
    const std::string key = f.name.empty() ? name : name + "." + std::string(f.name);
    write(out, owner.*f.member, key);
    if (std::isfinite(f.quantity.max)) out << key << " at most " << f.quantity.max << '\n';
    if (std::isfinite(f.quantity.min))
      out << key << (f.quantity.min_excluded ? " above " : " from ") << f.quantity.min << '\n';
  });
}

template <class T>
void write(std::ostream& out, const T& value, const std::string& name) {
  if constexpr (std::is_enum_v<T>) {
    out << name << ' ' << static_cast<int>(value) << '\n';
  } else if constexpr (std::is_arithmetic_v<T>) {
    out << name << ' ' << value << '\n';
  } else if constexpr (HasFields<T>) {
    write_fields(out, value, name);
  } else if constexpr (requires { value.has_value(); }) {
    out << name << (value ? " given" : " absent") << '\n';
    if (value) write(out, *value, name);
  } else if constexpr (requires { value.index(); }) {
    out << name << " alternative " << value.index() << '\n';
    std::visit([&](const auto& one) { write(out, one, name); }, value);
  } else if constexpr (requires {
                         value.begin();
                         value.size();
                       }) {
    out << name << " size " << value.size() << '\n';
    for (const auto& one : value) write(out, one, name + "[]");
  } else if constexpr (std::is_convertible_v<T, double>) {
    out << name << ' ' << static_cast<double>(value) << '\n';
  }
}

template <std::size_t... I>
void write_laws(std::ostream& out, std::index_sequence<I...>) {
  (write_fields(out, std::variant_alternative_t<I, LawParams>{}, "law" + std::to_string(I)), ...);
}

std::string all() {
  std::ostringstream out;
  write_laws(out, std::make_index_sequence<std::variant_size_v<LawParams>>{});
  write_fields(out, CompensationParams{}, "compensation");
  write_fields(out, SupervisionParams{}, "supervision");
  write_fields(out, LostMotionParams{}, "lost_motion");
  write_fields(out, friction::DriveLoop{}, "drive_loop");
  write_fields(out, friction::Conventional<double>{}, "conventional");
  write_fields(out, friction::Stribeck<double>{}, "stribeck");
  write_fields(out, friction::Gaussian<double>{}, "gaussian");
  write_fields(out, friction::GaussianTerm<double>{}, "term");
  write_fields(out, friction::LuGre<double>{}, "lugre");
  write_fields(out, friction::Gms<double>{}, "gms");
  write_fields(out, friction::GmsElement<double>{}, "element");
  write_fields(out, friction::Eccentric<double>{}, "eccentric");
  write_fields(out, friction::Place{}, "place");
  write_fields(out, friction::Spring{}, "spring");
  write_fields(out, friction::Unbalance{}, "unbalance");
  write_fields(out, friction::ModelDeviation{}, "deviation");
  write_fields(out, friction::ModelUncertainty{}, "uncertainty");
  return out.str();
}

const std::vector<std::string> kStored{
    "law0.kp size 1",
    "law0.kp[] 1600",
    "law0.kp above 0",
    "law0.kv size 1",
    "law0.kv[] 80",
    "law0.kv above 0",
    "law0.error_rate 0",
    "law1.lambda size 2",
    "law1.lambda[] 20",
    "law1.lambda[] 40",
    "law1.lambda above 0",
    "law1.a size 2",
    "law1.a[] 10",
    "law1.a[] 20",
    "law1.a from 0",
    "law1.gamma size 2",
    "law1.gamma[] 0.01",
    "law1.gamma[] 0.02",
    "law1.gamma from 0",
    "law1.mass_bound size 1",
    "law1.mass_bound[] 100",
    "law1.mass_bound from 0",
    "law1.force_bound size 1",
    "law1.force_bound[] 0",
    "law1.force_bound from 0",
    "law1.switching 0",
    "law1.boundary 0.001",
    "law1.boundary above 0",
    "law1.disturbance_rate 20",
    "law1.disturbance_rate above 0",
    "law1.gain 0",
    "law1.growth 3000",
    "law1.growth above 0",
    "law1.layer 2",
    "law1.layer above 0",
    "law1.gamma_least size 1",
    "law1.gamma_least[] 0.001",
    "law1.gamma_least above 0",
    "law1.gamma_most size 1",
    "law1.gamma_most[] 0.1",
    "law1.gamma_most above 0",
    "law1.error_rate 0",
    "law2.kp size 1",
    "law2.kp[] 2700",
    "law2.kp above 0",
    "law2.ki size 1",
    "law2.ki[] 27000",
    "law2.ki from 0",
    "law2.kv size 1",
    "law2.kv[] 90",
    "law2.kv above 0",
    "law2.error_rate 0",
    "law3.position_gain size 1",
    "law3.position_gain[] 20",
    "law3.position_gain above 0",
    "law3.velocity_gain size 1",
    "law3.velocity_gain[] 80",
    "law3.velocity_gain above 0",
    "law3.integral_time size 1",
    "law3.integral_time[] 0.1",
    "law3.integral_time above 0",
    "law3.velocity_feedforward 1",
    "law3.velocity_feedforward at most 1",
    "law3.velocity_feedforward from 0",
    "law3.acceleration_feedforward 1",
    "law3.acceleration_feedforward at most 1",
    "law3.acceleration_feedforward from 0",
    "law3.error_rate 0",
    "law4.kp size 1",
    "law4.kp[] 1600",
    "law4.kp above 0",
    "law4.kv size 1",
    "law4.kv[] 80",
    "law4.kv above 0",
    "law4.preview 0",
    "law5.kp size 1",
    "law5.kp[] 1600",
    "law5.kp above 0",
    "law5.kv size 1",
    "law5.kv[] 80",
    "law5.kv above 0",
    "law5.contour_kp 2000",
    "law5.contour_kp from 0",
    "law5.contour_ki 20000",
    "law5.contour_ki from 0",
    "law5.contour_kv 40",
    "law5.contour_kv from 0",
    "law5.error_rate 0",
    "law6.kp size 1",
    "law6.kp[] 1600",
    "law6.kp above 0",
    "law6.kv size 1",
    "law6.kv[] 80",
    "law6.kv above 0",
    "law6.learning 0.7",
    "law6.learning at most 1",
    "law6.learning from 0",
    "law6.cutoff 100",
    "law6.cutoff above 0",
    "law6.lead 2",
    "law6.lead at most 7",
    "law6.lead from 0",
    "law7.kp size 1",
    "law7.kp[] 1600",
    "law7.kp above 0",
    "law7.kv size 1",
    "law7.kv[] 80",
    "law7.kv above 0",
    "law7.learning 1",
    "law7.learning at most 1.5",
    "law7.learning from 0",
    "law7.least_learning 0.2",
    "law7.least_learning at most 1.5",
    "law7.least_learning from 0",
    "law7.cutoff 200",
    "law7.cutoff above 0",
    "law7.error_rate 0",
    "law8.omega 40",
    "law8.omega above 0",
    "law8.horizon 0.08",
    "law8.horizon above 0",
    "law8.iterations 30",
    "law8.iterations at most 200",
    "law8.iterations from 1",
    "law8.slows 1",
    "law8.catch_up 0.1",
    "law8.catch_up at most 1",
    "law8.catch_up from 0",
    "law8.reserve 0.1",
    "law8.reserve at most 0.9",
    "law8.reserve from 0",
    "law8.speed_limit size 0",
    "law8.speed_limit above 0",
    "law8.error_rate 0",
    "law8.rate_at_sample 0",
    "compensation.mass 0",
    "compensation.mass above 0",
    "compensation.load 0",
    "compensation.delay absent",
    "compensation.delay from 0",
    "compensation.friction.steady alternative 0",
    "compensation.friction.steady.alpha0 0",
    "compensation.friction.steady.alpha0 above 0",
    "compensation.friction.steady.alpha2 0",
    "compensation.friction.steady.alpha2 from 0",
    "compensation.friction.steady.stribeck absent",
    "compensation.friction.eccentric size 0",
    "compensation.friction.dynamics alternative 0",
    "compensation.friction.places size 0",
    "compensation.friction.spring absent",
    "compensation.drive_loop absent",
    "compensation.feedforward 0",
    "compensation.observer 0",
    "compensation.observer_pole 20",
    "compensation.observer_pole at most 100000",
    "compensation.observer_pole above 0",
    "compensation.disturbance_density absent",
    "compensation.disturbance_density above 0",
    "compensation.adaptive_gain 20",
    "compensation.adaptive_gain above 0",
    "compensation.adaptation.enabled 0",
    "compensation.adaptation.memory 20",
    "compensation.adaptation.memory above 0",
    "compensation.adaptation.level_spread 0.25",
    "compensation.adaptation.level_spread from 0",
    "compensation.adaptation.viscous_spread 0.25",
    "compensation.adaptation.viscous_spread from 0",
    "compensation.adaptation.stiffness_spread 0.4",
    "compensation.adaptation.stiffness_spread from 0",
    "compensation.adaptation.mass_spread 0.15",
    "compensation.adaptation.mass_spread from 0",
    "compensation.adaptation.delay_spread 0.5",
    "compensation.adaptation.delay_spread from 0",
    "compensation.adaptation.noise_share 0.05",
    "compensation.adaptation.noise_share above 0",
    "compensation.adaptation.correlation 0.05",
    "compensation.adaptation.correlation above 0",
    "compensation.reversal.distance absent",
    "compensation.reversal.distance above 0",
    "compensation.reversal.build_up size 0",
    "compensation.reversal.lead 0",
    "compensation.reversal.lead at most 0.02",
    "compensation.reversal.lead from 0",
    "compensation.reversal.rate_limit absent",
    "compensation.reversal.rate_limit above 0",
    "compensation.reversal.short_move absent",
    "compensation.reversal.short_move above 0",
    "compensation.encoder_resolution 1e-07",
    "compensation.encoder_resolution above 0",
    "compensation.guarded 0",
    "supervision.checks 2",
    "supervision.speed_limit absent",
    "supervision.speed_limit above 0",
    "supervision.acceleration_limit absent",
    "supervision.acceleration_limit above 0",
    "supervision.jump absent",
    "supervision.jump above 0",
    "supervision.push absent",
    "supervision.push above 0",
    "supervision.following_error absent",
    "supervision.following_error above 0",
    "supervision.omega absent",
    "supervision.omega above 0",
    "supervision.following_time 0.1",
    "supervision.following_time from 0",
    "supervision.bridge_time 0.01",
    "supervision.bridge_time at most 0.1",
    "supervision.bridge_time above 0",
    "supervision.stop_time 0.05",
    "supervision.stop_time at most 1",
    "supervision.stop_time above 0",
    "supervision.saturation_time 0.5",
    "supervision.saturation_time above 0",
    "supervision.start_share 0.5",
    "supervision.start_share at most 1",
    "supervision.start_share above 0",
    "lost_motion.backlash 0",
    "lost_motion.backlash from 0",
    "lost_motion.backlash_slope 0",
    "lost_motion.stiffness absent",
    "lost_motion.stiffness above 0",
    "lost_motion.table_friction 0",
    "lost_motion.table_friction from 0",
    "lost_motion.table_mass 0",
    "lost_motion.table_mass from 0",
    "lost_motion.build_up 3e-06",
    "lost_motion.build_up above 0",
    "lost_motion.move.distance absent",
    "lost_motion.move.distance above 0",
    "lost_motion.move.cycles absent",
    "lost_motion.move.cycles at most 1000",
    "lost_motion.move.cycles from 3",
    "lost_motion.move.speed absent",
    "lost_motion.move.speed above 0",
    "lost_motion.move.acceleration absent",
    "lost_motion.move.acceleration above 0",
    "lost_motion.move.jerk absent",
    "lost_motion.move.jerk above 0",
    "drive_loop.mode 0",
    "drive_loop.gain 0",
    "drive_loop.gain above 0",
    "drive_loop.integral_time absent",
    "drive_loop.integral_time above 0",
    "drive_loop.position_gain absent",
    "drive_loop.position_gain above 0",
    "drive_loop.velocity_feedforward absent",
    "drive_loop.velocity_feedforward at most 1",
    "drive_loop.velocity_feedforward from 0",
    "drive_loop.force_offset 0",
    "drive_loop.force_feedback 0",
    "conventional.alpha0 0",
    "conventional.alpha0 above 0",
    "conventional.alpha2 0",
    "conventional.alpha2 from 0",
    "conventional.stribeck absent",
    "stribeck.alpha1 0",
    "stribeck.alpha1 above 0",
    "stribeck.v0 0.001",
    "stribeck.v0 above 0",
    "stribeck.delta 2",
    "stribeck.delta above 0",
    "gaussian.velocity_range size 2",
    "gaussian.velocity_range[] 0",
    "gaussian.velocity_range[] 0",
    "gaussian.positive.eta0 0",
    "gaussian.positive.eta1 0",
    "gaussian.positive.gaussians size 0",
    "gaussian.negative.eta0 0",
    "gaussian.negative.eta1 0",
    "gaussian.negative.gaussians size 0",
    "term.a 0",
    "term.b 0",
    "term.c 1",
    "term.c above 0",
    "lugre.sigma0 0",
    "lugre.sigma0 above 0",
    "lugre.sigma1 0",
    "lugre.sigma1 from 0",
    "lugre.damping_velocity absent",
    "lugre.damping_velocity above 0",
    "gms.elements size 0",
    "gms.attraction 0",
    "gms.attraction above 0",
    "gms.damping 0",
    "gms.damping from 0",
    "gms.damping_velocity absent",
    "gms.damping_velocity above 0",
    "element.stiffness 0",
    "element.stiffness above 0",
    "element.share 0",
    "element.share at most 1",
    "element.share above 0",
    "eccentric.amplitude 0",
    "eccentric.amplitude from 0",
    "eccentric.period 1",
    "eccentric.period above 0",
    "eccentric.phase 0",
    "eccentric.form 0",
    "place.position 0",
    "place.level 1",
    "place.level at most 20",
    "place.level from 0.05",
    "place.stiffness 1",
    "place.stiffness at most 20",
    "place.stiffness from 0.05",
    "spring.stiffness 0",
    "spring.zero_at 0",
    "spring.from absent",
    "spring.to absent",
    "unbalance.torque 0",
    "unbalance.torque above 0",
    "unbalance.hangs_at 0",
    "deviation.mass 0",
    "deviation.level size 2",
    "deviation.level[] 0",
    "deviation.level[] 0",
    "deviation.viscous size 2",
    "deviation.viscous[] 0",
    "deviation.viscous[] 0",
    "deviation.rise size 2",
    "deviation.rise[] 0",
    "deviation.rise[] 0",
    "deviation.stiffness 0",
    "deviation.damping 0",
    "uncertainty.rise_speed 0.001",
    "uncertainty.rise_speed above 0",
    "uncertainty.told_from 0",
    "uncertainty.told_from from 0",
    "uncertainty.deviations size 0",
};

TEST(Defaults, AreThoseOfTheList) {
  const std::string now = all();
  if (std::getenv("STRIBECK_PRINT_DEFAULTS") != nullptr) {
    std::istringstream lines(now);
    for (std::string line; std::getline(lines, line);) std::printf("    \"%s\",\n", line.c_str());
    return;
  }
  std::vector<std::string> told;
  std::istringstream lines(now);
  for (std::string line; std::getline(lines, line);) told.push_back(line);
  EXPECT_EQ(told, kStored);
}

}  // namespace
}  // namespace stribeck::control::defaults_test
