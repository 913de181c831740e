#include <fast_float/fast_float.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/log.hpp>
#include <stribeck/io/units.hpp>

namespace stribeck::io {

namespace {

constexpr bool is_blank(char c) { return c == ' ' || c == '\t'; }
constexpr bool is_comment(std::string_view line) {
  return !line.empty() && (line[0] == '#' || line[0] == '%');
}

std::string_view trimmed(std::string_view s) {
  const auto first = s.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return {};
  return s.substr(first, s.find_last_not_of(" \t\r\n") - first + 1);
}

/// The line at the start of text, without its end; text moves behind it.
std::string_view take_line(std::string_view& text) {
  const auto end = std::min(text.find('\n'), text.size());
  std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

/// Cells of a line. Quotes protect separators; with blanks as separator, units in brackets belong to the name
/// before.
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
  if (separator != ' ' && cells.size() > 1 && cells.back().empty()) cells.pop_back();  // separator at the end
  return cells;
}

std::string unquoted(std::string_view cell) {
  if (cell.size() < 2 || cell.front() != '"' || cell.back() != '"') return std::string(cell);
  std::string out(cell.substr(1, cell.size() - 2));
  for (auto at = out.find("\"\""); at != std::string::npos; at = out.find("\"\"", at + 1)) out.erase(at, 1);
  return std::string(trimmed(out));
}

/// Header bytes that are no UTF-8 are taken as Latin-1, in which older Windows programs write µ and °.
std::string as_utf8(std::string_view in) {
  bool valid = true;
  std::string latin;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const auto c = static_cast<unsigned char>(in[i]);
    if (c < 0x80) {
      latin += in[i];
      continue;
    }
    latin += static_cast<char>(0xC0 | (c >> 6));
    latin += static_cast<char>(0x80 | (c & 0x3F));
  }
  for (std::size_t i = 0; i < in.size() && valid;) {
    const auto c = static_cast<unsigned char>(in[i]);
    const std::size_t n = c < 0x80                ? 1
                          : c >= 0xF0 && c < 0xF8 ? 4
                          : c >= 0xE0 && c < 0xF0 ? 3
                          : c >= 0xC2 && c < 0xE0 ? 2
                                                  : 0;
    valid = n > 0 && i + n <= in.size();
    for (std::size_t k = 1; valid && k < n; ++k)
      valid = (static_cast<unsigned char>(in[i + k]) & 0xC0) == 0x80;
    i += std::max<std::size_t>(n, 1);
  }
  return valid ? std::string(in) : latin;
}

/// A cell as a number; slow and complete: quotes, leading +.
std::optional<double> cell_number(std::string_view cell, char decimal) {
  cell = trimmed(cell);
  if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"')
    cell = trimmed(cell.substr(1, cell.size() - 2));
  if (cell.size() > 1 && cell[0] == '+' && cell[1] != '-') cell.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] =
      fast_float::from_chars_advanced(cell.data(), cell.data() + cell.size(), value,
                                      fast_float::parse_options{fast_float::chars_format::general, decimal});
  if (error != std::errc() || end != cell.data() + cell.size()) return std::nullopt;
  return value;
}

bool looks_like_number(std::string_view cell) {
  return cell_number(cell, '.').has_value() || cell_number(cell, ',').has_value();
}

