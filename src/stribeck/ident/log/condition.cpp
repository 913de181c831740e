#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <stribeck/ident/log/condition.hpp>
#include <stribeck/ident/log/condition_parts.hpp>
#include <stribeck/ident/log/motion.hpp>
#include <stribeck/ident/refused.hpp>
#include <utility>

namespace stribeck::ident::log {

using namespace parts;

namespace {

constexpr std::size_t kFewestRows = 100;  // as problems() of a record

bool turning(const std::string& unit) { return unit == "rad"; }

std::string unit_of_way(const std::string& unit) { return turning(unit) ? "rad" : "mm"; }

bool constant(const std::vector<Table>& tables, std::vector<double> Table::*column) {
  for (const Table& m : tables) {
    const std::vector<double>& y = m.*column;
    if (y.empty()) return false;
    for (const double value : y) {
      if (value != (tables.front().*column).front()) return false;
    }
  }
  return true;
}

/// Position from velocity where the log has none; starts at 0.
void integrate_velocity(std::vector<Table>& tables, bool reference) {
  double at = 0.0;
  for (Table& m : tables) {
    const std::vector<double>& rate = reference ? m.r : m.v;
    std::vector<double> way(rate.size());
    if (reference) at = m.x.front();
    for (std::size_t k = 0; k < rate.size(); ++k) {
      if (k > 0) at += 0.5 * m.sample_time * (rate[k - 1] + rate[k]);
      way[k] = at;
    }
    (reference ? m.r : m.x) = std::move(way);
  }
}

/// Slope of y over dx/dt and how well it holds, over stretches long enough that resolution does not matter.
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
      const double way = m.x[k] - m.x[first];
      const auto n = static_cast<double>(k - first);
      if (n < 8.0 || (k - first) % 4 != 0) continue;
      // Not before both have gone far beyond what their resolution makes of rest.
      const double least = 20.0 * x_resolution + 10.0 * v_resolution * m.sample_time * std::sqrt(n);
      if (std::abs(way) < least && std::abs(sum) < least) {
        if (n > 2000.0) {
          sum = 0.0;
          first = k;
        }
        continue;
      }
      xx += way * way;
      yy += sum * sum;
      xy += way * sum;
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

void check_velocity(std::vector<Table>& tables, const Sampling& sampling, Notes& notes) {
  if (tables.front().v.empty() || tables.front().x.empty()) return;
  const auto drop = [&] {
    for (Table& m : tables) m.v.clear();
  };
  if (constant(tables, &Table::v)) {
    notes.add_all("stuck", tables.front().source, true,
                  text("the velocity keeps the value %.6g in every row; not used", tables.front().v.front()));
    drop();
    return;
  }
  const Ratio r =
      ratio_of(tables, sampling.x_quantum_large > 0.0 ? sampling.x_quantum_large : sampling.x_noise,
               std::max(sampling.v_quantum, sampling.v_noise));
  if (r.stretches < 5) return;
  if (std::abs(r.correlation) < 0.6) {
    if (!notes.wanted("velocity")) return;
    notes.add_all("velocity", tables.front().source, true,
                  text("the velocity is not the rate of the position (correlation %.2f): rows are missing "
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
        text("the velocity has the opposite sign of the rate of the position (%.4f of it); turned", r.slope),
        {r.slope});
    for (Table& m : tables) {
      for (double& v : m.v) v = -v;
    }
    return;
  }
  if (std::abs(r.slope - 1.0) < 0.1) return;
  struct Factor {
    double value;
    const char* reason;
  };
  constexpr std::array<Factor, 9> kFactors{{{1000.0, "mm for m, or ms for s"},
                                            {60.0, "per minute for per second"},
                                            {25.4, "mm for inch"},
                                            {6.283185307179586, "rad for turns"},
                                            {57.29577951308232, "degrees for rad"},
                                            {60000.0, "mm/min for m/s"},
                                            {16.666666666666668, "m/min for mm/s"},
                                            {9.549296585513721, "turns per minute for rad/s"},
                                            {360.0, "degrees for turns"}}};
  std::string reason;
  for (const Factor& f : kFactors) {
    const double by = std::abs(r.slope);
    if (std::abs(by / f.value - 1.0) < 0.03) reason = text(" (as %s would do)", f.reason);
    if (std::abs(by * f.value - 1.0) < 0.03)
      reason = text(" (as %s, the other way round, would do)", f.reason);
  }
  if (!notes.wanted("velocity")) return;
  throw Refused(
      tables.front().source +
      text(": the velocity is %.4g times the rate of the position%s: the unit of velocity, position or "
           "time is wrong, and the log does not say which. Give the right one (--map v=\"COLUMN UNIT\"), "
           "or leave the velocity out (--keep velocity)",
           r.slope, reason.c_str()));
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
    return drop(text("the reference has little to do with the position (correlation %.2f)", correlation),
                correlation);
  if (std::abs(correlation) > 0.95 && (slope < 0.5 || slope > 2.0))
    return drop(
        text("the reference moves %.4g times as far as the position: one of the units or signs is wrong",
             slope),
        slope);
}

double middle_of(std::array<double, 4> a) {
  std::sort(a.begin(), a.end());
  return 0.5 * (a[1] + a[2]);
}

/// How far a sample stands off its neighbours, and how far these differ among themselves.
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

/// Single samples far off their neighbours, which agree with each other.
void mend_spikes(std::vector<Table>& tables, double resolution, std::vector<double> Table::*column,
                 const char* name, Notes& notes) {
  if (!notes.wanted("spike") || (tables.front().*column).empty()) return;
  std::vector<double> offs;
  for (const Table& m : tables) {
    const std::vector<double>& y = m.*column;
    const std::size_t stride = std::max<std::size_t>(1, y.size() / 20000);
    for (std::size_t k = 2; k + 2 < y.size(); k += stride) {
      const Off o = off_neighbours(y, k);
      if (o.here != 0.0 || o.around != 0.0) offs.push_back(std::abs(o.here));
    }
  }
  if (offs.size() < 50) return;
  double limit = std::max(kWild * quantile(offs, 0.995), 5.0 * resolution);
  if (column != &Table::x) {
    // A controller may well answer with a short push; what is far outside all other values is none.
    std::vector<double> all;
    for (const Table& m : tables) {
      const std::vector<double> some =
          sample_of(m.*column, std::max<std::size_t>(200, 20000 / tables.size()));
      all.insert(all.end(), some.begin(), some.end());
    }
    limit = std::max(limit, 1.5 * (quantile(all, 0.999) - quantile(all, 0.001)));
  }
  if (!(limit > 0.0)) return;
  std::size_t found = 0;
  Table* first_table = nullptr;
  std::size_t first = 0;
  double first_value = 0.0;
  double first_mended = 0.0;
  std::vector<std::pair<Table*, std::size_t>> all;
  for (Table& m : tables) {
    const std::vector<double>& y = m.*column;
    if (y.size() < 10) continue;
    for (std::size_t k = 0; k < y.size(); ++k) {
      // Cheap first: a spike leaves and comes back.
      if (k > 0 && k + 1 < y.size() && std::abs(y[k] - y[k - 1]) < 0.5 * limit) continue;
      const Off o = off_neighbours(y, k);
      if (std::abs(o.here) <= limit || o.around > 0.3 * std::abs(o.here)) continue;
      all.emplace_back(&m, k);
    }
  }
  std::size_t rows = 0;
  for (const Table& m : tables) rows += m.rows();
  // What comes often belongs to the axis.
  if (all.empty() || all.size() * 1000 > rows + 3000) return;
  for (const auto& [m, k] : all) {
    std::vector<double>& y = m->*column;
    const double value = y[k];
    y[k] = k == 0 ? y[1] : k + 1 == y.size() ? y[k - 1] : 0.5 * (y[k - 1] + y[k + 1]);
    m->mark[k] |= kRepairedRow;
    if (found++ == 0) {
      first_table = m;
      first = k;
      first_value = value;
      first_mended = y[k];
    }
  }
  notes.add(
      "spike", *first_table, first, true,
      text("the %s is %.6g between neighbours of %.6g: edited or disturbed%s; replaced by its neighbours",
           name, first_value, first_mended,
           found > 1 ? text(", the first of %zu such samples", found).c_str() : ""),
      {first_value, first_mended, static_cast<double>(found)});
}

/// Positions that jump between two rows while the speed before and after is the same.
std::vector<Table> cut_at_jumps(std::vector<Table> tables, const Sampling& sampling, Notes& notes) {
  if (!notes.wanted("jump")) return tables;
  const auto off_step = [](const std::vector<double>& x, std::size_t k, double& change) {
    const double before = 0.5 * (x[k - 1] - x[k - 3]);
    const double after = 0.5 * (x[k + 2] - x[k]);
    change = after - before;
    return x[k] - x[k - 1] - 0.5 * (before + after);
  };
  std::vector<double> offs;
  for (const Table& m : tables) {
    const std::size_t stride = std::max<std::size_t>(1, m.rows() / 20000);
    for (std::size_t k = 3; k + 2 < m.rows(); k += stride) {
      double change = 0.0;
      const double off = off_step(m.x, k, change);
      if (off != 0.0) offs.push_back(std::abs(off));
    }
  }
  if (offs.size() < 50) return tables;
  const double limit =
      std::max({kWild * quantile(offs, 0.995), 5.0 * sampling.x_quantum_large, 20.0 * sampling.x_noise});
  std::vector<Table> out;
  for (Table& m : tables) {
    std::size_t from = 0;
    std::size_t found = 0;
    for (std::size_t k = 3; k + 2 < m.rows(); ++k) {
      double change = 0.0;
      const double jump = off_step(m.x, k, change);
      if (std::abs(jump) <= limit || std::abs(change) > 0.3 * std::abs(jump)) continue;
      // A reference that jumps too was programmed so.
      if (!m.r.empty() && std::abs(m.r[k] - m.r[k - 1]) > 0.5 * std::abs(jump)) continue;
      if (found++ == 0) {
        notes.add("jump", m, k, true,
                  text("the position jumps by %s without any change of speed: rows are missing or the "
                       "encoder was set; cut there",
                       notes.way(jump).c_str()),
                  {jump});
      }
      out.push_back(slice(m, from, k));
      out.back().gap_before = m.gap_before || from > 0;
      from = k;
    }
    const bool whole = from == 0;
    out.push_back(whole ? std::move(m) : slice(m, from, m.rows()));
    if (from > 0) out.back().gap_before = true;
  }
  return out;
}

/// Force that keeps its value to the last bit while the axis is accelerated.
std::vector<Table> cut_stuck_force(std::vector<Table> tables, double hold, Notes& notes) {
  if (!notes.wanted("stuck")) return tables;
  std::size_t same = 0;
  std::size_t rows = 0;
  for (const Table& m : tables) {
    for (std::size_t k = 1; k < m.rows(); ++k) same += m.f[k] == m.f[k - 1] ? 1 : 0;
    rows += m.rows();
  }
  if (same * 5 > rows) return tables;  // coarse or programmed: constant stretches belong to it
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const Table& m : tables) {
    const auto [a, b] = std::minmax_element(m.f.begin(), m.f.end());
    low = std::min(low, *a);
    high = std::max(high, *b);
  }
  const auto shortest = static_cast<std::size_t>(50.0 * hold);
  // A programmed force rests between its ramps, where the axis springs back; it gets there and away in small steps.
  constexpr double kSmallStep = 0.1;  // of the whole range
  const auto programmed = [&](const Table& m, std::size_t first, std::size_t last) {
    const double step = kSmallStep * (high - low);
    const bool in = first == 0 || std::abs(m.f[first] - m.f[first - 1]) < step;
    const bool out = last + 1 >= m.rows() || std::abs(m.f[last + 1] - m.f[last]) < step;
    return in && out && quiet(m.f);
  };
  std::vector<Table> out;
  for (Table& m : tables) {
    std::size_t from = 0;
    std::size_t begin = 0;
    for (std::size_t k = 1; k <= m.rows(); ++k) {
      if (k < m.rows() && m.f[k] == m.f[begin]) continue;
      const bool moves = k - begin > shortest && m.x[k - 1] != m.x[begin];
      const bool limit = m.f[begin] == low || m.f[begin] == high;
      if (moves && !limit && !programmed(m, begin, k - 1)) {
        notes.add_range(
            "stuck", m, begin, k - 1, true,
            text("the force keeps the value %.6g to the last digit while the axis moves: the channel was "
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

void measure(const std::vector<Table>& tables, Sampling& s) {
  std::vector<double> x;
  std::vector<double> v;
  std::vector<double> f;
  constexpr std::size_t kMost = 20000;
  const std::size_t each =
      std::max<std::size_t>(kFewestRows, kMost / std::max<std::size_t>(1, tables.size()));
  double noise_x = 0.0;
  double noise_v = 0.0;
  double noise_f = 0.0;
  double weight = 0.0;
  for (const Table& m : tables) {
    const auto add = [&](const std::vector<double>& from, std::vector<double>& to) {
      const std::vector<double> some = sample_of(from, each);
      to.insert(to.end(), some.begin(), some.end());
    };
    add(m.x, x);
    add(m.v, v);
    add(m.f, f);
    const auto w = static_cast<double>(m.rows());
    const auto noise = [&](const std::vector<double>& y) {
      const std::vector<double> some = sample_of(y, each);
      return some.size() > 20 ? w * std::pow(position_noise(some), 2.0) : 0.0;
    };
    noise_x += noise(m.x);
    noise_v += noise(m.v);
    noise_f += noise(m.f);
    weight += w;
  }
  s.x_quantum = quantum(x);
  s.x_quantum_large = s.x_quantum;
  // Numbers printed with few digits are coarser where they are large.
  std::vector<double> decade;
  double largest = 0.0;
  for (const double value : x) largest = std::max(largest, std::abs(value));
  for (double top = largest; top > 1e-6 * largest && top > 0.0; top /= 10.0) {
    decade.clear();
    const double power = std::pow(10.0, std::floor(std::log10(top)));
    for (const double value : x) {
      if (std::abs(value) >= power && std::abs(value) < 10.0 * power) decade.push_back(value);
    }
    if (decade.size() * 20 > x.size()) s.x_quantum_large = std::max(s.x_quantum_large, quantum(decade));
  }
  s.v_quantum = quantum(v);
  s.f_quantum = quantum(f);
  s.x_noise = std::sqrt(noise_x / weight);
  s.v_noise = std::sqrt(noise_v / weight);
  s.f_noise = std::sqrt(noise_f / weight);
}

/// Marks standstill at both ends.
void mark_rest(Table& m, double resolution) {
  const double play = std::max(3.0 * resolution, 1e-12);
  std::size_t last = m.rows();
  while (last > 0 && std::abs(m.x[last - 1] - m.x.back()) <= play) --last;
  std::size_t first = 0;
  while (first < m.rows() && std::abs(m.x[first] - m.x.front()) <= play) ++first;
  if (first >= m.rows()) return;  // it never moves: not for this mark to say
  for (std::size_t k = 0; k < first; ++k) m.mark[k] |= kAtRest;
  for (std::size_t k = last; k < m.rows(); ++k) m.mark[k] |= kAtRest;
}

/// Strokes longer than the hysteresis, and the rows soon after each turn.
void count_strokes(const std::vector<double>& x, double hysteresis, double near, Coverage& c,
                   std::vector<double>& rows_near) {
  std::size_t low = 0;
  std::size_t high = 0;
  int direction = 0;
  std::vector<std::size_t> turns;
  for (std::size_t k = 0; k < x.size(); ++k) {
    if (x[k] >= x[high]) high = k;
    if (x[k] <= x[low]) low = k;
    if (direction <= 0 && x[k] - x[low] > hysteresis) {
      if (direction != 0) turns.push_back(low);
      direction = 1;
      high = k;
      ++c.strokes;
    } else if (direction >= 0 && x[high] - x[k] > hysteresis) {
      if (direction != 0) turns.push_back(high);
      direction = -1;
      low = k;
      ++c.strokes;
    }
  }
  c.reversals += turns.size();
  for (const std::size_t turn : turns) {
    std::size_t k = turn;
    while (k < x.size() && std::abs(x[k] - x[turn]) < near) ++k;
    rows_near.push_back(static_cast<double>(k - turn));
  }
}

Coverage cover(const std::vector<Table>& tables, const Sampling& s, const std::string& unit) {
  Coverage c;
  c.x_min = c.f_min = std::numeric_limits<double>::infinity();
  c.x_max = c.f_max = -c.x_min;
  std::vector<double> speeds;
  std::vector<double> velocities;
  std::vector<double> accelerations;
  std::vector<double> short_of_breakaway;
  const double presliding = turning(unit) ? 1e-3 : 50e-6;
  std::size_t moving = 0;
  std::size_t forward = 0;
  for (const Table& m : tables) {
    for (std::size_t k = 0; k < m.rows(); ++k) {
      c.x_min = std::min(c.x_min, m.x[k]);
      c.x_max = std::max(c.x_max, m.x[k]);
      c.f_min = std::min(c.f_min, m.f[k]);
      c.f_max = std::max(c.f_max, m.f[k]);
    }
  }
  constexpr std::size_t kMost = 40000;
  std::size_t rows = 0;
  for (const Table& m : tables) rows += m.rows();
  for (const Table& m : tables) {
    if (m.rows() < kFewestRows) continue;
    const auto share =
        static_cast<std::size_t>(static_cast<double>(m.rows()) *
                                 std::min(1.0, static_cast<double>(kMost) / static_cast<double>(rows)));
    Record record;
    record.sample_time = m.sample_time;
    constexpr std::size_t kParts = 8;
    const std::size_t length = std::max(kFewestRows, share / kParts);
    std::vector<std::size_t> firsts{0};
    const bool all = length * kParts >= m.rows();
    if (!all) {
      for (std::size_t i = 1; i < kParts; ++i) firsts.push_back(i * (m.rows() - length) / (kParts - 1));
    }
    for (const std::size_t first : firsts) {
      const Table part = slice(m, first, all ? m.rows() : first + length);
      record.t = part.t;
      record.x = part.x;
      record.f = part.f;
      record.loop = Loop::kClosed;
      const Motion motion = reconstruct(record);
      for (std::size_t k = 0; k < motion.rows(); ++k) {
        if (!motion.valid(k)) continue;
        velocities.push_back(motion.v[k]);
        speeds.push_back(std::abs(motion.v[k]));
        accelerations.push_back(std::abs(motion.a[k]));
      }
    }
  }
  const double hysteresis = std::max({std::min(20.0 * s.x_noise, 0.05 * (c.x_max - c.x_min)),
                                      3.0 * s.x_quantum_large, 2e-3 * (c.x_max - c.x_min)});
  for (const Table& m : tables) count_strokes(m.x, hysteresis, presliding, c, short_of_breakaway);
  if (speeds.empty()) return c;
  c.v_max = std::max(0.0, quantile(velocities, 0.999));
  c.v_min = std::min(0.0, quantile(velocities, 0.001));
  c.a_max = quantile(accelerations, 0.995);
  const double limit = 0.003 * quantile(speeds, 0.99);
  std::vector<double> sliding;
  for (std::size_t k = 0; k < speeds.size(); ++k) {
    if (speeds[k] <= limit) continue;
    ++moving;
    sliding.push_back(speeds[k]);
    if (velocities[k] > 0.0) ++forward;
  }
  c.slowest = sliding.empty() ? 0.0 : quantile(sliding, 0.02);
  c.moving = static_cast<double>(moving) / static_cast<double>(speeds.size());
  c.forward = moving > 0 ? static_cast<double>(forward) / static_cast<double>(moving) : 0.0;
  if (!short_of_breakaway.empty())
    c.rows_presliding = static_cast<std::size_t>(quantile(short_of_breakaway, 0.5));
  return c;
}

/// What such a log can tell and what not.
void judge(Conditioned& out, const std::string& unit) {
  const Coverage& c = out.coverage;
  const Sampling& s = out.sampling;
  const RoughFit& r = out.rough;
  const std::string way = unit_of_way(unit);
  const std::string speed = way + "/s";
  const double scale = turning(unit) ? 1.0 : 1e3;
  auto& can = out.determinable;
  auto& cannot = out.cannot_tell;
  const bool both = c.forward > 0.03 && c.forward < 0.97;
  if (!r.good || c.moving <= 0.0) {
    cannot.push_back("mass and friction: the axis hardly moves in this log");
  } else if (r.mass_shows) {
    can.push_back(
        text("mass: acceleration up to %.3g %s/s2 shows in the force", scale * c.a_max, way.c_str()));
  } else {
    cannot.push_back(
        text("mass: the acceleration (up to %.3g %s/s2) explains next to nothing of the force; add a log "
             "of pulses or of a faster reversal",
             scale * c.a_max, way.c_str()));
  }
  if (both) {
    can.push_back(text("friction by direction, and load apart from it: %.0f %% of the moving rows go forward",
                       100.0 * c.forward));
  } else if (c.moving > 0.0) {
    cannot.push_back(
        "load (weight) apart from friction: it moves in one direction only; add the motion back at the same "
        "speeds");
  }
  const double fastest = std::max(c.v_max, -c.v_min);
  if (fastest > 0.0 && c.slowest < 0.4 * fastest) {
    can.push_back(
        text("friction over speed, from %.3g to %.3g %s", scale * c.slowest, scale * fastest, speed.c_str()));
  } else if (fastest > 0.0) {
    cannot.push_back(
        text("viscous friction and its low-speed part: all speeds lie between %.3g and %.3g %s; add slower "
             "and faster motion",
             scale * c.slowest, scale * fastest, speed.c_str()));
  }
  const double resolution = std::max(s.x_quantum_large, 3.0 * s.x_noise);
  const double finest_period = std::max(8.0 * resolution, 4.0 * fastest * s.sample_time);
  const double travel = c.x_max - c.x_min;
  if (travel > 0.0 && finest_period < 0.25 * travel) {
    can.push_back(text("terms periodic in position, periods from %.3g to %.3g %s", scale * finest_period,
                       scale * travel / 3.0, way.c_str()));
  } else {
    cannot.push_back(
        text("terms periodic in position: the travel of %.4g %s holds too few periods that this sampling "
             "can see",
             scale * travel, way.c_str()));
  }
  // Break-away of guides and screws lies at 1 to 100 µm; five steps are needed to see a stiffness.
  const double coarse = turning(unit) ? 0.2e-3 : 10e-6;
  constexpr std::size_t kFewestInside = 4;
  if (resolution > coarse) {
    const bool steps = s.x_quantum_large > coarse;
    cannot.push_back(text(
        "pre-sliding: the position is too coarse, %.3g %s %s%s (break-away lies at %s, and five steps "
        "within it are the least)",
        scale * (steps ? s.x_quantum_large : resolution), way.c_str(),
        steps ? "between its values" : "of noise (3 sigma)",
        s.x_quantum_large > 1.5 * s.x_quantum && s.x_quantum > 0.0
            ? text(" where the numbers are large, %.3g where they are small", scale * s.x_quantum).c_str()
            : "",
        turning(unit) ? "0.1 to 10 mrad" : "1 to 100 um"));
  } else if (c.reversals == 0) {
    cannot.push_back(
        "pre-sliding (stiffness, break-away distance): no reversal in this log; add slow reversals");
  } else if (c.rows_presliding < kFewestInside) {
    cannot.push_back(
        text("pre-sliding: after a reversal only %zu rows (of %.3g s) lie within the first %s; reverse "
             "more slowly or sample faster",
             c.rows_presliding, s.sample_time, turning(unit) ? "1 mrad" : "50 um"));
  } else {
    can.push_back(text(
        "pre-sliding: %zu reversals, %zu rows within the first %s after each, position resolution %.3g %s",
        c.reversals, c.rows_presliding, turning(unit) ? "1 mrad" : "50 um", scale * resolution, way.c_str()));
  }
  if (resolution > coarse && s.sample_time > 0.02) {
    cannot.back() += text("; besides, %.3g s between rows is longer than a reversal takes", s.sample_time);
  }
}

}  // namespace

namespace parts {

Notes::Notes(const ConditionOptions& options) : keep_(options.keep) {
  for (const std::string& kind : keep_) {
    const auto& all = finding_kinds();
    if (std::find(all.begin(), all.end(), kind) != all.end()) continue;
    std::string names;
    for (const std::string& k : all) names += (names.empty() ? "" : ", ") + k;
    throw Refused("--keep: unknown kind \"" + kind + "\", expected one of " + names);
  }
}

std::string Notes::way(double value) const {
  return turns_ ? parts::text("%.4g rad", value) : parts::text("%.4g mm", 1e3 * value);
}

bool Notes::has(std::string_view kind) const {
  return std::any_of(found_.begin(), found_.end(), [&](const Finding& f) { return f.kind == kind; });
}

bool Notes::wanted(std::string_view kind) const {
  return std::find(keep_.begin(), keep_.end(), kind) == keep_.end();
}

void Notes::add(std::string kind, const Table& m, std::size_t k, bool repaired, const std::string& what,
                std::vector<double> values) {
  if (!wanted(kind)) return;
  found_.push_back({std::move(kind), m.source + parts::text(": row %zu (%.6g s): ", m.row[k], m.t[k]) + what,
                    m.row[k], m.t[k], repaired, std::move(values)});
}

void Notes::add_range(std::string kind, const Table& m, std::size_t k, std::size_t last, bool repaired,
                      const std::string& what, std::vector<double> values) {
  if (!wanted(kind)) return;
  found_.push_back(
      {std::move(kind),
       m.source +
           parts::text(": rows %zu to %zu (%.6g to %.6g s): ", m.row[k], m.row[last], m.t[k], m.t[last]) +
           what,
       m.row[k], m.t[k], repaired, std::move(values)});
}

void Notes::add_all(std::string kind, const std::string& source, bool repaired, const std::string& what,
                    std::vector<double> values) {
  if (!wanted(kind)) return;
  found_.push_back({std::move(kind), source + ": " + what, 0, 0.0, repaired, std::move(values)});
}

}  // namespace parts

const std::vector<std::string>& finding_kinds() {
  static const std::vector<std::string> kinds{
      "double-time", "rounded-time", "time-back",     "jitter",    "gap",       "time-bases",
      "held",        "frozen",       "stuck",         "velocity",  "spike",     "jump",
      "reference",   "drive-off",    "unsigned",      "inverted",  "saturated", "short",
      "irregular",   "no-position",  "contradiction", "mixed-runs"};
  return kinds;
}

namespace {

/// Squares and sums of what comes after this are still numbers.
void refuse_absurd(const RawLog& log) {
  constexpr double kAbsurd = 1e30;
  const auto look = [&](const std::vector<double>& y, const char* name) {
    for (std::size_t k = 0; k < y.size(); ++k) {
      if (!(std::abs(y[k]) >= kAbsurd)) continue;  // NaN is found with its column
      throw Refused(log.source +
                    text(": row %zu: the %s is %g, which no machine logs; repair or cut the log, or check "
                         "the unit of the column",
                         k < log.row.size() ? log.row[k] : k + 1, name, y[k]));
    }
  };
  for (const auto& [signal, name] : {std::pair{&log.x, "position"},
                                     {&log.r, "reference"},
                                     {&log.v, "velocity"},
                                     {&log.v_ref, "reference of the velocity"},
                                     {&log.f, "force"}}) {
    look(signal->t, "time");
    look(signal->y, name);
  }
}

/// A column in another unit than its header says may be off by powers of ten, but hardly so far.
void refuse_implausible(const std::vector<Table>& tables, const std::string& source, bool position,
                        const std::string& force_unit, const std::string& position_unit) {
  constexpr double kLeastStep = 1e-9, kMostStep = 1e5;  // [s]
  constexpr double kLeastWay = 1e-12, kMostWay = 1e7;   // [m] or [rad], of velocities per second
  constexpr double kLeastForce = 1e-12, kMostForce = 1e12;
  const auto range_of = [&](std::vector<double> Table::*column) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Table& m : tables) {
      const auto [a, b] = std::minmax_element((m.*column).begin(), (m.*column).end());
      if (a == (m.*column).end()) continue;
      low = std::min(low, *a), high = std::max(high, *b);
    }
    return high - low;
  };
  const auto check = [&](double value, double least, double most, const char* what, const std::string& unit) {
    if (value >= least && value <= most) return;
    throw Refused(
        source +
        text(": %s %.3g %s, which no machine has (expected %g to %g); the unit of the column is wrong", what,
             value, unit.c_str(), least, most));
  };
  for (const Table& m : tables) check(m.sample_time, kLeastStep, kMostStep, "the time between rows is", "s");
  check(range_of(position ? &Table::x : &Table::v), kLeastWay, kMostWay,
        position ? "the position ranges over" : "the velocity ranges over",
        position ? position_unit : position_unit + "/s");
  check(range_of(&Table::f), kLeastForce, kMostForce, "the force ranges over", force_unit);
}

}  // namespace

Conditioned condition(RawLog log, const ConditionOptions& options) {
  std::vector<RawLog> runs;
  runs.push_back(std::move(log));
  return condition(std::move(runs), options);
}

Conditioned condition(std::vector<RawLog> runs, const ConditionOptions& options) {
  if (runs.empty()) throw Refused("no log was given");
  Conditioned out;
  Notes notes(options);
  Sampling& s = out.sampling;
  const std::string& unit = runs.front().position_unit;
  const std::string& source = runs.front().source;
  const bool position = !runs.front().x.empty();
  const bool integrate_reference = runs.front().r.empty() && !runs.front().v_ref.empty();
  for (const RawLog& log : runs) {
    refuse_absurd(log);
    if (log.position_unit != unit || log.force_unit != runs.front().force_unit || log.x.empty() == position) {
      throw Refused(log.source + ": other quantities or units than " + source +
                    "; runs of one axis need the same");
    }
  }
  notes.turns(turning(unit));
  std::vector<Table> tables;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    std::vector<Table> pieces = regular_pieces(one_table(runs[i], i, notes), s, notes);
    std::move(pieces.begin(), pieces.end(), std::back_inserter(tables));
  }

  for (const auto column : {&Table::r, &Table::v}) {
    const bool everywhere =
        std::all_of(tables.begin(), tables.end(), [&](const Table& m) { return !(m.*column).empty(); });
    if (!everywhere && (column != &Table::v || position)) {
      for (Table& m : tables) (m.*column).clear();
    }
  }
  // A channel without any change says nothing; where it is needed there is no way on.
  if (constant(tables, &Table::f))
    throw Refused(source + text(": the force keeps the value %.6g in every row: the channel is stuck or not "
                                "recorded (choose another one with --map)",
                                tables.front().f.front()));
  if (constant(tables, position ? &Table::x : &Table::v))
    throw Refused(source +
                  text(": the %s keeps the value %.6g in every row: the axis did not move or the channel "
                       "is stuck (choose another one with --map)",
                       position ? "position" : "velocity", tables.front().motion().front()));

  refuse_implausible(tables, source, position, runs.front().force_unit, unit);

  s.x_hold = position ? hold_of(tables, &Table::x) : 1.0;
  s.v_hold = tables.front().v.empty() ? 1.0 : hold_of(tables, &Table::v);
  s.f_hold = hold_of(tables, &Table::f);
  tables = without_frozen(std::move(tables), std::max({s.x_hold, s.v_hold, s.f_hold}), notes);
  tables = on_slow_grid(std::move(tables), s, notes);
  if (position && s.v_hold > 1.5 * std::max(s.x_hold, s.f_hold)) {
    for (Table& m : tables) m.v.clear();
    notes.add_all(
        "held", source, true,
        text("the velocity is new only every %.4g rows, slower than the position; not used", s.v_hold),
        {s.v_hold});
  }
  std::size_t dropped = 0;
  const auto drop_short = [&] {
    std::vector<Table> long_enough;
    for (Table& m : tables) {
      if (m.rows() >= kFewestRows) {
        long_enough.push_back(std::move(m));
      } else {
        if (dropped++ == 0 && m.rows() > 0)
          notes.add_range("short", m, 0, m.rows() - 1, true,
                          text("a piece of %zu rows, fewer than %zu; left out", m.rows(), kFewestRows),
                          {static_cast<double>(m.rows())});
      }
    }
    tables = std::move(long_enough);
    if (tables.empty()) {
      throw Refused(source +
                    text(": no stretch of %zu rows is left that can be used (see the findings of --inspect)",
                         kFewestRows));
    }
  };
  drop_short();
  if (!position) {
    integrate_velocity(tables, false);
    notes.add_all(
        "no-position", source, true,
        "no position in this log; integrated from the velocity, starting at zero: terms periodic in "
        "position and pre-sliding are not determined");
  }
  if (integrate_reference && !tables.front().r.empty()) integrate_velocity(tables, true);
  measure(tables, s);
  mend_spikes(tables, std::max(s.x_quantum_large, 3.0 * s.x_noise), &Table::x, "position", notes);
  if (position) mend_spikes(tables, s.v_quantum, &Table::v, "velocity", notes);
  mend_spikes(tables, s.f_quantum, &Table::f, "force", notes);
  if (position) {
    tables = cut_at_jumps(std::move(tables), s, notes);
    check_velocity(tables, s, notes);
  }
  check_reference(tables, notes);
  tables = cut_stuck_force(std::move(tables), s.f_hold, notes);
  cut_drive_off(tables, notes);
  drop_short();
  measure(tables, s);
  recover_signs(tables, notes);
  mend_sign(tables, notes);
  find_saturation(tables, notes);
  for (Table& m : tables) mark_rest(m, std::max(s.x_quantum, s.x_noise));
  out.rough = rough_fit(tables);
  std::vector<double> times;
  for (const Table& m : tables) times.push_back(m.sample_time);
  s.sample_time = quantile(times, 0.5);
  out.coverage = cover(tables, s, unit);
  judge(out, unit);
  if (!position) {
    const auto of_position = [](const std::string& t) {
      return t.rfind("terms", 0) == 0 || t.rfind("pre-sliding", 0) == 0;
    };
    std::erase_if(out.determinable, of_position);
    std::erase_if(out.cannot_tell, of_position);
    out.cannot_tell.push_back("terms periodic in position, pre-sliding: there is no position in this log");
  }

  if (notes.has("irregular")) {
    std::erase_if(out.determinable, [](const std::string& t) { return t.rfind("terms", 0) != 0; });
    std::erase_if(out.cannot_tell, [](const std::string& t) { return t.rfind("terms", 0) != 0; });
    out.cannot_tell.push_back(
        "mass, friction over speed, pre-sliding, delay: the rows were taken at irregular times; what is "
        "left is force over position");
  }

  for (Table& m : tables) {
    const RawLog& raw = runs[m.run];
    Record record;
    record.source = raw.source;
    record.sample_time = m.sample_time;
    record.t = std::move(m.t);
    record.x = std::move(m.x);
    record.r = std::move(m.r);
    record.v = std::move(m.v);
    record.f = std::move(m.f);
    record.loop = raw.loop;
    record.force_unit = raw.force_unit;
    record.position_unit = raw.position_unit;
    constexpr unsigned kNotFitted = kSignUnsure | kAtLimit | kRepairedRow;
    if (std::any_of(m.mark.begin(), m.mark.end(), [](std::uint8_t k) { return (k & kNotFitted) != 0; })) {
      record.skip.resize(m.mark.size());
      for (std::size_t k = 0; k < m.mark.size(); ++k) record.skip[k] = (m.mark[k] & kNotFitted) != 0 ? 1 : 0;
    }
    out.records.push_back(std::move(record));
    out.marks.push_back(std::move(m.mark));
    out.rows.push_back(std::move(m.row));
    out.run.push_back(m.run);
  }
  out.findings = notes.take();
  return out;
}

}  // namespace stribeck::ident::log
