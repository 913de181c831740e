#include <algorithm>
#include <cmath>
#include <stribeck/ident/log/motion.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/replay/replay_loop.hpp>
#include <stribeck/ident/stats/order.hpp>

namespace stribeck::ident::replay {
namespace {

constexpr std::size_t kRemembered = 65;  // rows; replay_controller.hpp averages 64 at most
constexpr double kAgrees =
    0.01;  // of the RMS of the force: the median row, where the controller is the right one
constexpr double kAdded = 10.0;        // median differences: what somebody added
constexpr double kWorthSaying = 0.02;  // of the force

double root_mean(double sum, std::size_t n) { return n > 0 ? std::sqrt(sum / static_cast<double>(n)) : 0.0; }

}  // namespace

ControllerCheck check_controller(const ReplayController& controller, const log::Record& record) {
  if (record.r.empty())
    throw Refused(record.source + ": no reference in the log, which a closed-loop replay follows");
  const std::size_t n = record.x.size();
  ControlLoop loop(controller, record, start_of(record, 0, log::position_noise(record.x)));
  // A controller remembers positions from before the first row, which nobody knows.
  const std::size_t unknown = std::min(kRemembered, n / 10);
  std::vector<double> apart(n), size(n);
  double dd = 0.0, ff = 0.0;
  for (std::size_t k = 0; k < n; ++k) {
    apart[k] = record.f[k] - loop.force(k, record.x);
    if (k < unknown) apart[k] = 0.0;
    size[k] = std::abs(apart[k]);
    dd += apart[k] * apart[k];
    ff += record.f[k] * record.f[k];
  }
  ControllerCheck out;
  if (!(ff > 0.0)) return out;
  out.relative = std::sqrt(dd / ff);
  const double force = root_mean(ff, n);
  const double median = stats::median(size);
  if (!(median < kAgrees * force) || !(out.relative > kWorthSaying)) return out;
  const double least = std::max(kAdded * median, kAgrees * force);
  out.added.assign(n, 0.0);
  std::size_t rows = 0;
  double sum = 0.0;
  for (std::size_t k = 0; k < n; ++k) {
    if (size[k] <= least) continue;
    out.added[k] = apart[k];
    sum += apart[k] * apart[k];
    ++rows;
  }
  out.added_share = static_cast<double>(rows) / static_cast<double>(n);
  out.added_rms = root_mean(sum, rows);
  return out;
}

}  // namespace stribeck::ident::replay
