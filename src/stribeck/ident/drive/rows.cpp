#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stribeck/ident/drive/rows.hpp>
#include <stribeck/ident/drive/steady_rows.hpp>
#include <stribeck/ident/refused.hpp>
#include <string>

namespace stribeck::ident::drive {
namespace {

/// Largest relative change of speed within one relaxation length; the lag, of first order in it, is then small
/// and known.
constexpr double kLagShare = 0.2;
constexpr std::size_t kFewestOfADirection = 30;
constexpr std::size_t kRowsOfABin = 12;  // at least, on average
constexpr int kFewestBins = 8;
constexpr double kBinsPerDecade = 12.0;     // of slow speeds: each bin is a fifth wider than the one below
constexpr std::size_t kSampleRows = 60000;  // enough for a quick look at the data
constexpr std::size_t kSampleChunk = 2000;  // rows in sequence, so that their correlation can be seen

double slowest_of(const Extent& extent, const Window& window, double velocity) {
  return window.slowest_share * extent.top_speed[velocity > 0.0 ? 0 : 1];
}

/// At rest friction is anything that the force needs. A row before or behind a stop, whose window reaches into it, has a mean of both.
bool moves_in_window(const log::Motion& m, std::size_t k) {
  constexpr double kLeast = 0.1;  // of the speed of the row
  const auto n = static_cast<std::size_t>(m.reach);
  const double least = kLeast * m.v[k] * m.direction[k];
  // Near the ends of a record a row has no window, and its velocity is that of raw positions.
  const std::size_t first = std::max(k - n, n), last = std::min(k + n, m.rows() - 1 - n);
  return m.v[first] * m.direction[k] >= least && m.v[last] * m.direction[k] >= least;
}

void pick_rows(Rows& rows, const AlignedLog& log, const Extent& extent, const Window& window) {
  int stretches_before = 0;
  for (std::size_t r = 0; r < log.motions.size(); ++r) {
    const log::Motion& m = log.motions[r];
    const std::vector<std::uint8_t>& skip = log.records[r].skip;
    const std::vector<std::uint8_t> steady = steady_rows(m, window.exclude);
    for (std::size_t k = 0; k < m.rows(); ++k) {
      const double speed = m.v[k] * m.direction[k];
      const bool is_slow = speed < slowest_of(extent, window, m.v[k]);
      if (!(speed > 0.0) || (is_slow && steady[k] == 0)) continue;
      if (window.relaxation * std::abs(m.a[k]) > kLagShare * speed * speed) continue;
      if (!m.sliding(k, window.exclude) || (!skip.empty() && skip[k] != 0)) continue;
      if (!moves_in_window(m, k)) continue;
      rows.record.push_back(static_cast<int>(r));
      rows.at.push_back(k);
      rows.stretch.push_back(stretches_before + m.stretch[k]);
      rows.side.push_back(static_cast<std::uint8_t>(map::side_of(m.v[k])));
    }
    stretches_before += static_cast<int>(m.reversals.size());
  }
}

/// Number of rows of one direction.
struct Count {
  std::size_t fast = 0, slow = 0;
};

int bins_for(std::size_t rows, int most) { return std::min(most, static_cast<int>(rows / kRowsOfABin)); }

/// Bins of equal width for rows above the slowest speed, of equal ratio below; of equal width alone where one kind is missing.
void lay_bins(map::Grid& g, const Count& count, int most_bins) {
  const bool has_both = g.low < g.knee && g.knee < g.high;
  g.bins = std::max(kFewestBins, bins_for(has_both ? count.fast : count.fast + count.slow, most_bins));
  if (!has_both) return;
  const int wanted = 1 + static_cast<int>(kBinsPerDecade * std::log10(g.knee / g.low));
  g.slow_bins = std::max(1, bins_for(count.slow, wanted));
  g.bins += g.slow_bins;
}

void sort_into_bins(Rows& rows, const AlignedLog& log, const Extent& extent, const Window& window,
                    int most_bins) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  std::array<Count, map::kSides> count{};
  for (map::Grid& g : rows.grid) g = {kNone, 0.0, 1, kNone, 0};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double v = velocity_of(log, rows, i);
    const double speed = std::abs(v);
    map::Grid& g = rows.grid[rows.side[i]];
    g.low = std::min(g.low, speed);
    g.high = std::max(g.high, speed);
    const bool is_slow = speed < slowest_of(extent, window, v);
    if (!is_slow) g.knee = std::min(g.knee, speed);
    ++(is_slow ? count[rows.side[i]].slow : count[rows.side[i]].fast);
  }
  for (std::size_t s = 0; s < map::kSides; ++s) {
    const std::size_t all = count[s].fast + count[s].slow;
    if (all < kFewestOfADirection || !(rows.grid[s].high > rows.grid[s].low)) {
      throw Refused("identification: " + std::to_string(all) + " rows of " + map::kSideName[s] +
                    " sliding motion, expected at least " + std::to_string(kFewestOfADirection) +
                    "; run the axis through its speeds in both directions");
    }
    lay_bins(rows.grid[s], count[s], most_bins);
  }
  rows.bin.resize(rows.size());
  rows.lag.assign(rows.size(), 0.0);
  for (std::size_t i = 0; i < rows.size(); ++i)
    rows.bin[i] = rows.grid[rows.side[i]].bin(std::abs(velocity_of(log, rows, i)));
}

