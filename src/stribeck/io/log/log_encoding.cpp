// Text of Windows programs as UTF-8: UTF-16, and the code pages of Japan and China.
#include <iconv.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <stribeck/io/error.hpp>
#include <stribeck/io/log/log_text.hpp>

namespace stribeck::io::detail {
namespace {

struct Converter {
  iconv_t handle;
  explicit Converter(const char* encoding) : handle(iconv_open("UTF-8", encoding)) {}
  Converter(const Converter&) = delete;
  Converter& operator=(const Converter&) = delete;
  ~Converter() {
    if (good()) iconv_close(handle);
  }
  // iconv answers −1 as a handle.
  [[nodiscard]] bool good() const { return handle != reinterpret_cast<iconv_t>(-1); }
};

/// Converts all bytes; returns the errno of the first that is no text, and 0 where all are.
int convert(const Converter& converter, std::string_view bytes, std::string& out) {
  std::array<char, 1 << 16> part{};
  char* from = const_cast<char*>(bytes.data());  // iconv does not write there
  std::size_t left = bytes.size();
  while (left > 0) {
    char* to = part.data();
    std::size_t room = part.size();
    const bool failed = iconv(converter.handle, &from, &left, &to, &room) == static_cast<std::size_t>(-1);
    const int why = errno;
    out.append(part.data(), part.size() - room);
    if (failed && why != E2BIG) return why;
  }
  return 0;
}

/// Shift-JIS: letters of two bytes, of which at least two begin with a byte that Latin-1 uses for control characters, and two follow each
/// other somewhere. In Windows-1252 the sign of per mille and the bracket behind it are such a pair.
bool may_be_shift_jis(std::string_view head) {
  std::size_t sure = 0, run = 0, longest = 0;
  for (std::size_t i = 0; i < head.size(); ++i) {
    const auto c = static_cast<unsigned char>(head[i]);
    if (c < 0x80 || (c >= 0xA1 && c <= 0xDF)) {
      run = 0;
      continue;
    }
    longest = std::max(longest, ++run);
    if (c == 0x80 || c == 0xA0 || c > 0xFC || ++i == head.size()) return false;
    const auto next = static_cast<unsigned char>(head[i]);
    if (next < 0x40 || next == 0x7F || next > 0xFC) return false;
    if (c <= 0x9F) ++sure;
  }
  return sure >= 2 && longest >= 2;
}

/// GB 2312: all letters outside ASCII are pairs, and two follow each other somewhere, as no word of Latin-1 has it.
bool may_be_gb2312(std::string_view head) {
  std::size_t run = 0;
  std::size_t longest = 0;
  for (std::size_t i = 0; i <= head.size(); ++i) {
    const auto c = i < head.size() ? static_cast<unsigned char>(head[i]) : '\n';
    if (c >= 0x80) {
      if (c < 0xA1 || c == 0xFF) return false;
      longest = std::max(longest, ++run);
      continue;
    }
    if (run % 2 != 0) return false;
    run = 0;
  }
  return longest >= 4;
}

}  // namespace

bool is_utf16(std::string_view bytes) {
  return bytes.substr(0, 2) == "\xFF\xFE" || bytes.substr(0, 2) == "\xFE\xFF";
}

std::string from_utf16(std::string_view bytes, const std::string& source) {
  const Converter converter("UTF-16");
  if (!converter.good())
    throw InputError(Problem{source, 0, "",
                             "is UTF-16 text, which this system cannot convert (save it as \"CSV UTF-8\")"});
  std::string out;
  if (convert(converter, bytes, out) != 0)
    throw InputError(
        Problem{source, 1 + static_cast<std::size_t>(std::count(out.begin(), out.end(), '\n')), "",
                "is UTF-16 text that ends or breaks within a letter: damaged (export it again)"});
  return out;
}

std::optional<EastAsianText> from_east_asian(std::string_view bytes) {
  constexpr std::size_t kHead = 1 << 14;
  std::string_view head = bytes.substr(0, kHead);
  if (head.size() == kHead) head = head.substr(0, head.find_last_of('\n') + 1);
  if (is_utf8(head)) return std::nullopt;
  const bool japanese = may_be_shift_jis(head);
  if (!japanese && !may_be_gb2312(head)) return std::nullopt;
  const Converter converter(japanese ? "CP932" : "GB18030");
  EastAsianText text{japanese ? "Shift-JIS" : "GB 2312", ""};
  text.utf8.reserve(bytes.size() + bytes.size() / 64);
  if (!converter.good() || convert(converter, bytes, text.utf8) != 0) return std::nullopt;
  return text;
}

}  // namespace stribeck::io::detail
