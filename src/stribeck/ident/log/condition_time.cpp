// Cuts a table into pieces with regular time: repeated rows, stamps that stay or go back, gaps, jitter.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stribeck/ident/log/condition_parts.hpp>
#include <stribeck/ident/log/faults/faults.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <utility>

namespace stribeck::ident::log::parts {
namespace {

constexpr std::size_t kMostSteps = 50000;
constexpr std::size_t kRareRepeats = 20;  ///< one stamp in so many that stands still is a fault of the logger

/// Power of ten to which time stamps are rounded; 0 where they are not.
double rounding_of(const std::vector<double>& t) {
  const std::vector<double> some = sample_of(t, 2000);
  for (double q = 1.0; q > 1e-8; q /= 10.0) {
    const bool all = std::all_of(some.begin(), some.end(), [&](double x) {
      const double n = x / q;
      return std::abs(n - std::round(n)) < 1e-3;
    });
    if (all) return q;
  }
  return 0.0;
}

void erase_rows(Table& table, const std::vector<std::uint8_t>& gone) {
  const auto compact = [&](auto& column) {
    if (column.empty()) return;
    std::size_t to = 0;
    for (std::size_t k = 0; k < column.size(); ++k) {
      if (gone[k] == 0) column[to++] = column[k];
    }
    column.resize(to);
  };
  compact(table.x);
  compact(table.r);
  compact(table.v);
  compact(table.f);
  compact(table.row);
  compact(table.mark);
  compact(table.t);
}

/// Time on a straight line from the first stamp to the last.
void restamp(Table& m) {
  const double first = m.t.front();
  const double T = (m.t.back() - first) / static_cast<double>(m.rows() - 1);
  for (std::size_t k = 0; k < m.rows(); ++k) m.t[k] = first + T * static_cast<double>(k);
  m.sample_time = T;
}

/// Evenly spaced rows whose stamps are coarser than they are apart.
struct EvenRows {
  double first = 0.0;  ///< time of the first row
  double step = 0.0;
  std::size_t rows = 0;  ///< that the step was found from

