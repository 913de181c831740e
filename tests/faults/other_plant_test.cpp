// Supervision through the C interface, on a plant that shares no code with Stribeck's: ten Maxwell slip elements, a lag of the force,
// stiffness that depends on the position, and parameters that the controller knows roughly.
#include <gtest/gtest.h>
#include <stribeck/stribeck.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <new>
#include <string>

namespace stribeck::test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kPeriod = 1e-3;
constexpr double kWhen = 2.0;

class MaxwellAxis {
 public:
  explicit MaxwellAxis(double mass) : mass_(mass) {}

  void move(double force) {
    constexpr int kParts = 50;
    constexpr double kStep = kPeriod / kParts;
    for (int part = 0; part < kParts; ++part) {
      acts_ += kStep / 0.3e-3 * (force - acts_);
      const double stiffness = 1.0 + 0.2 * std::sin(x / 0.3e-3);
      double friction = 4000.0 * v;
      for (std::size_t i = 0; i < spring_.size(); ++i) {
        const double k = 7e5 * stiffness;
        const double slip = 0.6 * (1.0 + static_cast<double>(i));  // 33 N altogether
        spring_[i] = std::clamp(spring_[i] + k * kStep * v, -slip, slip);
        friction += spring_[i];
      }
      v += kStep * (acts_ - friction) / mass_;
      x += kStep * v;
    }
  }
  [[nodiscard]] double encoder() const { return 1e-7 * std::round(x / 1e-7); }

  double x = 0.0;
  double v = 0.0;

 private:
  double mass_;
  double acts_ = 0.0;
  std::array<double, 10> spring_{};
};

/// Two axes on a circle of 10 mm at 10 mm/s.
class Machine : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    size_ = stribeck_controller_size_for(2, GetParam());
    memory_ = ::operator new(size_, std::align_val_t(stribeck_alignment()));
    c = stribeck_controller_init(memory_, size_, 2);
    for (std::uint32_t i = 0; i < 2; ++i) {
      choose(i, "law", GetParam());
      set(i, "mass", 860.0);
      set(i, "omega", 60.0);
      set(i, "friction.conventional.alpha0", 30.0);
      set(i, "friction.conventional.alpha2", 4200.0);
      choose(i, "friction.dynamics", "lugre");
      set(i, "friction.lugre.sigma0", 6.5e6);
      set(i, "friction.lugre.sigma1", 70e3);
      choose(i, "feedforward", "dynamic");
      choose(i, "observer", "disturbance");
      set(i, "guarded", 1.0);
      set(i, "force_limit", 250.0);
      choose(i, "supervision.checks", "all");
      set(i, "supervision.speed_limit", 16e-3);
      set(i, "supervision.acceleration_limit", 0.1);
      if (std::string(GetParam()) == "learning") set(i, "learning.lap", 2.0 * M_PI);
    }
    ASSERT_EQ(stribeck_controller_configure(c, kPeriod), STRIBECK_OK) << stribeck_controller_problem(c);
    axis[0].x = 10e-3;
  }
  void TearDown() override { ::operator delete(memory_, std::align_val_t(stribeck_alignment())); }
  void set(std::uint32_t i, const char* name, double x) {
    ASSERT_EQ(stribeck_controller_set(c, i, name, x), STRIBECK_OK) << stribeck_controller_problem(c);
  }
  void choose(std::uint32_t i, const char* name, const char* word) {
    ASSERT_EQ(stribeck_controller_choose(c, i, name, word), STRIBECK_OK) << stribeck_controller_problem(c);
  }

  /// One period; the angle accelerates to 1 rad/s within the first second.
  void period() {
    const double t = time();
    const double phi = t < 1.0 ? 0.5 * t * t : t - 0.5;
    const double rate = t < 1.0 ? t : 1.0;
    const double acceleration = t < 1.0 ? 1.0 : 0.0;
    const double angle[2] = {phi, phi - 0.5 * M_PI};
    stribeck_axis_input in[2];
    error = 0.0;
    for (std::size_t i = 0; i < 2; ++i) {
      const double cosine = std::cos(angle[i]);
      const double sine = std::sin(angle[i]);
      in[i].position = 10e-3 * cosine;
      in[i].velocity = -10e-3 * sine * rate;
      in[i].acceleration = -10e-3 * (cosine * rate * rate + sine * acceleration);
      in[i].measured = encoder ? encoder(t, i, axis[i].encoder()) : axis[i].encoder();
      error = std::max(error, std::abs(axis[i].x - in[i].position));
    }
    stribeck_controller_set_phase(c, phi);
    result = stribeck_controller_step(c, in, force.data());
    for (std::size_t i = 0; i < 2; ++i) {
      stribeck_axis_signals now{};
      stribeck_controller_signals(c, static_cast<std::uint32_t>(i), &now, sizeof now);
      limited = limited || (result == STRIBECK_OK && now.limited != 0);
      ASSERT_TRUE(std::isfinite(force[i]));
      ASSERT_LE(std::abs(force[i]), 250.0);
      axis[i].move(i == wrong ? -force[i] : force[i]);
    }
    ++k_;
  }
  void run_to(double t) {
    while (time() < t && !HasFatalFailure()) period();
  }
  double worst_to(double t) {
    double most = 0.0;
    while (time() < t && !HasFatalFailure()) {
      period();
      most = std::max(most, error);
    }
    return most;
  }
  [[nodiscard]] double time() const { return kPeriod * k_; }
  [[nodiscard]] stribeck_supervision why() const {
    stribeck_supervision s{};
    stribeck_controller_supervision(c, &s, sizeof s);
    return s;
  }
  /// How far both axes move until t [m].
  double moved_to(double t) {
    const double from[2] = {axis[0].x, axis[1].x};
    double most = 0.0;
    while (time() < t && !HasFatalFailure()) {
      period();
      for (std::size_t i = 0; i < 2; ++i) most = std::max(most, std::abs(axis[i].x - from[i]));
    }
    return most;
  }

  stribeck_controller* c = nullptr;
  std::array<MaxwellAxis, 2> axis{MaxwellAxis(900.0), MaxwellAxis(800.0)};
  std::function<double(double, std::size_t, double)> encoder;
  std::size_t wrong = 2;  ///< axis whose force has the wrong sign
  std::array<double, 2> force{};
  stribeck_result result = STRIBECK_OK;
  double error = 0.0;
  bool limited = false;

 private:
  std::size_t size_ = 0;
  void* memory_ = nullptr;
  int k_ = 0;
};

