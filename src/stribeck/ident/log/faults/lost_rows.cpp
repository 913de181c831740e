// Rows lost, written twice or not renewed by a logger whose time stamps say nothing of it.
//
// Between even steps of the position a lost row is a step of double size, a row that was not renewed a step of zero and one of
// double size, a row written twice a step of zero alone. The usual step comes from the medians of five steps on either
// side, so that other faults nearby do not matter.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <stribeck/ident/log/faults/faults.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <utility>

namespace stribeck::ident::log::parts {
namespace {

constexpr std::size_t kNeighbours = 5;  // steps on either side
constexpr std::size_t kFewestNeighbours = 3;
constexpr std::size_t kMostHeld = 50;  // rows in one place that were not renewed
constexpr double kWhole = 0.25;        // of a step, by which a whole number of steps may be missed
constexpr double kBeyondSpread = 5.0;
constexpr double kBeyondUsualSpread = 8.0;
constexpr double kQuanta = 4.0;  // an even speed on a coarse scale has single steps of double size

/// Steps before and after a place, by their distance from it.
struct Steps {
  std::array<double, kNeighbours> before{};  ///< the nearest first
  std::array<double, kNeighbours> after{};
  std::size_t count_before = 0;
  std::size_t count_after = 0;

  [[nodiscard]] bool enough() const { return std::min(count_before, count_after) >= kFewestNeighbours; }
};

/// Steps of a column up to its row `left` (the last of `done`), and from row `right` of `raw` on.
Steps steps_around(const std::vector<double>& done, const std::vector<double>& raw, std::size_t right) {
  Steps s;
  for (std::size_t i = done.size(); i > 1 && s.count_before < kNeighbours; --i)
    s.before[s.count_before++] = done[i - 1] - done[i - 2];
  for (std::size_t i = right; i + 1 < raw.size() && s.count_after < kNeighbours; ++i)
    s.after[s.count_after++] = raw[i + 1] - raw[i];
  return s;
}

double median_of(std::array<double, kNeighbours> values, std::size_t count) {
  std::sort(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count));
  return count % 2 == 1 ? values[count / 2] : 0.5 * (values[count / 2 - 1] + values[count / 2]);
}

/// The step that belongs to the place, and how far seven of ten neighbours stand off the straight line through it.
struct Usual {
  double step = 0.0;
  double spread = 0.0;
};

Usual usual_step(const Steps& s) {
  const double before = median_of(s.before, s.count_before);
  const double after = median_of(s.after, s.count_after);
  const double to_before = 0.5 * static_cast<double>(s.count_before + 1);
  const double to_after = 0.5 * static_cast<double>(s.count_after + 1);
  const double slope = (after - before) / (to_before + to_after);
  Usual u;
  u.step = before + slope * to_before;
  std::array<double, 2 * kNeighbours> off{};
  std::size_t n = 0;
  for (std::size_t i = 0; i < s.count_before; ++i)
    off[n++] = std::abs(s.before[i] - u.step + slope * static_cast<double>(i + 1));
  for (std::size_t i = 0; i < s.count_after; ++i)
    off[n++] = std::abs(s.after[i] - u.step - slope * static_cast<double>(i + 1));
  const std::size_t at = n * 7 / 10 - 1;
  std::nth_element(off.begin(), off.begin() + static_cast<std::ptrdiff_t>(at),
                   off.begin() + static_cast<std::ptrdiff_t>(n));
  u.spread = off[at];
  return u;
}

/// What the steps of this log usually stand off each other.
double usual_spread(const std::vector<Table>& tables) {
  std::vector<double> spreads;
  std::size_t rows = 0;
  for (const Table& m : tables) rows += m.rows();
  const std::size_t stride = std::max<std::size_t>(1, rows / 20000);
  std::vector<double> left;
  for (const Table& m : tables) {
    for (std::size_t k = kNeighbours + 1; k + kNeighbours + 1 < m.rows(); k += stride) {
      if (m.x[k + kNeighbours] == m.x[k - kNeighbours - 1]) continue;  // at rest
      const auto at = m.x.begin() + static_cast<std::ptrdiff_t>(k);
      left.assign(at - static_cast<std::ptrdiff_t>(kNeighbours) - 1, at);
      spreads.push_back(usual_step(steps_around(left, m.x, k)).spread);
    }
  }
  return spreads.size() < 50 ? 0.0 : stats::thinned_quantile(std::move(spreads), 0.5);
}

/// Whether nearly all short steps are whole numbers of a count, within the digits of the log, and not all of them one: an even speed
/// is no count.
bool is_count(const std::vector<Table>& tables, double count, double digit) {
  constexpr double kShort = 5.0;  // counts
  constexpr double kNearly = 0.9;
  constexpr double kFewest = 100.0;
  constexpr double kOthers = 2e-3;  // of the short steps: none, or several counts
  double all = 0.0, whole = 0.0, others = 0.0;
  for (const Table& m : tables) {
    for (std::size_t k = 1; k < m.rows(); ++k) {
      const double step = std::abs(m.x[k] - m.x[k - 1]);
      if (step > kShort * count) continue;
      const double counts = std::round(step / count);
      all += 1.0;
      whole += std::abs(step - count * counts) < 1.5 * digit * std::max(1.0, counts) ? 1.0 : 0.0;
      others += counts == 1.0 ? 0.0 : 1.0;
    }
  }
  return all > kFewest && whole > kNearly * all && others > kOthers * all;
}

/// Digit and count of a position whose unit was converted, so that no digit shows: 0.1 um as motor angles with three decimals have steps
/// of 10 and 11 digits, and of 21 and 22. `about`: the count, roughly.
struct Rounded {
  double digit = 0.0;  ///< 0: the steps are not rounded
  double count = 0.0;
};
Rounded rounded_count(const std::vector<Table>& tables, double about) {
  constexpr std::size_t kMost = 5000;
  constexpr double kSame = 1e-4;          // of the count
  constexpr double kFinest = 1.0 / 50.0;  // the same
  std::vector<double> steps;
  for (const Table& m : tables) {
    for (std::size_t k = 1; k < m.rows() && steps.size() < kMost; ++k) {
      const double step = std::abs(m.x[k] - m.x[k - 1]);
      if (step > 0.5 * about && step < 2.5 * about) steps.push_back(step);
    }
  }
  std::sort(steps.begin(), steps.end());
  Rounded out;
  double sum = 0.0, single = 0.0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (steps[i] < 1.5 * about) sum += steps[i], single += 1.0;
    const double gap = i > 0 ? steps[i] - steps[i - 1] : 0.0;
    if (gap > kSame * about && (out.digit == 0.0 || gap < out.digit)) out.digit = gap;
  }
  if (out.digit < kFinest * about || single == 0.0) return {};
  out.count = sum / single;
  return out;
}

