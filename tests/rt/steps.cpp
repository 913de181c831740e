/// One function for each step of the real-time tier; see CMakeLists.txt for what compiling it proves.

#include <stribeck/control/contouring.hpp>
#include <stribeck/friction/table.hpp>
#include <stribeck/path/contour_error.hpp>

namespace stribeck::rt {

double pd(const control::Pd& law, control::Pd::State& state, const control::Pd::Input& input) {
  return law.step(state, input);
}

Vec2 contouring(const control::Contouring& law, control::Contouring::State& state, const path::PathPoint& r,
                const Vec2& x) {
  return law.step(state, r, x);
}

double disturbance(const control::DisturbanceObserver& o, control::DisturbanceObserver::State& s, double f,
                   double v) {
  return o.step(s, f, v);
}

double kalman(const control::KalmanObserver& o, control::KalmanObserver::State& s, double f, double x) {
  return o.step(s, f, x);
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

path::PathPoint path_point(path::Reference& reference, double dt) {
  reference.advance(dt);
  return reference.point();
}

double error(const path::Curve& curve, const Vec2& p, double phi) {
  return path::contour_error(curve, p, phi);
}

}  // namespace stribeck::rt