/// Unit written as the last part of a name, x_mm. Only units that logs of machines carry:
/// "X1_CurrentFeedback" or "run_a" shall not gain one.
constexpr std::array<std::pair<std::string_view, std::string_view>, 58> kSuffixes{{
    {"s", "s"},
    {"ms", "ms"},
    {"us", "us"},
    {"ns", "ns"},
    {"m", "m"},
    {"mm", "mm"},
    {"um", "um"},
    {"nm", "nm"},
    {"N", "N"},
    {"kN", "kN"},
    {"V", "V"},
    {"mV", "mV"},
    {"A", "A"},
    {"mA", "mA"},
    {"Nm", "Nm"},
    {"mNm", "mNm"},
    {"W", "W"},
    {"kW", "kW"},
    {"rad", "rad"},
    {"deg", "deg"},
    {"rev", "rev"},
    {"rpm", "rpm"},
    {"pct", "%"},
    {"percent", "%"},
    {"Hz", "Hz"},
    {"kHz", "kHz"},
    {"kg", "kg"},
    {"degC", "degC"},
    {"m_s", "m/s"},
    {"mm_s", "mm/s"},
    {"um_s", "um/s"},
    {"m_min", "m/min"},
    {"mm_min", "mm/min"},
    {"m_s2", "m/s2"},
    {"mm_s2", "mm/s2"},
    {"m_s3", "m/s3"},
    {"mm_s3", "mm/s3"},
    {"rad_s", "rad/s"},
    {"deg_s", "deg/s"},
    {"rad_s2", "rad/s2"},
    {"deg_s2", "deg/s2"},
    {"N_s", "N/s"},
    {"N_m", "N m"},
    {"N_V", "N/V"},
    {"V_s", "V/s"},
    {"A_s", "A/s"},
    {"m_per_s", "m/s"},
    {"mm_per_s", "mm/s"},
    {"um_per_s", "um/s"},
    {"m_per_min", "m/min"},
    {"mm_per_min", "mm/min"},
    {"m_per_s2", "m/s2"},
    {"mm_per_s2", "mm/s2"},
    {"rad_per_s", "rad/s"},
    {"deg_per_s", "deg/s"},
    {"rev_per_s", "rev/s"},
    {"N_per_V", "N/V"},
    {"N_per_A", "N/A"},
}};

/// Name and unit of a header.
Column column_of(std::string header, std::vector<std::string>& notes) {
  Column c;
  c.name = header;
  for (const auto& [open, close] : {std::pair{'[', ']'}, {'(', ')'}}) {
    const auto at = header.rfind(open);
    if (at == std::string::npos || header.back() != close) continue;
    const auto inside = std::string(trimmed(std::string_view(header).substr(at + 1, header.size() - at - 2)));
    const auto before = std::string(trimmed(std::string_view(header).substr(0, at)));
    const bool dimensionless = open == '[' && (inside == "-" || inside == "1");
    // "x (1)" is a second copy of x, not a unit.
    const bool unit = !inside.empty() &&
                      !(inside[0] >= '0' && inside[0] <= '9' && inside.substr(0, 2) != "1/") &&
                      is_unit(inside);
    if (dimensionless || unit) {
      c.name = before.empty() ? header : before;
      c.unit_text = dimensionless ? "1" : inside;
    } else if (open == '[' && !inside.empty()) {
      notes.push_back("column " + in_quotes(header) + ": unit " + in_quotes(inside) + " is not known");
    }
    c.header = std::move(header);
    return c;
  }
  std::size_t longest = 0;
  for (const auto& [suffix, unit] : kSuffixes) {
    if (suffix.size() <= longest || header.size() < suffix.size() + 2) continue;
    const auto at = header.size() - suffix.size();
    if (header[at - 1] != '_' || header.compare(at, suffix.size(), suffix) != 0) continue;
    longest = suffix.size();
    c.name = header.substr(0, at - 1);
    c.unit_text = unit;
  }
  c.header = std::move(header);
  return c;
}

/// Inflates gzip, several members one after the other too.
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
      if (stream.avail_in == 0 || *stream.next_in != 0x1f)
        break;  // padding behind the last member is allowed
      inflateReset(&stream);
      after_member = false;
    }
    stream.next_out = reinterpret_cast<Bytef*>(block.data());
    stream.avail_out = static_cast<uInt>(block.size());
    state = inflate(&stream, Z_NO_FLUSH);
    if (state == Z_OK || state == Z_STREAM_END) out.append(block, 0, block.size() - stream.avail_out);
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

/// One parse of one text.
class CsvReader {
 public:
  CsvReader(std::string_view bytes, std::string source, const CsvOptions& options)
      : all_(bytes), options_(options) {
    log_.source = std::move(source);
  }

  Log read() {
    check_bytes();
    std::string_view body = all_;
    read_header(body);
    if (options_.leave_out_text_columns) find_text_columns(first_row(body));
    if (separator_ == ' ') {
      read_rows<true>(body);
    } else {
      read_rows<false>(body);
    }
    drop_text_columns();
    if (dropped_blank_lines_ > 0) {
      note("lines without any value were left out: " + std::to_string(dropped_blank_lines_));
    }
    if (log_.rows < 2) {
      fail(0, log_.rows == 0 ? "has a header but no data rows, expected at least two"
                             : "has one data row, expected at least two");
    }
    return std::move(log_);
  }