/// The count of an encoder that is no whole number of the digits of the log, such as 0.1 um in inches; 0: none shows.
double count_beside_digits(const std::vector<Table>& tables, double digit) {
  constexpr std::size_t kFew = 20;
  std::vector<double> smallest;  // a heap, the largest of them first
  for (const Table& m : tables) {
    for (std::size_t k = 1; k < m.rows(); ++k) {
      const double step = std::abs(m.x[k] - m.x[k - 1]);
      if (!(step > 1.5 * digit) || (smallest.size() == kFew && step >= smallest.front())) continue;
      if (smallest.size() == kFew) {
        std::pop_heap(smallest.begin(), smallest.end());
        smallest.pop_back();
      }
      smallest.push_back(step);
      std::push_heap(smallest.begin(), smallest.end());
    }
  }
  constexpr double kLeast = 8.0;          // digits
  constexpr double kUntold = 1.0 / 40.0;  // of a count, where the log shows no digits
  constexpr double kCoarsest = 20e-6;     // [m]: encoders are finer
  if (smallest.size() < kFew) return 0.0;
  double count = smallest.front();
  if (digit == 0.0) {
    const Rounded rounded = rounded_count(tables, count);
    if (rounded.digit > 0.0) digit = rounded.digit, count = rounded.count;
  }
  const bool may_be = count > kLeast * digit && count < kCoarsest;
  return may_be && is_count(tables, count, digit > 0.0 ? digit : kUntold * count) ? count : 0.0;
}

enum class Fault : std::uint8_t { kNone, kLost, kStale, kRepeated };

struct Place {
  Fault fault = Fault::kNone;
  std::size_t rows = 0;  ///< lost, not renewed or repeated
  std::size_t next = 0;  ///< first row that is good again
  double steps = 0.0;    ///< travel to it in usual steps
};

/// `jump` is so many usual steps; 0 where it is no whole number.
std::size_t whole_steps(double jump, double step) {
  const double ratio = jump / step;
  const double n = std::round(ratio);
  return n >= 1.0 && std::abs(ratio - n) < kWhole ? static_cast<std::size_t>(n) : 0;
}

/// Whether the reference jumps by as many of its usual steps. A reference at rest agrees.
bool reference_agrees(const std::vector<double>& done, const std::vector<double>& raw, std::size_t next,
                      double x_step, std::size_t steps) {
  if (raw.empty()) return true;
  const Steps s = steps_around(done, raw, next);
  if (!s.enough()) return true;
  const Usual u = usual_step(s);
  const double jump = raw[next] - done.back();
  if (std::abs(u.step) < 0.3 * std::abs(x_step) || 3.0 * u.spread > std::abs(u.step)) return true;
  return whole_steps(jump, u.step) == steps;
}

