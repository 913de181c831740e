#include <algorithm>
#include <cmath>
#include <stribeck/ident/circle/minimum_zone.hpp>
#include <vector>

namespace stribeck::ident::circle {
namespace {

/// One point seen from the centre of the linearisation.
struct Ray {
  double distance;  ///< beyond the smallest one: small numbers keep their digits
  double ux;
  double uy;
};

/// Value and slopes of the linearised width at one δ.
struct Tangent {
  double at = 0.0;  ///< coordinate that is searched
  double value = 0.0;
  double slope = 0.0;   ///< along that coordinate
  double across = 0.0;  ///< along the other one
};

Tangent width_at(std::span<const Ray> rays, double dx, double dy) {
  const Ray* outer = nullptr;
  const Ray* inner = nullptr;
  double most = -HUGE_VAL;
  double least = HUGE_VAL;
  for (const Ray& ray : rays) {
    const double d = ray.distance - ray.ux * dx - ray.uy * dy;
    if (d > most) {
      most = d;
      outer = &ray;
    }
    if (d < least) {
      least = d;
      inner = &ray;
    }
  }
  return {dy, most - least, inner->uy - outer->uy, inner->ux - outer->ux};
}

/// The smallest value of a convex function between `low` and `high`, from its tangents.
template <class Evaluate>
Tangent lowest(Evaluate&& evaluate, double low, double high) {
  constexpr int kMost = 200;
  const double rounding = 1e-13 * (high - low);
  Tangent left = evaluate(low);
  if (left.slope >= 0.0) return left;
  Tangent right = evaluate(high);
  if (right.slope <= 0.0) return right;
  for (int k = 0; k < kMost; ++k) {
    const double at = (right.value - left.value + left.slope * left.at - right.slope * right.at) /
                      (left.slope - right.slope);
    const double floor = left.value + left.slope * (at - left.at);
    Tangent middle = evaluate(std::clamp(at, left.at, right.at));
    // On both tangents: at the optimum the slope across is that of the mixture whose slope along is zero.
    if (middle.value <= floor + rounding || at <= left.at || at >= right.at) {
      const double share = right.slope / (right.slope - left.slope);
      middle.across = share * left.across + (1.0 - share) * right.across;
      middle.slope = 0.0;
      return middle;
    }
    (middle.slope < 0.0 ? left : right) = middle;
    if (middle.slope == 0.0) return middle;
  }
  return left.value < right.value ? left : right;
}

struct Rays {
  std::vector<Ray> all;
  double outer = 0.0;
  double inner = HUGE_VAL;
};

Rays rays_from(std::span<const double> x, std::span<const double> y, const Centre& c) {
  Rays r;
  r.all.reserve(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double dx = x[i] - c.x;
    const double dy = y[i] - c.y;
    const double d = std::hypot(dx, dy);
    r.all.push_back({d, d > 0.0 ? dx / d : 0.0, d > 0.0 ? dy / d : 0.0});
    r.outer = std::max(r.outer, d);
    r.inner = std::min(r.inner, d);
  }
  for (Ray& ray : r.all) ray.distance -= r.inner;
  return r;
}

}  // namespace

MinimumZone minimum_zone(std::span<const double> x, std::span<const double> y, const Centre& near) {
  constexpr int kMostSteps = 30;
  if (x.empty()) return {near, 0.0, 0.0, 0.0};
  Centre centre = near;
  Rays now = rays_from(x, y, centre);
  for (int step = 0; step < kMostSteps; ++step) {
    // The centre of the zone is at most a width away from any centre with that width.
    const double reach = now.outer - now.inner;
    if (!(reach > 0.0)) break;
    const Tangent best = lowest(
        [&](double at_x) {
          const Tangent along_y =
              lowest([&](double at_y) { return width_at(now.all, at_x, at_y); }, -reach, reach);
          return Tangent{at_x, along_y.value, along_y.across, along_y.at};
        },
        -reach, reach);
    const double dx = best.at;
    const double dy = lowest([&](double at_y) { return width_at(now.all, dx, at_y); }, -reach, reach).at;
    // Far from the centre the linearisation may promise too much: then a shorter step.
    bool lower = false;
    for (double share = 1.0; share > 1e-3 && !lower; share *= 0.5) {
      const Centre tried{centre.x + share * dx, centre.y + share * dy};
      Rays there = rays_from(x, y, tried);
      lower = there.outer - there.inner < now.outer - now.inner;
      if (!lower) continue;
      centre = tried;
      now = std::move(there);
    }
    if (!lower) break;
  }
  return {centre, now.inner, now.outer, now.outer - now.inner};
}

}  // namespace stribeck::ident::circle
