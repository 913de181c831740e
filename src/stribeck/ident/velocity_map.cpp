#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <stribeck/ident/gaussian_fit.hpp>
#include <stribeck/ident/long_run.hpp>
#include <stribeck/ident/motion.hpp>
#include <stribeck/ident/uncertainty.hpp>
#include <stribeck/ident/velocity_map.hpp>

namespace stribeck::ident {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Index = Eigen::Index;

constexpr int kSides = 2;  // 0: v > 0, 1: v < 0
constexpr double kDirection[kSides] = {1.0, -1.0};
const char* const kSideName[kSides] = {"positive", "negative"};

/// exp(−6) = 0.25 % of the swing at a reversal is left beyond six relaxation lengths.
constexpr double kRelaxations = 6.0;
/// Largest relative change of speed within one relaxation length: the lag, first order in it, is then small
/// and known.
constexpr double kLagShare = 0.2;
constexpr std::size_t kFewestRows = 60;
constexpr double kSmallSpeed = 0.04;  // of the largest: below it only the lag and the bristle are seen

struct Rows {
  std::vector<double> v, a, f, z;
  std::vector<int> record;
  std::vector<std::size_t> at;
  std::vector<int> stretch;  // counted over all records

  [[nodiscard]] std::size_t size() const noexcept { return v.size(); }
  void reserve(std::size_t n) {
    v.reserve(n), a.reserve(n), f.reserve(n), z.reserve(n), record.reserve(n), at.reserve(n),
        stretch.reserve(n);
  }
};

int side_of(double v) { return v > 0.0 ? 0 : 1; }

/// Bins of speed of one direction.
struct Grid {
  double low = 0.0;   // [m/s]
  double high = 0.0;  // [m/s]
  int bins = 1;

  [[nodiscard]] int bin(double speed) const noexcept {
    return std::clamp(static_cast<int>((speed - low) / (high - low) * bins), 0, bins - 1);
  }
};

/// Means over bins, joined by straight lines: a map of friction without a model.
struct Polyline {
  Grid grid;
  std::vector<double> speed, force, weight;  // occupied bins
  std::vector<int> next;  // first occupied bin whose mean speed is above the left edge of the bin

  void build(const Grid& g, const std::vector<double>& n, const std::vector<double>& sum_v,
             const std::vector<double>& sum_f) {
    grid = g;
    speed.clear(), force.clear(), weight.clear();
    for (int b = 0; b < g.bins; ++b) {
      const auto i = static_cast<std::size_t>(b);
      if (n[i] <= 0.0) continue;
      speed.push_back(sum_v[i] / n[i]);
      force.push_back(sum_f[i] / n[i]);
      weight.push_back(n[i]);
    }
    next.assign(static_cast<std::size_t>(g.bins), static_cast<int>(speed.size()));
    for (int b = g.bins - 1, i = static_cast<int>(speed.size()); b >= 0; --b) {
      const double left = g.low + (g.high - g.low) * b / g.bins;
      while (i > 0 && speed[static_cast<std::size_t>(i) - 1] > left) --i;
      next[static_cast<std::size_t>(b)] = i;
    }
  }
  [[nodiscard]] double operator()(double s) const noexcept {
    if (s <= speed.front()) return force.front();
    if (s >= speed.back()) return force.back();
    auto i = static_cast<std::size_t>(next[static_cast<std::size_t>(grid.bin(s))]);
    while (speed[i] < s) ++i;
    if (i == 0) return force.front();
    const double share = (s - speed[i - 1]) / (speed[i] - speed[i - 1]);
    return force[i - 1] + share * (force[i] - force[i - 1]);
  }
};

/// Slope of a straight line through the polyline, not below zero: the part that does not go through the
/// bristle.
double viscous_of(const Polyline& p) {
  double n = 0, sv = 0, sf = 0, svv = 0, svf = 0;
  for (std::size_t i = 0; i < p.speed.size(); ++i) {
    n += p.weight[i];
    sv += p.weight[i] * p.speed[i];
    sf += p.weight[i] * p.force[i];
    svv += p.weight[i] * p.speed[i] * p.speed[i];
    svf += p.weight[i] * p.speed[i] * p.force[i];
  }
  const double det = n * svv - sv * sv;
  return det > 0.0 ? std::max(0.0, (n * svf - sv * sf) / det) : 0.0;
}

/// Peaks of the smoothed map after its straight line is taken off, the border at the highest speed counted
/// (thesis §2.4.3). Of two neighbouring peaks the lower one counts if it stands out of the valley between
/// them.
int peaks_of(const Polyline& p) {
  const std::size_t n = p.speed.size();
  double sw = 0, sv = 0, sf = 0, svv = 0, svf = 0, highest = 0;
  for (std::size_t i = 0; i < n; ++i) {
    sw += p.weight[i], sv += p.weight[i] * p.speed[i], sf += p.weight[i] * p.force[i];
    svv += p.weight[i] * p.speed[i] * p.speed[i], svf += p.weight[i] * p.speed[i] * p.force[i];
    highest = std::max(highest, std::abs(p.force[i]));
  }
  const double slope = (sw * svf - sv * sf) / (sw * svv - sv * sv);
  std::vector<double> rest(n);
  const double width = 0.02 * (p.speed.back() - p.speed.front());
  for (std::size_t i = 0; i < n; ++i) {
    double weight = 0, sum = 0;
    for (std::size_t j = 0; j < n; ++j) {
      const double d = (p.speed[j] - p.speed[i]) / width;
      if (std::abs(d) > 4.0) continue;
      const double w = p.weight[j] * std::exp(-0.5 * d * d);
      weight += w, sum += w * (p.force[j] - slope * p.speed[j]);
    }
    rest[i] = sum / weight;
  }
  const double stands_out = 0.01 * highest;
  int peaks = 0;
  double top = rest[0], valley = rest[0];
  bool rising = false;
  for (const double f : rest) {
    if (rising) {
      top = std::max(top, f);
      if (f < top - stands_out) ++peaks, rising = false, valley = f;
    } else {
      valley = std::min(valley, f);
      if (f > valley + stands_out) rising = true, top = f;
    }
  }
  return peaks + (rising ? 1 : 0);
}

/// Bristle in the domain of the way slid.
struct Bristle {
  double sigma0 = std::numeric_limits<double>::infinity();
  double length = 0.0;  // g/σ0 [m]
};

class Identification {
 public:
  Identification(const std::vector<Record>& records, const VelocityMapOptions& options)
      : records_(records), options_(options) {}

