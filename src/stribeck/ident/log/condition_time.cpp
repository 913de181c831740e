#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <stribeck/ident/log/condition_parts.hpp>
#include <stribeck/ident/refused.hpp>

namespace stribeck::ident::log {

double quantum(const std::vector<double>& values) {
  constexpr std::size_t kMost = 20000;
  std::vector<double> sorted = parts::sample_of(values, kMost);
  if (sorted.size() < 2) return 0.0;
  // At an even speed all values are multiples of one step that is no resolution.
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
  const double usual_move = parts::quantile(moves, 0.5);
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
  // The very smallest may come from one edited value.
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
    // Continuous values meet the band in one case of five.
    if (fits * 10 < near * 9 || near * 20 < steps.size() || (near < 20 && near < steps.size())) continue;
    const double step = sum / count;
    if (!repeats && usual_move < 1.5 * step) return 0.0;
    return step;
  }
  return 0.0;
}

namespace parts {
namespace {

constexpr std::size_t kFewestRows = 100;  // as problems() of a record
constexpr double kJitter = 0.01;
constexpr double kGap = 1.5;
constexpr std::size_t kSubset = 50000;

void check_finite(const RawLog& log, const Signal& s, const char* name) {
  for (std::size_t k = 0; k < s.y.size(); ++k) {
    if (std::isfinite(s.y[k]) && (s.t.empty() || std::isfinite(s.t[k]))) continue;
    const std::size_t row = k < log.row.size() ? log.row[k] : k + 1;
    throw Refused(log.source +
                  text(": column %s, row %zu: not a finite number (repair or cut the log)", name, row));
  }
}

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

double median_step(const std::vector<double>& t) {
  std::vector<double> steps;
  const std::size_t stride = std::max<std::size_t>(1, t.size() / kSubset);
  for (std::size_t k = 1; k < t.size(); k += stride) steps.push_back(t[k] - t[k - 1]);
  return quantile(std::move(steps), 0.5);
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

bool same_row(const Table& m, std::size_t a, std::size_t b) {
  const auto same = [&](const std::vector<double>& c) { return c.empty() || c[a] == c[b]; };
  return same(m.x) && same(m.r) && same(m.v) && same(m.f);
}

/// Time on a straight line from the first stamp to the last.
void restamp(Table& m) {
  const double first = m.t.front();
  const double T = (m.t.back() - first) / static_cast<double>(m.rows() - 1);
  for (std::size_t k = 0; k < m.rows(); ++k) m.t[k] = first + T * static_cast<double>(k);
  m.sample_time = T;
}

double largest_off_line(const std::vector<double>& t) {
  const double T = (t.back() - t.front()) / static_cast<double>(t.size() - 1);
  double worst = 0.0;
  for (std::size_t k = 0; k < t.size(); ++k)
    worst = std::max(worst, std::abs(t[k] - t.front() - T * static_cast<double>(k)));
  return worst;
}

/// On a regular grid from the first stamp on: positions and velocities on straight lines, the force as a mean.
Table resampled(const Table& m, double T) {
  Table out;
  out.source = m.source;
  out.run = m.run;
  out.gap_before = m.gap_before;
  out.sample_time = T;
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

/// Rows that stand in the log twice, as loggers pad their last block.
void drop_repeated_rows(Table& m, Notes& notes) {
  std::vector<std::uint8_t> gone(m.rows(), 0);
  std::size_t found = 0;
  std::size_t first = 0;
  for (std::size_t k = 1; k < m.rows(); ++k) {
    if (m.t[k] != m.t[k - 1] || !same_row(m, k, k - 1)) continue;
    gone[k] = 1;
    if (found++ == 0) first = k;
  }
  if (found == 0) return;
  notes.add("double-time", m, first, true,
            text("%zu rows repeat the row before them, time included; left out", found),
            {static_cast<double>(found)});
  erase_rows(m, gone);
}

/// Stamps that stand still. Returns the table with times that only increase or go back.
void mend_double_stamps(Table& m, Notes& notes) {
  std::size_t twice = 0;
  std::size_t back = 0;
  std::size_t first = 0;
  for (std::size_t k = 1; k < m.rows(); ++k) {
    if (m.t[k] == m.t[k - 1] && twice++ == 0) first = k;
    if (m.t[k] < m.t[k - 1]) ++back;
  }
  if (twice == 0) return;
  if (twice * 20 > m.rows()) {
    const double step = m.t.back() > m.t.front() ? rounding_of(m.t) : 0.0;
    if (back > 0 || !(step > 0.0) || largest_off_line(m.t) > 1.01 * step) {
      throw Refused(m.source + text(": column t, row %zu: time stands still in %zu of %zu rows and the "
                                    "rows are not equally spaced between (name another time column, or "
                                    "give the sample time)",
                                    m.row[first], twice, m.rows()));
    }
    restamp(m);
    notes.add(
        "rounded-time", m, first, true,
        text("the time stamps are coarser (%.3g s) than the rows are apart; equally spaced rows of %.6g s "
             "assumed",
             step, m.sample_time),
        {step, m.sample_time});
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
      text(
          "%zu time stamps occur twice; %zu rows left out, %zu time stamps interpolated between their neighbours",
          twice, dropped, moved),
      {static_cast<double>(twice)});
  erase_rows(m, gone);
}

/// One piece without steps back: cut at gaps, time made regular.
void cut_at_gaps(Table piece, Sampling& sampling, Notes& notes, std::vector<Table>& out) {
  const double T = median_step(piece.t);
  std::vector<std::size_t> starts{0};
  double widest = 0.0;
  for (std::size_t k = 1; k < piece.rows(); ++k) {
    const double step = piece.t[k] - piece.t[k - 1];
    if (step > kGap * T) {
      starts.push_back(k);
      widest = std::max(widest, step);
    } else {
      sampling.jitter = std::max(sampling.jitter, std::abs(step / T - 1.0));
    }
  }
  starts.push_back(piece.rows());
  sampling.gaps += starts.size() - 2;
  std::size_t kept = 0;
  for (std::size_t i = 1; i < starts.size(); ++i) {
    if (starts[i] - starts[i - 1] >= kFewestRows) kept += starts[i] - starts[i - 1];
  }
  const bool many = starts.size() > 2;
  if (many && kept * 2 < piece.rows() && starts.size() * 20 > piece.rows() && notes.wanted("irregular")) {
    std::vector<double> steps;
    for (std::size_t k = 1; k < piece.rows(); ++k) steps.push_back(piece.t[k] - piece.t[k - 1]);
    restamp(piece);
    notes.add("irregular", piece, 0, true,
              text("the rows were taken at irregular times (steps of %.3g to %.3g s); equal steps of %.4g "
                   "s are assumed: force over position at rest is right, speeds, acceleration and delay "
                   "are not",
                   quantile(steps, 0.02), quantile(steps, 0.98), piece.sample_time),
              {quantile(steps, 0.02), quantile(steps, 0.98)});
    sampling.jitter = std::max(sampling.jitter, quantile(steps, 0.98) / piece.sample_time - 1.0);
    sampling.gaps -= starts.size() - 2;
    out.push_back(std::move(piece));
    return;
  }
  if (many && kept * 5 < piece.rows() * 4 && widest < 3.5 * T) {
    notes.add(
        "gap", piece, starts[1], true,
        text("%zu single rows are missing, too many to cut the record there; interpolated by straight lines",
             starts.size() - 2),
        {static_cast<double>(starts.size() - 2)});
    piece.sample_time = T;
    out.push_back(resampled(piece, T));
    return;
  }
  if (many) {
    const std::size_t k = starts[1];
    std::string sentence =
        text("a gap of %.4g s before this row (the rows are %.4g s apart)", piece.t[k] - piece.t[k - 1], T);
    if (starts.size() > 3)
      sentence += text(", the first of %zu, the longest %.4g s", starts.size() - 2, widest);
    notes.add("gap", piece, k, true, sentence + "; cut there", {piece.t[k] - piece.t[k - 1]});
  }
  for (std::size_t i = 1; i < starts.size(); ++i) {
    Table part = many ? slice(piece, starts[i - 1], starts[i]) : std::move(piece);
    part.gap_before = i > 1;
    if (part.rows() < 2) {
      part.sample_time = T;
      out.push_back(std::move(part));
      if (!many) return;
      continue;
    }
    // A logger that is stopped writes one row more, early.
    if (part.rows() > kFewestRows && part.t.back() - part.t[part.rows() - 2] < 0.9 * T &&
        notes.wanted("jitter")) {
      notes.add("jitter", part, part.rows() - 1, true,
                text("the last row comes %.3g s after the one before, %.4g s is usual; left out",
                     part.t.back() - part.t[part.rows() - 2], T));
      const bool gap = part.gap_before;
      part = slice(part, 0, part.rows() - 1);
      part.gap_before = gap;
    }
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
    if (worst > kJitter) {
      const double step = rounding_of(part.t);
      if (step > 0.0 && largest_off_line(part.t) <= 1.01 * step && step < mean) {
        restamp(part);
        notes.add(
            "rounded-time", part, where, true,
            text("the time stamps are rounded to %.3g s (%.3g %% of a step); equally spaced rows of %.6g s "
                 "assumed",
                 step, 100.0 * step / mean, part.sample_time),
            {step, part.sample_time});
      } else {
        notes.add(
            "jitter", part, where, true,
            text(
                "the rows are not equally spaced (a step of %.4g s here, %.4g s is usual); resampled by linear interpolation, which smooths everything faster than a few rows",
                part.t[where] - part.t[where - 1], T),
            {worst});
        part = resampled(part, mean);
      }
    }
    out.push_back(std::move(part));
    if (!many) return;
  }
}

}  // namespace

std::string text(const char* format, ...) {
  char buffer[512];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(buffer, sizeof buffer, format, arguments);
  va_end(arguments);
  return buffer;
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  if (values.size() > 2 * kSubset) {
    const std::size_t stride = values.size() / kSubset;
    std::size_t to = 0;
    for (std::size_t k = 0; k < values.size(); k += stride) values[to++] = values[k];
    values.resize(to);
  }
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

std::vector<double> magnitudes(const std::vector<double>& values) {
  std::vector<double> out(values);
  for (double& x : out) x = std::abs(x);
  return out;
}

std::vector<double> sample_of(const std::vector<double>& values, std::size_t most) {
  if (values.size() <= most) return values;
  constexpr std::size_t kBlocks = 4;
  const std::size_t length = most / kBlocks;
  std::vector<double> out;
  for (std::size_t b = 0; b < kBlocks; ++b) {
    const std::size_t first = b * (values.size() - length) / (kBlocks - 1);
    out.insert(out.end(), values.begin() + static_cast<std::ptrdiff_t>(first),
               values.begin() + static_cast<std::ptrdiff_t>(first + length));
  }
  return out;
}

double hold_mean(const std::vector<double>& t, const std::vector<double>& y, double from, double to,
                 std::size_t& hint) {
  while (hint + 1 < t.size() && t[hint + 1] <= from) ++hint;
  double sum = 0.0;
  double at = from;
  for (std::size_t k = hint; at < to; ++k) {
    const double until = k + 1 < t.size() ? std::min(t[k + 1], to) : to;
    sum += y[std::min(k, y.size() - 1)] * (until - at);
    at = until;
    if (k + 1 >= t.size()) break;
  }
  return sum / (to - from);
}

double on_line(const std::vector<double>& t, const std::vector<double>& y, double at, std::size_t& hint) {
  while (hint + 2 < t.size() && t[hint + 1] <= at) ++hint;
  if (t.size() < 2) return y.front();
  const double share = (at - t[hint]) / (t[hint + 1] - t[hint]);
  return y[hint] + share * (y[hint + 1] - y[hint]);
}

Table slice(const Table& m, std::size_t first, std::size_t last) {
  Table out;
  out.source = m.source;
  out.run = m.run;
  out.sample_time = m.sample_time;
  const auto cut = [&](const auto& from, auto& to) {
    if (from.empty()) return;
    to.assign(from.begin() + static_cast<std::ptrdiff_t>(first),
              from.begin() + static_cast<std::ptrdiff_t>(last));
  };
  cut(m.t, out.t);
  cut(m.x, out.x);
  cut(m.r, out.r);
  cut(m.v, out.v);
  cut(m.f, out.f);
  cut(m.row, out.row);
  cut(m.mark, out.mark);
  return out;
}

Table one_table(RawLog& log, std::size_t run, Notes& notes) {
  const Signal& base = log.x.empty() ? log.v : log.x;
  if (base.empty()) throw Refused(log.source + ": neither position nor velocity; one of them is needed");
  if (log.f.empty()) throw Refused(log.source + ": no force, torque, current, voltage or percentage");
  const struct {
    const Signal* signal;
    const char* name;
  } all[] = {{&log.x, "x"}, {&log.r, "r"}, {&log.v, "v"}, {&log.v_ref, "reference velocity"}, {&log.f, "f"}};
  bool own = false;
  for (const auto& [s, name] : all) {
    if (s->empty()) continue;
    const std::size_t expected = s->t.empty() ? base.y.size() : s->t.size();
    if (s->y.size() != expected) {
      throw Refused(log.source + text(": column %s has %zu rows, expected %zu as its time has", name,
                                      s->y.size(), expected));
    }
    check_finite(log, *s, name);
    if (s != &base && !s->t.empty() && s->t != base.t) own = true;
  }
  Table m;
  m.source = log.source;
  m.run = run;
  std::vector<double> t = own ? base.t : std::move((log.x.empty() ? log.v : log.x).t);
  if (t.empty()) {
    if (!(log.sample_time > 0.0) || !std::isfinite(log.sample_time)) {
      throw Refused(log.source +
                    ": no column for the time; give the time between rows (--sample-time \"1 ms\")");
    }
    t.resize(base.y.size());
    for (std::size_t k = 0; k < t.size(); ++k) t[k] = log.sample_time * static_cast<double>(k);
  }
  const auto row_of = [&](std::size_t k) { return k < log.row.size() ? log.row[k] : k + 1; };
  if (t.size() < 2) {
    throw Refused(log.source + text(": %zu rows, expected at least %zu", t.size(), kFewestRows));
  }
  if (!own) {
    m.t = std::move(t);
    m.x = std::move(log.x.y);
    m.r = std::move(log.r.y);
    m.v = std::move(log.v.y);
    m.f = std::move(log.f.y);
    if (m.r.empty()) m.r = std::move(log.v_ref.y);
    m.row.resize(m.t.size());
    for (std::size_t k = 0; k < m.row.size(); ++k) m.row[k] = row_of(k);
    m.mark.assign(m.t.size(), kGoodRow);
    return m;
  }
  const auto time_of = [&](const Signal& s) -> const std::vector<double>& { return s.t.empty() ? t : s.t; };
  double from = t.front();
  double to = t.back();
  for (const auto& [s, name] : all) {
    if (s->empty()) continue;
    const std::vector<double>& own_time = time_of(*s);
    for (std::size_t k = 1; k < own_time.size(); ++k) {
      if (own_time[k] > own_time[k - 1]) continue;
      throw Refused(log.source +
                    text(": time of column %s, row %zu: goes from %.9g to %.9g s, expected it to increase "
                         "(cut the log there)",
                         name, k + 1, own_time[k - 1], own_time[k]));
    }
    from = std::max(from, own_time.front());
    to = std::min(to, own_time.back());
  }
  // The slower of motion and force makes the grid: nothing is invented between its samples.
  const double base_step = median_step(t);
  const double force_step = median_step(time_of(log.f));
  const bool force_grid = force_step > 1.2 * base_step;
  const std::vector<double>& grid = force_grid ? time_of(log.f) : t;
  const double T = force_grid ? force_step : base_step;
  std::size_t hints[4] = {0, 0, 0, 0};
  const Signal& reference = log.r.empty() ? log.v_ref : log.r;
  for (std::size_t k = 0; k < grid.size(); ++k) {
    const double at = grid[k];
    if (at < from || at > to) continue;
    m.t.push_back(at);
    m.row.push_back(row_of(k));
    if (!log.x.empty()) m.x.push_back(on_line(t, log.x.y, at, hints[0]));
    if (!reference.empty()) m.r.push_back(on_line(time_of(reference), reference.y, at, hints[1]));
    if (!log.v.empty()) m.v.push_back(on_line(time_of(log.v), log.v.y, at, hints[2]));
    m.f.push_back(hold_mean(time_of(log.f), log.f.y, at, at + T, hints[3]));
  }
  m.mark.assign(m.t.size(), kGoodRow);
  if (m.rows() < kFewestRows) {
    throw Refused(log.source +
                  text(": the columns have %zu rows in common (%.6g to %.6g s), expected at least %zu",
                       m.rows(), from, to, kFewestRows));
  }
  notes.add(
      "time-bases", m, 0, true,
      text(
          "motion and force have different time bases (%.4g s and %.4g s); both are now on that of the %s, positions interpolated linearly, the force as the mean over each interval",
          base_step, force_step, force_grid ? "force" : "motion"),
      {base_step, force_step});
  return m;
}

std::vector<Table> regular_pieces(Table m, Sampling& sampling, Notes& notes) {
  sampling.rows += m.rows();
  drop_repeated_rows(m, notes);
  mend_double_stamps(m, notes);
  std::vector<std::size_t> starts{0};
  for (std::size_t k = 1; k < m.rows(); ++k) {
    if (m.t[k] < m.t[k - 1]) starts.push_back(k);
  }
  starts.push_back(m.rows());
  if (starts.size() > 2) {
    const std::size_t k = starts[1];
    const double T = median_step(m.t);
    for (std::size_t i = 1; i < starts.size(); ++i) {
      // A new record begins far back; two stamps that are exchanged do not.
      const bool far = i + 1 == starts.size() || m.t[starts[i] - 1] - m.t[starts[i]] > 50.0 * T;
      if (far && starts[i] - starts[i - 1] >= kFewestRows) continue;
      throw Refused(m.source +
                    text(": column t, row %zu: time goes back, from %.9g to %.9g s, expected it to "
                         "increase (cut the log there, or mend the time column)",
                         m.row[k], m.t[k - 1], m.t[k]));
    }
    notes.add("time-back", m, k, true,
              text("time goes back, from %.6g to %.6g s%s; taken as a new record", m.t[k - 1], m.t[k],
                   starts.size() > 3 ? text(" (the first of %zu times)", starts.size() - 2).c_str() : ""),
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

double hold_of(const std::vector<Table>& tables, std::vector<double> Table::*column) {
  std::vector<double> gaps;
  std::vector<double> changes;
  std::vector<double> all;
  for (const Table& m : tables) {
    const std::vector<double>& y = m.*column;
    if (y.empty()) return 1.0;
    std::size_t last = 0;
    for (std::size_t k = 1; k < y.size() && gaps.size() < kSubset; ++k) {
      if (y[k] == y[k - 1]) continue;
      if (last > 0) gaps.push_back(static_cast<double>(k - last));
      changes.push_back(std::abs(y[k] - y[k - 1]));
      last = k;
    }
    const std::vector<double> some = sample_of(y, kSubset / 10);
    all.insert(all.end(), some.begin(), some.end());
  }
  constexpr std::size_t kFewestChanges = 50;
  constexpr double kLongest = 200.0;
  if (gaps.size() < kFewestChanges) return 1.0;
  const double typical = quantile(gaps, 0.5);
  if (typical < 2.0 || typical > kLongest) return 1.0;
  // A slow coarse position also stands for several rows, but then it changes by single steps.
  if (quantile(changes, 0.5) < 2.5 * quantum(all)) return 1.0;
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
    // Rows in which the slow channel is new; where it did not move they follow from the spacing.
    std::vector<std::size_t> starts;
    std::size_t first = 1;
    while (first < y.size() && y[first] == y[first - 1]) ++first;
    if (first >= y.size()) continue;
    const auto slack = static_cast<std::ptrdiff_t>(std::max(1.0, 0.25 * hold));
    double at = static_cast<double>(first);
    std::vector<std::size_t> breaks;  // in starts: where the spacing slipped
    double origin = at;
    double steps = 0.0;
    while (static_cast<std::size_t>(at) < y.size()) {
      starts.push_back(static_cast<std::size_t>(at));
      const double expected = origin + (steps + 1.0) * hold;
      const auto about = static_cast<std::ptrdiff_t>(std::llround(expected));
      std::ptrdiff_t found = about;
      for (std::ptrdiff_t d = 0; d <= slack; ++d) {
        const auto changed = [&](std::ptrdiff_t k) {
          return k > static_cast<std::ptrdiff_t>(at) && k < static_cast<std::ptrdiff_t>(y.size()) &&
                 y[static_cast<std::size_t>(k)] != y[static_cast<std::size_t>(k) - 1];
        };
        if (changed(about + d)) {
          found = about + d;
          break;
        }
        if (changed(about - d)) {
          found = about - d;
          break;
        }
      }
      if (std::abs(static_cast<double>(found) - expected) > 1.01) {
        origin = static_cast<double>(found);
        steps = 0.0;
        breaks.push_back(starts.size());
      } else {
        steps += 1.0;
      }
      at = static_cast<double>(found);
    }
    breaks.push_back(starts.empty() ? 0 : starts.size() - 1);  // the last interval may be cut
    const double T = m.sample_time * hold;
    std::size_t from = 0;
    for (const std::size_t until : breaks) {
      Table s;
      s.source = m.source;
      s.run = m.run;
      s.sample_time = T;
      s.gap_before = m.gap_before || from > 0;
      for (std::size_t i = from; i < until; ++i) {
        const std::size_t k = starts[i];
        const std::size_t end = i + 1 < starts.size() ? starts[i + 1] : y.size();
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
      if (s.rows() > 0) out.push_back(std::move(s));
      from = until;
    }
  }
  std::string holds;
  const auto say = [&](const char* name, double h) {
    holds += text("%s%s every %.4g rows", holds.empty() ? "" : ", ", name, h);
  };
  if (position) say("position", sampling.x_hold);
  if (!tables.front().v.empty()) say("velocity", sampling.v_hold);
  say("force", sampling.f_hold);
  notes.add(
      "held", tables.front(), 0, true,
      text("values are held over several rows (new: %s); records are on the grid of %.4g s, force as the "
           "mean over each interval",
           holds.c_str(), tables.front().sample_time * hold),
      {hold, tables.front().sample_time * hold});
  return out;
}

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
    for (std::size_t k = 1; k < y.size(); k += std::max<std::size_t>(1, y.size() / kSubset)) {
      if (y[k] != y[k - 1]) moves.push_back(std::abs(y[k] - y[k - 1]));
    }
    if (moves.empty()) {
      out.push_back(std::move(m));
      continue;
    }
    const double step = std::max(quantum(y), quantile(moves, 0.05));
    std::size_t from = 0;
    for (std::size_t k = 1; k < m.rows(); ++k) {
      if (m.f[k] != m.f[k - 1]) continue;
      std::size_t end = k;
      while (end < m.rows() && same_row(m, end, k - 1)) ++end;
      const std::size_t first = k - 1;  // last fresh row
      const std::size_t rows = end - k;
      const bool at_end = end == m.rows();
      k = std::max(k, end);
      if (rows < shortest || first < look) continue;
      bool frozen = false;
      // The channels come back each in its own time slot.
      std::size_t fresh = end;
      while (fresh < m.rows() && fresh < end + hold && y[fresh] == y[first]) ++fresh;
      if (fresh == m.rows()) fresh = end;
      const double jump = at_end ? 0.0 : y[fresh] - y[first];
      if (velocity_only) {
        // Constant velocity, force and reference to the last bit: only a coarse standstill does that.
        frozen = std::abs(y[first]) > 5.0 * step && step > 0.0;
      } else {
        const double speed = (y[first] - y[first - look]) / static_cast<double>(look);  // per row
        const double way = speed * static_cast<double>(rows);
        if (!at_end) {
          frozen = std::abs(way) > 10.0 * step && jump * way > 0.0 && std::abs(jump) > 0.25 * std::abs(way) &&
                   std::abs(jump) < 4.0 * std::abs(way) + 10.0 * step &&
                   std::abs(jump) > 2.5 * std::abs(speed) * static_cast<double>(hold);
        } else if (first >= 3 * look) {
          const double before = (y[first - 2 * look] - y[first - 3 * look]) / static_cast<double>(look);
          frozen = std::abs(speed) > 0.7 * std::abs(before) && speed * before > 0.0 &&
                   std::abs(speed) * static_cast<double>(hold) > 5.0 * step && std::abs(way) > 50.0 * step;
        }
      }
      if (!frozen) continue;
      notes.add_range(
          "frozen", m, first, end - 1, true,
          at_end ? std::string("every channel keeps its value while the axis moves: the logger had "
                               "stopped; cut off")
                 : text("every channel keeps its value while the axis moves, the position then jumps by "
                        "%s: the logger was frozen; cut out",
                        notes.way(jump).c_str()),
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

}  // namespace parts
}  // namespace stribeck::ident::log
