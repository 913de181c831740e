#include <fast_float/fast_float.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <stribeck/io/error.hpp>
#include <stribeck/io/log/log_text.hpp>
#include <utility>

namespace stribeck::io::detail {

std::string_view trimmed(std::string_view s) {
  const auto first = s.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return {};
  return s.substr(first, s.find_last_not_of(" \t\r\n") - first + 1);
}

std::string_view take_line(std::string_view& text) {
  const auto end = std::min(text.find('\n'), text.size());
  std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

std::vector<std::string_view> split(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  if (separator == ' ') line = trimmed(line);
  std::size_t start = 0;
  bool in_quotes = false;
  int depth = 0;
  for (std::size_t i = 0; i <= line.size(); ++i) {
    if (i < line.size()) {
      const char c = line[i];
      if (c == '"') in_quotes = !in_quotes;
      if (in_quotes) continue;
      if (separator == ' ') {
        if (c == '[' || c == '(') ++depth;
        if ((c == ']' || c == ')') && depth > 0) --depth;
        if (depth > 0 || !is_blank(c)) continue;
        const auto next = line.find_first_not_of(" \t", i);
        if (next != std::string_view::npos && (line[next] == '[' || line[next] == '(')) continue;
        cells.push_back(line.substr(start, i - start));
        start = next;
        i = next - 1;
        continue;
      }
      if (c != separator) continue;
    }
    cells.push_back(trimmed(line.substr(start, i - start)));
    start = i + 1;
  }
  if (separator != ' ' && cells.size() > 1 && cells.back().empty())
    cells.pop_back();  // a separator at the end of the line
  return cells;
}

std::string unquoted(std::string_view cell) {
  if (cell.size() < 2 || cell.front() != '"' || cell.back() != '"') return std::string(cell);
  std::string out(cell.substr(1, cell.size() - 2));
  for (auto at = out.find("\"\""); at != std::string::npos; at = out.find("\"\"", at + 1)) out.erase(at, 1);
  return std::string(trimmed(out));
}

bool is_utf8(std::string_view in) {
  for (std::size_t i = 0; i < in.size();) {
    const auto c = static_cast<unsigned char>(in[i]);
    const std::size_t n = c < 0x80                ? 1
                          : c >= 0xF0 && c < 0xF8 ? 4
                          : c >= 0xE0 && c < 0xF0 ? 3
                          : c >= 0xC2 && c < 0xE0 ? 2
                                                  : 0;
    if (n == 0 || i + n > in.size()) return false;
    for (std::size_t k = 1; k < n; ++k) {
      if ((static_cast<unsigned char>(in[i + k]) & 0xC0) != 0x80) return false;
    }
    i += n;
  }
  return true;
}

std::string as_utf8(std::string_view in) {
  if (is_utf8(in)) return std::string(in);
  // What Windows-1252 has in place of the control characters of Latin-1. A dash before a number is a minus; absent ones are a blank.
  constexpr std::array<std::string_view, 32> kPrintable{
      "\u20AC", " ",      "\u201A", "\u0192", "\u201E", "\u2026", "\u2020", "\u2021",
      "\u02C6", "\u2030", "\u0160", "\u2039", "\u0152", " ",      "\u017D", " ",
      " ",      "\u2018", "\u2019", "\u201C", "\u201D", "\u2022", "\u2013", "\u2014",
      "\u02DC", "\u2122", "\u0161", "\u203A", "\u0153", " ",      "\u017E", "\u0178"};
  std::string out;
  for (const char raw : in) {
    const auto c = static_cast<unsigned char>(raw);
    if (c < 0x80) {
      out += raw;
    } else if (c < 0xA0) {
      out += kPrintable[c - 0x80];
    } else {
      out += static_cast<char>(0xC0 | (c >> 6));
      out += static_cast<char>(0x80 | (c & 0x3F));
    }
  }
  return out;
}

namespace {

std::optional<double> plain_number(std::string_view cell, char decimal) {
  if (cell.size() > 1 && cell[0] == '+' && cell[1] != '-') cell.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] =
      fast_float::from_chars_advanced(cell.data(), cell.data() + cell.size(), value,
                                      fast_float::parse_options{fast_float::chars_format::general, decimal});
  if (error != std::errc()) return std::nullopt;
  if (end == cell.data() + cell.size()) return value;
  // Business software and some drive tools write the minus behind the digits.
  const bool minus_behind = end + 1 == cell.data() + cell.size() && *end == '-' &&
                            std::isdigit(static_cast<unsigned char>(cell[0])) != 0;
  return minus_behind ? std::optional(-value) : std::nullopt;
}

}  // namespace

std::optional<double> cell_number(std::string_view cell, char decimal) {
  cell = trimmed(cell);
  if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"')
    cell = trimmed(cell.substr(1, cell.size() - 2));
  // The minus of a typesetter, which word processors and some spreadsheets write, and the dash that Windows-1252 has for it.
  for (const std::string_view minus : {"\u2212", "\u2013", "\x96"}) {
    if (!cell.starts_with(minus)) continue;
    const std::string_view rest = trimmed(cell.substr(minus.size()));
    if (rest.starts_with('-') || rest.starts_with('+')) return std::nullopt;
    const auto value = plain_number(rest, decimal);
    return value ? std::optional(-*value) : std::nullopt;
  }
  return plain_number(cell, decimal);
}

bool looks_like_number(std::string_view cell) {
  return cell_number(cell, '.').has_value() || cell_number(cell, ',').has_value();
}

std::string inflated(std::string_view bytes, const std::string& source) {
  z_stream stream{};
  constexpr int kGzipOnly = 16 + MAX_WBITS;
  if (inflateInit2(&stream, kGzipOnly) != Z_OK)
    throw InputError(Problem{source, 0, "", "cannot be decompressed"});
  std::string out;
  std::string block(1 << 18, '\0');
  int state = Z_OK;
  std::size_t fed = 0;
  bool after_member = false;
  while (true) {
    if (stream.avail_in == 0 && fed < bytes.size()) {
      // zlib counts with 32 bits.
      const auto part = std::min<std::size_t>(bytes.size() - fed, 1U << 30);
      stream.next_in =
          reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data() + fed));  // zlib does not write to it
      stream.avail_in = static_cast<uInt>(part);
      fed += part;
    }
    if (after_member) {
      if (stream.avail_in == 0 || *stream.next_in != 0x1f) break;  // padding after the last member is allowed
      inflateReset(&stream);
      after_member = false;
    }
    stream.next_out = reinterpret_cast<Bytef*>(block.data());
    stream.avail_out = static_cast<uInt>(block.size());
    state = inflate(&stream, Z_NO_FLUSH);
    if (state == Z_OK || state == Z_STREAM_END) out.append(block, 0, block.size() - stream.avail_out);
    // Numbers as text shrink to a half or a tenth, a log of an axis at rest to a thirtieth; only a malicious file grows without
    // bound. Below the first bound everything is accepted.
    constexpr std::size_t kHarmless = std::size_t{64} << 20;
    constexpr std::size_t kLargest = std::size_t{2} << 30;
    constexpr std::size_t kGrowth = 30;
    if (out.size() > kLargest || (out.size() > kHarmless && out.size() / kGrowth > bytes.size())) {
      inflateEnd(&stream);
      throw InputError(Problem{source, 0, "",
                               "grows to more than " + std::to_string(out.size() >> 20) + " MB from " +
                                   std::to_string(bytes.size()) +
                                   " bytes of gzip: no log does (unpack it first if it is one)"});
    }
    after_member = state == Z_STREAM_END;
    if (state != Z_OK && state != Z_STREAM_END) break;
  }
  inflateEnd(&stream);
  if (state != Z_STREAM_END) {
    throw InputError(
        Problem{source, 0, "", "the gzip data are damaged or cut off (compress or copy it again)"});
  }
  return out;
}