  Result run() {
    prepare();
    // First pass: bristle unknown, generous exclusion.
    double stroke = 0.0;
    double hysteresis = 0.0;
    for (const Motion& m : motions_) {
      stroke = std::max(stroke, m.stroke);
      hysteresis = std::max(hysteresis, 20.0 * m.position_noise);
    }
    pilot_distance_ = std::max(hysteresis, 2e-3 * stroke);
    double top = 0.0;
    for (const Motion& m : motions_) {
      for (std::size_t k = 0; k < m.rows(); ++k) top = m.valid(k) ? std::max(top, std::abs(m.v[k])) : top;
    }
    gather(pilot_distance_, kSmallSpeed * top, 0.0);
    mass_ = options_.mass.value_or(0.0);
    nonparametric(false);
    nonparametric(true);
    find_bristle();
    if (bristle_.length > 0.0) {
      gather(kRelaxations * bristle_.length, 0.5 * kSmallSpeed * top, bristle_.length);
      remove_lag();
      nonparametric(true);
      remove_lag();
    }
    nonparametric(true);
    fit();
    intervals();
    return finish();
  }

 private:
  void prepare() {
    if (records_.empty()) throw Refused("velocity map: no record given");
    for (const Record& r : records_) {
      const auto wrong = problems(r);
      if (!wrong.empty()) throw Refused(wrong.front());
      motions_.push_back(reconstruct(r));
      if (motions_.back().loop == Loop::kAutomatic) {
        warn(r.source +
             ": no reference and no programmed force: the mass rests on smoothed accelerations alone");
      }
    }
  }
  void warn(std::string text) { result_.warnings.push_back(std::move(text)); }

  void gather(double exclude, double slowest, double relaxation) {
    rows_ = {};
    std::size_t total = 0;
    for (const Motion& m : motions_) total += m.rows();
    rows_.reserve(total);
    int before = 0;
    for (std::size_t r = 0; r < motions_.size(); ++r) {
      const Motion& m = motions_[r];
      for (std::size_t k = 0; k < m.rows(); ++k) {
        const double speed = m.v[k] * m.direction[k];
        if (speed < slowest || relaxation * std::abs(m.a[k]) > kLagShare * speed * speed ||
            !m.sliding(k, exclude))
          continue;
        rows_.v.push_back(m.v[k]);
        rows_.a.push_back(m.a[k]);
        rows_.f.push_back(m.f[k]);
        rows_.z.push_back(m.a[k]);
        rows_.record.push_back(static_cast<int>(r));
        rows_.at.push_back(k);
        rows_.stretch.push_back(before + m.stretch[k]);
      }
      before += static_cast<int>(m.reversals.size());
    }
    std::size_t count[kSides] = {0, 0};
    for (Grid& g : grid_) g = {std::numeric_limits<double>::infinity(), 0.0, 1};
    for (const double v : rows_.v) {
      Grid& g = grid_[side_of(v)];
      g.low = std::min(g.low, std::abs(v));
      g.high = std::max(g.high, std::abs(v));
      ++count[side_of(v)];
    }
    for (int s = 0; s < kSides; ++s) {
      if (count[s] < kFewestRows || !(grid_[s].high > grid_[s].low)) {
        throw Refused("velocity map: " + std::to_string(count[s]) + " rows of " + kSideName[s] +
                      " sliding motion, expected at least " + std::to_string(kFewestRows) +
                      "; run the axis through its speeds in both directions");
      }
      grid_[s].bins = std::max(8, std::min(options_.bins, static_cast<int>(count[s] / 12)));
    }
    side_.resize(rows_.size());
    bin_.resize(rows_.size());
    lag_.assign(rows_.size(), 0.0);
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const int s = side_of(rows_.v[i]);
      side_[i] = static_cast<std::uint8_t>(s);
      bin_[i] = grid_[s].bin(std::abs(rows_.v[i]));
    }
  }

