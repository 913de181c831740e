#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numeric>
#include <optional>
#include <stribeck/ident/drive/periodic_choice.hpp>
#include <stribeck/ident/drive/text.hpp>

namespace stribeck::ident::drive {
namespace {

constexpr int kPasses = 5;                 ///< largest number of searches beside the terms found
constexpr double kSettledForce = 2e-3;     ///< of the terms together; a smaller change counts as none
constexpr double kErrorsBesideMaps = 2.0;  ///< of the gain, for terms that do not stand out beside the bins
constexpr double kSettled =
    0.05;  ///< share of the width of a period's interval; a smaller change counts as none

void take_terms(Terms& terms, const AlignedLog& log, const std::vector<map::PeriodicTerm>& found) {
  terms.periodic.clear();
  for (const map::PeriodicTerm& t : found) terms.periodic.push_back(columns_of(log, t));
}

bool same_terms(const std::vector<map::PeriodicTerm>& now, const std::vector<map::PeriodicTerm>& before) {
  return std::equal(now.begin(), now.end(), before.begin(), before.end(), [](const auto& a, const auto& b) {
    return a.term.form == b.term.form &&
           std::abs(a.term.period - b.term.period) < kSettled * (a.period.high - a.period.low);
  });
}

/// Gain on held-out motion [N²] and its standard error, over blocks.
struct Gain {
  double sum = 0.0;
  double error = 0.0;
};
Gain gain_of(const std::vector<double>& without, const std::vector<double>& with) {
  const auto blocks = static_cast<double>(with.size());
  double gain = 0.0, square = 0.0;
  for (std::size_t k = 0; k < with.size(); ++k) gain += without[k] - with[k];
  for (std::size_t k = 0; k < with.size(); ++k) square += std::pow(without[k] - with[k] - gain / blocks, 2.0);
  return {gain, std::sqrt(square * blocks / (blocks - 1.0))};
}

/// Whether much of the loss is gone, and nearly every block has less: a single block that a map without the terms misses by far has a scatter
/// as large as the gain.
bool nearly_all_gain(const std::vector<double>& without, const std::vector<double>& with) {
  constexpr double kMuch = 0.5;
  constexpr double kSignTest = 2.5;
  double before = 0.0, after = 0.0, gained = 0.0;
  const auto blocks = static_cast<double>(with.size());
  for (std::size_t k = 0; k < with.size(); ++k) {
    before += without[k], after += with[k];
    gained += with[k] < without[k] ? 1.0 : 0.0;
  }
  return after < kMuch * before && 2.0 * gained - blocks > kSignTest * std::sqrt(blocks);
}

using Complex = std::complex<double>;

/// ∫ (1 − s)·exp(i·angle·s) ds over a row.
Complex falling_mean(double angle) {
  constexpr double kSmall = 1e-3;
  const Complex a(0.0, angle);
  if (std::abs(angle) < kSmall) return 0.5 + a / 6.0;
  return (std::exp(a) - 1.0 - a) / (a * a);
}

/// The map of few parameters that fits best together with the linear terms; absent where none is plausible.
std::optional<JointFit> best_joint(const std::vector<map::StaticFit>& maps, const LinearFit& fit) {
  std::optional<JointFit> best;
  double least = std::numeric_limits<double>::infinity();
  for (const map::StaticFit& start : maps) {
    JointFit joint = fit_jointly(start, fit, fit.sums.blocks);
    if (!joint.good) continue;
    double loss = 0.0;
    for (std::size_t k = 0; k < fit.sums.blocks; ++k) loss += loss_of(joint, fit.sums, k);
    if (loss < least) least = loss, best = std::move(joint);
  }
  return best;
}

/// Fits the linear terms beside the periodic ones and searches again, until the periods no longer change.
void settle_beside_bins(const AlignedLog& log, const Rows& rows, const map::PeriodicOptions& search,
                        std::vector<map::PeriodicTerm>& found, PeriodicChoice& out) {
  for (int k = 0; k <= kPasses; ++k) {
    take_terms(out.terms, log, found);
    out.fit = solve(log, rows, out.terms, &out.fit);
    if (k == kPasses) break;
    map::PeriodicResult again = map::find_periodic(rows_for_periodic(log, rows, out.terms, out.fit), search);
    if (again.terms.empty() || same_terms(again.terms, found)) break;
    found = std::move(again.terms);
  }
}

/// The same beside maps of few parameters, from the strongest line on; true when terms stand out at the end.
bool search_beside_maps(const AlignedLog& log, const Rows& rows, map::PeriodicOptions search,
                        std::vector<map::PeriodicTerm>& found, PeriodicChoice& out) {
  Terms terms = out.terms;
  LinearFit fit = out.fit;
  for (int k = 0; k <= kPasses; ++k) {
    const std::optional<JointFit> joint = best_joint(out.map.map.simple, fit);
    if (!joint) return false;
    search.guess = k == 0;
    map::PeriodicResult again = map::find_periodic(rows_for_periodic(log, rows, terms, fit, &*joint), search);
    if (again.terms.empty()) return false;
    if (k > 0 && same_terms(again.terms, found)) break;
    found = std::move(again.terms);
    take_terms(terms, log, found);
    fit = solve(log, rows, terms, &fit);
  }
  out.terms = std::move(terms);
  out.fit = std::move(fit);
  return true;
}

/// The slope within a bin comes from the curve of the fit before, which has a part of the terms at first: fits until they stay.
LinearFit solve_settled(const AlignedLog& log, const Rows& rows, const Terms& terms, LinearFit fit) {
  const auto first = static_cast<Index>(terms.first_periodic());
  const auto count = static_cast<Index>(2 * terms.periodic.size());
  fit = solve(log, rows, terms, &fit);
  for (int k = 1; k < kPasses; ++k) {
    const VectorXd before = fit.value.segment(first, count);
    fit = solve(log, rows, terms, &fit);
    const VectorXd now = fit.value.segment(first, count);
    if ((now - before).norm() < kSettledForce * now.norm()) break;
  }
  return fit;
}

double sum_of(const std::vector<double>& loss) { return std::accumulate(loss.begin(), loss.end(), 0.0); }

/// Searches again beside the chosen map, which cannot follow a term as the bins can, while held-out motion is predicted better.
void settle_beside_map(const AlignedLog& log, const Rows& rows, const map::PeriodicOptions& search,
                       const DriveFitOptions& options, std::vector<map::PeriodicTerm> found,
                       PeriodicChoice& out, MapChoice& with) {
  for (int k = 0; k < kPasses; ++k) {
    const JointFit joint{with.map.fit, with.joint.value_or(out.fit.value), true};
    map::PeriodicResult again =
        map::find_periodic(rows_for_periodic(log, rows, out.terms, out.fit, &joint), search);
    if (again.terms.empty() || same_terms(again.terms, found)) return;
    Terms terms = out.terms;
    take_terms(terms, log, again.terms);
    LinearFit fit = solve_settled(log, rows, terms, out.fit);
    MapChoice next = with_joint_fits(choose_map(log, rows, terms, fit, options), fit);
    if (!(sum_of(next.map.block_loss) < sum_of(with.map.block_loss))) return;
    found = std::move(again.terms);
    out.terms = std::move(terms);
    out.fit = std::move(fit);
    with = std::move(next);
  }
}

/// Terms that stand out of the residual, but do not predict held-out motion better.
void note_untold(const Shown& shown, const Terms& terms, Notes& notes) {
  std::string periods;
  std::string before;
  for (const PeriodicColumns& term : terms.periodic) {
    const std::string period = shown.length(term.period);
    if (period == before) continue;  // a force and its change with speed
    periods += (periods.empty() ? "" : " and ") + period;
    before = period;
  }
  if (periods.empty()) return;
  notes.cannot_tell.push_back(text(
      "whether a force repeats every %s: it stands out of the residual, but held-out motion is not predicted better with it; the motion may pass each place always at the same speed: add strokes at constant speed, slow and fast",
      periods.c_str()));
}

}  // namespace

bool predicts_better(const std::vector<double>& without, const std::vector<double>& with, double errors) {
  const Gain gain = gain_of(without, with);
  return gain.sum > errors * gain.error || nearly_all_gain(without, with);
}

map::PeriodicRows rows_for_periodic(const AlignedLog& log, const Rows& rows, const Terms& terms,
                                    const LinearFit& fit, const JointFit* joint) {
  const VectorXd& value = joint != nullptr ? joint->linear : fit.value;
  map::PeriodicRows out;
  out.shown = Shown(log.records.front());
  const std::size_t first = terms.first_periodic();
  const std::size_t behind = first + 2 * terms.periodic.size();
  std::vector<double> c(terms.count() + 1);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    double e = terms.fill(log, rows, i, c.data());
    for (std::size_t j = 0; j < terms.count(); ++j) {
      if (j < first || j >= behind) e -= value(static_cast<Index>(j)) * c[j];
    }
    const std::size_t s = rows.side[i];
    const double speed = std::abs(velocity_of(log, rows, i));
    e -= map::kDirection[s] *
         (joint != nullptr ? joint->map.force(static_cast<int>(s), speed) : fit.curve[s](speed));
    out.x.push_back(motion_of(log, rows, i).x[rows.at[i]]);
    out.e.push_back(e);
    out.direction.push_back(s == 0 ? 1 : -1);
    const log::Motion& motion = motion_of(log, rows, i);
    if (out.passed == nullptr) out.passed = log::passed_by(motion);
    const double cut_off = log::cut_off_of(motion);
    out.blur.push_back(cut_off > 0.0 ? speed / cut_off : 0.0);
  }
  out.record = rows.record;
  out.at = rows.at;
  return out;
}

