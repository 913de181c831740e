#include <fmt/format.h>
#include <algorithm>
#include <memory>
#include <utility>

#include <stribeck/io/error.hpp>
#include <stribeck/workflow/log/converted.hpp>
#include <stribeck/workflow/log/names/column_sums.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::workflow {

NamedColumn named_difference(const io::Log& log, const std::string& text) {
  const auto minus = text.rfind(" - "), plus = text.rfind(" + ");
  const auto at = minus == std::string::npos  ? plus
                  : plus == std::string::npos ? minus
                                              : std::max(minus, plus);
  // A column may have such a name itself.
  const io::Column* named = at == std::string::npos ? nullptr : column_called(log, text).column;
  const bool whole = at == std::string::npos ||
                     (named != nullptr && header_of(*named).size() > at && named->name.size() > at);
  if (whole) return named_column(log, text);
  NamedColumn first = named_difference(log, text.substr(0, at));
  const NamedColumn second = named_column(log, text.substr(at + 3));
  if (first.unit.empty()) first.unit = second.unit;
  const auto factor = conversion_between(second.unit.empty() ? first.unit : second.unit, first.unit);
  if (!factor || first.column->values.size() != second.column->values.size())
    refuse_option(
        "--map",
        fmt::format(
            "{} and {} cannot be added: expected two columns of one kind of unit and of equally many rows",
            io::in_quotes(header_of(*first.column)), io::in_quotes(header_of(*second.column))));
  auto made = std::make_shared<io::Column>(*first.column);
  const double sign = text[at + 1] == '-' ? -1.0 : 1.0;
  for (std::size_t k = 0; k < made->values.size(); ++k)
    made->values[k] += sign * (*factor)(second.column->values[k]);
  made->name += text.substr(at, 3) + second.column->name;
  made->header = made->name;
  // Where the file says another unit, the message of a unit that replaces it compares with the file's.
  if (made->unit_text.empty()) made->unit_text = first.unit;
  first.column = made.get();
  first.made = std::move(made);
  return first;
}

NamedColumn named_sum(const io::Log& log, const std::string& text) {
  constexpr std::string_view kPlus = " + ";
  const auto plus = log.find(text) == nullptr ? text.rfind(kPlus) : std::string::npos;
  if (plus == std::string::npos) return named_column(log, text);
  NamedColumn named = named_column(log, text.substr(plus + kPlus.size()));
  const NamedColumn before = named_sum(log, text.substr(0, plus));
  named.beside = before.beside;
  named.beside.insert(named.beside.begin(), before.column);
  for (const io::Column* c : named.beside) {
    if (c == named.column || c->values.size() != named.column->values.size() ||
        (!c->unit_text.empty() && c->unit_text != named.column->unit_text))
      refuse_option(
          "--map",
          fmt::format("{} and {} cannot be added: expected two columns of one unit and of equally many rows",
                      io::in_quotes(header_of(*c)), io::in_quotes(header_of(*named.column))));
  }
  return named;
}

}  // namespace stribeck::workflow
