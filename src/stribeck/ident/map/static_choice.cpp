#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stribeck/ident/map/static_fit.hpp>
#include <stribeck/ident/stats/linear.hpp>
#include <string>
#include <utility>

namespace stribeck::ident::map {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Index = Eigen::Index;
using Family = StaticFit::Family;

constexpr std::size_t kFoldBins = 80;
/// Repeated motion makes paired differences exact: a gain of less than this share of the error does not count.
constexpr double kWorthwhileGain = 0.01;
constexpr double kLeastLevel = 0.05;  ///< of the mean: below it a branch would drive the motion
/// Least level beside viscous friction, and the largest correction to reach it, both of the force at the top of the range.
constexpr double kNoFriction = 1e-3;
constexpr double kWithinNoise = 0.02;
constexpr double kMostHeight = 1.5;  ///< of a term, of the largest friction measured in the direction

/// All blocks except one.
Bins bins_without(const SideSums& side, std::size_t without, std::vector<char>* filled = nullptr) {
  Bins bins;
  const std::size_t count = side.block.front().n.size();
  if (filled != nullptr) filled->assign(count, 0);
  for (std::size_t b = 0; b < count; ++b) {
    double n = 0, v = 0, f = 0;
    for (std::size_t k = 0; k < side.block.size(); ++k) {
      if (k == without) continue;
      n += side.block[k].n[b];
      v += side.block[k].v[b];
      f += side.block[k].f[b];
    }
    if (n <= 0.0) continue;
    bins.u.push_back(v / n / side.grid.high);
    bins.force.push_back(f / n);
    bins.weight.push_back(n);
    if (filled != nullptr) (*filled)[b] = 1;
  }
  return bins;
}

/// Σ residual² of a fit on one block, over bins in which the other blocks have rows too.
template <class Force>
double loss_on(const SideSums& side, std::size_t k, const std::vector<char>& filled, const Force& force,
               double* rows = nullptr) {
  double sum = 0.0;
  const BlockSums& block = side.held.empty() ? side.block[k] : side.held[k];
  for (std::size_t b = 0; b < filled.size(); ++b) {
    const double count = block.n[b];
    if (!filled[b] || count <= 0.0) continue;
    const double f = force(block.v[b] / count);
    sum += block.ff[b] - 2.0 * f * block.f[b] + f * f * count;
    if (rows != nullptr) *rows += count;
  }
  return sum;
}

struct Scored {
  std::string name;
  int terms = 0;
  std::size_t parameters = 0;
  std::size_t complexity = 0;
  std::vector<double> loss;  // for each block
};

/// The candidates' rows for the result.
std::vector<Candidate> rows_of(const std::vector<Scored>& scored, const Picked& picked) {
  std::vector<Candidate> out;
  for (std::size_t n = 0; n < scored.size(); ++n) {
    Candidate c;
    c.name = scored[n].name;
    c.terms = scored[n].terms;
    c.parameters = static_cast<int>(scored[n].parameters);
    c.held_out_rms = picked.rms[n];
    c.standard_error = picked.error[n];
    c.chosen = n == picked.chosen;
    out.push_back(std::move(c));
  }
  return out;
}
Picked pick_of(const std::vector<Scored>& scored, double rows, double friction) {
  std::vector<std::vector<double>> loss;
  std::vector<std::size_t> complexity, parameters;
  for (const Scored& s : scored)
    loss.push_back(s.loss), complexity.push_back(s.complexity), parameters.push_back(s.parameters);
  return pick(loss, complexity, parameters, rows, friction);
}

/// Gaussian fits of one direction, and their held-out errors.
struct Branches {
  std::vector<BranchFit> fit;
  std::vector<Scored> scored;
  double rows = 0.0;
};

FitSettings settings_of(const SideSums& side) {
  double within = 0.0, rows = 0.0, highest = 0.0;
  for (std::size_t b = 0; b < side.block.front().n.size(); ++b) {
    double n = 0, f = 0, ff = 0;
    for (const BlockSums& k : side.block) n += k.n[b], f += k.f[b], ff += k.ff[b];
    if (n > 0) within += ff - f * f / n, rows += n, highest = std::max(highest, std::abs(f / n));
  }
  FitSettings settings;
  settings.noise = std::max({std::sqrt(std::max(0.0, within) / rows), 1e-7 * highest, 1e-300});
  settings.height_scale = std::max(10.0 * highest, 1e-300);
  settings.slope_scale = std::max(0.2 * highest, 1e-300);
  settings.most_force = kMostForce * highest;
  settings.most_height = kMostHeight * highest;
  return settings;
}

/// Whether a term of a fit moves none of the bins: the bounds left it no height, or no place within the range.
bool has_idle_term(const BranchFit& fit, const Bins& bins) {
  constexpr double kIdle = 1e-4;  // of the largest force
  const double least = kIdle * *std::max_element(bins.force.begin(), bins.force.end());
  return std::any_of(fit.terms.begin(), fit.terms.end(), [&](const FitTerm& g) {
    return std::all_of(bins.u.begin(), bins.u.end(), [&](double u) {
      const double off = (u - g.b) / g.c;
      return std::abs(g.a * std::exp(-off * off)) < least;
    });
  });
}

/// Whether the height of a narrow term is not seen: it is centred beyond the fastest bin and reaches less than half its height there. A
/// wide one is the curvature of the branch.
bool has_term_beyond(const BranchFit& fit, const Bins& bins) {
  constexpr double kSeen = 0.5;     // of its height
  constexpr double kNarrow = 0.15;  // of the largest speed
  const double last = bins.u.back();
  return std::any_of(fit.terms.begin(), fit.terms.end(), [&](const FitTerm& g) {
    const double off = (last - g.b) / g.c;
    return g.c < kNarrow && g.b > last && std::exp(-off * off) < kSeen;
  });
}

/// All numbers of terms for one direction: the fit to all blocks, and the held-out error with each block left out.
Branches score_branches(const SideSums& side, int s, const StaticOptions& options) {
  const std::size_t blocks = side.block.size();
  const double top = side.grid.high;
  const Bins all = bins_without(side, blocks);
  FitSettings settings = settings_of(side);
  settings.lowest_centre = all.u.front();
  FitSettings quick = settings;
  quick.polished = 2;
  quick.scattered = 4;
  quick.exchange = false;
  struct Fold {
    std::vector<char> filled;
    Bins bins;
    BranchFit fit;
  };
  std::vector<Fold> folds(blocks);
  Branches out;
  for (std::size_t k = 0; k < blocks; ++k) {
    folds[k].bins = joined(bins_without(side, k, &folds[k].filled), kFoldBins);
    static_cast<void>(loss_on(
        side, k, folds[k].filled, [](double) { return 0.0; }, &out.rows));
  }
  const std::string where = s == 0 ? ", v > 0" : ", v < 0";
  const auto add = [&](BranchFit fit) {
    Scored scored;
    const std::string of_one = fit.exponential ? " of exponent 1" : "";
    scored.name = fit.centred ? "by direction, Stribeck part" + of_one + where
                              : "by direction, " + std::to_string(fit.terms.size()) +
                                    (fit.terms.size() == 1 ? " Gaussian" : " Gaussians") + where;
    scored.terms = static_cast<int>(fit.terms.size());
    scored.parameters = fit.parameters();
    scored.complexity = fit.complexity();
    for (std::size_t k = 0; k < blocks; ++k) {
      const BranchFit& part = folds[k].fit;
      scored.loss.push_back(
          loss_on(side, k, folds[k].filled, [&](double speed) { return part.force(speed / top); }));
    }
    out.fit.push_back(std::move(fit));
    out.scored.push_back(std::move(scored));
    return std::accumulate(out.scored.back().loss.begin(), out.scored.back().loss.end(), 0.0);
  };

  const int most = options.terms.value_or(options.most_terms);
  BranchFit fit = fit_line(all, settings);
  for (Fold& f : folds) f.fit = fit_line(f.bins, quick);
  double best = add(fit);
  if (!options.terms && all.u.back() < kShapeRange * all.u.front()) return out;
  for (const Exponent exponent : {Exponent::kTwo, Exponent::kOne}) {
    if (options.terms) break;
    auto centred = fit_centred(all, settings, exponent);
    if (!centred) continue;
    for (Fold& f : folds) f.fit = fit_centred(f.bins, quick, exponent).value_or(f.fit);
    add(std::move(*centred));
    for (Fold& f : folds) f.fit = fit_line(f.bins, quick);
  }
  int vain = 0;
  for (int n = 1; n <= most && (options.terms || vain < 2); ++n) {
    std::optional<BranchFit> next = fit_one_more(all, fit, settings);
    if (!next) break;
    fit = std::move(*next);
    for (Fold& f : folds) f.fit = fit_one_more(f.bins, f.fit, quick, &fit).value_or(f.fit);
    // No candidate: the start of the fit with one term more.
    if (!options.terms && (has_idle_term(fit, all) || has_term_beyond(fit, all))) {
      ++vain;
      continue;
    }
    const double loss = add(fit);
    // Two more terms in sequence brought no gain; a third will not either.
    vain = loss < (1.0 - kWorthwhileGain) * best ? 0 : vain + 1;
    best = std::min(best, loss);
  }
  if (options.terms) {
    // Only the requested number of terms.
    out.fit.erase(out.fit.begin(), out.fit.end() - 1);
    out.scored.erase(out.scored.begin(), out.scored.end() - 1);
  }
  return out;
}

/// Symmetric fits over the bins of both directions.
struct Both {
  std::vector<double> side_sign, speed, force, root;

