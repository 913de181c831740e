#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <stribeck/ident/bristle_fit.hpp>
#include <stribeck/ident/drive_fit.hpp>
#include <stribeck/ident/drive_rows.hpp>
#include <stribeck/ident/long_run.hpp>
#include <stribeck/ident/motion.hpp>
#include <stribeck/ident/periodic.hpp>
#include <stribeck/ident/relaxation.hpp>
#include <stribeck/ident/static_fit.hpp>
#include <stribeck/ident/uncertainty.hpp>
#include <utility>

namespace stribeck::ident {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using friction::EccentricForm;
using Index = Eigen::Index;

/// exp(−6) = 0.25 % of the swing at a reversal is left beyond six relaxation lengths.
constexpr double kRelaxations = 6.0;
/// Largest relative change of speed within one relaxation length: the lag, first order in it, is then small
/// and known.
constexpr double kLagShare = 0.2;
constexpr std::size_t kFewestRows = 30;
constexpr double kSmallSpeed = 0.04;        // of the largest: below it only the lag and the bristle are seen
constexpr std::size_t kSampleRows = 60000;  // enough for what is only looked at
constexpr std::size_t kSampleChunk = 2000;  // rows in sequence: their correlation is seen
constexpr double kLongestShift = 0.03;      // [s]
constexpr double kMostShiftRows = 40.0;
constexpr double kWorthwhileShift = 1.02;  // ratio of the sums of squares: 1 % of the residual
constexpr double kPlainShift = 1.1;
constexpr double kSlowestLoop = 0.6;  // [s] that a position follows its reference by
constexpr std::size_t kShownResiduals = 4000;

std::string text(const char* format, auto... values) {
  char buffer[320];
  std::snprintf(buffer, sizeof buffer, format, values...);
  return buffer;
}

/// A term periodic in position: two columns, sine and cosine.
struct Wave {
  double period = 1.0;
  EccentricForm form = EccentricForm::kAdditive;
  Interval period_interval;
  std::vector<std::vector<double>> sine,
      cosine;  // of each record, through the window that the force has passed
};

class DriveFit {
 public:
  DriveFit(const std::vector<Record>& records, const DriveFitOptions& options)
      : records_(records), options_(options) {}

  Result run() {
    prepare();
    pilot();
    if (!options_.shift) find_shift();
    settle();
    StaticChoice choice = choose();
    if (options_.periodic) choice = try_periodic(std::move(choice));
    choice_ = std::move(choice);
    intervals();
    return finish();
  }

 private:
  void prepare() {
    if (records_.empty()) throw Refused("identification: no record given");
    motions_.reserve(records_.size()), force_.reserve(records_.size());
    for (const Record& r : records_) {
      const auto wrong = problems(r);
      if (!wrong.empty()) throw Refused(wrong.front());
      if (r.force_unit != records_.front().force_unit || r.position_unit != records_.front().position_unit) {
        throw Refused(r.source + ": its force is in " + r.force_unit + " and its position in " +
                      r.position_unit + ", expected " + records_.front().force_unit + " and " +
                      records_.front().position_unit + " as in " + records_.front().source);
      }
      MotionOptions motion;
      motion.cut_off = options_.cut_off;
      shift_ = options_.shift.value_or(-0.5);
      motion.shift = shift_;
      motion.smoothed_force = &force_.emplace_back();
      motions_.push_back(reconstruct(r, motion));
      predict(r, motions_.back());
      if (motions_.back().loop == Loop::kAutomatic) {
        warn(r.source +
             ": no reference and no programmed force: the mass rests on smoothed accelerations alone");
      }
    }
  }
  /// The motion that the reference alone explains, v̂ = Σ h_j·ṙ(k − l_j): free of the noise, and close to the
  /// measured motion even behind a slow position loop. Its acceleration is the instrument of the mass.
  void predict(const Record& record, Motion& m) {
    predicted_.emplace_back();
    if (m.loop != Loop::kClosed || record.r.empty()) return;
    const std::vector<double> r = smooth_like(m, record.r);
    const auto n = static_cast<std::ptrdiff_t>(r.size());
    std::vector<double> rate(r.size(), 0.0);
    for (std::size_t k = 1; k + 1 < r.size(); ++k) rate[k] = (r[k + 1] - r[k - 1]) / (2.0 * m.sample_time);
    std::vector<std::ptrdiff_t> lags{-1, 0, 1, 2, 3, 4};
    const auto longest =
        std::min<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(kSlowestLoop / m.sample_time), n / 8);
    while (lags.back() * 4 / 3 + 1 <= longest) lags.push_back(lags.back() * 4 / 3 + 1);
    const auto count = static_cast<Index>(lags.size());
    const auto row = [&](std::ptrdiff_t k, VectorXd& c) {
      for (Index j = 0; j < count; ++j) {
        const std::ptrdiff_t at = std::clamp<std::ptrdiff_t>(k - lags[static_cast<std::size_t>(j)], 0, n - 1);
        c(j) = rate[static_cast<std::size_t>(at)];
      }
    };
    MatrixXd normal = MatrixXd::Zero(count, count);
    VectorXd right = VectorXd::Zero(count), c(count);
    const std::ptrdiff_t step = n / 20000 + 1;
    for (std::ptrdiff_t k = m.reach; k + m.reach < n; k += step) {
      row(k, c);
      normal.selfadjointView<Eigen::Lower>().rankUpdate(c);
      right += c * m.v[static_cast<std::size_t>(k)];
    }
    // Neighbouring lags see nearly the same: a weak pull keeps their weights small.
    normal.diagonal().array() += 1e-6 * normal.trace() / static_cast<double>(count);
    const VectorXd h = normal.selfadjointView<Eigen::Lower>().ldlt().solve(right);
    std::vector<double>& v = predicted_.back();
    v.assign(r.size(), 0.0);
    // Lag by lag over pieces that stay in the cache.
    constexpr std::ptrdiff_t kPiece = 2048;
    for (std::ptrdiff_t from = 0; from < n; from += kPiece) {
      const std::ptrdiff_t to = std::min(n, from + kPiece);
      for (Index j = 0; j < count; ++j) {
        const std::ptrdiff_t lag = lags[static_cast<std::size_t>(j)];
        const std::ptrdiff_t inner = std::clamp(lag, from, to), outer = std::clamp(n + lag, inner, to);
        for (std::ptrdiff_t k = from; k < inner; ++k) v[static_cast<std::size_t>(k)] += h(j) * rate.front();
        Eigen::Map<VectorXd>(v.data() + inner, outer - inner) +=
            h(j) * Eigen::Map<const VectorXd>(rate.data() + (inner - lag), outer - inner);
        for (std::ptrdiff_t k = outer; k < to; ++k) v[static_cast<std::size_t>(k)] += h(j) * rate.back();
      }
    }
    for (std::size_t k = 1; k + 1 < r.size(); ++k)
      m.instrument[k] = (v[k + 1] - v[k - 1]) / (2.0 * m.sample_time);
  }

  void warn(std::string words) { result_.warnings.push_back(std::move(words)); }

  // ---- rows -----------------------------------------------------------------------------------------------