  [[nodiscard]] double at(std::size_t k) const { return first + step * static_cast<double>(k); }
};

/// From the first change of the stamp to the last one: the first and the last stamp may hold a part of their rows only.
/// Nothing where no whole stamp lies between.
std::optional<EvenRows> rows_between_changes(const std::vector<double>& t) {
  std::size_t from = 1;
  while (from < t.size() && t[from] == t[from - 1]) ++from;
  std::size_t to = t.size() - 1;
  while (to > 0 && t[to] == t[to - 1]) --to;
  if (to <= from) return std::nullopt;
  EvenRows even;
  even.rows = to - from;
  even.step = (t[to] - t[from]) / static_cast<double>(even.rows);
  even.first = t[from] - even.step * static_cast<double>(from);
  return even;
}

double largest_off(const EvenRows& even, const std::vector<double>& t) {
  double worst = 0.0;
  for (std::size_t k = 0; k < t.size(); ++k) worst = std::max(worst, std::abs(t[k] - even.at(k)));
  return worst;
}

/// Resamples to a regular grid that starts at the first stamp: positions and velocities are interpolated, the force is averaged.
Table resampled(const Table& m, double T) {
  Table out;
  out.source = m.source;
  out.run = m.run;
  out.gap_before = m.gap_before;
  out.sample_time = T;
  out.x_step = quantum(m.motion());
  const auto n = static_cast<std::size_t>(std::floor((m.t.back() - m.t.front()) / T * (1.0 + 1e-9))) + 1;
  std::size_t hx = 0;
  std::size_t hr = 0;
  std::size_t hv = 0;
  std::size_t hf = 0;
  std::size_t nearest = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const double at = std::min(m.t.front() + T * static_cast<double>(k), m.t.back());
    out.t.push_back(m.t.front() + T * static_cast<double>(k));
    if (!m.x.empty()) out.x.push_back(on_line(m.t, m.x, at, hx));
    if (!m.r.empty()) out.r.push_back(on_line(m.t, m.r, at, hr));
    if (!m.v.empty()) out.v.push_back(on_line(m.t, m.v, at, hv));
    out.f.push_back(hold_mean(m.t, m.f, at, at + T, hf));
    while (nearest + 1 < m.rows() && std::abs(m.t[nearest + 1] - at) <= std::abs(m.t[nearest] - at))
      ++nearest;
    out.row.push_back(m.row[nearest]);
    out.mark.push_back(m.mark[nearest]);
  }
  return out;
}

/// Removes rows that occur twice, because loggers pad their last block.
void drop_repeated_rows(Table& m, Notes& notes) {
  std::vector<std::uint8_t> gone(m.rows(), 0);
  std::size_t found = 0;
  std::size_t first = 0;
  std::size_t stamps = 0;
  for (std::size_t k = 1; k < m.rows(); ++k) {
    if (m.t[k] != m.t[k - 1]) continue;
    ++stamps;
    if (!same_row(m, k, k - 1)) continue;
    gone[k] = 1;
    if (found++ == 0) first = k;
  }
  // Of stamps that are coarser than the rows many stand still, and at standstill the rows are equal too.
  if (found == 0 || (stamps - found) * kRareRepeats > m.rows()) return;
  notes.add("double-time", m, first, true,
            fmt::format("{} rows repeat the row before them, time included; left out", found),
            {static_cast<double>(found)});
  erase_rows(m, gone);
}

struct Repeats {
  std::size_t first;  ///< row
  std::size_t rows;   ///< that repeat the stamp before them
  std::size_t back;   ///< times that the time goes back
};

/// Makes rows even whose stamps are coarser than they are apart. The stamps do not show how many rows
/// were lost within one of them: mend_lost_rows() shortens the step later.
void restamp_coarse(Table& m, const Repeats& repeats, Notes& notes) {
  const double step = m.t.back() > m.t.front() ? rounding_of(m.t) : 0.0;
  const auto even = rows_between_changes(m.t);
  if (repeats.back == 0 && step > 0.0 && !even) {
    throw Refused(
        m.source +
        fmt::format(": column t, row {}: the time stamps are coarser ({:.3g} s) than the rows are apart, and "
                    "the log holds no whole one, so that the time between rows is not known (give it "
                    "with --sample-time)",
                    m.row[repeats.first], step));
  }
  if (repeats.back > 0 || !(step > 0.0) || largest_off(*even, m.t) > 1.01 * step + 2.0 * even->step) {
    throw Refused(m.source + fmt::format(": column t, row {}: time stands still in {} of {} rows and the "
                                         "rows are not equally spaced between (name another time column, or "
                                         "give the sample time with --sample-time)",
                                         m.row[repeats.first], repeats.rows, m.rows()));
  }
  for (std::size_t k = 0; k < m.rows(); ++k) m.t[k] = even->at(k);
  m.sample_time = even->step;
  m.counted = true;
  notes.add(
      "rounded-time", m, repeats.first, true,
      fmt::format(
          "the time stamps are coarser ({:.3g} s) than the rows are apart; equally spaced rows of {:.6g} s "
          "assumed, counted over {} rows; rows that the control did not write would make all speeds "
          "wrong: give the time between rows with --sample-time if you know it",
          step, even->step, even->rows),
      {step, even->step});
}

/// Repairs stamps that do not change. Returns the table with times that only increase or go back.
void mend_double_stamps(Table& m, Notes& notes) {
  std::size_t twice = 0;
  std::size_t back = 0;
  std::size_t first = 0;
  for (std::size_t k = 1; k < m.rows(); ++k) {
    if (m.t[k] == m.t[k - 1] && twice++ == 0) first = k;
    if (m.t[k] < m.t[k - 1]) ++back;
  }
  if (twice == 0) return;
  if (twice * kRareRepeats > m.rows()) {
    restamp_coarse(m, {first, twice, back}, notes);
    return;
  }
  const double T = median_step(m.t);
  std::vector<std::uint8_t> gone(m.rows(), 0);
  std::size_t dropped = 0;
  std::size_t moved = 0;
  for (std::size_t k = 1; k < m.rows(); ++k) {
    if (m.t[k] != m.t[k - 1]) continue;
    const bool hole_after = k + 1 < m.rows() && m.t[k + 1] - m.t[k] > kGap * T;
    if (!same_row(m, k, k - 1) && hole_after) {
      m.t[k] += 0.5 * (m.t[k + 1] - m.t[k]);
      ++moved;
    } else {
      gone[k] = 1;
      ++dropped;
    }
  }
  notes.add(
      "double-time", m, first, true,
      fmt::format("{} time stamps occur twice; {} rows left out, {} time stamps interpolated between their "
                  "neighbours",
                  twice, dropped, moved),
      {static_cast<double>(twice)});
  erase_rows(m, gone);
}

/// Where a piece is cut: the first rows of its parts, followed by the number of all rows.
struct Gaps {
  std::vector<std::size_t> starts{0};
  double step = 0.0;     ///< median step [s]
  double widest = 0.0;   ///< [s]
  std::size_t kept = 0;  ///< rows in parts that are long enough

