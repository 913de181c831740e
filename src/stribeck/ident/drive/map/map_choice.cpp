#include <algorithm>
#include <cmath>
#include <stribeck/ident/drive/map/map_choice.hpp>
#include <stribeck/ident/drive/summary.hpp>

namespace stribeck::ident::drive {
namespace {

/// Sums by block and bin of the residual of the linear terms: for the fit, and for judging with terms fitted without the block.
std::array<map::SideSums, map::kSides> sums_left(const AlignedLog& log, const Rows& rows, const Terms& terms,
                                                 const LinearFit& fit) {
  std::array<map::SideSums, map::kSides> sums;
  for (std::size_t s = 0; s < map::kSides; ++s) {
    sums[s].grid = rows.grid[s];
    const std::vector<double> zero(static_cast<std::size_t>(rows.grid[s].bins));
    const map::BlockSums empty{zero, zero, zero, zero};
    sums[s].block.assign(rows.blocks, empty);
    sums[s].held.assign(rows.blocks, empty);
  }
  const std::size_t q = terms.count();
  std::vector<double> c(q + 1);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::size_t s = rows.side[i];
    const auto b = static_cast<std::size_t>(rows.bin[i]);
    const double speed = std::abs(velocity_of(log, rows, i));
    const double force = terms.fill(log, rows, i, c.data()) - fit.load;
    double full = force, held = force;
    const VectorXd& other = fit.held_out[rows.block[i]];
    for (std::size_t j = 0; j < q; ++j) {
      full -= fit.value(static_cast<Index>(j)) * c[j];
      held -= other(static_cast<Index>(j)) * c[j];
    }
    const auto add = [&](map::BlockSums& block, double f) {
      f *= map::kDirection[s];
      block.n[b] += 1.0;
      block.v[b] += speed;
      block.f[b] += f;
      block.ff[b] += f * f;
    };
    add(sums[s].block[rows.block[i]], full);
    add(sums[s].held[rows.block[i]], held);
  }
  return sums;
}

const char* const kTogether = "with periodic terms: ";

/// The maps of few parameters fitted together with the linear terms, and their held-out losses.
struct JointFits {
  std::vector<JointFit> fits;
  std::vector<std::vector<double>> losses;  ///< of each fit, by block
  std::vector<std::size_t> complexity, parameters;

  JointFits(const std::vector<map::StaticFit>& starts, const LinearFit& fit) {
    const std::size_t blocks = fit.sums.blocks;
    for (const map::StaticFit& start : starts) {
      JointFit joint = fit_jointly(start, fit, blocks);
      if (!joint.good) continue;
      std::vector<double> loss;
      for (std::size_t k = 0; k < blocks; ++k)
        loss.push_back(loss_of(fit_jointly(joint.map, fit, k), fit.sums, k));
      losses.push_back(std::move(loss));
      complexity.push_back(joint.map.complexity());
      parameters.push_back(joint.map.parameters());
      fits.push_back(std::move(joint));
    }
  }

  void take(std::size_t i, MapChoice& choice) const {
    map::StaticChoice& map = choice.map;
    for (Candidate& c : map.candidates) c.chosen = c.name == kTogether + fits[i].map.name();
    double loss = 0.0;
    for (const double l : losses[i]) loss += l;
    map.fit = fits[i].map;
    map.block_loss = losses[i];
    map.held_out_rms = std::sqrt(std::max(0.0, loss / map.tested));
    choice.joint = fits[i].linear;
  }
};

}  // namespace

MapChoice choose_map(const AlignedLog& log, const Rows& rows, const Terms& terms, const LinearFit& fit,
                     const DriveFitOptions& options) {
  map::StaticOptions statics;
  statics.terms = options.terms;
  statics.most_terms = options.most_terms;
  statics.symmetric = options.symmetric;
  statics.weighted = options.weighted;
  MapChoice out{map::choose_static(sums_left(log, rows, terms, fit), statics), std::nullopt};
  out.map.fit.load += fit.load;
  for (map::StaticFit& rival : out.map.rivals) rival.load += fit.load;
  for (map::StaticFit& simple : out.map.simple) simple.load += fit.load;
  return out;
}