/// In open loop the instrument is the force.
void renew_instruments(AlignedLog& log) {
  for (log::Motion& m : log.motions) {
    if (m.loop == log::Loop::kOpen) m.instrument = m.f;
  }
}

}  // namespace

Extent extent_of(const AlignedLog& log) {
  Extent out;
  double stroke = 0.0;
  double hysteresis = 0.0;
  for (const log::Motion& m : log.motions) {
    stroke = std::max(stroke, m.stroke);
    hysteresis = std::max(hysteresis, 20.0 * m.position_noise);
    for (std::size_t k = 0; k < m.rows(); ++k) {
      double& top = out.top_speed[m.v[k] > 0.0 ? 0 : 1];
      if (m.valid(k)) top = std::max(top, std::abs(m.v[k]));
    }
  }
  out.near = std::max(hysteresis, 2e-3 * stroke);
  return out;
}

Rows gather(const AlignedLog& log, const Extent& extent, const Window& window, int bins) {
  Rows rows;
  rows.reserve(std::accumulate(log.motions.begin(), log.motions.end(), std::size_t{0},
                               [](std::size_t sum, const log::Motion& m) { return sum + m.rows(); }));
  pick_rows(rows, log, extent, window);
  sort_into_bins(rows, log, extent, window, bins);
  number_blocks(rows);
  return rows;
}

namespace {

/// Place of each record among all, by what it holds: the order in which logs are given decides nothing. The longest comes first, so
/// that its blocks are those that it has alone.
std::vector<std::size_t> ranks_of_records(const Rows& rows) {
  std::vector<std::array<std::size_t, 3>> keys;  // rows, and sums of their bins and places
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto r = static_cast<std::size_t>(rows.record[i]);
    if (keys.size() <= r) keys.resize(r + 1);
    ++keys[r][0];
    keys[r][1] += static_cast<std::size_t>(rows.bin[i]);
    keys[r][2] += rows.at[i];
  }
  std::vector<std::size_t> order(keys.size()), rank(keys.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return keys[a] > keys[b]; });
  for (std::size_t i = 0; i < order.size(); ++i) rank[order[i]] = i;
  return rank;
}

using Sides = std::array<std::size_t, map::kSides>;

/// Strokes of each direction in all records of a lower rank.
std::vector<Sides> strokes_before(const Rows& rows, const std::vector<std::size_t>& rank) {
  std::vector<Sides> strokes(rank.size()), before(rank.size());
  int record = -1;
  std::array<int, map::kSides> last{-1, -1};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows.record[i] != record) record = rows.record[i], last = {-1, -1};
    const std::size_t s = rows.side[i];
    if (rows.stretch[i] != last[s])
      last[s] = rows.stretch[i], ++strokes[rank[static_cast<std::size_t>(record)]][s];
  }
  for (std::size_t r = 1; r < rank.size(); ++r) {
    for (std::size_t s = 0; s < map::kSides; ++s) before[r][s] = before[r - 1][s] + strokes[r - 1][s];
  }
  return before;
}

bool fills_all_blocks(const Rows& rows, std::size_t side) {
  std::vector<bool> filled(rows.blocks, false);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows.side[i] == side) filled[rows.block[i]] = true;
  }
  return std::find(filled.begin(), filled.end(), false) == filled.end();
}

/// `before`: rows of each direction in all records of a lower rank. `begin(rank, side)`: number of the first stroke of a record.
template <class Begin>
void assign_blocks(Rows& rows, const std::vector<std::size_t>& rank, const std::vector<Sides>& before,
                   const Sides& stretches, const Sides& count, Begin&& begin) {
  Sides ordinal{}, seen{};
  std::array<int, map::kSides> last{-1, -1};
  int record = -1;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::size_t s = rows.side[i];
    if (rows.record[i] != record) record = rows.record[i], ordinal = {}, seen = {}, last = {-1, -1};
    if (rows.stretch[i] != last[s]) {
      if (last[s] >= 0) ++ordinal[s];
      last[s] = rows.stretch[i];
    }
    const std::size_t r = rank[static_cast<std::size_t>(record)];
    const std::size_t piece = std::max<std::size_t>(1, count[s] / (rows.blocks * 5));
    const std::size_t number =
        stretches[s] >= rows.blocks ? ordinal[s] + begin(r, s) : (before[r][s] + seen[s]) / piece;
    rows.block[i] = static_cast<std::uint8_t>(number % rows.blocks);
    ++seen[s];
  }
}

}  // namespace