  [[nodiscard]] std::size_t count() const { return starts.size() - 2; }
};

Gaps find_gaps(const Table& piece, Sampling& sampling) {
  Gaps gaps;
  gaps.step = median_step(piece.t);
  for (std::size_t k = 1; k < piece.rows(); ++k) {
    const double step = piece.t[k] - piece.t[k - 1];
    if (step > kGap * gaps.step) {
      gaps.starts.push_back(k);
      gaps.widest = std::max(gaps.widest, step);
    } else {
      sampling.jitter = std::max(sampling.jitter, std::abs(step / gaps.step - 1.0));
    }
  }
  gaps.starts.push_back(piece.rows());
  for (std::size_t i = 1; i < gaps.starts.size(); ++i) {
    if (gaps.starts[i] - gaps.starts[i - 1] >= kFewestRows) gaps.kept += gaps.starts[i] - gaps.starts[i - 1];
  }
  return gaps;
}

/// The case of rows without any regular time: equal steps are assumed.
Table with_assumed_steps(Table piece, Sampling& sampling, Notes& notes) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < piece.rows(); ++k) steps.push_back(piece.t[k] - piece.t[k - 1]);
  const double shortest = stats::thinned_quantile(steps, 0.02);
  const double longest = stats::thinned_quantile(steps, 0.98);
  restamp(piece);
  notes.add("irregular", piece, 0, true,
            fmt::format(
                "the rows were taken at irregular times (steps of {:.3g} to {:.3g} s); equal steps of {:.4g} "
                "s are assumed: force over position at rest is right, speeds, acceleration and delay "
                "are not",
                shortest, longest, piece.sample_time),
            {shortest, longest});
  sampling.jitter = std::max(sampling.jitter, longest / piece.sample_time - 1.0);
  return piece;
}

/// When a logger is stopped it writes one more row, too early. Among stamps that jitter an early one is none.
Table without_early_last_row(Table part, double T, Notes& notes) {
  if (part.rows() <= kFewestRows || part.t.back() - part.t[part.rows() - 2] >= 0.9 * T ||
      usual_jitter(part.t, T) > kLeastJitter || !notes.wanted("jitter"))
    return part;
  notes.add("jitter", part, part.rows() - 1, true,
            fmt::format("the last row comes {:.3g} s after the one before, {:.4g} s is usual; left out",
                        part.t.back() - part.t[part.rows() - 2], T));
  Table out = slice(part, 0, part.rows() - 1);
  out.gap_before = part.gap_before;
  return out;
}

/// Makes the steps equal: rounded stamps are put on a line, rows at uneven times are resampled.
Table with_equal_steps(Table part, double T, Notes& notes) {
  double worst = 0.0;
  std::size_t where = 0;
  const double mean = (part.t.back() - part.t.front()) / static_cast<double>(part.rows() - 1);
  for (std::size_t k = 1; k < part.rows(); ++k) {
    const double off = std::abs((part.t[k] - part.t[k - 1]) / mean - 1.0);
    if (off > worst) {
      worst = off;
      where = k;
    }
  }
  part.sample_time = mean;
  if (!(worst > kJitter)) return part;
  const double step = rounding_of(part.t);
  if (step > 0.0 && largest_off_line(part.t) <= 1.01 * step && step < mean) {
    restamp(part);
    notes.add(
        "rounded-time", part, where, true,
        fmt::format("the time stamps are rounded to {:.3g} s ({:.3g} % of a step); equally spaced rows of "
                    "{:.6g} s assumed",
                    step, 100.0 * step / mean, part.sample_time),
        {step, part.sample_time});
    return part;
  }
  if (taken_evenly(part) && notes.wanted("jitter")) {
    restamp(part);
    notes.add(
        "jitter", part, where, true,
        fmt::format("the time stamps jitter by up to {:.3g} % of a step, but the motion is that of equally "
                    "spaced rows: rows of {:.6g} s assumed",
                    100.0 * worst, part.sample_time),
        {worst});
    return part;
  }
  notes.add("jitter", part, where, true,
            fmt::format(
                "the rows are not equally spaced (a step of {:.4g} s here, {:.4g} s is usual); resampled by "
                "linear interpolation, which smooths everything faster than a few rows",
                part.t[where] - part.t[where - 1], T),
            {worst});
  return resampled(part, mean);
}

