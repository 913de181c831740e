#include <algorithm>
#include <string>

#include <stribeck/io/log/decimal_sign.hpp>

namespace stribeck::io {

void set_decimal_sign(Log& log, char sign) {
  log.decimal_sign = sign;
  if (sign != ',') return;
  const bool any = std::any_of(log.metadata.begin(), log.metadata.end(), [](const auto& entry) {
    const std::string& value = entry.second;
    const auto end = std::min(value.find_first_not_of("+-.,0123456789"), value.size());
    return value.find_first_of(".,") < end;
  });
  if (any)
    log.notes.emplace_back(
        "the table has decimal commas: numbers above the table are read with decimal commas too");
}

}  // namespace stribeck::io
