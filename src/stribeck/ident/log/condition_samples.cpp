// Repairs single wild samples, and cuts out jumps of the position and stuck force.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stribeck/ident/log/condition_parts.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <utility>

namespace stribeck::ident::log::parts {
namespace {

double middle_of(std::array<double, 4> a) {
  std::sort(a.begin(), a.end());
  return 0.5 * (a[1] + a[2]);
}

/// Distance of a sample from its neighbours, and difference of the neighbours among themselves.
struct Off {
  double here = 0.0;
  double around = 0.0;
};

Off off_neighbours(const std::vector<double>& y, std::size_t k) {
  const std::size_t n = y.size();
  const std::size_t a = k < 2 ? (k == 0 ? 1 : 0) : k - 2;
  const std::size_t b = k < 2 ? (k == 0 ? 2 : 2) : k - 1;
  const std::size_t c = k + 2 < n ? k + 1 : (k + 1 < n ? k + 1 : k - 3);
  const std::size_t d = k + 2 < n ? k + 2 : (k + 1 < n ? k - 3 : k - 4);
  const std::array<double, 4> w{y[a], y[b], y[c], y[k < 2 ? 3 + k : d]};
  const auto [low, high] = std::minmax_element(w.begin(), w.end());
  return {y[k] - middle_of(w), *high - *low};
}

constexpr double kWild = 10.0;

/// Smallest distance from the neighbours at which a sample of this column is a spike; 0 where too few samples show it.
double spike_limit(const std::vector<Table>& tables, double resolution, std::vector<double> Table::*column) {
  std::vector<double> offs;
  for (const Table& m : tables) {
    const std::vector<double>& y = m.*column;
    const std::size_t stride = std::max<std::size_t>(1, y.size() / 20000);
    for (std::size_t k = 2; k + 2 < y.size(); k += stride) {
      const Off o = off_neighbours(y, k);
      if (o.here != 0.0 || o.around != 0.0) offs.push_back(std::abs(o.here));
    }
  }
  if (offs.size() < 50) return 0.0;
  const double limit = std::max(kWild * stats::thinned_quantile(offs, 0.995), 5.0 * resolution);
  if (column == &Table::x) return limit;
  // The neighbours of a spike must agree. A short push of a controller can look like a spike; a value far outside all others cannot be one.
  std::vector<double> all;
  for (const Table& m : tables) {
    const std::vector<double> some = sample_of(m.*column, std::max<std::size_t>(200, 20000 / tables.size()));
    all.insert(all.end(), some.begin(), some.end());
  }
  return std::max(limit, 1.5 * (stats::thinned_quantile(all, 0.999) - stats::thinned_quantile(all, 0.001)));
}

struct Spike {
  Table* table;
  std::size_t row;
};

std::vector<Spike> find_spikes(std::vector<Table>& tables, double limit, std::vector<double> Table::*column) {
  std::vector<Spike> found;
  for (Table& m : tables) {
    const std::vector<double>& y = m.*column;
    if (y.size() < 10) continue;
    for (std::size_t k = 0; k < y.size(); ++k) {
      // The cheap test first: a spike leaves and comes back.
      if (k > 0 && k + 1 < y.size() && std::abs(y[k] - y[k - 1]) < 0.5 * limit) continue;
      const Off o = off_neighbours(y, k);
      if (std::abs(o.here) <= limit || o.around > 0.3 * std::abs(o.here)) continue;
      found.push_back({&m, k});
    }
  }
  return found;
}

}  // namespace

void mend_spikes(std::vector<Table>& tables, double resolution, std::vector<double> Table::*column,
                 const char* name, Notes& notes) {
  if (!notes.wanted("spike") || (tables.front().*column).empty()) return;
  const double limit = spike_limit(tables, resolution, column);
  if (!(limit > 0.0)) return;
  const std::vector<Spike> found = find_spikes(tables, limit, column);
  std::size_t rows = 0;
  for (const Table& m : tables) rows += m.rows();
  // An event that occurs often belongs to the axis.
  if (found.empty() || found.size() * 1000 > rows + 3000) return;
  const Spike& first = found.front();
  const double first_value = (first.table->*column)[first.row];
  for (const auto& [m, k] : found) {
    std::vector<double>& y = m->*column;
    y[k] = k == 0 ? y[1] : k + 1 == y.size() ? y[k - 1] : 0.5 * (y[k - 1] + y[k + 1]);
    m->mark[k] |= kRepairedRow;
  }
  const double first_mended = (first.table->*column)[first.row];
  notes.add(
      "spike", *first.table, first.row, true,
      fmt::format("the {} is {:.6g} between neighbours of {:.6g}: edited or disturbed{}; replaced by its "
                  "neighbours",
                  name, first_value, first_mended,
                  found.size() > 1 ? fmt::format(", the first of {} such samples", found.size()) : ""),
      {first_value, first_mended, static_cast<double>(found.size())});
}

namespace {

/// Whether the position goes on, by more than the counts and the noise by which it changes to and fro at rest.
bool goes_on(const std::vector<double>& x, std::size_t first, std::size_t last) {
  constexpr double kCountsAtRest = 3.0;
  constexpr double kNoiseAtRest = 5.0;  // of white noise the ends differ by more than that once in a million
  double count = std::numeric_limits<double>::infinity();
  double squares = 0.0;
  for (std::size_t k = first + 1; k <= last; ++k) {
    const double step = std::abs(x[k] - x[k - 1]);
    if (step > 0.0) count = std::min(count, step);
    squares += step * step;
  }
  const double rms = std::sqrt(squares / static_cast<double>(last - first));
  return std::abs(x[last] - x[first]) > std::max(kCountsAtRest * count, kNoiseAtRest * rms);
}

}  // namespace

/// Force that keeps its value to the last bit while the axis accelerates.
std::vector<Table> cut_stuck_force(std::vector<Table> tables, double hold, Notes& notes) {
  if (!notes.wanted("stuck")) return tables;
  std::size_t same = 0;
  std::size_t rows = 0;
  for (const Table& m : tables) {
    for (std::size_t k = 1; k < m.rows(); ++k) same += m.f[k] == m.f[k - 1] ? 1 : 0;
    rows += m.rows();
  }
  if (same * 5 > rows) return tables;  // coarse or programmed: constant stretches are normal
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  double count = low;  // smallest step of the force
  for (const Table& m : tables) {
    for (std::size_t k = 1; k < m.rows(); ++k)
      if (m.f[k] != m.f[k - 1]) count = std::min(count, std::abs(m.f[k] - m.f[k - 1]));
    const auto [a, b] = std::minmax_element(m.f.begin(), m.f.end());
    low = std::min(low, *a);
    high = std::max(high, *b);
  }
  const auto shortest = static_cast<std::size_t>(50.0 * hold);
  // A programmed force rests between its ramps while the axis springs back; it changes in small steps before and after.
  constexpr double kSmallStep = 0.1;  // share of the whole range
  const auto within = [](const Table& m, std::size_t first, std::size_t last, double step) {
    const bool in = first == 0 || std::abs(m.f[first] - m.f[first - 1]) < step;
    return in && (last + 1 >= m.rows() || std::abs(m.f[last + 1] - m.f[last]) < step);
  };
  const auto programmed = [&](const Table& m, std::size_t first, std::size_t last) {
    return within(m, first, last, kSmallStep * (high - low)) && quiet(m.f);
  };
  // Coarse counts keep a force at constant speed; a channel that comes back has another one, by more than a count.
  constexpr double kNextCount = 1.5;
  const auto between_counts = [&](const Table& m, std::size_t first, std::size_t last) {
    return within(m, first, last, kNextCount * count);
  };
  std::vector<Table> out;
  for (Table& m : tables) {
    std::size_t from = 0;
    std::size_t begin = 0;
    for (std::size_t k = 1; k <= m.rows(); ++k) {
      if (k < m.rows() && m.f[k] == m.f[begin]) continue;
      const bool moves = k - begin > shortest && goes_on(m.x, begin, k - 1);
      const bool limit = m.f[begin] == low || m.f[begin] == high;
      if (moves && !limit && !programmed(m, begin, k - 1) && !between_counts(m, begin, k - 1)) {
        notes.add_range(
            "stuck", m, begin, k - 1, true,
            m.f[begin] == 0.0
                ? std::string(
                      "the force is exactly 0 while the axis moves: the drive was off, as after an emergency stop, or the "
                      "channel was stuck; cut out")
                : fmt::format(
                      "the force keeps the value {:.6g} to the last digit while the axis moves: the channel was "
                      "stuck; cut out",
                      m.f[begin]),
            {m.f[begin]});
        out.push_back(slice(m, from, begin + 1));
        out.back().gap_before = m.gap_before || from > 0;
        from = k;
      }
      begin = k;
    }
    if (from < m.rows()) {
      const bool whole = from == 0;
      out.push_back(whole ? std::move(m) : slice(m, from, m.rows()));
      if (from > 0) out.back().gap_before = true;
    }
  }
  return out;
}

}  // namespace stribeck::ident::log::parts