/// Copies a table row by row and mends it on the way.
class Mender {
 public:
  Mender(const Table& from, double least) : from_(from), least_(least) {
    out_.source = from.source;
    out_.run = from.run;
    out_.sample_time = from.sample_time;
    out_.counted = from.counted;
    out_.gap_before = from.gap_before;
  }

  struct Found {
    std::size_t places = 0;
    std::size_t rows = 0;
    std::size_t first = 0;  ///< row of the table
    double steps = 0.0;     ///< there
  };

  /// By Fault.
  [[nodiscard]] const Found& found(Fault fault) const { return found_[static_cast<std::size_t>(fault)]; }
  [[nodiscard]] std::size_t rows_found() const {
    return found(Fault::kLost).rows + found(Fault::kStale).rows + found(Fault::kRepeated).rows;
  }

  void run(const Notes& notes) {
    for (std::size_t k = 0; k < from_.rows();) {
      const Place p = look(k);
      const bool mend = p.fault != Fault::kNone && notes.wanted(name_of(p.fault));
      if (!mend) {
        copy(k++);
        continue;
      }
      Found& f = found_[static_cast<std::size_t>(p.fault)];
      if (f.places++ == 0) {
        f.first = k;
        f.steps = p.steps;
      }
      f.rows += p.rows;
      if (p.fault == Fault::kLost) fill(k, p.next, p.rows, false);
      if (p.fault == Fault::kStale) fill(k, p.next, p.rows, true);
      k = p.next;
    }
  }

  Table take() {
    const double first = from_.t.front();
    out_.t.resize(out_.row.size());
    for (std::size_t k = 0; k < out_.t.size(); ++k)
      out_.t[k] = first + out_.sample_time * static_cast<double>(k);
    return std::move(out_);
  }

  static const char* name_of(Fault fault) {
    return fault == Fault::kLost ? "lost" : fault == Fault::kStale ? "stale" : "repeated";
  }

 private:
  /// What is wrong between the last row that was copied and row k.
  [[nodiscard]] Place look(std::size_t k) const {
    const std::vector<double>& x = from_.x;
    if (out_.x.size() < kFewestNeighbours + 1 || k + kFewestNeighbours + 1 >= x.size()) return {};
    const double last = out_.x.back();
    const double step_before = last - out_.x[out_.x.size() - 2];
    const double change = std::abs(x[k] - last - step_before);
    if (change < 0.5 * std::abs(step_before) || change < least_) return {};  // most rows leave here
    std::size_t next = k;
    while (next < x.size() && x[next] == last && next - k <= kMostHeld) ++next;
    const std::size_t held = next - k;
    if (held > kMostHeld || next + kFewestNeighbours >= x.size()) return {};
    const Steps s = steps_around(out_.x, x, next);
    if (!s.enough()) return {};
    const Usual u = usual_step(s);
    const double limit = std::max(least_, kBeyondSpread * u.spread);
    const double jump = x[next] - last;
    if (std::abs(u.step) < limit) return {};
    // A single wild sample comes back.
    if (s.after[0] / u.step < -0.3) return {};
    const std::size_t steps = whole_steps(jump, u.step);
    if (steps == 0) return {};
    return judged(k, next, held, steps, u.step, jump / u.step);
  }

  [[nodiscard]] Place judged(std::size_t k, std::size_t next, std::size_t held, std::size_t steps,
                             double step, double ratio) const {
    if (held == 0) {
      if (steps < 2 || steps > kMostLost + 1) return {};
      if (!reference_agrees(out_.r, from_.r, next, step, steps)) return {};
      return {Fault::kLost, steps - 1, next, ratio};
    }
    if (steps == held + 1) return {Fault::kStale, held, next, ratio};
    if (steps != 1) return {};
    for (std::size_t i = k; i < next; ++i) {
      if (!same_row(from_, i, k - 1)) return {};
    }
    return {Fault::kRepeated, held, next, ratio};
  }

  void copy(std::size_t k) {
    out_.x.push_back(from_.x[k]);
    if (!from_.r.empty()) out_.r.push_back(from_.r[k]);
    if (!from_.v.empty()) out_.v.push_back(from_.v[k]);
    out_.f.push_back(from_.f[k]);
    out_.row.push_back(from_.row[k]);
    out_.mark.push_back(from_.mark[k]);
  }

