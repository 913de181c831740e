// The sign of the force: recovered where a magnitude was logged, reversed where it disagrees with the position.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/log/rough_fit.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <utility>

namespace stribeck::ident::log::parts {
namespace {

/// +1 or −1 for each row of each block.
using Signs = std::vector<std::vector<double>>;

struct Unfolded {
  Fit fit;
  Signs signs;
};

/// The side of zero on which the whole force lies, +1 or −1; absent where it lies on both sides or never changes.
std::optional<double> side_of_zero(const std::vector<Table>& tables) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const Table& m : tables) {
    for (const double f : m.f) {
      low = std::min(low, f);
      high = std::max(high, f);
    }
  }
  if (!(low >= 0.0 || high <= 0.0) || low == high) return {};
  return low >= 0.0 ? 1.0 : -1.0;
}

double usual_acceleration(const std::vector<Block>& blocks) {
  std::vector<double> accelerations;
  for (const Block& b : blocks) {
    const std::vector<double> some = sample_of(stats::magnitudes(b.motion.a), 20000);
    accelerations.insert(accelerations.end(), some.begin(), some.end());
  }
  return std::max(stats::thinned_quantile(std::move(accelerations), 0.95),
                  std::numeric_limits<double>::min());
}

/// Signs of friction and inertia, the latter `ratio` times as strong at the usual acceleration.
Signs signs_of_motion(const std::vector<Block>& blocks, double side, double ratio, double usual) {
  Signs out;
  for (const Block& b : blocks) {
    std::vector<double> one(b.motion.rows());
    for (std::size_t k = 0; k < one.size(); ++k) {
      const double guess = sign(b.motion.v[k]) + ratio * b.motion.a[k] / usual;
      one[k] = side * guess < 0.0 ? -1.0 : 1.0;
    }
    out.push_back(std::move(one));
  }
  return out;
}

/// Signs of the force that a fit predicts.
Signs signs_of_fit(const std::vector<Block>& blocks, double side, const Fit& fit) {
  Signs out;
  for (const Block& b : blocks) {
    std::vector<double> one = predicted(b, fit);
    for (double& p : one) p = side * p < 0.0 ? -1.0 : 1.0;
    out.push_back(std::move(one));
  }
  return out;
}

/// Fits, gives each row the sign of the model, and repeats this until no row changes its sign.
Unfolded unfold(std::vector<Block>& blocks, Signs signs, double side, double slowest, bool from_fit) {
  constexpr int kMostRounds = 25;
  constexpr int kRoundsAtFirst = 4;
  Fit fit;
  for (int round = 0; round < kMostRounds; ++round) {
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      std::vector<double> f = blocks[i].force;
      for (std::size_t k = 0; k < f.size(); ++k) f[k] *= signs[i][k];
      smooth_force(blocks[i], f);
    }
    // A wrong start fits best with a wrong delay, so the first rounds allow hardly any delay.
    fit = best_fit(blocks, slowest, round < kRoundsAtFirst && !from_fit ? 2 : 100);
    Signs next = signs_of_fit(blocks, side, fit);
    const bool same = next == signs;
    signs = std::move(next);
    if (same && round >= kRoundsAtFirst) break;
  }
  return {std::move(fit), std::move(signs)};
}

/// The best of several starts: the ratio of inertia to friction decides where the sign changes, and it is not known
/// yet.
Unfolded best_unfolded(std::vector<Block>& blocks, const Fit& as_logged, double side, double slowest) {
  const double usual = usual_acceleration(blocks);
  Unfolded best = unfold(blocks, signs_of_fit(blocks, side, as_logged), side, slowest, true);
  for (const double ratio : {0.0, 0.3, 1.0, 3.0, 1e6}) {
    Unfolded one = unfold(blocks, signs_of_motion(blocks, side, ratio, usual), side, slowest, false);
    if (one.fit.rss < best.fit.rss) best = std::move(one);
  }
  return best;
}

/// Number of rows whose sign changed, and of those among them beyond twice the residual.
struct Flipped {
  std::size_t all = 0;
  std::size_t sure = 0;
};

Flipped count_flipped(const std::vector<Block>& blocks, const Unfolded& best) {
  Flipped out;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const std::vector<double> p = predicted(blocks[i], best.fit);
    for (std::size_t k = 0; k < p.size(); ++k) {
      if (best.signs[i][k] > 0.0) continue;
      ++out.all;
      if (std::abs(p[k]) > 2.0 * std::sqrt(best.fit.rss)) ++out.sure;
    }
  }
  return out;
}

/// Changes that were made to the tables.
struct Applied {
  std::size_t unsure = 0;
  const Table* first_table = nullptr;  ///< place of the first row whose sign changed
  std::size_t first_row = 0;
};

/// Sets the signs of the rows, all multiplied by `turn`, and marks those that are not sure.
Applied apply_signs(std::vector<Table>& tables, const std::vector<Block>& blocks, const Unfolded& best,
                    double turn, double slowest) {
  Applied out;
  const double rms = std::sqrt(best.fit.rss);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    auto& table = tables[static_cast<std::size_t>(blocks[i].table - tables.data())];
    const std::vector<double> p = predicted(blocks[i], best.fit);
    for (std::size_t k = 0; k < p.size(); ++k) {
      const std::size_t at = blocks[i].first + k;
      table.f[at] *= turn * best.signs[i][k];
      if (turn * best.signs[i][k] < 0.0 && out.first_table == nullptr) {
        out.first_table = &table;
        out.first_row = at;
      }
      // At rest friction may hold in either direction; the sign is sure only for a load larger than friction.
      const auto at_motion = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(
          static_cast<std::ptrdiff_t>(k) - best.fit.delay, 0, static_cast<std::ptrdiff_t>(p.size()) - 1));
      const bool rests = std::abs(blocks[i].motion.v[at_motion]) < slowest;
      const double holding = std::abs(best.fit.c[4] + best.fit.c[3] * blocks[i].x[k]);
      const bool held = rests && holding < 1.5 * std::abs(best.fit.c[2]) + 2.0 * rms;
      if (std::abs(p[k]) < 2.0 * rms || held) {
        table.mark[at] |= kSignUnsure;
        ++out.unsure;
      }
    }
  }
  return out;
}

