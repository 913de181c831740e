#pragma once
/// The search for the number of sub-steps of a control period with which a simulation is accurate.
///
///   n₀ = max(2, ⌈rate·T/1.7⌉)      n ← n + ⌈n/2⌉ until a run with 2n sub-steps agrees with that of n
///
///   rate of the equations [1/s], T control period [s]
///
/// Explicit steps of order three are stable below a rate of 1.7 (oscillating) to 2.5 (decaying) per step. At a reversal the
/// order falls to two, so that the error of a run with n sub-steps is 4/3 of the difference.
/// Real time: no.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

namespace stribeck::sim {

/// More sub-steps of a control period than this are not tried.
inline constexpr int kMostSubsteps = 512;

/// Smallest number of sub-steps for the rate; it may be a fraction.
inline double least_substeps(double rate, double period) { return rate * period / 1.7; }

/// Error of a run, from its largest difference to a run with twice as many sub-steps; infinite where one is not finite.
class RunError {
 public:
  void add(double difference) {
    worst_ =
        std::isfinite(difference) ? std::max(worst_, difference) : std::numeric_limits<double>::infinity();
  }
  [[nodiscard]] bool within(double accuracy) const { return worst_ * 4.0 / 3.0 <= accuracy; }

 private:
  double worst_ = 0.0;
};

/// Largest and RMS error of a run, for the weaker demand on a loop in stick-slip: around standstill every difference grows to the size
/// of its hunting, with any number of sub-steps.
class ErrorSize {
 public:
  void add(double error) {
    most_ = std::max(most_, std::abs(error));
    squares_ += error * error;
    ++count_;
  }
  [[nodiscard]] double largest() const { return most_; }
  /// Both agree within a tenth.
  [[nodiscard]] bool alike(const ErrorSize& other) const {
    constexpr double kAlike = 0.1;
    const auto near = [](double a, double b) { return std::abs(a - b) <= kAlike * std::max(a, b); };
    return near(most_, other.most_) && near(rms(), other.rms());
  }

 private:
  [[nodiscard]] double rms() const { return std::sqrt(squares_ / static_cast<double>(count_)); }

  double most_ = 0.0;
  double squares_ = 0.0;
  std::size_t count_ = 0;
};

/// From this number on the weaker demand counts.
inline constexpr int kManySubsteps = 32;
/// Share of the periods with the drive at its limit; more: the loop swings between its limits, and is unstable.
inline constexpr double kMostAtLimit = 1e-3;

enum class Substeps { kEnough, kMore, kGiveUp };

/// run(n) simulates; judge(n, coarse, fine) tells whether n is enough. Empty where it gave up, or kMostSubsteps are not enough.
template <class Run, class Judge>
std::optional<int> search_substeps(double least, Run&& run, Judge&& judge) {
  for (int n = std::max(2, static_cast<int>(std::ceil(std::min(least, 2.0 * kMostSubsteps))));
       n <= kMostSubsteps; n += (n + 1) / 2) {
    const auto coarse = run(n);
    const auto fine = run(2 * n);
    const Substeps found = judge(n, coarse, fine);
    if (found == Substeps::kEnough) return n;
    if (found == Substeps::kGiveUp) return {};
  }
  return {};
}

}  // namespace stribeck::sim
