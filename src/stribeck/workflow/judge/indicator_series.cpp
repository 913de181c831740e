#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <string_view>

#include <stribeck/io/error.hpp>
#include <stribeck/io/log/log.hpp>
#include <stribeck/workflow/judge/indicator_series.hpp>
#include <stribeck/workflow/log/names/column_words.hpp>

namespace stribeck::workflow {
namespace {

constexpr const char* kExpected =
    "expected columns direction and reading [um], and as needed position [mm] and load [N]";

/// The quantities of a series, as their columns are called in English and German.
struct SeriesName {
  std::string_view name;
  std::array<std::string_view, 4> words;
};
constexpr std::array<SeriesName, 4> kSeries{
    {{"direction", {"direction", "dir", "richtung", "anfahrrichtung"}},
     {"reading", {"reading", "indicator", "anzeige", "ablesung"}},
     {"position", {"position", "pos", "lage", "stelle"}},
     {"load", {"load", "last", "belastung", "gewichtskraft"}}}};

/// The quantity of a column; "" where it is none of a series.
std::string_view quantity_of(const io::Column& c) {
  std::string_view found;
  for (const SeriesName& q : kSeries) {
    if (!any_word(words_of_name(c.name), q.words)) continue;
    if (!found.empty()) return {};  // "load position"
    found = q.name;
  }
  return found;
}

const io::Column* column_of(const io::Log& table, std::string_view name) {
  const io::Column* found = nullptr;
  for (const io::Column& c : table.columns) {
    if (quantity_of(c) != name) continue;
    if (found != nullptr)
      throw io::InputError({table.source, 0, c.header,
                            fmt::format("and {} are both the {}, expected one column of it",
                                        io::in_quotes(found->header), name)});
    found = &c;
  }
  return found;
}

/// 1, −1, or 0 where the text is no direction.
int sign_of(const std::string& text) {
  constexpr std::array<std::string_view, 6> kPlus{"+", "plus", "positive", "forward", "vor", "positiv"};
  constexpr std::array<std::string_view, 9> kMinus{"-",        "\u2212", "minus",   "negative", "back",
                                                   "backward", "zurück", "zurueck", "negativ"};
  const std::string word = lower_case(text);
  if (std::find(kPlus.begin(), kPlus.end(), word) != kPlus.end()) return 1;
  return std::find(kMinus.begin(), kMinus.end(), word) != kMinus.end() ? -1 : 0;
}

[[noreturn]] void refuse_cell(const io::Log& table, std::size_t row, const std::string& what) {
  throw io::InputError(
      {table.source, 0, "direction", fmt::format("row {}: got {}, expected + or -", row + 1, what)});
}

std::vector<int> directions_of(const io::Log& table, const io::Column& column) {
  std::vector<int> all;
  for (std::size_t i = 0; i < column.texts.size(); ++i) {
    const int sign = sign_of(column.texts[i]);
    if (sign == 0) refuse_cell(table, i, io::in_quotes(column.texts[i]));
    all.push_back(sign);
  }
  for (std::size_t i = 0; i < column.values.size(); ++i) {
    const double value = column.values[i];
    if (value != 1.0 && value != -1.0) refuse_cell(table, i, fmt::format("{:.6g}", value));
    all.push_back(value > 0.0 ? 1 : -1);
  }
  return all;
}

std::vector<double> numbers_of(const io::Log& table, const io::Column& column, const Quantity& quantity) {
  if (column.values.empty())
    throw io::InputError({table.source, 0, column.name,
                          fmt::format("holds text in most rows, expected numbers in {}", quantity.shown)});
  return io::in_si(column, quantity);
}

/// Of a column that may be left out.
std::vector<double> values_of(const io::Log& table, std::string_view name, const Quantity& quantity,
                              std::size_t rows) {
  const io::Column* column = column_of(table, name);
  return column == nullptr ? std::vector<double>(rows, 0.0) : numbers_of(table, *column, quantity);
}

}  // namespace

std::vector<ident::lost_motion::Reading> read_indicator_series(const std::string& file) {
  const io::Log table = io::read_log(file, {.times_needed = false});
  const io::Column* direction = column_of(table, "direction");
  const io::Column* reading = column_of(table, "reading");
  if (direction == nullptr || reading == nullptr) {
    throw io::InputError(
        {file, 0, "columns",
         fmt::format("no column \"{}\", {}", direction == nullptr ? "direction" : "reading", kExpected)});
  }
  for (const io::Column& c : table.columns) {
    if (quantity_of(c).empty())
      throw io::InputError(
          {file, 0, c.header, fmt::format("is no column of a series of readings, {}", kExpected)});
  }
  const std::vector<int> directions = directions_of(table, *direction);
  const std::vector<double> values = numbers_of(table, *reading, quantity("m", "um"));
  const std::vector<double> positions = values_of(table, "position", quantity("m", "mm"), values.size());
  const std::vector<double> loads = values_of(table, "load", quantity("N", "N"), values.size());
  std::vector<ident::lost_motion::Reading> series;
  for (std::size_t i = 0; i < values.size(); ++i)
    series.push_back({positions[i], directions[i], values[i], loads[i]});
  return series;
}

}  // namespace stribeck::workflow
