// Validation of the causes of a circle's deviation: 240 virtual machines (test_virtual_circle.hpp) with known causes, alone and in
// pairs. The table of docs/theory/circular-test.md is what this test prints.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iostream>
#include <map>
#include <optional>
#include <random>
#include <stribeck/core/fields.hpp>
#include <stribeck/ident/circle/causes.hpp>
#include <stribeck/ident/circle/test_virtual_circle.hpp>
#include <string>
#include <utility>
#include <vector>

namespace stribeck::ident::circle::circle_causes_test {
namespace {

std::vector<CircleMotion> measured(const VirtualMachine& m, const std::vector<double>& feeds,
                                   std::mt19937_64& random) {
  std::vector<CircleMotion> out;
  for (const double feed : feeds) out.push_back(travel(m, feed, 1.3, random).motion(m.radius));
  return out;
}

const Cause& cause_in(const Diagnosis& d, CauseKind kind, std::optional<int> axis) {
  for (const Cause& c : d.causes) {
    if (c.kind == kind && (!axis || c.axis == axis)) return c;
  }
  static const Cause none;
  return none;
}

/// A cause that can be switched on.
struct Switch {
  CauseKind kind;
  std::optional<int> axis;
  std::function<void(VirtualMachine&, double size)> on;
  /// Size that the diagnosis should state.
  std::function<double(double size)> stated = [](double size) { return size; };
  /// Others that follow from it: an error of one scale is a mismatch and a mean.
  std::vector<CauseKind> with = {};
};

std::vector<Switch> switches(const VirtualMachine& m, double fastest) {
  using K = CauseKind;
  const double r = m.radius;
  std::vector<Switch> all;
  for (const int k : {0, 1}) {
    all.push_back({K::kReversalSpike, k, [k](VirtualMachine& v, double s) { v.spike[k] = s; }});
    all.push_back({K::kBacklash, k, [k](VirtualMachine& v, double s) { v.backlash[k] = s; }});
    all.push_back({K::kBacklash, k, [k](VirtualMachine& v, double s) { v.backlash[k] = -s; },
                   [](double s) { return -s; }});
    all.push_back({K::kLateralPlay, k, [k](VirtualMachine& v, double s) { v.lateral[k] = s; }});
    all.push_back({K::kCyclic, k, [k](VirtualMachine& v, double s) { v.cyclic[k] = s; }});
    all.push_back({K::kStraightness, k, [k](VirtualMachine& v, double s) { v.bow[k] = s; }});
    all.push_back({K::kScaleMismatch,
                   std::nullopt,
                   [k, r](VirtualMachine& v, double s) { v.scale[k] = 2.0 * s / r; },
                   [k](double s) { return k == 0 ? s : -s; },
                   {K::kRadius}});
  }
  all.push_back({K::kSquareness, std::nullopt, [r](VirtualMachine& v, double s) { v.tilt = 2.0 * s / r; }});
  all.push_back({K::kRadius, std::nullopt, [](VirtualMachine& v, double s) { v.larger = s; }});
  all.push_back({K::kVibration, std::nullopt, [](VirtualMachine& v, double s) { v.vibration = s; }});
  all.push_back({K::kCentre, std::nullopt, [](VirtualMachine& v, double s) { v.offset[1] = s; }});
  // Both axes lag by T: the radius shrinks by V²T²/(2R); x lags more: V·(τx − τy)/2.
  all.push_back({K::kLag, std::nullopt, [r, fastest](VirtualMachine& v, double s) {
                   v.lag[0] = v.lag[1] = std::sqrt(2.0 * s * r) / fastest;
                 }});
  all.push_back({K::kServoMismatch, std::nullopt, [fastest](VirtualMachine& v, double s) {
                   v.lag[0] = std::max(v.lag[0], 1e-3) + 2.0 * s / fastest;
                   v.lag[1] = v.lag[0] - 2.0 * s / fastest;
                 }});
  return all;
}

/// What a validation counts.
struct Score {
  int on = 0;
  int found = 0;
  int right = 0;  ///< found, and its size within the bound
  double worst = 0.0;
};

struct Campaign {
  std::map<std::string, Score> by_cause;
  int machines = 0;
  int judged_off = 0;
  int false_causes = 0;
  std::map<std::string, int> false_by_cause;
};

void judge(Campaign& c, const Diagnosis& d, const std::vector<std::pair<const Switch*, double>>& on,
           double share) {
  ++c.machines;
  for (const auto& [which, size] : on) {
    const CauseKind kind = which->kind;
    // A scale error beside a larger radius adds to it: no size of its own.
    const bool adds = std::any_of(on.begin(), on.end(), [kind](const auto& o) {
      return std::find(o.first->with.begin(), o.first->with.end(), kind) != o.first->with.end();
    });
    if (adds) continue;
    const Cause& found = cause_in(d, which->kind, which->axis);
    const double stated = which->stated(size);
    Score& score = c.by_cause[std::string(enum_name(which->kind))];
    ++score.on;
    if (!found.found) continue;
    ++score.found;
    const double off = std::abs(found.size - stated);
    if (off <= std::max(share * size, 0.3e-6)) ++score.right;
    score.worst = std::max(score.worst, off);
  }
  for (const Cause& cause : d.causes) {
    const bool meant = std::any_of(on.begin(), on.end(), [&](const auto& o) {
      const Switch& s = *o.first;
      return (s.kind == cause.kind && (!s.axis || s.axis == cause.axis)) ||
             std::find(s.with.begin(), s.with.end(), cause.kind) != s.with.end();
    });
    if (meant || cause.kind == CauseKind::kCentre) continue;
    ++c.judged_off;
    if (!cause.found) continue;
    ++c.false_causes;
    ++c.false_by_cause[std::string(enum_name(cause.kind))];
  }
}

VirtualMachine random_machine(std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  VirtualMachine m;
  m.radius = 0.05 * std::pow(3.0, unit(random));
  m.spike_time = 0.008 * std::pow(12.0, unit(random));
  for (double& p : m.pitch) p = 0.005 * std::pow(4.0, unit(random));
  m.noise = (0.05 + 0.15 * unit(random)) * 1e-6;
  m.vibration_frequency = 15.0 + 60.0 * unit(random);
  return m;
}

/// Machines with `causes` causes each, of 0.5 µm to 20 µm, two feeds, both directions.
Campaign campaign(int machines, int causes, std::uint64_t seed) {
  Campaign c;
  for (int i = 0; i < machines; ++i) {
    std::mt19937_64 random(seed + static_cast<std::uint64_t>(i));
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    VirtualMachine m = random_machine(random);
    constexpr double kSlow = 1.0 / 60.0;
    constexpr double kFast = 3.0 / 60.0;
    const std::vector<Switch> all = switches(m, kFast);
    std::vector<std::pair<const Switch*, double>> on;
    for (int k = 0; k < causes; ++k) {
      // All of them by turns; the second is another one.
      const std::size_t place =
          (static_cast<std::size_t>(i) +
           static_cast<std::size_t>(k) *
               (1 + static_cast<std::size_t>(unit(random) * static_cast<double>(all.size() - 1)))) %
          all.size();
      const double size = 0.5e-6 * std::pow(40.0, unit(random));
      if (k > 0 && all[place].kind == on.front().first->kind) continue;
      on.emplace_back(&all[place], size);
    }
    for (const auto& [which, size] : on) which->on(m, size);
    const auto d = diagnose(measured(m, {kSlow, kFast}, random));
    if (!d) {
      ADD_FAILURE() << "seed " << seed << ", machine " << i << ": no diagnosis";
      continue;
    }
    judge(c, *d, on, causes > 1 ? 0.25 : 0.15);
  }
  return c;
}

void print(const Campaign& c) {
  for (const auto& [name, s] : c.by_cause)
    std::cout << "| " << name << " | " << s.on << " | " << s.found << " | " << s.right << " | "
              << s.worst * 1e6 << " |\n";
  std::cout << c.machines << " machines, " << c.false_causes << " false of " << c.judged_off
            << " causes that were off\n";
  for (const auto& [name, n] : c.false_by_cause) std::cout << "  false: " << name << " " << n << "\n";
}

/// Shares of the causes that were on: found, and right.
void expect(const Campaign& c, double found, double right) {
  print(c);
  Score all;
  for (const auto& [name, s] : c.by_cause) {
    all.on += s.on;
    all.found += s.found;
    all.right += s.right;
  }
  EXPECT_GE(all.found, found * all.on);
  EXPECT_GE(all.right, right * all.on);
  EXPECT_LE(c.false_causes, 0.05 * c.judged_off);
}

// Alone: within 15 % or 0.3 um.
TEST(CircleCauses, EachAlone) { expect(campaign(120, 1, 5000), 0.99, 0.98); }

// In pairs: within 25 % or 0.3 um.
TEST(CircleCauses, InPairs) { expect(campaign(120, 2, 9000), 0.97, 0.95); }

}  // namespace
}  // namespace stribeck::ident::circle::circle_causes_test
