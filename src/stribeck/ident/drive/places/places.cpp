#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stribeck/ident/drive/places/places.hpp>
#include <stribeck/ident/stats/linear.hpp>
#include <stribeck/ident/stats/long_run.hpp>
#include <utility>
#include <vector>

namespace stribeck::ident::drive {
namespace {

constexpr double kExpected = 0.3;  // prior standard deviation of a share
constexpr double kSmooth =
    0.1;  // prior standard deviation of the second difference between neighbouring places
constexpr double kPredicts =
    0.92;  // squared residual of motion left out, at most this share of that without places
constexpr double kWorthStoring = 0.03;  // largest share, at least
constexpr double kNarrowest = 1e-3;     // travel that is divided into places, at least [m]
constexpr double kFewestRows = 300.0;
constexpr double kTold =
    0.75;  // of thirteen places, ten must differ after the mean of each speed is taken off
constexpr double kSeen = 0.2;            // share of the squares of a difference that must be left for that
constexpr std::size_t kMostRecords = 8;  // with a level of their own
constexpr std::size_t kMostLooked = 20'000;  // rows: enough for nineteen columns
constexpr double kLeast = 0.1;               // share that is stored
constexpr auto kPlaces = static_cast<Index>(friction::kMostPlaces);

/// Two neighbours among the places, and the weight of the second.
struct Between {
  Index first = 0;
  double weight = 0.0;
};

class Grid {
 public:
  Grid(double low, double high)
      : low_(low), step_((high - low) / static_cast<double>(friction::kMostPlaces - 1)) {}
  [[nodiscard]] Between at(double x) const {
    const double s = std::clamp((x - low_) / step_, 0.0, static_cast<double>(friction::kMostPlaces - 1));
    const auto first = std::min<Index>(static_cast<Index>(s), friction::kMostPlaces - 2);
    return {first, s - static_cast<double>(first)};
  }
  [[nodiscard]] double position(std::size_t i) const { return low_ + step_ * static_cast<double>(i); }

 private:
  double low_, step_;
};

/// Squares and products of one block of motion.
struct Products {
  explicit Products(Index n) : columns(MatrixXd::Zero(n, n)), with(VectorXd::Zero(n)) {}

  MatrixXd columns;
  VectorXd with;
  double square = 0.0;

  void add(const VectorXd& c, double y) {
    columns.selfadjointView<Eigen::Lower>().rankUpdate(c);
    with += y * c;
    square += y * y;
  }
  void add(const Products& other) {
    columns += other.columns;
    with += other.with;
    square += other.square;
  }
  [[nodiscard]] MatrixXd whole() const { return columns.selfadjointView<Eigen::Lower>(); }
  /// Σ (y − c·s)².
  [[nodiscard]] double left(const VectorXd& s) const {
    return square - 2.0 * s.dot(with) + s.dot(whole() * s);
  }
};

/// The rows that are looked at, and the travel that they cover.
class Looked {
 public:
  explicit Looked(const PlaceRows& data) : data_(data), grid_(extent()) {}

  [[nodiscard]] const std::vector<std::size_t>& used() const { return used_; }
  [[nodiscard]] const Grid& grid() const { return grid_; }
  [[nodiscard]] double travel() const { return high_ - low_; }
  [[nodiscard]] double position(std::size_t i) const {
    return motion_of(data_.log, data_.rows, i).x[data_.rows.at[i]];
  }
  [[nodiscard]] double direction(std::size_t i) const { return map::kDirection[data_.rows.side[i]]; }
  [[nodiscard]] double speed(std::size_t i) const { return std::abs(velocity_of(data_.log, data_.rows, i)); }
  /// Level with its sign [N].
  [[nodiscard]] double level(std::size_t i) const {
    return direction(i) * data_.level(data_.rows.side[i], speed(i));
  }
  /// Places, and for each record a level of its own and one that drifts: a machine that warms up must not look like a place.
  [[nodiscard]] Index columns() const {
    return kPlaces + 2 * static_cast<Index>(std::min(data_.log.records.size(), kMostRecords));
  }
  /// Adds the columns of a row.
  void add_columns(VectorXd& c, std::size_t i) const {
    const Between place = grid_.at(position(i));
    const double force = level(i);
    c(place.first) += (1.0 - place.weight) * force;
    c(place.first + 1) += place.weight * force;
    const auto record = static_cast<std::size_t>(data_.rows.record[i]);
    if (record >= kMostRecords) return;
    const std::vector<double>& t = data_.log.records[record].t;
    const double duration = t.back() - t.front();
    const double share = duration > 0.0 ? (t[data_.rows.at[i]] - t.front()) / duration - 0.5 : 0.0;
    const Index own = kPlaces + 2 * static_cast<Index>(record);
    c(own) += force;
    c(own + 1) += share * force;
  }

