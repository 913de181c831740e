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
constexpr double kWideSwing = 0.5;  ///< [rad] in a sample; less: a spline through the ticks is the motion
constexpr int kMostTurns = 6;
constexpr double kSameCut = 0.3;   ///< of ln σ0: the pieces need not be cut anew
constexpr double kSettled = 1e-3;  ///< of ln σ0
constexpr double kMostMoved =
    0.1;  ///< largest change of ln σ0 that is taken: beyond it, law and motion repeat each other's error
constexpr double kPoor = 0.4;         ///< share of the static residual that is left: other starts are tried
constexpr double kClearlyLess = 0.7;  ///< less by this factor: the other start is right
constexpr std::size_t kFewRows = 20;
constexpr std::size_t kMostRowsForStarts = 20'000;  ///< one fit alone takes long
constexpr std::size_t kMostRows = 6'000;
constexpr std::size_t kFewPieces = 40;
constexpr std::size_t kFarTooManyRows = 40'000;  ///< with more rows, eight pieces do in place of forty
constexpr std::size_t kFewestPieces = 8;
/// Prior: ln of v_d over the speed δ·√(σ0/m) of a free swing through the break-away distance.
constexpr double kFading = -1.0;
constexpr double kFadingSpread = 1.5;
/// Prior of a rise that the steady map has not seen: ln of a share of the level (0.2), and ln of its width over the slowest speed of the map.
constexpr double kRiseHeight = -1.6;
constexpr double kRiseSpread = 1.0;
constexpr double kRiseWidth = -1.0;
constexpr double kRiseWidthSpread = 0.7;

Prior common_prior(const Given& given, const Rows& rows, int own) {
  const Index n = own + kCommon + rows.path.starts;
  Prior prior{VectorXd::Zero(n), VectorXd::Constant(n, 0.7)};
  prior.sd(own + kForward) = prior.sd(own + kBackward) = given.options.level_tolerance;
  prior.sd(own + kMass) = given.options.mass_tolerance.value_or(given.open ? 0.05 : 0.005);
  prior.sd(own + kLoad) = given.options.load_tolerance;
  prior.sd(own + kViscous) = given.options.viscous_tolerance;
  prior.mean(own + kRise) = kRiseHeight;
  prior.sd(own + kRise) = kRiseSpread;
  prior.mean(own + kWidth) = kRiseWidth;
  prior.sd(own + kWidth) = kRiseWidthSpread;
  return prior;
}

/// In closed loop the given mass is kept: least squares would take noise of the acceleration for a smaller
/// mass. Its tolerance still widens the intervals.
std::vector<Index> free_of(const Given& given, const Prior& prior, int own) {
  std::vector<Index> all;
  for (Index i = 0; i < prior.mean.size(); ++i) {
    if (!given.open && i == own + kMass) continue;
    if (given.options.unseen_below <= 0.0 && (i == own + kRise || i == own + kWidth)) continue;
    all.push_back(i);
  }
  return all;
}

Solution solved(const Rows& rows, const Model& model, const VectorXd& from, const std::vector<Index>& free,
                const Prior& prior, int iterations) {
  return solve(model, {&from, &free, &rows.every_row, &prior, rows.noise}, iterations);
}

/// Phase by which the mass swings on its bristles in one sample [rad].
double swing_of(const Given& given, double break_away) {
  return given.records->front().sample_time * std::sqrt(given.level / break_away / given.known->mass);
}

