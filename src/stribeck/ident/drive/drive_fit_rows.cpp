#include <algorithm>
#include <limits>
#include <numeric>
#include <stribeck/ident/drive/drive_fit_parts.hpp>
#include <string>

namespace stribeck::ident::drive {
namespace {

/// Largest relative change of speed within one relaxation length: the lag, first order in it, is then small
/// and known.
constexpr double kLagShare = 0.2;
constexpr std::size_t kFewestRows = 30;
constexpr std::size_t kSampleRows = 60000;  // enough for what is only looked at
constexpr std::size_t kSampleChunk = 2000;  // rows in sequence: their correlation is seen

}  // namespace

void DriveFit::gather(double exclude, double slowest_share, double relaxation) {
  rows_.clear();
  rows_.reserve(std::accumulate(motions_.begin(), motions_.end(), std::size_t{0},
                                [](std::size_t sum, const log::Motion& m) { return sum + m.rows(); }));
  int before = 0;
  for (std::size_t r = 0; r < motions_.size(); ++r) {
    const log::Motion& m = motions_[r];
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
      rows_.side.push_back(static_cast<std::uint8_t>(map::side_of(m.v[k])));
    }
    before += static_cast<int>(m.reversals.size());
  }
  std::array<std::size_t, map::kSides> count{};
  for (map::Grid& g : grid_) g = {std::numeric_limits<double>::infinity(), 0.0, 1};
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    map::Grid& g = grid_[rows_.side[i]];
    const double speed = std::abs(velocity(i));
    g.low = std::min(g.low, speed);
    g.high = std::max(g.high, speed);
    ++count[rows_.side[i]];
  }
  for (std::size_t s = 0; s < map::kSides; ++s) {
    if (count[s] < kFewestRows || !(grid_[s].high > grid_[s].low)) {
      throw Refused("identification: " + std::to_string(count[s]) + " rows of " + map::kSideName[s] +
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

void DriveFit::deal() {
  std::array<std::size_t, map::kSides> stretches{};
  std::array<std::size_t, map::kSides> count{};
  std::array<int, map::kSides> last{-1, -1};
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const std::size_t s = rows_.side[i];
    ++count[s];
    if (rows_.stretch[i] != last[s]) last[s] = rows_.stretch[i], ++stretches[s];
  }
  const std::size_t fewest = std::min(stretches[0], stretches[1]);
  // Primes: programmes repeat their speeds in other rhythms.
  blocks_ = fewest >= 7 ? 7 : 5;
  block_.resize(rows_.size());
  std::array<std::size_t, map::kSides> ordinal{}, seen{};
  last = {-1, -1};
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const std::size_t s = rows_.side[i];
    if (rows_.stretch[i] != last[s]) {
      if (last[s] >= 0) ++ordinal[s];
      last[s] = rows_.stretch[i];
    }
    const std::size_t piece = std::max<std::size_t>(1, count[s] / (blocks_ * 5));
    block_[i] = static_cast<std::uint8_t>((stretches[s] >= blocks_ ? ordinal[s] : seen[s] / piece) % blocks_);
    ++seen[s];
  }
}

bool DriveFit::thin_out() {
  const std::vector<std::size_t> kept = sample();
  if (kept.size() == rows_.size()) return false;
  map::Rows rows;
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

void DriveFit::take_all() {
  if (!thin_) return;
  thin_ = false;
  rows_ = std::move(all_rows_), block_ = std::move(all_blocks_);
  align(shift_);
}

std::vector<std::size_t> DriveFit::sample() const {
  const std::size_t every = rows_.size() / kSampleRows + 1;
  std::vector<std::size_t> out;
  out.reserve(kSampleRows + kSampleChunk);
  for (std::size_t from = 0; from < rows_.size(); from += every * kSampleChunk) {
    for (std::size_t i = from; i < std::min(from + kSampleChunk, rows_.size()); ++i) out.push_back(i);
  }
  return out;
}

}  // namespace stribeck::ident::drive
