// Steps of the C interface by law, for valgrind's callgrind, which counts the instructions of each step by itself. Unlike times, they do
// not depend on what else the computer does. Run by tools/count-instructions.
#include <stribeck/stribeck.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#if __has_include(<valgrind/callgrind.h>)
#include <valgrind/callgrind.h>
#else
#define CALLGRIND_DUMP_STATS_AT(name) static_cast<void>(name)
#endif

namespace {

constexpr std::uint32_t kAxes = 2;
constexpr double kPeriod = 1e-3;
constexpr double kLap = 0.6283185307179586;  // of a circle at 10 rad/s [s]

void must(bool good, const char* what, const stribeck_controller* c) {
  if (good) return;
  std::fprintf(stderr, "step_instructions: %s: %s\n", what,
               c == nullptr ? "" : stribeck_controller_problem(c));
  std::exit(1);
}

stribeck_controller* controller(const char* law, bool everything) {
  const std::size_t size = stribeck_controller_size_for(kAxes, law);
  const std::size_t alignment = stribeck_alignment();
  stribeck_controller* const c = stribeck_controller_init(
      std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment), size, kAxes);
  must(c != nullptr, law, nullptr);
  for (std::uint32_t axis = 0; axis < kAxes; ++axis) {
    const auto set = [&](const char* name, double value) {
      must(stribeck_controller_set(c, axis, name, value) == STRIBECK_OK, name, c);
    };
    const auto choose = [&](const char* name, const char* word) {
      must(stribeck_controller_choose(c, axis, name, word) == STRIBECK_OK, name, c);
    };
    choose("law", law);
    set("mass", 800.0);
    set("omega", 60.0);
    set("force_limit", 2500.0);
    set("friction.conventional.alpha0", 14.0);
    set("friction.conventional.alpha2", 4000.0);
    if (std::strcmp(law, "learning") == 0) set("learning.lap", kLap);
    choose("feedforward", everything ? "dynamic" : "steady");
    if (!everything) continue;
    choose("friction.dynamics", "lugre");
    set("friction.lugre.sigma0", 7.2e6);
    set("friction.lugre.sigma1", 84850.0);
    choose("observer", "kalman");
    set("adaptation.enabled", 1.0);
    choose("supervision.checks", "all");
    set("supervision.speed_limit", 0.5);
    set("supervision.acceleration_limit", 5.0);
  }
  must(stribeck_controller_configure(c, kPeriod) == STRIBECK_OK, law, c);
  return c;
}

/// A circle of 10 mm; the plant is a mass with friction.
void run(const char* law, bool everything, int steps) {
  stribeck_controller* const c = controller(law, everything);
  const std::string name = std::string(law) + (everything ? " everything" : " plain");
  double x[kAxes] = {10e-3, 0.0};
  double v[kAxes] = {0.0, 0.1};
  for (int k = 0; k < steps; ++k) {
    const double a = 10.0 * k * kPeriod;
    stribeck_axis_input in[kAxes];
    for (std::uint32_t i = 0; i < kAxes; ++i) {
      const double at = a - (i == 0 ? 0.0 : std::acos(0.0));
      in[i] = {10e-3 * std::cos(at), -0.1 * std::sin(at), -std::cos(at), 1e-7 * std::round(1e7 * x[i])};
    }
    double force[kAxes];
    stribeck_controller_set_phase(c, k * kPeriod);
    const stribeck_result result = stribeck_controller_step(c, in, force);
    CALLGRIND_DUMP_STATS_AT(name.c_str());
    must(result == STRIBECK_OK, law, c);
    for (std::uint32_t i = 0; i < kAxes; ++i) {
      v[i] += kPeriod * (force[i] - 14.0 * std::tanh(v[i] / 1e-4) - 4000.0 * v[i]) / 820.0;
      x[i] += kPeriod * v[i];
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int steps = argc > 1 ? std::atoi(argv[1]) : 700;
  const char* law = nullptr;
  for (std::uint32_t i = 0; (law = stribeck_controller_parameter_word("law", i)) != nullptr; ++i) {
    for (const bool everything : {false, true}) run(law, everything, steps);
  }
  return 0;
}