void note_gaps(const Table& piece, const Gaps& gaps, Notes& notes) {
  const std::size_t k = gaps.starts[1];
  std::string sentence = fmt::format("a gap of {:.4g} s before this row (the rows are {:.4g} s apart)",
                                     piece.t[k] - piece.t[k - 1], gaps.step);
  if (gaps.count() > 1)
    sentence += fmt::format(", the first of {}, the longest {:.4g} s", gaps.count(), gaps.widest);
  notes.add("gap", piece, k, true, sentence + "; cut there", {piece.t[k] - piece.t[k - 1]});
}

/// The case of a piece whose time does not go back: cuts it at gaps and makes its time regular.
void cut_at_gaps(Table piece, Sampling& sampling, Notes& notes, std::vector<Table>& out) {
  bridge_short_gaps(piece, sampling, notes);
  const Gaps gaps = find_gaps(piece, sampling);
  const bool many = gaps.count() > 0;
  if (many && gaps.kept * 2 < piece.rows() && gaps.starts.size() * 20 > piece.rows() &&
      notes.wanted("irregular")) {
    out.push_back(with_assumed_steps(std::move(piece), sampling, notes));
    return;
  }
  sampling.gaps += gaps.count();
  if (many && gaps.kept * 5 < piece.rows() * 4 && gaps.widest < 3.5 * gaps.step) {
    notes.add(
        "gap", piece, gaps.starts[1], true,
        fmt::format(
            "{} single rows are missing, too many to cut the record there; interpolated by straight lines",
            gaps.count()),
        {static_cast<double>(gaps.count())});
    piece.sample_time = gaps.step;
    out.push_back(resampled(piece, gaps.step));
    return;
  }
  if (many) note_gaps(piece, gaps, notes);
  for (std::size_t i = 1; i < gaps.starts.size(); ++i) {
    Table part = many ? slice(piece, gaps.starts[i - 1], gaps.starts[i]) : std::move(piece);
    part.gap_before = i > 1;
    if (part.rows() < 2) {
      part.sample_time = gaps.step;
      out.push_back(std::move(part));
      continue;
    }
    out.push_back(
        with_equal_steps(without_early_last_row(std::move(part), gaps.step, notes), gaps.step, notes));
  }
}

}  // namespace

double median_step(const std::vector<double>& t) {
  std::vector<double> steps;
  const std::size_t stride = std::max<std::size_t>(1, t.size() / kMostSteps);
  for (std::size_t k = 1; k < t.size(); k += stride) steps.push_back(t[k] - t[k - 1]);
  return stats::thinned_quantile(std::move(steps), 0.5);
}

std::vector<Table> regular_pieces(Table m, Sampling& sampling, Notes& notes) {
  sampling.rows += m.rows();
  drop_repeated_rows(m, notes);
  mend_double_stamps(m, notes);
  mend_jittering_stamps(m, notes);
  std::vector<std::size_t> starts{0};
  for (std::size_t k = 1; k < m.rows(); ++k) {
    if (m.t[k] < m.t[k - 1]) starts.push_back(k);
  }
  starts.push_back(m.rows());
  if (starts.size() > 2) {
    const std::size_t k = starts[1];
    const double T = median_step(m.t);
    for (std::size_t i = 1; i < starts.size(); ++i) {
      // A new record begins far back in time; two exchanged stamps do not.
      const bool far = i + 1 == starts.size() || m.t[starts[i] - 1] - m.t[starts[i]] > 50.0 * T;
      if (far && starts[i] - starts[i - 1] >= kFewestRows) continue;
      throw Refused(
          m.source +
          fmt::format(
              ": column t, row {}: time goes back, from {:.15g} to {:.15g} s, expected it to increase (cut the log there, or repair the time column)",
              m.row[k], m.t[k - 1], m.t[k]));
    }
    notes.add(
        "time-back", m, k, true,
        fmt::format("time goes back, from {:.15g} to {:.15g} s{}; taken as a new record", m.t[k - 1], m.t[k],
                    starts.size() > 3 ? fmt::format(" (the first of {} times)", starts.size() - 2) : ""),
        {static_cast<double>(starts.size() - 2)});
  }
  std::vector<Table> out;
  for (std::size_t i = 1; i < starts.size(); ++i) {
    Table piece = starts.size() > 2 ? slice(m, starts[i - 1], starts[i]) : std::move(m);
    sampling.duration += piece.t.back() - piece.t.front();
    sampling.logged_time = median_step(piece.t);
    cut_at_gaps(std::move(piece), sampling, notes, out);
    if (starts.size() == 2) break;
  }
  return out;
}

}  // namespace stribeck::ident::log::parts
