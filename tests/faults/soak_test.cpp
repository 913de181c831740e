// A long run in one piece: after millions of laps each force is that of the first ones, and no state, estimate or counter has drifted.
// STRIBECK_SOAK_STEPS: steps of all laws together (1e8), up to 1e10; tools/faults --soak.
#include <gtest/gtest.h>
#include <stribeck/stribeck.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <string>
#include <vector>

namespace stribeck::test::soak_test {
namespace {

constexpr double kPeriod = 1e-3;
constexpr int kLap = 4000;       // steps of one sine
constexpr int kSettled = 50;     // laps until adaptation and learning have settled
constexpr int kBlock = 20;       // laps that are compared
constexpr int kSections = 50;    // of the whole run, each compared at its end
constexpr double kMass = 900.0;  // [kg]

struct Soaked {
  const char* law;
  const char* feedforward;
  const char* observer;
  bool adapts;
  double share;  ///< of all steps; a step of predictive control takes ten times as long
};
std::ostream& operator<<(std::ostream& out, const Soaked& s) {
  return out << s.law << ' ' << s.feedforward << ' ' << s.observer << (s.adapts ? " adapting" : "");
}

/// One axis with a bristle, one explicit step per period: not a machine, but the same motion for ever.
struct Axis {
  double x = 0.0;
  double v = 0.0;
  double bristle = 0.0;  ///< [N]

  void move(double force) {
    constexpr double kLevel = 22.0;      // [N]
    constexpr double kStiffness = 1e6;   // [N/m]
    constexpr double kViscous = 4300.0;  // [N s/m]
    bristle = std::clamp(bristle + kStiffness * kPeriod * v, -kLevel, kLevel);
    v += kPeriod * (force - bristle - kViscous * v) / kMass;
    x += kPeriod * v;
  }
  [[nodiscard]] double encoder() const { return 1e-8 * std::round(x / 1e-8); }
};

/// What a block of laps comes to.
struct Sums {
  double force = 0.0;        ///< RMS [N]
  double error = 0.0;        ///< RMS [m]
  double most = 0.0;         ///< largest error [m]
  double level = 0.0;        ///< of adaptation, mean at the end of a lap
  double disturbance = 0.0;  ///< the observer's, the same [N]
};

class Soak : public testing::TestWithParam<Soaked> {
 protected:
  void SetUp() override {
    const Soaked& s = GetParam();
    const std::size_t size = stribeck_controller_size_for(1, s.law);
    memory_ = ::operator new(size, std::align_val_t(stribeck_alignment()));
    c_ = stribeck_controller_init(memory_, size, 1);
    choose("law", s.law);
    set("mass", 860.0);
    set("omega", 60.0);
    set("friction.conventional.alpha0", 20.0);
    set("friction.conventional.alpha2", 4200.0);
    choose("friction.dynamics", "lugre");
    set("friction.lugre.sigma0", 1e6);
    choose("feedforward", s.feedforward);
    choose("observer", s.observer);
    if (s.adapts) set("adaptation.enabled", 1.0);
    set("guarded", 1.0);
    set("force_limit", 250.0);
    set("encoder_resolution", 1e-8);
    choose("supervision.checks", "all");
    set("supervision.speed_limit", 30e-3);
    set("supervision.acceleration_limit", 0.2);
    if (std::string(s.law) == "learning") set("learning.lap", 2.0 * M_PI);
    ASSERT_EQ(stribeck_controller_configure(c_, kPeriod), STRIBECK_OK) << stribeck_controller_problem(c_);
    const double rate = 2.0 * M_PI / (kLap * kPeriod);
    for (int k = 0; k < kLap; ++k) {
      const double phi = 2.0 * M_PI * k / kLap;
      lap_.push_back(
          {10e-3 * std::sin(phi), 10e-3 * rate * std::cos(phi), -10e-3 * rate * rate * std::sin(phi), 0.0});
    }
  }
  void TearDown() override { ::operator delete(memory_, std::align_val_t(stribeck_alignment())); }

