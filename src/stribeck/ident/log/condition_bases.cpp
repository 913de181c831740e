// Brings signals with different time bases to one.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stribeck/ident/log/condition_parts.hpp>
#include <stribeck/ident/refused.hpp>
#include <utility>

namespace stribeck::ident::log::parts {
namespace {

void check_finite(const RawLog& log, const Signal& s, const char* name) {
  for (std::size_t k = 0; k < s.y.size(); ++k) {
    if (std::isfinite(s.y[k]) && (s.t.empty() || std::isfinite(s.t[k]))) continue;
    const std::size_t row = k < log.row.size() ? log.row[k] : k + 1;
    throw Refused(log.source +
                  fmt::format(": column {}, row {}: not a finite number (repair or cut the log)", name, row));
  }
}

/// The columns of a log that may have their own time bases.
struct NamedSignal {
  const Signal* signal;
  const char* name;
};
using Signals = std::array<NamedSignal, 5>;

std::size_t row_of(const RawLog& log, std::size_t k) { return k < log.row.size() ? log.row[k] : k + 1; }

/// Whether a signal has another time base than `base`. Refuses columns of another length than their time.
bool differing_bases(const RawLog& log, const Signals& all, const Signal& base) {
  bool own = false;
  for (const auto& [s, name] : all) {
    if (s->empty()) continue;
    const std::size_t expected = s->t.empty() ? base.y.size() : s->t.size();
    if (s->y.size() != expected) {
      throw Refused(log.source + fmt::format(": column {} has {} rows, expected {} as its time has", name,
                                             s->y.size(), expected));
    }
    check_finite(log, *s, name);
    if (s != &base && !s->t.empty() && s->t != base.t) own = true;
  }
  return own;
}

/// The time column `t`; computed from the sample time of the log where there is none.
std::vector<double> time_of_rows(const RawLog& log, std::vector<double> t, std::size_t rows) {
  if (t.empty()) {
    if (!(log.sample_time > 0.0) || !std::isfinite(log.sample_time)) {
      throw Refused(log.source +
                    ": no column for the time; give the time between rows (--sample-time \"1 ms\")");
    }
    t.resize(rows);
    for (std::size_t k = 0; k < t.size(); ++k) t[k] = log.sample_time * static_cast<double>(k);
  }
  if (t.size() < 2) {
    throw Refused(log.source + fmt::format(": {} rows, expected at least {}", t.size(), kFewestRows));
  }
  return t;
}

/// The case of columns that share the time t; takes them out of the log.
Table with_shared_time(RawLog& log, std::size_t run, std::vector<double> t) {
  Table m;
  m.source = log.source;
  m.run = run;
  m.t = std::move(t);
  m.x = std::move(log.x.y);
  m.r = std::move(log.r.y);
  m.v = std::move(log.v.y);
  m.f = std::move(log.f.y);
  if (m.r.empty()) m.r = std::move(log.v_ref.y);
  m.row.resize(m.t.size());
  for (std::size_t k = 0; k < m.row.size(); ++k) m.row[k] = row_of(log, k);
  m.mark.assign(m.t.size(), kGoodRow);
  return m;
}

const std::vector<double>& time_of(const Signal& s, const std::vector<double>& t) {
  return s.t.empty() ? t : s.t;
}

/// First and last instant that all signals cover. Refuses time that does not increase.
std::pair<double, double> common_time(const RawLog& log, const Signals& all, const std::vector<double>& t) {
  double from = t.front();
  double to = t.back();
  for (const auto& [s, name] : all) {
    if (s->empty()) continue;
    const std::vector<double>& own_time = time_of(*s, t);
    for (std::size_t k = 1; k < own_time.size(); ++k) {
      if (own_time[k] > own_time[k - 1]) continue;
      throw Refused(log.source +
                    fmt::format(": time of column {}, row {}: goes from {:.9g} to {:.9g} s, expected it to "
                                "increase (cut the log there)",
                                name, k + 1, own_time[k - 1], own_time[k]));
    }
    from = std::max(from, own_time.front());
    to = std::min(to, own_time.back());
  }
  return {from, to};
}

/// The slower of motion and force gives the grid, so that nothing is invented between its samples.
Table on_common_grid(const RawLog& log, std::size_t run, const Signals& all, const std::vector<double>& t,
                     Notes& notes) {
  const auto [from, to] = common_time(log, all, t);
  const double base_step = median_step(t);
  const double force_step = median_step(time_of(log.f, t));
  const bool force_grid = force_step > 1.2 * base_step;
  const std::vector<double>& grid = force_grid ? time_of(log.f, t) : t;
  const double T = force_grid ? force_step : base_step;
  std::size_t hints[4] = {0, 0, 0, 0};
  const Signal& reference = log.r.empty() ? log.v_ref : log.r;
  Table m;
  m.source = log.source;
  m.run = run;
  for (std::size_t k = 0; k < grid.size(); ++k) {
    const double at = grid[k];
    if (at < from || at > to) continue;
    m.t.push_back(at);
    m.row.push_back(row_of(log, k));
    if (!log.x.empty()) m.x.push_back(on_line(t, log.x.y, at, hints[0]));
    if (!reference.empty()) m.r.push_back(on_line(time_of(reference, t), reference.y, at, hints[1]));
    if (!log.v.empty()) m.v.push_back(on_line(time_of(log.v, t), log.v.y, at, hints[2]));
    m.f.push_back(hold_mean(time_of(log.f, t), log.f.y, at, at + T, hints[3]));
  }
  m.mark.assign(m.t.size(), kGoodRow);
  if (m.rows() < kFewestRows) {
    throw Refused(
        log.source +
        fmt::format(": the columns have {} rows in common ({:.6g} to {:.6g} s), expected at least {}",
                    m.rows(), from, to, kFewestRows));
  }
  notes.add("time-bases", m, 0, true,
            fmt::format(
                "motion and force have different time bases ({:.4g} s and {:.4g} s); both are now on that of "
                "the {}, positions interpolated linearly, the force as the mean over each interval",
                base_step, force_step, force_grid ? "force" : "motion"),
            {base_step, force_step});
  return m;
}

}  // namespace

Table one_table(RawLog& log, std::size_t run, Notes& notes) {
  Signal& base = log.x.empty() ? log.v : log.x;
  if (base.empty()) throw Refused(log.source + ": neither position nor velocity; one of them is needed");
  if (log.f.empty()) throw Refused(log.source + ": no force, torque, current, voltage or percentage");
  const Signals all{
      {{&log.x, "x"}, {&log.r, "r"}, {&log.v, "v"}, {&log.v_ref, "reference velocity"}, {&log.f, "f"}}};
  if (differing_bases(log, all, base)) {
    const std::vector<double> t = time_of_rows(log, base.t, base.y.size());
    return on_common_grid(log, run, all, t, notes);
  }
  const std::size_t rows = base.y.size();
  return with_shared_time(log, run, time_of_rows(log, std::move(base.t), rows));
}

}  // namespace stribeck::ident::log::parts