TEST_P(Machine, SoundItIsNeverStoppedAndNothingIsBridged) {
  run_to(15.0);
  EXPECT_EQ(why().fault, STRIBECK_FAULT_NONE) << stribeck_fault_describe(why().fault);
  stribeck_axis_signals now{};
  stribeck_controller_signals(c, 0, &now, sizeof now);
  EXPECT_EQ(now.bridged, 0u);
}

TEST_P(Machine, WildSamplesOfAnySizeMoveNothing) {
  run_to(kWhen);
  const double before = worst_to(4.0);
  limited = false;
  double when = 4.0;
  for (const double size : {3e-6, 1e-3, 1.0, 1e15, 1e300, kNan}) {
    encoder = [=](double t, std::size_t i, double x) {
      return i == 0 && std::abs(t - when) < 0.5 * kPeriod ? x + size : x;
    };
    EXPECT_LT(worst_to(when + 0.2), before + 20e-6) << size;
    EXPECT_LT(worst_to(when + 0.5), 1.2 * before) << size;
    when += 0.5;
  }
  EXPECT_FALSE(limited);
  EXPECT_EQ(why().fault, STRIBECK_FAULT_NONE);
}

TEST_P(Machine, ALostEncoderStopsWithinAMillimetre) {
  run_to(kWhen);
  encoder = [](double, std::size_t, double) { return kNan; };
  EXPECT_LT(moved_to(kWhen + 1.0), 1e-3);
  EXPECT_EQ(why().fault, STRIBECK_FAULT_ENCODER_LOST);
  EXPECT_EQ(force[0], 0.0);
  EXPECT_EQ(force[1], 0.0);
}

TEST_P(Machine, AFrozenEncoderStopsWithinTwoMillimetres) {
  run_to(kWhen);
  const double held[2] = {axis[0].encoder(), axis[1].encoder()};
  encoder = [=](double, std::size_t i, double) { return held[i]; };
  EXPECT_LT(moved_to(kWhen + 1.0), 2e-3);
  EXPECT_EQ(result, STRIBECK_FAULT);
}

TEST_P(Machine, AWrongSignIsSeenWithinHalfAMillimetre) {
  // The second axis moves first: the circle begins at the end of the first one.
  wrong = 1;
  run_to(0.001);
  const double from = axis[1].x;
  run_to(2.0);
  EXPECT_LT(std::abs(axis[1].x - from), 0.5e-3);
  EXPECT_EQ(why().fault, STRIBECK_FAULT_WRONG_SIGN) << stribeck_fault_describe(why().fault);
  EXPECT_FALSE(limited);
}

INSTANTIATE_TEST_SUITE_P(Laws, Machine,
                         testing::Values("contouring", "sliding-mode", "predictive", "learning"),
                         [](const auto& law) {
                           std::string name = law.param;
                           std::erase(name, '-');
                           return name;
                         });

}  // namespace
}  // namespace stribeck::test
