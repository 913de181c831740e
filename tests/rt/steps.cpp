/// One function for each step of the real-time tier; see CMakeLists.txt for what compiling it proves.

#include <stribeck/control/compensation/reversal_feedforward.hpp>
#include <stribeck/control/laws.hpp>
#include <stribeck/control/observers/cutting_force_observer.hpp>
#include <stribeck/control/pd.hpp>
#include <stribeck/control/supervision/supervisor.hpp>
#include <stribeck/friction/table.hpp>
#include <stribeck/path/contour_error.hpp>
#include <stribeck/path/curve.hpp>
#include <stribeck/path/five_axis.hpp>
#include <stribeck/path/fourier.hpp>
#include <stribeck/path/reference.hpp>
#include <stribeck/path/spline.hpp>

namespace stribeck::rt {

double pd(const control::Pd& law, control::Pd::State& state, const control::Pd::Input& input) {
  return law.step(state, input);
}

/// The step of each law of laws.hpp with N axes.
template <std::size_t N, class... Params>
struct Laws {
  template <class Controller>
  static Vec<double, N> step(const Controller& law, typename Controller::State& state,
                             const path::PathPoint<N>& r, const Vec<double, N>& x) {
    return law.step(state, r, x);
  }
  static constexpr std::tuple kSteps{&step<typename Params::template Controller<N>>...};
};
template <std::size_t N, class... Params>
auto steps_of(const std::variant<Params...>*) {
  return Laws<N, Params...>::kSteps;
}
auto laws_1() { return steps_of<1>(static_cast<const control::LawParams*>(nullptr)); }
auto laws_2() { return steps_of<2>(static_cast<const control::LawParams*>(nullptr)); }
auto laws_3() { return steps_of<3>(static_cast<const control::LawParams*>(nullptr)); }
auto laws_5() { return steps_of<5>(static_cast<const control::LawParams*>(nullptr)); }

Vec<double, 5> with_points_ahead(const control::Predictive<5>& law, control::Predictive<5>::State& s,
                                 std::span<const path::PathPoint<5>> ahead, const Vec<double, 5>& x) {
  return law.step(s, ahead, x);
}

/// Supervision apart from a law, as the C interface calls it.
template <std::size_t N>
struct Watching {
  using S = control::Supervisor<N>;
  static bool admit(const S& s, typename S::State& state, typename S::Law& law, path::PathPoint<N>& r,
                    Vec<double, N>& x) {
    return s.admit(state, law, r, x);
  }
  static Vec<double, N> judge(const S& s, typename S::State& state, typename S::Law& law,
                              const path::PathPoint<N>& r, const Vec<double, N>& force) {
    return s.judge(state, law, r, force);
  }
  static Vec<double, N> stopped(const S& s, typename S::State& state) { return s.stopped(state); }
  static void reset(const S& s, typename S::State& state, typename S::Law& law) { s.reset(state, law); }
};
template struct Watching<1>;
template struct Watching<2>;
template struct Watching<3>;
template struct Watching<5>;

double disturbance(const control::DisturbanceObserver& o, control::DisturbanceObserver::State& s, double f,
                   double v) {
  return o.step(s, f, v);
}

double kalman(const control::KalmanObserver& o, control::KalmanObserver::State& s, double f, double x) {
  return o.step(s, f, x);
}

double reversal(const control::ReversalFeedforward& o, control::ReversalFeedforward::State& s,
                const control::MotionAhead& r) {
  return o.step(s, r, r.velocity).sum();
}

double cutting(const control::CuttingForceObserver<2>& o, control::CuttingForceObserver<2>::State& s,
               double f, double r, double v, double x) {
  o.step(s, f, r, v, x);
  return o.coming(s);
}

double model(const friction::Model& m, double v, double x) {
  const auto p = m.parts(v, x);
  return p.level * sign(v) + p.viscous + p.additive;
}

double lugre(const friction::LuGre<double>& law, const friction::Gaussian<double>& map,
             friction::LuGre<double>::State& s, double v) {
  return law.step(map, s, v, 0.0, 1e-3);
}

double gms(const friction::Gms<double>& law, const friction::Table& map, friction::Gms<double>::State& s,
           double v) {
  return law.step(map, s, v, 0.0, 1e-3);
}

template <class C>
path::PathPoint<C::kAxes> next_point(path::Reference<C>& reference, double dt) {
  reference.advance(dt);
  return reference.point();
}
template path::PathPoint<2> next_point(path::Reference<path::Curve>&, double);
template path::PathPoint<1> next_point(path::Reference<path::Fourier<1>>&, double);
template path::PathPoint<3> next_point(path::Reference<path::Fourier<3>>&, double);
template path::PathPoint<5> next_point(path::Reference<path::Fourier<5>>&, double);
template path::PathPoint<5> next_point(path::Reference<path::ConeFrustum>&, double);
template path::PathPoint<3> next_point(path::Reference<path::QuinticSpline<3>>&, double);

double error(const path::Curve& curve, const Vec2& p, double phi) {
  return path::contour_error(curve, p, phi);
}

double error_in_space(const path::Fourier<3>& curve, const Vec<double, 3>& p, double phi) {
  return path::contour_error(curve, p, phi);
}

path::TipDeviation error_of_the_tip(const path::ConeFrustum& path, const Vec<double, 5>& q, double phi) {
  return path::tip_deviation(path, q, phi);
}

}  // namespace stribeck::rt
