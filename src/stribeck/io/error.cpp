#include <algorithm>
#include <numeric>
#include <stribeck/io/error.hpp>

namespace stribeck::io {

namespace {

std::string first_and_count(const std::vector<Problem>& problems) {
  std::string text = problems.empty() ? std::string("bad input") : problems.front().text();
  if (problems.size() > 1) text += " (and " + std::to_string(problems.size() - 1) + " more)";
  return text;
}

/// Length in bytes of the character that begins at `at`; 0 where no character begins.
std::size_t length_of_character(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(at);
  const std::size_t n = first < 0x80                    ? 1
                        : first >= 0xC2 && first < 0xE0 ? 2
                        : first >= 0xE0 && first < 0xF0 ? 3
                        : first >= 0xF0 && first < 0xF5 ? 4
                                                        : 0;
  if (n == 0 || at + n > text.size()) return 0;
  for (std::size_t i = 1; i < n; ++i) {
    if ((byte(at + i) & 0xC0) != 0x80) return 0;
  }
  return n;
}

/// Control characters, and those that change the direction of writing: a terminal obeys them.
bool commands_a_terminal(std::string_view character) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(character[i]); };
  if (character.size() == 1) return byte(0) < 0x20 || byte(0) == 0x7f;
  if (character.size() == 2) return (byte(0) == 0xC2 && byte(1) < 0xA0) || character == "\u061c";
  if (character.size() != 3 || byte(0) != 0xE2) return false;
  const int last = (byte(1) - 0x80) * 64 + byte(2) - 0x80;  // of U+2000 and following
  return last == 0x0e || last == 0x0f || (last >= 0x28 && last <= 0x2e) || (last >= 0x66 && last <= 0x69);
}

/// Its beginning and its end, where it is longer than that.
std::string shortened(const std::string& text, std::size_t most) {
  if (text.size() <= most) return text;
  std::size_t head = most / 2;
  std::size_t tail = text.size() - most / 4;
  const auto inside = [&](std::size_t i) { return (static_cast<unsigned char>(text[i]) & 0xC0) == 0x80; };
  while (head > 0 && inside(head)) --head;
  while (tail < text.size() && inside(tail)) ++tail;
  return text.substr(0, head) + "…" + text.substr(tail);
}

}  // namespace

std::string printable(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t n = length_of_character(text, i);
    const std::string_view character = text.substr(i, std::max<std::size_t>(n, 1));
    if (n == 0) {
      out += "\ufffd";
    } else if (commands_a_terminal(character)) {
      out += ' ';
    } else {
      out += character;
    }
    i += character.size();
  }
  return out;
}

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
