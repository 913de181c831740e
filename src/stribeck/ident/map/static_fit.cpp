#include <algorithm>
#include <cmath>
#include <stribeck/ident/map/static_fit.hpp>
#include <string>
#include <utility>

namespace stribeck::ident::map {
namespace {

using Index = Eigen::Index;
using Family = StaticFit::Family;

}  // namespace

std::vector<LevelPoint> level_points(double reach) {
  constexpr int kPoints = 40;
  constexpr double kFrom = 0.2;
  if (!(reach > 0.0)) return {{0.0, 1.0}};
  std::vector<LevelPoint> points;
  const double middle = 0.5 * (kFrom + 1.0) * reach;
  double square = 0.0;
  for (int i = 0; i <= kPoints; ++i) {
    points.push_back({reach * (kFrom + (1.0 - kFrom) * i / kPoints), 0.0});
    square += std::pow(points.back().speed - middle, 2.0);
  }
  for (LevelPoint& p : points) p.weight = 1.0 / (kPoints + 1) - middle * (p.speed - middle) / square;
  return points;
}

double StaticFit::force(int side, double speed) const noexcept {
  const double d = kDirection[static_cast<std::size_t>(side)];
  if (family == Family::kByDirection) {
    const auto s = static_cast<std::size_t>(side);
    return d * load + branch[s].force(speed / top[s]);
  }
  double f = d * load + coulomb + viscous * speed;
  if (family == Family::kSymmetricStribeck)
    f += rise * std::exp(-std::pow(speed / v0, static_cast<double>(exponent)));
  return f;
}

std::size_t StaticFit::parameters() const noexcept {
  if (family == Family::kByDirection) return branch[0].parameters() + branch[1].parameters();
  return family == Family::kSymmetric ? 3 : 5;
}

std::size_t StaticFit::complexity() const noexcept {
  if (family == Family::kByDirection) return branch[0].complexity() + branch[1].complexity();
  return parameters() + (family == Family::kSymmetricStribeck && exponent == Exponent::kOne ? 1 : 0);
}

std::pair<std::size_t, std::size_t> StaticFit::span(int side) const noexcept {
  if (family != Family::kByDirection) return {0, parameters()};
  return side == 0 ? std::pair<std::size_t, std::size_t>{0, branch[0].parameters()}
                   : std::pair{branch[0].parameters(), branch[1].parameters()};
}

void StaticFit::gradient(int side, double speed, double* out) const noexcept {
  const auto s = static_cast<std::size_t>(side);
  if (family == Family::kByDirection) {
    branch[s].gradient(speed / top[s], out);
    return;
  }
  out[0] = kDirection[s];
  out[1] = 1.0;
  out[2] = speed;
  if (family == Family::kSymmetric) return;
  const double r = speed / v0;
  const auto delta = static_cast<double>(exponent);
  const double power = std::pow(r, delta);
  const double e = std::exp(-power);
  out[3] = e;
  out[4] = rise * e * delta * power / v0;
}

double StaticFit::move(const Eigen::VectorXd& step) noexcept {
  double moved = 0.0;
  const auto width = [&](double& w, double by) {
    const double limited = std::clamp(by, -0.5 * w, 0.5 * w);
    w += limited;
    moved = std::max(moved, std::abs(limited) / w);
  };
  const auto height = [&](double& h, double by, double level) {
    h += by;
    moved = std::max(moved, std::abs(by) / std::max(level, 1e-300));
  };
  if (family != Family::kByDirection) {
    const double level = std::abs(coulomb);
    height(load, step(0), level);
    height(coulomb, step(1), level);
    height(viscous, step(2), level / std::max(top[0], top[1]));
    if (family == Family::kSymmetricStribeck) height(rise, step(3), level), width(v0, step(4));
    return moved;
  }
  Index i = 0;
  for (BranchFit& b : branch) {
    const double level = std::abs(b.eta0) + std::abs(b.eta1);
    height(b.eta0, step(i++), level);
    height(b.eta1, step(i++), level);
    for (FitTerm& t : b.terms) {
      height(t.a, step(i++), level);
      if (!b.centred) height(t.b, step(i++), 1.0);
      width(t.c, step(i++));
    }
  }
  return moved;
}

bool StaticFit::plausible() const noexcept {
  if (family != Family::kByDirection)
    return coulomb > 0.0 && coulomb + rise > 0.0 && viscous >= 0.0 &&
           (family == Family::kSymmetric || (v0 > 0.0 && v0 < 2.0 * std::max(top[0], top[1])));
  constexpr int kPoints = 50;
  for (const BranchFit& b : branch) {
    for (int i = 0; i <= kPoints; ++i) {
      const double u = static_cast<double>(i) / kPoints;
      if (!(b.force(u) - b.eta1 * u > 0.0)) return false;
    }
    if (!(b.eta1 >= 0.0)) return false;
  }
  return true;
}

std::string StaticFit::name() const {
  if (family == Family::kSymmetric) return "symmetric, Coulomb and viscous";
  const std::string one = " of exponent 1";
  if (family == Family::kSymmetricStribeck)
    return "symmetric, Coulomb, viscous and Stribeck" + (exponent == Exponent::kOne ? one : "");
  std::string text = "by direction";
  if (branch[0].terms.empty() && branch[1].terms.empty()) return text + ", Coulomb and viscous";
  if (branch[0].centred && branch[1].centred) {
    text += ", Coulomb, viscous and Stribeck";
    if (branch[0].exponential && branch[1].exponential) return text + one;
    if (branch[0].exponential) return text + one + " for v > 0";
    return branch[1].exponential ? text + one + " for v < 0" : text;
  }
  if (!branch[0].centred && !branch[1].centred)
    return text + ", " + std::to_string(branch[0].terms.size()) + " and " +
           std::to_string(branch[1].terms.size()) + " Gaussians";
  const auto name_of = [&](const BranchFit& b) {
    if (b.centred) return "a Stribeck part" + (b.exponential ? one : "");
    return std::to_string(b.terms.size()) + (b.terms.size() == 1 ? " Gaussian" : " Gaussians");
  };
  return text + ", " + name_of(branch[0]) + " and " + name_of(branch[1]);
}

}  // namespace stribeck::ident::map
