#include <algorithm>
#include <numeric>
#include <stribeck/io/error.hpp>
#include <stribeck/io/printable.hpp>

namespace stribeck::io {

namespace {

std::string first_and_count(const std::vector<Problem>& problems) {
  std::string text = problems.empty() ? std::string("bad input") : problems.front().text();
  if (problems.size() > 1) text += " (and " + std::to_string(problems.size() - 1) + " more)";
  return text;
}

}  // namespace

std::string Problem::text() const {
  constexpr std::size_t kLongestName = 300;
  constexpr std::size_t kLongestMessage = 1200;
  std::string out = shortened(file, kLongestName);
  if (line > 0) out += (out.empty() ? "line " : ":") + std::to_string(line);
  for (const auto& part : {shortened(key, kLongestName), shortened(message, kLongestMessage)}) {
    if (part.empty()) continue;
    if (!out.empty()) out += ": ";
    out += part;
  }
  return printable(out);
}

InputError::InputError(Problem problem) : InputError(std::vector{std::move(problem)}) {}

InputError::InputError(std::vector<Problem> problems)
    : std::runtime_error(first_and_count(problems)), problems_(std::move(problems)) {}

void Problems::throw_if_any() const {
  if (all_.empty()) return;
  auto sorted = all_;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Problem& a, const Problem& b) { return a.line < b.line; });
  throw InputError(std::move(sorted));
}

std::string in_quotes(std::string_view value) {
  constexpr std::size_t kLongest = 60;
  if (value.size() <= kLongest) return '"' + printable(value) + '"';
  std::size_t cut = kLongest;
  while (cut > 0 && (static_cast<unsigned char>(value[cut]) & 0xC0) == 0x80)
    --cut;  // do not cut inside a character
  return '"' + printable(value.substr(0, cut)) + "…\"";
}

std::string_view nearest(std::string_view word, const std::vector<std::string_view>& candidates) {
  std::string_view best;
  std::size_t best_distance = std::max<std::size_t>(2, word.size() / 3) + 1;
  std::vector<std::size_t> row;
  for (const auto candidate : candidates) {
    // Levenshtein distance, one row of the table at a time.
    row.resize(candidate.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 1; i <= word.size(); ++i) {
      std::size_t diagonal = row[0];
      row[0] = i;
      for (std::size_t j = 1; j <= candidate.size(); ++j) {
        const std::size_t substitute = diagonal + (word[i - 1] == candidate[j - 1] ? 0 : 1);
        diagonal = row[j];
        row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitute});
      }
    }
    if (row.back() < best_distance && row.back() < candidate.size()) {
      best_distance = row.back();
      best = candidate;
    }
  }
  return best;
}

}  // namespace stribeck::io
