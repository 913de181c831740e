// The HAL components as LinuxCNC's loader takes them, with a HAL of this test in place of its own: loading, a closed loop of
// stribeck_axis and stribeck_plant, and every fault. hal/run does the same under LinuxCNC itself.
#include <dlfcn.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <initializer_list>
#include <limits>
#include <map>
#include <memory>
#include <new>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace {
/// Allocations until there is no memory; below 0: there is always some.
int allocations_left = -1;
}  // namespace

// NOLINTBEGIN: replacing the global operators is the point; the components call these.
[[gnu::noinline]] void* operator new(std::size_t size) {
  if (allocations_left == 0) throw std::bad_alloc();
  if (allocations_left > 0) --allocations_left;
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept { std::free(p); }
// NOLINTEND

namespace {

/// What the components have asked for.
struct Hal {
  std::vector<std::unique_ptr<char[]>> memory;
  std::map<std::string, volatile double*> floats;
  std::map<std::string, volatile int*> integers;
  std::map<std::string, volatile bool*> bits;
  std::map<std::string, std::pair<void (*)(void*, long), void*>> functions;
  std::string messages;
  int components = 0;
  long long clock = 1;  ///< [ns]

  void* allocate(long size) {
    memory.emplace_back(new char[static_cast<std::size_t>(size) + 16]());
    return memory.back().get();
  }
};
Hal* hal = nullptr;

/// What hal_malloc() gave: HAL takes nothing back, whatever is unloaded.
std::vector<std::unique_ptr<char[]>>& kept_memory() {
  static auto* const kept = new std::vector<std::unique_ptr<char[]>>;
  return *kept;
}

std::string printed(const char* format, va_list arguments) {
  char text[200];
  std::vsnprintf(text, sizeof text, format, arguments);
  return text;
}

}  // namespace

// NOLINTBEGIN: names and arguments of LinuxCNC's hal.h and rtapi.h
extern "C" {
int hal_init(const char*) { return ++hal->components; }
int hal_exit(int) { return --hal->components, 0; }
int hal_ready(int) { return 0; }
void* hal_malloc(long size) {
  kept_memory().emplace_back(new char[static_cast<std::size_t>(size) + 16]());
  return kept_memory().back().get();
}
#define STRIBECK_NAME                                  \
  va_list arguments;                                   \
  va_start(arguments, format);                         \
  const std::string name = printed(format, arguments); \
  va_end(arguments);                                   \
  if (name.size() > 47) return -22
int hal_pin_float_newf(int, volatile double** pin, int, const char* format, ...) {
  STRIBECK_NAME;
  *pin = static_cast<double*>(hal->allocate(sizeof(double)));
  return hal->floats.emplace(name, *pin).second ? 0 : -22;
}
int hal_pin_s32_newf(int, volatile int** pin, int, const char* format, ...) {
  STRIBECK_NAME;
  *pin = static_cast<int*>(hal->allocate(sizeof(int)));
  return hal->integers.emplace(name, *pin).second ? 0 : -22;
}
int hal_pin_bit_newf(int, volatile bool** pin, int, const char* format, ...) {
  STRIBECK_NAME;
  *pin = static_cast<bool*>(hal->allocate(sizeof(bool)));
  return hal->bits.emplace(name, *pin).second ? 0 : -22;
}
int hal_param_float_newf(int, volatile double* value, int, const char* format, ...) {
  STRIBECK_NAME;
  return hal->floats.emplace(name, value).second ? 0 : -22;
}
int hal_param_s32_newf(int, volatile int* value, int, const char* format, ...) {
  STRIBECK_NAME;
  return hal->integers.emplace(name, value).second ? 0 : -22;
}
int hal_param_bit_newf(int, volatile bool* value, int, const char* format, ...) {
  STRIBECK_NAME;
  return hal->bits.emplace(name, value).second ? 0 : -22;
}
long long rtapi_get_time() { return hal->clock; }
int hal_export_funct(const char* name, void (*f)(void*, long), void* argument, int, int, int) {
  return hal->functions.emplace(name, std::pair(f, argument)).second ? 0 : -22;
}
void rtapi_print_msg(int, const char* format, ...) {
  allocations_left = -1;
  va_list arguments;
  va_start(arguments, format);
  hal->messages += printed(format, arguments);
  va_end(arguments);
}
int rtapi_snprintf(char* text, unsigned long size, const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  const int n = std::vsnprintf(text, size, format, arguments);
  va_end(arguments);
  return n;
}
}
// NOLINTEND

namespace {

constexpr long kPeriodNs = 1'000'000;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

using Names = std::initializer_list<const char*>;

/// A component between loadrt and unloadrt.
class Module {
 public:
  Module(const std::string& file, Names names, int axes = 0)
      : handle_(dlopen(file.c_str(), RTLD_NOW | RTLD_GLOBAL)) {
    if (handle_ == nullptr) throw std::runtime_error(dlerror());
    char** to = *static_cast<char***>(dlsym(handle_, "rtapi_info_address_names"));
    for (const char* name : names) *to++ = const_cast<char*>(name);
    if (axes != 0) **static_cast<int**>(dlsym(handle_, "rtapi_info_address_axes")) = axes;
    result = reinterpret_cast<int (*)()>(dlsym(handle_, "rtapi_app_main"))();
  }
  ~Module() {
    if (result == 0) reinterpret_cast<void (*)()>(dlsym(handle_, "rtapi_app_exit"))();
    dlclose(handle_);
  }
  Module(const Module&) = delete;
  Module& operator=(const Module&) = delete;

  int result = -1;

 private:
  void* handle_;
};

class Components : public testing::Test {
 protected:
  void SetUp() override { hal = &hal_; }
  void TearDown() override { EXPECT_EQ(hal_.components, 0); }

  volatile double& value(const std::string& name) {
    const auto at = hal_.floats.find(name);
    if (at == hal_.floats.end()) throw std::runtime_error("no pin or parameter " + name);
    return *at->second;
  }
  int fault(const std::string& axis) { return *hal_.integers.at(axis + ".fault"); }
  void call(const std::string& function) {
    const auto& [f, argument] = hal_.functions.at(function);
    f(argument, kPeriodNs);
  }

  Hal hal_;
};

/// stribeck_axis on stribeck_plant: a mass of 1000 kg with friction that the controller knows roughly.
class Loop : public Components {
 protected:
  void SetUp() override {
    Components::SetUp();
    axis_ = std::make_unique<Module>(STRIBECK_HAL_AXIS, Names{"ax.x"});
    plant_ = std::make_unique<Module>(STRIBECK_HAL_PLANT, Names{"pl.x"});
    ASSERT_EQ(axis_->result, 0);
    ASSERT_EQ(plant_->result, 0);
    for (const char* who : {"ax.x", "pl.x"}) {
      const std::string at = std::string(who) + ".";
      value(at + "mass") = 1000.0;
      value(at + "friction.conventional.alpha0") = 18.0;
      value(at + "friction.conventional.alpha2") = 4500.0;
      value(at + "friction.dynamics") = 1.0;
      value(at + "friction.lugre.sigma0") = 7.2e6;
    }
    value("pl.x.current.gain") = 25.0;
    value("pl.x.encoder.resolution") = 1e-7;
    value("ax.x.omega") = 60.0;
    value("ax.x.feedforward") = 2.0;
    value("ax.x.force-limit") = 250.0;
  }
  void TearDown() override {
    axis_.reset();
    plant_.reset();
    Components::TearDown();
  }

  /// One servo period: 10 mm · sin(t) when moving, and what the test does to the encoder.
  void period(bool moving = true) {
    if (moving) t_ += 1e-3;
    value("ax.x.pos-cmd") = 10.0 * std::sin(t_);
    value("ax.x.vel-cmd") = moving ? 10.0 * std::cos(t_) : 0.0;
    value("ax.x.acc-cmd") = moving ? -10.0 * std::sin(t_) : 0.0;
    const double encoder = value("pl.x.pos-fb");
    if (!frozen_) feedback_ = encoder;
    value("ax.x.pos-fb") = feedback_ + added_;
    call("ax.x");
    const double force = value("ax.x.force");
    ASSERT_TRUE(std::isfinite(force));
    ASSERT_LE(std::abs(force), 250.0);
    for (const char* pin : {"ax.x.voltage", "ax.x.friction-ff", "ax.x.disturbance", "ax.x.pos-error"})
      ASSERT_TRUE(std::isfinite(value(pin))) << pin;
    value("pl.x.force") = force;
    call("pl.x");
    hal_.clock += kPeriodNs;
  }
  void run(int periods, bool moving = true) {
    for (int k = 0; k < periods && !HasFatalFailure(); ++k) period(moving);
  }
  void enable(bool on) { *hal_.bits.at("ax.x.enable") = on; }
  /// From a fault on: the force goes to zero within the ramp's 20 ms, stays there, and the fault stays.
  void expect_ramp_and_latch(int code) {
    double last = std::abs(value("ax.x.force"));
    for (int k = 0; k < 25; ++k) {
      period();
      const double now = std::abs(value("ax.x.force"));
      EXPECT_LE(now, last + 1e-12) << k;
      last = now;
    }
    EXPECT_EQ(last, 0.0);
    EXPECT_EQ(fault("ax.x"), code);
    EXPECT_TRUE(*hal_.bits.at("ax.x.faulted"));
    added_ = 0.0;
    frozen_ = false;
    enable(false);
    run(5);
    EXPECT_EQ(fault("ax.x"), code) << "latched";
    // Enabled again where it stands, it goes on.
    t_ = std::asin(std::clamp<double>(value("pl.x.pos-fb") / 10.0, -1.0, 1.0));
    enable(true);
    run(200, false);
    EXPECT_EQ(fault("ax.x"), 0);
    EXPECT_FALSE(*hal_.bits.at("ax.x.faulted"));
    // A loop without integrator: friction of 18 N holds it 18 N/(1000 kg·60²/s²) = 5 um away, and the encoder's step.
    EXPECT_LT(std::abs(value("ax.x.pos-error")), 6e-3);
  }

  std::unique_ptr<Module> axis_;
  std::unique_ptr<Module> plant_;
  double t_ = 0.0;
  double feedback_ = 0.0;
  double added_ = 0.0;
  bool frozen_ = false;
};

TEST_F(Components, LoadAndUnloadAHundredTimes) {
  const auto resident = [] {
    std::ifstream file("/proc/self/statm");
    long pages = 0;
    file >> pages >> pages;
    return pages;
  };
  long before = 0;
  std::size_t taken = 0;
  for (int k = 0; k < 110; ++k) {
    if (k == 10) before = resident();
    if (k == 1) taken = kept_memory().size();
    {
      const Module axis(STRIBECK_HAL_AXIS, {"ax.x"});
      const Module contour(STRIBECK_HAL_CONTOUR, {"ct"});
      const Module plant(STRIBECK_HAL_PLANT, {"pl.x"});
      ASSERT_EQ(axis.result, 0);
      ASSERT_EQ(contour.result, 0);
      ASSERT_EQ(plant.result, 0);
      value("pl.x.mass") = 1.0;
      value("pl.x.current.gain") = 1.0;
      value("pl.x.encoder.resolution") = 1e-6;
      value("pl.x.friction.conventional.alpha0") = 1.0;
      value("pl.x.friction.dynamics") = 1.0;
      value("pl.x.friction.lugre.sigma0") = 1e5;
      call("ax.x");
      call("ct");
      call("pl.x");
      ASSERT_TRUE(*hal_.bits.at("pl.x.ok")) << hal_.messages;
    }
    hal_ = {};
  }
  // Ten pages for what the allocator keeps.
  EXPECT_LE(resident(), before + 10);
  EXPECT_EQ(kept_memory().size(), taken) << "a component takes HAL memory each time that it is loaded";
}

TEST_F(Components, RefuseToLoadAndSayWhy) {
  const auto expect = [&](const char* file, Names names, int axes, const char* message) {
    hal_.messages.clear();
    {
      const Module module(file, names, axes);
      EXPECT_LT(module.result, 0) << message;
    }
    EXPECT_EQ(hal_.messages, message);
    EXPECT_TRUE(hal_.floats.empty());
  };
  expect(STRIBECK_HAL_AXIS, {"a-long-name"}, 0,
         "stribeck_axis: names: \"a-long-name\" is too long, expected at most 6 letters\n");
  expect(STRIBECK_HAL_CONTOUR, {"ct", "conto"}, 0,
         "stribeck_contour: names: \"conto\" is too long, expected at most 4 letters\n");
  expect(STRIBECK_HAL_AXIS, {}, 0, "stribeck_axis: no names, expected e.g. loadrt stribeck_axis names=a,b\n");
  expect(STRIBECK_HAL_PLANT, {"pl.x", "pl.y", "pl.x"}, 0, "stribeck_plant: names: \"pl.x\" is there twice\n");
  expect(STRIBECK_HAL_PLANT, {"pl.x", "", "pl.y"}, 0, "stribeck_plant: names: \"\" is empty\n");
  for (const int axes : {1, 4}) {
    expect(STRIBECK_HAL_CONTOUR, {"ct"}, axes,
           ("stribeck_contour: axes: got " + std::to_string(axes) +
            ", expected 2 or 3 (one axis: stribeck_axis)\n")
               .c_str());
  }
}

TEST_F(Loop, FollowsASineWithinAMicrometre) {
  run(10, false);
  EXPECT_EQ(value("ax.x.force"), 0.0) << "not enabled";
  enable(true);
  double worst = 0.0;
  for (int k = 0; k < 7000; ++k) {
    period();
    if (k > 500) worst = std::max<double>(worst, std::abs(value("ax.x.pos-error")));
  }
  // The model is the plant's own; what is left are the hold and the encoder.
  EXPECT_LT(worst, 1e-3);
  EXPECT_EQ(fault("ax.x"), 0);
  EXPECT_GT(std::abs(value("ax.x.friction-ff")), 18.0);
}

TEST_F(Loop, NanOnTheEncoder) {
  enable(true);
  run(700);
  added_ = kNan;
  period();
  EXPECT_EQ(fault("ax.x"), 1);
  expect_ramp_and_latch(1);
}

// A drive that takes a position goes where it is told: of an encoder that has failed it was told 0, or the wild sample itself.
TEST_F(Loop, ADriveThatTakesPositionsIsNotSentToABadSample) {
  value("ax.x.drive-loop.mode") = 1.0;
  value("ax.x.drive-loop.gain") = 1e5;
  value("ax.x.drive-loop.position-gain") = 50.0;
  value("ax.x.drive-loop.velocity-feedforward") = 1.0;
  const auto sample = [&](double encoder) {
    value("ax.x.pos-cmd") = 350.0;
    for (const char* pin : {"ax.x.vel-cmd", "ax.x.acc-cmd"}) value(pin) = 0.0;
    value("ax.x.pos-fb") = encoder;
    call("ax.x");
    return value("ax.x.command");
  };
  for (const double bad : {kNan, 850.0, -std::numeric_limits<double>::infinity()}) {
    enable(false);
    EXPECT_NEAR(sample(350.0), 350.0, 1e-9) << "told where it is while it is off";
    enable(true);
    for (int k = 0; k < 20; ++k) EXPECT_NEAR(sample(350.0), 350.0, 0.01);
    for (int k = 0; k < 5; ++k) EXPECT_NEAR(sample(bad), 350.0, 0.01) << bad << ' ' << k;
    EXPECT_EQ(fault("ax.x"), bad > 0.0 ? 3 : 1) << hal_.messages;
  }
  enable(false);
  sample(350.0);
  EXPECT_NEAR(sample(351.0 - 0.9), 350.1, 1e-9) << "moved by hand";
}

TEST_F(Loop, NanOnTheCommand) {
  enable(true);
  run(700);
  t_ = kNan;
  period();
  EXPECT_EQ(fault("ax.x"), 2);
  expect_ramp_and_latch(2);
}

TEST_F(Loop, JumpOfAMillimetre) {
  enable(true);
  run(700);
  added_ = 1.0;
  period();
  expect_ramp_and_latch(3);
}

TEST_F(Loop, FrozenEncoder) {
  enable(true);
  run(700);
  frozen_ = true;
  // 7.6 mm/s: 0.2 mm are 26 periods.
  run(20);
  EXPECT_EQ(fault("ax.x"), 0);
  run(10);
  EXPECT_EQ(fault("ax.x"), 4);
  expect_ramp_and_latch(4);
}

TEST_F(Loop, FollowingError) {
  value("ax.x.ferror-limit") = 0.05;
  enable(true);
  run(700);
  // A slip of the coupling, slower than a jump.
  for (int k = 0; k < 100 && fault("ax.x") == 0; ++k) {
    added_ += 0.01;
    period();
  }
  expect_ramp_and_latch(5);
}

TEST_F(Loop, WithTheLibrarysSupervisionAWildSampleIsBridgedAndAFrozenEncoderBrakes) {
  value("ax.x.supervision.checks") = 2.0;
  value("ax.x.supervision.speed-limit") = 16e-3;
  value("ax.x.supervision.acceleration-limit") = 0.1;
  enable(true);
  run(700);
  // Below the jump limit of 0.5 mm: the component itself would let it through.
  const double before = value("ax.x.force");
  added_ = 0.3;
  period();
  added_ = 0.0;
  EXPECT_NEAR(value("ax.x.force"), before, 20.0);
  run(200);
  EXPECT_LT(std::abs(value("ax.x.pos-error")), 2e-3);
  EXPECT_EQ(fault("ax.x"), 0);
  EXPECT_EQ(*hal_.integers.at("ax.x.bridged"), 1);
  EXPECT_FALSE(*hal_.bits.at("ax.x.brake"));
  // At 6 mm/s; before the component's own limit of 0.2 mm.
  const double at = value("pl.x.pos");
  frozen_ = true;
  run(11);
  EXPECT_EQ(fault("ax.x"), 103);
  EXPECT_TRUE(*hal_.bits.at("ax.x.faulted"));
  EXPECT_TRUE(*hal_.bits.at("ax.x.brake"));
  run(100);
  EXPECT_EQ(value("ax.x.force"), 0.0);
  EXPECT_LT(std::abs(value("pl.x.pos") - at), 0.5);
  EXPECT_EQ(fault("ax.x"), 103) << "latched";
  frozen_ = false;
  enable(false);
  run(25, false);
  t_ = std::asin(std::clamp<double>(value("pl.x.pos-fb") / 10.0, -1.0, 1.0));
  enable(true);
  run(200, false);
  EXPECT_EQ(fault("ax.x"), 0);
  EXPECT_FALSE(*hal_.bits.at("ax.x.brake"));
}

/// A weight of 150 N on the axis of Loop, which the controller knows.
class Weight : public Loop {
 protected:
  void SetUp() override {
    Loop::SetUp();
    value("ax.x.load") = 150.0;
    value("pl.x.load") = 150.0;
    value("ax.x.supervision.checks") = 2.0;
    value("ax.x.supervision.speed-limit") = 16e-3;
    value("ax.x.supervision.acceleration-limit") = 0.1;
    enable(true);
    run(400, false);
    ASSERT_EQ(fault("ax.x"), 0) << hal_.messages;
    ASSERT_FALSE(*hal_.bits.at("ax.x.brake"));
    rest_ = value("pl.x.pos");
  }
  [[nodiscard]] double sag() { return rest_ - value("pl.x.pos"); }

  double rest_ = 0.0;
};

// The component took one sample that is NaN for a fault and let the axis go: 20 mm in 100 ms, where the library bridges it.
TEST_F(Weight, ASampleThatIsNanIsLeftToTheLibrary) {
  added_ = kNan;
  period(false);
  added_ = 0.0;
  run(200, false);
  EXPECT_EQ(fault("ax.x"), 0);
  EXPECT_EQ(*hal_.integers.at("ax.x.bridged"), 1);
  EXPECT_LT(std::abs(sag()), 5e-3);
  // The same on the command.
  const double t = t_;
  t_ = kNan;
  period(false);
  t_ = t;
  run(200, false);
  EXPECT_EQ(fault("ax.x"), 0);
  EXPECT_LT(std::abs(sag()), 5e-3);
}

TEST_F(Weight, ALostEncoderIsTheLibrarysFaultAndTheLoadIsHeldUntilTheBrakeHasClosed) {
  added_ = kNan;
  run(11, false);
  EXPECT_EQ(fault("ax.x"), 101);
  EXPECT_TRUE(*hal_.bits.at("ax.x.brake"));
  run(100, false);
  EXPECT_NEAR(value("ax.x.force"), 150.0, 1e-9);
  // LinuxCNC answers `faulted` by taking enable away.
  enable(false);
  run(195, false);
  EXPECT_NEAR(value("ax.x.force"), 150.0, 1e-9);
  EXPECT_LT(std::abs(sag()), 0.05);
  run(30, false);
  EXPECT_EQ(value("ax.x.force"), 0.0);
}

TEST_F(Weight, AFaultOfTheComponentRampsToTheLoadAndHoldsIt) {
  added_ = 1.0;  // beyond the jump limit
  period(false);
  EXPECT_EQ(fault("ax.x"), 3);
  EXPECT_TRUE(*hal_.bits.at("ax.x.brake"));
  run(300, false);
  EXPECT_NEAR(value("ax.x.force"), 150.0, 1e-9) << "while enable stays";
  EXPECT_LT(std::abs(sag()), 0.05);
  enable(false);
  run(195, false);
  EXPECT_NEAR(value("ax.x.force"), 150.0, 1e-9);
  run(30, false);
  EXPECT_EQ(value("ax.x.force"), 0.0);
}

TEST_F(Weight, DisabledItHoldsTheLoadForBrakeTime) {
  value("ax.x.brake-time") = 0.05;
  enable(false);
  period(false);
  EXPECT_TRUE(*hal_.bits.at("ax.x.brake"));
  run(45, false);
  EXPECT_NEAR(value("ax.x.force"), 150.0, 1e-9);
  EXPECT_LT(std::abs(sag()), 5e-3);
  double last = 150.0;
  for (int k = 0; k < 35; ++k) {
    period(false);
    EXPECT_LE(value("ax.x.force"), last);
    EXPECT_GE(value("ax.x.force"), last - 150.0 / 20.0 - 1e-9) << "in the ramp's 20 ms";
    last = value("ax.x.force");
  }
  EXPECT_EQ(last, 0.0);
}

TEST_F(Weight, WithoutTheLibrarysChecksNanIsTheComponentsFaultAndTheLoadIsHeldAsWell) {
  enable(false);
  run(300, false);
  value("ax.x.supervision.checks") = 1.0;
  t_ = std::asin(std::clamp<double>(value("pl.x.pos-fb") / 10.0, -1.0, 1.0));
  enable(true);
  run(300, false);
  ASSERT_EQ(fault("ax.x"), 0) << hal_.messages;
  added_ = kNan;
  period(false);
  EXPECT_EQ(fault("ax.x"), 1);
  run(100, false);
  EXPECT_NEAR(value("ax.x.force"), 150.0, 1e-9);
}

TEST_F(Weight, ParametersThatAreRefusedGiveNoForce) {
  enable(false);
  run(300, false);
  value("ax.x.mass") = -1.0;
  enable(true);
  for (int k = 0; k < 50; ++k) {
    period(false);
    EXPECT_EQ(value("ax.x.force"), 0.0) << k;
  }
  EXPECT_EQ(fault("ax.x"), 6);
}

TEST_F(Loop, AMissedCycleIsNoMotionOfTwoPeriods) {
  value("ax.x.observer") = 3.0;
  value("ax.x.adaptive-gain") = 40.0;
  *hal_.bits.at("ax.x.watch-lateness") = true;
  enable(true);
  run(700);
  const double before = value("ax.x.force");
  // A cycle in which nothing but the drive goes on.
  t_ += 1e-3;
  call("pl.x");
  hal_.clock += kPeriodNs;
  period();
  EXPECT_NEAR(value("ax.x.force"), before, 30.0) << "m·v/T of a period more would be 300 N";
  run(50);
  EXPECT_EQ(fault("ax.x"), 0);
}

TEST_F(Loop, LateCyclesAreAFaultOfTheLibraryWhereTheyAreWatched) {
  value("ax.x.supervision.checks") = 2.0;
  enable(true);
  run(700);
  hal_.clock += 20 * kPeriodNs;
  period();
  EXPECT_EQ(fault("ax.x"), 0) << "virtual time passes in periods";
  *hal_.bits.at("ax.x.watch-lateness") = true;
  hal_.clock += 20 * kPeriodNs;
  period();
  EXPECT_EQ(fault("ax.x"), 110);
}

TEST_F(Loop, OffsetIsInForceUnitAndAForceDriveHasNoCommand) {
  enable(true);
  run(300);
  EXPECT_EQ(value("ax.x.command"), 0.0);
  enable(false);
  run(30);
  value("ax.x.drive-loop.mode") = 0.0;
  value("ax.x.drive-loop.gain") = 1e5;
  value("ax.x.drive-loop.force-offset") = 1.0;
  double offset = 0.0;
  for (const double unit : {1.0, 10.0}) {
    value("ax.x.force-unit") = unit;
    for (const char* pin : {"ax.x.pos-cmd", "ax.x.pos-fb", "ax.x.vel-cmd", "ax.x.acc-cmd"}) value(pin) = 0.0;
    for (int k = 0; k < 100; ++k) call("ax.x");
    t_ = 0.0;
    enable(true);
    for (int k = 0; k < 100; ++k) {
      t_ += 1e-3;
      for (const char* pin : {"ax.x.pos-cmd", "ax.x.pos-fb"}) value(pin) = 10.0 * std::sin(t_);
      value("ax.x.vel-cmd") = 10.0 * std::cos(t_);
      value("ax.x.acc-cmd") = -10.0 * std::sin(t_);
      call("ax.x");
    }
    ASSERT_EQ(fault("ax.x"), 0) << hal_.messages;
    if (unit == 1.0) offset = value("ax.x.offset");
    EXPECT_NEAR(value("ax.x.offset"), offset / unit, 1e-9);
    EXPECT_GT(std::abs(offset), 5.0);
    enable(false);
  }
}

TEST_F(Loop, RefusedParameters) {
  value("ax.x.mass") = -1.0;
  enable(true);
  period(false);
  EXPECT_EQ(value("ax.x.force"), 0.0);
  EXPECT_EQ(fault("ax.x"), 6);
  EXPECT_NE(hal_.messages.find("mass: the value is out of range"), std::string::npos) << hal_.messages;
  value("ax.x.mass") = 1000.0;
  run(5, false);
  EXPECT_EQ(fault("ax.x"), 6) << "latched";
  enable(false);
  period(false);
  enable(true);
  run(5, false);
  EXPECT_EQ(fault("ax.x"), 0);
}

TEST_F(Loop, OwnParametersThatMeanNothingAreRefusedByName) {
  const std::map<std::string, double> bad{
      {"position-unit", 0.0}, {"force-unit", -1.0},
      {"ramp-time", kNan},    {"ramp-time", std::numeric_limits<double>::infinity()},
      {"ferror-limit", kNan}, {"jump-limit", 0.0},
      {"frozen-limit", -1.0}, {"force-per-volt", kNan}};
  for (const auto& [name, x] : bad) {
    const double before = value("ax.x." + name);
    value("ax.x." + name) = x;
    hal_.messages.clear();
    enable(true);
    run(5, false);
    EXPECT_EQ(fault("ax.x"), 6) << name;
    EXPECT_EQ(value("ax.x.force"), 0.0) << name;
    EXPECT_NE(hal_.messages.find(name + ": got "), std::string::npos) << name << ": " << hal_.messages;
    value("ax.x." + name) = before;
    enable(false);
    period(false);
    enable(true);
    run(5, false);
    EXPECT_EQ(fault("ax.x"), 0) << name;
    enable(false);
    run(25, false);
  }
}

TEST_F(Loop, AnEndlessRampIsNone) {
  enable(true);
  run(700);
  value("ax.x.ramp-time") = std::numeric_limits<double>::infinity();
  value("ax.x.ferror-limit") = 1e-9;
  period();
  EXPECT_EQ(fault("ax.x"), 5);
  period();
  EXPECT_EQ(value("ax.x.force"), 0.0);
}

TEST_F(Loop, ADriveThatLeavesAllBoundsIsOffUntilAParameterChanges) {
  value("pl.x.cutting") = 1e300;
  for (int k = 0; k < 50; ++k) call("pl.x");
  EXPECT_FALSE(*hal_.bits.at("pl.x.ok"));
  EXPECT_TRUE(std::isfinite(value("pl.x.pos")));
  EXPECT_NE(hal_.messages.find("left all bounds"), std::string::npos) << hal_.messages;
  value("pl.x.cutting") = 0.0;
  *hal_.integers.at("pl.x.seed") = 2;
  call("pl.x");
  EXPECT_TRUE(*hal_.bits.at("pl.x.ok")) << hal_.messages;
  EXPECT_NEAR(value("pl.x.pos"), 0.0, 1e-3);
}

TEST_F(Loop, ALimitThatBecomesNanWhileItRunsIsExceeded) {
  enable(true);
  run(700);
  value("ax.x.ferror-limit") = kNan;
  period();
  EXPECT_EQ(fault("ax.x"), 5);
  value("ax.x.ferror-limit") = 1.0;
  expect_ramp_and_latch(5);
}

TEST_F(Loop, UnitsWaitForTheNextEnable) {
  enable(true);
  run(700);
  const double force = value("ax.x.force");
  value("ax.x.force-unit") = 1e3;
  value("ax.x.position-unit") = 1.0;
  period();
  EXPECT_NEAR(value("ax.x.force"), force, 30.0) << "a step or two of the encoder";
  EXPECT_EQ(fault("ax.x"), 0);
  EXPECT_TRUE(*hal_.bits.at("ax.x.pending"));
  enable(false);
  run(50);
  const double here = 1e-3 * value("pl.x.pos-fb");
  for (const char* pin : {"ax.x.pos-cmd", "ax.x.pos-fb"}) value(pin) = here;
  for (const char* pin : {"ax.x.vel-cmd", "ax.x.acc-cmd"}) value(pin) = 0.0;
  enable(true);
  call("ax.x");
  EXPECT_EQ(fault("ax.x"), 0);
  EXPECT_FALSE(*hal_.bits.at("ax.x.pending"));
  value("ax.x.pos-cmd") = here + 1e-4;
  for (int k = 0; k < 3; ++k) call("ax.x");
  // 1000 kg·60²/s²·0.1 mm is 360 N, cut at 250 N; in kN.
  EXPECT_NEAR(value("ax.x.force"), 0.25, 1e-9);
}

TEST_F(Loop, EnableToggledAtSpeed) {
  enable(true);
  run(700);
  for (int k = 0; k < 5; ++k) {
    enable(false);
    double last = std::abs(value("ax.x.force"));
    for (int i = 0; i < 25; ++i) {
      period();
      EXPECT_LE(std::abs(value("ax.x.force")), last + 1e-12);
      last = std::abs(value("ax.x.force"));
    }
    EXPECT_EQ(last, 0.0);
    // LinuxCNC's command follows the axis while it is off.
    t_ = std::asin(value("pl.x.pos-fb") / 10.0);
    enable(true);
    period();
    // Bumpless, from the first period on: friction and acceleration of the motion that is asked for, and what the way that was lost
    // takes to make up for.
    for (int i = 0; i < 200; ++i) {
      period();
      EXPECT_LT(std::abs(value("ax.x.force")), 120.0) << k << ' ' << i;
    }
    EXPECT_EQ(fault("ax.x"), 0);
  }
}

TEST_F(Loop, EnabledFarFromTheCommandItGoesThereGently) {
  for (int k = 0; k < 5; ++k) period(false);
  t_ = 0.01;  // 0.1 mm, which would be 360 N at once
  enable(true);
  // 0.1 mm within 50 ms: m·o/τ² = 40 N, and friction.
  for (int k = 0; k < 300; ++k) {
    period(false);
    EXPECT_LT(std::abs(value("ax.x.force")), 60.0) << k;
  }
  run(700, false);
  EXPECT_LT(std::abs(value("ax.x.pos-error")), 5e-3);
}

TEST_F(Loop, EnabledWhileItCoastsItIsStoppedGently) {
  enable(true);
  run(700);
  enable(false);
  run(25);
  ASSERT_EQ(value("ax.x.force"), 0.0);
  // LinuxCNC's command is where the axis is, and stands; the axis goes on at some 6 mm/s, which by k_v alone would be 720 N at once; 2m·v/τ is 240 N.
  t_ = std::asin(value("pl.x.pos-fb") / 10.0);
  enable(true);
  for (int k = 0; k < 300; ++k) {
    period(false);
    EXPECT_LT(std::abs(value("ax.x.force")), 200.0) << k;
  }
  EXPECT_EQ(fault("ax.x"), 0);
  EXPECT_LT(std::abs(value("ax.x.pos-error")), 5e-3);
}

TEST_F(Loop, SaturatedOutput) {
  value("ax.x.force-limit") = 40.0;
  value("ax.x.observer") = 1.0;
  enable(true);
  int saturated = 0;
  for (int k = 0; k < 2000; ++k) {
    period();
    ASSERT_LE(std::abs(value("ax.x.force")), 40.0);
    if (*hal_.bits.at("ax.x.saturated")) ++saturated;
  }
  EXPECT_GT(saturated, 100);
  EXPECT_TRUE(fault("ax.x") == 0 || fault("ax.x") == 5);
}

TEST_F(Loop, ParametersWaitForTheNextEnable) {
  enable(true);
  run(100);
  EXPECT_FALSE(*hal_.bits.at("ax.x.pending"));
  value("ax.x.omega") = 30.0;
  run(2);
  EXPECT_TRUE(*hal_.bits.at("ax.x.pending"));
  enable(false);
  run(30, false);
  enable(true);
  run(2, false);
  EXPECT_FALSE(*hal_.bits.at("ax.x.pending"));
}

TEST_F(Components, ADriveWithoutMemorySaysSoAndNothingEscapes) {
  const Module plant(STRIBECK_HAL_PLANT, {"pl.x"});
  value("pl.x.mass") = 1.0;
  value("pl.x.current.gain") = 1.0;
  value("pl.x.encoder.resolution") = 1e-6;
  value("pl.x.friction.conventional.alpha0") = 1.0;
  value("pl.x.friction.dynamics") = 1.0;
  value("pl.x.friction.lugre.sigma0") = 1e5;
  // The memory ends at the first allocation, at the second, and so on. Whatever is thrown must stay inside.
  int needed = 0;
  for (; needed < 1000; ++needed) {
    value("pl.x.mass") = 1.0 + 1e-3 * needed;  // configured anew
    hal_.messages.clear();
    allocations_left = needed;
    hal_.functions.at("pl.x").first(hal_.functions.at("pl.x").second, kPeriodNs);
    allocations_left = -1;
    if (*hal_.bits.at("pl.x.ok")) break;
    EXPECT_NE(hal_.messages.find("out of memory"), std::string::npos) << needed << hal_.messages;
    call("pl.x");
  }
  EXPECT_GT(needed, 1);
  EXPECT_LT(needed, 1000);
}

TEST_F(Loop, TheDriveTakesOverWhatChanges) {
  enable(true);
  run(300);
  const double there = value("pl.x.pos");
  ASSERT_GT(there, 1.0);
  // Refused: it says so once, and nothing moves.
  hal_.messages.clear();
  *hal_.integers.at("pl.x.substeps") = 0;
  call("pl.x");
  call("pl.x");
  EXPECT_FALSE(*hal_.bits.at("pl.x.ok"));
  EXPECT_EQ(hal_.messages, "stribeck_plant: pl.x: substeps: expected 1 to 1000\n");
  *hal_.integers.at("pl.x.substeps") = 4;
  value("pl.x.force") = 0.0;
  call("pl.x");
  EXPECT_TRUE(*hal_.bits.at("pl.x.ok")) << hal_.messages;
  EXPECT_NEAR(value("pl.x.pos"), there, 1e-2) << "where it was";
  for (const double unit : {0.0, -1e-3, kNan}) {
    hal_.messages.clear();
    value("pl.x.position-unit") = unit;
    call("pl.x");
    EXPECT_FALSE(*hal_.bits.at("pl.x.ok"));
    EXPECT_NE(hal_.messages.find("position-unit: expected"), std::string::npos) << hal_.messages;
    EXPECT_NEAR(value("pl.x.pos"), there, 1e-2);
  }
  value("pl.x.position-unit") = 1e-3;
  value("pl.x.highest-speed") = 0.0;
  call("pl.x");
  EXPECT_FALSE(*hal_.bits.at("pl.x.ok"));
  value("pl.x.highest-speed") = 250.0;
  call("pl.x");
  value("pl.x.start") = -3.0;
  call("pl.x");
  EXPECT_TRUE(*hal_.bits.at("pl.x.ok")) << hal_.messages;
  EXPECT_NEAR(value("pl.x.pos"), -3.0, 1e-3) << "put at its start";
}

TEST_F(Components, TheSeedOfADriveIsTakenOver) {
  const Module plant(STRIBECK_HAL_PLANT, {"pl.x"});
  value("pl.x.mass") = 1.0;
  value("pl.x.current.gain") = 1.0;
  value("pl.x.encoder.resolution") = 1e-6;
  value("pl.x.friction.conventional.alpha0") = 1.0;
  value("pl.x.friction.dynamics") = 1.0;
  value("pl.x.friction.lugre.sigma0") = 1e5;
  value("pl.x.noise.rms") = 1.0;
  value("pl.x.start") = 2.0;
  call("pl.x");
  EXPECT_FALSE(*hal_.bits.at("pl.x.ok")) << "no time of correlation";
  value("pl.x.noise.correlation-time") = 1e-2;
  call("pl.x");
  EXPECT_NEAR(value("pl.x.pos"), 2.0, 1e-2) << "its start, though the first parameters were refused";
  const auto moved_with = [&](int seed) {
    *hal_.integers.at("pl.x.seed") = seed;
    value("pl.x.start") = value("pl.x.start") + 1.0;
    for (int k = 0; k < 50; ++k) call("pl.x");
    return value("pl.x.pos") - value("pl.x.start");
  };
  const double first = moved_with(1);
  ASSERT_TRUE(*hal_.bits.at("pl.x.ok")) << hal_.messages;
  const double second = moved_with(2);
  EXPECT_NE(first, second);
  EXPECT_NEAR(moved_with(1), first, 1e-12) << "the same seed, the same noise";
}

/// stribeck_contour on three drives.
class Path : public Components {
 protected:
  static constexpr std::array<const char*, 3> kDrives{"pl.x", "pl.y", "pl.z"};

  void SetUp() override {
    Components::SetUp();
    contour_ = std::make_unique<Module>(STRIBECK_HAL_CONTOUR, Names{"ct"});
    plants_ = std::make_unique<Module>(STRIBECK_HAL_PLANT, Names{"pl.x", "pl.y", "pl.z"});
    ASSERT_EQ(contour_->result, 0);
    ASSERT_EQ(plants_->result, 0);
    for (std::size_t i = 0; i < 3; ++i) {
      for (const std::string& at : {axis(i), std::string(kDrives[i]) + "."}) {
        value(at + "mass") = 900.0;
        value(at + "friction.conventional.alpha0") = 18.0;
        value(at + "friction.conventional.alpha2") = 4500.0;
        value(at + "friction.dynamics") = 1.0;
        value(at + "friction.lugre.sigma0") = 7.2e6;
      }
      value(std::string(kDrives[i]) + ".current.gain") = 25.0;
      value(std::string(kDrives[i]) + ".encoder.resolution") = 1e-7;
      value(axis(i) + "omega") = 60.0;
      value(axis(i) + "feedforward") = 2.0;
      value(axis(i) + "force-limit") = 200.0;
    }
  }
  void TearDown() override {
    contour_.reset();
    plants_.reset();
    Components::TearDown();
  }

  static std::string axis(std::size_t i) { return "ct." + std::to_string(i) + "."; }
  void set(const std::string& parameter, double x) {
    for (std::size_t i = 0; i < 3; ++i) value(axis(i) + parameter) = x;
  }
  void enable(bool on) { *hal_.bits.at("ct.enable") = on; }
  int fault_of(std::size_t i) { return *hal_.integers.at(axis(i) + "fault"); }

  /// One servo period towards a point [mm] with its derivatives.
  struct Point {
    std::array<double, 3> position{}, velocity{}, acceleration{};
  };
  void period(const Point& r) {
    for (std::size_t i = 0; i < 3; ++i) {
      value(axis(i) + "pos-cmd") = r.position[i];
      value(axis(i) + "vel-cmd") = r.velocity[i];
      value(axis(i) + "acc-cmd") = r.acceleration[i];
      value(axis(i) + "pos-fb") = value(std::string(kDrives[i]) + ".pos-fb") + (i == 1 ? added_ : 0.0);
    }
    call("ct");
    worst_ = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double force = value(axis(i) + "force");
      ASSERT_TRUE(std::isfinite(force)) << i;
      ASSERT_LE(std::abs(force), 200.0) << i;
      const double error = value(axis(i) + "pos-error");
      ASSERT_TRUE(std::isfinite(error)) << i;
      worst_ = std::max(worst_, std::abs(error));
      value(std::string(kDrives[i]) + ".force") = force;
      call(kDrives[i]);
    }
  }
  /// A circle of 5 mm at 10 mm/s.
  static Point circle(double t) {
    Point r;
    const double w = 2.0;
    r.position = {5.0 * std::cos(w * t) - 5.0, 5.0 * std::sin(w * t), 0.0};
    r.velocity = {-5.0 * w * std::sin(w * t), 5.0 * w * std::cos(w * t), 0.0};
    r.acceleration = {-5.0 * w * w * std::cos(w * t), -5.0 * w * w * std::sin(w * t), 0.0};
    return r;
  }
  /// The circle from rest: the largest error from `from` on [mm].
  double run_circle(double from, double to) {
    double most = 0.0;
    for (int k = 0; k * 1e-3 < to && !HasFatalFailure(); ++k) {
      period(circle(k * 1e-3));
      if (k * 1e-3 >= from) most = std::max(most, worst_);
    }
    return most;
  }

  std::unique_ptr<Module> contour_;
  std::unique_ptr<Module> plants_;
  double worst_ = 0.0;  ///< error of the last period, of the axis that has the largest [mm]
  double added_ = 0.0;  ///< to the encoder of y [mm]
};

TEST_F(Path, EveryLawFollowsACircle) {
  for (const double law : {0.0, 1.0, 2.0, 3.0}) {
    set("law", law);
    if (law == 3.0) set("learning.lap", 1.0);
    enable(false);
    for (int k = 0; k < 30; ++k) period({});
    enable(true);
    period({});
    ASSERT_EQ(fault_of(0), 0) << hal_.messages;
    // The model is the plant's own: hold, encoder, and for sliding mode the chattering of its sign.
    EXPECT_LT(run_circle(1.0, 6.3), 2e-3) << law;
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(fault_of(i), 0) << law;
  }
}

TEST_F(Path, SlidingModeIsQuietAtRestAndSafeAtACornerAndAtAReversal) {
  set("law", 1.0);
  set("sliding-mode.gain", 2.0);
  set("sliding-mode.switching", 1.0);
  set("observer", 3.0);
  enable(true);
  Point r;
  const auto run = [&](int periods) {
    double most = 0.0;
    for (int k = 0; k < periods && !HasFatalFailure(); ++k) {
      for (std::size_t i = 0; i < 3; ++i) r.position[i] += 1e-3 * r.velocity[i];
      period(r);
      most = std::max(most, worst_);
    }
    return most;
  };
  run(300);
  double last = value("ct.0.force");
  double most = 0.0;
  for (int k = 0; k < 500; ++k) {
    run(1);
    most = std::max<double>(most, std::abs(value("ct.0.force") - last));
    last = value("ct.0.force");
  }
  EXPECT_LT(most, 2.0) << "trembles at rest";
  // Ten mm/s at once is 9000 N for a millisecond; 200 N need 45 ms, in which half of 0.45 mm is lost.
  for (const std::array<double, 3>& velocity :
       {std::array{10.0, 0.0, 0.0}, std::array{0.0, 10.0, 0.0}, std::array{0.0, -10.0, 0.0},
        std::array{6.0, 0.0, 8.0}, std::array{0.0, 0.0, 0.0}}) {
    r.velocity = velocity;
    EXPECT_LT(run(600), 1.0);
    EXPECT_LT(run(200), 3e-3) << "at the end of a side";
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(fault_of(i), 0);
  }
}

TEST_F(Path, WhateverComesInTheForceIsFiniteAndWithinItsLimit) {
  std::mt19937 random(20);
  const auto one_in = [&](unsigned n) { return random() % n == 0; };
  const std::array<double, 6> bad{kNan, std::numeric_limits<double>::infinity(), 1e300, -1e300, 1.0, 1e-3};
  int ran = 0;
  for (const double law : {0.0, 1.0, 2.0, 3.0}) {
    set("law", law);
    set("learning.lap", law == 3.0 ? 0.7 : kNan);
    set("observer", 1.0 + static_cast<double>(random() % 3));
    set("adaptation.enabled", static_cast<double>(random() % 2));
    bool on = false;
    for (int k = 0; k < 8000 && !HasFatalFailure(); ++k) {
      SCOPED_TRACE(testing::Message() << "law " << law << ", period " << k);
      if (one_in(on ? 400 : 20)) enable(on = !on);
      if (*hal_.bits.at("ct.faulted") && one_in(10)) enable(on = false);
      if (one_in(1000)) value("ct.ramp-time") = bad[random() % bad.size()];
      value("ct.phase") = one_in(300) ? bad[random() % bad.size()] : 1e-3 * k;
      Point r = circle(1e-3 * k);
      if (one_in(200)) r.position[random() % 3] += bad[random() % bad.size()];
      if (one_in(200)) r.velocity[random() % 3] += bad[random() % bad.size()];
      if (one_in(200)) r.acceleration[random() % 3] += bad[random() % bad.size()];
      added_ = one_in(200) ? bad[random() % bad.size()] : 0.0;
      period(r);
      if (std::abs(value("ct.0.force")) > 0.0) ++ran;
    }
    enable(false);
    added_ = 0.0;
    for (int k = 0; k < 30; ++k) period({});
  }
  EXPECT_GT(ran, 8000) << "too often off to tell anything";
}

TEST_F(Path, AFaultOfOneAxisTakesAllToZero) {
  enable(true);
  run_circle(0.0, 1.3);
  std::array<double, 3> last;
  for (std::size_t i = 0; i < 3; ++i) last[i] = std::abs(value(axis(i) + "force"));
  ASSERT_GT(last[0] + last[1], 20.0);
  added_ = kNan;
  for (int k = 0; k < 25; ++k) {
    period(circle(1.3 + 1e-3 * k));
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_LE(std::abs(value(axis(i) + "force")), last[i] + 1e-12);
      last[i] = std::abs(value(axis(i) + "force"));
    }
  }
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(last[i], 0.0);
    EXPECT_EQ(fault_of(i), i == 1 ? 1 : 0);
  }
  EXPECT_TRUE(*hal_.bits.at("ct.faulted"));
}