void cut(const Given& given, double break_away, Rows& rows) {
  const double swing = swing_of(given, break_away);
  rows.path = cut_path(*given.records, given.data, *given.known,
                       {break_away, given.options.shift, given.open, swing > kWideSwing ? swing : 0.0});
  // Six thousand rows tell a stiffness to a part in a hundred; all of a long log take as long as all other steps together.
  if (rows.path.rows.size() > kMostRows) {
    BristlePath part = part_of(rows.path, kMostRows);
    if (part.pieces.size() < kFewPieces) part = shortest_of(rows.path, kMostRows, kFewPieces);
    const bool enough = part.pieces.size() >= kFewPieces;
    if ((enough ? part : rows.path).rows.size() > kFarTooManyRows) {
      // Slow jogs have thousands of rows after each reversal.
      part = shortest_of(rows.path, kMostRows, kFewestPieces);
      rows.path =
          part.pieces.size() >= kFewestPieces ? std::move(part) : shortened(rows.path, kFarTooManyRows);
    } else if (enough) {
      rows.path = std::move(part);
    }
  }
  rows.setting.path = &rows.path;
  rows.setting.unseen = given.options.unseen_below;
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

/// First fits the stiffness alone, which gives the scale of the noise; then everything, from several fading velocities. Which one
/// leads to the least shows on a part of many reversals.
Solution start_lugre(const Given& given, const Fitted& f, Rows& rows) {
  const auto model = lugre_model(rows.setting);
  std::vector<Index> first = f.free;
  first.erase(first.begin() + 1, first.begin() + 3);
  rows.noise = 0.05 * rows.setting.scales.level;
  const Solution coarse = solved(rows, *model, f.prior.mean, first, f.prior, kIterations);
  weigh(given, *model, coarse.p, rows);
  Rows part;
  Fitted few;
  const bool in_part = lay_part(rows, f, part, few);
  const Fitted& law = in_part ? few : f;
  const Rows& on = in_part ? part : rows;
  const auto started = lugre_model(on.setting);
  const Index count = in_part ? few.own + kCommon : coarse.p.size();
  Solution best;
  for (const double fading : {-2.5, -1.0, 0.5}) {
    VectorXd from = coarse.p.head(count);
    from(2) = fading;
    Solution s = solved(on, *started, from, law.free, law.prior, kFoldIterations);
    if (s.cost < best.cost) best = std::move(s);
  }
  if (!in_part || !std::isfinite(best.cost)) return best;
  VectorXd whole = coarse.p;
  whole.head(count) = best.p;
  best.p = std::move(whole);
  return best;
}

double rms_of(const Model& model, const VectorXd& p) {
  VectorXd e;
  model.evaluate(p, e, nullptr, false);
  return std::sqrt(e.squaredNorm() / static_cast<double>(std::max<Index>(1, e.size())));
}

/// Simulates the motion between the ticks with the present law, then fits the law to it, in turns until the stiffness no longer
/// changes. A motion that describes the force worse than the spline is not taken.
Solution solve_swinging(const Given& given, const Fitted& f, Rows& rows) {
  const auto model = lugre_model(rows.setting);
  Solution at = f.solution;
  const BristlePath spline = rows.path;
  const double noise = rows.noise;
  const double before = rms_of(*model, at.p);
  for (int turn = 0; turn < kMostTurns; ++turn) {
    const double stiffness = at.p(0);
    model->follow(at.p, *given.known, rows.path);
    rows.path.whitening.clear();
    weigh(given, *model, at.p, rows);
    Solution next = solved(rows, *model, VectorXd(at.p), f.free, f.prior, kIterations);
    if (!std::isfinite(next.cost)) break;
    at = std::move(next);
    if (std::abs(at.p(0) - stiffness) < kSettled) break;
  }
  if (rms_of(*model, at.p) < before && std::abs(at.p(0) - f.solution.p(0)) < kMostMoved) return at;
  rows.path = spline;
  rows.noise = noise;
  return f.solution;
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

/// Where a fit may begin.
double start_of(const Given& given, double guess) {
  return std::clamp(guess, std::max(0.5 * given.quantum, 1e-6 * given.stroke), given.stroke);
}

/// The fit that begins at one break-away distance.
std::string fit_from(const Given& given, double guess, Rows& rows, Fitted& lugre) {
  constexpr int kOwn = LuGreCase::kMostOwn;
  lugre.own = kOwn;
  guess = start_of(given, guess);
  for (int pass = 0; pass < kPasses; ++pass) {
    cut(given, guess, rows);
    if (rows.path.rows.size() < kFewRows)
      return "only " + std::to_string(rows.path.rows.size()) + " rows lie near its reversals";
    lugre.prior = lugre_prior(given, rows, kOwn);
    lugre.free = free_of(given, lugre.prior, kOwn);
    lugre.solution = start_lugre(given, lugre, rows);
    const bool last = pass + 1 == kPasses;
    if (std::isfinite(lugre.solution.cost) && (last || std::abs(lugre.solution.p(0)) < kSameCut)) {
      lugre.solution = solved(rows, *lugre_model(rows.setting), VectorXd(lugre.solution.p), lugre.free,
                              lugre.prior, kIterations);
    }
    if (!std::isfinite(lugre.solution.cost)) return "no stiffness describes its reversals";
    const double change = lugre.solution.p(0);
    if (std::abs(change) < kSameCut || last) break;
    guess = std::clamp(guess * std::exp(-change), std::max(0.1 * given.quantum, 1e-7 * given.stroke),
                       given.stroke);
  }
  if (swing_of(given, guess) > kWideSwing) lugre.solution = solve_swinging(given, lugre, rows);
  return {};
}

/// What LuGre leaves of the residual of static friction after reversals, RMS.
double share_left(const Given& given, const Rows& rows, const Fitted& lugre) {
  VectorXd e, plain;
  lugre_model(rows.setting)->evaluate(lugre.solution.p, e, nullptr, false);
  static_model(rows.setting)->evaluate(fit_static(given, rows).solution.p, plain, nullptr, false);
  double left = 0.0, all = 0.0;
  for (std::size_t k = 0; k < rows.path.rows.size(); ++k) {
    if (!rows.path.rows[k].turning) continue;
    left += e(static_cast<Index>(k)) * e(static_cast<Index>(k));
    all += plain(static_cast<Index>(k)) * plain(static_cast<Index>(k));
  }
  return all > 0.0 ? std::sqrt(left / all) : 1.0;
}

}  // namespace

std::string fit_lugre(const Given& given, double guess, Rows& rows, Fitted& lugre) {
  const std::string why = fit_from(given, guess, rows, lugre);
  if (!why.empty()) return why;
  double least = share_left(given, rows, lugre);
  if (least > kPoor && rows.path.rows.size() < kMostRowsForStarts && !given.options.near) {
    // The first guess may lie beside a wrong minimum: one break-away distance is tried far on either side of it.
    // Starts that the encoder or the stroke bounds to the same distance are one.
    double best = start_of(given, guess), last = best;
    std::vector<double> tried{best};
    for (const double times : {16.0, 4.0, 1.0 / 4.0, 1.0 / 16.0}) {
      const double start = start_of(given, times * guess);
      if (std::find(tried.begin(), tried.end(), start) != tried.end()) continue;
      tried.push_back(last = start);
      if (!fit_from(given, start, rows, lugre).empty()) continue;
      const double left = share_left(given, rows, lugre);
      if (left < kClearlyLess * least) least = left, best = start;
    }
    if (best != last) fit_from(given, best, rows, lugre);
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