/// RMS of the velocity.
double usual_speed(std::vector<Table>& tables) {
  double sum = 0.0, rows = 0.0;
  for (const Block& b : blocks_of(tables, std::numeric_limits<std::size_t>::max())) {
    for (const double v : b.motion.v) sum += v * v;
    rows += static_cast<double>(b.motion.v.size());
  }
  return rows > 0.0 ? std::sqrt(sum / rows) : 0.0;
}

}  // namespace

void recover_signs(std::vector<Table>& tables, Notes& notes) {
  if (!notes.wanted("unsigned")) return;
  const std::optional<double> side = side_of_zero(tables);
  if (!side) return;
  std::vector<Block> blocks = blocks_of(tables, std::numeric_limits<std::size_t>::max());
  if (blocks.empty()) return;
  const double slowest = slowest_moving(blocks);
  const Fit as_logged = best_fit(blocks, slowest);
  const Sums& sums = as_logged.sums;
  const bool both_ways = sums.forward * 33 > sums.n && (sums.n - sums.forward) * 33 > sums.n;
  if (sums.n < 50 || !both_ways) return;

  const Unfolded best = best_unfolded(blocks, as_logged, *side, slowest);
  Flipped flipped = count_flipped(blocks, best);
  // The force of a loaded axis may never change its sign; then the model with recovered signs fits no better.
  constexpr std::size_t kFewest = 8;
  if (flipped.sure < kFewest || best.fit.rss > 0.8 * as_logged.rss) return;
  const RoughFit recovered = as_rough(best.fit);
  constexpr double kEnough = 0.7;
  if (recovered.r_squared < kEnough) {
    throw Refused(
        tables.front().source +
        fmt::format(
            ": the force has no sign in this log, and the motion does not determine it (R2 = {:.2f} of "
            "the best model found): log the signed channel (--keep unsigned uses it as it is)",
            recovered.r_squared));
  }
  // The magnitude fits equally well with the opposite sign; friction and inertia decide.
  const double turn = best.fit.c[2] < 0.0 && best.fit.c[0] < 0.0 ? -1.0 : 1.0;
  std::size_t rows = 0;
  for (const Table& m : tables) rows += m.rows();
  if (turn < 0.0) flipped.all = rows - flipped.all;
  const Applied applied = apply_signs(tables, blocks, best, turn, slowest);
  if (applied.first_table == nullptr) return;  // nothing was reversed
  const double rms = std::sqrt(best.fit.rss);
  const double rms_as_logged = std::sqrt(as_logged.rss);
  notes.add(
      "unsigned", *applied.first_table, applied.first_row, true,
      fmt::format(
          "the force is a magnitude, never {} zero: a model shows where its sign changes. Sign recovered: {} of {} rows reversed, this is the first; {} rows at rest or nearer to zero than twice the residual ({:.3g}) are marked unsure. Residual {:.3g} instead of {:.3g} as logged",
          *side > 0.0 ? "below" : "above", flipped.all, rows, applied.unsure, 2.0 * rms, rms, rms_as_logged),
      {static_cast<double>(flipped.all), static_cast<double>(applied.unsure), rms, rms_as_logged});
}

void mend_sign(std::vector<Table>& tables, Notes& notes) {
  if (!notes.wanted("inverted")) return;
  const RoughFit r = rough_fit(tables);
  if (!r.good) return;
  // The viscous part may rightly be negative, because a rise at low speed looks like that.
  const bool negative = r.coulomb < 0.0;
  // A hydrostatic guide has viscous friction alone; the little that a line through its curve leaves at zero may have either sign.
  const bool drives = r.coulomb + std::max(r.viscous, 0.0) * usual_speed(tables) < 0.0;
  if (r.friction_shows && drives && r.mass_shows && r.mass > 0.0) {
    notes.add_all(
        "contradiction", tables.front().source, false,
        fmt::format(
            "inertia and friction have opposite signs (m = {:.4g}, F = {:.4g} in the units of the log): force "
            "and motion may not belong together, or another force acts",
            r.mass, r.coulomb),
        {r.mass, r.coulomb});
    return;
  }
  const bool inverted =
      (r.friction_shows && negative && r.viscous <= 0.0 && (!r.mass_shows || r.mass < 0.0)) ||
      (r.friction_shows && negative && r.mass_shows && r.mass < 0.0) ||
      (!r.friction_shows && r.mass_shows && r.mass < 0.0 && r.r_squared > 0.9);
  if (!inverted) return;
  for (Table& m : tables) {
    for (double& f : m.f) f = -f;
  }
  notes.add_all(
      "inverted", tables.front().source, true,
      fmt::format(
          "the force is positive towards smaller positions (as logged m = {:.4g}, F = {:.4g}, R2 = {:.3f}): sign of the force reversed",
          r.mass, r.coulomb, r.r_squared),
      {r.mass, r.coulomb, r.r_squared});
}

}  // namespace stribeck::ident::log::parts