bool begins_with(std::string_view text, std::string_view s) {
  if (text.size() < s.size()) return false;
  return std::equal(s.begin(), s.end(), text.begin(),
                    [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); });
}

std::string_view last_line(std::string_view text) {
  std::string_view last;
  while (!text.empty()) {
    const auto line = take_line(text);
    if (!trimmed(line).empty() && !is_comment(line)) last = line;
  }
  return last;
}

std::vector<std::string_view> split_exactly(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  std::size_t start = 0;
  bool in_quotes = false;
  for (std::size_t i = 0; i <= line.size(); ++i) {
    if (i < line.size()) {
      if (line[i] == '"') in_quotes = !in_quotes;
      if (in_quotes || line[i] != separator) continue;
    }
    cells.push_back(trimmed(line.substr(start, i - start)));
    start = i + 1;
  }
  return cells;
}

namespace {

/// Files that hold tables, but no text, by their first bytes.
constexpr std::array<std::pair<std::string_view, std::string_view>, 10> kBinaryTables{
    {{"PAR1", "a Parquet file"},
     {"\x89HDF", "an HDF5 file (MATLAB 7.3 writes it too)"},
     {"MATLAB 5.0", "a MATLAB file"},
     {"\xD0\xCF\x11\xE0", "an old Excel file"},
     {"TDSm", "a TDMS file of LabVIEW"},
     {"MDF ", "a measurement file, MDF"},
     {"#ROSBAG", "a ROS bag"},
     {"\x89MCAP", "a ROS bag, MCAP"},
     {"SQLite format 3", "a database, as ROS 2 records it"},
     {"\x93NUMPY", "a NumPy array"}}};

}  // namespace

void check_text(std::string_view bytes, const std::string& source) {
  const auto fail = [&](std::size_t line, const char* message) {
    throw InputError(Problem{source, line, "", message});
  };
  if (bytes.empty()) fail(0, "is empty, expected a header line and data rows");
  if (bytes.substr(0, 4) == "PK\x03\x04") {
    fail(0, "is a zip archive or a spreadsheet, expected CSV text (export it as CSV)");
  }
  for (const auto& [start, name] : kBinaryTables) {
    if (!bytes.starts_with(start)) continue;
    throw InputError(
        Problem{source, 0, "",
                "is " + std::string(name) +
                    ", expected CSV text (export it as CSV, or give its columns as arrays in Python)"});
  }
  if (const void* nul = std::memchr(bytes.data(), 0, bytes.size())) {
    const auto line = 1 + std::count(bytes.data(), static_cast<const char*>(nul), '\n');
    fail(static_cast<std::size_t>(line), "holds a NUL byte: not a text file (export it as CSV)");
  }
}

void check_no_control_characters(std::string_view text, const std::string& source) {
  const auto hit = std::find_if(text.begin(), text.end(), [](unsigned char c) {
    return c < 0x20 && c != '\t' && c != '\n' && c != '\r' && c != '\f';
  });
  if (hit == text.end()) return;
  const auto line = 1 + std::count(text.begin(), hit, '\n');
  throw InputError(Problem{source, static_cast<std::size_t>(line), "",
                           "holds a control character: damaged, or not a text file (export it again)"});
}

}  // namespace stribeck::io::detail
