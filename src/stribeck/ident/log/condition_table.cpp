// One table of equally spaced rows, means over its columns, and the notes on what was found.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/log/condition_parts.hpp>
#include <stribeck/ident/refused.hpp>
#include <string_view>
#include <utility>

namespace stribeck::ident::log::parts {

Table slice(const Table& m, std::size_t first, std::size_t last) {
  Table out;
  out.source = m.source;
  out.run = m.run;
  out.sample_time = m.sample_time;
  out.counted = m.counted;
  out.x_step = m.x_step;
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

bool same_row(const Table& m, std::size_t a, std::size_t b) {
  const auto same = [&](const std::vector<double>& c) { return c.empty() || c[a] == c[b]; };
  return same(m.x) && same(m.r) && same(m.v) && same(m.f);
}

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

Notes::Notes(const ConditionOptions& options) : keep_(options.keep) {
  for (const std::string& kind : keep_) {
    const auto& all = finding_kinds();
    if (std::find(all.begin(), all.end(), kind) != all.end()) continue;
    std::string names;
    for (const std::string& k : all) names += (names.empty() ? "" : ", ") + k;
    throw Refused("--keep: unknown kind \"" + kind + "\", expected one of " + names);
  }
}

std::string Notes::travel(double value) const {
  if (rotary_) return fmt::format("{:.4g} deg", value * 180.0 / kPi);
  return turns_ ? fmt::format("{:.4g} rad", value) : fmt::format("{:.4g} mm", 1e3 * value);
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
  found_.push_back({std::move(kind), m.source + fmt::format(": row {} ({:.6g} s): ", m.row[k], m.t[k]) + what,
                    m.row[k], m.t[k], repaired, std::move(values)});
}

void Notes::add_range(std::string kind, const Table& m, std::size_t k, std::size_t last, bool repaired,
                      const std::string& what, std::vector<double> values) {
  if (!wanted(kind)) return;
  found_.push_back(
      {std::move(kind),
       m.source +
           fmt::format(": rows {} to {} ({:.6g} to {:.6g} s): ", m.row[k], m.row[last], m.t[k], m.t[last]) +
           what,
       m.row[k], m.t[k], repaired, std::move(values)});
}

void Notes::add_all(std::string kind, const std::string& source, bool repaired, const std::string& what,
                    std::vector<double> values) {
  if (!wanted(kind)) return;
  found_.push_back({std::move(kind), source + ": " + what, 0, 0.0, repaired, std::move(values)});
}

std::vector<Finding> Notes::take() {
  std::vector<Finding> out;
  std::vector<std::size_t> times;
  // The same file, and the same words behind the place: "file: row 3 (0.2 s): the rows are not equally spaced (a step of …".
  const auto alike = [](const Finding& a, const Finding& b) {
    constexpr std::size_t kWords = 20;
    constexpr std::string_view kPlace = " s): ";
    const auto file = [](const Finding& f) {
      return std::string_view(f.text).substr(0, f.text.find(": row"));
    };
    const auto words = [&](const Finding& f) {
      const std::size_t at = f.text.find(kPlace);
      return at == std::string::npos ? std::string_view(f.text)
                                     : std::string_view(f.text).substr(at + kPlace.size(), kWords);
    };
    return a.kind == "jitter" && b.kind == "jitter" && !a.values.empty() && !b.values.empty() &&
           file(a) == file(b) && words(a) == words(b);
  };
  for (Finding& f : found_) {
    const auto same = f.kind != "jitter" ? out.end()
                                         : std::find_if(out.begin(), out.end(),
                                                        [&](const Finding& g) { return alike(f, g); });
    if (same == out.end()) {
      out.push_back(std::move(f));
      times.push_back(1);
      continue;
    }
    ++times[static_cast<std::size_t>(same - out.begin())];
    if (f.values.front() > same->values.front()) *same = std::move(f);
  }
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (times[i] > 1) out[i].text += fmt::format(" (the worst of {} pieces of the log)", times[i]);
  }
  found_.clear();
  return out;
}

}  // namespace stribeck::ident::log::parts