 private:
  [[noreturn]] void fail(std::size_t line, std::string message) const {
    throw InputError(Problem{log_.source, line, "", std::move(message)});
  }
  void note(std::string text) { log_.notes.push_back(std::move(text)); }

  [[nodiscard]] std::size_t line_number(const char* at) const {
    return 1 + static_cast<std::size_t>(std::count(all_.data(), at, '\n'));
  }

  void check_bytes() {
    if (all_.empty()) fail(0, "is empty, expected a header line and data rows");
    if (all_.substr(0, 2) == "\xFF\xFE" || all_.substr(0, 2) == "\xFE\xFF") {
      fail(0, "is UTF-16 text, expected UTF-8 (save it as \"CSV UTF-8\")");
    }
    if (all_.substr(0, 4) == "PK\x03\x04") {
      fail(0, "is a zip archive or a spreadsheet, expected CSV text (export it as CSV)");
    }
    if (const void* nul = std::memchr(all_.data(), 0, all_.size())) {
      fail(line_number(static_cast<const char*>(nul)),
           "holds a NUL byte: not a text file (export it as CSV)");
    }
  }

  void add_comment(std::string_view line) {
    const auto text = trimmed(line.substr(std::min(line.find_first_not_of("#% \t"), line.size())));
    const auto colon = text.find(':');
    if (colon == std::string_view::npos || colon == 0) return;
    log_.metadata.emplace_back(as_utf8(trimmed(text.substr(0, colon))),
                               as_utf8(trimmed(text.substr(colon + 1))));
  }

  /// First line of the text that is neither blank nor comment.
  static std::string_view first_row(std::string_view text) {
    while (!text.empty()) {
      const auto line = take_line(text);
      if (!trimmed(line).empty() && !is_comment(line)) return line;
    }
    return {};
  }

  void read_header(std::string_view& body) {
    if (body.substr(0, 3) == "\xEF\xBB\xBF") body.remove_prefix(3);
    for (std::size_t i = 0; i < options_.skip_lines; ++i) take_line(body);

    std::string_view header;
    std::string_view last_comment;
    std::string_view rest = body;
    while (!rest.empty() && header.empty()) {
      body = rest;
      const auto line = take_line(rest);
      if (trimmed(line).empty()) continue;
      if (is_comment(line)) {
        last_comment = line;
        add_comment(line);
      } else {
        header = line;
      }
    }
    if (header.empty()) fail(0, "has no header line, expected names of columns");
    const std::size_t line = line_number(header.data());
    if (!options_.names.empty()) {
      separator_ = best_separator(header, header);
      const auto cells = split(header, separator_).size();
      if (cells != options_.names.size()) {
        fail(line, "got " + std::to_string(cells) + " columns, expected " +
                       std::to_string(options_.names.size()) + " as named");
      }
      set_columns(options_.names, line);
    } else if (is_data(header)) {
      // "# t,x" directly above the numbers.
      separator_ = best_separator(header, header);
      const auto cells = split(header, separator_).size();
      std::vector<std::string_view> names;
      if (!last_comment.empty()) {
        const auto text = trimmed(
            last_comment.substr(std::min(last_comment.find_first_not_of("#% \t"), last_comment.size())));
        names = split(text, separator_);
        if (names.size() != cells) names = split(text, best_separator(text, header));
      }
      if (names.size() != cells || cells < 2) {
        fail(
            line,
            "has no header: the first row holds numbers (put a line with the names of the columns above it)");
      }
      set_columns({names.begin(), names.end()}, line);
      note("the names of the columns are taken from the comment above the numbers");
    } else {
      for (const char c : header) {
        if (static_cast<unsigned char>(c) < 0x20 && c != '\t') {
          fail(line, c == '\r' ? "ends its lines with CR alone, expected LF or CR LF (save it again as text)"
                               : "holds control characters: not a text file (export it as CSV)");
        }
      }
      body = rest;
      separator_ = best_separator(header, first_row(rest));
      const auto names = split(header, separator_);
      set_columns({names.begin(), names.end()}, line);
    }
    decimal_ = decimal_mark(body);
  }

