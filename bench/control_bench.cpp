/// One tick of a three-axis controller on the path (4.25) of the thesis at 1 ms: gains of Table 4.5 (b), Coulomb and viscous
/// friction of Table 4.3, adaptive friction on every axis.
///
///   SlidingMode          the point of the path given; with the printed and with the sufficient switching gain
///   SlidingModeWithPath  the same, and before it the next point of the path with its frame and their derivatives
///   PathPoint            that point alone
///   ThreePids            the peer: PID of each axis without any model of friction, the points given
///   Contouring           contouring control with the same feed-forward, the points given
///   Predictive/N/free    model predictive contouring of N axes, 64 periods ahead, the limits of force out of reach
///   Predictive/N/limited the same while errors of 50 µm that change side every 40 ticks drive every axis into its limit
///
/// Counters, of 10⁶ ticks each (Predictive: 3·10⁴):
///
///   call_ns   median of single calls, each between two readings of the clock, less the median of a pair of readings with
///             nothing between them
///   worst_ns  for Predictive: greatest over the points of the least time that any of the calls at a point took, likewise; what
///             else the machine does is not in it
///   batch_ns  median over 1000 batches of the mean of 1000 calls in a row, likewise

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <stribeck/control/laws/contouring.hpp>
#include <stribeck/control/laws/pid.hpp>
#include <stribeck/control/laws/predictive.hpp>
#include <stribeck/control/laws/sliding_mode.hpp>
#include <stribeck/path/fourier.hpp>
#include <stribeck/path/reference.hpp>
#include <vector>

namespace {

using namespace stribeck;

constexpr std::size_t kBatch = 1000;
constexpr std::size_t kBatches = 1000;
constexpr std::size_t kFewBatches = 30;  // of a law that takes a hundred times as long
constexpr double kPeriod = 1e-3;

using Point = path::PathPoint<3>;
using V = Vec<double, 3>;

path::Reference<path::Fourier<3>> reference() {
  path::Fourier<3> curve;
  curve.axis[0].terms = {path::Harmonic{10e-3, 3.0, 1.256 - 0.5 * kPi}};
  curve.axis[1].terms = {path::Harmonic{15e-3, 1.0, -0.5 * kPi}};
  curve.axis[2].terms = {path::Harmonic{15e-3, 1.0, -0.5 * kPi}};
  return {curve, {9.5e-3, 1.0, 1e9}};
}

/// Points of the path after the run-in, and positions up to 2 µm beside them in steps of an encoder.
struct Ticks {
  std::vector<Point> point;
  std::vector<V> measured;
};

const Ticks& ticks() {
  static const Ticks instance = [] {
    Ticks t;
    auto r = reference();
    for (int k = 0; k < 1000; ++k) r.advance(kPeriod);
    for (std::size_t k = 0; k < kBatch; ++k) {
      r.advance(kPeriod);
      t.point.push_back(r.point());
      V x = t.point.back().position;
      for (std::size_t i = 0; i < 3; ++i)
        x[i] = 1e-7 * std::round((x[i] + 2e-6 * std::sin(0.01 * static_cast<double>(k * (i + 1)))) / 1e-7);
      t.measured.push_back(x);
    }
    return t;
  }();
  return instance;
}

control::Setup<3> setup() {
  constexpr std::array kMass{1000.0, 800.0, 800.0};
  constexpr std::array kCoulomb{18.0, 15.0, 24.0};
  constexpr std::array kViscous{4500.0, 3000.0, 4000.0};
  constexpr std::array kAdaptive{10.0, 20.0, 20.0};
  control::Setup<3> s;
  s.period = kPeriod;
  for (std::size_t i = 0; i < 3; ++i) {
    auto& c = s.compensation[i];
    c.model.mass = kMass[i];
    c.model.load = i == 2 ? 10.0 : 0.0;
    c.model.friction.steady = friction::Conventional<double>{kCoulomb[i], kViscous[i], {}};
    c.feedforward = control::Feedforward::kSteady;
    c.observer = control::Observer::kAdaptive;
    c.adaptive_gain = kAdaptive[i];
    s.force_limit[i] = 250.0;
  }
  return s;
}

control::SlidingMode<3> sliding_mode(control::SwitchingGain gain) {
  control::SlidingModeParams p;
  p.lambda = {20.0, 40.0, 40.0};
  p.a = {10.0, 20.0, 20.0};
  p.gamma = {5e-3, 10e-3, 10e-3};
  p.mass_bound = {100.0};
  p.gain = gain;
  return {p, setup()};
}

double now_ns() {
  const auto t = std::chrono::steady_clock::now().time_since_epoch();
  return static_cast<double>(std::chrono::duration_cast<std::chrono::nanoseconds>(t).count());
}

double median(std::vector<double> v) {
  const auto middle = v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2);
  std::nth_element(v.begin(), middle, v.end());
  return *middle;
}

