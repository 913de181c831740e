#include <algorithm>

#include <stribeck/io/printable.hpp>

namespace stribeck::io {

namespace {

unsigned byte_at(std::string_view text, std::size_t i) { return static_cast<unsigned char>(text[i]); }

bool continues(std::string_view text, std::size_t i, unsigned low = 0x80, unsigned high = 0xBF) {
  return i < text.size() && byte_at(text, i) >= low && byte_at(text, i) <= high;
}

/// Length of the character that a text begins with, 0 where that is none. RFC 3629, table 3-7 of Unicode.
std::size_t length_of_character(std::string_view text) {
  const unsigned b = byte_at(text, 0);
  if (b < 0x80) return 1;
  if (b >= 0xC2 && b <= 0xDF) return continues(text, 1) ? 2 : 0;
  if (b >= 0xE0 && b <= 0xEF) {
    const bool second = continues(text, 1, b == 0xE0 ? 0xA0 : 0x80, b == 0xED ? 0x9F : 0xBF);
    return second && continues(text, 2) ? 3 : 0;
  }
  if (b >= 0xF0 && b <= 0xF4) {
    const bool second = continues(text, 1, b == 0xF0 ? 0x90 : 0x80, b == 0xF4 ? 0x8F : 0xBF);
    return second && continues(text, 2) && continues(text, 3) ? 4 : 0;
  }
  return 0;
}

bool commands_a_terminal(std::string_view character) {
  const unsigned first = byte_at(character, 0);
  if (character.size() == 1) return first < 0x20 || first == 0x7f;
  if (character.size() == 2) return (first == 0xC2 && byte_at(character, 1) < 0xA0) || character == "\u061c";
  if (character.size() != 3 || first != 0xE2) return false;
  const unsigned last =
      (byte_at(character, 1) - 0x80) * 64 + byte_at(character, 2) - 0x80;  // of U+2000 and on
  return last == 0x0e || last == 0x0f || (last >= 0x28 && last <= 0x2e) || (last >= 0x66 && last <= 0x69);
}

std::string cleaned(std::string_view text, bool keep_newlines) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const std::size_t n = length_of_character(text);
    const std::string_view character = text.substr(0, std::max<std::size_t>(n, 1));
    if (n == 0) {
      out += "\ufffd";
    } else if (commands_a_terminal(character) && !(keep_newlines && character == "\n")) {
      out += ' ';
    } else {
      out += character;
    }
    text.remove_prefix(character.size());
  }
  return out;
}

/// Moved back to where a character begins.
std::size_t begin_of_character(std::string_view text, std::size_t at) {
  while (at > 0 && at < text.size() && continues(text, at)) --at;
  return at;
}

}  // namespace

std::string printable(std::string_view text) { return cleaned(text, false); }

std::string printable_lines(std::string_view text) { return cleaned(text, true); }

std::string shortened(std::string_view text, std::size_t most) {
  if (text.size() <= most) return std::string(text);
  constexpr std::string_view kLeftOut = "…";
  const std::size_t room = most > kLeftOut.size() ? most - kLeftOut.size() : 0;
  const std::size_t head = begin_of_character(text, room - room / 4);
  std::size_t tail = text.size() - room / 4;
  while (tail < text.size() && continues(text, tail)) ++tail;
  return std::string(text.substr(0, head)) + std::string(kLeftOut) + std::string(text.substr(tail));
}

std::string one_line(std::string_view text, std::size_t most) {
  std::string line = shortened(printable(text), most);
  line.erase(line.find_last_not_of("\\ ") + 1);
  return line;
}

std::string comment_lines(std::string_view text) {
  constexpr std::size_t kLine = 196;
  constexpr std::size_t kAll = 4000;
  const std::string all = one_line(text, kAll);
  std::string out;
  std::string_view rest = all;
  do {
    const std::size_t n = begin_of_character(rest, std::min(kLine, rest.size()));
    const std::string_view line = rest.substr(0, n);
    rest.remove_prefix(n);
    out += "# ";
    out += line;
    if (line.ends_with('\\')) out += "…";  // which would continue the line
    out += '\n';
  } while (!rest.empty());
  return out;
}

}  // namespace stribeck::io