MapChoice with_joint_fits(MapChoice choice, const LinearFit& fit) {
  map::StaticChoice& map = choice.map;
  choice.joint.reset();
  const JointFits together(map.simple, fit);
  std::vector<std::vector<double>> losses = together.losses;
  losses.insert(losses.begin(), map.block_loss);
  std::vector<std::size_t> complexity = together.complexity;
  complexity.insert(complexity.begin(), map.fit.complexity());
  std::vector<std::size_t> parameters = together.parameters;
  parameters.insert(parameters.begin(), 0);  // none is the same law with another exponent
  const map::Picked picked = map::pick(losses, complexity, parameters, map.tested, map.friction);
  for (std::size_t i = 0; i < together.fits.size(); ++i) {
    Candidate c;
    c.name = kTogether + together.fits[i].map.name();
    c.parameters = static_cast<int>(together.fits[i].map.parameters());
    c.held_out_rms = picked.rms[i + 1];
    c.standard_error = picked.error[i + 1];
    map.candidates.push_back(std::move(c));
  }
  if (picked.chosen == 0) return choice;
  map.rivals.clear();
  for (std::size_t i = 0; i < together.fits.size(); ++i) {
    if (picked.equal[i + 1] && i + 1 != picked.chosen) map.rivals.push_back(together.fits[i].map);
  }
  together.take(picked.chosen - 1, choice);
  return choice;
}

std::optional<MapChoice> only_joint_fits(MapChoice choice, const LinearFit& fit) {
  const JointFits together(choice.map.simple, fit);
  if (together.fits.empty()) return std::nullopt;
  const map::Picked picked = map::pick(together.losses, together.complexity, together.parameters,
                                       choice.map.tested, choice.map.friction);
  choice.map.rivals.clear();
  for (std::size_t i = 0; i < together.fits.size(); ++i) {
    if (picked.equal[i] && i != picked.chosen) choice.map.rivals.push_back(together.fits[i].map);
  }
  together.take(picked.chosen, choice);
  return choice;
}

namespace {

/// Straight line of one direction: what the rows tell, with the load in the level.
LineSpread line_of(const map::StaticFit& fit, int side, const map::Grid& grid) {
  const Summary summary = summary_of(fit, side, grid);
  return {summary.coulomb.value + map::kDirection[static_cast<std::size_t>(side)] * fit.load,
          summary.viscous.value};
}

/// Standard deviation of a quantity of the maps that the data cannot tell apart, about that of the chosen one.
template <class Quantity>
double spread_of(const MapChoice& choice, Quantity&& quantity) {
  const double own = quantity(choice.map.fit);
  double square = 0.0;
  for (const map::StaticFit& r : choice.map.rivals) square += std::pow(quantity(r) - own, 2.0);
  return std::sqrt(square / static_cast<double>(choice.map.rivals.size() + 1));
}

}  // namespace

double spread_of_friction(const MapChoice& choice, int side, double speed) {
  return spread_of(choice, [&](const map::StaticFit& f) { return f.force(side, speed); });
}

double spread_of_v0(const MapChoice& choice) {
  double square = 0.0;
  for (const map::StaticFit& r : choice.map.rivals) {
    if (r.family == map::StaticFit::Family::kSymmetricStribeck)
      square += std::pow(r.v0 - choice.map.fit.v0, 2.0);
  }
  return std::sqrt(square / static_cast<double>(choice.map.rivals.size() + 1));
}

LineSpread spread_of_line(const MapChoice& choice, int side, const map::Grid& grid) {
  if (choice.map.fit.family == map::StaticFit::Family::kByDirection) return {};
  return {spread_of(choice, [&](const map::StaticFit& f) { return line_of(f, side, grid).coulomb; }),
          spread_of(choice, [&](const map::StaticFit& f) { return line_of(f, side, grid).viscous; })};
}

double spread_of_load(const MapChoice& choice, const std::array<map::Grid, map::kSides>& grid) {
  return spread_of(choice, [&](const map::StaticFit& f) {
    return 0.5 * (line_of(f, 0, grid[0]).coulomb - line_of(f, 1, grid[1]).coulomb);
  });
}

}  // namespace stribeck::ident::drive
