// The reference was logged as position: it is the same in every row, or smoother than any loop could make it.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stribeck/ident/log/faults/faults.hpp>
#include <stribeck/ident/stats/order.hpp>

namespace stribeck::ident::log::parts {
namespace {

constexpr std::size_t kWindow = 64;
constexpr std::size_t kDegree = 5;
constexpr std::size_t kFewestWindows = 12;
constexpr double kChanges = 0.01;  ///< of the travel at top speed
/// A loop cannot be faster than its sampling: a force that changes by Δf from row to row comes from a position that moved by more than
/// Δf·T²/m. Sensors of the current have noise of their own, which no position shows.
constexpr double kFarTooSmooth = 0.01;

using Basis = std::array<std::array<double, kWindow>, kDegree + 1>;

/// Orthonormal polynomials over a window.
Basis polynomials() {
  Basis q{};
  for (std::size_t d = 0; d <= kDegree; ++d) {
    for (std::size_t i = 0; i < kWindow; ++i)
      q[d][i] = std::pow(2.0 * static_cast<double>(i) / (kWindow - 1.0) - 1.0, static_cast<double>(d));
    for (std::size_t e = 0; e <= d; ++e) {
      double sum = 0.0;
      for (std::size_t i = 0; i < kWindow; ++i) sum += q[d][i] * q[e][i];
      for (std::size_t i = 0; i < kWindow; ++i)
        q[d][i] = e < d ? q[d][i] - sum * q[e][i] : q[d][i] / std::sqrt(sum);
    }
  }
  return q;
}

/// RMS of what a polynomial leaves of the window that begins at row k.
double roughness(const std::vector<double>& y, std::size_t k, const Basis& q) {
  std::array<double, kWindow> rest{};
  for (std::size_t i = 0; i < kWindow; ++i) rest[i] = y[k + i] - y[k];
  for (const auto& p : q) {
    double sum = 0.0;
    for (std::size_t i = 0; i < kWindow; ++i) sum += p[i] * rest[i];
    for (std::size_t i = 0; i < kWindow; ++i) rest[i] -= sum * p[i];
  }
  double square = 0.0;
  for (const double r : rest) square += r * r;
  return std::sqrt(square / kWindow);
}

/// Rows in which the reference moves, and those of them in which the position has the same value.
struct SameRows {
  std::size_t moving = 0, same = 0;
};
SameRows rows_on_reference(const std::vector<Table>& tables) {
  SameRows out;
  for (const Table& m : tables) {
    if (m.r.size() != m.x.size()) continue;
    for (std::size_t k = 1; k < m.rows(); ++k) {
      if (m.r[k] == m.r[k - 1]) continue;
      ++out.moving;
      out.same += m.x[k] == m.r[k] ? 1 : 0;
    }
  }
  return out;
}

}  // namespace

void name_commanded_position(const std::vector<Table>& tables, const RoughFit& rough, Notes& notes) {
  constexpr std::size_t kFewestSame = 200;
  const SameRows rows = rows_on_reference(tables);
  if (notes.wanted("commanded") && rows.same >= kFewestSame && 20 * rows.same >= 19 * rows.moving) {
    notes.add_all(
        "commanded", tables.front().source, false,
        fmt::format(
            "the position has the value of its reference in {} of {} rows in which that moves, and no loop follows so exactly: the "
            "command was logged twice, or the axis is simulated by the control; friction at reversals, pre-sliding and the "
            "shift of the force are then wrong: map the column of the actual position (--map x=…)",
            rows.same, rows.moving),
        {static_cast<double>(rows.same), static_cast<double>(rows.moving)});
    return;
  }
  if (!notes.wanted("too-smooth")) return;
  if (!rough.good || !rough.mass_shows || !(rough.mass > 0.0)) return;
  const Basis q = polynomials();
  double fastest = 0.0;
  for (const Table& m : tables) {
    for (std::size_t k = 0; k + kWindow < m.rows(); k += kWindow)
      fastest = std::max(fastest, std::abs(m.x[k + kWindow] - m.x[k]));
  }
  std::vector<double> positions, forces;
  double period = 0.0;
  for (const Table& m : tables) {
    if (!m.r.empty()) return;
    period = m.sample_time;
    for (std::size_t k = 0; k + kWindow < m.rows(); k += kWindow) {
      // At a constant speed a coarse encoder may count the same in every row.
      const double middle = m.x[k + kWindow / 2];
      if (std::abs(m.x[k + kWindow] - 2.0 * middle + m.x[k]) < kChanges * fastest) continue;
      positions.push_back(roughness(m.x, k, q));
      forces.push_back(roughness(m.f, k, q));
    }
  }
  if (positions.size() < kFewestWindows) return;
  // A programme has corners, at which no polynomial fits.
  const double position = stats::quantile(std::move(positions), 0.25);
  const double force = stats::median(std::move(forces));
  if (!(position < kFarTooSmooth * force * period * period / rough.mass)) return;
  notes.add_all(
      "too-smooth", tables.front().source, false,
      fmt::format(
          "the position looks like a reference: it is smooth to {} while the force changes, which "
          "no measured position is; mass and friction of a commanded motion are wrong: map the column "
          "of the actual position (--map x=…), and this one as r",
          notes.travel(position)),
      {position, force});
}

}  // namespace stribeck::ident::log::parts