  /// Friction left in row i at a mass [N], against the motion.
  [[nodiscard]] double friction(std::size_t i, double mass) const {
    return kDirection[side_[i]] * (rows_.f[i] - lag_[i] - mass * rows_.a[i]);
  }

  /// Mass from rows of equal velocity, then the polyline of friction. `instruments`: the polyline of the pass
  /// before is there, to take slopes within a bin out and to make an instrument of a programmed force.
  void nonparametric(bool instruments) {
    const std::size_t n = rows_.size();
    std::vector<double> y(n);
    for (std::size_t i = 0; i < n; ++i) {
      const double known = instruments ? kDirection[side_[i]] * line_[side_[i]](std::abs(rows_.v[i])) : 0.0;
      y[i] = rows_.f[i] - lag_[i] - known;
      const Motion& m = motions_[static_cast<std::size_t>(rows_.record[i])];
      const double raw = m.instrument[rows_.at[i]];
      rows_.z[i] = !instruments ? rows_.a[i] : m.loop == Loop::kOpen ? (raw - known) / mass_ : raw;
    }
    struct Sums {
      double n = 0, z = 0, a = 0, y = 0;
    };
    std::vector<Sums> sums[kSides];
    for (int s = 0; s < kSides; ++s) sums[s].assign(static_cast<std::size_t>(grid_[s].bins), {});
    for (std::size_t i = 0; i < n; ++i) {
      Sums& b = sums[side_[i]][static_cast<std::size_t>(bin_[i])];
      b.n += 1.0;
      b.z += rows_.z[i];
      b.a += rows_.a[i];
      b.y += y[i];
    }
    double szz = 0, sza = 0, saa = 0, szy = 0, say = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const Sums& b = sums[side_[i]][static_cast<std::size_t>(bin_[i])];
      const double z = rows_.z[i] - b.z / b.n;
      const double a = rows_.a[i] - b.a / b.n;
      const double d = y[i] - b.y / b.n;
      rows_.z[i] = z;
      szz += z * z;
      sza += z * a;
      saa += a * a;
      szy += z * d;
      say += a * d;
    }
    if (instruments && !(sza * sza > 0.1 * szz * saa)) {
      if (!weak_)
        warn("the reference hardly moves with the measured acceleration; the mass rests on the latter");
      weak_ = true;
      for (std::size_t i = 0; i < n; ++i) {
        const Sums& b = sums[side_[i]][static_cast<std::size_t>(bin_[i])];
        rows_.z[i] = rows_.a[i] - b.a / b.n;
      }
      sza = saa;
      szy = say;
    }
    slope_ = sza;
    if (!options_.mass) mass_ = std::abs(sza) > 0.0 ? szy / sza : 0.0;
    for (int s = 0; s < kSides; ++s) {
      const auto bins = static_cast<std::size_t>(grid_[s].bins);
      std::vector<double> count(bins, 0.0), sum_v(bins, 0.0), sum_f(bins, 0.0);
      for (std::size_t i = 0; i < n; ++i) {
        if (side_[i] != s) continue;
        const auto b = static_cast<std::size_t>(bin_[i]);
        count[b] += 1.0;
        sum_v[b] += std::abs(rows_.v[i]);
        sum_f[b] += friction(i, mass_);
      }
      line_[s].build(grid_[s], count, sum_v, sum_f);
      viscous_[s] = viscous_of(line_[s]);
    }
  }

  [[nodiscard]] double level(int side, double speed) const {
    const double g = line_[side](speed) - viscous_[side] * speed;
    return std::max(g, 0.05 * line_[side].force.front());
  }

  /// σ0 from the rows around reversals.
  void find_bristle() {
    struct Near {
      std::size_t record, at;
      int side;
      double way;  // since the row before, in the direction of motion [m]
      double g;    // [N]
      bool fresh;  // the row before is not in the list
      bool judged;
    };
    std::vector<Near> near;
    for (std::size_t r = 0; r < motions_.size(); ++r) {
      const Motion& m = motions_[r];
      if (m.reversals.size() < 2) continue;
      const auto reach = static_cast<std::size_t>(m.reach);
      std::size_t last = 0;
      for (std::size_t j = 0; j < m.reversals.size(); ++j) {
        const std::size_t at = m.reversals[j];
        // Before the first movement the state of the bristle is not known.
        if (j == 0) continue;
        std::size_t k = std::max(last + 1, at > 2 * reach ? at - 2 * reach : 1);
        for (; k < m.rows(); ++k) {
          if (k > at && (m.distance[k] > pilot_distance_ || m.stretch[k] > m.stretch[at])) break;
          const int side = m.direction[k] > 0 ? 0 : 1;
          const double way =
              m.stretch[k] == m.stretch[k - 1] ? m.distance[k] - m.distance[k - 1] : m.distance[k];
          near.push_back({r, k, side, way, level(side, std::abs(m.v[k])), k != last + 1 || near.empty(),
                          m.valid(k) && k >= at});
          last = k;
        }
        for (std::size_t tail = 0; tail < reach && k < m.rows(); ++tail, ++k) {
          const int side = m.direction[k] > 0 ? 0 : 1;
          if (m.stretch[k] != m.stretch[k - 1]) break;
          near.push_back({r, k, side, m.distance[k] - m.distance[k - 1], level(side, std::abs(m.v[k])),
                          k != last + 1, false});
          last = k;
        }
        if (near.size() > 40000) break;
      }
    }
    if (near.size() < 20) {
      warn(
          "no reversal of motion in the log: the distance to break away is not known and nothing is left out "
          "for it");
      return;
    }
    std::vector<double> model(near.size());
    auto cost = [&](double sigma0) {
      double force = 0.0;
      for (std::size_t i = 0; i < near.size(); ++i) {
        const Near& p = near[i];
        const double target = kDirection[p.side] * p.g;
        if (p.fresh) force = target;
        force = target + (force - target) * std::exp(-sigma0 * std::max(0.0, p.way) / p.g);
        model[i] = force;
      }
      double sum = 0.0;
      std::size_t count = 0;
      for (std::size_t i = 0; i < near.size(); ++i) {
        const Near& p = near[i];
        if (!p.judged) continue;
        const Motion& m = motions_[p.record];
        const auto half = static_cast<std::size_t>(3 * m.window);
        if (i < half || i + half >= near.size() || near[i - half].at + half != p.at ||
            near[i + half].at != p.at + half)
          continue;
        const std::vector<double>& w = weights_[p.record];
        double smooth = 0.0;
        for (std::size_t j = 0; j < w.size(); ++j) smooth += w[j] * model[i + j - half];
        const double e = m.f[p.at] - mass_ * m.a[p.at] - viscous_[p.side] * m.v[p.at] - smooth;
        sum += e * e;
        ++count;
      }
      return count > 0 ? sum / static_cast<double>(count) : 0.0;
    };
    weights_.clear();
    for (const Motion& m : motions_) {
      std::vector<double> impulse(static_cast<std::size_t>(12 * m.window + 1), 0.0);
      impulse[impulse.size() / 2] = 1.0;
      const std::vector<double> w = smooth_like(m, impulse);
      const auto centre = static_cast<std::ptrdiff_t>(impulse.size() / 2);
      weights_.emplace_back(w.begin() + centre - 3 * m.window, w.begin() + centre + 3 * m.window + 1);
    }
    const double g = std::max(level(0, 0.0), level(1, 0.0));
    // Relaxation lengths from a thousandth of the pilot distance to a third of it.
    const double lowest = std::log(g / (pilot_distance_ / 3.0));
    const double highest = std::log(g / (pilot_distance_ / 1000.0));
    constexpr int kCoarse = 12;
    int best = 0;
    double least = std::numeric_limits<double>::infinity();
    double costs[kCoarse + 1];
    for (int i = 0; i <= kCoarse; ++i) {
      costs[i] = cost(std::exp(lowest + (highest - lowest) * i / kCoarse));
      if (costs[i] < least) least = costs[i], best = i;
    }
    double lo = lowest + (highest - lowest) * std::max(0, best - 1) / kCoarse;
    double hi = lowest + (highest - lowest) * std::min(kCoarse, best + 1) / kCoarse;
    const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
    double p = hi - golden * (hi - lo), q = lo + golden * (hi - lo);
    double cp = cost(std::exp(p)), cq = cost(std::exp(q));
    while (hi - lo > 0.01) {
      if (cp < cq) {
        hi = q, q = p, cq = cp, p = hi - golden * (hi - lo), cp = cost(std::exp(p));
      } else {
        lo = p, p = q, cp = cq, q = lo + golden * (hi - lo), cq = cost(std::exp(q));
      }
    }
    bristle_.sigma0 = std::exp(0.5 * (lo + hi));
    bristle_.length = g / bristle_.sigma0;
    result_.break_away_distance = bristle_.length;
  }

  /// What friction lags behind its steady state in each row.
  void remove_lag() {
    std::size_t i = 0;
    for (std::size_t r = 0; r < motions_.size(); ++r) {
      const Motion& m = motions_[r];
      double force = 0.0;
      bool fresh = true;
      for (std::size_t k = 1; k < m.rows(); ++k) {
        const int side = m.direction[k] > 0 ? 0 : 1;
        const double target = level(side, std::abs(m.v[k]));
        if (m.stretch[k] != m.stretch[k - 1]) {
          // Deflected the other way by the end of the stretch before.
          force = fresh ? target : -force;
        }
        if (fresh) force = target, fresh = false;
        const double way =
            m.stretch[k] == m.stretch[k - 1] ? m.distance[k] - m.distance[k - 1] : m.distance[k];
        const double y = bristle_.sigma0 * std::max(0.0, way) / target;
        force = target + (force - target) * std::exp(-y);
        if (i < rows_.size() && rows_.record[i] == static_cast<int>(r) && rows_.at[i] == k) {
          lag_[i] = kDirection[side] * (force - target);
          ++i;
        }
      }
    }
  }

  struct Block {
    std::vector<double> n, v, f, ff;  // by bin
  };

  void fit() {
    // Blocks of motion for the held-out error: whole stretches, dealt out in turn.
    for (int s = 0; s < kSides; ++s) {
      std::vector<int> stretches;
      for (std::size_t i = 0; i < rows_.size(); ++i) {
        if (side_[i] == s && (stretches.empty() || stretches.back() != rows_.stretch[i]))
          stretches.push_back(rows_.stretch[i]);
      }
      const std::size_t folds = std::clamp<std::size_t>(stretches.size(), 4, 8);
      const bool whole = stretches.size() >= 4;
      const auto bins = static_cast<std::size_t>(grid_[s].bins);
      std::vector<Block> block(folds);
      for (Block& b : block)
        b.n.assign(bins, 0), b.v.assign(bins, 0), b.f.assign(bins, 0), b.ff.assign(bins, 0);
      std::size_t ordinal = 0;
      int stretch = stretches.front();
      std::size_t seen = 0;
      std::size_t count = 0;
      for (std::size_t i = 0; i < rows_.size(); ++i) count += side_[i] == s;
      const std::size_t piece = std::max<std::size_t>(1, count / (folds * 5));
      for (std::size_t i = 0; i < rows_.size(); ++i) {
        if (side_[i] != s) continue;
        if (rows_.stretch[i] != stretch) stretch = rows_.stretch[i], ++ordinal;
        const std::size_t fold = (whole ? ordinal : seen / piece) % folds;
        ++seen;
        Block& b = block[fold];
        const auto at = static_cast<std::size_t>(bin_[i]);
        const double f = friction(i, mass_);
        b.n[at] += 1.0;
        b.v[at] += std::abs(rows_.v[i]);
        b.f[at] += f;
        b.ff[at] += f * f;
      }
      fit_side(s, block);
    }
  }

  [[nodiscard]] static Bins bins_of(const std::vector<Block>& block, std::size_t without, double top,
                                    std::vector<char>* filled) {
    Bins bins;
    const std::size_t count = block.front().n.size();
    if (filled != nullptr) filled->assign(count, 0);
    for (std::size_t b = 0; b < count; ++b) {
      double n = 0, v = 0, f = 0;
      for (std::size_t k = 0; k < block.size(); ++k) {
        if (k == without) continue;
        n += block[k].n[b];
        v += block[k].v[b];
        f += block[k].f[b];
      }
      if (n <= 0.0) continue;
      bins.u.push_back(v / n / top);
      bins.force.push_back(f / n);
      bins.weight.push_back(n);
      if (filled != nullptr) (*filled)[b] = 1;
    }
    return bins;
  }

  void fit_side(int s, const std::vector<Block>& block) {
    const double top = grid_[s].high;
    const Bins all = bins_of(block, block.size(), top, nullptr);
    double within = 0.0, rows = 0.0, highest = 0.0;
    for (std::size_t b = 0; b < block.front().n.size(); ++b) {
      double n = 0, f = 0, ff = 0;
      for (const Block& k : block) n += k.n[b], f += k.f[b], ff += k.ff[b];
      if (n > 0) within += ff - f * f / n, rows += n, highest = std::max(highest, std::abs(f / n));
    }
    FitSettings settings;
    settings.noise = std::max(std::sqrt(std::max(0.0, within) / rows), 1e-7 * highest);
    settings.height_scale = 10.0 * highest;
    settings.slope_scale = 0.2 * highest;
    const int most = options_.terms.value_or(options_.most_terms);
    std::vector<BranchFit> ladder = fit_ladder(all, most, settings);

    std::size_t chosen = ladder.size() - 1;
    if (!options_.terms) {
      const std::size_t folds = block.size();
      std::vector<std::vector<double>> loss(ladder.size(), std::vector<double>(folds, 0.0));
      std::vector<double> tested(folds, 0.0);
      for (std::size_t k = 0; k < folds; ++k) {
        std::vector<char> filled;
        const Bins rest = bins_of(block, k, top, &filled);
        for (std::size_t n = 0; n < ladder.size(); ++n) {
          const BranchFit part = refine(rest, ladder[n], settings);
          for (std::size_t b = 0; b < filled.size(); ++b) {
            const double count = block[k].n[b];
            if (!filled[b] || count <= 0.0) continue;
            const double f = part.force(block[k].v[b] / count / top);
            loss[n][k] += block[k].ff[b] - 2.0 * f * block[k].f[b] + f * f * count;
            if (n == 0) tested[k] += count;
          }
        }
      }
      const double total = std::accumulate(tested.begin(), tested.end(), 0.0);
      std::vector<double> mean(ladder.size());
      for (std::size_t n = 0; n < ladder.size(); ++n) {
        mean[n] = std::accumulate(loss[n].begin(), loss[n].end(), 0.0) / total;
      }
      const auto best = static_cast<std::size_t>(std::min_element(mean.begin(), mean.end()) - mean.begin());
      bool found = false;
      std::vector<char> equal(ladder.size(), 0);
      for (std::size_t n = 0; n < ladder.size(); ++n) {
        // Standard error of the mean difference from the best, over blocks.
        double square = 0.0;
        const double fold_mean = (mean[n] - mean[best]) * total / static_cast<double>(folds);
        for (std::size_t k = 0; k < folds; ++k)
          square += std::pow(loss[n][k] - loss[best][k] - fold_mean, 2.0);
        const auto m = static_cast<double>(folds);
        const double error = std::sqrt(square * m / (m - 1.0)) / total;
        Candidate c;
        c.name = "Gaussian, " + std::to_string(n) + (n == 1 ? " term, v " : " terms, v ") +
                 (s == 0 ? "> 0" : "< 0");
        c.terms = static_cast<int>(n);
        c.parameters = static_cast<int>(ladder[n].parameters());
        c.held_out_rms = std::sqrt(std::max(0.0, mean[n]));
        c.standard_error = c.held_out_rms > 0 ? error / (2.0 * c.held_out_rms) : 0.0;
        equal[n] = mean[n] - mean[best] <= error;
        if (!found && equal[n]) {
          found = true;
          chosen = n;
          c.chosen = true;
          held_out_ += mean[n] * total;
          held_rows_ += total;
        }
        result_.models.push_back(std::move(c));
      }
      for (std::size_t n = 0; n < ladder.size(); ++n) {
        if (equal[n] && n != chosen) rivals_[s].push_back(ladder[n]);
      }
    }
    branch_[s] = ladder[chosen];
    std::sort(branch_[s].terms.begin(), branch_[s].terms.end(),
              [](const FitTerm& x, const FitTerm& y) { return x.b < y.b; });
  }

  void intervals() {
    const std::size_t n = rows_.size();
    std::vector<double> e(n);
    for (std::size_t i = 0; i < n; ++i) {
      const int s = side_[i];
      e[i] = kDirection[s] * (friction(i, mass_) - branch_[s].force(std::abs(rows_.v[i]) / grid_[s].high));
    }
    memory_ = memory_of(e, rows_.record, rows_.at);
    double square = 0.0;
    double instrument = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      square += e[i] * e[i];
      instrument += rows_.z[i] * rows_.z[i];
    }
    double mass_variance = 0.0;
    for (int s = 0; s < kSides; ++s) {
      const BranchFit& fit = branch_[s];
      const std::size_t p = fit.parameters();
      // One stacked estimator: the mass from all rows, the branch from its own.
      LongRun moments(p + 1, memory_);
      MatrixXd normal = MatrixXd::Zero(static_cast<Index>(p), static_cast<Index>(p));
      VectorXd along = VectorXd::Zero(static_cast<Index>(p));
      VectorXd g(static_cast<Index>(p));
      for (std::size_t i = 0; i < n; ++i) {
        double* row = moments.row(rows_.record[i], rows_.at[i]);
        row[p] += rows_.z[i] * e[i];
        if (side_[i] != s) continue;
        fit.gradient(std::abs(rows_.v[i]) / grid_[s].high, g.data());
        const double signed_e = kDirection[s] * e[i];
        for (std::size_t j = 0; j < p; ++j) row[j] += g(static_cast<Index>(j)) * signed_e;
        normal.selfadjointView<Eigen::Lower>().rankUpdate(g);
        along += g * (kDirection[s] * rows_.a[i]);
      }
      const MatrixXd full = normal.selfadjointView<Eigen::Lower>();
      const std::vector<double> raw = moments.covariance();
      const MatrixXd meat =
          Eigen::Map<const MatrixXd>(raw.data(), static_cast<Index>(p + 1), static_cast<Index>(p + 1));

      // Directions that the data do not see are taken out; the curve on the data does not move along them.
      const VectorXd scale = full.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
      const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(scale.asDiagonal() * full * scale.asDiagonal());
      const VectorXd& values = eigen.eigenvalues();
      VectorXd inverse = VectorXd::Zero(values.size());
      blind_[s].assign(p, 0.0);
      for (Index j = 0; j < values.size(); ++j) {
        if (values(j) > 1e-9 * values.maxCoeff()) {
          inverse(j) = 1.0 / values(j);
        } else {
          for (std::size_t i = 0; i < p; ++i) {
            blind_[s][i] += std::pow(eigen.eigenvectors()(static_cast<Index>(i), j), 2.0);
          }
        }
      }
      const MatrixXd bread = scale.asDiagonal() * eigen.eigenvectors() * inverse.asDiagonal() *
                             eigen.eigenvectors().transpose() * scale.asDiagonal();
      const double mass_gain = options_.mass ? 0.0 : 1.0 / slope_;
      // β moves by bread·(moments − along·mass shift).
      MatrixXd map(static_cast<Index>(p), static_cast<Index>(p + 1));
      map.leftCols(static_cast<Index>(p)) = bread;
      map.col(static_cast<Index>(p)) = -bread * along * mass_gain;
      const double independent = static_cast<double>(n) / (2.0 * memory_.rows);
      const auto all = static_cast<double>(branch_[0].parameters() + branch_[1].parameters() + 1);
      const double freedom = std::max(3.0, independent - all);
      const double correction = std::max(1.0, independent / freedom);
      covariance_[s] = correction * map * meat * map.transpose();
      // The same under stationary noise. Newey–West sees at each speed only the few passes through it and is
      // often too small there by chance; the stationary form pools all rows but misses noise that depends on
      // speed. The larger of the two stands.
      const double noise = 2.0 * memory_.rows * square / static_cast<double>(n) * correction;
      pooled_[s] = noise * bread +
                   noise * instrument * mass_gain * mass_gain * (bread * along) * (bread * along).transpose();
      mass_variance =
          std::max({mass_variance, noise * instrument * mass_gain * mass_gain,
                    correction * meat(static_cast<Index>(p), static_cast<Index>(p)) * mass_gain * mass_gain});
      factor_ = student_factor(freedom);
    }
    mass_error_ = std::sqrt(std::max(0.0, mass_variance));
  }

  void add(std::string name, double value, const char* unit, const char* shown, double error, bool seen) {
    Parameter p;
    p.name = std::move(name);
    p.value = value;
    p.unit = unit;
    p.shown = shown;
    p.ci_low = value - factor_ * error;
    p.ci_high = value + factor_ * error;
    p.identifiable = seen && std::isfinite(error) && factor_ * error < std::abs(value);
    result_.parameters.push_back(std::move(p));
  }

  Result finish() {
    result_.method = "velocity-map";
    result_.model = "gaussian";
    result_.mass = mass_;
    result_.mass_interval = {mass_ - factor_ * mass_error_, mass_ + factor_ * mass_error_};
    result_.velocity_range = {-grid_[1].high, grid_[0].high};
    result_.rows = rows_.size();
    result_.peaks = {peaks_of(line_[0]), peaks_of(line_[1])};
    add("mass", mass_, "kg", "N s2/mm", mass_error_, true);
    if (!result_.parameters.back().identifiable) {
      warn("the mass cannot be determined from this log; run a sine or pulses, or give the mass");
    }
    friction::Gaussian<double> map;
    map.velocity_range = result_.velocity_range;
    for (int s = 0; s < kSides; ++s) write_branch(s, s == 0 ? map.positive : map.negative);
    result_.friction.steady = map;
    map.validate(
        [&](const auto&, const auto& text) { warn(std::string("friction map: ") + std::string(text)); });
    for (int s = kSides - 1; s >= 0; --s) write_curve(s);
    write_map_points();
    if (held_rows_ > 0) result_.held_out_rms = std::sqrt(std::max(0.0, held_out_ / held_rows_));
    return std::move(result_);
  }

  void write_branch(int s, friction::GaussianBranch<double>& branch) {
    const BranchFit& fit = branch_[s];
    const double top = grid_[s].high;
    const double d = kDirection[s];
    const std::string tail = std::string("_") + kSideName[s];
    auto error = [&](std::size_t i) {
      const auto k = static_cast<Index>(i);
      return std::sqrt(std::max({0.0, covariance_[s](k, k), pooled_[s](k, k)}));
    };
    auto seen = [&](std::size_t i) { return blind_[s][i] < 0.1; };
    branch.eta0 = d * fit.eta0;
    branch.eta1 = fit.eta1 / top;
    add("eta0" + tail, branch.eta0, "N", "N", error(0), seen(0));
    add("eta1" + tail, branch.eta1, "N s/m", "N s/mm", error(1) / top, seen(1));
    std::size_t i = 2;
    for (std::size_t k = 0; k < fit.terms.size(); ++k, i += 3) {
      const FitTerm& g = fit.terms[k];
      const std::string name = "gaussian_" + std::to_string(k + 1) + "_";
      branch.gaussians.push_back({d * g.a, d * g.b * top, g.c * top});
      add(name + "a" + tail, d * g.a, "N", "N", error(i), seen(i));
      add(name + "b" + tail, d * g.b * top, "m/s", "mm/s", error(i + 1) * top, seen(i + 1));
      add(name + "c" + tail, g.c * top, "m/s", "mm/s", error(i + 2) * top, seen(i + 2));
    }
  }

  void write_curve(int s) {
    const BranchFit& fit = branch_[s];
    const auto p = static_cast<Index>(fit.parameters());
    const int points = std::max(21, options_.curve_points);
    VectorXd g(p);
    for (int i = 0; i < points; ++i) {
      const int at = s == 0 ? i : points - 1 - i;
      const double speed = grid_[s].low + (grid_[s].high - grid_[s].low) * at / (points - 1);
      const double u = speed / grid_[s].high;
      fit.gradient(u, g.data());
      // What the models differ in that the data cannot tell apart is part of the uncertainty (Buckland et al.
      // 1997).
      double spread = 0.0;
      for (const BranchFit& r : rivals_[s]) spread += std::pow(r.force(u) - fit.force(u), 2.0);
      if (!rivals_[s].empty()) spread /= static_cast<double>(rivals_[s].size() + 1);
      const double half =
          factor_ * std::sqrt(std::max(g.dot(covariance_[s] * g), g.dot(pooled_[s] * g)) + spread);
      const double f = kDirection[s] * fit.force(u);
      result_.curve.push_back({kDirection[s] * speed, f, f - half, f + half});
    }
  }

  void write_map_points() {
    const auto wanted = static_cast<std::size_t>(std::max(1, 2 * options_.map_points));
    const std::size_t step = std::max<std::size_t>(1, rows_.size() / wanted);
    for (std::size_t i = 0; i < rows_.size(); i += step) {
      result_.map.push_back({rows_.v[i], rows_.f[i] - lag_[i] - mass_ * rows_.a[i], side_[i] == 0 ? 1 : -1});
    }
  }

  const std::vector<Record>& records_;
  const VelocityMapOptions& options_;
  Result result_;
  std::vector<Motion> motions_;
  std::vector<std::vector<double>> weights_;
  double pilot_distance_ = 0.0;
  Rows rows_;
  std::vector<std::uint8_t> side_;
  std::vector<int> bin_;
  std::vector<double> lag_;
  Grid grid_[kSides];
  Polyline line_[kSides];
  double viscous_[kSides] = {0.0, 0.0};
  double mass_ = 0.0;
  double slope_ = 0.0;
  bool weak_ = false;
  Bristle bristle_;
  BranchFit branch_[kSides];
  std::vector<BranchFit> rivals_[kSides];  // as good on held-out motion
  double held_out_ = 0.0;
  double held_rows_ = 0.0;
  Memory memory_;
  MatrixXd covariance_[kSides];
  MatrixXd pooled_[kSides];
  std::vector<double> blind_[kSides];
  double mass_error_ = 0.0;
  double factor_ = 1.96;
};

}  // namespace

Result identify_velocity_map(const std::vector<Record>& records, const VelocityMapOptions& options) {
  return Identification(records, options).run();
}

}  // namespace stribeck::ident
