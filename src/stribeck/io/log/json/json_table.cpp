#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/log/json/json_table.hpp>
#include <stribeck/io/log/log_text.hpp>
#include <utility>
#include <vector>

namespace stribeck::io::detail {
namespace {

using Json = nlohmann::ordered_json;

/// Deepest nesting of a row.
constexpr int kDeepest = 8;
/// Cells of the table for each byte of the file. A cell with a value takes more than one byte; rows without most of their keys would
/// otherwise make a table far larger than the file.
constexpr std::size_t kCellsPerByte = 4;

/// The value; nothing where the text is no JSON or nested too deeply.
std::optional<Json> parsed(std::string_view text) {
  bool deep = false;
  const auto watch = [&](int depth, Json::parse_event_t, Json&) {
    deep = deep || depth > kDeepest;
    return !deep;
  };
  Json value = Json::parse(text.begin(), text.end(), watch, false);
  if (deep || value.is_discarded()) return std::nullopt;
  return value;
}

bool is_scalar(const Json& value) { return !value.is_structured(); }

/// A cell without a value. A blank one at the end of a line would be no cell.
constexpr const char* kAbsent = "null";

/// Text of a cell.
std::string cell_of(const Json& value) {
  if (value.is_null()) return kAbsent;
  if (value.is_boolean()) return value.get<bool>() ? "1" : "0";
  if (!value.is_string()) return value.dump();
  std::string out = "\"";
  for (const char c : value.get_ref<const std::string&>()) {
    if (static_cast<unsigned char>(c) < 0x20) {
      out += ' ';
    } else {
      out.append(c == '"' ? 2 : 1, c);
    }
  }
  return out + '"';
}

/// Calls `take(name, value)` for each value in a row.
void each_cell(const std::string& name, const Json& value,
               const std::function<void(const std::string&, const Json&)>& take) {
  if (is_scalar(value)) return take(name, value);
  std::size_t i = 0;
  for (const auto& item : value.items()) {
    if (value.is_object()) {
      each_cell(name.empty() ? item.key() : name + "." + item.key(), item.value(), take);
    } else {
      each_cell(fmt::format("{}_{}", name, i++), item.value(), take);
    }
  }
}

/// Rows of objects, written as CSV.
class Table {
 public:
  Table(std::size_t bytes, std::string source) : bytes_(bytes), source_(std::move(source)) {}

  void add(const Json& row) {
    std::vector<std::string> cells(names_.size(), kAbsent);
    each_cell("", row, [&](const std::string& name, const Json& value) {
      auto at = columns_.find(name);
      if (at == columns_.end()) {
        at = columns_.emplace(name, names_.size()).first;
        names_.push_back(name);
        cells.emplace_back();
      }
      cells[at->second] = cell_of(value);
    });
    if ((rows_.size() + 1) * names_.size() > kCellsPerByte * bytes_)
      throw InputError(
          Problem{source_, 0, "", "most of its rows lack most of the keys, expected the same keys in each"});
    rows_.push_back(joined(cells));
    widths_.push_back(cells.size());
  }

  [[nodiscard]] std::string text(const std::string& head) const {
    std::string out = head;
    std::vector<std::string> names;
    for (const std::string& name : names_) names.push_back(cell_of(Json(name)));
    out += joined(names) + '\n';
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      out += rows_[k];
      for (std::size_t c = widths_[k]; c < names_.size(); ++c) out += std::string(",") + kAbsent;
      out += '\n';
    }
    return out;
  }
  [[nodiscard]] bool empty() const { return names_.empty(); }

 private:
  static std::string joined(const std::vector<std::string>& cells) {
    return fmt::format("{}", fmt::join(cells, ","));
  }

