// Names of columns that a spreadsheet breaks into lines: "Position\\n[mm]".
#include <algorithm>
#include <stribeck/io/log/log_spreadsheet.hpp>

namespace stribeck::io::detail {
namespace {

constexpr std::size_t kLinesOfHead = 200;
constexpr std::size_t kMostBreaks = 5;  // in one cell
constexpr std::size_t kLongestCell = 500;

bool ends_a_cell(std::string_view text, std::size_t at) {
  return at >= text.size() || std::string_view(";,\t\r\n").find(text[at]) != std::string_view::npos;
}

/// The end of a cell that begins with a quote at `at`, behind its last quote; npos: it is no such cell.
std::size_t end_of_quoted(std::string_view text, std::size_t at) {
  std::size_t breaks = 0;
  for (std::size_t i = at + 1; i < std::min(text.size(), at + kLongestCell); ++i) {
    if (text[i] == '\n' && ++breaks > kMostBreaks) break;
    if (text[i] != '"') continue;
    if (ends_a_cell(text, i + 1)) return i + 1;
    if (text[i + 1] != '"') break;
    ++i;
  }
  return std::string_view::npos;
}

}  // namespace

std::string with_names_in_one_line(std::string_view text) {
  std::string out;
  std::size_t copied = 0;  // of the text
  std::size_t moved = 0;   // line ends that follow behind the row
  std::size_t lines = 0;
  bool begin = true;  // of a cell
  for (std::size_t i = 0; i < text.size() && lines < kLinesOfHead; ++i) {
    const char c = text[i];
    if (begin && c == '"') {
      const std::size_t end = end_of_quoted(text, i);
      if (end != std::string_view::npos) {
        const std::string_view cell = text.substr(i, end - i);
        if (cell.find('\n') != std::string_view::npos) {
          out += text.substr(copied, i - copied);
          for (const char in_cell : cell) {
            if (in_cell == '\n') ++moved;
            if (in_cell != '\r') out += in_cell == '\n' ? ' ' : in_cell;
          }
          copied = end;
        }
        i = end - 1;
        begin = false;
        continue;
      }
    }
    begin = c == ';' || c == ',' || c == '\t' || c == '\n';
    if (c != '\n') continue;
    ++lines;
    if (moved == 0) continue;
    out += text.substr(copied, i + 1 - copied);
    out.append(moved, '\n');
    copied = i + 1;
    moved = 0;
  }
  if (copied == 0) return {};
  out += text.substr(copied);
  return out;
}

}  // namespace stribeck::io::detail
