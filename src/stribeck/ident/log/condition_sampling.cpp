// How the log was written: resolution, number of rows that repeat a value, noise.
#include <algorithm>
#include <cmath>
#include <stribeck/ident/log/condition_parts.hpp>
#include <stribeck/ident/log/motion.hpp>
#include <stribeck/ident/stats/order.hpp>

namespace stribeck::ident::log {

double quantum(const std::vector<double>& values) {
  constexpr std::size_t kMost = 20000;
  std::vector<double> sorted = parts::sample_of(values, kMost);
  if (sorted.size() < 2) return 0.0;
  // At a constant speed all values are multiples of one step, which is no resolution.
  std::vector<double> moves;
  std::size_t same = 0;
  for (std::size_t k = 1; k < sorted.size(); ++k) {
    if (sorted[k] == sorted[k - 1]) {
      ++same;
    } else {
      moves.push_back(std::abs(sorted[k] - sorted[k - 1]));
    }
  }
  if (moves.empty()) return 0.0;
  const double usual_move = stats::thinned_quantile(moves, 0.5);
  const bool repeats = same * 10 > sorted.size();
  std::sort(sorted.begin(), sorted.end());
  const double largest = std::max(std::abs(sorted.front()), std::abs(sorted.back()));
  const double rounding = 1e-11 * largest;
  std::vector<double> steps;
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    if (sorted[i] - sorted[i - 1] > rounding) steps.push_back(sorted[i] - sorted[i - 1]);
  }
  if (steps.empty()) return 0.0;
  std::sort(steps.begin(), steps.end());
  // A single edited value may cause the very smallest step.
  for (const double share : {0.0, 0.02, 0.1}) {
    const double q = steps[static_cast<std::size_t>(share * static_cast<double>(steps.size() - 1))];
    double sum = 0.0;
    double count = 0.0;
    std::size_t fits = 0;
    std::size_t near = 0;
    for (const double s : steps) {
      const double n = std::round(s / q);
      if (n > 50.0) break;
      ++near;
      if (n < 1.0 || std::abs(s / q - n) > 0.1) continue;
      ++fits;
      sum += s;
      count += n;
    }
    // Continuous values lie in the band in one case of five.
    if (fits * 10 < near * 9 || near * 20 < steps.size() || (near < 20 && near < steps.size())) continue;
    const double step = sum / count;
    if (!repeats && usual_move < 1.5 * step) return 0.0;
    return step;
  }
  return 0.0;
}

namespace parts {
namespace {

constexpr std::size_t kMostChanges = 50000;

}  // namespace

double hold_of(const std::vector<Table>& tables, std::vector<double> Table::*column) {
  std::vector<double> gaps;
  std::vector<double> changes;
  std::vector<double> all;
  for (const Table& m : tables) {
    const std::vector<double>& y = m.*column;
    if (y.empty()) return 1.0;
    std::size_t last = 0;
    for (std::size_t k = 1; k < y.size() && gaps.size() < kMostChanges; ++k) {
      if (y[k] == y[k - 1]) continue;
      if (last > 0) gaps.push_back(static_cast<double>(k - last));
      changes.push_back(std::abs(y[k] - y[k - 1]));
      last = k;
    }
    const std::vector<double> some = sample_of(y, kMostChanges / 10);
    all.insert(all.end(), some.begin(), some.end());
  }
  constexpr std::size_t kFewestChanges = 50;
  constexpr double kLongest = 200.0;
  if (gaps.size() < kFewestChanges) return 1.0;
  const double typical = stats::thinned_quantile(gaps, 0.5);
  if (typical < 2.0 || typical > kLongest) return 1.0;
  // A slow coarse position also repeats its value, but then it changes by single steps.
  if (stats::thinned_quantile(changes, 0.5) < 2.5 * quantum(all)) return 1.0;
  double sum = 0.0;
  std::size_t single = 0;
  std::size_t early = 0;
  for (const double g : gaps) {
    if (g < typical - 1.0) ++early;
    if (std::abs(g - typical) > 1.0) continue;
    sum += g;
    ++single;
  }
  if (early * 50 > gaps.size() || single * 10 < gaps.size() * 6) return 1.0;
  const double hold = sum / static_cast<double>(single);
  return std::abs(hold - std::round(hold)) < 0.02 ? std::round(hold) : hold;
}

void measure(const std::vector<Table>& tables, Sampling& s) {
  std::vector<double> x;
  std::vector<double> v;
  std::vector<double> f;
  constexpr std::size_t kMost = 20000;
  const std::size_t each =
      std::max<std::size_t>(kFewestRows, kMost / std::max<std::size_t>(1, tables.size()));
  double noise_x = 0.0;
  double noise_v = 0.0;
  double noise_f = 0.0;
  double weight = 0.0;
  for (const Table& m : tables) {
    const auto add = [&](const std::vector<double>& from, std::vector<double>& to) {
      const std::vector<double> some = sample_of(from, each);
      to.insert(to.end(), some.begin(), some.end());
    };
    add(m.x, x);
    add(m.v, v);
    add(m.f, f);
    const auto w = static_cast<double>(m.rows());
    const auto noise = [&](const std::vector<double>& y) {
      const std::vector<double> some = sample_of(y, each);
      return some.size() > 20 ? w * std::pow(position_noise(some), 2.0) : 0.0;
    };
    noise_x += noise(m.x);
    noise_v += noise(m.v);
    noise_f += noise(m.f);
    weight += w;
  }
  s.x_quantum = quantum(x);
  s.x_quantum_large = s.x_quantum;
  // Numbers printed with few digits have larger steps where they are large.
  std::vector<double> decade;
  double largest = 0.0;
  for (const double value : x) largest = std::max(largest, std::abs(value));
  for (double top = largest; top > 1e-6 * largest && top > 0.0; top /= 10.0) {
    decade.clear();
    const double power = std::pow(10.0, std::floor(std::log10(top)));
    for (const double value : x) {
      if (std::abs(value) >= power && std::abs(value) < 10.0 * power) decade.push_back(value);
    }
    if (decade.size() * 20 > x.size()) s.x_quantum_large = std::max(s.x_quantum_large, quantum(decade));
  }
  s.v_quantum = quantum(v);
  s.f_quantum = quantum(f);
  s.x_noise = std::sqrt(noise_x / weight);
  s.v_noise = std::sqrt(noise_v / weight);
  s.f_noise = std::sqrt(noise_f / weight);
}

}  // namespace parts
}  // namespace stribeck::ident::log