  static bool is_data(std::string_view line) {
    for (const char separator : {'\t', ';', ',', ' '}) {
      const auto cells = split(line, separator);
      if (std::all_of(cells.begin(), cells.end(), looks_like_number)) return true;
    }
    return false;
  }

  /// The separator under which header and first row have the same number of cells; else one that both
  /// contain.
  static char best_separator(std::string_view header, std::string_view row) {
    constexpr std::array kSeparators{'\t', ';', ',', ' '};
    for (const char s : kSeparators) {
      const auto n = split(header, s).size();
      if (n > 1 && n == split(row, s).size()) return s;
    }
    for (const char s : kSeparators) {
      if (split(header, s).size() > 1 && split(row, s).size() > 1) return s;
    }
    for (const char s : {'\t', ';', ','}) {
      if (split(header, s).size() > 1) return s;
    }
    return ',';
  }

  void set_columns(const std::vector<std::string>& headers, std::size_t line) {
    std::map<std::string, std::size_t> seen;
    for (std::size_t i = 0; i < headers.size(); ++i) {
      std::string header = as_utf8(unquoted(trimmed(headers[i])));
      if (header.empty()) {
        header = "column " + std::to_string(i + 1);
        note("column " + std::to_string(i + 1) + " has no name");
      }
      if (const auto [hit, fresh] = seen.emplace(header, i); !fresh) {
        fail(line, "column name " + in_quotes(header) + " stands twice, for columns " +
                       std::to_string(hit->second + 1) + " and " + std::to_string(i + 1) + " (rename one)");
      }
      log_.columns.push_back(column_of(header, log_.notes));
    }
    // x_mm and x_um: what is left without the unit is no name.
    std::map<std::string, int> names;
    for (const auto& c : log_.columns) ++names[c.name];
    for (auto& c : log_.columns) {
      if (names[c.name] > 1) c.name = c.header;
    }
  }

  /// A comma is the decimal mark where cells hold commas and the separator is another.
  [[nodiscard]] char decimal_mark(std::string_view body) const {
    if (separator_ == ',') return '.';
    std::string_view rest = body;
    for (int k = 0; k < 100 && !rest.empty(); ++k) {
      const auto line = take_line(rest);
      if (!is_comment(line) && line.find(',') != std::string_view::npos) return ',';
    }
    const bool comma = body.find(',') != std::string_view::npos;
    return comma && body.find('.') == std::string_view::npos ? ',' : '.';
  }

  void find_text_columns(std::string_view row) {
    const auto cells = split(row, separator_);
    if (cells.size() != log_.columns.size()) return;
    is_text_.resize(cells.size());
    for (std::size_t c = 0; c < cells.size(); ++c) {
      is_text_[c] = unquoted(cells[c]).empty() || cell_number(cells[c], decimal_) ? 0 : 1;
    }
    if (std::count(is_text_.begin(), is_text_.end(), 1) == 0) is_text_.clear();
  }

  void drop_text_columns() {
    for (std::size_t c = is_text_.size(); c-- > 0;) {
      if (is_text_[c] == 0) continue;
      note("column " + in_quotes(log_.columns[c].header) + " was left out: it holds text");
      log_.columns.erase(log_.columns.begin() + static_cast<std::ptrdiff_t>(c));
    }
    if (log_.columns.empty()) fail(0, "has no column of numbers");
  }

  /// Reserves from the length of the first lines.
  void reserve(std::string_view body) {
    const auto sample = body.substr(0, 1 << 16);
    const auto lines = std::max<std::ptrdiff_t>(1, std::count(sample.begin(), sample.end(), '\n'));
    const double rows =
        static_cast<double>(body.size()) / static_cast<double>(sample.size()) * static_cast<double>(lines);
    for (auto& c : log_.columns) c.values.reserve(static_cast<std::size_t>(rows * 1.05) + 16);
  }