  /// Puts `rows` rows between the last one and `next`; those that are in the log keep what was renewed in them.
  void fill(std::size_t k, std::size_t next, std::size_t rows, bool in_log) {
    const double hole = static_cast<double>(rows + 1);
    std::array<std::vector<double>, 4> fresh;
    const std::array<std::pair<const std::vector<double>*, std::vector<double>*>, 4> columns{
        {{&from_.x, &out_.x}, {&from_.r, &out_.r}, {&from_.v, &out_.v}, {&from_.f, &out_.f}}};
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const auto& [raw, done] = columns[c];
      if (raw->empty()) continue;
      const bool position = c < 2;
      for (std::size_t i = 0; i < rows; ++i) {
        const double at = static_cast<double>(i + 1);
        const bool renewed = in_log && c > 0 && (*raw)[k + i] != (*raw)[k - 1];
        fresh[c].push_back(
            renewed ? (*raw)[k + i]
            : position
                ? on_cubic({-1.0, 0.0, hole, hole + 1.0},
                           {(*done)[done->size() - 2], done->back(), (*raw)[next], (*raw)[next + 1]}, at)
                : done->back() + ((*raw)[next] - done->back()) * at / hole);
      }
    }
    for (std::size_t c = 0; c < columns.size(); ++c)
      columns[c].second->insert(columns[c].second->end(), fresh[c].begin(), fresh[c].end());
    for (std::size_t i = 0; i < rows; ++i) {
      out_.row.push_back(in_log ? from_.row[k + i] : out_.row.back());
      out_.mark.push_back(kRepairedRow);
    }
  }

  const Table& from_;
  double least_;  ///< steps below this are not told apart
  Table out_;
  std::array<Found, 4> found_{};
};

std::string times(std::size_t places, std::size_t rows) {
  if (places == 1) return "";
  return fmt::format(", the first of {} such places with {} rows in all", places, rows);
}

void note(const Table& m, const Mender& mender, Notes& notes) {
  using Found = Mender::Found;
  if (const Found& f = mender.found(Fault::kLost); f.places > 0) {
    notes.add("lost", m, f.first, true,
              fmt::format("the position takes {:.3g} of its usual steps at once: {} missing before this row, "
                          "although the time stamps go on{}; put in between its neighbours, and not fitted",
                          f.steps, f.steps < 2.5 ? "a row is" : "rows are", times(f.places, f.rows)),
              {static_cast<double>(f.places), static_cast<double>(f.rows)});
  }
  if (const Found& f = mender.found(Fault::kStale); f.places > 0) {
    notes.add("stale", m, f.first, true,
              fmt::format("the position keeps its value here and makes up for it afterwards: it was not "
                          "renewed{}; set between its neighbours, and not fitted",
                          times(f.places, f.rows)),
              {static_cast<double>(f.places), static_cast<double>(f.rows)});
  }
  if (const Found& f = mender.found(Fault::kRepeated); f.places > 0) {
    notes.add("repeated", m, f.first, true,
              fmt::format("this row has the values of the one before while the axis moves evenly: written "
                          "twice, although the time stamps go on{}; left out",
                          times(f.places, f.rows)),
              {static_cast<double>(f.places), static_cast<double>(f.rows)});
  }
}

/// Steps of the tables whose sample time was counted.
std::size_t counted_steps(const std::vector<Table>& tables) {
  std::size_t steps = 0;
  for (const Table& m : tables) steps += m.counted && m.rows() > 0 ? m.rows() - 1 : 0;
  return steps;
}

/// Stamps that are coarser than the rows tell how long all rows took together: more rows in this time are shorter.
void scale_counted(std::vector<Table>& tables, double factor) {
  const double first = tables.front().t.front();
  for (Table& m : tables) {
    if (!m.counted) continue;
    m.sample_time *= factor;
    for (double& t : m.t) t = first + (t - first) * factor;
  }
}

}  // namespace

void mend_lost_rows(std::vector<Table>& tables, const Sampling& sampling, Notes& notes) {
  if (tables.front().x.empty()) return;
  const std::size_t before = counted_steps(tables);
  const double least = std::max(
      kBeyondUsualSpread * usual_spread(tables),
      kQuanta * std::max(sampling.x_quantum_large, count_beside_digits(tables, sampling.x_quantum_large)));
  double later = 0.0;
  std::size_t run = tables.front().run;
  for (Table& m : tables) {
    if (m.run != run) later = 0.0;
    run = m.run;
    for (double& t : m.t) t += later;
    if (m.rows() < kFewestRows) continue;
    Mender mender(m, least);
    mender.run(notes);
    // More of them are the way in which the log was written.
    if (mender.rows_found() == 0 || mender.rows_found() * 20 > m.rows()) continue;
    note(m, mender, notes);
    const double end = m.t.back();
    m = mender.take();
    later += m.t.back() - end;
  }
  if (const std::size_t after = counted_steps(tables); after > 0 && after != before)
    scale_counted(tables, static_cast<double>(before) / static_cast<double>(after));
}

}  // namespace stribeck::ident::log::parts