void number_blocks(Rows& rows) {
  const std::vector<std::size_t> rank = ranks_of_records(rows);
  Sides stretches{}, count{};
  std::vector<Sides> rows_of(rank.size());  // by rank
  std::array<int, map::kSides> last{-1, -1};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::size_t s = rows.side[i];
    ++count[s];
    ++rows_of[rank[static_cast<std::size_t>(rows.record[i])]][s];
    if (rows.stretch[i] != last[s]) last[s] = rows.stretch[i], ++stretches[s];
  }
  std::vector<Sides> before(rank.size());
  for (std::size_t r = 1; r < rank.size(); ++r) {
    for (std::size_t s = 0; s < map::kSides; ++s) before[r][s] = before[r - 1][s] + rows_of[r - 1][s];
  }
  // Prime numbers, because programmes do not repeat their speeds in these rhythms.
  rows.blocks = std::min(stretches[0], stretches[1]) >= 7 ? 7 : 5;
  rows.block.resize(rows.size());
  assign_blocks(rows, rank, before, stretches, count, [](std::size_t r, std::size_t) { return r; });
  // With few strokes in each record, blocks stay empty so: then the strokes are counted on from record to record.
  for (std::size_t s = 0; s < map::kSides; ++s) {
    if (stretches[s] < rows.blocks || fills_all_blocks(rows, s)) continue;
    const std::vector<Sides> strokes = strokes_before(rows, rank);
    assign_blocks(rows, rank, before, stretches, count,
                  [&](std::size_t r, std::size_t side) { return strokes[r][side]; });
    return;
  }
}

std::vector<std::size_t> sample(const Rows& rows) {
  const std::size_t every = rows.size() / kSampleRows + 1;
  std::vector<std::size_t> out;
  out.reserve(kSampleRows + kSampleChunk);
  for (std::size_t from = 0; from < rows.size(); from += every * kSampleChunk) {
    for (std::size_t i = from; i < std::min(from + kSampleChunk, rows.size()); ++i) out.push_back(i);
  }
  return out;
}

Rows picked(const Rows& rows, const std::vector<std::size_t>& kept) {
  Rows out;
  out.reserve(kept.size());
  for (const std::size_t i : kept) {
    out.record.push_back(rows.record[i]);
    out.at.push_back(rows.at[i]);
    out.stretch.push_back(rows.stretch[i]);
    out.side.push_back(rows.side[i]);
    out.bin.push_back(rows.bin[i]);
    out.lag.push_back(rows.lag[i]);
    out.block.push_back(rows.block[i]);
  }
  out.grid = rows.grid;
  out.blocks = rows.blocks;
  out.sampled = rows.sampled;
  return out;
}

Rows sampled(const Rows& rows) {
  const std::vector<std::size_t> kept = sample(rows);
  if (kept.size() == rows.size()) return rows;
  Rows out = picked(rows, kept);
  out.sampled = true;
  return out;
}

void align_all(AlignedLog& log, double shift) {
  log.shift = shift;
  for (std::size_t r = 0; r < log.motions.size(); ++r)
    log::align_force(log.force[r], shift, 0, log.force[r].size(), log.motions[r].f);
  renew_instruments(log);
}

void align(AlignedLog& log, double shift, const Rows& rows) {
  if (!rows.sampled) {
    align_all(log, shift);
    return;
  }
  log.shift = shift;
  for (std::size_t i = 0; i < rows.size();) {
    // A run of consecutive rows and its neighbours.
    std::size_t last = i;
    while (last + 1 < rows.size() && rows.record[last + 1] == rows.record[i] &&
           rows.at[last + 1] == rows.at[last] + 1)
      ++last;
    const auto r = static_cast<std::size_t>(rows.record[i]);
    const std::size_t from = rows.at[i] > 0 ? rows.at[i] - 1 : 0;
    log::align_force(log.force[r], shift, from, std::min(log.force[r].size(), rows.at[last] + 2),
                     log.motions[r].f);
    i = last + 1;
  }
  renew_instruments(log);
}

}  // namespace stribeck::ident::drive