 private:
  Grid extent() {
    const std::vector<std::size_t> all = sample(data_.rows);
    const std::size_t every = all.size() / kMostLooked + 1;
    for (std::size_t j = 0; j < all.size(); j += every) used_.push_back(all[j]);
    for (const std::size_t i : used_)
      low_ = std::min(low_, position(i)), high_ = std::max(high_, position(i));
    return {low_, high_};
  }

  const PlaceRows& data_;
  std::vector<std::size_t> used_;
  double low_ = std::numeric_limits<double>::infinity();
  double high_ = -std::numeric_limits<double>::infinity();
  Grid grid_;
};

/// The rows as deviations from the mean of their bins.
std::vector<Products> deviations(const PlaceRows& data, const Looked& looked) {
  struct Bin {
    VectorXd columns;
    double y = 0.0, count = 0.0;
  };
  std::array<std::vector<Bin>, map::kSides> bins;
  for (std::size_t s = 0; s < map::kSides; ++s)
    bins[s].assign(static_cast<std::size_t>(data.rows.grid[s].bins), Bin{VectorXd::Zero(looked.columns())});
  const auto bin_of = [&](std::size_t i) -> Bin& {
    return bins[data.rows.side[i]][static_cast<std::size_t>(data.rows.bin[i])];
  };
  for (const std::size_t i : looked.used()) {
    Bin& bin = bin_of(i);
    looked.add_columns(bin.columns, i);
    bin.y += data.residual[i];
    bin.count += 1.0;
  }
  std::vector<Products> out(data.rows.blocks, Products(looked.columns()));
  VectorXd c;
  for (const std::size_t i : looked.used()) {
    const Bin& bin = bin_of(i);
    c = bin.columns / -bin.count;
    looked.add_columns(c, i);
    out[data.rows.block[i]].add(c, data.residual[i] - bin.y / bin.count);
  }
  return out;
}

/// The same with the records' own levels alone.
std::vector<Products> without_places(const std::vector<Products>& blocks) {
  std::vector<Products> out;
  for (const Products& b : blocks) {
    const Index n = b.with.size() - kPlaces;
    Products own(n);
    own.columns = b.columns.bottomRightCorner(n, n);
    own.with = b.with.tail(n);
    own.square = b.square;
    out.push_back(std::move(own));
  }
  return out;
}

/// Prior: deviations are small and smooth.
MatrixXd prior(Index columns, Index places) {
  MatrixXd p = MatrixXd::Identity(columns, columns) / (kExpected * kExpected);
  for (Index i = 1; i + 1 < places; ++i) {
    VectorXd bend = VectorXd::Zero(columns);
    bend(i - 1) = bend(i + 1) = 1.0, bend(i) = -2.0;
    p += bend * bend.transpose() / (kSmooth * kSmooth);
  }
  return p;
}

/// Shares by ridge, and how well they predict each block from the others.
struct Ridge {
  VectorXd shares;
  MatrixXd spread;
  double left_out = 0.0;
  std::vector<double> left_out_of;  ///< of each block
};

/// `places`: how many columns are places.
Ridge solve_ridge(const std::vector<Products>& blocks, Index places, double rows_used, double memory) {
  Products all(blocks.front().with.size());
  for (const Products& b : blocks) all.add(b);
  const MatrixXd known = prior(all.with.size(), places);
  double variance = all.square / rows_used;
  const auto of = [&](const Products& sums) {
    return stats::solve_ldlt(sums.whole() / (variance * memory) + known, sums.with / (variance * memory));
  };
  for (int pass = 0; pass < 3; ++pass)
    variance = std::max(all.left(of(all)) / rows_used, 1e-12 * all.square / rows_used);
  Ridge out{of(all), {}, 0.0, {}};
  out.spread = stats::inverse_ldlt(all.whole() / (variance * memory) + known);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    Products others(all.with.size());
    for (std::size_t j = 0; j < blocks.size(); ++j) {
      if (j != b) others.add(blocks[j]);
    }
    out.left_out_of.push_back(blocks[b].left(of(others)));
    out.left_out += out.left_out_of.back();
  }
  return out;
}

/// Correlated rows count as the independent ones that they are worth.
double memory_of(const PlaceRows& data, const Looked& looked) {
  const double thinned = static_cast<double>(looked.used().size()) / static_cast<double>(data.rows.size());
  return std::max(1.0, 2.0 * thinned * stats::memory_of(data.residual, data.rows.record, data.rows.at).rows);
}

/// How many of the independent differences between places are left after the mean of each speed is taken off, as a share.
double share_told(const Looked& looked, const std::vector<Products>& blocks) {
  MatrixXd all = MatrixXd::Zero(kPlaces, kPlaces), left = all;
  VectorXd c(looked.columns());
  for (const std::size_t i : looked.used()) {
    c.setZero();
    looked.add_columns(c, i);
    all += c.head(kPlaces) * c.head(kPlaces).transpose();
  }
  for (const Products& b : blocks) left += b.whole().topLeftCorner(kPlaces, kPlaces);
  all.diagonal().array() += 1e-9 * all.trace();
  const VectorXd shares = stats::generalized_eigenvalues(left, all);
  return static_cast<double>((shares.array() > kSeen).count()) / static_cast<double>(kPlaces);
}

bool enough(const Looked& looked) {
  return static_cast<double>(looked.used().size()) >= kFewestRows && looked.travel() > kNarrowest;
}

/// The places of a ridge with a mean share of one: what all places have in common belongs to the map.
PlaceShares places_of(const Looked& looked, const Ridge& ridge, double before) {
  const auto rows_used = static_cast<double>(looked.used().size());
  PlaceShares out;
  out.before = std::sqrt(before / rows_used), out.after = std::sqrt(ridge.left_out / rows_used);
  const VectorXd s = ridge.shares.head(kPlaces);
  const double mean = s.mean();
  if ((s.array() - mean).abs().maxCoeff() < kWorthStoring) return out;
  const MatrixXd centred =
      MatrixXd::Identity(kPlaces, kPlaces) - MatrixXd::Constant(kPlaces, kPlaces, 1.0 / kPlaces);
  const MatrixXd spread = centred * ridge.spread.topLeftCorner(kPlaces, kPlaces) * centred.transpose();
  for (Index k = 0; k < kPlaces; ++k) {
    const double level = std::clamp((1.0 + s(k)) / (1.0 + mean), kLeast, 1.0 / kLeast);
    out.places.push_back({looked.grid().position(static_cast<std::size_t>(k)), level, 1.0});
    out.half.push_back(1.96 * std::sqrt(spread(k, k)));
  }
  return out;
}

}  // namespace