PeriodicColumns columns_of(const AlignedLog& log, const map::PeriodicTerm& term) {
  PeriodicColumns out{term.term.period, term.term.form, term.period, {}, {}};
  for (std::size_t r = 0; r < log.motions.size(); ++r) {
    const std::vector<double>& x = log.records[r].x;
    std::vector<double> sine, cosine;
    for (std::size_t k = 0; k < x.size(); ++k) {
      const double turn = 2.0 * kPi / out.period;
      const double ahead = k + 1 < x.size() ? turn * (x[k + 1] - x[k]) : 0.0;
      const double behind = k > 0 ? turn * (x[k - 1] - x[k]) : 0.0;
      const Complex mean = std::polar(1.0, turn * x[k]) * (falling_mean(ahead) + falling_mean(behind));
      sine.push_back(mean.imag());
      cosine.push_back(mean.real());
    }
    out.sine.push_back(log::smooth_like(log.motions[r], sine));
    out.cosine.push_back(log::smooth_like(log.motions[r], cosine));
  }
  return out;
}

PeriodicChoice choose_periodic(const AlignedLog& log, const Rows& rows, const Terms& terms,
                               const LinearFit& fit, MapChoice map, const DriveFitOptions& options,
                               Notes& notes) {
  map::PeriodicOptions search;
  search.most = static_cast<int>(friction::kMaxEccentricTerms);
  if (log.records.front().turns()) search.known = 2.0 * kPi;
  map::PeriodicResult first = map::find_periodic(rows_for_periodic(log, rows, terms, fit), search);
  for (const std::string& note : first.notes) notes.warn(note);
  PeriodicChoice out{std::move(map), terms, fit, std::move(first.spectrum)};
  std::vector<map::PeriodicTerm> terms_found = std::move(first.terms);
  const bool beside_bins = !terms_found.empty();
  if (beside_bins) settle_beside_bins(log, rows, search, terms_found, out);
  const bool found = beside_bins || search_beside_maps(log, rows, search, terms_found, out);
  if (!found || beside_bins)
    notes.cannot_tell.insert(notes.cannot_tell.end(), first.cannot_tell.begin(), first.cannot_tell.end());
  if (!found) return out;
  if (!beside_bins) out.fit = solve_settled(log, rows, out.terms, std::move(out.fit));
  MapChoice with = with_joint_fits(choose_map(log, rows, out.terms, out.fit, options), out.fit);
  if (!beside_bins) settle_beside_map(log, rows, search, options, std::move(terms_found), out, with);
  const Gain gain = gain_of(out.map.map.block_loss, with.map.block_loss);
  const bool better =
      predicts_better(out.map.map.block_loss, with.map.block_loss, beside_bins ? 1.0 : kErrorsBesideMaps);
  Candidate plain, periodic;
  plain.name = "without periodic terms";
  plain.parameters = static_cast<int>(out.map.map.fit.parameters() + terms.count());
  plain.held_out_rms = out.map.map.held_out_rms;
  plain.standard_error = gain.error / with.map.tested / (2.0 * with.map.held_out_rms);
  plain.chosen = !better;
  const std::size_t count = out.terms.periodic.size();
  periodic.name = text("with %zu periodic term%s", count, count == 1 ? "" : "s");
  periodic.parameters = static_cast<int>(with.map.fit.parameters() + out.terms.count() + count);
  periodic.held_out_rms = with.map.held_out_rms;
  periodic.chosen = better;
  if (better) {
    out.map = std::move(with);
  } else {
    if (beside_bins) note_untold(Shown(log.records.front()), out.terms, notes);
    out.terms = terms;
    out.fit.curve =
        fit.curve;  // the curve of the fit without periodic terms; the mass starts from its present value
    out.fit = solve(log, rows, terms, &out.fit);
  }
  out.map.map.candidates.push_back(std::move(plain));
  out.map.map.candidates.push_back(std::move(periodic));
  return out;
}

}  // namespace stribeck::ident::drive