  template <bool kBlankSeparated>
  void read_rows(std::string_view body) {
    if (body.empty()) return;
    reserve(body);
    const std::size_t n = log_.columns.size();
    // Rows go through a block that stays in the cache, then column by column to their place.
    const std::size_t block_rows = std::max<std::size_t>(16, 16384 / n);
    std::vector<double> block(n * block_rows);
    std::size_t filled = 0;
    const auto flush = [&] {
      for (std::size_t c = 0; c < n; ++c) {
        const double* from = block.data() + c * block_rows;
        log_.columns[c].values.insert(log_.columns[c].values.end(), from, from + filled);
      }
      filled = 0;
    };

    const fast_float::parse_options number_format{fast_float::chars_format::general, decimal_};
    const char separator = separator_;
    const char* const is_text = is_text_.empty() ? nullptr : is_text_.data();
    const char* p = body.data();
    const char* const end = p + body.size();
    while (p != end) {
      const char* const line = p;
      if (*p == '\n' || *p == '\r' || *p == '#' || *p == '%') {
        const char* const next = end_of_line(p, end);
        if (*p == '#' || *p == '%') add_comment({p, static_cast<std::size_t>(next - p)});
        const bool blank = trimmed({p, static_cast<std::size_t>(next - p)}).empty();
        if (blank || *p != '\r') {
          p = next == end ? end : next + 1;
          continue;
        }
      }
      double* out = block.data() + filled;
      std::size_t column = 0;
      while (true) {
        while (p != end && (*p == ' ' || (kBlankSeparated && *p == '\t'))) ++p;
        const char* after = p;
        if (is_text != nullptr && is_text[column] != 0) {
          after = end_of_text<kBlankSeparated>(p, end);
          if (after == nullptr) break;
          *out = 0.0;
        } else {
          const auto parsed = fast_float::from_chars_advanced(p, end, *out, number_format);
          if (parsed.ec != std::errc() || !std::isfinite(*out)) break;
          after = parsed.ptr;
        }
        const char* q = after;
        while (q != end && (*q == ' ' || (kBlankSeparated && *q == '\t'))) ++q;
        if (++column < n) {
          if (kBlankSeparated) {
            if (q == after) break;
          } else {
            if (q == end || *q != separator) break;
            ++q;
          }
          p = q;
          out += block_rows;
          continue;
        }
        if (!kBlankSeparated && q != end && *q == separator) {  // separator at the end of the line
          do {
            ++q;
          } while (q != end && *q == ' ');
        }
        if (q != end && *q == '\r') ++q;
        if (q != end && *q != '\n') break;
        p = q;
        column = n + 1;
        break;
      }
      if (column != n + 1) {
        const auto rest = slow_row(line, end, block.data() + filled, block_rows, log_.rows + 1);
        p = rest.next;
        if (!rest.is_row) continue;
      }
      ++log_.rows;
      if (p != end) ++p;
      if (++filled == block_rows) flush();
    }
    flush();
  }

  /// End of an unquoted text cell; null where the slow way has to look.
  template <bool kBlankSeparated>
  const char* end_of_text(const char* p, const char* end) const {
    for (; p != end && *p != separator_ && *p != '\n' && *p != '\r'; ++p) {
      if (*p == '"') return nullptr;
      if (kBlankSeparated && *p == '\t') break;
    }
    return p;
  }

  static const char* end_of_line(const char* p, const char* end) {
    const void* hit = std::memchr(p, '\n', static_cast<std::size_t>(end - p));
    return hit == nullptr ? end : static_cast<const char*>(hit);
  }

  struct SlowRow {
    const char* next;  ///< end of the line for a row, behind it for a line that was left out
    bool is_row;
  };