  /// So many laps.
  Sums go(std::int64_t laps) {
    Sums sums;
    for (std::int64_t n = 0; n < laps; ++n) {
      for (int k = 0; k < kLap; ++k) {
        stribeck_axis_input in = lap_[static_cast<std::size_t>(k)];
        // A sine that begins at speed is reached from rest.
        if (start_ < 1.0) {
          start_ += 1e-3;
          in.position *= start_ * start_;
          in.velocity *= start_ * start_;
          in.acceleration *= start_ * start_;
        }
        in.measured = axis_.encoder();
        stribeck_controller_set_phase(c_, 2.0 * M_PI * k / kLap);
        double force = 0.0;
        failed_ = failed_ || stribeck_controller_step(c_, &in, &force) != STRIBECK_OK;
        const double error = axis_.x - in.position;
        sums.force += force * force;
        sums.error += error * error;
        sums.most = std::max(sums.most, std::abs(error));
        axis_.move(force);
      }
      sums.level += now().level;
      sums.disturbance += now().disturbance;
    }
    const double steps = static_cast<double>(laps) * kLap;
    return {std::sqrt(sums.force / steps), std::sqrt(sums.error / steps), sums.most,
            sums.level / static_cast<double>(laps), sums.disturbance / static_cast<double>(laps)};
  }
  [[nodiscard]] stribeck_axis_signals now() const {
    stribeck_axis_signals s{};
    stribeck_controller_signals(c_, 0, &s, sizeof s);
    return s;
  }
  [[nodiscard]] stribeck_supervision why() const {
    stribeck_supervision s{};
    stribeck_controller_supervision(c_, &s, sizeof s);
    return s;
  }

  /// Block of laps n against the first one.
  void expect_same(const Sums& last, const Sums& first, int n) const {
    // The encoder rounds, so that laps differ in how; a state that drifts shows by orders more after so many laps.
    EXPECT_NEAR(last.force, first.force, 1e-4 * first.force) << n;
    EXPECT_NEAR(last.error, first.error, 0.02 * first.error + 1e-9) << n;
    EXPECT_LT(last.most, 1.1 * first.most + 10e-9) << n;
    // A hundredth of the friction level, which is what rounding leaves in the mean of a block.
    EXPECT_NEAR(last.disturbance, first.disturbance, 0.2) << n;
    if (GetParam().adapts) {
      EXPECT_NEAR(last.level, first.level, 0.005) << n;
    }
  }

  bool failed_ = false;

 private:
  void set(const char* name, double x) {
    ASSERT_EQ(stribeck_controller_set(c_, 0, name, x), STRIBECK_OK) << stribeck_controller_problem(c_);
  }
  void choose(const char* name, const char* word) {
    ASSERT_EQ(stribeck_controller_choose(c_, 0, name, word), STRIBECK_OK) << stribeck_controller_problem(c_);
  }

  void* memory_ = nullptr;
  stribeck_controller* c_ = nullptr;
  std::vector<stribeck_axis_input> lap_;
  Axis axis_;
  double start_ = 0.0;
};

TEST_P(Soak, LaterLapsAreTheFirstOnes) {
  const char* asked = std::getenv("STRIBECK_SOAK_STEPS");
  const double steps = std::clamp(asked == nullptr ? 1e8 : std::strtod(asked, nullptr), 1e6, 1e10);
  const auto laps = static_cast<std::int64_t>(GetParam().share * steps / kLap);
  static_cast<void>(go(kSettled));
  ASSERT_EQ(why().fault, STRIBECK_FAULT_NONE) << stribeck_fault_describe(why().fault);
  const Sums first = go(kBlock);
  // A drift that comes and goes again shows as well.
  Sums last;
  const std::int64_t between = std::max<std::int64_t>((laps - kSettled - kBlock) / kSections - kBlock, 0);
  for (int n = 0; n < kSections && !HasFailure(); ++n) {
    static_cast<void>(go(between));
    last = go(kBlock);
    expect_same(last, first, n + 1);
  }
  std::printf("%lld steps: force %.9g N, then %.9g N; error %.4g nm, then %.4g nm; level %.6g, then %.6g\n",
              static_cast<long long>(laps * kLap), first.force, last.force, first.error * 1e9,
              last.error * 1e9, first.level, last.level);
  EXPECT_FALSE(failed_);
  EXPECT_EQ(why().fault, STRIBECK_FAULT_NONE) << stribeck_fault_describe(why().fault);
  EXPECT_EQ(now().bridged, 0U);
  EXPECT_EQ(why().late, 0U);
  EXPECT_EQ(why().commands_lost, 0U);
  for (const std::uint32_t n : why().counts) EXPECT_EQ(n, 0U);
}

INSTANTIATE_TEST_SUITE_P(Laws, Soak,
                         testing::Values(Soaked{"contouring", "dynamic", "disturbance", false, 0.3},
                                         Soaked{"contouring", "dynamic", "kalman", false, 0.15},
                                         Soaked{"contouring", "dynamic", "disturbance", true, 0.25},
                                         Soaked{"contouring", "reversal", "disturbance", false, 0.1},
                                         Soaked{"sliding-mode", "steady", "adaptive", false, 0.1},
                                         Soaked{"learning", "dynamic", "disturbance", false, 0.08},
                                         Soaked{"predictive", "dynamic", "disturbance", false, 0.02}));

}  // namespace
}  // namespace stribeck::test::soak_test
