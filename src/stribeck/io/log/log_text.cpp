#include <fast_float/fast_float.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <stribeck/io/error.hpp>
#include <stribeck/io/log/log_text.hpp>
#include <stribeck/io/units.hpp>
#include <utility>

namespace stribeck::io::detail {

namespace {

/// Unit written as the last part of a name, x_mm. Only units that occur in logs of machines:
/// "X1_CurrentFeedback" or "run_a" must not get one.
constexpr std::array<std::pair<std::string_view, std::string_view>, 61> kSuffixes{{
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
    {"permil", "\u2030"},
    {"counts", "count"},
    {"incr", "count"},
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

/// Spellings of units in controls, drives and their tools.
constexpr std::array<std::pair<std::string_view, std::string_view>, 52> kSpellings{{
    {"Ampere", "A"},
    {"Aeff", "A"},
    {"Arms", "A"},
    {"A_rms", "A"},
    {"A rms", "A"},
    {"Amp", "A"},
    {"Volt", "V"},
    {"Grad", "deg"},
    {"degree", "deg"},
    {"degrees", "deg"},
    {"Grad/s", "deg/s"},
    {"Grad/min", "deg/min"},
    {"°", "deg"},
    {"°/s", "deg/s"},
    {"°/min", "deg/min"},
    {"°/s²", "deg/s2"},
    {"1000 mm/min", "m/min"},
    {"r/min", "rpm"},
    {"rev/min", "rpm"},
    {"Umdr/min", "rpm"},
    {"U/min", "rpm"},
    {"RPM", "rpm"},
    {"Rpm", "rpm"},
    {"Umdr", "rev"},
    {"Prozent", "%"},
    {"percent", "%"},
    {"Incr", "count"},
    {"incr", "count"},
    {"Inkr", "count"},
    {"Inc", "count"},
    {"inc", "count"},
    {"INC", "count"},
    {"pulse", "count"},
    {"pulses", "count"},
    {"pls", "count"},
    {"pls.", "count"},
    {"qc", "count"},
    {"counts", "count"},
    {"cnt", "count"},
    {"cnts", "count"},
    {"cts", "count"},
    {"Sek", "s"},
    {"sec", "s"},
    {"second", "s"},
    {"seconds", "s"},
    {"Sekunde", "s"},
    {"Sekunden", "s"},
    {"msec", "ms"},
    {"usec", "us"},
    {"NM", "N m"},
    {"-", "1"},
    {"Mikrometer", "um"},
}};

/// Torques with a hyphen, which the library of units takes for a mass at a distance.
constexpr std::array<std::pair<std::string_view, std::string_view>, 8> kTorques{{
    {"lb-in", "lbf in"},
    {"lbf-in", "lbf in"},
    {"in-lb", "lbf in"},
    {"in-lbf", "lbf in"},
    {"lb-ft", "lbf ft"},
    {"lbf-ft", "lbf ft"},
    {"ft-lb", "lbf ft"},
    {"ft-lbf", "lbf ft"},
}};

std::string_view torque_of(std::string_view unit) {
  const auto found =
      std::find_if(kTorques.begin(), kTorques.end(), [&](const auto& t) { return t.first == unit; });
  return found == kTorques.end() ? std::string_view() : found->second;
}

/// Increments of an encoder, as headers call them.
bool is_count_word(std::string_view unit) {
  return unit == "counts" || unit == "count" ||
         std::any_of(kSpellings.begin(), kSpellings.end(),
                     [&](const auto& s) { return s.first == unit && s.second == "count"; });
}

/// The plain unit of a spelling of controls; "" for others.
std::string_view spelling_of(std::string_view unit) {
  const auto found =
      std::find_if(kSpellings.begin(), kSpellings.end(), [&](const auto& s) { return s.first == unit; });
  return found == kSpellings.end() ? std::string_view() : found->second;
}

/// "0.00029296875 mm": a unit of the size that the number says, e.g. of one count.
bool is_scaled_unit(std::string_view text) {
  const auto end = std::min(text.find_first_of(" %"), text.size());
  const auto unit = trimmed(text.substr(end));
  const auto factor = cell_number(text.substr(0, end), '.');
  return factor && *factor > 0.0 && std::isfinite(*factor) && !unit.empty() &&
         (std::isalpha(static_cast<unsigned char>(unit[0])) != 0 || unit[0] == '%') && is_unit(unit) &&
         is_unit(text);
}

}  // namespace

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
  std::string latin;
  for (const char raw : in) {
    const auto c = static_cast<unsigned char>(raw);
    if (c < 0x80) {
      latin += raw;
      continue;
    }
    latin += static_cast<char>(0xC0 | (c >> 6));
    latin += static_cast<char>(0x80 | (c & 0x3F));
  }
  return latin;
}

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

Column column_of(std::string header, Notes& notes) {
  Column c;
  c.name = header;
  for (const auto& [open, close] : {std::pair{'[', ']'}, {'(', ')'}}) {
    const auto at = header.rfind(open);
    if (at == std::string::npos || header.back() != close) continue;
    const auto inside = std::string(trimmed(std::string_view(header).substr(at + 1, header.size() - at - 2)));
    const auto before = std::string(trimmed(std::string_view(header).substr(0, at)));
    // "x (1)" is a second copy of x, not a unit.
    const bool dimensionless = open == '[' && (inside == "-" || inside == "1");
    const bool counts = is_count_word(inside);
    const bool scaled = open == '[' && is_scaled_unit(inside);
    std::string_view spelled = open == '[' && !scaled && !counts ? spelling_of(inside) : "";
    const std::string_view torque = torque_of(inside);
    if (!torque.empty()) spelled = torque;
    const bool unit = !inside.empty() && !counts && !scaled &&
                      !(inside[0] >= '0' && inside[0] <= '9' && inside.substr(0, 2) != "1/") &&
                      is_unit(inside);
    if (dimensionless || unit || counts || scaled || !spelled.empty()) {
      c.name = before.empty() ? header : before;
      c.unit_text = dimensionless                        ? "1"
                    : counts                             ? "count"
                    : torque.empty() && (unit || scaled) ? inside
                                                         : std::string(spelled);
    } else if (open == '[' && inside.find_first_not_of("0123456789") != std::string::npos) {
      // A number in brackets is an index, r0482[0].
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
    c.unit_assumed = suffix.size() == 1;  // "i_A" may be that of axis A
  }
  c.header = std::move(header);
  return c;
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

std::string header_of(const std::string& name) {
  const auto text = trimmed(name);
  const auto blank = text.rfind(' ');
  if (text.empty() || text.back() == ']' || text.back() == ')' || blank == std::string_view::npos)
    return std::string(text);
  auto unit = text.substr(blank + 1);
  if (unit[0] >= '0' && unit[0] <= '9') return std::string(text);
  if (!is_unit(unit) && !is_count_word(unit) && torque_of(unit).empty()) return std::string(text);
  // "torque N m": a force before a length belongs to the unit.
  if (const auto before = text.substr(0, blank).rfind(' '); before != std::string_view::npos) {
    const auto both = text.substr(before + 1);
    const auto force = text.substr(before + 1, blank - before - 1);
    const bool torque =
        (force == "N" || force == "kN" || force == "mN" || force == "lbf" || force == "ozf") &&
        (unit == "m" || unit == "mm" || unit == "in" || unit == "ft");
    if (torque) return std::string(trimmed(text.substr(0, before))) + " [" + std::string(both) + "]";
  }
  // "x 0.001 mm": a factor has a decimal point or an exponent, for "axis 2 mm" is the column "axis 2".
  if (const auto before = trimmed(text.substr(0, blank)); before.rfind(' ') != std::string_view::npos) {
    const auto at = before.rfind(' ');
    const auto scaled = text.substr(at + 1);
    if (before.substr(at + 1).find_first_of(".eE") != std::string_view::npos && is_scaled_unit(scaled))
      return std::string(trimmed(before.substr(0, at))) + " [" + std::string(scaled) + "]";
  }
  return std::string(trimmed(text.substr(0, blank))) + " [" + std::string(unit) + "]";
}

std::optional<std::string> name_with_unit_after_slash(std::string_view header) {
  for (auto slash = header.find('/'); slash != std::string_view::npos; slash = header.find('/', slash + 1)) {
    const auto name = trimmed(header.substr(0, slash));
    const auto unit = trimmed(header.substr(slash + 1));
    if (name.empty() || unit.empty()) continue;
    const bool number = unit[0] >= '0' && unit[0] <= '9' && unit.substr(0, 2) != "1/";
    const bool known = (!number && is_unit(unit)) || is_count_word(unit) || !spelling_of(unit).empty() ||
                       !torque_of(unit).empty();
    if (known) return std::string(name) + " [" + std::string(unit) + "]";
  }
  return std::nullopt;
}

std::string plain_unit(std::string_view text, std::string_view column, Notes& notes) {
  std::string unit = as_utf8(unquoted(trimmed(text)));
  // TwinCAT adds the quantity: "dV (Voltage)", "(None)".
  if (!unit.empty() && unit.back() == ')') {
    const auto open = unit.rfind('(');
    if (open != std::string::npos && (open == 0 || unit[open - 1] == ' ')) {
      unit = std::string(trimmed(std::string_view(unit).substr(0, open)));
    }
  }
  // The Greek letter replaces the micro sign.
  for (auto at = unit.find("\u03BC"); at != std::string::npos; at = unit.find("\u03BC")) {
    unit.replace(at, 2, "\u00B5");
  }
  if (unit.empty()) return unit;
  if (const auto plain = spelling_of(unit); !plain.empty()) return std::string(plain);
  const bool number = unit[0] >= '0' && unit[0] <= '9' && unit.substr(0, 2) != "1/";
  if ((!number || unit == "1") && is_unit(unit)) return unit;
  notes.push_back("column " + in_quotes(column) + ": unit " + in_quotes(unit) + " is not known");
  return {};
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