  void add(const Bins& bins, int side, double top) {
    for (std::size_t i = 0; i < bins.size(); ++i) {
      side_sign.push_back(kDirection[static_cast<std::size_t>(side)]);
      speed.push_back(bins.u[i] * top);
      force.push_back(bins.force[i]);
      root.push_back(std::sqrt(bins.weight[i]));
    }
  }
};

/// Without an exponent: without a Stribeck part.
StaticFit fit_symmetric(const Both& b, std::optional<Exponent> exponent) {
  const bool stribeck = exponent.has_value();
  const auto n = static_cast<Index>(b.speed.size());
  MatrixXd design(n, stribeck ? 4 : 3);
  VectorXd y(n);
  double highest = 0.0;
  double lowest = std::numeric_limits<double>::infinity();
  for (Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    design(i, 0) = b.root[k] * b.side_sign[k];
    design(i, 1) = b.root[k];
    design(i, 2) = b.root[k] * b.speed[k];
    y(i) = b.root[k] * b.force[k];
    highest = std::max(highest, b.speed[k]);
    lowest = std::min(lowest, b.speed[k]);
  }
  struct Trial {
    VectorXd x;
    double cost;
  };
  const auto solve = [&](double v0) {
    if (stribeck) {
      for (Index i = 0; i < n; ++i) {
        const auto k = static_cast<std::size_t>(i);
        design(i, 3) = b.root[k] * std::exp(-std::pow(b.speed[k] / v0, static_cast<double>(*exponent)));
      }
    }
    VectorXd x = stats::least_squares(design, y).x;
    const double cost = (y - design * x).squaredNorm();
    return Trial{std::move(x), cost};
  };
  StaticFit fit;
  fit.family = stribeck ? Family::kSymmetricStribeck : Family::kSymmetric;
  Trial best = solve(highest);
  if (stribeck) {
    std::vector<double> widths = stribeck_widths(lowest, highest);
    if (widths.empty()) widths = {lowest, highest};
    best.cost = std::numeric_limits<double>::infinity();
    const auto take_better = [&](double v0) {
      Trial t = solve(v0);
      if (t.cost < best.cost) best = std::move(t), fit.v0 = v0;
    };
    for (const double v0 : widths) take_better(v0);
    for (double half = std::sqrt(widths[1] / widths[0]); half > 1.0001; half = std::sqrt(half)) {
      const double at = fit.v0;
      take_better(at / half);
      take_better(at * half);
    }
    fit.exponent = *exponent;
    fit.rise = best.x(3);
  }
  fit.load = best.x(0);
  fit.coulomb = best.x(1);
  fit.viscous = best.x(2);
  return fit;
}

/// The load that both directions have in common, where a branch would otherwise drive the motion or where a load is known to pull: half the sum of their levels
/// (level_points()). Viscous friction that differs between the directions is no load, and a wide term that shares it with eta1 moves none.
void take_out_load(StaticFit& fit, bool weighted) {
  std::array<double, kSides> lowest{}, mean{};
  constexpr int kPoints = 50;
  const double reach = std::min(fit.top[0], fit.top[1]);
  for (std::size_t s = 0; s < kSides; ++s) {
    lowest[s] = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= kPoints; ++i) {
      const double speed = reach * i / kPoints;
      const double level = fit.force(static_cast<int>(s), speed) - fit.branch[s].eta1 * speed / fit.top[s];
      lowest[s] = std::min(lowest[s], level);
    }
    for (const LevelPoint& p : level_points(reach))
      mean[s] += p.weight * fit.force(static_cast<int>(s), p.speed);
  }
  if (!weighted && std::min(lowest[0], lowest[1]) > kLeastLevel * 0.5 * std::abs(mean[0] + mean[1])) return;
  // Both directions keep a share of what is left, where anything is.
  const double margin = kLeastLevel * 0.5 * std::max(0.0, lowest[0] + lowest[1]);
  const double from = margin - lowest[1], to = lowest[0] - margin;
  const double half_sum = 0.5 * (mean[0] - mean[1]);
  fit.load = from < to ? std::clamp(half_sum, from, to) : 0.5 * (from + to);
  fit.branch[0].eta0 -= fit.load;
  fit.branch[1].eta0 += fit.load;
  // Next to no friction but the viscous one: its level may come out below zero by the noise.
  const double least = lowest[0] - fit.load;
  const double scale = 0.5 * (std::abs(fit.force(0, reach)) + std::abs(fit.force(1, reach)));
  const double missing = kNoFriction * scale - std::min(least, lowest[1] + fit.load);
  if (missing > 0.0 && missing <= kWithinNoise * scale) {
    for (BranchFit& branch : fit.branch) branch.eta0 += missing;
  }
}

