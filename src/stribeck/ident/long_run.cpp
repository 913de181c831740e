#include <algorithm>
#include <cmath>
#include <stribeck/ident/long_run.hpp>

namespace stribeck::ident {
namespace {

// The flat top reaches to six memories, where e^-6 of first-order noise is left.
constexpr double kMemories = 12.0;
constexpr std::size_t kBlocksOfLag = 8;
constexpr std::size_t kRowsForMemory = 60000;
constexpr std::size_t kLongestLag = 2000;
constexpr double kNegligible = 0.05;

}  // namespace

Memory memory_of(const std::vector<double>& e, const std::vector<int>& record,
                 const std::vector<std::size_t>& at) {
  Memory m;
  const std::size_t n = std::min(e.size(), kRowsForMemory);
  if (n < 20) return m;
  double square = 0.0;
  for (std::size_t i = 0; i < n; ++i) square += e[i] * e[i];
  if (!(square > 0.0)) return m;
  square /= static_cast<double>(n);
  for (std::size_t lag = 1; lag < std::min(kLongestLag, n / 4); ++lag) {
    double sum = 0.0;
    std::size_t pairs = 0;
    std::size_t j = 0;
    for (std::size_t i = 0; i < n; ++i) {
      if (i == 0 || record[i] != record[i - 1]) j = i;
      while (at[i] - at[j] > lag) ++j;
      if (at[i] - at[j] == lag) {
        sum += e[i] * e[j];
        ++pairs;
      }
    }
    const double rho = pairs > 0 ? sum / static_cast<double>(pairs) / square : 0.0;
    if (rho < kNegligible) break;
    m.rows += rho;
  }
  const double reach = std::min(kMemories * m.rows, static_cast<double>(e.size()) / 20.0);
  m.block = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(reach / kBlocksOfLag)));
  m.lags =
      std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(reach / static_cast<double>(m.block))));
  return m;
}

double* LongRun::row(int record, std::size_t at) {
  const std::size_t number = at / memory_.block;
  if (blocks_.empty() || blocks_.back().record != record || blocks_.back().number != number) {
    blocks_.push_back({record, number});
    sums_.resize(sums_.size() + dimension_, 0.0);
  }
  return sums_.data() + sums_.size() - dimension_;
}

std::vector<double> LongRun::covariance() const {
  const std::size_t d = dimension_;
  std::vector<double> s(d * d, 0.0);
  std::vector<double> before(d);
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const double* x = sums_.data() + b * d;
    // The weighted sum of the blocks before comes first: one product of vectors instead of one for every lag.
    std::fill(before.begin(), before.end(), 0.0);
    for (std::size_t c = b; c-- > 0;) {
      if (blocks_[c].record != blocks_[b].record) break;
      const std::size_t lag = blocks_[b].number - blocks_[c].number;
      if (lag > memory_.lags) break;
      const double w =
          std::min(1.0, 2.0 * (1.0 - static_cast<double>(lag) / static_cast<double>(memory_.lags + 1)));
      const double* y = sums_.data() + c * d;
      for (std::size_t j = 0; j < d; ++j) before[j] += w * y[j];
    }
    for (std::size_t i = 0; i < d; ++i) {
      for (std::size_t j = 0; j < d; ++j) s[i * d + j] += x[i] * (x[j] + before[j]) + before[i] * x[j];
    }
  }
  return s;
}

}  // namespace stribeck::ident
