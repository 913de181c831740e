/// The real-time tier allocates nothing: every step runs under a guard that counts calls of operator new.
/// That it neither throws nor needs exceptions is proved by the preset rt, which compiles it without them.

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>
#include <span>
#include <stribeck/control/laws.hpp>
#include <stribeck/control/pd.hpp>
#include <stribeck/control/supervision/supervisor.hpp>
#include <stribeck/friction/table.hpp>
#include <stribeck/friction/test_maps.hpp>
#include <stribeck/path/contour_error.hpp>
#include <stribeck/path/curve.hpp>
#include <stribeck/path/fourier.hpp>
#include <stribeck/path/reference.hpp>
#include <vector>

namespace {
std::atomic<long> allocations{0};
}

// NOLINTBEGIN: replacing the global operators is the point.
void* operator new(std::size_t size) {
  ++allocations;
  if (void* p = std::malloc(size)) return p;
  std::abort();
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
// NOLINTEND

namespace stribeck::no_allocation_test {
namespace {

/// Allocations while f runs.
template <class F>
long allocated(F&& f) {
  const long before = allocations;
  f();
  return allocations - before;
}

friction::AxisModel gaussian_model() {
  friction::AxisModel m;
  m.mass = 57650.0;
  m.friction.steady = friction::test::table_2_3_x();
  m.friction.eccentric.push_back({10.0, 5e-3, 0.3, friction::EccentricForm::kAdditive});
  return m;
}

control::CompensationParams compensation(control::Observer observer) {
  control::CompensationParams p;
  p.model = gaussian_model();
  p.feedforward = control::Feedforward::kSteady;
  p.observer = observer;
  return p;
}

TEST(RealTime, GuardSeesAnAllocation) {
  EXPECT_EQ(allocated([] { ::operator delete(::operator new(8)); }), 1);
}

TEST(RealTime, PdWithAnyObserverAllocatesNothing) {
  for (const auto observer : {control::Observer::kNone, control::Observer::kDisturbance,
                              control::Observer::kKalman, control::Observer::kAdaptive}) {
    EXPECT_EQ(allocated([&] {
                control::Pd::Params params;
                params.gains = control::Gains::critical(40.0);
                params.compensation = compensation(observer);
                const control::Pd controller(params, 5e-3);  // configuring does not either
                control::Pd::State state;
                for (int k = 0; k < 100; ++k) controller.step(state, {1e-6 * k, 1e-3, 0.0, 0.9e-6 * k});
                controller.step(state, {0.0, 1.0, 0.0, std::nan("")});
              }),
              0);
  }
}

template <class... Params, class F>
void for_each_law(const std::variant<Params...>*, F&& f) {
  (f(Params()), ...);
}

/// Every law of laws.hpp along a path, with the exact contour error and an input that is not finite.
template <class C>
void expect_no_allocation_along(const C& curve, path::FrameKind frame) {
  constexpr std::size_t kAxes = C::kAxes;
  for_each_law(static_cast<const control::LawParams*>(nullptr), [&](const auto& params) {
    using Controller = typename std::decay_t<decltype(params)>::template Controller<kAxes>;
    control::Setup<kAxes> setup;
    setup.period = 5e-3;
    setup.lap = curve.period();
    for (std::size_t i = 0; i < kAxes; ++i)
      setup.compensation[i] =
          compensation(i % 2 == 0 ? control::Observer::kAdaptive : control::Observer::kKalman);
    EXPECT_EQ(allocated([&] {
                const Controller controller(params, setup);  // configuring does not either
                typename Controller::State state;
                path::Reference reference(curve, {9.5e-3, 1.0, 10e-3}, path::Pace::kSpeed, frame);
                double sum = 0.0;
                while (!reference.finished()) {
                  const auto r = reference.point();
                  sum += controller.step(state, r, r.position)[0] +
                         path::contour_error(curve, r.position, r.phi);
                  reference.advance(5e-3);
                }
                auto broken = reference.point();
                broken.frame_rate[0][0] = std::nan("");
                controller.step(state, broken, broken.position);
                // Cycles that the host missed: a few, and so many that the motion begins anew.
                for (const int periods : {3, 1, 50, 1, 1}) {
                  state.periods = periods;
                  sum += controller.step(state, reference.point(), reference.point().position)[0];
                }
                ASSERT_TRUE(std::isfinite(sum));
              }),
              0)
        << params.kKind;
  });
}

TEST(RealTime, PredictiveControlAtItsLimitsAllocatesNothing) {
  constexpr std::size_t kTicks = 400;
  std::array<path::PathPoint<2>, kTicks> points;
  path::Reference reference(path::Curve{path::Shape::kCircle, 10e-3}, {9.5e-3, 1.0, 10e-3});
  for (auto& r : points) {
    r = reference.point();
    reference.advance(5e-3);
  }
  control::Setup<2> setup;
  setup.period = 5e-3;
  setup.compensation.fill(compensation(control::Observer::kKalman));
  setup.force_limit = {{1700.0, 1700.0}};
  int iterations = 0;
  EXPECT_EQ(allocated([&] {
              const control::Predictive<2> controller({}, setup);
              control::Predictive<2>::State state;
              for (std::size_t k = 0; k < kTicks; ++k) {
                controller.step(state, std::span(points).subspan(k), points[k].position);
                iterations += state.iterations;
              }
            }),
            0);
  EXPECT_GT(iterations, 0);
}

path::Fourier<3> saddle() {
  path::Fourier<3> c;
  c.axis[0].terms = {path::Harmonic{10e-3, 1.0, 0.0}};
  c.axis[1].terms = {path::Harmonic{10e-3, 1.0, -0.5 * kPi}};
  c.axis[2].terms = {path::Harmonic{3e-3, 2.0, -0.5 * kPi}};
  return c;
}

TEST(RealTime, NoLawAllocatesAlongAPath) {
  expect_no_allocation_along(path::Curve{path::Shape::kTrifolium, 10e-3}, path::FrameKind::kTransported);
  for (const auto frame :
       {path::FrameKind::kTransported, path::FrameKind::kFrenet, path::FrameKind::kPrinted})
    expect_no_allocation_along(saddle(), frame);
}

TEST(RealTime, SupervisionAllocatesNothingOverFaultStopAndReset) {
  // From rest on, so that encoder, command and force belong together and nothing but the lost encoder is a fault.
  path::Reference reference(saddle(), {9.5e-3, 1.0, 10e-3});
  std::vector<decltype(reference.point())> points;
  for (; points.size() < 220; reference.advance(5e-3)) points.push_back(reference.point());
  control::Setup<3> setup;
  setup.period = 5e-3;
  for (auto& c : setup.compensation) {
    c = compensation(control::Observer::kKalman);
    c.adaptation.enabled = true;
  }
  setup.force_limit = {{10e3, 10e3, 10e3}};
  control::Supervision<3> limits;
  for (auto& p : limits) p.speed_limit = 20e-3;
  EXPECT_EQ(allocated([&] {
              const control::Supervised<control::Contouring<3>, 3> controller({}, setup, limits);
              control::Supervised<control::Contouring<3>, 3>::State state;
              for (std::size_t k = 0; k < points.size(); ++k) {
                auto encoder = points[k].position;
                if (k >= 200) encoder[1] = std::nan("");
                controller.step(state, points[k], encoder);
              }
              ASSERT_EQ(state.watch.fault, control::Fault::kEncoderLost);
              controller.reset(state);
              ASSERT_TRUE(std::isfinite(controller.step(state, points.back(), points.back().position)[0]));
            }),
            0);
}

TEST(RealTime, NoWayToSwitchAllocates) {
  path::Reference reference(saddle(), {9.5e-3, 1.0, 10e-3});
  while (reference.time() < 1.0) reference.advance(5e-3);
  const auto r = reference.point();
  for (const auto switching : {control::Switching::kSign, control::Switching::kBoundaryLayer,
                               control::Switching::kTanh, control::Switching::kSuperTwisting}) {
    control::SlidingModeParams params;
    params.switching = switching;
    params.gain = control::SwitchingGain::kSufficient;
    control::Setup<3> setup;
    for (auto& c : setup.compensation) c = compensation(control::Observer::kAdaptive);
    EXPECT_EQ(allocated([&] {
                const control::SlidingMode<3> controller(params, setup);
                control::SlidingMode<3>::State state;
                for (int k = 0; k < 10; ++k)
                  ASSERT_TRUE(std::isfinite(controller.step(state, r, r.position)[0]));
              }),
              0);
  }
}

TEST(RealTime, FrictionModelsAllocateNothing) {
  const friction::Table table = friction::Table::build(friction::test::table_2_3_x(), 9.5e-3);
  EXPECT_EQ(allocated([&] {
              friction::LuGre<double> lugre{3e8, 600e3, 0.05e-3};
              friction::LuGre<double>::State bristle;
              friction::Gms<double> gms;
              for (int i = 0; i < 4; ++i) gms.elements.push_back({1e8, 0.25});
              gms.attraction = 1e5;
              friction::Gms<double>::State elements;
              double sum = 0.0;
              for (int k = 0; k < 100; ++k) {
                const double v = 1e-3 * (k - 50);
                sum += lugre.step(table, bristle, v, 0.0, 1e-3) +
                       gms.step(friction::test::table_2_3_y(), elements, v, 0.0, 1e-3);
              }
              ASSERT_TRUE(std::isfinite(sum));
            }),
            0);
}

}  // namespace
}  // namespace stribeck::no_allocation_test
