// Values that a logger holds over several rows, and rows that it wrote while it was frozen.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stribeck/ident/log/condition_parts.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <utility>

namespace stribeck::ident::log::parts {
namespace {

constexpr std::size_t kMostMoves = 50000;

/// Rows in which a held column changes. Rows are predicted from their spacing, because the axis may rest for a while.
struct NewRows {
  std::vector<std::size_t> starts;
  std::vector<std::size_t> breaks;  ///< in starts: where the spacing changed; the last interval may be cut
};

/// The row near `about`, after row `last`, in which y changes; `about` itself where there is none.
std::ptrdiff_t change_near(const std::vector<double>& y, std::ptrdiff_t about, std::ptrdiff_t last,
                           std::ptrdiff_t slack) {
  const auto changed = [&](std::ptrdiff_t k) {
    return k > last && k < static_cast<std::ptrdiff_t>(y.size()) &&
           y[static_cast<std::size_t>(k)] != y[static_cast<std::size_t>(k) - 1];
  };
  for (std::ptrdiff_t d = 0; d <= slack; ++d) {
    if (changed(about + d)) return about + d;
    if (changed(about - d)) return about - d;
  }
  return about;
}

/// The same for a column with a new value every `hold` rows, from row `first` on.
NewRows new_rows(const std::vector<double>& y, double hold, std::size_t first) {
  NewRows out;
  const auto slack = static_cast<std::ptrdiff_t>(std::max(1.0, 0.25 * hold));
  double at = static_cast<double>(first);
  double origin = at;
  double steps = 0.0;
  while (static_cast<std::size_t>(at) < y.size()) {
    out.starts.push_back(static_cast<std::size_t>(at));
    const double expected = origin + (steps + 1.0) * hold;
    const std::ptrdiff_t found = change_near(y, static_cast<std::ptrdiff_t>(std::llround(expected)),
                                             static_cast<std::ptrdiff_t>(at), slack);
    if (std::abs(static_cast<double>(found) - expected) > 1.01) {
      origin = static_cast<double>(found);
      steps = 0.0;
      out.breaks.push_back(out.starts.size());
    } else {
      steps += 1.0;
    }
    at = static_cast<double>(found);
  }
  out.breaks.push_back(out.starts.empty() ? 0 : out.starts.size() - 1);
  return out;
}

/// New rows from `from` to `until` (not included), as a table with the time T between rows.
Table on_grid(const Table& m, const std::vector<std::size_t>& starts, std::size_t from, std::size_t until,
              double T) {
  Table s;
  s.source = m.source;
  s.run = m.run;
  s.sample_time = T;
  s.gap_before = m.gap_before || from > 0;
  for (std::size_t i = from; i < until; ++i) {
    const std::size_t k = starts[i];
    const std::size_t end = i + 1 < starts.size() ? starts[i + 1] : m.rows();
    s.t.push_back(m.t[starts[from]] + T * static_cast<double>(i - from));
    if (!m.x.empty()) s.x.push_back(m.x[k]);
    if (!m.r.empty()) s.r.push_back(m.r[k]);
    if (!m.v.empty()) s.v.push_back(m.v[k]);
    double sum = 0.0;
    for (std::size_t j = k; j < end; ++j) sum += m.f[j];
    s.f.push_back(sum / static_cast<double>(end - k));
    s.row.push_back(m.row[k]);
    s.mark.push_back(m.mark[k]);
  }
  return s;
}

/// "position every 4 rows, force every 2 rows"
std::string in_words(const Table& table, const Sampling& sampling) {
  std::string holds;
  const auto say = [&](const char* name, double h) {
    holds += fmt::format("{}{} every {:.4g} rows", holds.empty() ? "" : ", ", name, h);
  };
  if (!table.x.empty()) say("position", sampling.x_hold);
  if (!table.v.empty()) say("velocity", sampling.v_hold);
  say("force", sampling.f_hold);
  return holds;
}

}  // namespace

std::vector<Table> on_slow_grid(std::vector<Table> tables, Sampling& sampling, Notes& notes) {
  const bool position = !tables.front().x.empty();
  const double motion_hold = position ? sampling.x_hold : sampling.v_hold;
  const double hold = std::max(motion_hold, sampling.f_hold);
  if (hold < 1.5 || !notes.wanted("held")) return tables;
  const bool by_force = sampling.f_hold > motion_hold;
  const auto column = by_force ? &Table::f : position ? &Table::x : &Table::v;
  std::vector<Table> out;
  for (const Table& m : tables) {
    const std::vector<double>& y = m.*column;
    std::size_t first = 1;
    while (first < y.size() && y[first] == y[first - 1]) ++first;
    if (first >= y.size()) continue;
    const NewRows rows = new_rows(y, hold, first);
    std::size_t from = 0;
    for (const std::size_t until : rows.breaks) {
      Table s = on_grid(m, rows.starts, from, until, m.sample_time * hold);
      if (s.rows() > 0) out.push_back(std::move(s));
      from = until;
    }
  }
  notes.add("held", tables.front(), 0, true,
            fmt::format(
                "values are held over several rows (new: {}); records are on the grid of {:.4g} s, force as "
                "the mean over each interval",
                in_words(tables.front(), sampling), tables.front().sample_time * hold),
            {hold, tables.front().sample_time * hold});
  return out;
}

namespace {

/// Lengths of the runs of equal rows at velocities above `rest`, in ascending order.
std::vector<std::size_t> equal_runs(const Table& m, double rest) {
  std::vector<std::size_t> runs;
  for (std::size_t k = 1, length = 0; k <= m.rows(); ++k) {
    if (k < m.rows() && std::abs(m.v[k]) > rest && same_row(m, k, k - 1)) {
      ++length;
      continue;
    }
    if (length > 0) runs.push_back(length);
    length = 0;
  }
  std::sort(runs.begin(), runs.end());
  return runs;
}

/// Whether rows first to end, of equal values, are more than coarse channels repeat: next to them a row equals the one before with
/// probability p, and a log of n rows has n·p^rows such runs. Where p is not small it differs from speed to speed, and chance
/// makes more than one run of half the length.
bool beyond_chance(const Table& m, std::size_t first, std::size_t end, const std::vector<std::size_t>& runs) {
  constexpr double kOften = 0.2;
  constexpr std::ptrdiff_t kAlike = 3;
  constexpr std::size_t kAround = 200;
  constexpr double kRuns = 1e-4;
  double same = 1.0;  // Laplace: a share is never 0 for a few rows
  double seen = 2.0;
  const auto count = [&](std::size_t from, std::size_t to) {
    for (std::size_t k = std::max<std::size_t>(1, from); k < to; ++k) {
      same += same_row(m, k, k - 1) ? 1.0 : 0.0;
      seen += 1.0;
    }
  };
  count(first > kAround ? first - kAround : 1, first + 1);
  count(end, std::min(m.rows(), end + kAround));
  const auto rows = static_cast<double>(end - first - 1);
  const auto alike = runs.end() - std::lower_bound(runs.begin(), runs.end(), (end - first) / 2);
  if (same / seen > kOften && alike > kAlike) return false;
  return static_cast<double>(m.rows()) * std::pow(same / seen, rows) < kRuns;
}

std::string frozen_text(bool at_end, bool velocity_only, const std::string& jump) {
  if (at_end) return "every channel keeps its value while the axis moves: the logger had stopped; cut off";
  if (velocity_only)
    return "every channel keeps its value to the last digit while the axis moves: the logger was frozen; cut out";
  return fmt::format(
      "every channel keeps its value while the axis moves, the position then jumps by {}: the logger was frozen; cut out",
      jump);
}

}  // namespace

std::vector<Table> without_frozen(std::vector<Table> tables, double longest_hold, Notes& notes) {
  if (!notes.wanted("frozen")) return tables;
  std::vector<Table> out;
  const auto hold = static_cast<std::size_t>(std::ceil(longest_hold));
  const std::size_t shortest = std::max<std::size_t>(8, 3 * hold);
  const std::size_t look = std::max<std::size_t>(6, 3 * hold);
  for (Table& m : tables) {
    const std::vector<double>& y = m.motion();
    const bool velocity_only = m.x.empty();
    std::vector<double> moves;
    for (std::size_t k = 1; k < y.size(); k += std::max<std::size_t>(1, y.size() / kMostMoves)) {
      if (y[k] != y[k - 1]) moves.push_back(std::abs(y[k] - y[k - 1]));
    }
    if (moves.empty()) {
      out.push_back(std::move(m));
      continue;
    }
    const double step =
        std::max(m.x_step > 0.0 ? m.x_step : quantum(y), stats::thinned_quantile(moves, 0.05));
    const std::vector<std::size_t> runs =
        velocity_only ? equal_runs(m, 5.0 * step) : std::vector<std::size_t>();
    std::size_t from = 0;
    for (std::size_t k = 1; k < m.rows(); ++k) {
      if (m.f[k] != m.f[k - 1]) continue;
      std::size_t end = k;
      while (end < m.rows() && same_row(m, end, k - 1)) ++end;
      const std::size_t first = k - 1;  // last row with new values
      const std::size_t rows = end - k;
      const bool at_end = end == m.rows();
      k = std::max(k, end);
      if (rows < shortest || first < look) continue;
      bool frozen = false;
      // Each channel changes again in its own time slot.
      std::size_t fresh = end;
      while (fresh < m.rows() && fresh < end + hold && y[fresh] == y[first]) ++fresh;
      if (fresh == m.rows()) fresh = end;
      const double jump = at_end ? 0.0 : y[fresh] - y[first];
      if (velocity_only) {
        // Velocity, force and reference are constant to the last bit: at standstill, or by chance where both are coarse.
        frozen = std::abs(y[first]) > 5.0 * step && step > 0.0 && beyond_chance(m, first, end, runs);
      } else {
        const double speed = (y[first] - y[first - look]) / static_cast<double>(look);  // per row
        const double travel = speed * static_cast<double>(rows);
        if (!at_end) {
          frozen = std::abs(travel) > 10.0 * step && jump * travel > 0.0 &&
                   std::abs(jump) > 0.25 * std::abs(travel) &&
                   std::abs(jump) < 4.0 * std::abs(travel) + 10.0 * step &&
                   std::abs(jump) > 2.5 * std::abs(speed) * static_cast<double>(hold);
        } else if (first >= 3 * look) {
          const double before = (y[first - 2 * look] - y[first - 3 * look]) / static_cast<double>(look);
          frozen = std::abs(speed) > 0.7 * std::abs(before) && speed * before > 0.0 &&
                   std::abs(speed) * static_cast<double>(hold) > 5.0 * step && std::abs(travel) > 50.0 * step;
        }
      }
      if (!frozen) continue;
      notes.add_range("frozen", m, first, end - 1, true,
                      frozen_text(at_end, velocity_only, notes.travel(jump)),
                      {m.t[first], m.t[end - 1], jump});
      out.push_back(slice(m, from, first + 1));
      out.back().gap_before = m.gap_before || from > 0;
      from = at_end ? end : fresh;
      k = std::max(k, from);
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
