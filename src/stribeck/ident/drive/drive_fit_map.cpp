#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stribeck/ident/drive/drive_fit_parts.hpp>

namespace stribeck::ident::drive {
namespace {

constexpr int kPasses = 5;         ///< searches for periodic terms beside what has been found, at most
constexpr double kSettled = 0.05;  ///< of the width of a period's interval: it does not move any more

}  // namespace

map::StaticChoice DriveFit::choose() {
  std::array<map::SideSums, map::kSides> sums;
  for (std::size_t s = 0; s < map::kSides; ++s) {
    sums[s].grid = grid_[s];
    const auto bins = static_cast<std::size_t>(grid_[s].bins);
    map::BlockSums empty{std::vector<double>(bins), std::vector<double>(bins), std::vector<double>(bins),
                         std::vector<double>(bins)};
    sums[s].block.assign(blocks_, empty);
    sums[s].held.assign(blocks_, empty);
  }
  const std::size_t q = columns();
  std::vector<double> c(q + 1);
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const std::size_t s = rows_.side[i];
    const auto b = static_cast<std::size_t>(rows_.bin[i]);
    const double speed = std::abs(velocity(i));
    const double force = fill(i, c.data()) - offset_;
    double full = force, held = force;
    const VectorXd& other = linear_held_[block_[i]];
    for (std::size_t j = 0; j < q; ++j) {
      full -= linear_(static_cast<Index>(j)) * c[j];
      held -= other(static_cast<Index>(j)) * c[j];
    }
    const auto add = [&](map::BlockSums& block, double f) {
      f *= map::kDirection[s];
      block.n[b] += 1.0;
      block.v[b] += speed;
      block.f[b] += f;
      block.ff[b] += f * f;
    };
    add(sums[s].block[block_[i]], full);
    add(sums[s].held[block_[i]], held);
  }
  map::StaticOptions options;
  options.terms = options_.terms;
  options.most_terms = options_.most_terms;
  options.symmetric = options_.symmetric;
  map::StaticChoice choice = map::choose_static(sums, options);
  choice.fit.load += offset_;
  for (map::StaticFit& rival : choice.rivals) rival.load += offset_;
  for (map::StaticFit& simple : choice.simple) simple.load += offset_;
  return choice;
}

DriveFit::Joint DriveFit::fit_jointly(const map::StaticFit& start, std::size_t without) const {
  const std::size_t q = columns();
  const std::size_t p = start.parameters();
  const std::size_t stride = q + 6;
  const auto Q = static_cast<Index>(q), P = static_cast<Index>(p);
  const auto yf = static_cast<Index>(q) + 3;
  std::vector<Index> by;
  for (std::size_t j = 0; j < q; ++j) by.push_back(static_cast<Index>(multiplier(j)));
  MatrixXd cross = MatrixXd::Zero(Q + 4, Q + 4);
  for (std::size_t k = 0; k < blocks_; ++k) {
    if (k != without) cross += raw_cross_[k];
  }
  Joint out{start, VectorXd::Zero(Q), false};
  VectorXd g(P);
  constexpr int kSteps = 8;
  for (int step = 0; step < kSteps; ++step) {
    MatrixXd A = MatrixXd::Zero(Q + P, Q + P);
    VectorXd b = VectorXd::Zero(Q + P);
    for (Index i = 0; i < Q; ++i) {
      for (Index j = 0; j < Q; ++j) A(i, j) = cross(by[static_cast<std::size_t>(i)], j);
      b(i) = cross(by[static_cast<std::size_t>(i)], yf);
    }
    for (int s = 0; s < map::kSides; ++s) {
      const auto S = static_cast<std::size_t>(s);
      const auto bins = static_cast<std::size_t>(grid_[S].bins);
      const auto [first, count] = out.fit.span(s);
      const auto F = Q + static_cast<Index>(first);
      const auto N = static_cast<Index>(count);
      for (std::size_t bin = 0; bin < bins; ++bin) {
        VectorXd sum = VectorXd::Zero(static_cast<Index>(stride));
        for (std::size_t k = 0; k < blocks_; ++k) {
          if (k != without)
            sum += Eigen::Map<const VectorXd>(&block_sums_[S][(k * bins + bin) * stride],
                                              static_cast<Index>(stride));
        }
        const double rows = sum(Q + 4);
        if (rows <= 0.0) continue;
        const double speed = sum(Q + 5) / rows;
        out.fit.gradient(s, speed, g.data());
        const double now = out.fit.force(s, speed);
        const double d = map::kDirection[S];
        for (Index i = 0; i < Q; ++i) {
          const double z = sum(by[static_cast<std::size_t>(i)]);
          A.block(i, F, 1, N) += d * z * g.head(N).transpose();
          b(i) -= d * now * z;
          A.block(F, i, N, 1) += d * sum(i) * g.head(N);
        }
        A.block(F, F, N, N) += rows * g.head(N) * g.head(N).transpose();
        b.segment(F, N) += (d * sum(yf) - rows * now) * g.head(N);
      }
    }
    const VectorXd scale = A.diagonal().cwiseAbs().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Eigen::FullPivLU<MatrixXd> lu(scale.asDiagonal() * A * scale.asDiagonal());
    if (!lu.isInvertible()) return out;
    const VectorXd x = scale.asDiagonal() * lu.solve(scale.asDiagonal() * b);
    if (!x.allFinite()) return out;
    out.linear = x.head(Q);
    const double moved = out.fit.move(x.tail(P));
    if (moved < 1e-6) break;
  }
  out.good = out.fit.plausible();
  return out;
}

