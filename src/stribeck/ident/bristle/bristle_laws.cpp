#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stribeck/ident/bristle/bristle_parts.hpp>
#include <utility>

namespace stribeck::ident::bristle {
namespace {

constexpr int kIterations = 40;
constexpr int kStartIterations = 10;
constexpr int kPasses = 4;
constexpr std::size_t kFewRows = 20;
constexpr std::size_t kMostRows = 6'000;
constexpr std::size_t kFewPieces = 40;
/// Prior: ln of v_d over the speed δ·√(σ0/m) of a free swing through the break-away distance.
constexpr double kFading = -1.0;
constexpr double kFadingSpread = 1.5;

Prior common_prior(const Given& given, const Rows& rows, int own) {
  const Index n = own + kCommon + rows.path.starts;
  Prior prior{VectorXd::Zero(n), VectorXd::Constant(n, 0.7)};
  prior.sd(own + kForward) = prior.sd(own + kBackward) = given.options.level_tolerance;
  prior.sd(own + kMass) = given.options.mass_tolerance.value_or(given.open ? 0.05 : 0.005);
  prior.sd(own + kLoad) = given.options.load_tolerance;
  prior.sd(own + kViscous) = given.options.viscous_tolerance;
  return prior;
}

/// In closed loop the given mass is kept: least squares would take noise of the acceleration for a smaller
/// mass. Its tolerance still widens the intervals.
std::vector<Index> free_of(const Given& given, const Prior& prior, int own) {
  std::vector<Index> all;
  for (Index i = 0; i < prior.mean.size(); ++i) {
    if (given.open || i != own + kMass) all.push_back(i);
  }
  return all;
}

Solution solved(const Rows& rows, const Model& model, const VectorXd& from, const std::vector<Index>& free,
                const Prior& prior, int iterations) {
  return solve(model, {&from, &free, &rows.every_row, &prior, rows.noise}, iterations);
}

void cut(const Given& given, double break_away, Rows& rows) {
  rows.path =
      cut_path(*given.records, given.data, *given.known, {break_away, given.options.shift, given.open});
  // Six thousand rows tell a stiffness to a part in a hundred; all of a long log take as long as all other steps together.
  if (rows.path.rows.size() > kMostRows) {
    BristlePath part = part_of(rows.path, kMostRows);
    if (part.pieces.size() < kFewPieces) part = shortest_of(rows.path, kMostRows, kFewPieces);
    if (part.pieces.size() >= kFewPieces) rows.path = std::move(part);
  }
  rows.setting.path = &rows.path;
  rows.setting.scales.break_away = break_away;
  rows.setting.fastest = 1e-12;
  for (const PathStep& step : rows.path.steps)
    rows.setting.fastest = std::max(rows.setting.fastest, std::abs(step.v));
  const double root = std::sqrt(rows.setting.scales.level / break_away * given.known->mass);
  rows.setting.scales.damping = root;
  rows.setting.scales.fading = break_away * root / given.known->mass;
  rows.every_row.assign(rows.path.rows.size(), 1);
}

/// Whitening, and the noise that a row would have if it were independent of its neighbours, so that the prior
/// has the right weight.
void weigh(const Given& given, const Model& model, const VectorXd& p, Rows& rows) {
  VectorXd e;
  model.evaluate(p, e, nullptr);
  // After programmed forces the axis rings within a few encoder steps; whitening would give that ringing the highest weight
  // (σ0 +0.7 % instead of +0.1 % on pulses of the biaxial table).
  if (!given.open) rows.path.whitening = whitening_of(rows.path, e.data());
  model.evaluate(p, e, nullptr);
  const double square =
      e.squaredNorm() / static_cast<double>(e.size()) * 2.0 * memory_of_rows(rows.path, e).rows;
  rows.noise = std::max(1e-9 * rows.setting.scales.level, std::sqrt(square));
}

/// Sets negative damping (number `damping`, followed by its velocity) to zero; then computes mass and spread.
void finish(const Given& given, const Rows& rows, const Model& model, Index damping, Fitted& f) {
  VectorXd& p = f.solution.p;
  std::vector<Index> spread_over = f.free;
  if (p(damping) <= 0.0) {
    VectorXd at = p;
    at(damping) = 0.0;
    f.free.erase(f.free.begin() + damping, f.free.begin() + damping + 2);
    const Solution s = solved(rows, model, at, f.free, f.prior, kIterations);
    p = std::isfinite(s.cost) ? s.p : at;
  }
  const Index mass = f.own + kMass;
  if (given.open) {
    correct_mass(model, p, f.free, f.prior, rows.noise);
  } else {
    spread_over.push_back(mass);
  }
  f.spread = spread_of(model, p, spread_over, f.prior, rows.noise, given.open ? mass : -1);
}

Prior lugre_prior(const Given& given, const Rows& rows, int own) {
  Prior prior = common_prior(given, rows, own);
  prior.sd(0) = 3.0;
  prior.sd(1) = 3.0;
  prior.mean(2) = kFading;
  prior.sd(2) = kFadingSpread;
  return prior;
}

/// First fits the stiffness alone, which gives the scale of the noise; then everything, from several fading velocities.
Solution solve_lugre(const Given& given, const Fitted& f, Rows& rows) {
  const auto model = lugre_model(rows.setting);
  std::vector<Index> first = f.free;
  first.erase(first.begin() + 1, first.begin() + 3);
  rows.noise = 0.05 * rows.setting.scales.level;
  const Solution coarse = solved(rows, *model, f.prior.mean, first, f.prior, kIterations);
  weigh(given, *model, coarse.p, rows);
  Solution best;
  for (const double fading : {-2.5, -1.0, 0.5}) {
    VectorXd from = coarse.p;
    from(2) = fading;
    Solution s = solved(rows, *model, from, f.free, f.prior, kFoldIterations);
    if (s.cost < best.cost) best = std::move(s);
  }
  if (std::isfinite(best.cost)) best = solved(rows, *model, VectorXd(best.p), f.free, f.prior, kIterations);
  return best;
}

Prior gms_prior(const Given& given, const Rows& rows, int own) {
  const int N = given.options.elements;
  const Index damping = gms_damping(N);
  Prior prior = common_prior(given, rows, own);
  prior.sd(0) = 3.0;
  for (int i = 1; i < N; ++i) {
    prior.mean(i) = std::log(0.7);
    prior.sd(i) = 0.7;
    prior.sd(N + i - 1) = 1.5;
  }
  prior.sd(damping - 1) = 1.0;
  prior.sd(damping) = 3.0;
  prior.mean(damping + 1) = kFading;
  prior.sd(damping + 1) = kFadingSpread;
  return prior;
}

}  // namespace

std::string fit_lugre(const Given& given, double guess, Rows& rows, Fitted& lugre) {
  constexpr int kOwn = LuGreCase::kMostOwn;
  lugre.own = kOwn;
  guess = std::clamp(guess, std::max(0.5 * given.quantum, 1e-6 * given.stroke), given.stroke);
  for (int pass = 0; pass < kPasses; ++pass) {
    cut(given, guess, rows);
    if (rows.path.rows.size() < kFewRows)
      return "only " + std::to_string(rows.path.rows.size()) + " rows lie near its reversals";
    lugre.prior = lugre_prior(given, rows, kOwn);
    lugre.free = free_of(given, lugre.prior, kOwn);
    lugre.solution = solve_lugre(given, lugre, rows);
    if (!std::isfinite(lugre.solution.cost)) return "no stiffness describes its reversals";
    const double change = lugre.solution.p(0);
    if (std::abs(change) < 0.3 || pass + 1 == kPasses) break;
    guess = std::clamp(guess * std::exp(-change), std::max(0.1 * given.quantum, 1e-7 * given.stroke),
                       given.stroke);
  }
  finish(given, rows, *lugre_model(rows.setting), 1, lugre);
  return {};
}

Fitted fit_static(const Given& given, const Rows& rows) {
  Fitted plain;
  plain.prior = common_prior(given, rows, 0);
  plain.free = free_of(given, plain.prior, 0);
  plain.solution =
      solved(rows, *static_model(rows.setting), plain.prior.mean, plain.free, plain.prior, kIterations);
  return plain;
}

std::optional<Fitted> fit_gms(const Given& given, const Rows& rows, const Fitted& lugre) {
  Fitted gms;
  const int own = gms.own = 2 * given.options.elements + 2;
  const Index damping = gms_damping(given.options.elements);
  const auto model = gms_model(rows.setting, own);
  gms.prior = gms_prior(given, rows, own);
  gms.free = free_of(given, gms.prior, own);
  Solution& best = gms.solution;
  for (const auto& [scale, fading] : {std::pair{0.25, -2.0}, std::pair{0.6, -0.5}}) {
    VectorXd from = gms.prior.mean;
    from.tail(kCommon + rows.path.starts) = lugre.solution.p.tail(kCommon + rows.path.starts);
    from(0) = std::log(scale) - lugre.solution.p(0);
    from(damping + 1) = fading;
    Solution s = solved(rows, *model, from, gms.free, gms.prior, kStartIterations);
    if (s.cost < best.cost) best = std::move(s);
  }
  if (!std::isfinite(best.cost)) return {};
  best = solved(rows, *model, VectorXd(best.p), gms.free, gms.prior, kIterations);
  if (!std::isfinite(best.cost)) return {};
  finish(given, rows, *model, damping, gms);
  return gms;
}

}  // namespace stribeck::ident::bristle