  void gather(double exclude, double slowest_share, double relaxation) {
    rows_.clear();
    rows_.reserve(std::accumulate(motions_.begin(), motions_.end(), std::size_t{0},
                                  [](std::size_t sum, const Motion& m) { return sum + m.rows(); }));
    int before = 0;
    for (std::size_t r = 0; r < motions_.size(); ++r) {
      const Motion& m = motions_[r];
      const std::vector<std::uint8_t>& skip = records_[r].skip;
      for (std::size_t k = 0; k < m.rows(); ++k) {
        const double speed = m.v[k] * m.direction[k];
        if (speed < slowest_share * top_[m.v[k] > 0.0 ? 0 : 1] ||
            relaxation * std::abs(m.a[k]) > kLagShare * speed * speed || !m.sliding(k, exclude))
          continue;
        if (!skip.empty() && skip[k] != 0) continue;
        rows_.record.push_back(static_cast<int>(r));
        rows_.at.push_back(k);
        rows_.stretch.push_back(before + m.stretch[k]);
        rows_.side.push_back(static_cast<std::uint8_t>(side_of(m.v[k])));
      }
      before += static_cast<int>(m.reversals.size());
    }
    std::array<std::size_t, kSides> count{};
    for (Grid& g : grid_) g = {std::numeric_limits<double>::infinity(), 0.0, 1};
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      Grid& g = grid_[rows_.side[i]];
      const double speed = std::abs(velocity(i));
      g.low = std::min(g.low, speed);
      g.high = std::max(g.high, speed);
      ++count[rows_.side[i]];
    }
    for (std::size_t s = 0; s < kSides; ++s) {
      if (count[s] < kFewestRows || !(grid_[s].high > grid_[s].low)) {
        throw Refused("identification: " + std::to_string(count[s]) + " rows of " + kSideName[s] +
                      " sliding motion, expected at least " + std::to_string(kFewestRows) +
                      "; run the axis through its speeds in both directions");
      }
      grid_[s].bins = std::max(8, std::min(options_.bins, static_cast<int>(count[s] / 12)));
    }
    rows_.bin.resize(rows_.size());
    rows_.lag.assign(rows_.size(), 0.0);
    for (std::size_t i = 0; i < rows_.size(); ++i)
      rows_.bin[i] = grid_[rows_.side[i]].bin(std::abs(velocity(i)));
    deal();
  }

  /// Blocks of motion for held-out errors: whole stretches, dealt out in turn; where there are few, pieces.
  void deal() {
    std::array<std::size_t, kSides> stretches{};
    std::array<std::size_t, kSides> count{};
    std::array<int, kSides> last{-1, -1};
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const std::size_t s = rows_.side[i];
      ++count[s];
      if (rows_.stretch[i] != last[s]) last[s] = rows_.stretch[i], ++stretches[s];
    }
    const std::size_t fewest = std::min(stretches[0], stretches[1]);
    // Primes: programmes repeat their speeds in other rhythms.
    blocks_ = fewest >= 7 ? 7 : 5;
    block_.resize(rows_.size());
    std::array<std::size_t, kSides> ordinal{}, seen{};
    last = {-1, -1};
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const std::size_t s = rows_.side[i];
      if (rows_.stretch[i] != last[s]) {
        if (last[s] >= 0) ++ordinal[s];
        last[s] = rows_.stretch[i];
      }
      const std::size_t piece = std::max<std::size_t>(1, count[s] / (blocks_ * 5));
      block_[i] =
          static_cast<std::uint8_t>((stretches[s] >= blocks_ ? ordinal[s] : seen[s] / piece) % blocks_);
      ++seen[s];
    }
  }

  [[nodiscard]] const Motion& motion(std::size_t i) const {
    return motions_[static_cast<std::size_t>(rows_.record[i])];
  }
  [[nodiscard]] double velocity(std::size_t i) const { return motion(i).v[rows_.at[i]]; }
  [[nodiscard]] double direction(std::size_t i) const { return kDirection[rows_.side[i]]; }

  // ---- terms that are linear ------------------------------------------------------------------------------

  [[nodiscard]] std::size_t columns() const {
    return (options_.mass ? 0u : 1u) + 2 * waves_.size() + (shift_free_ ? 1u : 0u);
  }
  /// Columns of row i; the force that is left when a known mass is taken off.
  double fill(std::size_t i, double* c) const {
    const Motion& m = motion(i);
    const std::size_t k = rows_.at[i];
    double f = m.f[k] - rows_.lag[i];
    if (options_.mass) {
      f -= *options_.mass * m.a[k];
    } else {
      *c++ = m.a[k];
    }
    const auto r = static_cast<std::size_t>(rows_.record[i]);
    for (const Wave& w : waves_) {
      const double d = w.form == EccentricForm::kProportional ? direction(i) : 1.0;
      *c++ = d * w.sine[r][k];
      *c++ = d * w.cosine[r][k];
    }
    if (shift_free_) *c = 0.5 * (m.f[k + 1] - m.f[k - 1]);
    return f;
  }

  /// What least squares multiplies with instead of the change of the force, which a controller makes react to
  /// the noise: the change of the force that the reference asks for.
  [[nodiscard]] double shift_instrument(std::size_t i, double change) const {
    return asked_.empty() || !asks(static_cast<std::size_t>(rows_.record[i])) ? change : asked_[i];
  }
  [[nodiscard]] bool asks(std::size_t record) const { return !predicted_[record].empty(); }
  /// m·a + F(v) of the predicted motion, differenced, at the rows in use.
  void ask() {
    asked_.assign(rows_.size(), 0.0);
    // Neighbouring rows share what they difference.
    std::size_t behind = 0;
    std::array<double, 3> f{};
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const auto r = static_cast<std::size_t>(rows_.record[i]);
      if (!asks(r)) continue;
      const std::vector<double>& v = predicted_[r];
      const std::vector<double>& a = motions_[r].instrument;
      const std::size_t k = rows_.at[i];
      if (k < 2 || k + 2 >= v.size()) continue;
      const auto at = [&](std::size_t row) {
        const std::size_t s = v[row] > 0.0 ? 0 : 1;
        return mass_ * a[row] + kDirection[s] * line_[s](std::abs(v[row]));
      };
      const bool next =
          i > 0 && i == behind + 1 && rows_.record[i - 1] == rows_.record[i] && rows_.at[i - 1] + 1 == k;
      f = next ? std::array{f[1], f[2], at(k + 1)} : std::array{at(k - 1), at(k), at(k + 1)};
      behind = i;
      asked_[i] = 0.5 * (f[2] - f[0]);
    }
  }

  /// Least squares of the linear terms with friction of each bin taken out; then the map without a model.
  /// `instruments`: the map of the pass before is there, to take slopes within a bin out and to make an
  /// instrument of a programmed force.
  void solve(bool instruments) {
    const std::size_t q = columns();
    const std::size_t w = q + 4;  // columns, instruments of mass and shift, force without the map, force
    const std::size_t zi = q, si = q + 1, yi = q + 2, fi = q + 3;
    const std::size_t stride = w + 2;  // and rows, speed
    std::array<std::vector<double>, kSides> sums;
    for (std::size_t s = 0; s < kSides; ++s)
      sums[s].assign(blocks_ * static_cast<std::size_t>(grid_[s].bins) * stride, 0.0);
    std::vector<MatrixXd> cross(blocks_, MatrixXd::Zero(static_cast<Index>(w), static_cast<Index>(w)));
    std::vector<double> row(w);
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const std::size_t s = rows_.side[i];
      const Motion& m = motion(i);
      const std::size_t k = rows_.at[i];
      const double f = fill(i, row.data());
      const double speed = std::abs(m.v[k]);
      const double known = instruments ? kDirection[s] * line_[s](speed) : 0.0;
      row[fi] = f;
      row[yi] = f - known;
      row[zi] = q == 0                                   ? 0.0
                : options_.mass || !instruments || weak_ ? row[0]
                : m.loop == Loop::kOpen                  ? (m.f[k] - rows_.lag[i] - known) / mass_
                                                         : m.instrument[k];
      row[si] = shift_free_ ? shift_instrument(i, row[q - 1]) : 0.0;
      MatrixXd& c = cross[block_[i]];
      for (std::size_t a = 0; a < w; ++a) {
        for (std::size_t b = 0; b <= a; ++b)
          c(static_cast<Index>(a), static_cast<Index>(b)) += row[a] * row[b];
      }
      double* sum = &sums[s][(block_[i] * static_cast<std::size_t>(grid_[s].bins) +
                              static_cast<std::size_t>(rows_.bin[i])) *
                             stride];
      for (std::size_t a = 0; a < w; ++a) sum[a] += row[a];
      sum[w] += 1.0;
      sum[w + 1] += speed;
    }
    raw_cross_.clear();
    for (const MatrixXd& c : cross) raw_cross_.emplace_back(c.selfadjointView<Eigen::Lower>());
    block_sums_ = sums;
    // Deviations from the mean of each bin over all blocks.
    std::array<std::vector<double>, kSides> total;
    for (std::size_t s = 0; s < kSides; ++s) {
      const std::size_t size = static_cast<std::size_t>(grid_[s].bins) * stride;
      total[s].assign(size, 0.0);
      for (std::size_t k = 0; k < blocks_; ++k) {
        for (std::size_t j = 0; j < size; ++j) total[s][j] += sums[s][k * size + j];
      }
    }
    MatrixXd all = MatrixXd::Zero(static_cast<Index>(w), static_cast<Index>(w));
    for (std::size_t k = 0; k < blocks_; ++k) {
      MatrixXd c = cross[k].selfadjointView<Eigen::Lower>();
      for (std::size_t s = 0; s < kSides; ++s) {
        for (std::size_t b = 0; b < static_cast<std::size_t>(grid_[s].bins); ++b) {
          const double* t = &total[s][b * stride];
          if (t[w] <= 0.0) continue;
          const double* own = &sums[s][(k * static_cast<std::size_t>(grid_[s].bins) + b) * stride];
          if (own[w] <= 0.0) continue;
          const Eigen::Map<const VectorXd> sum(own, static_cast<Index>(w));
          const VectorXd mean = Eigen::Map<const VectorXd>(t, static_cast<Index>(w)) / t[w];
          c += -sum * mean.transpose() - mean * sum.transpose() + own[w] * mean * mean.transpose();
        }
      }
      cross[k] = c;
      all += c;
    }
    const auto z = static_cast<Index>(zi);
    const auto solved = [&](const MatrixXd& c, bool with_instrument) -> VectorXd {
      if (q == 0) return {};
      MatrixXd a = c.topLeftCorner(static_cast<Index>(q), static_cast<Index>(q));
      VectorXd b = c.col(static_cast<Index>(yi)).head(static_cast<Index>(q));
      if (with_instrument && q > 0) {
        a.row(0) = c.row(z).head(static_cast<Index>(q));
        b(0) = c(z, static_cast<Index>(yi));
      }
      if (shift_free_) {
        const auto last = static_cast<Index>(q) - 1;
        a.row(last) = c.row(static_cast<Index>(si)).head(static_cast<Index>(q));
        b(last) = c(static_cast<Index>(si), static_cast<Index>(yi));
      }
      // Columns of very different size.
      const VectorXd scale =
          c.diagonal().head(static_cast<Index>(q)).cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
      MatrixXd scaled = a * scale.asDiagonal();
      for (Index i = 0; i < scaled.rows(); ++i) {
        const double size = scaled.row(i).norm();
        if (size > 0.0) scaled.row(i) /= size, b(i) /= size;
      }
      return scale.asDiagonal() * scaled.fullPivLu().solve(b);
    };
    const bool by_instrument = instruments && !options_.mass && q > 0;
    if (by_instrument && !weak_ && !(all(z, 0) * all(z, 0) > 0.1 * all(z, z) * all(0, 0))) {
      warn("the reference hardly moves with the measured acceleration; the mass rests on the latter");
      weak_ = true;
      solve(instruments);
      return;
    }
    linear_ = solved(all, by_instrument);
    linear_held_.clear();
    for (std::size_t k = 0; k < blocks_; ++k) linear_held_.push_back(solved(all - cross[k], by_instrument));
    // What multiplies the residual in place of each column.
    std::vector<Index> by(q);
    std::iota(by.begin(), by.end(), Index{0});
    if (by_instrument) by.front() = z;
    if (shift_free_) by.back() = static_cast<Index>(si);
    moments_.resize(static_cast<Index>(q), static_cast<Index>(q));
    instrument_moments_.resize(static_cast<Index>(q), static_cast<Index>(q));
    for (std::size_t i = 0; i < q; ++i) {
      for (std::size_t j = 0; j < q; ++j) {
        moments_(static_cast<Index>(i), static_cast<Index>(j)) = all(by[i], static_cast<Index>(j));
        instrument_moments_(static_cast<Index>(i), static_cast<Index>(j)) = all(by[i], by[j]);
      }
    }
    if (!options_.mass) {
      mass_ = linear_(0);
      plain_mass_ = solved(all, false)(0);
    }
    mean_.assign(kSides, {});
    for (std::size_t s = 0; s < kSides; ++s) {
      const auto bins = static_cast<std::size_t>(grid_[s].bins);
      std::vector<double> count(bins), sum_v(bins), sum_f(bins);
      mean_[s] = total[s];
      for (std::size_t b = 0; b < bins; ++b) {
        const double* t = &total[s][b * stride];
        count[b] = t[w];
        sum_v[b] = t[w + 1];
        double f = t[fi];
        for (std::size_t j = 0; j < q; ++j) f -= linear_(static_cast<Index>(j)) * t[j];
        sum_f[b] = kDirection[s] * f;
      }
      line_[s].build(grid_[s], count, sum_v, sum_f);
    }
    const auto forward = line_[0].line(), back = line_[1].line();
    // A load beside which friction is small would make one direction drive the motion.
    const double mean_level = 0.5 * (forward.level + back.level);
    offset_ = std::min(forward.level, back.level) < 0.2 * std::abs(mean_level)
                  ? 0.5 * (forward.level - back.level)
                  : 0.0;
  }

  /// Friction over the bins without its load, for the level of the bristle.
  [[nodiscard]] Level level() {
    bare_ = line_;
    Level l;
    for (std::size_t s = 0; s < kSides; ++s) {
      for (double& f : bare_[s].force) f -= kDirection[s] * offset_;
      l.viscous[s] = std::max(0.0, bare_[s].line().slope);
    }
    l.map = &bare_;
    return l;
  }

  // ---- passes ---------------------------------------------------------------------------------------------

  /// Friction near reversals unknown: generous exclusion.
  void pilot() {
    double stroke = 0.0;
    double hysteresis = 0.0;
    for (const Motion& m : motions_) {
      stroke = std::max(stroke, m.stroke);
      hysteresis = std::max(hysteresis, 20.0 * m.position_noise);
      for (std::size_t k = 0; k < m.rows(); ++k) {
        double& top = top_[m.v[k] > 0.0 ? 0 : 1];
        if (m.valid(k)) top = std::max(top, std::abs(m.v[k]));
      }
    }
    near_ = std::max(hysteresis, 2e-3 * stroke);
    gather(near_, kSmallSpeed, 0.0);
    thin_out();
    mass_ = options_.mass.value_or(0.0);
    solve(false);
    solve(true);
  }

  /// Goes on with a sample of the rows. Until friction and shift have settled no more is needed. False: these
  /// are all.
  bool thin_out() {
    const std::vector<std::size_t> kept = sample();
    if (kept.size() == rows_.size()) return false;
    Rows rows;
    rows.reserve(kept.size());
    std::vector<std::uint8_t> block;
    for (const std::size_t i : kept) {
      rows.record.push_back(rows_.record[i]);
      rows.at.push_back(rows_.at[i]);
      rows.stretch.push_back(rows_.stretch[i]);
      rows.side.push_back(rows_.side[i]);
      rows.bin.push_back(rows_.bin[i]);
      rows.lag.push_back(rows_.lag[i]);
      block.push_back(block_[i]);
    }
    thin_ = true;
    all_rows_ = std::exchange(rows_, std::move(rows));
    all_blocks_ = std::exchange(block_, std::move(block));
    return true;
  }
  /// All rows again, with the force at all of them.
  void take_all() {
    if (!thin_) return;
    thin_ = false;
    rows_ = std::move(all_rows_), block_ = std::move(all_blocks_);
    align(shift_);
  }

  void settle() {
    take_all();
    const Relaxation relaxation = find_relaxation(motions_, level(), mass_, offset_, near_);
    const double length = relaxation.length;
    const auto lag = [&] {
      if (length > 0.0) find_lag(motions_, level(), relaxation, rows_);
    };
    if (length > 0.0) {
      result_.break_away_distance = length;
      gather(kRelaxations * length, 0.5 * kSmallSpeed, length);
    } else {
      gather(near_, kSmallSpeed, 0.0);
      warn(
          "no reversal of motion in the log: the distance to break away is not known and nothing is left out "
          "for it");
    }
    thin_out();
    if (shift_free_) ask();
    if (length > 0.0) {
      lag();
      solve(true);
      lag();
    }
    solve(true);
    if (!options_.shift) judge_shift();
    if (!thin_) return;
    take_all();
    lag();
    if (shift_free_) ask();
    solve(true);
  }

  /// As far as rows are in use.
  void align(double shift) {
    shift_ = shift;
    if (!thin_) {
      for (std::size_t r = 0; r < motions_.size(); ++r)
        align_force(force_[r], shift_, 0, force_[r].size(), motions_[r].f);
    } else {
      for (std::size_t i = 0; i < rows_.size();) {
        // A run of consecutive rows and its neighbours.
        std::size_t last = i;
        while (last + 1 < rows_.size() && rows_.record[last + 1] == rows_.record[i] &&
               rows_.at[last + 1] == rows_.at[last] + 1)
          ++last;
        const auto r = static_cast<std::size_t>(rows_.record[i]);
        const std::size_t from = rows_.at[i] > 0 ? rows_.at[i] - 1 : 0;
        align_force(force_[r], shift_, from, std::min(force_[r].size(), rows_.at[last] + 2), motions_[r].f);
        i = last + 1;
      }
    }
    for (Motion& m : motions_) {
      if (m.loop == Loop::kOpen) m.instrument = m.f;
    }
  }

  /// Rows in sequence, spread over everything, for what is only looked at.
  [[nodiscard]] std::vector<std::size_t> sample() const {
    const std::size_t every = rows_.size() / kSampleRows + 1;
    std::vector<std::size_t> out;
    out.reserve(kSampleRows + kSampleChunk);
    for (std::size_t from = 0; from < rows_.size(); from += every * kSampleChunk) {
      for (std::size_t i = from; i < std::min(from + kSampleChunk, rows_.size()); ++i) out.push_back(i);
    }
    return out;
  }

  /// Shift of least residual when friction of every bin and the mass are free.
  void find_shift() {
    const double T = records_.front().sample_time;
    for (const Record& r : records_) {
      if (std::abs(r.sample_time - T) > 0.01 * T) {
        warn("records of different sample times: the shift of the force is not estimated");
        return;
      }
    }
    const std::vector<std::size_t> rows = sample();
    std::array<std::vector<double>, kSides> count;
    for (std::size_t s = 0; s < kSides; ++s) count[s].assign(static_cast<std::size_t>(grid_[s].bins), 0.0);
    for (const std::size_t i : rows) count[rows_.side[i]][static_cast<std::size_t>(rows_.bin[i])] += 1.0;
    const auto centred = [&](std::vector<double> column) {
      std::array<std::vector<double>, kSides> sum;
      for (std::size_t s = 0; s < kSides; ++s) sum[s].assign(count[s].size(), 0.0);
      for (std::size_t j = 0; j < rows.size(); ++j)
        sum[rows_.side[rows[j]]][static_cast<std::size_t>(rows_.bin[rows[j]])] += column[j];
      for (std::size_t j = 0; j < rows.size(); ++j) {
        const std::size_t s = rows_.side[rows[j]];
        const auto b = static_cast<std::size_t>(rows_.bin[rows[j]]);
        column[j] -= sum[s][b] / count[s][b];
      }
      return column;
    };
    std::vector<double> a(rows.size()), v(rows.size()), known(rows.size());
    for (std::size_t j = 0; j < rows.size(); ++j) {
      const std::size_t i = rows[j];
      a[j] = motion(i).a[rows_.at[i]];
      v[j] = velocity(i);
    }
    a = centred(std::move(a));
    v = centred(std::move(v));  // slope within a bin
    const auto dot = [](const std::vector<double>& x, const std::vector<double>& y) {
      return std::inner_product(x.begin(), x.end(), y.begin(), 0.0);
    };
    const double vv = dot(v, v);
    const double va = dot(v, a) / vv;
    for (std::size_t j = 0; j < rows.size(); ++j) a[j] -= va * v[j];
    const double aa = dot(a, a);
    // The force at a fraction of a row is a straight line between two whole ones: products of whole rows do.
    struct Whole {
      double ff = 0.0, next = 0.0, af = 0.0, vf = 0.0;  // next: with the row after
    };
    const double reach = std::min(kMostShiftRows, std::max(3.0, std::ceil(kLongestShift / T)));
    const auto lowest = -static_cast<std::ptrdiff_t>(reach) - 2;
    const auto highest = static_cast<std::ptrdiff_t>(reach) + 2;
    std::vector<Whole> products;
    std::vector<double> before;
    for (std::ptrdiff_t late = lowest; late <= highest; ++late) {
      std::vector<double> f(rows.size());
      for (std::size_t j = 0; j < rows.size(); ++j) {
        const std::size_t i = rows[j];
        const std::vector<double>& raw = force_[static_cast<std::size_t>(rows_.record[i])];
        const auto at = static_cast<std::ptrdiff_t>(rows_.at[i]) + late;
        f[j] = raw[static_cast<std::size_t>(
            std::clamp<std::ptrdiff_t>(at, 0, static_cast<std::ptrdiff_t>(raw.size()) - 1))];
      }
      f = centred(std::move(f));
      if (!products.empty()) products.back().next = dot(before, f);
      products.push_back({dot(f, f), 0.0, dot(a, f), dot(v, f)});
      before = std::move(f);
    }
    const auto cost = [&](double shift) {
      const double whole = std::floor(shift);
      const double part = shift - whole;
      const auto at = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(whole) - lowest);
      const Whole &p = products[at], &n = products[at + 1];
      const double left = 1.0 - part;
      const double ff = left * left * p.ff + 2.0 * left * part * p.next + part * part * n.ff;
      const double af = left * p.af + part * n.af;
      const double vf = left * p.vf + part * n.vf;
      const double total = ff - vf * vf / vv;
      return options_.mass ? total - 2.0 * *options_.mass * af + *options_.mass * *options_.mass * aa
                           : total - af * af / aa;
    };
    double best = -0.5;
    double least = cost(best);
    for (double s = -reach - 0.5; s <= reach; s += 0.5) {
      const double c = cost(s);
      if (c < least) least = c, best = s;
    }
    for (double half = 0.25; half > 1e-3; half *= 0.5) {
      for (const double s : {best - half, best + half}) {
        const double c = cost(s);
        if (c < least) least = c, best = s;
      }
    }
    if (best <= -reach || best >= reach - 0.25 || !(vv > 0.0 && aa > 0.0)) return;
    shift_free_ = true;
    align(best);
    solve(true);
    newton_shift();
  }

  /// Gauss–Newton on the column of the shift.
  void newton_shift() {
    constexpr int kSteps = 6;
    for (int i = 0; i < kSteps; ++i) {
      ask();
      solve(true);
      const double step = std::clamp(linear_(linear_.size() - 1), -1.0, 1.0);
      align(shift_ - step);
      if (std::abs(step) < 1e-3) break;
    }
    ask();
    solve(true);
  }

  /// With friction settled: the shift again, and whether it is one. A commanded force acts under its hold,
  /// exactly: nothing is gained by estimating what is known.
  void judge_shift() {
    const double limit = std::max(3.0, std::ceil(kLongestShift / records_.front().sample_time));
    double half_width = 0.0;
    double gain = 1.0;
    if (shift_free_) {
      newton_shift();
      half_width = shift_half_width();
      const double with = left_over();
      const double found = shift_;
      shift_free_ = false;
      align(-0.5);
      solve(true);
      gain = left_over() / std::max(with, 1e-300);
      shift_free_ = true;
      shift_ = found;
    }
    const bool told = shift_free_ && half_width < 2.0 && std::abs(shift_) < limit;
    if (!told) {
      result_.cannot_tell.emplace_back(
          "the shift between force and motion: the force changes too little or too seldom; taken as a "
          "commanded "
          "force under its zero-order hold");
    }
    // A shift that leaves as much of the force as none has no reason to be believed; one that leaves much less needs
    // no further witness: its half width is taken from the residual, which remembers longer than what moves it.
    const double away = std::abs(shift_ + 0.5);
    const bool seen = gain > kWorthwhileShift && away > std::max(1.5 * half_width, 0.02);
    const bool plain = gain > kPlainShift && away > std::max(0.5 * half_width, 0.02);
    if (told && (seen || plain)) {
      align(shift_);
      ask();
      solve(true);
      return;
    }
    shift_free_ = false;
    align(-0.5);
    solve(true);
    solve(true);
  }

  /// Σ residual² with friction of every bin free [N²].
  [[nodiscard]] double left_over() const {
    const std::size_t q = columns();
    std::vector<double> c(q + 1);
    double sum = 0.0;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      double e = fill(i, c.data()) - kDirection[rows_.side[i]] * line_[rows_.side[i]](std::abs(velocity(i)));
      for (std::size_t j = 0; j < q; ++j) e -= linear_(static_cast<Index>(j)) * c[j];
      sum += e * e;
    }
    return sum;
  }

  /// 95 % half width of the shift beside the mass [rows].
  [[nodiscard]] double shift_half_width() const {
    const std::vector<std::size_t> rows = sample();
    const std::size_t q = columns();
    const auto n = static_cast<Index>(rows.size());
    MatrixXd X(n, static_cast<Index>(q)), Z(n, static_cast<Index>(q));
    VectorXd e(n);
    std::vector<int> record(rows.size());
    std::vector<std::size_t> at(rows.size());
    std::vector<double> c(q + 1);
    for (std::size_t j = 0; j < rows.size(); ++j) {
      const auto k = static_cast<Index>(j);
      const std::size_t i = rows[j];
      const std::size_t s = rows_.side[i];
      const double* t = &mean_[s][static_cast<std::size_t>(rows_.bin[i]) * (q + 6)];
      double left = fill(i, c.data()) - kDirection[s] * line_[s](std::abs(velocity(i)));
      for (std::size_t col = 0; col < q; ++col) {
        const auto K = static_cast<Index>(col);
        left -= linear_(K) * c[col];
        X(k, K) = c[col] - t[col] / t[q + 4];
        Z(k, K) = col + 1 == q ? shift_instrument(i, c[col]) - t[q + 1] / t[q + 4] : X(k, K);
      }
      e(k) = left;
      record[j] = rows_.record[i];
      at[j] = rows_.at[i];
    }
    const Eigen::FullPivLU<MatrixXd> lu(Z.transpose() * X);
    if (!lu.isInvertible()) return std::numeric_limits<double>::infinity();
    return Uncertainty(Z, e, lu.inverse(), record, at)
        .half_width(VectorXd::Unit(static_cast<Index>(q), static_cast<Index>(q) - 1));
  }

  // ---- the map --------------------------------------------------------------------------------------------

  StaticChoice choose() {
    std::array<SideSums, kSides> sums;
    for (std::size_t s = 0; s < kSides; ++s) {
      sums[s].grid = grid_[s];
      const auto bins = static_cast<std::size_t>(grid_[s].bins);
      BlockSums empty{std::vector<double>(bins), std::vector<double>(bins), std::vector<double>(bins),
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
      const auto add = [&](BlockSums& block, double f) {
        f *= kDirection[s];
        block.n[b] += 1.0;
        block.v[b] += speed;
        block.f[b] += f;
        block.ff[b] += f * f;
      };
      add(sums[s].block[block_[i]], full);
      add(sums[s].held[block_[i]], held);
    }
    StaticOptions options;
    options.terms = options_.terms;
    options.most_terms = options_.most_terms;
    options.symmetric = options_.symmetric;
    StaticChoice choice = choose_static(sums, options);
    choice.fit.load += offset_;
    for (StaticFit& rival : choice.rivals) rival.load += offset_;
    for (StaticFit& simple : choice.simple) simple.load += offset_;
    return choice;
  }

  // ---- friction of velocity and of position together --------------------------------------------------------

  /// A steady map with the linear terms that belong to it.
  struct Joint {
    StaticFit fit;
    VectorXd linear;
    bool good = false;
  };

  /// Gauss–Newton on linear terms and map together, on the sums of all blocks but one. On a sine every speed has
  /// two positions only: bins of speed would take the even part of a periodic term for friction; a map of few
  /// parameters does not.
  Joint fit_jointly(const StaticFit& start, std::size_t without) const {
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
      for (int s = 0; s < kSides; ++s) {
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
          const double d = kDirection[S];
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

  /// Σ residual² of one block.
  [[nodiscard]] double joint_loss(const Joint& joint, std::size_t k) const {
    const std::size_t q = columns();
    const auto Q = static_cast<Index>(q);
    const std::size_t stride = q + 6;
    VectorXd h = VectorXd::Zero(Q + 4);
    h.head(Q) = -joint.linear;
    h(Q + 3) = 1.0;
    double sum = h.dot(raw_cross_[k] * h);
    for (int s = 0; s < kSides; ++s) {
      const auto S = static_cast<std::size_t>(s);
      const auto bins = static_cast<std::size_t>(grid_[S].bins);
      for (std::size_t bin = 0; bin < bins; ++bin) {
        const double* t = &block_sums_[S][(k * bins + bin) * stride];
        if (t[q + 4] <= 0.0) continue;
        const double f = joint.fit.force(s, t[q + 5] / t[q + 4]);
        double left = t[q + 3];
        for (std::size_t j = 0; j < q; ++j) left -= joint.linear(static_cast<Index>(j)) * t[j];
        sum += -2.0 * kDirection[S] * f * left + t[q + 4] * f * f;
      }
    }
    return sum;
  }

  /// Families of few parameters fitted together with the periodic terms, beside what the bins have chosen.
  void join(StaticChoice& choice) {
    joint_.reset();
    std::vector<Joint> fits;
    std::vector<std::vector<double>> losses{choice.block_loss};
    std::vector<std::size_t> parameters{choice.fit.parameters()};
    for (const StaticFit& start : choice.simple) {
      Joint joint = fit_jointly(start, blocks_);
      if (!joint.good) continue;
      std::vector<double> loss;
      for (std::size_t k = 0; k < blocks_; ++k) loss.push_back(joint_loss(fit_jointly(joint.fit, k), k));
      losses.push_back(std::move(loss));
      parameters.push_back(joint.fit.parameters());
      fits.push_back(std::move(joint));
    }
    const Picked picked = pick(losses, parameters, choice.tested);
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

  void add_wave(const PeriodicTerm& term) {
    Wave w{term.term.period, term.term.form, term.period, {}, {}};
    for (std::size_t r = 0; r < motions_.size(); ++r) {
      std::vector<double> sine, cosine;
      for (const double x : records_[r].x) {
        sine.push_back(std::sin(2.0 * kPi * x / w.period));
        cosine.push_back(std::cos(2.0 * kPi * x / w.period));
      }
      w.sine.push_back(smooth_like(motions_[r], sine));
      w.cosine.push_back(smooth_like(motions_[r], cosine));
    }
    waves_.push_back(std::move(w));
  }

  /// Terms periodic in position, if held-out motion is better for them.
  StaticChoice try_periodic(StaticChoice without) {
    PeriodicRows rows;
    const std::size_t q = columns();
    std::vector<double> c(q + 1);
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      double e = fill(i, c.data());
      for (std::size_t j = 0; j < q; ++j) e -= linear_(static_cast<Index>(j)) * c[j];
      const std::size_t s = rows_.side[i];
      e -= kDirection[s] * line_[s](std::abs(velocity(i)));
      rows.x.push_back(motion(i).x[rows_.at[i]]);
      rows.e.push_back(e);
      rows.direction.push_back(s == 0 ? 1 : -1);
    }
    rows.record = rows_.record;
    rows.at = rows_.at;
    PeriodicOptions options;
    options.most = static_cast<int>(friction::kMaxEccentricTerms);
    const PeriodicResult found = find_periodic(rows, options);
    result_.spectrum = found.spectrum;
    for (const std::string& note : found.notes) warn(note);
    for (const std::string& words : found.cannot_tell) result_.cannot_tell.push_back(words);
    if (found.terms.empty()) return without;
    for (const PeriodicTerm& t : found.terms) add_wave(t);
    const auto before_line = line_;
    solve(true);
    StaticChoice with = choose();
    join(with);
    const auto blocks = static_cast<double>(with.block_loss.size());
    double gain = 0.0, square = 0.0;
    for (std::size_t k = 0; k < with.block_loss.size(); ++k)
      gain += without.block_loss[k] - with.block_loss[k];
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
    StaticChoice& chosen = better ? with : without;
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

  // ---- uncertainty ----------------------------------------------------------------------------------------

  void intervals() {
    if (joint_) {
      linear_ = *joint_;
      if (!options_.mass) mass_ = linear_(0);
    }
    const StaticFit& fit = choice_.fit;
    const std::size_t n = rows_.size();
    const std::size_t q = columns();
    const std::size_t p = fit.parameters();
    const auto Q = static_cast<Index>(q), P = static_cast<Index>(p);
    // The fit and its derivatives by bin, at the mean speed of the bin.
    std::array<MatrixXd, kSides> slope;
    std::array<VectorXd, kSides> at_bin, per_speed;
    const std::size_t stride = q + 6;
    MatrixXd normal = MatrixXd::Zero(P, P);
    MatrixXd along = MatrixXd::Zero(P, Q), along_instruments = along;
    for (int s = 0; s < kSides; ++s) {
      const auto S = static_cast<std::size_t>(s);
      const Index bins = grid_[S].bins;
      const auto [first, count] = fit.span(s);
      slope[S] = MatrixXd::Zero(bins, static_cast<Index>(count));
      VectorXd g(static_cast<Index>(count));
      for (Index b = 0; b < bins; ++b) {
        const double* t = &mean_[S][static_cast<std::size_t>(b) * stride];
        const double rows = t[q + 4];
        const double speed = rows > 0.0 ? t[q + 5] / rows : grid_[S].low;
        fit.gradient(s, speed, g.data());
        slope[S].row(b) = g.transpose();
        if (rows <= 0.0) continue;
        normal.block(static_cast<Index>(first), static_cast<Index>(first), g.size(), g.size()) +=
            rows * g * g.transpose();
        along.middleRows(static_cast<Index>(first), g.size()) +=
            kDirection[S] * g * Eigen::Map<const VectorXd>(t, Q).transpose();
        for (std::size_t j = 0; j < q; ++j) {
          along_instruments.block(static_cast<Index>(first), static_cast<Index>(j), g.size(), 1) +=
              kDirection[S] * g * t[multiplier(j)];
        }
      }
    }
    // Curves over speed as tables: exponentials for every row would take longer than all the rest.
    constexpr int kTable = 2048;
    std::array<std::vector<double>, kSides> table;
    for (int s = 0; s < kSides; ++s) {
      const auto S = static_cast<std::size_t>(s);
      for (int i = 0; i <= kTable; ++i)
        table[S].push_back(fit.force(s, grid_[S].low + (grid_[S].high - grid_[S].low) * i / kTable));
    }
    residual_.resize(n);
    std::vector<double> c(q + 1);
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t s = rows_.side[i];
      double e = fill(i, c.data());
      for (std::size_t j = 0; j < q; ++j) e -= linear_(static_cast<Index>(j)) * c[j];
      const double place = (std::abs(velocity(i)) - grid_[s].low) / (grid_[s].high - grid_[s].low) * kTable;
      const int cell = std::clamp(static_cast<int>(place), 0, kTable - 1);
      const double share = place - cell;
      const auto u = static_cast<std::size_t>(cell);
      residual_[i] = e - kDirection[s] * (table[s][u] + share * (table[s][u + 1] - table[s][u]));
    }
    memory_ = memory_of(residual_, rows_.record, rows_.at);
    LongRun moments(q + p, memory_);
    double square = 0.0;
    const bool by_instrument = !options_.mass && q > 0 && !weak_;
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t s = rows_.side[i];
      const double e = residual_[i];
      square += e * e;
      double* row = moments.row(rows_.record[i], rows_.at[i]);
      fill(i, c.data());
      const double* t = &mean_[s][static_cast<std::size_t>(rows_.bin[i]) * stride];
      // Fitted together with the map, the linear terms are not centred.
      const double centre = joint_ ? 0.0 : 1.0 / t[q + 4];
      for (std::size_t j = 0; j < q; ++j) {
        if (j == 0 && by_instrument) {
          const Motion& m = motion(i);
          const std::size_t k = rows_.at[i];
          const double known = kDirection[s] * line_[s](std::abs(m.v[k]));
          const double z = m.loop == Loop::kOpen ? (m.f[k] - rows_.lag[i] - known) / mass_ : m.instrument[k];
          row[0] += (z - t[q] * centre) * e;
        } else if (shift_free_ && j + 1 == q) {
          row[j] += (shift_instrument(i, c[j]) - t[q + 1] * centre) * e;
        } else {
          row[j] += (c[j] - t[j] * centre) * e;
        }
      }
      const auto [first, count] = fit.span(static_cast<int>(s));
      const double signed_e = kDirection[s] * e;
      const Index b = rows_.bin[i];
      for (std::size_t j = 0; j < count; ++j)
        row[q + first + j] += slope[s](b, static_cast<Index>(j)) * signed_e;
    }
    const std::vector<double> raw = moments.covariance();
    const Eigen::Map<const MatrixXd> meat(raw.data(), Q + P, Q + P);

    // Directions that the data do not see are taken out; the curve on the data does not move along them.
    const VectorXd scale = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(scale.asDiagonal() * normal * scale.asDiagonal());
    const VectorXd& values = eigen.eigenvalues();
    VectorXd inverse = VectorXd::Zero(values.size());
    blind_.assign(p, 0.0);
    for (Index j = 0; j < values.size(); ++j) {
      if (values(j) > 1e-9 * values.maxCoeff()) {
        inverse(j) = 1.0 / values(j);
      } else {
        for (std::size_t i = 0; i < p; ++i)
          blind_[i] += std::pow(eigen.eigenvectors()(static_cast<Index>(i), j), 2.0);
      }
    }
    const MatrixXd bread = scale.asDiagonal() * eigen.eigenvectors() * inverse.asDiagonal() *
                           eigen.eigenvectors().transpose() * scale.asDiagonal();
    // The linear terms move by their own moments, the map by its own less what the linear terms take along.
    MatrixXd map = MatrixXd::Zero(Q + P, Q + P);
    MatrixXd white = MatrixXd::Zero(Q + P, Q + P);
    white.bottomRightCorner(P, P) = normal;
    if (joint_) {
      MatrixXd all = MatrixXd::Zero(Q + 4, Q + 4);
      for (const MatrixXd& block : raw_cross_) all += block;
      MatrixXd A = white;
      for (Index i = 0; i < Q; ++i) {
        for (Index j = 0; j < Q; ++j) {
          const auto zi = static_cast<Index>(multiplier(static_cast<std::size_t>(i)));
          const auto zj = static_cast<Index>(multiplier(static_cast<std::size_t>(j)));
          A(i, j) = all(zi, j);
          white(i, j) = all(zi, zj);
        }
      }
      A.bottomLeftCorner(P, Q) = along;
      A.topRightCorner(Q, P) = along_instruments.transpose();
      white.bottomLeftCorner(P, Q) = along_instruments;
      white.topRightCorner(Q, P) = along_instruments.transpose();
      const VectorXd size = A.diagonal().cwiseAbs().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
      map = size.asDiagonal() *
            (size.asDiagonal() * A * size.asDiagonal()).completeOrthogonalDecomposition().pseudoInverse() *
            size.asDiagonal();
    } else {
      if (q > 0) {
        const MatrixXd gain = moments_.fullPivLu().inverse();
        map.topLeftCorner(Q, Q) = gain;
        map.bottomLeftCorner(P, Q) = -bread * along * gain;
        white.topLeftCorner(Q, Q) = instrument_moments_;
      }
      map.bottomRightCorner(P, P) = bread;
    }
    const double independent = static_cast<double>(n) / (2.0 * memory_.rows);
    const double freedom = std::max(3.0, independent - static_cast<double>(p + q));
    const double correction = std::max(1.0, independent / freedom);
    covariance_ = correction * map * meat * map.transpose();
    // The same under stationary noise. Newey–West sees at each speed only the few passes through it and is
    // often too small there by chance; the stationary form pools all rows but misses noise that depends on
    // speed. The larger of the two stands.
    const double noise = 2.0 * memory_.rows * square / static_cast<double>(n) * correction;
    pooled_ = noise * map * white * map.transpose();
    factor_ = student_factor(freedom);
  }

  /// Column that multiplies the residual in place of column j: an instrument or itself.
  [[nodiscard]] std::size_t multiplier(std::size_t j) const {
    const std::size_t q = columns();
    if (j == 0 && !options_.mass && !weak_) return q;
    return shift_free_ && j + 1 == q ? q + 1 : j;
  }

  /// Standard error of hᵀθ, θ = (linear terms, map).
  [[nodiscard]] double error_of(const VectorXd& h) const {
    return std::sqrt(std::max({0.0, h.dot(covariance_ * h), h.dot(pooled_ * h)}));
  }
  [[nodiscard]] double error_at(std::size_t i) const {
    return error_of(VectorXd::Unit(covariance_.rows(), static_cast<Index>(i)));
  }

  // ---- result ---------------------------------------------------------------------------------------------

  [[nodiscard]] std::string in_units(std::string unit) const {
    // "N" and the metre are written for whatever the log holds.
    if (records_.front().force_unit != "N" && unit.starts_with("N"))
      unit = records_.front().force_unit + unit.substr(1);
    return unit;
  }

  void add(std::string name, double value, const std::string& unit, const std::string& shown, double error,
           bool seen) {
    Parameter p;
    p.name = std::move(name);
    p.value = value;
    p.unit = in_units(unit);
    p.shown = in_units(shown);
    p.ci_low = value - factor_ * error;
    p.ci_high = value + factor_ * error;
    p.identifiable = seen && std::isfinite(error) && factor_ * error < std::abs(value);
    result_.parameters.push_back(std::move(p));
  }

  Result finish() {
    const StaticFit& fit = choice_.fit;
    const std::size_t q = columns();
    result_.method = "auto";
    result_.force_unit = records_.front().force_unit;
    result_.position_unit = records_.front().position_unit;
    const bool newton = result_.force_unit == "N";
    result_.mass = mass_;
    result_.plain_mass = options_.mass ? std::numeric_limits<double>::quiet_NaN() : plain_mass_;
    const double mass_error = options_.mass ? 0.0 : error_at(0);
    result_.mass_interval = {mass_ - factor_ * mass_error, mass_ + factor_ * mass_error};
    result_.velocity_range = {-grid_[1].high, grid_[0].high};
    result_.rows = rows_.size();
    result_.peaks = {peaks_of(line_[0]), peaks_of(line_[1])};
    add("mass", mass_, newton ? "kg" : "N s2/m", newton ? "N s2/mm" : "N s2/m", mass_error, true);
    if (!result_.parameters.back().identifiable) {
      warn("the mass cannot be determined from this log; run a sine or pulses, or give the mass");
    }
    if (shift_free_) {
      const double T = records_.front().sample_time;
      add("force_shift", shift_ * T, "s", "ms", error_at(q - 1) * T, true);
      warn(text(
          "the force stands %.3g rows (%.3g ms) %s than the motion that it belongs to; this is taken out",
          std::abs(shift_), std::abs(shift_) * T * 1e3, shift_ > 0 ? "later" : "earlier"));
    }
    result_.load = fit.load;
    write_map();
    write_waves();
    for (int s = kSides - 1; s >= 0; --s) write_curve(s);
    write_points();
    result_.held_out_rms = choice_.held_out_rms;
    result_.models = choice_.candidates;
    if (options_.dynamics) bristle();
    drift();
    return std::move(result_);
  }

  void write_map() {
    const StaticFit& fit = choice_.fit;
    const std::size_t q = columns();
    auto error = [&](std::size_t i) { return error_at(q + i); };
    auto seen = [&](std::size_t i) { return blind_[i] < 0.1; };
    if (fit.family != StaticFit::Family::kByDirection) {
      result_.model = "conventional";
      friction::Conventional<double> map{fit.coulomb, fit.viscous, {}};
      add("load", fit.load, "N", "N", error(0), seen(0));
      add("alpha0", fit.coulomb, "N", "N", error(1), seen(1));
      if (fit.family == StaticFit::Family::kSymmetricStribeck) {
        map.stribeck = friction::Stribeck<double>{fit.coulomb + fit.rise, fit.v0, 2.0};
        VectorXd h = VectorXd::Zero(covariance_.rows());
        h(static_cast<Index>(q) + 1) = h(static_cast<Index>(q) + 3) = 1.0;
        add("alpha1", fit.coulomb + fit.rise, "N", "N", error_of(h), seen(3));
        add("v0", fit.v0, "m/s", "mm/s", error(4), seen(4));
      }
      add("alpha2", fit.viscous, "N s/m", "N s/mm", error(2), seen(2));
      result_.friction.steady = map;
      return;
    }
    friction::Gaussian<double> map;
    map.velocity_range = result_.velocity_range;
    std::size_t most = 0;
    if (std::abs(fit.load) > 0.0) {
      VectorXd h = VectorXd::Zero(covariance_.rows());
      h(static_cast<Index>(q)) = 0.5;
      h(static_cast<Index>(q + fit.span(1).first)) = -0.5;
      add("load", fit.load, "N", "N", error_of(h), true);
      result_.cannot_tell.emplace_back(
          "how much of the load is friction that differs by direction: it is half the sum of both "
          "directions");
    }
    for (std::size_t s = 0; s < kSides; ++s) {
      const BranchFit& b = fit.branch[s];
      const double top = fit.top[s];
      const double d = kDirection[s];
      const std::string tail = std::string("_") + kSideName[s];
      friction::GaussianBranch<double>& branch = s == 0 ? map.positive : map.negative;
      branch.eta0 = d * b.eta0;
      branch.eta1 = b.eta1 / top;
      std::size_t i = fit.span(static_cast<int>(s)).first;
      add("eta0" + tail, branch.eta0, "N", "N", error(i), seen(i));
      add("eta1" + tail, branch.eta1, "N s/m", "N s/mm", error(i + 1) / top, seen(i + 1));
      i += 2;
      for (std::size_t k = 0; k < b.terms.size(); ++k) {
        const FitTerm& g = b.terms[k];
        const std::string name = "gaussian_" + std::to_string(k + 1) + "_";
        branch.gaussians.push_back({d * g.a, d * g.b * top, g.c * top});
        add(name + "a" + tail, d * g.a, "N", "N", error(i), seen(i));
        ++i;
        if (!b.centred) add(name + "b" + tail, d * g.b * top, "m/s", "mm/s", error(i) * top, seen(i)), ++i;
        add(name + "c" + tail, g.c * top, "m/s", "mm/s", error(i) * top, seen(i));
        ++i;
      }
      most = std::max(most, b.terms.size());
    }
    result_.model = most > 0 || options_.terms ? "gaussian" : "asymmetric";
    result_.friction.steady = map;
    map.validate(
        [&](const auto&, const auto& words) { warn(std::string("friction map: ") + std::string(words)); });
  }

  void write_waves() {
    if (waves_.empty()) return;
    result_.model += " + periodic";
    const std::size_t first = options_.mass ? 0 : 1;
    for (std::size_t w = 0; w < waves_.size(); ++w) {
      const std::size_t i = first + 2 * w;
      const double s = linear_(static_cast<Index>(i)), c = linear_(static_cast<Index>(i) + 1);
      // s·sin + c·cos = A·sin(· − φ)
      const double amplitude = std::hypot(s, c);
      const double phase = std::atan2(-c, s);
      VectorXd along = VectorXd::Zero(covariance_.rows()), across = along;
      along(static_cast<Index>(i)) = s / amplitude, along(static_cast<Index>(i) + 1) = c / amplitude;
      across(static_cast<Index>(i)) = c / (amplitude * amplitude);
      across(static_cast<Index>(i) + 1) = -s / (amplitude * amplitude);
      const std::string tail = "_" + std::to_string(w + 1);
      add("periodic_amplitude" + tail, amplitude, "N", "N", error_of(along), true);
      Parameter period;
      period.name = "periodic_period" + tail;
      period.value = waves_[w].period;
      period.unit = "m", period.shown = "mm";
      period.ci_low = waves_[w].period_interval.low, period.ci_high = waves_[w].period_interval.high;
      result_.parameters.push_back(period);
      add("periodic_phase" + tail, phase, "rad", "rad", error_of(across), true);
      result_.parameters.back().identifiable = factor_ * error_of(across) < 0.5 * kPi;
      result_.friction.eccentric.push_back({amplitude, waves_[w].period, phase, waves_[w].form});
    }
    warn("the phase of the periodic terms belongs to the homing position of this log");
  }

  void write_curve(int s) {
    const StaticFit& fit = choice_.fit;
    const auto S = static_cast<std::size_t>(s);
    const auto [first, count] = fit.span(s);
    const std::size_t q = columns();
    const int points = std::max(21, options_.curve_points);
    std::vector<double> g(count);
    for (int i = 0; i < points; ++i) {
      const int at = s == 0 ? i : points - 1 - i;
      const double speed = grid_[S].low + (grid_[S].high - grid_[S].low) * at / (points - 1);
      fit.gradient(s, speed, g.data());
      VectorXd h = VectorXd::Zero(covariance_.rows());
      for (std::size_t j = 0; j < count; ++j) h(static_cast<Index>(q + first + j)) = g[j];
      // The load is a parameter of its own in the symmetric families; friction is what is shown.
      const double own = fit.force(s, speed) - kDirection[S] * fit.load;
      if (fit.family != StaticFit::Family::kByDirection) h(static_cast<Index>(q)) = 0.0;
      // What the models differ in that the data cannot tell apart is part of the uncertainty (Buckland et al.
      // 1997).
      double spread = 0.0;
      for (const StaticFit& r : choice_.rivals)
        spread += std::pow(r.force(s, speed) - fit.force(s, speed), 2.0);
      if (!choice_.rivals.empty()) spread /= static_cast<double>(choice_.rivals.size() + 1);
      const double error = error_of(h);
      const double half = factor_ * std::sqrt(error * error + spread);
      const double f = kDirection[S] * own;
      result_.curve.push_back({kDirection[S] * speed, f, f - half, f + half});
    }
  }

  void write_points() {
    const StaticFit& fit = choice_.fit;
    double sum = 0.0, square = 0.0, left = 0.0;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const double f = motion(i).f[rows_.at[i]];
      sum += f;
      square += f * f;
      left += residual_[i] * residual_[i];
    }
    const auto rows = static_cast<double>(rows_.size());
    result_.r_squared = 1.0 - left / std::max(square - sum * sum / rows, 1e-300);
    const auto wanted = static_cast<std::size_t>(std::max(1, 2 * options_.map_points));
    const std::size_t step = std::max<std::size_t>(1, rows_.size() / wanted);
    for (std::size_t i = 0; i < rows_.size(); i += step) {
      const int s = rows_.side[i];
      const double v = velocity(i);
      const double f = kDirection[rows_.side[i]] * fit.force(s, std::abs(v)) - fit.load + residual_[i];
      result_.map.push_back({v, f, s == 0 ? 1 : -1});
    }
    const std::size_t fine = std::max<std::size_t>(1, rows_.size() / kShownResiduals);
    for (std::size_t i = 0; i < rows_.size(); i += fine) {
      const auto r = static_cast<std::size_t>(rows_.record[i]);
      result_.residuals.push_back(
          {records_[r].t[rows_.at[i]], motion(i).x[rows_.at[i]], velocity(i), residual_[i], rows_.record[i]});
    }
  }

  /// Pre-sliding from the reversals. Records of a closed loop where there are any: their slow reversals tell more
  /// than the ringing after a pulse.
  void bristle() {
    if (!(mass_ > 0.0) || result_.position_unit != "m") return;
    friction::AxisModel known{mass_, result_.load, result_.friction};
    std::vector<Record> records;
    for (std::size_t r = 0; r < records_.size(); ++r) {
      if (motions_[r].loop == Loop::kClosed) records.push_back(records_[r]);
    }
    BristleOptions options;
    options.shift = shift_;
    const bool open = records.empty();
    BristleFit fit;
    try {
      fit = fit_bristle(open ? records_ : records, known, options);
    } catch (const Refused& why) {
      fit.reason = why.what();
    }
    if (!fit.determinable) {
      result_.cannot_tell.push_back(fit.reason);
      return;
    }
    const bool gms = std::holds_alternative<friction::Gms<double>>(fit.best);
    result_.friction.dynamics = fit.best;
    result_.model += gms ? " + gms" : " + lugre";
    for (Parameter p : gms ? fit.gms_parameters : fit.lugre_parameters) {
      // The ringing after pulses tells stiffness, its damping hardly (bristle_fit.hpp).
      if (open && p.name != "sigma0" && p.name != "stiffness") p.identifiable = false;
      result_.parameters.push_back(std::move(p));
    }
    result_.break_away_distance = fit.break_away;
    result_.parameters.push_back({"break_away_distance", fit.break_away, "m", "um",
                                  fit.break_away_interval.low, fit.break_away_interval.high, true});
    for (Candidate c : fit.models) {
      c.name = "after reversals: " + c.name;
      result_.models.push_back(std::move(c));
    }
  }

  /// Friction or offset that moves with time, on the longest record.
  void drift() {
    std::vector<std::size_t> length(records_.size());
    for (const int r : rows_.record) ++length[static_cast<std::size_t>(r)];
    const auto longest = static_cast<int>(std::max_element(length.begin(), length.end()) - length.begin());
    std::vector<std::size_t> rows;
    for (const std::size_t i : sample()) {
      if (rows_.record[i] == longest) rows.push_back(i);
    }
    if (rows.size() < 500) return;
    const Record& rec = records_[static_cast<std::size_t>(longest)];
    const double from = rec.t[rows_.at[rows.front()]], to = rec.t[rows_.at[rows.back()]];
    MatrixXd X(static_cast<Index>(rows.size()), 2);
    VectorXd y(static_cast<Index>(rows.size()));
    std::vector<int> record(rows.size(), 0);
    std::vector<std::size_t> at(rows.size());
    for (std::size_t j = 0; j < rows.size(); ++j) {
      const auto k = static_cast<Index>(j);
      const double tau = (rec.t[rows_.at[rows[j]]] - from) / (to - from) - 0.5;
      X(k, 0) = tau;
      X(k, 1) = tau * direction(rows[j]);
      y(k) = residual_[rows[j]];
      at[j] = rows_.at[rows[j]];
    }
    const MatrixXd normal = X.transpose() * X;
    // One direction only, or next to it: offset and friction cannot be told apart.
    if (!(normal.determinant() > 1e-3 * normal(0, 0) * normal(1, 1))) return;
    const MatrixXd inverse = normal.inverse();
    const VectorXd x = inverse * (X.transpose() * y);
    const Uncertainty uncertainty(X, y - X * x, inverse, record, at);
    const double level = 0.5 * (choice_.fit.force(0, grid_[0].low) + choice_.fit.force(1, grid_[1].low));
    constexpr double kWorthSaying = 0.02;
    const char* what[2] = {"the offset of the force", "friction"};
    for (Index j = 0; j < 2; ++j) {
      const double half = uncertainty.half_width(VectorXd::Unit(2, j));
      // Slow noise looks like a drift now and then: twice the interval.
      if (std::abs(x(j)) < 2.0 * half || std::abs(x(j)) < kWorthSaying * std::abs(level)) continue;
      warn(text(
          "%s %s by %.3g %s (%.2g %% of the friction) from begin to end of %s: warming up or running in; the "
          "result is the mean over the record",
          what[j], x(j) > 0 ? "rose" : "fell", std::abs(x(j)), result_.force_unit.c_str(),
          100.0 * std::abs(x(j) / level), rec.source.c_str()));
    }
  }

  const std::vector<Record>& records_;
  const DriveFitOptions& options_;
  Result result_;
  std::vector<Motion> motions_;
  std::vector<std::vector<double>> force_;  // smoothed, not aligned
  double shift_ = -0.5;
  bool shift_free_ = false;
  std::vector<std::vector<double>> predicted_;  // velocity that the reference explains [m/s]
  std::vector<double> asked_;  // change of the force that the reference asks for, by row in use [N]
  double near_ = 0.0;
  std::array<double, kSides> top_{};
  Rows rows_, all_rows_;  // in use; put aside while a sample is
  std::size_t blocks_ = 5;
  std::vector<std::uint8_t> block_, all_blocks_;
  bool thin_ = false;
  std::array<Grid, kSides> grid_;
  std::array<Polyline, kSides> line_, bare_;
  double offset_ = 0.0;
  double mass_ = 0.0;
  double plain_mass_ = 0.0;
  bool weak_ = false;
  std::vector<Wave> waves_;
  VectorXd linear_;
  std::vector<VectorXd> linear_held_;
  MatrixXd moments_, instrument_moments_;
  std::vector<MatrixXd> raw_cross_;                     // by block: products of the columns
  std::array<std::vector<double>, kSides> block_sums_;  // by side: block, bin, column
  std::vector<std::vector<double>> mean_;               // sums by side, bin and column, then rows and speed
  StaticChoice choice_;
  std::optional<VectorXd> joint_;  // linear terms of a map that was fitted together with them
  std::vector<double> residual_;
  Memory memory_;
  MatrixXd covariance_, pooled_;
  std::vector<double> blind_;
  double factor_ = 1.96;
};

}  // namespace

Result identify_drive(const std::vector<Record>& records, const DriveFitOptions& options) {
  return DriveFit(records, options).run();
}

}  // namespace stribeck::ident
