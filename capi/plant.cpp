#include <stribeck/plant.h>

#include <cmath>
#include <new>
#include <stribeck/plant/axis.hpp>

#include "parameters.hpp"

using namespace stribeck;

struct stribeck_plant {
  plant::AxisParams params;
  std::optional<plant::Axis> axis;
  double force_gain = capi::kAbsent;  ///< [N/V]
  double range = capi::kAbsent;       ///< [V]
  bool by_position = false;           ///< a drive_loop that takes a position
  double last_command = 0.0;          ///< of a drive with a loop
  capi::Problem problem;
};

namespace {

/// No exception may pass the C interface.
template <class F>
stribeck_result guarded(stribeck_plant* p, F&& f) noexcept {
  if (p == nullptr) return STRIBECK_BAD_HANDLE;
  try {
    return f();
  } catch (const std::bad_alloc&) {
    p->problem.set({stribeck_describe(STRIBECK_NO_MEMORY)});
    return STRIBECK_NO_MEMORY;
  } catch (const std::exception& e) {
    p->problem.set({e.what()});
    return STRIBECK_REFUSED;
  } catch (...) {
    p->problem.set({"an exception of an unknown kind"});
    return STRIBECK_REFUSED;
  }
}

Value initial() noexcept { return initial_of(type_of<plant::AxisParams>); }

stribeck_result not_configured(stribeck_plant& p) {
  p.problem.set({"not configured: call stribeck_plant_configure() first"});
  return STRIBECK_NOT_CONFIGURED;
}

/// Whether the state is still one of numbers; after an overflow only a start helps.
bool in_motion(const plant::Axis& axis) {
  return std::isfinite(axis.position()) && std::isfinite(axis.velocity());
}

}  // namespace

extern "C" {

stribeck_result stribeck_plant_create(stribeck_plant** out) noexcept {
  if (out == nullptr) return STRIBECK_BAD_ARGUMENT;
  *out = new (std::nothrow) stribeck_plant();
  return *out == nullptr ? STRIBECK_NO_MEMORY : STRIBECK_OK;
}

void stribeck_plant_destroy(stribeck_plant* p) noexcept { delete p; }

stribeck_result stribeck_plant_parameter(std::uint32_t index, stribeck_parameter* out) noexcept {
  return capi::parameter_at(initial(), index, out);
}

const char* stribeck_plant_parameter_word(const char* name, std::uint32_t index) noexcept {
  return capi::word_at(initial(), name, index);
}

stribeck_result stribeck_plant_set(stribeck_plant* p, const char* name, double value) noexcept {
  if (p == nullptr) return STRIBECK_BAD_HANDLE;
  return capi::set_parameter(target_of(p->params), name, value, "", p->problem);
}

stribeck_result stribeck_plant_choose(stribeck_plant* p, const char* name, const char* word) noexcept {
  if (p == nullptr) return STRIBECK_BAD_HANDLE;
  return capi::choose_parameter(target_of(p->params), name, word, "", p->problem);
}

const char* stribeck_plant_problem(const stribeck_plant* p) noexcept {
  return p == nullptr ? stribeck_describe(STRIBECK_BAD_HANDLE) : p->problem.text();
}

stribeck_result stribeck_plant_configure(stribeck_plant* p, double period, double highest_speed) noexcept {
  return guarded(p, [&]() -> stribeck_result {
    if (!(period >= capi::kShortestPeriod && period < 1.0)) {
      p->problem.set({capi::kPeriodExpected});
      return STRIBECK_BAD_ARGUMENT;
    }
    if (!(highest_speed > 0.0 && std::isfinite(highest_speed))) {
      p->problem.set({"highest speed: expected a speed above 0"});
      return STRIBECK_BAD_ARGUMENT;
    }
    const bool sound = capi::check(value_of(p->params), [&](std::string_view key, std::string_view what) {
      p->problem.set({key, ": ", what});
    });
    if (!sound) return STRIBECK_REFUSED;
    plant::Axis axis(p->params, period, highest_speed);
    axis.start(0.0, {}, {});
    p->axis = std::move(axis);
    p->force_gain = p->params.force_gain();
    p->range = p->params.converter.range;
    p->by_position =
        p->params.drive_loop && p->params.drive_loop->loop.mode == friction::DriveMode::kPosition;
    return STRIBECK_OK;
  });
}

stribeck_result stribeck_plant_start(stribeck_plant* p, double position, std::uint64_t seed,
                                     std::int32_t substeps) noexcept {
  return guarded(p, [&]() -> stribeck_result {
    if (!p->axis) return not_configured(*p);
    if (!std::isfinite(position) || substeps < 1 || substeps > 1000) {
      p->problem.set(
          {std::isfinite(position) ? "substeps: expected 1 to 1000" : "position: expected a number"});
      return STRIBECK_BAD_ARGUMENT;
    }
    plant::Fidelity fidelity;
    fidelity.substeps = substeps;
    p->axis->start(position, fidelity, {seed, 0, 0});
    p->last_command = p->by_position ? position : 0.0;
    return STRIBECK_OK;
  });
}

stribeck_result stribeck_plant_step(stribeck_plant* p, double voltage, double load) noexcept {
  if (p == nullptr) return STRIBECK_BAD_HANDLE;
  if (!p->axis) return not_configured(*p);
  if (p->axis->has_loop()) {
    p->problem.set({"drive_loop: this drive takes a command: stribeck_plant_step_command()"});
    return STRIBECK_REFUSED;
  }
  const bool finite = std::isfinite(voltage) && std::isfinite(load);
  p->axis->step(std::isfinite(voltage) ? voltage : 0.0, std::isfinite(load) ? load : 0.0);
  return finite && in_motion(*p->axis) ? STRIBECK_OK : STRIBECK_NOT_FINITE;
}

stribeck_result stribeck_plant_step_command(stribeck_plant* p, double command, double offset,
                                            double load) noexcept {
  if (p == nullptr) return STRIBECK_BAD_HANDLE;
  if (!p->axis) return not_configured(*p);
  if (!p->axis->has_loop()) {
    p->problem.set({"drive_loop: this drive has none"});
    return STRIBECK_REFUSED;
  }
  const bool finite = std::isfinite(command) && std::isfinite(offset) && std::isfinite(load);
  if (std::isfinite(command)) p->last_command = command;
  p->axis->step(p->last_command, std::isfinite(load) ? load : 0.0, std::isfinite(offset) ? offset : 0.0);
  return finite && in_motion(*p->axis) ? STRIBECK_OK : STRIBECK_NOT_FINITE;
}

double stribeck_plant_get(const stribeck_plant* p, stribeck_plant_signal signal) noexcept {
  if (p == nullptr || !p->axis) return capi::kAbsent;
  switch (signal) {
    case STRIBECK_PLANT_ENCODER:
      return p->axis->encoder();
    case STRIBECK_PLANT_POSITION:
      return p->axis->position();
    case STRIBECK_PLANT_VELOCITY:
      return p->axis->velocity();
    case STRIBECK_PLANT_FRICTION:
      return p->axis->friction_force();
    case STRIBECK_PLANT_VOLTAGE:
      return p->axis->voltage();
    case STRIBECK_PLANT_FORCE_PER_VOLT:
      return p->force_gain;
    case STRIBECK_PLANT_FORCE_LIMIT:
      return p->force_gain * p->range;
    case STRIBECK_PLANT_FORCE:
      return p->axis->force();
  }
  return capi::kAbsent;
}

}  // extern "C"