/// tick(k) is one call for the k-th point.
template <class Tick>
void measure(benchmark::State& state, Tick&& tick, std::size_t batches = kBatches) {
  std::vector<double> call, empty, batch;
  std::vector<double> least(kBatch, std::numeric_limits<double>::infinity());
  for (auto _ : state) {
    call.clear(), empty.clear(), batch.clear();
    for (std::size_t b = 0; b < batches; ++b) {
      for (std::size_t k = 0; k < kBatch; ++k) {
        const double a = now_ns();
        tick(k);
        const double m = now_ns();
        benchmark::ClobberMemory();
        const double e = now_ns();
        call.push_back(m - a);
        empty.push_back(e - m);
        least[k] = std::min(least[k], m - a);
      }
    }
    for (std::size_t b = 0; b < batches; ++b) {
      const double a = now_ns();
      for (std::size_t k = 0; k < kBatch; ++k) tick(k);
      batch.push_back((now_ns() - a) / static_cast<double>(kBatch));
    }
  }
  const double clock = median(empty);
  state.counters["call_ns"] = median(call) - clock;
  if (batches < kBatches) state.counters["worst_ns"] = *std::max_element(least.begin(), least.end()) - clock;
  state.counters["batch_ns"] = median(batch) - clock / static_cast<double>(kBatch);
}

void sliding(benchmark::State& state, control::SwitchingGain gain) {
  const Ticks& t = ticks();
  const auto law = sliding_mode(gain);
  control::SlidingMode<3>::State s;
  measure(state, [&](std::size_t k) { benchmark::DoNotOptimize(law.step(s, t.point[k], t.measured[k])); });
}

void sliding_with_path(benchmark::State& state) {
  const Ticks& t = ticks();
  const auto law = sliding_mode(control::SwitchingGain::kPrinted);
  control::SlidingMode<3>::State s;
  auto r = reference();
  for (int k = 0; k < 1000; ++k) r.advance(kPeriod);
  measure(state, [&](std::size_t k) {
    r.advance(kPeriod);
    const Point p = r.point();
    // As far beside the path as the positions that were sampled before.
    benchmark::DoNotOptimize(law.step(s, p, p.position + (t.measured[k] - t.point[k].position)));
  });
}

void path_point(benchmark::State& state) {
  auto r = reference();
  for (int k = 0; k < 1000; ++k) r.advance(kPeriod);
  measure(state, [&](std::size_t) {
    r.advance(kPeriod);
    benchmark::DoNotOptimize(r.point());
  });
}

void three_pids(benchmark::State& state) {
  const Ticks& t = ticks();
  auto plain = setup();
  for (auto& c : plain.compensation) {
    c.feedforward = control::Feedforward::kNone;
    c.observer = control::Observer::kNone;
  }
  const control::Pid<3> law(control::PidParams::triple(30.0), plain);
  control::Pid<3>::State s;
  measure(state, [&](std::size_t k) { benchmark::DoNotOptimize(law.step(s, t.point[k], t.measured[k])); });
}

void contouring(benchmark::State& state) {
  const Ticks& t = ticks();
  const control::Contouring<3> law({}, setup());
  control::Contouring<3>::State s;
  measure(state, [&](std::size_t k) { benchmark::DoNotOptimize(law.step(s, t.point[k], t.measured[k])); });
}

template <std::size_t N>
void predictive(benchmark::State& state, bool limited) {
  const Ticks& t = ticks();
  std::vector<path::PathPoint<N>> points(kBatch);
  std::vector<Vec<double, N>> measured(kBatch);
  control::Setup<N> few;
  few.period = kPeriod;
  for (std::size_t i = 0; i < N; ++i) {
    few.compensation[i] = setup().compensation[i];
    few.force_limit[i] = limited ? 100.0 : 1e4;
    for (std::size_t k = 0; k < kBatch; ++k) {
      points[k].position[i] = t.point[k].position[i];
      points[k].velocity[i] = t.point[k].velocity[i];
      points[k].acceleration[i] = t.point[k].acceleration[i];
      const double side = k / 40 % 2 == 0 ? 50e-6 : -50e-6;
      measured[k][i] = t.measured[k][i] + (limited ? side : 0.0);
    }
  }
  const control::Predictive<N> law({}, few);
  typename control::Predictive<N>::State s;
  int most = 0;
  measure(
      state,
      [&](std::size_t k) {
        if (k == 0) s = {};  // the points begin anew
        benchmark::DoNotOptimize(law.step(s, std::span(points).subspan(k), measured[k]));
        most = std::max(most, s.iterations);
      },
      kFewBatches);
  state.counters["iterations"] = most;
}

void predictive_2(benchmark::State& state, bool limited) { predictive<2>(state, limited); }
void predictive_3(benchmark::State& state, bool limited) { predictive<3>(state, limited); }

BENCHMARK(contouring)->Name("Contouring")->Iterations(1);
BENCHMARK_CAPTURE(predictive_2, free, false)->Name("Predictive/2/free")->Iterations(1);
BENCHMARK_CAPTURE(predictive_2, limited, true)->Name("Predictive/2/limited")->Iterations(1);
BENCHMARK_CAPTURE(predictive_3, free, false)->Name("Predictive/3/free")->Iterations(1);
BENCHMARK_CAPTURE(predictive_3, limited, true)->Name("Predictive/3/limited")->Iterations(1);
BENCHMARK_CAPTURE(sliding, printed, control::SwitchingGain::kPrinted)
    ->Name("SlidingMode/printed")
    ->Iterations(1);
BENCHMARK_CAPTURE(sliding, sufficient, control::SwitchingGain::kSufficient)
    ->Name("SlidingMode/sufficient")
    ->Iterations(1);
BENCHMARK(sliding_with_path)->Name("SlidingModeWithPath")->Iterations(1);
BENCHMARK(path_point)->Name("PathPoint")->Iterations(1);
BENCHMARK(three_pids)->Name("ThreePids")->Iterations(1);

}  // namespace
