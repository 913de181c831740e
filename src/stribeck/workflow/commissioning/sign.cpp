#include <algorithm>
#include <cmath>

#include <stribeck/workflow/commissioning/sign.hpp>

namespace stribeck::workflow::commissioning {
namespace {

constexpr double kSteps = 4.0;
constexpr double kLeast = 0.2e-6;  // [m]
constexpr double kScatter = 5.0;   // standard deviations
constexpr double kStarted = 1e-6;  // of the command [m]
constexpr std::size_t kLast = 10;  // rows

double smallest_step(const std::vector<double>& x) {
  double least = 0.0;
  for (std::size_t k = 1; k < x.size(); ++k) {
    const double step = std::abs(x[k] - x[k - 1]);
    if (step > 0.0 && (least == 0.0 || step < least)) least = step;
  }
  return least;
}

}  // namespace

SignTest judge_sign(const AxisRows& rows, double resolution) {
  SignTest out;
  const std::size_t n = rows.r.size();
  if (n < 2) return out;
  std::size_t start = 0;
  while (start < n && std::abs(rows.r[start] - rows.r.front()) < kStarted) ++start;
  if (start == n) return out;
  const std::size_t before = std::max<std::size_t>(start, 1);
  double mean = 0.0;
  for (std::size_t k = 0; k < before; ++k) mean += rows.x[k];
  mean /= static_cast<double>(before);
  double scatter = 0.0;
  for (std::size_t k = 0; k < before; ++k) scatter += (rows.x[k] - mean) * (rows.x[k] - mean);
  scatter = before > 2 ? std::sqrt(scatter / static_cast<double>(before - 1)) : 0.0;

  // Where the machine switched off, the command goes to where the axis is: rows behind the largest command do not count.
  const double top = *std::max_element(rows.r.begin(), rows.r.end());
  std::size_t last = n - 1;
  while (last > start && rows.r[last] < top - 0.1 * (top - rows.r.front())) --last;
  const std::size_t first = last + 1 - std::min(kLast, last - start + 1);
  for (std::size_t k = first; k <= last; ++k) out.moved += rows.x[k] - mean;
  out.moved /= static_cast<double>(last + 1 - first);
  for (std::size_t k = 0; k < n; ++k) {
    out.farthest = std::max(out.farthest, std::abs(rows.x[k] - mean));
    out.force = std::max(out.force, std::abs(rows.f[k] - rows.f.front()));
  }
  const double step = resolution > 0.0 ? resolution : smallest_step(rows.x);
  out.needed = std::max({kSteps * step, kLeast, kScatter * scatter});
  if (std::abs(out.moved) > out.needed) out.sign = out.moved > 0.0 ? Sign::kRight : Sign::kWrong;
  return out;
}

}  // namespace stribeck::workflow::commissioning
