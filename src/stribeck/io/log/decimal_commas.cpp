#include <algorithm>
#include <string>
#include <string_view>

#include <stribeck/io/log/decimal_commas.hpp>

namespace stribeck::io {
namespace {

constexpr std::string_view kDecimalCommas =
    "the table has decimal commas: numbers in the lines above it are taken as written alike";

}  // namespace

void note_decimal_commas(Log& log) {
  const bool any = std::any_of(log.metadata.begin(), log.metadata.end(), [](const auto& entry) {
    const std::string& value = entry.second;
    const auto end = std::min(value.find_first_not_of("+-.,0123456789"), value.size());
    return value.find_first_of(".,") < end;
  });
  if (any) log.notes.emplace_back(std::string(kDecimalCommas));
}

bool has_decimal_commas(const Log& log) {
  return std::any_of(log.notes.begin(), log.notes.end(),
                     [](const Note& note) { return note.text == kDecimalCommas; });
}

}  // namespace stribeck::io