/// The separate fits of both directions, and the equally good ones.
struct ByDirection {
  std::array<Branches, kSides> branches;
  StaticFit fit;
  Scored scored;
  std::array<std::vector<std::size_t>, kSides> equal;  ///< other numbers of terms within one standard error
  std::vector<Candidate> candidates;
  double tested = 0.0;  ///< rows that were judged

  /// The same fit with another branch for one direction.
  [[nodiscard]] StaticFit with_branch(std::size_t s, std::size_t n) const {
    StaticFit other = fit;
    other.branch[s] = branches[s].fit[n];
    other.branch[s].eta0 -= kDirection[s] * fit.load;
    return other;
  }
};

/// Mean friction of both directions, in which a load cancels [N].
double friction_of(const std::array<SideSums, kSides>& sums) {
  double friction = 0.0, sides = 0.0;
  for (const SideSums& side : sums) {
    double n = 0.0, f = 0.0;
    for (const BlockSums& block : side.block) {
      n += std::accumulate(block.n.begin(), block.n.end(), 0.0);
      f += std::accumulate(block.f.begin(), block.f.end(), 0.0);
    }
    if (n > 0.0) friction += f / n, sides += 1.0;
  }
  return sides > 0.0 ? std::abs(friction) / sides : 0.0;
}