PlaceShares find_places(const PlaceRows& data) {
  const Looked looked(data);
  if (!enough(looked)) return {};
  const std::vector<Products> blocks = deviations(data, looked);
  if (share_told(looked, blocks) < kTold) return {};
  const auto rows_used = static_cast<double>(looked.used().size());
  const double memory = memory_of(data, looked);
  const Ridge with = solve_ridge(blocks, kPlaces, rows_used, memory);
  const Ridge without = solve_ridge(without_places(blocks), 0, rows_used, memory);
  std::size_t better = 0;
  for (std::size_t b = 0; b < blocks.size(); ++b)
    better += with.left_out_of[b] < without.left_out_of[b] ? 1 : 0;
  if (!(with.left_out < kPredicts * without.left_out) || better + 1 < blocks.size()) return {};
  return places_of(looked, with, without.left_out);
}

void lay_places(const AlignedLog& log, Rows& rows, const Level& level, const friction::Places& places) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const log::Motion& m = motion_of(log, rows, i);
    const double x = m.x[rows.at[i]];
    const double change = friction::shares_at(places, x).level - 1.0;
    rows.lag[i] += map::kDirection[rows.side[i]] * change * level(rows.side[i], std::abs(m.v[rows.at[i]]));
  }
}

friction::Places together(const friction::Places& a, const friction::Places& b) {
  friction::Places out = a.empty() ? b : a;
  if (a.empty()) return out;
  for (friction::Place& p : out)
    p.level = std::clamp(p.level + friction::shares_at(b, p.position).level - 1.0, kLeast, 1.0 / kLeast);
  return out;
}

}  // namespace stribeck::ident::drive
