// Friction of a model along a measured motion.
#include <algorithm>
#include <cmath>
#include <stribeck/ident/replay/model_force.hpp>

namespace stribeck::ident::replay {
namespace {

constexpr double kAtStandstill = 1e-3;  // of the top speed: what a filter leaves of an axis at rest

}  // namespace

std::vector<double> friction_along(const friction::Model& model, std::span<const double> x,
                                   std::span<const double> v, double period, double push) {
  const std::size_t n = x.size();
  std::vector<double> f(n);
  if (n == 0) return f;
  double top = 0.0;
  for (const double s : v) top = std::max(top, std::abs(s));
  const double still = kAtStandstill * top;
  std::visit(
      [&]<class Base, class Law>(const Base& base, const Law& law) {
        const friction::Composed<Base> map = friction::composed(base, model);
        if constexpr (friction::PreSlidingLaw<Law>) {
          typename Law::State state{};
          const auto begin = map.parts(v[0], x[0]);
          if (std::abs(v[0]) > still) {
            law.slide(state, v[0] > 0.0 ? begin.level : -begin.level);
          } else {
            law.carry(state, std::clamp(push - begin.additive, -begin.level, begin.level));
          }
          for (std::size_t k = 0; k < n; ++k) {
            if (k > 0) {
              const double mean = 0.5 * (v[k - 1] + v[k]);
              const double stiffness = friction::shares_at(model.places, x[k]).stiffness;
              law.advance(state, stiffness * mean, map.parts(mean, x[k]).level, period);
            }
            const auto p = map.parts(v[k], x[k]);
            const double stiffness = friction::shares_at(model.places, x[k]).stiffness;
            f[k] = law.bristle(state, v[k], p.level, stiffness) + p.viscous + p.additive;
          }
        } else {
          for (std::size_t k = 0; k < n; ++k) f[k] = friction::steady_force(map, v[k], x[k]);
        }
      },
      model.steady, model.dynamics);
  return f;
}

}  // namespace stribeck::ident::replay