double DriveFit::joint_loss(const Joint& joint, std::size_t k) const {
  const std::size_t q = columns();
  const auto Q = static_cast<Index>(q);
  const std::size_t stride = q + 6;
  VectorXd h = VectorXd::Zero(Q + 4);
  h.head(Q) = -joint.linear;
  h(Q + 3) = 1.0;
  double sum = h.dot(raw_cross_[k] * h);
  for (int s = 0; s < map::kSides; ++s) {
    const auto S = static_cast<std::size_t>(s);
    const auto bins = static_cast<std::size_t>(grid_[S].bins);
    for (std::size_t bin = 0; bin < bins; ++bin) {
      const double* t = &block_sums_[S][(k * bins + bin) * stride];
      if (t[q + 4] <= 0.0) continue;
      const double f = joint.fit.force(s, t[q + 5] / t[q + 4]);
      double left = t[q + 3];
      for (std::size_t j = 0; j < q; ++j) left -= joint.linear(static_cast<Index>(j)) * t[j];
      sum += -2.0 * map::kDirection[S] * f * left + t[q + 4] * f * f;
    }
  }
  return sum;
}

void DriveFit::join(map::StaticChoice& choice) {
  joint_.reset();
  std::vector<Joint> fits;
  std::vector<std::vector<double>> losses{choice.block_loss};
  std::vector<std::size_t> parameters{choice.fit.parameters()};
  for (const map::StaticFit& start : choice.simple) {
    Joint joint = fit_jointly(start, blocks_);
    if (!joint.good) continue;
    std::vector<double> loss;
    for (std::size_t k = 0; k < blocks_; ++k) loss.push_back(joint_loss(fit_jointly(joint.fit, k), k));
    losses.push_back(std::move(loss));
    parameters.push_back(joint.fit.parameters());
    fits.push_back(std::move(joint));
  }
  const map::Picked picked = map::pick(losses, parameters, choice.tested);
  for (std::size_t i = 0; i < fits.size(); ++i) {
    Candidate c;
    c.name = "with periodic terms: " + fits[i].fit.name();
    c.parameters = static_cast<int>(parameters[i + 1]);
    c.held_out_rms = picked.rms[i + 1];
    c.standard_error = picked.error[i + 1];
    c.chosen = picked.chosen == i + 1;
    choice.candidates.push_back(std::move(c));
  }
  if (picked.chosen == 0) return;
  for (Candidate& c : choice.candidates) c.chosen = c.chosen && c.name.starts_with("with periodic terms: ");
  const Joint& best = fits[picked.chosen - 1];
  choice.rivals.clear();
  for (std::size_t i = 0; i < fits.size(); ++i) {
    if (picked.equal[i + 1] && i + 1 != picked.chosen) choice.rivals.push_back(fits[i].fit);
  }
  choice.fit = best.fit;
  choice.block_loss = losses[picked.chosen];
  choice.held_out_rms = picked.rms[picked.chosen];
  joint_ = best.linear;
}

