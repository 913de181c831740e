// UTF-16 text, which Windows programs write, as UTF-8.
#include <iconv.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <stribeck/io/error.hpp>
#include <stribeck/io/log/log_text.hpp>

namespace stribeck::io::detail {
namespace {

struct Converter {
  iconv_t handle = iconv_open("UTF-8", "UTF-16");
  Converter() = default;
  Converter(const Converter&) = delete;
  Converter& operator=(const Converter&) = delete;
  ~Converter() {
    if (good()) iconv_close(handle);
  }
  // iconv answers −1 as a handle.
  [[nodiscard]] bool good() const { return handle != reinterpret_cast<iconv_t>(-1); }
};

}  // namespace

bool is_utf16(std::string_view bytes) {
  return bytes.substr(0, 2) == "\xFF\xFE" || bytes.substr(0, 2) == "\xFE\xFF";
}

std::string from_utf16(std::string_view bytes, const std::string& source) {
  const Converter converter;
  if (!converter.good())
    throw InputError(Problem{source, 0, "",
                             "is UTF-16 text, which this system cannot convert (save it as \"CSV UTF-8\")"});
  std::string out;
  std::array<char, 1 << 16> part{};
  char* from = const_cast<char*>(bytes.data());  // iconv does not write there
  std::size_t left = bytes.size();
  while (left > 0) {
    char* to = part.data();
    std::size_t room = part.size();
    const bool failed = iconv(converter.handle, &from, &left, &to, &room) == static_cast<std::size_t>(-1);
    const int why = errno;
    out.append(part.data(), part.size() - room);
    if (failed && why != E2BIG)
      throw InputError(
          Problem{source, 1 + static_cast<std::size_t>(std::count(out.begin(), out.end(), '\n')), "",
                  "is UTF-16 text that ends or breaks within a letter: damaged (export it again)"});
  }
  return out;
}

}  // namespace stribeck::io::detail
