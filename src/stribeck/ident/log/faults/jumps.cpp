// Jumps of the position or of its speed between two rows.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stribeck/ident/log/faults/faults.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <string>
#include <utility>

namespace stribeck::ident::log::parts {
namespace {

constexpr double kWildJump = 10.0;

/// Steps before and after row k and the one to it, of a column.
struct Step {
  double before = 0.0;
  double after = 0.0;
  double jump = 0.0;  ///< beyond their mean

  [[nodiscard]] double change() const { return after - before; }
};

Step step_to(const std::vector<double>& x, std::size_t k) {
  Step s;
  s.before = 0.5 * (x[k - 1] - x[k - 3]);
  s.after = 0.5 * (x[k + 2] - x[k]);
  s.jump = x[k] - x[k - 1] - 0.5 * (s.before + s.after);
  return s;
}

/// Largest acceleration that the motion shows, over eight rows so that noise has little part in it, times the square of the sample time.
double acceleration_of(const std::vector<Table>& tables) {
  constexpr std::size_t kReach = 4;
  std::vector<double> sizes;
  for (const Table& m : tables) {
    const std::size_t stride = std::max<std::size_t>(1, m.rows() / 20000);
    for (std::size_t k = kReach; k + kReach < m.rows(); k += stride)
      sizes.push_back(std::abs(m.x[k + kReach] - 2.0 * m.x[k] + m.x[k - kReach]) / (kReach * kReach));
  }
  return sizes.empty() ? 0.0 : stats::thinned_quantile(sizes, 0.999);
}

/// Above these a jump, or a change of speed from one row to the next, is no motion.
struct JumpLimits {
  double jump = 0.0;
  double change = 0.0;
};

JumpLimits jump_limits_of(const std::vector<Table>& tables, const Sampling& sampling) {
  std::vector<double> jumps;
  std::vector<double> changes;
  for (const Table& m : tables) {
    const std::size_t stride = std::max<std::size_t>(1, m.rows() / 20000);
    for (std::size_t k = 3; k + 2 < m.rows(); k += stride) {
      const Step s = step_to(m.x, k);
      if (s.jump != 0.0) jumps.push_back(std::abs(s.jump));
      if (s.change() != 0.0) changes.push_back(std::abs(s.change()));
    }
  }
  if (jumps.size() < 50) return {};
  // From rest to rest within a row takes an acceleration of four times the jump; thrice the largest one of the motion is an impact.
  constexpr double kImpact = 3.0 / 4.0;
  const double least =
      std::max({5.0 * sampling.x_quantum_large, 20.0 * sampling.x_noise, kImpact * acceleration_of(tables)});
  return {std::max(kWildJump * stats::thinned_quantile(jumps, 0.995), least),
          std::max(2.0 * kWildJump * stats::thinned_quantile(changes, 0.995), 2.0 * least)};
}

/// What happened before row k, or "".
std::string fault_at(const Table& m, std::size_t k, const JumpLimits& limits, const Notes& notes,
                     double& size) {
  const Step x = step_to(m.x, k);
  const bool jumps = std::abs(x.jump) > limits.jump && std::abs(x.change()) <= 0.3 * std::abs(x.jump);
  const Step r = m.r.empty() ? Step{} : step_to(m.r, k);
  size = x.jump;
  if (jumps) {
    const bool r_jumps = !m.r.empty() && std::abs(m.r[k] - m.r[k - 1]) > 0.5 * std::abs(x.jump);
    if (!r_jumps)
      return fmt::format(
          "the position jumps by {} without any change of speed: rows are missing or the "
          "encoder was set; cut there",
          notes.travel(x.jump));
    // An axis follows a step of its reference, but neither at once nor with the whole of it.
    const bool together =
        std::abs(r.change()) <= 0.3 * std::abs(r.jump) && std::abs(r.jump - x.jump) <= 0.1 * std::abs(x.jump);
    if (!together) return {};
    const double speed = 0.5 * (x.before + x.after);
    const double rows = std::abs(speed) > 0.0 ? x.jump / speed : 0.0;
    if (rows > 0.5 && rows < 1e6)
      return fmt::format(
          "position and reference jump together by {}: about {:.0f} rows are missing at this "
          "speed, although the time stamps go on, or both were set anew; cut there",
          notes.travel(x.jump), rows);
    return fmt::format("position and reference jump together by {}: both were set anew; cut there",
                       notes.travel(x.jump));
  }
  // Rows lost around a turn leave the position where it was.
  size = x.change();
  if (!(std::abs(x.change()) > limits.change)) return {};
  // Without a reference an axis that stops dead may have met something.
  const double slower = std::min(std::abs(x.before), std::abs(x.after));
  if (m.r.empty() && slower < 0.1 * std::max(std::abs(x.before), std::abs(x.after))) return {};
  // The motion must be even before and after: a jump inside a window looks like a change of speed.
  const double uneven = std::max(std::abs(m.x[k - 1] - 2.0 * m.x[k - 2] + m.x[k - 3]),
                                 std::abs(m.x[k + 2] - 2.0 * m.x[k + 1] + m.x[k]));
  if (uneven > 0.2 * std::abs(x.change())) return {};
  // The rows beside it see a part of it.
  if (k + 3 < m.rows() && std::abs(step_to(m.x, k + 1).change()) > std::abs(x.change())) return {};
  if (!m.r.empty() && std::abs(r.change() - x.change()) > 0.3 * std::abs(x.change())) return {};
  return fmt::format(
      "the speed changes from {}/s to {}/s from one row to the next{}: rows are missing, "
      "although the time stamps go on; cut there",
      notes.travel(x.before / m.sample_time), notes.travel(x.after / m.sample_time),
      m.r.empty() ? "" : ", and so does that of the reference");
}

}  // namespace

std::vector<Table> cut_at_jumps(std::vector<Table> tables, const Sampling& sampling, Notes& notes) {
  if (!notes.wanted("jump")) return tables;
  const JumpLimits limits = jump_limits_of(tables, sampling);
  if (!(limits.jump > 0.0)) return tables;
  std::vector<Table> out;
  for (Table& m : tables) {
    std::size_t from = 0;
    std::size_t found = 0;
    for (std::size_t k = 3; k + 2 < m.rows(); ++k) {
      double size = 0.0;
      const std::string what = fault_at(m, k, limits, notes, size);
      if (what.empty()) continue;
      if (found++ == 0) notes.add("jump", m, k, true, what, {size});
      out.push_back(slice(m, from, k));
      out.back().gap_before = m.gap_before || from > 0;
      from = k;
      k += 2;
    }
    const bool whole = from == 0;
    out.push_back(whole ? std::move(m) : slice(m, from, m.rows()));
    if (from > 0) out.back().gap_before = true;
  }
  return out;
}

}  // namespace stribeck::ident::log::parts
