#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <stribeck/ident/stats/long_run.hpp>
#include <unsupported/Eigen/FFT>

namespace stribeck::ident::stats {
namespace {

// The flat top reaches to six correlation lengths, where e^-6 of first-order noise is left.
constexpr double kMemories = 12.0;
constexpr std::size_t kBlocksOfLag = 8;
constexpr std::size_t kRowsForMemory = 60000;
constexpr std::size_t kLongestLag = 2000;
constexpr double kNegligible = 0.05;

constexpr std::size_t kFewLags = 32;  // which are summed one by one
constexpr std::size_t kMostGaps =
    8;  // rows of a record for each one that has a residual, to lay them side by side

/// Σ e_i·e_j over rows of one record that are `lag` rows apart, and how many these are.
struct Products {
  double sum = 0.0;
  double pairs = 0.0;
};

Products products_at(std::size_t lag, std::size_t n, const std::vector<double>& e,
                     const std::vector<int>& record, const std::vector<std::size_t>& at) {
  Products out;
  std::size_t j = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (i == 0 || record[i] != record[i - 1]) j = i;
    while (at[i] - at[j] > lag) ++j;
    if (at[i] - at[j] == lag) out.sum += e[i] * e[j], out.pairs += 1.0;
  }
  return out;
}

/// Adds the correlation of a series with itself to `sums`, one element for each lag.
void add_correlation(std::vector<double> series, std::vector<double>& sums) {
  std::size_t size = 1;
  while (size < series.size() + sums.size()) size *= 2;
  series.resize(size, 0.0);
  Eigen::FFT<double> fft;
  std::vector<std::complex<double>> spectrum;
  fft.fwd(spectrum, series);
  for (std::complex<double>& c : spectrum) c = std::norm(c);
  fft.inv(series, spectrum);
  for (std::size_t lag = 0; lag < sums.size(); ++lag) sums[lag] += series[lag];
}

/// The same for all lags below `lags`, by the spectrum. Empty where the rows have too many gaps for it.
std::vector<Products> products_below(std::size_t lags, std::size_t n, const std::vector<double>& e,
                                     const std::vector<int>& record, const std::vector<std::size_t>& at) {
  std::vector<double> sums(lags, 0.0), pairs(lags, 0.0);
  for (std::size_t from = 0, to = 0; from < n; from = to) {
    while (to < n && record[to] == record[from]) ++to;
    const std::size_t length = at[to - 1] - at[from] + 1;
    if (length > kMostGaps * (to - from) + lags) return {};
    std::vector<double> values(length, 0.0), present(length, 0.0);
    for (std::size_t i = from; i < to; ++i) values[at[i] - at[from]] = e[i], present[at[i] - at[from]] = 1.0;
    add_correlation(std::move(values), sums);
    add_correlation(std::move(present), pairs);
  }
  std::vector<Products> out;
  for (std::size_t lag = 0; lag < lags; ++lag) out.push_back({sums[lag], std::round(pairs[lag])});
  return out;
}

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
  const std::size_t lags = std::min(kLongestLag, n / 4);
  std::vector<Products> all;
  for (std::size_t lag = 1; lag < lags; ++lag) {
    if (lag == kFewLags) all = products_below(lags, n, e, record, at);
    const Products p = all.empty() ? products_at(lag, n, e, record, at) : all[lag];
    const double rho = p.pairs > 0.0 ? p.sum / p.pairs / square : 0.0;
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
  const auto D = static_cast<Eigen::Index>(d);
  // Σ x·xᵀ + x·bᵀ + b·xᵀ, with b the weighted sum of the blocks before x, is M + Mᵀ with M = Σ x·(b + x/2)ᵀ: one product of vectors
  // for each block instead of one for every lag.
  constexpr Eigen::Index kTogether = 64;
  Eigen::MatrixXd blocks(D, kTogether), with(D, kTogether), sum = Eigen::MatrixXd::Zero(D, D);
  Eigen::Index filled = 0;
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    blocks.col(filled) = Eigen::Map<const Eigen::VectorXd>(sums_.data() + b * d, D);
    auto before = with.col(filled);
    before = 0.5 * blocks.col(filled);
    for (std::size_t c = b; c-- > 0;) {
      if (blocks_[c].record != blocks_[b].record) break;
      const std::size_t lag = blocks_[b].number - blocks_[c].number;
      if (lag > memory_.lags) break;
      const double w =
          std::min(1.0, 2.0 * (1.0 - static_cast<double>(lag) / static_cast<double>(memory_.lags + 1)));
      before += w * Eigen::Map<const Eigen::VectorXd>(sums_.data() + c * d, D);
    }
    if (++filled < kTogether && b + 1 < blocks_.size()) continue;
    sum.noalias() += blocks.leftCols(filled) * with.leftCols(filled).transpose();
    filled = 0;
  }
  std::vector<double> s(d * d);
  Eigen::Map<Eigen::MatrixXd>(s.data(), D, D) = sum + sum.transpose();
  return s;
}

}  // namespace stribeck::ident::stats
