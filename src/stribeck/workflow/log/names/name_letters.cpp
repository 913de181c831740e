#include <cctype>
#include <string_view>

#include <stribeck/workflow/log/names/column_words.hpp>
#include <stribeck/workflow/log/names/name_letters.hpp>

namespace stribeck::workflow {

std::string small_letters(const std::string& text) {
  std::string out = lower_case(text);
  for (std::size_t i = 0; i + 1 < out.size(); ++i) {
    const auto first = static_cast<unsigned char>(out[i]);
    const auto second = static_cast<unsigned char>(out[i + 1]);
    const auto set = [&](unsigned a, unsigned b) {
      out[i] = static_cast<char>(a);
      out[i + 1] = static_cast<char>(b);
    };
    if (first == 0xC3 && second >= 0x80 && second <= 0x9E && second != 0x97) {
      set(first, second + 0x20U);  // À to Þ
    } else if ((first == 0xC4 || first == 0xC5) && second >= 0x80 && second <= 0xBF) {
      // Ā to ž: pairs whose first is the capital; from Ĺ to Ň and from Ź on the first has an odd number.
      const unsigned code = ((first & 0x1FU) << 6U) | (second & 0x3FU);
      const bool odd = (code >= 0x139 && code <= 0x148) || (code >= 0x179 && code <= 0x17E);
      const bool single =
          code == 0x130 || code == 0x131 || code == 0x138 || code == 0x149 || code == 0x178 || code == 0x17F;
      if (!single && (code % 2 == 1) == odd) set(0xC0U | ((code + 1) >> 6U), 0x80U | ((code + 1) & 0x3FU));
    } else if (first == 0xD0 && second >= 0x90 && second <= 0x9F) {
      set(first, second + 0x20U);  // А to П
    } else if (first == 0xD0 && second >= 0xA0 && second <= 0xAF) {
      set(0xD1, second - 0x20U);  // Р to Я
    }
  }
  return out;
}

std::string without_type(const std::string& header) {
  const auto dot = header.rfind('.');
  const std::size_t first = dot == std::string::npos ? 0 : dot + 1;
  for (const std::string_view type : {"lr", "r", "f", "di", "n", "d", "i"}) {
    if (header.compare(first, type.size(), type) != 0 || first + type.size() >= header.size()) continue;
    if (std::isupper(static_cast<unsigned char>(header[first + type.size()])) == 0) continue;
    return header.substr(0, first) + header.substr(first + type.size());
  }
  return header;
}

}  // namespace stribeck::workflow