  /// A row that the fast loop could not read: quotes, plus signs, or something is wrong.
  SlowRow slow_row(const char* start, const char* end, double* out, std::size_t stride, std::size_t row) {
    const char* const line_end = end_of_line(start, end);
    const SlowRow skip{line_end == end ? end : line_end + 1, false};
    const std::string_view line = trimmed({start, static_cast<std::size_t>(line_end - start)});
    const std::size_t n = log_.columns.size();
    if (std::all_of(line.begin(), line.end(),
                    [&](char c) { return c == separator_ || is_blank(c) || c == '"'; })) {
      if (!line.empty()) ++dropped_blank_lines_;
      return skip;
    }
    // Leading separators are cells; only the blanks around the line are not.
    std::string_view raw = line;
    if (separator_ == '\t') {
      raw = {start, static_cast<std::size_t>(line_end - start)};
      if (raw.back() == '\r') raw.remove_suffix(1);
    }
    auto cells = split(raw, separator_);
    const bool last = trimmed({line_end, static_cast<std::size_t>(end - line_end)}).empty();
    const bool cut = last && line_end == end;
    const std::string where = "row " + std::to_string(row);
    const std::size_t line_no = line_number(start);
    if (cells.size() < n && last) {
      note("the last row (" + where + ", line " + std::to_string(line_no) + ") was left out: it has " +
           std::to_string(cells.size()) + " of " + std::to_string(n) + " cells");
      return skip;
    }
    if (cells.size() + 1 == n && separator_ != ' ' && raw.back() == separator_) cells.emplace_back();
    if (cells.size() != n) {
      fail(line_no, where + ": got " + std::to_string(cells.size()) +
                        (cells.size() == 1 ? " cell" : " cells") + ", expected " + std::to_string(n) +
                        " as in the header" +
                        (separator_ == ',' && n > 1 && cells.size() == 2 * n
                             ? " (a decimal comma? separate columns by ;)"
                             : ""));
    }
    for (std::size_t c = 0; c < n; ++c) {
      if (!is_text_.empty() && is_text_[c] != 0) {
        out[c * stride] = 0.0;
        continue;
      }
      const auto value = cell_number(cells[c], decimal_);
      if (value && std::isfinite(*value)) {
        out[c * stride] = *value;
        continue;
      }
      if (cut && c + 1 == n && !value) {
        note("the last row (" + where + ", line " + std::to_string(line_no) +
             ") was left out: it is cut off");
        return skip;
      }
      const std::string place = where + ", column " + in_quotes(log_.columns[c].header) + ": ";
      if (value) fail(line_no, place + "got " + in_quotes(trimmed(cells[c])) + ", expected a finite number");
      if (unquoted(cells[c]).empty()) {
        fail(line_no, place + "the cell is blank, expected a number (remove the row or the column)");
      }
      fail(line_no, place + "got " + in_quotes(as_utf8(trimmed(cells[c]))) + ", expected a number" +
                        (decimal_ == ',' && cells[c].find('.') != std::string_view::npos
                             ? " with a decimal comma, as in other cells"
                             : ""));
    }
    return {line_end, true};
  }

  std::string_view all_;
  const CsvOptions& options_;
  Log log_;
  char separator_ = ',';
  char decimal_ = '.';
  std::vector<char> is_text_;  ///< 1 for columns to leave out; empty when there are none
  std::size_t dropped_blank_lines_ = 0;
};

/// A header cell, in quotes where it needs them.
std::string header_text(const Column& c) {
  std::string text = c.name;
  if (!c.unit_text.empty()) text += " [" + c.unit_text + ']';
  if (text.find_first_of(",;\t\"") == std::string::npos && !text.empty() && text[0] != '#' && text[0] != '%')
    return text;
  std::string out = "\"";
  for (const char ch : text) out.append(ch == '"' ? 2 : 1, ch);
  return out + '"';
}

}  // namespace

const Column* Log::find(std::string_view name) const {
  for (const auto& c : columns) {
    if (c.header == name) return &c;
  }
  for (const auto& c : columns) {
    if (c.name == name) return &c;
  }
  return nullptr;
}

const Column& Log::at(std::string_view name) const {
  if (const Column* c = find(name)) return *c;
  std::vector<std::string_view> names;
  std::string list;
  for (const auto& c : columns) {
    names.push_back(c.name);
    list += (list.empty() ? "" : ", ") + c.name;
  }
  std::string message = "no column " + in_quotes(name) + ", there are: " + list;
  if (const auto near = nearest(name, names); !near.empty()) message += " (meant " + in_quotes(near) + "?)";
  throw InputError(Problem{source, 0, "", std::move(message)});
}

Log parse_csv(std::string_view bytes, const std::string& source, const CsvOptions& options) {
  if (bytes.substr(0, 2) == "\x1f\x8b") {
    const std::string text = inflated(bytes, source);
    return CsvReader(text, source, options).read();
  }
  return CsvReader(bytes, source, options).read();
}

Log read_csv(const std::string& path, const CsvOptions& options) {
  const FileBytes bytes(path);
  return parse_csv(bytes.view(), path, options);
}

