// Compares velocity and reference with the position: unit, direction, stuck channels.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/log/condition_parts.hpp>
#include <stribeck/ident/refused.hpp>

namespace stribeck::ident::log::parts {
namespace {

/// Slope of y over dx/dt and its scatter, over stretches so long that resolution does not matter.
struct Ratio {
  double slope = 0.0;
  double correlation = 0.0;
  std::size_t stretches = 0;
};

Ratio ratio_of(const std::vector<Table>& tables, double x_resolution, double v_resolution) {
  double xx = 0.0;
  double yy = 0.0;
  double xy = 0.0;
  Ratio out;
  for (const Table& m : tables) {
    double sum = 0.0;
    std::size_t first = 0;
    for (std::size_t k = 1; k < m.rows(); ++k) {
      sum += 0.5 * m.sample_time * (m.v[k - 1] + m.v[k]);
      const double travel = m.x[k] - m.x[first];
      const auto n = static_cast<double>(k - first);
      if (n < 8.0 || (k - first) % 4 != 0) continue;
      // Only once both have moved far beyond their resolution.
      const double least = 20.0 * x_resolution + 10.0 * v_resolution * m.sample_time * std::sqrt(n);
      if (std::abs(travel) < least && std::abs(sum) < least) {
        if (n > 2000.0) {
          sum = 0.0;
          first = k;
        }
        continue;
      }
      xx += travel * travel;
      yy += sum * sum;
      xy += travel * sum;
      ++out.stretches;
      sum = 0.0;
      first = k;
    }
  }
  if (xx > 0.0 && yy > 0.0) {
    out.slope = xy / xx;
    out.correlation = xy / std::sqrt(xx * yy);
  }
  return out;
}

/// Units that are often confused, with the factor between them.
struct Factor {
  double value;
  const char* reason;
};
constexpr std::array<Factor, 9> kFactors{{{1000.0, "mm for m, or ms for s"},
                                          {60.0, "per minute for per second"},
                                          {25.4, "mm for inch"},
                                          {2.0 * kPi, "rad for turns"},
                                          {180.0 / kPi, "degrees for rad"},
                                          {60000.0, "mm/min for m/s"},
                                          {16.666666666666668, "m/min for mm/s"},
                                          {9.549296585513721, "turns per minute for rad/s"},
                                          {360.0, "degrees for turns"}}};

/// " (as … would do)" where the factor belongs to two such units.
std::string reason_of(double by) {
  if (std::abs(by / 0.5 - 1.0) < 0.03)
    return " (as the diameter of a lathe would do; then give --map x=\"COLUMN 0.5 mm\")";
  std::string reason;
  for (const Factor& f : kFactors) {
    if (std::abs(by / f.value - 1.0) < 0.03) reason = fmt::format(" (as {} would do)", f.reason);
    if (std::abs(by * f.value - 1.0) < 0.03)
      reason = fmt::format(" (perhaps the two units are exchanged: {})", f.reason);
  }
  return reason;
}

}  // namespace

/// Position from velocity where the log has none; starts at 0.
void integrate_velocity(std::vector<Table>& tables, bool reference) {
  double at = 0.0;
  for (Table& m : tables) {
    const std::vector<double>& rate = reference ? m.r : m.v;
    std::vector<double> positions(rate.size());
    if (reference) at = m.x.front();
    for (std::size_t k = 0; k < rate.size(); ++k) {
      if (k > 0) at += 0.5 * m.sample_time * (rate[k - 1] + rate[k]);
      positions[k] = at;
    }
    (reference ? m.r : m.x) = std::move(positions);
  }
}

void check_velocity(std::vector<Table>& tables, const Sampling& sampling, Notes& notes) {
  if (tables.front().v.empty() || tables.front().x.empty()) return;
  const auto drop = [&] {
    for (Table& m : tables) m.v.clear();
  };
  if (constant(tables, &Table::v)) {
    notes.add_all(
        "stuck", tables.front().source, true,
        fmt::format("the velocity keeps the value {:.6g} in every row; not used", tables.front().v.front()));
    drop();
    return;
  }
  const Ratio r =
      ratio_of(tables, sampling.x_quantum_large > 0.0 ? sampling.x_quantum_large : sampling.x_noise,
               std::max(sampling.v_quantum, sampling.v_noise));
  if (r.stretches < 5) return;
  if (std::abs(r.correlation) < 0.6) {
    if (!notes.wanted("velocity")) return;
    notes.add_all(
        "velocity", tables.front().source, true,
        fmt::format("the velocity is not the rate of the position (correlation {:.2f}): rows are missing "
                    "everywhere, or one of the two is another signal; velocity not used",
                    r.correlation),
        {r.correlation});
    drop();
    return;
  }
  if (std::abs(r.correlation) < 0.95) return;
  if (r.slope < 0.0 && std::abs(r.slope + 1.0) < 0.1) {
    if (!notes.wanted("velocity")) return;
    notes.add_all(
        "velocity", tables.front().source, true,
        fmt::format("the velocity has the opposite sign of the rate of the position ({:.4f} of it); reversed",
                    r.slope),
        {r.slope});
    for (Table& m : tables) {
      for (double& v : m.v) v = -v;
    }
    return;
  }
  if (std::abs(r.slope - 1.0) < 0.1) return;
  if (!notes.wanted("velocity")) return;
  throw Refused(
      tables.front().source +
      fmt::format(
          ": the velocity is {:.4g} times the rate of the position{}: the unit of velocity, position or "
          "time is wrong, and the log does not say which. Give the right one (--map v=\"COLUMN UNIT\"), "
          "or leave the velocity out (--keep velocity)",
          r.slope, reason_of(std::abs(r.slope))));
}

void check_reference(std::vector<Table>& tables, Notes& notes) {
  if (tables.front().r.empty() || !notes.wanted("reference")) return;
  const auto drop = [&](const std::string& why, double value) {
    notes.add_all("reference", tables.front().source, true, why + "; not used", {value});
    for (Table& m : tables) m.r.clear();
  };
  if (constant(tables, &Table::r)) return drop("the reference never changes", 0.0);
  double sx = 0.0;
  double sr = 0.0;
  double n = 0.0;
  for (const Table& m : tables) {
    sx += std::accumulate(m.x.begin(), m.x.end(), 0.0);
    sr += std::accumulate(m.r.begin(), m.r.end(), 0.0);
    n += static_cast<double>(m.rows());
  }
  double xx = 0.0;
  double rr = 0.0;
  double xr = 0.0;
  for (const Table& m : tables) {
    for (std::size_t k = 0; k < m.rows(); ++k) {
      const double x = m.x[k] - sx / n;
      const double r = m.r[k] - sr / n;
      xx += x * x;
      rr += r * r;
      xr += x * r;
    }
  }
  if (!(xx > 0.0) || !(rr > 0.0)) return;
  const double correlation = xr / std::sqrt(xx * rr);
  const double slope = xr / xx;
  if (std::abs(correlation) < 0.3)
    return drop(
        fmt::format("the reference has little to do with the position (correlation {:.2f})", correlation),
        correlation);
  if (std::abs(correlation) > 0.95 && (slope < 0.5 || slope > 2.0))
    return drop(
        fmt::format(
            "the reference moves {:.4g} times as far as the position: one of the units or signs is wrong",
            slope),
        slope);
}

}  // namespace stribeck::ident::log::parts