void DriveFit::add_wave(const map::PeriodicTerm& term) {
  Wave w{term.term.period, term.term.form, term.period, {}, {}};
  for (std::size_t r = 0; r < motions_.size(); ++r) {
    std::vector<double> sine, cosine;
    for (const double x : records_[r].x) {
      sine.push_back(std::sin(2.0 * kPi * x / w.period));
      cosine.push_back(std::cos(2.0 * kPi * x / w.period));
    }
    w.sine.push_back(log::smooth_like(motions_[r], sine));
    w.cosine.push_back(log::smooth_like(motions_[r], cosine));
  }
  waves_.push_back(std::move(w));
}

map::StaticChoice DriveFit::try_periodic(map::StaticChoice without) {
  const std::size_t q = columns();
  const std::size_t first = options_.mass ? 0 : 1;  // of the waves' columns
  const auto before_line = line_;
  const auto residual = [&] {
    map::PeriodicRows rows;
    const std::size_t all = columns();
    const std::size_t behind = first + 2 * waves_.size();
    std::vector<double> c(all + 1);
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      double e = fill(i, c.data());
      for (std::size_t j = 0; j < all; ++j) {
        if (j < first || j >= behind) e -= linear_(static_cast<Index>(j)) * c[j];
      }
      const std::size_t s = rows_.side[i];
      e -= map::kDirection[s] * line_[s](std::abs(velocity(i)));
      rows.x.push_back(motion(i).x[rows_.at[i]]);
      rows.e.push_back(e);
      rows.direction.push_back(s == 0 ? 1 : -1);
    }
    rows.record = rows_.record;
    rows.at = rows_.at;
    return rows;
  };
  map::PeriodicOptions options;
  options.most = static_cast<int>(friction::kMaxEccentricTerms);
  map::PeriodicResult found = map::find_periodic(residual(), options);
  result_.spectrum = found.spectrum;
  for (const std::string& note : found.notes) warn(note);
  for (const std::string& words : found.cannot_tell) result_.cannot_tell.push_back(words);
  if (found.terms.empty()) return without;
  for (const map::PeriodicTerm& t : found.terms) add_wave(t);
  solve(true);
  // Mass and friction of the first fit had taken a part of the terms with them: again, from what is left without that.
  for (int k = 0; k < kPasses; ++k) {
    map::PeriodicResult again = map::find_periodic(residual(), options);
    if (again.terms.empty()) break;
    const bool settled =
        std::equal(again.terms.begin(), again.terms.end(), found.terms.begin(), found.terms.end(),
                   [](const auto& a, const auto& b) {
                     return a.term.form == b.term.form && std::abs(a.term.period - b.term.period) <
                                                              kSettled * (a.period.high - a.period.low);
                   });
    found = std::move(again);
    if (settled) break;
    joint_.reset();
    waves_.clear();
    for (const map::PeriodicTerm& t : found.terms) add_wave(t);
    solve(true);
  }
  map::StaticChoice with = choose();
  join(with);
  const auto blocks = static_cast<double>(with.block_loss.size());
  double gain = 0.0, square = 0.0;
  for (std::size_t k = 0; k < with.block_loss.size(); ++k) gain += without.block_loss[k] - with.block_loss[k];
  for (std::size_t k = 0; k < with.block_loss.size(); ++k)
    square += std::pow(without.block_loss[k] - with.block_loss[k] - gain / blocks, 2.0);
  const double error = std::sqrt(square * blocks / (blocks - 1.0));
  Candidate plain, wavy;
  plain.name = "without periodic terms";
  plain.parameters = static_cast<int>(without.fit.parameters() + q);
  plain.held_out_rms = without.held_out_rms;
  wavy.name = text("with %zu periodic term%s", waves_.size(), waves_.size() == 1 ? "" : "s");
  wavy.parameters = static_cast<int>(with.fit.parameters() + columns() + waves_.size());
  wavy.held_out_rms = with.held_out_rms;
  plain.standard_error = error / with.tested / (2.0 * with.held_out_rms);
  const bool better = gain > error;
  (better ? wavy : plain).chosen = true;
  map::StaticChoice& chosen = better ? with : without;
  chosen.candidates.push_back(plain);
  chosen.candidates.push_back(wavy);
  if (!better) {
    joint_.reset();
    waves_.clear();
    line_ = before_line;
    solve(true);
  }
  return std::move(chosen);
}

}  // namespace stribeck::ident::drive