  std::size_t bytes_;
  std::string source_;
  std::map<std::string, std::size_t> columns_;
  std::vector<std::string> names_;
  std::vector<std::string> rows_;
  std::vector<std::size_t> widths_;  ///< cells in each row: a key may come later
};

std::optional<std::string> lines_of_objects(std::string_view text, const std::string& source) {
  std::string_view rest = text;
  const auto first = parsed(trimmed(take_line(rest)));
  if (!first || !first->is_object() || !begins_with(trimmed(rest.substr(0, 4096)), "{")) return std::nullopt;
  Table table(text.size(), source);
  table.add(*first);
  for (std::size_t line = 2; !rest.empty(); ++line) {
    const bool ended = rest.find('\n') != std::string_view::npos;
    const std::string_view row = trimmed(take_line(rest));
    if (row.empty()) continue;
    const auto value = parsed(row);
    if (value && value->is_object()) {
      table.add(*value);
      continue;
    }
    if (!ended) break;  // cut off while it was written
    throw InputError(Problem{source, line, "", "is no JSON object, expected one in each line as above"});
  }
  return table.text("");
}

std::optional<std::string> list_of_objects(const Json& list, std::size_t bytes, const std::string& source,
                                           const std::string& head) {
  if (!list.is_array() || list.empty()) return std::nullopt;
  Table table(bytes, source);
  for (const Json& row : list) {
    if (!row.is_object()) return std::nullopt;
    table.add(row);
  }
  return table.empty() ? std::nullopt : std::optional(table.text(head));
}

/// Lists of equal length beside each other.
std::optional<std::string> object_of_lists(const Json& object, const std::string& source,
                                           const std::string& head) {
  std::vector<std::pair<std::string, const Json*>> columns;
  for (const auto& item : object.items()) {
    const Json& list = item.value();
    if (!list.is_array() || list.empty()) continue;
    if (!std::all_of(list.begin(), list.end(), is_scalar)) return std::nullopt;
    columns.emplace_back(item.key(), &list);
  }
  if (columns.size() < 2) return std::nullopt;
  for (const auto& [name, list] : columns) {
    if (list->size() == columns.front().second->size()) continue;
    throw InputError(
        Problem{source, 0, name,
                fmt::format("has {} values, expected {} as in {} (leave it out, or export the rows together)",
                            list->size(), columns.front().second->size(), in_quotes(columns.front().first))});
  }
  std::string out = head;
  for (std::size_t c = 0; c < columns.size(); ++c)
    out += (c > 0 ? "," : "") + cell_of(Json(columns[c].first));
  out += '\n';
  for (std::size_t k = 0; k < columns.front().second->size(); ++k) {
    for (std::size_t c = 0; c < columns.size(); ++c)
      out += (c > 0 ? "," : "") + cell_of((*columns[c].second)[k]);
    out += '\n';
  }
  return out;
}

/// Texts and numbers of an object beside its table, as comments of the CSV.
std::string head_of(const Json& object) {
  std::string head;
  for (const auto& item : object.items()) {
    const Json& value = item.value();
    if (!is_scalar(value) || value.is_null()) continue;
    std::string text =
        "# " + item.key() + ": " + (value.is_string() ? value.get<std::string>() : value.dump());
    for (char& c : text) c = static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    head += text + '\n';
  }
  return head;
}

/// Rows of the table that a value may hold: of a list, or of lists beside each other. A table has two lists at least, so the second
/// longest counts.
std::size_t rows_in(const Json& value) {
  if (value.is_array()) return value.size();
  std::size_t longest = 0, second = 0;
  if (!value.is_object()) return second;
  for (const auto& list : value) {
    const std::size_t rows = list.is_array() ? list.size() : 0;
    second = std::max(second, std::min(rows, longest));
    longest = std::max(longest, rows);
  }
  return second;
}

/// The table may stand inside, beside lists of channels or of events: {"channels": […], "data": […]}. The longest is taken, the first of
/// those that are equally long.
std::optional<std::string> longest_inside(const Json& object, std::size_t bytes, const std::string& source,
                                          const std::string& head) {
  std::vector<const Json*> inside;
  for (const auto& value : object) {
    if (rows_in(value) > 0) inside.push_back(&value);
  }
  std::stable_sort(inside.begin(), inside.end(),
                   [](const Json* a, const Json* b) { return rows_in(*a) > rows_in(*b); });
  for (const Json* const value : inside) {
    if (auto table = list_of_objects(*value, bytes, source, head)) return table;
    if (!value->is_object()) continue;
    if (auto table = object_of_lists(*value, source, head)) return table;
  }
  return std::nullopt;
}

/// Python writes NaN, which is no JSON, for what is absent.
std::string with_null_for_nan(std::string_view text) {
  std::string out;
  bool in_quotes = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (in_quotes && text[i] == '\\' && i + 1 < text.size()) {
      out += text[i++];
    } else if (text[i] == '"') {
      in_quotes = !in_quotes;
    } else if (!in_quotes && text.substr(i, 3) == "NaN") {
      out += "null";
      i += 2;
      continue;
    }
    out += text[i];
  }
  return out;
}

}  // namespace

bool may_be_json(std::string_view text) {
  text = trimmed(text.substr(0, 4096));
  if (text.empty() || (text[0] != '{' && text[0] != '[')) return false;
  const std::string_view inside = trimmed(text.substr(1));
  if (inside.empty()) return true;
  const char c = inside[0];
  if (text[0] == '{') return c == '"' || c == '}';
  return c == '{' || c == '[' || c == ']' || c == '"' || c == '-' ||
         std::isdigit(static_cast<unsigned char>(c)) != 0 || inside.starts_with("null") ||
         inside.starts_with("true") || inside.starts_with("false");
}

std::optional<std::string> csv_of_json(std::string_view text, const std::string& source) {
  text = trimmed(text);
  // The captures of a SINUMERIK are larger than others, and have a reader of their own.
  for (const std::string_view key : {"\"HFData\"", "\"SignalListHFData\"", "\"Payload\""}) {
    if (text.find(key) != std::string_view::npos) return std::nullopt;
  }
  std::string plain;
  if (text.find("NaN") != std::string_view::npos) {
    plain = with_null_for_nan(text);
    text = plain;
  }
  if (auto table = lines_of_objects(text, source)) return table;
  const auto value = parsed(text);
  if (!value) return std::nullopt;
  if (auto table = list_of_objects(*value, text.size(), source, "")) return table;
  if (!value->is_object()) return std::nullopt;
  const std::string head = head_of(*value);
  if (auto table = object_of_lists(*value, source, head)) return table;
  return longest_inside(*value, text.size(), source, head);
}

}  // namespace stribeck::io::detail
