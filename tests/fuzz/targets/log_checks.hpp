#pragma once
/// What holds of every log and every refusal.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stribeck/io/error.hpp>
#include <stribeck/io/log/log.hpp>
#include <stribeck/io/printable.hpp>
#include <tests/fuzz/targets/fuzz.hpp>

namespace stribeck::fuzz {

inline void check(const io::Log& log) {
  demand(log.rows >= 2, "fewer than two rows");
  demand(!log.columns.empty(), "no columns");
  for (const auto& c : log.columns) {
    const std::size_t n = c.texts.empty() ? c.values.size() : c.texts.size();
    demand(n > 0 && n <= log.rows, "a column of wrong length");
    for (const double x : c.values) demand(std::isfinite(x), "a value that is not finite");
    if (c.time < 0) continue;
    demand(static_cast<std::size_t>(c.time) < log.columns.size(), "a time column that is not there");
    demand(log.columns[static_cast<std::size_t>(c.time)].values.size() == n, "a time of another length");
  }
}

/// Each problem is one line that a terminal only shows, of bounded length; the first names the file where there is one.
inline void check(const io::InputError& e, std::string_view file = {}) {
  demand(!e.problems().empty(), "a refusal without a problem");
  for (const io::Problem& p : e.problems()) {
    const std::string text = p.text();
    demand(!text.empty() && text.size() < 2000, "a refusal that is empty or too long");
    demand(io::printable(text) == text, "a refusal that a terminal obeys");
  }
  const bool named = std::string_view(e.what()).find(file) != std::string_view::npos;
  if (!named) std::fprintf(stderr, "fuzz: %s\n", e.what());
  demand(named, "a refusal without the file");
}

}  // namespace stribeck::fuzz