TEST_F(Path, LearningFindsWhatTheModelLacksFromThePhase) {
  // Friction of the model half as high as it is: contouring leaves that over the stiffness of the loop.
  set("friction.conventional.alpha0", 9.0);
  set("law", 3.0);
  set("learning.lap", 2.0 * 3.14159265358979323846);
  enable(true);
  std::array<double, 4> most{};
  for (int k = 0; k < 4 * 3142 && !HasFatalFailure(); ++k) {
    value("ct.phase") = 2e-3 * k;
    period(circle(1e-3 * k));
    if (k % 3142 > 600)
      most[static_cast<std::size_t>(k / 3142)] = std::max(most[static_cast<std::size_t>(k / 3142)], worst_);
  }
  EXPECT_GT(most[0], 1.5e-3);
  EXPECT_LT(most[3], 0.4 * most[0]);
}

TEST_F(Path, PredictiveFallsBehindWhereContouringLeavesTheCircle) {
  // 20 mm/s² of 900 kg are 18 N, friction 18 N and 45 N at 10 mm/s: 66.5 N where they meet, and pre-sliding after a reversal.
  const auto largest_radial_error = [&](double law, double& lag) {
    set("law", law);
    if (law == 2.0) set("predictive.reserve", 0.02);
    set("force-limit", 66.0);
    set("ferror-limit", 5.0);
    enable(true);
    double most = 0.0;
    for (int k = 0; k < 8000 && !HasFatalFailure(); ++k) {
      // The circle, from rest over a second.
      const double t = 1e-3 * k;
      const double rate = std::min(t, 1.0);
      Point r = circle(t < 1.0 ? 0.5 * t * t : t - 0.5);
      for (std::size_t i = 0; i < 3; ++i) {
        r.acceleration[i] = r.acceleration[i] * rate * rate + (t < 1.0 ? r.velocity[i] : 0.0);
        r.velocity[i] *= rate;
      }
      period(r);
      lag = std::max(lag, double{value("ct.lag")});
      most = std::max(most, std::abs(std::hypot(value("pl.x.pos") + 5.0, double{value("pl.y.pos")}) - 5.0));
    }
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(fault_of(i), 0) << law;
    return most;
  };
  double lag = 0.0;
  const double predictive = largest_radial_error(2.0, lag);
  // 25 ms; its memory of the path ends at 126.
  EXPECT_GT(lag, 5e-3);
  EXPECT_LT(lag, 0.1);
  EXPECT_LT(predictive, 4e-3);
  // From the beginning.
  TearDown();
  hal_ = {};
  SetUp();
  double none = 0.0;
  const double contouring = largest_radial_error(0.0, none);
  EXPECT_EQ(none, 0.0);
  EXPECT_GT(contouring, 3.0 * predictive);
}

}  // namespace