ByDirection choose_by_direction(const std::array<SideSums, kSides>& sums, const StaticOptions& options,
                                double friction) {
  ByDirection out;
  out.scored.loss.assign(std::min(sums[0].block.size(), sums[1].block.size()), 0.0);
  for (std::size_t s = 0; s < kSides; ++s) {
    out.branches[s] = score_branches(sums[s], static_cast<int>(s), options);
    const Branches& found = out.branches[s];
    const Picked picked = pick_of(found.scored, std::max(1.0, found.rows), friction);
    out.fit.branch[s] = found.fit[picked.chosen];
    auto& terms = out.fit.branch[s].terms;
    std::sort(terms.begin(), terms.end(), [](const FitTerm& x, const FitTerm& y) { return x.b < y.b; });
    out.fit.top[s] = sums[s].grid.high;
    out.scored.parameters += out.fit.branch[s].parameters();
    out.scored.complexity += out.fit.branch[s].complexity();
    const std::vector<double>& loss = found.scored[picked.chosen].loss;
    for (std::size_t k = 0; k < loss.size(); ++k) out.scored.loss[k % out.scored.loss.size()] += loss[k];
    for (std::size_t n = 0; n < picked.equal.size(); ++n) {
      if (picked.equal[n] && n != picked.chosen) out.equal[s].push_back(n);
    }
    const auto rows = rows_of(found.scored, picked);
    out.candidates.insert(out.candidates.end(), rows.begin(), rows.end());
    out.tested += found.rows;
  }
  out.tested = std::max(1.0, out.tested);
  out.scored.name = out.fit.name();
  take_out_load(out.fit, options.weighted);
  return out;
}

/// By direction: the straight line, with and without a Stribeck part of either exponent.
std::vector<StaticFit> simple_by_direction(const ByDirection& found) {
  const auto line = [](const BranchFit& b) { return b.terms.empty(); };
  const auto two = [](const BranchFit& b) { return b.centred && !b.exponential; };
  const auto one = [](const BranchFit& b) { return b.exponential; };
  std::vector<StaticFit> out;
  for (const auto kind : {+line, +two, +one}) {
    StaticFit fit = found.fit;
    bool there = true;
    for (std::size_t s = 0; s < kSides && there; ++s) {
      const std::vector<BranchFit>& fits = found.branches[s].fit;
      const auto at = std::find_if(fits.begin(), fits.end(), kind);
      there = at != fits.end();
      if (there) fit.branch[s] = found.with_branch(s, static_cast<std::size_t>(at - fits.begin())).branch[s];
    }
    if (there) out.push_back(fit);
  }
  return out;
}