std::vector<double> in_si(const Column& column, const Quantity& quantity) {
  const std::string place = "column " + in_quotes(column.header.empty() ? column.name : column.header);
  const std::string_view wanted = quantity.shown.empty() ? quantity.unit : quantity.shown;
  if (column.unit_text.empty()) {
    throw InputError(Problem{"", 0, place,
                             "has no unit, expected one like " + std::string(wanted.empty() ? "1" : wanted) +
                                 " (name it in the header as " +
                                 in_quotes(column.name + " [" + std::string(wanted) + "]") + ")"});
  }
  Conversion convert;
  try {
    convert = conversion(column.unit_text, quantity.unit);
  } catch (const InputError& e) {
    throw InputError(Problem{"", 0, place, e.problems().front().message});
  }
  std::vector<double> values(column.values.size());
  // The divisor outside the loop: the same value as convert(x), without a power per sample.
  const double divisor = convert.decimal && convert.power < 0 ? std::pow(10.0, -convert.power) : 0.0;
  std::transform(column.values.begin(), column.values.end(), values.begin(),
                 [&](double x) { return divisor > 0.0 ? x / divisor : x * convert.factor; });
  return values;
}

std::string csv_text(const Log& log) {
  std::string out;
  for (const auto& [key, value] : log.metadata) {
    std::string line = key + ": " + value;
    for (char& c : line) c = c == '\n' || c == '\r' ? ' ' : c;
    out += "# " + line + '\n';
  }
  for (std::size_t c = 0; c < log.columns.size(); ++c)
    out += (c > 0 ? "," : "") + header_text(log.columns[c]);
  out += '\n';
  out.reserve(out.size() + log.rows * log.columns.size() * 12);
  std::array<char, 40> buffer{};
  for (std::size_t r = 0; r < log.rows; ++r) {
    for (std::size_t c = 0; c < log.columns.size(); ++c) {
      if (c > 0) out += ',';
      out.append(buffer.data(), std::to_chars(buffer.begin(), buffer.end(), log.columns[c].values.at(r)).ptr);
    }
    out += '\n';
  }
  return out;
}

void write_csv(const std::string& path, const Log& log) { write_atomically(path, csv_text(log)); }

TimeCheck check_time(const std::vector<double>& values, const std::string& source, const std::string& name) {
  const std::string place = "column " + in_quotes(name);
  if (values.size() < 2) {
    throw InputError(
        Problem{source, 0, place, "has " + std::to_string(values.size()) + " rows, expected at least two"});
  }
  std::vector<double> steps(values.size() - 1);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    steps[i] = values[i + 1] - values[i];
    if (!(steps[i] > 0.0)) {
      throw InputError(Problem{source, 0, place,
                               "row " + std::to_string(i + 2) + ": time " +
                                   (steps[i] < 0.0    ? "goes back"
                                    : steps[i] == 0.0 ? "stands still"
                                                      : "is not a number") +
                                   ", from " + number_text(values[i]) + " to " + number_text(values[i + 1]) +
                                   ", expected it to increase (cut the log there, or mend the time column)"});
    }
  }
  TimeCheck result;
  auto sorted = steps;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  result.sample_time = *middle;
  if (sorted.size() % 2 == 0)
    result.sample_time = 0.5 * (*middle + *std::max_element(sorted.begin(), middle));

  for (std::size_t i = 0; i < steps.size(); ++i) {
    const double ratio = steps[i] / result.sample_time;
    if (ratio > 1.5) {
      result.gaps.push_back({i + 2, steps[i]});
    } else if (std::abs(ratio - 1.0) > result.jitter) {
      result.jitter = std::abs(ratio - 1.0);
      result.jitter_row = i + 2;
    }
  }
  if (!result.gaps.empty()) {
    const auto& first = result.gaps.front();
    result.notes.push_back("time has " + std::to_string(result.gaps.size()) +
                           (result.gaps.size() == 1 ? " gap" : " gaps") + ", the first before row " +
                           std::to_string(first.row) + ": " + number_text(first.duration) + " instead of " +
                           number_text(result.sample_time));
  }
  if (result.jitter > TimeCheck::kJitterTolerance) {
    result.notes.push_back("time jitters by up to " + number_text(std::round(1000.0 * result.jitter) / 10.0) +
                           " % of the sample time, most at row " + std::to_string(result.jitter_row));
  }
  return result;
}

}  // namespace stribeck::io