Both bins_of_both(const std::array<SideSums, kSides>& sums, std::size_t without) {
  Both both;
  for (std::size_t s = 0; s < kSides; ++s)
    both.add(bins_without(sums[s], without), static_cast<int>(s), sums[s].grid.high);
  return both;
}

/// Held-out errors of a symmetric family.
Scored score_symmetric(const std::array<SideSums, kSides>& sums, const StaticFit& fit, std::size_t blocks) {
  Scored scored;
  scored.name = fit.name();
  scored.parameters = fit.parameters();
  scored.complexity = fit.complexity();
  const bool stribeck = fit.family == Family::kSymmetricStribeck;
  for (std::size_t k = 0; k < blocks; ++k) {
    const StaticFit part =
        fit_symmetric(bins_of_both(sums, k), stribeck ? std::optional(fit.exponent) : std::nullopt);
    double loss = 0.0;
    for (int s = 0; s < kSides; ++s) {
      const SideSums& side = sums[static_cast<std::size_t>(s)];
      if (k >= side.block.size()) continue;
      std::vector<char> filled;
      static_cast<void>(bins_without(side, k, &filled));
      loss += loss_on(side, k, filled, [&](double speed) { return part.force(s, speed); });
    }
    scored.loss.push_back(loss);
  }
  return scored;
}

/// The symmetric families that the bins can determine.
std::vector<StaticFit> symmetric_fits(const std::array<SideSums, kSides>& sums,
                                      const std::array<double, kSides>& top) {
  const Both all = bins_of_both(sums, std::max(sums[0].block.size(), sums[1].block.size()));
  std::vector<StaticFit> out;
  for (const auto exponent :
       {std::optional<Exponent>(), std::optional(Exponent::kTwo), std::optional(Exponent::kOne)}) {
    if (all.speed.size() < (exponent ? 12u : 8u)) continue;
    const auto [slowest, fastest] = std::minmax_element(all.speed.begin(), all.speed.end());
    if (exponent && *fastest < kShapeRange * *slowest) continue;
    StaticFit fit = fit_symmetric(all, exponent);
    fit.top = top;
    const double highest = *std::max_element(all.force.begin(), all.force.end());
    if (fit.coulomb + fit.rise > kMostForce * highest) continue;
    if (fit.coulomb > 0.0 && fit.coulomb + fit.rise > 0.0 && fit.viscous >= 0.0)
      out.push_back(std::move(fit));
  }
  return out;
}

}  // namespace

StaticChoice choose_static(const std::array<SideSums, kSides>& sums, const StaticOptions& options) {
  StaticChoice out;
  out.friction = friction_of(sums);
  const ByDirection by_direction = choose_by_direction(sums, options, out.friction);
  out.candidates = by_direction.candidates;
  out.tested = by_direction.tested;
  if (!options.terms) out.simple = simple_by_direction(by_direction);
  std::vector<Scored> families{by_direction.scored};
  std::vector<StaticFit> fits{by_direction.fit};
  if (options.symmetric && !options.terms) {
    for (StaticFit& fit : symmetric_fits(sums, by_direction.fit.top)) {
      families.push_back(score_symmetric(sums, fit, by_direction.scored.loss.size()));
      out.simple.push_back(fit);
      fits.push_back(std::move(fit));
    }
  }
  const Picked family = pick_of(families, out.tested, out.friction);
  out.fit = fits[family.chosen];
  out.block_loss = families[family.chosen].loss;
  out.held_out_rms = family.rms[family.chosen];
  if (family.chosen == 0) {
    // Equally good fits by direction differ in one branch at a time.
    for (std::size_t s = 0; s < kSides; ++s) {
      for (const std::size_t n : by_direction.equal[s]) out.rivals.push_back(by_direction.with_branch(s, n));
    }
  } else {
    for (Candidate& c : out.candidates) c.chosen = false;
    for (std::size_t n = 0; n < fits.size(); ++n) {
      if (family.equal[n] && n != family.chosen) out.rivals.push_back(fits[n]);
    }
  }
  if (families.size() > 1) {
    const auto rows = rows_of(families, family);
    out.candidates.insert(out.candidates.begin(), rows.begin(), rows.end());
  }
  return out;
}

}  // namespace stribeck::ident::map
